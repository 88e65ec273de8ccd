//! The suction of a void on the inner face, in four f32 lanes: `layered/suction.rs`.

use super::super::suction::weights;
use super::{Layered, Scratch};
use crate::mesh::enclosed;
use crate::mesh::height_field::HeightField;
use crate::mesh::lanes::{Field, Layout, load, store, store_first};
use crate::mesh::vec3::{Vec3, add};
use crate::mesh::{Chest, Pocket, Sheet};
use std::ops::Range;
use wide::f32x4;

/// A suction on the finest grid. The coarser ones have none, which costs fewer cycles and converges for more tissue: their defect terms contain it.
#[derive(Clone, Debug)]
pub(crate) struct OnFinest {
    /// Pressure \[kPa\].
    pub(crate) kpa: f64,
    pub(crate) wall: Chest,
    pub(crate) nodes_per_side: usize,
}

impl Layered {
    /// The same under the suction of a void; zero is none.
    pub(crate) fn under(self, suction: OnFinest) -> Self {
        Self { suction: Some(suction).filter(|suction| suction.kpa > 0.0), ..self }
    }

    /// Places the suction on a grid of a spacing \[mm\].
    pub(super) fn draw(&self, (layout, spacing): (&Layout, f64), scratch: &mut Scratch) {
        let suction = |of: &OnFinest| {
            let pressure = of.kpa * spacing / self.stiffness;
            LaneSuction::new(pressure, &of.wall, (layout, spacing), self.pocket)
        };
        let own = self.suction.as_ref().filter(|of| of.nodes_per_side == layout.nodes_per_side);
        scratch.suction = own.map(suction);
    }
}

/// A suction on a grid; lengths in spacings.
#[derive(Clone, Debug)]
pub(super) struct LaneSuction {
    /// Pressure \[stiffness/spacing\].
    pressure: f32,
    wall: HeightField<f32x4>,
    /// Positions of the inner face at rest.
    rest: Field,
    /// Part of each stored node's surroundings in the pocket, zero of nodes that are not free.
    weights: Vec<f32>,
    /// Scratch: these parts times heights over the wall.
    heights: Vec<f32>,
    /// Rows of nodes with a neighbour in the pocket.
    rows: Range<usize>,
}

impl LaneSuction {
    /// On the grid of a layout with a spacing \[mm\], of a pressure times the spacing over the stiffness.
    pub(super) fn new(
        pressure: f64,
        wall: &Chest,
        (layout, spacing): (&Layout, f64),
        pocket: Pocket,
    ) -> Self {
        let radius = spacing * (layout.nodes_per_side / 2) as f64;
        let of_grid = weights(&Sheet::new(layout.nodes_per_side, radius), pocket);
        let mut weights = vec![0.0; layout.len()];
        let mut within = layout.rows..0;
        for j in 0..layout.rows {
            for i in 0..layout.columns {
                let weight = of_grid[layout.node(i, j)];
                weights[j * layout.pitch + i] = weight as f32;
                if weight > 0.0 {
                    within = within.start.min(j)..j + 1;
                }
            }
        }
        Self {
            pressure: pressure as f32,
            wall: wall.scaled(1.0 / spacing).heights(),
            rest: layout.inner_at_rest(),
            heights: vec![0.0; weights.len()],
            weights,
            rows: within.start.saturating_sub(1)..(within.end + 1).min(layout.rows),
        }
    }

    /// Adds −p ∂V/∂u.
    pub(super) fn add_forces(&mut self, layout: &Layout, u: &Field, f: &mut Field) {
        let Self { pressure, wall, rest, weights, heights, rows } = self;
        let at = |k: usize| -> Vec3 { add(rest.load(k), u.load(k)) };
        for k in (rows.start * layout.pitch..rows.end * layout.pitch).step_by(4) {
            let [x, y, z] = at(k);
            let height = z - wall.at([x, y]).height;
            let weight = load(weights, k);
            // Places beside the patch may be beyond the wall's end.
            let counts = weight.simd_gt(f32x4::ZERO);
            store(heights, k, counts & (weight * height));
        }
        let place = |k: usize| {
            let [x, y, _] = at(k);
            [x, y]
        };
        let pressure = f32x4::splat(-*pressure);
        layout.free_groups(|group| {
            let k = group.first;
            if !rows.contains(&(k / layout.pitch)) {
                return;
            }
            let height = |k: usize| load(heights, k);
            let [across, along] = enclosed::gradient(k, layout.pitch, place, height);
            let up = load(weights, k) * enclosed::area(k, layout.pitch, place);
            let [slope_x, slope_y] = wall.at(place(k)).slope;
            let force =
                [across - up * slope_x, along - up * slope_y, up].map(|part| part * pressure);
            store_first(f, k, group.count, add(f.load(k), force));
        });
    }
}
