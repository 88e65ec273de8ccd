//! A size from a row of a table.

use super::ShelfSize;
use super::header::{LengthUnit, is_volume_unit, unit_word};
use crate::clinical::{ClinicalError, Size, limits};
use crate::curve::number;
use crate::table::{Decimals, NumberError, Quantity};

/// Greatest length of a name \[characters\]; with its volume it is the reference of an implant, of up to 60.
const MAX_NAME: usize = 46;
/// Greatest length of a cell in a message \[characters\].
const SHOWN: usize = 40;

/// The cells of a row: empty where the table has no such column.
#[derive(Clone, Copy, Default)]
pub(super) struct Cells<'a> {
    pub(super) name: &'a str,
    pub(super) width: &'a str,
    pub(super) height: &'a str,
    pub(super) projection: &'a str,
    pub(super) volume: &'a str,
}

/// How the numbers of the lengths are read.
#[derive(Clone, Copy)]
pub(super) struct Units {
    pub(super) decimals: Decimals,
    pub(super) width: LengthUnit,
    pub(super) height: LengthUnit,
    pub(super) projection: LengthUnit,
}

/// The number of a cell with the unit behind it; marks of notes and Ø do not count.
pub(super) fn quantity(cell: &str, decimals: Decimals) -> Result<Quantity<'_>, NumberError> {
    let cell = cell.trim().trim_start_matches(['Ø', 'ø', '⌀', '~', '≈']);
    decimals.read(cell.trim_end_matches(['*', '†', '‡', ' ', '\u{a0}']))
}

/// Why a row is no size.
const NO_NUMBERS: &str = "no number in the columns of a size";

impl ShelfSize {
    /// The size of a row.
    ///
    /// # Errors
    /// What is wrong and what is allowed.
    pub(super) fn of(cells: Cells, units: Units) -> Result<Self, String> {
        let numbers = [cells.width, cells.height, cells.projection, cells.volume];
        if numbers.iter().all(|cell| quantity(cell, units.decimals).is_err()) {
            return Err(NO_NUMBERS.to_owned());
        }
        let length =
            |what, cell, unit, allowed| length(what, cell, (units.decimals, unit), allowed);
        let width_mm = length("width", cells.width, units.width, limits::BASE_WIDTH_MM)?;
        let width_mm = width_mm.ok_or("the row has no width; allowed: a width")?;
        let (least, most) = limits::ASPECT;
        let heights = (least * width_mm, most * width_mm);
        let height_mm = length("height", cells.height, units.height, heights)?;
        let projection_mm =
            length("projection", cells.projection, units.projection, limits::PROJECTION_MM)?;
        let volume_ml = volume(cells.volume, units.decimals)?;
        let is_round = |height: &f64| (height - width_mm).abs() < 1e-6;
        let aspect = height_mm.filter(|height| !is_round(height)).map(|height| height / width_mm);
        let (size, impossible_fullness) =
            size(width_mm, aspect, projection_mm, volume_ml).map_err(|error| error.to_string())?;
        let name = name(cells.name);
        let name = if name.is_empty() { unnamed(size) } else { name };
        let label = label(&name, volume_ml);
        Ok(Self { name, label, size, projection_mm, volume_ml, impossible_fullness })
    }

    /// The size with a name that also has its numbers.
    pub(super) fn with_numbers_in_name(self) -> Self {
        let numbers = unnamed(self.size);
        let kept = MAX_NAME.saturating_sub(numbers.chars().count() + 2);
        let name = format!("{}, {numbers}", self.name.chars().take(kept).collect::<String>());
        Self { label: label(&name, self.volume_ml), name, ..self }
    }
}

