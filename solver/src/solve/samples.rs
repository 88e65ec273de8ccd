//! Problems of the tests: skin over adipose.

use super::{Problem, Tissue};
use crate::contact::{Dome, HalfBall, Obstacle};
use crate::curve::{CurveSpec, Fat};
use crate::mesh::{Attachment, Edge, Patch, Rest, Sheet};
use crate::springs::{Material, Springs};
use glam::DVec2;

/// A layer of 2 mm.
pub(crate) fn layer(curve: &CurveSpec, poisson_ratio: f64) -> Material {
    Material::of(curve, poisson_ratio, 2.0)
}

/// A sheet over a half-ball of 55 mm, to an error of 1e-3.
pub(crate) fn sheet(nodes_per_side: usize, center_mm: [f64; 2], insertion: f64) -> Problem {
    Problem {
        rest: Rest::of_sheet(Sheet::new(nodes_per_side, 75.0)),
        patch: Patch::clamped_at_pocket(75.0),
        obstacle: Obstacle::on_flat_wall(Dome::new(
            DVec2::from(center_mm),
            HalfBall::round(55.0, 55.0),
            insertion,
        )),
        materials: vec![layer(&CurveSpec::Skin {}, 0.45), layer(&CurveSpec::Adipose {}, 0.45)],
        springs: Springs::Coupled,
        tissue: Tissue::Sheet,
        tolerance: 1e-3,
        void: None,
    }
}

/// Layered tissue at rest over a pocket of 60 mm, to an error of 1e-3.
pub(crate) fn layered_at_rest(nodes_per_side: usize) -> Problem {
    let attachment = Attachment::default();
    let patch = Patch {
        radius_mm: 120.0,
        pocket_radius_mm: 60.0,
        pocket_lowered_mm: 0.0,
        edge: Edge::Attached(attachment),
    };
    let fat = layer(&CurveSpec::Fat { variant: Fat::Mid }, 0.49);
    Problem {
        rest: Rest::layered(Sheet::new(nodes_per_side, patch.radius_mm), &[10.0], 2),
        patch,
        obstacle: Obstacle::on_flat_wall(Dome::new(DVec2::ZERO, HalfBall::round(50.0, 50.0), 0.0)),
        materials: vec![layer(&CurveSpec::Skin {}, 0.45), Material { thickness_mm: 10.0, ..fat }],
        springs: Springs::Coupled,
        tissue: Tissue::Layered,
        tolerance: 1e-3,
        void: None,
    }
}
