//! The part of a symmetric shape that determines the whole: one quarter, half or all of the grid.

use super::lanes::Mirrored;

/// The nodes x ≥ 0 of a shape mirrored along x, y ≥ 0 of a shape mirrored along y, the axes included. Arrays over a
/// part are row-major, shape ([`Self::rows`], [`Self::columns`]).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Part {
    nodes_per_side: usize,
    mirrored: Mirrored,
}

impl Part {
    pub(crate) fn new(nodes_per_side: usize, mirrored: Mirrored) -> Self {
        Self { nodes_per_side, mirrored }
    }

    /// The whole grid.
    pub(crate) fn whole(nodes_per_side: usize) -> Self {
        Self::new(nodes_per_side, [false; 2])
    }

    /// First column and row.
    pub(crate) fn first(self) -> [usize; 2] {
        self.mirrored.map(|is_mirrored| if is_mirrored { self.nodes_per_side / 2 } else { 0 })
    }

    /// First column and row of the cells around the part's nodes.
    pub(crate) fn first_cell(self) -> [usize; 2] {
        self.first().map(|first| first.saturating_sub(1))
    }

    pub(crate) fn columns(self) -> usize {
        self.nodes_per_side - self.first()[0]
    }

    pub(crate) fn rows(self) -> usize {
        self.nodes_per_side - self.first()[1]
    }

    /// Length of an array over the part.
    pub(crate) fn len(self) -> usize {
        self.columns() * self.rows()
    }

    /// The part's nodes as nodes of the grid, in the order of an array over the part.
    pub(crate) fn nodes(self) -> impl Iterator<Item = usize> {
        let ([column, row], n) = (self.first(), self.nodes_per_side);
        (row..n).flat_map(move |j| j * n + column..(j + 1) * n)
    }

    /// The first image of each node of the part, in the order of the grid: x ≤ 0 of a shape mirrored along x.
    pub(crate) fn first_images(self) -> impl Iterator<Item = usize> {
        let ([columns, rows], n) = ([self.columns(), self.rows()], self.nodes_per_side);
        (0..rows).flat_map(move |j| j * n..j * n + columns)
    }

    /// Column and row of a node of the grid.
    #[inline]
    fn place(self, node: usize) -> [usize; 2] {
        // Of 32 bits: a division of 64 takes twice the time.
        let (node, n) = (node as u32, self.nodes_per_side as u32);
        [(node % n) as usize, (node / n) as usize]
    }

    /// Index of the part's node in a column and row of the grid, or of its mirror image.
    #[inline]
    pub(crate) fn index_at(self, column: usize, row: usize) -> usize {
        let last = self.nodes_per_side - 1;
        let fold = |k: usize, first: usize| if k < first { last - k - first } else { k - first };
        let [first_column, first_row] = self.first();
        fold(row, first_row) * self.columns() + fold(column, first_column)
    }

    /// Index of a node of the grid, or of its mirror image, in an array over the part.
    #[inline]
    pub(crate) fn index(self, node: usize) -> usize {
        if self.mirrored == [false; 2] {
            return node;
        }
        let [column, row] = self.place(node);
        self.index_at(column, row)
    }

    /// Is a node of the grid mirrored along x, along y, onto a node of the part?
    #[inline]
    pub(crate) fn is_image(self, node: usize) -> [bool; 2] {
        if self.mirrored == [false; 2] {
            return [false; 2];
        }
        let (place, first) = (self.place(node), self.first());
        [place[0] < first[0], place[1] < first[1]]
    }

    /// Number of nodes of the grid that a node of the part stands for: itself and its mirror images.
    #[inline]
    pub(crate) fn multiplicity(self, node: usize) -> f64 {
        if self.mirrored == [false; 2] {
            return 1.0;
        }
        let (place, half) = (self.place(node), self.nodes_per_side / 2);
        let sides =
            |axis: usize| if self.mirrored[axis] && place[axis] != half { 2.0 } else { 1.0 };
        sides(0) * sides(1)
    }

    /// Number of nodes of the grid.
    pub(crate) fn nodes_of_grid(self) -> usize {
        self.nodes_per_side * self.nodes_per_side
    }

    /// The values on the whole grid of an array over the part.
    pub(crate) fn on_grid<T: Copy>(self, values: Vec<T>) -> Vec<T> {
        if self.mirrored == [false; 2] {
            return values;
        }
        (0..self.nodes_of_grid()).map(|node| values[self.index(node)]).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_node_has_one_image_in_the_part_and_the_multiplicities_sum_to_the_grid() {
        let n = 9;
        for mirrored in [[false; 2], [true, false], [false, true], [true; 2]] {
            let part = Part::new(n, mirrored);
            let nodes: Vec<usize> = part.nodes().collect();
            assert_eq!(nodes.len(), part.len());
            let mut counts = vec![0.0; part.len()];
            for node in 0..n * n {
                counts[part.index(node)] += 1.0;
                let [x, y] = part.is_image(node);
                let (i, j) = (node % n, node / n);
                let image = if y { n - 1 - j } else { j } * n + if x { n - 1 - i } else { i };
                assert_eq!(nodes[part.index(node)], image);
            }
            let firsts = part.first_images().map(|node| part.index(node));
            let mut firsts: Vec<usize> = firsts.collect();
            firsts.sort_unstable();
            assert!(firsts.into_iter().eq(0..part.len()));
            for (&node, count) in nodes.iter().zip(counts) {
                assert!((part.multiplicity(node) - count).abs() < 1e-12);
            }
        }
    }
}
