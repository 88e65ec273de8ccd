//! The rows of the study, and their table.

use super::{Case, Method};
use crate::springs::Springs;
use serde::Serialize;
use std::fmt::Write;

/// A method's error after some time.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The method.
    pub method: Method,
    /// The spring law: the coupled springs, which have an equilibrium in every scene.
    pub springs: Springs,
    /// The scene.
    pub scene: Case,
    /// Nodes a side.
    pub nodes_per_side: usize,
    /// Work in evaluations of all nodal forces on the finest grid.
    pub work_units: f64,
    /// Time from a cold start \[ms\].
    pub time_ms: f64,
    /// Greatest distance of a node from where the grid's own equilibrium has it
    /// \[share of the dome's base radius\].
    pub error_vs_own_grid: f64,
    /// The same from the axisymmetric reference; `None` where there is none.
    pub error_vs_reference: Option<f64>,
    /// Where on its way the method is.
    pub status: Status,
}

/// Where on its way a method is at a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Status {
    /// It goes on; the method gives no sign that it might stop here.
    Running,
    /// It has ended: by its own rule, after all its steps, or (a baseline) below [`super::GOAL`].
    Finished,
    /// The time allowed was over before its end.
    Budget,
    /// It ended without an answer.
    Failed,
}

impl Status {
    /// Its name in the table.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Running => "running",
            Self::Finished => "finished",
            Self::Budget => "budget",
            Self::Failed => "failed",
        }
    }
}

/// The rows as CSV, with a line of column names; a missing error is an empty field.
#[must_use]
pub fn table(rows: &[Row]) -> String {
    let mut csv = "method,springs,scene,nodes_per_side,work_units,time_ms,\
                   error_vs_own_grid,error_vs_reference,status\n"
        .to_owned();
    for row in rows {
        let springs = match row.springs {
            Springs::Coupled => "coupled",
            Springs::Nikolaev => "nikolaev",
        };
        let reference = row.error_vs_reference.map(|e| format!("{e:.4e}")).unwrap_or_default();
        // Writing to a String cannot fail.
        let _ = writeln!(
            csv,
            "{},{springs},{},{},{:.2},{:.4},{:.4e},{reference},{}",
            row.method.name(),
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

/// The time \[ms\] from which on a method stays below an error against its own grid, given its rows of
/// one scene and grid, in the order of time; `None` if it does not get there.
#[must_use]
pub fn time_to(rows: &[Row], error: f64) -> Option<f64> {
    let stays = rows.iter().rev().take_while(|row| row.error_vs_own_grid <= error);
    stays.last().map(|row| row.time_ms)
}
