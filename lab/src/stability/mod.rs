//! Maps of the stability of a homogeneously stretched sheet, over strain and Poisson ratio.
//!
//! [`row`] computes a row of a map: the stiffness of the infinite sheet against waves in the plane (the
//! default meaning of "stable") and out of the plane ([`implant_preview_core::springs::stability`]), and the smallest
//! eigenvalue of the finite sheet with a free border ([`Sample::least_eigenvalue`]), the paper's sample.
//!
//! A free sheet without bending stiffness wrinkles where the stiffness out of the plane is negative. Under
//! uniaxial tension the sheet is at best neutral, since the transverse tension is zero. A dome and the
//! curvature of the sheet stabilise displacements out of the plane, but not in the plane.
//!
//! Uses `curve`, `springs` and `sample`. Used by `charts` and the command line.

use super::sample::Sample;
use glam::DVec2;
use implant_preview_core::curve::Curve;
use implant_preview_core::springs::stability::{Load, Search, Stack, Wave};
use implant_preview_core::springs::{Material, Springs};

/// Cells per side of the finite sheet of a map (the paper's sample).
pub const CELLS: usize = 4;

/// A state of one layer in a map. Stiffnesses are fractions of the small-strain edge stiffness Ef′(0)·h.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point {
    /// Poisson ratio \[-\].
    pub poisson_ratio: f64,
    /// Strain ε along x \[-\].
    pub strain: f64,
    /// Transverse strain ε_y \[-\].
    pub transverse_strain: f64,
    /// Smallest eigenvalue of the Hessian of the finite sheet without rigid motions (4 × 4 cells, free
    /// border).
    pub sheet: f64,
    /// The wave in the plane with the smallest stiffness of the infinite sheet.
    pub wave: Wave,
    /// Stiffness of the infinite sheet against waves out of the plane
    /// ([`implant_preview_core::springs::stability::Lattice::out_of_plane`]).
    pub out_of_plane: [f64; 3],
}

impl Point {
    /// Smallest stiffness of the infinite sheet against waves out of the plane.
    #[must_use]
    pub fn least_out_of_plane(&self) -> f64 {
        self.out_of_plane.into_iter().fold(f64::INFINITY, f64::min)
    }
}

/// Computes the states of one layer under one load at the given strains.
#[must_use]
pub fn row(
    springs: Springs,
    curve: &Curve,
    poisson_ratio: f64,
    load: Load,
    strains: &[f64],
) -> Vec<Point> {
    let layer = [Material::new(curve.clone(), poisson_ratio, 1.0)];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dense::Matrix;
    use implant_preview_core::curve::CurveSpec;

    /// Smallest eigenvalue of a sheet with a clamped border \[fraction of the edge stiffness\].
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
    fn the_least_eigenvalue_of_a_clamped_sheet_converges_to_the_weakest_wave_from_above() {
        // Displacements inside of a clamped border are displacements of the infinite sheet with equal energy:
        // the weakest wave is a lower bound, and the eigenvalue decreases with the size of the sheet.
        for (spec, nu, springs) in [
            (CurveSpec::Adipose {}, 0.3, Springs::Nikolaev),
            (CurveSpec::Linear { modulus_kpa: 100.0 }, 0.45, Springs::Nikolaev),
            (CurveSpec::Skin {}, 0.2, Springs::Nikolaev),
            (CurveSpec::Skin {}, 0.45, Springs::Coupled),
        ] {
            let curve = Curve::new(&spec).unwrap();
            let layer = [Material::new(curve.clone(), nu, 1.0)];
            let stack = Stack::new(springs, &layer);
            for load in Load::ALL {
                let strains = stack.strains(load, 0.6);
                let stretch = DVec2::ONE + DVec2::from(strains);
                // The smallest eigenvalue of D over all waves, including long waves.
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
