//! The clinic's shelf: the sizes at hand, read from a table.
//!
//! A table has a line of column names and a line for each size. Columns are separated by semicolons, tabs or commas; decimals
//! have a point or a comma; a text in double quotes may contain a separator. Names of columns, in any order: `name`,
//! `width_mm` or `width_cm`, and `projection_mm`, `projection_cm` or `volume_ml`; other columns are ignored.

use super::{Size, limits};
use crate::curve::number;
use std::fmt::Write as _;

/// Greatest number of sizes.
pub const MAX_SIZES: usize = 500;
/// Greatest length of a name \[characters\].
const MAX_NAME: usize = 60;
/// What a line of column names needs.
const COLUMNS: &str =
    "allowed: name, width_mm or width_cm, and projection_mm, projection_cm or volume_ml";
/// Names of columns, without what is no letter or digit.
const NAMES: [&str; 5] = ["name", "size", "model", "product", "reference"];
const WIDTHS: [&str; 4] = ["width", "basewidth", "base", "diameter"];
const PROJECTIONS: [&str; 2] = ["projection", "height"];
const VOLUMES: [&str; 2] = ["volume", "vol"];

/// The number beside the width that a size lists.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Listed {
    /// Projection \[mm\].
    Projection(f64),
    /// Volume \[ml\].
    Volume(f64),
}

/// A size of the shelf.
#[derive(Clone, Debug, PartialEq)]
pub struct ShelfSize {
    name: String,
    width_mm: f64,
    listed: Listed,
    size: Size,
}

impl ShelfSize {
    /// The name, different for every size of a shelf.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Base width \[mm\], as listed.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        self.width_mm
    }

    /// Projection or volume, as listed.
    #[must_use]
    pub fn listed(&self) -> Listed {
        self.listed
    }

    /// Width, projection and volume of the dome.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }
}

/// The sizes of a clinic, in the order of their table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shelf {
    sizes: Vec<ShelfSize>,
}

/// A column of a table, with the factor from its number to mm or ml.
#[derive(Clone, Copy, PartialEq)]
enum Column {
    Name,
    Width(f64),
    Projection(f64),
    Volume,
}

impl Shelf {
    /// Reads a table.
    ///
    /// # Errors
    /// One line with the number of the line, what is wrong and what is allowed.
    pub fn from_csv(text: &str) -> Result<Self, String> {
        let text = text.trim_start_matches('\u{feff}');
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let (first, header) = lines.next().ok_or_else(|| format!("no line; {COLUMNS}"))?;
        let separator = [';', '\t', ','].into_iter().find(|separator| header.contains(*separator));
        let separator =
            separator.ok_or_else(|| format!("line {}: one column; {COLUMNS}", first + 1))?;
        let columns = columns(header, separator).map_err(|error| at(first, &error))?;
        let mut sizes: Vec<ShelfSize> = Vec::new();
        for (index, line) in lines {
            if sizes.len() == MAX_SIZES {
                return Err(at(index, &format!("more sizes; allowed: up to {MAX_SIZES}")));
            }
            let size = size(line, separator, &columns).map_err(|error| at(index, &error))?;
            if sizes.iter().any(|other| other.name == size.name) {
                let error = format!("a second size “{}”; allowed: different names", size.name);
                return Err(at(index, &error));
            }
            sizes.push(size);
        }
        match sizes.is_empty() {
            true => Err("no size below the names of the columns; allowed: 1 to 500".to_owned()),
            false => Ok(Self { sizes }),
        }
    }

    /// The sizes as a table that [`Self::from_csv`] reads; empty without a size.
    #[must_use]
    pub fn to_csv(&self) -> String {
        if self.sizes.is_empty() {
            return String::new();
        }
        let mut text = "name;width_mm;projection_mm;volume_ml\n".to_owned();
        for size in &self.sizes {
            let name = size.name.replace('"', "\"\"");
            let [projection, volume] = match size.listed {
                Listed::Projection(projection) => [projection.to_string(), String::new()],
                Listed::Volume(volume) => [String::new(), volume.to_string()],
            };
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\"{name}\";{};{projection};{volume}", size.width_mm);
        }
        text
    }

    /// The sizes.
    #[must_use]
    pub fn sizes(&self) -> &[ShelfSize] {
        &self.sizes
    }

    /// Removes the size of an index.
    pub fn remove(&mut self, index: usize) {
        if index < self.sizes.len() {
            self.sizes.remove(index);
        }
    }

    /// The name of the size with this width and projection \[mm\], to rounding.
    #[must_use]
    pub fn name_of(&self, width_mm: f64, projection_mm: f64) -> Option<&str> {
        const ROUNDING_MM: f64 = 1e-6;
        let is_equal = |size: &&ShelfSize| {
            (size.width_mm - width_mm).abs() < ROUNDING_MM
                && (size.size.projection_mm() - projection_mm).abs() < ROUNDING_MM
        };
        self.sizes.iter().find(is_equal).map(ShelfSize::name)
    }
}

fn at(index: usize, error: &str) -> String {
    format!("line {}: {error}", index + 1)
}

