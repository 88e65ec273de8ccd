//! The state of the skin: its natural tension at rest, and what has relaxed of the tension above it.

use super::{Field, Layer, Scene, SceneError, TissueModel, out_of_range};
use crate::clinical::When;
use crate::curve::{number, present};
use crate::mesh::NaturalStretch;
use crate::springs::Material;
use crate::springs::coupled::equivalent_strain;
use crate::springs::tension_field::strain_of;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Tension of the skin of layered tissue at rest, and relaxation of the tension above it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct SkinState {
    /// Nominal tension of the skin at rest, force per width of skin without stress, mean of all directions \[N/m\], 0 to 300.
    #[serde(deserialize_with = "present")]
    pub natural_tension_n_per_m: f64,
    /// Tension along `direction_deg` / tension across it \[-\], 1 to 3.
    #[serde(deserialize_with = "present")]
    pub anisotropy: f64,
    /// Direction of the greatest tension, from x (the patient's side) to y (the head) \[°\], −180 to 180.
    #[serde(deserialize_with = "present")]
    pub direction_deg: f64,
    /// What is left of the tension above the natural one after relaxation \[-\], 0.05 to 1.
    #[serde(deserialize_with = "present")]
    pub relaxed: f64,
    /// Fraction of the skin's logarithmic stretch by the implant that growth takes over \[-\], 0 to 1.
    #[serde(deserialize_with = "present")]
    pub grown: f64,
}

impl Default for SkinState {
    fn default() -> Self {
        Self {
            natural_tension_n_per_m: 0.0,
            anisotropy: 1.0,
            direction_deg: 0.0,
            relaxed: 1.0,
            grown: 0.0,
        }
    }
}

/// Greatest natural strain of the skin, equivalent \[-\].
const MOST_STRAIN: f64 = 0.5;

impl SkinState {
    /// Is the skin without stress at rest?
    pub(super) fn is_none(&self) -> bool {
        self.natural_tension_n_per_m <= 0.0
    }

    /// Is the tension the same in all directions?
    pub(super) fn is_turned(&self) -> bool {
        self.is_none() || self.anisotropy <= 1.0
    }

    /// Tensions along the direction and across it \[N/m = kPa·mm\].
    fn tensions(&self, natural_tension: f64) -> [f64; 2] {
        let across = 2.0 * natural_tension / (1.0 + self.anisotropy);
        [self.anisotropy * across, across]
    }

    /// The stretch of a skin under a tension; `None` if the skin is stretched by more than [`MOST_STRAIN`].
    fn stretches(&self, skin: &Material, natural_tension: f64) -> Option<[f64; 2]> {
        let stress = self.tensions(natural_tension).map(|tension| tension / skin.thickness_mm);
        let strain = strain_of(&skin.curve, skin.poisson_ratio, stress, MOST_STRAIN)?;
        Some(strain.map(|strain| 1.0 + strain))
    }

    /// The greatest natural tension up to the given one that stretches a skin by [`MOST_STRAIN`] at most \[N/m\].
    fn greatest(&self, skin: &Material) -> f64 {
        let (mut least, mut most) = (0.0, self.natural_tension_n_per_m);
        for _ in 0..50 {
            let middle = 0.5 * (least + most);
            let is_small = self.stretches(skin, middle).is_some();
            *(if is_small { &mut least } else { &mut most }) = middle;
        }
        least
    }

    /// The stretch of a skin at rest.
    ///
    /// # Errors
    /// A tension that stretches the skin by more than [`MOST_STRAIN`].
    pub(super) fn stretch(&self, skin: &Material) -> Result<Option<NaturalStretch>, SceneError> {
        if self.is_none() {
            return Ok(None);
        }
        let given = self.natural_tension_n_per_m;
        if let Some(stretches) = self.stretches(skin, given) {
            return Ok(NaturalStretch::new(stretches, self.direction_deg.to_radians()));
        }
        let allowed = format!(
            "0 to {} N/m, which stretches skin of this strain scale by {} % (a measured pull or class gives other scales for lower tensions)",
            number((10.0 * self.greatest(skin)).floor() / 10.0),
            100.0 * MOST_STRAIN
        );
        Err(out_of_range(Field::NaturalTension.path, number(given), &allowed))
    }
}

impl SkinState {
    /// Relaxes the curve of a skin above its strain at rest.
    pub(super) fn relax(&self, skin: &mut Material, natural: Option<&NaturalStretch>) {
        if self.relaxed >= 1.0 {
            return;
        }
        let strain = natural.map_or([0.0; 2], |natural| natural.stretches().map(|it| it - 1.0));
        let above = equivalent_strain(strain, skin.poisson_ratio);
        skin.curve = skin.curve.clone().relaxed(above, self.relaxed);
    }
}

impl SkinState {
    /// Growth of a skin, up to the greatest one of its natural stretch \[-\].
    pub(super) fn growth(&self, natural: Option<&NaturalStretch>) -> f64 {
        natural.map_or(self.grown, |natural| self.grown.min(natural.greatest_growth()))
    }

    /// What a result says about skin that cannot grow so far.
    pub(crate) fn growth_warning(&self, natural: Option<&NaturalStretch>) -> Option<String> {
        let growth = self.growth(natural);
        (growth < self.grown).then(|| {
            format!(
                "The skin has grown by {:.2} of its stretch instead of {}: under so uneven a natural tension it would not resist shear \
                 beyond that.",
                growth,
                number(self.grown)
            )
        })
    }

    /// The state at a time after the operation, with relaxation and growth as expected.
    #[must_use]
    pub fn at(self, when: When) -> Self {
        Self { relaxed: when.relaxed().value, grown: when.grown().value, ..self }
    }
}

impl Scene {
    /// Does the skin bear its natural tension?
    ///
    /// # Errors
    /// A tension that stretches the skin by more than half.
    pub fn check_tension(&self) -> Result<(), SceneError> {
        let skin = self.layers.first().map(Layer::material);
        skin.and_then(Result::ok)
            .map_or(Ok(()), |skin| self.body.skin_state.stretch(&skin).map(|_| ()))
    }

    /// Lowers a natural tension that the skin does not bear to the greatest one that it does.
    pub(crate) fn lower_tension(&mut self) {
        let state = &mut self.body.skin_state;
        let skin = self.layers.first().filter(|_| !state.is_none());
        let Some(Ok(skin)) = skin.map(Layer::material) else { return };
        if state.stretches(&skin, state.natural_tension_n_per_m).is_none() {
            state.natural_tension_n_per_m = state.greatest(&skin);
        }
    }

    /// The scene at a time after the operation; a sheet has none and stays as it is.
    #[must_use]
    pub fn at(&self, when: When) -> Self {
        let mut scene = self.clone();
        if self.is_layered() {
            scene.body.skin_state = self.body.skin_state.at(when);
        }
        scene
    }

    /// The time after the operation whose expected relaxation and growth the skin has; `None` with other numbers.
    #[must_use]
    pub fn when(&self) -> Option<When> {
        let state = self.body.skin_state;
        When::ALL.into_iter().find(|when| state == state.at(*when))
    }

    /// Checks that the scene may have a state of the skin.
    pub(super) fn check_skin_state(&self) -> Result<(), SceneError> {
        if self.body.tissue_model == TissueModel::Sheet
            && self.body.skin_state != SkinState::default()
        {
            return Err(out_of_range("skin_state", "given".to_owned(), "in layered tissue only"));
        }
        Ok(())
    }
}
