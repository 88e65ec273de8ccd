//! Figures and words of the three cards: skin stretch, cover, pressure. Figure and word are the plan's own, with and without sampled
//! patients, on the card, in the sentence and in the report alike; the band of the patients stands in brackets, and the number of patients
//! of each word in a line ([`shares`]).

use super::shares::in_words as shares;
use crate::app::texts::{self, fixed, localized, tr, word_of};
use crate::app::uncertainty::{Findings, figure};
use crate::measure::bands::{self, Limits};
use crate::measure::{Outcome, STRAIN_BANDS};
use crate::scene::Scene;
use crate::solve::Problem;
use crate::study::{Band, Quantity};
use crate::view::color::{MOST_RESERVE, MOST_STRAIN};

/// Strain above which the share of the skin is shown \[-\], and its key in the result.
const SHARE_ABOVE: (f64, &str) = (STRAIN_BANDS[0], "0.25");
/// Greatest value of the bar of the pressure \[mmHg\].
const MOST_PRESSURE: f64 = 100.0;
/// Share of the sampled patients without an answer above which a band is open at its worse end \[-\].
const OPEN_ABOVE: f64 = 0.05;

/// The figures of the answer.
pub(super) struct Answer {
    /// Greatest strain of the skin \[-\].
    pub(super) strain: Option<f64>,
    /// The strain relative to that at which this skin turns steep \[-\].
    reserve: Option<f64>,
    /// Has this skin a reserve? Without a value too: the bar keeps its limits during a solve.
    has_reserve: bool,
    /// Fraction of the skin above [`SHARE_ABOVE`] \[-\].
    share: f64,
    /// Least thickness over the implant \[mm\].
    pub(super) cover: Option<f64>,
    /// Thickness over the implant's highest point \[mm\].
    apex: Option<f64>,
    /// Thickness at rest \[mm\].
    pub(super) rest: f64,
    /// Does the tissue have a cover, or is it one sheet?
    is_layered: bool,
    /// Mean and greatest contact pressure \[mmHg\].
    pub(super) pressure: Option<(f64, f64)>,
}

