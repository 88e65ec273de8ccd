//! A body's surface fitted by what a scene needs: a frame, the wall under the breast, the thickness of the tissue over it.
//!
//! Rounds renew the frame: the height field of the skin in the frame, the nodes that hang together with the implant's centre, those beside
//! both breasts that face outwards (n_z > 0.6) as data, a quadric through the data ([`crate::chest`]), whose normal at the implant's centre is the
//! next frame's z. The normal is within 0.3° to 2.4° of that of the true chest with exact marks, ≤ 5.5° with marks 8 mm off.

use crate::chest::{self, Quadric};
use crate::field::Field;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::marks::{BodyAxes, Marks, MarksError, Side};
use crate::quality::{Quality, Scan};
use crate::raster::View;
use crate::surface::Surface;
use crate::wall;
use glam::DVec3;

/// Choices of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Thickness of the tissue between skin and wall beside the breast \[mm\], 4 to 60.
    pub cover_mm: f64,
    /// Radius of the patch \[mm\].
    pub patch_radius_mm: f64,
    /// Radius of the pocket \[mm\].
    pub pocket_radius_mm: f64,
    /// Radius of the implant's base \[mm\], for a centre that is not marked.
    pub base_radius_mm: f64,
    /// Radii of curvature of the chest across and along the body \[mm\] in place of fitted ones.
    pub radii_mm: Option<[f64; 2]>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            cover_mm: 10.0,
            patch_radius_mm: 130.0,
            pocket_radius_mm: 70.0,
            base_radius_mm: 60.0,
            radii_mm: None,
        }
    }
}

/// A body fitted on one side. All grids lie over the plane of the frame.
#[derive(Clone, Debug, PartialEq)]
pub struct BodyFit {
    /// The frame, its origin on the wall.
    pub frame: Frame,
    /// The grid of all fields.
    pub grid: Grid,
    /// Heights of the skin \[mm\], continued where the scan has none.
    pub skin_mm: Vec<f64>,
    /// Heights of the skin without the breast \[mm\].
    pub bare_mm: Vec<f64>,
    /// Heights of the wall \[mm\].
    pub wall_mm: Vec<f64>,
    /// Thickness of all tissue along the wall's normals at lengths along the wall \[mm\], as many a side as the grid has.
    pub thickness_mm: Vec<f64>,
    /// Figures of the fit.
    pub quality: Quality,
}

/// Why a surface is not fitted, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FitError {
    /// Marks.
    #[error(transparent)]
    Marks(#[from] MarksError),
    /// No triangle near the implant's centre.
    #[error("the surface has no skin within 100 mm of the implant's centre: check unit and marks")]
    NoSkin,
    /// Fewer than 100 nodes of data.
    #[error("the surface has too little skin around the breast: check unit and marks")]
    NoData,
    /// Marks on one line.
    #[error("the marks of the breast lie on one line: check the marks")]
    Line,
    /// A figure beyond its limit.
    #[error("{0}")]
    Limit(String),
}

/// Renewals of the frame: after the first three the normal turns by less than 0.1°.
const ROUNDS: usize = 4;
/// Nodes of the grid from its centre to the patch's edge.
const NODES: usize = 32;
/// Nodes of the grid beyond the patch.
const BEYOND: usize = 2;
/// Reach of the mean normal about the implant's centre \[mm\].
const NEAR_MM: f64 = 100.0;
/// Depth below the wall down to which sheets of the surface count as overhang \[mm\].
const BELOW_WALL_MM: f64 = 2.0;
/// Least number of data nodes.
const LEAST_DATA: usize = 100;

