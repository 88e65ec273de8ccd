//! What differs between the plan and its pins beside the size: name, shape and fill of the implant, skin, pinch, thickness, chest, pocket. The table of the comparison, the
//! report and the captions of the pictures side by side contain only what differs.
//!
//! Uses `plan`, `texts`, `widgets`. Used by `compare`, `viewport`.

use crate::app::plan::device::Device;
use crate::app::plan::when::{tension_in_words, time_in_words};
use crate::app::plan::{
    chest_in_words, fill_in_words, fluid_in_words, plane_in_words, posture_in_words, shape_in_words,
};
use crate::app::texts::{fixed, tr};
use crate::app::widgets::quantity::format_at_most;
use crate::scene::field::TORSO;
use crate::scene::{Field, Scene};
use crate::session::{Pin, Session};

/// A value of a patient or a pocket.
struct Given {
    name: &'static str,
    /// Unit behind the name in a table and behind the value in a sentence; empty for words.
    unit: &'static str,
    /// Value of a scene; a dash without one.
    value: Value,
    /// Does the caption of a picture contain the value? A pinch determines the thickness.
    is_in_captions: bool,
}

/// The value of a scene.
#[derive(Clone, Copy)]
enum Value {
    Words(fn(&Scene) -> String),
    /// The shape, that of an expander under its name.
    Shape,
    Number(Field),
}

use Value::{Number, Shape, Words};

const BREAST: &str = "Breast";

const GIVEN: [Given; 16] = [
    Given { name: BREAST, unit: "", value: Words(side), is_in_captions: true },
    Given { name: "Implant", unit: "", value: Words(reference), is_in_captions: false },
    Given { name: "Shape", unit: "", value: Shape, is_in_captions: false },
    Given { name: "Filled with", unit: "", value: Words(fill_in_words), is_in_captions: true },
    Given { name: "Skin", unit: "", value: Words(skin), is_in_captions: true },
    Given { name: "Pinch", unit: "cm", value: Number(Field::Pinch), is_in_captions: true },
    Given {
        name: "Skin and fat at rest",
        unit: "mm",
        value: Words(thickness),
        is_in_captions: false,
    },
    Given {
        name: "Thickness of the skin",
        unit: "mm",
        value: Words(of_skin),
        is_in_captions: false,
    },
    Given { name: "Skin at rest", unit: "", value: Words(tension_in_words), is_in_captions: true },
    // In the titles of the captions.
    Given {
        name: "Time after the operation",
        unit: "",
        value: Words(time_in_words),
        is_in_captions: false,
    },
    Given { name: "Posture", unit: "", value: Words(posture_in_words), is_in_captions: true },
    Given { name: "Chest", unit: "", value: Words(chest_in_words), is_in_captions: true },
    Given { name: "Margin of the pocket", unit: "cm", value: Words(margin), is_in_captions: true },
    Given {
        name: "Plane of the pocket",
        unit: "",
        value: Words(plane_in_words),
        is_in_captions: true,
    },
    Given {
        name: "New fold lower",
        unit: "cm",
        value: Number(Field::PocketLowered),
        is_in_captions: true,
    },
    Given {
        name: "Fluid in the pocket",
        unit: "",
        value: Words(fluid_in_words),
        is_in_captions: true,
    },
];

fn side(scene: &Scene) -> String {
    scene.side.map_or("–", |side| tr(side.word())).to_owned()
}

/// The maker's name of the implant.
fn reference(scene: &Scene) -> String {
    let reference = &scene.implant_reference;
    if reference.is_empty() { "–".to_owned() } else { reference.clone() }
}

fn skin(scene: &Scene) -> String {
    let measured = scene.measured();
    let scale = scene.layers.first().map_or(1.0, |skin| skin.curve.strain_scale);
    match (measured.skin_class, measured.skin_pull_mm) {
        (Some(class), _) if (scale - class.strain_scale()).abs() < 1e-6 => {
            tr(class.word()).to_owned()
        }
        (None, Some(pull)) => tr!("pull {pull} cm", pull = format_at_most(0.1 * pull, 1, 2)),
        // Set by hand: the factor of the preset's strains.
        _ => format!("× {}", fixed(scale, 2)),
    }
}

