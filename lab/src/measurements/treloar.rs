//! Treloar's rubber: the equibiaxial stress predicted from the uniaxial curve. The laws do not meet this test by
//! construction.
//!
//! Uses `slab`, `table`. Used by `mod`.

use super::slab::{Slab, incompressible_equibiaxial};
use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use implant_preview_core::curve::{Curve, CurveError, CurveSpec, Interpolation};
use implant_preview_core::springs::Material;
use implant_preview_core::springs::coupled::biot_stress;

/// 1 kgf/cm² \[kPa\], the unit of the values.
const KPA: f64 = 98.0665;
/// Uniaxial stretch \[-\] and nominal stress \[kgf/cm²\].
const UNIAXIAL: [(f64, f64); 7] = [
    (1.02, 0.26),
    (1.125, 1.37),
    (1.24, 2.30),
    (1.39, 3.23),
    (1.585, 4.16),
    (1.90, 5.10),
    (2.18, 6.00),
];
/// Equibiaxial stretch \[-\] and nominal stress \[kgf/cm²\].
const EQUIBIAXIAL: [(f64, f64); 7] = [
    (1.03, 0.95),
    (1.07, 1.60),
    (1.12, 2.42),
    (1.14, 2.62),
    (1.20, 3.32),
    (1.31, 4.43),
    (1.42, 5.18),
];
/// Poisson ratio of the predictions \[-\]; rubber is nearly incompressible.
const POISSON_RATIO: f64 = 0.49;

/// Names of the laws in the rows.
pub const COUPLED: &str = "coupled law (sheet and skin) ν 0.49";
/// The solid law.
pub const SOLID: &str = "solid law (β 0.2) ν 0.49";
/// The solid law without the second invariant, in closed form.
pub const FIRST_INVARIANT: &str = "solid law with β 0 incompressible";

/// Nominal stress \[kPa\] as a function of the equibiaxial stretch.
type Stress<'a> = Box<dyn Fn(f64) -> f64 + 'a>;

/// The comparison.
///
/// # Errors
/// The uniaxial points are no valid curve.
pub fn comparison() -> Result<Comparison, CurveError> {
    let mut points = vec![[0.0, 0.0]];
    points.extend(UNIAXIAL.map(|(stretch, value)| [stretch - 1.0, KPA * value]));
    let curve = Curve::new(&CurveSpec::Points { points, interpolation: Interpolation::Spline })?;
    let slab = Slab::new(&Material::new(curve.clone(), POISSON_RATIO, 1.0));
    let laws: [(&str, Stress); 3] = [
        (COUPLED, Box::new(|l| biot_stress(&curve, POISSON_RATIO, [l - 1.0; 2])[0])),
        (SOLID, Box::new(|l| slab.equibiaxial(l))),
        (FIRST_INVARIANT, Box::new(|l| incompressible_equibiaxial(&curve, 0.0, l))),
    ];
    let mut rows = Vec::new();
    for (model, stress) in &laws {
        rows.extend(EQUIBIAXIAL.map(|(stretch, value)| Row {
            quantity: "equibiaxial nominal stress".to_owned(),
            model: (*model).to_owned(),
            at: Some(stretch),
            measured: Some(KPA * value),
            range: None,
            predicted: Some(stress(stretch)),
        }));
    }
    let line = |label: &str, of: &dyn Fn(f64) -> f64| Series {
        label: label.to_owned(),
        mark: Mark::Line,
        points: (0..=90).map(|k| 1.0 + 0.005 * f64::from(k)).map(|l| (l, of(l))).collect(),
    };
    let measured = |label: &str, data: &[(f64, f64)]| Series {
        label: label.to_owned(),
        mark: Mark::Points,
        points: data.iter().map(|(l, value)| (*l, KPA * value)).filter(|p| p.0 < 1.45).collect(),
    };
    let mut series = vec![
        measured("uniaxial, measured: the input", &UNIAXIAL),
        measured("equibiaxial, measured", &EQUIBIAXIAL),
        line("uniaxial curve", &|l| curve.stress(l - 1.0)),
    ];
    series.extend(laws.iter().map(|(model, stress)| line(model, stress)));
    Ok(Comparison {
        name: "treloar",
        title: "Rubber: equibiaxial stress from the uniaxial curve",
        source: "L. R. G. Treloar, Trans. Faraday Soc. 40, 1944.",
        unit: "kPa",
        argument: "stretch",
        rows,
        remarks: vec![
            "The uniaxial points, joined by a monotone spline, are the only input.".to_owned(),
            "Below a stretch of 1.07 the curve rests on one uniaxial point, at 1.02.".to_owned(),
        ],
        axes: [
            PlotAxis { name: "stretch (–)", range: [1.0, 1.45], decimals: 2, labels: 7 },
            PlotAxis { name: "nominal stress (kPa)", range: [0.0, 600.0], decimals: 0, labels: 7 },
        ],
        series,
    })
}
