//! Laws of solids: an energy per rest volume W(g, J) of the change of shape g and the volume ratio J of a deformation
//! (`model::layered::deformed`), one source for f64 and for four f32 lanes.
//!
//! `curve_law` (of a tissue's curve). A law is a file here and a line of the list in this file.

mod curve_law;

use super::Material;
use super::table::{Buckets, Table};
use crate::curve::Curve;
use crate::number::Real;
use curve_law::CurveLaw;
use wide::f32x4;

/// Poisson ratio above which solids have this one: the stiffness to a change of volume grows as 1/(1−2ν).
pub(crate) const MAX_POISSON_RATIO: f64 = 0.495;
/// J below which the change of volume counts as this J \[-\].
pub(crate) const LEAST_VOLUME: f64 = 0.05;

/// The derivatives of W(g, J) \[kPa\].
///
/// Of a nearly incompressible solid a law may leave a part of its stiffness to a change of volume to an augmented pressure p, one
/// number of each cell: [`Self::renewed`] after every cycle leads to the whole stiffness. Other laws ignore p.
pub(crate) trait SolidLaw<R: Real> {
    /// The derivatives at points of one J: those of a cell.
    fn slopes<const N: usize>(&self, g: [R; N], volume: Volume<R>, augmented: R) -> Slopes<R, N>;

    /// First and second derivatives at a point.
    fn curvature(&self, g: R, volume: Volume<R>, augmented: R) -> Curvature<R>;

    /// The augmented pressure after a cycle.
    fn renewed(&self, _volume: Volume<R>, augmented: R) -> R {
        augmented
    }
}

/// A law with its energy, for a tissue's curve and Poisson ratio.
pub(crate) trait WholeLaw: SolidLaw<f64> {
    type Lanes: SolidLaw<f32x4>;

    fn new(curve: &Curve, poisson_ratio: f64) -> Self;

    /// See [`ExactLaw::in_lanes`].
    fn in_lanes(&self, factor: f64) -> Self::Lanes;

    /// W \[kPa\].
    fn energy(&self, g: f64, volume: Volume<f64>) -> f64;

    /// Logarithmic strain in uniaxial tension that the law counts as equal: of this strain is the end of the curve's data.
    fn equivalent(&self, g: f64, volume: Volume<f64>) -> f64;

    /// Is the tissue nearly incompressible, so that multigrid needs an augmented pressure?
    fn is_augmented(&self) -> bool {
        false
    }
}

/// What a list of laws makes. A line has the name of a law and its type in numbers `R` with tables `T`; `$d` is a dollar sign.
macro_rules! laws_of_solids {
    ($d:tt $($(#[$doc:meta])* $name:ident: $law:ty,)+) => {
        /// Which law a tissue has as a solid.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum SolidKind { $($(#[$doc])* $name,)+ }

        impl SolidKind {
            /// All laws.
            pub const ALL: &[Self] = &[$(Self::$name),+];
        }

        /// The law of a solid.
        #[derive(Clone, Debug)]
        pub enum Solid<R: Real, T> { $($(#[$doc])* $name($law),)+ }

        impl ExactLaw {
            /// The law of a material.
            #[must_use]
            pub fn new(Material { curve, poisson_ratio, solid, .. }: &Material) -> Self {
                let nu = poisson_ratio.min(MAX_POISSON_RATIO);
                match solid { $(SolidKind::$name => Self::$name(WholeLaw::new(curve, nu)),)+ }
            }

            /// The law in lanes, its stresses times `factor`; nearly incompressible tissue with an augmented pressure.
            pub(crate) fn in_lanes(&self, factor: f64) -> LaneLaw {
                match self { $(Self::$name(law) => LaneLaw::$name(law.in_lanes(factor)),)+ }
            }
        }

        /// Evaluates an expression of the law in a [`Solid`], once compiled for each law.
        macro_rules! of_law {
            ($d solid:expr, $d law:ident => $d value:expr) => {
                match $d solid { $($d crate::springs::solids::Solid::$name($d law) => $d value,)+ }
            };
        }
        pub(crate) use of_law;
    };
}

// The list of the laws.
laws_of_solids! { $
    /// Of the tissue's curve.
    Curve: CurveLaw<R, T>,
}

/// A law in f64.
pub type ExactLaw = Solid<f64, Table>;
/// A law in four f32 lanes.
pub(crate) type LaneLaw = Solid<f32x4, Buckets<f32x4>>;

/// J, at least [`LEAST_VOLUME`], and ln J.
#[derive(Clone, Copy)]
pub(crate) struct Volume<R> {
    pub(crate) ratio: R,
    pub(crate) log: R,
}

impl<R: Real> Volume<R> {
    #[inline(always)]
    pub(crate) fn new(ratio: R) -> Self {
        let ratio = ratio.max(R::splat(LEAST_VOLUME));
        Self { ratio, log: ratio.ln() }
    }
}

/// First derivatives of W at the points of a cell.
#[derive(Clone, Copy)]
pub(crate) struct Slopes<R, const N: usize> {
    /// 2W_g of each point.
    pub(crate) shear: [R; N],
    /// W_J, the mean of the points.
    pub(crate) pressure: R,
}

/// First and second derivatives of W. With t = α·½∂g/∂F + β·∂J/∂F the second derivative has, beside the first derivatives times
/// ½∂²g/∂F² and ∂²J/∂F², the squares `bend`·t tᵀ + `volumetric`·∂J/∂F ∂J/∂Fᵀ.
#[derive(Clone, Copy)]
pub(crate) struct Curvature<R> {
    /// 2W_g.
    pub(crate) shear: R,
    /// W_J.
    pub(crate) pressure: R,
    /// α and β.
    pub(crate) along: [R; 2],
    pub(crate) bend: R,
    pub(crate) volumetric: R,
    /// Lower bound of `bend` in positive blocks: a softening solid keeps a fifth of its stiffness.
    pub(crate) least_bend: R,
    /// Stiffness to a change of ln J in positive blocks: `volumetric`·J² at J = 1.
    pub(crate) bulk: R,
}
