//! Scales of strain and stress: σ(ε) = `stress_scale` · f(ε / `strain_scale`).

use super::{Curve, CurveError, CurveSpec, MIN_WIDTH, Piece, Range, STRESS_SCALE, Shape, checked};
use schemars::JsonSchema;
use serde::Serialize;

/// Range of the scales of a curve \[-\].
pub const SCALES: (f64, f64) = (0.05, 20.0);

const SCALE: Range = (SCALES.0, SCALES.1, "0.05 to 20");

/// A curve of a scene with its scales: σ(ε) = `stress_scale` · f(ε / `strain_scale`), f the curve of the kind.
///
/// In JSON the scales are fields beside `kind`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScaledCurve {
    /// The curve f.
    #[serde(flatten)]
    pub spec: CurveSpec,
    /// Scale of the strain \[-\], 0.05 to 20: the tissue reaches the stress of f at this multiple of the strain.
    #[serde(skip_serializing_if = "is_one")]
    pub strain_scale: f64,
    /// Scale of the stress \[-\], 0.05 to 20.
    #[serde(skip_serializing_if = "is_one")]
    pub stress_scale: f64,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    clippy::float_cmp,
    reason = "serde; the default exactly"
)]
fn is_one(scale: &f64) -> bool {
    *scale == 1.0
}

impl From<CurveSpec> for ScaledCurve {
    fn from(spec: CurveSpec) -> Self {
        Self { spec, strain_scale: 1.0, stress_scale: 1.0 }
    }
}

impl JsonSchema for ScaledCurve {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Curve".into()
    }

    /// The schema of [`CurveSpec`] with the scales among the fields of every kind.
    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let mut schema = CurveSpec::json_schema(generator);
        let (least, most) = SCALES;
        let scale = |what: &str| {
            serde_json::json!({
                "description": format!("Scale of the {what}."),
                "type": "number", "minimum": least, "maximum": most, "default": 1.0,
            })
        };
        let kinds = schema.get_mut("oneOf").and_then(|kinds| kinds.as_array_mut());
        for kind in kinds.into_iter().flatten() {
            if let Some(fields) =
                kind.get_mut("properties").and_then(|fields| fields.as_object_mut())
            {
                fields.insert("strain_scale".to_owned(), scale("strain"));
                fields.insert("stress_scale".to_owned(), scale("stress"));
            }
        }
        schema
    }
}

impl Curve {
    /// Validates a description with its scales and builds the curve
    /// σ(ε) = `stress_scale` · f(ε / `strain_scale`), f the curve of the kind.
    ///
    /// Data, breaks and the final line scale with the strain.
    ///
    /// # Errors
    /// [`CurveError`] names the invalid parameter, point or section and the allowed range.
    pub fn scaled(curve: &ScaledCurve) -> Result<Self, CurveError> {
        let strain_scale = checked("strain_scale", curve.strain_scale, SCALE)?;
        let stress_scale = checked("stress_scale", curve.stress_scale, SCALE)?;
        let built = Self::new(&curve.spec)?.with_scales(strain_scale, stress_scale);
        if built.end.0 > STRESS_SCALE.1 {
            return Err(CurveError::Parameter {
                field: "stress at the end of the scaled curve (kPa)".to_owned(),
                value: built.end.0,
                allowed: STRESS_SCALE.2,
            });
        }
        let is_narrow = |pair: &[Piece]| pair[1].from - pair[0].from < 0.999 * MIN_WIDTH;
        if strain_scale < 1.0 && built.pieces.windows(2).any(is_narrow) {
            return Err(CurveError::Parameter {
                field: "strain_scale".to_owned(),
                value: strain_scale,
                allowed: "scaled strains 1e-9 apart or more",
            });
        }
        Ok(built)
    }

    /// The curve `stress_scale` · f(ε / `strain_scale`). Every kind of piece is closed under scaling.
    fn with_scales(self, strain_scale: f64, stress_scale: f64) -> Self {
        let energy_scale = stress_scale * strain_scale;
        let piece = |piece: Piece| Piece {
            from: piece.from * strain_scale,
            base: piece.base * stress_scale,
            energy: piece.energy * energy_scale,
            shape: piece.shape.scaled(strain_scale, stress_scale),
        };
        Self {
            pieces: self.pieces.into_iter().map(piece).collect(),
            data_end: self.data_end * strain_scale,
            measured_end: self.measured_end * strain_scale,
            line_start: self.line_start * strain_scale,
            end: (self.end.0 * stress_scale, self.end.1 * stress_scale / strain_scale),
            end_energy: self.end_energy * energy_scale,
            relaxation: None,
        }
    }
}

impl Shape {
    /// `stress_scale` · shape(x / `strain_scale`).
    fn scaled(self, strain_scale: f64, stress_scale: f64) -> Self {
        match self {
            Self::Polynomial(mut c) => {
                let mut factor = stress_scale;
                for c in &mut c {
                    factor /= strain_scale;
                    *c *= factor;
                }
                Self::Polynomial(c)
            }
            Self::Arctangent { scale, rate } => {
                Self::Arctangent { scale: scale * stress_scale, rate: rate / strain_scale }
            }
            Self::Sine { scale, rate } => {
                Self::Sine { scale: scale * stress_scale, rate: rate / strain_scale }
            }
            Self::Exponential { scale, rate } => {
                Self::Exponential { scale: scale * stress_scale, rate: rate / strain_scale }
            }
        }
    }
}
