//! The session: edits, undo, rejected input, and no work without a change.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use implant_preview::clinical::Measurements;
use implant_preview::measure::bands::SkinLimits;
use implant_preview::measure::{Field, Outcome, Status};
use implant_preview::scene::{CellsThrough, Layer, Scene, Springs, TissueModel};
use implant_preview::session::{Command, Counters, Session};
use implant_preview::solve::{Displayed, Method, Options, Progress, Solver};
use implant_preview::view::picture::Picture;
use implant_preview::view::quantity::{Colouring, Quantity};
use implant_preview::view::section::{Opening, Section};

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

#[test]
fn a_solved_session_at_rest_does_no_work() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        assert_eq!(session.outcome().unwrap().status, Status::Converged);
        let (counters, revision) = (session.counters(), session.revision());
        for _ in 0..10 {
            assert_eq!(session.advance(&mut || false), Progress::Done);
        }
        let same = session.scene().clone();
        session.apply(Command::Edit { scene: Box::new(same), gesture: 9 }).unwrap();
        assert_eq!(session.advance(&mut || false), Progress::Done);
        assert_eq!(session.counters(), counters);
        assert_eq!(session.revision(), revision);
        assert!(!session.can_undo());
    }
}

#[test]
fn a_name_or_a_colour_solves_nothing() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        let before = session.counters();
        edit(&mut session, 1, |scene| "capsule".clone_into(&mut scene.layers[1].tissue));
        assert_eq!(session.advance(&mut || false), Progress::Done);
        assert_eq!(session.counters(), before);
        assert_eq!(session.outcome().unwrap().layers[1].tissue, "capsule");
        assert!(session.can_undo());
    }
}

/// The work of a step: difference of the counters.
#[test]
fn a_change_of_the_patient_alone_solves_nothing_and_updates_the_result() {
    let mut start = small();
    let measured = |base_width_mm: f64| Measurements {
        base_width_mm: Some(base_width_mm),
        pinch_mm: Some(20.0),
        ..Measurements::default()
    };
    start.apply_patient(measured(120.0)).unwrap();
    let mut session = Session::new(start).unwrap();
    settle(&mut session);
    let (counters, outcome) = (session.counters(), session.outcome().unwrap().clone());
    assert_eq!(outcome.patient_values.len(), 2);
    let is_wide = |session: &Session| {
        let warnings = &session.outcome().unwrap().warnings;
        warnings.iter().filter(|text| text.contains("wider than the breast's base")).count()
    };
    assert_eq!(is_wide(&session), 0);
    edit(&mut session, 1, |scene| scene.apply_patient(measured(100.0)).unwrap());
    assert_eq!(is_wide(&session), 1);
    edit(&mut session, 2, |scene| scene.apply_patient(measured(90.0)).unwrap());
    assert_eq!(is_wide(&session), 1);
    edit(&mut session, 3, |scene| scene.patient = None);
    assert!(is_wide(&session) == 0 && session.outcome().unwrap().patient_values.is_empty());
    (0..3).for_each(|_| session.apply(Command::Undo).unwrap());
    assert_eq!((session.outcome().unwrap(), session.counters()), (&outcome, counters));
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
fn stability_limits_are_computed_once_per_stack_of_layers_and_only_for_the_papers_springs() {
    let mut session = Session::new(small_sheet()).unwrap();
    let asked = |session: &Session| {
        (session.stability_limits().is_some(), session.counters().stability_limits)
    };
    assert_eq!(asked(&session), (false, 0));
    let springs = |springs| move |scene: &mut Scene| scene.springs = springs;
    edit(&mut session, 1, springs(Springs::Nikolaev));
    assert_eq!((asked(&session), asked(&session)), ((true, 1), (true, 1)));
    edit(&mut session, 2, |scene| scene.insertion = 0.5);
    edit(&mut session, 3, springs(Springs::Coupled));
    assert_eq!(asked(&session), (false, 1));
    edit(&mut session, 4, springs(Springs::Nikolaev));
    assert_eq!(asked(&session), (true, 1));
    let before = session.stability_limits().cloned();
    edit(&mut session, 5, |scene| scene.layers[0].poisson_ratio = 0.3);
    assert_eq!(asked(&session), (true, 2));
    assert_ne!(session.stability_limits().cloned(), before);
}

/// Number of meshes of the picture in a step.
fn meshes(picture: &mut Picture, step: impl FnOnce(&mut Picture)) -> u64 {
    let before = picture.meshes_made;
    step(picture);
    picture.meshes_made - before
}

/// The work of a frame: an update of the picture.
fn draw(picture: &mut Picture, session: &Session, quantity: Quantity, angle: f32) {
    let section = Section { opening: Opening::Wedge, angle, axis: glam::Vec2::ZERO };
    assert!(picture.update(
        session,
        Colouring { quantity, skin: SkinLimits::Tearing },
        section,
        &|| 0.0
    ));
}

#[test]
fn a_finished_shape_is_recovered_and_measured_once_for_results_and_picture() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        let mut picture = Picture::default();
        let done = work(&mut session, |session| {
            session.advance(&mut || false);
            draw(&mut picture, session, Quantity::Strain, 0.0);
            draw(&mut picture, session, Quantity::Strain, 0.0);
        });
        assert_eq!((done.recoveries, done.measurements), (1, 1));
        // Tissue, cut faces, implant, wall; only the displayed field.
        assert_eq!((done.fields, picture.meshes_made), (1, 4));
        assert_eq!(session.values(Field::PrincipalStrain).len(), 33 * 33);
        assert_eq!(session.counters().fields, 1);
    }
}

