//! The dialog in front of a report: its entries, which become those of the plan.

use crate::app::plan::{self, Hand};
use crate::app::texts::tr;
use crate::app::widgets::remark;
use crate::app::widgets::theme::{self, SPACE};
use crate::scene::{Scene, Side, Visit};
use eframe::egui::{self, Context, Id, Key, Modal, RichText, Ui};

/// Greatest width \[points\].
const WIDTH: f32 = 360.0;

/// Where the entries are kept, and where not.
const KEPT: &str = "Patient number and remarks are in this report and in a saved plan only: after the next start they are gone here.";

/// The dialog with its entries.
pub(crate) struct ReportDialog {
    visit: Visit,
    side: Option<Side>,
    /// What is said in place of a choice of the side: of a scan, of plans for each side.
    fixed: Option<&'static str>,
    /// Has the first field not had the focus yet?
    is_new: bool,
}

/// What a user does with the dialog.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Choice {
    Save,
    Cancel,
}

impl ReportDialog {
    /// The dialog for a plan, with what the plan states.
    pub(crate) fn new(scene: &Scene) -> Self {
        let visit = scene.visit.clone().unwrap_or_default();
        let fixed = match &scene.other_side {
            Some(_) => Some(tr("both, a plan each")),
            None => scene.placement.as_ref().map(|_| plan::side_in_a_word(scene)),
        };
        Self { visit, side: scene.side, fixed, is_new: true }
    }

    /// Shows the dialog over the screen. Returns the choice of the user once there is one.
    pub(crate) fn show(&mut self, ctx: &Context, hand: Hand) -> Option<Choice> {
        let modal = Modal::new(Id::unique("report dialog")).show(ctx, |ui| {
            ui.set_width(WIDTH.min(ctx.content_rect().width() - 6.0 * SPACE));
            ui.heading(tr("Report"));
            ui.add_space(SPACE);
            let number =
                plan::entries_of_report(ui, &mut self.visit, (&mut self.side, self.fixed), hand);
            // The click that opens the dialog takes the focus from its first frame.
            self.is_new &= !number.has_focus();
            if self.is_new {
                number.request_focus();
            }
            let is_entered = number.lost_focus() && ui.input(|input| input.key_pressed(Key::Enter));
            remark(ui, tr(KEPT));
            ui.add_space(SPACE);
            buttons(ui, hand).or(is_entered.then_some(Choice::Save))
        });
        let is_escaped = ctx.input(|input| input.key_pressed(Key::Escape));
        modal.inner.or(is_escaped.then_some(Choice::Cancel))
    }

    /// Sets the entries of a plan.
    pub(crate) fn write_to(self, scene: &mut Scene) {
        plan::set_visit(scene, self.visit);
        scene.side = self.side;
    }
}

fn buttons(ui: &mut Ui, hand: Hand) -> Option<Choice> {
    let height = match hand {
        Hand::Mouse => ui.spacing().interact_size.y,
        Hand::Finger => theme::TOUCH,
    };
    let mut choice = None;
    ui.horizontal(|ui| {
        let palette = theme::palette(ui.visuals());
        let words = RichText::new(tr("Save report")).color(palette.on_accent);
        let save = egui::Button::new(words).fill(palette.accent);
        if ui.add(save.min_size(egui::vec2(0.0, height))).clicked() {
            choice = Some(Choice::Save);
        }
        let cancel = egui::Button::new(tr("Cancel")).min_size(egui::vec2(0.0, height));
        if ui.add(cancel).clicked() {
            choice = Some(Choice::Cancel);
        }
    });
    choice
}
