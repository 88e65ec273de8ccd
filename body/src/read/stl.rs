//! STL, ASCII and binary: the corners of triangles one by one.

use super::raw::Raw;
use super::text::{Lines, number, shown, words};
use super::{Error, MAX_TRIANGLES};
use glam::DVec3;

/// Header of a binary file with the number of its triangles, and a triangle \[bytes\].
const HEADER: usize = 84;
const TRIANGLE: usize = 50;

/// Whether the content has a sign of an STL file: the length of a binary one, or the first word of a text.
pub(super) fn is_stl(bytes: &[u8]) -> bool {
    has_length(bytes) || is_text(bytes)
}

/// Number of triangles by the header of a binary file.
fn count(bytes: &[u8]) -> Option<usize> {
    let bytes = bytes.get(HEADER - 4..HEADER)?.try_into().ok()?;
    Some(u32::from_le_bytes(bytes) as usize)
}

/// Whether the length is that of a binary file, which may begin with `solid` too.
fn has_length(bytes: &[u8]) -> bool {
    count(bytes).and_then(|count| count.checked_mul(TRIANGLE)?.checked_add(HEADER))
        == Some(bytes.len())
}

fn is_text(bytes: &[u8]) -> bool {
    let start = bytes.trim_ascii_start();
    start.get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"))
        && !start[..start.len().min(1000)].contains(&0)
}

pub(super) fn read(bytes: &[u8]) -> Result<Raw, Error> {
    let mut raw = Raw { is_soup: true, ..Raw::default() };
    if is_text(bytes) && !has_length(bytes) {
        read_text(bytes, &mut raw)?;
    } else {
        read_binary(bytes, &mut raw)?;
    }
    Ok(raw)
}

fn read_binary(bytes: &[u8], raw: &mut Raw) -> Result<(), Error> {
    let Some(count) = count(bytes) else {
        return Err(Error::damaged(format_args!(
            "byte {}: it ends in the header of an STL file",
            bytes.len()
        )));
    };
    let found = (bytes.len() - HEADER) / TRIANGLE;
    let is_text =
        bytes[..HEADER].iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
    if count > found && is_text {
        return Err(Error::damaged("an STL text begins with \"solid\""));
    }
    if count > found {
        return Err(Error::damaged(format_args!(
            "byte {}: it ends after {found} of {count} triangles",
            bytes.len()
        )));
    }
    if count > MAX_TRIANGLES {
        return Err(Error(format!(
            "the surface has {count} triangles; allowed: up to 2 million; export it with fewer"
        )));
    }
    raw.positions.reserve_exact(3 * count);
    for triangle in bytes[HEADER..].chunks_exact(TRIANGLE).take(count) {
        // A normal, three corners, two bytes without a common meaning.
        for corner in triangle[12..48].chunks_exact(12) {
            let value =
                |k: usize| f32::from_le_bytes([0, 1, 2, 3].map(|byte| corner[4 * k + byte]));
            raw.vertex(DVec3::new(value(0).into(), value(1).into(), value(2).into()))?;
        }
        triangle_of_last(raw)?;
    }
    Ok(())
}

/// Adds the triangle of the last three vertices.
fn triangle_of_last(raw: &mut Raw) -> Result<(), Error> {
    let end = raw.positions.len() as u32;
    raw.face(&[end - 3, end - 2, end - 1])
}

fn read_text(bytes: &[u8], raw: &mut Raw) -> Result<(), Error> {
    let mut lines = Lines::new(bytes);
    let (mut corners, mut is_open) = (0, false);
    while let Some(line) = lines.next() {
        let mut words = words(line);
        let Some(word) = words.next() else { continue };
        let fault = |what: String| Error::damaged(format_args!("line {}: {what}", lines.number));
        match word.to_ascii_lowercase().as_slice() {
            b"vertex" => {
                let mut value = || words.next().and_then(number);
                let (Some(x), Some(y), Some(z)) = (value(), value(), value()) else {
                    return Err(fault("a vertex without three numbers".to_owned()));
                };
                raw.vertex(DVec3::new(x, y, z))?;
                corners += 1;
            }
            b"endloop" if corners == 3 => {
                triangle_of_last(raw)?;
                corners = 0;
            }
            b"endloop" => {
                return Err(fault(format!("a facet of {corners} vertices; allowed: 3")));
            }
            b"solid" => is_open = true,
            b"endsolid" if corners == 0 => is_open = false,
            b"facet" | b"outer" | b"endfacet" => {}
            _ => {
                let word = shown(word);
                return Err(fault(format!(
                    "\"{word}\" is no word of an STL file, as facet or vertex"
                )));
            }
        }
    }
    if is_open {
        let line = lines.number;
        return Err(Error::damaged(format_args!("line {line}: it ends before \"endsolid\"")));
    }
    Ok(())
}
