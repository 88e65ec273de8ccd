//! The plan as a form: its numbers, its choices and its visit by name, for the form of the page and for scripts. A field has
//! the same limits and the same effect as its control on the screen.

use super::field::{Field, Values};
use super::form_choice::Choice;
use super::{
    Choices, Device, chest, format_at_most, implant, insertion, mm, patient, plain, pocket,
    position, set_insertion, shape, visit,
};
use crate::app::texts::tr;
use crate::app::widgets::Control;
use crate::clinical::Dimension;
use crate::scene::{Field as Row, Scene};

/// A number of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    Size(Dimension),
    /// Height of an anatomical base.
    Height,
    /// A number without code of its own.
    Plain(Row),
    /// Way of an anatomical implant's apex towards the feet.
    Apex,
    Pinch,
    /// Radius of the chest across (0) or along the body (1).
    Chest(usize),
    Margin,
    /// Position along an axis (0: to the side, 1: up).
    Offset(usize),
    InPlace,
    /// Greatest void of a plan that limits it.
    Fluid,
}

/// The numbers of the size by name, in the order of the screen.
const OF_SIZE: [(&str, Number); 4] = [
    ("width_cm", Number::Size(Dimension::BaseWidth)),
    ("height_cm", Number::Height),
    ("volume_ml", Number::Size(Dimension::Volume)),
    ("projection_cm", Number::Size(Dimension::Projection)),
];
/// The numbers after the plain ones.
const OTHERS: [(&str, Number); 10] = [
    ("apex_lower_cm", Number::Apex),
    ("pinch_cm", Number::Pinch),
    ("chest_across_cm", Number::Chest(0)),
    ("chest_along_cm", Number::Chest(1)),
    ("margin_cm", Number::Margin),
    ("fold_lower_cm", Number::Plain(Row::PocketLowered)),
    ("side_cm", Number::Offset(0)),
    ("up_cm", Number::Offset(1)),
    ("in_place_percent", Number::InPlace),
    ("fluid_ml", Number::Fluid),
];
/// The numbers of a torso by name.
const OF_TORSO: [(&str, Number); 6] = [
    ("chest_width_cm", Number::Plain(Row::TorsoChest)),
    ("breast_width_cm", Number::Plain(Row::TorsoBreast)),
    ("notch_nipple_cm", Number::Plain(Row::TorsoNotch)),
    ("nipple_fold_cm", Number::Plain(Row::TorsoFold)),
    ("nipple_nipple_cm", Number::Plain(Row::TorsoNipples)),
    ("breast_volume_ml", Number::Plain(Row::TorsoVolume)),
];

/// The name of a plain number: the last one of its path.
fn name_of(number: Row) -> &'static str {
    number.path.rsplit('.').next().unwrap_or_default()
}

/// The numbers by name, in the order of the screen.
fn numbers() -> impl Iterator<Item = (&'static str, Number)> {
    let plain = Row::PLAIN.map(|number| (name_of(number), Number::Plain(number)));
    OF_SIZE.into_iter().chain(plain).chain(OTHERS).chain(OF_TORSO)
}

/// The fields of the present plan, in the order of the screen.
pub(crate) fn fields(scene: &Scene, choices: &Choices) -> Vec<Field> {
    let mut fields = Vec::new();
    let choices_before =
        |name| Choice::before(name, scene, choices).map(|choice| choice.field(scene));
    for (name, number) in numbers() {
        fields.extend(choices_before(name));
        fields.extend(number.control(scene, choices).map(|(control, value)| {
            let allowed = control.allowed();
            let (text, values) = (
                control.shown(value),
                Values::Numbers { least: *allowed.start(), most: *allowed.end() },
            );
            Field {
                name,
                label: control.label,
                unit: control.unit,
                text,
                hint: choices.device.words(control.tooltip),
                range: tr!(
                    "{least} to {most} {unit}",
                    least = format_at_most(*allowed.start(), 0, 2),
                    most = format_at_most(*allowed.end(), 0, 2),
                    unit = control.unit
                ),
                values,
            }
        }));
    }
    fields.extend(choices_before(""));
    fields.extend(visit::form_fields(scene));
    fields
}

