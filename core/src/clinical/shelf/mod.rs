//! The clinic's shelf: the sizes at hand, read from the table of a maker or of the clinic.
//!
//! `header` (what a name of a column says) | `draft` (a table before it is taken: columns, units, rows that are left out) |
//! `row` (a size from a row).

mod draft;
mod header;
mod row;
#[cfg(test)]
mod tests;

pub use draft::{Draft, DraftColumn, Reading, Skipped, UnitOrigin};
pub use header::{Column, LengthUnit};

use super::{Size, limits};
use std::fmt::Write as _;

/// Greatest number of sizes.
pub const MAX_SIZES: usize = 500;
/// The names of the columns of a kept shelf.
const KEPT: &str = "name;width_mm;height_mm;projection_mm;volume_ml\n";
/// Those of a shelf without anatomical sizes, as former versions kept it.
const KEPT_BEFORE: &str = "name;width_mm;projection_mm;volume_ml\n";

/// A size of the shelf.
#[derive(Clone, Debug, PartialEq)]
pub struct ShelfSize {
    name: String,
    label: String,
    size: Size,
    /// As listed \[mm, ml\].
    projection_mm: Option<f64>,
    volume_ml: Option<f64>,
    /// The fullness that the listed numbers would need, where no dome has it.
    impossible_fullness: Option<f64>,
}

impl ShelfSize {
    /// The maker's reference or name; sizes of one name differ in a number.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The name with the listed volume, as "RD-275 · 275 cc"; different for every size of a shelf.
    #[must_use]
    pub fn label(&self) -> &str {
        &self.label
    }

    /// Base width \[mm\], as listed.
    #[must_use]
    pub fn width_mm(&self) -> f64 {
        self.size.base_width_mm()
    }

    /// Projection \[mm\], if it is listed.
    #[must_use]
    pub fn listed_projection_mm(&self) -> Option<f64> {
        self.projection_mm
    }

    /// Volume \[ml\], if it is listed.
    #[must_use]
    pub fn listed_volume_ml(&self) -> Option<f64> {
        self.volume_ml
    }

    /// The listed volume, or that of the dome \[ml\].
    #[must_use]
    pub fn volume_ml(&self) -> f64 {
        self.volume_ml.unwrap_or_else(|| self.size.volume_ml())
    }

    /// The dome: of the listed width, height, projection and volume, as far as a dome has them.
    #[must_use]
    pub fn size(&self) -> Size {
        self.size
    }

    /// Is the base round?
    #[must_use]
    pub fn is_round(&self) -> bool {
        (self.size.aspect() - 1.0).abs() < 1e-9
    }

    /// Why the dome has another volume than the listed one, in one line.
    #[must_use]
    pub fn note(&self) -> Option<String> {
        let fullness = self.impossible_fullness?;
        let ((least, most), taken) = (limits::FULLNESS, self.size.volume_ml());
        Some(format!(
            "the listed {:.0} ml need a fullness of {fullness:.2}; allowed: {least} to {most}; the shape shown has {taken:.0} ml",
            self.volume_ml()
        ))
    }
}

/// The sizes of a clinic, in the order of their table.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shelf {
    sizes: Vec<ShelfSize>,
}

impl Shelf {
    /// Reads a table without questions: its columns are recognised, and every row is a size.
    ///
    /// # Errors
    /// One line with the number of the line, what is wrong and what is allowed.
    pub fn from_csv(text: &str) -> Result<Self, String> {
        let draft = Draft::of(text)?;
        if let Some(missing) = draft.missing() {
            return Err(missing.to_owned());
        }
        let reading = draft.read();
        match reading.skipped.first() {
            Some(Skipped { line, reason }) => Err(format!("line {line}: {reason}")),
            None if reading.shelf.sizes.is_empty() => Err(draft::NO_SIZE.to_owned()),
            None => Ok(reading.shelf),
        }
    }

    /// The sizes as a table that [`Self::from_csv`] reads; empty without a size.
    #[must_use]
    pub fn to_csv(&self) -> String {
        if self.sizes.is_empty() {
            return String::new();
        }
        let mut text = KEPT.to_owned();
        for size in &self.sizes {
            let name = size.name.replace('"', "\"\"");
            let height = (!size.is_round()).then(|| size.size.base_height_mm());
            let [height, projection, volume] = [height, size.projection_mm, size.volume_ml]
                .map(|number| number.map(|number| number.to_string()).unwrap_or_default());
            let width = size.width_mm();
            // Writing to a String cannot fail.
            let _ = writeln!(text, "\"{name}\";{width};{height};{projection};{volume}");
        }
        text
    }

    /// The sizes.
    #[must_use]
    pub fn sizes(&self) -> &[ShelfSize] {
        &self.sizes
    }

    /// Adds the sizes of another shelf. A size that is there already is left out; one with the label of another size has its numbers
    /// in its name.
    ///
    /// # Errors
    /// One line if there are more than [`MAX_SIZES`] then; the shelf stays as it is.
    pub fn add(&mut self, other: &Self) -> Result<(), String> {
        let mut sizes = self.sizes.clone();
        for size in &other.sizes {
            let mut size = size.clone();
            if sizes.iter().any(|known| known.label == size.label && *known != size) {
                size = size.with_numbers_in_name();
            }
            if sizes.iter().all(|known| known.label != size.label) {
                sizes.push(size);
            }
        }
        if sizes.len() > MAX_SIZES {
            return Err(format!("{} sizes; allowed: up to {MAX_SIZES}", sizes.len()));
        }
        self.sizes = sizes;
        Ok(())
    }

    /// Removes the size of an index.
    pub fn remove(&mut self, index: usize) {
        if index < self.sizes.len() {
            self.sizes.remove(index);
        }
    }
}
