//! Stability of a homogeneously stretched sheet against small perturbations.
//!
//! [`Stack`] computes the homogeneous states of bonded layers under uniaxial ([`Load::Uniaxial`]) and
//! equibiaxial ([`Load::Equibiaxial`]) tension; [`Lattice`] the stiffness against waves in the plane
//! ([`Lattice::weakest_wave`]) and out of the plane ([`Lattice::out_of_plane`]); [`Limits`] the strains
//! without a stable homogeneous state.
//!
//! Uses `curve`, `coupled` and `paper`. Used by `session`, the lab, `view` and `app`.

mod lattice;

pub use lattice::{Lattice, Search, Wave};

use super::coupled;
use super::paper::{self, Spring};
use super::{Material, Springs};
use crate::curve::FULL_STRAIN;

/// Homogeneous load of the sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Load {
    /// Strain ε along x without transverse stress.
    Uniaxial,
    /// Strain ε along x and along y.
    Equibiaxial,
}

impl Load {
    /// Both loads.
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

/// Bonded layers under one spring law. The layers share their nodes; their energies add up.
#[derive(Clone, Debug)]
pub struct Stack<'a> {
    springs: Springs,
    layers: &'a [Material],
    edge_stiffness: f64,
}

impl<'a> Stack<'a> {
    /// Creates a stack of at least one layer.
    #[must_use]
    pub fn new(springs: Springs, layers: &'a [Material]) -> Self {
        let stiffness = |l: &Material| l.thickness_mm * l.curve.small_strain_modulus();
        Self { springs, layers, edge_stiffness: layers.iter().map(stiffness).sum() }
    }

    /// Strains (εₓ, ε_y) of the homogeneous state under a load at strain ε ≥ 0 along x.
    ///
    /// One layer contracts by νε. Layers of different ν have a common transverse strain with zero transverse
    /// tension; the tension increases with the strain under either law, bisection finds the root.
    #[must_use]
    pub fn strains(&self, load: Load, strain: f64) -> [f64; 2] {
        if load == Load::Equibiaxial {
            return [strain; 2];
        }
        let ratios = || self.layers.iter().map(|layer| layer.poisson_ratio);
        let (mut wide, mut narrow) = (ratios().fold(1.0, f64::min), ratios().fold(0.0, f64::max));
        while narrow - wide > 1e-9 {
            let middle = 0.5 * (wide + narrow);
            let is_tensile = self.transverse_tension([strain, -middle * strain]) > 0.0;
            if is_tensile { wide = middle } else { narrow = middle }
        }
        [strain, -0.5 * (wide + narrow) * strain]
    }

    /// Transverse tension \[kPa·mm\].
    fn transverse_tension(&self, [x, y]: [f64; 2]) -> f64 {
        let diagonal = paper::diagonal_strain(x, y);
        // Two diagonals of weight ½ per cell, each with its transverse component.
        let component = (1.0 + y) / (2f64.sqrt() * (1.0 + diagonal));
        let stress = |Material { curve, poisson_ratio: nu, .. }: &Material| match self.springs {
            Springs::Coupled => coupled::biot_stress(curve, *nu, [x, y])[1],
            Springs::Nikolaev => {
                paper::tension(Spring::Edge, curve, *nu, y)
                    + component * paper::tension(Spring::Diagonal, curve, *nu, diagonal)
            }
        };
        self.layers.iter().map(|layer| layer.thickness_mm * stress(layer)).sum()
    }

    /// Stiffness of the infinite sheet against waves at strains (εₓ, ε_y).
    #[must_use]
    pub fn lattice(&self, strains: [f64; 2]) -> Lattice {
        match self.springs {
            Springs::Coupled => Lattice::coupled(self.layers, strains, self.edge_stiffness),
            Springs::Nikolaev => Lattice::paper(self.layers, strains, self.edge_stiffness),
        }
    }
}

/// Strains from 0 to 1 without a stable homogeneous state of a stack.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Unstable intervals of strain under uniaxial tension \[-\], accurate to 0.0005.
    pub uniaxial: Vec<[f64; 2]>,
    /// Unstable intervals of strain under equibiaxial tension \[-\], accurate to 0.0005.
    pub equibiaxial: Vec<[f64; 2]>,
    /// Number of evaluated states.
    pub states: u64,
}

impl Limits {
    /// Number of strain steps before bisection; an interval shorter than one step may be missed.
    const STEPS: u32 = 100;
    /// Number of bisections of a step.
    const HALVINGS: u32 = 4;

    /// Computes the limits of the given layers.
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
            unstable_intervals(&mut is_unstable)
        });
        (limits.uniaxial, limits.equibiaxial, limits.states) = (uniaxial, equibiaxial, states);
        limits
    }

    /// The unstable intervals under a load.
    #[must_use]
    pub fn of(&self, load: Load) -> &[[f64; 2]] {
        match load {
            Load::Uniaxial => &self.uniaxial,
            Load::Equibiaxial => &self.equibiaxial,
        }
    }

    /// Smallest strain without a stable homogeneous state under a load \[-\]; `None` if every state is
    /// stable.
    #[must_use]
    pub fn first_loss(&self, load: Load) -> Option<f64> {
        self.of(load).first().map(|interval| interval[0])
    }
}

/// Unstable intervals of strain between 0 and 1 \[-\]: sampled, then bisected.
fn unstable_intervals(is_unstable: &mut dyn FnMut(f64) -> bool) -> Vec<[f64; 2]> {
    let step = FULL_STRAIN / f64::from(Limits::STEPS);
    let mut intervals: Vec<[f64; 2]> = Vec::new();
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
            match intervals.last_mut() {
                Some(last) if !now_unstable => last[1] = before,
                _ => intervals.push([after, FULL_STRAIN]),
            }
        }
        was_unstable = now_unstable;
    }
    intervals
}
