//! A surface of triangles.

use glam::DVec3;

/// A triangulated surface \[mm\], counter-clockwise seen from outside.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surface {
    /// Positions of the vertices \[mm\].
    pub positions: Vec<DVec3>,
    /// Vertex indices of the triangles.
    pub triangles: Vec<[u32; 3]>,
    /// sRGB of each vertex, where the file has colours.
    pub colors: Option<Vec<[u8; 3]>>,
}

/// Why arrays are no surface, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ArraysError(String);

/// Greatest coordinate of an array \[mm\].
const GREATEST_MM: f64 = 1e7;

impl Surface {
    /// The surface of arrays: three coordinates of each vertex \[mm\], three vertices of each triangle from 0, counter-clockwise seen from
    /// outside.
    ///
    /// # Errors
    /// An array of another length, a coordinate that is no number or beyond 1e7 mm, a vertex that does not exist, no triangle.
    pub fn of_arrays<T: Copy + Into<i64>>(
        positions: &[f64],
        triangles: &[T],
    ) -> Result<Self, ArraysError> {
        for (name, length) in [("positions", positions.len()), ("triangles", triangles.len())] {
            if !length.is_multiple_of(3) {
                let line = format!("{name} has {length} numbers; allowed: three of each");
                return Err(ArraysError(line));
            }
        }
        let ((points, _), (corners, _)) = (positions.as_chunks::<3>(), triangles.as_chunks::<3>());
        let wrong = |p: &[f64; 3]| p.iter().any(|x| !x.is_finite() || x.abs() > GREATEST_MM);
        if let Some(k) = points.iter().position(wrong) {
            let line = format!("positions[{k}] is {:?}; allowed: numbers up to 1e7 mm", points[k]);
            return Err(ArraysError(line));
        }
        let count = points.len() as i64;
        let corners: Vec<[i64; 3]> = corners.iter().map(|t| t.map(Into::into)).collect();
        let is_missing = |t: &[i64; 3]| t.iter().any(|k| !(0..count).contains(k));
        if let Some(k) = corners.iter().position(is_missing) {
            let allowed = match count {
                0 => "allowed: no vertex, for positions is empty".to_owned(),
                _ => format!("allowed: vertices 0 to {}", count - 1),
            };
            return Err(ArraysError(format!("triangles[{k}] is {:?}; {allowed}", corners[k])));
        }
        if corners.is_empty() {
            return Err(ArraysError("triangles is empty; allowed: 1 triangle or more".to_owned()));
        }
        Ok(Self {
            positions: points.iter().copied().map(DVec3::from).collect(),
            triangles: corners.into_iter().map(|t| t.map(|k| k as u32)).collect(),
            colors: None,
        })
    }

    /// The corners of a triangle \[mm\].
    #[must_use]
    pub fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|k| self.positions[k as usize])
    }

    /// The first vertex at the position of each vertex: equal vertices have equal entries. Positions are finite.
    #[must_use]
    pub fn weld(&self) -> Vec<u32> {
        weld(&self.positions)
    }

    /// Number of parts that have no position in common.
    #[must_use]
    pub fn parts(&self) -> usize {
        count_parts(&self.weld(), &self.triangles)
    }

    /// Volume between the surface and the centroid of its area \[mm³\]: positive where the triangles of a convex surface,
    /// closed or open, are counter-clockwise seen from outside.
    #[must_use]
    pub fn signed_volume(&self) -> f64 {
        let (mut area, mut moment) = (0.0, DVec3::ZERO);
        for [a, b, c] in self.triangles.iter().map(|t| self.corners(*t)) {
            let own = (b - a).cross(c - a).length();
            area += own;
            moment += (a + b + c) * own;
        }
        let centroid = moment / (3.0 * area.max(f64::MIN_POSITIVE));
        let sum: f64 = self
            .triangles
            .iter()
            .map(|t| self.corners(*t).map(|p| p - centroid))
            .map(|[a, b, c]| a.dot(b.cross(c)))
            .sum();
        sum / 6.0
    }

    /// Area of the surface \[mm²\].
    #[must_use]
    pub fn area(&self) -> f64 {
        let doubled = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).length();
        self.triangles.iter().map(|t| doubled(self.corners(*t))).sum::<f64>() / 2.0
    }

    /// Exchanges inside and outside.
    pub fn turn(&mut self) {
        self.triangles.iter_mut().for_each(|triangle| triangle.swap(1, 2));
    }

    /// The least and the greatest coordinates of the vertices of triangles \[mm\]; `None` without a triangle.
    #[must_use]
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let mut corners = self.triangles.iter().flatten().map(|k| self.positions[*k as usize]);
        let first = corners.next()?;
        Some(corners.fold([first; 2], |[least, most], p| [least.min(p), most.max(p)]))
    }
}

