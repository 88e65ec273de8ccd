//! Expanders: area stretch of pig skin over a filled expander, and pressure right after clinical filling.
//!
//! Uses `fat` (names), `table`. Used by `mod`.

use super::fat::{self, ADIPOSE, name};
use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use crate::solved;
use implant_preview_core::clinical::{Expander, Size};
use implant_preview_core::curve::{CurveSpec, Fat};
use implant_preview_core::measure::Outcome;
use implant_preview_core::measure::bands::FILLING_PRESSURE_MMHG;
use implant_preview_core::mesh::NodeKind;
use implant_preview_core::scene::{
    Body, CheckedScene, ChestShape, Implant, Layer, Scene, SceneError, TissueModel,
};
use implant_preview_core::simulate::Simulator;
use implant_preview_core::solve::{Solution, Tissue};
use implant_preview_core::springs::Material;
use implant_preview_core::springs::tension_field::stress;

/// Tolerance of the solutions \[base radius\].
const TOLERANCE: f64 = 1e-3;

/// Half-ellipsoid of the pig's expander, 60 ml: base radius and projection \[mm\]. The expander was rectangular.
const PIG_BASE_MM: f64 = 27.6;
const PIG_PROJECTION_MM: f64 = 37.5;
/// Thickness of the pig's skin, and assumed thickness of its fat \[mm\].
const PIG_SKIN_MM: f64 = 3.0;
const PIG_FAT_MM: f64 = 5.0;
/// Other thicknesses of the fat, for the sensitivity to the assumption \[mm\].
const PIG_OTHER_FAT_MM: [f64; 2] = [2.0, 10.0];
/// Radii of the pocket: the middle, the least and the greatest that suit the expander \[mm\].
const PIG_POCKETS_MM: [f64; 3] = [31.5, 28.0, 35.0];
/// Half of the side of the measured square of skin \[mm\].
const PIG_HALF_SIDE_MM: f64 = 50.0;
/// Statistics of the area stretch one hour after filling: name, value \[-\].
const PIG_MEASURED: [(&str, f64); 3] =
    [("mean area stretch", 0.99), ("90th percentile", 1.15), ("greatest area stretch", 1.50)];
/// Difference that the shape of the expander alone may cause \[-\].
const PIG_SHAPE: f64 = 0.15;

/// Area of pig skin on the animal by its area without stress \[-\]: 1.23 ± 0.16, and 1/0.83² of excised skin.
const PIG_NATURAL_AREAS: [f64; 4] = [1.23, 1.07, 1.39, 1.45];
/// What the name of a model under a natural tension has before the area.
pub const UNDER_TENSION: &str = "under skin of a natural area stretch of";

/// Names of the tissue models in the rows.
pub const SHEET: &str = "sheet";
/// Layered tissue with the curve `fat`.
pub const LAYERED_MID: &str = "layered fat mid";

/// Layers of solid fat with their names: the curves `fat` and the paper's adipose.
fn fats(thickness_mm: f64) -> Vec<(&'static str, Layer)> {
    let fat = |variant| {
        let curve = CurveSpec::Fat { variant }.into();
        (name(variant), Layer { thickness_mm, curve, ..Layer::adipose() })
    };
    let mut all: Vec<_> = Fat::ALL.into_iter().map(fat).collect();
    all.push((ADIPOSE, Layer { thickness_mm, ..Layer::paper_adipose() }));
    all
}

/// Mean, 90th percentile and greatest area stretch of the membrane over the measured square. Beyond a sheet the skin does not
/// move.
fn square_statistics(solution: &Solution) -> [f64; 3] {
    let problem = solution.problem();
    let (sheet, deformation) = (problem.sheet(), solution.deformation());
    let cell = sheet.spacing_mm().powi(2);
    let is_inside = |k: usize| {
        let at = sheet.rest()[k].abs();
        sheet.kinds()[k] == NodeKind::Free && at.max_element() <= PIG_HALF_SIDE_MM
    };
    let nodes = (0..sheet.len()).filter(|&k| is_inside(k));
    let mut values: Vec<(f64, f64)> = nodes.map(|k| (deformation.area_stretch(k), cell)).collect();
    let moved: f64 = values.iter().map(|(_, area)| area).sum();
    if problem.tissue == Tissue::Sheet {
        values.push((1.0, (4.0 * PIG_HALF_SIDE_MM * PIG_HALF_SIDE_MM - moved).max(0.0)));
    }
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let total: f64 = values.iter().map(|(_, area)| area).sum();
    let mean = values.iter().map(|(j, area)| j * area).sum::<f64>() / total;
    let mut below = 0.0;
    let percentile = values.iter().find(|(_, area)| {
        below += area;
        below >= 0.9 * total
    });
    [mean, percentile.map_or(mean, |(j, _)| *j), values.last().map_or(mean, |(j, _)| *j)]
}

