//! Scenes from a table: a template, and a row of values for each scene.

use super::super::InputError;
use super::super::cell;
use super::super::file;
use super::super::input::Source;
use super::super::output::input_error;
use super::key::Key;
use crate::scene::{MAX_SCENE_BYTES, Scene, read};
use crate::study::Template;
use crate::table::{Decimals, RawRow, cells};
use serde_json::json;
use std::borrow::Cow;
use std::path::Path;

/// A template and the columns of its table.
pub(super) struct Table {
    template: Template,
    /// All columns of the table, up to the last one with a name.
    names: Vec<String>,
    /// Index of the column of the ids.
    id: Option<usize>,
    separator: u8,
}

const NOT_UTF8: &str = "a letter is not UTF-8 (saved as Windows-1252?)";

impl Table {
    /// Reads the template, and the header of the table from its source.
    pub(super) fn read(template: &Path, table: &mut Source) -> Result<Self, InputError> {
        let bytes = file::read(template, MAX_SCENE_BYTES)?;
        let text = read::utf8(&bytes).map_err(|error| input_error(template, error))?;
        let none: [&str; 0] = [];
        Template::new(text, &none).map_err(|error| input_error(template, error))?;
        let (header, separator) = table.header()?;
        let columns = Self::with_header(text, header, separator);
        columns.map_err(|error| input_error(table.path(), format!("header: {error}")))
    }

    fn with_header(template: &str, header: Option<RawRow>, separator: u8) -> Result<Self, String> {
        let header =
            header.ok_or("is missing; allowed: the names of the columns in the first line")?;
        if let Some(fault) = header.fault {
            return Err(fault.to_string());
        }
        let text = std::str::from_utf8(&header.bytes).map_err(|_| NOT_UTF8)?;
        let mut names: Vec<String> =
            cells(text, separator).map(|name| name.trim().to_owned()).collect();
        names.truncate(names.iter().rposition(|name| !name.is_empty()).map_or(0, |last| last + 1));
        let mut ids = (0..names.len()).filter(|k| names[*k] == "id");
        let id = ids.next();
        if ids.next().is_some() {
            return Err("id is the name of two columns; allowed: one".to_owned());
        }
        let values: Vec<&String> = names.iter().filter(|name| *name != "id").collect();
        let template = Template::new(template, &values).map_err(|error| error.to_string())?;
        Ok(Self { template, names, id, separator })
    }

    /// The scene of a row, and what it is known by: its `id`, else template and cells.
    pub(super) fn scene(&self, row: &RawRow, decimals: Decimals) -> (Key, Result<Scene, String>) {
        let of_content = |row| json!({ "template": self.template.file(), "row": row }).to_string();
        let text = String::from_utf8_lossy(&row.bytes);
        let mut cells: Vec<Cow<str>> = cells(&text, self.separator).collect();
        let (found, wanted) = (cells.len(), self.names.len());
        let is_blank = |cells: &[Cow<str>]| cells.iter().all(|cell| cell.trim().is_empty());
        if cells.get(wanted..).is_some_and(is_blank) {
            cells.truncate(wanted);
        }
        if row.fault.is_some() || cells.len() != wanted {
            let fault = row.fault.map(|fault| fault.to_string());
            let words = || format!("{found} cells; allowed: {wanted}, one for each column");
            let key = Key::new(None, &of_content(json!(text.trim_end())));
            return (key, Err(fault.unwrap_or_else(words)));
        }
        // A letter that cannot be read is in its place in the lossy text.
        let is_read = std::str::from_utf8(&row.bytes).is_ok();
        let id = self.id.map(|id| &*cells[id]).filter(|id| is_read || !id.contains('\u{fffd}'));
        let id = id.and_then(cell::to_json);
        let content = self.names.iter().map(String::as_str).zip(cells.iter().map(|cell| &**cell));
        let content = content.filter(|(name, _)| id.is_none() || *name != "id");
        let key = Key::new(id.as_deref(), &of_content(content.collect()));
        let scene =
            if is_read { self.scene_of(&cells, decimals) } else { Err(NOT_UTF8.to_owned()) };
        (key, scene)
    }

    fn scene_of(&self, cells: &[Cow<str>], decimals: Decimals) -> Result<Scene, String> {
        let is_value = |(k, cell)| (Some(k) != self.id).then_some(cell);
        let values: Vec<&Cow<str>> = cells.iter().enumerate().filter_map(is_value).collect();
        self.template.scene(&values, decimals).map_err(|error| error.to_string())
    }
}
