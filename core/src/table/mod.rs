//! Tables as spreadsheets and instruments write them: text in UTF-8 or UTF-16; columns by commas, semicolons or tabs, or by what a
//! first line `sep=;` names; decimals by point or comma; rows that end with a carriage return, a line feed, or both; quoted cells.
//!
//! Small tables: [`decode`], then [`Table::read`]. Tables of any length: [`encoding`] and [`Form::of`] of their beginning, then
//! [`Rows`] and [`cells`].

mod encoding;
mod form;
mod number;
mod rows;

pub use encoding::{Encoding, NotText, decode, encoding, line_at};
pub use form::{Form, Shown, first_row};
pub use number::{Decimals, NumberError, Quantity};
pub use rows::{MAX_ROW_BYTES, RawRow, RowFault, Rows, cells};

/// Greatest length of a whole table \[bytes\].
pub const MAX_BYTES: usize = 10_000_000;
/// Length of the beginning that shows the form of a table \[bytes\].
pub const BEGINNING_BYTES: usize = 65_536;
/// Greatest number of cells of a whole table.
pub const MAX_CELLS: usize = 2_000_000;

/// A table as a whole: the rows that are not empty, names of columns and title lines among them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Table {
    form: Form,
    /// The texts of all cells, one behind the other.
    text: String,
    /// Where each cell ends in the text.
    ends: Vec<u32>,
    /// Of each row its line and the index of its first cell.
    rows: Vec<(u32, u32)>,
    columns: usize,
    empty_rows: usize,
}

/// A row of a table.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    table: &'a Table,
    /// The line on which the row begins, from 1.
    pub line: usize,
    /// Index of the first cell, and behind the last one.
    cells: (usize, usize),
}

/// Error of a table, in one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TableError {
    /// A row cannot be divided into cells.
    #[error("line {line}: {fault}")]
    Row {
        /// The line, from 1.
        line: usize,
        /// What is wrong.
        fault: RowFault,
    },
    /// The table is longer than [`MAX_BYTES`], or has more cells than [`MAX_CELLS`].
    #[error("the table has {0}; allowed: up to {1}")]
    TooLong(String, &'static str),
    /// A cell is not one number.
    #[error("line {line}, {column}: {error}")]
    Number {
        /// The line, from 1.
        line: usize,
        /// The name of the column.
        column: String,
        /// What is wrong.
        error: NumberError,
    },
}

impl Table {
    /// Reads a table, whose form is recognised. Blank rows and rows of empty cells are counted and left out, and so are columns at
    /// the end that have no text in any row.
    ///
    /// # Errors
    /// A quotation mark without its partner, with its line; a table that is too long.
    pub fn read(text: &str) -> Result<Self, TableError> {
        let form = Form::of(form::beginning(text));
        let mut table = Self::read_as(text, form)?;
        let mut shown = Shown::default();
        table.rows().flat_map(Row::cells).for_each(|cell| shown.add(cell));
        table.form = form.with_decimals(shown);
        Ok(table)
    }

    /// Reads a table of a known form.
    ///
    /// # Errors
    /// As of [`Self::read`].
    pub fn read_as(text: &str, form: Form) -> Result<Self, TableError> {
        let text = text.trim_start_matches('\u{feff}');
        if text.len() > MAX_BYTES {
            return Err(TableError::TooLong(format!("{} bytes", text.len()), "10 MB"));
        }
        let separator = form.separator();
        let mut table = Self {
            form,
            text: String::new(),
            ends: Vec::new(),
            rows: Vec::new(),
            columns: 0,
            empty_rows: 0,
        };
        let mut rows = Rows::new(text.as_bytes(), separator);
        let mut row = RawRow::default();
        let (mut columns, mut blank, mut is_first) = (0, 0, true);
        // Memory is always read.
        while rows.read_row(&mut row).unwrap_or_default() {
            if let Some(fault) = row.fault {
                return Err(TableError::Row { line: row.line, fault });
            }
            if std::mem::take(&mut is_first) && form.has_separator_line {
                continue;
            }
            if row.is_empty(separator) {
                blank += 1;
                // Blank lines at the end are not rows.
                if row.bytes.contains(&separator) {
                    table.empty_rows += std::mem::take(&mut blank);
                }
                continue;
            }
            table.empty_rows += std::mem::take(&mut blank);
            let start = table.ends.len();
            table.rows.push((to_u32(row.line), to_u32(start)));
            for cell in cells(std::str::from_utf8(&row.bytes).unwrap_or_default(), separator) {
                table.text.push_str(&cell);
                table.ends.push(to_u32(table.text.len()));
                if !cell.trim().is_empty() {
                    columns = columns.max(table.ends.len() - start);
                }
                if table.ends.len() > MAX_CELLS {
                    let line = format!("more than {MAX_CELLS} cells");
                    return Err(TableError::TooLong(line, "2 million"));
                }
            }
        }
        table.columns = columns;
        Ok(table)
    }

    /// Separator and decimal sign.
    #[must_use]
    pub fn form(&self) -> Form {
        self.form
    }

