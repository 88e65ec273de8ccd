//! A body's surface fitted by what a scene needs: a frame, the wall under the breast, the thickness of the tissue over it.
//!
//! Rounds renew the frame: the height field of the skin in the frame, the nodes that hang together with the implant's centre, those beside
//! both breasts that face outwards (n_z > 0.6) as data, a quadric through the data ([`crate::chest`]), whose normal at the implant's centre is the
//! next frame's z. A proposed centre moves to the middle of the breast's width in each frame. The normal is within 0.3° to 2.4° of that of the
//! true chest with exact marks, ≤ 5.5° with marks 8 mm off.

use crate::chest::{self, Ellipse, Quadric};
use crate::field::Field;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::marks::{BodyAxes, BreastMarks, Marks, MarksError, Side};
use crate::pick::snap;
use crate::quality::{Quality, Scan, carries_pocket};
use crate::raster::View;
use crate::surface::Surface;
use crate::wall;
use glam::DVec3;

/// Choices of a fit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Thickness of the tissue between skin and wall beside the breast \[mm\], 4 to 60.
    pub cover_mm: f64,
    /// Least thickness of the tissue under a cover of as much or more \[mm\]; a thinner cover is its own least thickness.
    pub least_mm: f64,
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
            least_mm: 6.0,
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
/// Ways by which a proposed centre moves to the midline where the pocket has no skin \[mm\].
const INWARDS_MM: [f64; 4] = [5.0, 10.0, 15.0, 20.0];
/// Nodes of the grid from its centre to the patch's edge.
const NODES: usize = 32;
/// Nodes of the grid beyond the patch.
const BEYOND: usize = 2;
/// Reach of the mean normal about the implant's centre \[mm\].
const NEAR_MM: f64 = 100.0;
/// Depth below the wall down to which sheets of the surface count as overhang \[mm\].
const BELOW_WALL_MM: f64 = 2.0;
/// Greatest distance of a mark from the surface without a word, and with one \[mm\]. A scan may end above the navel, which gives a direction alone.
const OFF_SKIN_MM: (f64, f64) = (15.0, 60.0);
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
    fitted(surface, marks, side, settings, true)
}

/// As [`fit`], of a body that is no scan: figures beyond their limits are no error.
///
/// # Errors
/// Marks in a wrong order, a surface without skin or data there.
pub fn fit_known(
    surface: &Surface,
    marks: &Marks,
    side: Side,
    settings: &Settings,
) -> Result<BodyFit, FitError> {
    fitted(surface, marks, side, settings, false)
}

fn fitted(
    surface: &Surface,
    marks: &Marks,
    side: Side,
    settings: &Settings,
    has_limits: bool,
) -> Result<BodyFit, FitError> {
    let welded = surface.weld();
    let subject = Subject::new(surface, &welded, (marks, side), settings)?;
    let off_skin = if has_limits { farthest_mark(surface, marks, side)? } else { None };
    let placed = subject.placed()?;
    let quality = Quality { off_skin, ..subject.quality(&placed) };
    if let Some(line) = quality.error().filter(|_| has_limits) {
        return Err(FitError::Limit(line));
    }
    let (frame, Fields { skin_mm, bare_mm, wall_mm, .. }) = subject.on_wall(&placed)?;
    let grid = subject.grid;
    let thickness_mm = wall::thickness(grid, &skin_mm, &wall_mm).ok_or(FitError::NoData)?;
    Ok(BodyFit { frame, grid, skin_mm, bare_mm, wall_mm, thickness_mm, quality })
}

/// A fit as far as the bare chest: frame and grid with the heights of the skin and of the bare chest.
pub(crate) struct Bare {
    pub(crate) frame: Frame,
    pub(crate) grid: Grid,
    pub(crate) skin_mm: Vec<f64>,
    pub(crate) bare_mm: Vec<f64>,
}

impl Bare {
    /// The left side of a body that is no scan.
    pub(crate) fn fitted(surface: &Surface, marks: &Marks) -> Result<Self, FitError> {
        let (welded, settings) = (surface.weld(), Settings::default());
        let subject = Subject::new(surface, &welded, (marks, Side::Left), &settings)?;
        let (frame, Fields { skin_mm, bare_mm, .. }) = subject.on_wall(&subject.placed()?)?;
        Ok(Self { frame, grid: subject.grid, skin_mm, bare_mm })
    }

    /// Volume between skin and bare chest in the ellipse of the left breast's marks \[ml\].
    pub(crate) fn volume_ml(&self, marks: &Marks) -> f64 {
        let Some(ellipse) = Ellipse::of_breast(&self.frame, marks, Side::Left) else {
            return 0.0;
        };
        let nodes = (0..self.grid.len()).filter(|&node| ellipse.contains(self.grid.place(node)));
        let depth = |node: usize| (self.skin_mm[node] - self.bare_mm[node]).max(0.0);
        nodes.map(depth).sum::<f64>() * self.grid.spacing_mm.powi(2) / 1e3
    }
}

