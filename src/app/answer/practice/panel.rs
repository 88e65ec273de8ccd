//! The rule of practice in words, and the buttons of its table.

use super::{Against, Practices};
use crate::app::frame::action::{Action, Task};
use crate::app::plan::device::Device;
use crate::app::texts::tr;
use crate::app::widgets::quantity::format_at_most;
use crate::clinical::{Bound, Corrected, Correction, PracticeTable, STEP_ML};
use crate::measure::bands::PracticeStretch;
use crate::scene::Scene;
use crate::study::{NoPractice, breast_width_mm};
use eframe::egui::Ui;

/// The rule as it applies to a plan, or why it does not apply, and the source of its numbers; a line each. Empty for an expander.
pub(crate) fn rule_in_short(practices: &Practices, plan: &Scene) -> String {
    let first = match practices.against(plan) {
        Against::Skin(None) => return String::new(),
        Against::Skin(Some(reason)) => Some(why_not(reason)),
        Against::Practice(_) | Against::Waiting => volume(practices, plan, None),
    };
    first.map_or_else(String::new, |line| format!("{line} {}\n", source(practices)))
}

/// As [`rule_in_short`], with the strains of practice's volumes and every number of the table.
pub(crate) fn rule(practices: &Practices, plan: &Scene) -> String {
    let mut lines = Vec::new();
    match practices.against(plan) {
        Against::Skin(None) => return String::new(),
        Against::Skin(Some(reason)) => lines.push(why_not(reason)),
        Against::Practice(practice) => lines.extend(volume(practices, plan, Some(practice))),
        Against::Waiting => lines.extend(volume(practices, plan, None)),
    }
    let table = practices.table();
    let start = |[width, volume]: &[f64; 2]| format!("{} cm {volume:.0} ml", centimetres(*width));
    let starts: Vec<String> = table.starts().iter().map(start).collect();
    let corrections: Vec<String> = table.corrections().iter().map(correction).collect();
    lines.push(tr!(
        "The table of practice, linear between its rows: {starts}; {corrections}.",
        starts = starts.join(", "),
        corrections = corrections.join(", ")
    ));
    lines.push(source(practices));
    lines.iter().map(|line| format!("{line}\n")).collect()
}

fn source(practices: &Practices) -> String {
    tr!("Source of the table: {source}.", source = tr(practices.table().source()))
}

/// The volume that practice takes for a plan with its parts, and the strains of its limits.
fn volume(
    practices: &Practices,
    plan: &Scene,
    practice: Option<PracticeStretch>,
) -> Option<String> {
    let volume = practices.volume(plan)?;
    let parts: String =
        volume.corrections.iter().map(|part| format!("; {}", correction(part))).collect();
    let takes = tr!(
        "Practice takes {volume:.0} ml here: {start:.0} ml for a base of {width} cm{parts}.",
        volume = volume.volume_ml(),
        start = volume.start_ml,
        width = centimetres(breast_width_mm(plan)),
        parts
    );
    let Some(practice) = practice else { return Some(takes) };
    let strains = tr!(
        "By the same model, in the same tissue, a round implant of {step:.0} ml less stretches the skin by {less:.0} %, of this volume by {same:.0} %, of {step:.0} ml more by {more:.0} %.",
        step = STEP_ML,
        less = 100.0 * practice.less,
        same = 100.0 * practice.same,
        more = 100.0 * practice.more
    );
    Some(format!("{takes} {strains}"))
}

/// Why a plan is not compared with practice.
fn why_not(reason: NoPractice) -> String {
    match reason {
        NoPractice::Model => {
            tr("Not compared with practice: that needs “Skin on solid layers”.").to_owned()
        }
        NoPractice::Width(least, most) => tr!(
            "Not compared with practice: its table has base widths of {least} to {most} cm.",
            least = centimetres(least),
            most = centimetres(most)
        ),
        NoPractice::Volume => {
            tr("Not compared with practice: its volumes have no answer in this tissue.").to_owned()
        }
    }
}

/// A correction, as "pull of the skin above 3 cm +30 ml".
fn correction(it: &Correction) -> String {
    let limit = match it.of {
        Corrected::Pull | Corrected::Fold => format!("{} cm", centimetres(it.limit)),
        Corrected::Fill => format!("{} %", format_at_most(it.limit, 0, 1)),
    };
    let bound = match it.bound {
        Bound::Below => tr("below"),
        Bound::Above => tr("above"),
    };
    format!("{} {bound} {limit} {:+.0} ml", tr(it.of.words()), it.volume_ml).replace('-', "−")
}

fn centimetres(mm: f64) -> String {
    format_at_most(0.1 * mm, 0, 2)
}

impl Practices {
    /// The volume that practice takes for a plan, as "Practice takes 300 ml"; empty for a plan that is not compared with practice.
    pub(crate) fn takes(&self, plan: &Scene) -> String {
        let volume = self.volume(plan).map(|volume| volume.volume_ml());
        volume.map_or_else(String::new, |volume| tr!("Practice takes {volume:.0} ml", volume))
    }

    /// The buttons of the table: open, save, back to the built-in one.
    pub(crate) fn table_buttons(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        if self.device == Device::Expander {
            return;
        }
        ui.horizontal_wrapped(|ui| {
            if ui.button(tr("Open practice table…")).on_hover_text(tr("A table (CSV) of your own rule; dropping the file does the same. Save the present one for its form")).clicked() {
                actions.push(Action::Run(Task::OpenTable));
            }
            if ui.button(tr("Save practice table")).clicked() {
                let content = self.table().to_csv().into_bytes();
                actions.push(Action::Save("practice-table.csv".to_owned(), content));
            }
            if !self.table().is_built_in() && ui.button(tr("Built-in practice table")).clicked() {
                self.set_table(PracticeTable::default());
            }
        });
    }
}
