//! From the table of a raw tensile test to a stress–strain curve: columns and units, engineering values, the loading branch, zero,
//! repeated strains, rupture, noise.
//!
//! [`read`] runs the steps in this order; each step adds a sentence about what it found or changed. Strains are fractions, stresses
//! kPa behind the first step.

mod clean;
mod fit;
mod recognise;

use crate::curve::{Curve, CurveSpec, Fat, Interpolation};
use crate::table;
use recognise::{COMPARED, recognise};

/// Strain \[-\] and stress \[kPa\].
type Row = [f64; 2];

/// A text that is no tensile test: one line.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct TensileError(String);

/// Unit of strains.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StrainUnit {
    /// 0.2
    Fraction,
    /// 20
    Percent,
}

impl StrainUnit {
    /// All units.
    pub const ALL: [Self; 2] = [Self::Fraction, Self::Percent];

    /// The unit of a name.
    ///
    /// # Errors
    /// Another name, in one line.
    pub fn of_name(name: &str) -> Result<Self, String> {
        named(Self::ALL.map(|unit| (unit.name(), unit)), name)
    }

    /// The unit's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fraction => "fraction",
            Self::Percent => "percent",
        }
    }

    const fn factor(self) -> f64 {
        match self {
            Self::Fraction => 1.0,
            Self::Percent => 0.01,
        }
    }
}

/// Unit of stresses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StressUnit {
    /// Pa
    Pa,
    /// kPa
    Kpa,
    /// MPa, N/mm²
    Mpa,
}

impl StressUnit {
    /// All units.
    pub const ALL: [Self; 3] = [Self::Pa, Self::Kpa, Self::Mpa];

    /// The unit of a name, in any case of letters.
    ///
    /// # Errors
    /// Another name, in one line.
    pub fn of_name(name: &str) -> Result<Self, String> {
        named(Self::ALL.map(|unit| (unit.name(), unit)), name)
    }

    /// The unit's name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Pa => "Pa",
            Self::Kpa => "kPa",
            Self::Mpa => "MPa",
        }
    }

    const fn factor(self) -> f64 {
        match self {
            Self::Pa => 1e-3,
            Self::Kpa => 1.0,
            Self::Mpa => 1e3,
        }
    }
}

fn named<T: Copy, const N: usize>(units: [(&str, T); N], name: &str) -> Result<T, String> {
    let found = units.iter().find(|(known, _)| known.eq_ignore_ascii_case(name));
    found.map(|(_, unit)| *unit).ok_or_else(|| {
        let allowed = units.map(|(known, _)| known).join(", ");
        format!("{:?} is no unit; allowed: {allowed}", recognise::shortened(name))
    })
}

/// Units as asked or as guessed; `None`: by header or cells.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Given {
    /// Unit of the strains.
    pub strain: Option<StrainUnit>,
    /// Unit of the stresses.
    pub stress: Option<StressUnit>,
}

/// What was recognised, left out and converted, a sentence each.
#[derive(Debug, Default)]
struct Notes {
    sentences: Vec<String>,
    form: Option<table::Form>,
    left_out: usize,
    guessed: Given,
}

impl Notes {
    fn say(&mut self, sentence: impl Into<String>) {
        self.sentences.push(sentence.into());
    }
}

/// A strain in percent, three digits of it.
fn percent(strain: f64) -> String {
    clean::shown(100.0 * strain)
}

/// The curve of a tensile test.
#[derive(Clone, Debug, PartialEq)]
pub struct Tensile {
    /// Points of a spline, the first at the origin: strain \[-\], stress \[kPa\].
    pub points: Vec<[f64; 2]>,
    /// The samples of the loading behind the curve: strain \[-\], stress \[kPa\].
    pub samples: Vec<[f64; 2]>,
    /// What was recognised, left out and converted, a sentence each.
    pub notes: Vec<String>,
    /// Separator and decimal sign of a table.
    pub form: Option<table::Form>,
    /// Number of rows without a strain and a stress.
    pub left_out: usize,
    /// Units that neither header nor cells name.
    pub guessed: Given,
    /// Root mean square of the samples' distances from the curve \[kPa\].
    pub rms_kpa: f64,
}

