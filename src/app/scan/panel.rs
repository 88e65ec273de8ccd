//! The controls of a scan: unit, side, pinch, the list of the marks, what the fit says.

use super::Scan;
use super::points;
use crate::app::plan::{Hand, chip, chips, named};
use crate::app::texts::{localized, shown, tr};
use crate::app::widgets::theme::{self, SPACE_SMALL};
use crate::app::widgets::{Control, fit_fingers, rejection_label, remark};
use crate::body::marks::Side;
use crate::body::read::Unit;
use crate::scene::{COVER_MM, Field, Scene};
use eframe::egui::{self, RichText, Ui};

/// How a user ends the step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Choice {
    Use,
    Cancel,
}

impl Scan {
    /// Shows the controls.
    pub(crate) fn show(&mut self, ui: &mut Ui, plan: &Scene, hand: Hand) {
        ui.add_space(SPACE_SMALL);
        ui.add(
            egui::Label::new(RichText::new(tr!("Scan {name}", name = self.name)).heading()).wrap(),
        );
        remark(ui, tr("It stays on this machine."));
        ui.add_space(SPACE_SMALL);
        self.unit(ui, hand);
        self.side(ui, hand);
        self.pinch(ui, hand);
        ui.separator();
        self.list(ui, hand);
        ui.add_space(SPACE_SMALL);
        self.findings(ui, plan);
    }

    /// The marks of the list.
    fn listed(&self) -> impl Iterator<Item = usize> {
        self.points.listed(self.side)
    }

    /// May the marks be fitted now? No fit for every step of a drag.
    fn is_at_rest(&self, ui: &Ui) -> bool {
        self.fitted.is_some() || !ui.input(|input| input.pointer.any_down())
    }

    /// Shows what the fit says.
    fn findings(&mut self, ui: &mut Ui, plan: &Scene) {
        if !self.is_at_rest(ui) {
            return;
        }
        let Some(found) = self.assess(plan) else { return };
        match found {
            Ok(found) => {
                let color = theme::palette(ui.visuals()).caution;
                for words in found.quality.warnings() {
                    ui.add(egui::Label::new(RichText::new(shown(&words)).color(color)).wrap());
                }
            }
            Err(error) => rejection_label(ui, &shown(error)),
        }
    }

    fn unit(&mut self, ui: &mut Ui, hand: Hand) {
        let mut chosen = None;
        named(ui, tr("Unit"), |ui| {
            chips(ui, |ui| {
                for unit in Unit::ALL {
                    let tooltip = tr("Unit of the lengths in the file");
                    if chip(ui, hand, unit == self.read.unit, unit.name(), tooltip) {
                        chosen = Some(unit);
                    }
                }
            });
        });
        if let Some(unit) = chosen {
            self.set_unit(unit);
        }
        let notch = self.points.get(0, self.side);
        let nipple = self.points.get(if self.side == Side::Left { 2 } else { 3 }, self.side);
        let words = match notch.zip(nipple) {
            Some((notch, nipple)) => {
                let cm = localized(format!("{:.1}", 0.1 * notch.distance(nipple)));
                tr!("Notch to nipple is {cm} cm: is that hers?", cm)
            }
            None => {
                let extent = self.read.surface.bounds().map_or(0.0, |[a, b]| (b - a).max_element());
                tr!("The surface is {cm:.0} cm long: is that hers?", cm = 0.1 * extent)
            }
        };
        ui.add(egui::Label::new(words).wrap());
    }

    fn side(&mut self, ui: &mut Ui, hand: Hand) {
        let mut chosen = None;
        named(ui, tr("Breast"), |ui| {
            chips(ui, |ui| {
                for (side, word) in [(Side::Left, tr("left")), (Side::Right, tr("right"))] {
                    let tooltip = tr("The patient's side");
                    if chip(ui, hand, side == self.side, word, tooltip) {
                        chosen = Some(side);
                    }
                }
            });
        });
        if let Some(side) = chosen {
            self.side = side;
            let same = points::of_other_side(self.chosen);
            self.chosen = self.points.missing(side).unwrap_or(same);
            self.fitted = None;
        }
    }

