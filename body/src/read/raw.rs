//! What a file contains: vertices, and faces of any number of corners.

use super::{Error, MAX_TRIANGLES, MAX_VERTICES};
use glam::DVec3;

/// Index of a vertex that no file can have.
pub(super) const NO_VERTEX: u32 = u32::MAX;

/// Vertices and faces as in the file; indices are not checked.
#[derive(Default)]
pub(super) struct Raw {
    /// Positions in the file's unit.
    pub(super) positions: Vec<DVec3>,
    /// sRGB of the vertices; counts only where every vertex has one.
    pub(super) colors: Vec<[u8; 3]>,
    /// Vertices of all faces.
    pub(super) corners: Vec<u32>,
    /// Number of corners of each face.
    pub(super) sizes: Vec<u32>,
    /// Whether the vertices are the corners of triangles one by one.
    pub(super) is_soup: bool,
    /// Whether the file has a texture.
    pub(super) has_texture: bool,
    /// Number of triangles of all faces.
    pub(super) triangles: usize,
}

impl Raw {
    /// Adds a face.
    pub(super) fn face(&mut self, corners: &[u32]) -> Result<(), Error> {
        self.triangles += corners.len().saturating_sub(2);
        if self.triangles > MAX_TRIANGLES {
            return Err(Error(
                "the surface has more than 2 million triangles; export it with fewer".to_owned(),
            ));
        }
        self.corners.extend(corners);
        self.sizes.push(corners.len() as u32);
        Ok(())
    }

    /// Adds a vertex.
    pub(super) fn vertex(&mut self, position: DVec3) -> Result<(), Error> {
        if self.positions.len() == MAX_VERTICES {
            return Err(Error(
                "the surface has more than 6 million points; export it with fewer".to_owned(),
            ));
        }
        self.positions.push(position);
        Ok(())
    }
}
