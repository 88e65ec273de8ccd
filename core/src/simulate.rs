//! The unit of work: from a scene to its result and its solution.
//!
//! Command line, JavaScript API and studies compute by [`run`].
//!
//! Uses `scene` and all to its left. Used by `study`, `session`, the lab, `platform`.

use crate::measure::{self, Fields, Outcome, Selection, no_shape};
use crate::scene::{CheckedScene, Scene, SceneError};
use crate::solve::{Invalid, Options, Problem, Progress, Solution, Solver};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// The result of a scene, with its solution.
#[derive(Debug)]
pub struct Simulation {
    /// The result.
    pub outcome: Outcome,
    /// The solution: faces, active set, contact forces, report.
    pub solution: Arc<Solution>,
}

/// Nodes per side up to which a [`Simulator`] keeps its grids: some 15 MB of a whole sheet, 50 MB of layered tissue.
const MAX_KEPT_NODES_PER_SIDE: usize = 257;

/// Computes one scene after the other. Each result is that of a new simulator; tables of the law and grids that a scene
/// shares with the previous scene are kept.
#[derive(Default)]
pub struct Simulator {
    solver: Option<Solver>,
    /// Greatest time of a solve \[ms\], by the clock of [`Self::run`]; `None`: as long as the solve takes. A solve beyond ends
    /// after the piece of work that runs, as not converged, with a warning.
    pub most_ms: Option<f64>,
    /// Ends the solve after the piece of work that runs, as not converged, once it is true.
    pub stop: Option<Arc<AtomicBool>>,
}

impl Simulator {
    /// Solves a scene from scratch and measures the selected fields. With a `clock` \[ms\] the result contains the solve's
    /// time, without the measuring.
    #[must_use]
    pub fn run(
        &mut self,
        scene: &CheckedScene,
        options: Options,
        selection: &Selection,
        clock: Option<&dyn Fn() -> f64>,
    ) -> Simulation {
        let start = clock.map(|clock| clock());
        let problem = scene.problem();
        // A panic leaves no solver behind.
        let mut solver = match self.solver.take() {
            Some(mut solver) => {
                solver.start_anew(problem, options);
                solver
            }
            None => Solver::with_options(problem, options),
        };
        let end = self.most_ms.zip(start).map(|(most, start)| start + most);
        let is_stopped = || self.stop.as_ref().is_some_and(|stop| stop.load(Ordering::Relaxed));
        let is_late = || is_stopped() || clock.zip(end).is_some_and(|(clock, end)| clock() >= end);
        let mut is_given_up = false;
        while solver.advance(&mut || is_late()) == Progress::Working {
            // A pause may also be a draft.
            if is_late() {
                solver.give_up();
                is_given_up = true;
            }
        }
        let solution = Arc::new(solver.take_solution());
        let time_ms = clock.zip(start).map(|(clock, start)| clock() - start);
        if solution.problem().sheet().nodes_per_side() <= MAX_KEPT_NODES_PER_SIDE {
            self.solver = Some(solver);
        }
        let fields = Fields::new(Arc::clone(&solution));
        let mut outcome = measure_selected(scene.scene(), &fields, selection);
        outcome.solver.time_ms = time_ms;
        if let Some(most_ms) = self.most_ms.filter(|_| is_given_up) {
            outcome.warnings.retain(|warning| warning != no_shape(Some(Invalid::NotFound)));
            outcome
                .warnings
                .insert(0, format!("The computation ended at its limit of {most_ms} ms."));
        }
        Simulation { outcome, solution }
    }
}

/// Solves a scene from scratch and measures the solution. With a `clock` \[ms\] the result contains the solve's time.
#[must_use]
pub fn run(scene: &CheckedScene, options: Options, clock: Option<&dyn Fn() -> f64>) -> Simulation {
    Simulator::default().run(scene, options, &Selection::all(), clock)
}

/// Solves a scene from scratch; returns the result.
///
/// # Errors
/// If the scene is out of its limits.
pub fn simulate(scene: &Scene) -> Result<Outcome, SceneError> {
    Ok(run(&CheckedScene::new(scene.clone())?, Options::default(), None).outcome)
}

/// Measures the solution of a scene.
#[must_use]
pub fn measure(scene: &Scene, fields: &Fields) -> Outcome {
    measure_selected(scene, fields, &Selection::all())
}