#[test]
fn another_quantity_computes_its_own_field_and_only_once() {
    let mut session = Session::new(small()).unwrap();
    let mut picture = Picture::default();
    settle(&mut session);
    draw(&mut picture, &session, Quantity::Strain, 0.0);
    for quantity in [Quantity::Stress(1), Quantity::AreaStretch, Quantity::Pressure] {
        let mut shown = Counters::default();
        let made = meshes(&mut picture, |picture| {
            shown = work(&mut session, |session| draw(picture, session, quantity, 0.0));
        });
        let only = Counters { fields: 1, ..Counters::default() };
        assert_eq!((shown, made), (only, 1), "{quantity:?}");
    }
    for quantity in [Quantity::Stress(1), Quantity::Tissue] {
        let made = meshes(&mut picture, |picture| {
            let again = work(&mut session, |session| draw(picture, session, quantity, 0.0));
            assert_eq!(again, Counters::default());
        });
        assert_eq!(made, 1);
    }
}

#[test]
fn a_turned_cut_updates_its_faces_and_a_renamed_layer_its_colours() {
    let mut session = Session::new(small()).unwrap();
    let mut picture = Picture::default();
    settle(&mut session);
    draw(&mut picture, &session, Quantity::Strain, 0.0);
    let faces = |picture: &Picture| picture.meshes[1].vertices.clone();
    let before = faces(&picture);
    let made = meshes(&mut picture, |picture| {
        let turned = work(&mut session, |session| draw(picture, session, Quantity::Strain, 0.5));
        assert_eq!(turned, Counters::default());
    });
    assert_eq!(made, 1);
    assert_ne!(faces(&picture), before);
    let before = faces(&picture);
    let made = meshes(&mut picture, |picture| {
        let renamed = work(&mut session, |session| {
            edit(session, 1, |scene| "muscle".clone_into(&mut scene.layers[1].tissue));
            session.advance(&mut || false);
            draw(picture, session, Quantity::Strain, 0.5);
        });
        assert_eq!(renamed, Counters::default());
    });
    assert_eq!(made, 2);
    assert_ne!(faces(&picture), before);
}

