//! Deserialisation of curves from structures with the fields of all kinds.
//!
//! serde buffers a tagged enum as a whole, in some thirty times the memory of the text, and loses the
//! position of an error.

use super::{CurveSpec, Fat, Interpolation, MAX_COEFFICIENTS, MAX_POINTS, ScaledCurve, Section};
use serde::de::value::{Error as ValueError, MapAccessDeserializer, StrDeserializer};
use serde::de::{
    Deserialize, Deserializer, Error, IgnoredAny, IntoDeserializer, MapAccess, SeqAccess,
    Unexpected, Visitor,
};
use std::fmt;
use std::marker::PhantomData;

/// A curve with the fields of all kinds.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct CurveFile {
    kind: Kind,
    #[serde(default, deserialize_with = "given")]
    variant: Option<Fat>,
    #[serde(default, deserialize_with = "given")]
    modulus_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    scale_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    rate: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    points: Option<List<Pair, MAX_POINTS>>,
    #[serde(default, deserialize_with = "given")]
    interpolation: Option<Interpolation>,
    #[serde(default, deserialize_with = "given")]
    sections: Option<List<Section, MAX_POINTS>>,
    #[serde(default, deserialize_with = "given")]
    strain_scale: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    stress_scale: Option<f64>,
}

/// A curve of a file; a scale that the file does not contain is `None`.
#[derive(Clone)]
pub struct GivenCurve {
    /// The curve before its scaling.
    pub spec: CurveSpec,
    /// Factor of the strains \[-\].
    pub strain_scale: Option<f64>,
    /// Factor of the stresses \[-\].
    pub stress_scale: Option<f64>,
}

#[derive(Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum Kind {
    Skin,
    Adipose,
    Fat,
    Linear,
    Arctangent,
    Exponential,
    Points,
    Sections,
}

/// A section with the fields of all kinds.
#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct SectionFile {
    kind: SectionKind,
    from: f64,
    to: f64,
    #[serde(default, deserialize_with = "given")]
    modulus_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    end_stress_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    end_slope_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    coefficients_kpa: Option<List<f64, MAX_COEFFICIENTS>>,
    #[serde(default, deserialize_with = "given")]
    scale_kpa: Option<f64>,
    #[serde(default, deserialize_with = "given")]
    rate: Option<f64>,
}

#[derive(Clone, Copy, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
enum SectionKind {
    Linear,
    Cubic,
    Polynomial,
    Arctangent,
    Sine,
    Exponential,
}

impl<'de> Deserialize<'de> for CurveSpec {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let file: CurveFile = object(reader)?;
        reject_others(&[
            ("strain_scale", file.strain_scale.is_some()),
            ("stress_scale", file.stress_scale.is_some()),
        ])?;
        file.spec()
    }
}

impl<'de> Deserialize<'de> for GivenCurve {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let file: CurveFile = object(reader)?;
        let (strain_scale, stress_scale) = (file.strain_scale, file.stress_scale);
        Ok(Self { spec: file.spec()?, strain_scale, stress_scale })
    }
}

impl<'de> Deserialize<'de> for ScaledCurve {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        GivenCurve::deserialize(reader).map(Self::from)
    }
}

impl From<GivenCurve> for ScaledCurve {
    fn from(given: GivenCurve) -> Self {
        let scale = |scale: Option<f64>| scale.unwrap_or(1.0);
        Self {
            spec: given.spec,
            strain_scale: scale(given.strain_scale),
            stress_scale: scale(given.stress_scale),
        }
    }
}

impl CurveFile {
    /// The curve of its kind.
    ///
    /// # Errors
    /// A missing field, or a field of another kind.
    fn spec<E: Error>(self) -> Result<CurveSpec, E> {
        let mut file = self;
        let spec = match file.kind {
            Kind::Skin => CurveSpec::Skin {},
            Kind::Adipose => CurveSpec::Adipose {},
            Kind::Fat => CurveSpec::Fat { variant: file.variant.take().unwrap_or_default() },
            Kind::Linear => {
                CurveSpec::Linear { modulus_kpa: take(&mut file.modulus_kpa, "modulus_kpa")? }
            }
            Kind::Arctangent => CurveSpec::Arctangent {
                scale_kpa: take(&mut file.scale_kpa, "scale_kpa")?,
                rate: take(&mut file.rate, "rate")?,
            },
            Kind::Exponential => CurveSpec::Exponential {
                scale_kpa: take(&mut file.scale_kpa, "scale_kpa")?,
                rate: take(&mut file.rate, "rate")?,
            },
            Kind::Points => CurveSpec::Points {
                points: take(&mut file.points, "points")?.0.into_iter().map(|p| p.0).collect(),
                interpolation: file.interpolation.take().unwrap_or_default(),
            },
            Kind::Sections => {
                CurveSpec::Sections { sections: take(&mut file.sections, "sections")?.0 }
            }
        };
        reject_others(&[
            ("variant", file.variant.is_some()),
            ("modulus_kpa", file.modulus_kpa.is_some()),
            ("scale_kpa", file.scale_kpa.is_some()),
            ("rate", file.rate.is_some()),
            ("points", file.points.is_some()),
            ("interpolation", file.interpolation.is_some()),
            ("sections", file.sections.is_some()),
        ])?;
        Ok(spec)
    }
}

