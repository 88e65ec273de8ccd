//! The balance of an implant that yields, with the solution of either method.

use super::Solver;
use super::fas::Ending;
use super::multigrid::Multigrid;
use super::newton::Start;
use super::yielding::Yielding;
use crate::contact::Modes;
use crate::mesh::NodeKind;
use glam::DVec3;
use std::sync::Arc;

/// Move of the surface by the next step up to which the numbers of a solution by Newton's method are balanced \[tolerance\].
const BALANCED: f64 = 0.3;
/// The most steps of the numbers between solutions by Newton's method.
const MAX_BALANCES: u32 = 30;
/// Gauge beside the surface up to which nodes follow it in part.
const FOLLOWING: f64 = 0.3;

impl Solver {
    /// Gives the problem's implant the numbers of its deformation that multigrid has found.
    pub(super) fn deform_as_multigrid(&mut self) {
        if let Some(modes) = self.multigrid.as_ref().and_then(Multigrid::modes) {
            self.deform(modes);
        }
    }

    pub(super) fn deform(&mut self, modes: Modes<f64>) {
        if self.problem.obstacle.dome.shape.soft().is_some() {
            Arc::make_mut(&mut self.problem).obstacle.dome.set_modes(modes);
        }
    }

    /// Ends with an implant whose balance is a move away \[mm\], which counts as an error.
    fn end_unbalanced(&mut self, left: f64) {
        let newton = self.newton.as_ref();
        let newton = newton.map(|newton| (newton.error(), newton.relative_residual()));
        let ending = newton.map(|(error, residual)| Ending::of(error + left, residual));
        let is_sheet = self.law.layered().is_none();
        self.kept = ending.filter(|ending| is_sheet || self.is_approximation(ending.error));
        self.end_with_last_shape();
    }

    /// Moves an implant that yields towards the balance with the solution of Newton's method, and starts again from there; false if it
    /// is balanced.
    pub(super) fn rebalance(&mut self) -> bool {
        let Some(own) = Yielding::of(&self.problem, self.problem.mirrored()) else { return false };
        let dome = &self.problem.obstacle.dome;
        let work = self.solution().part_reactions().work(&self.solution());
        let yielding = self.yielding.get_or_insert(own);
        let step = yielding.next_step(&work);
        let most = BALANCED * self.problem.tolerance * dome.reference_length();
        self.balances += 1;
        let left = yielding.greatest_move(&step);
        if left <= most {
            return false;
        }
        if self.balances > MAX_BALANCES {
            self.end_unbalanced(left);
            return true;
        }
        yielding.advance(&step);
        let before = dome.clone();
        let modes = yielding.modes;
        self.deform(modes);
        let dome = &self.problem.obstacle.dome;
        let kinds = self.problem.sheet().kinds();
        for k in (0..self.x.len()).filter(|k| kinds[*k] == NodeKind::Free) {
            let way: DVec3 = dome.way_after(&before, self.x[k], FOLLOWING);
            self.x[k] += way;
            self.outer.iter_mut().for_each(|layer| layer[k] += way);
        }
        self.start_newton(Start::FromSolution);
        true
    }
}

#[cfg(test)]
mod tests;
