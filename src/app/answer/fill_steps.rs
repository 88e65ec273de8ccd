//! The fill steps of an expander by week: the values of the curve over the fill at each visit.

use crate::app::texts::{mmhg, tr, word_of};
use crate::app::widgets::quantity::format_at_most;
use crate::app::widgets::theme::{SPACE, SPACE_SMALL};
use crate::app::widgets::{NumberField, rejection_label, remark};
use crate::measure::bands;
use crate::scene::FillSchedule;
use crate::study::{Map, Quantity};
use eframe::egui::{self, RichText, Ui};

/// Greatest number of visits.
const MAX_VISITS: usize = 30;

/// What the rows are, and what they leave out.
pub(crate) const NOTE: &str = "Each row is the answer as if the expander were filled to that volume at once. A week later, in a wide table: half of \
     the added tension relaxed, 30 % of the stretch grown, both estimates. Later fills meet more skin: the model leaves that out. Skin kept: about a \
     third (35 %) of the gained skin, the part that remained with tissue expanders.";

/// What a row of a file is.
pub(crate) const NOTE_OF_ROW: &str = "As if filled to this volume at once: no growth or relaxation of the skin between the visits. \
     Skin kept: 35 % of the gained skin.";

/// Where the usual numbers come from.
const CONVENTION: &str = "Your choice: no measurement fixes these numbers. In one series of 147 breasts 246 ± 107 ml were filled at operation \
     (ePlasty 2023, 23, e12), in another 68 % of the expander (Plast Reconstr Surg 2011, 127, 1065). Afterwards \
     50–60 ml a week are a habit of practices; pain and pale skin end a visit.";

/// The columns that follow from the others, which a narrow table does without, and the pressure a week later: visit, added, gained, later.
const FOLLOWING: [usize; 4] = [1, 2, 8, 10];

/// Heads of the columns; a number has its word in a column of its own.
const HEADS: [&str; 11] = [
    "Week",
    "Visit",
    "Added (ml)",
    "Filled (ml)",
    "Pressure (mmHg)",
    "Pressure, in a word",
    "Skin stretch (%)",
    "Skin stretch, in a word",
    "Skin gained (cm²)",
    "Skin kept (cm²)",
    "A week later (mmHg)",
];
/// The words of the lowest bands, which the table on the screen leaves out.
const LOWEST: [&str; 2] = ["usual", "reserve left"];
/// The columns of words.
const WORDS: [usize; 2] = [5, 7];

fn whole(value: f64) -> String {
    format!("{value:.0}")
}

/// What a user does with the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Use {
    Copy,
    Save,
}

/// The table of a schedule.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct FillSteps(pub(crate) FillSchedule);

/// The curves over the fill that the table reads.
#[derive(Clone, Copy)]
pub(crate) struct Curves<'a> {
    /// Right after filling.
    pub(crate) curve: &'a Map,
    /// A week after filling; `None` before it is solved.
    pub(crate) later: Option<&'a Map>,
}

impl FillSteps {
    /// The total fills \[ml\], operation first, up to a full fill \[ml\] or [`MAX_VISITS`].
    fn fills(self, full_ml: f64) -> Vec<f64> {
        let visits = ((full_ml - self.0.start_ml) / self.0.visit_ml - 1e-9).ceil().max(0.0);
        let visits = (visits as usize).min(MAX_VISITS);
        let fill = |visit: usize| (self.0.start_ml + visit as f64 * self.0.visit_ml).min(full_ml);
        (0..=visits).map(fill).collect()
    }

    /// The table up to a full fill \[ml\] as a surgeon reads it, heads first; a fill beyond the curve has no values.
    pub(crate) fn rows(self, curves: Curves<'_>, full_ml: f64) -> Vec<Vec<String>> {
        self.rows_with(curves, full_ml, mmhg)
    }

