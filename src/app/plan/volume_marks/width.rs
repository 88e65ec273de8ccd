//! The volumes of one width: a curve of solved scenes on a coarse grid, its marks, and the largest volume that stays usual. That
//! volume is found on the curve and checked on the plan's own grid: the plan of that volume is usual.

use super::marks::{Mark, marks};
use crate::app::answer::practice::Against;
use crate::app::frame::studies::{Driver, Studies};
use crate::app::plan::volumes::highest_sold_ml;
use crate::app::texts::tr;
use crate::measure::bands::SkinLimits;
use crate::scene::Scene;
use crate::study::{
    Axis, FirstUsual, Map, MapSettings, Parameter, Quantity, USUAL_STEP_ML, with_values,
};

/// Grid and tolerance of the curve.
pub(super) const SETTINGS: MapSettings = MapSettings { nodes_per_side: 33, tolerance: 1e-3 };
/// Projection / half base width of the greatest volume \[-\]: from 1.36 on a scene may have no answer.
pub(super) const MOST_RATIO: f64 = 1.3;
/// Steps above the volume of the curve from which on volumes are checked: the coarse grid may be too strict.
const STEPS_ABOVE: u32 = 2;

/// The studies of one width.
#[derive(Default)]
pub(super) struct Width {
    curve: Driver<Map>,
    /// The marks of a curve that is solved.
    marks: Option<Vec<Mark>>,
    check: Driver<FirstUsual>,
    /// What the stretches of the marks are compared with.
    against: Option<Against>,
    /// The volumes of the check \[ml\], downwards.
    volumes: Vec<f64>,
}

impl Width {
    /// Starts the volumes of an axis at the width of a scene.
    pub(super) fn start(&mut self, base: &Scene, axis: Axis, studies: &mut Studies) {
        self.cancel(studies);
        if let Ok(curve) = Map::new(base, &[axis], SETTINGS) {
            self.curve.start(curve.with_full_border(), studies);
        }
    }

    pub(super) fn cancel(&mut self, studies: &mut Studies) {
        self.marks = None;
        self.curve.cancel(studies);
        self.check.cancel(studies);
    }

    /// Has the curve these volumes, and every point of the scene? Then the scene becomes that of the curve.
    pub(super) fn move_to(&mut self, base: &Scene, axis: Axis) -> bool {
        let is_equal = |curve: &mut Map| curve.axes() == [axis] && curve.move_to(base);
        self.curve.study_mut().is_some_and(is_equal)
    }

    /// Continues the studies, once a frame. `is_shown`: else nothing is known about the present plan; `against`: what the stretches
    /// are compared with. Returns whether that is another one than in the frame before.
    pub(super) fn advance(
        &mut self,
        studies: &mut Studies,
        is_shown: bool,
        against: Against,
    ) -> bool {
        self.curve.advance(studies);
        let is_other = self.against.replace(against) != Some(against);
        if !is_shown || is_other {
            self.marks = None;
        }
        if is_shown
            && against != Against::Waiting
            && self.marks.is_none()
            && let Some(curve) = self.curve.finished()
        {
            let axis = curve.axes()[0];
            let value = |quantity, i| curve.value(quantity, i, 0);
            let practice = against.practice();
            let limits = |quantity| match (quantity, practice) {
                (Quantity::GreatestStrain, Some(practice)) => {
                    Some(SkinLimits::Practice(practice).limits())
                }
                (quantity, _) => curve.limits(quantity),
            };
            let found = marks(&axis, limits, value);
            let most = highest_sold_ml(&curve.base().implant);
            self.volumes = checked_volumes(&axis, most, &found);
            let plan = |volume: &f64| with_values(curve.base(), &[(Parameter::Volume, *volume)]);
            let plans = self.volumes.iter().map_while(|v| Some((plan(v).ok()?, practice)));
            let plans = plans.collect();
            self.check.start(FirstUsual::new(plans), studies);
            self.marks = Some(found);
        }
        self.check.advance(studies);
        is_other
    }

    /// The curve, once its marks are known.
    pub(super) fn curve(&self) -> Option<&Map> {
        self.curve.study().filter(|_| self.marks.is_some())
    }

    /// The curve, running or solved.
    pub(super) fn any_curve(&self) -> Option<&Map> {
        self.curve.study()
    }

    /// The marks in the order of their volumes; empty while the marks are not known.
    pub(super) fn marks(&self) -> &[Mark] {
        self.marks.as_deref().unwrap_or_default()
    }

