//! A grid for lanes of four f32: flat arrays in rows, lengths in grid spacings.
//!
//! Arrays store displacements from rest, not positions: displacements are zero on the border and keep more
//! digits. A mirrored grid stores one side of an axis of symmetry, x ≥ 0 or y ≥ 0, and one ghost column or row
//! beyond the axis: half of the sheet, or a quarter with two axes.

pub(crate) use super::lane_field::{Field, load, shifted_right, store, store_first};
use super::rest::Surface;
use super::vec3::Vec3;
use super::{Rest, Sheet};
use glam::{DVec2, DVec3};
use wide::f32x4;

/// Lanes beyond the end of a row or an array that a load may reach.
const PADDING: usize = 8;

/// A node beyond the free nodes whose value the interpolation to a finer grid extrapolates.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Extrapolated {
    pub(crate) node: u32,
    /// Number of the node's sources in [`Layout::sources`].
    pub(crate) count: u32,
    /// `true`: mean of the sources; `false`: mean of the linear extrapolations from pairs of sources, the near
    /// source first.
    pub(crate) is_mean: bool,
}

/// A row of cells with free corners only, in groups of four; the first and the last group may contain other cells.
#[derive(Clone, Copy, Debug)]
pub(crate) struct CellRow {
    /// Stored node at the first corner of the first group.
    pub(crate) start: usize,
    pub(crate) groups: usize,
    /// Half-open range of the cells, counted from the first group's first cell.
    from: usize,
    to: usize,
}

impl CellRow {
    /// Which cells of a group belong to the row.
    #[inline(always)]
    pub(crate) fn counts(&self, group: usize) -> f32x4 {
        let columns = f32x4::new([0.0, 1.0, 2.0, 3.0]) + (4 * group) as f32;
        let (from, to) = (f32x4::splat(self.from as f32), f32x4::splat(self.to as f32));
        columns.simd_ge(from) & columns.simd_lt(to)
    }
}

/// A triangle with a rest metric of its own: at the border, or anywhere on a surface that is not even.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OwnTriangle {
    /// Stored nodes, counter-clockwise, the right angle first.
    pub(crate) nodes: [u32; 3],
    /// The nodes' positions without displacement \[spacings\].
    pub(crate) places: [DVec3; 3],
    /// The rest metric, by the corners of [`Surface::triangle`] \[spacings\].
    pub(crate) rest: [DVec2; 3],
    /// Weight of the triangle's area \[-\].
    pub(crate) weight: f64,
}

/// Four neighbouring nodes of a row.
pub(crate) struct Group {
    /// Index of the first node.
    pub(crate) first: usize,
    /// Number of free nodes of the four.
    pub(crate) count: usize,
    /// Positions at rest relative to the grid's centre \[spacings\].
    pub(crate) rest: Vec3,
    /// Is the group the first of its row?
    pub(crate) is_row_start: bool,
}

/// Is the shape symmetric under x → −x, under y → −y?
pub(crate) type Mirrored = [bool; 2];

/// Positions and kinds of the stored nodes and cells of a grid; a function of the number of nodes and the symmetry
/// alone.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Nodes a side of the whole grid.
    pub(crate) nodes_per_side: usize,
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) pitch: usize,
    /// Does the grid store x ≥ 0 only, y ≥ 0 only?
    pub(crate) mirrored: Mirrored,
    /// Free nodes of each stored row without ghosts: half-open range of stored columns.
    pub(crate) free: Vec<(u32, u32)>,
    /// Cells of each stored row with four free corners.
    pub(crate) regular: Vec<(u32, u32)>,
    /// Nodes that are not free but within two cells of a free node, in the order of extrapolation; empty on the
    /// finest grid.
    pub(crate) extrapolated: Vec<Extrapolated>,
    /// Source nodes of all [`Self::extrapolated`], in the same order.
    pub(crate) sources: Vec<u32>,
    /// Stored index of the first node of the layer whose cells [`Self::cell_rows`] returns.
    origin: usize,
    /// Positions of the inner face at rest over a curved wall, relative to the pocket's centre \[spacings\]; empty over a flat
    /// wall.
    inner: Field,
}

