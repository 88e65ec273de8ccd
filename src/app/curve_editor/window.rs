//! Window for the points of a measured curve: a table, typed or pasted, beside the curve through its points. The layer
//! takes the points on request only, so a table may be incomplete meanwhile. The points are those that the plan uses: a scale
//! of the layer's curve is multiplied in, and the layer takes them with scale 1.

use super::import::Import;
use crate::app::answer::plots::fixed_plot;
use crate::app::frame::action::Action;
use crate::app::frame::messages::Notice;
use crate::app::range::marks;
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::{self, SPACE};
use crate::app::widgets::{Kind, NumberField, button_if, quantity, rejection_label};
use crate::curve::{Curve, CurveSpec, Interpolation};
use crate::scene::{Layer, Scene};
use eframe::egui::{self, Key, RichText, Ui, vec2};
use egui_plot::{GridMark, Line, PlotPoints, Points};

/// Upper limits of a point: strain \[-\] and stress \[kPa\].
const MAX_POINT: [f64; 2] = [10.0, 1e7];
/// Width of the table and of the plot \[points\].
const WIDTH: f32 = 270.0;
const ROW: f32 = 24.0;
/// Height of the window without its middle \[points\]: title, reason and buttons.
const ENDING: f32 = 150.0;
/// Number of intervals of the plotted curve.
const SAMPLES: i32 = 160;
/// Greatest number of points, and of samples of a test, drawn as dots.
const MAX_DOTS: usize = 400;

/// The window with its draft of a curve.
pub(crate) struct CurveWindow {
    /// Number of the layer, from the skin inwards.
    layer: usize,
    points: Vec<[f64; 2]>,
    interpolation: Interpolation,
    /// The curve of the layer.
    taken: CurveSpec,
    /// Are strains shown in percent?
    is_percent: bool,
    import: Import,
}

impl CurveWindow {
    /// Opens the window on a layer's points; `None` for a curve of another kind.
    pub(crate) fn new(scene: &Scene, layer: usize) -> Option<Self> {
        let curve = &scene.layers.get(layer)?.curve;
        let CurveSpec::Points { points, interpolation } = &curve.spec else { return None };
        let scaled = |[strain, stress]: &[f64; 2]| {
            [strain * curve.strain_scale, stress * curve.stress_scale].map(quantity::significant)
        };
        let points: Vec<[f64; 2]> = points.iter().map(scaled).collect();
        Some(Self {
            layer,
            taken: CurveSpec::Points { points: points.clone(), interpolation: *interpolation },
            points,
            interpolation: *interpolation,
            is_percent: false,
            import: Import::default(),
        })
    }

    /// Shows the window; returns whether the window stays open.
    pub(crate) fn show(
        &mut self,
        ctx: &egui::Context,
        scene: &mut Scene,
        actions: &mut Vec<Action>,
    ) -> bool {
        let Some(layer) = scene.layers.get_mut(self.layer) else { return false };
        // Escape ends the edit of a number too: a draft is not lost by Escape.
        let is_escape = ctx.input(|input| input.key_pressed(Key::Escape));
        let (mut is_open, mut is_closed) = (true, is_escape && self.spec() == self.taken);
        let is_wide = ctx.content_rect().width() >= theme::NARROW;
        egui::Window::new(tr!(
            "Curve of layer {number}: {tissue}",
            number = self.layer + 1,
            tissue = texts::tissue(&layer.tissue)
        ))
        .id(egui::Id::unique("curve window"))
        .open(&mut is_open)
        .collapsible(false)
        .resizable(false)
        .pivot(egui::Align2::CENTER_CENTER)
        .default_pos(ctx.content_rect().center())
        .show(ctx, |ui| {
            let height = ctx.content_rect().height() - ENDING;
            egui::ScrollArea::vertical().id_salt("curve window").max_height(height).show(
                ui,
                |ui| {
                    if is_wide {
                        ui.horizontal_top(|ui| {
                            ui.vertical(|ui| self.table(ui, actions));
                            ui.vertical(|ui| self.curve(ui));
                        });
                    } else {
                        self.table(ui, actions);
                        self.curve(ui);
                    }
                },
            );
            ui.separator();
            is_closed |= self.ending(ui, layer);
        });
        is_open && !is_closed
    }

