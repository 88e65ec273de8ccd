//! Columns and units of a table: as asked, by units in cells, by words and units of the header, by magnitude.

use super::{Given, Notes, Row, StrainUnit, StressUnit, TensileError};
use crate::curve::{List, MAX_POINTS, Pair};
use crate::table::{self, Table};
use std::borrow::Cow;

/// Strains \[-\] and stresses \[kPa\] of a table.
pub(super) struct Recognised {
    pub(super) rows: Vec<Row>,
    /// Are strain and stress true ones?
    pub(super) is_true: [bool; 2],
}

/// What the columns of one axis are called, and the factors of their units.
struct Axis {
    /// Beginnings of words, in languages of laboratories.
    words: &'static [&'static str],
    units: &'static [(&'static str, f64)],
}

static STRAIN: Axis = Axis {
    words: &[
        "strain", "elong", "dehnung", "deform", "déform", "allong", "allung", "alarg", "epsilon",
        "ε", "stretch", "λ",
    ],
    units: &[
        ("percent", 0.01),
        ("%", 0.01),
        ("fraction", 1.0),
        ("mm/mm", 1.0),
        ("m/m", 1.0),
        ("in/in", 1.0),
        ("[-]", 1.0),
        ("(-)", 1.0),
    ],
};
static STRESS: Axis = Axis {
    words: &["stress", "spannung", "tensi", "esfuerzo", "contrainte", "sforz", "sigma", "σ"],
    units: &[
        ("Pa", 1e-3),
        ("kPa", 1.0),
        ("MPa", 1e3),
        ("GPa", 1e6),
        ("N/mm2", 1e3),
        ("N/mm²", 1e3),
        ("N/mm^2", 1e3),
        ("psi", 6.894_757),
        ("bar", 100.0),
        ("mmHg", 0.133_322),
    ],
};
/// Beginnings of words of other quantities that have the word of an axis.
const OTHERS: [&str; 5] = ["rate", "geschw", "veloc", "energ", "modul"];
/// Beginnings of words of true strains and stresses.
const TRUE: [&str; 7] = ["true", "wahr", "verdader", "vraie", "log", "cauchy", "hencky"];
/// Units of forces and lengths, and of stress that are not read.
const REFUSED: [&str; 9] = ["n", "kn", "mn", "lbf", "ksi", "mm", "cm", "um", "µm"];
/// Greatest strain that is a fraction where no unit is named.
const MOST_FRACTION: f64 = 2.0;
/// Stress at [`COMPARED`] \[kPa\] below which a number without a unit is MPa, and above which it is Pa: four times softer than fat,
/// thirty times stiffer than skin.
const LIKELY_KPA: [f64; 2] = [0.1, 600.0];
/// Strain at which curves are compared \[-\].
pub(super) const COMPARED: f64 = 0.2;

/// A number and the factor of the unit in its cell.
type Cell = (f64, Option<f64>);

/// The name of a column, units and rows of units below it too.
#[derive(Clone, Debug, Default)]
struct Column {
    index: usize,
    name: String,
}

impl Column {
    fn unnamed(index: usize) -> Self {
        Self { index, ..Self::default() }
    }

    fn has(&self, beginnings: &[&str]) -> bool {
        let name = self.name.to_lowercase();
        let mut words = name.split(|c: char| !c.is_alphanumeric());
        words.any(|word| beginnings.iter().any(|beginning| word.starts_with(beginning)))
    }

    /// The unit of the column, by a word of its own or behind a stroke.
    fn unit(&self, axis: &Axis) -> Option<(&'static str, f64)> {
        let name = self.name.to_lowercase().replace('%', " % ");
        let words = || name.split(|c: char| c.is_whitespace() || "()[]{}<>,;:_".contains(c));
        let is_unit = |unit: &str| {
            let behind =
                |word: &str| word.split_once('/').is_some_and(|(_, behind)| behind == unit);
            unit.len() == 3 && unit.contains('-') && name.contains(unit)
                || words().any(|word| word == unit || behind(word))
        };
        axis.units.iter().find(|(unit, _)| is_unit(&unit.to_lowercase())).copied()
    }