impl Layout {
    /// The layout of a grid.
    pub(crate) fn new(nodes_per_side: usize, mirrored: Mirrored) -> Self {
        let half = nodes_per_side / 2;
        let sheet = Sheet::new(nodes_per_side, half as f64);
        let first = mirrored.map(|is_mirrored| if is_mirrored { half - 1 } else { 0 });
        let [columns, rows] = first.map(|first| nodes_per_side - first);
        // The last cell with free corners is two before the last column; its group of four also reads the nodes
        // of the next group.
        let pitch = (columns + 1).next_multiple_of(4).max(4 * ((columns - 3) / 4 + 2));
        let mut layout = Self {
            nodes_per_side,
            columns,
            rows,
            pitch,
            mirrored,
            free: Vec::with_capacity(rows),
            regular: Vec::with_capacity(rows - 1),
            extrapolated: Vec::new(),
            sources: Vec::new(),
            origin: 0,
            inner: Field::default(),
        };
        let free = |j: usize| {
            let (from, to) = sheet.free_spans()[j + first[1]];
            (from.saturating_sub(first[0]), to - first[0])
        };
        let [ghost, _] = layout.ghost();
        for j in 0..rows {
            let (from, to) = free(j);
            let (from, to) = if from < to { (from.max(ghost), to) } else { (0, 0) };
            layout.free.push((from as u32, to as u32));
        }
        for j in 0..rows - 1 {
            let ((a, b), (c, d)) = (free(j), free(j + 1));
            let (from, to) = (a.max(c), b.min(d).saturating_sub(1));
            let (from, to) = if from < to && a < b && c < d { (from, to) } else { (0, 0) };
            layout.regular.push((from as u32, to as u32));
        }
        layout
    }

    /// The rows of cells with free corners only.
    pub(crate) fn cell_rows(&self) -> impl Iterator<Item = CellRow> {
        self.regular.iter().enumerate().filter(|(_, (from, to))| from < to).map(
            |(j, &(from, to))| {
                let (from, to) = (from as usize, to as usize);
                let first = from / 4;
                CellRow {
                    start: self.origin + j * self.pitch + 4 * first,
                    groups: to.div_ceil(4) - first,
                    from: from - 4 * first,
                    to: to - 4 * first,
                }
            },
        )
    }

    /// Places the inner face at rest on a curved wall, or on a flat wall without `rest`.
    pub(crate) fn set_rest(&mut self, rest: Option<&Rest>) {
        let Some(rest) = rest else {
            self.inner = Field::default();
            return;
        };
        let mut inner = Field::new(self.len(), 1);
        let per_spacing = 1.0 / rest.sheet().spacing_mm();
        for j in 0..self.rows {
            for i in 0..self.columns {
                let [x, y, z] = (rest.node(0, self.node(i, j)) * per_spacing).as_vec3().to_array();
                let k = j * self.pitch + i;
                (inner.x[k], inner.y[k], inner.z[k]) = (x, y, z);
            }
        }
        self.inner = inner;
    }

    /// Positions of the inner face at rest, relative to the pocket's centre \[spacings\].
    pub(crate) fn inner_at_rest(&self) -> Field {
        if !self.inner.x.is_empty() {
            return self.inner.clone();
        }
        let mut inner = Field::new(self.len(), 1);
        for j in 0..self.rows {
            for i in 0..self.columns {
                let k = j * self.pitch + i;
                [inner.x[k], inner.y[k]] = self.rest(i, j);
            }
        }
        inner
    }

