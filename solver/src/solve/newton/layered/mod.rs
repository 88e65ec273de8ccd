//! Layered tissue in Newton's method: exact second derivatives of the cells without an assembled matrix, column solves.
//!
//! The step of an iteration: conjugate gradients in the inactive directions, which a direction of negative curvature ends
//! (T. Steihaug, SIAM J. Numer. Anal. 20(3), 1983; `conjugate_gradients`); then the active set of the step: nodes that
//! pass the obstacle become active, nodes that the obstacle would pull leave; both repeat until the set rests
//! (`active_set`; M. Hintermüller, K. Ito and K. Kunisch, SIAM J. Optim. 13(3), 2002).

mod active_set;
mod conjugate_gradients;
mod parameters;

use super::conjugate_gradients::CgState;
use super::parameters::{self as shared, Parameters};
use super::{Case, Contact, Grid, Layers, Newton, Phase, State, System};
use crate::contact::{Obstacle, TOUCH_F64};
use crate::mesh::Pocket;
use crate::mesh::stencil::BlockStencil9;
use crate::model::layered::LayeredLaw;
use crate::model::layered::exact::{Exact, Place};
use crate::model::layered::suction::Suction;
use crate::model::layered::tangent::Tangent;
use crate::model::membrane::assembly::{self, Stiffness, Sums, Totals};
use crate::solve::linear::columns::Columns;
use glam::{DMat3, DVec3};
use parameters::{PARAMETERS, PLACES_PER_PIECE};
use std::convert::Infallible;

type LayeredNewton = Newton<LayeredSystem>;
type LayeredCase<'a> = Case<'a, LayeredLaw>;

/// The quadratic model of the energy of layered tissue; arrays of shape (n², ).
pub(in crate::solve) struct LayeredSystem {
    /// The cells of the sheet, for a pocket.
    places: Vec<Place>,
    pocket: Option<Pocket>,
    tangent: Tangent,
    /// See [`Exact::at_rest`].
    at_rest: Vec<Vec<DVec3>>,
    /// The suction of a void, and the inner face at which its second derivatives are taken.
    suction: Option<Suction>,
    inner_face: Vec<DVec3>,
    skin: BlockStencil9,
    /// Forces of the skin alone.
    skin_forces: Vec<DVec3>,
    totals: Totals,
    columns: Columns,
    /// Blocks of the inner face and their inverses, the nodes above being free to follow.
    inner: Vec<[DMat3; 2]>,
}

impl<'a> LayeredCase<'a> {
    fn exact(&self, grid: &'a Grid, at_rest: &'a [Vec<DVec3>]) -> Exact<'a> {
        let (pocket, attachment) = (self.patch.pocket(), self.patch.attachment());
        let at_rest = at_rest.into();
        Exact { rest: &grid.rest, law: self.law, pocket, attachment, at_rest }
    }
}

impl System for LayeredSystem {
    type Law = LayeredLaw;
    type Piece = Infallible;
    type Checks = ();
    const PARAMETERS: Parameters = shared::LAYERED;

    /// Number of cells between free nodes.
    fn elements(grid: &Grid) -> usize {
        (grid.free.len() * grid.rest.cells().len()).max(1)
    }

    fn new(grid: &Grid) -> Self {
        let size = grid.sheet().len();
        Self {
            places: Vec::new(),
            pocket: None,
            tangent: Tangent::default(),
            at_rest: Vec::new(),
            suction: None,
            inner_face: Vec::new(),
            skin: BlockStencil9::new(grid.sheet().nodes_per_side()),
            skin_forces: vec![DVec3::ZERO; size],
            totals: Totals::default(),
            columns: Columns::new(size, grid.rest.layers()),
            inner: vec![[DMat3::ZERO; 2]; size],
        }
    }

    fn set_first_guess(grid: &Grid, _obstacle: &Obstacle, x: &mut Layers) {
        grid.put_at_rest(x);
    }

    /// Moves whole columns.
    fn start(newton: &mut LayeredNewton, case: &LayeredCase) {
        let (pocket, attachment) = (case.patch.pocket(), case.patch.attachment());
        let exact = Exact::new(&newton.grid.rest, case.law, pocket, attachment);
        let system = &mut newton.system;
        if system.pocket != Some(pocket) {
            system.places = exact.places();
            system.pocket = Some(pocket);
        }
        system.tangent.attach(&exact);
        system.at_rest = exact.at_rest.into_owned();
        let (kpa, sheet) = (case.suction_kpa, newton.grid.rest.sheet());
        let wall = &case.obstacle.wall.0;
        let suction = || Suction::new(kpa, wall, sheet, pocket);
        system.suction = (kpa > 0.0).then(suction);
        for k in newton.grid.free() {
            let shift = case.obstacle.project(newton.x[0][k], 0.0) - newton.x[0][k];
            newton.x.iter_mut().for_each(|layer| layer[k] += shift);
        }
    }

