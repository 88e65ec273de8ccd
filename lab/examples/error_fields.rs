//! Writes the changes of the skin by two cycles of the finest grid, an early and a late one, over the patch: which modes of the
//! error the cycles leave. Six scenes, as SVG:
//!
//! ```sh
//! cargo run --release -p implant-preview-lab --example error_fields > docs/notes/error-fields.svg
//! ```

#![allow(clippy::print_stdout, reason = "the picture is the output")]

use implant_preview_core::mesh::NodeKind;
use implant_preview_core::scene::{Scene, SceneError};
use implant_preview_core::solve::{Method, Options, Solver};
use implant_preview_lab::robustness::clinical::Clinical;
use std::fmt::Write;

const NODES: usize = 33;
/// Cycles of the finest grid before the cycle that is drawn.
const CYCLES: [u32; 2] = [1, 6];
/// Side of a panel and of a node in it \[px\].
const PANEL: usize = 165;
const NODE: usize = 5;
/// Colours of half a decade each, from 1e-6 of the base radius.
const COLOURS: [&str; 8] =
    ["#e9f0f4", "#c6dbe6", "#94bdd3", "#5f98bb", "#3b6fa0", "#6a4c93", "#b03a6b", "#d1362f"];
const LEAST: f64 = 1e-6;

/// An anatomical implant 12 cm wide over a chest of a radius across and along \[mm\].
fn anatomical(
    fat_mm: f64,
    projection_mm: f64,
    lower_mm: f64,
    chest: &str,
) -> Result<Scene, SceneError> {
    Scene::from_json(&format!(
        r#"{{ "implant": {{ "base_radius_mm": 60, "projection_mm": {projection_mm}, "base_height_mm": 108,
              "apex_shift_mm": {lower_mm} }},
            "pocket_radius_mm": 70, "patch_radius_mm": 130, "chest": {chest},
            "layers": [
              {{ "tissue": "skin", "thickness_mm": 1.5, "poisson_ratio": 0.45,
                 "curve": {{ "kind": "skin", "strain_scale": 0.5 }} }},
              {{ "tissue": "adipose", "thickness_mm": {fat_mm}, "poisson_ratio": 0.49,
                 "curve": {{ "kind": "fat" }} }} ],
            "solver": {{ "nodes_per_side": {NODES}, "tolerance": 1e-3 }} }}"#
    ))
}

fn scenes() -> Result<Vec<(String, Scene)>, SceneError> {
    let usual = r#"{ "radius_across_mm": 140 }"#;
    let hollow = r#"{ "radius_across_mm": -200, "radius_along_mm": -200 }"#;
    let bodies = Clinical { has_terrain: true, nodes_per_side: NODES, ..Clinical::default() };
    let body = |is_round: bool| {
        let of = (0..100).map(|case| (case, bodies.scene(11, case)));
        let named = |(case, scene)| (format!("random body {case}"), scene);
        of.filter(|(_, scene)| scene.implant.is_round() == is_round).map(named).next()
    };
    let mut scenes = vec![
        (
            "usual chest, fat 8.5, projection 30, lower by 20".to_owned(),
            anatomical(8.5, 30.0, 20.0, usual)?,
        ),
        ("usual chest, 20, 45, 20".to_owned(), anatomical(20.0, 45.0, 20.0, usual)?),
        ("usual chest, 35, 55, 10".to_owned(), anatomical(35.0, 55.0, 10.0, usual)?),
        ("hollow of 200, 17.5, 40, 0".to_owned(), anatomical(17.5, 40.0, 0.0, hollow)?),
    ];
    scenes.extend(body(true).map(|(name, scene)| (name + ", round", scene)));
    scenes.extend(body(false).map(|(name, scene)| (name + ", anatomical", scene)));
    Ok(scenes)
}

/// The change of every node of the skin by the cycle after `cycles` \[base radius\]; `None` outside of the patch.
fn changes(scene: &Scene, cycles: u32) -> Result<Vec<Option<f64>>, SceneError> {
    let after = |cycles: u32| -> Result<Solver, SceneError> {
        let options = Options { method: Method::Multigrid { cycles }, ..Options::default() };
        let mut solver = Solver::with_options(scene.problem()?, options);
        solver.advance(&mut || false);
        Ok(solver)
    };
    let (before, after) = (after(cycles)?, after(cycles + 1)?);
    let skin = |solver: &Solver, k: usize| solver.outer().last().map(|skin| skin[k]);
    let kinds = before.problem().sheet().kinds();
    let change = |k: usize| {
        let pair = skin(&before, k).zip(skin(&after, k));
        pair.filter(|_| kinds[k] != NodeKind::Outside)
            .map(|(a, b)| a.distance(b) / scene.implant.base_radius_mm)
    };
    Ok((0..kinds.len()).map(change).collect())
}

/// Draws a field at a place, a path a colour.
fn draw(svg: &mut String, [x, y]: [usize; 2], field: &[Option<f64>]) -> std::fmt::Result {
    let colour = |k: usize| {
        let half_decades = 2.0 * (field[k]?.max(LEAST) / LEAST).log10();
        Some((half_decades as usize).min(COLOURS.len() - 1))
    };
    for (level, fill) in COLOURS.iter().enumerate() {
        let mut path = String::new();
        for j in 0..NODES {
            let mut i = 0;
            while i < NODES {
                let from = i;
                while i < NODES && colour(j * NODES + i) == Some(level) {
                    i += 1;
                }
                if i > from {
                    // The head is up: rows count from the feet.
                    let row = y + (NODES - 1 - j) * NODE;
                    write!(path, "M{} {row}h{}", x + from * NODE, (i - from) * NODE)?;
                }
                i = i.max(from + 1);
            }
        }
        if !path.is_empty() {
            writeln!(svg, r#"<path stroke="{fill}" d="{path}"/>"#)?;
        }
    }
    Ok(())
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let scenes = scenes()?;
    let (wide, high) = (2 * PANEL + 40, PANEL + 44);
    let mut svg = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {} {}" font-family="sans-serif" font-size="12"><rect width="100%" height="100%" fill="white"/>"#,
        3 * wide,
        2 * high + 40
    );
    for (k, (name, scene)) in scenes.iter().enumerate() {
        let (x, y) = (12 + k % 3 * wide, k / 3 * high);
        writeln!(svg, r#"<text x="{x}" y="{}" font-weight="bold">{name}</text>"#, y + 16)?;
        for (panel, cycles) in CYCLES.into_iter().enumerate() {
            let field = changes(scene, cycles)?;
            let greatest = field.iter().flatten().copied().fold(0.0, f64::max);
            let x = x + panel * (PANEL + 8);
            let label = format!("cycle {}: at most {greatest:.1e} R", cycles + 1);
            writeln!(svg, r#"<text x="{x}" y="{}">{label}</text>"#, y + 32)?;
            writeln!(svg, r#"<g stroke-width="{NODE}">"#)?;
            draw(&mut svg, [x, y + 42], &field)?;
            svg += "</g>\n";
        }
    }
    for (level, fill) in COLOURS.iter().enumerate() {
        let (x, y) = (12 + level * 110, 2 * high + 10);
        let from = LEAST * 10_f64.powf(0.5 * level as f64);
        writeln!(svg, r#"<rect x="{x}" y="{y}" width="16" height="16" fill="{fill}"/>"#)?;
        writeln!(svg, r#"<text x="{}" y="{}">{from:.0e} R</text>"#, x + 22, y + 13)?;
    }
    println!("{svg}</svg>");
    Ok(())
}
