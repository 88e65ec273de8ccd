//! The picture of the current shape: meshes, updated only after a change of their content.

use crate::body::Body;
use crate::color::{self, Pattern, Rgb, Scale};
use crate::mesh::{self, Mesh, Vertex};
use crate::quantity::{Colouring, Quantity};
use crate::section::{CapTriangle, Section};
use crate::strokes;
use crate::subject::Subject;
use crate::torso::{Attached, Shape, Torso};
use glam::Vec3;
use implant_preview_core::contact::Dome;
use implant_preview_core::measure::Fields;
use implant_preview_core::mesh::Chest;
use std::rc::Rc;
use std::sync::Arc;

/// Greatest fraction of the time for meshes during a solve \[-\].
const SHARE_WHILE_SOLVING: f64 = 0.3;

/// Meshes and the state of their sources.
#[derive(Default)]
pub struct Picture {
    /// The tissue's columns; empty without a stable shape.
    pub body: Body,
    /// Fields of the drawn shape; `None` before the first shape.
    pub fields: Option<Rc<Fields>>,
    /// The colour bar's scale; `None` for plain tissue.
    pub scale: Option<Scale>,
    /// Greatest value of the displayed quantity, at least 0.
    pub greatest: f32,
    /// The cut faces.
    pub caps: Vec<CapTriangle>,
    /// Meshes in the order of drawing: tissue, cut faces, implant, wall. An unchanged mesh stays the same `Arc`, with
    /// the same indices.
    pub meshes: [Arc<Mesh>; 4],
    /// The torso with the skin of both sides, in place of the tissue; `None` while it is not asked for.
    pub torso: Option<Arc<Mesh>>,
    /// What the torso was made of.
    torso_made: Option<(u64, Colouring)>,
    /// The shape of the other side that the torso was made of.
    other_made: Option<Option<Rc<Fields>>>,
    /// The torso, and how it moves with the tissue of its sides.
    attached: Option<(Rc<Torso>, Vec<Attached>)>,
    /// Previous meshes of the torso, whose memory is reused.
    torsos_before: Vec<Arc<Mesh>>,
    /// Number of meshes made so far.
    pub meshes_made: u64,
    /// The scale's colours.
    pub table: Arc<Vec<Rgb>>,
    /// Previous meshes of the tissue, possibly still in use by the renderer. Their memory is reused: an allocation per
    /// shape would fragment the heap, which never shrinks in a browser.
    tissues_before: Vec<Arc<Mesh>>,
    /// The tissue's indices, common to all shapes of one triangulation.
    tissue_indices: Arc<Vec<u32>>,
    /// The subject's revision of the shape.
    shape_made: Option<u64>,
    colouring_made: Option<Colouring>,
    tissues_made: Vec<String>,
    section_made: Option<Section>,
    dome_made: Option<Dome>,
    /// Radius of the drawn wall, radius of the patch, the wall.
    wall_made: Option<(f32, f64, Chest)>,
    /// Start and duration of the last update of the shape, colours and cut included \[s\].
    last_shape: Option<(f64, f64)>,
}

impl Picture {
    /// Updates the picture. Returns whether the picture is current; if not, call again in the next frame. `seconds` is
    /// a clock.
    pub fn update(
        &mut self,
        subject: &impl Subject,
        colouring: Colouring,
        section: Section,
        seconds: &dyn Fn() -> f64,
    ) -> bool {
        let layers = &subject.scene().layers;
        let tissues = layers.iter().map(|layer| &layer.tissue);
        let rename = !tissues.clone().eq(&self.tissues_made);
        let recolor = rename || self.colouring_made != Some(colouring);
        let stale = self.shape_made != Some(subject.revision());
        // Values belong to the shape of their own revision.
        let start = seconds();
        // A draft is displayed immediately.
        let is_unsettled = subject.is_unsettled();
        let wait = is_unsettled && !recolor && self.should_wait(start);
        let reshape = stale && !wait;
        let recut = self.section_made != Some(section);
        if reshape {
            self.make_shape(subject);
        }
        if !(reshape || recolor || recut) {
            return !stale;
        }
        // The drawn shape may have another number of layers than the scene.
        let drawn = self.body.slabs.iter().map(|slab| slab.layer + 1).max().unwrap_or(0);
        let colors: Vec<Rgb> = (0..drawn.max(layers.len()))
            .map(|k| color::tissue(layers.get(k).map_or("", |layer| &layer.tissue), k))
            .collect();
        if reshape || recolor {
            self.make_colors(subject, colouring, &colors);
            self.colouring_made = Some(colouring);
        }
        if reshape || recut {
            self.caps = section.caps(&self.body);
            self.section_made = Some(section);
        }
        if reshape || recut || rename {
            let patterns: Vec<Pattern> =
                layers.iter().map(|layer| color::pattern(&layer.tissue)).collect();
            self.set_mesh(1, mesh::caps(&self.caps, &colors, &patterns));
        }
        if rename {
            self.tissues_made = tissues.cloned().collect();
        }
        if reshape {
            self.last_shape = Some((start, seconds() - start));
        }
        !stale || reshape
    }

