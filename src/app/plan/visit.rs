//! Patient and visit in words, for the plan's file and the report: the patient's number, side, date, surgeon, remarks.

use super::date::read_date;
use super::field::{Field, Values};
use super::side::OWN;
use super::{Hand, chip, named, side};
use crate::app::frame::files;
use crate::app::texts::{shown, tr};
use crate::app::widgets::theme::{self, SPACE};
use crate::app::widgets::{characters_left, field_frame, kept_lines, rejection_label, remark};
use crate::scene::visit::{MAX_REFERENCE, MAX_REMARK_LINES, MAX_REMARKS, MAX_SURGEON};
use crate::scene::{FillSchedule, Scene, Side, Visit};
use eframe::egui::{self, Id, Response, RichText, TextEdit, Ui, vec2};

/// The name of the fold.
const FOR_FILE: &str = "For the file";
/// The choice of no side, and the name of the date.
const NOT_SAID: &str = "not said";
const DATE_NAME: &str = "Date of the visit";
/// A date as it may be typed, in words.
const DATE: &str = "25.11.2026 or 25/11/2026 (day first), or 2026-11-25";
/// Greatest number of characters of a date while it is typed.
const MAX_DATE: usize = 20;

const KEPT: &str = "These entries stay in this plan's file and in the report. Patient number and side also stand on the saved picture, the number in \
                    the saved fill steps, number and date in the names of the files. A link or a pin has the side alone; the next start has none of them. Nothing is sent.";

/// Memory key of the switch.
fn key() -> Id {
    Id::unique("for the file")
}

fn is_open(ui: &Ui) -> bool {
    ui.data(|data| data.get_temp(key())).unwrap_or_default()
}

/// The patient's number, if the scene states it.
pub(crate) fn patient_number(scene: &Scene) -> Option<&str> {
    let number = scene.visit.as_ref().map(|visit| visit.reference.trim());
    number.filter(|number| !number.is_empty())
}

/// What a report needs and the scene does not state, patient's number and side, in words.
pub(crate) fn missing_for_file(scene: &Scene) -> Option<&'static str> {
    match (patient_number(scene).is_some(), scene.side) {
        (false, None) => Some(tr("No patient number and no side in it")),
        (false, Some(_)) => Some(tr("No patient number in it")),
        (true, None) => Some(tr("No side in it")),
        (true, Some(_)) => None,
    }
}

/// The switch that shows the fields, off at first.
pub(super) fn switch(ui: &mut Ui, hand: Hand) {
    let is_open = is_open(ui);
    let height = match hand {
        Hand::Mouse => 24.0,
        Hand::Finger => theme::TOUCH - 8.0,
    };
    let switch = egui::Button::selectable(is_open, tr(FOR_FILE))
        .frame(true)
        .frame_when_inactive(true)
        .min_size(vec2(0.0, height));
    let tooltip = tr(
        "Patient's number, date of the visit, surgeon, remarks: for the plan's file and the report",
    );
    if ui.add(switch).on_hover_text(tooltip).clicked() {
        ui.data_mut(|data| data.insert_temp(key(), !is_open));
    }
}

/// Shows the fields while the switch is on. Returns the text field with the focus.
pub(super) fn visit(ui: &mut Ui, scene: &mut Scene, hand: Hand) -> Option<Id> {
    if !is_open(ui) {
        return None;
    }
    let mut now = scene.visit.clone().unwrap_or_default();
    let focused = fields(ui, &mut now, hand);
    set_visit(scene, now);
    focused
}

/// Replaces the visit; an equal one leaves the scene as it is.
pub(crate) fn set_visit(scene: &mut Scene, now: Visit) {
    if now == scene.visit.clone().unwrap_or_default() {
        return;
    }
    scene.visit = (!now.is_empty()).then_some(now);
}

