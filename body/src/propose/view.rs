//! A body from the front: the pair of breasts, notch and navel.

use super::Subject;
use super::axes::Pose;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::raster::View;
use glam::{DVec2, DVec3};

/// Spacing of the heights \[mm\].
const SPACING_MM: f64 = 6.0;
/// Greatest number of nodes on each side of the centre: bodies of 2.2 m.
const MOST: usize = 180;
/// Distances of a nipple from the midline \[mm\].
const ASIDE_MM: [f64; 2] = [50.0, 165.0];
/// Height over and under a nipple at which the breast is over \[mm\].
const ABOVE_MM: f64 = 75.0;
/// Greatest height of a nipple over the midline, and over the places above and below \[mm\].
const GREATEST_MM: [f64; 2] = [160.0, 180.0];
/// Reach of the slopes over and under a nipple, and length of each \[mm\].
const SLOPES_MM: [f64; 3] = [12.0, 78.0, 18.0];
/// What a steeper slope under the nipple than over it counts \[mm\], and the greatest difference that counts \[-\].
const FOLD: (f64, f64) = (15.0, 2.0);
/// From notch to navel along the body over that from the notch to the level of the nipples \[-\], and its range in adults \[mm\].
const NAVEL: (f64, [f64; 2]) = (2.38, [320.0, 480.0]);
/// From the level of the nipples up to the notch over the distance between the nipples, where the shape shows none, and the range in which
/// it is looked for \[-\].
const NOTCH: (f64, [f64; 2]) = (0.675, [0.42, 1.1]);
/// Fall of the midline at a notch \[-\], and the length over which it is measured \[mm\].
const FALL: (f64, f64) = (0.35, 24.0);

/// Heights of a body's front over the plane of a pose.
pub(super) struct Front {
    pub(super) pose: Pose,
    grid: Grid,
    heights: Vec<f64>,
}

/// Places of the nipples \[mm\]: distance from the midline and level, the left one first.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair(pub(super) [DVec2; 2]);

impl Front {
    pub(super) fn new(subject: &Subject<'_>, pose: &Pose) -> Self {
        let Subject { surface, welded, triangles, orientation } = *subject;
        let frame = Frame { origin: pose.origin, axes: pose.axes };
        let far = triangles.iter().map(|index| {
            let [k, ..] = surface.triangles[*index as usize];
            let local = frame.local(surface.positions[k as usize]);
            local.x.abs().max(local.y.abs())
        });
        let half = far.fold(0.0, f64::max) / SPACING_MM;
        let grid =
            Grid { half: (half.ceil() as usize + 1).clamp(20, MOST), spacing_mm: SPACING_MM };
        let view = View::new(surface, welded, &frame, orientation);
        let heights = view.heights(grid, &view.outwards(triangles));
        Self { pose: *pose, grid, heights }
    }

    /// Height at a place, NaN where a node beside it has none \[mm\].
    fn at(&self, x: f64, y: f64) -> f64 {
        self.grid.value(&self.heights, DVec2::new(x, y))
    }

    /// The point of the skin at a place, in the surface's coordinates \[mm\].
    pub(super) fn point(&self, place: DVec2) -> DVec3 {
        let height = self.at(place.x, place.y);
        self.pose.origin + self.pose.axes * place.extend(height)
    }

