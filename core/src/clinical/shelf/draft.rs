//! A table of sizes before it is taken: what its columns hold, in which units, and which rows are left out.

use super::header::{self, Column, LengthUnit, Meaning, UNSURE, meaning};
use super::row::{Cells, Units, quantity};
use super::{KEPT, KEPT_BEFORE, MAX_SIZES, Shelf, ShelfSize};
use crate::table::{Decimals, Form, NotText, Row, Table, decode};
use std::borrow::Cow;
use std::collections::HashMap;

/// Most rows above the names of the columns.
const MOST_TITLES: usize = 60;
/// Most columns that are shown.
const MOST_COLUMNS: usize = 40;
/// Most rows that are listed as left out.
const MOST_LISTED: usize = 100;
/// Most rows by which units and contents are judged.
const MOST_JUDGED: usize = 200;
/// Least numbers in mm: the median of widths and heights, and of projections.
const LEAST_WIDTH_IN_MM: f64 = 30.0;
const LEAST_PROJECTION_IN_MM: f64 = 12.5;
/// What a table without sizes lacks.
pub(super) const NO_SIZE: &str = "no row is a size; allowed: a width with a projection or a volume";
const NO_WIDTH: &str = "no column is the width; allowed: one column of widths or diameters";
const NO_VOLUME: &str = "no column is the projection or the volume; allowed: one or both";

/// From where the unit of a column is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UnitOrigin {
    /// From the column's name, or chosen.
    Named,
    /// From the cells.
    Cells,
    /// From the size of the numbers.
    Guessed,
}

/// A column of a draft.
#[derive(Clone, Debug, PartialEq)]
pub struct DraftColumn {
    /// The name of the column; empty without one.
    pub title: String,
    /// The first cells below the name.
    pub sample: String,
    /// What the column is read as.
    pub column: Column,
    /// The unit of its lengths.
    pub unit: LengthUnit,
    /// From where the unit is known.
    pub origin: UnitOrigin,
}

/// A row that is no size.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Skipped {
    /// The line of the row, from 1.
    pub line: usize,
    /// What is wrong, and what is allowed.
    pub reason: String,
}

/// A draft as read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Reading {
    /// The sizes.
    pub shelf: Shelf,
    /// The first rows that are left out.
    pub skipped: Vec<Skipped>,
    /// Number of the rows that are left out.
    pub skipped_rows: usize,
}

impl Reading {
    fn skip(&mut self, line: usize, reason: impl Into<String>) {
        self.skipped_rows += 1;
        if self.skipped.len() < MOST_LISTED {
            self.skipped.push(Skipped { line, reason: reason.into() });
        }
    }
}

/// The letters of Windows-1252 that are none of Latin-1, from 0x80 on; a full stop for a byte without a letter.
const WINDOWS_1252: &str = "€.‚ƒ„…†‡ˆ‰Š‹Œ.Ž..‘’“”•–—˜™š›œ.žŸ";

/// The letter of a byte.
fn windows_1252(byte: u8) -> char {
    match byte.checked_sub(0x80).map(usize::from).and_then(|k| WINDOWS_1252.chars().nth(k)) {
        Some(letter) if letter != '.' => letter,
        _ => char::from(byte),
    }
}

/// A table of sizes with what its columns hold.
#[derive(Clone, Debug)]
pub struct Draft {
    table: Table,
    /// Index of the first row below the names of the columns and their units.
    first: usize,
    /// Index of the row with the names of the columns.
    names: Option<usize>,
    columns: Vec<DraftColumn>,
}

