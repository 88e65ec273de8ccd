//! What there is to see, without any toolkit: camera, colours, meshes, section cut, picking,
//! and the picture that keeps them up to date.
//!
//! Uses `session` and all to its left; knows no window, no GL and no clock. Used by `app`.
//!
//! Right-handed world in mm, z away from the chest wall; positions in `f32` are for drawing only.

pub mod body;
pub mod camera;
pub mod color;
#[cfg(feature = "drawing")]
pub mod contour;
pub mod mesh;
pub mod pick;
pub mod picture;
pub mod section;
#[cfg(feature = "drawing")]
pub mod stability_map;
#[cfg(feature = "drawing")]
pub mod svg;
#[cfg(feature = "drawing")]
pub mod svg_backend;
#[cfg(feature = "drawing")]
pub mod work_precision;
