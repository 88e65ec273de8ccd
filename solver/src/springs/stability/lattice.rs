//! Stiffness of the homogeneously stretched infinite sheet against waves (Bloch analysis).
//!
//! With one node per cell every small displacement is a sum of waves `u(X) = U exp(i k·X)` (F. Bloch,
//! Z. Phys. 52, 1929; M. Born and K. Huang, *Dynamical Theory of Crystal Lattices*, 1954). The Hessian
//! decomposes into one real symmetric 2 × 2 matrix D(k) for displacements in the plane and one number for
//! displacements out of the plane. With cells of side 1 along the grid and `s = sin²(k/2)`:
//!
//! * paper's springs: `D = Σ 2 (1 − cos k·d) [along n⊗n + across (I − n⊗n)]` over the two edges and
//!   two diagonals of a cell, `along` = Sq·f′/rest, `across` = Sq·f/length; out of the plane
//!   `Σ 2 (1 − cos k·d) across`;
//! * coupled springs: with A = ∂²W/∂F² the four half-weight triangles of a cell add up to
//!   `D = 4 sₓ A·₁·₁ + 4 s_y A·₂·₂ + sin kₓ sin k_y (A·₁·₂ + A·₂·₁)`, out of the plane the same
//!   with the tension S in place of A.
//!
//! [`Wave::stiffness`] is the smallest eigenvalue of D over `4 (sₓ + s_y)`, relative to the edge stiffness
//! at small strain. The denominator is k² for long waves: long and short waves are comparable, and the
//! limit of long waves is the acoustic tensor of the homogeneous sheet.
//!
//! The sheet stretched along the grid is mirror symmetric; 0 ≤ kₓ, k_y ≤ π covers all waves.
//!
//! Uses `coupled` and `paper`. Used by `stability`.

use crate::springs::Material;
use crate::springs::coupled::principal_response;
use crate::springs::paper::{self, Spring};
use std::f64::consts::{FRAC_PI_2, PI};

/// Rounding error of a stiffness \[fraction of the edge stiffness\].
const ROUNDING: f64 = 1e-12;

/// Stiffness of a homogeneously stretched sheet against waves, relative to the small-strain edge
/// stiffness \[-\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Lattice {
    xx: Entry,
    yy: Entry,
    /// Factor of the entry xy.
    xy: f64,
    zz: Entry,
}

/// An entry of D over `4 (sₓ + s_y)`; with p = sₓ/(sₓ + s_y) and q = sₓ + s_y the entry equals
/// `p·along + (1 − p)·up − q p (1 − p)·both`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Entry {
    along: f64,
    up: f64,
    both: f64,
}

impl Entry {
    fn at(self, p: f64, q: f64) -> f64 {
        p * self.along + (1.0 - p) * self.up - q * p * (1.0 - p) * self.both
    }

    fn add(&mut self, along: f64, up: f64, both: f64) {
        self.along += along;
        self.up += up;
        self.both += both;
    }
}

/// A wave in the plane, and how stiff the sheet is against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wave {
    /// Stiffness against the wave \[fraction of the edge stiffness\]; a negative value means an unstable
    /// homogeneous state.
    pub stiffness: f64,
    /// Wave vector k \[rad per cell\], components 0 to π; (0, 0) is the limit of long waves.
    pub vector: [f64; 2],
    /// Angle between k and the x axis \[rad\], 0 to π/2; defined for long waves too.
    pub angle: f64,
    /// Angle between the displacement and the x axis \[rad\], in (−π/2, π/2].
    pub polarisation: f64,
}

