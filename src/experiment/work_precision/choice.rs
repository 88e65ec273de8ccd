//! A plan as JSON text.

use super::{Case, Method, Plan};
use crate::mesh;
use crate::scene::{self, SceneError, limits};
use serde::Deserialize;

/// What is wanted; what is left out is as in the full plan, or in the quick one.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Choice {
    quick: bool,
    cases: Option<Vec<Case>>,
    nodes_per_side: Option<Vec<usize>>,
    methods: Option<Vec<Method>>,
}

impl Plan {
    /// A plan from JSON text: an object of `quick` (true or false) and of lists, `cases`,
    /// `nodes_per_side` and `methods`, that take the place of the quick or the full plan's. Numbers of
    /// nodes are rounded to those that a sheet has (see [`crate::mesh::rounded_nodes_per_side`]);
    /// what a list repeats counts once.
    ///
    /// # Errors
    /// One line that names the field, what is wrong and what is allowed.
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

/// The first of each in a list that must not be empty.
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
