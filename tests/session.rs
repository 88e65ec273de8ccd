//! The session: edits, undo, rejected input, and no work without a change.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::clinical::Measurements;
use implant_preview::measure::bands::SkinLimits;
use implant_preview::measure::{Field, Outcome, Status};
use implant_preview::scene::{CellsThrough, Layer, Scene, Springs, TissueModel, Visit};
use implant_preview::session::{Command, Counters, Session};
use implant_preview::solve::{Displayed, Method, Options, Progress, Solver};
use implant_preview::view::picture::Picture;
use implant_preview::view::quantity::{Colouring, Quantity};
use implant_preview::view::section::{Opening, Section};

#[path = "session/gestures.rs"]
mod gestures;
#[path = "session/saved_work.rs"]
mod saved_work;

/// The default scene, of layered tissue.
fn small() -> Scene {
    let mut scene = Scene::default();
    scene.solver.nodes_per_side = 33;
    scene
}

/// The default scene as a sheet.
fn small_sheet() -> Scene {
    Scene { solver: small().solver, ..Scene::sheet() }
}

/// Both tissue models.
fn both() -> [Scene; 2] {
    [small(), small_sheet()]
}

fn edit(session: &mut Session, gesture: u64, change: impl FnOnce(&mut Scene)) {
    let mut scene = session.scene().clone();
    change(&mut scene);
    session.apply(Command::Edit { scene: Box::new(scene), gesture }).unwrap();
}

fn settle(session: &mut Session) {
    while session.advance(&mut || true) == Progress::Working {}
}

fn work(session: &mut Session, step: impl FnOnce(&mut Session)) -> Counters {
    let before = session.counters();
    step(session);
    let after = session.counters();
    Counters {
        solves: after.solves - before.solves,
        slices: after.slices - before.slices,
        work_units: after.work_units - before.work_units,
        coarse_work_units: after.coarse_work_units - before.coarse_work_units,
        measurements: after.measurements - before.measurements,
        solutions: after.solutions - before.solutions,
        recoveries: after.recoveries - before.recoveries,
        fields: after.fields - before.fields,
        tables: after.tables - before.tables,
        grids: after.grids - before.grids,
        stability_limits: after.stability_limits - before.stability_limits,
        previews: after.previews - before.previews,
        reverted: after.reverted - before.reverted,
        shared: after.shared - before.shared,
    }
}

#[test]
fn the_shape_is_path_independent() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        for insertion in [0.3, 0.97] {
            edit(&mut session, 1, |scene| scene.insertion = insertion);
            assert!(session.is_working());
            settle(&mut session);
        }
        let outcome = session.outcome().unwrap();
        assert_eq!(outcome.status, Status::Converged);
        assert!((outcome.projection_mm.unwrap() - 0.97 * 55.0).abs() < 1e-9);
        let mut at_once = start.clone();
        at_once.insertion = 0.97;
        let mut other = Session::new(at_once).unwrap();
        settle(&mut other);
        assert_eq!(session.shape(), other.shape());
    }
}

#[test]
fn symmetric_scenes_take_a_quarter_or_half_of_the_sheet_and_give_the_same_shape() {
    // Rounding of f32 grows with 1/(1 − 2ν) and with flatter cells; multigrid of layered tissue resolves 1e-5.
    let mut compressible = small();
    compressible.layers[1].poisson_ratio = 0.45;
    compressible.solver.cells_through = Some(CellsThrough::Count(2));
    for (start, rounding) in [(compressible, 1e-6), (small(), 5e-6), (small_sheet(), 1e-6)] {
        for (nodes, center_mm, share) in [
            (33, [0.0, 0.0], 0.3),
            (65, [0.0, 0.0], 0.28),
            (129, [0.0, 0.0], 0.27),
            (65, [3.0, 0.0], 0.53),
            (129, [0.0, -2.0], 0.52),
        ] {
            let mut scene = start.clone();
            scene.solver.nodes_per_side = nodes;
            scene.implant.center_mm = center_mm;
            let [part, whole] = [true, false].map(|use_symmetry| {
                let method = Method::Multigrid { cycles: 16 };
                let options = Options { method, use_symmetry, ..Options::default() };
                let mut solver = Solver::with_options(scene.problem().unwrap(), options);
                solver.advance(&mut || false);
                assert!(!solver.fell_back());
                solver
            });
            let (solved, all) = (part.nodes_solved() as f64, whole.nodes_solved() as f64);
            assert!(solved < share * all, "{nodes} {center_mm:?}: {}", solved / all);
            for (a, b) in part.positions().iter().zip(whole.positions()) {
                let error = a.distance(*b) / scene.implant.base_radius_mm;
                assert!(error < rounding, "{nodes} {center_mm:?}: {error:.1e}");
            }
        }
    }
}