impl Lattice {
    /// Lattice of the paper's springs of bonded layers at strains (εₓ, ε_y).
    #[must_use]
    pub fn paper(layers: &[Material], [x, y]: [f64; 2], edge_stiffness: f64) -> Self {
        let mut lattice = Self::default();
        let diagonal = paper::diagonal_strain(x, y);
        // Direction of one diagonal; the other diagonal is the mirror image.
        let length = 2f64.sqrt() * (1.0 + diagonal);
        let [nx, ny] = [(1.0 + x) / length, (1.0 + y) / length];
        for layer in layers {
            // Axial and transverse stiffness of a spring; a diagonal has the rest length √2 and the weight ½.
            let stiffness = |spring: Spring, strain: f64| {
                let weight = match spring {
                    Spring::Edge => 1.0,
                    Spring::Diagonal => 0.5 / 2f64.sqrt(),
                };
                let weight = weight * layer.thickness_mm / edge_stiffness;
                let (curve, nu) = (&layer.curve, layer.poisson_ratio);
                let across = paper::tension(spring, curve, nu, strain) / (1.0 + strain);
                [weight * paper::slope(spring, curve, nu, strain), weight * across]
            };
            let [along_x, across_x] = stiffness(Spring::Edge, x);
            let [along_y, across_y] = stiffness(Spring::Edge, y);
            let [along, across] = stiffness(Spring::Diagonal, diagonal);
            // For both diagonals the sum of 2 (1 − cos k·d) is 8 (sₓ + s_y − 2 sₓ s_y), and the
            // difference is 4 sin kₓ sin k_y.
            let add = |entry: &mut Entry, x: f64, y: f64, both: f64| {
                entry.add(x + 2.0 * both, y + 2.0 * both, 4.0 * both);
            };
            add(&mut lattice.xx, along_x, across_y, across + (along - across) * nx * nx);
            add(&mut lattice.yy, across_x, along_y, across + (along - across) * ny * ny);
            add(&mut lattice.zz, across_x, across_y, across);
            lattice.xy += 4.0 * (along - across) * nx * ny;
        }
        lattice
    }

    /// Lattice of the coupled springs of bonded layers at strains (εₓ, ε_y).
    #[must_use]
    pub fn coupled(layers: &[Material], strains: [f64; 2], edge_stiffness: f64) -> Self {
        let mut lattice = Self::default();
        let [x, y] = strains.map(|strain| 1.0 + strain);
        for layer in layers {
            let response = principal_response(&layer.curve, layer.poisson_ratio, strains);
            let relative = |value: f64| value * layer.thickness_mm / edge_stiffness;
            let [tx, ty] = response.tension.map(relative);
            let [along, mixed, up] = response.stiffness.map(relative);
            // A₁₂₁₂ = shear + turn and A₁₂₂₁ = shear − turn of an isotropic energy
            // (R. W. Ogden, Non-Linear Elastic Deformations, 1984, section 6.1).
            let (turn, shear) = (0.5 * (tx + ty) / (x + y), 0.5 * relative(response.shear));
            lattice.xx.add(along, shear + turn, 0.0);
            lattice.yy.add(shear + turn, up, 0.0);
            lattice.zz.add(tx / x, ty / y, 0.0);
            lattice.xy += mixed + shear - turn;
        }
        lattice
    }

    /// D(k) over `4 (sₓ + s_y)` as \[xx, yy, xy\]; q = 0 is the limit of long waves.
    fn matrix(&self, p: f64, q: f64) -> [f64; 3] {
        // sin kₓ sin k_y / 4 (sₓ + s_y)
        let rest = (1.0 - q * p).max(0.0) * (1.0 - q * (1.0 - p)).max(0.0);
        let mixed = (p * (1.0 - p) * rest).sqrt();
        [self.xx.at(p, q), self.yy.at(p, q), self.xy * mixed]
    }

    /// D(k) \[fraction of the edge stiffness\] as \[xx, yy, xy, zz\], for 0 ≤ kₓ, k_y ≤ π.
    #[must_use]
    pub fn dynamical_matrix(&self, vector: [f64; 2]) -> [f64; 4] {
        let [x, y] = vector.map(|k| (0.5 * k).sin().powi(2));
        let q = x + y;
        if q <= 0.0 {
            return [0.0; 4];
        }
        let [xx, yy, xy] = self.matrix(x / q, q);
        [xx, yy, xy, self.zz.at(x / q, q)].map(|value| 4.0 * q * value)
    }

