//! Shapes of implants, and a shape in place.
//!
//! `traits` (what a shape is: sizes and lines in f64; its gauge in f64 and for four f32 at a time) | `half_ball` (round and anatomical implants of
//! any fullness) | `deformed` (a shape that yields) | `draped` (the map from a shape to its place over the wall). A further shape is a file with both
//! traits, `scaled` and `gauge`, and its line in the list [`shapes!`].

mod deformed;
mod draped;
mod half_ball;
#[cfg(test)]
pub(crate) mod superellipse;
mod traits;

use crate::mesh::vec3::Block;
use crate::number::Real;
pub use deformed::Deformed;
use deformed::DeformedGauge;
pub(crate) use deformed::{Balance, Gel, MODES, Modes};
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
                    $($(#[$attribute])* Self::$shape(own) => ShapeGauge::$shape(own.gauge().into()),)+
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

/// A half-ball's image that yields.
pub type SoftHalfBall = Deformed<HalfBall>;
type SoftHalfBallGauge<R> = Box<DeformedGauge<R, HalfBallGauge<R>>>;

shapes! {
    HalfBall with HalfBallGauge;
    SoftHalfBall with SoftHalfBallGauge;
    #[cfg(test)]
    Superellipse with SuperellipseGauge;
}

impl Shape {
    /// The half-ball's image, if the shape is one.
    #[must_use]
    pub fn half_ball(&self) -> Option<HalfBall> {
        match self {
            Self::HalfBall(own) => Some(*own),
            _ => None,
        }
    }

    /// The shape as one that yields, if it is one.
    #[must_use]
    pub fn soft(&self) -> Option<&SoftHalfBall> {
        match self {
            Self::SoftHalfBall(own) => Some(own),
            _ => None,
        }
    }

    /// The shape before a deformation.
    #[must_use]
    pub fn at_rest(&self) -> Self {
        match self {
            Self::SoftHalfBall(own) => own.rest.into(),
            other => other.clone(),
        }
    }

    /// Sets the numbers of the deformation of a shape that yields.
    pub(crate) fn set_modes(&mut self, modes: Modes<f64>) {
        if let Self::SoftHalfBall(own) = self {
            own.modes = modes;
        }
    }
}

impl<R: Real> ShapeGauge<R> {
    /// Derivatives of the length at a fixed position by the numbers of the deformation.
    pub(crate) fn variation(&self, at: [R; 3]) -> Modes<R> {
        match self {
            Self::SoftHalfBall(own) => own.variation(at),
            _ => [R::splat(0.0); MODES],
        }
    }

    /// The way of a point of the body from another deformation to this one.
    pub(crate) fn way_after(&self, before: &Self, at: [R; 3]) -> [R; 3] {
        match (self, before) {
            (Self::SoftHalfBall(own), Self::SoftHalfBall(before)) => own.way_after(before, at),
            _ => [R::splat(0.0); 3],
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
