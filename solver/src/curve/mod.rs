//! Stress–strain curves `Ef`: nominal stress \[kPa\] as a function of engineering strain \[-\].
//!
//! The paper (Nikolaev 2013, "Nonlinearity modeling") builds `Ef` from marked points joined by
//! segments or splines; pieces may be polynomial, trigonometric or exponential. [`CurveSpec`] is
//! the description in a scene file, [`ScaledCurve`] adds the scales of strain and stress, [`Curve`] is the validated,
//! callable curve.
//!
//! Uses no other module of this crate. Used by `springs`, `scene`, the lab and the views.
//!
//! Three assumptions that the paper does not state:
//! * compression is the odd extension, `Ef(−ε) = −Ef(ε)`;
//! * beyond the last point the curve continues as a line with its end slope (an arctangent keeps its
//!   formula); [`Curve::is_beyond_data`] detects these strains; [`Curve::measured_end`] is the end of the measurements behind a
//!   curve, which of [`Fat`] lies below the end of its data;
//! * `Ef` is strictly increasing, so that its energy is convex.

mod points;
mod read;
mod relaxation;
mod scale;
mod spec;

pub use read::number;
pub use read::{
    GAP, GivenCurve, List, Pair, given, given_object, object, present, present_object,
    present_whole, whole, whole_of,
};
pub use scale::{SCALES, ScaledCurve};
pub use spec::{CurveError, CurveSpec, Fat, Interpolation, Section};

use points::{check_points, hermite, monotone_slopes};
use relaxation::Relaxation;
use std::f64::consts::FRAC_PI_2;

/// End of the strain range of the analytic presets \[-\] (the paper: 0 to 1).
pub const FULL_STRAIN: f64 = 1.0;

/// Greatest number of marked points or sections of a curve.
pub const MAX_POINTS: usize = 100_000;

/// Greatest number of coefficients of a polynomial section.
pub const MAX_COEFFICIENTS: usize = 8;

/// A validated stress–strain curve: continuous, zero at zero, strictly increasing, odd.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Pieces in order of strain, at least one; a line follows the last piece.
    pieces: Vec<Piece>,
    /// Strain at the end of the data \[-\].
    data_end: f64,
    /// Strain at the end of the measurements \[-\], at most `data_end`.
    measured_end: f64,
    /// Start of the final line \[-\]: the end of the data, or a larger strain for a formula of bounded
    /// slope.
    line_start: f64,
    /// Stress and slope at `line_start` \[kPa\].
    end: (f64, f64),
    /// Strain energy density at `line_start` \[kPa\].
    end_energy: f64,
    /// What of the stress has relaxed; all other fields are those of the given curve.
    relaxation: Option<Relaxation>,
}

/// `stress = base + shape(ε − from)` on one interval.
#[derive(Clone, Debug, PartialEq)]
struct Piece {
    from: f64,
    base: f64,
    /// Energy density at `from` \[kPa\].
    energy: f64,
    shape: Shape,
}

/// An increment of stress over `x ≥ 0`; zero at `x = 0`.
#[derive(Clone, Debug, PartialEq)]
enum Shape {
    /// Σ c[k] x^(k+1).
    Polynomial(Vec<f64>),
    Arctangent {
        scale: f64,
        rate: f64,
    },
    Sine {
        scale: f64,
        rate: f64,
    },
    Exponential {
        scale: f64,
        rate: f64,
    },
}

impl Shape {
    fn stress(&self, x: f64) -> f64 {
        match self {
            Self::Polynomial(c) => c.iter().rev().fold(0.0, |sum, c| (sum + c) * x),
            Self::Arctangent { scale, rate } => scale * (rate * x).atan(),
            Self::Sine { scale, rate } => scale * (rate * x).sin(),
            Self::Exponential { scale, rate } => scale * (rate * x).exp_m1(),
        }
    }

