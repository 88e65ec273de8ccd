//! Figures and words of the three cards: skin stretch, cover, pressure. Figure and word are the plan's own, with and without sampled
//! patients, on the card, in the sentence and in the report alike; the band of the patients stands in brackets, and the number of patients
//! of each word in a line ([`shares`]).

use super::figures::{Answer, SHARE_ABOVE, Verdict, in_words, pressure_verdict};
use super::practice::Against;
use super::shares;
use super::uncertainty::{FEW, Findings, figure};
use crate::app::texts::{self, fixed, localized, tr};
use crate::measure::bands::{self, Limits, SkinLimits};
use crate::study::{Band, Quantity};
use crate::view::color;
use std::borrow::Cow;

/// Greatest value of the bar of the pressure \[mmHg\].
const MOST_PRESSURE: f64 = 100.0;
/// Share of the sampled patients without an answer above which a band is open at its worse end \[-\].
const OPEN_ABOVE: f64 = 0.05;
/// Why a volume of practice is above practice.
const ABOVE_BY_SHAPE: &str =
    "Practice's volume in another shape: as a round implant it stretches the skin less.";

/// Words and figures of a card.
pub(super) struct Card {
    pub(super) title: &'static str,
    /// The figure with its unit.
    pub(super) figure: String,
    /// The range of the sampled patients in brackets, with a space behind it; empty without it.
    pub(super) brackets: String,
    /// Words beside the figure.
    pub(super) beside: String,
    /// Short name and figure for the phone's row.
    pub(super) short: (&'static str, String),
    /// Band and word; `None` without limits or value.
    pub(super) verdict: Option<Verdict>,
    /// What stands in place of a word without limits.
    pub(super) no_verdict: &'static str,
    /// Numbers of sampled patients by their words, in a line, which takes the place of the other one once the patients are solved.
    pub(super) shares: Option<String>,
    /// Are these the words against practice, each in the tissue of a patient?
    pub(super) is_of_practice: bool,
    pub(super) line: String,
    /// The value on the bar.
    pub(super) value: Option<f64>,
    /// 10th and 90th percentile on the bar.
    pub(super) range: Option<[f64; 2]>,
    /// The median of the band, with its unit.
    pub(super) median: Option<String>,
    pub(super) scale: BarScale,
}

impl Card {
    /// Figure, range and what stands beside them in a line.
    pub(super) fn in_a_line(&self) -> String {
        let figure = format!("{} {}", self.figure, self.brackets);
        let words = self.beside.strip_prefix(&self.brackets).unwrap_or(&self.beside);
        // Another figure follows, not what the first one is.
        let separator = if self.is_of_practice { "; " } else { " " };
        format!("{}{separator}{words}", figure.trim_end())
    }
}

/// The scale of a card's bar.
pub(super) enum BarScale {
    /// Bands of limits, up to a value, with a further mark and its text.
    Bands { limits: Limits, most: f64, in_percent: bool, mark: Option<(f64, String)> },
    /// A part of a whole.
    Part { whole: f64 },
}

/// The stretch of a skin without limits.
const WITHOUT: Limits = Limits {
    quantity: "",
    unit: "",
    bands: Cow::Borrowed(&[bands::Band { limit: None, word: "", level: 0, source: "" }]),
    note: "",
};

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

