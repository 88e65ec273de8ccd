//! The check of a map: some of its points on a finer grid.

use super::map::{CHECK, Map};
use super::queue::{Queue, Queued};
use super::{Each, Quantity};
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::Serialize;

impl Map {
    /// A study of the points that check this map: first, middle and last value of each axis of a map of two axes, nine
    /// values of a map of one axis; on the grid [`CHECK`]. `None` if the map's own grid is as fine.
    #[must_use]
    pub fn check(&self) -> Option<MapCheck> {
        if self.settings.nodes_per_side >= CHECK.nodes_per_side {
            return None;
        }
        let (columns, rows) = self.shape();
        let spaced = |count: usize, parts: usize| {
            let mut picked: Vec<usize> = (0..=parts).map(|k| k * (count - 1) / parts).collect();
            picked.dedup();
            picked
        };
        let parts = if self.axes.len() == 1 { 8 } else { 2 };
        let (is, js) = (spaced(columns, parts), spaced(rows, parts));
        let points: Vec<(usize, usize)> =
            is.iter().flat_map(|&i| js.iter().map(move |&j| (i, j))).collect();
        let scenes = points.iter().map(|&(i, j)| self.scene_with(i, j, CHECK)).collect();
        Some(MapCheck { points, each: Each::new(scenes) })
    }

    /// The greatest difference of each quantity between this map and its solved check.
    #[must_use]
    pub fn differences(&self, check: &MapCheck) -> Vec<Difference> {
        let of = |quantity: Quantity| {
            let pairs = check.points.iter().enumerate().filter_map(|(k, &(i, j))| {
                let fine = check.each.case(k).filter(|case| case.is_converged())?;
                let (map, fine) = (self.value(quantity, i, j)?, fine.values.get(quantity)?);
                let at = self.axes.iter().zip([i, j]).map(|(axis, k)| axis.value(k)).collect();
                Some(Difference { quantity, difference: (map - fine).abs(), map, fine, at })
            });
            pairs.max_by(|a, b| a.difference.total_cmp(&b.difference))
        };
        Quantity::ALL.into_iter().filter_map(of).collect()
    }
}

/// The points that check a map, solved on a finer grid.
#[derive(Debug)]
pub struct MapCheck {
    points: Vec<(usize, usize)>,
    each: Each,
}

impl MapCheck {
    /// Number of points, and of those that converged.
    #[must_use]
    pub fn counts(&self) -> (usize, usize) {
        let converged =
            self.each.queue().cases().iter().flatten().filter(|case| case.is_converged());
        (self.points.len(), converged.count())
    }
}

impl Queued for MapCheck {
    fn queue(&self) -> &Queue {
        self.each.queue()
    }

    fn queue_mut(&mut self) -> &mut Queue {
        self.each.queue_mut()
    }

    fn scene_of(&self, item: usize) -> Result<Scene, String> {
        self.each.scene_of(item)
    }
}

/// The greatest difference of a quantity between a map and the check of its points.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Difference {
    /// The quantity.
    pub quantity: Quantity,
    /// |map − fine| \[unit of the quantity\].
    pub difference: f64,
    /// Value of the map.
    pub map: f64,
    /// Value on the finer grid.
    pub fine: f64,
    /// Values of the axes at this point.
    pub at: Vec<f64>,
}
