//! Colours of quantities and tissues, and scales of the colour bar.

use crate::measure::{Field, STRAIN_BANDS};
use crate::scene::Layer;

/// A colour as sRGB, 0 to 1 each.
pub type Rgb = [f32; 3];

/// Colours in a look-up table.
pub const TABLE_SIZE: usize = 256;

/// The quantity that colours the surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// The tissue's own colour.
    Tissue,
    /// Greatest principal strain, in the clinical bands.
    #[default]
    Strain,
    /// Area stretch.
    AreaStretch,
    /// Greatest principal stress of a layer, counted from the skin.
    Stress(usize),
    /// Contact pressure on the implant.
    Pressure,
    /// Layered tissue: greatest principal strain of a layer, counted from the skin, in the clinical bands.
    LayerStrain(usize),
    /// Layered tissue: thickness of a layer relative to its thickness at rest.
    Thickness(usize),
    /// Layered tissue: distance between implant and skin.
    Cover,
    /// Layered tissue: pull of the attachment around the pocket.
    Traction,
}

/// The scale of a colour bar.
#[derive(Clone, Debug, PartialEq)]
pub struct Scale {
    /// Name of the quantity, as "Principal strain".
    pub title: String,
    /// Unit of the labels.
    pub unit: &'static str,
    /// Field value at the lower end.
    pub low: f32,
    /// Field value at the upper end.
    pub high: f32,
    /// Field values of the ticks, with their labels.
    pub ticks: Vec<(f32, String)>,
    /// The colours from low to high.
    pub table: Vec<Rgb>,
}

impl Quantity {
    /// The nodal field of the quantity; `None` for plain tissue.
    #[must_use]
    pub fn field(&self) -> Option<Field> {
        match *self {
            Self::Tissue => None,
            Self::Strain => Some(Field::PrincipalStrain),
            Self::AreaStretch => Some(Field::AreaStretch),
            Self::Stress(layer) => Some(Field::Stress(layer)),
            Self::Pressure => Some(Field::ContactPressure),
            Self::LayerStrain(layer) => Some(Field::LayerStrain(layer)),
            Self::Thickness(layer) => Some(Field::ThicknessStretch(layer)),
            Self::Cover => Some(Field::Cover),
            Self::Traction => Some(Field::Traction),
        }
    }

    /// The scale of the colour bar for the field's values; `None` for plain tissue.
    #[must_use]
    pub fn scale(&self, values: &[f32], layers: &[Layer]) -> Option<Scale> {
        let greatest = values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f32::max);
        let name = |layer: usize| layers.get(layer).map_or("layer", |l| l.tissue.as_str());
        Some(match *self {
            Self::Tissue => return None,
            Self::Strain => strain_scale(),
            Self::LayerStrain(layer) => {
                Scale { title: format!("Strain of {}", name(layer)), ..strain_scale() }
            }
            Self::Thickness(layer) => {
                let high = nice_above(f64::from(greatest).max(1.0)) as f32;
                even(format!("Thickness of {}", name(layer)), "×", 0.0, high, sequential)
            }
            // Cover far beside the implant is of no interest.
            Self::Cover => even("Cover".to_owned(), "mm", 0.0, 20.0, sequential),
            Self::Traction => {
                let high = nice_above(f64::from(greatest).max(1e-3)) as f32;
                even("Pull at the pocket's edge".to_owned(), "kPa", 0.0, high, sequential)
            }
            Self::AreaStretch => {
                let high = nice_above(f64::from(greatest - 1.0).max(0.1)) as f32 + 1.0;
                even("Area stretch".to_owned(), "×", 1.0, high, sequential)
            }
            Self::Stress(layer) => {
                let high = nice_above(f64::from(greatest).max(1e-3)) as f32;
                even(format!("Stress in {}", name(layer)), "kPa", 0.0, high, sequential)
            }
            Self::Pressure => {
                let high = nice_above(f64::from(greatest).max(1e-3)) as f32;
                even("Contact pressure".to_owned(), "kPa", 0.0, high, sequential)
            }
        })
    }
}

/// The colour of a tissue: skin, adipose and muscle have colours of their own, others a colour of a muted palette by
/// `index`.
#[must_use]
pub fn tissue(name: &str, index: usize) -> Rgb {
    const OTHERS: [Rgb; 6] = [
        [0.72, 0.45, 0.42],
        [0.60, 0.68, 0.72],
        [0.74, 0.66, 0.56],
        [0.63, 0.57, 0.68],
        [0.58, 0.68, 0.58],
        [0.78, 0.70, 0.74],
    ];
    match name.trim().to_lowercase().as_str() {
        "skin" => [0.87, 0.68, 0.58],
        "adipose" | "fat" => [0.97, 0.87, 0.55],
        "muscle" => [0.70, 0.34, 0.31],
        _ => OTHERS[index % OTHERS.len()],
    }
}

/// The implant: pearl.
pub const IMPLANT: Rgb = [0.80, 0.82, 0.85];
/// The chest wall: muscle, muted.
pub const WALL: Rgb = [0.62, 0.43, 0.42];

