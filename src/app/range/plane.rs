//! The plane of a chart: values to points of the screen and back, round marks of the axes.

use eframe::egui::{Pos2, Rect, pos2, remap};

/// A rectangle of the screen with a range along each axis; y rises upwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    pub(super) rect: Rect,
    /// First and last value across.
    pub(super) x: (f64, f64),
    /// First and last value up.
    pub(super) y: (f64, f64),
}

impl Plane {
    /// The point of two values.
    pub(super) fn at(&self, (x, y): (f64, f64)) -> Pos2 {
        let part = |value: f64, (from, to): (f64, f64)| ((value - from) / (to - from)) as f32;
        pos2(
            self.rect.left() + self.rect.width() * part(x, self.x),
            self.rect.bottom() - self.rect.height() * part(y, self.y),
        )
    }

    /// The values of a point.
    pub(super) fn values(&self, point: Pos2) -> (f64, f64) {
        let value = |at: f32, range: (f32, f32), (from, to): (f64, f64)| {
            from + (to - from) * f64::from(remap(at, range.0..=range.1, 0.0..=1.0))
        };
        (
            value(point.x, (self.rect.left(), self.rect.right()), self.x),
            value(point.y, (self.rect.bottom(), self.rect.top()), self.y),
        )
    }
}

/// Index of the value of an axis of `count` equal steps that is nearest to a value.
pub(super) fn nearest(value: f64, (from, to): (f64, f64), count: usize) -> usize {
    let last = count.saturating_sub(1);
    let position = (value - from) / (to - from) * last as f64;
    (position.round().max(0.0) as usize).min(last)
}

/// Round numbers within a range, at most `most`: 1, 2 or 5 times a power of ten apart.
pub(crate) fn marks((from, to): (f64, f64), most: usize) -> Vec<f64> {
    let (least, greatest) = (from.min(to), from.max(to));
    let coarse = (greatest - least) / most.max(1) as f64;
    if !(coarse.is_finite() && coarse > 0.0) {
        return Vec::new();
    }
    let power = 10f64.powf(coarse.log10().floor());
    let step =
        [1.0, 2.0, 5.0, 10.0].map(|f| f * power).into_iter().find(|s| *s >= coarse * (1.0 - 1e-9));
    let step = step.unwrap_or(10.0 * power);
    // The ends count although they are rounded.
    let (first, last) =
        ((least / step - 1e-6).ceil() as i64, (greatest / step + 1e-6).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::vec2;

    #[test]
    fn values_and_points_of_the_screen_map_to_each_other() {
        let rect = Rect::from_min_size(pos2(100.0, 50.0), vec2(300.0, 200.0));
        let plane = Plane { rect, x: (78.0, 180.0), y: (20.0, 75.0) };
        assert_eq!(plane.at((78.0, 20.0)), rect.left_bottom());
        assert_eq!(plane.at((180.0, 75.0)), rect.right_top());
        for values in [(78.0, 20.0), (129.0, 47.5), (120.0, 40.0), (180.0, 75.0)] {
            let (x, y) = plane.values(plane.at(values));
            assert!((x - values.0).abs() < 1e-4 && (y - values.1).abs() < 1e-4, "{x} {y}");
        }
        // A falling axis.
        let plane = Plane { x: (180.0, 78.0), ..plane };
        assert_eq!(plane.at((180.0, 75.0)), rect.left_top());
    }

    #[test]
    fn the_nearest_point_is_within_half_a_step_and_on_the_axis() {
        let range = (78.0, 180.0);
        assert_eq!(nearest(120.0, range, 18), 7);
        assert_eq!([80.9, 81.1].map(|value| nearest(value, range, 18)), [0, 1]);
        assert_eq!([0.0, 500.0].map(|value| nearest(value, range, 18)), [0, 17]);
        assert_eq!(nearest(1.0, (5.0, 1.0), 5), 4);
    }

    #[test]
    fn marks_are_round_and_few() {
        assert_eq!(marks((7.8, 18.0), 6), [8.0, 10.0, 12.0, 14.0, 16.0, 18.0]);
        assert_eq!(marks((0.0, 1.0), 5).len(), 6);
        assert!(marks((3.0, 3.0), 5).is_empty() && marks((f64::NAN, 1.0), 5).is_empty());
        for most in 2..9 {
            assert!(marks((0.013, 7.77), most).len() <= most + 1);
        }
    }
}