/// The cells of a line, without the quotes around them.
pub(super) fn cells(line: &str, separator: char) -> Vec<String> {
    let (mut cells, mut is_quoted) = (vec![String::new()], false);
    let mut letters = line.chars().peekable();
    while let Some(letter) = letters.next() {
        let Some(cell) = cells.last_mut() else { break };
        match letter {
            '"' if is_quoted && letters.peek() == Some(&'"') => {
                letters.next();
                cell.push('"');
            }
            '"' => is_quoted = !is_quoted,
            letter if letter == separator && !is_quoted => cells.push(String::new()),
            letter => cell.push(letter),
        }
    }
    cells.iter().map(|cell| cell.trim().to_owned()).collect()
}

/// The columns of a line of names; columns of other names are `None`.
fn columns(line: &str, separator: char) -> Result<Vec<Option<Column>>, String> {
    let mut columns = Vec::new();
    for cell in cells(line, separator) {
        let column = column(&cell)?;
        if column.is_some_and(|column| has(&columns, column)) {
            return Err(format!("a second column like “{cell}”; {COLUMNS}"));
        }
        columns.push(column);
    }
    let is_missing = |column| !has(&columns, column);
    if is_missing(Column::Name) || is_missing(Column::Width(1.0)) {
        return Err(format!("no column of names or none of widths; {COLUMNS}"));
    }
    if is_missing(Column::Projection(1.0)) && is_missing(Column::Volume) {
        return Err(format!("no column of projections or volumes; {COLUMNS}"));
    }
    Ok(columns)
}

/// Is a column of the same kind among the columns?
fn has(columns: &[Option<Column>], column: Column) -> bool {
    let kind = std::mem::discriminant(&column);
    columns.iter().flatten().any(|other| std::mem::discriminant(other) == kind)
}

/// The column of a name, as "Width (cm)"; `None` for another name.
fn column(cell: &str) -> Result<Option<Column>, String> {
    let letters = cell.chars().filter(|letter| letter.is_alphanumeric());
    let name: String = letters.flat_map(char::to_lowercase).collect();
    let units = [("mm", 1.0), ("cm", 10.0), ("ml", 1.0), ("cc", 1.0), ("cm3", 1.0), ("cm³", 1.0)];
    let unit = |names: &[&str]| {
        let rest = names.iter().find_map(|known| name.strip_prefix(known))?;
        units.into_iter().find(|(unit, _)| *unit == rest)
    };
    let is_length = |(unit, _): &(&str, f64)| ["mm", "cm"].contains(unit);
    if NAMES.contains(&&*name) {
        return Ok(Some(Column::Name));
    }
    if let Some((_, factor)) = unit(&WIDTHS).filter(is_length) {
        return Ok(Some(Column::Width(factor)));
    }
    if let Some((_, factor)) = unit(&PROJECTIONS).filter(is_length) {
        return Ok(Some(Column::Projection(factor)));
    }
    let is_volume = unit(&VOLUMES).is_some_and(|unit| !is_length(&unit));
    if is_volume || [VOLUMES[0], VOLUMES[1], "ml", "cc"].contains(&&*name) {
        return Ok(Some(Column::Volume));
    }
    if WIDTHS.contains(&&*name) || PROJECTIONS.contains(&&*name) {
        return Err(format!("the column “{cell}” has no unit; {COLUMNS}"));
    }
    Ok(None)
}

/// The size of a line. A projection comes before a volume.
fn size(line: &str, separator: char, columns: &[Option<Column>]) -> Result<ShelfSize, String> {
    let cells = cells(line, separator);
    if cells.len() != columns.len() {
        let (found, allowed) = (cells.len(), columns.len());
        return Err(format!("{found} columns; allowed: {allowed}, as in the line of names"));
    }
    let (mut name, mut width_mm, mut projection_mm, mut volume_ml) =
        (String::new(), None, None, None);
    for (cell, column) in cells.into_iter().zip(columns) {
        let (least, most) = (limits::BASE_WIDTH_MM, limits::PROJECTION_MM);
        match column {
            Some(Column::Name) => name = cell,
            Some(Column::Width(factor)) => {
                width_mm = Some(value("width", &cell, *factor, least)?);
            }
            Some(Column::Projection(factor)) if !cell.is_empty() => {
                projection_mm = Some(value("projection", &cell, *factor, most)?);
            }
            Some(Column::Volume) if !cell.is_empty() => {
                volume_ml = Some(value("volume", &cell, 1.0, (0.4, 3620.0))?);
            }
            _ => {}
        }
    }
    let length = name.chars().count();
    if !(1..=MAX_NAME).contains(&length) {
        return Err(format!("a name of {length} characters; allowed: 1 to {MAX_NAME}"));
    }
    let width_mm = width_mm.unwrap_or_default();
    let (listed, size) = match (projection_mm, volume_ml) {
        (Some(projection), _) => {
            (Listed::Projection(projection), Size::of_width_and_projection(width_mm, projection))
        }
        (None, Some(volume)) => {
            (Listed::Volume(volume), Size::of_width_and_volume(width_mm, volume))
        }
        (None, None) => {
            return Err(format!("“{name}” has neither; allowed: a projection or a volume"));
        }
    };
    let size = size.map_err(|error| error.to_string())?;
    Ok(ShelfSize { name, width_mm, listed, size })
}

