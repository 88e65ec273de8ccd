//! The 3-D view: camera, picture, colour bar, values at the pointer.
//!
//! Without GL (in tests, without WebGL 2) only the picture itself is missing.

mod before;
mod directions;
mod envelope;
mod legend;
mod marks;
mod moves;
mod options;
mod overlay;
mod panes;
mod readout;
mod renderer;
mod scan;
mod shown;
mod torso;

pub(crate) use before::Before;
pub(crate) use envelope::Outline;
pub(crate) use legend::lower_edge;
pub(crate) use marks::labelled_box;
pub(crate) use options::{Options, Subject as PictureSubject};
pub(crate) use overlay::{pointer_box, scale_bar};
pub(crate) use scan::{Dot, Touched};
pub(crate) use shown::Shown;

use crate::app::texts::tr;
use crate::app::widgets::keep_press;
use crate::body;
use crate::scene::Scene;
use crate::session::Session;
use crate::solve::{Problem, Tissue};
use crate::study::SectionBand;
use crate::view::body::Body;
use crate::view::camera::{Ball, Camera, View};
use crate::view::color::{Rgb, Scale};
use crate::view::mesh::Mesh;
use crate::view::picture::Picture;
use crate::view::section::{Opening, Section};
use crate::view::subject::{Between, LastAnswer, Subject};
use crate::view::wall;
use eframe::egui::{self, Align2, Pos2, Rect, Response, Sense, TextStyle, Ui, WidgetInfo};
use eframe::{egui_glow, glow};
use egui::layers::ShapeIdx;
use glam::{Vec3, Vec4};
use marks::{Marked, Marks};
use panes::Pane;
use renderer::{Areola, Frame, Renderer};
use shown::{colouring, of_legend};
use std::sync::{Arc, Mutex};
use web_time::Instant;

/// Opacity of the veil over the last answer of a scene without one \[-\].
const VEIL: f32 = 0.6;

/// The 3-D view with its camera.
pub(crate) struct Viewport {
    gl: Option<Arc<glow::Context>>,
    renderer: Option<Arc<Mutex<Renderer>>>,
    error: Option<String>,
    camera: Camera,
    /// The ball to which the camera is fitted, and the view of it; `None` after the user has moved the camera.
    fitted: Option<(Ball, View)>,
    /// What the camera saw of the last body: see [`Torso::seen`].
    stood: Option<(Ball, Vec3, f32)>,
    is_placed: bool,
    aspect: f32,
    id: Option<egui::Id>,
    /// Where the current scene's picture was drawn last.
    area: Option<Rect>,
    /// Place for handles in the order of drawing: over the picture, under the marks.
    handles: Option<ShapeIdx>,
    marks: Marks,
    picture: Picture,
    /// The built-in torsos, once they are drawn.
    built_in: torso::BuiltIn,
    /// The bodies of scans, with the places of their scenes.
    bodies: Vec<torso::ScannedBody>,
    /// The surface of the last scan, with its marks.
    scan: Option<(body::marks::Marks, body::surface::Surface)>,
    /// The body of a scan that was shown last.
    scanned: Option<scan::Scanned>,
    /// Place of the border between before and after, from the left \[-\].
    wipe: f32,
    /// The pins' pictures beside the picture.
    panes: Vec<Pane>,
    /// Colour table of all pictures side by side.
    common_table: Arc<Vec<Rgb>>,
    /// Start of the picture's clock.
    start: Instant,
}

/// Number of the current scene's picture; the pins' numbers are greater.
const CURRENT: u64 = 0;

/// The meshes of a picture, one for each material: the torso, or all others.
fn meshes_of(picture: &Picture) -> [Arc<Mesh>; 5] {
    let [tissue, cap, implant, wall] = picture.meshes.clone();
    match &picture.torso {
        Some(torso) => {
            let none = || Arc::default();
            [none(), none(), none(), none(), Arc::clone(torso)]
        }
        None => [tissue, cap, implant, wall, Arc::default()],
    }
}

/// What is drawn in an area.
#[derive(Clone)]
struct Drawn<'a> {
    /// The number of the picture, and the numbers of all pictures in use.
    number: u64,
    numbers: Arc<[u64]>,
    meshes: [Arc<Mesh>; 5],
    nodes_per_side: usize,
    table: &'a Arc<Vec<Rgb>>,
    range: [f32; 2],
    problem: &'a Problem,
    section: Section,
    /// The springs?
    net: bool,
    areola: Areola,
    /// The line of the pocket's edge?
    pocket_line: bool,
    /// The plane at which the torso ends behind.
    end: Option<(Vec3, f32)>,
}