    /// [`Self::rows`] with the texts of the pressures.
    fn rows_with(
        self,
        Curves { curve, later }: Curves<'_>,
        full_ml: f64,
        pressure_text: fn(f64) -> String,
    ) -> Vec<Vec<String>> {
        let none = || "–".to_owned();
        let mut rows = vec![HEADS.map(|head| tr(head).to_owned()).to_vec()];
        let mut before = 0.0;
        for (visit, fill) in self.fills(full_ml).into_iter().enumerate() {
            let value = |quantity: Quantity| curve.between(quantity, fill, 0.0);
            let pressure = value(Quantity::GreatestPressureMmhg);
            let pressure_word = pressure
                .map(|most| word_of(&bands::PRESSURE, bands::PRESSURE.verdict(most).1).to_owned());
            let stretch = value(Quantity::GreatestStrain);
            let gain = value(Quantity::SkinAreaGainCm2);
            let stretch_word = stretch.map(|strain| {
                tr(bands::stretch(strain, value(Quantity::SkinReserveUsed)).1).to_owned()
            });
            rows.push(vec![
                format_at_most(visit as f64 * self.0.weeks, 0, 1),
                if visit == 0 { "op.".to_owned() } else { visit.to_string() },
                format!("{:.0}", fill - before),
                format!("{fill:.0}"),
                pressure.map_or_else(none, pressure_text),
                pressure_word.unwrap_or_else(none),
                stretch.map_or_else(none, |strain| whole(100.0 * strain)),
                stretch_word.unwrap_or_else(none),
                gain.map_or_else(none, whole),
                gain.map_or_else(none, |gain| whole(bands::REALISED_AREA_GAIN * gain)),
                later
                    .and_then(|later| later.between(Quantity::GreatestPressureMmhg, fill, 0.0))
                    .map_or_else(none, pressure_text),
            ]);
            before = fill;
        }
        rows
    }

    /// What the table does not contain, in a sentence; empty if nothing is missing.
    fn missing(self, curve: &Map, full_ml: f64) -> String {
        let fills = self.fills(full_ml);
        let last = fills.last().copied().unwrap_or_default();
        let (least, most) = (curve.axes()[0].from, curve.axes()[0].to);
        if last < full_ml {
            return tr!(
                "Only {visits} visits are shown: more per visit reaches {full_ml:.0} ml.",
                visits = MAX_VISITS,
                full_ml
            );
        }
        if fills.iter().any(|fill| !(least..=most).contains(fill)) {
            return tr!("–: not computed below {least:.0} ml and above {most:.0} ml.", least, most);
        }
        String::new()
    }

    /// Shows the schedule and its table; returns the rows of the file if that should be saved. `is_solved`: the curve has all its values.
    pub(crate) fn show(
        &mut self,
        ui: &mut Ui,
        curves: Curves<'_>,
        full_ml: f64,
        is_solved: bool,
    ) -> Option<Vec<Vec<String>>> {
        let title = match is_solved {
            true => tr("Fill steps by week"),
            false => tr("Fill steps by week (provisional, being computed)"),
        };
        ui.label(RichText::new(title).small().strong());
        self.fields(ui);
        let rows = self.rows(curves, full_ml);
        egui::ScrollArea::horizontal().id_salt("fill steps").show(ui, |ui| {
            let grid = egui::Grid::new("fill steps").num_columns(HEADS.len()).min_col_width(0.0);
            let is_narrow = ui.available_width() < whole_width(ui, &rows);
            grid.striped(true).spacing([SPACE, 2.0]).show(ui, |ui| table(ui, &rows, is_narrow));
        });
        let missing = self.missing(curves.curve, full_ml);
        if !missing.is_empty() {
            remark(ui, missing);
        }
        remark(ui, tr(NOTE));
        let mut chosen = None;
        ui.horizontal_wrapped(|ui| {
            if !is_solved {
                ui.disable();
            }
            if ui
                .button(tr("Copy fill steps"))
                .on_hover_text(tr("As a table, for a letter or a sheet"))
                .clicked()
            {
                chosen = Some(Use::Copy);
            }
            if ui.button(tr("Save fill steps (CSV)…")).clicked() {
                chosen = Some(Use::Save);
            }
        });
        match chosen? {
            Use::Copy => {
                let lines: Vec<String> = rows.iter().map(|row| row.join("\t")).collect();
                ui.copy_text(lines.join("\n"));
                None
            }
            Use::Save => {
                // The names of the columns of a file are English, and its numbers have points.
                let rows = self.rows_with(curves, full_ml, whole).into_iter().skip(1);
                let heads = [HEADS.map(str::to_owned).to_vec()];
                let mut rows: Vec<_> = heads.into_iter().chain(rows).collect();
                for week in rows.iter_mut().filter_map(|row| row.first_mut()) {
                    *week = week.replace(',', ".");
                }
                Some(rows)
            }
        }
    }