    fn slope(&self, x: f64) -> f64 {
        match self {
            Self::Polynomial(c) => {
                c.iter().enumerate().rev().fold(0.0, |sum, (k, c)| sum * x + (k + 1) as f64 * c)
            }
            Self::Arctangent { scale, rate } => scale * rate / (1.0 + (rate * x).powi(2)),
            Self::Sine { scale, rate } => scale * rate * (rate * x).cos(),
            Self::Exponential { scale, rate } => scale * rate * (rate * x).exp(),
        }
    }

    /// ∫₀ˣ stress.
    fn energy(&self, x: f64) -> f64 {
        match self {
            Self::Polynomial(c) => {
                c.iter().enumerate().rev().fold(0.0, |sum, (k, c)| (sum + c / (k + 2) as f64) * x)
                    * x
            }
            Self::Arctangent { scale, rate } => {
                let y = rate * x;
                scale * (x * y.atan() - 0.5 * (y * y).ln_1p() / rate)
            }
            Self::Sine { scale, rate } => {
                let half = (0.5 * rate * x).sin();
                2.0 * scale * half * half / rate
            }
            Self::Exponential { scale, rate } => scale * exp_m1_minus(rate * x) / rate,
        }
    }

    /// Returns `true` if the slope is positive on the open interval (0, length).
    fn increases_over(&self, length: f64) -> bool {
        match self {
            Self::Polynomial(c) if c.len() <= 3 => {
                // A quadratic slope has its minimum at an end or at the vertex.
                let [b, d] = [1, 2].map(|k| c.get(k).copied().unwrap_or(0.0));
                let vertex = if d > 0.0 { -b / (3.0 * d) } else { 0.0 };
                let terms = [1.0, 2.0 * length, 3.0 * length * length];
                let tiny = -1e-12 * c.iter().zip(terms).map(|(c, x)| c.abs() * x).sum::<f64>();
                [0.0, length, vertex.clamp(0.0, length)].iter().all(|&x| self.slope(x) >= tiny)
            }
            Self::Polynomial(_) => {
                (0..=1000).all(|k| self.slope(length * f64::from(k) / 1000.0) >= 0.0)
            }
            Self::Sine { rate, .. } => rate * length <= FRAC_PI_2,
            Self::Arctangent { .. } | Self::Exponential { .. } => true,
        }
    }
}

/// exp(y) − 1 − y, for small y as a series without cancellation.
fn exp_m1_minus(y: f64) -> f64 {
    if y < 0.01 {
        0.5 * y * y * (1.0 + y / 3.0 * (1.0 + y / 4.0 * (1.0 + y / 5.0 * (1.0 + y / 6.0))))
    } else {
        y.exp_m1() - y
    }
}

impl Curve {
    /// Validates a description and builds the curve.
    ///
    /// # Errors
    /// [`CurveError`] names the invalid parameter, point or section and the allowed range.
    pub fn new(spec: &CurveSpec) -> Result<Self, CurveError> {
        match spec {
            CurveSpec::Skin {} => Self::from_sections(&skin_sections()),
            CurveSpec::Adipose {} => {
                Self::from_shape(Shape::Arctangent { scale: 0.4, rate: 7.5 }, MAX_STRAIN)
            }
            CurveSpec::Fat { variant } => Self::from_fat(*variant),
            CurveSpec::Linear { modulus_kpa } => {
                let modulus = checked("modulus_kpa", *modulus_kpa, STRESS_SCALE)?;
                Self::from_shape(Shape::Polynomial(vec![modulus]), FULL_STRAIN)
            }
            CurveSpec::Arctangent { scale_kpa, rate } => {
                let scale = checked("scale_kpa", *scale_kpa, STRESS_SCALE)?;
                let rate = checked("rate", *rate, RATE)?;
                Self::from_shape(Shape::Arctangent { scale, rate }, MAX_STRAIN)
            }
            CurveSpec::Exponential { scale_kpa, rate } => {
                let scale = checked("scale_kpa", *scale_kpa, STRESS_SCALE)?;
                let rate = checked("rate", *rate, RATE)?;
                Self::from_shape(Shape::Exponential { scale, rate }, FULL_STRAIN)
            }
            CurveSpec::Points { points, interpolation } => {
                Self::from_points(points, *interpolation)
            }
            CurveSpec::Sections { sections } => Self::from_sections(sections),
        }
    }