    /// The plane at which the torso ends behind, as [`Torso::end`].
    #[must_use]
    pub fn end(&self) -> Option<(Vec3, f32)> {
        self.attached.as_ref().and_then(|(torso, _)| torso.end())
    }

    /// Updates the torso to the drawn shape and colours, or drops it.
    pub fn update_torso(&mut self, subject: &impl Subject, torso: Option<&Rc<Torso>>) {
        let made = self.shape_made.zip(self.colouring_made);
        let (Some(torso), Some(fields)) = (torso.filter(|_| !self.body.is_empty()), &self.fields)
        else {
            (self.torso, self.torso_made) = (None, None);
            return;
        };
        let is_same = self.attached.as_ref().is_some_and(|(known, _)| Rc::ptr_eq(known, torso));
        let other = subject.other_side();
        let is_same_other = match (&self.other_made, other) {
            (Some(Some(made)), Some(Some(other))) => Rc::ptr_eq(made, other),
            (made, other) => {
                made.as_ref().map(Option::is_some) == other.as_ref().map(Option::is_some)
            }
        };
        if is_same && is_same_other && made.is_some() && made == self.torso_made {
            return;
        }
        let (_, mut known) = self.attached.take().filter(|_| is_same).unzip();
        let known: &mut Vec<Attached> = known.get_or_insert_default();
        let mut attach = |fields: &Fields, side| {
            let problem = fields.solution().problem();
            let found = known.iter().position(|known| known.is_of(problem, side));
            found.map_or_else(|| torso.attached(problem, side), |k| known.swap_remove(k))
        };
        let mut attached = vec![attach(fields, other.map(|_| 0))];
        let other = other.flatten();
        attached.extend(other.map(|other| attach(other, Some(1))));
        let toward = subject.toward().map(|(to, part)| (&**to, part));
        let field = self.colouring_made.and_then(|colouring| colouring.quantity.field());
        let toward = [toward, None];
        let shapes = attached.iter().zip([Some(fields), other].into_iter().flatten()).zip(toward);
        let shapes: Vec<Shape<'_>> =
            shapes.map(|((attached, fields), toward)| Shape { attached, fields, toward }).collect();
        let room = take_unused(&mut self.torsos_before);
        let mesh = Arc::new(torso.mesh(&shapes, field, room));
        self.attached = Some((Rc::clone(torso), attached));
        self.other_made = subject.other_side().map(Option::<&Rc<Fields>>::cloned);
        self.torsos_before.extend(self.torso.replace(mesh));
        self.torso_made = made;
    }

    /// The drawn torso before, if one is drawn.
    #[must_use]
    pub fn before(&self) -> Option<&Arc<Mesh>> {
        let (torso, _) = self.attached.as_ref().filter(|_| self.torso.is_some())?;
        Some(torso.before())
    }

    fn should_wait(&self, now: f64) -> bool {
        self.last_shape.is_some_and(|(when, cost)| now - when < cost / SHARE_WHILE_SOLVING)
    }

