//! A chest by the built-in torso, shaped by what a tape measures: wall and thickness of a scene are those of its fit.
//!
//! The cover of the fit is the thickness of the layers, below the muscle that of the muscle, too, the pocket's centre that of an implant of 12 cm. Shaped torsos and fits are kept by
//! their numbers: a torso with its fit takes twice as long as the solve of the opening plan at 65 nodes per side, a fit under another cover half of that.

use super::field::Scale;
use super::thickness::FACTORS;
use super::{Field, Scene, SceneError, ThicknessGrid, field, out_of_range, problem};
use crate::body::fit::{BodyFit, FitError, Settings, fit_known};
use crate::body::marks::{Marks, Side};
use crate::body::surface::Surface;
use crate::body::torso::{self, Tape};
use crate::curve::{number, present};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize, Serializer};
use std::borrow::Cow;
use std::ops::RangeInclusive;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

/// What a tape measures on a body of which both sides are alike; the built-in torso is shaped by it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct Torso {
    /// Width of the chest at the level of the folds, straight \[mm\], 220 to 320.
    #[serde(deserialize_with = "present")]
    pub chest_width_mm: f64,
    /// Width of the breast from its medial to its lateral end, straight \[mm\], 110 to 150.
    #[serde(deserialize_with = "present")]
    pub breast_width_mm: f64,
    /// From the sternal notch to the nipple, straight \[mm\], 170 to 250.
    #[serde(deserialize_with = "present")]
    pub notch_nipple_mm: f64,
    /// From the nipple to the fold, along the skin \[mm\], 40 to 120; `None`: as the other numbers give it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nipple_fold_mm: Option<f64>,
    /// Between the nipples, straight \[mm\], 180 to 250.
    #[serde(deserialize_with = "present")]
    pub nipple_nipple_mm: f64,
    /// Volume of the breast between skin and bare chest \[ml\], 80 to 500.
    #[serde(deserialize_with = "present")]
    pub breast_volume_ml: f64,
}

impl Default for Torso {
    /// That of the drawn torso: a small breast before the operation.
    fn default() -> Self {
        Self {
            chest_width_mm: Tape::OWN.chest_width_mm,
            breast_width_mm: Tape::OWN.breast_width_mm,
            notch_nipple_mm: 192.7,
            nipple_fold_mm: None,
            // The mean of 54 young women is 203 mm, the stored trunk has 225 mm.
            nipple_nipple_mm: 204.7,
            breast_volume_ml: 180.0,
        }
    }
}

impl Torso {
    /// A number of the torso by its place among [`field::TORSO`]; `None`: not stated.
    pub(super) fn number(&mut self, k: usize) -> Option<&mut f64> {
        match k {
            0 => Some(&mut self.chest_width_mm),
            1 => Some(&mut self.breast_width_mm),
            2 => Some(&mut self.notch_nipple_mm),
            3 => self.nipple_fold_mm.as_mut(),
            4 => Some(&mut self.nipple_nipple_mm),
            _ => Some(&mut self.breast_volume_ml),
        }
    }

    fn tape(&self) -> Tape {
        let Self { chest_width_mm, breast_width_mm, notch_nipple_mm, .. } = *self;
        let Self { nipple_fold_mm, nipple_nipple_mm, breast_volume_ml, .. } = *self;
        Tape {
            chest_width_mm,
            breast_width_mm,
            notch_nipple_mm,
            nipple_fold_mm,
            nipple_nipple_mm,
            breast_volume_ml,
        }
    }

    /// The torso with the numbers of a tape.
    fn of(tape: &Tape) -> Self {
        let Tape {
            chest_width_mm,
            breast_width_mm,
            notch_nipple_mm,
            nipple_fold_mm,
            nipple_nipple_mm,
            breast_volume_ml,
        } = *tape;
        Self {
            chest_width_mm,
            breast_width_mm,
            notch_nipple_mm,
            nipple_fold_mm,
            nipple_nipple_mm,
            breast_volume_ml,
        }
    }

    /// The way from nipple to fold that the other numbers give \[mm\]; `None`: they have no torso.
    #[must_use]
    pub fn own_nipple_fold_mm(&self) -> Option<f64> {
        Self { nipple_fold_mm: None, ..*self }.shaped().ok()?.tape.nipple_fold_mm
    }

    /// The built-in torso with these numbers.
    ///
    /// # Errors
    /// No chest is found under its breast: none within the limits.
    pub fn shaped(&self) -> Result<Arc<Shaped>, FitError> {
        SHAPED.of(*self, || {
            let (torso, arms, tape) = torso::shaped_with_arms(&self.tape())?;
            Ok(Shaped { torso, arms, tape })
        })
    }