    /// A formula with data up to [`FULL_STRAIN`], evaluated up to `line_start`.
    fn from_shape(shape: Shape, line_start: f64) -> Result<Self, CurveError> {
        let pieces = vec![Piece { from: 0.0, base: 0.0, energy: 0.0, shape }];
        Self::from_pieces(pieces, FULL_STRAIN, line_start)
    }

    fn from_fat(variant: Fat) -> Result<Self, CurveError> {
        let (scale, rate) = variant.scale_and_rate();
        let shape = Shape::Exponential { scale, rate };
        let from = Fat::MEASURED_STRAIN;
        let (base, slope) = (shape.stress(from), shape.slope(from));
        let pieces = vec![
            Piece { from: 0.0, base: 0.0, energy: 0.0, shape },
            Piece { from, base, energy: 0.0, shape: Shape::Polynomial(vec![slope]) },
        ];
        let curve = Self::from_pieces(pieces, FULL_STRAIN, FULL_STRAIN)?;
        Ok(Self { measured_end: from, ..curve })
    }

    /// Builds a curve from its pieces; computes end values and energies.
    fn from_pieces(
        mut pieces: Vec<Piece>,
        data_end: f64,
        line_start: f64,
    ) -> Result<Self, CurveError> {
        for k in 1..pieces.len() {
            let before = &pieces[k - 1];
            let x = pieces[k].from - before.from;
            pieces[k].energy = before.energy + before.base * x + before.shape.energy(x);
        }
        let last = &pieces[pieces.len() - 1];
        let x = line_start - last.from;
        let end = (last.base + last.shape.stress(x), last.shape.slope(x));
        if !(end.0.is_finite() && end.1.is_finite() && end.0 <= STRESS_SCALE.1) {
            return Err(CurveError::Parameter {
                field: "stress at the end of the curve (kPa)".to_owned(),
                value: end.0,
                allowed: STRESS_SCALE.2,
            });
        }
        let end_energy = last.energy + last.base * x + last.shape.energy(x);
        // The lower bound keeps the final line increasing after a flat end.
        let end = (end.0, end.1.max(1e-6 * end.0 / line_start));
        let measured_end = data_end;
        Ok(Self { pieces, data_end, measured_end, line_start, end, end_energy, relaxation: None })
    }

    fn from_points(points: &[[f64; 2]], interpolation: Interpolation) -> Result<Self, CurveError> {
        check_points(points)?;
        let slopes = match interpolation {
            Interpolation::Line => Vec::new(),
            Interpolation::Spline => monotone_slopes(points),
        };
        let pieces = points
            .windows(2)
            .enumerate()
            .map(|(k, pair)| {
                let [[from, base], [to, end]] = [pair[0], pair[1]];
                let shape = match interpolation {
                    Interpolation::Line => Shape::Polynomial(vec![(end - base) / (to - from)]),
                    Interpolation::Spline => {
                        hermite(to - from, end - base, slopes[k], slopes[k + 1])
                    }
                };
                Piece { from, base, energy: 0.0, shape }
            })
            .collect();
        let end = points[points.len() - 1][0];
        Self::from_pieces(pieces, end, end)
    }

