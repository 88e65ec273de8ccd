//! A chest wall by a grid of heights, as a scan gives it.

use super::continued::Continuation;
use super::hollow::{DIRECTIONS, Feet, LEAST_OF_TISSUE, way};
use super::smooth::smoothed;
use super::{Scene, SceneError, grid, out_of_range, problem};
use crate::curve::{number, present, whole};
use crate::mesh::{Chest, HeightGrid, ThicknessField};
use glam::DVec2;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::TAU;
use std::sync::Arc;

/// The chest wall by a grid of heights.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
pub struct ChestGrid {
    /// The grid.
    pub grid: HeightsGrid,
}

/// Heights over a plane, centred on the pocket's centre. The wall's tangent plane there is subtracted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
pub struct HeightsGrid {
    /// Distance of neighbouring heights \[mm\], 0.5 to 50.
    pub spacing_mm: f64,
    /// Heights in a row, along x, 4 to 257.
    #[serde(deserialize_with = "whole")]
    pub columns: usize,
    /// Rows, along y, 4 to 257.
    #[serde(deserialize_with = "whole")]
    pub rows: usize,
    /// Row by row, x fastest, from −x, −y, −1000 to 1000 \[mm\]; `null` where the scan has no data: there, and beyond a small grid, the
    /// wall is continued. Data cover 60 % of the simulated tissue and 90 % of the pocket at least.
    #[serde(serialize_with = "grid::written", deserialize_with = "grid::read")]
    #[schemars(with = "Vec<Option<f64>>")]
    pub heights_mm: Arc<[Option<f64>]>,
    /// Standard deviation of a Gaussian mean that smooths the heights \[mm\], 0 to 20; planes stay. Default: 0, the heights as given.
    #[serde(default, deserialize_with = "present", skip_serializing_if = "is_zero")]
    pub smooth_mm: f64,
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    reason = "serde passes a reference; an 8-byte number is small on some targets"
)]
fn is_zero(number: &f64) -> bool {
    *number == 0.0
}

/// Smoothing \[mm\].
const SMOOTH_MM: (f64, f64) = (0.0, 20.0);
/// Heights \[mm\].
const HEIGHTS_MM: (f64, f64) = (-1000.0, 1000.0);
/// Greatest tilt of the grid at its centre \[degrees\], and the tilt that a result mentions: the subtracted plane shears the wall.
const TILTS: (f64, f64) = (20.0, 1.0);
/// Least height component of the wall's normal \[-\]: 76° of slope.
const LEAST_UP: f64 = 0.24;
/// Least distance of neighbouring geodesics \[distance over the plane\]: lines that meet fold the tissue.
const LEAST_SPREAD: f64 = 0.3;

/// Least shares of pocket and simulated tissue with data \[-\].
const SHARES: [(f64, &str); 2] = [(0.9, "pocket"), (0.6, "simulated tissue")];

/// Least part of pocket or tissue without data that a result mentions \[%\].
const LEAST_SAID: f64 = 0.05;

/// Smoothing that an error proposes where it is enough \[mm\].
const SMOOTHER_MM: [f64; 9] = [2.0, 3.0, 4.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0];

/// The first ones: where neither is enough, none of the others is worth its time.
const TRIED_FIRST_MM: [f64; 2] = [20.0, 8.0];

const PATH: &str = "chest.grid";
/// The error of a chest with radii and a grid.
pub(super) const BOTH: &str = "both radii and a grid; allowed: one of them";

/// Why a wall carries no tissue.
enum Unfit {
    /// What the wall is, and what is allowed; smoother heights may be fit.
    Rough([String; 2]),
    Error(SceneError),
}

impl From<SceneError> for Unfit {
    fn from(error: SceneError) -> Self {
        Self::Error(error)
    }
}

