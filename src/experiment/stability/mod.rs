//! Is an evenly stretched sheet stable, or is there a small motion that lowers its energy?
//!
//! [`Stack`] gives the even states of bonded layers: pulled one way ([`Load::Uniaxial`]) or both ways
//! ([`Load::Equibiaxial`]). Three answers for each:
//!
//! * the infinite sheet, by its waves (`lattice`): in the plane ([`Lattice::weakest_wave`]), which
//!   is what "stable" means wherever nothing else is said, and
//! * out of the plane ([`Lattice::out_of_plane`]): a free sheet without bending stiffness crumples
//!   where this is negative, and pulled one way it is exactly neutral at best, since nothing pulls
//!   across. A dome under the sheet, and curvature, hold it; in the plane nothing does;
//! * the finite sheet with a free border ([`Sample::least_eigenvalue`]), as the paper pulled it.
//!
//! [`row`] is a line of a map over strain and Poisson ratio, [`Limits`] what the app asks: from which
//! strain on has this stack no stable even shape?
//!
//! Uses `curve`, `springs`, `solve` (for its layers) and `sample`. Used by `session`, `view` and the
//! command line.

mod lattice;

pub use lattice::{Lattice, Search, Wave};

use super::sample::Sample;
use crate::curve::{Curve, FULL_STRAIN};
use crate::solve::Material;
use crate::springs::Springs;
use crate::springs::coupled;
use crate::springs::paper::{self, Spring};
use glam::DVec2;

/// Cells per side of the finite sheet of a map: the paper's sample.
pub const CELLS: usize = 4;

/// How the sheet is stretched.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Load {
    /// By ε along x, free to narrow: no stress across.
    Uniaxial,
    /// By ε along x and along y.
    Equibiaxial,
}

impl Load {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Uniaxial, Self::Equibiaxial];

    /// The name in tables.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Uniaxial => "uniaxial",
            Self::Equibiaxial => "equibiaxial",
        }
    }
}

/// Bonded layers under one spring law: their nodes are the same, so their energies add.
#[derive(Clone, Debug)]
pub struct Stack<'a> {
    springs: Springs,
    layers: &'a [Material],
    edge_stiffness: f64,
}

impl<'a> Stack<'a> {
    /// The given layers, at least one.
    #[must_use]
    pub fn new(springs: Springs, layers: &'a [Material]) -> Self {
        let stiffness = |l: &Material| l.thickness_mm * l.curve.small_strain_modulus();
        Self { springs, layers, edge_stiffness: layers.iter().map(stiffness).sum() }
    }

    /// Strains (εₓ, ε_y) of the even state that a load makes at strain ε ≥ 0 along x.
    ///
    /// One layer narrows by νε. Layers of different ν agree on the width at which the stress across
    /// vanishes; it rises with the width, under either law, and so is found by bisection.
    #[must_use]
    pub fn strains(&self, load: Load, strain: f64) -> [f64; 2] {
        if load == Load::Equibiaxial {
            return [strain; 2];
        }
        let ratios = || self.layers.iter().map(|layer| layer.poisson_ratio);
        let (mut wide, mut narrow) = (ratios().fold(1.0, f64::min), ratios().fold(0.0, f64::max));
        while narrow - wide > 1e-9 {
            let middle = 0.5 * (wide + narrow);
            let pulls = self.tension_across([strain, -middle * strain]) > 0.0;
            if pulls { wide = middle } else { narrow = middle }
        }
        [strain, -0.5 * (wide + narrow) * strain]
    }

    /// Tension across the pull \[kPa·mm\].
    fn tension_across(&self, [x, y]: [f64; 2]) -> f64 {
        let diagonal = paper::diagonal_strain(x, y);
        // Two diagonals of weight ½ a cell, each with its component across.
        let share = (1.0 + y) / (2f64.sqrt() * (1.0 + diagonal));
        let stress = |Material { curve, poisson_ratio: nu, .. }: &Material| match self.springs {
            Springs::Coupled => coupled::biot_stress(curve, *nu, [x, y])[1],
            Springs::Nikolaev => {
                paper::tension(Spring::Edge, curve, *nu, y)
                    + share * paper::tension(Spring::Diagonal, curve, *nu, diagonal)
            }
        };
        self.layers.iter().map(|layer| layer.thickness_mm * stress(layer)).sum()
    }

