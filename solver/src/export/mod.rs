//! Results as files of other programs: closed meshes of tissue, skin and implant, tables.
//!
//! Uses `measure` and all to its left. Used by `app` and `platform`.
//!
//! `solid` (triangle meshes) | `srgb` → `glb` (glTF) | `formats` (STL, OBJ, PLY, glTF) | `table` (rows, numbers and the profile as CSV).

mod formats;
mod glb;
mod solid;
pub mod srgb;
mod table;

pub use formats::{Axes, Format};
pub use solid::{Body, Part, Solid};
pub use table::{csv, number, profile, quoted};
