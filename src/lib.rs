//! Preview how skin and adipose stretch over an implant or a tissue expander.
//!
//! The window, the page and the command line; all modules of the core, [`implant_preview_core`], and the [`view`] are modules
//! here, too. Module order; imports point left only (`tests/modules.rs`):
//!
//! core → charts → lab → view → `app` → `platform`
//!
//! Units: mm, kPa, N (1 kPa·mm² = 1 mN); angles in radians inside, degrees in results.

#[cfg(feature = "app")]
pub mod app;
pub mod platform;

pub use implant_preview_core::{
    body, clinical, contact, curve, export, measure, mesh, scene, session, simulate, solve,
    springs, study, table, tensile,
};
pub use implant_preview_view as view;