#[test]
fn a_scene_without_a_stable_shape_has_no_shape_until_the_next_stable_scene() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        assert!(!session.has_no_shape());
        // A needle between the nodes of a coarse grid.
        edit(&mut session, 1, |scene| {
            scene.implant.projection_mm = 120.0;
            scene.solver.nodes_per_side = 17;
        });
        assert!(!session.has_no_shape(), "nothing is known yet");
        settle(&mut session);
        assert!(session.has_no_shape(), "{:?}", session.outcome());
        session.apply(Command::Undo).unwrap();
        settle(&mut session);
        assert!(!session.has_no_shape());
    }
}

#[test]
fn a_cancelled_solve_takes_an_edit_back_before_the_plan_that_was_opened() {
    let mut session = Session::new(small()).unwrap();
    settle(&mut session);
    let opened = Scene { insertion: 0.7, ..small() };
    session.apply(Command::Open(opened.to_json())).unwrap();
    edit(&mut session, 1, |scene| scene.insertion = 0.6);
    session.cancel();
    assert_eq!(session.scene(), &opened);
    assert!(session.is_working());
    session.cancel();
    assert_eq!(session.scene(), &small());
    session.apply(Command::Redo).unwrap();
    assert_eq!(session.scene(), &opened);
    settle(&mut session);
    edit(&mut session, 2, |scene| scene.insertion = 0.5);
    session.cancel();
    assert_eq!(session.scene(), &opened);
    // A plan that was opened and taken back is none to go back to, and the visit stays as it is.
    session.apply(Command::Open(Scene { insertion: 0.4, ..small() }.to_json())).unwrap();
    session.apply(Command::Undo).unwrap();
    session.cancel();
    assert_eq!(session.scene(), &opened);
    session.apply(Command::Open(Scene { insertion: 0.4, ..small() }.to_json())).unwrap();
    let visit = Some(Visit { surgeon: "Dr A".to_owned(), ..Visit::default() });
    edit(&mut session, 3, |scene| scene.visit.clone_from(&visit));
    edit(&mut session, 4, |scene| scene.insertion = 0.3);
    session.cancel();
    assert_eq!((session.scene().insertion, &session.scene().visit), (0.4, &visit));
}

#[test]
fn a_law_changed_at_zero_insertion_is_used_by_the_next_solve() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        edit(&mut session, 1, |scene| scene.insertion = 0.0);
        settle(&mut session);
        edit(&mut session, 2, |scene| scene.layers[0].poisson_ratio = 0.1);
        settle(&mut session);
        edit(&mut session, 3, |scene| scene.insertion = 1.0);
        settle(&mut session);
        let mut cold = Solver::new(session.scene().problem().unwrap());
        cold.advance(&mut || false);
        assert_eq!(session.shape(), cold.positions());
    }
}

