//! Limits, levels and contour lines of a map.

use super::contour::{Field, Path};
use super::{Map, Quantity};
use crate::measure::bands::{Limits, SkinLimits};

/// What judges the strain of the skins of a map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Skin {
    /// All skins have these limits.
    Same(SkinLimits),
    /// The skins of the points turn steep at different strains.
    Different,
}

impl Map {
    /// All values row by row, shape (rows, columns); not a number where a point has not converged.
    pub(super) fn field(&self, quantity: Quantity) -> Vec<f64> {
        let (columns, rows) = self.shape();
        let points = (0..rows).flat_map(|j| (0..columns).map(move |i| (i, j)));
        points.map(|(i, j)| self.value(quantity, i, j).unwrap_or(f64::NAN)).collect()
    }

    /// The contour lines of a value on a map of two axes, as polylines of (x, y) in the units of the axes. Lines end at
    /// points that have not converged.
    #[must_use]
    pub fn contours(&self, quantity: Quantity, level: f64) -> Vec<Path> {
        self.lines(self.field(quantity), level)
    }

    /// The contour lines of values row by row.
    pub(super) fn lines(&self, mut values: Vec<f64>, level: f64) -> Vec<Path> {
        let [x, y] = &self.axes[..] else { return Vec::new() };
        let (mut xs, mut ys) = (x.values(), y.values());
        // The grid of the contours has rising axes.
        if x.to < x.from {
            xs.reverse();
            values.chunks_mut(x.count).for_each(<[f64]>::reverse);
        }
        if y.to < y.from {
            ys.reverse();
            values = values.chunks(x.count).rev().flatten().copied().collect();
        }
        Field { x: &xs, y: &ys, values: &values }.lines(level)
    }

    /// The limits of a quantity with words and sources, and the factor from a value to the unit of the limits. The strain has
    /// none where the skins of the points turn steep at different strains.
    #[must_use]
    pub fn limits(&self, quantity: Quantity) -> Option<(Limits, f64)> {
        match (quantity, self.skin) {
            (Quantity::GreatestStrain, Skin::Different) => None,
            (_, Skin::Different) => quantity.limits(SkinLimits::Tearing),
            (_, Skin::Same(skin)) => quantity.limits(skin),
        }
    }

    /// The limits of a quantity \[unit of the quantity\]; empty without any.
    #[must_use]
    pub fn limit_values(&self, quantity: Quantity) -> Vec<f64> {
        let Some((limits, factor)) = self.limits(quantity) else { return Vec::new() };
        limits.bands.iter().filter_map(|band| Some(band.limit? / factor)).collect()
    }

    /// The levels of the contour lines \[unit of the quantity\]: its limits, or round numbers within its range on this map.
    #[must_use]
    pub fn levels(&self, quantity: Quantity) -> Vec<f64> {
        let limits = self.limit_values(quantity);
        if !limits.is_empty() {
            return limits;
        }
        let (factor, _) = quantity.display();
        match self.range(quantity) {
            Some((least, most)) => {
                let levels = round_levels(least * factor, most * factor, 6.0);
                levels.into_iter().map(|level| level / factor).collect()
            }
            None => Vec::new(),
        }
    }
}

/// Up to so many round numbers within a range: 1, 2 or 5 times a power of ten apart.
pub(super) fn round_levels(least: f64, most: f64, count: f64) -> Vec<f64> {
    if !(least.is_finite() && most > least) {
        return Vec::new();
    }
    let coarse = (most - least) / count;
    let power = 10f64.powi(coarse.log10().floor() as i32);
    let step =
        power * [1.0, 2.0, 5.0, 10.0].into_iter().find(|f| f * power >= coarse).unwrap_or(10.0);
    let (first, last) = ((least / step).ceil() as i64, (most / step).floor() as i64);
    (first..=last).map(|k| k as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study::{Axis, MapSettings};

    #[test]
    fn the_strain_has_the_limits_of_the_skin_unless_the_skin_differs_from_point_to_point() {
        let scene = Scene::opening();
        let limits = |axis: &str, scene: &Scene| {
            let axis = Axis::parse(axis).unwrap();
            let map = Map::new(scene, &[axis], MapSettings::default()).unwrap();
            map.limit_values(Quantity::GreatestStrain)
        };
        // 80 and 100 % of the strain at which the curve turns steep.
        let knee = scene.skin_knee().unwrap();
        let of_width = limits("base_width_mm=100:140:3", &scene);
        for (limit, share) in of_width.iter().zip([0.8, 1.0]) {
            assert!((limit - share * knee).abs() < 1e-12, "{of_width:?}");
        }
        let mut lax = scene.clone();
        lax.layers[0].curve.strain_scale *= 2.0;
        let of_lax = limits("base_width_mm=100:140:3", &lax);
        assert!((of_lax[1] - 2.0 * of_width[1]).abs() < 1e-6, "{of_lax:?}");
        assert!(limits("strain_scale=0.5:2:3", &scene).is_empty());
        // A sheet has no reserve.
        assert_eq!(limits("strain_scale=0.5:2:3", &Scene::sheet()), [0.25, 0.5, 0.54]);
    }
}