    /// Stiffness against waves out of the plane \[fraction of the edge stiffness\]: along x, along y (of
    /// any length), and of the checkerboard k = (π, π).
    ///
    /// The smallest of the three is the minimum over all waves, because the stiffness is linear in p and
    /// in q.
    #[must_use]
    pub fn out_of_plane(&self) -> [f64; 3] {
        let Entry { along, up, both } = self.zz;
        [along, up, 0.5 * (along + up - both)].map(without_rounding)
    }

    /// The wave in the plane with the smallest stiffness; among equal waves the longest.
    ///
    /// The variables of the search are the angle of (√sₓ, √s_y) and the greater of kₓ and k_y (the size).
    /// The matrix is smooth in both variables, including long waves of every direction (size 0).
    #[must_use]
    pub fn weakest_wave(&self, search: Search) -> Wave {
        let step = [FRAC_PI_2 / f64::from(search.angles), PI / f64::from(search.sizes)];
        let mut best = ([0.0; 2], f64::INFINITY);
        let mut evaluate = |[angle, size]: [f64; 2]| {
            let at = [angle.clamp(0.0, FRAC_PI_2), size.clamp(0.0, PI)];
            let stiffness = least_eigenvalue(self.matrix_of(at));
            let is_better = stiffness < best.1 - ROUNDING;
            if is_better {
                best = (at, stiffness);
            }
            (is_better, best.0)
        };
        for k in 0..=search.sizes {
            for i in 0..=search.angles {
                evaluate([step[0] * f64::from(i), step[1] * f64::from(k)]);
            }
        }
        // Coordinate search from the best sample.
        let mut step = step.map(|step| 0.5 * step);
        let mut at = evaluate([0.0; 2]).1;
        while step[0] > 1e-6 {
            let mut has_moved = false;
            for [i, k] in [[-1.0, 0.0], [1.0, 0.0], [0.0, -1.0], [0.0, 1.0]] {
                let (is_better, best) = evaluate([at[0] + i * step[0], at[1] + k * step[1]]);
                (at, has_moved) = (best, has_moved || is_better);
            }
            if !has_moved {
                step = step.map(|step| 0.5 * step);
            }
        }
        self.wave(at)
    }

    fn matrix_of(&self, variables: [f64; 2]) -> [f64; 3] {
        let (p, q) = direction_and_size(variables);
        self.matrix(p, q)
    }

    fn wave(&self, [angle, size]: [f64; 2]) -> Wave {
        let (p, q) = direction_and_size([angle, size]);
        let vector = [p, 1.0 - p].map(|p| 2.0 * (q * p).sqrt().min(1.0).asin());
        let matrix @ [xx, yy, xy] = self.matrix(p, q);
        let polarisation = 0.5 * (0.0 - 2.0 * xy).atan2(yy - xx);
        Wave {
            stiffness: without_rounding(least_eigenvalue(matrix)),
            vector,
            angle: if size > 0.0 { vector[1].atan2(vector[0]) } else { angle },
            // Displacements along −y and along y are equal.
            polarisation: if polarisation < 1e-6 - FRAC_PI_2 { FRAC_PI_2 } else { polarisation },
        }
    }
}

/// Resolution of the search for the weakest wave before the coordinate search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Search {
    /// Number of steps of the angle over π/2.
    angles: u32,
    /// Number of steps of the greater of kₓ and k_y over π.
    sizes: u32,
}

impl Search {
    /// Resolution for maps.
    pub const FINE: Self = Self { angles: 36, sizes: 24 };
    /// Resolution for interactive use.
    pub const QUICK: Self = Self { angles: 8, sizes: 6 };
}

/// p and q of the variables of the search.
fn direction_and_size([angle, size]: [f64; 2]) -> (f64, f64) {
    let p = angle.cos().powi(2);
    (p, (0.5 * size).sin().powi(2) / p.max(1.0 - p))
}

fn least_eigenvalue([xx, yy, xy]: [f64; 3]) -> f64 {
    0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy)
}

fn without_rounding(value: f64) -> f64 {
    if value.abs() < ROUNDING { 0.0 } else { value }
}
