//! Layered tissue compared with the axisymmetric reference, its invariants, and the contract of its scenes and results.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::curve::{CurveSpec, Fat};
use implant_preview::measure::{Fields, Outcome, SolverMethod, Status};
use implant_preview::scene::{CellsThrough, CheckedScene, Layer, Scene, Springs, TissueModel};
use implant_preview::simulate::{measure, run, simulate};
use implant_preview::solve::{Method, Options, Problem, Solver, Verdict};
use serde_json::{Value, json};
use std::f64::consts::TAU;
use std::sync::Arc;

/// A case of `tests/reference/layered.json` on its two finest meshes.
struct Case {
    fine: Value,
    finest: Value,
}

impl Case {
    fn all() -> Vec<Self> {
        let file: Value = serde_json::from_str(include_str!("reference/layered.json")).unwrap();
        let all = file["cases"].as_array().unwrap().clone();
        all.chunks(3)
            .map(|meshes| Self { fine: meshes[1].clone(), finest: meshes[2].clone() })
            .collect()
    }

    /// The limit of a result on ever finer meshes, of first order: 144 and 216 cells along the radius.
    fn limit(&self, of: impl Fn(&Value) -> f64) -> f64 {
        let (fine, finest) = (of(&self.fine["result"]), of(&self.finest["result"]));
        finest + 2.0 * (finest - fine)
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

fn scene_of(case: &Value, nodes: usize, tolerance: f64) -> Scene {
    let mut layers = case["layers"].clone();
    for layer in layers.as_array_mut().unwrap() {
        if let Value::String(kind) = layer["curve"].clone() {
            layer["curve"] = json!({ "kind": kind });
        }
    }
    let solids_mm: f64 =
        layers.as_array().unwrap()[1..].iter().map(|l| number(&l["thickness_mm"])).sum();
    let cells = if solids_mm > 15.0 { 4 } else { 2 };
    let scene = json!({
        "implant": { "base_radius_mm": case["base_radius_mm"], "projection_mm": case["projection_mm"] },
        "pocket_radius_mm": case["pocket_radius_mm"],
        "patch_radius_mm": case["patch_radius_mm"],
        "attachment": { "stiffness_kpa_per_mm": case["attachment_kpa_per_mm"],
                        "ramp_mm": case["attachment_ramp_mm"] },
        "insertion": case["insertion"],
        "layers": layers,
        "solver": { "nodes_per_side": nodes, "tolerance": tolerance, "cells_through": cells },
    });
    Scene::from_json(&scene.to_string()).unwrap()
}

/// Errors of a result: greatest error of the skin's profile / base radius, relative errors of the force and of the
/// membrane's height above the apex.
fn errors(case: &Case, outcome: &Outcome) -> [f64; 3] {
    let radius = number(&case.finest["base_radius_mm"]);
    let profile = &outcome.profile_skin;
    assert_eq!(profile.len(), 41);
    let skin = profile
        .iter()
        .enumerate()
        .map(|(k, point)| {
            let expected = [0, 1].map(|axis| case.limit(|r| number(&r["skin"][k][axis])));
            (point.r_mm - expected[0]).hypot(point.z_mm - expected[1]) / radius
        })
        .fold(0.0, f64::max);
    let force =
        outcome.contact_force_n.unwrap() / case.limit(|r| number(&r["contact_force_n"])) - 1.0;
    // The reference's cover ends at the membrane.
    let apex = number(&case.finest["projection_mm"]);
    let cover = (profile[0].z_mm - apex) / case.limit(|r| number(&r["cover_at_apex_mm"])) - 1.0;
    [skin, force.abs(), cover.abs()]
}

#[test]
fn the_shape_converges_to_the_axisymmetric_reference() {
    for case in Case::all() {
        let of = |nodes| errors(&case, &simulate(&scene_of(&case.finest, nodes, 1e-4)).unwrap());
        let (coarse, fine) = (of(33), of(65));
        let name = &case.finest["name"];
        println!("{name}: skin, force, cover {coarse:.4?} at 33, {fine:.4?} at 65");
        let [skin, force, cover] = fine;
        assert!(skin < 8e-3 && force < 0.03 && cover < 0.02, "{name}: {fine:?}");
        assert!(skin < coarse[0], "{name}: {coarse:?} {fine:?}");
    }
}

fn distance(a: &Solver, b: &Solver) -> f64 {
    let radius = a.problem().obstacle.dome.reference_length();
    let layers = |solver: &Solver| {
        let mut layers = vec![solver.positions().to_vec()];
        layers.extend(solver.outer().iter().cloned());
        layers
    };
    let (a, b) = (layers(a), layers(b));
    let apart = a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| a.distance(*b));
    apart.fold(0.0, f64::max) / radius
}

fn solved(scene: &Scene, options: Options) -> Solver {
    let mut solver = Solver::with_options(scene.problem().unwrap(), options);
    solver.advance(&mut || false);
    solver
}

/// Random scenes within realistic ranges, half of them off centre; a third has linear fat, the others fat as measured.
fn realistic(count: usize, nodes: usize, seed: u64) -> Vec<Scene> {
    let mut rng = fastrand::Rng::with_seed(seed);
    let mut between = move |low: f64, high: f64| low + (high - low) * rng.f64();
    (0..count)
        .map(|k| {
            let radius = between(40.0, 90.0);
            let offset = if k % 2 == 0 { 0.0 } else { between(0.0, 0.25 * radius) };
            let angle = between(0.0, TAU);
            let pocket = (radius * between(1.0, 1.3)).max(radius + offset);
            let stiffness = between(2.0, 20.0);
            let curve = match k % 3 {
                0 => json!({ "kind": "linear", "modulus_kpa": stiffness }),
                _ => {
                    let variant = ["low", "mid", "high"][k / 3 % 3];
                    json!({ "kind": "fat", "variant": variant })
                }
            };
            let scene = json!({
                "implant": { "base_radius_mm": radius, "projection_mm": radius * between(0.39, 1.07),
                             "center_mm": [offset * angle.cos(), offset * angle.sin()] },
                "pocket_radius_mm": pocket.min(200.0),
                "insertion": between(0.2, 1.0),
                "layers": [
                    { "thickness_mm": between(1.0, 2.5), "poisson_ratio": between(0.3, 0.48) },
                    { "tissue": "adipose", "thickness_mm": between(5.0, 40.0),
                      "poisson_ratio": between(0.3, 0.495), "curve": curve } ],
                "solver": { "nodes_per_side": nodes, "tolerance": 1e-3 },
            });
            Scene::from_json(&scene.to_string()).unwrap()
        })
        .collect()
}

#[test]
fn realistic_scenes_converge_and_the_error_estimate_holds() {
    let scenes = realistic(48, 33, 3);
    let (mut converged, mut above) = (0, 0);
    for (k, scene) in scenes.iter().enumerate() {
        let rough = solved(scene, Options::default());
        let report = rough.report();
        let outcome = simulate(scene).unwrap();
        if outcome.status != Status::Converged {
            println!("{k}: {:?}", outcome.status);
            continue;
        }
        converged += 1;
        let mut exact = scene.clone();
        exact.solver.tolerance = 2e-5;
        let error = distance(&rough, &solved(&exact, Options::default()));
        let estimate = report.estimated_position_error.unwrap();
        let found = format!("{k}: error {error:.1e}, estimate {estimate:.1e}");
        if error > estimate + 2e-5 {
            println!("{found}");
            above += 1;
        }
        assert!(error < 2.0 * estimate + 2e-5, "{found}");
    }
    assert!(converged >= 47, "{converged} of 48");
    assert!(above <= 2, "{above} errors above their estimate");
}

#[test]
fn a_quarter_and_a_half_of_the_patch_have_the_shape_of_the_whole() {
    for center in [[0.0, 0.0], [8.0, 0.0]] {
        let mut scene = realistic(1, 33, 8).remove(0);
        scene.implant.center_mm = center;
        scene.pocket_radius_mm = scene.implant.base_radius_mm + 20.0;
        scene.solver.tolerance = 1e-5;
        scene.repair();
        let part = solved(&scene, Options::default());
        let whole = solved(&scene, Options { use_symmetry: false, ..Options::default() });
        let apart = distance(&part, &whole);
        assert!(apart < 1e-4, "{center:?}: {apart:.1e}");
        assert!(part.nodes_solved() < whole.nodes_solved());
    }
}

/// A scene with the paper's fat, which softens.
fn papers_fat(nodes: usize) -> Scene {
    Scene::from_json(&papers_fat_file(nodes).to_string()).unwrap()
}

fn papers_fat_file(nodes: usize) -> Value {
    json!({ "implant": { "base_radius_mm": 55 }, "pocket_radius_mm": 70,
        "layers": [{}, { "tissue": "adipose", "thickness_mm": 10, "curve": { "kind": "adipose" } }],
        "solver": { "nodes_per_side": nodes, "tolerance": 1e-3, "cells_through": 2 } })
}

#[test]
fn results_add_cover_layers_skin_area_and_traction() {
    let outcome = simulate(&papers_fat(65)).unwrap();
    let cover = outcome.cover_mm.unwrap();
    // 6.1 mm of fat and skin of 1.5 mm, stretched 1.21-fold both ways.
    assert!((cover.apex - 7.2).abs() < 0.1 && cover.least <= cover.apex + 1e-3, "{cover:?}");
    let skin = outcome.skin_area.unwrap();
    assert!((skin.pocket_after_cm2 / skin.pocket_before_cm2 - 1.2454).abs() < 5e-3, "{skin:?}");
    let gained = skin.patch_after_cm2 - skin.patch_before_cm2;
    assert!(gained > skin.pocket_after_cm2 - skin.pocket_before_cm2, "{skin:?}");
    assert!((outcome.area_after_cm2.unwrap() - skin.pocket_after_cm2).abs() < 1e-9);
    let fat = &outcome.layers[1];
    // 6.1 mm at the apex, a little less beside it.
    assert!((fat.thickness_mm.unwrap().least - 6.0).abs() < 0.15, "{fat:?}");
    assert!(fat.max_stretch.unwrap() > 1.2);
    let traction = outcome.attachment_traction_kpa.unwrap();
    let at = traction.at_mm[0].hypot(traction.at_mm[1]);
    assert!(traction.max > 0.1 && (70.0..85.0).contains(&at), "{traction:?}");
    assert_eq!((outcome.profile.len(), outcome.profile_skin.len()), (41, 41));
    assert!((outcome.profile[40].s_mm - 70.0).abs() < 1e-9);
    assert!((outcome.profile_skin[40].s_mm - 130.0).abs() < 1e-9);
    assert_eq!(outcome.contact_angle_deg, None);
}

#[test]
fn a_scene_of_either_tissue_model_is_read_as_it_is_written() {
    let sheet = r#"{ "tissue_model": "sheet", "implant": { "base_radius_mm": 50 } }"#;
    let sheet = Scene::from_json(sheet).unwrap();
    let mut layered = sheet.clone();
    layered.set_tissue_model(TissueModel::Layered);
    for scene in [sheet, layered] {
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    }
}

#[test]
fn invalid_fields_of_layered_tissue_are_refused_in_one_line() {
    let refused = |fields: &str| {
        let scene = format!(r#"{{ "implant": {{ "base_radius_mm": 55 }}, {fields} }}"#);
        let error = Scene::from_json(&scene).unwrap_err().to_string();
        assert!(error.lines().count() == 1 && error.len() < 250, "{error}");
        error
    };
    assert!(refused(r#""springs": "nikolaev""#).contains("springs"));
    assert!(
        refused(r#""patch_radius_mm": 75"#)
            .contains("patch_radius_mm is 75; allowed: 90 to 260 mm")
    );
    assert!(refused(r#""attachment": { "stiffness_kpa_per_mm": 0 }"#).contains("0.1 to 50 kPa/mm"));
    assert!(refused(r#""attachment": { "ramp_mm": 41 }"#).contains("1 to 40 mm"));
    assert!(refused(r#""attachment": { "width": 1 }"#).contains("unknown field"));
    assert!(refused(r#""attachment": [2, 10]"#).contains("one JSON object"));
    assert!(refused(r#""tissue_model": "jelly""#).contains("layered"));
    assert!(refused(r#""solver": { "cells_through": 9 }"#).contains("1 to 8"));
    assert!(refused(r#""solver": { "cells_through": "many" }"#).contains("auto"));
}

#[test]
fn a_scene_without_schema_is_layered_tissue() {
    let least = r#"{ "implant": { "base_radius_mm": 55 } }"#;
    let scene = Scene::from_json(least).unwrap();
    assert_eq!(scene, Scene::default());
    let fat = &scene.layers[1];
    assert_eq!(fat.curve.spec, CurveSpec::Fat { variant: Fat::Mid });
    assert!((fat.poisson_ratio - 0.49).abs() < 1e-12);
    let body = scene.body;
    assert_eq!(body.tissue_model, TissueModel::Layered);
    assert!((body.patch_radius_mm - 130.0).abs() < 1e-12);
    assert!((body.attachment.stiffness_kpa_per_mm - 2.0).abs() < 1e-12);
    assert!((body.attachment.ramp_mm - 10.0).abs() < 1e-12);
    assert_eq!(scene.solver.cells_through.unwrap_or_default(), CellsThrough::Auto);
    let with_schema =
        r#"{ "schema": "implant-preview/scene/1", "implant": { "base_radius_mm": 55 } }"#;
    assert_eq!(Scene::from_json(with_schema).unwrap(), scene);
    let sheet = r#"{ "tissue_model": "sheet", "implant": { "base_radius_mm": 55 } }"#;
    let mut sheet = Scene::from_json(sheet).unwrap();
    assert_eq!((sheet.is_layered(), &sheet.layers), (false, &scene.layers));
    // The paper's sheet has its own fat.
    sheet.layers[1] = Layer::paper_adipose();
    assert_eq!(sheet, Scene::sheet());
}

#[test]
fn the_papers_springs_belong_to_a_sheet() {
    let with = |field: &str| {
        Scene::from_json(&format!(
            r#"{{ "implant": {{ "base_radius_mm": 55 }}, "springs": "nikolaev"{field} }}"#
        ))
    };
    let refused = "springs is nikolaev; allowed: coupled in layered tissue, the default; \
                   nikolaev with tissue_model sheet";
    for field in ["", r#", "tissue_model": "layered""#] {
        assert_eq!(with(field).unwrap_err().to_string(), refused);
    }
    assert_eq!(with(r#", "tissue_model": "sheet""#).unwrap().springs, Springs::Nikolaev);
    // A change of the springs or of the model keeps the scene valid.
    let mut scene = Scene::default();
    scene.set_springs(Springs::Nikolaev);
    assert!(!scene.is_layered() && scene.springs == Springs::Nikolaev);
    assert_eq!(scene.validate(), Ok(()));
    scene.set_springs(Springs::Coupled);
    assert!(!scene.is_layered());
    scene.set_springs(Springs::Nikolaev);
    scene.set_tissue_model(TissueModel::Layered);
    assert_eq!(scene, Scene::default());
}

#[test]
fn a_sheet_ignores_patch_attachment_and_cells() {
    let sheet = |fields: &str| {
        Scene::from_json(&format!(
            r#"{{ "tissue_model": "sheet",
                  "implant": {{ "base_radius_mm": 55 }}, {fields} }}"#
        ))
    };
    let mut scene = sheet(
        r#""patch_radius_mm": 70, "attachment": { "stiffness_kpa_per_mm": 0, "ramp_mm": 90 },
           "solver": { "cells_through": 20 }"#,
    )
    .unwrap();
    assert!(scene.same_physics(&sheet(r#""insertion": 1"#).unwrap()));
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    for (fields, wanted) in [
        (r#""patch_radius_mm": -1"#, "patch_radius_mm is -1; allowed: 0 mm or more"),
        (r#""attachment": { "ramp_mm": -1 }"#, "attachment.ramp_mm is -1; allowed: 0 mm or more"),
        (
            r#""attachment": { "stiffness_kpa_per_mm": -1 }"#,
            "attachment.stiffness_kpa_per_mm is -1; allowed: 0 kPa/mm or more",
        ),
    ] {
        assert_eq!(sheet(fields).unwrap_err().to_string(), wanted);
    }
    assert!(sheet(r#""patch_radius_mm": "wide""#).is_err());
    // The change to layered tissue moves the values into their limits.
    scene.set_tissue_model(TissueModel::Layered);
    assert_eq!(scene.validate(), Ok(()));
    let body = scene.body;
    assert_eq!((body.patch_radius_mm, body.attachment.ramp_mm), (90.0, 40.0));
    assert_eq!(scene.solver.cells_through, Some(CellsThrough::Count(8)));
    scene.solver.cells_through = Some(CellsThrough::Count(0));
    let error = scene.validate().unwrap_err().to_string();
    assert_eq!(error, "solver.cells_through is 0; allowed: \"auto\" or 1 to 8");
}

#[test]
fn a_record_of_layered_tissue_restores_its_solution() {
    let checked = CheckedScene::new(papers_fat(33)).unwrap();
    let simulation = run(&checked, Options::default(), None);
    let json = serde_json::to_string(&simulation.solution.record()).unwrap();
    let record = serde_json::from_str(&json).unwrap();
    let restored = implant_preview::solve::Solution::restore(checked.problem(), record).unwrap();
    assert_eq!(restored.faces(), simulation.solution.faces());
    assert_eq!(restored.faces().len(), 3);
    assert_eq!(restored.reactions().force, simulation.solution.reactions().force);
}

#[test]
fn fine_grids_thin_fat_and_domes_off_centre_need_no_second_attempt() {
    let scene = |nodes: usize, fat: f64, center: [f64; 2]| {
        let mut scene = papers_fat(nodes);
        scene.layers[1].thickness_mm = fat;
        scene.implant.center_mm = center;
        scene
    };
    // Each once ended in an oscillation at the pocket's edge, or in cells much flatter than wide.
    for (nodes, fat, center) in [
        (97, 10.0, [0.0, 0.0]),
        (129, 10.0, [6.0, 0.0]),
        (65, 1.0, [0.0, 0.0]),
        (65, 20.0, [4.0, 3.0]),
    ] {
        let outcome = simulate(&scene(nodes, fat, center)).unwrap();
        let solver = &outcome.solver;
        assert_eq!(outcome.status, Status::Converged, "{nodes} {fat} {center:?}");
        assert!(!solver.fell_back, "{nodes} {fat} {center:?}");
    }
}

#[test]
fn a_second_attempt_starts_on_a_finer_grid() {
    // The coarsest grid has few nodes over these domes.
    let wide = json!({ "patch_radius_mm": 260 });
    let small = json!({ "implant": { "base_radius_mm": 20 }, "pocket_radius_mm": 35 });
    for change in [wide, small] {
        let mut scene = papers_fat_file(65);
        for (name, value) in change.as_object().unwrap() {
            scene[name] = value.clone();
        }
        let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{change}");
        assert!(outcome.solver.fell_back, "{change}");
    }
}

/// Newton's method in f64 knows nothing of the multigrid: its start, its second derivatives and its contact are its own.
#[test]
fn newtons_method_finds_the_shape_of_multigrid() {
    for mut scene in realistic(8, 33, 5) {
        let multigrid = solved(&scene, Options::default());
        assert_eq!(multigrid.report().method, Method::Multigrid { cycles: multigrid.cycles() });
        let tolerance = scene.solver.tolerance;
        scene.solver.tolerance = 1e-7;
        let newton = solved(&scene, Options { method: Method::Newton, ..Options::default() });
        assert_eq!(newton.verdict(), Verdict::Converged, "{}", scene.to_json());
        assert_eq!(newton.report().method, Method::Newton);
        let error = distance(&multigrid, &newton);
        let estimate = multigrid.estimated_position_error();
        assert!(error <= tolerance && error <= 2.0 * estimate, "{error:e} {estimate:e}");
    }
}

/// From a shape Newton's method stays on its branch: nearer to the equilibrium, with far less work than from rest.
#[test]
fn a_refined_solution_is_that_of_a_smaller_tolerance() {
    let mut scene = papers_fat(33);
    let coarse = solved(&scene, Options::default());
    let refined = coarse.refined(1e-7, 1.0);
    scene.solver.tolerance = 1e-7;
    let newton = solved(&scene, Options { method: Method::Newton, ..Options::default() });
    assert_eq!((refined.verdict(), newton.verdict()), (Verdict::Converged, Verdict::Converged));
    let (before, after) = (distance(&coarse, &newton), distance(&refined, &newton));
    assert!(before > 1e-6 && after < 4e-7, "{before:e} {after:e}");
    assert!(refined.work_units() < 0.7 * newton.work_units(), "{}", refined.work_units());
}

/// The limit of work of all grids holds within an iteration, too, on every grid.
#[test]
fn newtons_method_ends_at_its_limit_of_work() {
    const FACTOR: f64 = 0.05;
    for nodes in [33, 65] {
        let scene = papers_fat(nodes);
        let options =
            Options { method: Method::Newton, work_limit_factor: FACTOR, ..Options::default() };
        let solver = solved(&scene, options);
        let Problem { rest, .. } = solver.problem();
        let cells = rest.cells().len() * rest.sheet().free_nodes();
        // 9e6 evaluations of a cell, and one piece of work.
        let most = FACTOR * 9e6 / cells as f64 + 15.0;
        let work = solver.work_units();
        assert_ne!(solver.verdict(), Verdict::Converged, "{nodes}: {work}");
        assert!(work > most - 30.0 && work <= most, "{nodes}: {work} of {most}");
    }
}

/// f32 resolves tolerances down to 1e-5; Newton's method completes the solve.
#[test]
fn newtons_method_reaches_small_tolerances() {
    let mut scene = papers_fat(33);
    scene.solver.tolerance = 1e-7;
    let solver = solved(&scene, Options::default());
    assert_eq!(solver.verdict(), Verdict::Converged);
    assert!(!solver.fell_back() && solver.report().method == Method::Newton);
    assert!(solver.estimated_position_error() <= 1e-7);
}

/// Thin adipose on few nodes, pressed on the flat wall beside the implant: both attempts of multigrid failed where it did not slide there.
#[test]
fn thin_tissue_on_the_wall_converges_by_multigrid() {
    let scene = json!({ "implant": { "base_radius_mm": 85, "projection_mm": 34, "center_mm": [-6, -21] },
        "pocket_radius_mm": 110,
        "layers": [ { "thickness_mm": 1.5, "poisson_ratio": 0.36 },
            { "tissue": "adipose", "thickness_mm": 3, "poisson_ratio": 0.3 } ],
        "solver": { "nodes_per_side": 21, "tolerance": 1e-3 } });
    let outcome = simulate(&Scene::from_json(&scene.to_string()).unwrap()).unwrap();
    assert_eq!(outcome.status, Status::Converged);
    assert_eq!(outcome.solver.method, SolverMethod::Multigrid);
    assert!(!outcome.solver.fell_back, "{:?}", outcome.solver);
}

fn contact_force(solver: &Solver) -> f64 {
    let fields = Fields::new(Arc::new(solver.solution()));
    measure(&papers_fat(33), &fields).contact_force_n.unwrap()
}

/// A used solver takes a problem with more layers of nodes on the same grid.
#[test]
fn a_solver_restarts_with_more_layers() {
    let mut scene = papers_fat(17);
    scene.solver.cells_through = Some(CellsThrough::Count(1));
    let whole = scene.clone();
    scene.layers.truncate(1);
    let mut solver = solved(&scene, Options::default());
    solver.restart(whole.problem().unwrap());
    solver.advance(&mut || false);
    assert_eq!(solver.verdict(), Verdict::Converged);
    assert!(distance(&solver, &solved(&whole, Options::default())) < 1e-3);
}

/// Another thickness of the fat is another tissue at rest under the same law: the tables stay.
#[test]
fn a_solver_restarts_with_thicker_fat_and_its_tables() {
    let mut scene = papers_fat(17);
    scene.solver.cells_through = Some(CellsThrough::Count(2));
    let mut solver = solved(&scene, Options::default());
    scene.layers[1].thickness_mm *= 1.5;
    solver.restart(scene.problem().unwrap());
    solver.advance(&mut || false);
    assert_eq!((solver.verdict(), solver.tables_built()), (Verdict::Converged, 1));
    assert!(distance(&solver, &solved(&scene, Options::default())) < 1e-12);
    scene.layers[1].poisson_ratio = 0.4;
    solver.restart(scene.problem().unwrap());
    assert_eq!(solver.tables_built(), 2);
}

/// The augmented pressure of multigrid has the fixed point of the law that Newton's method solves.
#[test]
fn nearly_incompressible_tissue_has_the_shape_and_the_force_of_its_law() {
    for (poisson_ratio, center) in [(0.485, [0.0, 0.0]), (0.495, [0.0, 0.0]), (0.49, [6.0, 3.0])] {
        let mut scene = papers_fat(33);
        scene.implant.center_mm = center;
        scene.layers[1].poisson_ratio = poisson_ratio;
        scene.solver.tolerance = 1e-3;
        let problem = scene.problem().unwrap();
        let run = |method, tolerance: f64| {
            let problem = Problem { tolerance, ..problem.clone() };
            let mut solver =
                Solver::with_options(problem, Options { method, ..Options::default() });
            solver.advance(&mut || false);
            assert_eq!(solver.verdict(), Verdict::Converged, "{poisson_ratio} {method:?}");
            let force = contact_force(&solver);
            (solver, force)
        };
        let (multigrid, force) = run(Method::Automatic, 1e-3);
        let (newton, exact_force) = run(Method::Newton, 1e-7);
        assert!(!multigrid.fell_back() && multigrid.report().method != Method::Newton);
        let error = distance(&multigrid, &newton);
        assert!(error < 1e-3, "{poisson_ratio}: {error:e}");
        let error = force / exact_force - 1.0;
        assert!(error.abs() < 3e-3, "{poisson_ratio}: {force} {exact_force}");
    }
}

#[test]
fn a_scene_without_a_shape_has_no_figures() {
    let mut scene = papers_fat(33);
    scene.layers[1].curve =
        serde_json::from_value(json!({ "kind": "linear", "modulus_kpa": 1e-6 })).unwrap();
    let outcome = simulate(&scene).unwrap();
    assert_eq!(outcome.status, Status::Unstable);
    assert!(outcome.warnings[0].starts_with("The solver found no shape"), "{:?}", outcome.warnings);
    assert!(outcome.contact_force_n.is_none() && outcome.cover_mm.is_none());
    let mut flat = papers_fat(33);
    flat.insertion = 0.0;
    let outcome = simulate(&flat).unwrap();
    assert!((outcome.skin_projection_mm.unwrap() - 11.5).abs() < 1e-3);
    assert!(outcome.cover_mm.is_none());
    // Written without a sign.
    assert_eq!(outcome.contact_force_n.unwrap().to_string(), "0");
}

#[test]
fn a_poisson_ratio_out_of_reach_is_said() {
    let said = |poisson_ratio: f64| {
        let mut scene = papers_fat(33);
        scene.layers[0].poisson_ratio = 0.5;
        scene.layers[1].poisson_ratio = poisson_ratio;
        let outcome = simulate(&scene).unwrap();
        assert_eq!(outcome.status, Status::Converged, "{poisson_ratio}");
        outcome.warnings.iter().any(|warning| warning.starts_with("The Poisson ratio of adipose"))
    };
    assert!(said(0.5) && !said(0.495));
}
