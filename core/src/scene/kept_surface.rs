//! The surface of a body inside of a plan's file: reduced, in 16 bits, as text.

use crate::body::reduce::reduced;
use crate::body::surface::Surface;
use crate::curve::number;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use glam::DVec3;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Greatest number of vertices and of triangles.
const MOST_VERTICES: usize = 12_000;
const MOST_TRIANGLES: usize = 24_000;
/// Bytes of a vertex and of a triangle: three numbers of 16 bits.
const BYTES: usize = 6;
/// Greatest step of the coordinates \[mm\]: a body of 65 m.
const MOST_STEP_MM: f64 = 1.0;
/// Least step of the coordinates \[mm\].
const LEAST_STEP_MM: f64 = 1e-6;
/// Greatest coordinate \[mm\].
const GREATEST_MM: f64 = 1e7;

/// A body's surface in at most 12 000 vertices and 24 000 triangles, without colours. Copies have their triangles in common.
#[derive(Clone, Debug, Serialize, Deserialize)]
#[serde(try_from = "SurfaceFile", into = "SurfaceFile")]
pub struct KeptSurface {
    surface: Arc<Surface>,
    least: [f64; 3],
    step_mm: f64,
}

impl PartialEq for KeptSurface {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.surface, &other.surface)
            || self.step_mm == other.step_mm && self.surface == other.surface
    }
}

/// A kept surface in a file.
#[derive(Clone, Debug, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields, expecting = "one JSON object")]
#[schemars(rename = "BodySurface")]
pub(super) struct SurfaceFile {
    /// Least coordinates of the vertices, in the axes of the surface \[mm\].
    least_mm: [f64; 3],
    /// Step of the coordinates \[mm\], 0.000001 to 1.
    step_mm: f64,
    /// Base64 of three numbers of 16 bits, the low byte first, for each vertex: steps along x, y and z; 3 to 12 000 vertices.
    vertices: String,
    /// Base64 of three numbers of 16 bits, the low byte first, for each triangle: its vertices from 0, counter-clockwise seen from outside; 1 to
    /// 24 000 triangles.
    triangles: String,
}

impl KeptSurface {
    /// The surface of a body for its file: reduced where it has more vertices or triangles, the vertices moved by half a step at most, 0.02 mm of a
    /// standing body. `None` for one without triangles or beyond 65 m.
    #[must_use]
    pub fn of(surface: &Surface) -> Option<Self> {
        let mut reduced = reduced(surface, MOST_VERTICES, MOST_TRIANGLES);
        let [least, most] = reduced.bounds()?;
        // Vertices without triangles may lie outside of the bounds.
        let extent = (most - least).max_element();
        let step_mm = (extent / f64::from(u16::MAX)).max(LEAST_STEP_MM);
        let is_usable = step_mm <= MOST_STEP_MM && reduced.positions.len() >= 3;
        if !is_usable || least.abs().max_element() > GREATEST_MM {
            return None;
        }
        for position in &mut reduced.positions {
            *position = place(steps(*position, least, step_mm), least, step_mm);
        }
        Some(Self { surface: Arc::new(reduced), least: least.to_array(), step_mm })
    }

    /// The surface \[mm\].
    #[must_use]
    pub fn surface(&self) -> &Arc<Surface> {
        &self.surface
    }
}

/// Coordinates in steps from the least ones.
fn steps(position: DVec3, least: DVec3, step_mm: f64) -> [u16; 3] {
    // Saturates beyond the bounds.
    ((position - least) / step_mm).round().to_array().map(|x| x as u16)
}

/// The place of coordinates in steps \[mm\].
fn place(steps: [u16; 3], least: DVec3, step_mm: f64) -> DVec3 {
    least + DVec3::from(steps.map(f64::from)) * step_mm
}

impl From<KeptSurface> for SurfaceFile {
    fn from(KeptSurface { surface, least, step_mm }: KeptSurface) -> Self {
        let text = |triples: &mut dyn Iterator<Item = [u16; 3]>| {
            let bytes: Vec<u8> = triples.flatten().flat_map(u16::to_le_bytes).collect();
            STANDARD.encode(bytes)
        };
        let position = |p: &DVec3| steps(*p, least.into(), step_mm);
        // 12 000 vertices have indices of 16 bits.
        let triangle = |corners: &[u32; 3]| corners.map(|k| k as u16);
        Self {
            least_mm: least,
            step_mm,
            vertices: text(&mut surface.positions.iter().map(position)),
            triangles: text(&mut surface.triangles.iter().map(triangle)),
        }
    }
}

impl TryFrom<SurfaceFile> for KeptSurface {
    type Error = String;

    fn try_from(file: SurfaceFile) -> Result<Self, String> {
        let SurfaceFile { least_mm, step_mm, vertices, triangles } = file;
        if !(LEAST_STEP_MM..=MOST_STEP_MM).contains(&step_mm) {
            return Err(format!(
                "step_mm is {}; allowed: {LEAST_STEP_MM} to {MOST_STEP_MM} mm",
                number(step_mm)
            ));
        }
        if let Some(wrong) = least_mm.iter().find(|x| x.is_nan() || x.abs() > GREATEST_MM) {
            return Err(format!(
                "least_mm has {}; allowed: up to {GREATEST_MM} mm",
                number(*wrong)
            ));
        }
        let least = DVec3::from(least_mm);
        let position = |at: [u16; 3]| place(at, least, step_mm);
        let positions: Vec<DVec3> =
            triples("vertices", &vertices, 3..=MOST_VERTICES)?.map(position).collect();
        let triangles: Vec<[u32; 3]> = triples("triangles", &triangles, 1..=MOST_TRIANGLES)?
            .map(|corners| corners.map(u32::from))
            .collect();
        let count = positions.len();
        let is_missing = |corners: &[u32; 3]| corners.iter().any(|k| *k as usize >= count);
        if let Some(k) = triangles.iter().position(is_missing) {
            let most = triangles[k].iter().max().copied().unwrap_or_default();
            return Err(format!(
                "triangles: triangle {k} has vertex {most}; allowed: 0 to {}",
                count - 1
            ));
        }
        let surface = Surface { positions, triangles, colors: None };
        Ok(Self { surface: Arc::new(surface), least: least_mm, step_mm })
    }
}

/// Triples of numbers of a text.
fn triples(
    name: &str,
    text: &str,
    counts: std::ops::RangeInclusive<usize>,
) -> Result<impl Iterator<Item = [u16; 3]>, String> {
    let (least, most) = (counts.start(), counts.end());
    let allowed = format!("base64 of {BYTES} bytes each, {least} to {most} of them");
    let longest = (most * BYTES).div_ceil(3) * 4;
    if text.len() > longest {
        return Err(format!("{name} has {} characters; allowed: {allowed}", text.len()));
    }
    let bytes =
        STANDARD.decode(text).map_err(|error| format!("{name}: {error}; allowed: {allowed}"))?;
    if !bytes.len().is_multiple_of(BYTES) || !counts.contains(&(bytes.len() / BYTES)) {
        return Err(format!("{name} has {} bytes; allowed: {allowed}", bytes.len()));
    }
    let count = bytes.len() / BYTES;
    let number = move |k: usize| u16::from_le_bytes([bytes[2 * k], bytes[2 * k + 1]]);
    Ok((0..count).map(move |k| [0, 1, 2].map(|axis| number(3 * k + axis))))
}
