//! The unit of work: from a scene to its result and its solution.
//!
//! Command line, JavaScript API and studies compute by [`run`].
//!
//! Uses `scene` and all to its left. Used by `session`, `experiment`, `platform`.

use crate::measure::{self, Fields, Outcome};
use crate::scene::{CheckedScene, Scene, SceneError};
use crate::solve::{Options, Progress, Solution, Solver};
use std::sync::Arc;

/// The result of a scene, with its solution.
#[derive(Debug)]
pub struct Simulation {
    /// The result.
    pub outcome: Outcome,
    /// The solution: faces, active set, contact forces, report.
    pub solution: Arc<Solution>,
}

/// Solves a scene from scratch and measures the solution. With a `clock` \[ms\] the result contains the solve's time.
#[must_use]
pub fn run(scene: &CheckedScene, options: Options, clock: Option<&dyn Fn() -> f64>) -> Simulation {
    let start = clock.map(|clock| clock());
    let mut solver = Solver::with_options(scene.problem(), options);
    while solver.advance(&mut || false) == Progress::Working {}
    let time_ms = clock.zip(start).map(|(clock, start)| clock() - start);
    let solution = Arc::new(solver.into_solution());
    let mut outcome = measure(scene.scene(), &Fields::new(Arc::clone(&solution)));
    outcome.solver.time_ms = time_ms;
    Simulation { outcome, solution }
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
    let tissues: Vec<String> = scene.layers.iter().map(|layer| layer.tissue.clone()).collect();
    let mut outcome = measure::measure(fields, &tissues);
    let (asked, given) = (scene.solver.nodes_per_side, outcome.solver.nodes_per_side);
    if asked != given {
        outcome.warnings.push(format!("nodes_per_side {asked} was rounded to {given}."));
    }
    outcome.patient_values = scene.patient_values();
    outcome.warnings.extend(scene.patient_warnings());
    outcome
}

/// Replaces the part of a result that depends on the patient, after a change of the patient alone.
pub(crate) fn replace_patient(outcome: &mut Outcome, before: &Scene, scene: &Scene) {
    let old = before.patient_warnings();
    outcome.warnings.retain(|warning| !old.contains(warning));
    outcome.patient_values = scene.patient_values();
    outcome.warnings.extend(scene.patient_warnings());
}

#[cfg(test)]
mod tests {
    use super::*;

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
    fn a_record_of_another_grid_is_rejected() {
        let scene = CheckedScene::new(Scene::default()).unwrap();
        let mut record = Solver::new(scene.problem()).solution().record();
        record.inner.pop();
        assert!(Solution::restore(scene.problem(), record).is_none());
    }
}
