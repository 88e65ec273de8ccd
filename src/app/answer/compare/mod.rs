//! Compare: pins, the table of their results, silhouettes over each other, pictures side by side.
//!
//! [`section`] shows pins and table in a panel and returns a command; [`silhouettes`] draws in the plot of the
//! cross-section; `viewport::panes` draws the pictures. `keep` passes plan and pins to the platform, which
//! stores them.
//!
//! Uses `details`, `theme`, `widgets`. Used by `ui`, `plots`.

mod keep;
mod table;

pub(crate) use keep::{DELAY, Keep, KeptPlan, is_due};
pub(crate) use table::rows;

use super::before_after;
use super::measured::Measured;
use super::practice::Practices;
use crate::app::texts::tr;
use crate::app::widgets::theme::{self, Palette};
use crate::app::widgets::{
    button_if, characters_left, field_frame, group, remark, set_accessible_name,
};
use crate::measure::Status;
use crate::scene::{Letter, Scene};
use crate::session::{Command, Pin, Session};
use crate::study::Samples;
use eframe::egui::{self, Color32, RichText, Ui};
use egui_plot::{Line, LineStyle, PlotPoint, PlotUi, Text};

/// Greatest length of a name \[characters\]; at most 4 bytes each.
const NAME_LENGTH: usize = 25;

/// Distance of a letter from its silhouette \[mm\].
const LETTER_LIFT_MM: f64 = 5.0;

/// The choices of the comparison.
#[derive(Debug, Default)]
pub(crate) struct Compare {
    pictures: Pictures,
    /// Does the table contain differences beside the pins' values?
    has_differences: bool,
    /// The name being typed, with its pin.
    name: Option<(Letter, String)>,
}

/// Where the pictures contain the pins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Pictures {
    /// The skin of the pins is drawn over the picture and the cross-section.
    #[default]
    Overlay,
    /// The pictures of the pins are beside the picture.
    SideBySide,
    /// Nowhere.
    PlanOnly,
}

impl Compare {
    /// Are pictures of pins to be shown beside the picture?
    pub(crate) fn is_side_by_side(&self, session: &Session) -> bool {
        self.pictures == Pictures::SideBySide && session.pins().iter().any(Pin::has_shape)
    }
}

/// Shows pins, choices and the table of results with the bands of the `sampled` scenes; returns a command of the user.
pub(crate) fn section<'a>(
    ui: &mut Ui,
    (session, measured): (&Session, &Measured),
    compare: &mut Compare,
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
    practices: &Practices,
) -> Option<Command> {
    let mut command = None;
    group(ui, tr("Compare"), |ui| {
        command = pin_button(ui, session);
        if session.pins().is_empty() {
            let hint = tr("A pin keeps this plan with its result, to compare other plans with it.");
            remark(ui, hint);
            if session.other_side().is_none() {
                return;
            }
        }
        for pin in session.pins() {
            command = pin_row(ui, pin, session, compare).or(command.take());
        }
        if !session.pins().is_empty() {
            choices(ui, compare);
        }
        table::show(ui, session, compare.has_differences, sampled, practices);
        if !before_after::has_measures(session) {
            return;
        }
        let fold = egui::CollapsingHeader::new(tr(before_after::TITLE)).id_salt("measures of pins");
        fold.show_unindented(ui, |ui| {
            match before_after::table(measured, session, before_after::Of::Pins) {
                Some(table) => before_after::show(ui, table, "measures of pins"),
                None => drop(ui.weak(tr("No numbers yet."))),
            }
        });
    });
    command
}

/// The choices of the comparison with pins.
fn choices(ui: &mut Ui, compare: &mut Compare) {
    ui.horizontal_wrapped(|ui| {
        ui.label(tr("Pictures:"));
        let choices = [
            (
                Pictures::Overlay,
                tr("Overlay"),
                tr("Draw the skin of the pins over the picture and the cross-section"),
            ),
            (
                Pictures::SideBySide,
                tr("Side by side"),
                tr("Show the pins beside the picture, with one camera"),
            ),
            (Pictures::PlanOnly, tr("Off"), tr("Show no pin in the pictures")),
        ];
        for (pictures, name, tip) in choices {
            let is_present = compare.pictures == pictures;
            if ui.radio(is_present, name).on_hover_text(tip).clicked() {
                compare.pictures = pictures;
            }
        }
    });
    ui.checkbox(&mut compare.has_differences, tr("Differences in the table"))
        .on_hover_text(tr("Show this plan minus pin beside the pin's values"));
}

fn pin_button(ui: &mut Ui, session: &Session) -> Option<Command> {
    let Some(letter) = session.free_letter() else {
        ui.weak(tr("All four pins are in use. Remove a pin to pin this plan."));
        return None;
    };
    let tip = tr("Keep this plan and its result for comparison");
    let button = ui.button(tr!("Pin as {letter}", letter)).on_hover_text(tip);
    button.clicked().then_some(Command::Pin)
}

