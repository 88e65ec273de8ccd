//! What a dead load holds on a grid: the forces of the skin at rest, less a change of weight.

use super::{Layered, Scratch, SkinScratch};
use crate::mesh::lanes::{Field, Layout};
use crate::mesh::{Grown, Rest};
use crate::model::ElasticModel;
use std::sync::Arc;

impl Layered {
    /// The skin at rest on a grid, `rest` being `None` over a flat wall, of which this has grown on the finest grid.
    pub(super) fn skin_at_rest(
        &self,
        layout: &Layout,
        rest: Option<&Rest>,
        grown: Option<&Grown>,
    ) -> SkinScratch {
        let grown = grown.map(|grown| grown.restricted(layout.nodes_per_side));
        let skin = |rest: &Rest| {
            let surface = rest.outermost().stretched(self.natural.as_ref()).grown(grown.as_ref());
            SkinScratch::new(layout, surface, self.cells.len())
        };
        rest.map_or_else(|| skin(&layout.plane()), skin)
    }

    /// Sets the forces at rest: those of the skin, less the change of weight.
    pub(super) fn load_at_rest(
        &self,
        (layout, spacing): (&Layout, f64),
        rest: Option<&Arc<Rest>>,
        scratch: &mut Scratch,
    ) {
        let of_skin = match self.natural {
            Some(_) => self.skin_forces_at_rest(layout, rest, scratch),
            None => Field::default(),
        };
        let Some(finest) = &self.weighed else {
            scratch.at_rest = of_skin;
            return;
        };
        let mut at_rest = Field::new(layout.len(), self.layers());
        let unit = 1.0 / (self.stiffness * spacing);
        // Tissue of even thickness over a flat wall is not given on coarser grids.
        let weight = match rest {
            Some(rest) => rest.change_of_weight(),
            None => finest.restricted(layout.nodes_per_side).change_of_weight(),
        };
        for (layer, weight) in weight.iter().enumerate() {
            let skin =
                Some(&of_skin).filter(|skin| layer + 1 == self.layers() && !skin.x.is_empty());
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let k = j * layout.pitch + i;
                    let own = skin.map_or([0.0; 3], |skin| skin.at(k));
                    let [x, y, z] = (weight[layout.node(i, j)] * unit).to_array();
                    let at = layer * layout.len() + k;
                    at_rest.x[at] = own[0] - x as f32;
                    at_rest.y[at] = own[1] - y as f32;
                    at_rest.z[at] = own[2] - z as f32;
                }
            });
        }
        scratch.at_rest = at_rest;
    }

    /// Forces of the skin at rest, on its layer of nodes.
    fn skin_forces_at_rest(
        &self,
        layout: &Layout,
        rest: Option<&Arc<Rest>>,
        scratch: &mut Scratch,
    ) -> Field {
        let zero = Field::new(layout.len(), self.layers());
        let (mut forces, mut at_rest) = (zero.clone(), Field::new(layout.len(), 1));
        if self.grown.is_some() {
            let mut skin = self.skin_at_rest(layout, rest.map(Arc::as_ref), None);
            self.skin.forces(layout, &zero, &mut forces, &mut skin);
        } else {
            self.skin.forces(layout, &zero, &mut forces, &mut scratch.skin);
        }
        at_rest.copy_last_plane_from(&forces);
        at_rest
    }
}
