//! Tables: comma-separated values with a point as the decimal separator.

use crate::measure::Outcome;

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

/// Reads a table by the grammar of RFC 4180, to test tables.
///
/// # Panics
/// At the first sign against the grammar.
#[must_use]
pub fn read_csv(text: &str) -> Vec<Vec<String>> {
    let mut rows = vec![vec![]];
    let mut signs = text.chars().peekable();
    while signs.peek().is_some() {
        let mut cell = String::new();
        if signs.next_if_eq(&'"').is_some() {
            loop {
                match signs.next().expect("an open quote") {
                    '"' if signs.next_if_eq(&'"').is_none() => break,
                    c => cell.push(c),
                }
            }
        } else {
            while let Some(c) = signs.next_if(|c| !",\r\n".contains(*c)) {
                assert_ne!(c, '"', "a quote within a cell");
                cell.push(c);
            }
        }
        rows.last_mut().expect("a row").push(cell);
        match signs.next() {
            Some(',') => assert!(signs.peek().is_some(), "a comma at the end"),
            Some('\r') => {
                assert_eq!(signs.next(), Some('\n'));
                rows.push(vec![]);
            }
            other => panic!("{other:?} after a cell"),
        }
    }
    assert_eq!(rows.pop(), Some(vec![]), "a last line without its end");
    rows
}

/// The profile of a result as a table: arc length `s_mm`, distance from the axis `r_mm`, height `z_mm`, stretches \[-\].
#[must_use]
pub fn profile(outcome: &Outcome) -> String {
    let mut table = "s_mm,r_mm,z_mm,stretch_meridional,stretch_hoop\n".to_owned();
    for p in &outcome.profile {
        let row = [p.s_mm, p.r_mm, p.z_mm, p.stretch_meridional, p.stretch_hoop].map(number);
        table += &row.join(",");
        table.push('\n');
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
        assert_eq!(read_csv(&csv(&rows)), rows);
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