impl<'de> Deserialize<'de> for Section {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        let mut file: SectionFile = object(reader)?;
        let (from, to) = (file.from, file.to);
        let section = match file.kind {
            SectionKind::Linear => {
                let modulus_kpa = take(&mut file.modulus_kpa, "modulus_kpa")?;
                Self::Linear { from, to, modulus_kpa }
            }
            SectionKind::Cubic => {
                let end_stress_kpa = take(&mut file.end_stress_kpa, "end_stress_kpa")?;
                let end_slope_kpa = take(&mut file.end_slope_kpa, "end_slope_kpa")?;
                Self::Cubic { from, to, end_stress_kpa, end_slope_kpa }
            }
            SectionKind::Polynomial => {
                let coefficients_kpa = take(&mut file.coefficients_kpa, "coefficients_kpa")?.0;
                Self::Polynomial { from, to, coefficients_kpa }
            }
            kind => {
                let scale_kpa = take(&mut file.scale_kpa, "scale_kpa")?;
                let rate = take(&mut file.rate, "rate")?;
                match kind {
                    SectionKind::Sine => Self::Sine { from, to, scale_kpa, rate },
                    SectionKind::Arctangent => Self::Arctangent { from, to, scale_kpa, rate },
                    _ => Self::Exponential { from, to, scale_kpa, rate },
                }
            }
        };
        reject_others(&[
            ("modulus_kpa", file.modulus_kpa.is_some()),
            ("end_stress_kpa", file.end_stress_kpa.is_some()),
            ("end_slope_kpa", file.end_slope_kpa.is_some()),
            ("coefficients_kpa", file.coefficients_kpa.is_some()),
            ("scale_kpa", file.scale_kpa.is_some()),
            ("rate", file.rate.is_some()),
        ])?;
        Ok(section)
    }
}

fn take<T, E: Error>(field: &mut Option<T>, name: &'static str) -> Result<T, E> {
    field.take().ok_or_else(|| E::missing_field(name))
}

/// Rejects fields of other kinds.
fn reject_others<E: Error>(fields: &[(&str, bool)]) -> Result<(), E> {
    match fields.iter().find(|(_, is_present)| *is_present) {
        Some((name, _)) => {
            Err(E::custom(format_args!("field `{name}` does not belong to this kind")))
        }
        None => Ok(()),
    }
}

/// Reads a structure from a JSON object only; serde also accepts a list of the fields in their order.
pub fn object<'de, T: Deserialize<'de>, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    struct Reader<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<T> {
        type Value = T;

        fn expecting(&self, text: &mut fmt::Formatter) -> fmt::Result {
            text.write_str("one JSON object")
        }

        fn visit_map<A: MapAccess<'de>>(self, fields: A) -> Result<T, A::Error> {
            T::deserialize(MapAccessDeserializer::new(fields))
        }
    }
    reader.deserialize_map(Reader(PhantomData))
}

/// An error of `null` in an optional field begins with this; what is allowed follows.
pub const GAP: &str = "null; allowed: ";

/// Reads a field that is present; `null` is rejected, as a gap is no value.
pub fn given<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<T>, D::Error> {
    present(reader).map(Some)
}

/// Reads a field that has a default and is present; `null` is rejected, as a gap is no value.
pub fn present<'de, T: Deserialize<'de>, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    struct Reader<T>(PhantomData<T>);
    impl<'de, T: Deserialize<'de>> Visitor<'de> for Reader<T> {
        type Value = T;

        fn expecting(&self, text: &mut fmt::Formatter) -> fmt::Result {
            text.write_str(&expected::<T>())
        }

        fn visit_some<D: Deserializer<'de>>(self, reader: D) -> Result<T, D::Error> {
            T::deserialize(reader)
        }

        fn visit_none<E: Error>(self) -> Result<T, E> {
            Err(E::custom(format_args!("{GAP}{}, or leave it out", expected::<T>())))
        }

        fn visit_unit<E: Error>(self) -> Result<T, E> {
            self.visit_none()
        }
    }
    reader.deserialize_option(Reader(PhantomData))
}

/// Reads an object that is present, as [`given`] and [`object`] do.
pub fn given_object<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> Result<Option<T>, D::Error> {
    present_object(reader).map(Some)
}

