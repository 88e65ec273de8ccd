//! The table "Measures before | after" of her body, or of the torso by a tape: on the screen and in the report.

use super::columns::{Cell, Columns, Line, cell};
use super::measured::Measured;
use crate::app::plan::side_in_a_word;
use crate::app::texts::{fixed, tr};
use crate::app::widgets::remark;
use crate::body::before_after::{NOT_COMPUTED, Row};
use crate::scene::Scene;
use crate::session::Session;
use eframe::egui::{self, RichText, Ui, vec2};

/// Title of the table.
pub(crate) const TITLE: &str = "Measures before | after";

/// Whose measures a table has.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Of {
    /// The plan.
    Plan,
    /// The plan and the pins on the same chest.
    Pins,
}

/// The table as texts.
pub(crate) struct Table {
    pub(crate) heads: Vec<String>,
    /// Name with its unit, what it means, and the cells.
    pub(crate) lines: Vec<(String, &'static str, Vec<String>)>,
    /// What is said below it.
    pub(crate) notes: Vec<String>,
}

/// A value with its decimals, or nothing.
fn value(row: &Row, value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| fixed(value, row.decimals))
}

/// What the operation adds, with its sign.
fn gain(row: &Row) -> String {
    let Some(gain) = row.gain else { return String::new() };
    let text = fixed(gain.abs(), row.decimals);
    let is_zero = !text.contains(|c: char| ('1'..='9').contains(&c));
    match gain {
        _ if is_zero => text,
        more if more > 0.0 => format!("+{text}"),
        _ => format!("−{text}"),
    }
}

/// Has the plan her body?
pub(crate) fn has_body(session: &Session) -> bool {
    let placement = session.scene().placement.as_ref();
    placement.is_some_and(|placement| placement.surface.is_some())
}

/// Is there a body to measure: hers, or the torso that a tape has shaped?
pub(crate) fn has_measures(session: &Session) -> bool {
    has_body(session) || session.scene().torso.is_some()
}

/// The table of a session; `None` without a body or a result.
pub(crate) fn table(measured: &Measured, session: &Session, of: Of) -> Option<Table> {
    let rows = measured.of_plan(session)?;
    let names = ["before", "after", "gain"].map(tr);
    let mut heads = names.map(str::to_owned).to_vec();
    let other = session.other_side().zip(measured.of_other_side(session));
    if let Some((other, _)) = &other {
        let named = |scene: &Scene| names.map(|head| format!("{}: {head}", side_in_a_word(scene)));
        heads = [session.scene(), other.scene()].map(named).concat();
    }
    let pins = session.pins().iter().filter(|_| of == Of::Pins);
    let pins = pins.filter_map(|pin| Some((pin.letter(), measured.of_pin(session, pin)?)));
    let pins: Vec<_> = pins.collect();
    heads.extend(pins.iter().map(|(letter, _)| letter.to_string()));
    let line = |(k, row): (usize, &Row)| {
        let three = |row: &Row| [value(row, row.before), value(row, row.after), gain(row)];
        let mut cells = three(row).to_vec();
        cells.extend(other.iter().filter_map(|(_, rows)| rows.get(k)).flat_map(three));
        let of_pin = |row: &Row| match row.after {
            Some(_) => value(row, row.after),
            None => gain(row),
        };
        cells.extend(pins.iter().map(|(_, of)| of.get(k).map(of_pin).unwrap_or_default()));
        (format!("{}, {}", tr(row.name), row.unit), tr(row.about), cells)
    };
    let has_value = |(_, row): &(usize, &Row)| row.gain.is_some() || row.before.is_some();
    let lines = rows.iter().enumerate().filter(has_value).map(line).collect();
    let proposed = session.scene().placement.as_ref().map_or(0, |of| of.proposed_marks.len());
    let proposed = (proposed > 0).then(|| tr!(
        "{proposed} of the 12 marks were proposed by the program and nobody has checked them: lengths from these, and what differs between the sides, may be off by 10 mm and more.",
        proposed
    ));
    let torso = session.scene().torso.map(|_| {
        tr("On the torso shaped by the tape, both breasts alike before: no scan of this patient.")
            .to_owned()
    });
    let notes = proposed.into_iter().chain(torso).chain([tr(NOT_COMPUTED).to_owned()]).collect();
    Some(Table { heads, lines, notes })
}

/// Shows a table, and what is to be said of it.
pub(crate) fn show(ui: &mut Ui, table: Table, id: &str) {
    let heads: Vec<(String, String)> =
        table.heads.into_iter().map(|head| (head, String::new())).collect();
    let line = |(name, about, cells): (String, &'static str, Vec<String>)| Line {
        name,
        about,
        cells: cells.into_iter().map(|text| Cell { text, ..Cell::default() }).collect(),
        is_first: true,
    };
    let lines: Vec<Line> = table.lines.into_iter().map(line).collect();
    let columns = Columns::fitting(ui, &heads, &lines);
    egui::ScrollArea::horizontal().id_salt(id).show(ui, |ui| {
        ui.spacing_mut().item_spacing = vec2(columns.space, 3.0);
        columns.row(ui, ["", ""], heads.iter(), |ui, (head, _)| {
            ui.add(egui::Label::new(RichText::new(head).small().strong()).extend());
        });
        for line in &lines {
            columns.row(ui, [&line.name, line.about], line.cells.iter(), cell);
        }
    });
    for note in &table.notes {
        remark(ui, note);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answer::measured::tests::solved;
    use crate::session::Command;

    #[test]
    fn a_gain_has_a_sign_and_no_zero_has_one() {
        let row = |gain: Option<f64>, decimals| Row {
            name: "",
            unit: "cm",
            decimals,
            before: None,
            after: None,
            gain,
            about: "",
        };
        for (value, decimals, text) in
            [(0.94, 1, "+0.9"), (-5.2, 0, "−5"), (-0.04, 1, "0.0"), (0.0, 0, "0")]
        {
            assert_eq!(gain(&row(Some(value), decimals)), text);
        }
        assert_eq!(gain(&row(None, 1)), "");
    }

    #[test]
    fn a_table_has_the_plan_and_the_pins_on_its_chest() {
        let (mut session, measured) = (solved(), Measured::default());
        session.apply(Command::Pin).unwrap();
        let plan = table(&measured, &session, Of::Plan).unwrap();
        assert_eq!(plan.heads, ["before", "after", "gain"]);
        assert_eq!(plan.lines.len(), 17);
        let pins = table(&measured, &session, Of::Pins).unwrap();
        assert_eq!(pins.heads, ["before", "after", "gain", "A"]);
        for (name, about, cells) in &pins.lines {
            assert!(!about.is_empty() && cells.len() == 4, "{name}");
            let of_pin = if cells[1].is_empty() { &cells[2] } else { &cells[1] };
            assert!(!of_pin.is_empty() && &cells[3] == of_pin, "{name}");
        }
        let (_, _, notch) = &plan.lines[0];
        let [before, after, gain] = [0, 1, 2].map(|k| notch[k].parse::<f64>().unwrap());
        assert!((after - before - gain).abs() < 0.11 && gain > 0.0, "{notch:?}");
        assert_eq!(plan.lines[0].0, "Notch to nipple, cm");
        assert_eq!(plan.notes, [NOT_COMPUTED]);
        let mut scene = session.scene().clone();
        scene.placement.as_mut().unwrap().proposed_marks = vec!["navel".to_owned()];
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 1 }).unwrap();
        let plan = table(&measured, &session, Of::Plan).unwrap();
        assert!(plan.notes[0].starts_with("1 of the 12 marks were proposed"), "{:?}", plan.notes);
    }
}
