//! The figures of the answer and their words, and both in a sentence.

use super::practice::{Against, Practices};
use crate::app::texts::{self, tr, word_of};
use crate::clinical::STEP_ML;
use crate::measure::bands::{self, PracticeStretch, SkinLimits};
use crate::measure::{
    CoverWithoutMuscle, MMHG_PER_KPA, Outcome, STRAIN_BANDS, least_thickness_at_rest,
};
use crate::scene::Scene;
use crate::solve::Problem;
use crate::study::Parameter;

/// Strain above which the share of the skin is shown \[-\], and its key in the result.
pub(super) const SHARE_ABOVE: (f64, &str) = (STRAIN_BANDS[0], "0.25");

/// The figures of the answer.
pub(super) struct Answer {
    /// Greatest strain of the skin \[-\].
    pub(super) strain: Option<f64>,
    /// Greatest strain against the skin at rest, of skin under tension or grown \[-\].
    pub(super) added: Option<f64>,
    /// The strain relative to that at which this skin turns steep \[-\].
    pub(super) reserve: Option<f64>,
    /// What the stretch is compared with.
    pub(super) against: Against,
    /// The volume that practice takes \[ml\], if the stretch is compared with practice.
    pub(super) practice_ml: Option<f64>,
    /// Volume of the plan \[ml\].
    volume_ml: Option<f64>,
    /// Is the implant another one than round, as practice's are?
    pub(super) has_other_shape: bool,
    /// The limits of the bar, without a value too: the bar keeps its limits during a solve.
    pub(super) skin: SkinLimits,
    /// Fraction of the skin above [`SHARE_ABOVE`] \[-\].
    pub(super) share: f64,
    /// Least thickness over the implant \[mm\].
    pub(super) cover: Option<f64>,
    /// Thickness over the implant's highest point \[mm\].
    pub(super) apex: Option<f64>,
    /// Both without the muscle, of a pocket below it.
    pub(super) without_muscle: Option<CoverWithoutMuscle>,
    /// Thickness at rest, the least over the implant's base \[mm\].
    pub(super) rest: f64,
    /// Does the tissue have a cover, or is it one sheet?
    pub(super) is_layered: bool,
    /// Mean and greatest contact pressure \[mmHg\].
    pub(super) pressure: Option<(f64, f64)>,
    /// The part of it by which the suction of a void presses the tissue on the implant \[mmHg\].
    pub(super) suction: f64,
}

/// Band, counted from the lowest, and its word.
pub(super) type Verdict = (usize, &'static str);

/// A verdict in the language of the user.
pub(super) fn in_words((band, word): Verdict) -> Verdict {
    (band, tr(word))
}

/// The verdict of a contact pressure \[mmHg\].
pub(super) fn pressure_verdict(mmhg: f64) -> Verdict {
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
        let implant = &scene.implant;
        Self {
            strain: strain.map(|strain| strain.max_principal.max(0.0)),
            added: strain.and_then(|strain| Some(strain.added?.max_principal)),
            reserve,
            against: practices.against(scene),
            practice_ml: practices.volume(scene).map(|volume| volume.volume_ml()),
            volume_ml: Parameter::Volume.value(scene),
            has_other_shape: !scene.implant.is_round(),
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
            without_muscle: cover.and_then(|cover| cover.without_muscle),
            is_layered: scene.is_layered(),
            rest: least_thickness_at_rest(problem, implant.center_mm, implant.base_radius_mm),
            pressure: outcome.and_then(|o| o.contact_pressure_mmhg).map(|p| (p.mean, p.max)),
            suction: outcome.and_then(|o| o.suction_kpa).unwrap_or(0.0) * MMHG_PER_KPA,
        }
    }

    /// The word of the stretch; `None` while practice's volumes are being solved.
    pub(super) fn stretch(&self) -> Option<Verdict> {
        let strain = self.strain.filter(|_| self.against != Against::Waiting)?;
        Some(in_words(bands::stretch_by(self.against.practice(), strain, self.reserve)))
    }

    /// The strain of practice's volume \[-\] with that volume \[ml\].
    pub(super) fn practice(&self) -> Option<(PracticeStretch, f64)> {
        self.against.practice().zip(self.practice_ml)
    }

    /// Is the volume practice's, and the stretch above practice's, because the shape is another one?
    pub(super) fn is_above_by_shape(&self) -> bool {
        let (Some((practice, ml)), Some(volume)) = (self.practice(), self.volume_ml) else {
            return false;
        };
        let is_above = self.strain.is_some_and(|strain| strain > practice.more);
        self.has_other_shape && is_above && (volume - ml).abs() <= STEP_ML
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
    pub(super) fn words(&self) -> [Option<Verdict>; 3] {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::NoPractice;

    #[test]
    fn the_sentence_begins_with_the_worst_word() {
        let answer = |strain, reserve, cover, pressure| Answer {
            strain: Some(strain),
            added: None,
            reserve,
            against: Against::Skin(Some(NoPractice::Volume)),
            practice_ml: None,
            volume_ml: None,
            has_other_shape: false,
            skin: SkinLimits::Tearing,
            share: 0.0,
            cover: Some(cover),
            apex: None,
            without_muscle: None,
            rest: 10.0,
            is_layered: true,
            pressure: Some((0.8 * pressure, pressure)),
            suction: 0.0,
        };
        for (of, sentence) in [
            (
                answer(0.14, Some(0.65), 7.2, 13.0),
                "usual. Stretch 14 %, cover 7.2 mm, pressure 13 mmHg.",
            ),
            (
                answer(0.09, Some(0.9), 7.2, 17.0),
                "skin stretch little reserve. Stretch 9 %, cover 7.2 mm, pressure 17 mmHg.",
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
                "skin stretch little reserve. Stretch 60 %, cover 7.2 mm, pressure 17 mmHg.",
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
        assert_eq!(at_once, "if filled at once, skin stretch little reserve. Stretch");
        let above = PracticeStretch { less: 0.1, same: 0.11, more: 0.12 };
        let above = words(against(Against::Practice(above)));
        assert_eq!(above, "skin stretch above practice. Stretch");
    }
}
