//! Figures and words of the three cards: skin stretch, cover, pressure. Figure and word are the plan's own, with and without sampled
//! patients, on the card, in the sentence and in the report alike; the band of the patients stands in brackets, and the number of patients
//! of each word in a line ([`shares`]).

use super::practice::{Against, Practices};
use super::shares;
use super::uncertainty::{FEW, Findings, figure};
use crate::app::texts::{self, fixed, localized, tr, word_of};
use crate::measure::bands::{self, Limits, PracticeStretch, SkinLimits};
use crate::measure::{Outcome, STRAIN_BANDS};
use crate::scene::Scene;
use crate::solve::Problem;
use crate::study::{Band, Quantity};
use crate::view::color;
use std::borrow::Cow;

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
    /// What the stretch is compared with.
    against: Against,
    /// The volume that practice takes \[ml\], if the stretch is compared with practice.
    practice_ml: Option<f64>,
    /// The limits of the bar, without a value too: the bar keeps its limits during a solve.
    skin: SkinLimits,
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
    pub(super) fn new(
        outcome: Option<&Outcome>,
        scene: &Scene,
        problem: &Problem,
        practices: &Practices,
    ) -> Self {
        let strain = outcome.and_then(|outcome| outcome.strain.as_ref());
        let share = strain.and_then(|s| s.fraction_above.get(SHARE_ABOVE.1)).copied();
        let cover = outcome.and_then(|outcome| outcome.cover_mm);
        let reserve = outcome.and_then(|outcome| outcome.skin_reserve_used);
        Self {
            strain: strain.map(|strain| strain.max_principal.max(0.0)),
            reserve,
            against: practices.against(scene),
            practice_ml: practices.volume(scene).map(|volume| volume.volume_ml()),
            skin: practices.skin(
                scene,
                match strain {
                    Some(_) => reserve.and(problem.skin_knee()),
                    None => problem.skin_knee(),
                },
            ),
            share: share.unwrap_or(0.0),
            cover: cover.map(|cover| cover.least),
            apex: cover.map(|cover| cover.apex),
            is_layered: scene.is_layered(),
            rest: scene.layers.iter().map(|layer| layer.thickness_mm).sum(),
            pressure: outcome.and_then(|o| o.contact_pressure_mmhg).map(|p| (p.mean, p.max)),
        }
    }

    /// The word of the stretch; `None` while practice's volumes are being solved.
    pub(super) fn stretch(&self) -> Option<Verdict> {
        let strain = self.strain.filter(|_| self.against != Against::Waiting)?;
        Some(in_words(bands::stretch_by(self.against.practice(), strain, self.reserve)))
    }

    /// The strain of practice's volume \[-\] with that volume \[ml\].
    fn practice(&self) -> Option<(PracticeStretch, f64)> {
        self.against.practice().zip(self.practice_ml)
    }

    /// Is the plan one of an expander? Its figures and words are those of a fill at once.
    pub(super) fn is_filled_at_once(&self) -> bool {
        self.against == Against::Skin(None)
    }

    /// The word of a plan without a worse one than that of its stretch: against practice, or usual.
    fn calm(&self) -> Option<&'static str> {
        match self.against {
            Against::Practice(_) => self.stretch().map(|(_, word)| word),
            Against::Waiting => None,
            Against::Skin(_) => Some(tr("usual")),
        }
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
        let worst = match worst {
            Some(((_, word), name)) => Some(format!("{name} {word}. ")),
            None => self.calm().map(|word| format!("{word}. ")),
        };
        let at_once = if self.is_filled_at_once() { tr("if filled at once, ") } else { "" };
        let worst = worst.map_or_else(String::new, |words| format!("{at_once}{words}"));
        let figures = [
            self.strain.map(|strain| tr!("stretch {strain:.0} %", strain = 100.0 * strain)),
            self.cover.map(|mm| tr!("cover {mm:.1} mm", mm)),
            self.pressure.map(|(_, most)| tr!("pressure {figure}", figure = texts::pressure(most))),
        ];
        let figures: Vec<String> = figures.into_iter().flatten().collect();
        let figures = figures.join(", ");
        let (first, rest) = figures.split_at(usize::from(!figures.is_empty()));
        format!("{worst}{}{rest}.", first.to_uppercase())
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
            tr!("practice's {ml:.0} ml: {percent:.0} %", ml, percent = 100.0 * strain)
        }
        (Against::Skin(_), Some(share), _) => {
            tr!("longer: {share:.0} % of its reserve", share = 100.0 * share)
        }
        _ => tr("longer, at most").to_owned(),
    };
    let line = match of_practice {
        Some(_) => tr("Longer than at rest, where the skin is stretched most.").to_owned(),
        None => line,
    };
    let mark = of_practice
        .map(|(strain, _)| (strain, tr!("practice {percent:.0} %", percent = 100.0 * strain)));
    let range = sampled.range(Quantity::GreatestStrain);
    let verdict = |value| in_words(limits.verdict(value));
    Card {
        title: title(answer, "Skin stretch", "Stretch if filled at once"),
        short: (title(answer, "Stretch", "Stretch, at once"), figure.clone()),
        figure,
        beside: format!("{brackets}{words}"),
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
    let line = match answer.apex {
        Some(apex) => {
            tr!(
                "{cover} over the implant's highest point",
                cover = sampled.in_line(Quantity::ApexCoverMm, apex)
            )
        }
        None if answer.is_layered => String::new(),
        None => tr("needs “Skin on solid layers” (Advanced)").to_owned(),
    };
    let brackets = sampled.brackets(Quantity::LeastCoverMm, true);
    Card {
        title: tr("Cover over implant"),
        short: (tr("Cover"), text_of(answer.cover, |v| format!("{} mm", fixed(v, 1)))),
        figure: text_of(answer.cover, |v| format!("{} mm", fixed(v, 1))),
        beside: tr!("{brackets}at least; {rest:.1} at rest", brackets, rest = answer.rest),
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
        title: title(answer, "Pressure on the tissue", "Pressure if filled at once"),
        short: (title(answer, "Pressure", "Pressure, at once"), figure.clone()),
        figure,
        beside: tr!("{brackets}at most", brackets),
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
    use crate::session::Session;
    use crate::study::NoPractice;

    #[test]
    fn the_sentence_begins_with_the_worst_word() {
        let answer = |strain, reserve, cover, pressure| Answer {
            strain: Some(strain),
            reserve,
            against: Against::Skin(Some(NoPractice::Volume)),
            practice_ml: None,
            skin: SkinLimits::Tearing,
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
        let practice = PracticeStretch { less: 0.12, same: 0.14, more: 0.16 };
        let against = |against| Answer { against, ..answer(0.14, Some(0.9), 7.2, 13.0) };
        let words = |against| {
            let sentence = Answer::in_a_sentence(&against);
            sentence.split_once(" 14 %").unwrap().0.to_owned()
        };
        assert_eq!(words(against(Against::Practice(practice))), "as practice. Stretch");
        assert_eq!(words(against(Against::Waiting)), "Stretch");
        let at_once = words(against(Against::Skin(None)));
        assert_eq!(at_once, "if filled at once, skin stretch high. Stretch");
        let above = PracticeStretch { less: 0.1, same: 0.11, more: 0.12 };
        let above = words(against(Against::Practice(above)));
        assert_eq!(above, "skin stretch above practice. Stretch");
    }

    #[test]
    fn the_card_names_practices_volume_and_strain_and_marks_it_on_the_bar() {
        let session = Session::new(Scene::opening()).unwrap();
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let practices = Practices::of_known(Scene::opening(), Ok(practice));
        let mut answer = Answer::new(None, session.scene(), session.problem(), &practices);
        answer.strain = Some(0.16);
        let [card, ..] = cards(&answer, None);
        assert_eq!(card.beside, "practice's 300 ml: 21 %");
        assert_eq!((card.verdict, card.value), (Some((0, "below practice")), Some(0.16)));
        let BarScale::Bands { limits, mark, .. } = card.scale else { panic!("no limits") };
        assert_eq!(mark, Some((0.21, "practice 21 %".to_owned())));
        assert_eq!(limits, practice.limits());
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
