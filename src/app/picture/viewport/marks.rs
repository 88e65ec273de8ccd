//! Marks on the picture: values at the pointer and of a kept point, and the ruler. Marks move with the tissue.

use super::moves::viewport_point;
use super::overlay::pointer_box;
use super::{Viewport, readout};
use crate::app::frame::research;
use crate::app::plan::device::Device;
use crate::app::texts::{fixed, tr};
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme;
use crate::measure::Fields;
use crate::scene::Scene;
use crate::view::body::Body;
use crate::view::pick::{self, Hit};
use crate::view::picture::Picture;
use crate::view::place::{Place, SkinLine, along_skin};
use crate::view::section::Section;
use crate::view::subject::Subject;
use eframe::egui::{
    self, Color32, Painter, Pos2, Rect, Response, Role, Sense, Shape, Stroke, Ui, Vec2, vec2,
};
use glam::{DVec3, Vec3};

/// Maximum nodes per side for which a running solve still shows values at the pointer.
const PICK_WHILE_SOLVING: usize = 257;
/// Distance within which a click is on a kept point \[points\].
const SAME: f32 = 24.0;

/// Where the ruler has no end.
const ON_SKIN: &str = "Ruler: only on the computed skin, which Stretch colours";

/// Radius of a marked point with its edge \[points\].
const DOT: f32 = 6.0;

/// What is marked on the tissue.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Marks {
    /// The point whose values stay visible.
    kept: Option<Place>,
    /// The ruler's ends, up to two; `None` without a ruler.
    ruler: Option<Vec<Place>>,
    /// Was the last click of the ruler on no computed skin?
    is_missed: bool,
}

/// A click on the tissue.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Click {
    /// On the point whose values are kept.
    Kept,
    /// On a point of the tissue; `is_skin`: of the skin.
    At { place: Place, is_skin: bool },
    /// On tissue that is not computed.
    Outside,
}

impl Marks {
    fn click(&mut self, click: Click) {
        self.is_missed = false;
        match (&mut self.ruler, click) {
            (Some(ends), Click::At { place, is_skin: true }) => {
                // A third click starts again.
                if ends.len() > 1 {
                    ends.clear();
                }
                ends.push(place);
            }
            (Some(ends), _) => self.is_missed = ends.len() < 2,
            (None, Click::Outside) => {}
            (None, Click::Kept) => self.kept = None,
            (None, Click::At { place, .. }) => self.kept = Some(place),
        }
    }

    /// Removes the ruler, otherwise the kept point. Returns whether there was one.
    fn remove(&mut self) -> bool {
        self.is_missed = false;
        self.ruler.take().is_some() || self.kept.take().is_some()
    }
}

/// A picture with its subject, for marks.
pub(super) struct Marked<'a, S: Subject> {
    pub(super) picture: &'a Picture,
    pub(super) subject: &'a S,
    pub(super) section: Section,
    /// What no box covers.
    pub(super) taken: &'a [Rect],
}

impl Viewport {
    /// Is the ruler on?
    pub(crate) fn has_ruler(&self) -> bool {
        self.marks.ruler.is_some()
    }

    /// Has the ruler an end to place?
    fn is_measuring(&self) -> bool {
        self.marks.ruler.as_ref().is_some_and(|ends| ends.len() < 2)
    }

    /// Switches the ruler on, without points, or off.
    pub(crate) fn toggle_ruler(&mut self) {
        self.marks.ruler = if self.has_ruler() { None } else { Some(Vec::new()) };
        self.marks.is_missed = false;
    }

    /// Removes the ruler, otherwise the point whose values are kept. Returns whether there was one.
    pub(crate) fn remove_mark(&mut self) -> bool {
        self.marks.remove()
    }

    /// Takes a click on the tissue.
    pub(super) fn click(&mut self, click: Option<Click>) {
        if let Some(click) = click {
            self.marks.click(click);
        }
    }

    /// Is a solve running that leaves no time for values?
    fn is_busy(marked: &Marked<'_, impl Subject>) -> bool {
        marked.subject.is_working() && marked.picture.body.nodes_per_side > PICK_WHILE_SOLVING
    }