/// Sets the schedule of the fills; that of the defaults is not stated.
pub(crate) fn set_fill_steps(scene: &mut Scene, steps: FillSchedule) {
    let mut now = scene.visit.clone().unwrap_or_default();
    now.fill_steps = (steps != FillSchedule::default()).then_some(steps);
    set_visit(scene, now);
}

/// The visit as fields of the form.
pub(super) fn form_fields(scene: &Scene) -> [Field; 5] {
    let visit = scene.visit.clone().unwrap_or_default();
    let text = |characters, lines| Values::Text { characters, lines };
    let side = scene.side.map_or(NOT_SAID, Side::word).to_owned();
    let others = [OWN.0, NOT_SAID];
    let choices: Vec<&str> = Side::ALL.map(Side::word).into_iter().chain(others).collect();
    let words = choices.iter().map(|word| tr(word)).collect();
    [
        ("reference", tr("Patient no."), visit.reference, text(MAX_REFERENCE, 1)),
        ("side", tr("Side"), side, Values::Words { choices, words }),
        ("date", tr(DATE_NAME), visit.date, text(MAX_DATE, 1)),
        ("surgeon", tr("Surgeon"), visit.surgeon, text(MAX_SURGEON, 1)),
        ("remarks", tr("Remarks"), visit.remarks, text(MAX_REMARKS, MAX_REMARK_LINES)),
    ]
    .map(|(name, label, text, values)| Field {
        name,
        label,
        unit: "",
        text,
        hint: tr(KEPT).to_owned(),
        range: match values {
            Values::Text { characters, .. } => tr!("up to {characters} characters", characters),
            Values::Numbers { .. } | Values::Words { .. } => String::new(),
        },
        values,
    })
}

/// Sets a field of the form; `None`: the visit has no such field.
///
/// # Errors
/// Returns one line with what is allowed; the visit is then unchanged.
pub(super) fn set_form_field(
    scene: &mut Scene,
    name: &str,
    text: &str,
) -> Option<Result<(), String>> {
    let mut now = scene.visit.clone().unwrap_or_default();
    let typed = |most: usize, lines: usize| -> String {
        cleaned(text.trim(), lines).chars().take(most).collect()
    };
    match name {
        "reference" => now.reference = typed(MAX_REFERENCE, 1),
        "side" => {
            if text.trim() == OWN.0 {
                return Some(scene.add_other_side().map_err(|error| shown(&error.to_string())));
            }
            let side = Side::ALL.into_iter().find(|side| side.word() == text.trim());
            if side.is_none() && text.trim() != NOT_SAID {
                let words = Side::ALL.map(Side::word).join(", ");
                return Some(Err(tr!(
                    "Side: allowed: {words}, {none}",
                    words,
                    none = [OWN.0, NOT_SAID].join(", ")
                )));
            }
            scene.set_side(side);
            return Some(Ok(()));
        }
        "date" => {
            let Some(date) = date_or_none(text) else {
                return Some(Err(tr!(
                    "{name}: {text} is no date; allowed: {allowed}",
                    name = tr(DATE_NAME),
                    text = format_args!("{:?}", text.trim()),
                    allowed = tr(DATE)
                )));
            };
            now.date = date;
        }
        "surgeon" => now.surgeon = typed(MAX_SURGEON, 1),
        "remarks" => now.remarks = typed(MAX_REMARKS, MAX_REMARK_LINES),
        _ => return None,
    }
    set_visit(scene, now);
    Some(Ok(()))
}

/// The date of a text; empty for an empty text, `None` for a text that is no date.
fn date_or_none(text: &str) -> Option<String> {
    if text.trim().is_empty() { Some(String::new()) } else { read_date(text) }
}

/// Reference and side in words; empty if none is stated.
pub(crate) fn patient_in_words(scene: &Scene) -> String {
    let reference = patient_number(scene).unwrap_or_default();
    let both = scene.other_side.as_ref().map(|_| Side::Both);
    let side = both.or(scene.side).map_or("", |side| tr(side.words()));
    joined([reference, side].map(str::to_owned))
}

