//! PLY: ASCII, binary little and big endian. Elements other than `vertex` and `face`, and unknown properties, are skipped.

use super::raw::{NO_VERTEX, Raw};
use super::text::{Lines, number, shown, words};
use super::{Error, MAX_VERTICES};
use glam::DVec3;

/// How values are written.
#[derive(Clone, Copy, PartialEq)]
enum Form {
    Ascii,
    Little,
    Big,
}

#[derive(Clone, Copy, PartialEq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Kind {
    fn of_name(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Factor from a value to a byte of a colour.
    fn color_scale(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 255.0,
            Self::U16 => 1.0 / 257.0,
            _ => 1.0,
        }
    }
}

struct Property<'a> {
    name: &'a [u8],
    kind: Kind,
    /// Type of the length of a list.
    length: Option<Kind>,
}

struct Element<'a> {
    name: &'a [u8],
    count: u64,
    properties: Vec<Property<'a>>,
}

pub(super) fn read(bytes: &[u8]) -> Result<Raw, Error> {
    let mut lines = Lines::new(bytes);
    let (form, elements) = header(&mut lines)
        .map_err(|what| Error::damaged(format_args!("line {}: {what}", lines.number.max(1))))?;
    let mut data = Data { bytes, at: lines.at.min(bytes.len()), line: lines.number + 1, form };
    let mut raw = Raw::default();
    for element in elements.iter().filter(|element| !element.properties.is_empty()) {
        data.check_length(element)?;
        match element.name {
            b"vertex" => vertices(element, &mut data, &mut raw)?,
            b"face" => faces(element, &mut data, &mut raw)?,
            _ => {
                for row in 0..element.count {
                    let skipped = element.properties.iter().try_for_each(|p| data.skip(p));
                    skipped.map_err(|what| data.fault(element, row, &what))?;
                }
            }
        }
    }
    Ok(raw)
}

/// The lines up to `end_header`; an error is without its line.
fn header<'a>(lines: &mut Lines<'a>) -> Result<(Form, Vec<Element<'a>>), String> {
    let (mut form, mut elements) = (None, Vec::<Element>::new());
    lines.next();
    for line in lines.by_ref() {
        let mut words = words(line);
        match words.next().unwrap_or_default() {
            b"format" => form = Some(format(words.next().unwrap_or_default())?),
            b"element" => {
                let name = words.next().unwrap_or_default();
                let count = std::str::from_utf8(words.next().unwrap_or_default()).ok();
                let count = count.and_then(|count| count.parse().ok());
                let count = count.ok_or("an element without a number of rows")?;
                elements.push(Element { name, count, properties: Vec::new() });
            }
            b"property" => {
                let element = elements.last_mut().ok_or("a property before an element")?;
                let mut kind = || {
                    let word = words.next().unwrap_or_default();
                    match word {
                        b"list" => Ok(None),
                        _ => Kind::of_name(word).map(Some).ok_or_else(|| {
                            let word = shown(word);
                            format!("\"{word}\" is no type; allowed: char to uint, float, double")
                        }),
                    }
                };
                let (length, kind) = match kind()? {
                    Some(own) => (None, Some(own)),
                    None => (kind()?, kind()?),
                };
                let kind = kind.ok_or("a list of lists; allowed: a list of numbers")?;
                let name = words.next().unwrap_or_default();
                element.properties.push(Property { name, kind, length });
            }
            b"end_header" => {
                return Ok((form.ok_or("the header has no line \"format\"")?, elements));
            }
            b"comment" | b"obj_info" | b"" => {}
            word => return Err(format!("\"{}\" is no word of a PLY header", shown(word))),
        }
    }
    Err("it ends before \"end_header\"".to_owned())
}

fn format(word: &[u8]) -> Result<Form, String> {
    match word {
        b"ascii" => Ok(Form::Ascii),
        b"binary_little_endian" => Ok(Form::Little),
        b"binary_big_endian" => Ok(Form::Big),
        _ => Err(format!(
            "format \"{}\"; allowed: ascii, binary_little_endian, binary_big_endian",
            shown(word)
        )),
    }
}

fn vertices(element: &Element, data: &mut Data, raw: &mut Raw) -> Result<(), Error> {
    let names: [&[&[u8]]; 6] = [
        &[b"x"],
        &[b"y"],
        &[b"z"],
        &[b"red", b"r", b"diffuse_red"],
        &[b"green", b"g", b"diffuse_green"],
        &[b"blue", b"b", b"diffuse_blue"],
    ];
    let place = |property: &Property| {
        let place = names.iter().position(|names| names.contains(&property.name));
        place.filter(|_| property.length.is_none())
    };
    let places: Vec<Option<usize>> = element.properties.iter().map(place).collect();
    if let Some(k) = (0..3).find(|k| !places.contains(&Some(*k))) {
        let name = shown(names[k][0]);
        return Err(Error::damaged(format_args!("the vertices have no {name}; needed: x, y, z")));
    }
    let has_colors = (3..6).all(|k| places.contains(&Some(k)));
    let expected = usize::try_from(element.count).unwrap_or(usize::MAX).min(MAX_VERTICES);
    raw.positions.reserve_exact(expected);
    let mut values = [0.0; 6];
    for row in 0..element.count {
        for (property, place) in element.properties.iter().zip(&places) {
            let read = match place {
                Some(place) => data.value(property.kind).map(|value| {
                    let scale = if *place < 3 { 1.0 } else { property.kind.color_scale() };
                    values[*place] = value * scale;
                }),
                None => data.skip(property),
            };
            read.map_err(|what| data.fault(element, row, &what))?;
        }
        let [x, y, z, r, g, b] = values;
        raw.vertex(DVec3::new(x, y, z))?;
        if has_colors {
            raw.colors.push([r, g, b].map(|value| value.round() as u8));
        }
    }
    Ok(())
}

