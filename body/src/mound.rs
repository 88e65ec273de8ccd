//! A breast over its bare chest, before and after an operation, and the likeness of both breasts.
//!
//! Before and after lie over one bare chest in one frame, so that differences have the errors of the surfaces alone: volumes ≤ 1 % (grid of
//! 4 mm), lengths ≤ 0.1 mm. The bare chest itself is uncertain: on trunks of known chest projection is within 1 mm, volume within 3 ml, the share of the upper pole within 0.5 %
//! (`body/tests/mound.rs`), with marks 8 mm off volume within 35 ml; separately fitted scans differ by more. Compare volumes of one fit only.

use crate::chest::Ellipse;
use crate::fit::BodyFit;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::marks::{Marks, Side};
use crate::raster::View;
use crate::surface::Surface;
use glam::{DVec2, DVec3};

/// A breast over its bare chest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mound {
    /// Greatest height of the skin over the bare chest, along the chest's normal \[mm\].
    pub projection_mm: f64,
    /// Volume between skin and bare chest: in the ellipse of the marks before, after with all that the patch has gained \[ml\].
    pub volume_ml: f64,
    /// Share of this volume above the level of the nipple \[%\].
    pub upper_percent: f64,
}

/// A breast before and after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change {
    /// Before.
    pub before: Mound,
    /// After, over the same bare chest.
    pub after: Mound,
    /// Volume that the skin of the patch gains, Σ Δz h² \[ml\].
    pub gained_ml: f64,
    /// Way of the nipple: to the patient's side, to the head, outwards along the chest's normal \[mm\].
    pub nipple_mm: DVec3,
}

/// A breast of a fit as it is; `None` for marks of no breast.
#[must_use]
pub fn mound(fit: &BodyFit, marks: &Marks, side: Side) -> Option<Mound> {
    let none = vec![0.0; fit.grid.len()];
    Field { fit, gains: &none, level: fit.frame.local(marks.nipple(side)).y }.mound(marks, side)
}

/// A breast before and after: a deformed surface with its marks, over the bare chest of the fit before; `None` for marks of no breast.
#[must_use]
pub fn change(
    fit: &BodyFit,
    [before, after]: [(&Surface, &Marks); 2],
    side: Side,
) -> Option<Change> {
    let welded = before.0.weld();
    let orientation = if fit.quality.is_turned { -1.0 } else { 1.0 };
    // The parts of the surface that hang together with the skin at the centre.
    let frame = fit.frame.raised(fit.skin_mm[fit.grid.len() / 2]);
    let view = View::new(before.0, &welded, &frame, orientation);
    let triangles = view.connected();
    let heights = |surface: &Surface| {
        let view = View::new(surface, &welded, &fit.frame, orientation);
        view.heights(fit.grid, &triangles)
    };
    let [low, high] = [before.0, after.0].map(heights);
    let gain = |(low, high): (&f64, &f64)| {
        let gain = high - low;
        if gain.is_finite() { gain } else { 0.0 }
    };
    let gains: Vec<f64> = low.iter().zip(&high).map(gain).collect();
    let local = |marks: &Marks| fit.frame.local(marks.nipple(side));
    let field = Field { fit, gains: &gains, level: local(after.1).y };
    Some(Change {
        before: mound(fit, before.1, side)?,
        after: field.mound(before.1, side)?,
        gained_ml: gains.iter().sum::<f64>() * fit.grid.spacing_mm.powi(2) / 1e3,
        nipple_mm: local(after.1) - local(before.1),
    })
}

/// Heights over a bare chest.
struct Field<'a> {
    fit: &'a BodyFit,
    /// Heights that the skin has gained since the fit \[mm\].
    gains: &'a [f64],
    /// Level of the nipple in the frame \[mm\].
    level: f64,
}

impl Field<'_> {
    /// The breast in the ellipse of marks before.
    fn mound(&self, marks: &Marks, side: Side) -> Option<Mound> {
        let BodyFit { grid, frame, skin_mm, bare_mm, .. } = self.fit;
        let ellipse = Ellipse::of_breast(frame, marks, side)?;
        let (mut projection_mm, mut volume, mut upper) = (0.0_f64, 0.0, 0.0);
        for node in 0..grid.len() {
            let place = grid.place(node);
            let own = if ellipse.contains(place) { skin_mm[node] - bare_mm[node] } else { 0.0 };
            if ellipse.contains(place) {
                projection_mm = projection_mm.max(own + self.gains[node]);
            }
            let depth = own.max(0.0) + self.gains[node];
            volume += depth;
            // A row of nodes at the level is shared.
            let above = (0.5 + (place.y - self.level) / grid.spacing_mm).clamp(0.0, 1.0);
            upper += depth * above;
        }
        let upper_percent = if volume > 0.0 { 100.0 * upper / volume } else { 0.0 };
        let volume_ml = volume * grid.spacing_mm.powi(2) / 1e3;
        Some(Mound { projection_mm, volume_ml, upper_percent })
    }
}

/// Grid of the comparison of both sides.
const BOTH: Grid = Grid { half: 52, spacing_mm: 4.0 };
/// Least z of the unit normal of skin that is compared \[-\].
const LEAST_UP: f64 = 0.3;

/// Root mean square distance, along the mean normals of both, of the left breast's skin from the mirror image of the right one's, the mirror being the midplane of a frame, that
/// of the marks before an operation ([`Frame::of_body`]) \[mm\]; within the ellipse of either breast's marks. `None` for marks without both breasts. Error: 0.1 mm of a fine
/// surface; a plane turned by 1° is 2 mm.
#[must_use]
pub fn asymmetry_mm(surface: &Surface, marks: &Marks, frame: &Frame) -> Option<f64> {
    let welded = surface.weld();
    let turned = surface.signed_volume() < 0.0;
    let orientation = if turned { -1.0 } else { 1.0 };
    let view = View::new(surface, &welded, frame, orientation);
    let heights = view.heights(BOTH, &view.connected());
    let ellipse = |side: Side| Ellipse::of_breast(frame, marks, side);
    let ellipses = [ellipse(Side::Left)?, ellipse(Side::Right)?];
    let (side, mut sum, mut count) = (BOTH.side(), 0.0, 0.0);
    for node in 0..BOTH.len() {
        let place = BOTH.place(node);
        let image = node - node % side + (side - 1 - node % side);
        let both = [place, BOTH.place(image)];
        let is_own = place.x > 0.0 && (0..2).any(|k| ellipses[k].contains(both[k]));
        let apart = heights[node] - heights[image];
        // Of both skins alike: sides exchanged give the same distance.
        let slopes = [node, image].map(|node| BOTH.slope(&heights, node));
        let slope = 0.5 * (slopes[0] + slopes[1] * DVec2::new(-1.0, 1.0));
        let up = 1.0 / (1.0 + slope.length_squared()).sqrt();
        if is_own && apart.is_finite() && up > LEAST_UP {
            sum += (apart * up).powi(2);
            count += 1.0;
        }
    }
    (count > 0.0).then(|| (sum / count).sqrt())
}
