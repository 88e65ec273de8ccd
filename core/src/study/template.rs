//! A scene in which some values vary: the columns of a table by their names, a scene for each row.

use super::parameter::{Parameter, ParameterError, with_values};
use super::quantity::short;
use crate::scene::{Field, Scene, SceneError};
use crate::table::{Decimals, NumberError, Quantity};
use serde_json::{Number, Value};

/// A scene file in which the columns of a table replace values.
///
/// A column is a number of a scene by its name ([`Parameter`]: a path of the scene, or a surgeon's name as `volume_ml`; the pocket keeps
/// its margin around an implant that a column changes), or the path of any other number or text in the file.
#[derive(Clone, Debug)]
pub struct Template {
    file: Value,
    /// The scene of the file.
    scene: Scene,
    columns: Vec<Column>,
}

#[derive(Clone, Debug)]
struct Column {
    /// As it was given.
    name: String,
    place: Place,
}

#[derive(Clone, Debug, PartialEq)]
enum Place {
    Number(Parameter),
    /// A value of the file by its JSON pointer.
    Value {
        pointer: String,
        is_number: bool,
    },
}

/// Error of a template or of a row, in one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TemplateError {
    /// The template is no scene, or the row none within the limits of a file.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The scene has no such number, or the values give no size of an implant.
    #[error(transparent)]
    Parameter(#[from] ParameterError),
    /// A column has no value in the template.
    #[error("{0}, and the paths of other values in the template")]
    Unknown(String),
    /// Two columns set the same value.
    #[error("{0} and {1} set the same field; allowed: one of the two")]
    Twice(String, String),
    /// Width, projection and volume are columns.
    #[error("{0} determine each other; allowed: two of them, which give the third")]
    Overdetermined(String),
    /// The row is longer or shorter than the header.
    #[error("{found} cells; allowed: {wanted}, one for each column")]
    Cells {
        /// Number of cells of the row.
        found: usize,
        /// Number of columns.
        wanted: usize,
    },
    /// A cell of a number is empty or has other text.
    #[error("{column} is {error}")]
    Number {
        /// The column.
        column: String,
        /// What is wrong.
        error: NumberError,
    },
    /// A text stands behind the number of a cell.
    #[error(
        "{column} has a number and {unit:?}; allowed: a number, in the unit of the column's name"
    )]
    Unit {
        /// The column.
        column: String,
        /// The first 40 characters of the text.
        unit: String,
    },
}

impl Template {
    /// A template and the names of the columns.
    ///
    /// # Errors
    /// The text is no valid scene; a column names no value of the template; two columns set the same value.
    pub fn new(json: &str, names: &[impl AsRef<str>]) -> Result<Self, TemplateError> {
        let scene = Scene::from_json(json)?;
        let file = serde_json::from_str(json.trim_start_matches('\u{feff}')).unwrap_or_default();
        let mut others = Vec::new();
        values_of(&file, "", "", &mut others);
        let mut columns: Vec<Column> = Vec::new();
        for name in names.iter().map(AsRef::as_ref) {
            let place = match Parameter::of_name(name) {
                Ok(parameter) => {
                    parameter.check(&scene)?;
                    Place::Number(parameter)
                }
                Err(line) => {
                    let found = others.iter().find(|(path, _)| path == name);
                    found.ok_or(TemplateError::Unknown(line))?.1.clone()
                }
            };
            if let Some(other) = columns.iter().find(|other| other.place.excludes(&place, &scene)) {
                return Err(TemplateError::Twice(other.name.clone(), name.to_owned()));
            }
            columns.push(Column { name: name.to_owned(), place });
        }
        let template = Self { file, scene, columns };
        template.check_size()?;
        Ok(template)
    }

    fn check_size(&self) -> Result<(), TemplateError> {
        let of = |wanted| {
            let is_wanted = |column: &&Column| column.place == Place::Number(wanted);
            self.columns.iter().find(is_wanted)
        };
        let width = of(Parameter::BaseWidth).or_else(|| of(Parameter::of(Field::BaseRadius)));
        match (width, of(Parameter::of(Field::Projection)), of(Parameter::Volume)) {
            (Some(width), Some(projection), Some(volume)) => {
                let names = [width, projection, volume].map(|column| column.name.clone());
                Err(TemplateError::Overdetermined(names.join(", ")))
            }
            _ => Ok(()),
        }
    }