impl Draft {
    /// The text of a file: UTF-8, UTF-16 with a byte order mark, or else Windows-1252.
    ///
    /// # Errors
    /// What the file is instead.
    pub fn text_of(bytes: &[u8]) -> Result<Cow<'_, str>, NotText> {
        match decode(bytes) {
            Err(NotText::NotUtf8 { .. }) => {
                Ok(bytes.iter().map(|byte| windows_1252(*byte)).collect())
            }
            other => other,
        }
    }

    /// Reads a table and recognises its columns.
    ///
    /// # Errors
    /// One line for a table that cannot be divided into cells, or without a row.
    pub fn of(text: &str) -> Result<Self, String> {
        let kept =
            Form { separator: Some(b';'), decimals: Decimals::Point, has_separator_line: false };
        let table = if [KEPT, KEPT_BEFORE].iter().any(|names| text.starts_with(names)) {
            Table::read_as(text, kept)
        } else {
            Table::read(text)
        };
        let table = table.map_err(|error| error.to_string())?;
        if table.rows().len() == 0 {
            return Err(
                "the table is empty; allowed: names of columns and a row for each size".to_owned()
            );
        }
        let names = names(&table);
        let mut first = names.map_or(0, |names| names + 1);
        let units = names.and_then(|_| table.rows().nth(first)).filter(|row| is_units(*row));
        first += usize::from(units.is_some());
        let count = table.columns().min(MOST_COLUMNS);
        let cell =
            |row: Option<Row>, k: usize| row.map(|row| row.cell(k).to_owned()).unwrap_or_default();
        let names_row = names.and_then(|names| table.rows().nth(names));
        let title = |k: usize| {
            let title = format!("{} {}", cell(names_row, k), cell(units, k));
            title.split_whitespace().collect::<Vec<_>>().join(" ")
        };
        let titles: Vec<String> = (0..count).map(title).collect();
        let mut draft = Self { table, first, names, columns: Vec::new() };
        let meanings = draft.contents(&titles);
        for (k, (title, meaning)) in titles.into_iter().zip(&meanings).enumerate() {
            let sample: Vec<&str> =
                draft.cells(k).map(str::trim).filter(|cell| !cell.is_empty()).take(2).collect();
            let sample = sample.join(", ");
            let column = meaning.map_or(Column::Ignored, |meaning| meaning.column);
            let named = meaning.and_then(|meaning| meaning.unit);
            let (unit, origin) = draft.unit(k, column, named);
            draft.columns.push(DraftColumn { title, sample, column, unit, origin });
        }
        Ok(draft)
    }

    /// The columns of the table.
    #[must_use]
    pub fn columns(&self) -> &[DraftColumn] {
        &self.columns
    }

    /// Reads a column as something else; another column that was read so is ignored.
    pub fn choose(&mut self, index: usize, column: Column) {
        for other in &mut self.columns {
            if other.column == column {
                other.column = Column::Ignored;
            }
        }
        let title = self.columns.get(index).map(|column| column.title.clone()).unwrap_or_default();
        let words = meaning(&title).and_then(|meaning| meaning.unit);
        let (unit, origin) = self.unit(index, column, words);
        if let Some(chosen) = self.columns.get_mut(index) {
            (chosen.column, chosen.unit, chosen.origin) = (column, unit, origin);
        }
    }

    /// Sets the unit of a column of lengths.
    pub fn choose_unit(&mut self, index: usize, unit: LengthUnit) {
        if let Some(column) = self.columns.get_mut(index) {
            column.unit = unit;
        }
    }

    /// What no column holds, and a size needs.
    #[must_use]
    pub fn missing(&self) -> Option<&'static str> {
        let has = |wanted| self.columns.iter().any(|column| column.column == wanted);
        if !has(Column::Width) {
            Some(NO_WIDTH)
        } else if has(Column::Projection) || has(Column::Volume) {
            None
        } else {
            Some(NO_VOLUME)
        }
    }

    /// The sizes of the table, and the rows that are none.
    #[must_use]
    pub fn read(&self) -> Reading {
        let mut reading = Reading::default();
        let place = |wanted| self.columns.iter().position(|column| column.column == wanted);
        let [name, width, height, projection, volume] =
            [Column::Name, Column::Width, Column::Height, Column::Projection, Column::Volume]
                .map(place);
        let unit = |place: Option<usize>| place.map_or(LengthUnit::Mm, |k| self.columns[k].unit);
        let units = Units {
            decimals: self.table.form().decimals,
            width: unit(width),
            height: unit(height),
            projection: unit(projection),
        };
        // Lines of the labels.
        let mut lines: HashMap<String, usize> = HashMap::new();
        for (k, row) in self.table.rows().enumerate() {
            if k < self.first {
                if Some(k) < self.names {
                    reading.skip(row.line, "above the names of the columns");
                }
                continue;
            }
            let cell = |place: Option<usize>| place.map_or("", |k| row.cell(k));
            let cells = Cells {
                name: cell(name),
                width: cell(width),
                height: cell(height),
                projection: cell(projection),
                volume: cell(volume),
            };
            let mut size = match ShelfSize::of(cells, units) {
                Ok(size) => size,
                Err(reason) => {
                    reading.skip(row.line, reason);
                    continue;
                }
            };
            if reading.shelf.sizes.len() == MAX_SIZES {
                reading.skip(row.line, format!("more sizes; allowed: up to {MAX_SIZES}"));
                continue;
            }
            if lines.contains_key(&size.label) {
                let is_equal = |other: &ShelfSize| *other == size;
                if !reading.shelf.sizes.iter().any(is_equal) {
                    size = size.with_numbers_in_name();
                }
            }
            if let Some(line) = lines.get(&size.label) {
                reading.skip(row.line, format!("the size of line {line} again"));
                continue;
            }
            lines.insert(size.label.clone(), row.line);
            reading.shelf.sizes.push(size);
        }
        reading
    }

    /// The cells of a column that are judged.
    fn cells(&self, column: usize) -> impl Iterator<Item = &str> {
        let rows = self.table.rows().skip(self.first).take(MOST_JUDGED);
        rows.map(move |row| row.cell(column))
    }

    /// What the columns hold by their names; of two that hold the same that of the lower rank.
    fn contents(&self, titles: &[String]) -> Vec<Option<Meaning>> {
        let has_numbers =
            |k| self.cells(k).any(|cell| quantity(cell, self.table.form().decimals).is_ok());
        let mut meanings: Vec<Option<Meaning>> = titles
            .iter()
            .enumerate()
            .map(|(k, title)| {
                let mut found =
                    meaning(title).filter(|found| found.rank < UNSURE || has_numbers(k))?;
                // A name that all rows share comes behind one that differs.
                if found.column == Column::Name && self.is_shared(k) {
                    found.rank += UNSURE;
                }
                Some(found)
            })
            .collect();
        let has = |meanings: &[Option<Meaning>], column| {
            meanings.iter().flatten().any(|found| found.column == column)
        };
        let is_round = meanings.iter().flatten().any(|found| found.is_diameter);
        if is_round {
            // The height of a round implant is its projection.
            let column = if has(&meanings, Column::Projection) {
                Column::Ignored
            } else {
                Column::Projection
            };
            let heights =
                meanings.iter_mut().flatten().filter(|found| found.column == Column::Height);
            heights.for_each(|found| found.column = column);
        }
        let ranks: Vec<_> =
            meanings.iter().map(|found| found.map(|found| (found.column, found.rank))).collect();
        for (k, found) in meanings.iter_mut().enumerate() {
            let Some(own) = ranks[k] else { continue };
            let is_before = |(other, rank): (usize, &Option<(Column, u8)>)| {
                rank.is_some_and(|rank| rank.0 == own.0 && (rank.1, other) < (own.1, k))
            };
            if ranks.iter().enumerate().any(is_before) {
                *found = None;
            }
        }
        meanings
    }

    /// Has a column the same text in several rows?
    fn is_shared(&self, column: usize) -> bool {
        let mut cells = self.cells(column).map(str::trim).filter(|cell| !cell.is_empty());
        let first = cells.next();
        first.is_none() || cells.next() == first
    }

    /// The unit of a column's lengths: named, in the cells, or by the size of the numbers.
    fn unit(
        &self,
        index: usize,
        column: Column,
        named: Option<LengthUnit>,
    ) -> (LengthUnit, UnitOrigin) {
        if !column.is_length() {
            return (LengthUnit::Mm, UnitOrigin::Named);
        }
        if let Some(unit) = named {
            return (unit, UnitOrigin::Named);
        }
        let decimals = self.table.form().decimals;
        let (mut numbers, mut in_cells) = (Vec::new(), None);
        for read in self.cells(index).filter_map(|cell| quantity(cell, decimals).ok()) {
            match LengthUnit::of(&header::unit_word(read.unit)) {
                Some(unit) => in_cells = Some(unit),
                None => numbers.push(read.value),
            }
        }
        if let Some(unit) = in_cells.filter(|_| numbers.is_empty()) {
            return (unit, UnitOrigin::Cells);
        }
        numbers.sort_by(f64::total_cmp);
        let least =
            if column == Column::Projection { LEAST_PROJECTION_IN_MM } else { LEAST_WIDTH_IN_MM };
        let is_mm = numbers.get(numbers.len() / 2).is_some_and(|median| *median >= least);
        (if is_mm { LengthUnit::Mm } else { LengthUnit::Cm }, UnitOrigin::Guessed)
    }
}

