//! The fill of an implant: how far its body yields.
//!
//! A shell of modulus times thickness S around gel of Young's modulus E under pressure acts like gel of another modulus, of a base radius R,
//!
//! ```text
//! E* = 1.15 (E + 1.9 √(E S / R))
//! ```
//!
//! Both factors are those with which the few numbers of the implant's deformation follow axisymmetric elements of gel, shell and tissue over flat and
//! curved walls (docs/validation.md); the root is the bending stiffness of a shell on a soft body.

use super::{SceneError, out_of_range};
use crate::curve::number;
use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{Error, MapAccess, Unexpected};
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Factors of E*.
const OF_GEL: f64 = 1.15;
const OF_SHELL: f64 = 1.9;

/// The fill of an implant that yields.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fill {
    /// Form-stable gel: 40 kPa, shell 600 kPa·mm.
    FormStable,
    /// Cohesive gel: 15 kPa, shell 600 kPa·mm.
    Cohesive,
    /// Soft gel: 5 kPa, shell 500 kPa·mm.
    Soft,
    /// Saline: a fluid, 0.3 kPa, in a shell of 500 kPa·mm.
    Saline,
    /// Gel and shell of given moduli.
    Gel(Gel),
}

/// Gel and shell.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Gel {
    /// Young's modulus of the gel \[kPa\], 0.3 to 1000.
    pub modulus_kpa: f64,
    /// Modulus × thickness of the shell \[kPa·mm\], 0 to 5000.
    pub shell_kpa_mm: f64,
}

/// Limits of the moduli.
const MODULUS_KPA: (f64, f64) = (0.3, 1000.0);
const SHELL_KPA_MM: (f64, f64) = (0.0, 5000.0);

impl Fill {
    /// The fills with a name, from the stiffest.
    pub const NAMED: [(&'static str, Self); 4] = [
        ("form_stable", Self::FormStable),
        ("cohesive", Self::Cohesive),
        ("soft", Self::Soft),
        ("saline", Self::Saline),
    ];

    /// The name in files of a fill with a name.
    #[must_use]
    pub fn name(self) -> Option<&'static str> {
        Self::NAMED.into_iter().find_map(|(name, fill)| (fill == self).then_some(name))
    }

    /// Gel and shell.
    #[must_use]
    pub fn gel(self) -> Gel {
        let gel = |modulus_kpa, shell_kpa_mm| Gel { modulus_kpa, shell_kpa_mm };
        match self {
            Self::FormStable => gel(40.0, 600.0),
            Self::Cohesive => gel(15.0, 600.0),
            Self::Soft => gel(5.0, 500.0),
            Self::Saline => gel(0.3, 500.0),
            Self::Gel(own) => own,
        }
    }

    /// E* of an implant of a base radius \[mm\] \[kPa\].
    #[must_use]
    pub fn modulus_kpa(self, base_radius_mm: f64) -> f64 {
        let Gel { modulus_kpa, shell_kpa_mm } = self.gel();
        OF_GEL * (modulus_kpa + OF_SHELL * (modulus_kpa * shell_kpa_mm / base_radius_mm).sqrt())
    }

    /// The fill with a factor on both moduli, as far as they are allowed.
    pub(crate) fn stiffer(self, factor: f64) -> Self {
        let Gel { modulus_kpa, shell_kpa_mm } = self.gel();
        let within = |value: f64, (least, most): (f64, f64)| (factor * value).clamp(least, most);
        Self::Gel(Gel {
            modulus_kpa: within(modulus_kpa, MODULUS_KPA),
            shell_kpa_mm: within(shell_kpa_mm, SHELL_KPA_MM),
        })
    }

    /// Checks the moduli.
    pub(super) fn check(self) -> Result<(), SceneError> {
        let Gel { modulus_kpa, shell_kpa_mm } = self.gel();
        for (path, value, (least, most)) in [
            ("implant.fill.modulus_kpa", modulus_kpa, MODULUS_KPA),
            ("implant.fill.shell_kpa_mm", shell_kpa_mm, SHELL_KPA_MM),
        ] {
            if !(least..=most).contains(&value) {
                let allowed = format!("{} to {}", number(least), number(most));
                return Err(out_of_range(path, number(value), &allowed));
            }
        }
        Ok(())
    }
}

