//! The answers of a report: a word, a figure and a bar each.

use super::html::{escaped, put};
use crate::app::answer::Bar;
use crate::view::color::{Rgb, bytes};
use std::fmt::Write as _;

/// Size of a bar \[units of the drawing\], and height of its numbers.
const WIDTH: f64 = 240.0;
const HEIGHT: f64 = 28.0;
const NUMBERS: f64 = 10.0;
/// Top and height of the coloured parts.
const TOP: f64 = 8.0;
const THICK: f64 = 8.0;

pub(super) const STYLE: &str = ".answers{display:flex;flex-wrap:wrap;gap:6px 24px}.answers>div{flex:1 1 190px;min-width:0;break-inside:avoid}.sides .answers{display:block}.sides .answers>div{margin-bottom:6px}.sides h3,.sides .verdict{display:inline;padding-right:6px}\
    .answers h3{font-size:inherit;margin:0}.answers p{margin:1px 0}.answers svg{display:block;width:98%;max-width:300px}\
    .verdict{font-size:1.6em;font-weight:700;line-height:1.2}.verdict.none{font-size:1.1em;font-weight:400;color:#666}.band1{color:#8f5600}.band2,.band3{color:#a8201a}\
    @media screen and (prefers-color-scheme:dark){.verdict.none{color:#aaa}.band1{color:#e6a645}.band2,.band3{color:#ff8a80}}";

/// The answers of a plan under their heading.
pub(super) struct Answers {
    pub(super) heading: String,
    /// The cards: title, figure, word, further line, with their bars; none without an answer.
    pub(super) cards: Vec<([String; 4], Bar)>,
}

/// The answers of a plan in a row, or those of each side in a column, the columns side by side.
pub(super) fn sides(page: &mut String, sides: &[Answers]) {
    let class = if sides.len() > 1 { "pair sides" } else { "pair" };
    let _ = write!(page, "<div class=\"{class}\">");
    for Answers { heading, cards } in sides {
        page.push_str("<div>");
        put(page, "h2", heading);
        answers(page, cards);
        page.push_str("</div>");
    }
    page.push_str("</div>");
}

/// The answers: title, figure, word, further line of each, with its bar.
fn answers(page: &mut String, answers: &[([String; 4], Bar)]) {
    page.push_str("<div class=\"answers\">");
    for ([title, figure, word, line], bar) in answers {
        page.push_str("<div>");
        put(page, "h3", title);
        let class = bar.level.map_or_else(|| "none".to_owned(), |band| format!("band{band}"));
        let _ = write!(page, "<p class=\"verdict {class}\">{}</p>", escaped(word));
        put(page, "p", figure);
        draw(page, bar);
        let _ = write!(page, "<p class=\"quiet\">{}</p></div>", escaped(line));
    }
    page.push_str("</div>");
}

