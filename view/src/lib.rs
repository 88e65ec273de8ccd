//! The view without a toolkit: camera, colours, meshes, section cut, picking, and the picture with the current
//! meshes.
//!
//! Uses `session` and all to its left; no window, no GL, no clock. Used by `app`.
//!
//! Right-handed world in mm, z away from the chest wall; positions in `f32` are for drawing only.

pub mod body;
pub mod camera;
pub mod color;
pub mod cross_section;
pub mod mesh;
pub mod pick;
pub mod picture;
pub mod place;
pub mod quantity;
pub mod section;
pub mod side_by_side;
pub mod strokes;
pub mod subject;
pub mod torso;
pub mod wall;
