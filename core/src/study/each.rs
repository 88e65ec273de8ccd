//! Each scene of a list, solved by itself.

use super::Case;
use super::queue::{Queue, Queued};
use crate::scene::Scene;

/// The scenes of a list with their cases, a [`Study`](super::Study).
#[derive(Debug)]
pub struct Each {
    scenes: Vec<Result<Scene, String>>,
    queue: Queue,
}

impl Each {
    /// The study of these scenes, each on its own grid. An error stands in the place of a scene that does not exist.
    #[must_use]
    pub fn new(mut scenes: Vec<Result<Scene, String>>) -> Self {
        scenes.iter_mut().flatten().for_each(|scene| scene.patient = None);
        let queue = Queue::new((0..scenes.len()).collect());
        Self { scenes, queue }
    }

    /// The case of a scene by its index, once the scene is solved.
    #[must_use]
    pub fn case(&self, index: usize) -> Option<&Case> {
        self.queue.case(index)
    }
}

impl Queued for Each {
    fn queue(&self) -> &Queue {
        &self.queue
    }

    fn queue_mut(&mut self) -> &mut Queue {
        &mut self.queue
    }

    fn scene_of(&self, item: usize) -> Result<Scene, String> {
        self.scenes[item].clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::{Cases, Quantity, Study, evaluate};

    #[test]
    fn each_scene_has_the_case_of_its_own_solve_and_an_error_stays_one() {
        let scene = |projection_mm: f64| {
            let mut scene = Scene::sheet();
            scene.solver.nodes_per_side = 17;
            scene.implant.projection_mm = projection_mm;
            scene
        };
        let scenes = vec![Ok(scene(20.0)), Err("too wide".to_owned()), Ok(scene(30.0))];
        let (mut each, mut store) = (Each::new(scenes), Cases::default());
        while let Some((index, job)) = each.next_job(&mut store) {
            each.receive(index, evaluate(&job), &mut store);
        }
        assert!(each.is_done());
        assert_eq!(each.case(1).unwrap().error.as_deref(), Some("too wide"));
        for (index, projection) in [(0, 20.0), (2, 30.0)] {
            let outcome = crate::simulate::simulate(&scene(projection)).unwrap();
            let found = each.case(index).unwrap().values.get(Quantity::GreatestStrain);
            assert_eq!(found, Quantity::GreatestStrain.of(&outcome));
        }
        assert!(each.case(3).is_none());
    }
}
