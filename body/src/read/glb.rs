//! Binary glTF 2.0: the triangles of all meshes of the scene, moved by their nodes, with the colours of their vertices.
//!
//! Textures, skins, animations and normals are ignored. Positions keep the axes of the file.

use super::Error;
use super::raw::Raw;
use glam::{DMat4, DQuat, DVec3};
use implant_preview_solver::export::srgb;
use serde_json::Value;

/// Primitives as three vertices a triangle, a strip, a fan.
const TRIANGLES: u64 = 4;
const STRIP: u64 = 5;
const FAN: u64 = 6;

pub(super) fn read(bytes: &[u8]) -> Result<Raw, Error> {
    let (text, data) = chunks(bytes)?;
    let text = text.trim_ascii_end();
    let text = &text[..text.iter().rposition(|byte| *byte != 0).map_or(0, |last| last + 1)];
    let json = serde_json::from_slice(text).map_err(|error| {
        let (line, column) = (error.line(), error.column());
        Error::damaged(format_args!("line {line}, column {column} of its description (JSON)"))
    })?;
    let file = File { json, data };
    file.check_extensions()?;
    let mut raw = Raw { has_texture: !file.list("textures").is_empty(), ..Raw::default() };
    let mut is_seen = vec![false; file.list("nodes").len()];
    let mut open: Vec<(usize, DMat4)> = Vec::new();
    open.extend(file.roots().into_iter().rev().map(|node| (node, DMat4::IDENTITY)));
    while let Some((index, parent)) = open.pop() {
        let node = file.item("nodes", index)?;
        if std::mem::replace(&mut is_seen[index], true) {
            return Err(Error::damaged(format_args!(
                "part {index} (nodes) stands in itself or twice"
            )));
        }
        let own = parent
            * matrix(node).ok_or_else(|| {
                Error::damaged(format_args!("the place of part {index} (nodes) is not finite"))
            })?;
        if let Some(mesh) = whole(member(node, "mesh")) {
            // The node of a mesh with a skeleton does not move it.
            let own = if member(node, "skin").is_number() { DMat4::IDENTITY } else { own };
            file.mesh(mesh, own, &mut raw)?;
        }
        let children = entries(member(node, "children")).iter().rev();
        open.extend(children.filter_map(whole).map(|child| (child, own)));
    }
    Ok(raw)
}

/// The chunks JSON and BIN; BIN may be missing.
fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), Error> {
    let word = |at: usize| {
        let word = bytes.get(at..at + 4).and_then(|word| word.try_into().ok());
        let ends =
            || Error::damaged(format_args!("byte {}: it ends in a header of GLB", bytes.len()));
        word.map(u32::from_le_bytes).ok_or_else(ends)
    };
    let (version, length) = (word(4)?, word(8)? as usize);
    if version != 2 {
        let line = format!("the file is glTF {version}; allowed: glTF 2, as GLB, or PLY or STL");
        return Err(Error(line));
    }
    if length > bytes.len() {
        let here = bytes.len();
        return Err(Error::damaged(format_args!("it ends after {here} of {length} bytes")));
    }
    let chunk = |at: usize, kind: &[u8; 4]| {
        let end = (at + 8).saturating_add(word(at)? as usize);
        let is_kind = bytes.get(at + 4..at + 8) == Some(kind);
        let content = bytes.get(at + 8..end).filter(|_| is_kind);
        let name = kind.escape_ascii();
        content.ok_or_else(|| Error::damaged(format_args!("byte {at}: no whole part \"{name}\"")))
    };
    let text = chunk(12, b"JSON")?;
    let second = 20 + text.len();
    let data = if second + 8 <= length { chunk(second, b"BIN\0")? } else { &[] };
    Ok((text, data))
}

/// A member of an object of JSON; null without one. The one copy of the search of a name.
#[inline(never)]
fn member<'a>(value: &'a Value, name: &str) -> &'a Value {
    value.get(name).unwrap_or(&Value::Null)
}

/// A whole number of JSON.
fn whole(value: &Value) -> Option<usize> {
    value.as_u64().and_then(|value| usize::try_from(value).ok())
}

/// The entries of a list of JSON.
fn entries(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Numbers of JSON, as many as there are places.
fn numbers<const N: usize>(value: &Value) -> Option<[f64; N]> {
    let list = value.as_array().filter(|list| list.len() == N)?;
    let mut numbers = [0.0; N];
    for (number, value) in numbers.iter_mut().zip(list) {
        *number = value.as_f64()?;
    }
    Some(numbers)
}

/// The transformation of a node; `None` if it is not finite.
fn matrix(node: &Value) -> Option<DMat4> {
    let matrix = member(node, "matrix");
    if !matrix.is_null() {
        return Some(DMat4::from_cols_array(&numbers(matrix)?));
    }
    let part = |name: &str, default: [f64; 3]| match member(node, name) {
        Value::Null => Some(default),
        value => numbers(value),
    };
    let shift = DVec3::from_array(part("translation", [0.0; 3])?);
    let scale = DVec3::from_array(part("scale", [1.0; 3])?);
    let rotation = match member(node, "rotation") {
        Value::Null => [0.0, 0.0, 0.0, 1.0],
        value => numbers(value)?,
    };
    let rotation = DQuat::from_array(rotation);
    let length = rotation.length();
    let is_rotation = length.is_finite() && length > 1e-6;
    is_rotation.then(|| DMat4::from_scale_rotation_translation(scale, rotation / length, shift))
}

/// The numbers of an accessor within the file.
struct Accessor<'a> {
    bytes: &'a [u8],
    count: usize,
    /// Distance of two entries \[bytes\].
    stride: usize,
    /// `componentType`.
    kind: u64,
    /// Factor of whole numbers that stand for fractions.
    scale: f64,
}