fn pig_scene(model: TissueModel, pocket_mm: f64, fat: Option<Layer>, nodes: usize) -> Scene {
    let mut layers = vec![Layer { thickness_mm: PIG_SKIN_MM, ..Layer::skin() }];
    layers.extend(fat);
    let mut scene = Scene {
        implant: Implant {
            base_radius_mm: PIG_BASE_MM,
            projection_mm: PIG_PROJECTION_MM,
            ..Implant::default()
        },
        pocket_radius_mm: pocket_mm,
        body: Body::around(pocket_mm, model),
        layers,
        ..Scene::default()
    };
    scene.solver.nodes_per_side = nodes;
    scene.solver.tolerance = TOLERANCE;
    scene
}

/// The natural tension that stretches the skin of a scene to an area by its area without stress \[N/m\].
fn tension_of_area(scene: &Scene, area: f64) -> Result<f64, SceneError> {
    let checked = CheckedScene::new(scene.clone())?;
    let Material { curve, poisson_ratio, thickness_mm, .. } = &checked.materials()[0];
    Ok(thickness_mm * stress(curve, *poisson_ratio, [area.sqrt() - 1.0; 2])[0])
}

/// Area stretch of pig skin over an expander of 60 ml: data, prediction and chart in one piece.
///
/// # Errors
/// A scene is out of its limits.
pub fn pig(nodes_per_side: usize) -> Result<Comparison, SceneError> {
    let is_middle = |pocket: f64| pocket.to_bits() == PIG_POCKETS_MM[0].to_bits();
    let layered = TissueModel::Layered;
    let mut scenes = Vec::new();
    for pocket in PIG_POCKETS_MM {
        scenes.push((SHEET.to_owned(), TissueModel::Sheet, pocket, None));
        for (name, fat) in fats(PIG_FAT_MM) {
            if name == fat::name(Fat::Mid) || is_middle(pocket) {
                scenes.push((format!("layered {name}"), layered, pocket, Some(fat)));
            }
        }
    }
    for thickness_mm in PIG_OTHER_FAT_MM {
        let fat = Layer { thickness_mm, ..Layer::adipose() };
        let name = format!("{LAYERED_MID} of {thickness_mm} mm");
        scenes.push((name, layered, PIG_POCKETS_MM[0], Some(fat)));
    }
    let mut scenes: Vec<_> = scenes
        .into_iter()
        .map(|(name, model, pocket, fat)| (name, pig_scene(model, pocket, fat, nodes_per_side)))
        .collect();
    for area in PIG_NATURAL_AREAS {
        let fat = Layer { thickness_mm: PIG_FAT_MM, ..Layer::adipose() };
        let mut scene = pig_scene(layered, PIG_POCKETS_MM[0], Some(fat), nodes_per_side);
        scene.body.skin_state.natural_tension_n_per_m = tension_of_area(&scene, area)?;
        scenes.push((format!("{LAYERED_MID} {UNDER_TENSION} {area}"), scene));
    }
    let mut simulator = Simulator::default();
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (name, scene) in scenes {
        let pocket = scene.pocket_radius_mm;
        let found = solved(&mut simulator, scene)?;
        let statistics = found.map(|found| square_statistics(&found.solution));
        let model = format!("{name} pocket {pocket} mm");
        for (k, (quantity, measured)) in PIG_MEASURED.into_iter().enumerate() {
            rows.push(Row {
                quantity: quantity.to_owned(),
                model: model.clone(),
                at: None,
                measured: Some(measured),
                range: Some([measured - PIG_SHAPE, measured + PIG_SHAPE]),
                predicted: statistics.map(|all| all[k]),
            });
        }
        let is_drawn = is_middle(pocket)
            && !name.ends_with(" mm")
            && (!name.contains(UNDER_TENSION) || name.ends_with(&PIG_NATURAL_AREAS[0].to_string()));
        if let Some(all) = statistics.filter(|_| is_drawn) {
            let points = (1_u8..).map(f64::from).zip(all).collect();
            lines.push(Series { label: name, mark: Mark::Line, points });
        }
    }
    rows.sort_by_key(|row| PIG_MEASURED.iter().position(|(name, _)| *name == row.quantity));
    let at = |k: usize| (k + 1) as f64;
    let mut series = Vec::new();
    for (k, (_, value)) in PIG_MEASURED.into_iter().enumerate() {
        let label = if k == 0 { "measured ± 0.15 (shape of the expander)" } else { "" };
        let heights = [value - PIG_SHAPE, value + PIG_SHAPE];
        series.push(Series::band(label, [at(k) - 0.06, at(k) + 0.06], heights));
    }
    series.push(Series {
        label: "measured on pigs".to_owned(),
        mark: Mark::Points,
        points: PIG_MEASURED.iter().enumerate().map(|(k, (_, value))| (at(k), *value)).collect(),
    });
    series.extend(lines);
    let [dome, base] = dome_and_base_cm2();
    Ok(Comparison {
        name: "pig-expander",
        title: "Pig skin over an expander of 60 ml: area stretch",
        source: "Han, Lee, Gosain, Buganza Tepole, Acta Biomater. 2022: 10 × 10 cm of skin, one hour \
                 after filling.",
        unit: "",
        argument: "–",
        rows,
        remarks: vec![
            format!(
                "Area stretch is J = area / area before, not J − 1: the half-ellipsoid of 60 ml has {dome:.0} cm² on a base of \
                 {base:.0} cm², so the mean over 100 cm² with a fixed border is at most {:.2}; a mean of 1.99 is impossible for \
                 60 ml. A mean of 0.99 means that the square's border moved inwards, or that the skin at rest was under tension.",
                1.0 + (dome - base) / 100.0
            ),
            "The skin is the preset of human skin, 3 mm, not pig skin; 5 mm of fat are assumed. The rectangular expander is a \
             half-ellipsoid of its volume here, which alone may change a value by 0.15."
                .to_owned(),
            "In the sheet skin beyond the pocket does not move: its area stretch is 1.".to_owned(),
            "Pig skin on the animal has 1.45 times the area that it has once excised (0.83 × 0.83, Buganza Tepole et al. 2015, PMC4520804, abstract), \
             by another figure 1.23 ± 0.16 (secondary source): the rows under a natural tension have such skin at rest; their area stretches are \
             relative to the skin on the animal, as measured."
                .to_owned(),
        ],
        axes: [
            PlotAxis { name: "1: mean, 2: 90th percentile, 3: greatest", range: [0.8, 3.2], decimals: 0, labels: 3 },
            PlotAxis { name: "area stretch (–)", range: [0.8, 3.4], decimals: 1, labels: 7 },
        ],
        series,
    })
}