    /// The points as numbers, and as text to paste.
    fn table(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ui.set_width(WIDTH);
        ui.horizontal(|ui| {
            ui.label(tr("Strain as"));
            ui.radio_value(&mut self.is_percent, false, tr("fraction"));
            ui.radio_value(&mut self.is_percent, true, tr("percent"));
        });
        let removed = self.rows(ui);
        if let Some(k) = removed {
            self.points.remove(k);
        }
        let tip = tr("Add a point on the line through the last two points");
        if button_if(ui, true, tr("Add point"), tr("Add point"), tip)
            && let [.., [e0, s0], [e1, s1]] = self.points[..]
            && e1 < 9.0
            && e1 > e0
        {
            self.points.push([e1 + 0.1, s1 + 0.1 * (s1 - s0) / (e1 - e0)]);
        }
        ui.add_space(SPACE);
        if let Some(found) = self.import.show(ui, WIDTH, actions) {
            (self.points, self.interpolation) = (found.points.clone(), Interpolation::Spline);
        }
    }

    /// Reads a tensile test in the text of a file. Returns the notice.
    pub(crate) fn read_file(&mut self, name: &str, text: String) -> Notice {
        match self.import.read_file(text) {
            Ok(found) => {
                (self.points, self.interpolation) = (found.points.clone(), Interpolation::Spline);
                Notice::info(tr!("{name} was read; the layer takes its curve by Apply.", name))
            }
            Err(error) => Notice::error(tr!(
                "{name} was not read; the points are unchanged. {error}.",
                name,
                error
            )),
        }
    }

    /// Shows a row per point, and the reasons of rejected numbers. Returns the point to remove.
    fn rows(&mut self, ui: &mut Ui) -> Option<usize> {
        let invalid = first_non_increasing(&self.points);
        let is_removable = self.points.len() > 2;
        let (mut removed, mut rejections) = (None, Vec::new());
        ui.horizontal(|ui| {
            ui.add_sized([80.0, 16.0], egui::Label::new(RichText::new(tr("Strain")).small()));
            ui.add_sized([80.0, 16.0], egui::Label::new(RichText::new(tr("Stress (kPa)")).small()));
        });
        let height = (self.points.len().min(8) as f32) * (ROW + SPACE);
        let area = egui::ScrollArea::vertical().max_height(height).auto_shrink([false, true]);
        area.show_rows(ui, ROW, self.points.len(), |ui, rows| {
            for k in rows {
                ui.horizontal(|ui| {
                    if k == 0 {
                        // The first point of every curve is the origin.
                        for _ in 0..2 {
                            ui.add_sized(
                                [80.0, ROW],
                                egui::Label::new(RichText::new("0").monospace()),
                            );
                        }
                        return;
                    }
                    for axis in 0..2 {
                        let is_marked = invalid == Some((k, axis));
                        rejections.extend(self.number(ui, k, axis, is_marked));
                    }
                    let name = tr!("Remove point {number}", number = k + 1);
                    if button_if(ui, is_removable, "×", &name, "") {
                        removed = Some(k);
                    }
                });
            }
        });
        rejections.iter().for_each(|reason| rejection_label(ui, reason));
        removed
    }

    /// The field of a strain (axis 0) or stress (axis 1); returns the reason of a rejected number.
    fn number(&mut self, ui: &mut Ui, k: usize, axis: usize, is_invalid: bool) -> Option<String> {
        let name =
            tr!("{value} of point {k}", value = [tr("Strain"), tr("Stress")][axis], k = k + 1);
        let is_percent = self.is_percent && axis == 0;
        let factor = if is_percent { 100.0 } else { 1.0 };
        let kind = match axis {
            0 if is_percent => Kind::Percent,
            0 => Kind::Fraction,
            _ => Kind::Stress,
        };
        let field = NumberField {
            name: &name,
            kind,
            allowed: 0.0..=factor * MAX_POINT[axis],
            decimals: if is_percent { 0 } else { [2, 1][axis] },
            step: if is_percent { 1.0 } else { [0.01, 1.0][axis] },
            width: 80.0,
            is_invalid,
            ..NumberField::default()
        };
        let mut value = quantity::significant(factor * self.points[k][axis]);
        let response = field.show(ui, &mut value);
        if response.is_changed {
            self.points[k][axis] = quantity::significant(value / factor);
        }
        response.rejection.map(|reason| format!("{name}: {reason}"))
    }

