//! Lines of cells in columns as wide as their texts.

use crate::app::texts::tr;
use eframe::egui::{self, RichText, TextStyle, Ui, vec2};

/// A row of the table as texts.
pub(super) struct Line {
    pub(super) name: String,
    /// What the name means, in the present language; empty for a plain one.
    pub(super) about: &'static str,
    pub(super) cells: Vec<Cell>,
    /// Is the row in sight without unfolding?
    pub(super) is_first: bool,
}

/// A number or a word, with the word and the band of a result.
#[derive(Default)]
pub(super) struct Cell {
    pub(super) text: String,
    pub(super) word: Option<&'static str>,
    pub(super) band: Option<String>,
}

/// Widths of the columns \[points\]: those of the widest text. A grid would keep the widths of its previous frame.
pub(super) struct Columns {
    /// Width of the names; 0: the names stand in lines of their own above the numbers.
    name: f32,
    cells: Vec<f32>,
    /// Space between two columns.
    pub(super) space: f32,
}

impl Columns {
    /// Greatest and least space between two columns \[points\].
    const SPACE: (f32, f32) = (12.0, 6.0);

    pub(super) fn fitting(ui: &Ui, heads: &[(String, String)], lines: &[Line]) -> Self {
        let width = |style: TextStyle, text: &str| {
            let (font, color) = (style.resolve(ui.style()), ui.visuals().text_color());
            ui.painter().layout_no_wrap(text.to_owned(), font, color).size().x.ceil()
        };
        let name = |line: &Line| width(TextStyle::Small, &line.name);
        let cell = |cell: &Cell| {
            let band = cell.band.as_ref().map_or(0.0, |band| width(TextStyle::Small, band));
            width(TextStyle::Monospace, &cell.text).max(band)
        };
        let column = |(k, head): (usize, &(String, String))| {
            let cells = lines.iter().filter_map(|line| line.cells.get(k)).map(cell);
            cells.fold(width(TextStyle::Body, &head.0), f32::max)
        };
        let cells: Vec<f32> = heads.iter().enumerate().map(column).collect();
        let name = lines.iter().map(name).fold(0.0, f32::max);
        let room = |name: f32| {
            let gaps = cells.len() as f32 - if name > 0.0 { 0.0 } else { 1.0 };
            (ui.available_width() - name - cells.iter().sum::<f32>()) / gaps.max(1.0)
        };
        let (least, most) = (Self::SPACE.1, Self::SPACE.0);
        let name = if room(name) < least { 0.0 } else { name };
        Self { name, space: room(name).min(most).max(least), cells }
    }

    /// Shows a row: the name with what it means on the line of the numbers, the cells aligned to the right.
    pub(super) fn row<T>(
        &self,
        ui: &mut Ui,
        [name, about]: [&str; 2],
        cells: impl Iterator<Item = T>,
        show: impl Fn(&mut Ui, T),
    ) {
        let height = ui.text_style_height(&TextStyle::Monospace);
        let label = |ui: &mut Ui| {
            if !name.is_empty() {
                let name = ui.add(egui::Label::new(RichText::new(name).small()).extend());
                if !about.is_empty() {
                    name.on_hover_text(about);
                }
            }
        };
        if self.name <= 0.0 {
            label(ui);
        }
        ui.horizontal_top(|ui| {
            if self.name > 0.0 {
                let left = egui::Layout::left_to_right(egui::Align::Center);
                ui.allocate_ui_with_layout(vec2(self.name, height), left, |ui| {
                    ui.set_min_size(vec2(self.name, height));
                    label(ui);
                });
            }
            for (width, of) in self.cells.iter().zip(cells) {
                let right = egui::Layout::top_down(egui::Align::Max);
                ui.allocate_ui_with_layout(vec2(*width, height), right, |ui| {
                    ui.set_min_width(*width);
                    ui.spacing_mut().item_spacing.y = 0.0;
                    show(ui, of);
                });
            }
        });
    }
}

/// Shows a value; below it its band, if the band is known.
pub(super) fn cell(ui: &mut Ui, cell: &Cell) {
    if cell.text.is_empty() {
        return;
    }
    let response = ui.add(egui::Label::new(RichText::new(&cell.text).monospace()).extend());
    if let Some(word) = cell.word {
        response.on_hover_text(word);
    }
    if let Some(band) = &cell.band {
        ui.add(egui::Label::new(RichText::new(band).small()).extend()).on_hover_text(tr(
            "10th to 90th percentile of the sampled patients; of a difference, of the same patients",
        ));
    }
}