    /// The shaped torso and the fit of its left side under a cover \[mm\].
    ///
    /// # Errors
    /// As [`Self::shaped`].
    pub fn fitted(&self, cover_mm: f64) -> Result<Arc<FittedTorso>, FitError> {
        self.fitted_under([cover_mm, Settings::default().least_mm])
    }

    /// The same under a cover and a least thickness \[mm\].
    fn fitted_under(&self, tissue_mm: [f64; 2]) -> Result<Arc<FittedTorso>, FitError> {
        FITTED.of((*self, tissue_mm), || {
            let shaped = self.shaped()?;
            let torso::Torso { surface, marks } = &shaped.torso;
            let [cover_mm, least_mm] = tissue_mm;
            let settings = Settings { cover_mm, least_mm, ..Settings::default() };
            let fit = fit_known(surface, marks, Side::Left, &settings)?;
            Ok(FittedTorso { shaped, fit })
        })
    }
}

/// A shaped torso.
#[derive(Debug)]
pub struct Shaped {
    /// Its surface and its marks.
    pub torso: torso::Torso,
    /// Its shoulders and stumps of arms, which are drawn beside it.
    pub arms: Surface,
    /// The numbers that it has: others where no such torso is within the ranges of its moves and stretches.
    pub tape: Tape,
}

/// A shaped torso with the fit of its left side, of which the right one is the mirror image.
#[derive(Debug)]
pub struct FittedTorso {
    /// The torso.
    pub shaped: Arc<Shaped>,
    /// Its fit.
    pub fit: BodyFit,
}

/// What was made last, by its key.
struct Kept<K, V>(Mutex<Vec<(K, Arc<V>)>>);

/// Number of kept torsos and fits: a fit has 160 kB.
const KEPT: usize = 8;

static SHAPED: Kept<Torso, Shaped> = Kept(Mutex::new(Vec::new()));
static FITTED: Kept<(Torso, [f64; 2]), FittedTorso> = Kept(Mutex::new(Vec::new()));

impl<K: Copy + PartialEq, V> Kept<K, V> {
    fn list(&self) -> MutexGuard<'_, Vec<(K, Arc<V>)>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The kept value of a key; a new one is made without the lock.
    fn of(&self, key: K, make: impl FnOnce() -> Result<V, FitError>) -> Result<Arc<V>, FitError> {
        if let Some((_, found)) = self.list().iter().find(|(known, _)| *known == key) {
            return Ok(Arc::clone(found));
        }
        let made = Arc::new(make()?);
        let mut list = self.list();
        if list.len() == KEPT {
            list.remove(0);
        }
        list.push((key, Arc::clone(&made)));
        Ok(made)
    }
}

/// Writes a torso as a chest.
pub(super) fn written<S: Serializer>(torso: &Option<Torso>, to: S) -> Result<S::Ok, S::Error> {
    #[derive(Serialize)]
    struct Chest {
        torso: Option<Torso>,
    }
    Chest { torso: *torso }.serialize(to)
}

/// Greatest radius of the simulated tissue \[mm\]: beyond, less of it lies on the torso than a scan must cover.
const MOST_PATCH_MM: f64 = 180.0;
/// Greatest difference of a torso from what is asked for that is not mentioned \[-\].
const NEAREST: f64 = 0.02;
/// From sternal notch to navel against the width of the chest, of the stored trunk \[-\].
const OWN_TRUNK: f64 = 386.0 / 260.0;
/// The same of a trunk that is not mentioned, against that of the stored one \[-\].
const USUAL_TRUNK: RangeInclusive<f64> = 0.75..=1.3;

impl Scene {
    /// Sets the torso as the chest, in place of radii, a grid, or a scan.
    pub fn set_torso(&mut self, torso: Torso) {
        self.set_chest(None);
        self.thickness_field = None;
        self.torso = Some(torso);
    }

    /// The shaped torso under the scene and its fit; `None` for another chest.
    ///
    /// # Errors
    /// As [`Torso::fitted`].
    pub fn fitted_torso(&self) -> Option<Result<Arc<FittedTorso>, FitError>> {
        // The muscle is as thick everywhere. Over it the tissue is as thick as without it, and other solids have a part of their thickness.
        let [even, uneven] = self.even_and_uneven_mm();
        let least =
            (Settings::default().least_mm + self.muscle_mm()).max(even + FACTORS.0 * uneven);
        Some(self.torso.as_ref()?.fitted_under([self.tissue_mm(), least]))
    }

