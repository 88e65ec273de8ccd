//! A tissue model as Newton's method uses it.

use super::parameters::Parameters;
use super::{Case, Contact, Grid, Layers, Newton, State, Trial};
use crate::contact::Obstacle;
use glam::{DMat3, DVec3};

/// A tissue model on one grid: energy, forces and second derivatives at one shape, and the methods for its step.
pub(in crate::solve) trait System: Sized {
    type Law;
    /// Pieces of work of this model alone.
    type Piece: Copy;
    /// Completed checks of a converged solution.
    type Checks: Default;
    const PARAMETERS: Parameters;

    /// Number of parts of the grid that evaluations of forces add up.
    fn elements(grid: &Grid) -> usize;

    fn new(grid: &Grid) -> Self;

    /// Sets the positions from which a solve starts on the coarsest grid.
    fn set_first_guess(grid: &Grid, obstacle: &Obstacle, x: &mut Layers);

    /// Prepares the start from the positions in `x`; moves the inner face out of the obstacle.
    fn start(newton: &mut Newton<Self>, case: &Case<Self::Law>);

    /// Elastic energy \[kPa·mm³\].
    fn energy(&self, grid: &Grid, case: &Case<Self::Law>, x: &Layers) -> f64;

    /// Adds a piece of energy, forces and second derivatives at `x`; returns the next piece, `None` at the end.
    fn linearize(newton: &mut Newton<Self>, case: &Case<Self::Law>, piece: usize) -> Option<usize>;

    /// Completes the model with the obstacle's curvature; a state ends the piece of work.
    fn complete(newton: &mut Newton<Self>, case: &Case<Self::Law>) -> Option<State>;

    /// The scale of forces \[kPa·mm²\].
    fn force_scale(&self, grid: &Grid, law: &Self::Law) -> f64;

    /// The inner face's block at a node, the nodes above being free to follow, and its inverse.
    fn block(&self, k: usize) -> [&DMat3; 2];

    /// Sets `out` to H v at the free nodes.
    fn product(&self, grid: &Grid, contact: &Contact, v: &Layers, out: &mut Layers);

    /// Sets `z` to an approximation of H⁻¹ r in the unconstrained directions.
    fn precondition(&mut self, grid: &Grid, contact: &Contact, r: &Layers, z: &mut Layers);

    /// Begins the rounds of active set and conjugate gradients of an iteration.
    fn begin_rounds(newton: &mut Newton<Self>);

    fn update_active_set(newton: &mut Newton<Self>);

    fn conjugate_gradients(newton: &mut Newton<Self>, step: super::CgState);

    /// Does a piece of work of this model alone.
    fn own_piece(newton: &mut Newton<Self>, case: &Case<Self::Law>, piece: Self::Piece) -> State;

    /// Contact offset of a node, as a gauge \[-\].
    fn offset(&self, _k: usize) -> f64 {
        0.0
    }

    /// Rounding of the energy by the rounding of positions \[kPa·mm³\].
    fn energy_of_rounding(&self, _grid: &Grid) -> f64 {
        0.0
    }

    /// Is a rejected step to be given up without shorter lengths?
    fn is_uphill(&self, _trial: &Trial) -> bool {
        false
    }

    /// Ends a line search without a decrease of the energy.
    fn reject_step(_newton: &mut Newton<Self>, _is_uphill: bool) -> State {
        State::Stalled
    }

    /// Estimates the error after an accepted step; returns the state of the iteration.
    fn accept_step(
        newton: &mut Newton<Self>,
        case: &Case<Self::Law>,
        trial: &Trial,
        is_full: bool,
    ) -> State {
        newton.estimate_error(trial, is_full, 1.0, false);
        let most = Self::PARAMETERS.max_residual_before_step;
        if newton.has_converged(trial, case, most) { State::Converged } else { State::Working }
    }

    /// Checks the final state of the finest grid; returns [`State::Working`] if the iteration has to continue.
    fn check(
        _newton: &mut Newton<Self>,
        _checks: &mut Self::Checks,
        _case: &Case<Self::Law>,
        state: State,
    ) -> State {
        state
    }

    /// Does the shape have an inverted part that no cell of the inner face shows?
    fn is_inverted(_grid: &Grid, _x: &Layers) -> bool {
        false
    }

    /// Moves nodes with contact offsets in the result `x`, and lists their balanced positions.
    fn write_offsets(
        _newton: &Newton<Self>,
        _obstacle: &Obstacle,
        _x: &mut [DVec3],
        _offset_nodes: &mut Vec<(usize, DVec3)>,
    ) {
    }
}