impl Scene {
    /// The wall of the scene's grid under tissue of this thickness; `None` without a grid.
    ///
    /// # Errors
    /// A field that is out of its range, or a wall that does not carry the tissue.
    pub(super) fn scanned_wall(
        &self,
        thickness: Option<&ThicknessField>,
    ) -> Result<Option<Chest>, SceneError> {
        let Some(ChestGrid { grid }) = &self.chest_grid else { return Ok(None) };
        let HeightsGrid { spacing_mm, columns, rows, heights_mm, smooth_mm } = grid;
        self.check_may_have_chest()?;
        if self.chest.is_some() {
            return Err(problem("chest", BOTH));
        }
        let counts = [*columns, *rows];
        let form = grid::Form { path: PATH, values: "heights_mm", spacing_mm: *spacing_mm };
        form.check(counts, heights_mm, HEIGHTS_MM, "mm")?;
        if !(SMOOTH_MM.0..=SMOOTH_MM.1).contains(smooth_mm) {
            let allowed = format!("{} to {} mm", SMOOTH_MM.0, SMOOTH_MM.1);
            return Err(out_of_range("chest.grid.smooth_mm", number(*smooth_mm), &allowed));
        }
        match self.wall_of(grid, &form, thickness) {
            Ok(wall) => Ok(Some(wall)),
            Err(Unfit::Error(error)) => Err(error),
            Err(Unfit::Rough([value, allowed])) => {
                let is_enough = |mm: &f64| {
                    let smooth = HeightsGrid { smooth_mm: *mm, ..grid.clone() };
                    *mm > *smooth_mm && self.wall_of(&smooth, &form, thickness).is_ok()
                };
                let is_cured = TRIED_FIRST_MM.iter().any(is_enough);
                let remedy = is_cured.then(|| SMOOTHER_MM.into_iter().find(is_enough)).flatten();
                let remedy = remedy.map(|mm| format!("; {PATH}.smooth_mm {mm} would do"));
                let allowed = allowed + &remedy.unwrap_or_default();
                Err(out_of_range(PATH, value, &allowed))
            }
        }
    }

    /// The wall of a grid, continued where it has no data, that the tissue fits onto.
    fn wall_of(
        &self,
        grid: &HeightsGrid,
        form: &grid::Form,
        thickness: Option<&ThicknessField>,
    ) -> Result<Chest, Unfit> {
        let counts = [grid.columns, grid.rows];
        let whole = grid.whole().map(|heights| {
            let heights = HeightGrid::new(grid.spacing_mm, counts, heights);
            heights.map(Chest::Grid).ok_or_else(|| problem(PATH, "no grid of numbers"))
        });
        let whole = whole.transpose()?.filter(|wall| {
            let patch = self.patch_radius();
            let feet = wall.feet(patch);
            let reach = (0..DIRECTIONS).map(|k| feet(way(k) * patch).0.truncate().abs());
            // A line along the wall reaches no further than it is long; one that is lost on an uneven wall does.
            let reach = reach.fold(DVec2::ZERO, DVec2::max).min(DVec2::splat(patch));
            form.check_reach(counts, reach.to_array()).is_ok()
        });
        let (wall, counts) = match whole {
            Some(wall) => (wall, counts),
            None => self.continued_wall(grid, form, thickness)?,
        };
        let tilt = tilt(&wall);
        if tilt > TILTS.0 {
            let allowed =
                format!("up to {}° (turn the scan: z along the chest's normal there)", TILTS.0);
            let value = format!("tilted by {tilt:.0}° at the pocket's centre");
            return Err(Unfit::Rough([value, allowed]));
        }
        self.check_wall(&wall, thickness, form, counts)?;
        Ok(wall)
    }

    /// The wall of a grid with gaps or beyond a small one, and the numbers of its heights.
    fn continued_wall(
        &self,
        grid: &HeightsGrid,
        form: &grid::Form,
        thickness: Option<&ThicknessField>,
    ) -> Result<(Chest, [usize; 2]), SceneError> {
        let patch = self.patch_radius();
        let none = || {
            let size = form.check_reach([grid.columns, grid.rows], [patch; 2]).err();
            size.unwrap_or_else(|| unknown(0.0, SHARES[1]))
        };
        let mut continuation = self.continuation(grid, thickness).ok_or_else(none)?;
        let shares = continuation.shares(self.ends()).ok_or_else(none)?;
        for ([_, bridged], least) in shares.into_iter().zip(SHARES) {
            if bridged < least.0 {
                return Err(unknown(bridged, least));
            }
        }
        if grid.smooth_mm > 0.0 {
            let smooth = grid.smoothed(continuation.counts(), continuation.shortest());
            continuation.replace(&smooth);
        }
        let wall = continuation.wall(patch, self.tissue_at(thickness)).ok_or_else(none)?;
        Ok((wall, continuation.counts()))
    }

