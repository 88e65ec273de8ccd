//! Augmented breasts: what of an implant's projection the breast gains, and what of its height the implant keeps in the body.
//!
//! Uses `table`. Used by `mod`.

use super::table::{Comparison, Mark, PlotAxis, Row, Series};
use crate::solved;
use implant_preview_core::body::deform::{deform, deform_marks};
use implant_preview_core::body::fit::{BodyFit, FitError, Settings, fit};
use implant_preview_core::body::marks::Side;
use implant_preview_core::body::mound::change;
use implant_preview_core::body::read::Unit;
use implant_preview_core::body::torso::{Tape, Torso, shaped};
use implant_preview_core::clinical::When;
use implant_preview_core::scene::{Fill, Scene, SceneError};
use implant_preview_core::simulate::{Simulation, Simulator};

/// Projection of the implant, 12 cm wide: 302 ml \[mm\].
const PROJECTION_MM: f64 = 40.0;
/// Natural tension of the skin \[N/m\], the middle of what is measured on people.
const TENSION_N_PER_M: f64 = 20.0;
/// Tolerance of the solutions \[base radius\].
const TOLERANCE: f64 = 1e-3;
/// Gain of projection / projection of the implant \[-\]: 58.7 mm of 72.7 expected, for implants of 38 to 42 mm.
const TEPPER: [f64; 2] = [0.63, 0.67];
/// The nipple moves 23 mm forwards, for implants of 40 to 45 mm \[-\].
const JI: [f64; 2] = [0.5, 0.6];
/// Projection of cohesive implants in the body / before − 1 \[-\].
const IN_BODY: f64 = -0.035;

/// Names of the breasts in the rows.
pub const FLAT: &str = "flat chest";
/// The opening plan's chest.
pub const CURVED: &str = "usual chest";
/// The built-in torso, and one with a small breast.
pub const BREAST: &str = "breast of 374 ml";
/// The small breast.
pub const SMALL: &str = "breast of 200 ml";
/// Volume of the small breast \[ml\]: women who are augmented have less than the mean of 340.
const SMALL_ML: f64 = 200.0;
/// Quantity of the rows of projection.
pub const GAIN: &str = "gain of projection (Tepper)";
/// Name of an implant that does not yield.
pub const RIGID: &str = "rigid";

/// An augmented breast.
#[derive(Clone, Debug)]
struct Augmented {
    breast: &'static str,
    fill: &'static str,
    when: When,
    /// Gain of projection / projection of the implant \[-\]; `None` without an answer.
    gain: Option<f64>,
    /// Way of the nipple forwards / projection of the implant \[-\].
    nipple: Option<f64>,
    /// Height of the implant in the body / its projection − 1 \[-\].
    lower: Option<f64>,
}

/// A body that was fitted on its left side.
struct Body {
    torso: Torso,
    fit: BodyFit,
}

/// A breast before the operation.
struct Before {
    name: &'static str,
    scene: Scene,
    body: Option<Body>,
}

/// The built-in torso with a breast of a volume, fitted on its left side.
fn on_torso(name: &'static str, breast_volume_ml: f64) -> Result<Before, SceneError> {
    let settings = Settings::default();
    let refused =
        |error: FitError| SceneError::Json { path: name.to_owned(), problem: error.to_string() };
    let (torso, _) = shaped(&Tape { breast_volume_ml, ..Tape::OWN }).map_err(refused)?;
    let fit = fit(&torso.surface, &torso.marks, Side::Left, &settings).map_err(refused)?;
    let marks = (&torso.marks, Side::Left);
    let scene = Scene::of_body(&fit, marks, settings.cover_mm, Unit::Mm)?;
    Ok(Before { name, scene, body: Some(Body { torso, fit }) })
}

/// The plan's implant and skin over a flat and a curved chest under thin tissue, and on torsos with breasts.
fn breasts() -> Result<[Before; 4], SceneError> {
    let opening = Scene::opening();
    let flat = Scene { chest: None, ..opening.clone() };
    let mut all = [
        Before { name: FLAT, scene: flat, body: None },
        Before { name: CURVED, scene: opening, body: None },
        on_torso(SMALL, SMALL_ML)?,
        on_torso(BREAST, Tape::OWN.breast_volume_ml)?,
    ];
    for before in &mut all {
        before.scene.implant.projection_mm = PROJECTION_MM;
        before.scene.set_natural_tension(TENSION_N_PER_M)?;
    }
    Ok(all)
}

impl Before {
    /// What the breast's projection gains, and the way of its nipple forwards \[mm\]: of a body as its measures have both, over the bare chest.
    fn gain(&self, found: &Simulation) -> Option<[f64; 2]> {
        let Some(Body { torso, fit }) = &self.body else {
            return Some([found.outcome.skin_projection_mm? - self.scene.tissue_mm(); 2]);
        };
        let frame = self.scene.placement.as_ref()?.frame();
        let skin = deform(&torso.surface, &frame, &found.solution);
        let marks = deform_marks(&torso.marks, &[(frame, &found.solution)]);
        let bodies = [(&torso.surface, &torso.marks), (&skin, &marks)];
        let change = change(fit, bodies, Side::Left)?;
        Some([change.after.projection_mm - change.before.projection_mm, change.nipple_mm.z])
    }
}

fn fills() -> impl Iterator<Item = (&'static str, Option<Fill>)> {
    let yielding = Fill::NAMED.into_iter().map(|(name, fill)| (name, Some(fill)));
    std::iter::once((RIGID, None)).chain(yielding)
}

