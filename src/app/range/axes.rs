//! The numbers that the range of implants varies: a surgeon's words and units, usual ranges, numbers of values.

use crate::app::plan::is_anatomical;
use crate::app::texts::tr;
use crate::app::widgets::Kind;
use crate::app::widgets::quantity::{format_at_most, significant};
use crate::clinical::{self, Size};
use crate::scene::field::{CM, Scale};
use crate::scene::{Field, Implant, Scene, limits};
use crate::study::{Axis, Parameter, with_values};

/// The numbers on offer, the usual ones first.
pub(super) const FIELDS: [Parameter; 16] = [
    Parameter::BaseWidth,
    Parameter::of(Field::Projection),
    Parameter::Volume,
    Parameter::of(Field::BaseHeight),
    Parameter::of(Field::ApexShift),
    Parameter::PocketMargin,
    Parameter::of(Field::Pinch),
    Parameter::Thickness,
    Parameter::of(Field::StrainScale),
    Parameter::of(Field::StressScale),
    Parameter::PoissonRatio,
    Parameter::of(Field::CenterX),
    Parameter::of(Field::CenterY),
    Parameter::of(Field::Insertion),
    Parameter::of(Field::AttachmentStiffness),
    Parameter::of(Field::ChestAcross),
];

const VOLUME: Scale = Scale { unit: "ml", factor: 1.0, step: 5.0, decimals: 0 };

/// How an axis is displayed.
#[derive(Clone, Copy)]
pub(super) struct Words {
    pub(super) name: &'static str,
    pub(super) kind: Kind,
    pub(super) unit: &'static str,
    /// Displayed number per value.
    pub(super) factor: f64,
    /// Values of an axis are multiples of this step where the range allows \[displayed unit\].
    step: f64,
    /// Most decimals of a displayed value.
    decimals: usize,
}

impl Words {
    pub(super) fn of(field: Parameter) -> Self {
        let (row, _) = field.row();
        let (name, scale) = match field {
            Parameter::BaseWidth => (tr(row.label), CM),
            Parameter::Volume => (tr("Volume"), VOLUME),
            Parameter::PocketMargin => (tr("Margin of the pocket"), CM),
            Parameter::Thickness => (tr("Thickness of the cover"), CM),
            // Words that the heading of a control has on the plan.
            Parameter::Number(Field::CenterX, _) => (tr("Position, to the side"), CM),
            Parameter::Number(Field::CenterY, _) => (tr("Position, up"), CM),
            Parameter::Number(Field::ChestAcross, _) => (tr("Radius of the chest"), CM),
            Parameter::PoissonRatio | Parameter::Number(..) => (tr(row.label), row.scale),
        };
        // A grid may be finer than the steps of a slider.
        let (step, decimals) = match scale.unit {
            "cm" | "" => (0.5 * scale.step, scale.decimals + 1),
            "kPa/mm" => (scale.step, scale.decimals + 1),
            _ => (scale.step, scale.decimals),
        };
        Self {
            name,
            kind: Kind::of_unit(scale.unit),
            unit: scale.unit,
            factor: scale.factor,
            step,
            decimals,
        }
    }

    /// A value as displayed, without unit.
    pub(super) fn number(&self, value: f64) -> String {
        format_at_most(self.display(value), 0, self.decimals)
    }

    /// A value with its unit.
    pub(super) fn text(&self, value: f64) -> String {
        format!("{} {}", self.number(value), self.unit).trim_end().to_owned()
    }

    /// Name and unit.
    pub(super) fn title(&self) -> String {
        if self.unit.is_empty() {
            self.name.to_owned()
        } else {
            format!("{} ({})", self.name, self.unit)
        }
    }

    pub(super) fn display(&self, value: f64) -> f64 {
        significant(value * self.factor)
    }

    pub(super) fn value(&self, displayed: f64) -> f64 {
        significant(displayed / self.factor)
    }
}

/// Sizes at both sides of the plan's own \[mm\]; the middle is a multiple of [`ROUND_MM`].
pub(super) const AROUND_MM: f64 = 20.0;
const ROUND_MM: f64 = 5.0;

