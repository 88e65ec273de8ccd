//! One grid of the hierarchy: flat f32 arrays in rows, lengths in grid spacings.
//!
//! Displacements from rest are stored, not positions: they are zero on the border and keep more
//! digits. A mirrored grid holds what lies on one side of an axis of symmetry, x ≥ 0 or y ≥ 0, and one
//! ghost column or row beyond it: half of the sheet, or a quarter where both are mirrored.

use super::border::Border;
use crate::sheet::{CellKind, NodeKind, Sheet};
use wide::f32x4;

/// Lanes that a row or an array may be read beyond its end.
const PADDING: usize = 8;

/// A vector at every stored node, component by component.
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    pub(super) x: Vec<f32>,
    pub(super) y: Vec<f32>,
    pub(super) z: Vec<f32>,
}

impl Field {
    pub(super) fn new(length: usize) -> Self {
        Self { x: vec![0.0; length], y: vec![0.0; length], z: vec![0.0; length] }
    }

    pub(super) fn copy_from(&mut self, other: &Self) {
        self.x.copy_from_slice(&other.x);
        self.y.copy_from_slice(&other.y);
        self.z.copy_from_slice(&other.z);
    }

    #[inline(always)]
    pub(super) fn load(&self, k: usize) -> [f32x4; 3] {
        [load(&self.x, k), load(&self.y, k), load(&self.z, k)]
    }

    #[inline(always)]
    pub(super) fn store(&mut self, k: usize, [x, y, z]: [f32x4; 3]) {
        store(&mut self.x, k, x);
        store(&mut self.y, k, y);
        store(&mut self.z, k, z);
    }

    #[inline(always)]
    pub(super) fn at(&self, k: usize) -> [f32; 3] {
        [self.x[k], self.y[k], self.z[k]]
    }

    #[inline(always)]
    pub(super) fn add(&mut self, k: usize, [x, y, z]: [f32; 3]) {
        self.x[k] += x;
        self.y[k] += y;
        self.z[k] += z;
    }
}

#[inline(always)]
pub(super) fn load(values: &[f32], k: usize) -> f32x4 {
    let lanes = &values[k..k + 4];
    f32x4::new([lanes[0], lanes[1], lanes[2], lanes[3]])
}

#[inline(always)]
pub(super) fn store(values: &mut [f32], k: usize, lanes: f32x4) {
    values[k..k + 4].copy_from_slice(&lanes.to_array());
}

/// A node beyond the free ones, as a finer grid's interpolation needs it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extrapolated {
    pub(super) node: u32,
    /// How many of [`Layout::sources`] are its own.
    pub(super) count: u32,
    /// The mean of its sources; else that of the straight lines through each two of them, the near
    /// one first.
    pub(super) is_mean: bool,
}

/// Is the shape its own image mirrored along x, along y?
pub(super) type Mirrored = [bool; 2];

/// Where the stored nodes and cells of a grid lie and what they are. Depends on the number of nodes
/// alone.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    /// Nodes a side of the whole grid.
    pub(super) nodes_per_side: usize,
    pub(super) columns: usize,
    pub(super) rows: usize,
    pub(super) pitch: usize,
    /// Is x ≥ 0 all that is stored, is y ≥ 0?
    pub(super) mirrored: Mirrored,
    /// Free nodes of each stored row: half-open range of stored columns, ghosts left out.
    pub(super) free: Vec<(u32, u32)>,
    /// Cells of each stored row with four free corners.
    pub(super) regular: Vec<(u32, u32)>,
    pub(super) border: Border,
    /// Nodes that are not free but within two cells of one, in the order in which they can be
    /// extrapolated; of grids alone that have a finer one.
    pub(super) extrapolated: Vec<Extrapolated>,
    /// The stored nodes that they are extrapolated from, one after the other.
    pub(super) sources: Vec<u32>,
}

impl Layout {
    pub(super) fn new(nodes_per_side: usize, mirrored: Mirrored) -> Self {
        let half = nodes_per_side / 2;
        let sheet = Sheet::new(nodes_per_side, half as f64);
        let first = mirrored.map(|is_mirrored| if is_mirrored { half - 1 } else { 0 });
        let [columns, rows] = first.map(|first| nodes_per_side - first);
        // The last cell with free corners is two before the last column; its group of four takes the nodes
        // of the next group too.
        let pitch = (columns + 1).next_multiple_of(4).max(4 * ((columns - 3) / 4 + 2));
        let mut layout = Self {
            nodes_per_side,
            columns,
            rows,
            pitch,
            mirrored,
            free: Vec::with_capacity(rows),
            regular: Vec::with_capacity(rows - 1),
            border: Border::default(),
            extrapolated: Vec::new(),
            sources: Vec::new(),
        };
        let is_free = |i: usize, j: usize| {
            sheet.kinds()[(j + first[1]) * nodes_per_side + i + first[0]] == NodeKind::Free
        };
        let [ghost, _] = layout.ghost();
        for j in 0..rows {
            let from = (ghost..columns).find(|&i| is_free(i, j));
            let to = (ghost..columns).rfind(|&i| is_free(i, j)).map_or(0, |i| i + 1);
            layout.free.push((from.unwrap_or(to) as u32, to as u32));
        }
        let mut triangles = Vec::new();
        for j in 0..rows - 1 {
            let regular = |i: usize| {
                [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].iter().all(|&(i, j)| is_free(i, j))
            };
            let from = (0..columns - 1).find(|&i| regular(i));
            let to = (0..columns - 1).rfind(|&i| regular(i)).map_or(0, |i| i + 1);
            let from = from.unwrap_or(to);
            layout.regular.push((from as u32, to as u32));
            for i in (0..from).chain(to..columns - 1) {
                let (i, j) = (i + first[0], j + first[1]);
                if sheet.cell(i, j) != CellKind::Outside {
                    triangles.extend(sheet.cell_triangles(i, j));
                }
            }
        }
        let stored =
            |k: usize| (k / nodes_per_side - first[1]) * pitch + k % nodes_per_side - first[0];
        layout.border = Border::new(&sheet, &triangles, stored);
        layout
    }