impl Serialize for Fill {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.name() {
            Some(name) => to.serialize_str(name),
            None => self.gel().serialize(to),
        }
    }
}

/// A fill in a file: rigid, or one that yields.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FillFile(pub(super) Option<Fill>);

const ALLOWED: &str = "\"rigid\", \"form_stable\", \"cohesive\", \"soft\", \"saline\" or an object with modulus_kpa and shell_kpa_mm";

impl<'de> Deserialize<'de> for FillFile {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Self, D::Error> {
        struct Visitor;
        impl<'de> serde::de::Visitor<'de> for Visitor {
            type Value = FillFile;
            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(ALLOWED)
            }
            fn visit_str<E: Error>(self, text: &str) -> Result<FillFile, E> {
                let named = Fill::NAMED.into_iter().find(|(name, _)| *name == text);
                match named {
                    Some((_, fill)) => Ok(FillFile(Some(fill))),
                    None if text == "rigid" => Ok(FillFile(None)),
                    None => Err(E::invalid_value(Unexpected::Str(text), &self)),
                }
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<FillFile, A::Error> {
                let gel = Gel::deserialize(MapAccessDeserializer::new(map))?;
                let own = Fill::Gel(gel);
                let named = Fill::NAMED.into_iter().find(|(_, fill)| fill.gel() == gel);
                Ok(FillFile(Some(named.map_or(own, |(_, fill)| fill))))
            }
        }
        from.deserialize_any(Visitor)
    }
}

impl JsonSchema for FillFile {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Fill".into()
    }

    fn json_schema(generator: &mut schemars::SchemaGenerator) -> schemars::Schema {
        let gel = generator.subschema_for::<Gel>();
        schemars::json_schema!({
            "description": "How far the implant's body yields.",
            "anyOf": [
                { "enum": ["rigid", "form_stable", "cohesive", "soft", "saline"] },
                gel,
            ],
        })
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;

    fn read(fill: &str) -> Result<Scene, String> {
        let json = format!(
            "{{\"implant\": {{\"base_radius_mm\": 60, \"projection_mm\": 40, \"fill\": {fill}}}, \"pocket_radius_mm\": 70}}"
        );
        Scene::from_json(&json).map_err(|error| error.to_string())
    }

    #[test]
    fn a_fill_is_written_as_it_is_read() {
        for fill in ["\"cohesive\"", "\"saline\"", "{\"modulus_kpa\":9.0,\"shell_kpa_mm\":450.0}"] {
            let scene = read(fill).unwrap();
            let written: serde_json::Value = serde_json::from_str(&scene.to_json()).unwrap();
            assert_eq!(written["implant"]["fill"].to_string(), fill);
            assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        }
        let rigid = read("\"rigid\"").unwrap();
        assert!(rigid.implant.fill.is_none() && !rigid.to_json().contains("fill"));
        let named = read("{\"modulus_kpa\": 15, \"shell_kpa_mm\": 600}").unwrap();
        assert_eq!(named, read("\"cohesive\"").unwrap());
    }

    #[test]
    fn a_fill_that_is_none_is_refused_in_a_line() {
        for (fill, words) in [
            ("\"hard\"", "implant.fill"),
            ("null", "implant.fill"),
            ("7", "implant.fill"),
            ("{\"modulus_kpa\": 15}", "shell_kpa_mm"),
            ("{\"modulus_kpa\": 0.1, \"shell_kpa_mm\": 0}", "implant.fill.modulus_kpa"),
            ("{\"modulus_kpa\": 10, \"shell_kpa_mm\": 6000}", "0 to 5000"),
        ] {
            let line = read(fill).unwrap_err();
            assert!(line.contains(words) && !line.contains('\n'), "{line}");
        }
    }
}
