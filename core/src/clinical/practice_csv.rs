//! The practice table as a CSV.
//!
//! Columns in any order: `measure` (`base width`, `pull`, `fold`, `fill`), `is` (`at`, `below`, `above`), `value`, `unit` (`mm`, `cm`,
//! `%`), `volume_ml`, and optionally `source`, a text of one row or more. Decimals have a point or a comma in any cell: no number of
//! the table reaches the thousands that a sign before three digits could separate.

use super::limits;
use super::practice::{Bound, Corrected, Correction, PracticeTable, source_of};
use crate::curve::number;
use crate::table::{Table, first_row};
use std::fmt::Write as _;

/// Greatest number of rows.
const MAX_ROWS: usize = 200;
/// Allowed start volumes and corrections \[ml\].
const START_ML: (f64, f64) = (100.0, 1500.0);
const CORRECTION_ML: (f64, f64) = (-90.0, 300.0);
/// Allowed limits of a correction: lengths \[mm\], part of the envelope \[%\].
const LENGTH_MM: (f64, f64) = (1.0, 300.0);
const FILL_PERCENT: (f64, f64) = (0.0, 100.0);

const COLUMNS: [&str; 5] = ["measure", "is", "value", "unit", "volume_ml"];
const SOURCE: &str = "source";
const ALLOWED: &str = "allowed: measure, is, value, unit, volume_ml, source";

/// A row as read.
enum Row {
    Start([f64; 2]),
    Correction(Correction),
}

/// Has a table the columns of a practice table? Then it is no shelf.
#[must_use]
pub fn is_practice_table(text: &str) -> bool {
    let names = first_row(text);
    COLUMNS[..2].iter().all(|column| names.iter().any(|name| name.trim() == *column))
}

impl PracticeTable {
    /// Reads a table; the format is described in `docs/formats.md`.
    ///
    /// # Errors
    /// One line with the number of the line, what is wrong and what is allowed.
    pub fn from_csv(text: &str) -> Result<Self, String> {
        read(text)
    }

    /// The table as a CSV that [`Self::from_csv`] reads.
    #[must_use]
    pub fn to_csv(&self) -> String {
        write(self)
    }
}

fn read(text: &str) -> Result<PracticeTable, String> {
    let read = Table::read(text).map_err(|error| error.to_string())?;
    let mut rows = read.rows();
    let header = rows.next().ok_or_else(|| format!("no line; {ALLOWED}"))?;
    let names: Vec<&str> = header.cells().map(str::trim).collect();
    let place = |column: &str| names.iter().position(|name| *name == column);
    for name in &names {
        if names.iter().filter(|other| *other == name).count() > 1 {
            let error = format!("a second column “{}”; {ALLOWED}", shortened(name));
            return Err(at(header.line, &error));
        }
    }
    let mut places = [0; COLUMNS.len()];
    for (own, column) in places.iter_mut().zip(COLUMNS) {
        *own = place(column).ok_or_else(|| {
            at(header.line, &format!("the column “{column}” is missing; {ALLOWED}"))
        })?;
    }
    let mut table =
        PracticeTable { starts: Vec::new(), corrections: Vec::new(), source: String::new() };
    let mut sources: Vec<String> = Vec::new();
    for (count, cells) in rows.enumerate() {
        let line = cells.line;
        if count == MAX_ROWS {
            return Err(at(line, &format!("more rows; allowed: up to {MAX_ROWS}")));
        }
        if cells.cells().len() > names.len() {
            let (found, allowed) = (cells.cells().len(), names.len());
            let error = format!("{found} columns; allowed: {allowed}, as in the line of names");
            return Err(at(line, &error));
        }
        let cell = |place: usize| cells.cell(place).trim();
        match row(places.map(cell)).map_err(|error| at(line, &error))? {
            Row::Start(start) => {
                if table.starts.iter().any(|other| same(other[0], start[0])) {
                    let error = format!("a second volume for {} mm", number(start[0]));
                    return Err(at(line, &format!("{error}; allowed: one for each base width")));
                }
                table.starts.push(start);
            }
            Row::Correction(it) => {
                let is_equal = |other: &Correction| {
                    (other.of, other.bound) == (it.of, it.bound) && same(other.limit, it.limit)
                };
                if table.corrections.iter().any(is_equal) {
                    let error = "a second correction at this limit; allowed: one";
                    return Err(at(line, error));
                }
                table.corrections.push(it);
            }
        }
        let source = source_of(place(SOURCE).map_or("", cell));
        if !source.is_empty() && !sources.contains(&source) {
            sources.push(source);
        }
    }
    if table.starts.len() < 2 {
        return Err("fewer than 2 rows “base width”; allowed: 2 or more".to_owned());
    }
    table.starts.sort_by(|a, b| a[0].total_cmp(&b[0]));
    table.source = source_of(&sources.join("; "));
    Ok(table)
}

