//! The core of implant-preview: scenes, studies and the document.
//!
//! All modules of the solver, [`implant_preview_solver`], are modules here, too. Module order; imports point left only
//! (`tests/modules.rs`):
//!
//! solver → body → `table` → `tensile` → `clinical` → `scene` → `simulate` → `study` → `session`
//!
//! Units: mm, kPa, N (1 kPa·mm² = 1 mN); angles in radians inside, degrees in results.

pub use implant_preview_body as body;
pub use implant_preview_solver::{contact, curve, export, measure, mesh, solve, springs};
#[doc(hidden)]
pub use implant_preview_solver::{model, number};

pub mod clinical;
pub mod scene;
pub mod session;
pub mod simulate;
pub mod study;
pub mod table;
pub mod tensile;
