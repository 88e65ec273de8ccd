//! What a map has between and beside its points: values between points, lines of equal volume, typical sizes.

use super::contour::Path;
use super::map::{Map, PointStatus};
use super::map_levels::round_levels;
use super::parameter::with_values;
use super::{Parameter, Quantity};
use crate::clinical::{Dimension, Size, typical_sizes};
use crate::measure::STRAIN_BANDS;
use crate::scene::{Field, Implant};

impl Map {
    /// The interpolated value of a point that is not solved, and its error.
    #[must_use]
    pub fn interpolated(&self, quantity: Quantity, i: usize, j: usize) -> Option<(f64, f64)> {
        let (columns, rows) = self.shape();
        let is_open = i < columns && j < rows && self.case(i, j).is_none();
        let of = |quantity| self.sample.of(quantity, j * columns + i).filter(|_| is_open);
        let [value, error, _] = of(quantity)?;
        let [low, high, _] = STRAIN_BANDS;
        // No skin is stretched above a strain that the greatest one does not reach, and no more than all of it.
        let area_over = |limit| match of(Quantity::GreatestStrain) {
            Some([strain, error, _]) if strain + error < limit => (0.0, 0.0),
            _ => (value, error.min(1.0)),
        };
        // The greatest pressure is no less than the mean, the least cover no more than that over the apex.
        let at_least = |other| match of(other) {
            Some([least, of_least, _]) if value < least => (least, error.max(of_least)),
            _ => (value, error),
        };
        Some(match quantity {
            Quantity::AreaOver25 => area_over(low),
            Quantity::AreaOver50 => area_over(high),
            Quantity::GreatestPressureKpa => at_least(Quantity::MeanPressureKpa),
            Quantity::GreatestPressureMmhg => at_least(Quantity::MeanPressureMmhg),
            Quantity::ApexCoverMm => at_least(Quantity::LeastCoverMm),
            // No tissue changes the volume.
            Quantity::ImplantVolumeMl => match self.implant_volume_ml(i, j) {
                Some(volume) => (volume, 0.0),
                None => (value, error),
            },
            _ => (value, error),
        })
    }

    /// The volume of the implant of a point \[ml\].
    fn implant_volume_ml(&self, i: usize, j: usize) -> Option<f64> {
        let implant = with_values(self.base(), &self.values_at(i, j)).ok()?.implant;
        Some(implant.size().ok()?.volume_ml())
    }

    /// The value to display at a point, and whether the value is known: solved, or interpolated with a small error. The value of a
    /// waiting point of a map that is solved as a whole is interpolated between the corners of the finest lattice around the point that
    /// is solved; a point that ended without convergence has no value, and no value is interpolated from such a point.
    #[must_use]
    pub fn displayed(&self, quantity: Quantity, i: usize, j: usize) -> Option<(f64, bool)> {
        if let Some((value, _)) = self.interpolated(quantity, i, j) {
            return Some((value, self.is_known(quantity, i, j)));
        }
        if self.status(i, j) != PointStatus::Waiting {
            return self.value(quantity, i, j).map(|value| (value, true));
        }
        let (columns, rows) = self.shape();
        if i >= columns || j >= rows {
            return None;
        }
        let mut step = 2;
        while step < 2 * columns.max(rows) {
            // Neighbours on the lattice and the part of the way between the two.
            let around = |k: usize, count: usize| {
                let low = if k == count - 1 { k } else { k / step * step };
                let high = if k.is_multiple_of(step) { low } else { (low + step).min(count - 1) };
                let part = if high > low { (k - low) as f64 / (high - low) as f64 } else { 0.0 };
                (low, high, part)
            };
            let ((left, right, u), (bottom, top, v)) = (around(i, columns), around(j, rows));
            let row = |j: usize| {
                let [a, b] = [left, right].map(|i| self.value(quantity, i, j));
                Some(a? * (1.0 - u) + b? * u)
            };
            if let (Some(low), Some(high)) = (row(bottom), row(top)) {
                return Some((low * (1.0 - v) + high * v, false));
            }
            step *= 2;
        }
        None
    }

