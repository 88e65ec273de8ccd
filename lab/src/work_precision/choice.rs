//! Plan from JSON text.

use super::{Case, Method, Plan};
use implant_preview_core::mesh;
use implant_preview_core::scene::{self, SceneError, limits};
use serde::Deserialize;

/// Options of a plan; missing lists are those of the full or the quick plan.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    quick: bool,
    cases: Option<Vec<Case>>,
    nodes_per_side: Option<Vec<usize>>,
    methods: Option<Vec<Method>>,
}

impl Plan {
    /// Reads a plan from JSON text: an object with `quick` (true or false) and the lists `cases`,
    /// `nodes_per_side` and `methods`, which replace the lists of the quick or the full plan. Numbers of
    /// nodes are rounded to valid numbers (see [`implant_preview_core::mesh::rounded_nodes_per_side`]); duplicates are
    /// removed.
    ///
    /// # Errors
    /// One line with the field, the error and the allowed range.
    pub fn from_json(json: &str) -> Result<Self, SceneError> {
        let choice: Choice = scene::read::json(json, "options")?;
        let mut plan = if choice.quick { Self::quick() } else { Self::full() };
        if let Some(cases) = choice.cases {
            plan.cases = distinct("cases", cases)?;
        }
        if let Some(methods) = choice.methods {
            plan.methods = distinct("methods", methods)?;
        }
        if let Some(grids) = choice.nodes_per_side {
            let (least, most) = limits::NODES_PER_SIDE;
            for (k, nodes) in grids.iter().enumerate() {
                if !(least..=most).contains(nodes) {
                    return Err(SceneError::OutOfRange {
                        field: format!("nodes_per_side[{k}]"),
                        value: nodes.to_string(),
                        allowed: format!("{least} to {most}"),
                    });
                }
            }
            let grids = grids.into_iter().map(mesh::rounded_nodes_per_side).collect();
            plan.nodes_per_side = distinct("nodes_per_side", grids)?;
            plan.nodes_per_side.sort_unstable();
        }
        Ok(plan)
    }
}

/// Removes duplicates from a list; an empty list is an error.
fn distinct<T: PartialEq>(field: &str, list: Vec<T>) -> Result<Vec<T>, SceneError> {
    let mut kept = Vec::new();
    for item in list {
        if !kept.contains(&item) {
            kept.push(item);
        }
    }
    if kept.is_empty() {
        return Err(SceneError::OutOfRange {
            field: field.to_owned(),
            value: "an empty list".to_owned(),
            allowed: "one entry or more".to_owned(),
        });
    }
    Ok(kept)
}