    /// The scene of a row: a cell for each column, in their order, with the decimal sign of their table. The limits of the scene are not checked
    /// ([`CheckedScene::like`](crate::scene::CheckedScene::like)).
    ///
    /// # Errors
    /// Cells are missing or in surplus; a cell is no number; the scene has no such value.
    pub fn scene(
        &self,
        cells: &[impl AsRef<str>],
        decimals: Decimals,
    ) -> Result<Scene, TemplateError> {
        let (found, wanted) = (cells.len(), self.columns.len());
        if found != wanted {
            return Err(TemplateError::Cells { found, wanted });
        }
        let mut file = None;
        let mut numbers = Vec::new();
        for (column, cell) in self.columns.iter().zip(cells.iter().map(AsRef::as_ref)) {
            match &column.place {
                Place::Number(parameter) => {
                    numbers.push((*parameter, column.number(cell, decimals)?.value));
                }
                Place::Value { pointer, is_number } => {
                    let value = if *is_number {
                        let Quantity { digits, value, .. } = column.number(cell, decimals)?;
                        let whole = digits.parse::<i64>().map(Number::from).ok();
                        Value::Number(whole.or_else(|| Number::from_f64(value)).unwrap_or(0.into()))
                    } else {
                        Value::from(cell)
                    };
                    let file = file.get_or_insert_with(|| self.file.clone());
                    if let Some(place) = file.pointer_mut(pointer) {
                        *place = value;
                    }
                }
            }
        }
        let scene = file.map(|file| Scene::from_json(&file.to_string())).transpose()?;
        Ok(with_values(scene.as_ref().unwrap_or(&self.scene), &numbers)?)
    }

    /// The file of the template.
    #[must_use]
    pub fn file(&self) -> &Value {
        &self.file
    }
}

impl Column {
    fn number<'a>(&self, cell: &'a str, decimals: Decimals) -> Result<Quantity<'a>, TemplateError> {
        let column = || short(&self.name);
        let number = decimals.read(cell);
        let number = number.map_err(|error| TemplateError::Number { column: column(), error })?;
        match number.unit {
            "" => Ok(number),
            unit => Err(TemplateError::Unit { column: column(), unit: short(unit) }),
        }
    }
}

impl Place {
    fn excludes(&self, other: &Self, scene: &Scene) -> bool {
        match (self, other) {
            (Self::Number(a), Self::Number(b)) => a.excludes(*b, scene),
            _ => self == other,
        }
    }
}