fn thickness(scene: &Scene) -> String {
    fixed(scene.tissue_mm(), 1)
}

fn of_skin(scene: &Scene) -> String {
    scene.layers.first().map_or_else(|| "–".to_owned(), |skin| fixed(skin.thickness_mm, 1))
}

fn margin(scene: &Scene) -> String {
    format_at_most(0.1 * (scene.pocket_radius_mm - scene.implant.greatest_half_axis_mm()), 1, 2)
}

impl Given {
    /// A number without code of its own.
    fn of(number: Field) -> Self {
        let value = Number(number);
        Self { name: number.label, unit: number.scale.unit, value, is_in_captions: false }
    }

    fn of_scene(&self, scene: &Scene, device: Device) -> String {
        match self.value {
            Words(words) => words(scene),
            Shape if device == Device::Expander && scene.implant.is_round() => {
                tr("expander").to_owned()
            }
            Shape => shape_in_words(scene),
            Number(number) => {
                let decimals = number.scale.decimals;
                let text = |value| format_at_most(value, decimals, decimals.max(2));
                number.shown(scene).map_or_else(|| "–".to_owned(), text)
            }
        }
    }
}

/// The scenes that are compared: the plan, that of the other side, the pins.
fn compared(session: &Session) -> impl Iterator<Item = &Scene> {
    let pins = session.pins().iter().map(Pin::scene);
    [session.scene()].into_iter().chain(session.scene().other_side.as_deref()).chain(pins)
}

/// The values that differ between the plan, the other side and its pins.
fn differing(session: &Session, device: Device) -> impl Iterator<Item = Given> {
    let differs = move |given: &Given| {
        let own = given.of_scene(session.scene(), device);
        // The columns of both sides have their names.
        let other = session.scene().other_side.as_deref().filter(|_| given.name != BREAST);
        let mut others = session.pins().iter().map(Pin::scene).chain(other);
        others.any(|scene| given.of_scene(scene, device) != own)
    };
    let by_rows = Field::PLAIN.into_iter().chain(TORSO).map(Given::of);
    GIVEN.into_iter().chain(by_rows).filter(differs)
}

/// The values that differ, a row each: the name with the unit, then the plan's value and those of the other side and of the pins.
pub(crate) fn rows(session: &Session, device: Device) -> Vec<(String, Vec<String>)> {
    let row = |given: Given| {
        let name = match given.unit {
            "" => tr(given.name).to_owned(),
            unit => format!("{}, {unit}", tr(given.name)),
        };
        (name, compared(session).map(|scene| given.of_scene(scene, device)).collect())
    };
    differing(session, device).map(row).collect()
}

