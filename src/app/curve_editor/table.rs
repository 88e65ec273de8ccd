//! A table of a measured curve as text: a strain and a stress per line.

use crate::app::texts::tr;
use crate::app::widgets::{Kind, quantity};

/// What was read: points, and lines that are no points.
#[derive(Debug, PartialEq)]
pub(super) struct Table {
    pub(super) points: Vec<[f64; 2]>,
    /// Lines that were left out: number and reason, in one line each.
    pub(super) left_out: Vec<String>,
}

/// Reads a strain and a stress \[kPa\] per line, separated by a tab, a semicolon, spaces or a comma. Numbers may have
/// units, and decimal commas if another separator stands between the numbers. Headings and empty lines are skipped, lines that are no
/// point are left out; the origin is added. `is_percent`: strains without a unit are percent.
///
/// # Errors
/// Returns one line with the reason if no line is a point.
pub(super) fn read(text: &str, is_percent: bool) -> Result<Table, String> {
    let mut table = Table { points: Vec::new(), left_out: Vec::new() };
    for (k, line) in text.lines().enumerate() {
        let line = line.trim();
        let is_heading = table.points.is_empty() && !line.contains(|c: char| c.is_ascii_digit());
        if line.is_empty() || is_heading {
            continue;
        }
        match point(line, is_percent) {
            Ok(point) => {
                if table.points.is_empty() && point[0] > 0.0 {
                    table.points.push([0.0, 0.0]);
                }
                table.points.push(point);
            }
            Err(reason) => {
                table.left_out.push(tr!("line {line}: {error}", line = k + 1, error = reason));
            }
        }
    }
    match (table.points.is_empty(), table.left_out.first()) {
        (true, Some(first)) => Err(first.clone()),
        (true, None) => Err(tr("no line has a strain and a stress").to_owned()),
        (false, _) => Ok(table),
    }
}

/// The point of a line.
fn point(line: &str, is_percent: bool) -> Result<[f64; 2], String> {
    let [strain, stress] = fields(line).ok_or_else(|| {
        tr("allowed: a strain and a stress, separated by a tab, a semicolon or a space").to_owned()
    })?;
    let value = quantity::parse(strain, Kind::Fraction)?;
    let strain = if is_percent && !strain.ends_with('%') {
        quantity::significant(0.01 * value)
    } else {
        value
    };
    Ok([strain, quantity::parse(stress, Kind::Stress)?])
}

/// The two fields of a line; `None` for another number of fields.
fn fields(line: &str) -> Option<[&str; 2]> {
    let split: Vec<&str> =
        if let Some(separator) = ['\t', ';'].into_iter().find(|c| line.contains(*c)) {
            line.trim_end_matches(separator).split(separator).collect()
        } else if line.contains(char::is_whitespace) {
            line.split_whitespace().map(|field| field.trim_end_matches(',')).collect()
        } else {
            line.split(',').collect()
        };
    <[&str; 2]>::try_from(split).ok().map(|fields| fields.map(str::trim))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_spreadsheets_and_papers_are_read() {
        let expected = [[0.0, 0.0], [0.1, 2.5], [0.45, 120.0]];
        for text in [
            "0.1\t2.5\n0.45\t120\n",
            "0,1\t2,5\r\n0,45\t120\r\n",
            "strain;stress (kPa)\n0;0\n0,1;2,5\n0,45;120;",
            "0.1,2.5\n0.45,120",
            "0.1, 2.5\n\n0.45, 120",
            "0,1 2,5\n0,45   120",
            "10 %\t2500 Pa\n45%\t0.12 MPa",
        ] {
            let table = Table { points: expected.to_vec(), left_out: Vec::new() };
            assert_eq!(read(text, false), Ok(table), "{text}");
        }
        for text in ["10 2.5\n45 120", "10 %;2.5\n45;120"] {
            assert_eq!(read(text, true).unwrap().points, expected, "{text}");
        }
    }

    #[test]
    fn a_line_that_is_no_point_is_named() {
        for (text, start) in [
            ("", "no line"),
            ("strain stress", "no line"),
            ("0.1 2 3", "line 1: allowed"),
            ("0,1,2,5", "line 1: allowed"),
            ("0.1\tNaN", "line 1: “NaN” is not a number"),
            ("0.1\t2 mm", "line 1: “mm” is not a unit of stress"),
            ("0.1;1e999", "line 1: “1e999”"),
        ] {
            let reason = read(text, false).unwrap_err();
            assert!(reason.starts_with(start) && !reason.contains('\n'), "{text:?}: {reason}");
        }
    }

    #[test]
    fn a_line_that_is_no_point_is_left_out_with_its_reason_and_the_others_are_kept() {
        let table = read("strain stress\n0.1 2\n\nx 3\n0.2\n0.45 120", false).unwrap();
        assert_eq!(table.points, [[0.0, 0.0], [0.1, 2.0], [0.45, 120.0]]);
        let [number, fields] = &table.left_out[..] else { panic!("{table:?}") };
        assert!(number.starts_with("line 4: “x” is not a number"), "{number}");
        assert!(fields.starts_with("line 5: allowed: a strain and a stress"), "{fields}");
    }
}