    fn pinch(&mut self, ui: &mut Ui, hand: Hand) {
        let (least, most) = COVER_MM;
        let control = Control { reset: 2.0, ..Control::of(Field::Pinch) };
        let control = control.with_rail(0.2 * least..=0.2 * most);
        let control = Control { allowed: Some(0.2 * least..=0.2 * most), ..control };
        let mut pinch = 0.1 * self.pinch_mm;
        let changed = match hand {
            Hand::Mouse => control.row(ui, &mut pinch, (0.0, |_: &mut Ui| {})),
            Hand::Finger => control.stepper(ui, &mut pinch, |_: &mut Ui| {}),
        };
        if changed.is_changed {
            self.pinch_mm = 10.0 * pinch;
            self.fitted = None;
        }
    }

    /// The marks: those that are set, and the one to click next.
    fn list(&mut self, ui: &mut Ui, hand: Hand) {
        let words = match self.points.missing(self.side) {
            Some(mark) => {
                if self.points.get(self.chosen, self.side).is_some() {
                    self.chosen = mark;
                }
                tr!("Click on her body: {mark}.", mark = points::name(self.chosen, self.side).0)
            }
            None if self.listed().any(|mark| self.points.is_proposed(mark, self.side)) => {
                tr("The marks with a question mark are proposed: click on each, drag those that are off.")
                    .to_owned()
            }
            None => tr("Drag a dot, or move it by the arrow keys (Shift: 1 cm).").to_owned(),
        };
        ui.add(egui::Label::new(RichText::new(words).strong()).wrap());
        // Without marks nothing tells the axes.
        if self.listed().all(|mark| self.points.get(mark, self.side).is_none()) {
            remark(ui, tr("No breasts were recognised. The body should stand upright here."));
            if ui.button(tr("Turn the body")).clicked() {
                self.turn();
            }
        }
        let mut chosen = None;
        chips(ui, |ui| {
            for mark in self.listed() {
                let (name, word) = points::name(mark, self.side);
                let is_proposed = self.points.is_proposed(mark, self.side);
                let text = match self.points.get(mark, self.side) {
                    None => format!("{word} …"),
                    Some(_) if is_proposed => format!("{word} ?"),
                    Some(_) => word.to_owned(),
                };
                if chip(ui, hand, mark == self.chosen && !is_proposed, &text, name) {
                    chosen = Some(mark);
                }
            }
        });
        if let Some(mark) = chosen {
            self.choose(mark);
        }
    }

    /// The buttons below the controls. Returns how the user ends the step, once so.
    pub(crate) fn buttons(&mut self, ui: &mut Ui, plan: &Scene) -> Option<Choice> {
        let is_able = self.is_at_rest(ui) && self.assess(plan).is_some_and(Result::is_ok);
        let palette = theme::palette(ui.visuals());
        ui.add_space(SPACE_SMALL);
        let mut choice = None;
        ui.horizontal_wrapped(|ui| {
            fit_fingers(ui);
            let text = RichText::new(tr("Use these marks"));
            let button = match is_able {
                true => egui::Button::new(text.color(palette.on_accent)).fill(palette.accent),
                false => egui::Button::new(text),
            };
            if ui.add_enabled(is_able, button).clicked() {
                choice = Some(Choice::Use);
            }
            if ui.button(tr("Cancel")).clicked() {
                choice = Some(Choice::Cancel);
            }
            let undo = egui::Button::new(tr("Undo mark"));
            if ui.add_enabled(self.points.can_undo(), undo).on_hover_text("Ctrl+Z").clicked() {
                self.undo();
            }
        });
        ui.add_space(SPACE_SMALL);
        choice
    }
}
