//! The choices of a map, as JavaScript and Python have them.

use super::{Axis, Map, MapError, MapSettings, Quantity};
use crate::curve::given;
use crate::scene::Scene;
use schemars::JsonSchema;
use serde::Deserialize;

/// The choices of a map besides its scene, as the JavaScript API and the Python module have them.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct MapOptions {
    /// The first axis.
    pub x: Axis,
    /// The second axis, if the map has one.
    #[serde(default, deserialize_with = "given")]
    #[schemars(with = "Axis")]
    pub y: Option<Axis>,
    /// Grid and tolerance.
    #[serde(default)]
    pub grid: MapSettings,
    /// The quantity of the contour lines. Default: the greatest strain.
    #[serde(default = "greatest_strain")]
    pub show: Quantity,
    /// Is every point solved? Else those where the quantities bend, and the others are interpolated.
    #[serde(default)]
    pub all: bool,
}

fn greatest_strain() -> Quantity {
    Quantity::GreatestStrain
}

impl MapOptions {
    /// The map around a scene.
    ///
    /// # Errors
    /// As [`Map::new`].
    pub fn map(&self, scene: &Scene) -> Result<Map, MapError> {
        let axes: Vec<Axis> = [Some(self.x), self.y].into_iter().flatten().collect();
        let map = Map::new(scene, &axes, self.grid)?;
        Ok(if self.all { map } else { map.sampled() })
    }
}
