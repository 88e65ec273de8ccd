//! The axes of a map, and the errors of a map.

use super::parameter::Parameter;
use super::quantity::short;
use crate::curve::{number, whole, whole_of};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Greatest number of points of a map.
pub const MAX_POINTS: usize = 3600;

/// A varied number of a scene: equal steps from `from` to `to`, both included.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Axis {
    /// The number.
    pub field: Parameter,
    /// First value \[unit of the field\].
    pub from: f64,
    /// Last value \[unit of the field\].
    pub to: f64,
    /// Number of values, 2 or more.
    #[serde(deserialize_with = "whole")]
    pub count: usize,
}

/// Error of a map, in one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MapError {
    /// An axis is not `FIELD=FROM:TO:COUNT`.
    #[error("{0:?} is no axis; allowed: FIELD=FROM:TO:COUNT, as base_width_mm=90:140:20")]
    Format(String),
    /// The field of an axis is unknown.
    #[error("{0}")]
    Field(String),
    /// A map has one axis or two.
    #[error("a map of {0} axes; allowed: 1 or 2")]
    Axes(usize),
    /// An end of an axis is not finite, or both ends are equal.
    #[error("{field} from {} to {}; allowed: two different numbers", number(*from), number(*to))]
    Range {
        /// The field.
        field: String,
        /// First value.
        from: f64,
        /// Last value.
        to: f64,
    },
    /// The number of values of an axis is out of its range.
    #[error("{field}: count is {count}; allowed: 2 to {MAX_POINTS}")]
    Count {
        /// The field.
        field: String,
        /// Number of values.
        count: String,
    },
    /// The map has too many points.
    #[error("a map of {0} points; allowed: up to {MAX_POINTS}")]
    TooMany(u128),
    /// Both axes set the same field.
    #[error("{0} and {1} set the same field; allowed: two fields")]
    Same(String, String),
    /// All points at one end of an axis are out of the limits of a scene.
    #[error("{field} = {}: {error}", number(*value))]
    End {
        /// The field.
        field: String,
        /// The value at this end.
        value: f64,
        /// Why the scenes are invalid.
        error: String,
    },
    /// The grid or the tolerance is out of its range.
    #[error("{0}")]
    Settings(String),
}

impl Axis {
    /// Does a value lie between the ends?
    pub(super) fn contains(&self, value: f64) -> bool {
        (self.from.min(self.to)..=self.from.max(self.to)).contains(&value)
    }

    /// Reads `FIELD=FROM:TO:COUNT`.
    ///
    /// # Errors
    /// One line with the part that is wrong and the allowed values.
    pub fn parse(text: &str) -> Result<Self, MapError> {
        let format = || MapError::Format(short(text));
        let (field, range) = text.split_once('=').ok_or_else(format)?;
        let parts: Vec<&str> = range.split(':').collect();
        let [from, to, count] = parts[..] else { return Err(format()) };
        let field = Parameter::of_name(field.trim()).map_err(MapError::Field)?;
        let end = |text: &str| text.trim().parse::<f64>().map_err(|_| format());
        let (from, to, count) = (end(from)?, end(to)?, count.trim());
        // 20.0 is a whole number, as in JSON.
        let whole = count.parse().ok().or_else(|| {
            let whole = count.parse().ok().and_then(whole_of);
            whole.and_then(|count| usize::try_from(count).ok())
        });
        let count =
            whole.ok_or_else(|| MapError::Count { field: field.name(), count: short(count) })?;
        Ok(Self { field, from, to, count })
    }

    /// The value of an index below `count`.
    #[must_use]
    pub fn value(&self, index: usize) -> f64 {
        let last = self.count.saturating_sub(1).max(1);
        match index {
            0 => self.from,
            index if index >= last => self.to,
            index => self.from + (self.to - self.from) * (index as f64 / last as f64),
        }
    }

    /// All values.
    #[must_use]
    pub fn values(&self) -> Vec<f64> {
        (0..self.count).map(|k| self.value(k)).collect()
    }

    pub(super) fn check(&self) -> Result<(), MapError> {
        let &Self { field, from, to, count } = self;
        let field = field.name();
        if !(from.is_finite() && to.is_finite() && (to - from).abs() > 0.0) {
            return Err(MapError::Range { field, from, to });
        }
        if !(2..=MAX_POINTS).contains(&count) {
            return Err(MapError::Count { field, count: count.to_string() });
        }
        Ok(())
    }
}