/// The paths of the numbers and texts in a value, and their places.
fn values_of(at: &Value, path: &str, pointer: &str, found: &mut Vec<(String, Place)>) {
    match at {
        Value::Number(_) | Value::String(_) => {
            let place = Place::Value { pointer: pointer.to_owned(), is_number: at.is_number() };
            found.push((path.to_owned(), place));
        }
        Value::Array(entries) => {
            for (k, value) in entries.iter().enumerate() {
                values_of(value, &format!("{path}[{k}]"), &format!("{pointer}/{k}"), found);
            }
        }
        Value::Object(fields) => {
            for (name, value) in fields {
                let point = if path.is_empty() { "" } else { "." };
                // A scene has no names with the signs of a pointer, but for those in its `id`.
                if !name.contains(['/', '~']) {
                    let pointer = format!("{pointer}/{name}");
                    values_of(value, &format!("{path}{point}{name}"), &pointer, found);
                }
            }
        }
        Value::Null | Value::Bool(_) => {}
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = r#"{
        "implant": { "base_radius_mm": 60, "projection_mm": 40 }, "pocket_radius_mm": 72, "chest": { "radius_across_mm": 140 },
        "layers": [{ "tissue": "skin", "thickness_mm": 1.5, "curve": { "kind": "skin" } },
            { "tissue": "adipose", "thickness_mm": 8.5, "curve": { "kind": "fat", "variant": "mid" } }],
        "solver": { "nodes_per_side": 33 } }"#;

    fn scene(names: &[&str], cells: &[&str]) -> Result<Scene, TemplateError> {
        Template::new(FILE, names)?.scene(cells, Decimals::Point)
    }

    #[test]
    fn a_row_is_the_scene_with_its_values() {
        let base = Scene::from_json(FILE).unwrap();
        assert_eq!(scene(&[], &[]).unwrap(), base);
        let names = ["layers[1].curve.variant", "solver.nodes_per_side", "layers[0].thickness_mm"];
        let found = scene(&names, &["high", " 65 ", "0.1e1"]).unwrap();
        let text = FILE.replace("mid", "high").replace("33", "65").replace("1.5", "1");
        assert_eq!(found, Scene::from_json(&text).unwrap());
        // The pocket keeps its margin of 12 mm.
        let found = scene(&["base_width_mm", "chest.radius_across_mm"], &["100", "160"]).unwrap();
        assert_eq!((found.implant.base_radius_mm, found.pocket_radius_mm), (50.0, 62.0));
        assert_eq!(found.chest.map(|chest| chest.radius_across_mm), Some(160.0));
        // A pull is that over the implant of the row, in any order of the columns.
        let one = scene(&["skin_pull_mm", "base_width_mm"], &["30", "100"]).unwrap();
        assert_eq!(scene(&["base_width_mm", "skin_pull_mm"], &["100", "30"]).unwrap(), one);
        assert_eq!(one.patient.unwrap().measured.base_width_mm, Some(100.0));
    }

    #[test]
    fn bad_columns_and_cells_are_named_with_what_is_allowed() {
        for (names, cells, wanted) in [
            (&["colour"][..], &[][..], "\"colour\" is not a field; allowed: base_width_mm, "),
            (&["implant/base_radius_mm"], &[], "is not a field"),
            (&["layers.0.thickness_mm"], &[], "is not a field"),
            (
                &["layers[2].thickness_mm"],
                &[],
                "the scene has 2 layers; allowed: layers[0] to layers[1]",
            ),
            (&["insertion", "pinch_mm", "insertion"], &[], "insertion and insertion set the same"),
            (&["solver.nodes_per_side"; 2], &[], "set the same field; allowed: one of the two"),
            (&["pinch_mm", "layers[1].thickness_mm"], &[], "set the same field"),
            (
                &["volume_ml", "projection_mm", "base_width_mm"],
                &[],
                "two of them, which give the third",
            ),
            (&["insertion", "pinch_mm"], &["1"], "1 cells; allowed: 2, one for each column"),
            (&["insertion"], &[""], "insertion is \"\"; allowed: a number, as 12.5"),
            (
                &["insertion"],
                &["1,250"],
                "insertion is \"1,250\", with a separator of thousands; allowed: 1250",
            ),
            (
                &["insertion"],
                &["0.5 mm"],
                "insertion has a number and \"mm\"; allowed: a number, in",
            ),
            (&["insertion"], &["NaN"], "insertion is \"NaN\"; allowed: a number"),
            (
                &["solver.nodes_per_side"],
                &["many"],
                "solver.nodes_per_side is \"many\"; allowed: a number",
            ),
            (&["solver.nodes_per_side"], &["33.5"], "expected a whole number"),
            (&["layers[1].curve.variant"], &["soft"], "allowed: `low`"),
            (&["skin_pull_mm"], &["900"], "skin_pull_mm"),
        ] {
            let error = scene(names, cells).unwrap_err().to_string();
            assert!(error.contains(wanted) && !error.contains('\n'), "{names:?}: {error}");
        }
        let sheet = FILE.replacen('{', r#"{ "tissue_model": "sheet","#, 1);
        let sheet = sheet.replace(r#""chest": { "radius_across_mm": 140 },"#, "");
        for name in ["attachment.ramp_mm", "chest.radius_along_mm"] {
            let error = Template::new(&sheet, &[name]).unwrap_err().to_string();
            assert_eq!(error, format!("{name}: the scene is a sheet; allowed: layered tissue"));
        }
        assert!(Template::new("{", &["insertion"]).is_err());
    }
}