fn faces(element: &Element, data: &mut Data, raw: &mut Raw) -> Result<(), Error> {
    let is_corners = |property: &Property| {
        property.length.is_some() && matches!(property.name, b"vertex_indices" | b"vertex_index")
    };
    if !element.properties.iter().any(is_corners) {
        return Err(Error::damaged("the faces have no corners (vertex_indices)"));
    }
    let mut corners = Vec::new();
    for row in 0..element.count {
        for property in &element.properties {
            let read = if is_corners(property) {
                data.indices(property, &mut corners)
            } else {
                data.skip(property)
            };
            read.map_err(|what| data.fault(element, row, &what))?;
        }
        raw.face(&corners)?;
    }
    Ok(())
}

/// The rows behind the header.
struct Data<'a> {
    bytes: &'a [u8],
    at: usize,
    /// Line of an ASCII file.
    line: usize,
    form: Form,
}

impl Data<'_> {
    fn fault(&self, element: &Element, row: u64, what: &str) -> Error {
        let place = match self.form {
            Form::Ascii => format!("line {}", self.line),
            _ => format!("byte {}", self.at),
        };
        let (name, count) = (shown(element.name), element.count);
        Error::damaged(format_args!("{place}, {name} {} of {count}: {what}", row + 1))
    }

    /// Checks that the rows of an element fit into the rest of the file.
    fn check_length(&self, element: &Element) -> Result<(), Error> {
        let least = |property: &Property| match self.form {
            Form::Ascii => 2,
            _ => property.length.unwrap_or(property.kind).bytes() as u64,
        };
        let row: u64 = element.properties.iter().map(least).sum();
        // No blank is needed behind the last number of a text.
        let rest = (self.bytes.len() - self.at) as u64 + u64::from(self.form == Form::Ascii);
        if element.count > rest / row {
            let (name, count) = (shown(element.name), element.count);
            return Err(Error::damaged(format_args!(
                "of {count} rows of \"{name}\" the file has {} at most",
                rest / row
            )));
        }
        Ok(())
    }

    fn value(&mut self, kind: Kind) -> Result<f64, String> {
        if self.form == Form::Ascii {
            let word = self.word().ok_or("it ends")?;
            return number(word).ok_or_else(|| format!("\"{}\" is no number", shown(word)));
        }
        let size = kind.bytes();
        let own = self.bytes.get(self.at..self.at + size).ok_or("it ends")?;
        self.at += size;
        let shifted = |word: u64, byte: &u8| word << 8 | u64::from(*byte);
        let word = match self.form {
            Form::Big => own.iter().fold(0, shifted),
            _ => own.iter().rev().fold(0, shifted),
        };
        Ok(match kind {
            Kind::I8 => f64::from(word as i8),
            Kind::U8 => f64::from(word as u8),
            Kind::I16 => f64::from(word as i16),
            Kind::U16 => f64::from(word as u16),
            Kind::I32 => f64::from(word as i32),
            Kind::U32 => f64::from(word as u32),
            Kind::F32 => f64::from(f32::from_bits(word as u32)),
            Kind::F64 => f64::from_bits(word),
        })
    }

    /// The next word of a text, across lines.
    fn word(&mut self) -> Option<&[u8]> {
        let rest = &self.bytes[self.at..];
        let start = rest.iter().position(|byte| !byte.is_ascii_whitespace())?;
        self.line += rest[..start].iter().filter(|byte| **byte == b'\n').count();
        let length = rest[start..].iter().position(u8::is_ascii_whitespace);
        let end = length.map_or(rest.len(), |length| start + length);
        self.at += end;
        Some(&rest[start..end])
    }

    /// The length of a list, within the rest of the file.
    fn length(&mut self, length: Kind, kind: Kind) -> Result<usize, String> {
        let value = self.value(length)?;
        let least = if self.form == Form::Ascii { 1 } else { kind.bytes() };
        let most = (self.bytes.len() - self.at) / least;
        if !(0.0..=most as f64).contains(&value) || value.fract() > 0.0 {
            // A number of 300 digits is no line.
            let value = if value.abs() < 1e12 { value.to_string() } else { format!("{value:e}") };
            return Err(format!(
                "a list of {value} numbers; the rest of the file has up to {most}"
            ));
        }
        Ok(value as usize)
    }

    fn indices(&mut self, property: &Property, corners: &mut Vec<u32>) -> Result<(), String> {
        corners.clear();
        let length = self.length(property.length.unwrap_or(property.kind), property.kind)?;
        for _ in 0..length {
            let value = self.value(property.kind)?;
            let is_index = (0.0..f64::from(NO_VERTEX)).contains(&value);
            corners.push(if is_index { value as u32 } else { NO_VERTEX });
        }
        Ok(())
    }

    fn skip(&mut self, property: &Property) -> Result<(), String> {
        let count = match property.length {
            Some(length) => self.length(length, property.kind)?,
            None => 1,
        };
        if self.form != Form::Ascii {
            let end = self.at + count * property.kind.bytes();
            self.at = Some(end).filter(|end| *end <= self.bytes.len()).ok_or("it ends")?;
            return Ok(());
        }
        (0..count).try_for_each(|_| self.word().map(|_| ()).ok_or_else(|| "it ends".to_owned()))
    }
}
