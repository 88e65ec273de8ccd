//! The plots: stress–strain curves of the layers with the present strains, the cross-section, and the outlines of the pins over
//! the picture.

use super::PreviousResults;
use super::compare::{self, Compare, Silhouette};
use crate::app::picture::viewport::Outline;
use crate::app::plan;
use crate::app::plan::device::Device;
use crate::app::texts::{self, fixed, tr};
use crate::app::widgets::group;
use crate::app::widgets::theme::{self, Palette};
use crate::curve::Curve;
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::solve::{Problem, Solution};
use crate::study::SectionBand;
use crate::view::cross_section::SectionPlane;
use crate::view::subject::Subject;
use eframe::egui::{self, Color32, RichText, Sense, Ui};
use egui_plot::{
    FilledArea, GridMark, HoverPosition, Legend, Line, LineStyle, MarkerShape, Plot, PlotUi,
    Points, uniform_grid_spacer,
};
use glam::{DVec2, DVec3, Vec2};

/// Number of intervals of a sampled curve.
const SAMPLES: i32 = 160;

/// Points (x, y) of a line.
type Polyline = Vec<[f64; 2]>;

/// Plots the curves of all layers up to strain 1, dashed beyond the measurements, thick up to the greatest strain. During a long solve
/// (`previous`) the strains are unknown and the thick part is missing.
pub(crate) fn curves(ui: &mut Ui, session: &Session, previous: PreviousResults) {
    let greatest_strain = session.greatest_strain().filter(|_| previous == PreviousResults::Shown);
    let colors = theme::palette(ui.visuals()).curves;
    group(ui, tr("Stress–strain curves"), |ui| {
        fixed_plot("curves", 180.0)
            .legend(Legend::default().position(egui_plot::Corner::LeftTop))
            .x_axis_label(tr("strain"))
            .x_grid_spacer(uniform_grid_spacer(|_| [1.0, 0.5, 0.1]))
            .x_axis_formatter(|mark, _| fixed(mark.value, 1))
            .y_axis_label(tr("stress (kPa)"))
            .show(ui, |plot| {
                for k in 0..session.scene().layers.len() {
                    let color = colors[k % colors.len()];
                    layer_curve(plot, session, k, color, greatest_strain);
                }
            });
        ui.small(greatest_strain.map_or_else(
            || tr("The strains of this plan are being computed.").to_owned(),
            |strain| {
                tr!("Dashed: extrapolated. Thick: how far this plan stretches it, up to {strain:.0} %. Dot: stress at that strain under \
                     uniaxial stretch, as in the measured curve. Diamond: greatest stress over this \
                     plan's dome, where the stretch is biaxial.", strain = 100.0 * strain)
            },
        ));
    });
}

/// Plots the curve of a layer, its strained part and the stresses at the greatest strain.
fn layer_curve(
    plot: &mut PlotUi<'_>,
    session: &Session,
    k: usize,
    color: Color32,
    greatest_strain: Option<f64>,
) {
    let (layer, material) = (&session.scene().layers[k], &session.problem().materials[k]);
    let name = format!("{} {}", k + 1, texts::tissue(&layer.tissue));
    let curve = &material.curve;
    // Solid up to the end of the measurements, dashed beyond.
    let mut part = |end: f64, color: Color32, width: f32| {
        let measured = curve.measured_end();
        let solid = Line::new(name.clone(), sampled(curve, 0.0, end.min(measured)));
        plot.line(solid.color(color).width(width));
        if end > measured {
            let dashed = Line::new(name.clone(), sampled(curve, measured, end));
            plot.line(dashed.color(color).width(width).style(LineStyle::dashed_dense()));
        }
    };
    part(greatest_strain.unwrap_or(0.0).max(1.0), color.gamma_multiply(0.5), 1.0);
    let Some(strain) = greatest_strain else { return };
    part(strain, color, 3.0);
    // Points without a name are not in the legend.
    let uniaxial = vec![[strain, material.curve.stress(strain)]];
    plot.points(Points::new("", uniaxial).color(color).radius(4.0));
    if let Some(stress) = session.outcome().and_then(|o| o.layers.get(k)?.max_stress_kpa) {
        let biaxial = Points::new("", vec![[strain, stress]]).color(color).radius(5.0);
        plot.points(biaxial.filled(false).shape(MarkerShape::Diamond));
    }
}