/// The values that differ, as words about a scene of the session: "Skin tight, pinch 2.5 cm"; empty if none differs.
pub(crate) fn in_words(session: &Session, device: Device) -> impl Fn(&Scene) -> String {
    let given: Vec<Given> =
        differing(session, device).filter(|given| given.is_in_captions).collect();
    move |scene| {
        let words = given.iter().enumerate().map(|(k, given)| {
            let name = tr(given.name);
            let name = if k == 0 { name.to_owned() } else { name.to_lowercase() };
            format!("{name} {} {}", given.of_scene(scene, device), given.unit).trim_end().to_owned()
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::clinical::{Measurements, SkinClass};
    use crate::scene::Side;
    use crate::session::Command;

    #[test]
    fn only_what_differs_between_plan_and_pins_has_a_row_and_words() {
        let mut scene = Scene::opening();
        let tight = Measurements {
            pinch_mm: Some(20.0),
            skin_class: Some(SkinClass::Tight),
            ..Measurements::default()
        };
        scene.apply_patient(tight).unwrap();
        let mut session = Session::new(scene.clone()).unwrap();
        session.apply(Command::Pin).unwrap();
        assert!(rows(&session, Device::Implant).is_empty());
        // A size of the shelf has its name.
        scene.implant_reference = "RD-275 · 275 cc".to_owned();
        let named = Command::Edit { scene: Box::new(scene.clone()), gesture: 2 };
        session.apply(named).unwrap();
        let names = ["RD-275 · 275 cc", "–"].map(str::to_owned).to_vec();
        assert_eq!(rows(&session, Device::Implant), [("Implant".to_owned(), names)]);
        session.apply(Command::Undo).unwrap();
        scene.implant_reference.clear();
        // Another size is in the rows of the table.
        scene.implant.projection_mm = 52.0;
        let edit = |scene: &Scene| Command::Edit { scene: Box::new(scene.clone()), gesture: 1 };
        session.apply(edit(&scene)).unwrap();
        assert!(rows(&session, Device::Implant).is_empty());
        assert_eq!(in_words(&session, Device::Implant)(session.scene()), "");
        let lax = Measurements { skin_class: Some(SkinClass::Lax), ..tight };
        scene.apply_patient(lax).unwrap();
        scene.pocket_radius_mm += 5.0;
        session.apply(edit(&scene)).unwrap();
        let own =
            format_at_most(0.1 * (scene.pocket_radius_mm - scene.implant.base_radius_mm), 1, 2);
        let pinned = margin(session.pins()[0].scene());
        let row =
            |name: &str, values: [&str; 2]| (name.to_owned(), values.map(str::to_owned).to_vec());
        assert_eq!(
            rows(&session, Device::Implant),
            [row("Skin", ["lax", "tight"]), row("Margin of the pocket, cm", [&own, &pinned])]
        );
        let words = in_words(&session, Device::Implant)(session.pins()[0].scene());
        assert_eq!(words, format!("Skin tight, margin of the pocket {pinned} cm"));
        // An anatomical implant has its height beside its width in the captions.
        scene.implant.base_height_mm = Some(108.0);
        session.apply(edit(&scene)).unwrap();
        let shapes = ["anatomical, 10.8 cm high", "round"];
        assert_eq!(rows(&session, Device::Implant)[0], row("Shape", shapes));
        let shapes = ["anatomical, 10.8 cm high", "expander"];
        assert_eq!(rows(&session, Device::Expander)[0], row("Shape", shapes));
        scene.implant.base_height_mm = None;
        // A number without code of its own has a row as it has a name.
        scene.implant.fullness = Some(0.75);
        session.apply(edit(&scene)).unwrap();
        assert!(rows(&session, Device::Implant).contains(&row("Fullness", ["0.75", "0.67"])));
        scene.implant.fullness = None;
        // A pinch has its thicknesses.
        scene.apply_patient(Measurements { pinch_mm: Some(30.0), ..tight }).unwrap();
        scene.pocket_radius_mm -= 5.0;
        session.apply(edit(&scene)).unwrap();
        let names: Vec<String> =
            rows(&session, Device::Implant).into_iter().map(|(name, _)| name).collect();
        assert_eq!(names[0], "Pinch, cm");
        assert!(names.contains(&"Skin and fat at rest, mm".to_owned()), "{names:?}");
        assert_eq!(in_words(&session, Device::Implant)(session.scene()), "Pinch 3.0 cm");
        // Two pictures side by side are not two sides of a patient unless they say so.
        let of_side = |session: &mut Session, scene: &mut Scene, side| {
            scene.side = Some(side);
            session.apply(edit(scene)).unwrap();
        };
        of_side(&mut session, &mut scene, Side::Left);
        assert_eq!(in_words(&session, Device::Implant)(session.scene()), "Pinch 3.0 cm");
        session.apply(Command::Pin).unwrap();
        of_side(&mut session, &mut scene, Side::Right);
        assert_eq!(
            in_words(&session, Device::Implant)(session.scene()),
            "Breast right, pinch 3.0 cm"
        );
    }
}
