//! A height field of a body's skin with the nodes that belong to a breast and those that determine the chest.

use crate::chest::Ellipse;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::marks::{Marks, MarksError, Side};
use glam::DVec3;

/// Margin of a breast's ellipse \[mm\].
const MARGIN_MM: f64 = 5.0;
/// Least z of the unit normal of data \[-\].
const LEAST_UP: f64 = 0.6;

/// A height field and its nodes.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// The grid.
    pub grid: Grid,
    /// Heights of the skin \[mm\], NaN where there is none.
    pub heights_mm: Vec<f64>,
    /// Is a node inside of the ellipse of the fitted breast?
    pub is_own: Vec<bool>,
    /// Does a node determine the chest: within the patch, with skin, beside the breasts, with n_z > 0.6?
    pub is_data: Vec<bool>,
}

impl Field {
    /// The nodes of a height field within a patch \[mm\]; `None` for marks on one line.
    ///
    /// # Errors
    /// Marks that are missing or lie at one place.
    pub fn new(
        (grid, heights_mm): (Grid, Vec<f64>),
        frame: &Frame,
        (marks, side): (&Marks, Side),
        patch_radius_mm: f64,
    ) -> Result<Option<Self>, MarksError> {
        let (breast, axes) = (marks.breast(side)?, marks.axes()?);
        let four = [breast.fold, breast.upper, breast.medial, breast.lateral];
        let mirrored = four.map(|point| {
            point - axes.across * (2.0 * (point - marks.sternal_notch).dot(axes.across))
        });
        let ellipse = |points: [DVec3; 4]| {
            Ellipse::through(points.map(|point| frame.local(point).truncate()), MARGIN_MM)
        };
        let (Some(own), Some(other)) = (ellipse(four), ellipse(mirrored)) else { return Ok(None) };
        let nodes = || 0..grid.len();
        let is_own: Vec<bool> = nodes().map(|node| own.contains(grid.place(node))).collect();
        let is_data = nodes().map(|node| {
            let up = 1.0 / (1.0 + grid.slope(&heights_mm, node).length_squared()).sqrt();
            let is_within = grid.place(node).length() <= patch_radius_mm;
            let is_beside = !is_own[node] && !other.contains(grid.place(node));
            is_within && is_beside && heights_mm[node].is_finite() && up > LEAST_UP
        });
        let is_data = is_data.collect();
        Ok(Some(Self { grid, heights_mm, is_own, is_data }))
    }
}