    /// Shows the marks of a picture, and the values at the pointer. Returns a click on the tissue.
    pub(super) fn show_marks(
        &self,
        ui: &Ui,
        response: &Response,
        marked: &Marked<'_, impl Subject>,
    ) -> Option<Click> {
        let area = response.rect;
        let painter = ui.painter_at(area);
        let (kept, kept_box) = self.show_kept(ui, &painter, area, marked).unzip();
        let taken: Vec<Rect> = marked.taken.iter().copied().chain(kept_box).collect();
        let pointer =
            if response.clicked() { response.interact_pointer_pos() } else { response.hover_pos() };
        let pointer = pointer.filter(|_| !response.dragged() && !Self::is_busy(marked));
        let hit = pointer.and_then(|at| {
            let ray = self.camera.ray(viewport_point(area, at), self.aspect);
            let (picture, obstacle) = (marked.picture, &marked.subject.problem().obstacle);
            pick::pick(&ray, &picture.body, &marked.section, &picture.caps, obstacle)
        });
        let place = hit.and_then(|hit| place_of(&hit, marked.picture));
        let is_skin = place.is_some_and(|place| place.depth <= 0.0);
        self.show_ruler(ui, (&painter, area, &taken), marked, place.filter(|_| is_skin));
        let (pointer, hit) = pointer.zip(hit)?;
        let is_kept = kept.is_some_and(|kept| kept.distance(pointer) < SAME) && !self.has_ruler();
        if !is_kept && !self.has_ruler() {
            let (picture, scene) = (marked.picture, marked.subject.scene());
            show_values(ui, (&painter, area, &taken), pointer, &hit, picture, scene);
        }
        if self.is_measuring() && !is_skin {
            let (fields, scene) = (marked.picture.fields.as_deref(), marked.subject.scene());
            let device = Device::of(ui.ctx());
            let words = fields.and_then(|fields| readout::heading(&hit, fields, scene, device));
            let lines: Vec<String> = words.into_iter().collect();
            labelled_box(ui, (&painter, area, &taken), (pointer, tr("Ruler")), &lines);
        }
        match (response.clicked(), is_kept) {
            (false, _) => None,
            (true, true) => Some(Click::Kept),
            (true, false) => {
                Some(place.map_or(Click::Outside, |place| Click::At { place, is_skin }))
            }
        }
    }

    /// Shows the values at a hit of the current scene's picture beside a position elsewhere, as over the cross-section, beside what is `taken`.
    /// Returns the point of the tissue.
    pub(crate) fn show_values(
        &self,
        ui: &Ui,
        (area, taken): (Rect, &[Rect]),
        pointer: Pos2,
        hit: &Hit,
        scene: &Scene,
    ) -> Option<Place> {
        show_values(ui, (&ui.painter_at(area), area, taken), pointer, hit, &self.picture, scene);
        place_of(hit, &self.picture)
    }

    /// Keeps the values of a point visible.
    pub(crate) fn keep_values(&mut self, place: Place) {
        self.marks.kept = Some(place);
    }

    /// Shows the values of the kept point. Returns the places of the point and of its box.
    fn show_kept(
        &self,
        ui: &Ui,
        painter: &Painter,
        area: Rect,
        marked: &Marked<'_, impl Subject>,
    ) -> Option<(Pos2, Rect)> {
        let place = self.marks.kept?;
        let sheet = &marked.picture.fields.as_ref()?.solution().problem().sheet();
        let at = self.point(place.position(sheet, &marked.picture.body)?, area)?;
        if !area.contains(at) {
            return None;
        }
        dot(ui, painter, at);
        let lines = lines(ui, None, Some(place), marked.picture, marked.subject.scene());
        let canvas = (painter, area, marked.taken);
        Some((at, labelled_box(ui, canvas, (at, tr("Kept values")), &lines)))
    }

