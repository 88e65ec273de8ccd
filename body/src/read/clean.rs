//! From the content of a file to a surface: unusable vertices and faces dropped, polygons split, turned outside, in mm.

use super::raw::Raw;
use super::{Error, Format, Read, Unit};
use crate::surface::{Surface, count_parts, weld};
use glam::DVec3;

/// Greatest coordinate of a vertex, in any unit.
const MAX_COORDINATE: f64 = 1e7;
/// Mark of a dropped vertex.
const DROPPED: u32 = u32::MAX;
/// Volume of a surface without a direction, relative to that of a cube of its area \[-\].
const NO_VOLUME: f64 = 1e-6;
/// Greatest number of corners from which the triangles of a polygon are tried.
const MAX_FANS: usize = 16;

/// What a reader dropped, split or turned.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Cleaned {
    /// Vertices without three finite coordinates up to 10⁷, dropped with their faces.
    pub dropped_vertices: usize,
    /// Faces of dropped vertices, dropped.
    pub dropped_faces: usize,
    /// Faces with a vertex that the file does not have, dropped.
    pub bad_faces: usize,
    /// The first of them, from 1; 0 without one.
    pub first_bad_face: usize,
    /// Triangles without an area, dropped.
    pub degenerate_triangles: usize,
    /// Faces of more than three corners, split.
    pub split_faces: usize,
    /// Vertices at the position of an earlier one, kept; in STL files every corner is one, which are merged and not counted.
    pub repeated_vertices: usize,
    /// Whether the surface was inside out and was turned.
    pub is_turned: bool,
    /// Whether the file has colours in a texture only, which are not read.
    pub has_texture: bool,
    /// Parts without a common position, all kept.
    pub parts: usize,
}

impl Cleaned {
    /// A sentence for each change.
    #[must_use]
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let mut note = |count: usize, text: &str| {
            if count > 0 {
                notes.push(text.replace('#', &count.to_string()));
            }
        };
        note(self.dropped_vertices, "Vertices that are not finite, dropped: #.");
        note(self.dropped_faces, "Faces of such vertices, dropped: #.");
        let first = self.first_bad_face;
        let bad = format!(
            "Faces of vertices that the file does not have, dropped: # (the first is face {first})."
        );
        note(self.bad_faces, &bad);
        note(self.degenerate_triangles, "Triangles without an area, dropped: #.");
        note(self.split_faces, "Polygons split into triangles: #.");
        note(self.repeated_vertices, "Vertices at the place of another one: #.");
        note(usize::from(self.is_turned), "The surface was inside out and is turned round.");
        note(usize::from(self.has_texture), "The colours of the texture are left out.");
        if self.parts > 1 {
            note(self.parts, "Parts that are not connected: #.");
        }
        notes
    }
}

/// The surface of a file's content.
pub(super) fn clean(mut raw: Raw, format: Format) -> Result<Read, Error> {
    let mut cleaned = Cleaned::default();
    let index = vertices(&mut raw, &mut cleaned);
    let triangles = triangles(&raw, &index, &mut cleaned);
    if triangles.is_empty() {
        return Err(no_triangles(&raw, &cleaned));
    }
    let colors = (raw.colors.len() == raw.positions.len()).then_some(raw.colors);
    cleaned.has_texture = raw.has_texture && colors.is_none();
    let mut surface = Surface { positions: raw.positions, triangles, colors };
    let [least, most] = surface.bounds().unwrap_or_default();
    let unit = Unit::of_extent((most - least).max_element());
    if unit != Unit::Mm {
        surface.positions.iter_mut().for_each(|position| *position *= unit.factor());
    }
    let area = surface.area();
    if surface.signed_volume() < -NO_VOLUME * area * area.sqrt() {
        surface.turn();
        cleaned.is_turned = true;
    }
    if raw.is_soup {
        let own: Vec<u32> = (0..surface.positions.len() as u32).collect();
        cleaned.parts = count_parts(&own, &surface.triangles);
    } else {
        let welded = surface.weld();
        let is_repeated = |(k, first): &(usize, &u32)| *k != **first as usize;
        cleaned.repeated_vertices = welded.iter().enumerate().filter(is_repeated).count();
        cleaned.parts = count_parts(&welded, &surface.triangles);
    }
    Ok(Read { surface, unit, format, cleaned })
}

