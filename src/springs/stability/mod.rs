//! Stability of an evenly stretched sheet: does a small motion lower its energy?
//!
//! [`Stack`] gives the even states of bonded layers, pulled one way ([`Load::Uniaxial`]) or both ways
//! ([`Load::Equibiaxial`]); [`Lattice`] their stiffness against waves, in the plane
//! ([`Lattice::weakest_wave`]) and out of it ([`Lattice::out_of_plane`]); [`Limits`] the strains at which
//! a stack has no stable even shape.
//!
//! Uses `curve`, `coupled` and `paper`. Used by `session`, `experiment`, `view` and `app`.

mod lattice;

pub use lattice::{Lattice, Search, Wave};

use super::coupled;
use super::paper::{self, Spring};
use super::{Material, Springs};
use crate::curve::FULL_STRAIN;

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