    /// Shows the ruler; `next`: the point of the skin at the pointer.
    fn show_ruler(
        &self,
        ui: &Ui,
        (painter, area, taken): Canvas<'_>,
        marked: &Marked<'_, impl Subject>,
        next: Option<Place>,
    ) {
        let Some(ends) = &self.marks.ruler else { return };
        let Some(fields) = marked.picture.fields.as_deref() else { return };
        let body = &marked.picture.body;
        if ends.len() < 2 {
            let words =
                [tr("Ruler: click a point of the skin"), tr("Ruler: click the second point")];
            // A finger has no pointer beside which the words stand.
            let words = if self.marks.is_missed { tr(ON_SKIN) } else { words[ends.len()] };
            hint(ui, painter, area, words);
        }
        let mut ends = ends.clone();
        ends.extend(next.filter(|_| ends.len() < 2));
        let sheet = fields.solution().problem().sheet();
        let at = |place: &Place| place.position(sheet, body);
        for end in ends.iter().filter_map(at).filter_map(|end| self.point(end, area)) {
            dot(ui, painter, end);
        }
        let [a, b] = ends[..] else { return };
        let Some(measured) = Measured::new([a, b], fields, body) else { return };
        let on_screen = |part: [Vec3; 2]| Some(part.map(|p| self.point(p, area)));
        let ground = Stroke::new(5.0, ui.visuals().panel_fill.gamma_multiply(0.7));
        let line = Stroke::new(2.0, theme::palette(ui.visuals()).accent);
        let parts = measured.line.parts.iter().copied().filter_map(on_screen);
        let parts: Vec<[Pos2; 2]> = parts.filter_map(|[p, q]| Some([p?, q?])).collect();
        for stroke in [ground, line] {
            painter.extend(parts.iter().map(|part| Shape::line_segment(*part, stroke)));
        }
        let [Some(p), Some(q)] = measured.ends.map(|end| self.point(end, area)) else { return };
        painter.extend(Shape::dashed_line(&[p, q], Stroke::new(1.5, line.color), 5.0, 4.0));
        // The box covers no end.
        let dots = [p, q].map(|end| Rect::from_center_size(end, Vec2::splat(2.0 * DOT)));
        let taken = [taken, &dots].concat();
        let canvas = (painter, area, &*taken);
        labelled_box(ui, canvas, (p.lerp(q, 0.5), tr("Ruler")), &measured.words());
    }
}

/// Two points of the skin with their distances.
struct Measured {
    ends: [Vec3; 2],
    line: SkinLine,
    rest_mm: f32,
}

impl Measured {
    fn new(places: [Place; 2], fields: &Fields, body: &Body) -> Option<Self> {
        let rest = &fields.solution().problem().rest;
        let sheet = rest.sheet();
        let [a, b] = places.map(|place| place.position(sheet, body));
        let ends = [a?, b?];
        let line = along_skin(body.levels.first()?, &body.triangles, ends);
        if rest.is_even() {
            let rest_mm = places[0].rest.distance(places[1].rest);
            return Some(Self { ends, line, rest_mm });
        }
        // The skin at rest, without the ring.
        let skin: Vec<Vec3> = rest.nodes(rest.layers() - 1).map(DVec3::as_vec3).collect();
        let is_on_sheet = |t: &&[u32; 3]| t.iter().all(|&k| (k as usize) < skin.len());
        let triangles: Vec<[u32; 3]> = body.triangles.iter().filter(is_on_sheet).copied().collect();
        let at_rest = places.map(|place| {
            let nodes = place.nodes(sheet)?;
            Some(nodes.into_iter().map(|(k, weight)| skin[k] * weight).sum())
        });
        let [a, b] = at_rest;
        let rest_mm = along_skin(&skin, &triangles, [a?, b?]).length_mm;
        Some(Self { ends, line, rest_mm })
    }

    fn words(&self) -> Vec<String> {
        let cm = |mm: f32| format!("{} cm", fixed(0.1 * f64::from(mm), 1));
        // Of the lengths as they are shown.
        let gain = self.line.length_mm.round() - self.rest_mm.round();
        vec![
            tr!("Straight {length}", length = cm(self.ends[0].distance(self.ends[1]))),
            tr!("Along the skin {length}", length = cm(self.line.length_mm)),
            tr!("At rest {length} ({gain:+.1} cm)", length = cm(self.rest_mm), gain = 0.1 * gain),
        ]
    }
}

/// The point of the tissue of a picture at a hit.
fn place_of(hit: &Hit, picture: &Picture) -> Option<Place> {
    readout::place_of(hit, &picture.body, picture.fields.as_deref()?)
}

/// Shows the values at a hit beside the pointer.
fn show_values(
    ui: &Ui,
    canvas: Canvas<'_>,
    pointer: Pos2,
    hit: &Hit,
    picture: &Picture,
    scene: &Scene,
) {
    ring(ui, canvas.0, pointer);
    let fields = picture.fields.as_deref();
    let device = Device::of(ui.ctx());
    let heading = fields.and_then(|fields| readout::heading(hit, fields, scene, device));
    let lines = lines(ui, heading, place_of(hit, picture), picture, scene);
    labelled_box(ui, canvas, (pointer, tr("Values at the pointer")), &lines);
}