    /// The value between points, by two lines; `None` off the map and beside a point without a value.
    #[must_use]
    pub fn between(&self, quantity: Quantity, x: f64, y: f64) -> Option<f64> {
        let low = |k: usize, value: f64| {
            let axis = self.axes.get(k)?;
            let last = (axis.count - 1) as f64;
            let position = (value - axis.from) / (axis.to - axis.from) * last;
            let low = position.floor().min(last - 1.0);
            (-1e-9..=last + 1e-9).contains(&position).then(|| {
                let low = low.max(0.0);
                (low as usize, position - low)
            })
        };
        let (i, u) = low(0, x)?;
        let (j, v) = if self.axes.len() == 1 { (0, 0.0) } else { low(1, y)? };
        let corners = [(0, 0), (1, 0), (0, 1), (1, 1)].map(|(a, b)| {
            let weight = (if a == 0 { 1.0 - u } else { u }) * (if b == 0 { 1.0 - v } else { v });
            (weight, i + a, j + b)
        });
        // A corner without weight need not have a value.
        let corners = corners.into_iter().filter(|(weight, ..)| *weight > 1e-9);
        corners.map(|(weight, i, j)| Some(weight * self.displayed(quantity, i, j)?.0)).sum()
    }

    /// On a map over width and projection: the factor from x to the base width, else `None`.
    fn widths(&self) -> Option<f64> {
        match &self.axes[..] {
            [x, y] if y.field == Parameter::of(Field::Projection) => match x.field {
                Parameter::BaseWidth => Some(1.0),
                Parameter::Number(Field::BaseRadius, _) => Some(2.0),
                _ => None,
            },
            _ => None,
        }
    }

    /// Lines of equal volume of the implant on a map over width (x) and projection (y): volume \[ml\] and points.
    #[must_use]
    pub fn equal_volumes(&self) -> Vec<(f64, Path)> {
        const POINTS: usize = 101;
        let (Some(factor), [x, y]) = (self.widths(), &self.axes[..]) else { return Vec::new() };
        let (low, high) = (y.from.min(y.to), y.from.max(y.to));
        let size = |x: f64, projection_mm: f64| {
            let mut implant = Implant { projection_mm, ..self.base().implant };
            implant.set_base_radius(0.5 * factor * x);
            implant.size().ok()
        };
        let volume = |x: f64, y: f64| size(x, y).map_or(f64::NAN, Size::volume_ml);
        let least = volume(x.from.min(x.to), low);
        let most = volume(x.from.max(x.to), high);
        let line = |volume: f64| -> Path {
            let xs = (0..POINTS).map(|k| x.from + (x.to - x.from) * k as f64 / (POINTS - 1) as f64);
            let of = |x: f64| {
                let size = size(x, low)?.changed(Dimension::Volume, volume, Dimension::BaseWidth);
                Some((x, size.ok()?.projection_mm()))
            };
            xs.filter_map(of).filter(|(_, y)| (low..=high).contains(y)).collect()
        };
        let lines =
            round_levels(least, most, 12.0).into_iter().map(|volume| (volume, line(volume)));
        lines.filter(|(_, path)| path.len() > 1).collect()
    }

    /// Typical round sizes on a map of round implants over width and projection, as (x, y).
    #[must_use]
    pub fn typical_sizes(&self) -> Vec<(f64, f64)> {
        let (Some(factor), [x, y]) = (self.widths(), &self.axes[..]) else { return Vec::new() };
        let at = |size: Size| (size.base_width_mm() / factor, size.projection_mm());
        let sizes = typical_sizes().into_iter().filter(|_| self.base().implant.is_round()).map(at);
        sizes.filter(|(a, b)| x.contains(*a) && y.contains(*b)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study::{Axis, Cases, MapSettings, Study, evaluate};

    #[test]
    fn a_value_between_points_lies_on_the_lines_between_them() {
        let axes = ["base_width_mm=100:120:3", "projection_mm=30:40:3"];
        let axes = axes.map(|axis| Axis::parse(axis).unwrap());
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        let mut map = Map::new(&Scene::sheet(), &axes, settings).unwrap();
        let mut store = Cases::default();
        let quantity = Quantity::ImplantVolumeMl;
        assert_eq!(map.between(quantity, 110.0, 35.0), None);
        while let Some((index, job)) = map.next_job(&mut store) {
            map.receive(index, evaluate(&job), &mut store);
        }
        let value = |i, j| map.value(quantity, i, j).unwrap();
        for (x, y, expected) in [
            (100.0, 30.0, value(0, 0)),
            (120.0, 40.0, value(2, 2)),
            (105.0, 30.0, 0.5 * (value(0, 0) + value(1, 0))),
            (115.0, 37.5, 0.25 * (value(1, 1) + value(2, 1) + value(1, 2) + value(2, 2))),
        ] {
            let found = map.between(quantity, x, y).unwrap();
            assert!((found - expected).abs() < 1e-6 * expected, "{x} {y}: {found} {expected}");
        }
        assert_eq!(map.between(quantity, 121.0, 35.0), None);
    }
}
