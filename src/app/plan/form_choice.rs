//! The choices of the plan's form: their places among its numbers, their words, and how each is read and set.

use super::device::Device;
use super::field::{Field, Values};
use super::{Choices, chest, fill, patient, pocket, posture, shape, when};
use crate::app::texts::tr;
use crate::clinical::SkinClass;
use crate::scene::Scene;

/// A word of a choice and its name on the screen.
type Word = (&'static str, &'static str);

/// The plans that have a choice.
enum Of {
    Any,
    /// An expander has no shape and no fill.
    Implants,
    Layers,
}

/// A choice of words.
pub(super) struct Choice {
    name: &'static str,
    label: &'static str,
    hint: &'static str,
    of: Of,
    words: fn() -> Vec<Word>,
    /// The word of a plan; `None` of one with numbers of its own.
    present: fn(&Scene) -> Option<&'static str>,
    /// Sets the choice to a word by its number.
    set: fn(&mut Scene, &mut Choices, usize),
}

/// The choices before a number, by the number's name, in the order of the screen; the last ones are after all numbers.
const PLACES: [(&str, &[Choice]); 5] = [
    ("width_cm", &[SHAPE, FILL]),
    ("chest_across_cm", &[SKIN, SKIN_AT_REST, CHEST]),
    ("fold_lower_cm", &[PLANE]),
    ("fluid_ml", &[FLUID]),
    ("", &[TIME, POSTURE]),
];

const SHAPE: Choice = Choice {
    name: "shape",
    label: "Implant",
    hint: "Shape of the implant: round; anatomical, with a height of its own and a lower apex.",
    of: Of::Implants,
    words: || shape::CHOICES.map(|(word, _)| (word, word)).to_vec(),
    present: |scene| Some(shape::choice(scene)),
    set: |scene, choices, k| shape::set_anatomical(scene, choices, k == 1),
};

const FILL: Choice = Choice {
    name: "fill",
    label: "Filled with",
    hint: "How far the implant yields under the tissue: gel that is form-stable, cohesive or soft, saline, or rigid.",
    of: Of::Implants,
    words: || fill::CHOICES.map(|(word, _, name, _)| (word, name)).to_vec(),
    present: fill::choice,
    set: |scene, _, k| scene.implant.fill = fill::CHOICES[k].1,
};

const SKIN: Choice = Choice {
    name: "skin",
    label: "Skin feels",
    hint: "Class of the skin by how far a pull lifts the skin: tight less than 2 cm, normal 2–3 cm, lax 3–4 cm, \
               very lax more than 4 cm.",
    of: Of::Any,
    words: || SkinClass::ALL.map(|class| (class.word(), class.word())).to_vec(),
    // None of a measured pull or of values set by hand.
    present: |scene| scene.measured().skin_class.map(SkinClass::word),
    set: |scene, _, k| {
        let mut measured = scene.measured();
        (measured.skin_class, measured.skin_pull_mm) = (Some(SkinClass::ALL[k]), None);
        patient::measure(scene, measured);
    },
};

const SKIN_AT_REST: Choice = Choice {
    name: "skin_at_rest",
    label: "Skin at rest",
    hint: when::ABOUT_TENSION,
    of: Of::Layers,
    words: || when::AT_REST.to_vec(),
    present: |scene| Some(when::AT_REST[usize::from(when::is_tense(scene))].0),
    set: |scene, _, k| when::set_tense(scene, k == 1),
};

const CHEST: Choice = Choice {
    name: "chest",
    label: "Chest",
    hint: "Curvature of the chest wall: flat; usual, with a radius of 14 cm across the body; round, with 12 cm across and 60 cm along; torso, by what a tape measures.",
    of: Of::Layers,
    words: || chest::CHOICES.map(|(word, ..)| (word, word)).to_vec(),
    present: chest::choice,
    set: |scene, _, k| chest::CHOICES[k].1.set(scene),
};