    /// The fields of the schedule.
    fn fields(&mut self, ui: &mut Ui) {
        let mut rejections = Vec::new();
        for (value, name, allowed, step) in [
            (&mut self.0.start_ml, tr("At operation (ml)"), FillSchedule::START_ML, 10.0),
            (&mut self.0.visit_ml, tr("Per visit (ml)"), FillSchedule::VISIT_ML, 5.0),
            (&mut self.0.weeks, tr("Weeks between visits"), FillSchedule::WEEKS, 0.5),
        ] {
            ui.horizontal(|ui| {
                let field = NumberField {
                    name,
                    allowed: allowed.0..=allowed.1,
                    decimals: 0,
                    step,
                    width: 44.0,
                    ..NumberField::default()
                };
                let typed = field.show(ui, value);
                typed.response.on_hover_text(tr(CONVENTION));
                rejections.extend(typed.rejection.map(|reason| format!("{name}: {reason}")));
                ui.label(name).on_hover_text(tr(CONVENTION));
            });
        }
        for reason in rejections {
            rejection_label(ui, &reason);
        }
        ui.add_space(SPACE_SMALL);
    }
}

/// Shows heads and rows; a value with a word above usual stands out.
fn table(ui: &mut Ui, rows: &[Vec<String>], is_narrow: bool) {
    for row in texts(rows, is_narrow) {
        for (text, is_strong) in row {
            let text = RichText::new(text).small();
            ui.label(if is_strong { text.strong() } else { text });
        }
        ui.end_row();
    }
}

/// Width of the table with all columns \[points\].
fn whole_width(ui: &Ui, rows: &[Vec<String>]) -> f32 {
    let font = egui::TextStyle::Small.resolve(ui.style());
    let mut widths = [0_f32; HEADS.len() - WORDS.len()];
    for row in texts(rows, false) {
        for (width, (text, _)) in widths.iter_mut().zip(row) {
            let galley = ui.painter().layout_no_wrap(text, font.clone(), egui::Color32::WHITE);
            *width = width.max(galley.size().x);
        }
    }
    widths.iter().sum::<f32>() + SPACE * (widths.len() - 1) as f32
}

