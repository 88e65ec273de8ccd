//! The cross-section under the picture: skin, fat, implant and pocket at one scale across and up, with the skin of the pins.
//!
//! Uses `compare`, `plots`, `shared`, `theme`, `viewport`. Used by `ui`.

use super::viewport::{scale_bar, veil};
use crate::app::answer::compare::{self, Silhouette};
use crate::app::answer::plots;
use crate::app::answer::uncertainty::Findings;
use crate::app::frame::shared::Shared;
use crate::app::plan::volumes::highest_sold_mm;
use crate::app::texts::{self, tr};
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme;
use crate::solve::Problem;
use crate::study::SectionBand;
use crate::view::body::Body;
use crate::view::color;
use crate::view::cross_section::{CrossSection, SectionPlane};
use crate::view::pick::{Hit, Target};
use crate::view::place as tissue;
use crate::view::subject::{Between, LastAnswer, Subject};
use eframe::egui::{
    self, Align2, Color32, Mesh, Painter, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Ui, pos2,
    vec2,
};
use glam::{Vec2, Vec3};

/// Name of the strip, and of its switch.
pub(crate) const CROSS_SECTION: &str = "Cross-section";
/// Height of the strip \[points\].
const HEIGHT: f32 = 160.0;
/// Least height of the window with a strip \[points\].
const LEAST_WINDOW: f32 = 760.0;
/// Width of legend and scale bar at the left \[points\].
const LEGEND: f32 = 96.0;
/// Least distance of two points of an outline, whose direction is then more than rounding \[points\].
const LEAST_STEP: f32 = 0.1;

/// Is there room for the strip? `is_wide`: not on a phone.
pub(crate) fn has_room(ctx: &egui::Context, is_wide: bool) -> bool {
    is_wide && ctx.content_rect().height() >= LEAST_WINDOW
}

/// The strip's area at the bottom of the picture's.
pub(crate) fn area(picture: Rect) -> Rect {
    picture.with_min_y(picture.bottom() - HEIGHT)
}

/// What the user does with the strip.
#[derive(Default)]
pub(crate) struct Done {
    /// A clicked point of the tissue, whose values stay.
    pub(crate) kept: Option<tissue::Place>,
    /// Another plane.
    pub(crate) plane: Option<SectionPlane>,
}

/// Shows the strip with the switch of its plane, after its picture.
pub(crate) fn show(ui: &mut Ui, area: Rect, shared: &Shared, between: Option<Between<'_>>) -> Done {
    let kept = content(ui, area, shared, between);
    let room = area.shrink2(vec2(theme::SPACE, 3.0));
    let layout = egui::Layout::right_to_left(egui::Align::Min);
    let builder = egui::UiBuilder::new().id_salt("plane").max_rect(room).layout(layout);
    let (plane, scene) = (shared.section_plane(), shared.session.scene());
    let mut switch = ui.new_child(builder);
    let plane = plots::choose_plane(&mut switch, plane, scene);
    let (id, place) = (switch_id(ui), switch.min_rect());
    ui.data_mut(|data| data.insert_temp(id, place));
    Done { kept, plane }
}

/// Where the place of the switch is kept for the next frame: no box of values lies under it.
fn switch_id(ui: &Ui) -> egui::Id {
    ui.scope_id().with("switch of the plane")
}

fn content(
    ui: &Ui,
    area: Rect,
    shared: &Shared,
    between: Option<Between<'_>>,
) -> Option<tissue::Place> {
    if let Some(between) = between {
        return strip_of(ui, area, shared, &between);
    }
    let last = LastAnswer::of(&shared.session);
    let kept = match &last {
        Some(answer) => strip_of(ui, area, shared, answer),
        None => strip_of(ui, area, shared, &shared.session),
    };
    if last.is_some() || shared.is_provisional() {
        veil(ui, area);
    }
    kept
}