/// A number of a cell in mm or ml; the decimals may have a comma.
fn value(what: &str, cell: &str, factor: f64, (least, most): (f64, f64)) -> Result<f64, String> {
    let read = cell.replace(',', ".").parse::<f64>().ok();
    // To the digits of the table: 12.3 cm are 123 mm.
    let value =
        read.map(|value| if factor > 1.0 { (value * factor * 1e6).round() / 1e6 } else { value });
    value.filter(|value| (least..=most).contains(value)).ok_or_else(|| {
        let [least, most] = [least / factor, most / factor].map(number);
        format!("the {what} is “{cell}”; allowed: a number from {least} to {most}")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_all_forms_have_the_same_sizes() {
        let expected =
            Shelf::from_csv("name,width_mm,volume_ml\nRound 300,123,300\nHigh,115,280").unwrap();
        assert_eq!(expected.sizes()[0].listed(), Listed::Volume(300.0));
        for text in [
            "Name;Width (cm);Volume (cc)\nRound 300;12,3;300\nHigh;11.5;280\n",
            "\u{feff}volume\tprice\twidth_cm\tname\r\n300\t9\t12.3\tRound 300\r\n\r\n280\t\t11,5\tHigh\r\n",
            "ml,\"Base width [mm]\",Size\n300,\"123,0\",Round 300\n280,115,High\n",
        ] {
            assert_eq!(Shelf::from_csv(text).as_ref(), Ok(&expected), "{text:?}");
        }
    }

    #[test]
    fn a_shelf_is_the_same_after_its_own_table() {
        let text = "name;width_cm;projection_cm;volume_ml\n\"A; \"\"flat\"\"\";12,3;3,7;\nB;11.1;;287.5\nC;10;3;250";
        let shelf = Shelf::from_csv(text).unwrap();
        assert_eq!(Shelf::from_csv(&shelf.to_csv()), Ok(shelf.clone()));
        let [a, b, c] = shelf.sizes() else { panic!("{shelf:?}") };
        assert_eq!(
            (a.name(), a.width_mm(), a.listed()),
            ("A; \"flat\"", 123.0, Listed::Projection(37.0))
        );
        assert_eq!((b.listed(), c.listed()), (Listed::Volume(287.5), Listed::Projection(30.0)));
        assert_eq!(shelf.name_of(111.0, b.size().projection_mm()), Some("B"));
        assert_eq!(shelf.name_of(111.0, 30.0), None);
        let mut fewer = shelf.clone();
        fewer.remove(0);
        fewer.remove(7);
        assert_eq!(
            (fewer.sizes(), Shelf::default().to_csv()),
            (&shelf.sizes()[1..], String::new())
        );
    }

    #[test]
    fn errors_have_the_line_and_what_is_allowed() {
        let head = "name;width_cm;volume_ml\n";
        for (text, error) in [
            (String::new(), "no line; allowed: name, "),
            ("name\nA".to_owned(), "line 1: one column; allowed: name, "),
            ("name;width;volume".to_owned(), "line 1: the column “width” has no unit; allowed: "),
            ("name;width_mm;width_cm".to_owned(), "line 1: a second column like “width_cm”; "),
            ("name;width_mm;price".to_owned(), "line 1: no column of projections or volumes; "),
            ("width_mm;volume".to_owned(), "line 1: no column of names or none of widths; "),
            (head.to_owned(), "no size below the names of the columns; allowed: 1 to 500"),
            (
                format!("{head}A;12;300\n\nB;x;3"),
                "line 4: the width is “x”; allowed: a number from 2 to 24",
            ),
            (
                format!("{head}A;12;NaN"),
                "line 2: the volume is “NaN”; allowed: a number from 0.4 to 3620",
            ),
            (format!("{head}A;12;300;1"), "line 2: 4 columns; allowed: 3, as in the line of names"),
            (format!("{head}A;12;"), "line 2: “A” has neither; allowed: a projection or a volume"),
            (format!("{head};12;300"), "line 2: a name of 0 characters; allowed: 1 to 60"),
            (
                format!("{head}A;12;300\nA;13;300"),
                "line 3: a second size “A”; allowed: different names",
            ),
            (
                format!("{head}A;3;3000"),
                "line 2: 3000 ml on a base of 30 mm gives a projection of ",
            ),
        ] {
            let found = Shelf::from_csv(&text).unwrap_err();
            assert!(found.starts_with(error) && !found.contains('\n'), "{found}");
        }
        let rows = |count: usize| (0..count).map(|k| format!("{k};12;300\n")).collect::<String>();
        assert!(Shelf::from_csv(&format!("{head}{}", rows(500))).is_ok());
        let error = Shelf::from_csv(&format!("{head}{}", rows(501))).unwrap_err();
        assert_eq!(error, "line 502: more sizes; allowed: up to 500");
    }
}