/// Areas of the pig's half-ellipsoid, prolate, and of its base \[cm²\].
fn dome_and_base_cm2() -> [f64; 2] {
    let (r, p) = (PIG_BASE_MM / 10.0, PIG_PROJECTION_MM / 10.0);
    let base = std::f64::consts::PI * r * r;
    let eccentricity = (1.0 - (r / p).powi(2)).sqrt();
    [base * (1.0 + p / (r * eccentricity) * eccentricity.asin()), base]
}

/// Fills of the clinical expander \[ml\].
const FILLS_ML: [f64; 4] = [100.0, 200.0, 300.0, 400.0];
/// Strain scale of tight skin \[-\].
const TIGHT: f64 = 0.25;

/// Names of the quantities of the filling curve.
pub const GREATEST_PRESSURE: &str = "greatest contact pressure";
/// The mean pressure.
pub const MEAN_PRESSURE: &str = "mean contact pressure";

pub(super) fn filling_scene(model: TissueModel, fat: Layer, nodes: usize) -> Scene {
    // Derived values stay as they are.
    let mut scene = Scene { chest: None, patient: None, ..Scene::opening() };
    scene.implant.fill = None;
    scene.set_tissue_model(model);
    if let Some(layer) = scene.layers.get_mut(1) {
        layer.curve = fat.curve;
        layer.poisson_ratio = fat.poisson_ratio;
    }
    scene.solver.nodes_per_side = nodes;
    scene.solver.tolerance = TOLERANCE;
    scene
}