/// Draws the strip; returns a clicked point of the tissue.
fn strip_of(ui: &Ui, area: Rect, shared: &Shared, subject: &impl Subject) -> Option<tissue::Place> {
    // Without focus: the keys act on the picture.
    let response = ui.interact(area, ui.scope_id().with("strip"), Sense::CLICK);
    set_accessible_name(&response, egui::Role::Canvas, tr(CROSS_SECTION));
    let (problem, plane) = (subject.problem(), shared.section_plane());
    let section = CrossSection::new(shared.viewport.body(), problem.sheet(), plane);
    let palette = theme::palette(ui.visuals());
    let pins = plots::drawn_silhouettes(&shared.session, &shared.compare, palette, plane);
    let pins = first_and_last(pins);
    let place = Place::new(area, (subject, plane), &pins);
    let painter = ui.painter_at(area);
    paint_ground(ui, &painter, area);
    paint_wall(ui, &painter, &place, subject);
    if !section.skin().is_empty() {
        let tissue = |layer: usize| {
            let name = subject.scene().layers.get(layer).map_or("", |l| l.tissue.as_str());
            (texts::tissue(name).to_owned(), theme::color32(color::tissue(name, layer)))
        };
        paint_implant(ui, &painter, &place, subject);
        paint_tissue(ui, &painter, &place, &section, &|layer| tissue(layer).1);
        let band = shared.uncertainty.findings().map_or(&[][..], Findings::section);
        let band = plots::sampled_skin(&shared.session, band, plane);
        paint_band(ui, &painter, &place, &band);
        let layers = (0..subject.scene().layers.len()).map(tissue);
        let accent = theme::palette(ui.visuals()).accent;
        let implant = (shared.choices.device.words(tr("implant")), accent.gamma_multiply(0.22));
        let sampled = (tr("skin of 8 in 10 sampled patients").to_owned(), band_color(ui));
        let sampled = (!band.is_empty()).then_some(sampled);
        legend(ui, &painter, area, layers.chain([implant]).chain(sampled));
    }
    for pin in &pins {
        paint_pin(ui, &painter, &place, pin);
    }
    scale_bar(ui, &painter, area, place.points_per_mm);
    let is_clicked = response.clicked();
    let pointer = if is_clicked { response.interact_pointer_pos() } else { response.hover_pos() };
    let pointer = pointer.filter(|_| !shared.viewport.has_ruler())?;
    let hit = hit(place.point(pointer), (&section, plane), shared.viewport.body(), problem)?;
    let id = switch_id(ui);
    let taken: Option<Rect> = ui.data(|data| data.get_temp(id));
    let canvas = (area, taken.as_slice());
    let kept = shared.viewport.show_values(ui, canvas, pointer, &hit, subject.scene());
    kept.filter(|_| is_clicked)
}

/// Pin A and the pin that was added last.
fn first_and_last(mut pins: Vec<Silhouette>) -> Vec<Silhouette> {
    if pins.len() > 2 {
        pins.drain(1..pins.len() - 1);
    }
    pins
}

/// Where the plane of the section is drawn.
struct Place {
    /// The pocket's centre on the chest wall.
    origin: Pos2,
    /// Scale across and up.
    points_per_mm: f32,
    /// Half of the drawn width \[mm\].
    reach_mm: f32,
    /// +1: the patient's side or head is at the right; the side of a right breast −1.
    hand: f32,
    plane: SectionPlane,
}

impl Place {
    /// The scale follows from width, tissue and chest, with room for the highest profile sold: another volume or insertion leaves it as it
    /// is, so that two volumes are seen in their sizes.
    fn new(
        area: Rect,
        (subject, plane): (&impl Subject, SectionPlane),
        pins: &[Silhouette],
    ) -> Self {
        let (problem, scene) = (subject.problem(), subject.scene());
        let radius = problem.sheet().radius_mm() as f32;
        let cover = scene.tissue_mm();
        let highest = cover + scene.implant.projection_mm.max(highest_sold_mm(&scene.implant));
        let pins = pins.iter().flat_map(|pin| &pin.points).map(|point| point[1]);
        let highest = pins.fold(highest, f64::max) as f32;
        let wall = plots::wall_line(problem, plane).into_iter().map(|[_, z]| z as f32);
        let lowest = wall.fold(0.0, f32::min);
        let room = area.shrink2(vec2(2.0 * theme::SPACE, theme::SPACE));
        let room = room.with_min_x(room.left() + LEGEND);
        let below = 14.0;
        let points_per_mm =
            ((room.height() - below) / (highest - lowest)).min(0.5 * room.width() / radius);
        Self {
            origin: pos2(room.center().x, room.bottom() - below + lowest * points_per_mm),
            points_per_mm,
            reach_mm: radius,
            hand: plots::hand_in(plane, subject.scene()) as f32,
            plane,
        }
    }

    fn at(&self, point: Vec2) -> Pos2 {
        self.origin + self.points_per_mm * vec2(self.hand * point.x, -point.y)
    }

