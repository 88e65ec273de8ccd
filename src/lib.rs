//! Preview how skin and adipose stretch over an implant or a tissue expander.
//!
//! The core: stress–strain curves, spring laws, grids, contact, elastic model, equilibrium and its measured
//! quantities. Module order; imports point left only (`tests/modules.rs`):
//!
//! `number` → `curve` → `clinical` → `springs` → `mesh` → `contact` → `model` → `solve` → `measure` → `export` → `scene` → `simulate` →
//! `study` → `session` → `experiment` → `view` → `app` → `platform`
//!
//! Units: mm, kPa, N (1 kPa·mm² = 1 mN); angles in radians inside, degrees in results.

#[cfg(feature = "app")]
pub mod app;
pub mod clinical;
pub mod contact;
pub mod curve;
pub mod experiment;
pub mod export;
pub mod measure;
pub mod mesh;
mod model;
mod number;
pub mod platform;
pub mod scene;
pub mod session;
pub mod simulate;
pub mod solve;
pub mod springs;
pub mod study;
pub mod view;