/// Points of a curve between two strains.
pub(crate) fn sampled(curve: &Curve, from: f64, to: f64) -> Polyline {
    let strains = (0..=SAMPLES).map(|i| from + (to - from) * f64::from(i) / f64::from(SAMPLES));
    strains.map(|strain| [strain, curve.stress(strain)]).collect()
}

/// The planes of a cross-section.
pub(crate) const PLANES: [SectionPlane; 2] = [SectionPlane::Across, SectionPlane::Along];

/// Name of a plane of a scene, from the left of its drawing to the right.
pub(crate) fn name_of(plane: SectionPlane, scene: &Scene) -> &'static str {
    match plane {
        SectionPlane::Across if hand_in(plane, scene) < 0.0 => tr("side to midline"),
        SectionPlane::Across => tr("midline to side"),
        SectionPlane::Along => tr("feet to head"),
    }
}

/// What of the patient is at the left and at the right of a drawing.
pub(crate) fn ends_of(plane: SectionPlane, scene: &Scene) -> [&'static str; 2] {
    match plane {
        SectionPlane::Across if hand_in(plane, scene) < 0.0 => [tr("side"), tr("midline")],
        SectionPlane::Across => [tr("midline"), tr("side")],
        SectionPlane::Along => [tr("feet"), tr("head")],
    }
}

/// Plots the section in a plane with a switch of the plane: implant, inner face and outer skin, the outer skin of the pins, and the
/// skin of sampled patients (`band`), if any. Without a stable shape the tissue is missing. Returns another plane.
pub(crate) fn section(
    ui: &mut Ui,
    session: &Session,
    compare: &Compare,
    band: &[SectionBand],
    plane: SectionPlane,
) -> Option<SectionPlane> {
    let mut chosen = None;
    group(ui, tr("Cross-section"), |ui| {
        ui.horizontal_wrapped(|ui| chosen = choose_plane(ui, plane, session.scene()));
        section_chart(ui, session, compare, (band, plane), 170.0);
    });
    chosen
}

/// The switch of the plane; returns another plane.
pub(crate) fn choose_plane(
    ui: &mut Ui,
    plane: SectionPlane,
    scene: &Scene,
) -> Option<SectionPlane> {
    let mut chosen = None;
    for other in PLANES {
        let name = RichText::new(name_of(other, scene)).small();
        let label = egui::Button::selectable(other == plane, name);
        if ui.add(label).clicked() {
            chosen = Some(other).filter(|other| *other != plane);
        }
    }
    chosen
}