/// The implant in the middle of the chart of a plan.
pub(super) fn middle(implant: Implant) -> Implant {
    let round = |value: f64| ROUND_MM * (value / ROUND_MM).round();
    let mut middle = Implant { projection_mm: round(implant.projection_mm), ..implant };
    middle.set_base_radius(0.5 * round(2.0 * implant.base_radius_mm));
    middle
}

/// Sizes around the one in the middle, within the limits.
fn around(middle: f64, (least, most): (f64, f64)) -> (f64, f64) {
    ((middle - AROUND_MM).max(least), (middle + AROUND_MM).min(most))
}

/// The range of an axis until another one is typed: sizes around an implant, the usual values of other numbers, and the
/// present value.
pub(super) fn usual(field: Parameter, scene: &Scene, of: Implant) -> (f64, f64) {
    let thickness = scene.tissue_mm();
    let skin = scene.layers.first().map_or(0.0, |skin| skin.thickness_mm);
    let (least, most) = match field {
        Parameter::BaseWidth => around(2.0 * of.base_radius_mm, allowed(field)),
        Parameter::Number(Field::Projection, _) => around(of.projection_mm, allowed(field)),
        // These projections on the base in the middle.
        Parameter::Volume => {
            let (least, most) = around(of.projection_mm, allowed(Parameter::of(Field::Projection)));
            let round = |projection_mm: f64| {
                let size = Implant { projection_mm, ..of }.size();
                (size.map_or(0.0, Size::volume_ml) / 50.0).round().max(1.0) * 50.0
            };
            (round(least), round(most).max(round(least) + 100.0))
        }
        Parameter::Number(Field::BaseHeight, _) => {
            let width = Scene { implant: of, ..scene.clone() };
            around(of.base_height(), field.row().0.range(&width))
        }
        Parameter::Number(Field::ApexShift, _) => (0.0, 0.4 * (0.5 * of.base_height())),
        Parameter::PocketMargin => (0.0, 30.0),
        Parameter::Number(Field::Pinch, _) => (10.0, 50.0),
        Parameter::Thickness => ((skin + 2.0).max(4.0), thickness.max(30.0)),
        Parameter::Number(Field::StrainScale, _) => (0.5, 2.0),
        Parameter::Number(Field::StressScale, _) => (0.4, 2.5),
        Parameter::PoissonRatio => (0.3, 0.49),
        Parameter::Number(Field::CenterX | Field::CenterY, _) => {
            let room = scene.room_mm().max(5.0);
            (-room, room)
        }
        Parameter::Number(Field::Insertion, _) => (0.2, 1.0),
        Parameter::Number(Field::AttachmentStiffness, _) => (0.5, 10.0),
        Parameter::Number(Field::ChestAcross, _) => {
            let least = (scene.least_chest_radius_mm(false) / 10.0).ceil() * 10.0;
            (least, (2.0 * least).max(250.0))
        }
        Parameter::Number(number, _) => number.limits,
    };
    match field.value(scene) {
        // A number that the range determines itself.
        Some(_) if matches!(field.row().0, Field::CenterX | Field::CenterY) => (least, most),
        Some(value) => (least.min(value), most.max(value)),
        None => (least, most),
    }
}

/// The values that may be typed.
pub(super) fn allowed(field: Parameter) -> (f64, f64) {
    match field {
        Parameter::BaseWidth => clinical::limits::BASE_WIDTH_MM,
        Parameter::Volume => (10.0, 5000.0),
        Parameter::PocketMargin => (0.0, limits::POCKET_RADIUS_MAX_MM),
        Parameter::Thickness => (0.5, 8.0 * Field::Thickness.limits.1),
        Parameter::Number(Field::ChestAcross, _) => (50.0, 10_000.0),
        _ => field.row().0.limits,
    }
}

/// Does the number vary in this scene? A sheet has no attachment, a round implant no height, and a pinch may have no effect.
pub(super) fn applies(field: Parameter, scene: &Scene) -> bool {
    let is_shape = matches!(field.row().0, Field::BaseHeight | Field::ApexShift);
    if is_shape && !is_anatomical(&scene.implant) {
        return false;
    }
    let (least, most) = usual(field, scene, scene.implant);
    with_values(scene, &[(field, 0.5 * (least + most))]).is_ok()
}

