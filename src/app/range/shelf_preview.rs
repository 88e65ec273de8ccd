//! A table of sizes before it is taken: what its columns are read as, and which rows are left out.

use crate::app::plan::device::Device;
use crate::app::texts::{shown, tr};
use crate::app::widgets::theme;
use crate::app::widgets::{list, remark, set_accessible_name};
use crate::clinical::{Column, Draft, LengthUnit, Reading, Shelf, ShelfSize, UnitOrigin};
use eframe::egui::{self, RichText, Ui};

/// What the sizes are beside an expander.
pub(super) const AS_EXPANDERS: &str =
    "The plan is an expander: the sizes are compared as expanders.";
/// Greatest height of the list of columns, and of the rows that are left out \[points\].
const COLUMNS_HEIGHT: f32 = 240.0;
const SKIPPED_HEIGHT: f32 = 120.0;
/// Width of the window \[points\].
const WIDTH: f32 = 470.0;
/// Most sizes whose shape is remarked.
const MOST_NOTES: usize = 20;

/// A table that is being looked at.
pub(super) struct Preview {
    /// Name of the file.
    pub(super) name: String,
    draft: Draft,
    reading: Reading,
}

/// What a user decided.
pub(super) enum Decision {
    /// In place of the sizes in stock.
    Take(Shelf),
    /// Beside them.
    Add(Shelf),
    Cancel,
}

impl Preview {
    pub(super) fn new(name: &str, draft: Draft) -> Self {
        let reading = draft.read();
        Self { name: name.to_owned(), draft, reading }
    }

    /// Shows the window; returns the decision once. `in_stock`: number of sizes that are there already.
    pub(super) fn show(&mut self, ctx: &egui::Context, in_stock: usize) -> Option<Decision> {
        let (mut is_open, mut decision) = (true, None);
        let title = tr!("Table of sizes: {name}", name = self.name);
        egui::Window::new(title)
            .id(egui::Id::unique("preview of a table"))
            .open(&mut is_open)
            .collapsible(false)
            .resizable(false)
            .anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO)
            .show(ctx, |ui| {
                ui.set_width(WIDTH.min(ui.ctx().content_rect().width() - 4.0 * theme::SPACE));
                decision = self.content(ui, in_stock);
            });
        let is_left = !is_open || ctx.input(|input| input.key_pressed(egui::Key::Escape));
        decision.or_else(|| is_left.then_some(Decision::Cancel))
    }

    fn content(&mut self, ui: &mut Ui, in_stock: usize) -> Option<Decision> {
        let count = self.reading.shelf.sizes().len();
        let (rows, skipped) = (count + self.reading.skipped_rows, self.reading.skipped_rows);
        ui.label(tr!("{rows} rows, {skipped} skipped. Columns are read as:", rows, skipped));
        let scroll = egui::ScrollArea::vertical().max_height(COLUMNS_HEIGHT);
        if scroll.id_salt("columns").show(ui, |ui| columns(ui, &mut self.draft)).inner {
            self.reading = self.draft.read();
        }
        let is_ignored = |column: Column| column == Column::Ignored;
        let ignored = self.draft.columns().iter().enumerate().filter(|(_, c)| is_ignored(c.column));
        let ignored: Vec<String> = ignored.map(|(k, column)| title_of(k, &column.title)).collect();
        if !ignored.is_empty() {
            remark(ui, tr!("Ignored: {names}.", names = ignored.join(", ")));
        }
        if let Some(missing) = self.draft.missing() {
            let color = ui.visuals().warn_fg_color;
            ui.label(RichText::new(format!("{}.", shown(missing))).color(color));
        }
        self.skipped(ui);
        if Device::of(ui.ctx()) == Device::Expander {
            remark(ui, tr(AS_EXPANDERS));
        }
        ui.add_space(theme::SPACE_SMALL);
        let mut decision = None;
        ui.horizontal(|ui| {
            let is_ready = count > 0 && self.draft.missing().is_none();
            let words = match (count, in_stock) {
                (1, 0) => tr("Take 1 size").to_owned(),
                (_, 0) => tr!("Take {count} sizes", count),
                (1, _) => tr("Add 1 size").to_owned(),
                _ => tr!("Add {count} sizes", count),
            };
            let mut button = |words| ui.add_enabled(is_ready, egui::Button::new(words)).clicked();
            let (is_first, is_replaced) =
                (button(words), in_stock > 0 && button(replaced(in_stock)));
            if is_first || is_replaced {
                let shelf = std::mem::take(&mut self.reading.shelf);
                let adds = is_first && in_stock > 0;
                decision = Some(if adds { Decision::Add(shelf) } else { Decision::Take(shelf) });
            }
            if ui.button(tr("Cancel")).clicked() {
                decision = Some(Decision::Cancel);
            }
        });
        decision
    }

    /// The rows that are left out, and the sizes of which no dome has all numbers.
    fn skipped(&self, ui: &mut Ui) {
        let Reading { shelf, skipped, skipped_rows } = &self.reading;
        let rows: Vec<String> = skipped
            .iter()
            .map(|row| tr!("line {line}: {error}", line = row.line, error = shown(&row.reason)))
            .collect();
        fold(ui, tr!("Skipped rows: {count}", count = skipped_rows), *skipped_rows, &rows);
        let note = |size: &ShelfSize| Some(format!("{}: {}", size.name(), shown(&size.note()?)));
        let notes: Vec<String> = shelf.sizes().iter().filter_map(note).collect();
        let title =
            tr!("Sizes whose volume no shape of the model has: {count}", count = notes.len());
        fold(ui, title, notes.len(), &notes[..notes.len().min(MOST_NOTES)]);
    }
}