    /// A unit in brackets that is none of a strain or stress.
    fn refused_unit(&self) -> Option<&'static str> {
        let name = self.name.to_lowercase();
        let has =
            |unit: &str| name.contains(&format!("[{unit}]")) || name.contains(&format!("({unit})"));
        REFUSED.into_iter().find(|unit| has(unit))
    }
}

impl Axis {
    /// The column of this axis, by its words: an engineering one rather than a true one.
    fn by_words<'a>(&self, columns: &'a [Column]) -> Option<&'a Column> {
        let found = || columns.iter().filter(|c| c.has(self.words) && !c.has(&OTHERS));
        found().find(|c| !c.has(&TRUE)).or_else(|| found().next())
    }

    /// The column of this axis, by its words or its unit.
    fn by_words_or_unit<'a>(&self, columns: &'a [Column]) -> Option<&'a Column> {
        let is_found = |c: &&Column| c.unit(self).is_some() && !c.has(&OTHERS);
        self.by_words(columns).or_else(|| columns.iter().find(is_found))
    }

    /// The number of a cell with the factor of its unit.
    fn cell(&self, row: table::Row<'_>, column: &Column) -> Option<Cell> {
        let found = row.number(column.index, "").ok()?;
        let is_unit = |unit: &str| unit.eq_ignore_ascii_case(found.unit);
        let factor = self.units.iter().find(|(unit, _)| is_unit(unit)).map(|(_, factor)| *factor);
        (found.unit.is_empty() || factor.is_some()).then_some((found.value, factor))
    }
}

/// Reads the rows of a table, or the points of a curve in JSON.
pub(super) fn recognise(
    text: &str,
    given: Given,
    notes: &mut Notes,
) -> Result<Recognised, TensileError> {
    if text.trim_start().starts_with(['{', '[']) {
        let cells = json_points(text)?.into_iter().map(|point| point.map(|value| (value, None)));
        let rows = in_units(cells.collect(), &[0, 1].map(Column::unnamed), given, notes);
        return Ok(Recognised { rows, is_true: [false; 2] });
    }
    let table = Table::read(&with_tabs(text)).map_err(|error| TensileError(error.to_string()))?;
    notes.form = Some(table.form());
    let rows: Vec<_> = table.rows().collect();
    let numbers = |row: &table::Row<'_>| -> Vec<usize> {
        (0..table.columns()).filter(|&column| row.number(column, "").is_ok()).collect()
    };
    let first = rows.iter().position(|row| numbers(row).len() > 1).ok_or_else(|| {
        TensileError(
            "no row has two numbers; allowed: a strain and a stress in each row".to_owned(),
        )
    })?;
    let (head, rows) = rows.split_at(first);
    let columns = columns(head, &numbers(&rows[0]), given)?;
    let [strain, stress] = &columns;
    let (mut cells, mut left_out) = (Vec::with_capacity(rows.len()), Vec::new());
    for row in rows {
        match STRAIN.cell(*row, strain).zip(STRESS.cell(*row, stress)) {
            Some((strain, stress)) => cells.push([strain, stress]),
            None => left_out.push(row.line),
        }
    }
    notes.left_out = left_out.len();
    if let [line, ..] = left_out[..] {
        let count = left_out.len();
        notes.say(format!(
            "Rows without a strain and a stress, left out: {count}; the first: line {line}."
        ));
    }
    let is_stretch = strain.has(&["stretch", "λ"]);
    if is_stretch {
        cells.iter_mut().for_each(|[(strain, _), _]| *strain -= 1.0);
        notes.say("Stretch was converted to strain.");
    }
    let is_true = [strain.has(&TRUE) && !is_stretch, stress.has(&TRUE)];
    Ok(Recognised { rows: in_units(cells, &columns, given, notes), is_true })
}

