//! The largest volume that stays usual, for 8 of 10 sampled patients: computed while the bands are on, after them.

use super::volumes::highest_sold_ml;
use crate::app::frame::studies::{Driver, Studies};
use crate::app::texts::tr;
use crate::scene::Scene;
use crate::study::{
    Axis, BandsSettings, PATIENTS, Parameter, USUAL_STEP_ML, UsualRange, UsualVolumes, with_values,
};

/// The study behind the band.
#[derive(Default)]
pub(crate) struct VolumeBand {
    search: Driver<UsualRange>,
    /// The choices of the search.
    started: Option<BandsSettings>,
}

impl VolumeBand {
    /// Starts, continues or cancels the search, once a frame. `curve`: the scene and the volumes of the curve of one patient, once
    /// that is solved; `practice`: the plan of practice's greatest volume for a scene, if its stretch is compared with practice;
    /// `choices`: those of the bands while they are on, and whether the bands are complete.
    pub(crate) fn advance(
        &mut self,
        curve: Option<(&Scene, Axis)>,
        practice: impl Fn(&Scene) -> Option<Scene>,
        choices: Option<(BandsSettings, bool)>,
        studies: &mut Studies,
        is_busy: bool,
    ) {
        let Some((settings, is_complete)) = choices else { return self.cancel(studies) };
        if self.started.as_ref().is_some_and(|started| *started != settings) {
            self.cancel(studies);
        }
        if self.started.is_none()
            && is_complete
            && let Some((scene, axis)) = curve.filter(|_| !is_busy)
        {
            // Another volume is no other search.
            let least = with_values(scene, &[(Parameter::Volume, axis.from)]).ok();
            let most = axis.to.min(highest_sold_ml(&scene.implant));
            let practice = practice(scene);
            // Whole steps: the volume of the headline is one of them.
            let steps = ((most - axis.from) / USUAL_STEP_ML + 1e-9).floor();
            let ends = (axis.from, axis.from + USUAL_STEP_ML * steps);
            let search = |least| UsualRange::new(&least, &settings, ends, practice.as_ref()).ok();
            if let Some(search) = least.and_then(search) {
                self.search.start(search, studies);
            }
            self.started = Some(settings);
        }
        self.search.advance(studies);
    }

    /// Cancels the search: its curve is another one's, or the bands are off.
    pub(crate) fn cancel(&mut self, studies: &mut Studies) {
        if self.started.take().is_some() {
            self.search.cancel(studies);
        }
    }

    /// The band in brackets, as " (210–280 ml in 8 of 10 patients)"; empty while that is not known.
    pub(crate) fn words(&self) -> String {
        let found = self.search.study().and_then(UsualRange::found);
        found.map_or_else(String::new, |found| {
            tr!(" ({range} in 8 of 10 patients)", range = range(found))
        })
    }

    /// What the band is, for a hover; empty while the band is not known.
    pub(crate) fn about(&self) -> String {
        if self.words().is_empty() {
            return String::new();
        }
        tr!(
            " In brackets: 10th to 90th percentile of {count} sampled patients, in steps of {step} ml; what varies is chosen \
             under Uncertainty.",
            count = PATIENTS,
            step = USUAL_STEP_ML
        )
    }
}

/// The range in words.
fn range(UsualVolumes { low_ml, high_ml, is_open }: UsualVolumes) -> String {
    let more = if is_open { tr(" and more") } else { "" };
    match (low_ml, high_ml) {
        (Some(low), Some(high)) if high > low => format!("{low:.0}–{high:.0} ml{more}"),
        (Some(low), _) => format!("{low:.0} ml{more}"),
        (None, Some(high)) => tr!("none to {high:.0} ml{more}", high, more),
        (None, None) => tr("none").to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_without_a_usual_volume_or_an_end_says_so() {
        let words = |low_ml, high_ml, is_open| range(UsualVolumes { low_ml, high_ml, is_open });
        assert_eq!(words(Some(210.0), Some(280.0), false), "210–280 ml");
        assert_eq!(words(Some(210.0), Some(580.0), true), "210–580 ml and more");
        assert_eq!(words(Some(210.0), Some(210.0), false), "210 ml");
        assert_eq!(words(None, Some(280.0), false), "none to 280 ml");
        assert_eq!(words(None, None, false), "none");
        assert_eq!(VolumeBand::default().words(), "");
    }
}
