//! The plan as a form: its numbers, its choice and its visit by name, for the form of the page and for scripts. A field has
//! the same limits and the same effect as its control on the screen.

use super::field::{Field, Values};
use super::{
    Choices, Device, chest, fill, format_at_most, implant, insertion, mm, patient, plain, pocket,
    position, posture, set_insertion, shape, visit,
};
use crate::app::texts::tr;
use crate::app::widgets::Control;
use crate::clinical::{Dimension, SkinClass};
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

/// The numbers of the size by name, in the order of the screen; the choice of the shape is before the width.
const OF_SIZE: [(&str, Number); 4] = [
    (WIDTH, Number::Size(Dimension::BaseWidth)),
    ("height_cm", Number::Height),
    ("volume_ml", Number::Size(Dimension::Volume)),
    ("projection_cm", Number::Size(Dimension::Projection)),
];
/// The numbers after the plain ones; skin and choice of the chest follow the pinch, the choice of the fluid is before its volume.
const OTHERS: [(&str, Number); 10] = [
    ("apex_lower_cm", Number::Apex),
    (PINCH, Number::Pinch),
    ("chest_across_cm", Number::Chest(0)),
    ("chest_along_cm", Number::Chest(1)),
    ("margin_cm", Number::Margin),
    ("fold_lower_cm", Number::Plain(Row::PocketLowered)),
    ("side_cm", Number::Offset(0)),
    ("up_cm", Number::Offset(1)),
    ("in_place_percent", Number::InPlace),
    (FLUID_ML, Number::Fluid),
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
const WIDTH: &str = "width_cm";
const SHAPE: &str = "shape";
const FILL: &str = "fill";
const PINCH: &str = "pinch_cm";
const SKIN: &str = "skin";
const CHEST: &str = "chest";
const FLUID: &str = "fluid";
const FLUID_ML: &str = "fluid_ml";
const POSTURE: &str = "posture";

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
    for (name, number) in numbers() {
        if name == WIDTH && has_shape(choices) {
            fields.extend([shape_field(scene), fill_field(scene)]);
        }
        fields.extend((name == FLUID_ML && scene.is_layered()).then(|| fluid_field(scene)));
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
        if name == PINCH {
            fields.push(skin(scene));
            fields.extend(scene.is_layered().then(|| chest_field(scene)));
        }
    }
    fields.extend(scene.is_layered().then(|| posture_field(scene)));
    fields.extend(visit::form_fields(scene));
    fields
}

/// The choices of a form: the dimension that follows rules.
fn without_last(choices: &Choices) -> Choices {
    Choices { last: None, ..*choices }
}

/// Has the plan a choice between round and anatomical, and of the fill? An expander has none.
fn has_shape(choices: &Choices) -> bool {
    choices.device == Device::Implant
}

/// A choice of words, each with its name on the screen; `text` is the word of the present one.
fn choice<const N: usize>(
    (name, label): (&'static str, &'static str),
    text: Option<&str>,
    hint: &'static str,
    choices: [(&'static str, &'static str); N],
) -> Field {
    Field {
        name,
        label: tr(label),
        unit: "",
        text: text.unwrap_or_default().to_owned(),
        hint: tr(hint).to_owned(),
        range: String::new(),
        values: Values::Words {
            choices: choices.map(|(word, _)| word).to_vec(),
            words: choices.map(|(_, name)| tr(name)).to_vec(),
        },
    }
}

/// The choice of the implant's shape.
fn shape_field(scene: &Scene) -> Field {
    choice(
        (SHAPE, "Implant"),
        Some(shape::choice(scene)),
        "Shape of the implant: round; anatomical, with a height of its own and a lower apex.",
        shape::CHOICES.map(|(word, _)| (word, word)),
    )
}

/// The choice of the implant's fill; empty for a gel by its numbers.
fn fill_field(scene: &Scene) -> Field {
    choice(
        (FILL, "Filled with"),
        fill::choice(scene),
        "How far the implant yields under the tissue: gel that is form-stable, cohesive or soft, saline, or rigid.",
        fill::CHOICES.map(|(word, _, name, _)| (word, name)),
    )
}

