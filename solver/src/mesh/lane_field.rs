//! Vectors at the nodes of a grid, in lanes of four f32.

use wide::f32x4;

/// A vector at every stored node, component by component. A column through the thickness has one node
/// or several: each component has one plane of [`Layout::len`](super::lanes::Layout::len) values per layer of nodes, the inner
/// face first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Field {
    pub(crate) x: Vec<f32>,
    pub(crate) y: Vec<f32>,
    pub(crate) z: Vec<f32>,
    /// Values of a plane.
    plane: usize,
}

impl Field {
    /// Zeros on `layers` planes of `plane` values.
    pub(crate) fn new(plane: usize, layers: usize) -> Self {
        let zeros = || vec![0.0; plane * layers];
        Self { x: zeros(), y: zeros(), z: zeros(), plane }
    }

    /// All planes: those of x, of y, of z.
    pub(crate) fn planes(&self) -> impl Iterator<Item = &[f32]> {
        [&self.x, &self.y, &self.z].into_iter().flat_map(|part| part.chunks_exact(self.plane))
    }

    /// [`Self::planes`], mutable.
    pub(crate) fn planes_mut(&mut self) -> impl Iterator<Item = &mut [f32]> {
        let plane = self.plane;
        [&mut self.x, &mut self.y, &mut self.z]
            .into_iter()
            .flat_map(move |part| part.chunks_exact_mut(plane))
    }

    /// The offsets of the planes of each component.
    pub(crate) fn layers(&self) -> impl Iterator<Item = usize> + use<> {
        (0..self.x.len()).step_by(self.plane)
    }

    pub(crate) fn fill_zero(&mut self) {
        for part in [&mut self.x, &mut self.y, &mut self.z] {
            part.fill(0.0);
        }
    }

    pub(crate) fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }

    /// Copies the last plane of each component.
    pub(crate) fn copy_last_plane_from(&mut self, other: &Self) {
        let parts = [&other.x, &other.y, &other.z];
        for (to, from) in [&mut self.x, &mut self.y, &mut self.z].into_iter().zip(parts) {
            let (to_start, from_start) = (to.len() - self.plane, from.len() - other.plane);
            to[to_start..].copy_from_slice(&from[from_start..]);
        }
    }

    /// Subtracts a field of one plane, or without values, from the last plane of each component.
    pub(crate) fn subtract_from_last_plane(&mut self, other: &Self) {
        let parts = [&other.x, &other.y, &other.z];
        for (to, from) in [&mut self.x, &mut self.y, &mut self.z].into_iter().zip(parts) {
            let start = to.len() - from.len();
            to[start..].iter_mut().zip(from).for_each(|(to, from)| *to -= from);
        }
    }

    #[inline(always)]
    pub(crate) fn load(&self, k: usize) -> [f32x4; 3] {
        [load(&self.x, k), load(&self.y, k), load(&self.z, k)]
    }

    #[inline(always)]
    pub(crate) fn store(&mut self, k: usize, [x, y, z]: [f32x4; 3]) {
        store(&mut self.x, k, x);
        store(&mut self.y, k, y);
        store(&mut self.z, k, z);
    }

    #[inline(always)]
    pub(crate) fn at(&self, k: usize) -> [f32; 3] {
        [self.x[k], self.y[k], self.z[k]]
    }

    /// The vectors of four nodes of a layer.
    #[inline(always)]
    pub(crate) fn gather(&self, nodes: [u32; 4], layer: usize) -> [f32x4; 3] {
        let four = |part: &[f32]| {
            let value = |lane: usize| part[nodes[lane] as usize + layer];
            f32x4::new([value(0), value(1), value(2), value(3)])
        };
        [four(&self.x), four(&self.y), four(&self.z)]
    }

    #[inline(always)]
    pub(crate) fn add(&mut self, k: usize, [x, y, z]: [f32; 3]) {
        self.x[k] += x;
        self.y[k] += y;
        self.z[k] += z;
    }

    /// Sets the field to u − before.
    pub(crate) fn set_difference(&mut self, u: &Self, before: &Self) {
        for ((to, u), before) in self.planes_mut().zip(u.planes()).zip(before.planes()) {
            for ((to, u), before) in to.iter_mut().zip(u).zip(before) {
                *to = u - before;
            }
        }
    }

    /// Adds a multiple of another field.
    pub(crate) fn add_scaled(&mut self, other: &Self, factor: f32) {
        for (u, other) in self.planes_mut().zip(other.planes()) {
            for (u, other) in u.iter_mut().zip(other) {
                *u += factor * other;
            }
        }
    }

    /// Adds a multiple of a − b.
    pub(crate) fn add_scaled_difference(&mut self, a: &Self, b: &Self, factor: f32) {
        for ((u, a), b) in self.planes_mut().zip(a.planes()).zip(b.planes()) {
            for ((u, a), b) in u.iter_mut().zip(a).zip(b) {
                *u += factor * (a - b);
            }
        }
    }
}

#[inline(always)]
pub(crate) fn load(values: &[f32], k: usize) -> f32x4 {
    let lanes = &values[k..k + 4];
    f32x4::new([lanes[0], lanes[1], lanes[2], lanes[3]])
}

/// Lanes shifted to the right; the first one is the last of the four before.
#[inline(always)]
pub(crate) fn shifted_right(before: f32x4, now: f32x4) -> f32x4 {
    let (a, b) = (before.to_array(), now.to_array());
    f32x4::new([a[3], b[0], b[1], b[2]])
}

#[inline(always)]
pub(crate) fn store(values: &mut [f32], k: usize, lanes: f32x4) {
    values[k..k + 4].copy_from_slice(&lanes.to_array());
}

/// Stores the first `count` of four lanes.
#[inline(always)]
pub(crate) fn store_first(field: &mut Field, k: usize, count: usize, lanes: [f32x4; 3]) {
    if count == 4 {
        field.store(k, lanes);
        return;
    }
    let [x, y, z] = lanes.map(f32x4::to_array);
    field.x[k..k + count].copy_from_slice(&x[..count]);
    field.y[k..k + count].copy_from_slice(&y[..count]);
    field.z[k..k + count].copy_from_slice(&z[..count]);
}