impl<'a> Drawn<'a> {
    /// A picture of a problem, in a table of colours with the field values at its ends.
    fn of(
        number: u64,
        numbers: Arc<[u64]>,
        picture: &Picture,
        (table, range): (&'a Arc<Vec<Rgb>>, [f32; 2]),
        problem: &'a Problem,
        options: &Options,
    ) -> Self {
        Self {
            number,
            numbers,
            meshes: meshes_of(picture),
            nodes_per_side: picture.body.nodes_per_side,
            table,
            range,
            problem,
            section: section_of(options, problem),
            net: options.net,
            areola: options.areola(),
            pocket_line: options.has_pocket_line(),
            end: picture.end(),
        }
    }
}

/// Field values at both ends of a scale.
fn range_of(scale: Option<&Scale>) -> [f32; 2] {
    scale.map_or([0.0, 1.0], |scale| [scale.low, scale.high])
}

impl Viewport {
    /// Creates a view for a graphics context; without one it shows the reason.
    #[must_use]
    pub(crate) fn new(gl: Option<&Arc<glow::Context>>) -> Self {
        let mut viewport = Self {
            gl: None,
            renderer: None,
            error: None,
            camera: Camera::new(90.0, 1.4),
            fitted: None,
            stood: None,
            is_placed: false,
            aspect: 1.4,
            id: None,
            area: None,
            handles: None,
            marks: Marks::default(),
            picture: Picture::default(),
            built_in: torso::BuiltIn::default(),
            bodies: Vec::new(),
            scan: None,
            scanned: None,
            wipe: 0.5,
            panes: Vec::new(),
            common_table: Arc::default(),
            start: Instant::now(),
        };
        viewport.move_to(gl);
        viewport
    }

    /// Moves the view to another graphics context; the resources of the previous one are lost.
    pub(crate) fn move_to(&mut self, gl: Option<&Arc<glow::Context>>) {
        self.gl = gl.cloned();
        (self.renderer, self.error) = match gl.map(|gl| Renderer::new(gl)) {
            Some(Ok(renderer)) => (Some(Arc::new(Mutex::new(renderer))), None),
            Some(Err(error)) => (None, Some(error)),
            None => (None, Some("OpenGL or WebGL 2 is missing".to_owned())),
        };
    }

    /// The graphics context.
    ///
    /// # Errors
    /// Returns why the view is empty.
    pub(crate) fn graphics(&self) -> Result<Arc<glow::Context>, String> {
        match &self.error {
            Some(error) => Err(error.clone()),
            None => self.gl.clone().ok_or_else(|| "graphics are missing".to_owned()),
        }
    }

    /// Shows the view elsewhere, with its camera. The view in the window stays as it is.
    pub(crate) fn aside<R>(&mut self, show: impl FnOnce(&mut Self) -> R) -> R {
        let place = (self.camera, self.fitted, self.stood, self.is_placed, self.aspect, self.id);
        let (area, marks) = (self.area, std::mem::take(&mut self.marks));
        let shown = show(self);
        (self.camera, self.fitted, self.stood, self.is_placed, self.aspect, self.id) = place;
        (self.area, self.marks) = (area, marks);
        shown
    }

    /// Id of the picture's widget after its first frame.
    pub(crate) fn id(&self) -> Option<egui::Id> {
        self.id
    }

    /// The tissue as the picture of the current scene shows it.
    pub(crate) fn body(&self) -> &Body {
        &self.picture.body
    }

    /// Draws handles over the picture, under its marks.
    pub(crate) fn paint_handles(&mut self, ui: &Ui, shapes: Vec<egui::Shape>) {
        if let Some((place, area)) = self.handles.take().zip(self.area) {
            ui.painter_at(area).set(place, egui::Shape::Vec(shapes));
        }
    }

    /// Where the current scene's picture was drawn last.
    pub(crate) fn area(&self) -> Option<Rect> {
        self.area
    }

    /// Moves the camera smoothly to a standard view of the tissue of the patch.
    fn fit(&mut self, session: &Session, view: View) {
        let ball = self.ball_to_fit(session);
        self.camera.fit(ball, self.aspect, view);
        self.fitted = Some((ball, view));
    }

    /// Frees the resources on the graphics card.
    pub(crate) fn destroy(&mut self, gl: Option<&glow::Context>) {
        if let Some(gl) = gl
            && let Some(renderer) = self.renderer.take()
            && let Ok(renderer) = renderer.lock()
        {
            renderer.destroy(gl);
        }
    }

    /// Shows the session in the remaining space; for a scene without an answer, the last answer under a veil.
    pub(crate) fn show(&mut self, ui: &mut Ui, shown: Shown<'_>) {
        match LastAnswer::of(shown.session) {
            Some(answer) => {
                let area = ui.available_rect_before_wrap();
                self.show_subject(ui, &answer, Shown { envelope: &[], outlines: &[], ..shown });
                veil(ui, area);
            }
            None => self.show_subject(ui, shown.session, shown),
        }
    }

