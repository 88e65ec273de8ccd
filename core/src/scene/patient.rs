//! Measurements of a person in a scene, and the fields of the scene that are derived from them.
//!
//! A pinch determines the thickness of the skin (`layers[0]`) and of the first layer named `adipose`; a pull or a class of
//! the skin determines `layers[0].curve.strain_scale` if this curve is the skin preset.
//!
//! A determined field is either *derived* (its path is in [`Patient::derived`]) or *set by hand*. Reading a file never
//! changes a number that the file contains.

use super::field::Field;
use super::layer::{ADIPOSE, LayerFile};
use super::{Scene, SceneError, limits, one_line, out_of_range};
use crate::clinical::{
    ClinicalError, Derived, EnvelopeFill, Measurements, SkinClass, inconsistency,
};
use crate::curve::{CurveSpec, List, given, number};
use crate::measure::PatientValue;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Measurements of a person, and the fields of the scene that were derived from them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Patient {
    /// What was measured.
    #[serde(flatten)]
    pub measured: Measurements,
    /// Paths of the fields whose values were derived; all other fields that the measurements determine were set by hand.
    pub derived: Vec<String>,
}

impl Patient {
    /// The measured base of the breast of the same patient now \[mm\]: all other measurements are equal. `None` with a measured pull, of which the
    /// base is a part.
    pub(crate) fn base_now(&self, now: &Self) -> Option<f64> {
        let others = |patient: &Self| Measurements { base_width_mm: None, ..patient.measured };
        let is_same = self.measured.skin_pull_mm.is_none() && others(self) == others(now);
        now.measured.base_width_mm.filter(|_| is_same)
    }
}

/// Greatest number of derived fields in a file.
const MAX_DERIVED: usize = 16;

/// A patient in a file.
#[derive(Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "Patient")]
pub(super) struct PatientFile {
    /// Base width of the breast \[mm\], 60 to 240.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    base_width_mm: Option<f64>,
    /// Pinch: thickness of a fold of skin and fat \[mm\], 4 to 120.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    pinch_mm: Option<f64>,
    /// Anterior pull of the skin \[mm\], 5 to 80; with `base_width_mm`, without `skin_class`.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    skin_pull_mm: Option<f64>,
    /// Class of the skin by its anterior pull.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "SkinClass")]
    skin_class: Option<SkinClass>,
    /// Nipple–fold distance under stretch \[mm\], 30 to 200; for the practice table alone.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "f64")]
    fold_stretched_mm: Option<f64>,
    /// How much of the stretched envelope the existing breast fills; for the practice table alone.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "EnvelopeFill")]
    envelope_fill: Option<EnvelopeFill>,
    /// Paths of the derived fields; the scene contains their values. Default: the determined fields that the scene does
    /// not contain are derived.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "Vec<String>")]
    derived: Option<List<String, MAX_DERIVED>>,
}

/// The fields of a layer in a file that a patient may fill: are they present?
#[derive(Clone, Copy, Default)]
pub(super) struct Given {
    thickness: bool,
    strain_scale: bool,
}

impl Given {
    pub(super) fn of(layer: &LayerFile) -> Self {
        Self {
            thickness: layer.thickness_mm.is_some(),
            strain_scale: layer.strain_scale().is_some(),
        }
    }
}

/// A number that a measurement may determine, with its layer: the thickness of a layer, the strain scale of the skin.
type Number = (Field, usize);

fn of_path(path: &str) -> Option<Number> {
    let thicknesses = (0..limits::LAYERS.1).map(|layer| (Field::Thickness, layer));
    let mut numbers = thicknesses.chain([(Field::StrainScale, 0)]);
    numbers.find(|(field, layer)| field.path(*layer) == path)
}

fn is_given((field, layer): Number, given: &[Given]) -> bool {
    let is_thickness = field == Field::Thickness;
    given.get(layer).is_some_and(|of| if is_thickness { of.thickness } else { of.strain_scale })
}

fn set(scene: &mut Scene, (field, layer): Number, value: f64) {
    if let Some(place) = field.place(scene, layer) {
        *place = value;
    }
}

/// Greatest relative difference of a derived value in a file from the derivation \[-\].
const ROUNDING: f64 = 1e-6;

fn is_equal(a: f64, b: f64) -> bool {
    (a - b).abs() <= ROUNDING * b.abs()
}

