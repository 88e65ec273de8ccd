//! Rows of the study and their CSV table.

use super::{Case, Method};
use crate::tension::springs_name;
use implant_preview_core::springs::Springs;
use serde::Serialize;
use std::fmt::Write;

/// Error of a method after a run time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// The spring law (coupled springs).
    pub springs: Springs,
    /// The scene.
    pub scene: Case,
    /// Nodes per side.
    pub nodes_per_side: usize,
    /// Work in evaluations of all nodal forces on the finest grid.
    pub work_units: f64,
    /// Time from a cold start \[ms\].
    pub time_ms: f64,
    /// Greatest distance of a node from the grid's own equilibrium \[fraction of the dome's base radius\].
    pub error_vs_own_grid: f64,
    /// Greatest distance of a node from the axisymmetric reference \[fraction of the dome's base radius\];
    /// `None` without a reference.
    pub error_vs_reference: Option<f64>,
    /// Greatest distance of a node of the inner face of layered tissue from the axisymmetric reference \[fraction of the
    /// dome's base radius\]; `None` without a reference and for a sheet. Of layered tissue
    /// [`Self::error_vs_reference`] is the skin's error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub inner_error_vs_reference: Option<f64>,
    /// State of the method.
    pub status: Status,
}

/// State of a method at a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// The method ended by its own criterion, or after its number of cycles.
    Finished,
    /// The method exceeded the time budget.
    Budget,
    /// The method ended without a solution.
    Failed,
}

impl Status {
    /// Name of the state in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Budget => "budget",
            Self::Failed => "failed",
        }
    }
}

/// Writes the rows as CSV with a line of column names; a missing error is an empty field. Rows of layered tissue add the
/// column `inner_error_vs_reference`.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    let has_layers = rows.iter().any(|row| row.scene.is_layered());
    let inner = if has_layers { "inner_error_vs_reference," } else { "" };
    let mut csv = format!(
        "method,springs,scene,nodes_per_side,work_units,time_ms,\
         error_vs_own_grid,error_vs_reference,{inner}status\n"
    );
    for row in rows {
        let field = |error: Option<f64>| error.map(|e| format!("{e:.4e}")).unwrap_or_default();
        let mut reference = field(row.error_vs_reference);
        if has_layers {
            reference = format!("{reference},{}", field(row.inner_error_vs_reference));
        }
        // Writing to a String cannot fail.
        let _ = writeln!(
            csv,
            "{},{},{},{},{:.2},{:.4},{:.4e},{reference},{}",
            row.method.name(),
            springs_name(row.springs),
            row.scene.name(),
            row.nodes_per_side,
            row.work_units,
            row.time_ms,
            row.error_vs_own_grid,
            row.status.name()
        );
    }
    csv
}

/// Time after which a method stays within an error against the grid's own equilibrium \[ms\], from the
/// method's rows of one scene and grid in the order of time; `None` if the last row exceeds the error.
#[must_use]
pub fn time_to(rows: &[Row], error: f64) -> Option<f64> {
    let within = rows.iter().rev().take_while(|row| row.error_vs_own_grid <= error);
    within.last().map(|row| row.time_ms)
}
