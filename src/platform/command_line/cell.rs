//! Cells of a table: one row a line, and any JSON value in a cell.

use csv::{ReaderBuilder, StringRecord, WriterBuilder};
use serde::de::IgnoredAny;
use serde_json::Value;

/// A row with its line end. Cells without line breaks give one line.
pub(super) fn row(cells: impl IntoIterator<Item = String>) -> String {
    let mut writer = WriterBuilder::new().from_writer(Vec::new());
    // Memory takes every row.
    let _ = writer.write_record(cells);
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

/// The cells of a line.
pub(super) fn split(line: &str) -> Result<StringRecord, String> {
    if line.matches('"').count() % 2 == 1 {
        return Err("a quotation mark is not closed; allowed: one row a line".to_owned());
    }
    let mut cells = StringRecord::new();
    let mut reader = ReaderBuilder::new().has_headers(false).from_reader(line.as_bytes());
    reader.read_record(&mut cells).map_err(|error| error.to_string())?;
    Ok(cells)
}

/// The cell of a value: nothing for null, plain text for a text, else JSON.
pub(super) fn of_value(value: &Value) -> String {
    match value {
        Value::Null => String::new(),
        value => of_json(&value.to_string()),
    }
}

/// The cell of JSON text: plain for a text that reads as itself in one line, else the JSON.
pub(super) fn of_json(json: &str) -> String {
    match serde_json::from_str::<String>(json) {
        Ok(text) if !text.contains(char::is_control) && to_json(&text).as_deref() == Some(json) => {
            text
        }
        _ => json.to_owned(),
    }
}

/// The JSON text of a cell; `None` for an empty one and for null.
pub(super) fn to_json(cell: &str) -> Option<String> {
    match cell.trim() {
        "" | "null" => None,
        json if serde_json::from_str::<IgnoredAny>(json).is_ok() => Some(json.to_owned()),
        _ => Some(Value::from(cell).to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_has_the_json_that_it_was_written_from() {
        for (json, cell) in [
            (r#""a""#, "a"),
            ("7", "7"),
            (r#""7""#, r#""7""#),
            ("0.10", "0.10"),
            (r#""null""#, r#""null""#),
            (r#""""#, r#""""#),
            (r#"" ""#, r#"" ""#),
            (r#"" a""#, " a"),
            (r#""a\nb""#, r#""a\nb""#),
            (r#""\u0061""#, r#""\u0061""#),
            (r#""say \"x\", y""#, r#"say "x", y"#),
            (r#"{"x":[1,2.5]}"#, r#"{"x":[1,2.5]}"#),
            ("true", "true"),
        ] {
            assert_eq!(of_json(json), cell);
            assert_eq!(to_json(cell).as_deref(), Some(json));
            let line = row([cell.to_owned(), "1".to_owned()]);
            assert_eq!(line.lines().count(), 1);
            assert_eq!(split(&line).unwrap().iter().collect::<Vec<_>>(), [cell, "1"]);
        }
        assert_eq!((to_json(""), to_json(" null ")), (None, None));
        assert_eq!(
            (of_value(&Value::Null), of_value(&Value::from(0.1))),
            (String::new(), "0.1".to_owned())
        );
        assert_eq!(
            split("a,\"b").unwrap_err(),
            "a quotation mark is not closed; allowed: one row a line"
        );
        assert_eq!(split("1,,2\r\n").unwrap().len(), 3);
    }
}
