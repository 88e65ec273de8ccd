//! Checks of solved scenes: work of the contact force, order of convergence, axisymmetric references.
//!
//! Uses `check`, `accuracy`, `axisymmetric_layers`, `work_precision`, `scene`, `simulate`. Used by `mod`.

use super::check::{Bound, Check};
use crate::accuracy;
use crate::axisymmetric_layers::{self, Input, RestShape, Solution, Wall};
use crate::solved;
use crate::work_precision::Case;
use implant_preview_core::contact::HALF_ELLIPSOID;
use implant_preview_core::curve::CurveSpec;
use implant_preview_core::mesh::Attachment;
use implant_preview_core::scene::{
    Body, CellsThrough, ChestShape, Implant, Layer, Scene, SceneError, TissueModel,
};
use implant_preview_core::simulate::{Simulation, Simulator};

/// Tolerance of the solutions \[base radius\].
const TOLERANCE: f64 = 1e-4;
/// Gauss points and weights on 0 … 1, exact for polynomials of degree 9.
const GAUSS_5: [(f64, f64); 5] = [
    (0.046_910_077_030_668, 0.118_463_442_528_095),
    (0.230_765_344_947_158, 0.239_314_335_249_683),
    (0.5, 0.284_444_444_444_444),
    (0.769_234_655_052_842, 0.239_314_335_249_683),
    (0.953_089_922_969_332, 0.118_463_442_528_095),
];

/// Work of the contact force while the dome rises against the energy stored at full insertion.
pub(super) fn energy_balance() -> Result<Vec<Check>, SceneError> {
    let mut simulator = Simulator::default();
    let mut checks = Vec::new();
    for (place, model) in [("sheet", TissueModel::Sheet), ("layered tissue", TissueModel::Layered)]
    {
        let mut scene = Scene::opening();
        scene.implant.fill = None;
        scene.set_tissue_model(model);
        scene.solver.nodes_per_side = 65;
        scene.solver.tolerance = TOLERANCE;
        let mut force = |insertion: f64| -> Result<Option<Simulation>, SceneError> {
            solved(&mut simulator, Scene { insertion, ..scene.clone() })
        };
        let mut work = 0.0;
        for (insertion, weight) in GAUSS_5 {
            let found = force(insertion)?.and_then(|found| found.outcome.contact_force_n);
            // N·mm = mJ.
            work += weight * scene.implant.projection_mm * found.unwrap_or(f64::NAN);
        }
        let stored = force(1.0)?.map_or(f64::NAN, |found| 1e-3 * found.solution.elastic_energy());
        let place = format!("{place}; rigid opening plan; 65 nodes per side");
        let figure = (work / stored - 1.0).abs();
        checks.push(Check::at_most(
            "work of the contact force = stored energy",
            &place,
            figure,
            0.01,
        ));
    }
    Ok(checks)
}

/// Order of the root mean square of the errors from grid to grid, of a sheet.
pub(super) fn order(is_quick: bool) -> Result<Vec<Check>, SceneError> {
    let grids: &[usize] = if is_quick { &[33, 65] } else { &[33, 65, 129] };
    let mut checks = Vec::new();
    for case in [Case::LinearThird, Case::SkinEquator] {
        let mut errors = Vec::new();
        for nodes in grids {
            let row = accuracy::measure(case, false, *nodes)?;
            errors.push(row.map_or(f64::NAN, |row| row.faces[0].1.mean));
        }
        for (k, pair) in errors.windows(2).enumerate() {
            let place = format!("sheet; {}; {} to {}", case.name(), grids[k], grids[k + 1]);
            checks.push(Check {
                property: "order of convergence of the nodes".to_owned(),
                place,
                figure: (pair[0] / pair[1]).log2(),
                bound: Bound::AtLeast(1.7),
            });
        }
    }
    Ok(checks)
}

