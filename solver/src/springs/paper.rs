//! The paper's springs, exactly as published (Nikolaev 2013, "Poisson ratio modeling").
//!
//! A square cell of side L has four edge springs and two diagonal springs of rest length √2 L. Each
//! spring's force is its tension \[kPa\] — a function of its own strain ε = Δl/l alone — times the
//! width `Sq` it stands for. Every cell owns its six springs, each with
//!
//! > `Sq = L/2 · h` (h: thickness of the layer),
//!
//! so that an interior edge, which two cells share, weighs L·h, a border edge L/2·h and a diagonal
//! L/2·h. With these weights uniaxial tension is exact: a sheet stretched by ε along an edge and by
//! −νε across is in equilibrium under the nominal stress `Ef(ε)` (equation (1) of the paper).
//! The equilibrium may be unstable: `stability`.
//!
//! **Domain.** Equations (3) and (6) divide by `1 − ν ε` and `1 − ν J`, the cell's width across the
//! pull; they are undefined where that width is zero or negative. Up to [`edge_strain_limit`] they are used as they
//! stand; beyond it the tension goes on as a straight line with its last slope, so that it stays
//! finite, and [`is_outside_domain`] is true: a shape with such a spring is reported as
//! unstable. The root in `J` is real for every ε ≥ 0, the only strains it is used for.

use crate::curve::Curve;
use std::f64::consts::SQRT_2;

/// The width of a cell across the pull, relative to its rest width, below which the equations are
/// no longer used \[-\].
pub const LEAST_WIDTH: f64 = 0.05;

/// The two kinds of spring in a square cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spring {
    /// A side of the square, rest length L: equation (3).
    Edge,
    /// A diagonal of the square, rest length √2 L: equation (6).
    Diagonal,
}

/// Tension per width `Sq` \[kPa\] of a spring at strain `strain` \[-\], for ν in [0, 0.5].
#[must_use]
pub fn tension(spring: Spring, curve: &Curve, poisson_ratio: f64, strain: f64) -> f64 {
    let limit = strain_limit(spring, poisson_ratio);
    let inside = strain.min(limit);
    let value = match spring {
        Spring::Edge => edge_tension(curve, poisson_ratio, inside),
        Spring::Diagonal => diagonal_tension(curve, poisson_ratio, inside),
    };
    if strain > limit {
        value + slope(spring, curve, poisson_ratio, limit) * (strain - limit)
    } else {
        value
    }
}

/// Derivative of [`tension`] by the strain \[kPa\]; at strain 0, where it jumps, that of the
/// stretched side.
#[must_use]
pub fn slope(spring: Spring, curve: &Curve, poisson_ratio: f64, strain: f64) -> f64 {
    let inside = strain.min(strain_limit(spring, poisson_ratio));
    match spring {
        Spring::Edge => edge_slope(curve, poisson_ratio, inside),
        Spring::Diagonal => diagonal_slope(curve, poisson_ratio, inside),
    }
}

/// ∫₀^ε of [`tension`] \[kPa\]: a spring's energy is this times `Sq` times its rest length.
#[must_use]
pub fn energy(spring: Spring, curve: &Curve, poisson_ratio: f64, strain: f64) -> f64 {
    let limit = strain_limit(spring, poisson_ratio);
    let inside = strain.min(limit);
    let value = match spring {
        Spring::Edge => edge_energy(curve, poisson_ratio, inside),
        Spring::Diagonal => diagonal_energy(curve, poisson_ratio, inside),
    };
    let over = (strain - limit).max(0.0);
    if over > 0.0 {
        let at_limit = tension(spring, curve, poisson_ratio, limit);
        value + over * (at_limit + 0.5 * over * slope(spring, curve, poisson_ratio, limit))
    } else {
        value
    }
}

/// Is the spring stretched so far that the paper's equation has no meaning (see the module text)?
#[must_use]
pub fn is_outside_domain(spring: Spring, poisson_ratio: f64, strain: f64) -> bool {
    strain > strain_limit(spring, poisson_ratio)
}

/// The edge strain \[-\] where a cell's width across the pull, `1 − νε`, is down to [`LEAST_WIDTH`].
#[must_use]
pub fn edge_strain_limit(poisson_ratio: f64) -> f64 {
    if poisson_ratio > 0.0 { (1.0 - LEAST_WIDTH) / poisson_ratio } else { f64::INFINITY }
}

/// The same limit for either spring, as a strain of that spring \[-\].
fn strain_limit(spring: Spring, poisson_ratio: f64) -> f64 {
    let edge = edge_strain_limit(poisson_ratio);
    match spring {
        Spring::Edge => edge,
        Spring::Diagonal => diagonal_strain(edge, -poisson_ratio * edge),
    }
}

/// Strain of the diagonal of a square whose sides are strained by `along` and `across` \[-\]:
/// equations (4) and (5).
#[must_use]
pub fn diagonal_strain(along: f64, across: f64) -> f64 {
    if along.is_infinite() {
        return f64::INFINITY;
    }
    (0.5 * ((1.0 + along).powi(2) + (1.0 + across).powi(2))).sqrt() - 1.0
}