    /// The node of the whole grid at a stored column and row.
    #[inline(always)]
    pub(crate) fn node(&self, i: usize, j: usize) -> usize {
        let [first, first_row] = self.first();
        (j + first_row) * self.nodes_per_side + i + first
    }

    /// Stored index in a layer of a node of the whole grid; the node is stored.
    pub(crate) fn stored(&self, node: usize) -> usize {
        let (n, [first, first_row]) = (self.nodes_per_side, self.first());
        (node / n - first_row) * self.pitch + node % n - first
    }

    /// The plane of the grid at rest \[spacings\].
    pub(crate) fn plane(&self) -> Rest {
        let half = (self.nodes_per_side / 2) as f64;
        Rest::of_sheet(Sheet::new(self.nodes_per_side, half))
    }

    /// The layout of a layer of nodes that is this surface at rest, and the triangles of cells that are not regular: even
    /// surfaces have regular cells, which are squares of the grid.
    pub(crate) fn of_surface(&self, surface: Surface, layer: usize) -> (Self, Vec<OwnTriangle>) {
        let mut layout = Self { origin: layer * self.len(), ..self.clone() };
        if !surface.is_even() {
            layout.regular.fill((0, 0));
        }
        let (sheet, [first, first_row]) = (surface.sheet(), self.first());
        let per_spacing = 1.0 / sheet.spacing_mm();
        let triangle = |(nodes, weight): ([usize; 3], f64)| OwnTriangle {
            nodes: nodes.map(|k| (layout.origin + self.stored(k)) as u32),
            places: nodes.map(|k| surface.node(k) * per_spacing),
            rest: surface.triangle(nodes).map(|corner| corner * per_spacing),
            weight,
        };
        let mut triangles = Vec::new();
        for (j, &(from, to)) in layout.regular.iter().enumerate() {
            let (begin, end) = sheet.cell_span(j + first_row);
            let is_regular = |i: usize| (from as usize..to as usize).contains(&(i - first));
            for i in (begin.max(first)..end).filter(|&i| !is_regular(i)) {
                triangles.extend(sheet.cell_triangles(i, j + first_row).map(triangle));
            }
        }
        (layout, triangles)
    }

    /// Has the stored cell (i, j) a free corner?
    pub(crate) fn touches_free(&self, i: usize, j: usize) -> bool {
        let is_free = |i: usize, j: usize| self.is_free(i as isize, j as isize);
        is_free(i, j) || is_free(i + 1, j) || is_free(i, j + 1) || is_free(i + 1, j + 1)
    }

    /// Length of an array over the stored nodes.
    pub(crate) fn len(&self) -> usize {
        self.rows * self.pitch + PADDING
    }

    /// Stored column and row of the grid's centre.
    pub(crate) fn center(&self) -> [usize; 2] {
        self.mirrored.map(|is_mirrored| if is_mirrored { 1 } else { self.nodes_per_side / 2 })
    }

    /// First stored column and row, as indices of the whole grid.
    pub(crate) fn first(&self) -> [usize; 2] {
        self.center().map(|center| self.nodes_per_side / 2 - center)
    }

    /// Place of the node of a stored column and row along the wall, relative to the grid's centre \[spacings\].
    #[inline(always)]
    pub(crate) fn rest(&self, i: usize, j: usize) -> [f32; 2] {
        let [x, y] = self.center().map(|center| center as f32);
        [i as f32 - x, j as f32 - y]
    }

    /// The first column and row that are not ghosts.
    pub(crate) fn ghost(&self) -> [usize; 2] {
        self.mirrored.map(usize::from)
    }

    /// Radius of the grid \[spacings\].
    pub(crate) fn radius(&self) -> f32 {
        (self.nodes_per_side / 2) as f32
    }

    /// Free nodes solved for.
    pub(crate) fn free_nodes(&self) -> usize {
        self.free[self.ghost()[1]..].iter().map(|(from, to)| (to - from) as usize).sum()
    }