#[test]
fn a_scene_equal_to_the_previous_scene_reuses_everything() {
    let mut session = Session::new(small()).unwrap();
    let mut picture = Picture::default();
    settle(&mut session);
    draw(&mut picture, &session, Quantity::Strain, 0.0);
    let nothing = Counters::default();
    let same = work(&mut session, |session| {
        edit(session, 1, |_| {});
        session.apply(Command::Open(session.scene().to_json())).unwrap();
        session.advance(&mut || false);
        draw(&mut picture, session, Quantity::Strain, 0.0);
    });
    assert_eq!(same, nothing);
    edit(&mut session, 2, |scene| "capsule".clone_into(&mut scene.layers[1].tissue));
    draw(&mut picture, &session, Quantity::Strain, 0.0);
    // With the previous name the shape is equal, the colours differ.
    let made = meshes(&mut picture, |picture| {
        let undone = work(&mut session, |session| {
            session.apply(Command::Undo).unwrap();
            session.advance(&mut || false);
            draw(picture, session, Quantity::Strain, 0.0);
        });
        assert_eq!(undone, nothing);
    });
    assert_eq!(made, 2);
    assert_eq!(session.outcome().unwrap().layers[1].tissue, "adipose");
}

#[test]
fn a_new_shape_keeps_the_triangulation_and_unchanged_meshes() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        let mut picture = Picture::default();
        settle(&mut session);
        draw(&mut picture, &session, Quantity::Strain, 0.0);
        let (before, made) = (picture.meshes.clone(), picture.meshes_made);
        let softer = work(&mut session, |session| {
            edit(session, 1, |scene| scene.layers[1].poisson_ratio = 0.4);
            settle(session);
            draw(&mut picture, session, Quantity::Strain, 0.0);
        });
        // A draft and the end of the solve are measured.
        assert_eq!((softer.solves, softer.measurements, softer.recoveries), (1, 2, 2));
        assert_eq!((softer.fields, picture.meshes_made - made), (1, 2));
        for moved in [0, 1] {
            assert_ne!(picture.meshes[moved].vertices, before[moved].vertices);
        }
        assert!(std::sync::Arc::ptr_eq(&picture.meshes[0].indices, &before[0].indices));
        assert!(std::sync::Arc::ptr_eq(&picture.meshes[2], &before[2]));
    }
}

#[test]
fn an_undisplayed_shape_is_recovered_only_for_its_results() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        while session.advance(&mut || true) == Progress::Working {
            let drafts = u64::from(session.solver().displayed() == Displayed::Draft);
            assert_eq!(session.counters().recoveries, drafts);
        }
        let counters = session.counters();
        assert_eq!((counters.recoveries, counters.measurements, counters.fields), (2, 2, 0));
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

/// Advances to the end; returns the work.
fn solving(session: &mut Session, change: impl FnOnce(&mut Scene)) -> Counters {
    work(session, |session| {
        edit(session, 7, change);
        settle(session);
    })
}