/// The plot of [`section`] of a height \[points\], with its legend below.
pub(crate) fn section_chart(
    ui: &mut Ui,
    session: &Session,
    compare: &Compare,
    (band, plane): (&[SectionBand], SectionPlane),
    height: f32,
) {
    let palette = theme::palette(ui.visuals());
    let problem = Subject::problem(session);
    let device = Device::of(ui.ctx());
    // The section as one looks at the patient: the side of a right breast is at the left.
    let hand = hand_in(plane, session.scene());
    let seen = |line: Polyline| line.into_iter().map(|[x, z]| [hand * x, z]).collect::<Polyline>();
    let implant = (tr("implant"), palette.accent, seen(dome_outline(problem, plane)));
    let tissue = (!Subject::has_no_shape(session)).then(|| {
        let [inner, outer] = tissue_faces(session.solution(), plane).map(seen);
        [(tr("skin"), palette.curves[0], outer), (tr("inner face"), palette.curves[1], inner)]
    });
    let wall = (tr("chest wall"), palette.caution, seen(wall_line(problem, plane)));
    let pins: Vec<(&Pin, Color32)> = compare::drawn_pins(session, compare, palette).collect();
    let mut silhouettes = drawn_silhouettes(session, compare, palette, plane);
    silhouettes.iter_mut().flat_map(|line| &mut line.points).for_each(|point| point[0] *= hand);
    let mut band = sampled_skin(session, band, plane);
    band.iter_mut().for_each(|point| point.r_mm *= hand);
    let own = tissue.iter().flatten().chain([&implant, &wall]);
    let names: Vec<(String, Color32)> = own
        .map(|&(name, color, _)| (device.words(name), color))
        .chain(
            pins.iter()
                .map(|(pin, color)| (tr!("skin of {letter}", letter = pin.letter()), *color)),
        )
        .collect();
    let of_pins = silhouettes.iter().map(|line| &line.points);
    let of_band: Polyline =
        band.iter().flat_map(|point| point.z_mm.map(|z| [point.r_mm, z])).collect();
    let drawn = tissue.iter().flatten().chain([&implant, &wall]).map(|(_, _, points)| points);
    let width = fitting_width(drawn.chain(of_pins).chain([&of_band]), height);
    let [left, right] = ends_of(plane, session.scene());
    let axis = match plane {
        SectionPlane::Across => tr("across (mm)"),
        SectionPlane::Along => tr("along (mm)"),
    };
    let plot = fixed_plot("section", height)
        .width(width.min(ui.available_width()))
        .data_aspect(1.0)
        .x_axis_label(format!("< {left}        {axis}        {right} >"))
        .x_grid_spacer(uniform_grid_spacer(|_| [100.0, 50.0, 10.0]))
        .y_grid_spacer(uniform_grid_spacer(|_| [100.0, 50.0, 10.0]))
        .y_axis_label(tr("height (mm)"))
        .include_y(0.0);
    ui.vertical_centered(|ui| {
        plot.show(ui, |plot| {
            skin_band(plot, palette.curves[0], &band);
            let (name, color, points) = implant;
            plot.line(Line::new(name, points).color(color).width(1.5));
            for (name, color, points) in tissue.into_iter().flatten().rev() {
                plot.line(Line::new(name, points).color(color).width(2.0));
            }
            compare::silhouettes(plot, silhouettes, palette);
            let (name, color, points) = wall;
            plot.line(
                Line::new(name, points)
                    .color(color.gamma_multiply(0.6))
                    .style(LineStyle::dashed_dense())
                    .width(1.0),
            );
        });
    });
    ui.horizontal_wrapped(|ui| {
        for (name, color) in names {
            ui.label(RichText::new(name).small().color(color));
        }
        if !band.is_empty() {
            let words = tr("shaded: skin of 8 in 10 sampled patients, dotted: median");
            ui.label(RichText::new(words).small().color(palette.curves[0]));
        }
    });
}

/// Width of a plot of a height \[points\] that its lines fill at one scale across and up.
fn fitting_width<'a>(lines: impl Iterator<Item = &'a Polyline>, height: f32) -> f32 {
    /// Room of the axes beside and below the lines \[points\].
    const AXES: (f32, f32) = (50.0, 40.0);
    let (mut low, mut high) = ([0.0_f64; 2], [0.0_f64; 2]);
    for point in lines.flatten() {
        for k in 0..2 {
            (low[k], high[k]) = (low[k].min(point[k]), high[k].max(point[k]));
        }
    }
    let [across, up] = [0, 1].map(|k| high[k] - low[k]);
    AXES.0 + (height - AXES.1) * (across / up.max(1e-9)) as f32
}

/// +1, or −1 where the plane is seen from its other side: across a right breast.
pub(crate) fn hand_in(plane: SectionPlane, scene: &Scene) -> f64 {
    match plane {
        SectionPlane::Across => plan::hand_of(scene),
        SectionPlane::Along => 1.0,
    }
}