/// Band, counted from the lowest, and its word.
type Verdict = (usize, &'static str);

/// A verdict in the language of the user.
fn in_words((band, word): Verdict) -> Verdict {
    (band, tr(word))
}

/// The verdict of a contact pressure \[mmHg\].
fn pressure_verdict(mmhg: f64) -> Verdict {
    let (band, word) = bands::PRESSURE.verdict(mmhg);
    (band, word_of(&bands::PRESSURE, word))
}

impl Answer {
    /// The figures of a result of a plan; without a result the limits are those of a problem.
    pub(super) fn new(outcome: Option<&Outcome>, scene: &Scene, problem: &Problem) -> Self {
        let strain = outcome.and_then(|outcome| outcome.strain.as_ref());
        let share = strain.and_then(|s| s.fraction_above.get(SHARE_ABOVE.1)).copied();
        let cover = outcome.and_then(|outcome| outcome.cover_mm);
        let reserve = outcome.and_then(|outcome| outcome.skin_reserve_used);
        Self {
            strain: strain.map(|strain| strain.max_principal.max(0.0)),
            reserve,
            has_reserve: match strain {
                Some(_) => reserve.is_some(),
                None => problem.skin_knee().is_some(),
            },
            share: share.unwrap_or(0.0),
            cover: cover.map(|cover| cover.least),
            apex: cover.map(|cover| cover.apex),
            is_layered: scene.is_layered(),
            rest: scene.layers.iter().map(|layer| layer.thickness_mm).sum(),
            pressure: outcome.and_then(|o| o.contact_pressure_mmhg).map(|p| (p.mean, p.max)),
        }
    }

    /// The word of the stretch.
    pub(super) fn stretch(&self) -> Option<Verdict> {
        self.strain.map(|strain| in_words(bands::stretch(strain, self.reserve)))
    }

    /// The word of the cover; `None` for a cover that is not thin.
    pub(super) fn cover_word(&self) -> Option<Verdict> {
        self.cover.and_then(bands::cover).map(in_words)
    }

    /// The words of the cards: stretch, cover, pressure.
    fn words(&self) -> [Option<Verdict>; 3] {
        let pressure = self.pressure.map(|(_, most)| pressure_verdict(most));
        [self.stretch(), self.cover_word(), pressure]
    }

    /// The worst word with its quantity, and the three figures, as "usual. Stretch 14 %, cover 7.2 mm, pressure 13 mmHg."
    pub(super) fn in_a_sentence(&self) -> String {
        let names = [tr("skin stretch"), tr("cover"), tr("pressure")];
        let words = self.words().into_iter().zip(names);
        let words = words.filter_map(|(word, name)| Some((word?, name)));
        // The first of equal ones.
        let worst =
            words.rev().max_by_key(|((band, _), _)| *band).filter(|((band, _), _)| *band > 0);
        let worst = worst
            .map_or_else(|| tr("usual").to_owned(), |((_, word), name)| format!("{name} {word}"));
        let figures = [
            self.strain.map(|strain| tr!("stretch {strain:.0} %", strain = 100.0 * strain)),
            self.cover.map(|mm| tr!("cover {mm:.1} mm", mm)),
            self.pressure.map(|(_, most)| tr!("pressure {figure}", figure = texts::pressure(most))),
        ];
        let figures: Vec<String> = figures.into_iter().flatten().collect();
        let figures = figures.join(", ");
        let (first, rest) = figures.split_at(usize::from(!figures.is_empty()));
        format!("{worst}. {}{rest}.", first.to_uppercase())
    }
}

/// Words and figures of a card.
pub(super) struct Card {
    pub(super) title: &'static str,
    /// The figure with its unit.
    pub(super) figure: String,
    /// Words beside the figure.
    pub(super) beside: String,
    /// Short name and figure for the phone's row.
    pub(super) short: (&'static str, String),
    /// Band and word; `None` without limits or value.
    pub(super) verdict: Option<Verdict>,
    /// What stands in place of a word without limits.
    pub(super) no_verdict: &'static str,
    /// Numbers of sampled patients by their words, in a line.
    pub(super) shares: Option<String>,
    pub(super) line: String,
    /// The value on the bar.
    pub(super) value: Option<f64>,
    /// 10th and 90th percentile on the bar.
    pub(super) range: Option<[f64; 2]>,
    /// The median of the band, with its unit.
    pub(super) median: Option<String>,
    pub(super) scale: BarScale,
}

/// The scale of a card's bar.
#[derive(Clone, Copy)]
pub(super) enum BarScale {
    /// Bands of limits, up to a value.
    Bands { limits: &'static Limits, most: f64, in_percent: bool },
    /// A part of a whole.
    Part { whole: f64 },
}

/// The marks of a cover up to a thickness \[mm\] with their words: thin, and practice's least thickness at rest.
pub(super) fn cover_marks(whole: f64) -> impl Iterator<Item = (f64, String)> {
    let marks = [bands::THIN_COVER_MM, bands::PRACTICE_COVER_MM];
    marks.into_iter().filter(move |mm| *mm <= whole).map(|mm| (mm, format!("{mm:.0} mm")))
}

/// The bands of sampled patients, as far as there are any.
struct Sampled<'a>(Option<&'a Findings>);

impl<'a> Sampled<'a> {
    fn new(findings: Option<&'a Findings>) -> Self {
        Self(findings.filter(|findings| !findings.is_empty()))
    }

    fn band(&self, quantity: Quantity) -> Option<&Band> {
        self.0.and_then(|findings| findings.band(quantity))
    }

    /// The range in brackets, as "(4–31) "; open at its worse end if more than [`OPEN_ABOVE`] of the patients are missing.
    fn brackets(&self, quantity: Quantity, is_low_worse: bool) -> String {
        let Some((band, findings)) = self.band(quantity).zip(self.0) else { return String::new() };
        let (factor, unit) = quantity.display();
        let decimals = usize::from(unit == "mm");
        let ends = [band.p10, band.p90].map(|value| factor * value);
        if unit == "mmHg" && ends[1].round() > texts::MOST_PRESSURE {
            return format!("({}) ", texts::pressures(ends));
        }
        let [low, high] = ends.map(|value| fixed(value, decimals));
        match findings.without_answer() > OPEN_ABOVE {
            true if is_low_worse => format!("(≤ {low}–{high}) "),
            true => format!("({low}–≥ {high}) "),
            false => format!("({low}–{high}) "),
        }
    }

    /// A figure of a line, as "12 % (4–31)".
    fn in_line(&self, quantity: Quantity, own: f64) -> String {
        let text = format!("{} {}", figure(quantity, own), self.brackets(quantity, false));
        text.trim_end().to_owned()
    }

    /// The median with its unit.
    fn median(&self, quantity: Quantity) -> Option<String> {
        let text = |band: &Band| match quantity.display() {
            (factor, "mmHg") => Some(texts::pressure(factor * band.p50)),
            _ => band.text.rsplit_once(", ").map(|(median, _)| localized(median)),
        };
        self.band(quantity).and_then(text)
    }

    /// The numbers of patients by the word of a quantity.
    fn shares(&self, quantity: Quantity, word: impl Fn(f64) -> Verdict) -> Option<String> {
        let findings = self.0?;
        let words = findings.values().of(quantity).map(word);
        shares(words, findings.solved() - findings.answers())
    }

    /// The 10th and the 90th percentile.
    fn range(&self, quantity: Quantity) -> Option<[f64; 2]> {
        self.band(quantity).map(|band| [band.p10, band.p90])
    }
}

/// The cards of an answer, with the bands of `findings` in brackets.
pub(super) fn cards(answer: &Answer, findings: Option<&Findings>) -> [Card; 3] {
    let sampled = Sampled::new(findings);
    let [stretch, cover, pressure] = answer.words();
    [
        stretch_card(answer, &sampled, stretch),
        cover_card(answer, &sampled, cover),
        pressure_card(answer, &sampled, pressure),
    ]
}

/// A value in words, or a dash.
fn text_of(value: Option<f64>, text: impl Fn(f64) -> String) -> String {
    value.map_or_else(|| "–".to_owned(), text)
}

fn stretch_card(answer: &Answer, sampled: &Sampled<'_>, word: Option<Verdict>) -> Card {
    let figure = text_of(answer.strain, |v| format!("{:.0} %", 100.0 * v));
    let range = sampled.range(Quantity::GreatestStrain);
    let reserve = sampled.range(Quantity::SkinReserveUsed);
    let missing = sampled.0.and_then(Findings::missing).unwrap_or_default();
    let line = answer.strain.map_or_else(String::new, |_| {
        let share = match answer.reserve {
            Some(_) => String::new(),
            None => tr!(
                "{share} of the skin is above {limit:.0} %. ",
                share = sampled.in_line(Quantity::AreaOver25, answer.share),
                limit = 100.0 * SHARE_ABOVE.0
            ),
        };
        format!("{missing}{share}").trim_end().to_owned()
    });
    let brackets = sampled.brackets(Quantity::GreatestStrain, false);
    let words = answer.reserve.map_or_else(
        || tr("longer, at most").to_owned(),
        |share| tr!("longer: {share:.0} % of its reserve", share = 100.0 * share),
    );
    let (limits, most, of) = match answer.has_reserve {
        true => (&bands::RESERVE, MOST_RESERVE, Quantity::SkinReserveUsed),
        false => (&bands::STRAIN, MOST_STRAIN, Quantity::GreatestStrain),
    };
    Card {
        title: tr("Skin stretch"),
        short: (tr("Stretch"), figure.clone()),
        figure,
        beside: format!("{brackets}{words}"),
        verdict: word,
        no_verdict: "",
        shares: sampled.shares(of, |value| in_words(limits.verdict(value))),
        line,
        value: answer.reserve.or(answer.strain),
        range: if answer.has_reserve { reserve } else { range },
        median: sampled.median(Quantity::GreatestStrain),
        scale: BarScale::Bands { limits, most, in_percent: true },
    }
}

fn cover_card(answer: &Answer, sampled: &Sampled<'_>, word: Option<Verdict>) -> Card {
    let line = match answer.apex {
        Some(apex) => {
            tr!("{cover} at the top", cover = sampled.in_line(Quantity::ApexCoverMm, apex))
        }
        None if answer.is_layered => String::new(),
        None => tr("needs “Skin on solid layers” (Advanced)").to_owned(),
    };
    let brackets = sampled.brackets(Quantity::LeastCoverMm, true);
    Card {
        title: tr("Cover over implant"),
        short: (tr("Cover"), text_of(answer.cover, |v| format!("{} mm", fixed(v, 1)))),
        figure: text_of(answer.cover, |v| format!("{} mm", fixed(v, 1))),
        beside: tr!("{brackets}at least; at rest {rest:.1} mm", brackets, rest = answer.rest),
        verdict: word,
        no_verdict: tr("not thin"),
        shares: sampled.shares(Quantity::LeastCoverMm, |mm| {
            bands::cover(mm).map_or((0, tr("not thin")), in_words)
        }),
        line,
        value: answer.cover,
        range: sampled.range(Quantity::LeastCoverMm),
        median: sampled.median(Quantity::LeastCoverMm),
        scale: BarScale::Part { whole: answer.rest },
    }
}

fn pressure_card(answer: &Answer, sampled: &Sampled<'_>, word: Option<Verdict>) -> Card {
    let most = answer.pressure.map(|(_, most)| most);
    let figure = text_of(most, texts::pressure);
    let line = answer.pressure.map_or_else(String::new, |(mean, _)| {
        tr!("{pressure} on average", pressure = sampled.in_line(Quantity::MeanPressureMmhg, mean))
    });
    let brackets = sampled.brackets(Quantity::GreatestPressureMmhg, false);
    Card {
        title: tr("Pressure on the tissue"),
        short: (tr("Pressure"), figure.clone()),
        figure,
        beside: tr!("{brackets}at most", brackets),
        verdict: word,
        no_verdict: "",
        shares: sampled.shares(Quantity::GreatestPressureMmhg, pressure_verdict),
        line,
        value: most,
        range: sampled.range(Quantity::GreatestPressureMmhg),
        median: sampled.median(Quantity::GreatestPressureMmhg),
        scale: BarScale::Bands { limits: &bands::PRESSURE, most: MOST_PRESSURE, in_percent: false },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Session;

    #[test]
    fn the_sentence_begins_with_the_worst_word() {
        let answer = |strain, reserve, cover, pressure| Answer {
            strain: Some(strain),
            reserve,
            has_reserve: reserve.is_some(),
            share: 0.0,
            cover: Some(cover),
            apex: None,
            rest: 10.0,
            is_layered: true,
            pressure: Some((0.8 * pressure, pressure)),
        };
        for (of, sentence) in [
            (
                answer(0.14, Some(0.65), 7.2, 13.0),
                "usual. Stretch 14 %, cover 7.2 mm, pressure 13 mmHg.",
            ),
            (
                answer(0.09, Some(0.9), 7.2, 17.0),
                "skin stretch high. Stretch 9 %, cover 7.2 mm, pressure 17 mmHg.",
            ),
            (
                answer(0.09, Some(0.3), 4.4, 17.0),
                "cover thin. Stretch 9 %, cover 4.4 mm, pressure 17 mmHg.",
            ),
            (
                answer(0.09, Some(0.9), 4.4, 90.0),
                "pressure very high. Stretch 9 %, cover 4.4 mm, pressure 90 mmHg.",
            ),
            // A skin with a reserve is judged by the reserve alone, another one by its strain.
            (
                answer(0.6, Some(0.9), 7.2, 17.0),
                "skin stretch high. Stretch 60 %, cover 7.2 mm, pressure 17 mmHg.",
            ),
            (
                answer(0.6, None, 7.2, 90.0),
                "skin stretch beyond. Stretch 60 %, cover 7.2 mm, pressure 90 mmHg.",
            ),
        ] {
            assert_eq!(of.in_a_sentence(), sentence);
        }
    }

    #[test]
    fn the_bar_of_the_stretch_has_the_same_limits_before_the_result() {
        let session = Session::new(Scene::opening()).unwrap();
        let answer = Answer::new(None, session.scene(), session.problem());
        let [card, ..] = cards(&answer, None);
        let BarScale::Bands { limits, .. } = card.scale else { panic!("no limits") };
        assert_eq!((limits.quantity, card.value), (bands::RESERVE.quantity, None));
    }
}
