//! The meshes of the present shape, remade only when what they show has changed.

use crate::measure::{Fields, Status};
use crate::session::Session;
use crate::view::body::Body;
use crate::view::color::{self, Quantity, Rgb, Scale};
use crate::view::mesh::{self, Mesh};
use crate::view::section::{CapTriangle, Section};
use std::sync::Arc;
use web_time::Instant;

/// While solving, no more than this share of the time goes into meshes.
const SHARE_WHILE_SOLVING: f64 = 0.3;

/// Meshes and what they were made from.
#[derive(Default)]
pub(crate) struct Picture {
    /// The tissue's columns; empty when there is no stable shape to show.
    pub(crate) body: Body,
    /// The fields of the shape.
    pub(crate) fields: Fields,
    /// The colour bar's scale; `None` for plain tissue.
    pub(crate) scale: Option<Scale>,
    /// The cut faces.
    pub(crate) caps: Vec<CapTriangle>,
    /// In the renderer's order: tissue, cut faces, implant, wall.
    pub(crate) meshes: [Arc<Mesh>; 4],
    /// The scale's colours.
    pub(crate) table: Arc<Vec<Rgb>>,
    shape_made: Option<ShapeKey>,
    colors_made: Option<(Quantity, Vec<String>)>,
    section_made: Option<Section>,
    last_shape: Option<(Instant, f64)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct ShapeKey {
    revision: u64,
    hidden: bool,
}

impl Picture {
    /// Brings the picture up to date. Returns whether it is; else ask again next frame.
    pub(crate) fn update(
        &mut self,
        session: &Session,
        quantity: Quantity,
        section: Section,
    ) -> bool {
        let key = ShapeKey { revision: session.revision(), hidden: is_hidden(session) };
        let stale = self.shape_made != Some(key);
        let reshape = stale && !(session.is_working() && self.should_wait());
        if reshape {
            let start = Instant::now();
            self.make_shape(session, key);
            self.last_shape = Some((Instant::now(), start.elapsed().as_secs_f64()));
        }
        let tissues: Vec<String> =
            session.scene().layers.iter().map(|l| l.tissue.clone()).collect();
        let recolor =
            self.colors_made.as_ref().is_none_or(|(q, t)| *q != quantity || *t != tissues);
        let recut = self.section_made != Some(section);
        // A shape that waits still has its own number of layers.
        let colors: Vec<Rgb> = (0..self.body.layers().max(tissues.len()))
            .map(|k| color::tissue(tissues.get(k).map_or("", String::as_str), k))
            .collect();
        if reshape || recolor {
            self.make_colors(session, quantity, &colors);
            self.colors_made = Some((quantity, tissues));
        }
        if reshape || recut {
            self.caps = section.caps(&self.body, 0);
            self.section_made = Some(section);
        }
        if reshape || recut || recolor {
            self.meshes[1] = Arc::new(mesh::caps(&self.caps, &colors));
        }
        !stale || reshape
    }

    fn should_wait(&self) -> bool {
        self.last_shape.is_some_and(|(when, cost)| {
            when.elapsed().as_secs_f64() < cost * (1.0 / SHARE_WHILE_SOLVING - 1.0)
        })
    }

    fn make_shape(&mut self, session: &Session, key: ShapeKey) {
        let problem = session.solver().problem();
        self.fields.clone_from(session.fields());
        let radius = problem.sheet.radius_mm() as f32;
        let body = Body::new(problem, session.shape(), &self.fields);
        let wall_radius = body.block_radius.max(radius);
        self.body = if key.hidden { Body::default() } else { body };
        self.meshes[2] = Arc::new(mesh::implant(&problem.dome));
        self.meshes[3] = Arc::new(mesh::wall(wall_radius));
        self.shape_made = Some(key);
    }

    fn make_colors(&mut self, session: &Session, quantity: Quantity, colors: &[Rgb]) {
        let values = quantity.values(&self.fields);
        self.meshes[0] = Arc::new(mesh::tissue(&self.body, colors, 0, values));
        self.scale = quantity.scale(&self.fields, &session.scene().layers);
        let table = self.scale.as_ref().map_or(&[[1.0; 3]][..], |s| &s.table);
        if self.table.as_slice() != table {
            self.table = Arc::new(table.to_vec());
        }
    }
}

/// No shape is shown where the springs have none, nor one that is not made of numbers.
fn is_hidden(session: &Session) -> bool {
    let unstable = !session.is_working()
        && session.outcome().is_some_and(|outcome| outcome.status == Status::Unstable);
    unstable || session.shape().iter().any(|p| !p.is_finite())
}
