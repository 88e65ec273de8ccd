//! The stored half of the built-in torso.

use glam::DVec3;

/// Half of the torso, x ≤ 0: number of vertices and of triangles (u16), then variable-length numbers of seven bits: the corners, counted
/// back from the next new vertex, 0 for that one; x, y and z of the vertices as signed differences (zigzag) from the corners before.
const HALF: &[u8] = include_bytes!("../assets/torso.bin");
/// Unit of the coordinates \[mm\].
pub(crate) const UNIT_MM: f64 = 0.05;

/// Vertices \[mm\] and triangles of the right half, x ≤ 0.
pub(crate) fn read() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let (head, rest) = HALF.split_at(4);
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