    fn energy(&self, grid: &Grid, case: &LayeredCase, x: &Layers) -> f64 {
        let of_suction = self.suction.as_ref().map_or(0.0, |suction| suction.energy(&x[0]));
        case.exact(grid, &self.at_rest).energy(&self.places, x) + of_suction
    }

    fn linearize(newton: &mut LayeredNewton, case: &LayeredCase, place: usize) -> Option<usize> {
        let Newton { grid, x, forces, energy, system, .. } = newton;
        let LayeredSystem { places, tangent, at_rest, suction, inner_face, .. } = system;
        let exact = case.exact(grid, at_rest);
        if place == 0 {
            exact.set_forces(places, x, forces);
            if newton.iterations == 0 {
                let of_suction = suction.as_ref().map_or(0.0, |suction| suction.energy(&x[0]));
                *energy = exact.energy(places, x) + of_suction;
            }
            if let Some(suction) = suction {
                inner_face.clone_from(&x[0]);
                (0..x[0].len()).for_each(|k| forces[0][k] += suction.force(k, &x[0]));
            }
            tangent.clear();
        }
        let end = (place + PLACES_PER_PIECE).min(places.len());
        tangent.linearize(&exact, &places[place..end], x);
        (end < places.len()).then_some(end)
    }

    fn complete(newton: &mut LayeredNewton, case: &LayeredCase) -> Option<State> {
        if !newton.energy.is_finite() {
            return Some(State::Stalled);
        }
        newton.find_contact(&case.obstacle, TOUCH_F64);
        let Newton { grid, x, contact, system, .. } = newton;
        system.linearize_skin(grid, case.law, x);
        system.eliminate_columns(grid, contact);
        (0..newton.grid.free.len()).for_each(|k| newton.constrain(newton.grid.free[k] as usize));
        None
    }

    fn force_scale(&self, _grid: &Grid, _law: &LayeredLaw) -> f64 {
        let squares = self.totals.force_scale().powi(2) + self.tangent.squared_forces();
        squares.max(f64::MIN_POSITIVE).sqrt()
    }

    fn block(&self, k: usize) -> [&DMat3; 2] {
        self.inner[k].each_ref()
    }

    fn product(&self, grid: &Grid, contact: &Contact, v: &Layers, out: &mut Layers) {
        out.iter_mut().for_each(|layer| layer.fill(DVec3::ZERO));
        self.tangent.add_product(v, out);
        let top = v.len() - 1;
        for k in grid.free() {
            out[top][k] += self.skin.row(k, &v[top]);
        }
        for (k, curvature) in &contact.curvature {
            out[0][*k] -= *curvature * v[0][*k];
        }
        if let Some(suction) = &self.suction {
            grid.free().for_each(|k| out[0][k] += suction.product(k, &self.inner_face, &v[0]));
        }
    }

    fn precondition(&mut self, grid: &Grid, contact: &Contact, r: &Layers, z: &mut Layers) {
        for k in grid.free() {
            self.columns.solve(k, &contact.inverse[k], r, z);
        }
    }

    fn begin_rounds(newton: &mut LayeredNewton) {
        newton.begin_gradients();
    }

    fn update_active_set(newton: &mut LayeredNewton) {
        newton.update_active_set();
    }

    fn conjugate_gradients(newton: &mut LayeredNewton, step: CgState) {
        newton.conjugate_gradients(step);
    }

    fn own_piece(_newton: &mut LayeredNewton, _case: &LayeredCase, piece: Infallible) -> State {
        match piece {}
    }
}

impl LayeredSystem {
    fn linearize_skin(&mut self, grid: &Grid, law: &LayeredLaw, x: &Layers) {
        self.skin.clear();
        self.totals = Totals::default();
        let sums = Sums {
            forces: &mut self.skin_forces,
            hessian: &mut self.skin,
            totals: &mut self.totals,
        };
        let (surface, law) = (grid.rest.membrane(), &law.skin);
        let rows = 0..surface.sheet().nodes_per_side() - 1;
        assembly::linearize_rows(surface, law, &x[x.len() - 1], rows, Stiffness::Positive, sums);
    }

    /// Eliminates the columns of free nodes, whose inner blocks lose the obstacle's curvature.
    fn eliminate_columns(&mut self, grid: &Grid, contact: &Contact) {
        let columns = &mut self.columns;
        columns.clear();
        let Columns { diagonal, above } = columns;
        self.tangent.visit_blocks(
            |layer, k, block| diagonal[layer][k] += block,
            |layer, k, block| above[layer][k] += block,
        );
        let top = diagonal.len() - 1;
        for k in grid.free() {
            diagonal[top][k] += self.skin.diagonal[k];
        }
        for (k, curvature) in &contact.curvature {
            diagonal[0][*k] -= *curvature;
        }
        for k in grid.free() {
            self.inner[k] = columns.eliminate(k);
        }
    }
}