    fn make_shape(&mut self, subject: &impl Subject) {
        let problem = subject.problem();
        self.shape_made = Some(subject.revision());
        self.fields = Some(Rc::clone(subject.fields()));
        if is_hidden(subject) {
            self.body = Body::default();
        } else if self.body.update(subject.fields().solution()) {
            self.tissue_indices = Arc::new(mesh::tissue_indices(&self.body));
        }
        let toward = subject.toward().filter(|_| !self.body.is_empty());
        if let Some((to, part)) = toward {
            self.body.move_toward(&Body::new(to.solution()), part);
        }
        // An implant without its tissue would look like an extrusion.
        let dome = (!self.body.is_empty()).then_some(&problem.obstacle.dome);
        if self.dome_made.as_ref() != dome {
            self.set_mesh(2, dome.map_or_else(Mesh::default, mesh::implant));
            self.dome_made = dome.cloned();
        }
        if let Some((to, part)) = toward {
            let to = mesh::implant(&to.solution().problem().obstacle.dome);
            let mut between = mesh::implant(&problem.obstacle.dome);
            for (vertex, to) in between.vertices.iter_mut().zip(&to.vertices) {
                for (own, other) in vertex.iter_mut().zip(to) {
                    *own += part * (other - *own);
                }
            }
            self.set_mesh(2, between);
            self.dome_made = None;
        }
        let wall_radius = self.body.block_radius.max(problem.sheet().radius_mm() as f32);
        let patch_radius = problem.sheet().radius_mm();
        let chest = &problem.obstacle.wall.0;
        let wall = Some((wall_radius, patch_radius, chest.clone()));
        if self.wall_made != wall {
            self.wall_made = wall;
            self.set_mesh(3, mesh::wall(chest, patch_radius, wall_radius));
        }
    }

    fn make_colors(&mut self, subject: &impl Subject, colouring: Colouring, colors: &[Rgb]) {
        let Colouring { quantity, skin } = colouring;
        let is_shown = !self.body.is_empty();
        let field = quantity.field().filter(|_| is_shown);
        let between = field.zip(subject.toward()).map(|(field, (to, part))| {
            let pairs = subject.fields().values(field).iter().zip(to.values(field));
            pairs.map(|(own, to)| own + part * (to - own)).collect::<Vec<f32>>()
        });
        let own = field.map(|field| subject.fields().values(field));
        let values = between.as_deref().or(own);
        self.greatest = values.map_or(0.0, color::greatest);
        let scale = quantity.scale(self.greatest, &subject.scene().layers, skin);
        self.scale = scale.filter(|_| is_shown);
        let room = take_unused(&mut self.tissues_before);
        let mut vertices = mesh::tissue_vertices(room, &self.body, colors, values);
        let mut indices = if is_shown { Arc::clone(&self.tissue_indices) } else { Arc::default() };
        if is_shown && quantity == Quantity::Wrinkles {
            let directions = subject.fields().wrinkle_directions();
            let spacing = subject.problem().sheet().spacing_mm() as f32;
            let (points, triangles) =
                strokes::along(&self.body, directions, spacing, vertices.len() as u32);
            if !points.is_empty() {
                vertices.extend(points);
                indices = Arc::new(indices.iter().copied().chain(triangles).collect());
            }
        }
        self.tissues_before.push(Arc::clone(&self.meshes[0]));
        self.set_mesh(0, Mesh { vertices, indices });
        let table = self.scale.as_ref().map_or(&[[1.0; 3]][..], |s| &s.table);
        if self.table.as_slice() != table {
            self.table = Arc::new(table.to_vec());
        }
    }

    fn set_mesh(&mut self, place: usize, mesh: Mesh) {
        self.meshes[place] = Arc::new(mesh);
        self.meshes_made += 1;
    }
}

/// The vertices of a mesh without other owners, for reuse of their memory.
fn take_unused(meshes: &mut Vec<Arc<Mesh>>) -> Vec<Vertex> {
    let unused = meshes.iter_mut().position(|mesh| Arc::get_mut(mesh).is_some());
    let mesh = unused.map(|k| meshes.swap_remove(k)).and_then(|mesh| Arc::try_unwrap(mesh).ok());
    mesh.map(|mesh| mesh.vertices).unwrap_or_default()
}