impl Tensile {
    /// The curve as a scene has it.
    #[must_use]
    pub fn spec(&self) -> CurveSpec {
        CurveSpec::Points { points: self.points.clone(), interpolation: Interpolation::Spline }
    }

    /// Numbers of samples and points, and the distance between them, in a sentence.
    #[must_use]
    pub fn summary(&self) -> String {
        let (samples, points) = (self.samples.len(), self.points.len());
        let greatest = self.points.last().map_or(1.0, |end| end[1]);
        // Less is rounding.
        let rms_kpa = if self.rms_kpa < 1e-9 * greatest { 0.0 } else { self.rms_kpa };
        let [rms, share] = [rms_kpa, 100.0 * rms_kpa / greatest].map(clean::shown);
        format!(
            "{points} points fit {samples} samples; root mean square of the distances: {rms} kPa, {share} % of the greatest stress."
        )
    }
}

/// Reads a tensile test: a table of any locale with strain and stress in each row, or points in JSON.
///
/// # Errors
/// One line: no text, no two columns of numbers, or no stress that rises.
pub fn read(bytes: &[u8], given: Given) -> Result<Tensile, TensileError> {
    let text = table::decode(bytes).map_err(|error| TensileError(format!("the file {error}")))?;
    let mut notes = Notes::default();
    let found = recognise(&text, given, &mut notes)?;
    of_rows(found.rows, found.is_true, notes)
}

/// How a curve differs from every curve of its tissue by so much that its unit may be another one, in a sentence; `None` for a
/// likely curve. The presets of skin are those of a tissue "skin", all presets those of any other.
#[must_use]
pub fn unlikely(curve: &Curve, tissue: &str) -> Option<String> {
    const FACTOR: f64 = 30.0;
    let fat = |variant| CurveSpec::Fat { variant };
    let presets = [CurveSpec::Skin {}, CurveSpec::Adipose {}, fat(Fat::Low), fat(Fat::High)];
    let presets = if tissue == "skin" { &presets[..1] } else { &presets[..] };
    let stresses =
        presets.iter().filter_map(|preset| Some(Curve::new(preset).ok()?.stress(COMPARED)));
    let [least, most] = stresses.fold([f64::INFINITY, 0.0], |[a, b], s| [s.min(a), s.max(b)]);
    let stress = curve.stress(COMPARED);
    let word = if stress * FACTOR < least {
        "softer"
    } else if stress > FACTOR * most {
        "stiffer"
    } else {
        return None;
    };
    let (tissue, stress) =
        (if tissue.is_empty() { "tissue" } else { tissue }, clean::shown(stress));
    Some(format!(
        "The curve of {tissue} has {stress} kPa at 20 % strain, more than 30 times {word} than every preset: kPa or MPa, fraction or percent?"
    ))
}

/// The curve of rows in the order of the test.
fn of_rows(
    mut rows: Vec<Row>,
    is_true: [bool; 2],
    mut notes: Notes,
) -> Result<Tensile, TensileError> {
    clean::engineering(&mut rows, is_true, &mut notes);
    let rows = clean::loading(&rows, &mut notes);
    let rows = clean::merged(rows, &mut notes);
    let rows = clean::until_rupture(rows, &mut notes);
    let samples = clean::zeroed(rows, &mut notes);
    let fit = fit::fit(&samples)
        .ok_or_else(|| TensileError("the stress does not rise with the strain".to_owned()))?
        .map_err(|error| TensileError(error.to_string()))?;
    let slope = clean::shown(fit.least_slope);
    for [from, to] in fit.flat {
        let to = percent(to);
        notes.say(if from > 0.0 {
            format!(
                "No rise from {} to {to} % strain; slope of the curve there: {slope} kPa.",
                percent(from)
            )
        } else {
            format!("Slack up to {to} % strain; slope of the curve there: {slope} kPa.")
        });
    }
    let squares =
        samples.iter().map(|[strain, stress]| (stress - fit.curve.stress(*strain)).powi(2));
    let rms_kpa = (squares.sum::<f64>() / samples.len() as f64).sqrt();
    notes.sentences.extend(unlikely(&fit.curve, ""));
    let Notes { sentences: notes, form, left_out, guessed } = notes;
    Ok(Tensile { points: fit.points, samples, notes, form, left_out, guessed, rms_kpa })
}

#[cfg(test)]
mod tests;
