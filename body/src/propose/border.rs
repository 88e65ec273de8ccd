//! One breast: the nipple and the borders, over the bare chest in a frame along the chest's normal.

use super::Subject;
use super::view::{Front, Pair};
use crate::chest::Quadric;
use crate::frame::Frame;
use crate::grid::Grid;
use crate::marks::Side;
use crate::raster::View;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Grid of the heights.
const GRID: Grid = Grid { half: 36, spacing_mm: 4.0 };
/// Turn of the chest's normal to the side at first \[radians\].
const YAW: f64 = 0.35;
/// From the nipple to the breast's middle, towards the midline and the head, and half widths of the breast at first \[mm\].
const MIDDLE_MM: DVec2 = DVec2::new(-12.0, 22.0);
const HALF_MM: DVec2 = DVec2::new(72.0, 82.0);
/// Distance of the data from the border \[mm\].
const MARGIN_MM: f64 = 8.0;
/// Renewals of normal, bare chest and border.
const ROUNDS: usize = 3;
/// Least z of the unit normal of skin that determines the chest \[-\].
const LEAST_UP: f64 = 0.6;
/// Reach of the nipple about the place in the view from the front \[mm\].
const NEAR_MM: f64 = 45.0;
/// Rays of the border, first place and step on a ray, last place \[mm\].
const RAYS: usize = 48;
const WALK_MM: [f64; 3] = [16.0, 2.0, 140.0];
/// Way without skin, as in a deep fold, over which a ray goes on \[mm\].
const GAP_MM: f64 = 24.0;
/// The border is where the skin is less over the bare chest than this share of the nipple, within these heights \[-\], \[mm\].
const END: (f64, [f64; 2]) = (0.08, [2.5, 6.0]);
/// Directions of the marks from the nipple, from the side towards the head \[degrees\].
const LATERAL: f64 = 22.5;
const UPPER: f64 = 100.0;
const MEDIAL: f64 = 180.0;
const FOLD: f64 = 285.0;
/// Least distance of the medial mark from the midline \[mm\].
const MIDLINE_MM: f64 = 5.0;
/// Least and greatest half widths of a breast \[mm\].
const WIDTHS_MM: [f64; 2] = [40.0, 115.0];

/// Marks of a breast, in the surface's coordinates \[mm\].
pub(super) struct Breast {
    pub(super) nipple: DVec3,
    pub(super) fold: DVec3,
    pub(super) upper: DVec3,
    pub(super) medial: DVec3,
    pub(super) lateral: DVec3,
}

/// An upright ellipse.
#[derive(Clone, Copy)]
struct Oval {
    center: DVec2,
    half: DVec2,
}

impl Oval {
    fn contains(&self, place: DVec2) -> bool {
        ((place - self.center) / (self.half + MARGIN_MM)).length_squared() < 1.0
    }
}

impl Breast {
    pub(super) fn new(
        subject: &Subject<'_>,
        front: &Front,
        Pair(nipples): &Pair,
        side: Side,
    ) -> Option<Self> {
        let (pose, sign) = (front.pose, side.sign());
        let own = nipples[side as usize];
        let at = |place: DVec2| front.point(place);
        let middle = own + MIDDLE_MM * DVec2::new(sign, 1.0);
        let outwards = pose.axes * DVec3::new(sign * YAW.sin(), 0.0, YAW.cos());
        let mut frame = Frame::new(at(middle), outwards, pose.axes.y_axis, side)?;
        let mut oval = Oval { center: DVec2::ZERO, half: HALF_MM };
        let mut found = None;
        for _ in 0..ROUNDS {
            let mirrored = {
                // The other breast: the image of the own one.
                let center = frame.point(oval.center.extend(0.0));
                let across = (center - pose.origin).dot(pose.axes.x_axis);
                let image = frame.local(center - pose.axes.x_axis * (2.0 * across));
                Oval { center: image.truncate(), half: oval.half }
            };
            let heights = skin(subject, &frame);
            let quadric = chest(&heights, [&oval, &mirrored])?;
            let near = frame.local(at(own)).truncate();
            let shape = Shape { heights, quadric, nipple: near };
            let shape = shape.with_nipple(near)?;
            let ends = shape.ends();
            let (low, high) = ends
                .iter()
                .fold((ends[0], ends[0]), |(low, high), end| (low.min(*end), high.max(*end)));
            oval.center = 0.5 * (low + high);
            oval.half =
                (0.5 * (high - low)).clamp(DVec2::splat(WIDTHS_MM[0]), DVec2::splat(WIDTHS_MM[1]));
            let turned = Frame::new(
                frame.origin,
                frame.direction(quadric.normal()),
                pose.axes.y_axis,
                side,
            )?;
            found = Some((shape, ends, frame));
            frame = turned;
        }
        let (shape, ends, frame) = found?;
        let at = |degrees: f64| {
            let ray = (degrees / 360.0 * RAYS as f64).round() as usize % RAYS;
            let place = shape.on_skin(ends[ray]);
            frame.point(place.extend(shape.height(place)))
        };
        let nipple = frame.point(shape.nipple.extend(shape.height(shape.nipple)));
        let mut medial = at(MEDIAL);
        let across = (medial - pose.origin).dot(pose.axes.x_axis) * sign;
        medial += pose.axes.x_axis * (sign * (MIDLINE_MM - across).max(0.0));
        Some(Self { nipple, fold: at(FOLD), upper: at(UPPER), medial, lateral: at(LATERAL) })
    }
}