    /// The pair of breasts with the best score \[mm\]: how far both nipples, mirror images here, lie over the midline, and over the places above
    /// and below, more with a fold below.
    pub(super) fn breasts(&self) -> Option<(f64, Pair)> {
        let reach = self.grid.half as f64 * SPACING_MM - ABOVE_MM - 6.0;
        let levels = (2.0 * reach.max(0.0) / SPACING_MM) as usize;
        let sides = ((ASIDE_MM[1] - ASIDE_MM[0]) / SPACING_MM) as usize;
        let mut best: Option<(f64, DVec2)> = None;
        for place in (0..=levels).flat_map(|j| {
            let y = j as f64 * SPACING_MM - reach;
            (0..=sides).map(move |i| DVec2::new(ASIDE_MM[0] + i as f64 * SPACING_MM, y))
        }) {
            let [left, right] = [1.0, -1.0].map(|side| self.rise(place * DVec2::new(side, 1.0)));
            let score = left.min(right);
            if score > best.map_or(0.0, |(most, _)| most) {
                best = Some((score, place));
            }
        }
        let (score, place) = best?;
        let fold = [1.0, -1.0].map(|side| self.fold(place * DVec2::new(side, 1.0)));
        let (counts, most) = FOLD;
        let fold = (0.5 * (fold[0] + fold[1])).clamp(-most, most) * counts;
        Some((score + fold, Pair([place, place * DVec2::new(-1.0, 1.0)])))
    }

    /// How far a place lies over the midline and over the places above and below \[mm\]; NaN where it is no breast.
    fn rise(&self, place: DVec2) -> f64 {
        let own = self.at(place.x, place.y);
        let aside = own - self.at(0.0, place.y);
        let (up, down) = (
            own - self.at(place.x, place.y + ABOVE_MM),
            own - self.at(place.x, place.y - ABOVE_MM),
        );
        let most = up.max(down);
        let is_breast = aside > 0.0 && aside < GREATEST_MM[0] && most < GREATEST_MM[1];
        if is_breast { 0.5 * aside + 0.5 * (up + down) } else { f64::NAN }
    }

    /// The steepest slope under a place less that over it \[-\].
    fn fold(&self, place: DVec2) -> f64 {
        let [from, to, length] = SLOPES_MM;
        let steepest = |way: f64| {
            let steps = ((to - from) / SPACING_MM) as usize;
            let slopes = (0..steps).map(|k| {
                let start = from + k as f64 * SPACING_MM;
                let height = |s: f64| self.at(place.x, place.y + way * s);
                (height(start) - height(start + length)) / length
            });
            slopes.fold(0.0, f64::max)
        };
        steepest(-1.0) - steepest(1.0)
    }

    /// Notch and navel, in the surface's coordinates \[mm\].
    pub(super) fn midline(&self, Pair(nipples): &Pair) -> [DVec3; 2] {
        let level = 0.5 * (nipples[0].y + nipples[1].y);
        let apart = nipples[0].x - nipples[1].x;
        let (usual, [least, most]) = NOTCH;
        let (fall, length) = FALL;
        // Where the chest falls back to the neck most steeply.
        let steps = ((most - least) * apart / 3.0) as usize;
        let slopes = (0..steps).map(|k| {
            let y = level + least * apart + 3.0 * k as f64;
            ((self.at(0.0, y - 0.5 * length) - self.at(0.0, y + 0.5 * length)) / length, y)
        });
        let steepest = slopes.filter(|(slope, _)| *slope > fall).max_by(|a, b| a.0.total_cmp(&b.0));
        let notch = steepest.map_or(level + usual * apart, |(_, y)| y);
        let (ratio, [shortest, longest]) = NAVEL;
        let navel = notch - (ratio * (notch - level)).clamp(shortest, longest);
        [notch, navel].map(|y| self.on_midline(y, level))
    }

    /// The point of the midline at a level, or at the nearest level with skin towards another one.
    fn on_midline(&self, level: f64, towards: f64) -> DVec3 {
        let Pose { origin, axes } = self.pose;
        let steps = (level - towards).abs() as usize;
        let way = (towards - level).signum();
        let levels = (0..=steps).map(|k| level + way * k as f64);
        let bounds = self.grid.half as f64 * SPACING_MM;
        let mut found =
            levels.filter(|y| y.abs() <= bounds).map(|y| DVec3::new(0.0, y, self.at(0.0, y)));
        let place = found.find(|at| at.z.is_finite());
        origin + axes * place.unwrap_or(DVec3::new(0.0, level, 0.0))
    }
}
