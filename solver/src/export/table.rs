//! Tables: comma-separated values with a point as the decimal separator.

use crate::measure::Meridian;
use std::fmt::Write;

/// Formats a number for a table: ten significant digits, no trailing zeros.
#[must_use]
pub fn number(value: f64) -> String {
    let digits = format!("{value:.9e}");
    digits
        .parse::<f64>()
        .map_or(digits, |rounded| if rounded == 0.0 { "0".to_owned() } else { rounded.to_string() })
}

/// Formats a text for a table: quoted if it contains a comma, a quote or a line break.
#[must_use]
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\r', '\n']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// Rows of cells as a table by RFC 4180: lines end with CR LF, cells are [`quoted`] where they must be.
#[must_use]
pub fn csv(rows: &[Vec<String>]) -> String {
    let cell = |text: &String| quoted(text);
    let line = |row: &Vec<String>| row.iter().map(cell).collect::<Vec<_>>().join(",") + "\r\n";
    rows.iter().map(line).collect()
}

/// The meridians as a table: surface and direction, arc length at rest `s_mm`, distance from the axis `r_mm`, height `z_mm`, stretches \[-\].
#[must_use]
pub fn profile(meridians: &[Meridian]) -> String {
    let mut table = "surface,direction,s_mm,r_mm,z_mm,stretch_meridional,stretch_hoop\n".to_owned();
    for Meridian { surface, direction, points } in meridians {
        for p in points {
            let row = [p.s_mm, p.r_mm, p.z_mm, p.stretch_meridional, p.stretch_hoop].map(number);
            // Writing to a String cannot fail.
            let _ = writeln!(table, "{surface},{},{}", direction.word(), row.join(","));
        }
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_with_commas_are_quoted() {
        assert_eq!(quoted("skin"), "skin");
        assert_eq!(quoted("a,\"b\".json"), "\"a,\"\"b\"\".json\"");
    }

    #[test]
    fn a_table_is_read_back_cell_by_cell() {
        let rows: Vec<Vec<String>> =
            [["a", "b, c", "d \"e\""], ["", "f\r\ng", "1.5"], ["é", "\"", ","]]
                .map(|row| row.map(str::to_owned).to_vec())
                .to_vec();
        let text = csv(&rows);
        let mut read = ::csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        let read: Vec<Vec<String>> = read.deserialize().map(Result::unwrap).collect();
        assert_eq!(read, rows);
        assert_eq!(csv(&rows[..1]), "a,\"b, c\",\"d \"\"e\"\"\"\r\n");
    }

    #[test]
    fn numbers_keep_ten_digits_and_drop_the_rest() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-0.0), "0");
        assert_eq!(number(40.000_000_000_001), "40");
        assert_eq!(number(1.0 / 3.0), "0.3333333333");
    }
}