/// The visit in one line, and the remarks; empty if nothing is stated.
pub(crate) fn visit_in_words(scene: &Scene) -> [String; 2] {
    let visit = scene.visit.clone().unwrap_or_default();
    let named = |name: &str, text: &str| {
        if text.is_empty() { String::new() } else { format!("{name} {text}") }
    };
    let date = named(tr("visit of"), &visit.date);
    let surgeon = named(tr("surgeon"), visit.surgeon.trim());
    let line = joined([patient_in_words(scene), date, surgeon]);
    [line, visit.remarks.trim().to_owned()]
}

fn joined<const N: usize>(parts: [String; N]) -> String {
    let stated: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    stated.join(" · ")
}

/// The entries of a report: patient's number, side and remarks, at the size of a finger or of a mouse. Returns the field of the number.
pub(crate) fn entries_of_report(
    ui: &mut Ui,
    visit: &mut Visit,
    (side, fixed): (&mut Option<Side>, Option<&str>),
    hand: Hand,
) -> Response {
    let number = number(ui, &mut visit.reference);
    side::side(ui, side, fixed, hand);
    remarks(ui, &mut visit.remarks);
    number
}

fn number(ui: &mut Ui, reference: &mut String) -> Response {
    line(ui, tr("Patient no."), tr("number or initials"), reference, MAX_REFERENCE)
}

fn fields(ui: &mut Ui, visit: &mut Visit, hand: Hand) -> Option<Id> {
    let mut focused = None;
    let mut note = |response: Response| {
        if response.has_focus() {
            focused = Some(response.id);
        }
    };
    note(number(ui, &mut visit.reference));
    note(date(ui, hand, &mut visit.date));
    note(line(ui, tr("Surgeon"), "", &mut visit.surgeon, MAX_SURGEON));
    note(remarks(ui, &mut visit.remarks));
    remark(ui, tr(KEPT));
    focused
}

fn line(ui: &mut Ui, name: &str, hint: &str, text: &mut String, most: usize) -> Response {
    named(ui, name, |ui| {
        let mut typed = text.clone();
        let field = TextEdit::singleline(&mut typed).hint_text(hint).char_limit(most);
        let response = add(ui, name, field, text);
        characters_left(&response, &typed, most);
        if response.changed() {
            *text = cleaned(&typed, 1);
        }
        response
    })
}

fn remarks(ui: &mut Ui, text: &mut String) -> Response {
    ui.label(RichText::new(tr("Remarks")).color(ui.visuals().weak_text_color()));
    let mut typed = text.clone();
    let field = TextEdit::multiline(&mut typed).desired_rows(3).char_limit(MAX_REMARKS);
    let response = add(ui, tr("Remarks"), field, text);
    ui.ctx().accesskit_node_builder(response.id, |node| {
        node.set_role(egui::accesskit::Role::MultilineTextInput);
    });
    characters_left(&response, &typed, MAX_REMARKS);
    if response.changed() {
        *text = cleaned(&typed, MAX_REMARK_LINES);
    }
    response
}