    /// The stiffness of the infinite sheet against waves at strains (εₓ, ε_y).
    #[must_use]
    pub fn lattice(&self, strains: [f64; 2]) -> Lattice {
        match self.springs {
            Springs::Coupled => Lattice::coupled(self.layers, strains, self.edge_stiffness),
            Springs::Nikolaev => Lattice::paper(self.layers, strains, self.edge_stiffness),
        }
    }
}

/// A state of one layer in a map. Stiffnesses are shares of the small-strain edge stiffness Ef′(0)·h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Strain ε along x \[-\].
    pub strain: f64,
    /// Strain across \[-\].
    pub transverse_strain: f64,
    /// Least eigenvalue of the Hessian of the finite sheet, 4 × 4 cells with a free border, rigid
    /// motions set aside.
    pub sheet: f64,
    /// The wave in the plane against which the infinite sheet is least stiff.
    pub wave: Wave,
    /// Stiffness of the infinite sheet against waves out of the plane ([`Lattice::out_of_plane`]).
    pub out_of_plane: [f64; 3],
}

impl Point {
    /// The least stiffness of the infinite sheet against a wave out of the plane.
    #[must_use]
    pub fn least_out_of_plane(&self) -> f64 {
        self.out_of_plane.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// The states of one layer under one load at the given strains.
#[must_use]
pub fn row(
    springs: Springs,
    curve: &Curve,
    poisson_ratio: f64,
    load: Load,
    strains: &[f64],
) -> Vec<Point> {
    let layer = [Material { curve: curve.clone(), poisson_ratio, thickness_mm: 1.0 }];
    let stack = Stack::new(springs, &layer);
    let sample = Sample::new(CELLS, springs, curve, poisson_ratio);
    let point = |&strain: &f64| {
        let strains = stack.strains(load, strain);
        let stretch = DVec2::ONE + DVec2::from(strains);
        let shape: Vec<DVec2> = sample.rest().iter().map(|p| *p * stretch).collect();
        let lattice = stack.lattice(strains);
        Point {
            poisson_ratio,
            strain,
            transverse_strain: strains[1],
            sheet: sample.least_eigenvalue(&shape),
            wave: lattice.weakest_wave(Search::FINE),
            out_of_plane: lattice.out_of_plane(),
        }
    };
    strains.iter().map(point).collect()
}

/// Where a stack has no stable even shape, strain 0 to 1.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Stretches of strain \[-\] without one when pulled one way, from and to, known to 0.0005.
    pub uniaxial: Vec<[f64; 2]>,
    /// The same when pulled both ways.
    pub equibiaxial: Vec<[f64; 2]>,
    /// States that were asked.
    pub states: u64,
}

impl Limits {
    /// Strains asked before bisection: a stretch shorter than one step may be overlooked.
    const STEPS: u32 = 100;
    /// Halvings of a step.
    const HALVINGS: u32 = 4;

    /// The limits of the given layers.
    #[must_use]
    pub fn new(springs: Springs, layers: &[Material]) -> Self {
        let stack = Stack::new(springs, layers);
        let mut limits = Self::default();
        let mut states = 0;
        let [uniaxial, equibiaxial] = Load::ALL.map(|load| {
            let mut is_unstable = |strain: f64| {
                states += 1;
                let lattice = stack.lattice(stack.strains(load, strain));
                lattice.weakest_wave(Search::QUICK).stiffness < 0.0
            };
            unstable_stretches(&mut is_unstable)
        });
        (limits.uniaxial, limits.equibiaxial, limits.states) = (uniaxial, equibiaxial, states);
        limits
    }

    /// The stretches under a load.
    #[must_use]
    pub fn of(&self, load: Load) -> &[[f64; 2]] {
        match load {
            Load::Uniaxial => &self.uniaxial,
            Load::Equibiaxial => &self.equibiaxial,
        }
    }