/// The texts of heads and rows, and whether each stands out. A narrow table leaves out what follows from the other columns.
fn texts(
    rows: &[Vec<String>],
    is_narrow: bool,
) -> impl Iterator<Item = impl Iterator<Item = (String, bool)>> {
    let is_shown =
        move |column: &usize| !(is_narrow && FOLLOWING.contains(column) || WORDS.contains(column));
    rows.iter().enumerate().map(move |(k, row)| {
        (0..row.len()).filter(is_shown).map(move |column| {
            let cell = &row[column];
            if k == 0 {
                // A head has a word a line.
                return (cell.replace(' ', "\n"), true);
            }
            // The word of a value stands beside or below the value, unless it is that of the lowest band.
            let word = WORDS.contains(&(column + 1)).then(|| &row[column + 1]);
            let is_left_out = |word: &str| word == "–" || LOWEST.map(tr).contains(&word);
            match word.filter(|word| !is_left_out(word)) {
                None => (cell.clone(), false),
                Some(word) if is_narrow => (format!("{cell},\n{word}"), true),
                Some(word) => (format!("{cell}, {word}"), true),
            }
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use crate::study::{Axis, Cases, MapSettings, Parameter, Study, evaluate};

    fn steps(start_ml: f64, visit_ml: f64) -> FillSteps {
        FillSteps(FillSchedule { start_ml, visit_ml, weeks: 2.0 })
    }

    #[test]
    fn the_last_visit_fills_the_rest_and_the_number_of_visits_is_limited() {
        assert_eq!(steps(100.0, 60.0).fills(300.0), [100.0, 160.0, 220.0, 280.0, 300.0]);
        assert_eq!(steps(100.0, 100.0).fills(300.0), [100.0, 200.0, 300.0]);
        assert_eq!(steps(400.0, 60.0).fills(300.0), [300.0]);
        assert_eq!(steps(0.0, 5.0).fills(1000.0).len(), 1 + MAX_VISITS);
    }

    #[test]
    fn a_row_has_the_values_of_the_curve_at_its_fill_and_the_words_of_the_limits() {
        let axis = Axis { field: Parameter::Volume, from: 100.0, to: 600.0, count: 6 };
        let settings = MapSettings { nodes_per_side: 17, ..MapSettings::default() };
        let mut curve = Map::new(&Scene::sheet(), &[axis], settings).unwrap();
        let mut store = Cases::default();
        while let Some((index, job)) = curve.next_job(&mut store) {
            curve.receive(index, evaluate(&job), &mut store);
        }
        let schedule = steps(50.0, 150.0);
        let curves = Curves { curve: &curve, later: Some(&curve) };
        let rows = schedule.rows_with(curves, 600.0, whole);
        let shown = schedule.rows(curves, 600.0);
        assert_eq!(shown[5][4], "over 100");
        assert_eq!(shown[2], rows[2]);
        assert_eq!(rows[0], HEADS);
        assert_eq!(rows[1], ["0", "op.", "50", "50", "–", "–", "–", "–", "–", "–", "–"]);
        assert_eq!(rows[2][..4], ["2", "1", "150", "200"]);
        assert_eq!(rows.last().unwrap()[..4], ["8", "4", "100", "600"]);
        assert_eq!(rows.len(), 6);
        for (row, i) in [(&rows[2], 1), (&rows[5], 5)] {
            let value = |quantity| curve.value(quantity, i, 0).unwrap();
            let pressure = value(Quantity::GreatestPressureMmhg);
            let stretch = value(Quantity::GreatestStrain);
            let number = |value: f64| format!("{value:.0}");
            assert_eq!(
                row[4..7],
                [
                    number(pressure),
                    bands::PRESSURE.verdict(pressure).1.to_owned(),
                    number(100.0 * stretch)
                ]
            );
            assert_eq!(row[7], bands::stretch(stretch, None).1);
            let gain = value(Quantity::SkinAreaGainCm2);
            assert_eq!(row[8..], [number(gain), number(0.35 * gain), number(pressure)]);
        }
        let before = schedule.rows(Curves { curve: &curve, later: None }, 600.0);
        assert_eq!((&before[2][..10], &*before[2][10]), (&shown[2][..10], "–"));
        // A column has either numbers or words; the greatest fill is above usual.
        for row in &rows[2..] {
            for (column, cell) in row.iter().enumerate() {
                let is_word = WORDS.contains(&column);
                assert_eq!(cell.parse::<f64>().is_err(), is_word, "{column}: {cell}");
            }
        }
        assert!(!LOWEST.contains(&&*rows[5][7]));
        // Between two points on a line.
        let [a, b] = [2, 3].map(|i| curve.value(Quantity::SkinAreaGainCm2, i, 0).unwrap());
        assert_eq!(rows[3][8], format!("{:.0}", 0.5 * (a + b)));
        assert!(steps(50.0, 150.0).missing(&curve, 600.0).contains("below 100 ml"));
        assert_eq!(steps(100.0, 100.0).missing(&curve, 600.0), "");
        assert!(steps(100.0, 5.0).missing(&curve, 600.0).starts_with("Only 30 visits"));
    }
}