#[test]
fn only_a_change_of_the_law_makes_tables_and_only_a_change_of_the_grid_makes_grids() {
    for start in both() {
        let mut session = Session::new(start.clone()).unwrap();
        settle(&mut session);
        let start = session.counters();
        assert_eq!((start.tables, start.grids), (1, 1));
        let moved = solving(&mut session, |scene| scene.insertion = 0.8);
        assert_eq!((moved.solves, moved.tables, moved.grids), (1, 0, 0));
        let wider = solving(&mut session, |scene| scene.pocket_radius_mm += 2.0);
        assert_eq!((wider.solves, wider.tables, wider.grids), (1, 0, 0));
        let softer = solving(&mut session, |scene| scene.layers[0].poisson_ratio = 0.3);
        assert_eq!((softer.solves, softer.tables, softer.grids), (1, 1, 0));
        let finer = solving(&mut session, |scene| scene.solver.nodes_per_side = 65);
        assert_eq!((finer.solves, finer.tables, finer.grids), (1, 0, 1));
        // Off centre the whole sheet is solved.
        let aside = solving(&mut session, |scene| scene.implant.center_mm = [1.0, 2.0]);
        assert_eq!((aside.solves, aside.tables, aside.grids), (1, 0, 1));
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
fn nodes_outside_of_the_pocket_cost_next_to_nothing() {
    for start in both() {
        for center_mm in [[0.0, 0.0], [3.0, 2.0]] {
            let mut scene = start.clone();
            scene.solver.nodes_per_side = 129;
            scene.implant.center_mm = center_mm;
            let mut solver = Solver::new(scene.problem().unwrap());
            solver.advance(&mut || false);
            let (solved, swept) =
                (solver.nodes_solved() as f64, solver.report().nodes_swept as f64);
            assert!(swept > solved && swept < 1.05 * solved, "{swept} for {solved}");
        }
    }
}

#[test]
fn layers_of_equal_poisson_ratio_cost_as_much_as_one() {
    let units = |ratios: &[f64]| {
        let mut scene = small_sheet();
        scene.layers = ratios
            .iter()
            .map(|&poisson_ratio| Layer { poisson_ratio, ..Layer::adipose() })
            .collect();
        let mut solver = Solver::new(scene.problem().unwrap());
        solver.advance(&mut || false);
        solver.tables()
    };
    assert_eq!(units(&[0.45]), 1);
    assert_eq!(units(&[0.45; 8]), 1);
    assert_eq!(units(&[0.45, 0.3, 0.45]), 2);
}

#[test]
fn a_drag_displays_a_draft_within_a_thousandth_and_then_the_final_shape() {
    for start in both() {
        let mut scene = start.clone();
        scene.solver.nodes_per_side = 129;
        scene.solver.tolerance = 1e-5;
        let mut session = Session::new(scene).unwrap();
        settle(&mut session);
        edit(&mut session, 1, |scene| scene.insertion = 0.9);
        if session.has_coarser_grid() {
            assert_eq!(session.advance(&mut || false), Progress::Working);
            assert_eq!(session.coarser_nodes_per_side(), Some(65));
        }
        // Without a pause, a slice ends at the draft.
        assert_eq!(session.advance(&mut || false), Progress::Working);
        assert_eq!(session.solver().displayed(), Displayed::Draft);
        assert!(session.is_working());
        let draft = session.shape().to_vec();
        let measured = session.outcome().unwrap();
        assert!((measured.projection_mm.unwrap() - 0.9 * 55.0).abs() < 0.055);
        assert!(measured.solver.estimated_position_error.unwrap() <= 1e-3);
        assert_eq!(session.advance(&mut || false), Progress::Done);
        assert_eq!(session.outcome().unwrap().status, Status::Converged);
        let moved = draft.iter().zip(session.shape()).map(|(a, b)| a.distance(*b));
        let moved = moved.fold(0.0, f64::max) / 55.0;
        assert!(moved > 0.0 && moved < 1e-3, "{moved:.1e}");
    }
}

#[test]
fn a_drag_of_layered_tissue_shows_the_results_of_a_coarser_grid_and_ends_on_its_own() {
    let mut scene = Scene::opening();
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (129, 1e-3);
    let mut session = Session::new(scene.clone()).unwrap();
    settle(&mut session);
    assert_eq!(
        (session.coarser_nodes_per_side(), session.counters().coarse_work_units),
        (None, 0.0)
    );
    let exact = |scene: &Scene| {
        let mut other = Session::new(scene.clone()).unwrap();
        settle(&mut other);
        other
    };
    for step in 1..=4 {
        edit(&mut session, 1, |scene| scene.implant.projection_mm += 0.3);
        let edited = work(&mut session, |session| {
            assert!(session.is_on_coarser_grid() && !session.is_outcome_present());
            assert_eq!(session.problem().sheet().nodes_per_side(), 129);
            assert_eq!(session.advance(&mut || false), Progress::Working);
        });
        // Not a step on the grid of 129 nodes; the first edit has no solution to continue from.
        assert_eq!((edited.work_units, edited.measurements, edited.previews), (0.0, 1, 1));
        let most = if step == 1 { 60.0 } else { 35.0 };
        assert!(edited.coarse_work_units < most, "{step}: {}", edited.coarse_work_units);
        assert_eq!(session.displayed(), Displayed::Coarse { nodes_per_side: 65 });
        assert!(session.is_outcome_present() && session.result().is_none());
        let coarse = session.outcome().unwrap();
        assert_eq!(coarse.solver.nodes_per_side, 65);
        assert!(coarse.solver.estimated_discretisation_error.unwrap() < 0.01);
        assert!(coarse.warnings.iter().all(|warning| !warning.contains("rounded")));
    }
    let coarse = session.outcome().unwrap().clone();
    settle(&mut session);
    let (own, other) = (session.outcome().unwrap(), exact(session.scene()));
    assert_eq!((session.coarser_nodes_per_side(), own.solver.nodes_per_side), (None, 129));
    assert_eq!(session.shape(), other.shape());
    let of = |outcome: &Outcome| outcome.strain.as_ref().unwrap().max_principal;
    let ratio = of(&coarse) / of(own);
    assert!((0.97..1.03).contains(&ratio), "{ratio}");
}

#[test]
fn a_scene_without_an_answer_on_the_coarser_grid_is_solved_on_its_own() {
    let mut session = Session::new(Scene::opening()).unwrap();
    settle(&mut session);
    edit(&mut session, 1, |scene| {
        scene.implant.projection_mm = 75.0;
        scene.implant.base_radius_mm = 30.0;
    });
    assert_eq!(session.advance(&mut || false), Progress::Working);
    assert_eq!((session.coarser_nodes_per_side(), session.is_on_coarser_grid()), (None, false));
    assert!(session.is_working());
    // The next plan with an answer shows its coarser grid again.
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.advance(&mut || false), Progress::Working);
    assert_eq!(session.coarser_nodes_per_side(), Some(65));
}

#[test]
fn a_short_slice_displays_the_solution_of_a_coarser_grid() {
    // The patch of layered tissue has fewer nodes over the dome.
    for (start, (slice, bound)) in both().into_iter().zip([(30, 0.15), (40, 0.05)]) {
        let mut scene = start;
        scene.solver.nodes_per_side = 129;
        let mut session = Session::new(scene).unwrap();
        let mut pieces = 0;
        let mut pause = || {
            pieces += 1;
            pieces == slice
        };
        assert_eq!(session.advance(&mut pause), Progress::Working);
        let Displayed::Coarse { nodes_per_side } = session.solver().displayed() else {
            panic!("{:?}", session.solver().displayed())
        };
        assert!((17..129).contains(&nodes_per_side), "{nodes_per_side}");
        assert_eq!(session.counters().previews, 1);
        let coarse = session.shape().to_vec();
        settle(&mut session);
        let moved = coarse.iter().zip(session.shape()).map(|(a, b)| a.distance(*b));
        let moved = moved.fold(0.0, f64::max) / 55.0;
        assert!(moved < bound, "{moved:.1e}");
    }
}

#[test]
fn a_cancelled_gesture_leaves_no_step() {
    let mut session = Session::new(small()).unwrap();
    edit(&mut session, 1, |scene| scene.insertion = 0.8);
    let kept = session.scene().clone();
    for k in 1..=3 {
        edit(&mut session, 2, |scene| scene.insertion = 0.1 * f64::from(k));
    }
    // Another gesture is not the last one.
    session.apply(Command::CancelGesture(1)).unwrap();
    assert_ne!(session.scene(), &kept);
    session.apply(Command::CancelGesture(2)).unwrap();
    session.apply(Command::CancelGesture(2)).unwrap();
    assert_eq!(session.scene(), &kept);
    assert!(session.can_undo() && !session.can_redo());
    // An edit to an equal scene is no step, and cancelling takes none back.
    edit(&mut session, 3, |_| {});
    session.apply(Command::CancelGesture(3)).unwrap();
    assert_eq!(session.scene(), &kept);
}

#[test]
fn a_gesture_is_one_step_of_undo() {
    let mut session = Session::new(small()).unwrap();
    for k in 1..=5 {
        edit(&mut session, 1, |scene| scene.insertion = 1.0 - 0.1 * f64::from(k));
    }
    edit(&mut session, 2, |scene| scene.layers.push(Layer::adipose()));
    assert_eq!(session.scene().layers.len(), 3);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.scene().layers.len(), 2);
    assert!((session.scene().insertion - 0.5).abs() < 1e-12);
    session.apply(Command::Undo).unwrap();
    assert_eq!(session.scene(), &small());
    assert!(!session.can_undo() && session.can_redo());
    session.apply(Command::Redo).unwrap();
    session.apply(Command::Redo).unwrap();
    assert_eq!(session.scene().layers.len(), 3);
    assert!(!session.can_redo());
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