    /// [`Self::free_nodes`] with each row filled up to whole groups of four.
    pub(crate) fn lanes(&self) -> usize {
        let groups = |&(from, to): &(u32, u32)| (to - from).next_multiple_of(4) as usize;
        self.free[self.ghost()[1]..].iter().map(groups).sum()
    }

    /// Calls `visit(row, from, to)` for the free span of every stored row but the ghost.
    #[inline(always)]
    pub(crate) fn free_rows(&self, mut visit: impl FnMut(usize, usize, usize)) {
        for j in self.ghost()[1]..self.rows {
            let (from, to) = self.free[j];
            if from < to {
                visit(j, from as usize, to as usize);
            }
        }
    }

    /// Calls `visit` for the groups of four of the free span of every stored row but the ghost.
    #[inline(always)]
    pub(crate) fn free_groups(&self, mut visit: impl FnMut(Group)) {
        self.free_rows(|j, from, to| {
            let mut i = from;
            while i < to {
                let first = j * self.pitch + i;
                visit(Group {
                    first,
                    count: (to - i).min(4),
                    rest: self.group_rest(first, i, j),
                    is_row_start: i == from,
                });
                i += 4;
            }
        });
    }

    #[inline(always)]
    fn group_rest(&self, first: usize, i: usize, j: usize) -> Vec3 {
        if self.inner.x.is_empty() {
            let [x, y] = self.rest(i, j);
            return [f32x4::new([0.0, 1.0, 2.0, 3.0]) + x, f32x4::splat(y), f32x4::ZERO];
        }
        self.inner.load(first)
    }

    /// Stored column and row of the node, or of its mirror image; `None` unless the node is free.
    pub(crate) fn free_node(&self, i: isize, j: isize) -> Option<(usize, usize)> {
        let within = |k: isize, is_mirrored| if is_mirrored && k < 1 { 2 - k } else { k };
        let (i, j) = (within(i, self.mirrored[0]), within(j, self.mirrored[1]));
        self.is_free(i, j).then_some((i as usize, j as usize))
    }

    fn is_free(&self, i: isize, j: isize) -> bool {
        // A ghost is free if its mirror image is free.
        let across = |k: isize, is_mirrored| if is_mirrored && k == 0 { 2 } else { k };
        let (i, j) = (across(i, self.mirrored[0]), across(j, self.mirrored[1]));
        (0..self.rows as isize).contains(&j) && {
            let (from, to) = self.free[j as usize];
            (from as isize..to as isize).contains(&i)
        }
    }

    /// Finds the sources of two rings around the free nodes: linear extrapolation where two sources lie in a row, else
    /// the mean.
    pub(crate) fn find_extrapolation(&mut self) {
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
                    let stored = |i: isize, j: isize| (j * self.pitch as isize + i) as u32;
                    let (mut lines, mut means) = (Vec::new(), Vec::new());
                    for (di, dj) in
                        [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (1, -1), (-1, 1), (-1, -1)]
                    {
                        if is_known(i + di, j + dj) {
                            means.push(stored(i + di, j + dj));
                            if is_known(i + 2 * di, j + 2 * dj) {
                                lines.push(stored(i + di, j + dj));
                                lines.push(stored(i + 2 * di, j + 2 * dj));
                            }
                        }
                    }
                    let is_mean = lines.is_empty();
                    let sources = if is_mean { means } else { lines };
                    if sources.is_empty() {
                        continue;
                    }
                    known[(j * columns + i) as usize] = true;
                    let (node, count) = (stored(i, j), sources.len() as u32);
                    self.extrapolated.push(Extrapolated { node, count, is_mean });
                    self.sources.extend(sources);
                }
            }
        }
    }
}