/// The choices of a form: the dimension that follows rules.
fn without_last(choices: &Choices) -> Choices {
    Choices { last: None, ..*choices }
}

/// Sets a field from its text. A number may have a decimal comma and a unit.
///
/// # Errors
/// Returns one line with the field, what is wrong and what is allowed; scene and choices are then unchanged.
pub(crate) fn set(
    scene: &mut Scene,
    choices: &mut Choices,
    name: &str,
    text: &str,
) -> Result<(), String> {
    if let Some(choice) = Choice::named(name, scene, choices) {
        return choice.set(scene, choices, text);
    }
    if let Some(set) = visit::set_form_field(scene, name, text) {
        return set;
    }
    let number = numbers().find(|(known, _)| *known == name);
    let found = number.and_then(|(_, n)| Some((n, n.control(scene, choices)?)));
    let Some((number, (control, before))) = found else {
        let names: Vec<&str> = fields(scene, choices).iter().map(|field| field.name).collect();
        return Err(format!("the plan has no field of this name; allowed: {}", names.join(", ")));
    };
    let value = control.parse(text).map_err(|reason| format!("{}: {reason}", control.label))?;
    // The shown text is rounded: the same text keeps the value.
    if text.trim() != control.shown(before) {
        number.set(scene, choices, value);
    }
    Ok(())
}

impl Number {
    /// The control of the number and its value in the control's unit; `None` if the plan has no such number.
    fn control(self, scene: &Scene, choices: &Choices) -> Option<(Control<'static>, f64)> {
        Some(match self {
            // The fill of an expander raises its dome.
            Self::Size(Dimension::Projection) if choices.device == Device::Expander => return None,
            Self::Size(dimension) => {
                let size = scene.implant.size().ok()?;
                let control = implant::control_of(size, dimension, &without_last(choices));
                (control, implant::value(size, dimension))
            }
            Self::Height | Self::Apex if choices.device == Device::Expander => return None,
            Self::Height => return shape::height(scene, choices),
            Self::Plain(number) => return plain::control(scene, number, choices.device),
            Self::Apex => return shape::apex(scene),
            Self::Pinch => patient::pinch_control(scene, &scene.measured()),
            Self::Chest(axis) => return chest::radius(scene, axis),
            Self::Margin => pocket::margin(scene),
            Self::Offset(axis) => position::offset(scene, axis),
            Self::InPlace => insertion(scene),
            Self::Fluid => return pocket::fluid_control(scene),
        })
    }

    /// Sets the number, in the unit of its control.
    fn set(self, scene: &mut Scene, choices: &mut Choices, value: f64) {
        match self {
            Self::Size(dimension) => {
                *choices = without_last(choices);
                let size = scene.implant.size().ok();
                let size = size.and_then(|size| implant::resized(size, choices, dimension, value));
                if let Some(size) = size {
                    shape::set_size(scene, size);
                }
            }
            Self::Height => shape::set_height(scene, choices, value),
            Self::Plain(number) => plain::set(scene, number, value),
            Self::Apex => shape::set_apex(scene, value),
            Self::Pinch => {
                let mut measured = scene.measured();
                measured.pinch_mm = Some(mm(value));
                patient::measure(scene, measured);
            }
            Self::Chest(axis) => chest::set_radius(scene, axis, value),
            Self::Margin => pocket::set_margin(scene, value),
            Self::Offset(axis) => scene.implant.center_mm[axis] = mm(value),
            Self::InPlace => set_insertion(scene, value),
            Self::Fluid => Row::PocketVoid.set(scene, 0, value),
        }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "stated values hold to the last bit")]