/// Fits a side of a body.
///
/// # Errors
/// Marks in a wrong order, a surface without skin or data there, figures beyond their limits.
pub fn fit(
    surface: &Surface,
    marks: &Marks,
    side: Side,
    settings: &Settings,
) -> Result<BodyFit, FitError> {
    marks.check(side)?;
    let axes = marks.axes()?;
    let center = marks.implant_centre(side, settings.base_radius_mm)?;
    let is_marked = marks.breast(side)?.implant_centre.is_some();
    let (outwards, orientation) = mean_normal(surface, center, &axes).ok_or(FitError::NoSkin)?;
    let mut frame = Frame::new(center, outwards, axes.head, side).ok_or(FitError::NoSkin)?;
    let spacing_mm = settings.patch_radius_mm / NODES as f64;
    let grid = Grid { half: NODES + BEYOND, spacing_mm };
    let welded = surface.weld();
    for round in 0.. {
        let view = View { surface, welded: &welded, frame: &frame, orientation };
        let triangles = view.connected();
        let heights = view.heights(grid, &triangles);
        let middle = heights[grid.len() / 2];
        if round == 0 && !is_marked && middle.is_finite() {
            frame = frame.raised(middle);
            continue;
        }
        let radius = settings.patch_radius_mm;
        let field = Field::new((grid, heights), &frame, (marks, side), radius)?;
        let field = field.ok_or(FitError::Line)?;
        if field.is_data.iter().filter(|is| **is).count() < LEAST_DATA {
            return Err(FitError::NoData);
        }
        let quadric = Quadric::fitted(grid, &field.heights_mm, &field.is_data, settings.radii_mm);
        let quadric = quadric.ok_or(FitError::NoData)?;
        if round < ROUNDS {
            let outwards = frame.direction(quadric.normal());
            frame = Frame::new(frame.origin, outwards, axes.head, side).ok_or(FitError::NoData)?;
            continue;
        }
        return complete(&view, &field, &quadric, (marks, side), settings);
    }
    Err(FitError::NoSkin)
}

/// The mean unit normal of the surface within 100 mm of a point, and +1, or −1 for normals inwards; `None` without a surface there.
fn mean_normal(surface: &Surface, center: DVec3, axes: &BodyAxes) -> Option<(DVec3, f64)> {
    let mut sum = DVec3::ZERO;
    for triangle in &surface.triangles {
        let [a, b, c] = triangle.map(|k| surface.positions[k as usize]);
        if a.distance_squared(center) < NEAR_MM * NEAR_MM {
            sum += (b - a).cross(c - a);
        }
    }
    let orientation = if sum.dot(axes.front) < 0.0 { -1.0 } else { 1.0 };
    Some(((sum * orientation).try_normalize()?, orientation))
}

/// The fields and figures of the last round.
fn complete(
    view: &View<'_>,
    field: &Field,
    quadric: &Quadric,
    (marks, side): (&Marks, Side),
    settings: &Settings,
) -> Result<BodyFit, FitError> {
    let (grid, heights) = (field.grid, &field.heights_mm);
    let mut filled = heights.clone();
    let holes = wall::fill_holes(grid, &mut filled);
    let mut bare_mm = chest::bare(grid, &filled, quadric, &field.is_data);
    let cover = settings.cover_mm;
    let (mut skin_mm, mut wall_mm) = wall::skin_and_wall(grid, &filled, &bare_mm, quadric, cover);
    let scan = Scan {
        heights_mm: heights,
        filled_mm: &filled,
        is_own: &field.is_own,
        is_data: &field.is_data,
    };
    let radii = (settings.patch_radius_mm, settings.pocket_radius_mm);
    let mut quality =
        Quality::of_fields(grid, &scan, [&skin_mm, &bare_mm, &wall_mm], quadric, radii);
    let floor: Vec<f64> = wall_mm.iter().map(|wall| wall - BELOW_WALL_MM).collect();
    quality.set_air(grid, &view.air(grid, heights, &floor), settings.patch_radius_mm);
    quality.holes = holes;
    quality.notch_nipple_mm = marks.notch_nipple(side);
    let (BodyAxes { across, head, front }, z) = (marks.axes()?, view.frame.axes.z_axis);
    quality.yaw_degrees = z.dot(across).atan2(z.dot(front)).to_degrees();
    quality.pitch_degrees = z.dot(head).asin().to_degrees();
    quality.is_turned = view.orientation < 0.0;
    if let Some(line) = quality.error() {
        return Err(FitError::Limit(line));
    }
    // The origin moves onto the wall.
    let raise = wall_mm[grid.len() / 2];
    for values in [&mut skin_mm, &mut bare_mm, &mut wall_mm] {
        values.iter_mut().for_each(|height| *height -= raise);
    }
    let frame = view.frame.raised(raise);
    let thickness_mm = wall::thickness(grid, &skin_mm, &wall_mm);
    let thickness_mm = thickness_mm.ok_or(FitError::NoData)?;
    Ok(BodyFit { frame, grid, skin_mm, bare_mm, wall_mm, thickness_mm, quality })
}
