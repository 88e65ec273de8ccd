//! Wavefront OBJ: vertices with or without colours, and faces; all other lines are ignored.

use super::Error;
use super::raw::{NO_VERTEX, Raw};
use super::text::{Lines, number, shown, words};
use glam::DVec3;

/// Whether one of the first lines of the content is a vertex.
pub(super) fn is_obj(bytes: &[u8]) -> bool {
    let start = &bytes[..bytes.len().min(10_000)];
    Lines::new(start).any(|line| {
        let mut words = words(line);
        words.next() == Some(b"v") && words.take(3).filter_map(number).count() == 3
    })
}

pub(super) fn read(bytes: &[u8]) -> Result<Raw, Error> {
    let mut file = File::default();
    let mut lines = Lines::new(bytes);
    let mut joined = Vec::new();
    while let Some(line) = lines.next() {
        file.line = lines.number;
        match line.trim_ascii_end().strip_suffix(b"\\") {
            None => file.read(line),
            Some(start) => {
                joined.clear();
                joined.extend_from_slice(start);
                // A backslash at the end continues a line.
                for line in lines.by_ref() {
                    joined.push(b' ');
                    let end = line.trim_ascii_end().strip_suffix(b"\\");
                    joined.extend_from_slice(end.unwrap_or(line));
                    if end.is_none() {
                        break;
                    }
                }
                file.read(&joined)
            }
        }?;
    }
    // Colours are fractions or bytes.
    let most = file.colors.iter().flatten().fold(0.0, |most: f32, value| most.max(*value));
    let scale = if most > 1.0 { 1.0 } else { 255.0 };
    let color = |color: &[f32; 3]| color.map(|value| (value * scale).round() as u8);
    file.raw.colors = file.colors.iter().map(color).collect();
    Ok(file.raw)
}

#[derive(Default)]
struct File {
    raw: Raw,
    colors: Vec<[f32; 3]>,
    /// The corners of a face.
    corners: Vec<u32>,
    /// Number of the present line.
    line: usize,
}

impl File {
    fn fault(&self, what: std::fmt::Arguments<'_>) -> Error {
        Error::damaged(format_args!("line {}: {what}", self.line))
    }

    fn read(&mut self, line: &[u8]) -> Result<(), Error> {
        let mut words = words(line);
        match words.next() {
            Some(b"v") => self.vertex(words),
            Some(b"f") => self.face(words),
            _ => Ok(()),
        }
    }

    /// Three coordinates; a weight behind them is ignored; six numbers end in a colour.
    fn vertex<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Error> {
        let (mut values, mut count) = ([0.0; 6], 0);
        for word in words.take(6) {
            values[count] = number(word)
                .ok_or_else(|| self.fault(format_args!("\"{}\" is no number", shown(word))))?;
            count += 1;
        }
        if count < 3 {
            let what = format_args!("a vertex of {count} numbers; allowed: 3, or 6 with a colour");
            return Err(self.fault(what));
        }
        let [x, y, z, r, g, b] = values;
        if count == 6 {
            self.colors.push([r as f32, g as f32, b as f32]);
        }
        self.raw.vertex(DVec3::new(x, y, z))
    }

    /// Corners as `vertex`, `vertex/texture` or `vertex/texture/normal`, from 1, or from the end below 0.
    fn face<'a>(&mut self, words: impl Iterator<Item = &'a [u8]>) -> Result<(), Error> {
        self.corners.clear();
        for word in words {
            let index = word.split(|byte| *byte == b'/').next().unwrap_or_default();
            let index = std::str::from_utf8(index).ok().and_then(|text| text.parse::<i64>().ok());
            let corner = match index {
                Some(index @ 1..) => u32::try_from(index - 1).unwrap_or(NO_VERTEX),
                Some(index @ ..0) => {
                    let from_start = (self.raw.positions.len() as i64).checked_add(index);
                    from_start.and_then(|k| u32::try_from(k).ok()).unwrap_or(NO_VERTEX)
                }
                Some(0) | None => {
                    let word = shown(word);
                    let allowed = "a whole number from 1, or from the end below 0";
                    return Err(
                        self.fault(format_args!("\"{word}\" is no vertex; allowed: {allowed}"))
                    );
                }
            };
            self.corners.push(corner);
        }
        self.raw.face(&self.corners)
    }
}