/// The class of the skin; empty with a measured pull or with values set by hand.
fn skin(scene: &Scene) -> Field {
    choice(
        (SKIN, "Skin feels"),
        scene.measured().skin_class.map(SkinClass::word),
        "Class of the skin by how far a pull lifts the skin: tight less than 2 cm, normal 2–3 cm, lax 3–4 cm, \
               very lax more than 4 cm.",
        SkinClass::ALL.map(|class| (class.word(), class.word())),
    )
}

/// The choice of the chest; empty for radii of their own.
fn chest_field(scene: &Scene) -> Field {
    choice(
        (CHEST, "Chest"),
        chest::choice(scene),
        "Curvature of the chest wall: flat; usual, with a radius of 14 cm across the body; round, with 12 cm across and 60 cm along; torso, by what a tape measures.",
        chest::CHOICES.map(|(word, ..)| (word, word)),
    )
}

/// The choice of whether the void of the pocket is limited.
fn fluid_field(scene: &Scene) -> Field {
    choice(
        (FLUID, "Fluid in the pocket"),
        Some(pocket::fluid_choice(scene)),
        "The ring between the implant's rim and the pocket's edge: as large as it gets, or with so much fluid at most.",
        pocket::FLUIDS.map(|(word, name, _)| (word, name)),
    )
}

/// The choice of the posture.
fn posture_field(scene: &Scene) -> Field {
    let words = posture::POSTURES.map(|(posture, word, name, _)| (posture, word, name));
    let present = words.into_iter().find(|(posture, ..)| *posture == scene.body.posture);
    choice(
        (POSTURE, "Posture"),
        present.map(|(_, word, _)| word),
        "Whether weight counts, and in which direction: the tissue was measured standing.",
        words.map(|(_, word, name)| (word, name)),
    )
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
    let chosen = |label, words: &[&str]| {
        let place = words.iter().position(|word| *word == text.trim());
        let refusal =
            || tr!("{label}: allowed: {words}", label = tr(label), words = words.join(", "));
        place.ok_or_else(refusal)
    };
    let is_layered = scene.is_layered();
    match name {
        SKIN => {
            let found = chosen("Skin feels", &SkinClass::ALL.map(SkinClass::word))?;
            let mut measured = scene.measured();
            (measured.skin_class, measured.skin_pull_mm) = (Some(SkinClass::ALL[found]), None);
            patient::measure(scene, measured);
        }
        SHAPE if has_shape(choices) => {
            let found = chosen("Implant", &shape::CHOICES.map(|(word, _)| word))?;
            shape::set_anatomical(scene, choices, found == 1);
        }
        FILL if has_shape(choices) => {
            let found = chosen("Filled with", &fill::CHOICES.map(|(word, ..)| word))?;
            scene.implant.fill = fill::CHOICES[found].1;
        }
        CHEST if is_layered => {
            let found = chosen("Chest", &chest::CHOICES.map(|(word, ..)| word))?;
            chest::CHOICES[found].1.set(scene);
        }
        FLUID if is_layered => {
            let found = chosen("Fluid in the pocket", &pocket::FLUIDS.map(|(word, ..)| word))?;
            pocket::limit_fluid(scene, found == 1);
        }
        POSTURE if is_layered => {
            let found = chosen("Posture", &posture::POSTURES.map(|(_, word, ..)| word))?;
            scene.body.posture = posture::POSTURES[found].0;
        }
        _ => return set_other(scene, choices, name, text),
    }
    Ok(())
}

/// Sets a number or a field of the visit from its text.
fn set_other(
    scene: &mut Scene,
    choices: &mut Choices,
    name: &str,
    text: &str,
) -> Result<(), String> {
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
    use crate::scene::{ChestShape, Fill, Posture};

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
             chest, chest_across_cm, margin_cm, fold_lower_cm, side_cm, up_cm, in_place_percent, fluid, posture, reference, side, date, surgeon, remarks"
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
        let without = ["projection_cm", SHAPE, FILL];
        assert!(without.iter().all(|name| !names.contains(name)), "{names:?}");
        assert!(set(&mut scene, &mut choices, "projection_cm", "4").is_err());
    }
}