fn measure_selected(scene: &Scene, fields: &Fields, selection: &Selection) -> Outcome {
    let tissues: Vec<String> = scene.layers.iter().map(|layer| layer.tissue.clone()).collect();
    let mut outcome = measure::measure(fields, &tissues, selection);
    let (asked, given) = (scene.solver.nodes_per_side, outcome.solver.nodes_per_side);
    if asked != given {
        outcome.warnings.push(format!("nodes_per_side {asked} was rounded to {given}."));
    }
    outcome.implant_reference.clone_from(&scene.implant_reference);
    if let Some(cover) = outcome.cover_mm.as_mut().filter(|_| scene.body.plane.is_some()) {
        cover.without_muscle = measure::cover_without_innermost(fields.solution(), cover);
    }
    outcome.patient_values = scene.patient_values();
    outcome.warnings.extend(scene.patient_warnings());
    outcome.warnings.extend(scene.curve_warnings());
    outcome.warnings.extend(scene.torso_warnings());
    let Problem { rest, obstacle, .. } = fields.solution().problem();
    outcome.warnings.extend(scene.body.skin_state.growth_warning(rest.natural()));
    let wall = &obstacle.wall.0;
    outcome.warnings.extend(scene.chest_warnings(wall));
    outcome.warnings.extend(scene.pocket_warning(wall));
    outcome
}

