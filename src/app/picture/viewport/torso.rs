//! The torso in place of the tissue, and the cameras before it.

use super::{Options, Viewport};
use crate::body::frame::Frame;
use crate::body::surface::Surface;
use crate::scene::{FittedTorso, Placement, Scene};
use crate::session::Session;
use crate::view::camera::{Camera, Standing, View};
use crate::view::torso::Torso;
use std::rc::Rc;
use std::sync::Arc;

/// Greatest number of vertices of a scan that is kept beside its reduced surface: 10 MB.
const KEPT_VERTICES: usize = 200_000;
/// Number of bodies that are kept.
const BODIES: usize = 8;

/// The built-in torsos as they are drawn.
#[derive(Default)]
pub(super) struct BuiltIn {
    /// That of plans with another chest.
    usual: Option<Rc<Torso>>,
    /// Those that scenes have for their chests.
    shaped: Vec<(Arc<FittedTorso>, Rc<Torso>)>,
}

/// The body of a scan as it is drawn for a place of a scene, and of its other side.
pub(super) struct ScannedBody {
    place: Box<Placement>,
    frames: Vec<Frame>,
    torso: Rc<Torso>,
}

/// The standard pose of a view; none from the head.
pub(super) fn pose_of(view: View) -> Option<Standing> {
    match view {
        View::Front => Some(Standing::Front),
        View::Side => Some(Standing::Side),
        View::All => Some(Standing::ThreeQuarter),
        View::Top => None,
    }
}

/// The camera of a standard pose before a torso.
pub(super) fn standing(torso: &Torso, aspect: f32, standing: Standing) -> Camera {
    let (ball, middle, azimuth) = torso.seen();
    Camera::standing(ball, aspect, standing).moved_to(middle).turned_by(azimuth)
}

impl BuiltIn {
    /// The torso that a scene has for its chest.
    fn shaped(&mut self, fitted: Arc<FittedTorso>) -> Rc<Torso> {
        let is_known = |(known, _): &&(Arc<FittedTorso>, _)| Arc::ptr_eq(known, &fitted);
        if let Some((_, torso)) = self.shaped.iter().find(is_known) {
            return Rc::clone(torso);
        }
        if self.shaped.len() == BODIES {
            self.shaped.remove(0);
        }
        let torso = Rc::new(Torso::of_torso(&fitted));
        self.shaped.push((fitted, Rc::clone(&torso)));
        torso
    }
}

impl Viewport {
    /// The body, if these options draw it, uncut: that of the scan on which a scene lies, else the built-in torso, shaped by a tape where a scene has it for its chest.
    pub(super) fn torso(&mut self, options: &Options, scene: &Scene) -> Option<Rc<Torso>> {
        if !options.has_torso() {
            return None;
        }
        if let Some(placement) = &scene.placement {
            if let Some(kept) = &placement.surface {
                self.add_body(scene, kept.surface());
            }
            let frames = scene.frames();
            let is_same = |body: &&ScannedBody| body.place == *placement && body.frames == frames;
            if let Some(body) = self.bodies.iter().find(is_same) {
                return Some(Rc::clone(&body.torso));
            }
        }
        if let Some(Ok(fitted)) = scene.fitted_torso() {
            return Some(self.built_in.shaped(fitted));
        }
        let usual = &mut self.built_in.usual;
        if usual.is_none() {
            *usual = Torso::new().map(Rc::new);
        }
        usual.clone()
    }

    /// Keeps the surface on which a scene lies, that of its scan before a reduced one.
    pub(crate) fn add_body(&mut self, scene: &Scene, surface: &Surface) {
        let Some(placement) = &scene.placement else { return };
        let frames = scene.frames();
        if self.bodies.iter().any(|body| body.place == *placement && body.frames == frames) {
            return;
        }
        let of_scan = self.scan.as_ref().filter(|(marks, _)| *marks == placement.marks);
        let surface = of_scan.map_or(surface, |(_, surface)| surface);
        if let Some(torso) = Torso::of_body(surface, &frames, &placement.marks) {
            if self.bodies.len() == BODIES {
                self.bodies.remove(0);
            }
            let (place, torso) = (placement.clone(), Rc::new(torso));
            self.bodies.push(ScannedBody { place, frames, torso });
        }
    }

    /// Keeps the surface of a scan, the last one, for all plans on its marks.
    pub(crate) fn keep_scan(&mut self, scene: &Scene, surface: &Surface) {
        if let Some(placement) = &scene.placement {
            let is_kept = surface.positions.len() <= KEPT_VERTICES;
            self.scan = is_kept.then(|| (placement.marks, surface.clone()));
            self.add_body(scene, surface);
        }
    }

    /// Changes the options; with or without a torso from now on, the camera moves to its first view.
    pub(crate) fn change(
        &mut self,
        session: &Session,
        options: &mut Options,
        change: impl FnOnce(&mut Options),
    ) {
        let had_torso = options.has_torso();
        change(options);
        if options.has_torso() != had_torso {
            self.look(session, options, View::All);
        }
    }

    /// Moves the camera to a standard view, before the body of a scan that gets its marks, or a torso if these options draw it.
    pub(crate) fn look(&mut self, session: &Session, options: &Options, view: View) {
        let torso = match &self.scanned {
            Some(scanned) => Some(Rc::clone(&scanned.torso)),
            None => self.torso(options, session.scene()),
        };
        let Some((torso, pose)) = torso.zip(pose_of(view)) else {
            return self.fit(session, view);
        };
        self.camera = standing(&torso, self.aspect, pose);
        self.fitted = Some((self.ball_to_fit(session), view));
    }
}