    /// The point (distance, z) of the plane at a position \[mm\].
    fn point(&self, at: Pos2) -> Vec2 {
        let offset = (at - self.origin) / self.points_per_mm;
        Vec2::new(self.hand * offset.x, -offset.y)
    }

    fn line(&self, points: &[[f64; 2]]) -> Vec<Pos2> {
        points.iter().map(|&[x, z]| self.at(Vec2::new(x as f32, z as f32))).collect()
    }
}

/// What is at a point (distance, z) of the section; `None` outside of tissue and implant.
fn hit(
    point: Vec2,
    (section, plane): (&CrossSection, SectionPlane),
    body: &Body,
    problem: &Problem,
) -> Option<Hit> {
    let dome = &problem.obstacle.dome;
    let target = match section.layer_at(point) {
        Some(layer) => Target::Cut(layer),
        None => {
            let [s, z] = point.to_array().map(f64::from);
            let at = plane.place(s).extend(z);
            let is_inside = problem.obstacle.wall.gap(at) >= 0.0 && dome.contains(at);
            is_inside.then_some(Target::Implant)?
        }
    };
    // The row's nodes leave the plane where the implant is off centre.
    let level = body.levels.first()?;
    let near = |k: &&usize| plane.point(level[**k]).x - point.x;
    let column = section.columns.iter().min_by(|a, b| near(a).abs().total_cmp(&near(b).abs()))?;
    let column = level[*column];
    let point = match plane {
        SectionPlane::Across => Vec3::new(point.x, column.y, point.y),
        SectionPlane::Along => Vec3::new(column.x, point.x, point.y),
    };
    Some(Hit { point, target })
}

fn paint_ground(ui: &Ui, painter: &Painter, area: Rect) {
    painter.rect_filled(area, 0.0, ui.visuals().panel_fill);
    let line = ui.visuals().widgets.noninteractive.bg_stroke;
    painter.hline(area.x_range(), area.top(), line);
}

/// The chest wall with the pocket on it, and the sides of the patient.
fn paint_wall(ui: &Ui, painter: &Painter, place: &Place, subject: &impl Subject) {
    let (problem, ends) = (subject.problem(), plots::ends_of(place.plane, subject.scene()));
    let (visuals, palette) = (ui.visuals(), theme::palette(ui.visuals()));
    let font = TextStyle::Small.resolve(ui.style());
    // At a length along the wall.
    let at = |s: f32| {
        let foot = problem.obstacle.wall.0.foot_and_normal(place.plane.place(f64::from(s))).0;
        place.at(place.plane.point(foot.as_vec3()))
    };
    let wall = Stroke::new(1.0, palette.edge);
    painter.add(Shape::line(place.line(&plots::wall_line(problem, place.plane)), wall));
    let line = Stroke::new(2.0, palette.text);
    for way in [-1.0, 1.0] {
        let unit = place.plane.place(way).to_array();
        let x = (way * problem.patch.pocket().edge(unit)) as f32;
        painter.line_segment([at(x) - vec2(0.0, 5.0), at(x) + vec2(0.0, 3.0)], line);
    }
    let below = |x: f32, align: Align2, words: &str, color: Color32| {
        painter.text(at(x) + vec2(0.0, 2.0), align, words, font.clone(), color);
    };
    let weak = visuals.weak_text_color();
    below(0.0, Align2::CENTER_TOP, tr("pocket"), palette.text);
    let (left, right) = (-place.hand * place.reach_mm, place.hand * place.reach_mm);
    below(left, Align2::LEFT_TOP, ends[0], weak);
    below(right, Align2::RIGHT_TOP, ends[1], weak);
}

fn paint_implant(ui: &Ui, painter: &Painter, place: &Place, subject: &impl Subject) {
    let problem = subject.problem();
    let mut outline = plots::dome_outline(problem, place.plane);
    if let Some((to, part)) = subject.toward() {
        let others = plots::dome_outline(to.solution().problem(), place.plane);
        for (point, other) in outline.iter_mut().zip(others) {
            *point = [0, 1].map(|k| point[k] + f64::from(part) * (other[k] - point[k]));
        }
    }
    let foot =
        |point: &[f64; 2]| [point[0], plots::wall_height(problem, place.plane.place(point[0]))];
    let base: Vec<[f64; 2]> = outline.iter().rev().map(foot).collect();
    let accent = theme::palette(ui.visuals()).accent;
    // A draped implant is not convex: strips from the wall to the surface.
    let (top, low) = (place.line(&outline), place.line(&base));
    let mut mesh = Mesh::default();
    for (high, low) in top.iter().zip(low.iter().rev()) {
        mesh.colored_vertex(*high, accent.gamma_multiply(0.22));
        mesh.colored_vertex(*low, accent.gamma_multiply(0.22));
    }
    for k in (2..mesh.vertices.len() as u32).step_by(2) {
        mesh.add_triangle(k - 2, k - 1, k);
        mesh.add_triangle(k - 1, k, k + 1);
    }
    painter.add(Shape::mesh(mesh));
    // The base ends at the feet of the top: below an overhang it would turn back on itself, a corner that is drawn as a long spike.
    let [Some(first), Some(last)] = [top.first(), top.last()] else { return };
    let feet = Rect::from_two_pos(*first, *last).x_range().shrink(LEAST_STEP);
    let base = low.into_iter().filter(|at| feet.contains(at.x)).collect();
    painter.add(Shape::closed_line([top, base].concat(), Stroke::new(1.5, accent)));
}

