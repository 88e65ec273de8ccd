//! A surface of triangles.

use glam::DVec3;

/// A triangulated surface \[mm\], counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// sRGB of each vertex, where the file has colours.
    pub colors: Option<Vec<[u8; 3]>>,
}
