//! Expanders: pressure days after a filling over that right after it.
//!
//! Uses `expander` (its scenes), `table`. Used by `mod`.

use super::expander::{filled, filling_scene};
use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use crate::solved;
use implant_preview_core::clinical::{Expander, SkinClass, When};
use implant_preview_core::scene::{Field, Layer, Scene, SceneError, SkinState, TissueModel};
use implant_preview_core::simulate::Simulator;

/// Fills \[ml\].
const FILLS_ML: [f64; 3] = [200.0, 300.0, 400.0];
/// Natural tension of the skin \[N/m\], the middle of what is measured on people.
const TENSION_N_PER_M: f64 = 20.0;
/// At most 10 mmHg three days after a filling to 30 mmHg and more \[-\].
const MEASURED: [f64; 2] = [0.0, 1.0 / 3.0];

/// Names of the states of the skin in the rows: those of a week as expected, with a standard deviation more of relaxation and growth, that of six
/// months, and growth to the end.
pub const STATES: [&str; 4] =
    ["after a week", "after a week (a deviation more)", "after six months", "grown in full"];

fn state(name: &str, own: SkinState) -> SkinState {
    let [week, later] = [When::Week, When::SixMonths].map(|when| own.at(when));
    match name {
        "after a week" => week,
        "after six months" => later,
        "grown in full" => SkinState { grown: 1.0, ..week },
        _ => SkinState {
            relaxed: When::Week.relaxed().range(Field::Relaxed.limits)[0],
            grown: When::Week.grown().range(Field::Grown.limits)[1],
            ..own
        },
    }
}

/// The expander under skin of a class and a natural tension.
fn scene(class: SkinClass, tension: f64, nodes: usize) -> Result<Scene, SceneError> {
    let mut plan = Scene::opening();
    let measured = plan.measured();
    plan.apply_patient(implant_preview_core::clinical::Measurements {
        skin_class: Some(class),
        ..measured
    })?;
    plan.set_natural_tension(tension)?;
    let mut scene = filling_scene(TissueModel::Layered, Layer::adipose(), nodes);
    scene.layers[0] = plan.layers[0].clone();
    scene.body.skin_state = plan.body.skin_state;
    Ok(scene)
}

/// The comparison.
///
/// # Errors
/// A scene is out of its limits.
pub fn comparison(nodes_per_side: usize) -> Result<Comparison, SceneError> {
    let skins = [
        ("normal skin without a tension", SkinClass::Normal, 0.0),
        ("normal skin", SkinClass::Normal, TENSION_N_PER_M),
        ("tight skin", SkinClass::Tight, TENSION_N_PER_M),
    ];
    let mut simulator = Simulator::default();
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    let ends = [FILLS_ML[0] - 20.0, FILLS_ML[2] + 20.0];
    series.push(Series::band("pigs, three days later", ends, MEASURED));
    for (name, class, tension) in skins {
        let table = scene(class, tension, nodes_per_side)?;
        let own = table.body.skin_state;
        let mut lines = STATES.map(|_| Vec::new());
        let patient = |source| SceneError::Patient { field: "expander", source };
        let expander = Expander::new(2.0 * table.implant.base_radius_mm).map_err(patient)?;
        for fill in FILLS_ML {
            let table = filled(&table, expander.dome(fill).map_err(patient)?);
            let mut pressure = |state: SkinState| -> Result<Option<f64>, SceneError> {
                let mut scene = table.clone();
                scene.body.skin_state = state;
                let found = solved(&mut simulator, scene)?;
                Ok(found.and_then(|found| Some(found.outcome.contact_pressure_mmhg?.mean)))
            };
            let before = pressure(own)?;
            for (state_name, line) in STATES.into_iter().zip(&mut lines) {
                let after = pressure(state(state_name, own))?;
                let ratio = before.zip(after).map(|(before, after)| after / before);
                line.extend(ratio.map(|ratio| (fill, ratio)));
                rows.push(Row {
                    quantity: "mean pressure later / right after filling".to_owned(),
                    model: format!("{name} {state_name}"),
                    at: Some(fill),
                    measured: None,
                    range: Some(MEASURED),
                    predicted: ratio,
                });
            }
        }
        for (state_name, points) in STATES.into_iter().zip(lines) {
            if tension > 0.0 && state_name != STATES[1] {
                series.push(Series {
                    label: format!("{name} {state_name}"),
                    mark: Mark::Line,
                    points,
                });
            }
        }
    }
    Ok(Comparison {
        name: "pressure-later",
        title: "Expander: pressure days after a filling / right after it",
        source: "Koger et al. (abstract): 8 pigs, 30 to 60 mmHg right after filling, at most 10 mmHg three days later in all.",
        unit: "",
        argument: "fill (ml)",
        rows,
        remarks: vec![
            format!(
                "The expander of the filling pressures over a flat chest. Skin under {TENSION_N_PER_M} N/m at rest; the model has no third day: a \
                 week has 0.5 of the tension above the natural one left and 0.3 of the stretch grown (0.4 and 0.5 with a deviation more), six \
                 months 0.5 and 0.8, both estimates that were not chosen from this source."
            ),
            "Fat does not relax in the model, and a shell that is not full folds: both lower what is measured.".to_owned(),
        ],
        axes: [
            PlotAxis { name: "fill (ml)", range: [ends[0], ends[1]], decimals: 0, labels: 7 },
            PlotAxis { name: "pressure / right after filling (–)", range: [0.0, 1.0], decimals: 1, labels: 6 },
        ],
        series,
    })
}