    /// Shows a shape of the session's plan between two insertions in the remaining space.
    pub(crate) fn show_between(&mut self, ui: &mut Ui, between: &Between<'_>, shown: Shown<'_>) {
        self.show_subject(ui, between, Shown { envelope: &[], outlines: &[], ..shown });
    }

    fn show_subject(&mut self, ui: &mut Ui, session: &impl Subject, shown: Shown<'_>) {
        let Shown { options, practices, envelope, outlines, bar, .. } = shown;
        self.panes.clear();
        self.leave_scan();
        let (_, whole) = ui.allocate_space(ui.available_size().max(egui::Vec2::splat(1.0)));
        let [whole, strip] = shown.parted(whole);
        let torso = self.torso(options, session.scene());
        // Lines of pins have no place on a body: its skin is another one.
        let outlines = if torso.is_some() { &[][..] } else { outlines };
        let way = if torso.is_some() { options.before } else { Before::Off };
        let [before, area] = match way {
            Before::Beside => before::halves(whole),
            Before::Off | Before::Wipe => [whole; 2],
        };
        let beside = (way == Before::Beside).then(|| self.interact_before(ui, before));
        let response = self.interact(ui, area);
        let ball = wall::ball(session.problem());
        self.place_camera(ball, area.width() / area.height(), torso.as_deref(), shown.standing);
        self.camera.mirror(session.scene().is_right());
        let section = section_of(options, session.problem());
        let start = self.start;
        let clock = || start.elapsed().as_secs_f64();
        let colouring = colouring(session, options.quantity, practices);
        let up_to_date = self.picture.update(session, colouring, section, &clock);
        self.picture.update_torso(session, torso.as_ref());
        let moved = self.move_camera(ui, &response, area);
        let moved_beside = beside.is_some_and(|response| self.move_camera(ui, &response, before));
        if moved || moved_beside || self.camera.is_easing() || !up_to_date {
            ui.ctx().request_repaint();
        }
        if !ui.is_rect_visible(area) {
            return;
        }
        let painter = ui.painter_at(area);
        overlay::background(ui, &painter, area);
        let scale = self.picture.scale.as_ref();
        let (numbers, colours) = (before::numbers(way), (&self.picture.table, range_of(scale)));
        let drawn = Drawn::of(CURRENT, numbers, &self.picture, colours, session.problem(), options);
        let mesh_before = self.picture.before().cloned().filter(|_| way != Before::Off);
        let (words, wipe) = match mesh_before {
            Some(mesh) => {
                self.draw(ui, &painter, area, drawn.clone());
                let way = (way, whole.top() + bar);
                self.draw_before(ui, (&mesh, drawn), [before, area], way, session.scene())
            }
            None => {
                self.draw(ui, &painter, area, drawn);
                (before::time(ui, area, whole.top() + bar, session.scene()), self.wipe)
            }
        };
        self.draw_envelope(ui, &painter, area, (session.scene(), section), envelope);
        for outline in outlines {
            for line in outline.lines(section, self.camera.pose().azimuth) {
                let points = line.iter().filter_map(|point| self.point(*point, area)).collect();
                overlay::outline(ui, &painter, points, outline);
            }
        }
        let free = area.with_min_y(area.top() + bar);
        let scale = scale.filter(|_| !self.picture.body.is_empty());
        let bar = self.show_scale(ui, area, strip);
        let show_legend = |scale| {
            let scale = of_legend(scale, session.scene(), practices);
            legend::legend(ui, &painter, free, bar, &scale)
        };
        let mut taken = vec![scale.map_or(Rect::NOTHING, show_legend), bar];
        taken.extend(words);
        let (right, up) = self.camera.right_and_up();
        let words = match shown.standing {
            // The pose has a name, and the body is upright.
            Some(_) => Vec::new(),
            None => directions::words(right, up, self.picture.torso.is_some()),
        };
        let taken = overlay::directions(ui, &painter, free, &words, &taken);
        self.handles = Some(painter.add(egui::Shape::Noop));
        let marked = Marked { picture: &self.picture, subject: session, section, taken: &taken };
        let click = self.show_marks(ui, &response, &marked);
        self.wipe = wipe;
        self.click(click);
    }

