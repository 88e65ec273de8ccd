//! The columns of a table of results: one value of a result each, by its path.

use super::Outcome;
use super::selection::{Selection, UnknownField, object};
use serde_json::Value;

/// Why a path is no column.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ColumnError {
    /// No result contains the path.
    #[error(transparent)]
    Unknown(#[from] UnknownField),
    /// The path names several fields.
    #[error("\"{path}\" has several fields; allowed in a table: {allowed}")]
    Several {
        /// The path.
        path: String,
        /// The paths of its fields.
        allowed: String,
    },
    /// Brackets stand behind a value that has no entries, or the text is no path.
    #[error(
        "\"{0}\" is no path of a result; allowed: names with points between, and [k] behind a list, as layers[0].max_stress_kpa"
    )]
    Path(String),
}

/// A column: a path of a result, as `strain.max_principal`. `[k]` names an entry of a list by its index from 0, and of a map by its
/// key: `layers[0].max_stress_kpa`, `strain.fraction_above[0.25]`. A path through a whole list has the list of its entries' values.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    name: String,
    steps: Vec<Step>,
    kind: Kind,
}

/// The values of a column; each may be absent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Numbers.
    Number,
    /// True or false.
    Flag,
    /// Texts; a list is its JSON.
    Text,
}

#[derive(Clone, Debug, PartialEq, Eq)]
enum Step {
    Field(String),
    /// Index of a list, key of a map.
    Entry(String),
}

impl Column {
    /// The column of a path.
    ///
    /// # Errors
    /// No result contains the path, or it names several fields.
    pub fn of(path: &str) -> Result<Self, ColumnError> {
        let no_path = || ColumnError::Path(path.to_owned());
        let steps = steps(path).ok_or_else(no_path)?;
        let mut column = Self { name: path.to_owned(), steps, kind: Kind::Text };
        Selection::of(&[column.field()])?;
        let schema = schemars::schema_for!(Outcome).to_value();
        let (mut at, mut is_list) = (&schema, false);
        for step in &column.steps {
            let next = match step {
                Step::Field(name) => {
                    is_list |= at.get("items").is_some();
                    &object(&schema, at)["properties"][name]
                }
                // A list of lists or a map in a list does not occur in a result.
                Step::Entry(key) => {
                    let index = key.parse::<usize>().ok();
                    let entries = index.and(at.get("items")).or(at.get("additionalProperties"));
                    entries.filter(|entries| entries.is_object()).ok_or_else(no_path)?
                }
            };
            at = next;
        }
        if let Some(Value::Object(fields)) = object(&schema, at).get("properties") {
            let path = path.to_owned();
            let allowed = fields.keys().map(|field| format!("{path}.{field}"));
            let allowed = allowed.collect::<Vec<_>>().join(", ");
            return Err(ColumnError::Several { path, allowed });
        }
        if !is_list {
            column.kind = kind(at);
        }
        Ok(column)
    }

    /// What the values are.
    #[must_use]
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// The path as it was given.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The path without entries, for a [`Selection`].
    #[must_use]
    pub fn field(&self) -> String {
        let fields = self.steps.iter().filter_map(|step| match step {
            Step::Field(name) => Some(name.as_str()),
            Step::Entry(_) => None,
        });
        fields.collect::<Vec<_>>().join(".")
    }

    /// The value in a result as JSON; null if the result has none.
    #[must_use]
    pub fn value(&self, result: &Value) -> Value {
        value(result, &self.steps)
    }
}

/// What a schema of one type or null allows.
fn kind(schema: &Value) -> Kind {
    let mut types = match &schema["type"] {
        Value::Array(types) => {
            types.iter().filter_map(Value::as_str).filter(|name| *name != "null").collect()
        }
        name => Vec::from_iter(name.as_str()),
    };
    match (types.pop(), types.is_empty()) {
        (Some("number" | "integer"), true) => Kind::Number,
        (Some("boolean"), true) => Kind::Flag,
        _ => Kind::Text,
    }
}

fn value(at: &Value, steps: &[Step]) -> Value {
    let Some((step, rest)) = steps.split_first() else { return at.clone() };
    let next = match (step, at) {
        (Step::Field(_), Value::Array(entries)) => {
            return entries.iter().map(|entry| value(entry, steps)).collect();
        }
        (Step::Entry(index), Value::Array(entries)) => {
            index.parse::<usize>().ok().and_then(|index| entries.get(index))
        }
        (Step::Field(name) | Step::Entry(name), at) => at.get(name),
    };
    next.map_or(Value::Null, |next| value(next, rest))
}

/// The steps of a path: names with points between, entries in brackets behind them.
fn steps(path: &str) -> Option<Vec<Step>> {
    let (mut steps, mut rest) = (Vec::new(), path);
    loop {
        let end = rest.find(['.', '[']).unwrap_or(rest.len());
        steps.push(Step::Field(rest[..end].to_owned()));
        rest = &rest[end..];
        while let Some(inside) = rest.strip_prefix('[') {
            let (entry, after) = inside.split_once(']')?;
            steps.push(Step::Entry(entry.to_owned()));
            rest = after;
        }
        if rest.is_empty() {
            return Some(steps);
        }
        rest = rest.strip_prefix('.')?;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_of_no_single_value_is_rejected_with_what_is_allowed() {
        for (path, wanted) in [
            ("force", "contact_force_n"),
            ("", "contact_force_n"),
            ("strain", "strain.max_principal"),
            ("layers", "layers.max_stress_kpa"),
            ("layers[0]", "layers[0].max_stress_kpa"),
            ("layers[x].tissue", "layers[0]"),
            ("layers[0", "layers[0]"),
            ("layers[0]tissue", "layers[0]"),
            ("strain[max_principal]", "layers[0]"),
            ("status[0]", "layers[0]"),
            ("profile[0][1]", "layers[0]"),
        ] {
            let error = Column::of(path).unwrap_err().to_string();
            assert!(error.contains(wanted) && !error.contains('\n'), "{path}: {error}");
        }
    }
}