/// Heights of the skin in a frame \[mm\], NaN where there is none.
fn skin(subject: &Subject<'_>, frame: &Frame) -> Vec<f64> {
    let Subject { surface, welded, triangles, orientation } = *subject;
    let view = View::new(surface, welded, frame, orientation);
    view.heights(GRID, &view.outwards(triangles))
}

/// The quadric through the skin beside the breasts.
fn chest(heights: &[f64], breasts: [&Oval; 2]) -> Option<Quadric> {
    let reach = GRID.half as f64 * GRID.spacing_mm;
    let is_data = (0..GRID.len()).map(|node| {
        let place = GRID.place(node);
        let up = 1.0 / (1.0 + GRID.slope(heights, node).length_squared()).sqrt();
        let is_beside = breasts.iter().all(|oval| !oval.contains(place));
        heights[node].is_finite() && up > LEAST_UP && is_beside && place.length() < reach
    });
    Quadric::fitted(GRID, heights, &is_data.collect::<Vec<bool>>(), None)
}

/// Skin over the bare chest.
struct Shape {
    heights: Vec<f64>,
    quadric: Quadric,
    /// Place of the nipple \[mm\].
    nipple: DVec2,
}

impl Shape {
    fn height(&self, place: DVec2) -> f64 {
        GRID.value(&self.heights, place)
    }

    /// Skin over the bare chest at a place \[mm\], NaN without skin.
    fn rise(&self, place: DVec2) -> f64 {
        self.height(place) - self.quadric.at(place)
    }

    /// The last place with skin on the way from the nipple to a place.
    fn on_skin(&self, end: DVec2) -> DVec2 {
        const STEPS: u32 = 50;
        let places = (0..STEPS).map(|k| end.lerp(self.nipple, f64::from(k) / f64::from(STEPS)));
        let mut with_skin = places.filter(|place| self.rise(*place).is_finite());
        with_skin.next().unwrap_or(self.nipple)
    }

    /// With the nipple at the highest place over the bare chest near a place.
    fn with_nipple(mut self, near: DVec2) -> Option<Self> {
        let steps = (NEAR_MM / 2.0) as i32;
        let places = (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| (i, j)));
        let places = places.map(|(i, j)| near + DVec2::new(f64::from(i), f64::from(j)) * 2.0);
        let rises =
            places.map(|place| (self.rise(place), place)).filter(|(rise, _)| rise.is_finite());
        self.nipple = rises.max_by(|a, b| a.0.total_cmp(&b.0))?.1;
        Some(self)
    }

    /// The places where the breast ends, on rays from the nipple.
    fn ends(&self) -> Vec<DVec2> {
        let [first, step, last] = WALK_MM;
        let (share, [least, most]) = END;
        let end = (share * self.rise(self.nipple)).clamp(least, most);
        let length = |ray: usize| {
            let way = DVec2::from_angle(TAU * ray as f64 / RAYS as f64);
            let (mut at, mut with_skin) = (first, first);
            while at < last && at - with_skin < GAP_MM {
                let rise = self.rise(self.nipple + way * at);
                if rise.is_finite() {
                    with_skin = at;
                }
                if rise < end {
                    break;
                }
                at += step;
            }
            with_skin
        };
        let lengths: Vec<f64> = (0..RAYS).map(length).collect();
        let ray = |ray: usize| {
            // The middle one of three: a single ray may pass a hollow or a hole.
            let mut three = [RAYS - 1, 0, 1].map(|by| lengths[(ray + by) % RAYS]);
            three.sort_by(f64::total_cmp);
            self.nipple + DVec2::from_angle(TAU * ray as f64 / RAYS as f64) * three[1]
        };
        (0..RAYS).map(ray).collect()
    }
}
