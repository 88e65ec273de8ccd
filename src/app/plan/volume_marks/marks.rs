//! The volumes along a curve above which the word of a card changes, and above which the model has no answer.

use crate::app::plan::volumes::COUNT;
use crate::app::texts::{tr, word_of};
use crate::measure::bands::{self, Limits, SkinLimits};
use crate::study::{Axis, Quantity};

/// The quantities of the cards with limits.
const QUANTITIES: [Quantity; 2] = [Quantity::GreatestStrain, Quantity::GreatestPressureMmhg];

/// A volume \[ml\] above which the word of a quantity changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Mark {
    pub(super) volume_ml: f64,
    /// Level of the band above the volume, 0 for a calm word; `None`: no answer.
    pub(super) level: Option<usize>,
    /// The quantity of the card; `None`: no answer.
    pub(super) quantity: Option<Quantity>,
    /// The word of the band.
    pub(super) word: &'static str,
}

impl Mark {
    /// Does no volume above the mark have calm words?
    pub(super) fn ends_usual(&self) -> bool {
        self.level != Some(0)
    }

    /// The mark in words.
    pub(super) fn words(&self) -> String {
        let name = match self.quantity {
            Some(Quantity::GreatestPressureMmhg) => "pressure",
            Some(Quantity::LeastCoverMm) => "cover",
            Some(_) => "skin stretch",
            None => "the model has",
        };
        let limits = self.quantity.and_then(|quantity| quantity.limits(SkinLimits::Tearing));
        let word = limits.map_or(tr(self.word), |(limits, _)| word_of(&limits, self.word));
        format!("{} {word}", tr(name))
    }
}

/// The volumes at which the quantities exceed their limits and the answers end, in their order. `limits`: those of a quantity,
/// and the factor from a value to their unit; `value`: a quantity at a volume of the axis; `None` without an answer.
pub(super) fn marks(
    axis: &Axis,
    limits: impl Fn(Quantity) -> Option<(Limits, f64)>,
    value: impl Fn(Quantity, usize) -> Option<f64>,
) -> Vec<Mark> {
    let point = |quantity: Quantity, i: usize| Some([axis.value(i), value(quantity, i)?]);
    let mut marks = Vec::new();
    for quantity in QUANTITIES {
        let Some((limits, factor)) = limits(quantity) else { continue };
        let line: Vec<[f64; 2]> = (0..COUNT).filter_map(|i| point(quantity, i)).collect();
        for (k, limit) in limits.bands.iter().filter_map(|band| band.limit).enumerate() {
            if let Some(volume_ml) = crossing(&line, limit / factor) {
                let band = limits.bands[k + 1];
                let (level, quantity) = (Some(band.level), Some(quantity));
                marks.push(Mark { volume_ml, level, quantity, word: band.word });
            }
        }
    }
    // A cover that gets thin.
    let line: Vec<[f64; 2]> = (0..COUNT)
        .filter_map(|i| point(Quantity::LeastCoverMm, i).map(|[volume, cover]| [volume, -cover]))
        .collect();
    if let Some(volume_ml) = crossing(&line, -bands::THIN_COVER_MM) {
        let quantity = Some(Quantity::LeastCoverMm);
        marks.push(Mark { volume_ml, level: Some(1), quantity, word: "thin" });
    }
    // Between the last volume with an answer and the next one.
    let last = (0..COUNT).rev().find_map(|i| Some((i, point(Quantity::GreatestStrain, i)?[0])));
    if let Some((_, volume)) = last.filter(|(i, _)| i + 1 < COUNT) {
        let volume_ml = volume + 0.5 * (axis.value(1) - axis.value(0));
        marks.push(Mark { volume_ml, level: None, quantity: None, word: "no answer" });
    }
    marks.sort_by(|a, b| a.volume_ml.total_cmp(&b.volume_ml));
    marks
}

/// The first place where a polyline exceeds a limit; its start if it begins above.
fn crossing(line: &[[f64; 2]], limit: f64) -> Option<f64> {
    let first = line.iter().position(|point| point[1] > limit)?;
    let [x, y] = line[first];
    let Some(&[before, value]) = first.checked_sub(1).map(|k| &line[k]) else { return Some(x) };
    Some(before + (x - before) * (limit - value) / (y - value))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::plan::volume_marks::width::{MOST_RATIO, SETTINGS};
    use crate::app::plan::volumes::volumes;
    use crate::clinical::Size;
    use crate::measure::Outcome;
    use crate::scene::{Scene, TissueModel};
    use crate::simulate::simulate;

    #[test]
    fn a_line_exceeds_a_limit_between_its_points() {
        let line = [[100.0, 0.1], [200.0, 0.2], [300.0, 0.4]];
        assert_eq!(crossing(&line, 0.05), Some(100.0));
        assert!((crossing(&line, 0.25).unwrap() - 225.0).abs() < 1e-9);
        assert_eq!(crossing(&line, 0.4), None);
        assert_eq!(crossing(&[], 0.4), None);
    }

    #[test]
    fn the_marks_separate_the_words_of_single_solves() {
        let mut scene = Scene::opening();
        scene.set_tissue_model(TissueModel::Sheet);
        let width = 2.0 * scene.implant.base_radius_mm;
        let axis = volumes(&scene.implant, MOST_RATIO);
        let solved = |volume: f64, nodes: usize| {
            let mut scene = scene.clone();
            scene.solver.nodes_per_side = nodes;
            let size = Size::of_width_and_volume(width, volume).unwrap();
            scene.implant.projection_mm = size.projection_mm();
            simulate(&scene).unwrap()
        };
        let curve: Vec<Outcome> =
            axis.values().iter().map(|v| solved(*v, SETTINGS.nodes_per_side)).collect();
        let limits = |quantity: Quantity| quantity.limits(SkinLimits::of_skin(scene.skin_knee()));
        let marks = marks(&axis, limits, |quantity, i| quantity.of(&curve[i]));
        let of_stretch = |mark: &&Mark| mark.quantity == Some(Quantity::GreatestStrain);
        assert!(marks.iter().filter(of_stretch).count() >= 2, "{marks:?}");
        for mark in &marks {
            let Some((level, quantity)) = mark.level.zip(mark.quantity) else { continue };
            let (limits, factor) = limits(quantity).unwrap();
            // A sheet has no cover: a level is the place of its band.
            for (share, expected) in [(0.97, level - 1), (1.03, level)] {
                let value = quantity.of(&solved(share * mark.volume_ml, 129)).unwrap();
                assert_eq!(limits.band(factor * value), expected, "{mark:?}: {value}");
            }
        }
    }

    #[test]
    fn the_answers_end_between_the_last_volume_with_one_and_the_next() {
        let axis = volumes(&Scene::opening().implant, 1.0);
        let end = |count: usize| {
            let value = |quantity| if quantity == Quantity::LeastCoverMm { 10.0 } else { 0.1 };
            marks(
                &axis,
                |quantity| quantity.limits(SkinLimits::Tearing),
                |quantity, i| (i < count).then_some(value(quantity)),
            )
        };
        assert_eq!(end(COUNT), []);
        let found = end(10);
        assert!(found.len() == 1 && found[0].level.is_none(), "{found:?}");
        assert!(axis.value(9) < found[0].volume_ml && found[0].volume_ml < axis.value(10));
    }
}