    /// Number of columns: up to the last one with a text.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Number of blank rows and rows of empty cells that were left out; blank lines at the end are not counted.
    #[must_use]
    pub fn empty_rows(&self) -> usize {
        self.empty_rows
    }

    /// The rows in their order.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = Row<'_>> + Clone {
        self.rows.iter().enumerate().map(|(k, (line, start))| {
            let start = *start as usize;
            let end = self.rows.get(k + 1).map_or(self.ends.len(), |next| next.1 as usize);
            let cells = (start, end.min(start + self.columns));
            Row { table: self, line: *line as usize, cells }
        })
    }
}

impl<'a> Row<'a> {
    /// The texts of the cells; a row may have fewer than the table has columns.
    pub fn cells(self) -> impl ExactSizeIterator<Item = &'a str> + Clone {
        let Table { text, ends, .. } = self.table;
        (self.cells.0..self.cells.1).map(move |k| {
            let start = k.checked_sub(1).map_or(0, |before| ends[before] as usize);
            &text[start..ends[k] as usize]
        })
    }

    /// The text of a cell; empty where the row has none.
    #[must_use]
    pub fn cell(self, column: usize) -> &'a str {
        self.cells().nth(column).unwrap_or_default()
    }

    /// The number of a cell and the unit behind it; messages name the column.
    ///
    /// # Errors
    /// The cell is not one number, in one line.
    pub fn number(self, column: usize, name: &str) -> Result<Quantity<'a>, TableError> {
        self.table.form.decimals.read(self.cell(column)).map_err(|error| TableError::Number {
            line: self.line,
            column: name.to_owned(),
            error,
        })
    }
}

fn to_u32(value: usize) -> u32 {
    u32::try_from(value).unwrap_or(u32::MAX)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rows(table: &Table) -> Vec<(usize, Vec<&str>)> {
        table.rows().map(|row| (row.line, row.cells().collect())).collect()
    }

    #[test]
    fn tables_of_all_locales_are_the_same_table() {
        let expected = [("A; flat", 60.5, 30.2), ("B", 55.0, 28.0)];
        for text in [
            "name,width,height\n\"A; flat\",60.5,30.2\nB,55,28\n",
            "\u{feff}name;width;height\r\n\"A; flat\";60,5;30,2\r\nB;55;28\r\n",
            "sep=;\r\nname;width;height;\r\n\"A; flat\";\"60,5\";30,2;\r\n;;;\r\nB;55;28;\r\n",
            "name\twidth\theight\rA; flat\t60,5\t30,2\rB\t55\t28",
            "\n\"name\",\"width\",\"height\",\" \"\n\"A; flat\",\"60,5\",\"30,2\",\"\"\nB,55,28\n\n",
        ] {
            let table = Table::read(text).unwrap();
            assert_eq!(table.columns(), 3, "{text:?}");
            let mut rows = table.rows();
            let names: Vec<_> = rows.next().unwrap().cells().collect();
            assert_eq!(names, ["name", "width", "height"]);
            let found: Vec<_> = rows
                .map(|row| {
                    let value = |k| row.number(k, names[k]).unwrap().value;
                    (row.cell(0), value(1), value(2))
                })
                .collect();
            assert_eq!(found, expected, "{text:?}");
        }
    }

    #[test]
    fn empty_rows_are_counted_and_lines_are_those_of_the_text() {
        let table = Table::read("a;b;;\n\n ; ;;\r\n1;\"x\ny\";;\r3\n;;;\n\n\n").unwrap();
        assert_eq!(rows(&table), [(1, vec!["a", "b"]), (4, vec!["1", "x\ny"]), (6, vec!["3"])]);
        assert_eq!((table.columns(), table.empty_rows()), (2, 3));
        let rows: Vec<_> = table.rows().collect();
        assert_eq!((rows[2].cell(0), rows[2].cell(1), rows[2].cell(9)), ("3", "", ""));
        assert_eq!(Table::read("").unwrap().rows().len(), 0);
    }

    #[test]
    fn errors_name_line_and_column() {
        let table = Table::read("width;height\n60,5;1.200\n12,3 cm;x").unwrap();
        let rows: Vec<_> = table.rows().collect();
        assert_eq!(rows[2].number(0, "width").unwrap().unit, "cm");
        let error = |row: Row| row.number(1, "height").unwrap_err().to_string();
        assert_eq!(
            error(rows[1]),
            "line 2, height: \"1.200\", with a separator of thousands; allowed: 1200"
        );
        assert_eq!(error(rows[2]), "line 3, height: \"x\"; allowed: a number, as 12.5");
        assert_eq!(
            Table::read("a;b\n1;\"2\n3;4").unwrap_err().to_string(),
            "line 2: a quotation mark is not closed; allowed: each mark within a cell twice, as \"\""
        );
        assert_eq!(
            Table::read(&";".repeat(MAX_BYTES + 1)).unwrap_err().to_string(),
            "the table has 10000001 bytes; allowed: up to 10 MB"
        );
        assert_eq!(
            Table::read(&format!("x{}x", ";".repeat(MAX_CELLS))).unwrap_err().to_string(),
            "the table has more than 2000000 cells; allowed: up to 2 million"
        );
    }
}
