//! Tests of fat alone: tangent moduli of the presets beside measured ones.
//!
//! Uses `slab`, `table`. Used by `mod`.

use super::slab::Slab;
use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use implant_preview_core::curve::{Curve, CurveError, CurveSpec, Fat};
use implant_preview_core::springs::Material;

/// A measured modulus: quantity, strain \[-\], value and standard deviation \[kPa\].
type Measured = (&'static str, f64, f64, Option<f64>);

/// Factor from the tangent of a running test to the tangent at rest \[-\].
const AT_REST: f64 = 0.77;
const ALKHOULI: [(f64, f64, f64); 2] = [(0.0, 1.6, 0.8), (Fat::MEASURED_STRAIN, 11.7, 6.4)];
const OTHERS: [Measured; 3] = [
    ("initial modulus (Sims et al. 2010)", 0.0, 1.6, None),
    ("initial modulus (magnetic resonance elastography)", 0.0, 2.25, None),
    ("initial modulus (breast fat in vivo)", 0.0, 3.04, Some(1.17)),
];
/// Compressive strain of the comparison with Krouskop et al. \[-\].
const COMPRESSION: f64 = 0.2;

/// Names of the quantities.
pub const TANGENT: &str = "tangent modulus (Alkhouli et al. 2013)";
/// The tangents of the running test times 0.77.
pub const TANGENT_AT_REST: &str = "tangent modulus (Alkhouli et al. 2013) × 0.77";
/// Name of the paper's curve.
pub const ADIPOSE: &str = "adipose of the paper";

/// Name of a curve of fat.
#[must_use]
pub fn name(fat: Fat) -> &'static str {
    match fat {
        Fat::Low => "fat low",
        Fat::Mid => "fat mid",
        Fat::High => "fat high",
    }
}

/// The comparison: data, prediction and chart in one piece.
///
/// # Errors
/// A curve is invalid.
pub fn comparison() -> Result<Comparison, CurveError> {
    let mut curves = Vec::new();
    for variant in Fat::ALL {
        curves.push((name(variant), Curve::new(&CurveSpec::Fat { variant })?, 0.49));
    }
    curves.push((ADIPOSE, Curve::new(&CurveSpec::Adipose {})?, 0.45));
    let mut measured: Vec<Measured> = Vec::new();
    for (strain, value, deviation) in ALKHOULI {
        measured.push((TANGENT, strain, value, Some(deviation)));
        measured.push((TANGENT_AT_REST, strain, AT_REST * value, Some(AT_REST * deviation)));
    }
    measured.extend(OTHERS);
    let mut rows = Vec::new();
    for (quantity, strain, value, deviation) in measured {
        rows.extend(curves.iter().map(|(model, curve, _)| Row {
            quantity: quantity.to_owned(),
            model: (*model).to_owned(),
            at: Some(strain),
            measured: Some(value),
            range: deviation.map(|sd| [value - sd, value + sd]),
            predicted: Some(curve.slope(strain)),
        }));
    }
    for (model, curve, poisson_ratio) in &curves {
        let slab = Slab::new(&Material::new(curve.clone(), *poisson_ratio, 1.0));
        let tangent = |strain: f64| {
            let [up, down] = [0.01, -0.01].map(|step| slab.uniaxial(1.0 + strain + step).0);
            (up - down) / 0.02
        };
        rows.push(Row {
            quantity:
                "tangent at 20 % compression / tangent at rest (Krouskop et al. 1998: constant)"
                    .to_owned(),
            model: (*model).to_owned(),
            at: Some(-COMPRESSION),
            measured: Some(1.0),
            range: None,
            predicted: Some(tangent(-COMPRESSION) / tangent(0.0)),
        });
    }
    let rest = ALKHOULI.map(|(strain, value, _)| (strain, value));
    let mut series: Vec<Series> = ALKHOULI
        .iter()
        .map(|(strain, value, sd)| {
            let label = if *strain > 0.0 { "± one standard deviation" } else { "" };
            Series::band(label, [strain - 0.006, strain + 0.006], [value - sd, value + sd])
        })
        .collect();
    series.push(Series {
        label: "Alkhouli et al. 2013, measured".to_owned(),
        mark: Mark::Points,
        points: rest.to_vec(),
    });
    series.extend(curves.iter().map(|(model, curve, _)| Series {
        label: (*model).to_owned(),
        mark: Mark::Line,
        points: (0..=30).map(|k| 0.01 * f64::from(k)).map(|e| (e, curve.slope(e))).collect(),
    }));
    Ok(Comparison {
        name: "fat",
        title: "Fat: tangent moduli",
        source: "N. Alkhouli et al., Am. J. Physiol. Endocrinol. Metab. 305, 2013: the only tensile test of human fat. A. M. Sims \
                 et al. 2010; T. A. Krouskop et al. 1998; L. A. Mihai et al. 2015.",
        unit: "kPa; a ratio in the last rows",
        argument: "strain",
        rows,
        remarks: vec![
            "The curves `fat` were chosen from these sources: their agreement is no independent test. Beyond 30 % no \
             quasi-static test was found; the curves continue as lines."
                .to_owned(),
            "In compression the model follows from the same curve. Krouskop et al. 1998 found a constant modulus, Mihai et al. \
             2015 stiffening in compression and not in tension: the sources disagree."
                .to_owned(),
        ],
        axes: [
            PlotAxis { name: "strain (–)", range: [-0.01, 0.32], decimals: 2, labels: 7 },
            PlotAxis { name: "tangent modulus (kPa)", range: [0.0, 20.0], decimals: 0, labels: 7 },
        ],
        series,
    })
}
