//! Human skin pulled in vivo between two pads: force over displacement.
//!
//! Uses `table`. Used by `mod`.

use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use implant_preview_core::curve::{Curve, CurveError, CurveSpec, ScaledCurve};

/// Displacement \[mm\] and force \[N\].
const MEASURED: [(f64, f64); 10] = [
    (1.0, -0.005),
    (2.0, 0.011),
    (3.0, 0.029),
    (4.0, 0.037),
    (5.0, 0.053),
    (6.0, 0.080),
    (7.0, 0.104),
    (8.0, 0.155),
    (9.0, 0.326),
    (9.4, 0.397),
];
/// Width of the pads, distance between the pads and thickness of the skin \[mm\].
const PAD_WIDTH_MM: f64 = 8.0;
const PAD_DISTANCE_MM: f64 = 36.0;
const SKIN_MM: f64 = 1.5;
/// Strain scales of the preset \[-\] with their names: as it is, and the class `normal` of the clinical plan.
const SCALES: [(f64, &str); 2] =
    [(1.0, "skin preset as a strip"), (0.5, "skin preset with strain scale 0.5 as a strip")];

/// The comparison.
///
/// # Errors
/// A curve is invalid.
pub fn comparison() -> Result<Comparison, CurveError> {
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    series.push(Series {
        label: "measured".to_owned(),
        mark: Mark::Points,
        points: MEASURED.map(|(mm, force)| (mm / PAD_DISTANCE_MM, force)).to_vec(),
    });
    for (strain_scale, model) in SCALES {
        let curve = Curve::scaled(&ScaledCurve { strain_scale, ..CurveSpec::Skin {}.into() })?;
        // kPa·mm² = mN.
        let force = |strain: f64| 1e-3 * PAD_WIDTH_MM * SKIN_MM * curve.stress(strain);
        rows.extend(MEASURED.map(|(mm, measured)| Row {
            quantity: "force (N)".to_owned(),
            model: model.to_owned(),
            at: Some(mm / PAD_DISTANCE_MM),
            measured: Some(measured),
            range: None,
            predicted: Some(force(mm / PAD_DISTANCE_MM)),
        }));
        let (mm, last) = MEASURED[MEASURED.len() - 1];
        rows.push(Row {
            quantity: "force / width of the pads (N/m)".to_owned(),
            model: model.to_owned(),
            at: Some(mm / PAD_DISTANCE_MM),
            measured: Some(1e3 * last / PAD_WIDTH_MM),
            range: None,
            predicted: Some(SKIN_MM * curve.stress(mm / PAD_DISTANCE_MM)),
        });
        series.push(Series {
            label: model.to_owned(),
            mark: Mark::Line,
            points: (0..=56).map(|k| 0.005 * f64::from(k)).map(|e| (e, force(e))).collect(),
        });
    }
    Ok(Comparison {
        name: "skin-pull",
        title: "Human skin pulled in vivo",
        source: "Lavigne et al., open data: pads 8 mm wide, 36 mm apart.",
        unit: "unit of the row",
        argument: "strain",
        rows,
        remarks: vec![
            "The prediction is a free strip as wide as the pads, 1.5 mm thick. On the body the skin beside the strip is pulled \
             along, which raises the force; the fat below is left out."
                .to_owned(),
            "Held at 0.35 N, the force falls to 0.22 N within a minute. Relaxation is not modelled.".to_owned(),
        ],
        axes: [
            PlotAxis { name: "strain (–)", range: [0.0, 0.28], decimals: 2, labels: 7 },
            PlotAxis { name: "force (N)", range: [-0.05, 1.0], decimals: 1, labels: 7 },
        ],
        series,
    })
}