/// The mark of a side that is farthest off the surface, and its distance \[mm\]; `None`: all lie on it.
fn farthest_mark(
    surface: &Surface,
    marks: &Marks,
    side: Side,
) -> Result<Option<(String, f64)>, FitError> {
    let nearest = |at: DVec3| {
        let squares = surface.positions.iter().map(|place| place.distance_squared(at));
        squares.fold(f64::INFINITY, f64::min).sqrt()
    };
    let (free, most) = OFF_SKIN_MM;
    // The middle of a large triangle is far from its corners.
    let distance = |at: DVec3| match nearest(at) {
        near if near <= free => near,
        near => snap(surface, at).map_or(near, |found| found.point.distance(at)),
    };
    let mut off: Vec<_> =
        marks.named(side)?.into_iter().map(|(name, at)| (name, distance(at))).collect();
    off.retain(|(_, distance)| *distance > free);
    off.sort_by(|a, b| b.1.total_cmp(&a.1));
    if let Some((name, off)) = off.iter().find(|(name, off)| *off > most && name != "navel") {
        let line = format!(
            "{name} is {off:.0} mm off the surface; allowed: up to {most} mm: check unit and marks"
        );
        return Err(FitError::Limit(line));
    }
    Ok(off.into_iter().next())
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

/// What is fitted.
struct Subject<'a> {
    surface: &'a Surface,
    welded: &'a [u32],
    marks: &'a Marks,
    side: Side,
    breast: BreastMarks,
    axes: BodyAxes,
    settings: &'a Settings,
    grid: Grid,
    /// The implant's centre: marked, or proposed and on no surface.
    center: DVec3,
    /// Mean unit normal of the skin about the centre, and +1, or −1 for normals inwards.
    outwards: DVec3,
    orientation: f64,
}

/// Frame, skin and quadric after the rounds, with their fields.
struct Placed {
    frame: Frame,
    field: Field,
    quadric: Quadric,
    fields: Fields,
}