/// The columns of strain and stress among those with numbers: by the header, or the only two.
fn columns(
    head: &[table::Row<'_>],
    numbers: &[usize],
    given: Given,
) -> Result<[Column; 2], TensileError> {
    // The names begin on the last row that has both; rows of units follow.
    let named = |from: usize| -> Vec<Column> {
        let name = |index: usize| {
            let cells = head[from..].iter().map(|row| row.cell(index).trim());
            cells.filter(|cell| !cell.is_empty()).collect::<Vec<_>>().join(" ")
        };
        numbers.iter().map(|&index| Column { index, name: name(index) }).collect()
    };
    let last = named(head.len().saturating_sub(1));
    let by_header = |find: fn(&'static Axis, &[Column]) -> Option<Column>| {
        (0..head.len()).rev().find_map(|from| {
            let columns = named(from);
            let (strain, stress) = find(&STRAIN, &columns).zip(find(&STRESS, &columns))?;
            (strain.index != stress.index).then_some([strain, stress])
        })
    };
    let by_name = by_header(|axis, columns| axis.by_words(columns).cloned())
        .or_else(|| by_header(|axis, columns| axis.by_words_or_unit(columns).cloned()));
    let found = match (by_name, &last[..]) {
        (Some(found), _) => found,
        (None, [strain, stress]) => [strain.clone(), stress.clone()],
        _ => {
            let names: Vec<_> = last.iter().map(|column| shortened(&column.name)).collect();
            return Err(TensileError(format!(
                "no header names strain and stress among {} columns ({}); allowed: two columns, or names as Strain, Stress",
                names.len(),
                names.join(", ")
            )));
        }
    };
    let is_asked = [given.strain.is_some(), given.stress.is_some()];
    for (column, _) in found.iter().zip(is_asked).filter(|(_, is_asked)| !is_asked) {
        if let Some(unit) = column.refused_unit() {
            let name = shortened(&column.name);
            return Err(TensileError(format!(
                "the column {name:?} is in {unit}; allowed: strain as a fraction or in %, stress in Pa, kPa, MPa or N/mm²"
            )));
        }
    }
    Ok(found)
}

/// The first letters of a name, for a message.
pub(super) fn shortened(name: &str) -> String {
    name.chars().filter(|letter| !letter.is_control()).take(40).collect()
}

/// The cells in their units.
fn in_units(
    cells: Vec<[Cell; 2]>,
    columns: &[Column; 2],
    given: Given,
    notes: &mut Notes,
) -> Vec<Row> {
    let plain = |axis: usize| {
        let is_plain = move |cell: &&[Cell; 2]| cell[axis].1.is_none();
        cells.iter().filter(is_plain).map(move |cell| cell[axis].0)
    };
    let strain = match (given.strain, columns[0].unit(&STRAIN)) {
        (Some(unit), _) => notes.unit(&STRAIN, columns, unit.name(), "as asked", unit.factor()),
        (None, Some((unit, factor))) => notes.unit(&STRAIN, columns, unit, "by the header", factor),
        (None, None) if plain(0).next().is_none() => {
            notes.unit(&STRAIN, columns, "%", "by the cells", 1.0)
        }
        (None, None) => {
            let most = plain(0).map(f64::abs).fold(0.0, f64::max);
            let unit =
                if most > MOST_FRACTION { StrainUnit::Percent } else { StrainUnit::Fraction };
            notes.guessed.strain = Some(unit);
            notes.unit(
                &STRAIN,
                columns,
                unit.name(),
                "guessed by the size of the numbers",
                unit.factor(),
            )
        }
    };
    let strain_of = |cell: &[Cell; 2]| cell[0].0 * cell[0].1.unwrap_or(strain);
    let stress = match (given.stress, columns[1].unit(&STRESS)) {
        (Some(unit), _) => notes.unit(&STRESS, columns, unit.name(), "as asked", unit.factor()),
        (None, Some((unit, factor))) => notes.unit(&STRESS, columns, unit, "by the header", factor),
        (None, None) if plain(1).next().is_none() => {
            notes.unit(&STRESS, columns, "kPa", "by the cells", 1.0)
        }
        (None, None) => {
            let off = |cell: &[Cell; 2]| (strain_of(cell) - COMPARED).abs();
            let near = cells
                .iter()
                .filter(|cell| cell[1].1.is_none())
                .min_by(|a, b| off(a).total_cmp(&off(b)));
            let at = near.map_or(1.0, |cell| (cell[1].0 * COMPARED / strain_of(cell)).abs());
            let unit = if at < LIKELY_KPA[0] {
                StressUnit::Mpa
            } else if at > LIKELY_KPA[1] {
                StressUnit::Pa
            } else {
                StressUnit::Kpa
            };
            notes.guessed.stress = Some(unit);
            notes.unit(
                &STRESS,
                columns,
                unit.name(),
                "guessed by the size of the numbers",
                unit.factor(),
            )
        }
    };
    let row = |cell: &[Cell; 2]| [strain_of(cell), cell[1].0 * cell[1].1.unwrap_or(stress)];
    cells.iter().map(row).collect()
}

impl Notes {
    /// Says column and unit of an axis; returns the unit's factor.
    fn unit(
        &mut self,
        axis: &Axis,
        columns: &[Column; 2],
        unit: &str,
        source: &str,
        factor: f64,
    ) -> f64 {
        let is_strain = axis.words == STRAIN.words;
        let Column { index, name } = &columns[usize::from(!is_strain)];
        let column = if name.is_empty() {
            format!("column {}", index + 1)
        } else {
            format!("“{}”", shortened(name))
        };
        self.say(if is_strain {
            format!("Strain: {column}, in {unit}, {source}.")
        } else {
            format!("Stress: {column}, in {unit}, {source}.")
        });
        factor
    }
}

/// A table of columns by spaces as one by tabs; another table as it is.
fn with_tabs(text: &str) -> Cow<'_, str> {
    let parts = |line: &str| {
        line.split_whitespace()
            .map(|part| part.trim_end_matches(',').to_owned())
            .collect::<Vec<_>>()
    };
    let is_numeric = |part: &String| {
        part.trim_start_matches(['-', '+', '.', ',']).starts_with(|c: char| c.is_ascii_digit())
    };
    let is_row = |line: &&str| {
        line.trim_start_matches(['-', '+', '.', ' ']).starts_with(|c: char| c.is_ascii_digit())
    };
    let mut rows = text.lines().map(str::trim).filter(is_row).peekable();
    let is_spaced = rows.peek().is_some()
        && !text.contains(['\t', ';', '"'])
        && rows.all(|line| parts(line).len() > 1 && parts(line).iter().all(is_numeric));
    if !is_spaced {
        return Cow::Borrowed(text);
    }
    // A unit in brackets belongs to the word before.
    let line = |line: &str| parts(&line.replace(" (", "(").replace(" [", "[")).join("\t");
    Cow::Owned(text.lines().map(line).collect::<Vec<_>>().join("\n"))
}

