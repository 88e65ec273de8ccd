//! The HTML of a report.

use super::DISCLAIMER;
use super::answers::{self, Answers, sides};
use super::html::{escaped, put};
use crate::app::answer::before_after;
use crate::app::answer::fill_steps;
use crate::app::answer::times;
use crate::app::texts::{self, tr};
use crate::study::NOTES;
use base64::Engine as _;
use std::fmt::Write as _;

/// A picture of the report.
pub(super) struct Picture {
    /// What the picture shows.
    pub(super) name: String,
    /// The picture itself, as an address.
    pub(super) address: String,
    /// A line below the picture; may be empty.
    pub(super) caption: String,
}

/// The content of a report.
pub(super) struct Page {
    /// The plan in the standard poses; none without a shape.
    pub(super) poses: Vec<Picture>,
    /// Pins and plan side by side.
    pub(super) pins: Option<Picture>,
    /// Pictures of the second page.
    pub(super) further: Vec<Picture>,
    /// How to get a picture that is missing: on the screen only.
    pub(super) missing: Option<String>,
    /// The visit in one line, and the remarks; each may be empty.
    pub(super) visit: [String; 2],
    /// The implant in a line, or that of each side.
    pub(super) implant: Vec<String>,
    /// The head of every page on paper.
    pub(super) running: String,
    /// Date, time and version in words.
    pub(super) origin: String,
    /// The answer in one sentence.
    pub(super) headline: String,
    /// The plan: names and values.
    pub(super) plan: Vec<(&'static str, String)>,
    /// The answers, or those of each side.
    pub(super) answers: Vec<Answers>,
    /// Warnings, or what a missing answer means.
    pub(super) remarks: Vec<String>,
    /// The results of the plan and of the pins: names and cells of number and word; the first row contains the heads of the columns.
    pub(super) table: Vec<(String, Vec<[String; 2]>)>,
    /// The measures of her body before and after, if the plan has it.
    pub(super) measures: Option<before_after::Table>,
    /// The plan on the table and later, once its skin has a state.
    pub(super) times: Option<before_after::Table>,
    /// What the bands are, if the results have bands.
    pub(super) bands: Option<String>,
    /// The fill steps of an expander, heads first; may be empty.
    pub(super) steps: Vec<Vec<String>>,
    /// Headings and limits with their sources, a source in a line.
    pub(super) limits: Vec<(&'static str, String)>,
    /// Model, grids and what repeats the computation, a sentence in a line.
    pub(super) technical: Vec<String>,
    /// The plan's file.
    pub(super) plan_json: String,
}

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;color:#222;max-width:860px;margin:24px auto;padding:0 16px}\
    h1{font-size:22px;margin:0}h2{font-size:17px;margin:22px 0 6px}img{max-width:100%;box-sizing:border-box;border:1px solid #ccc}\
    table{border-collapse:collapse}th,td{padding:3px 14px 3px 0;text-align:left;vertical-align:top;\
    border-bottom:1px solid #e4e4e4}tr,table,img,.note,.answers,figure{break-inside:avoid}.number{text-align:right;white-space:nowrap;padding-right:8px;font-variant-numeric:tabular-nums}\
    .wide{overflow-x:auto}.steps th,.steps td{padding-right:8px}.quiet{color:#666;font-size:13px}pre{font-size:12px;white-space:pre-wrap;overflow-wrap:anywhere}\
    .note{border-left:4px solid #b26a00;padding-left:10px}.pair{display:flex;flex-wrap:wrap;gap:0 28px}.pair>div{flex:1 1 300px}\
    .poses{display:flex;gap:10px;margin:10px 0}.poses figure{flex:1 1 0;min-width:0;margin:0}figcaption{color:#666;font-size:13px}.implant{font-weight:600;margin:6px 0}\
    .plan{columns:2 300px;column-gap:28px}.plan p{margin:0;padding:2px 0;border-bottom:1px solid #e4e4e4;display:flex;gap:12px;break-inside:avoid}.plan b{font-weight:400;color:#666;flex:0 0 7em}\
    .visit{margin:6px 0;font-weight:600;overflow-wrap:anywhere}.blank{margin:6px 0;display:flex;flex-wrap:wrap;gap:4px 10px}.blank span{flex:1 1 90px;border-bottom:1px solid #222}.words{font-weight:400;white-space:pre-line;columns:2 250px}\
    .notes{columns:2 300px;column-gap:20px}.notes p{margin-top:0;break-inside:avoid}.second img{max-width:min(100%,620px)}\
    @media screen and (prefers-color-scheme:dark){:root{color-scheme:dark}body{background:#16181c;color:#e2e2e2}img{border-color:#444}\
    th,td,.plan p{border-color:#3a3d42}.quiet,figcaption,.plan b{color:#aaa}.blank span{border-color:#ccc}}\
    @media print{body{font-size:11px;line-height:1.35;margin:0;max-width:none;padding:0 1px}h1{font-size:18px}\
    h2{font-size:14px;margin:7px 0 1px}p{margin:3px 0}.quiet,figcaption{font-size:9.5px}th,td{padding:1px 12px 1px 0}\
    .second{break-inside:avoid}.sides~.second{break-inside:auto}.plan{columns:3 200px}.second img{max-height:72mm}.poses{margin:5px 0}.plan p{padding:1px 0}.wide{overflow:visible}h2{break-after:avoid}details,.screen{display:none}.pair{gap:0 16px}.pair>div{flex-basis:270px}}";

impl Page {
    /// The file, one template without scripts and outside addresses.
    pub(super) fn html(&self) -> String {
        let mut body = String::new();
        let page = &mut body;
        put(page, "h1", tr("Implant preview"));
        let [visit, words] = &self.visit;
        for (class, text) in [("visit", visit), ("visit words", words)] {
            if !text.is_empty() {
                let _ = write!(page, "<p class=\"{class}\">{}</p>", escaped(text));
            }
        }
        if visit.is_empty() {
            // To fill by hand.
            let names = ["Patient", "Date of the visit", "Surgeon"].map(|name| escaped(tr(name)));
            let blanks = names.map(|name| format!("{name}: <span></span>")).join(" ");
            let _ = write!(page, "<p class=\"blank\">{blanks}</p>");
        }
        for implant in &self.implant {
            let _ = write!(page, "<p class=\"implant\">{}</p>", escaped(implant));
        }
        put(page, "p", &self.headline);
        let _ = write!(page, "<p class=\"note\">{}</p>", escaped(tr(DISCLAIMER)));
        let _ = write!(page, "<p class=\"quiet\">{}</p>", escaped(&self.origin));
        if !self.poses.is_empty() {
            page.push_str("<div class=\"poses\">");
            for pose in &self.poses {
                page.push_str("<figure>");
                picture(page, pose);
                put(page, "figcaption", &pose.name);
                page.push_str("</figure>");
            }
            page.push_str("</div>");
        }
        sides(page, &self.answers);
        for remark in &self.remarks {
            let _ = write!(page, "<p class=\"note\">{}</p>", escaped(remark));
        }
        put(page, "h2", tr("Plan"));
        page.push_str("<div class=\"plan\">");
        for (name, value) in &self.plan {
            let (name, value) = (escaped(name), escaped(value));
            let _ = write!(page, "<p><b>{name}</b> <span>{value}</span></p>");
        }
        page.push_str("</div>");
        if let Some(pins) = &self.pins {
            put(page, "h2", &pins.name);
            picture(page, pins);
        }
        page.push_str("<div class=\"second\"><div class=\"pair\">");
        for further in &self.further {
            page.push_str("<div>");
            put(page, "h2", &further.name);
            picture(page, further);
            page.push_str("</div>");
        }
        page.push_str("</div>");
        if let Some(how) = &self.missing {
            let _ = write!(page, "<p class=\"quiet screen\">{}</p>", escaped(how));
        }
        put(page, "h2", tr("Where limits come from"));
        page.push_str("<div class=\"notes\">");
        for (heading, limits) in &self.limits {
            let lines: Vec<String> = limits.lines().map(escaped).collect();
            let (heading, lines) = (escaped(heading), lines.join("<br>"));
            let _ = write!(page, "<p class=\"quiet\"><b>{heading}</b><br>{lines}</p>");
        }
        if !self.technical.is_empty() {
            let lines: Vec<String> = self.technical.iter().map(|line| escaped(line)).collect();
            let (heading, lines) = (escaped(tr("Technical details")), lines.join("<br>"));
            let _ = write!(page, "<p class=\"quiet\"><b>{heading}</b><br>{lines}</p>");
        }
        page.push_str("</div>");
        page.push_str("<div class=\"pair\"><div>");
        put(page, "h2", tr("Numbers"));
        numbers(page, &self.table);
        page.push_str("</div>");
        let tables = [(&self.measures, before_after::TITLE), (&self.times, times::TITLE)];
        for (measures, title) in tables {
            let Some(measures) = measures else { continue };
            page.push_str("<div>");
            put(page, "h2", tr(title));
            let head = [String::new()].into_iter().chain(measures.heads.iter().cloned());
            let row = |(name, _, cells): &(String, &str, Vec<String>)| -> Vec<String> {
                [name].into_iter().chain(cells).cloned().collect()
            };
            let rows: Vec<Vec<String>> = measures.lines.iter().map(row).collect();
            table(page, "measures", &head.collect::<Vec<_>>(), &rows);
            for note in &measures.notes {
                let _ = write!(page, "<p class=\"quiet\">{}</p>", escaped(note));
            }
            page.push_str("</div>");
        }
        if let Some((head, rows)) = self.steps.split_first() {
            page.push_str("<div>");
            put(page, "h2", tr("Fill steps by week"));
            table(page, "steps", head, rows);
            let note = escaped(tr(fill_steps::NOTE));
            let _ = write!(page, "<p class=\"quiet\">{note}</p></div>");
        }
        page.push_str("</div>");
        if let Some(words) = &self.bands {
            let notes = [words.as_str(), tr(NOTES[0]), tr(NOTES[1])].map(escaped).join(" ");
            let _ = write!(page, "<p class=\"quiet\">{notes}</p>");
        }
        page.push_str("</div>");
        let _ = write!(
            page,
            "<details><summary>{}</summary><pre>{}</pre></details>",
            escaped(tr("The plan's file")),
            escaped(&self.plan_json)
        );
        // Programs print the title where they print no running head.
        let title = format!("{} · {}", tr("Implant preview: report"), self.running);
        let (language, title) = (texts::language().subtag(), escaped(&title));
        let (answers, paper) = (answers::STYLE, paper(&self.running));
        format!(
            "<!doctype html>\n<html lang=\"{language}\"><head><meta charset=\"utf-8\">\
             <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; \
             style-src 'unsafe-inline'\">\
             <meta name=\"viewport\" content=\"width=device-width\">\
             <title>{title}</title><style>{STYLE}{answers}{paper}</style></head><body>{body}</body></html>\n"
        )
    }
}

/// The style of the paper: a running head on every page but the first, which has the visit in its title, and the number of the page.
fn paper(running: &str) -> String {
    let font = "font:9px system-ui,sans-serif;color:#444";
    let pages = css_text(&tr!("page {page} of {pages}", page = PAGE, pages = PAGES));
    // The places of the numbers are counters.
    let pages = pages.replace(PAGE, "\" counter(page) \"").replace(PAGES, "\" counter(pages) \"");
    format!(
        "@page{{size:A4;margin:15mm 13mm;@top-left{{content:\"{head}\";{font}}}\
         @bottom-right{{content:\"{pages}\";{font}}}}}@page:first{{@top-left{{content:none}}}}",
        head = css_text(running),
    )
}

/// Places of the number of the page and of all pages in a text.
const PAGE: &str = "PageNumber";
const PAGES: &str = "NumberOfPages";

/// A text as the content of a string in a style: all but letters, digits and blanks as numbers of characters.
fn css_text(text: &str) -> String {
    let sign = |c: char| match c {
        ' ' => " ".to_owned(),
        c if c.is_ascii_alphanumeric() => c.to_string(),
        c => format!("\\{:x} ", c as u32),
    };
    text.chars().map(sign).collect()
}

/// A picture (PNG) as an address.
pub(super) fn data_address(png: &[u8]) -> String {
    let text = base64::engine::general_purpose::STANDARD.encode(png);
    format!("data:image/png;base64,{text}")
}

fn picture(page: &mut String, picture: &Picture) {
    let Picture { name, address, caption } = picture;
    let _ = write!(page, "<img alt=\"{}\" src=\"{address}\">", escaped(name));
    if !caption.is_empty() {
        let _ = write!(page, "<p class=\"quiet\">{}</p>", escaped(caption));
    }
}

/// A table of texts with its heads.
fn table(page: &mut String, class: &str, head: &[String], rows: &[Vec<String>]) {
    // A wide table scrolls within the page of a phone.
    let _ = write!(page, "<div class=\"wide\"><table class=\"{class}\"><thead><tr>");
    let is_number =
        |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "+−".contains(c));
    let class = |is_number: bool| if is_number { " class=\"number\"" } else { "" };
    for (k, cell) in head.iter().enumerate() {
        let class = class(rows.iter().filter_map(|row| row.get(k)).any(is_number));
        let _ = write!(page, "<th{class}>{}</th>", escaped(cell));
    }
    page.push_str("</tr></thead>");
    for cells in rows {
        page.push_str("<tr>");
        for cell in cells {
            let _ = write!(page, "<td{}>{}</td>", class(is_number(cell)), escaped(cell));
        }
        page.push_str("</tr>");
    }
    page.push_str("</table></div>");
}

/// The numbers, aligned to the right, with their words in columns of their own.
fn numbers(page: &mut String, rows: &[(String, Vec<[String; 2]>)]) {
    page.push_str("<div class=\"wide\"><table class=\"numbers\">");
    for (k, (name, cells)) in rows.iter().enumerate() {
        page.push_str("<tr>");
        put(page, if k == 0 { "th" } else { "td" }, name);
        for [number, word] in cells {
            let (number, word) = (escaped(number), escaped(word));
            let _ = if k == 0 {
                write!(page, "<th class=\"number\">{number}</th><th></th>")
            } else {
                write!(page, "<td class=\"number\">{number}</td><td>{word}</td>")
            };
        }
        page.push_str("</tr>");
    }
    page.push_str("</table></div>");
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answer::Bar;

    #[test]
    fn a_report_contains_its_texts_as_text_only() {
        let hostile = "<script>alert(1)</script>&\"".to_owned();
        let picture = |name: &str, png: &[u8], caption: &str| Picture {
            name: name.to_owned(),
            address: data_address(png),
            caption: caption.to_owned(),
        };
        let bar = Bar {
            parts: Vec::new(),
            limits: Vec::new(),
            has_bands: true,
            unit: "",
            value: None,
            range: None,
            level: None,
        };
        let page = Page {
            poses: vec![picture("From the front", &[1, 2, 3], "")],
            pins: Some(picture("Pins", &[5], "")),
            further: vec![picture("Cross-section", &[4], &hostile)],
            implant: vec![hostile.clone()],
            missing: Some(hostile.clone()),
            visit: [hostile.clone(), hostile.clone()],
            running: hostile.clone(),
            origin: "2026-01-01, 00:00 UTC".to_owned(),
            headline: hostile.clone(),
            plan: vec![("Width", hostile.clone())],
            answers: vec![Answers {
                heading: hostile.clone(),
                cards: vec![([(); 4].map(|()| hostile.clone()), bar)],
            }],
            remarks: vec![hostile.clone()],
            table: vec![
                (String::new(), vec![[hostile.clone(), String::new()]]),
                (hostile.clone(), vec![["12".to_owned(), hostile.clone()]]),
            ],
            measures: Some(before_after::Table {
                heads: vec![hostile.clone()],
                lines: vec![(hostile.clone(), "", vec!["+7".to_owned()])],
                notes: vec![hostile.clone()],
            }),
            times: None,
            bands: Some(hostile.clone()),
            steps: vec![vec![hostile.clone()], vec![hostile.clone()]],
            limits: vec![("Pressure", hostile.clone())],
            technical: vec![hostile.clone()],
            plan_json: hostile.clone(),
        };
        let html = page.html();
        assert!(!html.contains("<script"), "{html}");
        let count = html.matches("&lt;script&gt;alert(1)&lt;/script&gt;&amp;&quot;").count();
        assert_eq!(count, 26);
        let css = "@top-left{content:\"\\3c script\\3e alert\\28 1\\29 \\3c \\2f script\\3e \\26 \\22 \";";
        assert!(html.contains(css), "{html}");
        assert!(!html.contains("class=\"blank\""), "a filled line of the patient");
        let number = "content:\"page \" counter(page) \" of \" counter(pages) \"\"";
        assert!(html.contains(number), "{html}");
        assert!(html.contains("data:image/png;base64,AQID"));
        let pose = "<figure><img alt=\"From the front\" src=\"data:image/png;base64,AQID\"><figcaption>From the front";
        assert!(html.contains(pose), "{html}");
        // The second page begins with the cross-section; a number and its word have a column each.
        let second = "<div class=\"second\"><div class=\"pair\"><div><h2>Cross-section</h2>";
        assert!(html.contains(second), "{html}");
        assert!(html.contains("<td class=\"number\">12</td><td>&lt;script&gt;"), "{html}");
        assert!(html.contains("</td><td class=\"number\">+7</td>"), "{html}");
        assert!(html.contains("Not a medical device") && html.contains("not a prediction"));
        assert!(!html.contains("http://") && !html.contains("https://"));
        // Dark on a dark screen, light on paper, whose edge cuts no frame.
        assert_eq!(html.matches("@media screen and (prefers-color-scheme:dark)").count(), 2);
        assert!(!html.contains("@media (prefers-color-scheme"), "{html}");
        assert!(html.contains("@media print{") && html.contains("padding:0 1px"), "{html}");
    }
}