    /// The widget of the current scene's picture.
    fn interact(&mut self, ui: &Ui, area: Rect) -> Response {
        // An id of its own: the focus stays while the progress of a solve is shown above the picture.
        let id = ui.scope_id().with("3-D view");
        let response = ui.interact(area, id, Sense::click_and_drag() | Sense::FOCUSABLE);
        keep_press(&response);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Canvas, true, tr("3-D view")));
        (self.id, self.area) = (Some(response.id), Some(area));
        response
    }

    fn draw(&self, ui: &Ui, painter: &egui::Painter, area: Rect, drawn: Drawn<'_>) {
        let Drawn { number, numbers, meshes, nodes_per_side, table, range, problem, .. } = drawn;
        let Drawn { section, net, areola, pocket_line, end, .. } = drawn;
        let Some(renderer) = &self.renderer else {
            let why = self.error.as_deref().unwrap_or("graphics are missing");
            let text = tr!(
                "The 3-D view is not available: {why}.\nControls and results work.",
                why = tr(why)
            );
            let font = TextStyle::Body.resolve(ui.style());
            let color = ui.visuals().weak_text_color();
            painter.text(area.center(), Align2::CENTER_CENTER, text, font, color);
            return;
        };
        let (right, up) = self.camera.light();
        // A sheet ends at the pocket's edge.
        let edge = problem.patch.pocket();
        let pocket = match problem.tissue {
            Tissue::Layered if pocket_line => edge.radius_mm / problem.sheet().spacing_mm(),
            Tissue::Layered | Tissue::Sheet => 0.0,
        };
        let frame = Frame {
            picture: number,
            pictures: numbers,
            meshes,
            table: Arc::clone(table),
            range,
            clip_from_world: self.camera.clip_from_world(self.aspect),
            eye: self.camera.eye(),
            right,
            up,
            planes: section.planes(),
            axis: section.axis,
            net,
            areola,
            cell_mm: problem.sheet().spacing_mm() as f32,
            grid_centre: 0.5 * nodes_per_side.saturating_sub(1) as f32,
            foot: problem.obstacle.dome.wall_axes().as_vec2().to_array(),
            pocket: [pocket, edge.radius_mm / edge.reach_mm()].map(|of| of as f32),
            // A whole body is everywhere in front of its end.
            end: end.map_or(Vec4::W * f32::MAX, |(front, height)| front.extend(height)),
            behind: overlay::behind(ui),
        };
        let renderer = Arc::clone(renderer);
        let paint = egui_glow::CallbackFn::new(move |info, painter| {
            let window = info.viewport_in_pixels();
            let window = [window.from_bottom_px, window.height_px].map(|px| px as f32);
            if let Ok(mut renderer) = renderer.lock() {
                renderer.paint(painter.gl(), &frame, window);
            }
        });
        painter.add(egui::PaintCallback { rect: area, callback: Arc::new(paint) });
    }

    /// Draws the scale of a picture on its strip, without one on the picture. Returns its place.
    fn show_scale(&self, ui: &Ui, area: Rect, strip: Rect) -> Rect {
        let points_per_mm = self.points_per_mm(area);
        match strip.is_positive() {
            true => overlay::scale_below(ui, strip, points_per_mm),
            false => scale_bar(ui, &ui.painter_at(area), area, points_per_mm),
        }
    }

    fn points_per_mm(&self, area: Rect) -> f32 {
        let target = self.camera.pose().target;
        let (right, _) = self.camera.right_and_up();
        let project = |p| self.camera.project(p, self.aspect).unwrap_or_default();
        0.5 * area.width() * (project(target + right) - project(target)).length()
    }

    /// The place of a point \[mm\] in the area; `None` behind the eye.
    pub(crate) fn point(&self, point: Vec3, area: Rect) -> Option<Pos2> {
        let at = self.camera.project(point, self.aspect)?;
        Some(area.lerp_inside(egui::vec2(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y)))
    }

    /// Draws the envelopes of the skin of sampled patients over the session's picture.
    fn draw_envelope(
        &self,
        ui: &Ui,
        painter: &egui::Painter,
        area: Rect,
        (scene, section): (&Scene, Section),
        band: &[SectionBand],
    ) {
        let azimuth = self.camera.pose().azimuth;
        for line in envelope::lines(band, scene.is_round(), section, azimuth) {
            let points = line.points.iter().filter_map(|point| self.point(*point, area)).collect();
            overlay::envelope(ui, painter, points, line.is_outer);
        }
    }
}

/// The cut of the options through the axis of an implant.
fn section_of(options: &Options, problem: &Problem) -> Section {
    Section {
        opening: match (options.section, options.half) {
            (false, _) => Opening::Closed,
            (true, false) => Opening::Wedge,
            (true, true) => Opening::Half,
        },
        angle: options.section_azimuth_deg.to_radians(),
        axis: problem.obstacle.dome.center.as_vec2(),
    }
}

/// Draws the veil over the last answer of a scene without one.
pub(crate) fn veil(ui: &Ui, area: Rect) {
    let veil = ui.visuals().panel_fill.gamma_multiply(VEIL);
    ui.painter_at(area).rect_filled(area, 0.0, veil);
}