fn paint_tissue(
    ui: &Ui,
    painter: &Painter,
    place: &Place,
    section: &CrossSection,
    color: &dyn Fn(usize) -> Color32,
) {
    let mut mesh = Mesh::default();
    for (layer, quad) in section.quads() {
        let first = mesh.vertices.len() as u32;
        for corner in quad {
            mesh.colored_vertex(place.at(corner), color(layer));
        }
        mesh.add_triangle(first, first + 1, first + 2);
        mesh.add_triangle(first, first + 2, first + 3);
    }
    painter.add(Shape::mesh(mesh));
    // Lines where the layers end: the skin's outer surface and each layer's inner face.
    let line = Stroke::new(1.0, ui.visuals().text_color().gamma_multiply(0.7));
    for (level, points) in section.levels.iter().enumerate() {
        let is_within = level > 0 && section.layers.get(level) == section.layers.get(level - 1);
        if !is_within {
            painter.add(Shape::line(points.iter().map(|p| place.at(*p)).collect(), line));
        }
    }
}

fn band_color(ui: &Ui) -> Color32 {
    theme::palette(ui.visuals()).curves[0].gamma_multiply(0.35)
}

/// The skin of sampled patients: 10th to 90th percentile of the heights, shaded.
fn paint_band(ui: &Ui, painter: &Painter, place: &Place, band: &[SectionBand]) {
    let mut mesh = Mesh::default();
    for point in band {
        for height in [point.z_mm[0], point.z_mm[2]] {
            let at = place.at(Vec2::new(point.r_mm as f32, height as f32));
            mesh.colored_vertex(at, band_color(ui));
        }
    }
    for k in (2..mesh.vertices.len() as u32).step_by(2) {
        mesh.add_triangle(k - 2, k - 1, k);
        mesh.add_triangle(k - 1, k, k + 1);
    }
    painter.add(Shape::mesh(mesh));
}

/// The skin of a pin with its letter.
fn paint_pin(ui: &Ui, painter: &Painter, place: &Place, pin: &Silhouette) {
    let (color, dash, gap) = compare::stroke_of(pin.letter, theme::palette(ui.visuals()));
    let points = place.line(&pin.points);
    painter.extend(Shape::dashed_line(&points, Stroke::new(2.0, color), dash, gap));
    // Each letter at a place of its own: similar skins lie over each other.
    let place = compare::place_of(pin.letter);
    if let Some(at) = points.get((place * points.len() as f64) as usize) {
        let at = *at - vec2(4.0, 2.0);
        let font = TextStyle::Button.resolve(ui.style());
        painter.text(at, Align2::RIGHT_BOTTOM, pin.letter.to_string(), font, color);
    }
}

/// Names of the tissues with their colours, at the left of the top.
fn legend(ui: &Ui, painter: &Painter, area: Rect, names: impl Iterator<Item = (String, Color32)>) {
    let font = TextStyle::Small.resolve(ui.style());
    let text = ui.visuals().text_color();
    let mut at = area.left_top() + vec2(2.0 * theme::SPACE, theme::SPACE);
    for (name, color) in names {
        let mark = Rect::from_min_size(at + vec2(0.0, 2.0), vec2(10.0, 10.0));
        let border = Stroke::new(1.0, theme::palette(ui.visuals()).edge);
        painter.rect(mark, 2.0, color, border, egui::StrokeKind::Inside);
        painter.text(at + vec2(15.0, 0.0), Align2::LEFT_TOP, name, font.clone(), text);
        at.y += font.size + theme::SPACE_SMALL;
    }
}
