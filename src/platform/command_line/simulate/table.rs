//! Scenes from a table: a template, and a line of values for each scene.

use super::super::InputError;
use super::super::cell;
use super::super::input::{self, Source};
use super::super::output::input_error;
use super::key::Key;
use crate::scene::{MAX_SCENE_BYTES, Scene, read};
use crate::study::Template;
use csv::StringRecord;
use serde_json::json;
use std::path::Path;

/// A template and the columns of its table.
pub(super) struct Table {
    template: Template,
    /// All columns of the table.
    names: Vec<String>,
    /// Index of the column of the ids.
    id: Option<usize>,
}

impl Table {
    /// Reads the template, and the header of the table from its source.
    pub(super) fn read(template: &Path, table: &mut Source) -> Result<Self, InputError> {
        let bytes = input::read(template, MAX_SCENE_BYTES)?;
        let text = read::utf8(&bytes).map_err(|error| input_error(template, error))?;
        let none: [&str; 0] = [];
        Template::new(text, &none).map_err(|error| input_error(template, error))?;
        let header = table.take_line()?;
        let columns = Self::with_header(text, &header);
        columns.map_err(|error| input_error(table.path(), format!("header: {error}")))
    }

    fn with_header(template: &str, header: &[u8]) -> Result<Self, String> {
        let header = read::utf8(header).map_err(|error| error.to_string())?;
        let header = header.trim_start_matches('\u{feff}');
        if header.trim().is_empty() {
            return Err(
                "is missing; allowed: the names of the columns in the first line".to_owned()
            );
        }
        let names: Vec<String> =
            cell::split(header)?.iter().map(|name| name.trim().to_owned()).collect();
        let mut ids = (0..names.len()).filter(|k| names[*k] == "id");
        let id = ids.next();
        if ids.next().is_some() {
            return Err("id is the name of two columns; allowed: one".to_owned());
        }
        let values: Vec<&String> = names.iter().filter(|name| *name != "id").collect();
        let template = Template::new(template, &values).map_err(|error| error.to_string())?;
        Ok(Self { template, names, id })
    }

    /// The scene of a line, and what it is known by: its `id`, else template and cells.
    pub(super) fn scene(&self, line: &[u8]) -> (Key, Result<Scene, String>) {
        let text = match line.len() {
            ..=MAX_SCENE_BYTES => read::utf8(line).map_err(|error| error.to_string()),
            _ => Err("the row is longer than 10 MB; allowed: up to 10 MB".to_owned()),
        };
        let cells = text.and_then(cell::split);
        let of_content = |row| json!({ "template": self.template.file(), "row": row }).to_string();
        match cells {
            Ok(cells) if cells.len() == self.names.len() => {
                let id = self.id.and_then(|id| cell::to_json(&cells[id]));
                let row = self.names.iter().map(String::as_str).zip(&cells);
                let row = row.filter(|(name, _)| id.is_none() || *name != "id");
                (Key::new(id.as_deref(), &of_content(row.collect())), self.scene_of(&cells))
            }
            cells => {
                let wanted = self.names.len();
                let error = cells.map_or_else(
                    |error| error,
                    |cells| {
                        format!("{} cells; allowed: {wanted}, one for each column", cells.len())
                    },
                );
                let text = String::from_utf8_lossy(line);
                (Key::new(None, &of_content(json!(text.trim_end()))), Err(error))
            }
        }
    }

    fn scene_of(&self, cells: &StringRecord) -> Result<Scene, String> {
        let is_value = |(k, cell)| (Some(k) != self.id).then_some(cell);
        let values: Vec<&str> = cells.iter().enumerate().filter_map(is_value).collect();
        self.template.scene(&values).map_err(|error| error.to_string())
    }
}
