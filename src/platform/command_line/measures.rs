//! Measures of a body as JSON.

use crate::body::frame::Frame;
use crate::body::marks::{Marks, Side};
use crate::body::measures::{BreastMeasures, measures};
use crate::body::mound::{Mound, asymmetry_mm};
use crate::body::surface::Surface;
use serde::Serialize;

/// Two decimals.
pub(super) fn rounded(value: f64) -> f64 {
    (100.0 * value).round() / 100.0
}

/// Measures of a body.
#[derive(Serialize)]
pub(super) struct BodyMeasures {
    #[serde(skip_serializing_if = "Option::is_none")]
    left: Option<OfBreast>,
    #[serde(skip_serializing_if = "Option::is_none")]
    right: Option<OfBreast>,
    nipple_nipple_mm: f64,
    between_breasts_mm: Option<f64>,
    /// The left nipple above the right one.
    nipple_height_mm: f64,
    left_less_right: Option<OfBreast>,
    asymmetry_mm: Option<f64>,
}

/// Measures of a breast, or differences.
#[derive(Serialize)]
struct OfBreast {
    notch_nipple_mm: f64,
    notch_nipple_skin_mm: Option<f64>,
    nipple_fold_mm: Option<f64>,
    nipple_midline_mm: f64,
    base_width_mm: f64,
    #[serde(flatten)]
    mound: Option<OfMound>,
}

/// Measures over the bare chest.
#[derive(Serialize)]
struct OfMound {
    projection_mm: f64,
    volume_ml: f64,
    upper_percent: f64,
}

impl OfBreast {
    fn new(breast: &BreastMeasures, mound: Option<Mound>) -> Self {
        Self {
            notch_nipple_mm: rounded(breast.notch_nipple_mm),
            notch_nipple_skin_mm: breast.notch_nipple_skin_mm.map(rounded),
            nipple_fold_mm: breast.nipple_fold_mm.map(rounded),
            nipple_midline_mm: rounded(breast.nipple_midline_mm),
            base_width_mm: rounded(breast.base_width_mm),
            mound: mound.map(|mound| OfMound {
                projection_mm: rounded(mound.projection_mm),
                volume_ml: rounded(mound.volume_ml),
                upper_percent: rounded(mound.upper_percent),
            }),
        }
    }
}

impl BodyMeasures {
    /// Measures of a surface and its marks in the frame of its marks before an operation, with those over the bare chest of a side.
    pub(super) fn of(
        surface: &Surface,
        (marks, frame): (&Marks, &Frame),
        (side, mound): (Side, Option<Mound>),
    ) -> Self {
        let found = measures(surface, marks, frame);
        let of = |own: Side| {
            let breast = found.breasts[own as usize].as_ref()?;
            Some(OfBreast::new(breast, mound.filter(|_| own == side)))
        };
        let less = found.left_less_right();
        Self {
            left: of(Side::Left),
            right: of(Side::Right),
            nipple_nipple_mm: rounded(found.nipple_nipple_mm),
            between_breasts_mm: found.between_breasts_mm.map(rounded),
            nipple_height_mm: rounded(found.nipple_height_mm),
            left_less_right: less.map(|less| OfBreast::new(&less, None)),
            asymmetry_mm: asymmetry_mm(surface, marks, frame).map(rounded),
        }
    }
}
