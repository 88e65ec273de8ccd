//! A table of a measured curve as text: a strain and a stress per line.

use crate::app::widgets::{Kind, quantity};

/// Reads a strain and a stress \[kPa\] per line, separated by a tab, a semicolon, spaces or a comma. Numbers may have
/// units, and decimal commas if another separator stands between the numbers. Headings and empty lines are skipped; the
/// origin is added. `is_percent`: strains without a unit are percent.
///
/// # Errors
/// Returns one line with the number of the line and the reason.
pub(super) fn read(text: &str, is_percent: bool) -> Result<Vec<[f64; 2]>, String> {
    let mut points: Vec<[f64; 2]> = Vec::new();
    for (k, line) in text.lines().enumerate() {
        let line = line.trim();
        let is_heading = points.is_empty() && !line.contains(|c: char| c.is_ascii_digit());
        if line.is_empty() || is_heading {
            continue;
        }
        let at = |reason: String| format!("line {}: {reason}", k + 1);
        let [strain, stress] = fields(line).ok_or_else(|| {
            at("allowed: a strain and a stress, separated by a tab, a semicolon or a space"
                .to_owned())
        })?;
        let value = quantity::parse(strain, Kind::Fraction).map_err(at)?;
        let strain = if is_percent && !strain.ends_with('%') {
            quantity::significant(0.01 * value)
        } else {
            value
        };
        let stress = quantity::parse(stress, Kind::Stress).map_err(at)?;
        if points.is_empty() && strain > 0.0 {
            points.push([0.0, 0.0]);
        }
        points.push([strain, stress]);
    }
    if points.is_empty() { Err("no line has a strain and a stress".to_owned()) } else { Ok(points) }
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
            assert_eq!(read(text, false).as_deref(), Ok(&expected[..]), "{text}");
        }
        assert_eq!(read("10 2.5\n45 120", true).as_deref(), Ok(&expected[..]));
        assert_eq!(read("10 %;2.5\n45;120", true).as_deref(), Ok(&expected[..]));
    }

    #[test]
    fn a_line_that_is_no_point_is_named() {
        for (text, start) in [
            ("", "no line"),
            ("strain stress", "no line"),
            ("0.1 2\n0.2", "line 2: allowed"),
            ("0.1 2 3", "line 1: allowed"),
            ("0,1,2,5", "line 1: allowed"),
            ("0.1 2\n\nx 3", "line 3: “x” is not a number"),
            ("0.1\tNaN", "line 1: “NaN” is not a number"),
            ("0.1\t2 mm", "line 1: “mm” is not a unit of stress"),
            ("0.1;1e999", "line 1: “1e999”"),
        ] {
            let reason = read(text, false).unwrap_err();
            assert!(reason.starts_with(start) && !reason.contains('\n'), "{text:?}: {reason}");
        }
    }
}
