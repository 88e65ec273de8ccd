//! The plan that the app opens on, part by part: what plane, void, new fold, posture, tension, time and fill each cost and bring.
//!
//! Uses `scene`, `simulate`. Used by the command line and the tests.

use crate::solved;
use implant_preview_core::clinical::When;
use implant_preview_core::measure::Outcome;
use implant_preview_core::scene::{Fill, Plane, Posture, Scene, SceneError};
use implant_preview_core::simulate::Simulator;
use std::fmt::Write;

/// Nodes per side of the scenes.
pub const NODES_PER_SIDE: usize = 65;
/// Natural tension of the skin \[N/m\].
const TENSION_N_PER_M: f64 = 20.0;
/// Void of the pocket \[ml\]: what fluid is left after days.
const VOID_ML: f64 = 10.0;
/// How much lower the new fold is \[mm\].
const NEW_FOLD_MM: f64 = 14.0;

/// A column: title with its unit, decimals, value of a result.
type Column = (&'static str, usize, fn(&Outcome) -> Option<f64>);

const COLUMNS: [Column; 12] = [
    ("force (N)", 2, |of| of.contact_force_n),
    ("mean pressure (mmHg)", 1, |of| Some(of.contact_pressure_mmhg?.mean)),
    ("greatest", 1, |of| Some(of.contact_pressure_mmhg?.max)),
    ("greatest stretch (%)", 1, |of| Some(100.0 * of.strain.as_ref()?.max_principal)),
    ("of which added", 1, |of| {
        let strain = of.strain.as_ref()?;
        let added = strain.added.map_or(strain.max_principal, |added| added.max_principal);
        Some(100.0 * added)
    }),
    ("area / before", 3, |of| of.area_ratio),
    ("implant's height (mm)", 2, |of| of.projection_mm),
    ("projection of the skin (mm)", 2, |of| of.skin_projection_mm),
    ("cover over the apex (mm)", 2, |of| Some(of.cover_mm?.apex)),
    ("reserve used", 2, |of| of.skin_reserve_used),
    ("cycles", 0, |of| Some(f64::from(of.solver.cycles))),
    ("work units", 0, |of| Some(of.solver.work_units)),
];

/// A form of the opening plan with its result.
#[derive(Clone, Debug)]
pub struct Part {
    /// What the plan has.
    pub name: String,
    /// The values of the columns; `None` without an answer.
    pub values: Vec<Option<f64>>,
}

/// The forms of the plan, from the one without any part.
fn forms() -> Result<Vec<(String, Scene)>, SceneError> {
    let plain = Scene::opening();
    let mut tense = plain.clone();
    tense.set_natural_tension(TENSION_N_PER_M)?;
    let filled = |fill: Fill, plan: &Scene| {
        let mut scene = plan.clone();
        scene.implant.fill = Some(fill);
        scene
    };
    let under = |plane| {
        let mut scene = filled(Fill::Cohesive, &plain);
        scene.set_plane(Some(plane));
        scene
    };
    let mut closed = filled(Fill::Cohesive, &plain);
    closed.body.pocket_void_ml = Some(VOID_ML);
    let posed = |posture| {
        let mut scene = filled(Fill::Cohesive, &plain);
        scene.body.posture = posture;
        scene
    };
    let mut lowered = filled(Fill::Cohesive, &plain);
    lowered.body.pocket_lowered_mm = NEW_FOLD_MM;
    let mut all = vec![
        ("rigid, skin without a tension".to_owned(), plain.clone()),
        ("cohesive".to_owned(), filled(Fill::Cohesive, &plain)),
        ("cohesive, dual plane II".to_owned(), under(Plane::DualPlaneIi)),
        ("cohesive, below the muscle".to_owned(), under(Plane::Below)),
        (format!("cohesive, a void of {VOID_ML} ml"), closed),
        (format!("cohesive, new fold {NEW_FOLD_MM} mm lower"), lowered),
        ("cohesive, standing".to_owned(), posed(Posture::Standing)),
        ("cohesive, lying".to_owned(), posed(Posture::Lying)),
        (format!("skin under {TENSION_N_PER_M} N/m"), tense.clone()),
    ];
    for when in [When::Week, When::SixMonths] {
        all.push((format!("the same {}", when.words()), tense.at(when)));
    }
    for (name, fill) in Fill::NAMED {
        let soft = filled(fill, &tense);
        let words = name.replace('_', "-");
        all.push((format!("{words} under {TENSION_N_PER_M} N/m"), soft.clone()));
        all.push((
            format!("{words}, the same {}", When::SixMonths.words()),
            soft.at(When::SixMonths),
        ));
    }
    Ok(all)
}

/// The opening plan's forms with their results.
///
/// # Errors
/// A scene is out of its limits.
pub fn parts() -> Result<Vec<Part>, SceneError> {
    let mut simulator = Simulator::default();
    let solve = |(name, mut scene): (String, Scene)| {
        scene.solver.nodes_per_side = NODES_PER_SIDE;
        let found = solved(&mut simulator, scene)?;
        let value = |(_, _, of): &Column| found.as_ref().and_then(|found| of(&found.outcome));
        Ok(Part { name, values: COLUMNS.iter().map(value).collect() })
    };
    forms()?.into_iter().map(solve).collect()
}

/// The forms as a table in Markdown.
#[must_use]
pub fn markdown(parts: &[Part]) -> String {
    let titles = COLUMNS.map(|(title, ..)| title).join(" | ");
    let mut text = format!("| plan | {titles} |\n|{}\n", " --- |".repeat(1 + COLUMNS.len()));
    for Part { name, values } in parts {
        let cell = |(value, (_, decimals, _)): (&Option<f64>, &Column)| {
            value.map_or_else(|| "–".to_owned(), |value| format!("{value:.decimals$}"))
        };
        let cells: Vec<String> = values.iter().zip(&COLUMNS).map(cell).collect();
        // Writing to a String cannot fail.
        let _ = writeln!(text, "| {name} | {} |", cells.join(" | "));
    }
    text
}