/// A curve of points, alone, in a layer or in a scene.
#[derive(serde::Deserialize)]
struct Holder {
    points: Option<List<Pair, MAX_POINTS>>,
    curve: Option<Box<Holder>>,
    layers: Option<List<Holder, 8>>,
}

impl Holder {
    fn into_points(self) -> Vec<Vec<Pair>> {
        let within = self.layers.into_iter().flat_map(|layers| layers.0);
        let within = within.chain(self.curve.map(|curve| *curve)).flat_map(Self::into_points);
        self.points.into_iter().map(|points| points.0).chain(within).collect()
    }
}

/// The points of a JSON text: a list of pairs, or an object with one curve of points.
fn json_points(text: &str) -> Result<Vec<Row>, TensileError> {
    let error = |error: serde_json::Error| TensileError(error.to_string());
    let mut found = if text.trim_start().starts_with('[') {
        vec![serde_json::from_str::<List<Pair, MAX_POINTS>>(text).map_err(error)?.0]
    } else {
        serde_json::from_str::<Holder>(text).map_err(error)?.into_points()
    };
    match (found.pop(), found.len()) {
        (Some(points), 0) => Ok(points.into_iter().map(|point| point.0).collect()),
        (_, others) => Err(TensileError(format!(
            "{} curves of points; allowed: one list of points [strain, stress]",
            if others == 0 { 0 } else { others + 1 }
        ))),
    }
}