/// The row with the names of the columns: that of the first rows which names most contents of a size; without one the last row of
/// words above the first row of numbers.
fn names(table: &Table) -> Option<usize> {
    let numbers = |row: Row| row.cells().filter(|cell| is_number(cell)).count();
    let score = |row: Row| {
        let found: Vec<Column> =
            row.cells().filter_map(meaning).map(|found| found.column).collect();
        let kinds = Column::ALL.into_iter().filter(|column| found.contains(column)).count();
        let has_size = found.iter().any(|column| *column != Column::Name);
        if numbers(row) > 1 || !has_size || kinds < 2 { 0 } else { kinds }
    };
    let rows = || table.rows().take(MOST_TITLES).enumerate();
    let best = rows().map(|(k, row)| (score(row), std::cmp::Reverse(k))).max()?;
    if best.0 > 0 {
        return Some(best.1.0);
    }
    let first = rows().find(|(_, row)| numbers(*row) > 1)?.0.checked_sub(1)?;
    let count = table.rows().nth(first)?.cells().filter(|cell| !cell.trim().is_empty()).count();
    (count > 1).then_some(first)
}

/// Is a cell a number with or without a unit of a size?
fn is_number(cell: &str) -> bool {
    quantity(cell, Decimals::Unknown).is_ok_and(|read| {
        let unit = header::unit_word(read.unit);
        unit.is_empty() || LengthUnit::of(&unit).is_some() || header::is_volume_unit(&unit)
    })
}

/// Has a row units only, as a second row of names?
fn is_units(row: Row) -> bool {
    let words: Vec<String> =
        row.cells().map(header::unit_word).filter(|word| !word.is_empty()).collect();
    !words.is_empty()
        && words.iter().all(|word| LengthUnit::of(word).is_some() || header::is_volume_unit(word))
}