/// The button that replaces the sizes in stock.
fn replaced(in_stock: usize) -> String {
    match in_stock {
        1 => tr("Replace the size in stock").to_owned(),
        count => tr!("Replace the {count} in stock", count),
    }
}

/// A fold of lines, and the number of further ones; nothing without lines.
fn fold(ui: &mut Ui, title: String, count: usize, lines: &[String]) {
    if count == 0 {
        return;
    }
    egui::CollapsingHeader::new(&title).id_salt(lines.first()).default_open(count < 6).show(
        ui,
        |ui| {
            let scroll = egui::ScrollArea::vertical().max_height(SKIPPED_HEIGHT).id_salt(&title);
            scroll.show(ui, |ui| {
                for line in lines {
                    remark(ui, line.as_str());
                }
                if count > lines.len() {
                    remark(ui, tr!("and {more} more", more = count - lines.len()));
                }
            });
        },
    );
}

/// The columns with their menus; returns whether something was chosen.
fn columns(ui: &mut Ui, draft: &mut Draft) -> bool {
    let mut contents = None;
    let mut units = None;
    egui::Grid::new("columns of a table").num_columns(3).spacing([14.0, 3.0]).show(ui, |ui| {
        for (k, column) in draft.columns().iter().enumerate() {
            let title = title_of(k, &column.title);
            ui.vertical(|ui| {
                ui.set_max_width(0.45 * WIDTH);
                ui.add(egui::Label::new(RichText::new(&title).strong()).truncate());
                ui.add(egui::Label::new(RichText::new(&column.sample).small().weak()).truncate());
            });
            let menu = list(ui, ("content", k)).width(110.0);
            let menu = menu.selected_text(tr(column.column.word())).show_ui(ui, |ui| {
                for content in Column::ALL {
                    let is_chosen = content == column.column;
                    if ui.selectable_label(is_chosen, tr(content.word())).clicked() {
                        contents = Some((k, content));
                    }
                }
            });
            set_accessible_name(&menu.response, egui::Role::ComboBox, &tr!("{title} is", title));
            unit(ui, (k, &title), column, &mut units);
            ui.end_row();
        }
    });
    if let Some((k, content)) = contents {
        draft.choose(k, content);
    }
    if let Some((k, unit)) = units {
        draft.choose_unit(k, unit);
    }
    contents.is_some() || units.is_some()
}

/// The unit of a column: a menu where it was guessed.
fn unit(
    ui: &mut Ui,
    (k, title): (usize, &str),
    column: &crate::clinical::DraftColumn,
    chosen: &mut Option<(usize, LengthUnit)>,
) {
    let word = match column.column {
        content if content.is_length() => column.unit.word(),
        Column::Volume => "cc",
        _ => "",
    };
    if !(column.column.is_length() && column.origin == UnitOrigin::Guessed) {
        ui.label(word);
        return;
    }
    let menu = list(ui, ("unit", k)).width(60.0).selected_text(word);
    let menu = menu.show_ui(ui, |ui| {
        for unit in [LengthUnit::Cm, LengthUnit::Mm] {
            if ui.selectable_label(unit == column.unit, unit.word()).clicked() {
                *chosen = Some((k, unit));
            }
        }
    });
    set_accessible_name(&menu.response, egui::Role::ComboBox, &tr!("Unit of {title}", title));
    menu.response.on_hover_text(tr("No unit is named; it follows from the size of the numbers."));
}

/// The name of a column, or its number.
fn title_of(index: usize, title: &str) -> String {
    if title.is_empty() { tr!("column {number}", number = index + 1) } else { title.to_owned() }
}