fn solutions(nodes_per_side: usize) -> Result<Vec<Augmented>, SceneError> {
    let mut simulator = Simulator::default();
    let mut all = Vec::new();
    for before in &breasts()? {
        for when in [When::OnTheTable, When::SixMonths] {
            for (name, fill) in fills() {
                let mut scene = before.scene.at(when);
                scene.implant.fill = fill;
                scene.solver.nodes_per_side = nodes_per_side;
                scene.solver.tolerance = TOLERANCE;
                let found = solved(&mut simulator, scene)?;
                let of = |length: f64| length / PROJECTION_MM;
                let gains = found.as_ref().and_then(|found| before.gain(found));
                let [gain, nipple] = [0, 1].map(|k: usize| gains.map(|gains| of(gains[k])));
                let body = found.and_then(|found| found.outcome.implant_in_body);
                let lower = body.map(|body| of(body.height_mm) - 1.0);
                let breast = before.name;
                all.push(Augmented { breast, fill: name, when, gain, nipple, lower });
            }
        }
    }
    Ok(all)
}

/// Gain of projection and height of the implant in the body.
///
/// # Errors
/// A scene is out of its limits.
pub fn comparisons(nodes_per_side: usize) -> Result<[Comparison; 2], SceneError> {
    let all = solutions(nodes_per_side)?;
    Ok([projection(&all), in_body(&all)])
}

fn model(of: &Augmented) -> String {
    format!("{} {} {}", of.breast, of.fill.replace('_', "-"), of.when.words())
}

fn projection(all: &[Augmented]) -> Comparison {
    let mut rows = Vec::new();
    for of in all {
        for (quantity, range, predicted) in
            [(GAIN, TEPPER, of.gain), ("way of the nipple forwards (Ji)", JI, of.nipple)]
        {
            rows.push(Row {
                quantity: quantity.to_owned(),
                model: model(of),
                at: None,
                measured: None,
                range: Some(range),
                predicted,
            });
        }
    }
    rows.sort_by_key(|row| row.quantity != GAIN);
    let count = fills().count() as f64;
    let mut series = vec![
        Series::band("Tepper: 28 breasts", [0.7, count + 0.3], TEPPER),
        Series::band("Ji: 13 women; the nipple", [0.7, count + 0.3], JI),
    ];
    for line in all.chunks(fills().count()) {
        let points = (1_u8..).map(f64::from).zip(line);
        series.push(Series {
            label: format!("{} {}", line[0].breast, line[0].when.words()),
            mark: Mark::Line,
            points: points.filter_map(|(at, of)| Some((at, of.gain?))).collect(),
        });
    }
    Comparison {
        name: "projection",
        title: "Augmentation: gain of projection / projection of the implant",
        source: "Tepper, Karp, Ann Plast Surg 2009 (abstract): 14 women, 28 breasts, day 143, projection 58.7 mm of 72.7 expected. Ji, Luan 2014 \
                 (abstract): 13 women, dual plane, 12 months, nipple 23 ± 11 mm forwards.",
        unit: "",
        argument: "–",
        rows,
        remarks: vec![
            "Neither abstract names the implants: the ranges are those of projections of 38 to 42 mm (Tepper) and 40 to 45 mm (Ji). With them \
             unknown this is a check of consistency, no validation."
                .to_owned(),
            format!(
                "The plan: implant of 12 cm, {PROJECTION_MM} mm, 302 ml, skin of class normal under {TENSION_N_PER_M} N/m; 10 mm of tissue over a \
                 flat and over a usual chest, where the nipple is the apex; the built-in torso with a breast of 374 and with one of 200 ml, centred on its marks."
            ),
            "The gels were chosen from tests of implants between plates, the tension from measurements of skin, growth from studies that \
             include Ji's: none from the gains."
                .to_owned(),
        ],
        axes: [
            PlotAxis {
                name: "1: rigid, 2: form-stable, 3: cohesive, 4: soft, 5: saline",
                range: [0.5, count + 0.5],
                decimals: 0,
                labels: 5,
            },
            PlotAxis { name: "gain of projection (–)", range: [0.3, 1.0], decimals: 1, labels: 8 },
        ],
        series,
    }
}

fn in_body(all: &[Augmented]) -> Comparison {
    let cohesive = || all.iter().filter(|of| Fill::Cohesive.name() == Some(of.fill));
    let rows = cohesive().map(|of| Row {
        quantity: "height of the implant in the body / before − 1".to_owned(),
        model: model(of),
        at: None,
        measured: Some(IN_BODY),
        range: None,
        predicted: of.lower,
    });
    let points = (1_u8..).map(f64::from).zip(cohesive());
    let points: Vec<_> = points.filter_map(|(at, of)| Some((at, 100.0 * of.lower?))).collect();
    let last = cohesive().count() as f64;
    Comparison {
        name: "implant-in-body",
        title: "Cohesive implants in the body: change of their projection",
        source: "PubMed 17694253 (abstract): 9 women, 18 implants under the muscle, six weeks, MRI.",
        unit: "",
        argument: "–",
        rows: rows.collect(),
        remarks: vec![
            "The abstract has neither sizes nor tissue of the women; no muscle lies over the implants here.".to_owned(),
            "24 women, five years, MRI (Aesth Plast Surg 2019, abstract): soft cohesive implants of high profile have no significant loss \
             against the catalogue."
                .to_owned(),
        ],
        axes: [
            PlotAxis {
                name: "flat, usual chest, small and usual breast: on the table and after six months",
                range: [0.5, last + 0.5],
                decimals: 0,
                labels: 8,
            },
            PlotAxis { name: "change of the projection (%)", range: [-20.0, 0.0], decimals: 0, labels: 5 },
        ],
        series: vec![
            Series {
                label: "measured".to_owned(),
                mark: Mark::Points,
                points: vec![(0.6, 100.0 * IN_BODY), (last + 0.4, 100.0 * IN_BODY)],
            },
            Series { label: "cohesive".to_owned(), mark: Mark::Line, points },
        ],
    }
}
