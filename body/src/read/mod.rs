//! Readers of surfaces: PLY, STL, OBJ and GLB, as text or binary, then [cleaning](Cleaned).
//!
//! `text` (lines, words, numbers) → `raw` (what a file contains) → `ply` | `stl` | `obj` | `glb` → `clean`.

mod clean;
mod glb;
mod obj;
mod ply;
mod raw;
mod stl;
mod text;

use crate::surface::Surface;
pub use clean::Cleaned;
pub use implant_preview_solver::export::Format;

/// Greatest length of a file \[bytes\]: as many triangles in binary STL.
pub const MAX_BYTES: usize = 84 + 50 * MAX_TRIANGLES;
/// Greatest number of triangles.
pub const MAX_TRIANGLES: usize = 2_000_000;
/// Greatest number of vertices: the corners of all triangles.
const MAX_VERTICES: usize = 3 * MAX_TRIANGLES;

/// A file that is no surface: one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Error(String);

impl Error {
    /// A damaged file: where and what, and what a user can do.
    fn damaged(fault: impl std::fmt::Display) -> Self {
        Self(format!("the file is damaged: {fault}; export the surface again, as PLY or STL"))
    }
}

/// Unit of the lengths of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Millimetres.
    Mm,
    /// Centimetres.
    Cm,
    /// Metres.
    M,
}

impl Unit {
    /// All units.
    pub const ALL: [Self; 3] = [Self::Mm, Self::Cm, Self::M];

    /// The unit's symbol.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Mm => "mm",
            Self::Cm => "cm",
            Self::M => "m",
        }
    }

    /// The unit's length \[mm\].
    #[must_use]
    pub const fn factor(self) -> f64 {
        match self {
            Self::Mm => 1.0,
            Self::Cm => 10.0,
            Self::M => 1000.0,
        }
    }

    /// The unit in which a torso has this extent: a trunk is 0.4 to 1 m long, a whole body up to 2 m, and no surface of less
    /// than 25 cm holds a patch of tissue.
    #[must_use]
    pub fn of_extent(extent: f64) -> Self {
        match extent {
            ..3.0 => Self::M,
            ..250.0 => Self::Cm,
            _ => Self::Mm,
        }
    }
}

/// The surface of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Read {
    /// The surface \[mm\], in the axes of the file.
    pub surface: Surface,
    /// Unit of the file's lengths, by the extent of the surface.
    pub unit: Unit,
    /// Format of the file.
    pub format: Format,
    /// What was dropped, split or turned.
    pub cleaned: Cleaned,
}

impl Read {
    /// Sets the unit of the file's lengths; the surface is scaled.
    pub fn set_unit(&mut self, unit: Unit) {
        let factor = unit.factor() / self.unit.factor();
        self.surface.positions.iter_mut().for_each(|position| *position *= factor);
        self.unit = unit;
    }
}

/// The surface of a file. The content decides on the format, the extension of the name where the content has no sign.
///
/// # Errors
/// No surface, damaged, or longer than [`MAX_BYTES`] or [`MAX_TRIANGLES`]; one line.
pub fn read(bytes: &[u8], name: &str) -> Result<Read, Error> {
    if bytes.len() > MAX_BYTES {
        let tenths = bytes.len().div_ceil(100_000) as f64 / 10.0;
        let line = format!("the file has {tenths} MB; allowed: up to 100 MB");
        return Err(Error(line));
    }
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let format = format_of(bytes, name)?;
    let raw = match format {
        Format::Ply => ply::read(bytes),
        Format::Stl => stl::read(bytes),
        Format::Obj => obj::read(bytes),
        Format::Glb => glb::read(bytes),
    }?;
    clean::clean(raw, format)
}

fn format_of(bytes: &[u8], name: &str) -> Result<Format, Error> {
    if bytes.is_empty() {
        return Err(Error(
            "the file is empty; allowed: a surface as PLY, STL, OBJ or GLB".to_owned(),
        ));
    }
    let by_content = match bytes {
        [b'p', b'l', b'y', b'\n' | b'\r', ..] => Some(Format::Ply),
        [b'g', b'l', b'T', b'F', ..] => Some(Format::Glb),
        _ if stl::is_stl(bytes) => Some(Format::Stl),
        _ if obj::is_obj(bytes) => Some(Format::Obj),
        _ => None,
    };
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    match by_content.or(Format::of_extension(extension)) {
        Some(Format::Ply) if by_content.is_none() => Err(begins("PLY", "ply")),
        Some(Format::Glb) if by_content.is_none() => Err(begins("GLB", "glTF")),
        Some(format) => Ok(format),
        None if bytes.trim_ascii_start().starts_with(b"{") => {
            Err(Error("glTF as text is not read; export it as GLB, in one file".to_owned()))
        }
        None if bytes.starts_with(b"PK") => {
            Err(Error("the file is an archive (ZIP); unpack the surface in it".to_owned()))
        }
        None => Err(Error(
            "the format of the file is unknown; allowed: a surface as PLY, STL, OBJ or GLB"
                .to_owned(),
        )),
    }
}

fn begins(format: &str, sign: &str) -> Error {
    Error::damaged(format_args!("a {format} file begins with \"{sign}\""))
}