fn error((field, source): (&'static str, ClinicalError)) -> SceneError {
    SceneError::Patient { field, source }
}

impl PatientFile {
    /// Sets the patient of a scene that was read. Without a list of derived fields, the fields that the file does not
    /// contain are derived; with a list no number changes.
    ///
    /// # Errors
    /// A measurement is invalid, a path in the list is unknown, or a derived value is out of its range.
    pub(super) fn fill(self, scene: &mut Scene, given: &[Given]) -> Result<(), SceneError> {
        let measured = Measurements {
            base_width_mm: self.base_width_mm,
            pinch_mm: self.pinch_mm,
            skin_pull_mm: self.skin_pull_mm,
            skin_class: self.skin_class,
            fold_stretched_mm: self.fold_stretched_mm,
            envelope_fill: self.envelope_fill,
        };
        measured.check().map_err(error)?;
        let mut paths = Vec::new();
        if let Some(list) = self.derived {
            let listed = fields(&list.0)?;
            for number in
                scene.patient_fields().into_iter().filter(|number| listed.contains(number))
            {
                // Another number in the file was set by hand.
                if scene.is_derivation(&measured, number) {
                    paths.push(number.0.path(number.1));
                }
            }
        } else {
            for number in scene.patient_fields().into_iter().filter(|n| !is_given(*n, given)) {
                if let Some(value) = scene.derivation(&measured, number)? {
                    set(scene, number, value.value);
                    paths.push(number.0.path(number.1));
                }
            }
        }
        scene.patient = Some(Patient { measured, derived: paths });
        Ok(())
    }
}

/// The fields of a list of paths.
fn fields(paths: &[String]) -> Result<Vec<Number>, SceneError> {
    let field = |(k, path): (usize, &String)| {
        of_path(path).ok_or_else(|| {
            out_of_range(
                &format!("patient.derived[{k}]"),
                one_line(path, 40),
                "layers[k].thickness_mm, layers[0].curve.strain_scale",
            )
        })
    };
    paths.iter().enumerate().map(field).collect()
}

impl Scene {
    /// Sets the measurements of the patient and derives the values of the scene that they determine.
    ///
    /// Fields that the earlier measurements determined and that were set by hand keep their values. The values derived
    /// from a measurement that is no longer given stay in the scene.
    ///
    /// # Errors
    /// A measurement is invalid, or a derived value is out of its range; the scene is unchanged.
    pub fn apply_patient(&mut self, measured: Measurements) -> Result<(), SceneError> {
        measured.check().map_err(error)?;
        let is_by_hand = |value: &PatientValue| value.set_by_hand;
        let by_hand: Vec<String> =
            self.patient_values().into_iter().filter(is_by_hand).map(|value| value.field).collect();
        let mut values = Vec::new();
        for number in self.patient_fields() {
            if !by_hand.contains(&number.0.path(number.1))
                && let Some(value) = self.derivation(&measured, number)?
            {
                values.push((number, value.value));
            }
        }
        let mut derived = Vec::new();
        for (number, value) in values {
            set(self, number, value);
            derived.push(number.0.path(number.1));
        }
        self.patient = Some(Patient { measured, derived });
        Ok(())
    }

    /// The measurements of the patient; none without a patient.
    #[must_use]
    pub fn measured(&self) -> Measurements {
        self.patient.as_ref().map(|patient| patient.measured).unwrap_or_default()
    }

    /// The values of the scene that the patient's measurements determine, derived or set by hand.
    ///
    /// A value counts as derived if [`Patient::derived`] lists its path and the value is the derived one.
    #[must_use]
    pub fn patient_values(&self) -> Vec<PatientValue> {
        let Some(patient) = &self.patient else { return Vec::new() };
        let value = |(field, layer): Number| {
            let derived = self.derivation(&patient.measured, (field, layer)).ok()??;
            let (path, value) = (field.path(layer), field.value(self, layer)?);
            let is_derived = patient.derived.contains(&path)
                && self.is_derivation(&patient.measured, (field, layer));
            Some(derived.beside(path, value, !is_derived))
        };
        self.patient_fields().into_iter().filter_map(value).collect()
    }

    /// Sentences on measurements that do not fit to the scene: a value set by hand outside of the range of its
    /// measurement, a measurement without effect, an implant wider than the base width.
    #[must_use]
    pub fn patient_warnings(&self) -> Vec<String> {
        let Some(Patient { measured, .. }) = &self.patient else { return Vec::new() };
        let values = self.patient_values();
        let mut warnings: Vec<String> = values.iter().filter_map(inconsistency).collect();
        let fields = self.patient_fields();
        let errors = fields.iter().filter_map(|field| self.derivation(measured, *field).err());
        warnings.extend(errors.map(|error| format!("{error}.")));
        let has_fat = fields.iter().any(|(field, layer)| *field == Field::Thickness && *layer > 0);
        if measured.pinch_mm.is_some() && !has_fat {
            warnings.push(
                "The pinch determines no thickness of fat: the scene has no layer named adipose below the skin."
                    .to_owned(),
            );
        }
        let is_pulled = measured.skin_pull_mm.is_some() || measured.skin_class.is_some();
        if is_pulled && !self.has_preset_skin() {
            warnings.push(
                "The pull of the skin has no effect: the curve of the first layer is not the skin preset."
                    .to_owned(),
            );
        }
        let width = 2.0 * self.implant.base_radius_mm;
        if let Some(base) = measured.base_width_mm.filter(|base| width > *base) {
            warnings.push(format!(
                "The implant's base of {} cm is wider than the breast's base of {} cm.",
                number(width / 10.0),
                number(base / 10.0)
            ));
        }
        warnings
    }

    /// Checks the patient's measurements.
    pub(super) fn check_patient(&self) -> Result<(), SceneError> {
        self.patient.as_ref().map_or(Ok(()), |patient| patient.measured.check().map_err(error))
    }

    fn has_preset_skin(&self) -> bool {
        self.layers.first().is_some_and(|skin| skin.curve.spec == CurveSpec::Skin {})
    }

    /// The fields of this scene that a patient may determine.
    fn patient_fields(&self) -> Vec<Number> {
        let is_fat = |k: &usize| self.layers[*k].tissue == ADIPOSE;
        let skin = (!self.layers.is_empty()).then_some(0);
        let fat = (1..self.layers.len()).find(is_fat);
        let strain_scale = self.has_preset_skin().then_some((Field::StrainScale, 0));
        let thicknesses = skin.into_iter().chain(fat).map(|layer| (Field::Thickness, layer));
        thicknesses.chain(strain_scale).collect()
    }

    /// Is the number of a field what the measurements give? Of a strain scale also without a natural tension, under which plans keep theirs.
    fn is_derivation(&self, measured: &Measurements, number: Number) -> bool {
        let (field, layer) = number;
        let under_none = || self.derivation_under(0.0, measured, number);
        let is_present = |derived: Result<Option<Derived>, SceneError>| {
            let present = field.value(self, layer);
            present.zip(derived.ok().flatten()).is_some_and(|(a, b)| is_equal(a, b.value))
        };
        is_present(self.derivation(measured, number)) || is_present(under_none())
    }

    /// Sets the natural tension of the skin \[N/m\]; a strain scale that was derived from a pull or a class is derived again under it.
    ///
    /// # Errors
    /// A pull or a class that gives no strain scale under the tension, or one that the tension stretches too far; the scene is unchanged.
    pub fn set_natural_tension(&mut self, tension_n_per_m: f64) -> Result<(), SceneError> {
        let mut changed = self.clone();
        changed.body.skin_state.natural_tension_n_per_m = tension_n_per_m;
        if let Some(patient) = &self.patient {
            for (field, layer) in self.patient_fields() {
                let path = field.path(layer);
                let is_derived = patient.derived.contains(&path)
                    && self.is_derivation(&patient.measured, (field, layer));
                if is_derived
                    && let Some(value) = changed.derivation(&patient.measured, (field, layer))?
                {
                    set(&mut changed, (field, layer), value.value);
                }
            }
        }
        changed.check_tension()?;
        *self = changed;
        Ok(())
    }

    /// The value that the measurements give for a field; a strain scale depends on the natural tension of the skin.
    fn derivation(
        &self,
        measured: &Measurements,
        number: Number,
    ) -> Result<Option<Derived>, SceneError> {
        self.derivation_under(self.body.skin_state.natural_tension_n_per_m, measured, number)
    }

    fn derivation_under(
        &self,
        natural_tension_n_per_m: f64,
        measured: &Measurements,
        (field, layer): Number,
    ) -> Result<Option<Derived>, SceneError> {
        let invalid = |name| move |source| error((name, source));
        if field == Field::Thickness {
            let cover = measured.cover().map_err(invalid("pinch_mm"))?;
            Ok(cover.map(|cover| if layer == 0 { cover.skin } else { cover.fat }))
        } else {
            measured.strain_scale(natural_tension_n_per_m).map_err(invalid("skin_pull_mm"))
        }
    }
}
