//! Numbers on a grid in a scene: form in a file and checks.

use super::{SceneError, out_of_range};
use crate::curve::{List, number};
use glam::DVec2;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::sync::Arc;

/// Numbers a side.
pub(super) const COUNTS: (usize, usize) = (4, 257);
/// Distances of neighbouring numbers \[mm\].
const SPACING_MM: (f64, f64) = (0.5, 50.0);
/// Most numbers of a grid.
const MOST: usize = COUNTS.1 * COUNTS.1;

/// A grid in a scene.
pub(super) struct Form {
    /// The path of the grid.
    pub(super) path: &'static str,
    /// The member with the numbers.
    pub(super) values: &'static str,
    pub(super) spacing_mm: f64,
}

impl Form {
    /// Checks spacing, numbers a side, and numbers with a unit, of which some may be absent.
    pub(super) fn check<T: Copy + Into<Option<f64>>>(
        &self,
        counts: [usize; 2],
        values: &[T],
        (least, most): (f64, f64),
        unit: &str,
    ) -> Result<(), SceneError> {
        let path = |member: &str| format!("{}.{member}", self.path);
        if !(SPACING_MM.0..=SPACING_MM.1).contains(&self.spacing_mm) {
            let allowed = format!("{} to {} mm", SPACING_MM.0, SPACING_MM.1);
            return Err(out_of_range(&path("spacing_mm"), number(self.spacing_mm), &allowed));
        }
        for (member, count) in ["columns", "rows"].into_iter().zip(counts) {
            if !(COUNTS.0..=COUNTS.1).contains(&count) {
                let allowed = format!("{} to {}", COUNTS.0, COUNTS.1);
                return Err(out_of_range(&path(member), count.to_string(), &allowed));
            }
        }
        let expected = counts[0] * counts[1];
        if values.len() != expected {
            let value = format!("a list of {}", values.len());
            let allowed = format!("{expected} numbers, columns times rows");
            return Err(out_of_range(&path(self.values), value, &allowed));
        }
        let known = values.iter().enumerate().filter_map(|(k, value)| Some((k, (*value).into()?)));
        match known.into_iter().find(|(_, value)| !(least..=most).contains(value)) {
            Some((k, value)) => {
                let member = format!("{}[{k}]", self.values);
                let allowed = format!("{} to {} {unit}", number(least), number(most));
                Err(out_of_range(&path(&member), number(value), allowed.trim_end()))
            }
            None => Ok(()),
        }
    }

    /// Checks that a grid reaches as far as needed along x and y \[mm\]; one spacing more is continued.
    pub(super) fn check_reach(
        &self,
        counts: [usize; 2],
        needed: [f64; 2],
    ) -> Result<(), SceneError> {
        for (axis, side) in ["wide", "high"].into_iter().enumerate() {
            let has = (counts[axis] - 1) as f64 * self.spacing_mm;
            let least = 2.0 * (needed[axis] - self.spacing_mm);
            if has < least {
                let value = format!("{} mm {side}", number(has));
                let least = number((10.0 * least).ceil() / 10.0);
                let allowed = format!("{least} mm or more, the simulated tissue");
                return Err(out_of_range(self.path, value, &allowed));
            }
        }
        Ok(())
    }
}

pub(super) fn written<S: Serializer, T: Serialize>(
    values: &Arc<[T]>,
    to: S,
) -> Result<S::Ok, S::Error> {
    values.as_ref().serialize(to)
}

pub(super) fn read<'de, D: Deserializer<'de>, T: Deserialize<'de>>(
    reader: D,
) -> Result<Arc<[T]>, D::Error> {
    List::<T, MOST>::deserialize(reader).map(|list| list.0.into())
}

/// Place of a node of a grid of columns and rows about its middle \[mm\].
pub(super) fn place(k: usize, [columns, rows]: [usize; 2], spacing_mm: f64) -> DVec2 {
    let at = DVec2::new((k % columns) as f64, (k / columns) as f64);
    (at - 0.5 * DVec2::new((columns - 1) as f64, (rows - 1) as f64)) * spacing_mm
}
