//! A sheet of bonded layers without bending stiffness.
//!
//! `law` (a stack of layers as tables) | `triangle` (principal stretches) | `node_stiffness` | `assembly` (energy,
//! forces and Hessian in f64) | `lanes` (forces and diagonal blocks for four f32 at a time) | `deformation` (stretch,
//! normal and area at the nodes) | `stack` (faces of the layers).

pub mod assembly;
pub(crate) mod deformation;
pub(crate) mod lanes;
pub mod law;
pub(crate) mod node_stiffness;
pub mod stack;
pub(crate) mod triangle;