    /// The largest volume that stays usual \[ml\], in whole 5 ml, or that none does; `None` while that is not known.
    pub(super) fn largest_ml(&self) -> Option<Option<f64>> {
        let check = self.check.finished().filter(|_| self.marks.is_some())?;
        Some(check.found().and_then(|k| self.volumes.get(k).copied()))
    }

    /// [`Self::largest_ml`] as "360 ml".
    pub(super) fn largest(&self) -> Option<Option<String>> {
        let volume = self.largest_ml()?;
        let most = self.curve().map(|curve| highest_sold_ml(&curve.base().implant));
        Some(volume.map(|volume| {
            let is_highest = most.is_some_and(|most| volume + USUAL_STEP_ML > most);
            let highest = if is_highest { tr(" (the highest profile sold)") } else { "" };
            format!("{volume:.0} ml{highest}")
        }))
    }

    /// Are the volumes fills of an expander, which has no practice?
    pub(super) fn is_of_expander(&self) -> bool {
        self.against == Some(Against::Skin(None))
    }

    /// Are the stretches compared with practice?
    pub(super) fn is_against_practice(&self) -> bool {
        self.against.is_some_and(|against| against.practice().is_some())
    }

    /// The first mark above which no volume has calm words.
    pub(super) fn end(&self) -> Option<&Mark> {
        self.marks().iter().find(|mark| mark.ends_usual())
    }

    /// A width whose studies are done: for tests of what is read from them.
    #[cfg(test)]
    #[allow(clippy::unwrap_used, reason = "a test stops where something is missing")]
    pub(super) fn done(
        base: &Scene,
        axis: Axis,
        marks: Vec<Mark>,
        largest_ml: Option<f64>,
    ) -> Self {
        use crate::study::{Cases, Study, evaluate};
        let mut width = Self { marks: Some(marks), ..Self::default() };
        width.curve.set(Map::new(base, &[axis], SETTINGS).unwrap());
        width.volumes = largest_ml.into_iter().collect();
        // Of any usual plan.
        let plans = vec![(Scene::opening(), None); width.volumes.len()];
        let (mut check, mut store) = (FirstUsual::new(plans), Cases::default());
        while let Some((index, job)) = check.next_job(&mut store) {
            check.receive(index, evaluate(&job), &mut store);
        }
        width.check.set(check);
        width
    }
}

/// The volumes of an axis from a little above the first mark downwards, up to the `most` \[ml\].
fn checked_volumes(axis: &Axis, most: f64, marks: &[Mark]) -> Vec<f64> {
    let whole = |volume: f64| (volume / USUAL_STEP_ML + 1e-9).floor();
    let above = |mark: &Mark| whole(mark.volume_ml) + f64::from(STEPS_ABOVE);
    let first = marks.iter().find(|mark| mark.ends_usual());
    let first = first.map_or(f64::INFINITY, above).min(whole(axis.to.min(most)));
    let count = (first - axis.from / USUAL_STEP_ML).max(-1.0).floor() + 1.0;
    (0..count as usize).map(|k| USUAL_STEP_ML * (first - k as f64)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::plan::volumes::volumes;

    #[test]
    fn volumes_are_checked_from_a_little_above_the_first_mark_down_to_the_least() {
        let axis = volumes(&Scene::opening().implant, MOST_RATIO);
        let quantity = Some(Quantity::GreatestStrain);
        let mark = |volume_ml| Mark { volume_ml, level: Some(1), quantity, word: "high" };
        let volumes = checked_volumes(&axis, f64::INFINITY, &[mark(347.0)]);
        assert_eq!(volumes[..4], [355.0, 350.0, 345.0, 340.0]);
        assert!(volumes.last().is_some_and(|last| (axis.from..axis.from + 5.0).contains(last)));
        let first = |most| checked_volumes(&axis, most, &[]).first().copied();
        assert_eq!(first(f64::INFINITY), Some(axis.to));
        // The highest profile sold on 12 cm has 484 ml: no larger volume is recommended.
        assert_eq!(first(highest_sold_ml(&Scene::opening().implant)), Some(480.0));
        let of = |mark: Mark| checked_volumes(&axis, f64::INFINITY, &[mark]);
        assert_eq!(of(mark(axis.from)).len(), 3);
        assert!(of(mark(axis.from - 40.0)).is_empty());
    }
}
