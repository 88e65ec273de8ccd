//! How long solves take, to choose the grid of an edit whose solve fits a frame.
//!
//! The session has no clock: the app notes the time of its calls.

use crate::solve::Problem;

/// Time of the solve of an edit of a drag \[s\].
const FRAME_S: f64 = 0.03;
/// Part of [`FRAME_S`] that the expected time may exceed it by, or has to stay below it by, for another grid \[-\].
const MARGIN: f64 = 0.15;
/// Work of the solve of an edit before one is known \[evaluations of the forces of its grid\]: see `docs/performance.md`, drags.
const USUAL_WORK: f64 = 30.0;

/// The time of an evaluation, and the work of the last solves on the coarser grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pace {
    /// Time of the forces of a node of a layer of cells \[s\]; `None` before the first one is known.
    seconds: Option<f64>,
    /// Of the last two solves; a single one from nothing does not count.
    works: [f64; 2],
    /// Evaluations of the forces of a node of a layer of cells whose time is not known yet.
    untimed: f64,
}

impl Default for Pace {
    fn default() -> Self {
        Self { seconds: None, works: [USUAL_WORK; 2], untimed: 0.0 }
    }
}

/// Nodes times layers of cells of a problem, of one image of those that its symmetry leaves.
fn size(problem: &Problem) -> f64 {
    let images = problem.mirrored().map(|holds| if holds { 2.0 } else { 1.0 });
    let (nodes, cells) = (problem.sheet().free_nodes(), problem.rest.cells().len());
    (nodes * cells) as f64 / (images[0] * images[1])
}

impl Pace {
    /// Adds work on the grid of a problem \[evaluations of its forces\].
    pub(super) fn add(&mut self, work: f64, problem: &Problem) {
        self.untimed += work * size(problem);
    }

    /// Notes the time of the work that was added since the last call \[s\].
    pub(super) fn note(&mut self, seconds: f64) {
        let untimed = std::mem::take(&mut self.untimed);
        if untimed > 0.0 {
            let last = seconds / untimed;
            self.seconds = Some(self.seconds.map_or(last, |before| 0.5 * (before + last)));
        }
    }

    /// Notes the work of a solve on the coarser grid, whether or not it has ended.
    pub(super) fn note_work(&mut self, work: f64) {
        self.works = [work, self.works[0]];
    }

    /// Does the solve of a problem fit a frame? `was_on`: the last solve was on its grid, or a finer one.
    pub(super) fn fits(&self, problem: &Problem, was_on: bool) -> bool {
        let Some(seconds) = self.seconds else { return true };
        let most = FRAME_S * if was_on { 1.0 + MARGIN } else { 1.0 - MARGIN };
        let work = self.works[0].min(self.works[1]);
        seconds * work * size(problem) <= most
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    fn problem(nodes: usize, center_mm: [f64; 2]) -> Problem {
        let mut scene = Scene::opening();
        scene.solver.nodes_per_side = nodes;
        scene.implant.center_mm = center_mm;
        scene.problem().unwrap()
    }

    #[test]
    fn a_solve_that_takes_four_frames_off_centre_fits_one_on_a_quarter_and_on_half_of_the_nodes() {
        let [quarter, half, whole] = [[0.0; 2], [3.0, 0.0], [3.0; 2]].map(|at| problem(65, at));
        let mut pace = Pace::default();
        // Without a time every grid fits.
        assert!(pace.fits(&whole, false));
        pace.add(USUAL_WORK, &quarter);
        pace.note(0.8 * FRAME_S);
        let fits = |pace: &Pace| [&quarter, &half, &whole].map(|of| pace.fits(of, false));
        assert_eq!(fits(&pace), [true, false, false]);
        assert!(pace.fits(&problem(33, [3.0; 2]), false));
        // Work without a time of its own changes nothing.
        pace.note(0.0);
        assert_eq!(fits(&pace), [true, false, false]);
        // Faster by a factor of three.
        for _ in 0..9 {
            pace.add(USUAL_WORK, &quarter);
            pace.note(0.25 * FRAME_S);
        }
        assert_eq!(fits(&pace), [true, true, false]);
        // Twice the work twice in a row takes twice the time; once, from nothing, it does not count.
        pace.note_work(2.0 * USUAL_WORK);
        assert_eq!(fits(&pace), [true, true, false]);
        pace.note_work(2.0 * USUAL_WORK);
        assert_eq!(fits(&pace), [true, false, false]);
    }

    #[test]
    fn a_grid_at_the_limit_stays() {
        let problem = problem(65, [3.0; 2]);
        for (part, stays, comes) in [(0.8, true, true), (1.0, true, false), (1.2, false, false)] {
            let mut pace = Pace::default();
            pace.add(USUAL_WORK, &problem);
            pace.note(part * FRAME_S);
            assert_eq!([true, false].map(|was_on| pace.fits(&problem, was_on)), [stays, comes]);
        }
    }
}