    /// The range in brackets, as "(4–31) ", in whole units; open at its worse end if more than [`OPEN_ABOVE`] of the patients are missing.
    fn brackets(&self, quantity: Quantity, is_low_worse: bool) -> String {
        let Some((band, findings)) = self.band(quantity).zip(self.0) else { return String::new() };
        let (factor, unit) = quantity.display();
        let ends = [band.p10, band.p90].map(|value| factor * value);
        if unit == "mmHg" && ends[1].round() > texts::MOST_PRESSURE {
            return format!("({}) ", texts::pressures(ends));
        }
        let [low, high] = ends.map(|value| fixed(value, 0));
        match findings.without_answer() > OPEN_ABOVE {
            true if is_low_worse => tr!("(under {low} to {high}) ", low, high),
            true => tr!("({low} to over {high}) ", low, high),
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
        shares::in_words(words, findings.solved() - findings.answers())
    }

    /// The numbers of patients by the word against practice, that of practice's volumes \[ml\] in the tissue of each patient.
    fn shares_of_practice(&self, ml: f64) -> Option<String> {
        let practice = self.0?.practice();
        let words = practice.iter().map(|(strain, practice)| in_words(practice.verdict(*strain)));
        let without_answer = FEW.saturating_sub(practice.len());
        shares::against_practice(words, without_answer, ml).filter(|_| !practice.is_empty())
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

/// The title of a card of an implant or of an expander.
fn title(answer: &Answer, implant: &'static str, expander: &'static str) -> &'static str {
    tr(if answer.is_filled_at_once() { expander } else { implant })
}

fn stretch_card(answer: &Answer, sampled: &Sampled<'_>, word: Option<Verdict>) -> Card {
    let figure = text_of(answer.strain, |v| format!("{:.0} %", 100.0 * v));
    let line = answer.strain.map_or_else(String::new, |_| match answer.reserve {
        Some(_) if answer.is_filled_at_once() => tr(
            "By the skin’s own limits; filled by week the skin grows, which the model leaves out.",
        )
        .to_owned(),
        Some(_) => String::new(),
        None => tr!(
            "{share} of the skin is above {limit:.0} %.",
            share = sampled.in_line(Quantity::AreaOver25, answer.share),
            limit = 100.0 * SHARE_ABOVE.0
        ),
    });
    let brackets = sampled.brackets(Quantity::GreatestStrain, false);
    // Before practice is known the bar has its length, and no limits.
    let is_waiting = answer.against == Against::Waiting;
    let (limits, factor) = if is_waiting { (WITHOUT, 1.0) } else { answer.skin.limits() };
    let is_reserve = !is_waiting && matches!(answer.skin, SkinLimits::Reserve(_));
    let most = if is_waiting { color::MOST_OF_PRACTICE } else { color::most(answer.skin) };
    let of_practice = answer.practice().map(|(practice, ml)| (practice.same, ml));
    let words = match (answer.against, answer.reserve, of_practice) {
        (_, _, Some((strain, ml))) => {
            let percent = 100.0 * strain;
            match answer.has_other_shape {
                true => tr!("practice's {ml:.0} ml, round: {percent:.0} %", ml, percent),
                false => tr!("practice's {ml:.0} ml: {percent:.0} %", ml, percent),
            }
        }
        (Against::Skin(_), Some(share), _) => {
            tr!("longer: {share:.0} % of its reserve", share = 100.0 * share)
        }
        _ => tr("longer, at most").to_owned(),
    };
    let line = match (of_practice, answer.added) {
        (Some(_), _) if answer.is_above_by_shape() => tr(ABOVE_BY_SHAPE).to_owned(),
        (_, Some(added)) => tr!(
            "Longer than skin without tension; than before the operation {added:.0} %.",
            added = 100.0 * added
        ),
        (Some(_), None) => tr("Longer than at rest, where the skin is stretched most.").to_owned(),
        (None, None) => line,
    };
    let mark = of_practice
        .map(|(strain, _)| (strain, tr!("practice {percent:.0} %", percent = 100.0 * strain)));
    let range = sampled.range(Quantity::GreatestStrain);
    let verdict = |value| in_words(limits.verdict(value));
    Card {
        title: title(answer, "Skin stretch", "Stretch, at once"),
        short: (title(answer, "Stretch", "Stretch, at once"), figure.clone()),
        figure,
        beside: format!("{brackets}{words}"),
        brackets,
        verdict: word,
        no_verdict: if is_waiting { "…" } else { "" },
        shares: match (answer.against, is_reserve) {
            (Against::Skin(_), true) => sampled.shares(Quantity::SkinReserveUsed, verdict),
            (Against::Skin(_), false) => sampled.shares(Quantity::GreatestStrain, verdict),
            (Against::Practice(_), _) => {
                answer.practice_ml.and_then(|ml| sampled.shares_of_practice(ml))
            }
            (Against::Waiting, _) => None,
        },
        is_of_practice: of_practice.is_some(),
        line,
        value: answer.strain.map(|strain| factor * strain),
        range: if is_reserve { sampled.range(Quantity::SkinReserveUsed) } else { range },
        median: sampled.median(Quantity::GreatestStrain),
        scale: BarScale::Bands { limits: limits.clone(), most, in_percent: true, mark },
    }
}

fn cover_card(answer: &Answer, sampled: &Sampled<'_>, word: Option<Verdict>) -> Card {
    let line = match (answer.apex, answer.without_muscle) {
        (Some(_), Some(thin)) => tr!(
            "without the muscle {least:.1} mm, {apex:.1} over the highest point",
            least = thin.least,
            apex = thin.apex
        ),
        (Some(apex), None) => {
            tr!(
                "{cover} over the implant's highest point",
                cover = sampled.in_line(Quantity::ApexCoverMm, apex)
            )
        }
        (None, _) if answer.is_layered => String::new(),
        (None, _) => tr("needs “Skin on solid layers” (Advanced)").to_owned(),
    };
    let brackets = sampled.brackets(Quantity::LeastCoverMm, true);
    Card {
        title: tr("Cover over implant"),
        short: (tr("Cover"), text_of(answer.cover, |v| format!("{} mm", fixed(v, 1)))),
        figure: text_of(answer.cover, |v| format!("{} mm", fixed(v, 1))),
        beside: tr!(
            "{brackets}at least; {rest:.1} at rest",
            brackets = &brackets,
            rest = answer.rest
        ),
        brackets,
        verdict: word,
        no_verdict: tr("not thin"),
        shares: sampled.shares(Quantity::LeastCoverMm, |mm| {
            bands::cover(mm).map_or((0, tr("not thin")), in_words)
        }),
        is_of_practice: false,
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
    let line = answer.pressure.map_or_else(String::new, |(mean, most)| {
        if most.round() > texts::MOST_PRESSURE {
            return tr("beyond the studies of living skin").to_owned();
        }
        let pressure = sampled.in_line(Quantity::MeanPressureMmhg, mean);
        tr!("{pressure} on average", pressure)
    });
    let brackets = sampled.brackets(Quantity::GreatestPressureMmhg, false);
    Card {
        title: title(answer, "Pressure on the tissue", "Pressure, at once"),
        short: (title(answer, "Pressure", "Pressure, at once"), figure.clone()),
        figure,
        beside: match answer.suction.round() {
            0.0 => tr!("{brackets}at most", brackets = &brackets),
            suction => {
                tr!("{brackets}at most, {suction} of it suction", brackets = &brackets, suction)
            }
        },
        brackets,
        verdict: word,
        no_verdict: "",
        shares: sampled.shares(Quantity::GreatestPressureMmhg, pressure_verdict),
        is_of_practice: false,
        line,
        value: most,
        range: sampled.range(Quantity::GreatestPressureMmhg),
        median: sampled.median(Quantity::GreatestPressureMmhg),
        scale: BarScale::Bands {
            limits: bands::PRESSURE.clone(),
            most: MOST_PRESSURE,
            in_percent: false,
            mark: None,
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answer::practice::Practices;
    use crate::measure::bands::PracticeStretch;
    use crate::scene::Scene;
    use crate::session::Session;
    use crate::study::{NoPractice, Parameter, with_values};

    #[test]
    fn the_card_names_practices_volume_and_strain_and_marks_it_on_the_bar() {
        let session = Session::new(Scene::opening()).unwrap();
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let practices = Practices::of_known(Scene::opening(), Ok(practice));
        let mut answer = Answer::new(None, session.scene(), session.problem(), &practices);
        answer.strain = Some(0.16);
        let [card, ..] = cards(&answer, None);
        assert_eq!(card.beside, "practice's 300 ml: 21 %");
        assert_eq!(card.in_a_line(), "16 %; practice's 300 ml: 21 %");
        let card = Card {
            brackets: "(9–20) ".to_owned(),
            beside: format!("(9–20) {}", card.beside),
            ..card
        };
        assert_eq!(card.in_a_line(), "16 % (9–20); practice's 300 ml: 21 %");
        assert_eq!((card.verdict, card.value), (Some((0, "below practice")), Some(0.16)));
        let BarScale::Bands { limits, mark, .. } = card.scale else { panic!("no limits") };
        assert_eq!(mark, Some((0.21, "practice 21 %".to_owned())));
        assert_eq!(limits, practice.limits());
    }

    #[test]
    fn a_range_with_patients_without_an_answer_is_open_in_words() {
        let band = |quantity, [p10, p90]: [f64; 2]| Band {
            quantity,
            label: "",
            unit: "",
            scene: None,
            p10,
            p50: 0.5 * (p10 + p90),
            p90,
            text: String::new(),
            scenarios: Vec::new(),
            importance: std::collections::BTreeMap::new(),
            importance_error: None,
        };
        let bands =
            [(Quantity::GreatestStrain, [0.16, 0.23]), (Quantity::LeastCoverMm, [6.0, 9.0])];
        for (without, stretch, cover) in
            [(0, "(16–23) ", "(6–9) "), (3, "(16 to over 23) ", "(under 6 to 9) ")]
        {
            let bands = bands.map(|(quantity, ends)| band(quantity, ends)).to_vec();
            let findings = Findings::of_bands(bands, without);
            let sampled = Sampled::new(Some(&findings));
            assert_eq!(sampled.brackets(Quantity::GreatestStrain, false), stretch);
            assert_eq!(sampled.brackets(Quantity::LeastCoverMm, true), cover);
        }
    }

    #[test]
    fn a_volume_of_practice_above_practice_has_the_shape_as_its_reason() {
        let mut scene = Scene::opening();
        let lines = |scene: &Scene, strain: f64| {
            let session = Session::new(scene.clone()).unwrap();
            let practice = PracticeStretch { less: 0.17, same: 0.19, more: 0.21 };
            let practices = Practices::of_known(scene.clone(), Ok(practice));
            let mut answer = Answer::new(None, scene, session.problem(), &practices);
            answer.strain = Some(strain);
            let [card, ..] = cards(&answer, None);
            (card.beside, card.line == ABOVE_BY_SHAPE)
        };
        let with_volume =
            |scene: &Scene, ml| with_values(scene, &[(Parameter::Volume, ml)]).unwrap();
        let round = with_volume(&scene, 315.0);
        assert_eq!(lines(&round, 0.22), ("practice's 300 ml: 19 %".to_owned(), false));
        scene.implant.base_height_mm = Some(108.0);
        scene.implant.apex_shift_mm = 11.0;
        let anatomical = |ml| with_volume(&scene, ml);
        let beside = "practice's 300 ml, round: 19 %".to_owned();
        assert_eq!(lines(&anatomical(315.0), 0.22), (beside.clone(), true));
        assert_eq!(lines(&anatomical(315.0), 0.20), (beside.clone(), false));
        assert_eq!(lines(&anatomical(345.0), 0.22), (beside, false));
    }

    #[test]
    fn the_bar_of_the_stretch_has_the_same_limits_before_the_result_and_none_before_practice() {
        let session = Session::new(Scene::opening()).unwrap();
        let limits = |practices: &Practices| {
            let answer = Answer::new(None, session.scene(), session.problem(), practices);
            let [card, ..] = cards(&answer, None);
            let BarScale::Bands { limits, most, .. } = card.scale else { panic!("no limits") };
            (limits.bands.len(), most)
        };
        let waiting = limits(&Practices::default());
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let known = limits(&Practices::of_known(Scene::opening(), Ok(practice)));
        assert_eq!((waiting, known), ((1, color::MOST_OF_PRACTICE), (5, color::MOST_OF_PRACTICE)));
        let none = Practices::of_known(Scene::opening(), Err(NoPractice::Volume));
        assert_eq!(limits(&none), (3, color::MOST_RESERVE));
    }
}
