//! Results that are kept without the session, or beside its present one.

use crate::body::before_after::Row;
use crate::measure::{Fields, Outcome};
use crate::scene::Scene;
use serde::Serialize;
use std::collections::BTreeMap;
use std::rc::Rc;

/// A saved result, complete without the session.
#[derive(Clone, Debug, Serialize)]
pub struct Record {
    /// The result.
    #[serde(flatten)]
    pub outcome: Outcome,
    /// The result of the other side, where it has a plan of its own and is solved.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub other_side: Option<Outcome>,
    /// The measures of her body before and after by side, where the plan has it.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub measures: BTreeMap<&'static str, Vec<Row>>,
    /// The scene of the result.
    pub scene: Scene,
    /// Version of the program.
    pub program_version: &'static str,
    /// Date and time of saving, UTC, as in RFC 3339.
    pub date: String,
}

/// A scene with the fields of its solution.
#[derive(Clone, Debug)]
pub struct Answer {
    /// The scene.
    pub scene: Scene,
    /// The fields.
    pub fields: Rc<Fields>,
}