    fn from_sections(sections: &[Section]) -> Result<Self, CurveError> {
        if sections.is_empty() || sections.len() > MAX_POINTS {
            return Err(CurveError::Count {
                field: "sections",
                count: sections.len(),
                allowed: "1 to 100000",
            });
        }
        let mut pieces = Vec::with_capacity(sections.len());
        let (mut end, mut base, mut slope) = (0.0, 0.0, 0.0);
        for (index, section) in sections.iter().enumerate() {
            let invalid = |problem: String| CurveError::Entry { field: "sections", index, problem };
            let (from, to) = section.interval();
            if !(from.is_finite() && to.is_finite() && to > from && to <= MAX_STRAIN) {
                return Err(invalid(format!(
                    "goes from {} to {}; allowed: finite, to > from, at most {MAX_STRAIN}",
                    number(from),
                    number(to)
                )));
            }
            if (from - end).abs() > 1e-9 {
                let (from, end) = (number(from), number(end));
                return Err(invalid(format!("starts at strain {from}; it must start at {end}")));
            }
            // The section starts at the previous end: no gap remains between the sections.
            let length = to - end;
            if length < MIN_WIDTH {
                let length = number(length);
                return Err(invalid(format!(
                    "is {length} long; allowed: strains 1e-9 apart or more"
                )));
            }
            let shape = section
                .shape(length, base, slope)
                .map_err(|problem| invalid(problem.to_string()))?;
            if !shape.increases_over(length) {
                return Err(invalid(
                    "does not increase; Ef must increase over every section".to_owned(),
                ));
            }
            let rise = shape.stress(length);
            if !(rise.is_finite() && rise >= MIN_SLOPE * length) {
                return Err(invalid(
                    "does not increase by a slope of 1e-9 kPa or more; Ef must increase over every section"
                        .to_owned(),
                ));
            }
            slope = shape.slope(length);
            pieces.push(Piece { from: end, base, energy: 0.0, shape });
            (end, base) = (to, base + rise);
        }
        Self::from_pieces(pieces, end, end)
    }

    /// Is the slope at twice the length below that at rest?
    #[must_use]
    pub fn softens(&self) -> bool {
        self.slope(1.0) < self.small_strain_modulus()
    }

    /// Is the slope at twice the length above that at rest? A linear tissue neither stiffens nor softens.
    #[must_use]
    pub fn stiffens(&self) -> bool {
        self.slope(1.0) > self.small_strain_modulus()
    }

    /// [`Self::stress`] before relaxation.
    fn given_stress(&self, strain: f64) -> f64 {
        let x = strain.abs();
        let stress = if x > self.line_start {
            self.end.0 + self.end.1 * (x - self.line_start)
        } else {
            let piece = self.piece(x);
            piece.base + piece.shape.stress(x - piece.from)
        };
        stress.copysign(strain)
    }

    /// [`Self::slope`] before relaxation.
    fn given_slope(&self, strain: f64) -> f64 {
        let x = strain.abs();
        if x >= self.line_start {
            return self.end.1;
        }
        let piece = self.piece(x);
        piece.shape.slope(x - piece.from)
    }

    /// [`Self::energy`] before relaxation.
    fn given_energy(&self, strain: f64) -> f64 {
        let x = strain.abs();
        if x > self.line_start {
            let over = x - self.line_start;
            return self.end_energy + over * (self.end.0 + 0.5 * self.end.1 * over);
        }
        let piece = self.piece(x);
        let over = x - piece.from;
        piece.energy + piece.base * over + piece.shape.energy(over)
    }

    /// Secant modulus Ef(ε)/ε \[kPa\]; at zero the initial slope.
    #[must_use]
    pub fn secant(&self, strain: f64) -> f64 {
        if strain.abs() < 1e-9 { self.slope(0.0) } else { self.stress(strain) / strain }
    }

    /// Modulus at small strain Ef′(0) \[kPa\], the reference of stiffnesses. The lower bound for curves with
    /// a flat start is a thousandth of the secant at strain 0.01.
    #[must_use]
    pub fn small_strain_modulus(&self) -> f64 {
        self.slope(0.0).max(1e-3 * self.secant(0.01))
    }

    /// Strain at which the curve turns steep \[-\]: its slope is twice the initial slope from there on; `None` for a curve that
    /// does not stiffen so far.
    #[must_use]
    pub fn knee(&self) -> Option<f64> {
        const STEEP: f64 = 2.0;
        let modulus = self.given_slope(0.0).max(1e-3 * self.given_stress(0.01) / 0.01);
        let is_steep = |strain: f64| self.given_slope(strain) >= STEEP * modulus;
        let end = self.line_start;
        if !is_steep(end) {
            return None;
        }
        // The last interval of a fine division whose start is not steep, halved.
        const STEPS: u32 = 200;
        let at = |k: u32| end * f64::from(k) / f64::from(STEPS);
        let last = (0..STEPS).rev().find(|&k| !is_steep(at(k)))?;
        let (mut low, mut high) = (at(last), at(last + 1));
        for _ in 0..40 {
            let middle = 0.5 * (low + high);
            *(if is_steep(middle) { &mut high } else { &mut low }) = middle;
        }
        Some(high)
    }