/// The first vertex at the position of each vertex; finite positions.
pub(crate) fn weld(positions: &[DVec3]) -> Vec<u32> {
    const EMPTY: u32 = u32::MAX;
    let slots = (positions.len() * 3 / 2).next_power_of_two().max(2);
    let mut table = vec![EMPTY; slots];
    let first = |(k, position): (usize, &DVec3)| {
        let mut slot = hash(*position, slots);
        while table[slot] != EMPTY {
            if positions[table[slot] as usize] == *position {
                return table[slot];
            }
            slot = (slot + 1) % slots;
        }
        table[slot] = k as u32;
        k as u32
    };
    positions.iter().enumerate().map(first).collect()
}

/// A slot of a position: multiplicative hashing; both zeros are one number.
fn hash(position: DVec3, slots: usize) -> usize {
    const FACTOR: u64 = 0x517c_c1b7_2722_0a95;
    let mixed = position.to_array().into_iter().fold(0_u64, |sum, value| {
        (sum.rotate_left(5) ^ (value + 0.0).to_bits()).wrapping_mul(FACTOR)
    });
    (mixed >> (64 - slots.trailing_zeros())) as usize
}

/// Number of connected parts of triangles over welded vertices.
pub(crate) fn count_parts(welded: &[u32], triangles: &[[u32; 3]]) -> usize {
    let mut sets = Sets::new(welded, triangles);
    let mut is_root = vec![false; welded.len()];
    triangles.iter().for_each(|t| is_root[sets.root(t[0]) as usize] = true);
    is_root.into_iter().filter(|is| *is).count()
}

/// Triangles of the part of a surface that has the greatest area.
pub(crate) fn main_part(surface: &Surface, welded: &[u32]) -> Vec<u32> {
    let mut sets = Sets::new(welded, &surface.triangles);
    let roots: Vec<u32> = surface.triangles.iter().map(|t| sets.root(t[0])).collect();
    let mut areas = vec![0.0; welded.len()];
    for (triangle, root) in surface.triangles.iter().zip(&roots) {
        let [a, b, c] = surface.corners(*triangle);
        areas[*root as usize] += (b - a).cross(c - a).length();
    }
    let most = (0..welded.len()).max_by(|&a, &b| f64::total_cmp(&areas[a], &areas[b]));
    let is_main =
        |(index, root): (usize, &u32)| (Some(*root as usize) == most).then_some(index as u32);
    roots.iter().enumerate().filter_map(is_main).collect()
}

/// Disjoint sets of vertices that triangles connect.
struct Sets(Vec<u32>);

impl Sets {
    fn new(welded: &[u32], triangles: &[[u32; 3]]) -> Self {
        let mut sets = Self(welded.to_vec());
        for &[a, b, c] in triangles {
            let first = sets.root(a);
            for other in [b, c] {
                let root = sets.root(other);
                sets.0[root as usize] = first;
            }
        }
        sets
    }

    /// The representative of a vertex's set (path halving).
    fn root(&mut self, vertex: u32) -> u32 {
        let (parents, mut at) = (&mut self.0, vertex as usize);
        while parents[at] as usize != at {
            parents[at] = parents[parents[at] as usize];
            at = parents[at] as usize;
        }
        at as u32
    }
}