const PLANE: Choice = Choice {
    name: "plane",
    label: "Plane of the pocket",
    hint: "Whether a muscle covers the implant: none above it; below it all of the implant, in a dual plane its upper part.",
    of: Of::Layers,
    words: || pocket::PLANES.map(|(plane, word, ..)| (word, pocket::words_of(plane))).to_vec(),
    present: |scene| {
        let mut planes = pocket::PLANES.into_iter();
        planes.find(|(plane, ..)| *plane == scene.body.plane).map(|(_, word, ..)| word)
    },
    set: |scene, _, k| scene.set_plane(pocket::PLANES[k].0),
};

const FLUID: Choice = Choice {
    name: "fluid",
    label: "Fluid in the pocket",
    hint: "The ring between the implant's rim and the pocket's edge: as large as it gets, or with so much fluid at most.",
    of: Of::Layers,
    words: || pocket::FLUIDS.map(|(word, name, _)| (word, name)).to_vec(),
    present: |scene| Some(pocket::fluid_choice(scene)),
    set: |scene, _, k| pocket::limit_fluid(scene, k == 1),
};

const TIME: Choice = Choice {
    name: "time",
    label: "Time after the operation",
    hint: "What has relaxed of the skin's tension, and grown of its stretch, since the operation.",
    of: Of::Layers,
    words: || when::TIMES.map(|(_, word, name, _)| (word, name)).to_vec(),
    present: |scene| {
        let present = scene.when()?;
        when::TIMES.into_iter().find(|(time, ..)| *time == present).map(|(_, word, ..)| word)
    },
    set: |scene, _, k| *scene = scene.at(when::TIMES[k].0),
};

const POSTURE: Choice = Choice {
    name: "posture",
    label: "Posture",
    hint: "Whether weight counts, and in which direction: the tissue was measured standing.",
    of: Of::Layers,
    words: || posture::POSTURES.map(|(_, word, name, _)| (word, name)).to_vec(),
    present: |scene| {
        let mut postures = posture::POSTURES.into_iter();
        postures.find(|(posture, ..)| *posture == scene.body.posture).map(|(_, word, ..)| word)
    },
    set: |scene, _, k| scene.body.posture = posture::POSTURES[k].0,
};

impl Choice {
    /// The choices of a plan before a number.
    pub(super) fn before(
        number: &str,
        scene: &Scene,
        choices: &Choices,
    ) -> impl Iterator<Item = &'static Self> {
        let place = PLACES.iter().find(|(name, _)| *name == number);
        let of = place.map_or(&[][..], |(_, of)| of).iter();
        let (is_implant, is_layered) = (choices.device == Device::Implant, scene.is_layered());
        of.filter(move |choice| match choice.of {
            Of::Any => true,
            Of::Implants => is_implant,
            Of::Layers => is_layered,
        })
    }

    /// The choice of a plan by its name.
    pub(super) fn named(name: &str, scene: &Scene, choices: &Choices) -> Option<&'static Self> {
        let mut all = PLACES.iter().flat_map(|(number, _)| Self::before(number, scene, choices));
        all.find(|choice| choice.name == name)
    }

    /// The field of a plan.
    pub(super) fn field(&self, scene: &Scene) -> Field {
        let words = (self.words)();
        Field {
            name: self.name,
            label: tr(self.label),
            unit: "",
            text: (self.present)(scene).unwrap_or_default().to_owned(),
            hint: tr(self.hint).to_owned(),
            range: String::new(),
            values: Values::Words {
                choices: words.iter().map(|(word, _)| *word).collect(),
                words: words.iter().map(|(_, name)| tr(name)).collect(),
            },
        }
    }

    /// Sets the choice from its word.
    ///
    /// # Errors
    /// One line with the allowed words.
    pub(super) fn set(
        &self,
        scene: &mut Scene,
        choices: &mut Choices,
        text: &str,
    ) -> Result<(), String> {
        let words: Vec<&str> = (self.words)().into_iter().map(|(word, _)| word).collect();
        let place = words.iter().position(|word| *word == text.trim());
        let refusal =
            || tr!("{label}: allowed: {words}", label = tr(self.label), words = words.join(", "));
        (self.set)(scene, choices, place.ok_or_else(refusal)?);
        Ok(())
    }
}