/// A scene with stiffening fat and the limit of the independent solution, extrapolated by second order from the two meshes of
/// `tests/reference/stiffening.json` and `tests/reference/body.json`.
struct Reference {
    name: &'static str,
    base_radius_mm: f64,
    projection_mm: f64,
    pocket_radius_mm: f64,
    skin_scale: f64,
    fat_mm: f64,
    poisson_ratio: f64,
    scale_kpa: f64,
    rate: f64,
    /// Radius of a spherical chest; `None`: flat.
    chest_mm: Option<f64>,
    force_n: f64,
    cover_mm: f64,
}

const STIFFENING: Reference = Reference {
    name: "stiffening",
    base_radius_mm: 60.0,
    projection_mm: 40.0,
    pocket_radius_mm: 70.0,
    skin_scale: 0.5,
    fat_mm: 8.5,
    poisson_ratio: 0.45,
    scale_kpa: 0.6,
    rate: 5.0,
    chest_mm: None,
    force_n: 15.759_94,
    cover_mm: 6.996_07,
};
const REFERENCES: [Reference; 3] = [
    STIFFENING,
    Reference {
        name: "steep",
        base_radius_mm: 55.0,
        projection_mm: 45.0,
        pocket_radius_mm: 65.0,
        skin_scale: 0.8,
        fat_mm: 15.0,
        poisson_ratio: 0.49,
        scale_kpa: 0.25,
        rate: 10.0,
        chest_mm: None,
        force_n: 29.211_18,
        cover_mm: 11.656_99,
    },
    Reference {
        name: "over a sphere",
        chest_mm: Some(150.0),
        force_n: 38.815_91,
        cover_mm: 6.026_58,
        ..STIFFENING
    },
];
/// Width of the patch around the pocket \[mm\].
const MARGIN_MM: f64 = 60.0;
/// Cells of the two meshes of the axisymmetric reference.
const MESHES: [[usize; 2]; 2] = [[72, 4], [144, 8]];
/// Cells through the thickness of the solver's grids.
const CELLS: [usize; 2] = [2, 4];

/// The limit of two meshes, one with cells half as wide, of second order.
fn richardson(coarse: f64, fine: f64) -> f64 {
    fine + (fine - coarse) / 3.0
}

impl Reference {
    fn scene(&self, nodes: usize, cells: usize) -> Scene {
        let (mut skin, mut fat) = (Layer::skin(), Layer::adipose());
        skin.curve.strain_scale = self.skin_scale;
        fat.thickness_mm = self.fat_mm;
        fat.poisson_ratio = self.poisson_ratio;
        fat.curve = CurveSpec::Exponential { scale_kpa: self.scale_kpa, rate: self.rate }.into();
        let mut scene = Scene {
            implant: Implant {
                base_radius_mm: self.base_radius_mm,
                projection_mm: self.projection_mm,
                ..Implant::default()
            },
            pocket_radius_mm: self.pocket_radius_mm,
            body: Body {
                patch_radius_mm: self.pocket_radius_mm + MARGIN_MM,
                ..Body::around(self.pocket_radius_mm, TissueModel::Layered)
            },
            chest: self.chest_mm.map(|radius| ChestShape {
                radius_across_mm: radius,
                radius_along_mm: Some(radius),
            }),
            layers: vec![skin, fat],
            ..Scene::default()
        };
        scene.solver.nodes_per_side = nodes;
        scene.solver.tolerance = TOLERANCE;
        scene.solver.cells_through = Some(CellsThrough::Count(cells));
        scene
    }

    /// The axisymmetric solutions on both meshes.
    fn meshes(&self, skin_wrinkles: bool) -> Result<Option<[Solution; 2]>, SceneError> {
        let problem = self.scene(33, 2).problem()?;
        let on = |cells: [usize; 2]| {
            axisymmetric_layers::solve(&Input {
                base_radius_mm: self.base_radius_mm,
                projection_mm: self.projection_mm,
                fullness: HALF_ELLIPSOID,
                insertion: 1.0,
                pocket_radius_mm: self.pocket_radius_mm,
                patch_radius_mm: self.pocket_radius_mm + MARGIN_MM,
                attachment: Attachment::default(),
                layers: problem.materials.clone(),
                skin_wrinkles,
                void_mm3: None,
                rest: RestShape { wall: Wall { radius_mm: self.chest_mm }, ..RestShape::default() },
                cells,
            })
            .ok()
        };
        Ok(on(MESHES[0]).zip(on(MESHES[1])).map(|(coarse, fine)| [coarse, fine]))
    }
}