    /// Length of an array over the stored nodes.
    pub(super) fn len(&self) -> usize {
        self.rows * self.pitch + PADDING
    }

    /// Stored column and row of the grid's centre.
    pub(super) fn center(&self) -> [usize; 2] {
        self.mirrored.map(|is_mirrored| if is_mirrored { 1 } else { self.nodes_per_side / 2 })
    }

    /// Column and row of the whole grid that are stored first.
    pub(super) fn first(&self) -> [usize; 2] {
        self.center().map(|center| self.nodes_per_side / 2 - center)
    }

    /// Rest place of the node of a stored column and row, about the grid's centre.
    #[inline(always)]
    pub(super) fn rest(&self, i: usize, j: usize) -> [f32; 2] {
        let [x, y] = self.center().map(|center| center as f32);
        [i as f32 - x, j as f32 - y]
    }

    /// The first column and row that are not ghosts.
    pub(super) fn ghost(&self) -> [usize; 2] {
        self.mirrored.map(usize::from)
    }

    /// The grid's radius, in spacings.
    pub(super) fn radius(&self) -> f32 {
        (self.nodes_per_side / 2) as f32
    }

    /// Free nodes solved for.
    pub(super) fn free_nodes(&self) -> usize {
        self.free[self.ghost()[1]..].iter().map(|(from, to)| (to - from) as usize).sum()
    }

    /// The same, each row filled up to whole groups of four.
    pub(super) fn lanes(&self) -> usize {
        let groups = |&(from, to): &(u32, u32)| (to - from).next_multiple_of(4) as usize;
        self.free[self.ghost()[1]..].iter().map(groups).sum()
    }

    /// Calls `visit(row, from, to)` for the free span of every stored row but the ghost.
    #[inline(always)]
    pub(super) fn free_rows(&self, mut visit: impl FnMut(usize, usize, usize)) {
        for j in self.ghost()[1]..self.rows {
            let (from, to) = self.free[j];
            if from < to {
                visit(j, from as usize, to as usize);
            }
        }
    }

    /// Where the node of a stored row and column, or its mirror image, is stored if it is free.
    pub(super) fn place(&self, i: isize, j: isize) -> Option<(usize, usize)> {
        let within = |k: isize, is_mirrored| if is_mirrored && k < 1 { 2 - k } else { k };
        let (i, j) = (within(i, self.mirrored[0]), within(j, self.mirrored[1]));
        self.is_free(i, j).then_some((i as usize, j as usize))
    }

    fn is_free(&self, i: isize, j: isize) -> bool {
        // A ghost is free where its mirror image is.
        let across = |k: isize, is_mirrored| if is_mirrored && k == 0 { 2 } else { k };
        let (i, j) = (across(i, self.mirrored[0]), across(j, self.mirrored[1]));
        (0..self.rows as isize).contains(&j) && {
            let (from, to) = self.free[j as usize];
            (from as isize..to as isize).contains(&i)
        }
    }

    /// Two rings around the free nodes: straight on where two lie in a row, else the mean.
    pub(super) fn find_extrapolation(&mut self) {
        let [columns, rows] = [self.columns as isize, self.rows as isize];
        let [first_column, first_row] = self.ghost().map(|ghost| ghost as isize);
        let mut known = vec![false; (columns * rows) as usize];
        for j in 0..rows {
            for i in 0..columns {
                known[(j * columns + i) as usize] = self.is_free(i, j);
            }
        }
        for _ in 0..2 {
            let before = known.clone();
            let is_known = |i: isize, j: isize| {
                (0..columns).contains(&i)
                    && (0..rows).contains(&j)
                    && before[(j * columns + i) as usize]
            };
            for j in first_row..rows {
                for i in first_column..columns {
                    if is_known(i, j) {
                        continue;
                    }
                    let place = |i: isize, j: isize| (j * self.pitch as isize + i) as u32;
                    let (mut lines, mut means) = (Vec::new(), Vec::new());
                    for (di, dj) in
                        [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]
                    {
                        if is_known(i + di, j + dj) {
                            means.push(place(i + di, j + dj));
                            if is_known(i + 2 * di, j + 2 * dj) {
                                lines.push(place(i + di, j + dj));
                                lines.push(place(i + 2 * di, j + 2 * dj));
                            }
                        }
                    }
                    let is_mean = lines.is_empty();
                    let sources = if is_mean { means } else { lines };
                    if sources.is_empty() {
                        continue;
                    }
                    known[(j * columns + i) as usize] = true;
                    let (node, count) = (place(i, j), sources.len() as u32);
                    self.extrapolated.push(Extrapolated { node, count, is_mean });
                    self.sources.extend(sources);
                }
            }
        }
    }
}
