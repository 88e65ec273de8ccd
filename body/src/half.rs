//! The stored halves of the built-in torso: of its trunk, of its arms.

use crate::surface::Surface;
use glam::DVec3;

/// Half of the trunk, x ≤ 0: number of vertices and of triangles (u16), then variable-length numbers of seven bits: the corners, counted
/// back from the next new vertex, 0 for that one; x, y and z of the vertices as signed differences (zigzag) from the corners before.
pub(crate) const TRUNK: &[u8] = include_bytes!("../assets/torso.bin");
/// The right arm as far as it is drawn, in the same format; its first vertices are those of the trunk's border.
pub(crate) const ARM: &[u8] = include_bytes!("../assets/arm.bin");
/// Unit of the coordinates \[mm\].
pub(crate) const UNIT_MM: f64 = 0.05;

/// Vertices \[mm\] and triangles of a stored half.
fn read(half: &[u8]) -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (head, rest) = half.split_at(4);
    let [vertices, count] = [0, 2].map(|k| usize::from(u16::from_le_bytes([head[k], head[k + 1]])));
    let mut bytes = rest.iter();
    let mut number = || {
        let (mut value, mut shift) = (0_u32, 0);
        for byte in bytes.by_ref() {
            value |= u32::from(byte & 127) << shift;
            shift += 7;
            if byte & 128 == 0 {
                break;
            }
        }
        value
    };
    let mut next = 0;
    let mut corner = || match number() {
        0 => {
            next += 1;
            next - 1
        }
        back => next - back,
    };
    let triangles: Vec<[u32; 3]> = (0..count).map(|_| [corner(), corner(), corner()]).collect();
    let mut differences = || {
        let signed = |value: u32| (value >> 1) as i32 ^ -((value & 1) as i32);
        (0..vertices).map(|_| signed(number())).collect::<Vec<i32>>()
    };
    let differences = [differences(), differences(), differences()];
    let mut places: Vec<[i32; 3]> = Vec::with_capacity(vertices);
    for triangle in &triangles {
        for (k, &corner) in triangle.iter().enumerate() {
            let corner = corner as usize;
            if corner < places.len() {
                continue;
            }
            let [first, second] = [0, 1].map(|k| places.get(triangle[k] as usize));
            let from = |axis: usize| match (k, first, second) {
                (2, Some(a), Some(b)) => (a[axis] + b[axis]).div_euclid(2),
                (1, Some(a), _) => a[axis],
                _ => places.last().map_or(0, |last| last[axis]),
            };
            places.push([0, 1, 2].map(|axis| from(axis) + differences[axis][corner]));
        }
    }
    let point = |place: [i32; 3]| DVec3::from(place.map(|value| f64::from(value) * UNIT_MM));
    (places.into_iter().map(point).collect(), triangles)
}

/// The image in the midplane.
pub(crate) fn mirrored(at: DVec3) -> DVec3 {
    DVec3::new(-at.x, at.y, at.z)
}

/// A stored half and its image in the midplane.
pub(crate) fn both_halves(half: &[u8]) -> Surface {
    let (right, triangles) = read(half);
    let count = right.len();
    let mut positions = right;
    let mut image = Vec::with_capacity(count);
    for k in 0..count {
        let at = positions[k];
        if at.x == 0.0 {
            image.push(k as u32);
        } else {
            image.push(positions.len() as u32);
            positions.push(mirrored(at));
        }
    }
    let left = triangles.iter().map(|&[a, b, c]| [a, c, b].map(|k| image[k as usize]));
    let triangles = triangles.iter().copied().chain(left).collect();
    Surface { positions, triangles, colors: None }
}