fn cover(solution: &Solution) -> f64 {
    solution.apex_skin_mm - solution.apex_inner_mm
}

/// Errors of a result: greatest error of the skin's profile over the base radius, relative errors of force and cover.
fn errors(found: &Simulation, [coarse, fine]: &[Solution; 2]) -> [f64; 3] {
    let outcome = &found.outcome;
    let radius = found.solution.problem().obstacle.dome.reference_length();
    let apart = |(k, point): (usize, &implant_preview_core::measure::ProfilePoint)| {
        let limit = [0, 1].map(|axis| richardson(coarse.skin[k][axis], fine.skin[k][axis]));
        (point.r_mm - limit[0]).hypot(point.z_mm - limit[1]) / radius
    };
    let skin = outcome.profile_skin.iter().enumerate().map(apart).fold(0.0, f64::max);
    let force = richardson(coarse.contact_force_n, fine.contact_force_n);
    let cover_mm = richardson(cover(coarse), cover(fine));
    let profile = outcome.profile_skin.first().map_or(f64::NAN, |apex| apex.z_mm);
    let projection = found.solution.problem().obstacle.dome.apex().z;
    [
        skin,
        (outcome.contact_force_n.unwrap_or(f64::NAN) / force - 1.0).abs(),
        ((profile - projection) / cover_mm - 1.0).abs(),
    ]
}

/// Bounds of skin, force and cover on a grid.
fn bounds(nodes: usize) -> [f64; 3] {
    match nodes {
        ..65 => [0.01, 0.03, 0.03],
        65..129 => [0.005, 0.02, 0.01],
        _ => [0.005, 0.02, 0.005],
    }
}

/// The project's axisymmetric reference against the independent one, and the solver against the former: skin as a tension
/// field.
pub(super) fn references(grids: &[usize]) -> Result<Vec<Check>, SceneError> {
    let mut simulator = Simulator::default();
    let mut checks = Vec::new();
    for reference in &REFERENCES {
        let name = reference.name;
        let own = reference.meshes(false)?.map_or([f64::NAN; 2], |[coarse, fine]| {
            let force = richardson(coarse.contact_force_n, fine.contact_force_n);
            let cover_mm = richardson(cover(&coarse), cover(&fine));
            [force / reference.force_n - 1.0, cover_mm / reference.cover_mm - 1.0]
        });
        for (quantity, figure) in ["force", "cover"].into_iter().zip(own) {
            let property =
                format!("{quantity} of the axisymmetric reference = independent solution");
            checks.push(Check::at_most(&property, name, figure.abs(), 1e-3));
        }
        let limit = reference.meshes(true)?;
        for cells in CELLS {
            for &nodes in grids {
                let found = solved(&mut simulator, reference.scene(nodes, cells))?;
                let figures = match (&found, &limit) {
                    (Some(found), Some(limit)) => errors(found, limit),
                    _ => [f64::NAN; 3],
                };
                debug_assert!(
                    found.is_none_or(|found| found.solution.problem().rest.cells().len() == cells)
                );
                let place = format!("{name}; {nodes} nodes per side; {cells} cells");
                for ((quantity, figure), bound) in
                    ["skin", "force", "cover"].into_iter().zip(figures).zip(bounds(nodes))
                {
                    let property = format!("{quantity} = limit of the axisymmetric reference");
                    checks.push(Check::at_most(&property, &place, figure, bound));
                }
            }
        }
    }
    Ok(checks)
}
