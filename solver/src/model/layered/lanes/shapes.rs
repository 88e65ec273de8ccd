//! The cells at rest in f32 lanes: one shape a layer over a flat wall, arrays of cells over a curved wall.

use crate::mesh::Rest;
use crate::mesh::lanes::{Layout, load};
use crate::mesh::vec3::{add, scale, sub};
use crate::model::layered::border::{Border, BorderCell, Four};
use crate::model::layered::modes::{Corners, Modes, modes};
use crate::model::layered::shape::{Even, InPlane, Own, RestShape};
use crate::model::layered::sides::{self, Oblique, Skew};
use crate::model::layered::variation::Variation;
use glam::DVec3;
use wide::f32x4;

/// The shapes of all cells.
#[derive(Clone, Debug)]
pub(super) enum Shapes {
    Flat(Vec<Even>),
    Curved(Box<CurvedLayers>),
}

impl Default for Shapes {
    fn default() -> Self {
        Self::Flat(Vec::new())
    }
}

/// The shapes of the cells of each layer.
pub(super) trait Layers {
    type Shape: RestShape;
    type BorderShape: RestShape;

    /// Of the regular cells whose first corner is the stored node k of the inner face.
    fn regular(&self, layer: usize, k: usize) -> Self::Shape;

    /// Of a group of cells at the border.
    fn at_border(&self, layer: usize, group: usize, four: &Four) -> Self::BorderShape;

    /// The shape of that group in the stiffness that a smoother inverts.
    fn inverted_at_border(&self, layer: usize, group: usize) -> Self::Shape;
}

impl Layers for Vec<Even> {
    type Shape = Even;
    type BorderShape = InPlane;

    #[inline(always)]
    fn regular(&self, layer: usize, _k: usize) -> Even {
        self[layer]
    }

    fn at_border(&self, layer: usize, _group: usize, four: &Four) -> InPlane {
        four.upright(&self[layer])
    }

    fn inverted_at_border(&self, layer: usize, _group: usize) -> Even {
        self[layer]
    }
}

/// Cells over a curved wall. Columns are straight, so that the layers share the vectors that their skews are made of.
#[derive(Clone, Debug)]
pub(super) struct CurvedLayers {
    /// Of the cell at each stored node, shape (layers, stored nodes): 𝐉⁻¹ by columns, volume over spacing² and nominal height.
    sides: [Vec<f32>; 9],
    weight: Vec<f32>,
    /// Twists and d of layers with thicknesses of their own, shape (layers, stored nodes); empty: those below.
    skews: Vec<Vec<f32>>,
    /// Of the cells at each stored node: the twist b₁₂ of the inner face, then those parts of the columns' directions
    /// that are sums over the corners with the signs ξ, η, ξη.
    twist: [Vec<f32>; 3],
    directions: [Vec<f32>; 9],
    /// Height of the middle of each layer, and of the layer \[spacings\].
    heights: Vec<[f32x4; 2]>,
    length: usize,
    /// Of the groups of four cells at the border, shape (layers, groups).
    border: Vec<Own>,
    groups: usize,
}

impl Layers for CurvedLayers {
    type Shape = Own;
    type BorderShape = Own;

    #[inline(always)]
    fn regular(&self, layer: usize, k: usize) -> Own {
        let at = k + layer * self.length;
        let three = |parts: &[Vec<f32>], k: usize| {
            [load(&parts[0], k), load(&parts[1], k), load(&parts[2], k)]
        };
        let of_side = |side: usize| three(&self.sides[3 * side..], at);
        let sides = Oblique([of_side(0), of_side(1), of_side(2)]);
        let weight = load(&self.weight, at);
        if !self.skews.is_empty() {
            let part = |part: usize| three(&self.skews[3 * part..], at);
            let skew = Skew { twist: [part(0), part(1), part(2)], d: part(3) };
            return Own { sides, variation: Variation::of_sides(&sides), weight, skew };
        }
        let direction = |sign: usize| three(&self.directions[3 * sign..], k);
        let [middle, height] = self.heights[layer];
        let (along, half) = (direction(2), height * f32x4::HALF);
        let inner = three(&self.twist, k);
        let skew = Skew {
            twist: [
                add(inner, scale(along, middle)),
                scale(direction(0), half),
                scale(direction(1), half),
            ],
            d: scale(along, height),
        };
        Own { sides, variation: Variation::of_sides(&sides), weight, skew }
    }

    fn at_border(&self, layer: usize, group: usize, _four: &Four) -> Own {
        self.border[layer * self.groups + group]
    }

    fn inverted_at_border(&self, layer: usize, group: usize) -> Own {
        self.border[layer * self.groups + group]
    }
}