fn row([measure, is, value, unit, volume]: [&str; 5]) -> Result<Row, String> {
    if measure == "base width" {
        if is != "at" {
            return Err(format!("“is” is “{}”; allowed: at", shortened(is)));
        }
        let width = within(value, "value", length(unit)?, limits::MEASURED_WIDTH_MM)?;
        return Ok(Row::Start([width, within(volume, "volume_ml", 1.0, START_ML)?]));
    }
    let of = Corrected::ALL.into_iter().find(|of| of.name() == measure).ok_or_else(|| {
        format!("“measure” is “{}”; allowed: base width, pull, fold, fill", shortened(measure))
    })?;
    let bound = match is {
        "below" => Bound::Below,
        "above" => Bound::Above,
        _ => return Err(format!("“is” is “{}”; allowed: below, above", shortened(is))),
    };
    let limit = match of {
        Corrected::Pull | Corrected::Fold => within(value, "value", length(unit)?, LENGTH_MM)?,
        Corrected::Fill if unit == "%" => within(value, "value", 1.0, FILL_PERCENT)?,
        Corrected::Fill => {
            return Err(format!("“unit” is “{}”; allowed: %", shortened(unit)));
        }
    };
    let volume_ml = within(volume, "volume_ml", 1.0, CORRECTION_ML)?;
    Ok(Row::Correction(Correction { of, bound, limit, volume_ml }))
}

/// The factor from a unit of length to mm.
fn length(unit: &str) -> Result<f64, String> {
    match unit {
        "mm" => Ok(1.0),
        "cm" => Ok(10.0),
        _ => Err(format!("“unit” is “{}”; allowed: mm, cm", shortened(unit))),
    }
}

/// A number times a factor, within a range.
fn within(cell: &str, column: &str, factor: f64, (least, most): (f64, f64)) -> Result<f64, String> {
    let value = cell.replace(',', ".").replace('−', "-").parse::<f64>();
    // Ten digits: a length in cm is the same number in mm.
    let value = value.map(|value| (1e9 * factor * value).round() / 1e9);
    value.ok().filter(|value| (least..=most).contains(value)).ok_or_else(|| {
        let [least, most] = [least, most].map(|end| number(end / factor));
        format!("“{column}” is “{}”; allowed: a number from {least} to {most}", shortened(cell))
    })
}

fn shortened(cell: &str) -> String {
    source_of(cell).chars().take(40).collect()
}

fn same(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-6
}

fn at(line: usize, error: &str) -> String {
    format!("line {line}: {error}")
}

fn write(table: &PracticeTable) -> String {
    let mut text = format!("{};{SOURCE}\n", COLUMNS.join(";"));
    let mut source = format!("\"{}\"", table.source.replace('"', "\"\""));
    let mut line = |row: String| {
        // Writing to a String cannot fail; the source stands in the first row.
        let _ = writeln!(text, "{row};{}", std::mem::take(&mut source));
    };
    for [width, volume] in &table.starts {
        line(format!("base width;at;{};cm;{volume}", tenth(*width)));
    }
    for Correction { of, bound, limit, volume_ml } in &table.corrections {
        let is = match bound {
            Bound::Below => "below",
            Bound::Above => "above",
        };
        let (value, unit) = match of {
            Corrected::Fill => (limit.to_string(), "%"),
            Corrected::Pull | Corrected::Fold => (tenth(*limit), "cm"),
        };
        line(format!("{};{is};{value};{unit};{volume_ml}", of.name()));
    }
    text
}

