//! Attempts, Newton's method and new starts.

use super::*;

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