mod tests {
    use super::*;
    use crate::clinical::{SkinClass, When};
    use crate::scene::{ChestShape, Fill, Plane, Posture};

    /// The scene after fields of the opening plan were set.
    fn after(fields: &[(&str, &str)]) -> Scene {
        let (mut scene, mut choices) = (Scene::opening(), Choices::default());
        for (name, text) in fields {
            set(&mut scene, &mut choices, name, text).unwrap();
        }
        scene
    }

    #[test]
    fn the_shown_texts_keep_every_bit_of_the_plan() {
        let (opening, choices) = (Scene::opening(), Choices::default());
        for field in fields(&opening, &choices) {
            assert_eq!(after(&[(field.name, &field.text)]), opening, "{}", field.name);
        }
    }

    #[test]
    fn a_number_of_each_field_becomes_that_of_the_scene() {
        let scene = after(&[("width_cm", "130 mm"), ("volume_ml", "0,35 l")]);
        assert_eq!(scene.implant.base_radius_mm, 65.0);
        let volume = scene.implant.size().unwrap().volume_ml();
        assert!((volume - 350.0).abs() < 1e-9, "{volume}");
        let wide = after(&[("projection_cm", "5")]);
        assert_eq!((wide.implant.base_radius_mm, wide.implant.projection_mm), (60.0, 50.0));
        let full = after(&[("fullness", "0,72")]);
        assert!((full.implant.fullness() - 0.72).abs() < 1e-12);
        let size = full.implant.size().unwrap();
        let opening = Scene::opening().implant.size().unwrap();
        assert!(size.volume_ml() > opening.volume_ml() + 10.0);
        assert_eq!(size.projection_mm(), opening.projection_mm());
        let patient = after(&[("pinch_cm", "3"), ("skin", "lax")]).patient.unwrap().measured;
        assert_eq!((patient.pinch_mm, patient.skin_class), (Some(30.0), Some(SkinClass::Lax)));
        let placed = after(&[("margin_cm", "2"), ("side_cm", "1"), ("up_cm", "−0,5")]);
        assert_eq!((placed.pocket_radius_mm, placed.implant.center_mm), (80.0, [10.0, -5.0]));
        assert_eq!(after(&[("in_place_percent", "40 %")]).insertion, 0.4);
        let shaped =
            after(&[("shape", "anatomical"), ("apex_lower_cm", "2"), ("height_cm", "13,5")]);
        assert_eq!(shaped.implant.base_height_mm, Some(135.0));
        assert_eq!((shaped.implant.apex_shift_mm, shaped.pocket_radius_mm), (20.0, 77.5));
        assert_eq!(after(&[("fill", "soft")]).implant.fill, Some(Fill::Soft));
        assert_eq!(after(&[("fill", "rigid")]).implant.fill, None);
        let lowered = after(&[("fold_lower_cm", "1,4")]);
        assert_eq!(lowered.body.pocket_lowered_mm, 14.0);
        let limited = after(&[("fluid", "limited"), ("fluid_ml", "4")]);
        assert_eq!(limited.body.pocket_void_ml, Some(4.0));
        let free = after(&[("fluid", "limited"), ("fluid", "free")]);
        assert_eq!(free, Scene::opening());
        assert_eq!(after(&[("posture", "lying")]).body.posture, Posture::Lying);
        assert_eq!(after(&[("plane", "dual_2")]).body.plane, Some(Plane::DualPlaneIi));
        assert_eq!(after(&[("plane", "below"), ("plane", "above")]), Scene::opening());
        let tense = after(&[("skin_at_rest", "under_tension")]);
        assert_eq!(tense.body.skin_state.natural_tension_n_per_m, 20.0);
        assert_eq!(after(&[("time", "six_months")]).when(), Some(When::SixMonths));
        assert_eq!(after(&[("time", "week"), ("time", "on_the_table")]), Scene::opening());
        let round = after(&[("shape", "anatomical"), ("shape", "round")]);
        assert!(round.implant.is_round());
        let chest =
            after(&[("chest", "round"), ("chest_along_cm", "30"), ("chest_across_cm", "13,5")]);
        let radii = ChestShape { radius_across_mm: 135.0, radius_along_mm: Some(300.0) };
        assert_eq!(chest.chest, Some(radii));
    }

