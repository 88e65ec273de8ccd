//! The form of the lines of a stream: JSON lines, or a table with a header.

use super::super::cell;
use super::key::{self, Key};
use crate::measure::{Column, Kind, Outcome, Selected, Selection, Written};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use serde_json::value::RawValue;

/// The fields that a run writes, and how.
pub(super) struct LineFormat {
    pub(super) selection: Selection,
    table: Option<Table>,
}

/// A table of results (CSV): `id`, `scene_hash`, the columns, `error`.
struct Table {
    columns: Vec<Column>,
    header: String,
}

/// Where an invalid scene stands.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    /// The file, where a run has several.
    pub(super) file: Option<&'a str>,
    /// The line, from 1.
    pub(super) line: usize,
}

#[derive(Serialize)]
struct ResultLine<'a> {
    #[serde(skip_serializing_if = "Option::is_none")]
    id: Option<&'a RawValue>,
    scene_hash: &'a str,
    #[serde(flatten)]
    result: Selected<'a>,
}

#[derive(Serialize)]
struct ErrorLine<'a> {
    id: Option<&'a RawValue>,
    scene_hash: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    file: Option<&'a str>,
    line: usize,
    error: &'a str,
}

/// The scene of a line of an earlier run.
pub(super) struct Earlier {
    /// The JSON text of its `id`.
    pub(super) id: Option<Box<str>>,
    /// Of its content; lines with an `id` have not always had one.
    pub(super) hash: Option<u128>,
}

impl Earlier {
    fn new(id: Option<Box<str>>, hash: Option<&str>) -> Option<Self> {
        let hash = match hash {
            Some(text) => Some(key::written_hash(text)?),
            None => None,
        };
        (id.is_some() || hash.is_some()).then_some(Self { id, hash })
    }

    fn of_json(line: &[u8]) -> Option<Self> {
        #[derive(Deserialize)]
        struct Names<'a> {
            #[serde(borrow)]
            id: Option<&'a RawValue>,
            scene_hash: Option<&'a str>,
            /// Of a result, or of an error in its place.
            status: Option<IgnoredAny>,
            error: Option<IgnoredAny>,
        }
        let Names { id, scene_hash, status, error } = serde_json::from_slice(line).ok()?;
        status.or(error)?;
        Self::new(id.map(|id| key::one_line(id.get())), scene_hash)
    }
}

/// What a line has beside its result.
const NAMES: [&str; 2] = ["id", "scene_hash"];

/// How each line of a result begins.
const BEGINNINGS: [&[u8]; 2] = [br#"{"id":"#, br#"{"scene_hash":"#];

impl LineFormat {
    /// A result a line, as JSON.
    pub(super) fn json(selection: Selection) -> Self {
        Self { selection, table: None }
    }

    /// A table of these columns.
    pub(super) fn table(selection: Selection, columns: Vec<Column>) -> Self {
        let names = columns.iter().map(Column::name);
        let names = ["id", "scene_hash"].into_iter().chain(names).chain(["error"]);
        let header = cell::row(names.map(str::to_owned));
        Self { selection, table: Some(Table { columns, header }) }
    }

    /// The same without the profiles.
    pub(super) fn without_profile(self) -> Self {
        Self { selection: self.selection.without_profile(), ..self }
    }

    /// The first line of the file, of a table.
    pub(super) fn header(&self) -> Option<&str> {
        self.table.as_ref().map(|table| table.header.as_str())
    }

    /// What the columns of a table hold.
    pub(super) fn kinds(&self) -> Vec<Kind> {
        let columns = self.table.iter().flat_map(|table| &table.columns).map(Column::kind);
        let ids = [Kind::Text; 2];
        ids.into_iter().chain(columns).chain([Kind::Text]).collect()
    }

    /// The line of a result.
    pub(super) fn result(&self, key: &Key, outcome: &Outcome) -> String {
        let result = self.selection.of_outcome(outcome);
        let Some(Table { columns, .. }) = &self.table else {
            let (id, hash) = (key.id(), key.hash());
            let (id, scene_hash) = (id.as_deref(), hash.as_str());
            return json(&ResultLine { id, scene_hash, result });
        };
        // The values of a result have names and numbers only.
        let result = serde_json::to_value(result).unwrap_or_default();
        let values = columns.iter().map(|column| cell::of_value(&column.value(&result)));
        row(key, values, String::new())
    }

    /// The line of a scene without a result.
    pub(super) fn error(&self, key: &Key, place: Place, error: &str) -> String {
        let Place { file, line } = place;
        let Some(Table { columns, .. }) = &self.table else {
            let (id, hash) = (key.id(), key.hash());
            let (id, scene_hash) = (id.as_deref(), hash.as_str());
            return json(&ErrorLine { id, scene_hash, file, line, error });
        };
        let file = file.map(|file| format!("{file}, ")).unwrap_or_default();
        let error = cell::of_value(&Value::from(format!("{file}line {line}: {error}")));
        row(key, columns.iter().map(|_| String::new()), error)
    }

    /// The scene of a line of an earlier run, the header aside; `None` for another line.
    pub(super) fn earlier(&self, line: &[u8]) -> Option<Earlier> {
        let Some(Table { columns, .. }) = &self.table else { return Earlier::of_json(line) };
        let cells = cell::split(std::str::from_utf8(line).ok()?).ok()?;
        if cells.len() != columns.len() + 3 {
            return None;
        }
        let id = cell::to_json(&cells[0]).map(|id| key::one_line(&id));
        Earlier::new(id, Some(&cells[1]).filter(|hash| !hash.is_empty()))
    }

    /// Compares the fields of a JSON line of an earlier run; `None` for an error in the place of a result. A table has a header.
    pub(super) fn compared(&self, line: &[u8]) -> Option<Result<(), String>> {
        let result: Value = serde_json::from_slice(line).ok()?;
        result.get("status")?;
        let other = Written::new(&self.selection).difference(&result, &NAMES);
        Some(other.map_or(Ok(()), Err))
    }

    /// May a line without its end be one of an earlier run?
    pub(super) fn is_begun(&self, number: usize, line: &[u8]) -> bool {
        match self.header() {
            Some(header) => number > 1 || header.as_bytes().starts_with(line),
            None => {
                BEGINNINGS.iter().any(|start| line.starts_with(start) || start.starts_with(line))
            }
        }
    }
}

/// A value in a line.
fn json(value: &impl Serialize) -> String {
    // The values of a result have names and numbers only.
    serde_json::to_string(value).unwrap_or_default() + "\n"
}

fn row(key: &Key, values: impl Iterator<Item = String>, error: String) -> String {
    let id = key.id().map(|id| cell::of_json(id.get())).unwrap_or_default();
    let names = [id, key.hash()];
    cell::row(names.into_iter().chain(values).chain([error]))
}