/// `J` \[-\]: the edge strain that goes with the diagonal strain `strain` ≥ 0 in uniaxial tension,
/// the inverse of [`diagonal_strain`]`(J, −νJ)` (the formula after equation (5)).
///
/// ```text
/// J = [ν − 1 + √(2 (1 + ν²) (1 + ε)² − (1 + ν)²)] / (1 + ν²)
/// ```
#[must_use]
pub fn edge_strain_of_diagonal(poisson_ratio: f64, strain: f64) -> f64 {
    let nu = poisson_ratio;
    // (1 + ε)² is taken apart, so that J is exact to rounding at small strain:
    // root = √((1 − ν)² + x) and root − (1 − ν) = x / (root + 1 − ν).
    let x = 2.0 * (1.0 + nu * nu) * strain * (2.0 + strain);
    let root = ((1.0 - nu).powi(2) + x).sqrt();
    x / ((root + 1.0 - nu) * (1.0 + nu * nu))
}

/// dJ/dε \[-\] for the same arguments.
#[must_use]
pub fn edge_strain_of_diagonal_slope(poisson_ratio: f64, strain: f64) -> f64 {
    let nu = poisson_ratio;
    let root = (2.0 * (1.0 + nu * nu) * (1.0 + strain).powi(2) - (1.0 + nu).powi(2)).sqrt();
    2.0 * (1.0 + strain) / root
}

/// Equation (3): tension of an edge spring \[kPa\].
///
/// ```text
/// f / Sq = Ef(ε) + Ef(−νε) (1 + ε)/(1 − νε)   for ε ≥ 0
/// f / Sq = Ef(ε)                              for ε < 0
/// ```
///
/// (The paper's denominator `(1 + ν)/(1 + ε) − ν` equals `(1 − νε)/(1 + ε)`.)
fn edge_tension(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.stress(strain);
    }
    curve.stress(strain) + curve.stress(-nu * strain) * (1.0 + strain) / (1.0 - nu * strain)
}

fn edge_slope(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.slope(strain);
    }
    let width = 1.0 - nu * strain;
    curve.slope(strain) - nu * curve.slope(nu * strain) * (1.0 + strain) / width
        + curve.stress(-nu * strain) * (1.0 + nu) / (width * width)
}

fn edge_energy(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.energy(strain);
    }
    let counterpart = |e: f64| curve.stress(-nu * e) * (1.0 + e) / (1.0 - nu * e);
    curve.energy(strain) + integral(curve, nu, strain, counterpart)
}

/// Equation (6): tension of a diagonal spring \[kPa\].
///
/// ```text
/// f / Sq = −√2 Ef(−νJ) (1 + ε)/(1 − νJ)   for ε ≥ 0
/// f / Sq = Ef(ε)                          for ε < 0
/// ```
fn diagonal_tension(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.stress(strain);
    }
    let edge = edge_strain_of_diagonal(nu, strain);
    -SQRT_2 * curve.stress(-nu * edge) * (1.0 + strain) / (1.0 - nu * edge)
}

fn diagonal_slope(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.slope(strain);
    }
    let edge = edge_strain_of_diagonal(nu, strain);
    let edge_slope = edge_strain_of_diagonal_slope(nu, strain);
    let width = 1.0 - nu * edge;
    let stress = curve.stress(nu * edge);
    SQRT_2 / width
        * (stress + (1.0 + strain) * nu * edge_slope * (curve.slope(nu * edge) + stress / width))
}

fn diagonal_energy(curve: &Curve, nu: f64, strain: f64) -> f64 {
    if strain < 0.0 {
        return curve.energy(strain);
    }
    // In the variable J, with 2 (1 + ε) dε = ((1 + J) − ν (1 − νJ)) dJ, the root is gone.
    let integrand = |j: f64| {
        let width = 1.0 - nu * j;
        curve.stress(nu * j) * (1.0 + j - nu * width) / (SQRT_2 * width)
    };
    integral(curve, nu, edge_strain_of_diagonal(nu, strain), integrand)
}

/// ∫₀^end of a function that is smooth between the breaks of Ef(ν·): Gauss–Legendre with five
/// points on panels of at most 0.05 (relative error below 1e-12 for the preset curves).
fn integral(curve: &Curve, nu: f64, end: f64, integrand: impl Fn(f64) -> f64) -> f64 {
    const NODES: [(f64, f64); 5] = [
        (-0.906_179_845_938_664, 0.236_926_885_056_189_08),
        (-0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.0, 0.568_888_888_888_888_9),
        (0.538_469_310_105_683_1, 0.478_628_670_499_366_47),
        (0.906_179_845_938_664, 0.236_926_885_056_189_08),
    ];
    const PANEL: f64 = 0.05;
    if nu == 0.0 {
        return 0.0; // Ef(−0·ε) = 0: both counterparts vanish.
    }
    let breaks = curve.breaks().map(|strain| strain / nu).take_while(|&b| b < end);
    let (mut sum, mut from) = (0.0, 0.0);
    for to in breaks.chain([end]) {
        let panels = ((to - from) / PANEL).ceil().max(1.0);
        let half = 0.5 * (to - from) / panels;
        for k in 0..panels as usize {
            let middle = from + (2 * k + 1) as f64 * half;
            sum += half * NODES.iter().map(|(x, w)| w * integrand(middle + half * x)).sum::<f64>();
        }
        from = to;
    }
    sum
}