/// Perceptually uniform from dark blue over green to yellow (viridis, N. Smith and S. van der
/// Walt, polynomial fit by M. Zucker), without its darkest tenth.
#[must_use]
pub fn sequential(t: f32) -> Rgb {
    let t = 0.1 + 0.9 * t.clamp(0.0, 1.0);
    let coefficients: [[f32; 3]; 7] = [
        [0.277_727, 0.005_407, 0.334_1],
        [0.105_093, 1.404_614, 1.384_59],
        [-0.330_862, 0.214_848, 0.095_095],
        [-4.634_23, -5.799_1, -19.332_44],
        [6.228_27, 14.179_93, 56.690_55],
        [4.776_385, -13.745_15, -65.353_03],
        [-5.435_456, 4.645_853, 26.312_435],
    ];
    std::array::from_fn(|k| {
        coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c[k]).clamp(0.0, 1.0)
    })
}

/// Colour of a strain by bands: neutral below 0.25, amber to 0.5, red above, dark red beyond failure.
#[must_use]
pub fn strain_bands(strain: f32) -> Rgb {
    let [high, very_high, failure] = STRAIN_BANDS.map(|limit| limit as f32);
    let bands: [(f32, Rgb, Rgb); 4] = [
        (high, [0.93, 0.95, 0.93], [0.36, 0.66, 0.66]),
        (very_high, [0.99, 0.85, 0.58], [0.88, 0.46, 0.13]),
        (failure, [0.84, 0.33, 0.22], [0.80, 0.27, 0.20]),
        (0.8, [0.62, 0.12, 0.24], [0.36, 0.03, 0.22]),
    ];
    let band = bands.iter().position(|(to, ..)| strain < *to).unwrap_or(bands.len() - 1);
    let (to, low, high) = bands[band];
    let from = if band == 0 { 0.0 } else { bands[band - 1].0 };
    let t = ((strain - from) / (to - from)).clamp(0.0, 1.0);
    std::array::from_fn(|k| low[k] + (high[k] - low[k]) * t)
}

fn strain_scale() -> Scale {
    let (low, high) = (0.0, 0.8);
    let [strain_high, very_high, failure] = STRAIN_BANDS;
    let marks = [0.0, strain_high, very_high, failure, f64::from(high)];
    Scale {
        title: "Principal strain".to_owned(),
        unit: "%",
        low,
        high,
        ticks: marks.iter().map(|m| (*m as f32, format!("{:.0}", 100.0 * m))).collect(),
        table: table(|t| strain_bands(low + (high - low) * t)),
    }
}

fn even(title: String, unit: &'static str, low: f32, high: f32, map: fn(f32) -> Rgb) -> Scale {
    let decimals = decimals_for(f64::from(high - low) / 4.0);
    let ticks = (0..=4)
        .map(|k| low + (high - low) * k as f32 / 4.0)
        .map(|v| (v, format!("{v:.decimals$}")))
        .collect();
    Scale { title, unit, low, high, ticks, table: table(map) }
}

fn table(map: impl Fn(f32) -> Rgb) -> Vec<Rgb> {
    (0..TABLE_SIZE).map(|k| map((k as f32 + 0.5) / TABLE_SIZE as f32)).collect()
}

/// The least of 1, 2, 4, 8 times a power of ten that is not below the value; quarters of these are round
/// numbers.
#[must_use]
pub fn nice_above(value: f64) -> f64 {
    let unit = 10f64.powf(value.max(1e-12).log10().floor());
    let steps = [1.0, 2.0, 4.0, 8.0, 10.0];
    steps.into_iter().map(|s| s * unit).find(|s| *s >= value * 0.999).unwrap_or(10.0 * unit)
}

fn decimals_for(step: f64) -> usize {
    (0..6)
        .find(|d| {
            let scaled = step * 10f64.powi(*d);
            (scaled - scaled.round()).abs() < 1e-3 * scaled.max(1e-9)
        })
        .unwrap_or(6) as usize
}

#[cfg(test)]
mod tests {
    use super::*;

    fn luminance(c: Rgb) -> f32 {
        let linear = c.map(|v| v.powf(2.2));
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]
    }

    #[test]
    fn the_luminance_of_the_sequential_map_increases() {
        let mut last = 0.0;
        for k in 0..=100 {
            let now = luminance(sequential(k as f32 / 100.0));
            assert!(now > last, "{k}");
            last = now;
        }
    }

    #[test]
    fn strain_bands_darken_and_jump_at_their_limits() {
        let samples: Vec<f32> = (0..800).map(|k| k as f32 / 1000.0).collect();
        for limit in STRAIN_BANDS {
            let (a, b) = (strain_bands(limit as f32 - 1e-4), strain_bands(limit as f32 + 1e-4));
            let jump: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
            assert!(jump > 0.15, "{limit}: {jump}");
        }
        assert!(luminance(strain_bands(samples[0])) > 4.0 * luminance(strain_bands(0.79)));
    }

    #[test]
    fn scale_ends_are_round_numbers_above_the_value() {
        for (value, nice) in [(0.13, 0.2), (3.0, 4.0), (8.1, 10.0), (42.0, 80.0), (100.0, 100.0)] {
            assert!((nice_above(value) - nice).abs() < 1e-9 * nice, "{value}");
        }
    }
}
