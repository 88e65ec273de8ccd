//! Two plots: the layers' curves with the strains now in use, and the cross-section.

use super::readings::PreviousResults;
use super::theme;
use super::widgets::group;
use crate::session::Session;
use crate::sheet::NodeKind;
use eframe::egui::{Color32, RichText, Sense, Ui};
use egui_plot::{Legend, Line, LineStyle, Plot, PlotPoints, Points, uniform_grid_spacer};

/// Samples of a curve.
const SAMPLES: i32 = 160;

/// Curves of all layers up to strain 1, the strained part drawn thick; not while a long solve is under way
/// (`previous`), whose strains are not known.
pub(super) fn curves(ui: &mut Ui, session: &Session, previous: PreviousResults) {
    let greatest_strain = session.greatest_strain().filter(|_| previous == PreviousResults::Shown);
    let outcome = session.outcome().filter(|_| previous == PreviousResults::Shown);
    let colors = theme::palette(ui.visuals()).curves;
    group(ui, "Stress–strain curves", |ui| {
        Plot::new("curves")
            .height(180.0)
            .legend(Legend::default().position(egui_plot::Corner::LeftTop))
            .x_axis_label("strain")
            .x_grid_spacer(uniform_grid_spacer(|_| [1.0, 0.5, 0.1]))
            .x_axis_formatter(|mark, _| format!("{:.1}", mark.value))
            .y_axis_label("stress (kPa)")
            // Not a stop of the Tab key: there is nothing to do in it.
            .sense(Sense::hover())
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .show(ui, |plot| {
                let materials = &session.solver().problem().materials;
                for (k, (layer, material)) in
                    session.scene().layers.iter().zip(materials).enumerate()
                {
                    let curve = &material.curve;
                    let color = colors[k % colors.len()];
                    let name = format!("{} {}", k + 1, layer.tissue);
                    let sampled = |end: f64| -> PlotPoints<'static> {
                        (0..=SAMPLES)
                            .map(|i| end * f64::from(i) / f64::from(SAMPLES))
                            .map(|e| [e, curve.stress(e)])
                            .collect()
                    };
                    plot.line(
                        // Without a name it stays out of the legend.
                        Line::new(name.clone(), sampled(greatest_strain.unwrap_or(0.0).max(1.0)))
                            .color(color.gamma_multiply(0.5))
                            .width(1.0),
                    );
                    let Some(greatest_strain) = greatest_strain else { continue };
                    plot.line(Line::new(name, sampled(greatest_strain)).color(color).width(3.0));
                    let here = vec![[greatest_strain, curve.stress(greatest_strain)]];
                    plot.points(Points::new("", here).color(color).radius(4.0));
                    let both_ways = outcome.and_then(|o| o.layers.get(k)?.max_stress_kpa);
                    if let Some(stress) = both_ways {
                        let here = Points::new("", vec![[greatest_strain, stress]]);
                        plot.points(
                            here.color(color)
                                .radius(5.0)
                                .filled(false)
                                .shape(egui_plot::MarkerShape::Diamond),
                        );
                    }
                }
            });
        ui.small(greatest_strain.map_or_else(
            || "How far this plan stretches the tissue is being computed.".to_owned(),
            |greatest_strain| {
                format!(
                    "Thick line: how far this plan stretches the tissue, {:.0} %. Dot: the stress there if \
                     it were stretched one way, as in the measurement. Diamond: the greatest stress over \
                     this implant, stretched both ways.",
                    100.0 * greatest_strain
                )
            },
        ));
    });
}

/// The section along x through the pocket's centre: implant, inner face, outer skin; the tissue only where
/// it has a shape.
pub(super) fn section(ui: &mut Ui, session: &Session) {
    let palette = theme::palette(ui.visuals());
    let problem = session.solver().problem();
    let (sheet, dome) = (&problem.sheet, problem.dome);
    let n = sheet.nodes_per_side();
    let row: Vec<usize> =
        (n / 2 * n..(n / 2 + 1) * n).filter(|&k| sheet.kinds()[k] != NodeKind::Outside).collect();
    let (x, stack) = (session.shape(), session.fields().stack());
    let inner: Vec<[f64; 2]> = row.iter().map(|&k| [x[k].x, x[k].z]).collect();
    let outer: Vec<[f64; 2]> = row
        .iter()
        .map(|&k| {
            let thickness: f64 = stack.thickness_mm.iter().map(|t| f64::from(t[k])).sum();
            let normal = stack.normal[k].as_dvec3();
            [x[k].x + normal.x * thickness, x[k].z + normal.z * thickness]
        })
        .collect();
    // Where the plane y = 0 cuts the dome, an ellipse too.
    let across = dome.center.y / dome.base_radius;
    let share = (1.0 - across * across).max(0.0).sqrt();
    let dome_line: Vec<[f64; 2]> = (0..=SAMPLES)
        .map(|i| std::f64::consts::PI * f64::from(i) / f64::from(SAMPLES))
        .map(|a| {
            let (sin, cos) = a.sin_cos();
            [
                dome.center.x + share * dome.base_radius * cos,
                dome.base_height + share * dome.projection * sin,
            ]
        })
        .filter(|p| p[1] >= -1e-9)
        .collect();
    let has_shape = !session.has_no_shape();
    group(ui, "Cross-section", |ui| {
        Plot::new("section")
            .height(170.0)
            .data_aspect(1.0)
            .x_axis_label("across (mm)")
            .x_grid_spacer(uniform_grid_spacer(|_| [100.0, 50.0, 10.0]))
            .y_grid_spacer(uniform_grid_spacer(|_| [100.0, 50.0, 10.0]))
            .y_axis_label("height (mm)")
            .include_y(0.0)
            // Not a stop of the Tab key: there is nothing to do in it.
            .sense(Sense::hover())
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false)
            .show(ui, |plot| {
                let mut line = |name: &str, points: Vec<[f64; 2]>, color: Color32, width: f32| {
                    plot.line(Line::new(name, points).color(color).width(width));
                };
                line("implant", dome_line, palette.accent, 1.5);
                if has_shape {
                    line("inner face", inner, palette.curves[1], 2.0);
                    line("skin", outer, palette.curves[0], 2.0);
                }
                let a = sheet.radius_mm();
                let wall = vec![[-a, 0.0], [a, 0.0]];
                plot.line(
                    Line::new("chest wall", wall)
                        .color(palette.caution.gamma_multiply(0.6))
                        .style(LineStyle::dashed_dense())
                        .width(1.0),
                );
            });
        ui.horizontal_wrapped(|ui| {
            let names = [
                ("skin", palette.curves[0]),
                ("inner face", palette.curves[1]),
                ("implant", palette.accent),
                ("chest wall", palette.caution),
            ];
            for &(name, color) in &names[if has_shape { 0 } else { 2 }..] {
                ui.label(RichText::new(name).small().color(color));
            }
        });
    });
}