fn no_triangles(raw: &Raw, cleaned: &Cleaned) -> Error {
    let (vertices, faces) = (raw.positions.len(), raw.sizes.len());
    if faces == 0 {
        let line = format!(
            "the file has {vertices} points and no surface; export the surface as triangles, as PLY or STL"
        );
        Error(line)
    } else if cleaned.bad_faces == faces {
        Error::damaged(format_args!("all {faces} faces have corners beyond its {vertices} points"))
    } else {
        Error::damaged(format_args!("none of its {faces} faces is a triangle with an area"))
    }
}

/// Drops vertices that are not finite and merges the corners of a soup; returns the new index of each vertex.
fn vertices(raw: &mut Raw, cleaned: &mut Cleaned) -> Vec<u32> {
    let is_usable =
        |position: &DVec3| position.abs().max_element() <= MAX_COORDINATE && !position.is_nan();
    let has_all = raw.positions.iter().all(is_usable);
    if has_all && !raw.is_soup {
        return (0..raw.positions.len() as u32).collect();
    }
    let has_colors = raw.colors.len() == raw.positions.len();
    let mut index = vec![DROPPED; raw.positions.len()];
    let mut kept = 0;
    for k in 0..raw.positions.len() {
        if is_usable(&raw.positions[k]) {
            raw.positions[kept] = raw.positions[k];
            if has_colors {
                raw.colors[kept] = raw.colors[k];
            }
            index[k] = kept as u32;
            kept += 1;
        }
    }
    cleaned.dropped_vertices = raw.positions.len() - kept;
    raw.positions.truncate(kept);
    raw.colors.truncate(kept);
    if raw.is_soup {
        let mut welded = weld(&raw.positions);
        let mut kept = 0;
        for k in 0..welded.len() {
            let first = welded[k] as usize;
            if first == k {
                raw.positions[kept] = raw.positions[k];
                welded[k] = kept as u32;
                kept += 1;
            } else {
                welded[k] = welded[first];
            }
        }
        raw.positions.truncate(kept);
        let of_kept = |k: &u32| if *k == DROPPED { DROPPED } else { welded[*k as usize] };
        index = index.iter().map(of_kept).collect();
    }
    index
}

/// The faces with usable vertices as triangles with an area.
fn triangles(raw: &Raw, index: &[u32], cleaned: &mut Cleaned) -> Vec<[u32; 3]> {
    let mut triangles = Vec::with_capacity(raw.sizes.len());
    let (mut rest, mut face) = (raw.corners.as_slice(), Vec::new());
    for (number, size) in raw.sizes.iter().enumerate() {
        let (own, behind) = rest.split_at(*size as usize);
        rest = behind;
        face.clear();
        face.extend(own.iter().filter_map(|k| index.get(*k as usize)));
        if face.len() < own.len() {
            cleaned.bad_faces += 1;
            if cleaned.first_bad_face == 0 {
                cleaned.first_bad_face = number + 1;
            }
        } else if face.contains(&DROPPED) {
            cleaned.dropped_faces += 1;
        } else {
            cleaned.split_faces += usize::from(face.len() > 3);
            cleaned.degenerate_triangles += usize::from(face.len() < 3);
            let first = if face.len() > 3 { best_fan(&face, &raw.positions) } else { 0 };
            for triangle in fan(&face, first) {
                if doubled_area(triangle, &raw.positions).length_squared() > 0.0 {
                    triangles.push(triangle);
                } else {
                    cleaned.degenerate_triangles += 1;
                }
            }
        }
    }
    triangles
}

/// The triangles of a polygon that have one of its corners in common.
fn fan(face: &[u32], first: usize) -> impl Iterator<Item = [u32; 3]> {
    let at = move |k: usize| face[(first + k) % face.len()];
    (2..face.len()).map(move |k| [at(0), at(k - 1), at(k)])
}

/// Twice the area of a triangle, along its normal.
fn doubled_area(triangle: [u32; 3], positions: &[DVec3]) -> DVec3 {
    let [a, b, c] = triangle.map(|k| positions[k as usize]);
    (b - a).cross(c - a)
}

/// The corner whose least triangle is greatest, seen along the polygon's normal: of a polygon with one reflex corner it is a
/// corner from which all triangles lie inside.
fn best_fan(face: &[u32], positions: &[DVec3]) -> usize {
    let normal: DVec3 = fan(face, 0).map(|triangle| doubled_area(triangle, positions)).sum();
    let least = |first: usize| {
        let areas = fan(face, first).map(|triangle| doubled_area(triangle, positions).dot(normal));
        areas.fold(f64::INFINITY, f64::min)
    };
    let fans = (0..face.len().min(MAX_FANS)).map(|first| (first, least(first)));
    fans.reduce(|best, next| if next.1 > best.1 { next } else { best })
        .map_or(0, |(first, _)| first)
}