impl CurvedLayers {
    /// The cells of a layout, of tissue at rest on its grid.
    pub(super) fn new(layout: &Layout, rest: &Rest) -> Self {
        let (n, length) = (layout.nodes_per_side, layout.len());
        let (spacing, layers) = (rest.sheet().spacing_mm(), rest.cells().len());
        let per_spacing = 1.0 / spacing;
        let total: f64 = rest.cells().iter().map(|cells| cells.height_mm * per_spacing).sum();
        let zeros = |length: usize| vec![0.0_f32; length];
        let mut below = 0.0;
        let heights = rest.cells().iter().map(|cells| {
            let height = cells.height_mm * per_spacing;
            let middle = below + 0.5 * height;
            below += height;
            [middle, height]
        });
        let heights: Vec<[f64; 2]> = heights.collect();
        let mut curved = Self {
            sides: [0; 9].map(|_| zeros(length * layers)),
            weight: zeros(length * layers),
            skews: Vec::new(),
            twist: [0; 3].map(|_| zeros(length)),
            directions: [0; 9].map(|_| zeros(length)),
            heights: heights.iter().map(|pair| pair.map(|h| f32x4::splat(h as f32))).collect(),
            length,
            border: Vec::new(),
            groups: 0,
        };
        if rest.is_tapered() {
            curved.skews = (0..12).map(|_| zeros(length * layers)).collect();
        }
        let at = |layer: usize, k: usize| (rest.node(layer, k) * per_spacing).to_array();
        for (j, &(from, to)) in layout.regular.iter().enumerate() {
            for i in from as usize..to as usize {
                let node = layout.node(i, j);
                let corners = [node, node + 1, node + n + 1, node + n];
                let face = |layer: usize| Corners::new(corners.map(|k| at(layer, k)));
                let (inner, outer) = (face(0), face(layers));
                let k = j * layout.pitch + i;
                for axis in 0..3 {
                    curved.twist[axis][k] = inner.xy[axis] as f32;
                    let ends = [(inner.x, outer.x), (inner.y, outer.y), (inner.xy, outer.xy)];
                    for (part, (inner, outer)) in ends.into_iter().enumerate() {
                        let direction = (outer[axis] - inner[axis]) / total;
                        curved.directions[3 * part + axis][k] = direction as f32;
                    }
                }
                for (layer, [middle, height]) in heights.iter().enumerate() {
                    let modes = if rest.is_tapered() {
                        modes(&face(layer), &face(layer + 1))
                    } else {
                        let linear = middle_of(&inner, &outer, [middle / total, height / total]);
                        Modes { linear, ..Modes::default() }
                    };
                    let (Oblique(sides), skew, volume) = sides::of_rest(&modes);
                    let at = k + layer * length;
                    let skews = skew.twist.as_flattened().iter().chain(&skew.d);
                    for (array, value) in curved.skews.iter_mut().zip(skews) {
                        array[at] = *value as f32;
                    }
                    for (array, value) in curved.sides.iter_mut().zip(sides.as_flattened()) {
                        array[at] = *value as f32;
                    }
                    let law = rest.law_factor(layer, &corners);
                    curved.weight[at] = (volume / height * law) as f32;
                }
            }
        }
        curved.add_border(&Border::cells(layout), rest, &heights);
        curved
    }

    fn add_border(&mut self, cells: &[BorderCell], rest: &Rest, heights: &[[f64; 2]]) {
        self.groups = cells.len().div_ceil(4);
        let per_spacing = 1.0 / rest.sheet().spacing_mm();
        for (layer, [_, height]) in heights.iter().enumerate() {
            let shape = |cell: &BorderCell| {
                let face = |layer: usize| {
                    cell.gather(|k: usize| -> DVec3 { rest.node(layer, k) * per_spacing })
                };
                let (sides, skew, volume) = sides::of_rest(&modes(&face(layer), &face(layer + 1)));
                let law = rest.law_factor(layer, &cell.corners);
                (sides, skew, law * volume * cell.share() / (height * cell.area))
            };
            self.border.extend(cells.chunks(4).map(|four| {
                let shapes = [0, 1, 2, 3].map(|lane| shape(&four[lane.min(four.len() - 1)]));
                let lanes = |value: &dyn Fn(usize) -> f64| {
                    f32x4::new([0, 1, 2, 3].map(|lane| value(lane) as f32))
                };
                let matrix = |of: &dyn Fn(usize) -> [[f64; 3]; 3]| {
                    [0, 1, 2].map(|c| [0, 1, 2].map(|r| lanes(&|lane| of(lane)[c][r])))
                };
                let sides = Oblique(matrix(&|lane| shapes[lane].0.0));
                let skew = Skew {
                    twist: matrix(&|lane| shapes[lane].1.twist),
                    d: [0, 1, 2].map(|axis| lanes(&|lane| shapes[lane].1.d[axis])),
                };
                let weight = lanes(&|lane| shapes[lane].2);
                Own { sides, variation: Variation::of_sides(&sides), weight, skew }
            }));
        }
    }
}

/// The linear modes of a cell between two faces of its columns, at a fraction of their length and of a fraction's height.
fn middle_of(inner: &Corners<f64>, outer: &Corners<f64>, [at, height]: [f64; 2]) -> [[f64; 3]; 3] {
    let between = |a, b| scale(add(scale(a, 1.0 - at), scale(b, at)), 0.5);
    [
        between(inner.x, outer.x),
        between(inner.y, outer.y),
        scale(sub(outer.sum, inner.sum), 0.25 * height),
    ]
}