/// A length \[mm\] in cm, to the digits of [`within`].
fn tenth(mm: f64) -> String {
    ((1e10 * (mm / 10.0)).round() / 1e10).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_built_in_table_is_the_same_after_its_own_csv() {
        let table = PracticeTable::default();
        let text = table.to_csv();
        assert!(text.starts_with(
            "measure;is;value;unit;volume_ml;source\nbase width;at;10.5;cm;200;\"Tebbetts"
        ));
        assert!(text.contains("\nfold;above;9.5;cm;30;\nfill;below;20;%;30;\n"), "{text}");
        assert_eq!(PracticeTable::from_csv(&text), Ok(table.clone()));
        assert!(table.is_built_in() && is_practice_table(&text));
        assert!(!is_practice_table("name;width_cm;volume_ml\nA;12;300"));
    }

    #[test]
    fn a_table_of_a_spreadsheet_in_any_order_of_columns_and_rows_is_read() {
        let text = "\u{feff}volume_ml\tunit\tvalue\tis\tmeasure\r\n320\tcm\t12,5\tat\tbase width\r\n\r\n250\tmm\t110\tat\tbase width\r\n−20\tcm\t2,2\tbelow\tpull\r\n";
        let table = PracticeTable::from_csv(text).unwrap();
        assert_eq!(table.starts(), [[110.0, 250.0], [125.0, 320.0]]);
        let expected =
            Correction { of: Corrected::Pull, bound: Bound::Below, limit: 22.0, volume_ml: -20.0 };
        assert_eq!((table.corrections(), table.source()), (&[expected][..], ""));
        assert!(!table.is_built_in());
    }

    #[test]
    fn every_form_of_a_table_is_read() {
        let table = PracticeTable::from_csv(
            "measure;is;value;unit;volume_ml;source\nbase width;at;11;cm;250;A, B\nbase width;at;12.5;cm;320;",
        );
        let table = table.unwrap();
        for (text, source) in [
            (
                "sep=;\rmeasure;is;value;unit;volume_ml;source;\rbase width;at;11;cm;250;\"A,\rB\";\r;;;\rbase width;at;12,5;cm;320;;\r",
                "A, B",
            ),
            (
                "measure,is,value,unit,volume_ml,source\r\nbase width,at,110,mm,250,\"A, B\"\r\nbase width,at,\"12,5\",cm,320,\r\n",
                "A, B",
            ),
            (
                "sep=|\nmeasure|is|value|unit|volume_ml\nbase width|at|11|cm|250\nbase width|at|12.5|cm|320",
                "",
            ),
        ] {
            assert!(is_practice_table(text), "{text:?}");
            let found = PracticeTable::from_csv(text).unwrap();
            assert_eq!((found.starts(), found.source()), (table.starts(), source), "{text:?}");
        }
        let error = PracticeTable::from_csv("measure;is\r\"base;at").unwrap_err();
        assert!(error.starts_with("line 2: a quotation mark is not closed; "), "{error}");
    }

    #[test]
    fn errors_have_the_line_and_what_is_allowed() {
        let head = "measure;is;value;unit;volume_ml;source";
        let starts = "base width;at;11;cm;250\nbase width;at;12;cm;300";
        for (text, error) in [
            (String::new(), "no line; allowed: measure, is, value, unit, volume_ml, source"),
            ("measure;is;value;volume_ml".to_owned(), "line 1: the column “unit” is missing; "),
            (format!("{head};is"), "line 1: a second column “is”; "),
            (head.to_owned(), "fewer than 2 rows “base width”; allowed: 2 or more"),
            (
                format!("{head}\nheight;at;12;cm;300"),
                "line 2: “measure” is “height”; allowed: base width, ",
            ),
            (format!("{head}\nbase width;above;12;cm;300"), "line 2: “is” is “above”; allowed: at"),
            (format!("{head}\npull;at;2;cm;30"), "line 2: “is” is “at”; allowed: below, above"),
            (format!("{head}\npull;above;2;%;30"), "line 2: “unit” is “%”; allowed: mm, cm"),
            (format!("{head}\nfill;above;2;cm;30"), "line 2: “unit” is “cm”; allowed: %"),
            (
                format!("{head}\nbase width;at;1.2;cm;300"),
                "line 2: “value” is “1.2”; allowed: a number from 6 to 24",
            ),
            (
                format!("{head}\n\nbase width;at;12;cm;NaN"),
                "line 3: “volume_ml” is “NaN”; allowed: a number from 100 to 1500",
            ),
            (
                format!("{head}\npull;below;2;cm;-400"),
                "line 2: “volume_ml” is “-400”; allowed: a number from -90 to 300",
            ),
            (
                format!("{head}\n{starts}\nbase width;at;120;mm;310"),
                "line 4: a second volume for 120 mm; allowed: one for each base width",
            ),
            (
                format!("{head}\npull;below;2;cm;-30\npull;below;20;mm;-30"),
                "line 3: a second correction at this limit; allowed: one",
            ),
            (format!("{head}\nbase width;at;12;cm;300;a;b"), "line 2: 7 columns; allowed: 6, "),
        ] {
            let found = PracticeTable::from_csv(&text).unwrap_err();
            assert!(found.starts_with(error) && !found.contains('\n'), "{found}");
        }
        assert!(PracticeTable::from_csv(&format!("{head}\n{starts}")).is_ok());
    }
}
