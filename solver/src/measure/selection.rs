//! The fields of a result that are asked for: the others are neither computed nor written.

use super::Outcome;
use serde::ser::{Serialize, SerializeMap, Serializer};
use serde_json::Value;

/// A path that no result contains, or no path.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("\"{path}\" is not a field of a result; allowed: {allowed}")]
pub struct UnknownField {
    path: String,
    allowed: String,
}

/// Fields of an [`Outcome`] by their paths, as `contact_force_n` or `strain.max_principal`; a path through a list names
/// the field of every entry, as `layers.max_stress_kpa`. `schema` and `status` are always selected.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// Paths in the order asked for; `None`: all fields.
    paths: Option<Vec<String>>,
    without_profile: bool,
}

/// Always selected: a result without its status might be read as converged.
const ALWAYS: [&str; 2] = ["schema", "status"];
const PROFILES: [&str; 4] = ["profile", "profile_skin", "profile_y", "profile_skin_y"];

impl Selection {
    /// All fields.
    #[must_use]
    pub fn all() -> Self {
        Self::default()
    }

    /// The fields of these paths.
    ///
    /// # Errors
    /// The first path that no result contains.
    pub fn of(paths: &[String]) -> Result<Self, UnknownField> {
        let schema = schemars::schema_for!(Outcome).to_value();
        for path in paths {
            check(&schema, path)?;
        }
        let mut all: Vec<String> = ALWAYS.map(str::to_owned).to_vec();
        all.extend(paths.iter().cloned());
        Ok(Self { paths: Some(all), without_profile: false })
    }

    /// The same fields without the profiles.
    #[must_use]
    pub fn without_profile(self) -> Self {
        Self { without_profile: true, ..self }
    }

    /// Is a profile one of the paths?
    #[must_use]
    pub fn names_a_profile(&self) -> bool {
        self.paths.is_some() && PROFILES.iter().any(|field| self.wants(field))
    }

    /// Is a field of the result, or a part of it, selected?
    pub(crate) fn wants(&self, field: &str) -> bool {
        let is_left_out = self.without_profile && PROFILES.contains(&field);
        let is_of = |path: &String| path.split('.').next() == Some(field);
        !is_left_out && self.paths.as_ref().is_none_or(|paths| paths.iter().any(is_of))
    }

    /// Is one of the fields selected?
    pub(crate) fn wants_any(&self, fields: &[&str]) -> bool {
        fields.iter().any(|field| self.wants(field))
    }

    /// The selected fields of a result, for serialisation.
    #[must_use]
    pub fn of_outcome<'a>(&'a self, outcome: &'a Outcome) -> Selected<'a> {
        Selected { selection: self, outcome }
    }
}

/// Compares written results with the fields of a selection.
#[derive(Clone, Debug)]
pub struct Written {
    schema: Value,
    selection: Selection,
}

impl Written {
    /// Results with the fields of a selection.
    #[must_use]
    pub fn new(selection: &Selection) -> Self {
        let settings = schemars::generate::SchemaSettings::default().for_serialize();
        let schema = settings.into_generator().into_root_schema_for::<Outcome>().to_value();
        Self { schema, selection: selection.clone() }
    }

    /// The first field by which a written result differs, in words, as "`strain` in surplus"; `None`: it has the selected fields. Names
    /// beside the result, as that of its scene, are given.
    #[must_use]
    pub fn difference(&self, result: &Value, beside: &[&str]) -> Option<String> {
        let Selection { paths, without_profile } = &self.selection;
        let paths: Option<Vec<&str>> =
            paths.as_ref().map(|paths| paths.iter().map(String::as_str).collect());
        let is_left_out = |name: &str| *without_profile && PROFILES.contains(&name);
        self.part(&self.schema, result, paths.as_deref(), &|name| {
            is_left_out(name).then_some(false).or(beside.contains(&name).then_some(true))
        })
    }

    /// The difference of a part by the relative paths; `decided` knows whether a name may stand there.
    fn part(
        &self,
        schema: &Value,
        found: &Value,
        paths: Option<&[&str]>,
        decided: &dyn Fn(&str) -> Option<bool>,
    ) -> Option<String> {
        if let Value::Array(entries) = found {
            return entries.iter().find_map(|entry| self.part(schema, entry, paths, decided));
        }
        let schema = object(&self.schema, schema);
        let (fields, properties) = (found.as_object()?, schema["properties"].as_object()?);
        let of_name = |name: &str| {
            let paths = paths?.iter().filter(|path| path.split('.').next() == Some(name));
            Some(paths.map(|path| path.split_once('.').map(|(_, rest)| rest)).collect::<Vec<_>>())
        };
        let is_wanted = |name: &str| {
            let is_selected = || of_name(name).is_none_or(|paths| !paths.is_empty());
            decided(name).unwrap_or_else(|| properties.contains_key(name) && is_selected())
        };
        if let Some(name) = fields.keys().find(|name| !is_wanted(name)) {
            return Some(format!("{name:?} in surplus"));
        }
        let required =
            schema["required"].as_array().into_iter().flatten().filter_map(Value::as_str);
        if let Some(name) =
            required.into_iter().find(|name| is_wanted(name) && !fields.contains_key(*name))
        {
            return Some(format!("{name:?} missing"));
        }
        fields.iter().find_map(|(name, value)| {
            // A path that ends here names the whole field.
            let rest: Option<Vec<&str>> =
                of_name(name).and_then(|paths| paths.into_iter().collect());
            self.part(properties.get(name)?, value, rest.as_deref(), &|_| None)
        })
    }
}