/// Shows the letter, name and buttons of a pin.
fn pin_row(ui: &mut Ui, pin: &Pin, session: &Session, compare: &mut Compare) -> Option<Command> {
    let letter = pin.letter();
    let mut command = None;
    ui.horizontal(|ui| {
        let style = Style::of(letter, theme::palette(ui.visuals()));
        ui.label(RichText::new(letter.to_string()).strong().color(style.color));
        command = name_field(ui, pin, compare);
        let is_present = session.scene().is_same_plan(pin.scene());
        let tip = tr("Open this pin in place of this plan; Undo brings this plan back");
        if button_if(ui, !is_present, tr("Open"), &tr!("Open {letter}", letter), tip) {
            command = Some(Command::OpenPin(letter));
        }
        let remove = ui.button("×");
        set_accessible_name(&remove, egui::Role::Button, &tr!("Remove {letter}", letter));
        if remove.on_hover_text(tr("Remove this pin")).clicked() {
            command = Some(Command::Unpin(letter));
        }
    });
    let note = match pin.outcome().map(|outcome| outcome.status) {
        None => tr("is being computed"),
        Some(Status::Converged) => return command,
        Some(Status::NotConverged) => tr("is not finished: no numbers"),
        Some(Status::Unstable) => tr("has no answer"),
    };
    remark(ui, format!("{letter} {note}"));
    command
}

/// Field for the name of a pin; the name is accepted when the field loses the focus, Esc restores the name.
fn name_field(ui: &mut Ui, pin: &Pin, compare: &mut Compare) -> Option<Command> {
    let letter = pin.letter();
    let typed = compare.name.take_if(|(of, _)| *of == letter);
    let mut text = typed.map_or_else(|| pin.name().to_owned(), |(_, text)| text);
    let field = egui::TextEdit::singleline(&mut text)
        .id_salt(("name of a pin", letter))
        .char_limit(NAME_LENGTH)
        .frame(field_frame(ui))
        .hint_text(match pin.scene().implant_reference.as_str() {
            "" => tr("name"),
            reference => reference,
        })
        .desired_width((ui.available_width() - 110.0).clamp(60.0, 180.0));
    let response = ui.add(field);
    response.widget_info(|| egui::WidgetInfo {
        label: Some(tr!("Name of {letter}", letter)),
        ..egui::WidgetInfo::text_edit(true, "", &text, tr("name"))
    });
    characters_left(&response, &text, NAME_LENGTH);
    if response.lost_focus() {
        let is_accepted = !ui.input(|input| input.key_pressed(egui::Key::Escape));
        return (is_accepted && text != pin.name()).then_some(Command::Rename(letter, text));
    }
    if response.has_focus() {
        compare.name = Some((letter, text));
    }
    None
}

/// Line style and colour of a pin: the lines differ without colours too.
struct Style {
    line: LineStyle,
    color: Color32,
}

impl Style {
    fn of(letter: Letter, palette: &Palette) -> Self {
        let (line, color) = match letter {
            Letter::A => (LineStyle::dashed_loose(), palette.curves[2]),
            Letter::B => (LineStyle::dotted_dense(), palette.curves[3]),
            Letter::C => (LineStyle::dashed_dense(), palette.text),
            Letter::D => (LineStyle::dotted_loose(), palette.text),
        };
        Self { line, color }
    }
}

/// Draws the outer skin of the pins into the plot of the cross-section, each with its letter.
pub(crate) fn silhouettes(plot: &mut PlotUi<'_>, lines: Vec<Silhouette>, palette: &Palette) {
    for Silhouette { letter, points } in lines {
        let (Style { line, color }, at) = (Style::of(letter, palette), place_of(letter));
        let place = points.get((at * points.len() as f64) as usize).copied().unwrap_or_default();
        let name = letter.to_string();
        plot.line(Line::new(name.clone(), points).color(color).width(1.5).style(line));
        let text = RichText::new(name.clone()).strong().color(color);
        plot.text(Text::new(name, PlotPoint::new(place[0], place[1] + LETTER_LIFT_MM), text));
    }
}

/// Place of a pin's letter along its line \[-\].
pub(crate) fn place_of(letter: Letter) -> f64 {
    match letter {
        Letter::A => 0.5,
        Letter::B => 0.42,
        Letter::C => 0.58,
        Letter::D => 0.35,
    }
}

/// Length of the dashes of a pin's line and of the gaps between them \[points\]: in print and for some eyes the colours are alike.
pub(crate) fn dashes_of(letter: Letter) -> (f32, f32) {
    match letter {
        Letter::A => (7.0, 4.0),
        Letter::B => (2.0, 4.0),
        Letter::C => (13.0, 3.0),
        Letter::D => (2.0, 8.0),
    }
}

/// Colour of a pin's line, and length of its dashes and of the gaps between them \[points\].
pub(crate) fn stroke_of(letter: Letter, palette: &Palette) -> (Color32, f32, f32) {
    let (dash, gap) = dashes_of(letter);
    (Style::of(letter, palette).color, dash, gap)
}

/// The outer skin of a pin in the cross-section.
pub(crate) struct Silhouette {
    pub(crate) letter: Letter,
    /// Points (x, z) \[mm\].
    pub(crate) points: Vec<[f64; 2]>,
}

/// The pins whose silhouettes are drawn, with their colours.
pub(crate) fn drawn_pins<'a>(
    session: &'a Session,
    compare: &Compare,
    palette: &'a Palette,
) -> impl Iterator<Item = (&'a Pin, Color32)> {
    let is_drawn = compare.pictures != Pictures::PlanOnly;
    let pins = session.pins().iter().filter(move |pin| is_drawn && pin.has_shape());
    pins.map(|pin| (pin, Style::of(pin.letter(), palette).color))
}
