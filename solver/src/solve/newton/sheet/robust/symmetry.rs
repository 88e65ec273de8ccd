//! Symmetric solutions of symmetric scenes.
//!
//! Symptom: a centred scene has an asymmetric solution (`asymmetric-shape-on-needle`). Cause: asymmetry from
//! rounding and truncated iterations grows at a node on a steep dome. Remedy: steps are symmetrised, mirrored nodes have
//! equal active constraints. A convex model of a symmetric shape has a symmetric minimum.

use super::SheetNewton;
use crate::contact::Dome;
use crate::mesh::Sheet;
use glam::{DVec2, DVec3};

/// The mirror symmetries to enforce.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::solve) enum Mirrors {
    None,
    /// Common symmetries of dome and grid.
    OfDome,
}

impl Mirrors {
    pub(super) fn of(self, dome: &Dome) -> Vec<Mirror> {
        match self {
            Self::None => Vec::new(),
            Self::OfDome => Mirror::of(dome),
        }
    }
}

impl SheetNewton {
    pub(in crate::solve::newton::sheet) fn symmetrize_positions(&mut self) {
        symmetrize(&self.system.robust.mirrors, self.grid.sheet(), &self.grid.free, &mut self.x[0]);
    }

    /// Symmetrises the step and the active constraints.
    pub(in crate::solve::newton::sheet) fn symmetrize_step(&mut self) {
        symmetrize(&self.system.robust.mirrors, self.grid.sheet(), &self.grid.free, &mut self.d[0]);
        share_flags(
            &self.system.robust.mirrors,
            self.grid.sheet(),
            &self.grid.free,
            &mut self.contact.active,
        );
    }
}

/// A mirror through the centre of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Mirror {
    /// x → −x.
    X,
    /// y → −y.
    Y,
    /// (x, y) → (y, x).
    Diagonal,
    /// (x, y) → (−y, −x).
    Antidiagonal,
}

impl Mirror {
    /// The common symmetries of a dome and the grid.
    fn of(dome: &Dome) -> Vec<Self> {
        let DVec2 { x, y } = dome.center;
        let [along_x, along_y] = dome.mirrored();
        let all = [
            (Self::X, along_x),
            (Self::Y, along_y),
            (Self::Diagonal, dome.is_round() && x - y == 0.0),
            (Self::Antidiagonal, dome.is_round() && x + y == 0.0),
        ];
        all.into_iter().filter_map(|(mirror, holds)| holds.then_some(mirror)).collect()
    }

    /// The mirror image of a node, n nodes a side.
    fn node(self, k: usize, n: usize) -> usize {
        let (i, j) = (k % n, k / n);
        let (i, j) = match self {
            Self::X => (n - 1 - i, j),
            Self::Y => (i, n - 1 - j),
            Self::Diagonal => (j, i),
            Self::Antidiagonal => (n - 1 - j, n - 1 - i),
        };
        j * n + i
    }

    /// The image of a position or step.
    fn image(self, v: DVec3) -> DVec3 {
        match self {
            Self::X => DVec3::new(-v.x, v.y, v.z),
            Self::Y => DVec3::new(v.x, -v.y, v.z),
            Self::Diagonal => DVec3::new(v.y, v.x, v.z),
            Self::Antidiagonal => DVec3::new(-v.y, -v.x, v.z),
        }
    }
}

/// Symmetrises positions or steps of the free nodes by the mean of node and image.
fn symmetrize(mirrors: &[Mirror], sheet: &Sheet, free: &[u32], v: &mut [DVec3]) {
    let n = sheet.nodes_per_side();
    for mirror in mirrors {
        for &k in free {
            let k = k as usize;
            let other = mirror.node(k, n);
            if other >= k {
                let mean = 0.5 * (v[k] + mirror.image(v[other]));
                v[k] = mean;
                v[other] = mirror.image(mean);
            }
        }
    }
}

/// Adds to every node's flags those of its images.
fn share_flags(mirrors: &[Mirror], sheet: &Sheet, free: &[u32], flags: &mut [u8]) {
    let n = sheet.nodes_per_side();
    for mirror in mirrors {
        for &k in free {
            let k = k as usize;
            let other = mirror.node(k, n);
            flags[k] |= flags[other];
            flags[other] = flags[k];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::HalfBall;
    use crate::mesh::NodeKind;

    #[test]
    fn symmetrized_vectors_and_flags_equal_their_mirror_images() {
        let sheet = Sheet::new(17, 8.0);
        let free: Vec<u32> = (0..sheet.len())
            .filter(|&k| sheet.kinds()[k] == NodeKind::Free)
            .map(|k| k as u32)
            .collect();
        for (center, count) in [
            ([0.0, 0.0], 4),
            ([3.0, 0.0], 1),
            ([0.0, -3.0], 1),
            ([2.0, 2.0], 1),
            ([2.0, -2.0], 1),
            ([2.0, 1.0], 0),
        ] {
            let mirrors =
                Mirror::of(&Dome::new(DVec2::from(center), HalfBall::round(4.0, 4.0), 1.0));
            assert_eq!(mirrors.len(), count, "{center:?}");
            let wave = |k: usize, f: f64| (f * k as f64).sin();
            let mut v: Vec<DVec3> = (0..sheet.len())
                .map(|k| DVec3::new(wave(k, 1.3), wave(k, 2.1), wave(k, 3.7)))
                .collect();
            symmetrize(&mirrors, &sheet, &free, &mut v);
            let first = free[0] as usize;
            let mut flags = vec![0; sheet.len()];
            flags[first] = 1;
            share_flags(&mirrors, &sheet, &free, &mut flags);
            assert_eq!(flags[first], 1);
            for mirror in mirrors {
                for &k in &free {
                    let k = k as usize;
                    let other = mirror.node(k, 17);
                    let image = mirror.image(v[other]);
                    assert!(v[k].distance(image) < 1e-15, "{mirror:?} at {center:?}");
                    assert_eq!(flags[k], flags[other], "{mirror:?} at {center:?}");
                }
            }
        }
    }
}
