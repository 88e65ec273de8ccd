//! JSON Schemas of the formats, generated from the types.

use super::MapOptions;
use super::bands::BandsSettings;
use super::bands_report::BandsReport;
use super::map_file::MapFile;
use super::quantity::short;
use super::times::TimesFile;
use crate::measure::Outcome;
use crate::scene;
use schemars::JsonSchema;
use schemars::generate::SchemaSettings;

/// A format with a schema.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SchemaOf {
    /// A scene.
    Scene,
    /// The result of a scene.
    Result,
    /// A map.
    Map,
    /// The choices of a map besides its scene.
    MapOptions,
    /// Bands.
    Bands,
    /// The choices of bands besides their scene.
    BandsOptions,
    /// A plan at its times.
    Times,
}

impl SchemaOf {
    /// All formats with their names.
    pub const ALL: [(&'static str, Self); 7] = [
        ("scene", Self::Scene),
        ("result", Self::Result),
        ("map", Self::Map),
        ("map-options", Self::MapOptions),
        ("bands", Self::Bands),
        ("bands-options", Self::BandsOptions),
        ("times", Self::Times),
    ];

    /// The format of a name.
    ///
    /// # Errors
    /// One line with the name and the allowed names.
    pub fn of_name(name: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, format)| format).ok_or_else(|| {
            let allowed = Self::ALL.map(|(name, _)| name).join(", ");
            format!("{:?} is no format; allowed: {allowed}", short(name))
        })
    }

    /// The JSON Schema (draft 2020-12). Input has optional fields where a default exists; of output a field is required unless
    /// its description has a condition.
    #[must_use]
    pub fn json(self) -> String {
        let input = SchemaSettings::draft2020_12();
        let output = SchemaSettings::draft2020_12().for_serialize();
        match self {
            Self::Scene => scene::schema(),
            Self::Result => json::<Outcome>(output),
            Self::Map => json::<MapFile>(output),
            Self::MapOptions => json::<MapOptions>(input),
            Self::Bands => json::<BandsReport>(output),
            Self::BandsOptions => json::<BandsSettings>(input),
            Self::Times => json::<TimesFile>(output),
        }
    }
}

fn json<T: JsonSchema>(settings: SchemaSettings) -> String {
    let schema = settings.into_generator().into_root_schema_for::<T>();
    serde_json::to_string_pretty(&schema).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::Value;

    #[test]
    fn names_are_unique_and_an_unknown_name_lists_them() {
        for (name, format) in SchemaOf::ALL {
            assert_eq!(SchemaOf::of_name(name), Ok(format));
        }
        let error = SchemaOf::of_name(&"x".repeat(1000)).unwrap_err();
        assert!(error.len() < 200 && error.ends_with("bands-options, times"), "{error}");
    }

    #[test]
    fn every_reference_of_a_schema_has_its_definition() {
        fn references(value: &Value, found: &mut Vec<String>) {
            match value {
                Value::Object(fields) => {
                    found.extend(fields.get("$ref").and_then(Value::as_str).map(str::to_owned));
                    fields.values().for_each(|value| references(value, found));
                }
                Value::Array(values) => values.iter().for_each(|value| references(value, found)),
                _ => {}
            }
        }
        for (name, format) in SchemaOf::ALL {
            let schema: Value = serde_json::from_str(&format.json()).unwrap();
            let mut found = Vec::new();
            references(&schema, &mut found);
            for reference in found {
                let path = reference.strip_prefix('#').unwrap();
                assert!(schema.pointer(path).is_some(), "{name}: {reference}");
            }
        }
    }

    /// A scene in a map has the schema of a scene, and so have its pins.
    #[test]
    fn a_scene_has_one_schema_wherever_it_stands() {
        let [scene, map, bands] = [SchemaOf::Scene, SchemaOf::Map, SchemaOf::Bands]
            .map(|format| serde_json::from_str::<Value>(&format.json()).unwrap());
        for (format, name) in [(&map, "MapFile"), (&bands, "BandsReport")] {
            assert_eq!(format["title"], name);
            assert_eq!(format["$defs"]["Scene"]["properties"], scene["properties"]);
            assert_eq!(format["$defs"]["Scene"]["required"], serde_json::json!(["implant"]));
            assert_eq!(format["$defs"]["Layer"], scene["$defs"]["Layer"]);
        }
    }
}