/// The date with a button for the present day; a text that is no date stays in the field, and the date of the plan stays unchanged. The
/// line below has the allowed forms or the reason, at the same height.
fn date(ui: &mut Ui, hand: Hand, date: &mut String) -> Response {
    let key = ui.make_persistent_id("date being typed");
    let kept = ui.data(|data| data.get_temp::<(String, String)>(key));
    // A draft belongs to the date of the plan while it was typed.
    let draft = kept.filter(|(of, _)| of == date).map(|(_, draft)| draft);
    let mut typed = draft.unwrap_or_else(|| date.clone());
    let mut is_today = false;
    let response = named(ui, tr("Date"), |ui| {
        let words = tr("Today");
        let font = egui::TextStyle::Button.resolve(ui.style());
        let button = ui.painter().layout_no_wrap(words.to_owned(), font, egui::Color32::WHITE);
        let rest = button.size().x + 2.0 * ui.spacing().button_padding.x + 2.0 * SPACE;
        let field =
            TextEdit::singleline(&mut typed).hint_text(tr("DD.MM.YYYY")).char_limit(MAX_DATE);
        let response = add_beside(ui, tr(DATE_NAME), field, date, rest);
        is_today =
            chip(ui, hand, false, words, tr("Sets the date of the visit to the present day"));
        response
    });
    let text = typed.trim();
    let read = date_or_none(text);
    let is_escaped = read.is_none() && ui.input(|input| input.key_pressed(egui::Key::Escape));
    if is_today {
        *date = files::today();
        ui.data_mut(|data| data.remove::<(String, String)>(key));
    } else if response.changed() {
        if let Some(read) = &read {
            date.clone_from(read);
        }
        ui.data_mut(|data| data.insert_temp(key, (date.clone(), typed.clone())));
    } else if is_escaped || (read.is_some() && !response.has_focus()) {
        ui.data_mut(|data| data.remove::<(String, String)>(key));
    }
    let reason = (read.is_none() && !response.has_focus()).then(|| {
        tr!("{text} is no date: {allowed}", text = format_args!("{text:?}"), allowed = tr(DATE))
    });
    kept_lines(ui, 2, |ui| {
        ui.style_mut().override_font_id = Some(egui::TextStyle::Small.resolve(ui.style()));
        match &reason {
            Some(reason) => rejection_label(ui, reason),
            None => drop(remark(ui, tr(DATE))),
        }
    });
    response
}

/// Adds a text field of the free width with its name for screen readers.
fn add(ui: &mut Ui, name: &str, field: TextEdit<'_>, text: &str) -> Response {
    add_beside(ui, name, field, text, 0.0)
}

/// Adds a text field that leaves a width free \[points\].
fn add_beside(ui: &mut Ui, name: &str, field: TextEdit<'_>, text: &str, rest: f32) -> Response {
    let width = (ui.available_width() - SPACE - rest).max(40.0);
    let response = ui.add(field.id_salt(name).frame(field_frame(ui)).desired_width(width));
    response.widget_info(|| egui::WidgetInfo {
        label: Some(name.to_owned()),
        ..egui::WidgetInfo::text_edit(true, "", text, "")
    });
    response
}

/// A text without control characters and with so many lines; further lines follow in the last one.
fn cleaned(text: &str, most_lines: usize) -> String {
    let mut lines = 1;
    let clean = |c: char| match c {
        '\n' if lines < most_lines => {
            lines += 1;
            c
        }
        c if c.is_control() => ' ',
        c => c,
    };
    text.chars().map(clean).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cleaned_text_is_allowed_and_as_long_as_before() {
        assert_eq!(cleaned("a\tb\u{7}c\nd", 1), "a b c d");
        let text = "x\n".repeat(20);
        let clean = cleaned(&text, MAX_REMARK_LINES);
        assert_eq!((clean.split('\n').count(), clean.len()), (MAX_REMARK_LINES, text.len()));
    }

    #[test]
    fn a_visit_in_words_names_what_is_stated() {
        let mut scene = Scene::opening();
        assert_eq!(visit_in_words(&scene), ["", ""]);
        scene.visit = Some(Visit {
            reference: "K. M.".to_owned(),
            date: "2026-01-31".to_owned(),
            surgeon: "Dr A".to_owned(),
            remarks: "one\ntwo\n".to_owned(),
            fill_steps: None,
        });
        scene.side = Some(Side::Left);
        let [line, remarks] = visit_in_words(&scene);
        assert_eq!(line, "K. M. · left side · visit of 2026-01-31 · surgeon Dr A");
        assert_eq!(remarks, "one\ntwo");
        assert_eq!(patient_in_words(&scene), "K. M. · left side");
        (scene.side, scene.visit) = (Some(Side::Both), None);
        assert_eq!(visit_in_words(&scene), ["both sides", ""]);
    }
}