    /// Sentences on the shaped torso: numbers that are others than those asked for, by more than 2 %, where no torso of the asked ones is
    /// within the ranges; a trunk of rare proportions, which the way from notch to nipple makes longer or shorter.
    #[must_use]
    pub fn torso_warnings(&self) -> Vec<String> {
        let (Some(asked), Some(Ok(fitted))) = (self.torso, self.fitted_torso()) else {
            return Vec::new();
        };
        let found = Torso::of(&fitted.shaped.tape);
        let warning = |number: Field| {
            let value =
                |torso: Torso| number.shown(&Self { torso: Some(torso), ..Self::default() });
            let (asked, found) = (value(asked)?, value(found)?);
            let Scale { unit, decimals, .. } = number.scale;
            ((found - asked).abs() > NEAREST * asked).then(|| {
                let name = number.label;
                format!("Nearest torso: {name} {found:.decimals$} {unit}, not {asked:.decimals$}.")
            })
        };
        let mut warnings: Vec<String> = field::TORSO.into_iter().filter_map(warning).collect();
        let Marks { sternal_notch, navel, .. } = fitted.shaped.torso.marks;
        let (long, wide) = (sternal_notch.distance(navel), fitted.shaped.tape.chest_width_mm);
        if !USUAL_TRUNK.contains(&(long / wide / OWN_TRUNK)) {
            let [long, wide] = [long, wide].map(|mm| mm / 10.0);
            warnings.push(format!(
                "A trunk of rare proportions: {long:.0} cm from sternal notch to navel, {wide:.0} cm wide."
            ));
        }
        warnings
    }

    /// Checks that the scene may have its torso.
    pub(super) fn check_torso(&self) -> Result<(), SceneError> {
        if self.torso.is_none() {
            return Ok(());
        }
        self.check_may_have_chest()?;
        field::TORSO.iter().try_for_each(|field| field.check(self, 0))?;
        if self.thickness_field.is_some() {
            let allowed = "no field with chest.torso, whose tissue has a thickness of its own";
            return Err(out_of_range("thickness_field", "given".to_owned(), allowed));
        }
        if self.patch_radius() > MOST_PATCH_MM {
            let (value, allowed) = (number(self.patch_radius()), number(MOST_PATCH_MM));
            let allowed = format!("up to {allowed} mm with chest.torso");
            return Err(out_of_range(Field::PatchRadius.path, value, &allowed));
        }
        Ok(())
    }

    /// An error of the wall, which names the torso where that has made the wall.
    pub(super) fn named_by_torso(&self, error: SceneError) -> SceneError {
        match error {
            SceneError::OutOfRange { value, allowed, .. } if self.torso.is_some() => {
                let allowed = allowed.split_once(';').map_or(&*allowed, |(limit, _)| limit);
                out_of_range("chest.torso", value, allowed)
            }
            error => error,
        }
    }

    /// The scene with wall and thickness of its torso; otherwise the scene itself.
    pub(super) fn laid(&self) -> Result<Cow<'_, Self>, SceneError> {
        let Some(fitted) = self.fitted_torso() else { return Ok(Cow::Borrowed(self)) };
        let fitted = fitted.map_err(|error| problem("chest.torso", &error.to_string()))?;
        let (wall, thickness) = self.grids_of(&fitted.fit);
        Ok(Cow::Owned(Self {
            torso: None,
            other_side: None,
            chest_grid: Some(wall),
            thickness_field: Some(thickness.wider(self.patch_radius())),
            ..self.clone()
        }))
    }
}

impl ThicknessGrid {
    /// The field, continued with the factors of its edge as far as the simulated tissue reaches \[mm\].
    fn wider(self, patch_mm: f64) -> Self {
        let Self { spacing_mm, columns, rows, factors } = self;
        let lacks = |count: usize| patch_mm / spacing_mm - 1.0 - 0.5 * (count - 1) as f64;
        let more = lacks(columns.min(rows)).ceil().max(0.0) as usize;
        let at = |k: usize, count: usize| k.saturating_sub(more).min(count - 1);
        let wide = columns + 2 * more;
        let of = |k: usize| factors[at(k / wide, rows) * columns + at(k % wide, columns)];
        let high = rows + 2 * more;
        let factors = (0..wide * high).map(of).collect();
        Self { spacing_mm, columns: wide, rows: high, factors }
    }
}