/// Symmetry and norms.
impl Layout {
    /// Fills the ghosts of a mirrored grid.
    pub(crate) fn mirror(&self, field: &mut Field) {
        let pitch = self.pitch;
        let [along_x, along_y] = self.mirrored;
        for layer in field.layers() {
            if along_x {
                for j in 0..self.rows {
                    let row = layer + j * pitch;
                    field.x[row + 1] = 0.0;
                    field.x[row] = -field.x[row + 2];
                    field.y[row] = field.y[row + 2];
                    field.z[row] = field.z[row + 2];
                }
            }
            if along_y {
                field.y[layer + pitch..layer + 2 * pitch].fill(0.0);
                for k in layer..layer + self.columns {
                    field.x[k] = field.x[k + 2 * pitch];
                    field.y[k] = -field.y[k + 2 * pitch];
                    field.z[k] = field.z[k + 2 * pitch];
                }
            }
        }
    }

    /// Fills the ghosts of nodal marks.
    pub(crate) fn mirror_marks(&self, marks: &mut [f32]) {
        let pitch = self.pitch;
        let [along_x, along_y] = self.mirrored;
        if along_x {
            for j in 0..self.rows {
                marks[j * pitch] = marks[j * pitch + 2];
            }
        }
        if along_y {
            marks.copy_within(2 * pitch..3 * pitch, 0);
        }
    }

    /// Greatest length of a vector at a free node; NaN if a length is NaN.
    pub(crate) fn greatest_length(&self, vector: impl Fn(usize) -> [f32; 3]) -> f32 {
        let mut greatest = 0.0_f32;
        self.free_rows(|j, from, to| {
            let row = j * self.pitch;
            for k in row + from..row + to {
                let d = vector(k);
                let square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
                // This order of comparison keeps NaN.
                greatest = if square <= greatest { greatest } else { square };
            }
        });
        greatest.sqrt()
    }

    /// The greatest distance between two fields at a free node.
    pub(crate) fn greatest_difference(&self, a: &Field, b: &Field) -> f32 {
        let of_layer = |layer: usize| {
            self.greatest_length(|k| {
                let (p, q) = (a.at(layer + k), b.at(layer + k));
                [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
            })
        };
        let greater = |a: f32, b: f32| if b <= a { a } else { b };
        a.layers().map(of_layer).fold(0.0, greater)
    }

    /// ⟨a, b⟩ over the free nodes.
    pub(crate) fn product(&self, a: &Field, b: &Field) -> f64 {
        let mut product = 0.0;
        for layer in a.layers() {
            self.free_rows(|j, from, to| {
                let mut of_row = 0.0_f32;
                for k in layer + j * self.pitch + from..layer + j * self.pitch + to {
                    let (p, q) = (a.at(k), b.at(k));
                    of_row += p[0] * q[0] + p[1] * q[1] + p[2] * q[2];
                }
                product += f64::from(of_row);
            });
        }
        product
    }

    /// ⟨u − before, step⟩, ⟨step, step⟩ and ⟨u − before, u − before⟩ over the free nodes.
    pub(crate) fn products(&self, u: &Field, before: &Field, step: &Field) -> [f64; 3] {
        let (mut product, mut square, mut own) = (0.0, 0.0, 0.0);
        for layer in u.layers() {
            self.free_rows(|j, from, to| {
                let (mut row_product, mut row_square, mut row_own) = (0.0_f32, 0.0_f32, 0.0_f32);
                for k in layer + j * self.pitch + from..layer + j * self.pitch + to {
                    let (p, q, s) = (u.at(k), before.at(k), step.at(k));
                    let r = [p[0] - q[0], p[1] - q[1], p[2] - q[2]];
                    row_product += r[0] * s[0] + r[1] * s[1] + r[2] * s[2];
                    row_own += r[0] * r[0] + r[1] * r[1] + r[2] * r[2];
                    row_square += s[0] * s[0] + s[1] * s[1] + s[2] * s[2];
                }
                product += f64::from(row_product);
                square += f64::from(row_square);
                own += f64::from(row_own);
            });
        }
        [product, square, own]
    }
}