/// The dome of the listed numbers, and the fullness that they would need where no dome has it: the nearest one is taken.
fn size(
    width_mm: f64,
    aspect: Option<f64>,
    projection_mm: Option<f64>,
    volume_ml: Option<f64>,
) -> Result<(Size, Option<f64>), ClinicalError> {
    let of_aspect = |size: Size| aspect.map_or(size, |aspect| size.with_aspect(aspect));
    let (projection_mm, volume_ml) = match (projection_mm, volume_ml) {
        (Some(projection), Some(volume)) => (projection, volume),
        (Some(projection), None) => {
            return Ok((of_aspect(Size::of_width_and_projection(width_mm, projection)?), None));
        }
        (None, volume) => {
            // Without either a volume of zero is refused.
            let round_ml = volume.unwrap_or_default() / aspect.unwrap_or(1.0);
            return Ok((of_aspect(Size::of_width_and_volume(width_mm, round_ml)?), None));
        }
    };
    let half = of_aspect(Size::of_width_and_projection(width_mm, projection_mm)?);
    match half.filled_to(volume_ml) {
        Err(ClinicalError::Derived {
            quantity: "fullness", value, allowed: (least, most), ..
        }) => Ok((half.with_fullness(value.clamp(least, most))?, Some(value))),
        filled => Ok((filled?, None)),
    }
}

/// A name in one line, of a length that a scene allows.
fn name(cell: &str) -> String {
    let words: Vec<&str> = cell.split_whitespace().collect();
    let name: String = words.join(" ").chars().filter(|c| !c.is_control()).collect();
    match name.char_indices().nth(MAX_NAME) {
        Some(_) => name.chars().take(MAX_NAME - 1).chain(['…']).collect(),
        None => name,
    }
}

/// A name by the numbers of the dome, as "12 × 3.9 cm".
fn unnamed(size: Size) -> String {
    let cm = |mm: f64| number((10.0 * mm).round() / 100.0);
    let (width, projection) = (cm(size.base_width_mm()), cm(size.projection_mm()));
    if (size.aspect() - 1.0).abs() < 1e-9 {
        format!("{width} × {projection} cm")
    } else {
        format!("{width} × {} × {projection} cm", cm(size.base_height_mm()))
    }
}

/// A name with the maker's volume, unless it ends with that.
fn label(name: &str, volume_ml: Option<f64>) -> String {
    let Some(volume) = volume_ml else { return name.to_owned() };
    let volume = format!("{} cc", number((10.0 * volume).round() / 10.0));
    if name.to_lowercase().ends_with(&volume) {
        name.to_owned()
    } else {
        format!("{name} · {volume}")
    }
}

/// A length \[mm\]; `None` for an empty cell.
fn length(
    what: &str,
    cell: &str,
    (decimals, unit): (Decimals, LengthUnit),
    (least, most): (f64, f64),
) -> Result<Option<f64>, String> {
    if is_blank(cell) {
        return Ok(None);
    }
    let read = quantity(cell, decimals).map_err(|error| format!("the {what} is {error}"))?;
    let own = unit_word(read.unit);
    let unit = match LengthUnit::of(&own) {
        None if own.is_empty() => unit,
        own => own.ok_or_else(|| other_unit(what, cell, "mm, cm"))?,
    };
    let factor = unit.in_mm();
    // To the digits of the table: 12.3 cm are 123 mm.
    let value = if factor > 1.0 { (read.value * factor * 1e6).round() / 1e6 } else { read.value };
    if (least..=most).contains(&value) {
        return Ok(Some(value));
    }
    let [least, most] = [least, most].map(|end| number((1e6 * end / factor).round() / 1e6));
    let (cell, unit) = (shown(cell), unit.word());
    Err(format!("the {what} is “{cell}”; allowed: a number from {least} to {most} {unit}"))
}

/// A volume \[ml\]; `None` for an empty cell.
fn volume(cell: &str, decimals: Decimals) -> Result<Option<f64>, String> {
    if is_blank(cell) {
        return Ok(None);
    }
    let read = quantity(cell, decimals).map_err(|error| format!("the volume is {error}"))?;
    if read.unit.is_empty() || is_volume_unit(&unit_word(read.unit)) {
        return Ok(Some(read.value));
    }
    Err(other_unit("volume", cell, "ml, cc, cm³"))
}

/// Is a cell empty, or a dash?
fn is_blank(cell: &str) -> bool {
    cell.chars().all(|c| c.is_whitespace() || "-–—".contains(c))
}

fn other_unit(what: &str, cell: &str, allowed: &str) -> String {
    format!("the {what} is “{}”; allowed units: {allowed}", shown(cell))
}

fn shown(cell: &str) -> String {
    let words: Vec<&str> = cell.split_whitespace().collect();
    words.join(" ").chars().filter(|c| !c.is_control()).take(SHOWN).collect()
}