/// Reads an object that has a default and is present, as [`present`] and [`object`] do.
pub fn present_object<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    reader: D,
) -> Result<T, D::Error> {
    struct Object<T>(T);
    impl<'de, T: Deserialize<'de>> Deserialize<'de> for Object<T> {
        fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
            object(reader).map(Self)
        }
    }
    present(reader).map(|Object(read)| read)
}

/// What a type is read from, in the words of its error at an empty text.
fn expected<'de, T: Deserialize<'de>>() -> String {
    let empty: StrDeserializer<'_, ValueError> = "".into_deserializer();
    match T::deserialize(empty) {
        Ok(_) => "a text".to_owned(),
        Err(error) => {
            let line = error.to_string();
            let words = line.split_once(", expected ").map_or("a value", |(_, words)| words);
            words.trim_start_matches("one of ").to_owned()
        }
    }
}

/// Reads a whole number that has a default and is present, as [`present`] and [`whole`] do.
pub fn present_whole<'de, T: TryFrom<u64>, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    struct Whole<T>(T);
    impl<'de, T: TryFrom<u64>> Deserialize<'de> for Whole<T> {
        fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
            whole(reader).map(Self)
        }
    }
    present(reader).map(|Whole(read)| read)
}

/// Reads a whole number, 33.0 and 3.3e1 too.
///
/// # Errors
/// The number has a fraction or is out of the range of its type.
pub fn whole<'de, T: TryFrom<u64>, D: Deserializer<'de>>(reader: D) -> Result<T, D::Error> {
    struct Reader<T>(PhantomData<T>);
    impl<T: TryFrom<u64>> Visitor<'_> for Reader<T> {
        type Value = T;

        fn expecting(&self, text: &mut fmt::Formatter) -> fmt::Result {
            text.write_str("a whole number")
        }

        fn visit_u64<E: Error>(self, number: u64) -> Result<T, E> {
            T::try_from(number).map_err(|_| E::invalid_value(Unexpected::Unsigned(number), &self))
        }

        fn visit_f64<E: Error>(self, number: f64) -> Result<T, E> {
            let whole = whole_of(number).and_then(|whole| T::try_from(whole).ok());
            whole.ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))
        }
    }
    reader.deserialize_any(Reader(PhantomData))
}

/// The whole number of a real one, up to 2⁵³.
#[must_use]
pub fn whole_of(number: f64) -> Option<u64> {
    const MOST: f64 = 9_007_199_254_740_992.0;
    let is_whole = (0.0..=MOST).contains(&number) && number.fract() == 0.0;
    is_whole.then_some(number as u64)
}

/// A list of at most `MAX` entries; reading stops at the first surplus entry.
pub struct List<T, const MAX: usize>(pub Vec<T>);

impl<'de, T: Deserialize<'de>, const MAX: usize> Deserialize<'de> for List<T, MAX> {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct Reader<T, const MAX: usize>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>, const MAX: usize> Visitor<'de> for Reader<T, MAX> {
            type Value = Vec<T>;

            fn expecting(&self, text: &mut fmt::Formatter) -> fmt::Result {
                write!(text, "a list of at most {MAX} entries")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Vec<T>, A::Error> {
                let mut read = Vec::new();
                while read.len() < MAX {
                    match list.next_element()? {
                        Some(entry) => read.push(entry),
                        None => return Ok(read),
                    }
                }
                match list.next_element::<IgnoredAny>()? {
                    Some(_) => Err(A::Error::invalid_length(MAX + 1, &self)),
                    None => Ok(read),
                }
            }
        }
        reader.deserialize_seq(Reader::<T, MAX>(PhantomData)).map(Self)
    }
}

/// A pair of numbers.
#[derive(Clone, Copy, Default)]
pub struct Pair(pub [f64; 2]);

impl<'de> Deserialize<'de> for Pair {
    fn deserialize<D: Deserializer<'de>>(reader: D) -> Result<Self, D::Error> {
        struct Reader;
        impl<'de> Visitor<'de> for Reader {
            type Value = Pair;

            fn expecting(&self, text: &mut fmt::Formatter) -> fmt::Result {
                text.write_str("a list of 2 numbers")
            }

            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Pair, A::Error> {
                let mut pair = [0.0; 2];
                for (k, number) in pair.iter_mut().enumerate() {
                    let entry = list.next_element()?;
                    *number = entry.ok_or_else(|| A::Error::invalid_length(k, &self))?;
                }
                match list.next_element::<IgnoredAny>()? {
                    Some(_) => Err(A::Error::invalid_length(3, &self)),
                    None => Ok(Pair(pair)),
                }
            }
        }
        reader.deserialize_seq(Reader)
    }
}

/// Formats a number in few characters: 1e308 rather than 309 digits.
pub fn number(value: f64) -> String {
    if value != 0.0 && !(1e-4..1e6).contains(&value.abs()) {
        format!("{value:e}")
    } else {
        value.to_string()
    }
}
