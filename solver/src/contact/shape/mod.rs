//! Shapes of implants, and a shape in place.
//!
//! `traits` (what a shape is: sizes and lines in f64; its gauge in f64 and for four f32 at a time) | `half_ball` (round and anatomical implants of
//! any fullness) | `draped` (the map from a shape to its place over the wall). A further shape is a file with both traits
//! and its line in the list [`shapes!`].

mod draped;
mod half_ball;
#[cfg(test)]
pub(crate) mod superellipse;
mod traits;

use crate::mesh::vec3::Block;
use crate::number::Real;
pub(super) use draped::{Draped, Near};
use half_ball::HalfBallGauge;
pub use half_ball::{HALF_ELLIPSOID, HalfBall};
use std::ops::Deref;
#[cfg(test)]
use superellipse::{Superellipse, SuperellipseGauge};
pub(super) use traits::Gauge;
pub use traits::Geometry;

/// The enums of all shapes and of their gauges, with static dispatch: an enum of one shape costs nothing.
macro_rules! shapes {
    ($($(#[$attribute:meta])* $shape:ident with $gauge:ident;)+) => {
        /// The shape of an implant.
        #[derive(Clone, Debug, PartialEq)]
        pub enum Shape {
            $(
                $(#[$attribute])*
                #[doc = concat!("A [`", stringify!($shape), "`].")]
                $shape($shape),
            )+
        }

        /// The gauge of a [`Shape`].
        #[derive(Clone, Debug)]
        pub(crate) enum ShapeGauge<R> {
            $($(#[$attribute])* $shape($gauge<R>),)+
        }

        $($(#[$attribute])*
        impl From<$shape> for Shape {
            fn from(shape: $shape) -> Self {
                Self::$shape(shape)
            }
        })+

        impl Deref for Shape {
            type Target = dyn Geometry;

            fn deref(&self) -> &Self::Target {
                match self {
                    $($(#[$attribute])* Self::$shape(own) => own,)+
                }
            }
        }

        impl Shape {
            /// The shape in another unit of length.
            #[must_use]
            pub fn scaled(&self, factor: f64) -> Self {
                match self {
                    $($(#[$attribute])* Self::$shape(own) => own.scaled(factor).into(),)+
                }
            }

            pub(super) fn gauge<R: Real>(&self) -> ShapeGauge<R> {
                match self {
                    $($(#[$attribute])* Self::$shape(own) => ShapeGauge::$shape(own.gauge()),)+
                }
            }
        }

        /// The value of an expression of the gauge that the enum contains.
        macro_rules! of_each {
            ($of:expr, $own:ident => $value:expr) => {
                match $of {
                    $($(#[$attribute])* ShapeGauge::$shape($own) => $value,)+
                }
            };
        }
    };
}

shapes! {
    HalfBall with HalfBallGauge;
    #[cfg(test)]
    Superellipse with SuperellipseGauge;
}

impl Shape {
    /// The half-ball's image, if the shape is one.
    #[must_use]
    pub fn half_ball(&self) -> Option<HalfBall> {
        match self {
            Self::HalfBall(own) => Some(*own),
            #[allow(unreachable_patterns, reason = "another shape is in the tests only")]
            _ => None,
        }
    }
}

impl<R: Real> Gauge<R> for ShapeGauge<R> {
    #[inline(always)]
    fn length_squared(&self, at: [R; 3]) -> R {
        of_each!(self, own => own.length_squared(at))
    }

    #[inline(always)]
    fn length(&self, at: [R; 3]) -> (R, [R; 3]) {
        of_each!(self, own => own.length(at))
    }

    #[inline(always)]
    fn curvature(&self, at: [R; 3], length: R, gradient: [R; 3], least: f64) -> Block<R> {
        of_each!(self, own => own.curvature(at, length, gradient, least))
    }

    #[inline(always)]
    fn distance_along(&self, at: [R; 3], direction: [R; 3], length: R) -> R {
        of_each!(self, own => own.distance_along(at, direction, length))
    }

    #[inline(always)]
    fn way_to(&self, at: [R; 3], length: R, to: R) -> [R; 3] {
        of_each!(self, own => own.way_to(at, length, to))
    }
}
