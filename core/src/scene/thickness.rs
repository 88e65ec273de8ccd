//! The thickness field of a scene: factors of the thickness of the solid layers on a grid, in lengths along the wall.

use super::chest::LEAST_OF_TISSUE;
use super::{Scene, SceneError, grid, out_of_range, problem};
use crate::curve::{number, whole};
use crate::mesh::ThicknessField;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Factors of the thickness of all solid layers, with a smooth function between them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "ThicknessField")]
pub struct ThicknessGrid {
    /// Distance of neighbouring factors along the wall \[mm\], 0.5 to 50.
    pub spacing_mm: f64,
    /// Factors in a row, along x, 4 to 257.
    #[serde(deserialize_with = "whole")]
    pub columns: usize,
    /// Rows, along y, 4 to 257.
    #[serde(deserialize_with = "whole")]
    pub rows: usize,
    /// Row by row, x fastest, from −x, −y, centred on the pocket's centre, 0.05 to 20 \[-\].
    #[serde(serialize_with = "grid::written", deserialize_with = "grid::read")]
    #[schemars(with = "Vec<f64>")]
    pub factors: Arc<[f64]>,
}

impl ThicknessGrid {
    /// Distance of the nearest edge from the pocket's centre along the wall \[mm\].
    pub(super) fn reach_mm(&self) -> f64 {
        0.5 * (self.columns.min(self.rows).saturating_sub(1)) as f64 * self.spacing_mm
    }
}

/// Factors of the thickness.
pub(super) const FACTORS: (f64, f64) = (0.05, 20.0);

impl Scene {
    /// The thickness of the solids as a function of the place on the wall.
    ///
    /// # Errors
    /// A field that is out of its range, or that does not belong to the scene.
    pub(super) fn thickness(&self) -> Result<Option<ThicknessField>, SceneError> {
        const PATH: &str = "thickness_field";
        let Some(field) = &self.thickness_field else { return Ok(None) };
        if !self.is_layered() {
            return Err(out_of_range(PATH, "given".to_owned(), "in layered tissue only"));
        }
        let ThicknessGrid { spacing_mm, columns, rows, factors } = field;
        let form = grid::Form { path: PATH, values: "factors", spacing_mm: *spacing_mm };
        form.check([*columns, *rows], factors, FACTORS, "")?;
        form.check_reach([*columns, *rows], [self.patch_radius(); 2])?;
        let found = ThicknessField::new(*spacing_mm, [*columns, *rows], factors.to_vec());
        let found = found.ok_or_else(|| problem(PATH, "no grid of numbers"))?;
        let least = found.least();
        if least <= 0.0 {
            let value = format!(
                "as low as {} between two numbers",
                number((100.0 * least).floor() / 100.0)
            );
            return Err(out_of_range("thickness_field.factors", value, "more than 0 everywhere"));
        }
        self.check_hollow(found.greatest())?;
        Ok(Some(found))
    }

    /// Thickness of the layers that the field leaves as they are, the skin and the muscle of a plane, and of those that it thickens \[mm\].
    pub(super) fn even_and_uneven_mm(&self) -> [f64; 2] {
        let even = self.layers[0].thickness_mm + self.muscle_mm();
        [even, self.tissue_mm() - even]
    }

    /// Checks that the solids, thickened by a factor at most, leave cells in a hollow.
    fn check_hollow(&self, factor: f64) -> Result<(), SceneError> {
        let Some(chest) = &self.chest else { return Ok(()) };
        let least = chest.least_hollow_mm();
        let [even, solids] = self.even_and_uneven_mm();
        let most = (least / LEAST_OF_TISSUE - even) / solids.max(f64::MIN_POSITIVE);
        if factor <= most {
            return Ok(());
        }
        let up_to = |factor: f64| number((100.0 * factor).floor() / 100.0);
        let value = format!("as high as {}", up_to(factor));
        let allowed = format!(
            "{} or less in a hollow of {} mm, twice the tissue",
            up_to(most),
            number(least)
        );
        Err(out_of_range("thickness_field.factors", value, &allowed))
    }
}