/// The skin's band across the plot: on both sides of a centred implant, otherwise on the side of the profile; along the body of a plan
/// that is the same in all directions only.
pub(crate) fn sampled_skin(
    session: &Session,
    band: &[SectionBand],
    plane: SectionPlane,
) -> Vec<SectionBand> {
    if plane == SectionPlane::Along && !session.scene().is_round() {
        return Vec::new();
    }
    let [x, y] = session.scene().implant.center_mm;
    let is_centred = x == 0.0 && y == 0.0;
    let mirrored = |point: &SectionBand| SectionBand { r_mm: -point.r_mm, ..*point };
    let left = band.iter().skip(1).rev().map(mirrored).filter(|_| is_centred);
    left.chain(band.iter().copied()).collect()
}

/// Plots the skin's band, shaded, with its median.
fn skin_band(plot: &mut PlotUi<'_>, color: Color32, band: &[SectionBand]) {
    if band.is_empty() {
        return;
    }
    let heights = |k: usize| band.iter().map(|point| point.z_mm[k]).collect::<Vec<_>>();
    let across: Vec<f64> = band.iter().map(|point| point.r_mm).collect();
    let area =
        FilledArea::new("skin of 8 in 10 sampled patients", &across, &heights(0), &heights(2));
    plot.add(area.fill_color(color.gamma_multiply(0.25)));
    let median: Polyline = band.iter().map(|point| [point.r_mm, point.z_mm[1]]).collect();
    let median = Line::new("median of the sampled patients", median);
    plot.line(median.color(color).style(LineStyle::dotted_dense()).width(1.5));
}

/// Inner and outer face of the tissue on the grid line nearest to a plane \[mm\].
fn tissue_faces(solution: &Solution, plane: SectionPlane) -> [Polyline; 2] {
    let row = plane.nodes(solution.problem().sheet());
    let (x, stack) = (solution.inner(), solution.stack());
    let outer = |k: usize| {
        let along_normal = stack.thickness_mm.len() - stack.between.len();
        let layers = stack.thickness_mm[..along_normal].iter();
        let thickness: f64 = layers.map(|t| f64::from(t[k])).sum();
        let x = stack.between.last().map_or(x[k], |face| face[k].as_dvec3());
        let normal = stack.normal[k].as_dvec3();
        x + normal * thickness
    };
    let seen = |at: DVec3| [plane.distance(at.truncate()), at.z];
    [row.clone().map(|k| seen(x[k])).collect(), row.map(|k| seen(outer(k))).collect()]
}

/// The skin of the pins in the cross-section, as far as the comparison draws it.
pub(crate) fn drawn_silhouettes(
    session: &Session,
    compare: &Compare,
    palette: &Palette,
    plane: SectionPlane,
) -> Vec<Silhouette> {
    let silhouette = |(pin, _): (&Pin, Color32)| {
        let [_, points] = tissue_faces(pin.solution()?, plane);
        Some(Silhouette { letter: pin.letter(), points })
    };
    compare::drawn_pins(session, compare, palette).filter_map(silhouette).collect()
}

/// The outlines of the pins over the picture, but for a pin of the present scene.
pub(crate) fn outlines(session: &Session, compare: &Compare, palette: &Palette) -> Vec<Outline> {
    let outline = |(pin, color): (&Pin, Color32)| {
        let [_, skin] = tissue_faces(pin.solution()?, SectionPlane::Across);
        let outwards = skin.into_iter().filter(|[x, _]| *x >= 0.0);
        Some(Outline {
            letter: pin.letter(),
            color,
            dashes: compare::dashes_of(pin.letter()),
            points: outwards.map(|[x, z]| Vec2::new(x as f32, z as f32)).collect(),
            is_round: pin.scene().is_round(),
        })
    };
    let pins = compare::drawn_pins(session, compare, palette);
    pins.filter(|(pin, _)| !pin.scene().same_physics(session.scene())).filter_map(outline).collect()
}