    #[test]
    fn a_refused_text_changes_nothing() {
        let (mut scene, mut choices) = (Scene::opening(), Choices::default());
        let plain = Row::PLAIN.map(name_of).join(", ");
        let no_field = format!(
            "the plan has no field of this name; allowed: shape, fill, width_cm, volume_ml, projection_cm, {plain}, pinch_cm, skin, \
             skin_at_rest, chest, chest_across_cm, margin_cm, plane, fold_lower_cm, side_cm, up_cm, in_place_percent, fluid, time, posture, reference, side, date, surgeon, remarks"
        );
        for (name, text, words) in [
            ("width_cm", "wide", "Width: “wide” is not a number"),
            ("width_cm", "1e308", "Width: at most 24 cm"),
            ("volume_ml", "NaN", "Volume: “NaN” is not a number"),
            ("pinch_cm", "", "Pinch: enter a number"),
            ("skin", "soft", "Skin feels: allowed: tight, normal, lax, very lax"),
            ("shape", "square", "Implant: allowed: round, anatomical"),
            ("fill", "hard", "Filled with: allowed: form_stable, cohesive, soft, saline, rigid"),
            ("chest", "square", "Chest: allowed: flat, usual, round, torso"),
            ("fluid", "10", "Fluid in the pocket: allowed: free, limited"),
            ("posture", "upright", "Posture: allowed: none, standing, lying"),
            ("plane", "dual", "Plane of the pocket: allowed: above, dual_1, dual_2, dual_3, below"),
            ("skin_at_rest", "20", "Skin at rest: allowed: without_tension, under_tension"),
            ("time", "a year", "Time after the operation: allowed: on_the_table, week, six_months"),
            ("side_cm", "3", "To the side: at most 1.0 cm in this pocket"),
            ("height", "3", &no_field),
            ("side", "up", "Side: allowed: left, right, both, each own, not said"),
            (
                "date",
                "31.1.26",
                "Date of the visit: \"31.1.26\" is no date; allowed: 25.11.2026 or 25/11/2026 (day first), or 2026-11-25",
            ),
        ] {
            assert_eq!(set(&mut scene, &mut choices, name, text).unwrap_err(), words);
        }
        assert_eq!(scene, Scene::opening());
    }

    #[test]
    fn the_visit_is_set_as_on_the_screen() {
        let visit = after(&[
            ("reference", "K. M.\n4711"),
            ("side", "left"),
            ("date", " 2026-01-31 "),
            ("remarks", "one\ntwo"),
        ]);
        assert_eq!(visit.side, Some(crate::scene::Side::Left));
        let visit = visit.visit.unwrap();
        assert_eq!((&*visit.reference, &*visit.date), ("K. M. 4711", "2026-01-31"));
        assert_eq!(visit.remarks, "one\ntwo");
        let long = after(&[("surgeon", &"é".repeat(70))]).visit.unwrap();
        assert_eq!(long.surgeon.chars().count(), 60);
        // Nothing stated is no visit.
        let none = after(&[("side", "right"), ("side", "not said"), ("surgeon", "")]);
        assert_eq!(none, Scene::opening());
    }

    #[test]
    fn an_expander_has_no_projection() {
        let (mut scene, mut choices) = (Scene::opening(), Choices::default());
        choices.device = Device::Expander;
        let names: Vec<&str> = fields(&scene, &choices).iter().map(|field| field.name).collect();
        let without = ["projection_cm", "shape", "fill"];
        assert!(without.iter().all(|name| !names.contains(name)), "{names:?}");
        assert!(set(&mut scene, &mut choices, "projection_cm", "4").is_err());
    }
}