    /// The curve through the points.
    fn curve(&mut self, ui: &mut Ui) {
        ui.set_width(WIDTH);
        ui.horizontal(|ui| {
            ui.label(tr("Between points"));
            ui.radio_value(&mut self.interpolation, Interpolation::Line, tr("straight"));
            ui.radio_value(&mut self.interpolation, Interpolation::Spline, tr("smooth"));
        });
        let color = theme::palette(ui.visuals()).curves[self.layer % 4];
        let faint = ui.visuals().weak_text_color();
        let curve = Curve::new(&self.spec()).ok();
        let end = self.points.last().map_or(1.0, |point| point[0]);
        let ticks: Vec<GridMark> = marks((0.0, end), 3)
            .into_iter()
            .map(|value| GridMark { value, step_size: end / 3.0 })
            .collect();
        fixed_plot("curve draft", 220.0)
            .x_grid_spacer(move |_| ticks.clone())
            .x_axis_label(tr("strain"))
            .y_axis_label(tr("stress (kPa)"))
            .show(ui, |plot| {
                if let Some(found) = self.import.tensile() {
                    let step = found.samples.len() / MAX_DOTS + 1;
                    let samples: PlotPoints<'_> =
                        found.samples.iter().step_by(step).copied().collect();
                    plot.points(Points::new("samples", samples).color(faint).radius(1.5));
                }
                if let Some(curve) = curve {
                    let strains = (0..=SAMPLES).map(|i| end * f64::from(i) / f64::from(SAMPLES));
                    let line: PlotPoints<'_> = strains.map(|e| [e, curve.stress(e)]).collect();
                    plot.line(Line::new("curve", line).color(color).width(2.0));
                }
                if self.points.len() <= MAX_DOTS {
                    plot.points(
                        Points::new("points", self.points.clone()).color(color).radius(4.0),
                    );
                }
            });
        self.import.what_was_read(ui);
    }

    /// Takes the points over or closes the window; returns whether the window is to be closed.
    fn ending(&mut self, ui: &mut Ui, layer: &mut Layer) -> bool {
        let reason = self.invalid_reason();
        if let Some(reason) = &reason {
            rejection_label(ui, &tr!("{reason}. Until then the layer keeps its curve.", reason));
        }
        let spec = self.spec();
        ui.horizontal(|ui| {
            let is_able = reason.is_none() && spec != self.taken;
            let tip = tr("The layer takes this curve; Undo restores the previous one");
            if button_if(ui, is_able, tr("Apply"), tr("Apply the curve"), tip) {
                self.taken = spec.clone();
                layer.curve = spec.into();
            }
            ui.add(egui::Button::new(tr("Close")).min_size(vec2(60.0, ROW))).clicked()
        })
        .inner
    }

    fn spec(&self) -> CurveSpec {
        CurveSpec::Points { points: self.points.clone(), interpolation: self.interpolation }
    }

    /// Reason why the points are no valid curve; `None` for valid points.
    fn invalid_reason(&self) -> Option<String> {
        let Some((k, axis)) = first_non_increasing(&self.points) else {
            return Curve::new(&self.spec()).err().map(|error| error.to_string());
        };
        let (name, unit) = [(tr("strain"), ""), (tr("stress"), " kPa")][axis];
        let value = |k: usize| quantity::format(self.points[k][axis], 0);
        let (point, here, before) = (k + 1, value(k), value(k - 1));
        Some(tr!(
            "the {name} of point {point} ({here}{unit}) must be greater than that of point {k} ({before}{unit})",
            name,
            point,
            here,
            unit,
            k,
            before
        ))
    }
}

/// Finds the first point that does not exceed the previous point, and the axis in which it does not.
fn first_non_increasing(points: &[[f64; 2]]) -> Option<(usize, usize)> {
    (1..points.len()).find_map(|k| {
        let axis = (0..2).find(|&axis| points[k][axis] <= points[k - 1][axis])?;
        Some((k, axis))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_that_do_not_rise_are_found() {
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.5, 220.0]]), None);
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.4, 220.0]]), Some((2, 0)));
        assert_eq!(first_non_increasing(&[[0.0, 0.0], [0.4, 100.0], [0.5, 90.0]]), Some((2, 1)));
    }
}