/// Checks that a result may contain a path.
fn check(schema: &Value, path: &str) -> Result<(), UnknownField> {
    let mut at = schema;
    for name in path.split('.') {
        at = object(schema, at);
        let fields = at.get("properties").and_then(Value::as_object);
        at = fields.and_then(|fields| fields.get(name)).ok_or_else(|| UnknownField {
            path: path.to_owned(),
            allowed: fields.map_or_else(
                || "a shorter path".to_owned(),
                |fields| fields.keys().map(String::as_str).collect::<Vec<_>>().join(", "),
            ),
        })?;
    }
    Ok(())
}

/// The schema of the object behind references, options and lists.
pub(super) fn object<'a>(root: &'a Value, mut at: &'a Value) -> &'a Value {
    loop {
        let next = if let Some(Value::String(reference)) = at.get("$ref") {
            root.pointer(reference.trim_start_matches('#'))
        } else if let Some(Value::Array(choices)) = at.get("anyOf") {
            choices.iter().find(|choice| choice.get("$ref").is_some())
        } else {
            at.get("items")
        };
        match next {
            Some(next) => at = next,
            None => return at,
        }
    }
}

/// The selected fields of a result.
#[derive(Clone, Copy, Debug)]
pub struct Selected<'a> {
    selection: &'a Selection,
    outcome: &'a Outcome,
}

impl Serialize for Selected<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Selection { paths, without_profile } = self.selection;
        if paths.is_none() && !without_profile {
            return self.outcome.serialize(serializer);
        }
        let value = serde_json::to_value(self.outcome).map_err(serde::ser::Error::custom)?;
        let paths = match paths {
            Some(paths) => paths.clone(),
            None => {
                value.as_object().map_or_else(Vec::new, |fields| fields.keys().cloned().collect())
            }
        };
        let is_wanted = |path: &&str| {
            !without_profile || !PROFILES.contains(&path.split('.').next().unwrap_or(""))
        };
        let paths: Vec<&str> = paths.iter().map(String::as_str).filter(is_wanted).collect();
        Part { value: &value, paths: &paths }.serialize(serializer)
    }
}

/// The parts of a value that relative paths name; no path names the whole value.
struct Part<'a> {
    value: &'a Value,
    paths: &'a [&'a str],
}

impl Serialize for Part<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let Self { value, paths } = *self;
        match value {
            Value::Array(entries) if !paths.is_empty() => {
                serializer.collect_seq(entries.iter().map(|value| Part { value, paths }))
            }
            Value::Object(fields) if !paths.is_empty() => {
                let mut map = serializer.serialize_map(None)?;
                let mut written: Vec<&str> = Vec::new();
                for path in paths {
                    let name = path.split('.').next().unwrap_or(path);
                    let Some(value) = fields.get(name).filter(|_| !written.contains(&name)) else {
                        continue;
                    };
                    written.push(name);
                    let of_name = |path: &&&str| path.split('.').next() == Some(name);
                    let rest = paths.iter().filter(of_name).map(|path| path.split_once('.'));
                    // A path that ends here names the whole field.
                    let rest: Option<Vec<&str>> =
                        rest.map(|pair| pair.map(|(_, rest)| rest)).collect();
                    let rest = rest.unwrap_or_default();
                    map.serialize_entry(name, &Part { value, paths: &rest })?;
                }
                map.end()
            }
            value => value.serialize(serializer),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paths(paths: &[&str]) -> Vec<String> {
        paths.iter().map(|&path| path.to_owned()).collect()
    }

    #[test]
    fn an_unknown_path_is_rejected_with_the_allowed_names() {
        for (path, allowed) in [
            ("strain.max", "mean_area"),
            ("force", "contact_force_n"),
            ("", "contact_force_n"),
            ("layers.curve", "max_stress_kpa"),
            ("projection_mm.x", "a shorter path"),
        ] {
            let error = Selection::of(&paths(&[path])).unwrap_err().to_string();
            assert!(error.contains(allowed) && !error.contains('\n'), "{error}");
        }
        let known = ["profile.z_mm", "strain.fraction_above", "solver.work_units", "cover_mm.apex"];
        assert!(Selection::of(&paths(&known)).is_ok());
    }
}