impl<'s> Subject<'s> {
    fn new(
        surface: &'s Surface,
        welded: &'s [u32],
        (marks, side): (&'s Marks, Side),
        settings: &'s Settings,
    ) -> Result<Self, FitError> {
        marks.check(side)?;
        let (breast, axes) = (*marks.breast(side)?, marks.axes()?);
        let center = marks.implant_centre(side, settings.base_radius_mm)?;
        let (outwards, orientation) =
            mean_normal(surface, center, &axes).ok_or(FitError::NoSkin)?;
        let spacing_mm = settings.patch_radius_mm / NODES as f64;
        let grid = Grid { half: NODES + BEYOND, spacing_mm };
        Ok(Self {
            surface,
            welded,
            marks,
            side,
            breast,
            axes,
            settings,
            grid,
            center,
            outwards,
            orientation,
        })
    }

    fn is_proposed(&self) -> bool {
        self.breast.implant_centre.is_none()
    }

    /// The frame turned to another normal.
    fn turned(&self, frame: &Frame, outwards: DVec3) -> Result<Frame, FitError> {
        let outwards = frame.direction(outwards);
        Frame::new(frame.origin, outwards, self.axes.head, self.side).ok_or(FitError::NoData)
    }

    /// The frame after the rounds. A proposed pocket that reaches around the flank moves to the midline until there is skin over it.
    fn placed(&self) -> Result<Placed, FitError> {
        let pocket_mm = self.settings.pocket_radius_mm;
        let mut placed = self.placed_beside(0.0)?;
        for inwards_mm in INWARDS_MM {
            if !self.is_proposed() || carries_pocket(self.grid, &placed.fields.filled_mm, pocket_mm)
            {
                break;
            }
            placed = self.placed_beside(inwards_mm)?;
        }
        Ok(placed)
    }

    /// The same, a proposed centre by a way nearer to the midline than the middle of the breast's width.
    fn placed_beside(&self, inwards_mm: f64) -> Result<Placed, FitError> {
        let frame = Frame::new(self.center, self.outwards, self.axes.head, self.side);
        let mut frame = frame.ok_or(FitError::NoSkin)?;
        if self.is_proposed() {
            let middle = self.heights(&frame)[self.grid.len() / 2];
            frame = frame.raised(if middle.is_finite() { middle } else { 0.0 });
        }
        for _ in 0..ROUNDS {
            let (_, quadric) = self.chest(&frame)?;
            frame = self.turned(&frame, quadric.normal())?;
            if self.is_proposed() {
                // On the middle of the breast's width, as seen along the normal.
                let BreastMarks { medial, lateral, .. } = self.breast;
                let middle = frame.local(medial.midpoint(lateral)).x;
                frame = frame.moved_across(middle - inwards_mm);
            }
        }
        let (field, quadric) = self.chest(&frame)?;
        let fields = Fields::new(&field, &quadric, self.settings);
        Ok(Placed { frame, field, quadric, fields })
    }

    /// The frame on the wall with z as the wall's own normal, and its fields: the smoothed residual tilts the wall by up to some degrees.
    fn on_wall(&self, placed: &Placed) -> Result<(Frame, Fields), FitError> {
        let Placed { frame, fields, .. } = placed;
        let slope = self.grid.slope(&fields.wall_mm, self.grid.len() / 2);
        let frame = self.turned(frame, (-slope).extend(1.0))?;
        let (field, quadric) = self.chest(&frame)?;
        let mut fields = Fields::new(&field, &quadric, self.settings);
        let raise = fields.move_to_wall(self.grid);
        Ok((frame.raised(raise), fields))
    }

    fn view<'a>(&'a self, frame: &'a Frame) -> View<'a> {
        View::new(self.surface, self.welded, frame, self.orientation)
    }

    /// Heights of the skin in a frame \[mm\].
    fn heights(&self, frame: &Frame) -> Vec<f64> {
        let view = self.view(frame);
        view.heights(self.grid, &view.connected())
    }

    /// Skin and quadric in a frame.
    fn chest(&self, frame: &Frame) -> Result<(Field, Quadric), FitError> {
        let Settings { patch_radius_mm, radii_mm, .. } = *self.settings;
        let of = (self.grid, self.heights(frame));
        let field = Field::new(of, frame, (self.marks, self.side), patch_radius_mm)?;
        let field = field.ok_or(FitError::Line)?;
        if field.is_data.iter().filter(|is| **is).count() < LEAST_DATA {
            return Err(FitError::NoData);
        }
        let quadric = Quadric::fitted(self.grid, &field.heights_mm, &field.is_data, radii_mm);
        Ok((field, quadric.ok_or(FitError::NoData)?))
    }

    /// The figures of the fields in a frame.
    fn quality(&self, placed: &Placed) -> Quality {
        let Placed { frame, field, quadric, fields } = placed;
        let Settings { patch_radius_mm, pocket_radius_mm, .. } = *self.settings;
        let scan = Scan {
            heights_mm: &field.heights_mm,
            filled_mm: &fields.filled_mm,
            is_own: &field.is_own,
            is_data: &field.is_data,
        };
        let of = [&*fields.skin_mm, &fields.bare_mm, &fields.wall_mm];
        let radii = (patch_radius_mm, pocket_radius_mm);
        let mut quality = Quality::of_fields(self.grid, &scan, of, quadric, radii);
        let floor: Vec<f64> = fields.wall_mm.iter().map(|wall| wall - BELOW_WALL_MM).collect();
        let air = self.view(frame).air(self.grid, &field.heights_mm, &floor);
        quality.set_air(self.grid, &air, patch_radius_mm);
        quality.holes = fields.holes;
        quality.notch_nipple_mm = self.marks.notch_nipple(self.side);
        let (BodyAxes { across, head, front }, z) = (self.axes, frame.axes.z_axis);
        quality.yaw_degrees = z.dot(across).atan2(z.dot(front)).to_degrees();
        quality.pitch_degrees = z.dot(head).asin().to_degrees();
        quality.is_turned = self.orientation < 0.0;
        if quality.open_pocket_percent > 0.0 {
            quality.inwards_percent = self.view(frame).inwards_percent(NEAR_MM);
        }
        if self.is_proposed() {
            quality.above_nipple_mm = (self.center - self.marks.nipple(self.side)).dot(head);
        }
        quality
    }
}

/// Heights over the plane of a frame \[mm\].
struct Fields {
    /// The skin after holes are filled, NaN where there is none.
    filled_mm: Vec<f64>,
    /// Number of holes that were filled.
    holes: usize,
    skin_mm: Vec<f64>,
    bare_mm: Vec<f64>,
    wall_mm: Vec<f64>,
}

impl Fields {
    fn new(field: &Field, quadric: &Quadric, settings: &Settings) -> Self {
        let Settings { cover_mm, least_mm, .. } = *settings;
        let mut filled_mm = field.heights_mm.clone();
        let holes = wall::fill_holes(field.grid, &mut filled_mm);
        let bare_mm = chest::bare(field.grid, &filled_mm, quadric, &field.is_data);
        let (skin_mm, wall_mm) =
            wall::skin_and_wall(field.grid, &filled_mm, &bare_mm, quadric, [cover_mm, least_mm]);
        Self { filled_mm, holes, skin_mm, bare_mm, wall_mm }
    }

    /// Counts all heights from the wall at the centre; its height before \[mm\].
    fn move_to_wall(&mut self, grid: Grid) -> f64 {
        let raise = self.wall_mm[grid.len() / 2];
        for values in [&mut self.skin_mm, &mut self.bare_mm, &mut self.wall_mm] {
            values.iter_mut().for_each(|height| *height -= raise);
        }
        raise
    }
}