#[test]
fn rejected_input_changes_nothing_and_is_reported_in_one_line() {
    let mut session = Session::new(small()).unwrap();
    settle(&mut session);
    let (scene, revision) = (session.scene().clone(), session.revision());
    for (json, expected) in [
        ("", "scene: is empty"),
        ("[1]", "scene"),
        (r#"{"implant":{"base_radius_mm":"big"}}"#, "implant.base_radius_mm"),
        (r#"{"implant":{"base_radius_mm":50,"x":1}}"#, "`x`"),
        (r#"{"implant":{"base_radius_mm":1e308}}"#, "is 1e308; allowed: 10 to 120 mm"),
        (r#"{"implant":[50]}"#, "expected one JSON object"),
        (
            r#"{"implant":{"base_radius_mm":50},"layers":[]}"#,
            "layers is a list of 0; allowed: 1 to 8 layers",
        ),
        (
            r#"{"implant":{"base_radius_mm":50},"layers":[{"poisson_ratio":0.6}]}"#,
            "layers[0].poisson_ratio is 0.6; allowed: 0 to 0.5",
        ),
        (r#"{"implant":{"base_radius_mm":50},"pocket_radius_mm":40}"#, "pocket_radius_mm is 40"),
        (
            r#"{"implant":{"base_radius_mm":100,"center_mm":[60,-80.5]}}"#,
            "implant.center_mm is 100.5 mm from the pocket's centre",
        ),
        (r#"{"schema":"implant-preview/scene/2","implant":{"base_radius_mm":50}}"#, "schema"),
        (
            r#"{"implant":{"base_radius_mm":50},"layers":[{"curve":{"kind":"points","points":[[0,0],[0.5,2],[0.4,3]]}}]}"#,
            "layers[0].curve: points[2]",
        ),
        (
            r#"{"implant":{"base_radius_mm":50},"layers":[{"curve":{"kind":"skin","modulus_kpa":3}}]}"#,
            "modulus_kpa",
        ),
        (r#"{"implant":{"base_radius_mm":50}} trailing"#, "trailing"),
        (r#"{"implant":{"base_radius_mm":50,"base_radius_mm":60}}"#, "duplicate"),
    ] {
        let error = session.apply(Command::Open(json.to_owned())).unwrap_err().to_string();
        assert!(error.contains(expected), "{json}: {error}");
        assert!(!error.contains('\n') && error.len() < 400, "{error}");
        assert_eq!(session.scene(), &scene);
        assert_eq!(session.revision(), revision);
        assert!(!session.is_working());
    }
}

#[test]
fn a_saved_scene_is_read_back_unchanged() {
    let mut scene = small();
    scene.implant.center_mm = [3.0, -4.0];
    scene.layers.push(Layer::skin());
    let again = Scene::from_json(&scene.to_json()).unwrap();
    assert_eq!(again, scene);
}

#[test]
fn a_scene_needs_only_a_base_radius() {
    let scene = Scene::from_json(r#"{"implant":{"base_radius_mm":40}}"#).unwrap();
    assert!((scene.implant.projection_mm - 40.0).abs() < 1e-12);
    assert!((scene.pocket_radius_mm - 55.0).abs() < 1e-12);
    assert_eq!(scene.layers, Scene::default().layers);
    assert_eq!(scene.solver, Scene::default().solver);
}

#[test]
fn the_schema_names_every_field_of_the_scene() {
    let schema = implant_preview::scene::schema();
    for field in [
        "implant",
        "base_radius_mm",
        "projection_mm",
        "center_mm",
        "pocket_radius_mm",
        "insertion",
        "layers",
        "tissue",
        "thickness_mm",
        "poisson_ratio",
        "curve",
        "springs",
        "solver",
        "nodes_per_side",
        "tolerance",
        "modulus_kpa",
        "scale_kpa",
        "interpolation",
        "sections",
    ] {
        assert!(schema.contains(&format!("\"{field}\"")), "{field}");
    }
}

#[test]
fn the_displayed_pressure_is_the_reported_pressure() {
    type Change = fn(&mut Scene);
    let changes: [Change; 5] = [
        |_| {},
        |scene| scene.implant.center_mm = [8.0, 5.0],
        |scene| scene.implant.projection_mm = 25.0,
        |scene| scene.insertion = 0.3,
        // No node of this small contact is an interior node.
        |scene| scene.insertion = 0.02,
    ];
    for (case, change) in changes.into_iter().enumerate() {
        for (nodes, start) in [33, 65, 129].into_iter().flat_map(|n| both().map(|s| (n, s))) {
            let mut scene = start;
            scene.solver.nodes_per_side = nodes;
            change(&mut scene);
            let mut session = Session::new(scene).unwrap();
            settle(&mut session);
            let drawn = session.values(Field::ContactPressure).to_vec();
            let read = session.outcome().unwrap().contact_pressure_kpa.unwrap();
            let greatest = f64::from(drawn.iter().copied().fold(0.0, f32::max));
            let ratio = greatest / read.max;
            assert!((ratio - 1.0).abs() < 1e-6, "scene {case}, {nodes} nodes: {ratio}");
            // Under a sheet adjacent nodes in contact have similar pressures; under solid tissue the pressure falls to zero at the edge.
            let least = drawn.iter().copied().filter(|p| *p > 0.0).fold(f32::MAX, f32::min);
            let is_sheet = session.scene().body.tissue_model == TissueModel::Sheet;
            assert!(
                !is_sheet || f64::from(least) > 0.3 * read.mean,
                "scene {case}, {nodes} nodes: {least}"
            );
            assert!(read.max >= read.mean);
        }
    }
}