/// Intersection of the dome with a plane, above the chest wall \[mm\].
pub(crate) fn dome_outline(problem: &Problem, plane: SectionPlane) -> Polyline {
    let dome = &problem.obstacle.dome;
    (0..=SAMPLES)
        .map(|i| std::f64::consts::PI * f64::from(i) / f64::from(SAMPLES))
        .map(|angle| match plane {
            SectionPlane::Across => dome.outline(0.0, angle),
            SectionPlane::Along => dome.outline_along(0.0, angle),
        })
        .filter(|point| point.y >= -1e-9)
        .map(|point| [point.x, point.y + wall_height(problem, plane.place(point.x))])
        .collect()
}

/// Height of the chest wall at a place \[mm\].
pub(crate) fn wall_height(problem: &Problem, place: DVec2) -> f64 {
    problem.obstacle.wall.0.height(place)
}

/// The chest wall under the patch in a plane \[mm\].
pub(crate) fn wall_line(problem: &Problem, plane: SectionPlane) -> Polyline {
    let radius = problem.sheet().radius_mm();
    let place = |i: i32| radius * (2.0 * f64::from(i) / f64::from(SAMPLES) - 1.0);
    let foot = |s: f64| problem.obstacle.wall.0.foot_and_normal(plane.place(s)).0;
    let seen = |foot: DVec3| [plane.distance(foot.truncate()), foot.z];
    (0..=SAMPLES).map(|i| seen(foot(place(i)))).collect()
}

/// A plot without interaction, so that the Tab key skips it.
pub(crate) fn fixed_plot(name: &'static str, height: f32) -> Plot<'static> {
    Plot::new(name)
        .height(height)
        .sense(Sense::hover())
        .allow_scroll(false)
        .allow_drag(false)
        .allow_zoom(false)
        .x_axis_formatter(|mark, _| axis_number(mark))
        .y_axis_formatter(|mark, _| axis_number(mark))
        .label_formatter(|at| Some(values_at(at)))
}

/// The values at the pointer, with the name of the line there.
fn values_at(at: &HoverPosition<'_>) -> String {
    let (name, at) = match *at {
        HoverPosition::NearDataPoint { plot_name, position, .. } => {
            (format!("{plot_name}\n"), position)
        }
        HoverPosition::Elsewhere { position } => (String::new(), position),
    };
    format!("{name}x = {}\ny = {}", fixed(at.x, 3), fixed(at.y, 3))
}

/// The number of a mark on an axis, with the decimals of its step.
fn axis_number(mark: GridMark) -> String {
    fixed(mark.value, (-mark.step_size.log10().round()).max(0.0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::widgets::texts_of;
    use crate::scene::Side;
    use crate::solve::Progress;
    use eframe::egui::vec2;

    /// The texts of a section of a plan of a side in a broad room.
    fn texts(plane: SectionPlane, side: Side) -> Vec<String> {
        let mut scene = Scene { side: Some(side), ..Scene::first_plan() };
        scene.solver.nodes_per_side = 17;
        let mut session = Session::new(scene).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let compare = Compare::default();
        texts_of(vec2(860.0, 260.0), |ui| {
            section_chart(ui, &session, &compare, (&[], plane), 212.0);
        })
    }

    #[test]
    fn a_section_says_what_is_left_and_right_and_its_axis_ends_with_the_drawing() {
        for (plane, side, ends) in [
            (SectionPlane::Across, Side::Left, ["< midline ", " side >"]),
            (SectionPlane::Across, Side::Right, ["< side ", " midline >"]),
            (SectionPlane::Along, Side::Right, ["< feet ", " head >"]),
        ] {
            let texts = texts(plane, side);
            let is_axis = |text: &String| text.starts_with(ends[0]) && text.ends_with(ends[1]);
            assert!(texts.iter().any(is_axis), "{texts:?}");
            // The tissue of the opening plan is 24 cm wide.
            let number = |text: &String| text.replace('−', "-").parse::<f64>().ok();
            let most = texts.iter().filter_map(number).fold(0.0, |most: f64, x| most.max(x.abs()));
            assert!((100.0..=150.0).contains(&most), "{texts:?}");
        }
    }
}