    /// The grid with what continues it.
    fn continuation(
        &self,
        grid: &HeightsGrid,
        thickness: Option<&ThicknessField>,
    ) -> Option<Continuation> {
        let HeightsGrid { spacing_mm, columns, rows, heights_mm, .. } = grid;
        Continuation::new(
            (*spacing_mm, [*columns, *rows]),
            heights_mm,
            self.patch_radius(),
            self.thickest_mm(thickness),
        )
    }

    /// Greatest thickness of the tissue \[mm\].
    fn thickest_mm(&self, thickness: Option<&ThicknessField>) -> f64 {
        let [even, solids] = self.even_and_uneven_mm();
        even + solids * thickness.map_or(1.0, ThicknessField::greatest)
    }

    /// Is a place over the plane \[mm\] under the base of the implant?
    fn is_under_implant(&self, place: DVec2) -> bool {
        let implant = &self.implant;
        let half = DVec2::new(implant.base_radius_mm, 0.5 * implant.base_height());
        ((place - DVec2::from(implant.center_mm)) / half).length() <= 1.0
    }

    /// Radii of pocket and simulated tissue \[mm\].
    fn ends(&self) -> [f64; 2] {
        [self.pocket_radius_mm, self.patch_radius()]
    }

    /// Thickness of the tissue as a function of lengths along the wall \[mm\].
    fn tissue_at(&self, thickness: Option<&ThicknessField>) -> impl Fn(DVec2) -> f64 {
        let [even, solids] = self.even_and_uneven_mm();
        move |along| even + solids * thickness.map_or(1.0, |field| field.factor(along))
    }

    /// Checks that the tissue fits onto a wall.
    fn check_wall(
        &self,
        wall: &Chest,
        thickness: Option<&ThicknessField>,
        form: &grid::Form,
        counts: [usize; 2],
    ) -> Result<(), Unfit> {
        let feet = Feet::new(wall, self.patch_radius());
        // Beyond the grid its margin goes on: there the grid's size is the reason.
        let refused = |[what, more]: [&str; 2], place: DVec2, allowed: String| {
            let value = format!("{what} at ({:.0}, {:.0}) mm{more}", place.x, place.y);
            let size = form.check_reach(counts, place.abs().to_array()).err();
            Err(size.map_or(Unfit::Rough([value, allowed]), Unfit::Error))
        };
        let uneven = |place: DVec2, spread: f64| {
            let more =
                format!(": lines along it draw together to {:.0} %", 100.0 * spread.max(0.0));
            let allowed = format!("{:.0} % or more", 100.0 * LEAST_SPREAD);
            refused(["too uneven", &more], place, allowed)
        };
        let (mut reach, lost) = (DVec2::ZERO, feet.lost());
        let sound = lost.map_or(usize::MAX, |(sound, _)| sound);
        for (point, normal) in feet.rings().flat_map(|(_, feet)| feet).take(sound) {
            if normal.z < LEAST_UP {
                let slope = normal.z.clamp(0.0, 1.0).acos().to_degrees();
                let allowed = format!("up to {:.0}°", LEAST_UP.acos().to_degrees());
                return refused([&format!("steep by {slope:.0}°"), ""], point.truncate(), allowed);
            }
            reach = reach.max(point.truncate().abs());
        }
        if let Some((_, place)) = lost {
            return uneven(place, 0.0);
        }
        let tissue = (self.tissue_at(thickness), self.thickest_mm(thickness));
        if let Some(hollow) = feet.deepest(LEAST_OF_TISSUE, tissue) {
            return Err(Unfit::Rough(hollow.words()));
        }
        for (length, ring) in feet.rings() {
            let apart = TAU * length / DIRECTIONS as f64;
            for (k, (point, _)) in ring.iter().enumerate() {
                let (place, next) = (point.truncate(), ring[(k + 1) % DIRECTIONS].0);
                let spread =
                    place.perp_dot(next.truncate()).signum() * point.distance(next) / apart;
                if spread < LEAST_SPREAD {
                    return uneven(place, spread);
                }
            }
        }
        Ok(form.check_reach(counts, reach.to_array())?)
    }