/// An axis of about `target` values, whose step is round where the range allows.
pub(super) fn axis(field: Parameter, (from, to): (f64, f64), target: usize) -> Axis {
    let words = Words::of(field);
    let range = words.factor * (to - from).abs();
    let is_round = |step: f64, unit: f64| {
        let steps = step / unit;
        steps >= 0.5 && (steps - steps.round()).abs() < 1e-6
    };
    let most = if target > 40 { target } else { target + target / 2 };
    let mut counts: Vec<usize> = (target * 3 / 4..=most).collect();
    counts.sort_by_key(|count| count.abs_diff(target));
    let units = [20.0, 10.0, 5.0, 2.0, 1.0].map(|multiple| multiple * words.step);
    let round = units.into_iter().find_map(|unit| {
        counts.iter().copied().find(|count| is_round(range / (count - 1) as f64, unit))
    });
    Axis { field, from, to, count: round.unwrap_or(target) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Map, MapSettings};

    #[test]
    fn usual_axes_have_round_steps_and_maps() {
        let mut scene = Scene::opening();
        scene.implant.base_height_mm = Some(108.0);
        for target in [20, 40, 60] {
            for field in FIELDS {
                assert!(applies(field, &scene), "{}", field.name());
                let (from, to) = usual(field, &scene, middle(scene.implant));
                let (least, most) = allowed(field);
                assert!(least <= from && to <= most, "{}", field.name());
                let axis = axis(field, (from, to), target);
                assert!((target * 3 / 4..=60).contains(&axis.count), "{axis:?}");
                Map::new(&scene, &[axis], MapSettings::default()).unwrap();
            }
        }
        scene = Scene::opening();
        let step = |field| {
            let axis = axis(field, usual(field, &scene, middle(scene.implant)), 20);
            significant((axis.to - axis.from) / (axis.count - 1) as f64)
        };
        let fields = [Parameter::BaseWidth, Parameter::of(Field::Projection), Parameter::Volume];
        for (step, expected) in fields.map(step).into_iter().zip([2.5, 2.5, 20.0]) {
            assert!((step - expected).abs() < 1e-9, "{step}");
        }
    }

    #[test]
    fn sizes_lie_two_centimetres_around_the_plan_within_their_limits() {
        let ends = |width: f64, projection: f64| {
            let mut scene = Scene::opening();
            scene.implant.base_radius_mm = 0.5 * width;
            scene.implant.projection_mm = projection;
            let of = |field| usual(field, &scene, middle(scene.implant));
            (of(Parameter::BaseWidth), of(Parameter::of(Field::Projection)))
        };
        assert_eq!(ends(120.0, 40.0), ((100.0, 140.0), (20.0, 60.0)));
        assert_eq!(ends(122.4, 42.6), ((100.0, 140.0), (25.0, 65.0)));
        assert_eq!(ends(25.0, 3.0), ((20.0, 45.0), (2.0, 25.0)));
        assert_eq!(ends(239.0, 119.0), ((220.0, 240.0), (100.0, 120.0)));
    }

    #[test]
    fn values_are_displayed_in_centimetres_and_back() {
        let words = Words::of(Parameter::BaseWidth);
        assert_eq!(
            (words.text(120.0), words.number(83.5)),
            ("12 cm".to_owned(), "8.35".to_owned())
        );
        assert!((words.value(words.display(83.7)) - 83.7).abs() < 1e-9);
        assert_eq!(Words::of(Parameter::PoissonRatio).text(0.45), "0.45");
        assert_eq!(Words::of(Parameter::of(Field::Insertion)).text(0.35), "35 %");
    }

    #[test]
    fn a_sheet_has_no_attachment() {
        assert!(!applies(Parameter::of(Field::AttachmentStiffness), &Scene::sheet()));
        assert!(applies(Parameter::BaseWidth, &Scene::sheet()));
        assert!(!applies(Parameter::of(Field::BaseHeight), &Scene::opening()));
    }
}