/// Adapts a result to another scene of the same physics: names of tissues and implant, and what depends on the patient.
pub(crate) fn relabel(outcome: &mut Outcome, before: &Scene, scene: &Scene) {
    for (outcome, layer) in outcome.layers.iter_mut().zip(&scene.layers) {
        outcome.tissue.clone_from(&layer.tissue);
    }
    outcome.implant_reference.clone_from(&scene.implant_reference);
    let old = [before.patient_warnings(), before.curve_warnings()].concat();
    outcome.warnings.retain(|warning| !old.contains(warning));
    outcome.patient_values = scene.patient_values();
    outcome.warnings.extend(scene.patient_warnings());
    outcome.warnings.extend(scene.curve_warnings());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::{Column, Status, Written, surfaces};
    use crate::solve::Method;
    use serde_json::Value;
    use std::cell::Cell;

    #[test]
    fn a_written_result_has_the_fields_of_its_own_selection_only() {
        let of = |names: &[&str]| match names {
            [] => Selection::all(),
            ["no profile"] => Selection::all().without_profile(),
            names => {
                Selection::of(&names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>())
                    .unwrap()
            }
        };
        let selections = [
            &[][..],
            &["no profile"],
            &["contact_force_n"],
            &["contact_force_n", "strain.max_principal"],
            &["contact_force_n", "strain"],
            &["layers.tissue", "solver.cycles"],
            &["solver.cycles", "strain.fraction_above", "warnings"],
        ];
        for mut scene in [Scene::sheet(), Scene::default()] {
            scene.solver.nodes_per_side = 17;
            let outcome = simulate(&scene).unwrap();
            for a in selections {
                let selection = of(a);
                let mut line: Value = serde_json::to_value(selection.of_outcome(&outcome)).unwrap();
                line["id"] = 7.into();
                for b in selections {
                    let found = Written::new(&of(b)).difference(&line, &["id"]);
                    assert_eq!(found.is_none(), a == b, "{a:?} {b:?}: {found:?}");
                }
            }
        }
    }

    #[test]
    fn a_solution_is_restored_from_json_with_the_same_result() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 33;
        scene.implant.center_mm = [4.0, 0.0];
        let scene = CheckedScene::new(scene).unwrap();
        let Simulation { outcome, solution } = run(&scene, Options::default(), None);
        let json = serde_json::to_string(&solution.record()).unwrap();
        let record = serde_json::from_str(&json).unwrap();
        let restored = std::thread::spawn({
            let problem = scene.problem();
            move || Arc::new(Solution::restore(problem, record).unwrap())
        });
        let restored = restored.join().unwrap();
        assert_eq!(restored.faces(), solution.faces());
        assert_eq!(restored.reactions().force, solution.reactions().force);
        assert_eq!(measure(scene.scene(), &Fields::new(restored)), outcome);
    }

    #[test]
    fn a_solve_ends_at_its_limit_of_time_and_leaves_the_next_one_as_it_is() {
        for (mut scene, method) in [
            (Scene::sheet(), Method::Automatic),
            (Scene::sheet(), Method::Newton),
            (Scene::default(), Method::Automatic),
        ] {
            scene.solver.nodes_per_side = 33;
            scene.implant.center_mm = [5.0, 3.0];
            let scene = CheckedScene::new(scene).unwrap();
            let options = Options { method, ..Options::default() };
            let whole = run(&scene, options, None).outcome;
            let mut simulator = Simulator::default();
            // A clock that counts its readings, one for each piece of work.
            let (mut shapes, mut limits) = (0, 0);
            for most in (1..).map(|k| 3.0 * f64::from(k * k)) {
                let now = Cell::new(-1.0);
                let clock = || now.replace(now.get() + 1.0);
                simulator.most_ms = Some(most);
                let outcome =
                    simulator.run(&scene, options, &Selection::all(), Some(&clock)).outcome;
                if outcome.status == Status::Converged {
                    assert_eq!(Outcome { solver: whole.solver.clone(), ..outcome }, whole);
                    break;
                }
                limits += 1;
                assert_eq!(outcome.status, Status::NotConverged);
                assert!(outcome.warnings[0].contains(&format!("limit of {most} ms")));
                let (shape, value) = (outcome.strain.is_some(), outcome.contact_force_n);
                assert!(shape == value.is_some() && value.is_none_or(f64::is_finite));
                shapes += usize::from(shape);
            }
            assert!(shapes > 0 && shapes < limits, "{method:?}: {shapes} of {limits}");
        }
    }

    #[test]
    fn the_result_of_a_simulator_does_not_depend_on_the_scenes_before() {
        let mut scenes = Vec::new();
        for base in [Scene::sheet(), Scene::default()] {
            for (center, insertion, thickness) in
                [(0.0, 1.0, 10.0), (0.0, 0.6, 10.0), (5.0, 0.6, 10.0), (5.0, 0.6, 14.0)]
            {
                let mut scene = base.clone();
                scene.solver.nodes_per_side = 33;
                scene.implant.center_mm = [center, 0.0];
                scene.insertion = insertion;
                scene.layers[1].thickness_mm = thickness;
                scenes.push(CheckedScene::new(scene).unwrap());
            }
        }
        // To a tolerance of Newton's method, and at rest.
        for (tolerance, insertion) in [(1e-7, 0.6), (1e-3, 0.0)] {
            let mut scene = scenes[0].scene().clone();
            (scene.solver.tolerance, scene.insertion) = (tolerance, insertion);
            scenes.insert(2, CheckedScene::new(scene).unwrap());
        }
        let mut simulator = Simulator::default();
        for scene in scenes.iter().chain(scenes.iter().rev()) {
            let kept = simulator.run(scene, Options::default(), &Selection::all(), None);
            let new = run(scene, Options::default(), None);
            assert_eq!(kept.outcome, new.outcome);
            assert_eq!(kept.solution.record(), new.solution.record());
        }
    }

    #[test]
    fn a_quarter_and_half_have_the_result_of_the_whole_sheet() {
        for base in [Scene::sheet(), Scene::default()] {
            for center_mm in [[0.0, 0.0], [5.0, 0.0], [0.0, -5.0]] {
                let mut scene = base.clone();
                scene.solver.nodes_per_side = 33;
                scene.implant.center_mm = center_mm;
                let scene = CheckedScene::new(scene).unwrap();
                let part = run(&scene, Options::default(), None);
                let mut record = part.solution.record();
                assert_eq!(record.mirrored, center_mm.map(|c| c == 0.0));
                record.mirrored = [false; 2];
                let whole = Arc::new(Solution::restore(scene.problem(), record).unwrap());
                let whole = serde_json::to_value(measure(scene.scene(), &Fields::new(whole)));
                let part = serde_json::to_value(part.outcome).unwrap();
                assert_close(&part, &whole.unwrap(), "");
            }
        }
    }

    fn assert_close(a: &Value, b: &Value, path: &str) {
        match (a, b) {
            (Value::Object(a), Value::Object(b)) => {
                assert_eq!(a.len(), b.len());
                a.iter().for_each(|(k, a)| assert_close(a, &b[k], &format!("{path}.{k}")));
            }
            (Value::Array(a), Value::Array(b)) => {
                assert_eq!(a.len(), b.len());
                a.iter().zip(b).for_each(|(a, b)| assert_close(a, b, path));
            }
            (Value::Number(x), Value::Number(y)) => {
                let (x, y) = (x.as_f64().unwrap(), y.as_f64().unwrap());
                // Forces that cancel are zero on a part, nearly zero on the whole.
                let bound = 1e-11 * x.abs().max(y.abs()) + 1e-13;
                assert!((x - y).abs() <= bound, "{path}: {x} and {y}");
            }
            _ => assert_eq!(a, b, "{path}"),
        }
    }

    #[test]
    fn a_column_has_the_value_of_its_path() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 17;
        let outcome = simulate(&scene).unwrap();
        let result = serde_json::to_value(&outcome).unwrap();
        let of = |path: &str| Column::of(path).unwrap().value(&result);
        assert_eq!(of("status"), "converged");
        assert_eq!(of("strain.max_principal"), outcome.strain.as_ref().unwrap().max_principal);
        assert_eq!(of("strain.fraction_above[0.25]"), result["strain"]["fraction_above"]["0.25"]);
        assert_eq!(of("strain.fraction_above[0.26]"), Value::Null);
        assert_eq!(of("layers[1].max_stress_kpa"), outcome.layers[1].max_stress_kpa.unwrap());
        assert_eq!(
            of("layers[1].thickness_mm.least"),
            outcome.layers[1].thickness_mm.unwrap().least
        );
        assert_eq!(of("layers[7].max_stress_kpa"), Value::Null);
        assert_eq!(of("layers.tissue").as_array().unwrap().len(), outcome.layers.len());
        assert_eq!(of("profile[40].r_mm"), outcome.profile[40].r_mm);
        assert_eq!(of("contact_resultant_n[2]"), outcome.contact_resultant_n.unwrap()[2]);
        assert_eq!(of("contact_angle_deg"), Value::Null);
        assert_eq!(
            Column::of("layers[1].thickness_mm.least").unwrap().field(),
            "layers.thickness_mm.least"
        );
    }

    #[test]
    fn a_selection_contains_the_values_of_the_whole_result_and_no_others() {
        for mut scene in [Scene::sheet(), Scene::default()] {
            scene.solver.nodes_per_side = 33;
            let scene = CheckedScene::new(scene).unwrap();
            let mut simulator = Simulator::default();
            let mut run = |selection: &Selection| {
                let simulation = simulator.run(&scene, Options::default(), selection, None);
                serde_json::to_value(selection.of_outcome(&simulation.outcome)).unwrap()
            };
            let whole = run(&Selection::all());
            let fields: Vec<String> = whole.as_object().unwrap().keys().cloned().collect();
            for field in &fields {
                let one = run(&Selection::of(std::slice::from_ref(field)).unwrap());
                assert_eq!(one[field], whole[field], "{field}");
                let expected = [field.as_str(), "schema", "status"];
                assert!(one.as_object().unwrap().keys().all(|k| expected.contains(&k.as_str())));
            }
            let some = ["strain.max_principal", "layers.tissue", "layers.max_stress_kpa"];
            let some = run(&Selection::of(&some.map(str::to_owned)).unwrap());
            assert_eq!(some["strain"].as_object().unwrap().len(), 1);
            assert_eq!(some["strain"]["max_principal"], whole["strain"]["max_principal"]);
            assert_eq!(some["layers"][1].as_object().unwrap().len(), 2);
            assert_eq!(some["layers"][1]["tissue"], whole["layers"][1]["tissue"]);
            let short = run(&Selection::all().without_profile());
            let left_out = fields.iter().filter(|field| short.get(field).is_none());
            assert!(left_out.eq(fields.iter().filter(|field| field.starts_with("profile"))));
        }
    }

    #[test]
    fn the_skin_lies_the_layers_thickness_outside_of_the_inner_face() {
        let mut scene = Scene::sheet();
        scene.solver.nodes_per_side = 33;
        let mut solver = Solver::new(scene.problem().unwrap());
        solver.advance(&mut || false);
        let solution = Arc::new(solver.solution());
        let surfaces = surfaces(&solution);
        assert_eq!(surfaces.positions.len(), 3);
        // Euler's formula for a disc without holes: V − E + T = 1.
        let mut edges: Vec<(u32, u32)> = surfaces
            .triangles
            .iter()
            .flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)])
            .map(|(a, b)| (a.min(b), a.max(b)))
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let used =
            surfaces.triangles.as_flattened().iter().collect::<std::collections::BTreeSet<_>>();
        assert_eq!(used.len() + surfaces.triangles.len(), edges.len() + 1);
        let apex = surfaces.nodes.iter().position(|&k| k == 33 * 33 / 2).unwrap();
        let height = |face: usize| f64::from(surfaces.positions[face][apex][2]);
        let outcome = measure(&scene, &Fields::new(solution));
        assert!((height(0) - 55.0).abs() < 1e-3);
        assert!((height(2) - outcome.skin_projection_mm.unwrap()).abs() < 1e-2);
        assert!(height(1) > height(0) && height(2) > height(1));
    }

    #[test]
    fn a_record_of_another_grid_is_rejected() {
        let scene = CheckedScene::new(Scene::default()).unwrap();
        let mut record = Solver::new(scene.problem()).solution().record();
        record.inner.pop();
        assert!(Solution::restore(scene.problem(), record).is_none());
    }
}