impl Accessor<'_> {
    /// Bytes of a number, and the greatest whole number.
    fn of_kind(kind: u64) -> Option<(usize, f64)> {
        Some(match kind {
            5120 => (1, f64::from(i8::MAX)),
            5121 => (1, f64::from(u8::MAX)),
            5122 => (2, f64::from(i16::MAX)),
            5123 => (2, f64::from(u16::MAX)),
            5125 => (4, f64::from(u32::MAX)),
            5126 => (4, 1.0),
            _ => return None,
        })
    }

    /// A number of an entry; entry and place are within the accessor.
    fn value(&self, entry: usize, place: usize) -> f64 {
        let size = Self::of_kind(self.kind).map_or(1, |(size, _)| size);
        let at = entry * self.stride + place * size;
        let own = &self.bytes[at..at + size];
        let word = own.iter().rev().fold(0_u32, |word, byte| word << 8 | u32::from(*byte));
        let value = match self.kind {
            5120 => f64::from(word as i8),
            5122 => f64::from(word as i16),
            5126 => f64::from(f32::from_bits(word)),
            _ => f64::from(word),
        };
        value * self.scale
    }
}

struct File<'a> {
    json: Value,
    data: &'a [u8],
}

impl File<'_> {
    fn list(&self, name: &str) -> &[Value] {
        entries(member(&self.json, name))
    }

    fn item(&self, name: &str, index: usize) -> Result<&Value, Error> {
        let list = self.list(name);
        list.get(index).ok_or_else(|| {
            let count = list.len();
            Error::damaged(format_args!("number {index} of {count} {name} is missing"))
        })
    }

    /// Rejects compressed meshes.
    fn check_extensions(&self) -> Result<(), Error> {
        let needed = self.list("extensionsRequired").iter().filter_map(Value::as_str);
        for name in ["KHR_draco_mesh_compression", "EXT_meshopt_compression"] {
            if needed.clone().any(|needed| needed == name) {
                let line = format!(
                    "the surface is compressed ({name}); export it without compression, as PLY or STL"
                );
                return Err(Error(line));
            }
        }
        Ok(())
    }

    /// The nodes of the scene; without a scene all nodes that are no children.
    fn roots(&self) -> Vec<usize> {
        let scene = whole(member(&self.json, "scene")).unwrap_or(0);
        if let Some(nodes) = self.list("scenes").get(scene) {
            return entries(member(nodes, "nodes")).iter().filter_map(whole).collect();
        }
        let mut is_root = vec![true; self.list("nodes").len()];
        for node in self.list("nodes") {
            for child in entries(member(node, "children")).iter().filter_map(whole) {
                is_root.get_mut(child).into_iter().for_each(|is_root| *is_root = false);
            }
        }
        (0..is_root.len()).filter(|k| is_root[*k]).collect()
    }

    fn mesh(&self, mesh: usize, to_scene: DMat4, raw: &mut Raw) -> Result<(), Error> {
        let is_mirror = to_scene.determinant() < 0.0;
        let primitives = entries(member(self.item("meshes", mesh)?, "primitives"));
        // Accessors of vertices that several primitives have in common, and their first vertices.
        let mut known: Vec<((usize, Option<usize>), u32)> = Vec::new();
        for primitive in primitives {
            let mode = match member(primitive, "mode") {
                Value::Null => TRIANGLES,
                value => value.as_u64().unwrap_or_default(),
            };
            let attributes = member(primitive, "attributes");
            let position = whole(member(attributes, "POSITION"));
            let Some(position) = position.filter(|_| (TRIANGLES..=FAN).contains(&mode)) else {
                continue;
            };
            let color = whole(member(attributes, "COLOR_0"));
            let positions = self.accessor(position, 3..=3)?;
            let of_vertices = (position, color);
            let found = known.iter().find(|(accessors, _)| *accessors == of_vertices);
            let first = match found {
                Some((_, first)) => *first,
                None => {
                    let first = raw.positions.len() as u32;
                    known.push((of_vertices, first));
                    self.vertices(&positions, color, to_scene, raw)?;
                    first
                }
            };
            let indices = whole(member(primitive, "indices"));
            let indices = indices.map(|index| self.accessor(index, 1..=1)).transpose()?;
            let count = indices.as_ref().map_or(positions.count, |indices| indices.count);
            // A vertex beyond those of the primitive is one that no file has.
            let corner = |k: usize| {
                let own = indices.as_ref().map_or(k, |indices| indices.value(k, 0) as usize);
                if own < positions.count { first + own as u32 } else { super::raw::NO_VERTEX }
            };
            let triangles = if mode == TRIANGLES { count / 3 } else { count.saturating_sub(2) };
            for k in 0..triangles {
                let [a, b, c] = match mode {
                    TRIANGLES => [3 * k, 3 * k + 1, 3 * k + 2],
                    STRIP => [k, k + 1 + k % 2, k + 2 - k % 2],
                    _ => [0, k + 1, k + 2],
                };
                let [b, c] = if is_mirror { [c, b] } else { [b, c] };
                raw.face(&[a, b, c].map(corner))?;
            }
            // A vertex has 3 bytes at least, a triangle of a strip one: memory stays a multiple of the file.
            if raw.positions.len() > self.data.len() / 3 || raw.sizes.len() > self.data.len() {
                let line = format_args!("surface {mesh} (meshes) stands in it too often");
                return Err(Error::damaged(line));
            }
        }
        Ok(())
    }

    /// Adds vertices with their colours.
    fn vertices(
        &self,
        positions: &Accessor,
        color: Option<usize>,
        to_scene: DMat4,
        raw: &mut Raw,
    ) -> Result<(), Error> {
        let count = positions.count;
        for k in 0..count {
            let own = DVec3::from_array([0, 1, 2].map(|place| positions.value(k, place)));
            raw.vertex(to_scene.transform_point3(own))?;
        }
        let colors = color.map(|color| self.accessor(color, 3..=4)).transpose()?;
        if let Some(colors) = colors.filter(|colors| colors.count == count) {
            let byte = |k, place| srgb::of_linear(colors.value(k, place) as f32);
            raw.colors.extend((0..count).map(|k| [0, 1, 2].map(|place| byte(k, place))));
        }
        Ok(())
    }

    /// An accessor of entries of so many numbers.
    fn accessor(
        &self,
        index: usize,
        widths: std::ops::RangeInclusive<usize>,
    ) -> Result<Accessor<'_>, Error> {
        let accessor = self.item("accessors", index)?;
        let fault = |what: &str| {
            Error::damaged(format_args!("its list of numbers {index} (accessors) {what}"))
        };
        let names = ["SCALAR", "VEC2", "VEC3", "VEC4"];
        let width = names.iter().position(|name| member(accessor, "type") == *name).map(|k| k + 1);
        let width = width.filter(|width| widths.contains(width));
        let width = width.ok_or_else(|| fault("has not three numbers for each place"))?;
        let kind = member(accessor, "componentType").as_u64().unwrap_or_default();
        let (size, most) = Accessor::of_kind(kind)
            .ok_or_else(|| fault("has numbers of an unknown kind (componentType)"))?;
        let count =
            whole(member(accessor, "count")).ok_or_else(|| fault("has no length (count)"))?;
        if !member(accessor, "sparse").is_null() {
            return Err(Error(
                "the surface is stored with gaps (sparse); export it as PLY or STL".to_owned(),
            ));
        }
        let view = whole(member(accessor, "bufferView"))
            .ok_or_else(|| fault("has no place in the file (bufferView)"))?;
        let view = self.item("bufferViews", view)?;
        let buffer = whole(member(view, "buffer")).unwrap_or(0);
        let is_elsewhere =
            self.list("buffers").first().is_some_and(|own| member(own, "uri").is_string());
        if buffer != 0 || is_elsewhere {
            return Err(Error(
                "the surface is in a second file; export it in one file, as PLY or STL".to_owned(),
            ));
        }
        let part = |value: &Value, name: &str| member(value, name).as_u64().unwrap_or(0);
        let (start, length) = (part(view, "byteOffset"), part(view, "byteLength"));
        let stride = match part(view, "byteStride") {
            0 => (size * width) as u64,
            stride => stride,
        };
        let own = part(accessor, "byteOffset");
        // An entry, and the way to the last one.
        let needed = (count as u64).saturating_sub(1).checked_mul(stride);
        let needed =
            needed.and_then(|way| way.checked_add((size * width) as u64)?.checked_add(own));
        let end = start.checked_add(length).filter(|end| *end <= self.data.len() as u64);
        let (Some(needed), Some(end)) = (needed, end) else {
            return Err(fault("ends beyond the file"));
        };
        if needed > length {
            return Err(fault(&format!("needs {needed} bytes, there are {length}")));
        }
        let bytes = &self.data[(start + own) as usize..end as usize];
        let is_fraction = kind != 5126 && *member(accessor, "normalized") == true;
        let scale = if is_fraction { 1.0 / most } else { 1.0 };
        Ok(Accessor { bytes, count, stride: stride as usize, kind, scale })
    }
}