/// Draws a bar; the texts around say what it shows.
fn draw(page: &mut String, bar: &Bar) {
    let at = |share: f64| WIDTH * share;
    let _ = write!(page, "<svg aria-hidden=\"true\" viewBox=\"0 0 {WIDTH} {HEIGHT}\">");
    let mut from = 0.0;
    for (to, colour) in &bar.parts {
        let (x, width) = (at(from), at(to - from));
        let _ = write!(
            page,
            "<rect x=\"{x:.1}\" y=\"{TOP}\" width=\"{width:.1}\" height=\"{THICK}\" fill=\"{}\"/>",
            hex(*colour)
        );
        from = *to;
    }
    let frame = "fill=\"none\" stroke=\"#667\" stroke-width=\".7\"";
    let _ = write!(
        page,
        "<rect x=\".4\" y=\"{TOP}\" width=\"{:.1}\" height=\"{THICK}\" {frame}/>",
        WIDTH - 0.8
    );
    let mut taken: Vec<[f64; 2]> = Vec::new();
    for (limit, text) in &bar.limits {
        let half = 0.3 * NUMBERS * text.chars().count() as f64;
        let x = at(*limit);
        // At an end of the bar the text ends there, however broad its letters are.
        let (x, anchor, middle) = if x > WIDTH - half {
            (WIDTH, "end", WIDTH - half)
        } else if x < half {
            (0.0, "start", half)
        } else {
            (x, "middle", x)
        };
        // Another limit may be too close for its text.
        let own = [middle - half - 3.0, middle + half];
        if taken.iter().any(|other| own[0] < other[1] && other[0] < own[1]) {
            continue;
        }
        taken.push(own);
        let _ = write!(
            page,
            "<text x=\"{x:.1}\" y=\"{:.1}\" font-size=\"{NUMBERS}\" text-anchor=\"{anchor}\" fill=\"currentColor\">{}</text>",
            HEIGHT - 2.0,
            escaped(text)
        );
    }
    if let Some([low, high]) = bar.range {
        let _ = write!(
            page,
            "<path d=\"M{:.1} {y}H{:.1}\" stroke=\"currentColor\" stroke-width=\"2\"/>",
            at(low),
            at(high),
            y = TOP - 4.0
        );
    }
    if let Some(x) = bar.value.map(at) {
        let _ = write!(
            page,
            "<path d=\"M{x:.1} {:.1}l-5 -9h10z\" fill=\"currentColor\" stroke=\"#fff\" stroke-width=\".8\"/>",
            TOP + 3.0
        );
    }
    page.push_str("</svg>");
}

fn hex(colour: Rgb) -> String {
    let [r, g, b] = bytes(colour);
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_answers_of_both_sides_stand_beside_each_other_under_their_names() {
        let side =
            |side: &str| Answers { heading: format!("What happens · {side}"), cards: Vec::new() };
        let mut page = String::new();
        sides(&mut page, &[side("left"), side("right")]);
        let [left, right] = ["left", "right"].map(|side| {
            let place = page.find(&format!("<div><h2>What happens · {side}</h2>"));
            place.expect("a column with its name")
        });
        assert!(page.starts_with("<div class=\"pair sides\">") && left < right, "{page}");
        let mut page = String::new();
        sides(&mut page, &[side("left")]);
        assert!(page.starts_with("<div class=\"pair\"><div><h2>"), "{page}");
    }

    #[test]
    fn an_answer_has_its_word_and_a_bar_with_limits_and_mark() {
        let bar = Bar {
            parts: vec![(0.5, [1.0, 0.0, 0.0]), (1.0, [0.0, 0.0, 1.0])],
            limits: vec![(0.5, "80 %".to_owned()), (0.51, "81 %".to_owned())],
            value: Some(0.25),
            range: None,
            has_bands: true,
            unit: "",
            level: Some(1),
        };
        let mut page = String::new();
        let texts = ["Skin stretch", "18 % longer", "high", "a < b"].map(str::to_owned);
        let answer = [(texts, bar)];
        answers(&mut page, &answer);
        let [(_, bar)] = answer;
        assert!(page.contains("<p class=\"verdict band1\">high</p>"), "{page}");
        assert!(page.contains("a &lt; b") && page.contains("fill=\"#ff0000\""), "{page}");
        assert!(page.contains("x=\"120.0\" y=\"26.0\"") && page.contains(">80 %<"), "{page}");
        // A text at the end of the bar is anchored there: its letters may be broad.
        let bar = Bar { limits: vec![(1.0, "10 mm".to_owned()), (0.0, "0".to_owned())], ..bar };
        let mut page = String::new();
        draw(&mut page, &bar);
        let ends = ["x=\"240.0\" y=\"26.0\" font-size=\"10\" text-anchor=\"end\"", "x=\"0.0\""];
        assert!(ends.iter().all(|end| page.contains(end)), "{page}");
        assert!(!page.contains("81 %"), "over the limit before");
        assert!(page.contains("M60.0 11.0l"), "the mark at a quarter: {page}");
    }
}
