//! No work without a change, and none twice.

use super::*;

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
