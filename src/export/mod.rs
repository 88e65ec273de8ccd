//! Results as files of other programs: closed meshes of tissue, skin and implant, the profile as a table.
//!
//! Uses `measure` and all to its left. Used by `app` and `platform`.
//!
//! `solid` (closed triangle meshes) | `formats` (STL, OBJ, PLY, glTF), `table` (numbers and the profile as CSV).

mod formats;
mod solid;
mod table;

pub use formats::Format;
pub use solid::{Part, Solid};
pub use table::{number, profile};