/// Is the shape hidden? True without a stable shape and for positions that are not finite.
fn is_hidden(subject: &impl Subject) -> bool {
    subject.has_no_shape() || subject.fields().solution().inner().iter().any(|p| !p.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use implant_preview_core::measure::bands::SkinLimits;
    use implant_preview_core::scene::Scene;
    use implant_preview_core::session::{Command, Session};
    use implant_preview_core::solve::Progress;
    use std::cell::Cell;

    fn by(quantity: Quantity) -> Colouring {
        Colouring { quantity, skin: SkinLimits::Tearing }
    }

    #[test]
    fn strokes_along_the_wrinkles_are_made_only_when_the_wrinkles_are_shown() {
        // The thick fat moves outwards and shortens the radii of the skin.
        let scene = Scene::from_json(
            r#"{ "implant": { "base_radius_mm": 60, "projection_mm": 45 }, "pocket_radius_mm": 65,
                 "layers": [ {}, { "thickness_mm": 50, "poisson_ratio": 0.49, "curve": { "kind": "fat" } } ],
                 "solver": { "nodes_per_side": 33, "tolerance": 1e-3 } }"#,
        );
        let mut session = Session::new(scene.unwrap()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let section = Section {
            opening: crate::section::Opening::Closed,
            angle: 0.0,
            axis: glam::Vec2::ZERO,
        };
        let mut picture = Picture::default();
        let mut tissue = |quantity| {
            picture.update(&session, by(quantity), section, &|| 0.0);
            (Arc::clone(&picture.meshes[0]), session.counters().fields)
        };
        let (plain, before) = tissue(Quantity::Strain);
        let (stroked, after) = tissue(Quantity::Wrinkles);
        let (again, _) = tissue(Quantity::Strain);
        // States and directions, once each.
        assert_eq!(after - before, 2);
        let added = stroked.vertices.len() - plain.vertices.len();
        assert!(added >= 4 * 20 && added.is_multiple_of(4), "{added}");
        assert_eq!(stroked.indices.len() - plain.indices.len(), added / 4 * 6);
        assert_eq!(stroked.indices.iter().max(), Some(&(stroked.vertices.len() as u32 - 1)));
        assert!(Arc::ptr_eq(&plain.indices, &again.indices));
        assert_eq!(plain.vertices.len(), again.vertices.len());
    }

    #[test]
    fn a_shape_between_two_has_its_points_between_theirs_and_covers_its_implant() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.insertion) = (33, 0.5);
        let solved = |scene: &Scene| {
            let mut session = Session::new(scene.clone()).unwrap();
            while session.advance(&mut || false) == Progress::Working {}
            Rc::clone(session.fields())
        };
        let from = solved(&scene);
        scene.insertion = 0.6;
        let to = solved(&scene);
        let section =
            Section { opening: crate::section::Opening::Wedge, angle: 0.3, axis: glam::Vec2::ZERO };
        let drawn = |part: f32| {
            let mut picture = Picture::default();
            let between =
                crate::subject::Between { scene: &scene, from: &from, to: &to, part, revision: 1 };
            picture.update(&between, by(Quantity::Strain), section, &|| 0.0);
            picture
        };
        let [first, middle, last] = [0.0, 0.5, 1.0].map(drawn);
        let apex = |picture: &Picture| picture.body.levels[0][16 * 33 + 16].z;
        assert_eq!(first.body.levels, Body::new(from.solution()).levels);
        assert!((apex(&middle) - 0.5 * (apex(&first) + apex(&last))).abs() < 1e-3);
        assert!(apex(&last) > apex(&first) + 1.0);
        assert!(middle.greatest > first.greatest && middle.greatest < last.greatest);
        for picture in [&first, &middle, &last] {
            assert!(protrusion(picture).unwrap() < 0.0);
            assert!(!picture.caps.is_empty());
        }
    }

    /// Greatest height of the drawn implant above the drawn skin \[mm\]; `None` without tissue.
    fn protrusion(picture: &Picture) -> Option<f32> {
        let (body, implant) = (&picture.body, &picture.meshes[2]);
        let skin = body.levels.first()?;
        // Heights of the skin over the vertices of the implant, from the triangles above them.
        let height = |at: glam::Vec2| {
            body.triangles.iter().find_map(|triangle| {
                let [a, b, c] = triangle.map(|k| skin[k as usize]);
                let cross = |p: Vec3, q: Vec3| (q - p).truncate().perp_dot(at - p.truncate());
                let weights = [cross(b, c), cross(c, a), cross(a, b)];
                let area = weights.iter().sum::<f32>();
                (area > 0.0 && weights.iter().all(|w| *w >= -1e-4 * area))
                    .then(|| (weights[0] * a.z + weights[1] * b.z + weights[2] * c.z) / area)
            })
        };
        let above = implant.vertices.iter().step_by(7).filter_map(|vertex| {
            let [x, y, z, ..] = *vertex;
            Some(z - height(glam::vec2(x, y))?)
        });
        Some(above.fold(f32::MIN, f32::max))
    }

    #[test]
    fn the_implant_never_protrudes_through_the_skin_during_a_solve() {
        for mut scene in [Scene::opening(), Scene::sheet()] {
            scene.solver.nodes_per_side = 33;
            let section = Section {
                opening: crate::section::Opening::Closed,
                angle: 0.0,
                axis: glam::Vec2::ZERO,
            };
            let (mut session, mut picture) =
                (Session::new(scene.clone()).unwrap(), Picture::default());
            let (mut pictures, mut gesture) = (0, 0);
            let mut watch = |session: &mut Session| loop {
                picture.update(session, by(Quantity::Strain), section, &|| 1e9);
                if let Some(mm) = protrusion(&picture) {
                    pictures += 1;
                    assert!(mm < 0.0, "{mm} mm, {:?}", session.displayed());
                } else {
                    assert!(picture.meshes[2].vertices.is_empty(), "an implant without tissue");
                }
                if session.advance(&mut || true) == Progress::Done {
                    break;
                }
            };
            watch(&mut session);
            for (projection_mm, thickness_mm, nodes) in
                [(54.0, 8.0, 33), (25.0, 8.0, 33), (50.0, 14.0, 33), (30.0, 14.0, 49)]
            {
                scene.implant.projection_mm = projection_mm;
                scene.layers.last_mut().unwrap().thickness_mm = thickness_mm;
                scene.solver.nodes_per_side = nodes;
                gesture += 1;
                let edit = Command::Edit { scene: Box::new(scene.clone()), gesture };
                session.apply(edit).unwrap();
                watch(&mut session);
                assert!(!session.has_no_shape());
            }
            assert!(pictures > 20, "{pictures}");
        }
    }

    #[test]
    fn the_picture_takes_a_limited_fraction_of_the_time_during_a_solve() {
        let mut scene = Scene::default();
        scene.solver.nodes_per_side = 33;
        let mut session = Session::new(scene.clone()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let (mut picture, section) = (
            Picture::default(),
            Section {
                opening: crate::section::Opening::Closed,
                angle: 0.0,
                axis: glam::Vec2::ZERO,
            },
        );
        // Each reading of the clock is one second later: the first picture takes one second.
        let now = Cell::new(0.0);
        let clock = || now.replace(now.get() + 1.0);
        let mut update =
            |session: &Session, quantity| picture.update(session, by(quantity), section, &clock);
        assert!(update(&session, Quantity::Strain));
        let mut edit = |session: &mut Session, insertion| {
            scene.insertion = insertion;
            session.apply(Command::Edit { scene: Box::new(scene.clone()), gesture: 1 }).unwrap();
            // The first piece of work ends on a coarse grid.
            session.advance(&mut || true);
            assert!(session.is_working());
        };
        edit(&mut session, 0.5);
        assert!(!update(&session, Quantity::Strain), "too soon");
        assert!(update(&session, Quantity::Pressure), "another quantity does not wait");
        edit(&mut session, 0.6);
        assert!(!update(&session, Quantity::Pressure), "too soon again");
        now.set(now.get() + 10.0);
        assert!(update(&session, Quantity::Pressure), "it has waited long enough");
        while session.advance(&mut || false) == Progress::Working {}
        assert!(update(&session, Quantity::Pressure), "nothing is being solved any more");
    }
}