pub(super) fn filled(scene: &Scene, size: Size) -> Scene {
    let mut scene = scene.clone();
    scene.implant.projection_mm = size.projection_mm();
    scene
}

/// Pressure right after filling, over the fill.
///
/// # Errors
/// A scene is out of its limits.
pub fn filling(nodes_per_side: usize) -> Result<Comparison, SceneError> {
    let layered = TissueModel::Layered;
    let mut scenes = vec![(
        "sheet with fat mid".to_owned(),
        filling_scene(TissueModel::Sheet, Layer::adipose(), nodes_per_side),
    )];
    for (name, fat) in fats(1.0) {
        scenes.push((format!("layered {name}"), filling_scene(layered, fat, nodes_per_side)));
    }
    let mut tight = filling_scene(layered, Layer::adipose(), nodes_per_side);
    if let Some(skin) = tight.layers.first_mut() {
        skin.curve.strain_scale = TIGHT;
    }
    scenes.push(("layered fat mid under tight skin".to_owned(), tight));
    let mut curved = filling_scene(layered, Layer::adipose(), nodes_per_side);
    curved.chest = Some(ChestShape::USUAL);
    scenes.push(("layered fat mid over a usual chest".to_owned(), curved));
    let (low, high) = FILLING_PRESSURE_MMHG;
    let (mut rows, mut series) = (Vec::new(), Vec::new());
    series.push(Series::band("measured right after filling", [0.0, 420.0], [low, high]));
    let mut simulator = Simulator::default();
    for (model, scene) in scenes {
        let patient = |source| SceneError::Patient { field: "expander", source };
        let expander = Expander::new(2.0 * scene.implant.base_radius_mm).map_err(patient)?;
        let mut points = vec![(0.0, 0.0)];
        for fill in FILLS_ML {
            let size = expander.dome(fill).map_err(patient)?;
            let found = solved(&mut simulator, filled(&scene, size))?;
            let pressure = |of: &Outcome| of.contact_pressure_mmhg;
            let pressure = found.as_ref().and_then(|found| pressure(&found.outcome));
            points.extend(pressure.map(|pressure| (fill, pressure.max)));
            for (quantity, predicted) in [
                (GREATEST_PRESSURE, pressure.map(|p| p.max)),
                (MEAN_PRESSURE, pressure.map(|p| p.mean)),
            ] {
                rows.push(Row {
                    quantity: quantity.to_owned(),
                    model: model.clone(),
                    at: Some(fill),
                    measured: None,
                    range: Some([low, high]),
                    predicted,
                });
            }
        }
        series.push(Series { label: model, mark: Mark::Line, points });
    }
    rows.sort_by_key(|row| row.quantity == MEAN_PRESSURE);
    Ok(Comparison {
        name: "filling-pressure",
        title: "Expander: pressure right after filling",
        source: "Clinical filling of expanders: 30–60 mmHg right after filling. In one study of pigs blood flow was near zero above \
                 80 mmHg.",
        unit: "mmHg",
        argument: "fill (ml)",
        rows,
        remarks: vec![
            "The opening plan: base 12 cm, pocket 14 cm, 1.5 mm of normal skin (strain scale 0.5; tight 0.25) over 8.5 mm of fat. \
             The predictions are contact pressures of the tissue's own elastic resistance over a fill from empty."
                .to_owned(),
            "The measured range is of no known fill, base or tissue: surgeons fill until the skin is tight, in several \
             sessions, and the shell, the capsule and muscle over the expander add pressure. The difference is the distance \
             from the range."
                .to_owned(),
        ],
        axes: [
            PlotAxis { name: "fill (ml)", range: [0.0, 420.0], decimals: 0, labels: 7 },
            PlotAxis { name: "greatest pressure (mmHg)", range: [0.0, 120.0], decimals: 0, labels: 7 },
        ],
        series,
    })
}
