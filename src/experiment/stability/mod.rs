//! Maps of where an evenly stretched sheet is stable, over strain and Poisson ratio.
//!
//! [`row`] is a line of a map: the infinite sheet against waves in its plane, which is what "stable" means
//! wherever nothing else is said, and out of its plane ([`crate::springs::stability`]), and the finite
//! sheet with a free border ([`Sample::least_eigenvalue`]), as the paper pulled it. Out of its plane a
//! free sheet without bending stiffness crumples where the stiffness is negative, and pulled one way the
//! sheet is exactly neutral at best, since nothing pulls across. A dome under the sheet, and curvature,
//! hold it; in the plane nothing does.
//!
//! Uses `curve`, `springs` and `sample`. Used by `view` and the command line.

use super::sample::Sample;
use crate::curve::Curve;
use crate::springs::stability::{Load, Search, Stack, Wave};
use crate::springs::{Material, Springs};
use glam::DVec2;

/// Cells per side of the finite sheet of a map: the paper's sample.
pub const CELLS: usize = 4;

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
    /// Stiffness of the infinite sheet against waves out of the plane ([`crate::springs::stability::Lattice::out_of_plane`]).
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
