//! A solve that continues from the solution of another problem: an implant that is dragged, tissue of another thickness.
//!
//! The columns move as the initial guess moves from one dome to the next, the pressure of nearly incompressible tissue and the blocks of all
//! grids are kept, and the cycles begin on the finest grid. The first one shows how far the solution is. An implant that yields keeps the numbers of
//! its deformation, from one body to the next, and what its steps have learned of the tissue.

use super::{FullMultigrid, Mode, Stop};
use crate::model::ElasticModel;
use crate::solve::Problem;
use glam::DVec3;

/// The longest move of the initial guess from which a solve continues \[base radius\].
const LONGEST_MOVE: f64 = 0.1;
/// Change of the first cycle beyond which a solve from nothing takes less work \[start tolerance\].
const MOST_CHANGE: f64 = 2.0;

/// Moves of the columns of the finest grid \[spacings\], shape (nodes_per_side², ).
pub(in crate::solve) struct Moves(Vec<DVec3>);

impl<M: ElasticModel> FullMultigrid<M> {
    /// The moves from one problem to another; `None` of moves that are too long.
    pub(in crate::solve) fn moves(&self, from: &Problem, to: &Problem) -> Option<Moves> {
        let [.., guide, finest] = &*self.levels else { return None };
        // The coarser grid resolves the moves. An implant that yields is as deformed in both.
        let modes = self.modes();
        let guess = |problem: &Problem| {
            let mut dome = problem.obstacle.dome.clone();
            modes.into_iter().for_each(|modes| dome.set_modes(modes));
            guide.guess(problem, &dome)
        };
        let moves = guess(to).into_iter().zip(guess(from)).map(|(to, from)| 2.0 * (to - from));
        let moves: Vec<DVec3> = moves.collect();
        let longest = moves.iter().map(|way| way.length_squared()).fold(0.0, f64::max).sqrt();
        let most = LONGEST_MOVE * to.obstacle.dome.reference_length();
        let is_short = longest * to.rest.sheet().spacing_mm() <= most;
        let [coarse, fine] = [guide, finest].map(|level| level.layout.nodes_per_side);
        is_short.then(|| Moves(interpolated(&moves, coarse, fine)))
    }

    /// Continues on the finest grid from the last solution.
    pub(in crate::solve) fn continue_by(
        &mut self,
        Moves(moves): &Moves,
        problem: &Problem,
        stop: Stop,
        draft_tolerance: Option<f64>,
    ) {
        self.before_growth = (0, self.change_by_refinement());
        self.set_up(problem, stop, draft_tolerance);
        self.yielded = self.yielded.take().and_then(|last| last.in_problem(problem));
        self.is_continued = true;
        self.place(&problem.obstacle);
        let finest = self.levels.len() - 1;
        self.levels[finest].move_columns(moves);
        self.begin_grid(finest);
    }

    /// Does the solve continue from the solution of another problem?
    pub(in crate::solve) fn is_continued(&self) -> bool {
        self.is_continued
    }

    /// Is the solution too far after the first cycle, of this change \[mm\], to continue?
    pub(super) fn is_too_far(&self, change: f64) -> bool {
        let most = MOST_CHANGE * self.parameters.start_tolerance * self.reference_length;
        let is_first = self.convergence.cycles == 1;
        self.is_continued && is_first && (change > most || self.mode == Mode::Robust)
    }

    /// Starts from nothing where the continued solve has failed; its work counts.
    pub(in crate::solve) fn start_from_nothing(&mut self, problem: &Problem, stop: Stop) {
        let (work_units, draft_tolerance) = (self.work_units, self.draft_tolerance);
        self.start(problem, stop, draft_tolerance);
        self.work_units = work_units;
    }
}

/// Values at the nodes of a coarser grid, bilinear on the grid with half the spacing.
fn interpolated(values: &[DVec3], coarse: usize, fine: usize) -> Vec<DVec3> {
    let row = |j: usize| {
        let values = &values[j * coarse..(j + 1) * coarse];
        move |i: usize| 0.5 * (values[i / 2] + values[i.div_ceil(2)])
    };
    let rows = (0..fine).map(|j| [row(j / 2), row(j.div_ceil(2))]);
    rows.flat_map(|[low, high]| (0..fine).map(move |i| 0.5 * (low(i) + high(i)))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_linear_field_is_interpolated_exactly() {
        let of = |n: usize, scale: f64| -> Vec<DVec3> {
            let at = |k: usize| scale * DVec3::new((k % n) as f64, (k / n) as f64, 1.0 / scale);
            (0..n * n).map(at).collect()
        };
        assert_eq!(interpolated(&of(5, 2.0), 5, 9), of(9, 1.0));
    }
}