    /// Strain at the end of the data \[-\]: the last point or section, 1 for a formula; times the strain scale.
    #[must_use]
    pub fn data_end(&self) -> f64 {
        self.data_end
    }

    /// Strain at the end of the measurements behind the curve \[-\], times the strain scale: [`Fat::MEASURED_STRAIN`] of the fat
    /// preset, which continues as a line; [`Self::data_end`] of all other kinds.
    #[must_use]
    pub fn measured_end(&self) -> f64 {
        self.measured_end
    }

    /// Start of the final line with the end slope \[-\]: the end of the data; an arctangent keeps its
    /// formula up to strain 10, times the strain scale.
    #[must_use]
    pub fn line_start(&self) -> f64 {
        self.line_start
    }

    /// End of the strains that a table of this curve covers \[-\]: the start of the final line, at most strain 10 or
    /// the end of the data. The formula of an arctangent with a large strain scale goes farther; a table up to there would
    /// lose accuracy at the strains of tissue.
    #[must_use]
    pub(crate) fn table_end(&self) -> f64 {
        let end = self.line_start.min(MAX_STRAIN.max(self.data_end));
        end.max(self.relaxed_above().unwrap_or_default())
    }

    /// Returns `true` if the strain (of either sign) lies beyond the data.
    #[must_use]
    pub fn is_beyond_data(&self, strain: f64) -> bool {
        strain.abs() > self.data_end * (1.0 + 1e-9)
    }

    /// Strains at the ends of the pieces, the start of the final line last \[-\]; the slope may jump there.
    pub fn breaks(&self) -> impl Iterator<Item = f64> + '_ {
        let inner = self.pieces.iter().skip(1).map(|p| p.from);
        inner.chain([self.line_start]).chain(self.relaxed_above().filter(|strain| *strain > 0.0))
    }

    fn piece(&self, x: f64) -> &Piece {
        let k = self.pieces.partition_point(|p| p.from <= x);
        &self.pieces[k.saturating_sub(1)]
    }
}

type Range = (f64, f64, &'static str);
const STRESS_SCALE: Range = (1e-6, 1e7, "1e-6 to 1e7 kPa");
const SLOPE: Range = (0.0, 1e9, "0 to 1e9 kPa");
const COEFFICIENT: Range = (-1e9, 1e9, "-1e9 to 1e9 kPa");
const RATE: Range = (1e-3, 100.0, "0.001 to 100");
const MAX_STRAIN: f64 = 10.0;
/// Smallest width of a piece \[-\]; smaller differences of strains cancel.
const MIN_WIDTH: f64 = 1e-9;
/// Smallest mean slope of a piece \[kPa\]; smaller quotients of stress and strain cancel.
const MIN_SLOPE: f64 = 1e-9;

fn checked(field: &str, value: f64, (least, most, allowed): Range) -> Result<f64, CurveError> {
    if (least..=most).contains(&value) {
        Ok(value)
    } else {
        Err(CurveError::Parameter { field: field.to_owned(), value, allowed })
    }
}

/// The skin preset in three sections (0.4 and 0.7 as in the paper, after Hendriks).
fn skin_sections() -> [Section; 3] {
    [
        Section::Linear { from: 0.0, to: 0.4, modulus_kpa: 100.0 },
        Section::Cubic { from: 0.4, to: 0.7, end_stress_kpa: 205.0, end_slope_kpa: 1000.0 },
        Section::Linear { from: 0.7, to: FULL_STRAIN, modulus_kpa: 1000.0 },
    ]
}