/// The lines of a box: what is there, and the values.
fn lines(
    ui: &Ui,
    heading: Option<String>,
    place: Option<Place>,
    picture: &Picture,
    scene: &Scene,
) -> Vec<String> {
    let values = picture.fields.as_ref().zip(place).and_then(|(fields, place)| {
        let nodes = place.nodes(fields.solution().problem().sheet())?;
        Some(readout::values(&nodes, fields, scene, research::is_on(ui.ctx())))
    });
    heading.into_iter().chain(values.into_iter().flatten()).collect()
}

/// Where boxes are drawn: painter, area, and what no box covers.
type Canvas<'a> = (&'a Painter, Rect, &'a [Rect]);

/// Shows a box beside a point, with its content as an accessible name. Returns its place.
pub(crate) fn labelled_box(
    ui: &Ui,
    (painter, area, taken): Canvas<'_>,
    (at, name): (Pos2, &str),
    lines: &[String],
) -> Rect {
    if lines.is_empty() {
        return Rect::NOTHING;
    }
    let rect = pointer_box(ui, painter, area, at, lines, taken);
    let response = ui.interact(rect, ui.scope_id().with((area.min.x as i32, name)), Sense::hover());
    set_accessible_name(&response, Role::Label, &format!("{name}: {}", lines.join("; ")));
    rect
}

/// A line of text over the lower edge of the picture.
fn hint(ui: &Ui, painter: &Painter, area: Rect, words: &str) {
    let at = area.center_bottom() - vec2(0.0, 3.0 * theme::SPACE);
    let font = egui::TextStyle::Body.resolve(ui.style());
    let galley = painter.layout_no_wrap(words.to_owned(), font, ui.visuals().strong_text_color());
    let rect = egui::Align2::CENTER_BOTTOM.anchor_size(at, galley.size());
    painter.rect_filled(rect.expand(6.0), 4.0, ui.visuals().window_fill);
    painter.galley(rect.min, galley, ui.visuals().strong_text_color());
    let response = ui.interact(rect, ui.scope_id().with("ruler hint"), Sense::hover());
    set_accessible_name(&response, Role::Label, words);
}

/// A ring around the pointer.
fn ring(ui: &Ui, painter: &Painter, at: Pos2) {
    let line = Stroke::new(1.5, ui.visuals().strong_text_color());
    painter.circle(at, 3.0, Color32::TRANSPARENT, line);
}

/// A marked point.
fn dot(ui: &Ui, painter: &Painter, at: Pos2) {
    let palette = theme::palette(ui.visuals());
    painter.circle(at, DOT - 1.0, palette.accent, Stroke::new(2.0, ui.visuals().panel_fill));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(x: f32) -> Click {
        Click::At { place: Place { rest: glam::vec2(x, 0.0), depth: 0.0 }, is_skin: true }
    }

    fn ends(marks: &Marks) -> usize {
        marks.ruler.as_ref().map_or(0, Vec::len)
    }

    #[test]
    fn a_second_click_on_a_kept_point_removes_the_point_and_one_elsewhere_moves_it() {
        let mut marks = Marks::default();
        marks.click(at(1.0));
        marks.click(at(2.0));
        assert_eq!(marks.kept.map(|place| place.rest.x), Some(2.0));
        marks.click(Click::Kept);
        assert_eq!(marks, Marks::default());
        assert!(!marks.remove());
    }

    #[test]
    fn the_ruler_has_two_ends_on_the_skin_and_escape_leaves_the_kept_point() {
        let mut marks = Marks::default();
        marks.click(at(9.0));
        marks.ruler = Some(Vec::new());
        marks.click(at(1.0));
        marks.click(Click::At {
            place: Place { rest: glam::Vec2::ZERO, depth: 0.5 },
            is_skin: false,
        });
        assert_eq!(ends(&marks), 1, "a point under the skin is no end");
        assert!(marks.is_missed);
        marks.click(at(2.0));
        assert_eq!((ends(&marks), marks.is_missed), (2, false));
        // A measured line has no word about the skin beside it.
        marks.click(Click::Outside);
        assert_eq!((ends(&marks), marks.is_missed), (2, false));
        marks.click(at(3.0));
        assert_eq!(ends(&marks), 1, "a third click starts again");
        assert!(marks.remove() && marks.kept.is_some() && marks.remove() && !marks.remove());
    }
}