    /// The strain from which on the stack has no stable even shape under a load \[-\]; `None` if it
    /// always has one.
    #[must_use]
    pub fn first_loss(&self, load: Load) -> Option<f64> {
        self.of(load).first().map(|stretch| stretch[0])
    }
}

fn unstable_stretches(is_unstable: &mut dyn FnMut(f64) -> bool) -> Vec<[f64; 2]> {
    let step = FULL_STRAIN / f64::from(Limits::STEPS);
    let mut stretches: Vec<[f64; 2]> = Vec::new();
    let mut was_unstable = false;
    for k in 0..=Limits::STEPS {
        let strain = step * f64::from(k);
        let now_unstable = is_unstable(strain);
        if now_unstable != was_unstable {
            let (mut before, mut after) = ((strain - step).max(0.0), strain);
            for _ in 0..Limits::HALVINGS {
                let middle = 0.5 * (before + after);
                if is_unstable(middle) == now_unstable { after = middle } else { before = middle }
            }
            match stretches.last_mut() {
                Some(last) if !now_unstable => last[1] = before,
                _ => stretches.push([after, FULL_STRAIN]),
            }
        }
        was_unstable = now_unstable;
    }
    stretches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::experiment::dense::Matrix;

    /// The least eigenvalue of a sheet of cells whose border is held \[share of the edge stiffness\].
    fn clamped(sample: &Sample, cells: usize, shape: &[DVec2]) -> f64 {
        let whole = sample.hessian(shape);
        let inner: Vec<usize> = (1..cells)
            .flat_map(|j| (1..cells).map(move |i| j * (cells + 1) + i))
            .flat_map(|node| [2 * node, 2 * node + 1])
            .collect();
        let mut matrix = Matrix::zeros(inner.len());
        for (row, &from) in inner.iter().enumerate() {
            for (column, &to) in inner.iter().enumerate() {
                matrix.add(row, column, whole.get(from, to));
            }
        }
        matrix.least_eigenvalue() / sample.edge_stiffness()
    }

    #[test]
    fn a_held_sheet_comes_down_to_the_weakest_wave_as_it_grows_and_never_below() {
        // What moves inside of a held border moves in the infinite sheet too, with the same energy:
        // no held sheet is weaker than the weakest wave, and a larger one is no stiffer.
        for (spec, nu, springs) in [
            (CurveSpec::Adipose {}, 0.3, Springs::Nikolaev),
            (CurveSpec::Linear { modulus_kpa: 100.0 }, 0.45, Springs::Nikolaev),
            (CurveSpec::Skin {}, 0.2, Springs::Nikolaev),
            (CurveSpec::Skin {}, 0.45, Springs::Coupled),
        ] {
            let curve = Curve::new(&spec).unwrap();
            let layer = [Material { curve: curve.clone(), poisson_ratio: nu, thickness_mm: 1.0 }];
            let stack = Stack::new(springs, &layer);
            for load in Load::ALL {
                let strains = stack.strains(load, 0.6);
                let stretch = DVec2::ONE + DVec2::from(strains);
                // Over all waves, long ones included: the least eigenvalue of D itself.
                let lattice = stack.lattice(strains);
                let eigenvalue = |wave: [f64; 2]| {
                    let [xx, yy, xy, _] = lattice.dynamical_matrix(wave);
                    0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy)
                };
                let side = || (0..=64).map(|k| std::f64::consts::PI * f64::from(k) / 64.0);
                let least = side()
                    .flat_map(|x| side().map(move |y| [x, y]))
                    .map(eigenvalue)
                    .fold(f64::INFINITY, f64::min);
                let gaps = [4, 6, 9].map(|cells| {
                    let sample = Sample::new(cells, springs, &curve, nu);
                    let shape: Vec<DVec2> = sample.rest().iter().map(|p| *p * stretch).collect();
                    clamped(&sample, cells, &shape) - least
                });
                assert!(gaps[2] > -1e-6, "{spec:?} {load:?}: {gaps:?}");
                assert!(gaps[1] < 0.7 * gaps[0] && gaps[2] < 0.7 * gaps[1], "{spec:?}: {gaps:?}");
            }
        }
    }
}