    /// What a result says about the grid of the chest.
    pub(crate) fn chest_warnings(&self, wall: &Chest) -> Vec<String> {
        let (Chest::Grid(heights), Some(ChestGrid { grid })) = (wall, &self.chest_grid) else {
            return Vec::new();
        };
        let tilt = tilt(wall);
        let tilted = (tilt > TILTS.1).then(|| {
            format!(
                "The grid of the chest is tilted by {tilt:.0}° at the pocket's centre; heights count from the plane that \
                 touches it there."
            )
        });
        let whole = grid.whole().filter(|_| heights.counts() == [grid.columns, grid.rows]);
        let is_whole = whole.is_some();
        let continuation = || self.continuation(grid, self.thickness().ok()?.as_ref());
        let smoothed = (grid.smooth_mm > 0.0).then(|| {
            let moved = match whole {
                Some(heights) => heights,
                None => continuation().map_or_else(Vec::new, |continuation| {
                    let smooth = grid.smoothed(continuation.counts(), continuation.shortest());
                    continuation.given(&smooth)
                }),
            };
            let counts = [grid.columns, grid.rows];
            let is_within =
                |k: usize| grid::place(k, counts, grid.spacing_mm).length() <= self.patch_radius();
            let known = moved.iter().zip(&*grid.heights_mm).enumerate();
            let moves = known
                .filter(|(k, _)| is_within(*k))
                .filter_map(|(_, (after, before))| Some((after - (*before)?).abs()));
            format!(
                "The heights of the chest are smoothed by {} mm; they moved by up to {:.1} mm.",
                number(grid.smooth_mm),
                moves.fold(0.0, f64::max)
            )
        });
        let continuation = (!is_whole).then(continuation).flatten();
        let gap = continuation.as_ref().and_then(|continuation| {
            let (at, width) = continuation.widest_gap(|place| self.is_under_implant(place))?;
            Some(format!(
                "The wall under the implant is estimated at ({:.0}, {:.0}) mm, where the grid has no heights over {width:.0} mm; \
                 pressure there may differ.",
                at.x, at.y
            ))
        });
        let shares = continuation.and_then(|continuation| continuation.shares(self.ends()));
        let continued = shares.map(|shares| shares.map(|[share, _]| 100.0 * (1.0 - share)));
        let continued = continued.filter(|parts| parts.iter().any(|part| *part >= LEAST_SAID));
        let continued = continued.map(|[pocket, tissue]| {
            format!(
                "The heights of the chest are continued over {tissue:.1} % of the tissue and {pocket:.1} % of the pocket, where \
                 the grid has none."
            )
        });
        [tilted, smoothed, continued, gap].into_iter().flatten().collect()
    }
}

/// The error of data that cover too small a share.
fn unknown(share: f64, (least, what): (f64, &str)) -> SceneError {
    let value = format!("known over {:.0} % of the {what}", (100.0 * share).floor());
    let allowed = format!("{:.0} % or more", 100.0 * least);
    out_of_range("chest.grid.heights_mm", value, &allowed)
}

impl HeightsGrid {
    /// The heights after their smoothing \[mm\]; `None` with gaps.
    fn whole(&self) -> Option<Vec<f64>> {
        let heights: Option<Vec<f64>> = self.heights_mm.iter().copied().collect();
        Some(self.smoothed([self.columns, self.rows], heights?))
    }

    /// Heights of columns and rows after the smoothing \[mm\].
    fn smoothed(&self, counts: [usize; 2], heights: Vec<f64>) -> Vec<f64> {
        smoothed(counts, heights, self.smooth_mm / self.spacing_mm)
    }
}

/// Angle of the grid's tangent plane at its centre \[degrees\].
fn tilt(wall: &Chest) -> f64 {
    let Chest::Grid(heights) = wall else { return 0.0 };
    DVec2::from(heights.tilt()).length().atan().to_degrees()
}

#[cfg(test)]
mod tests;
