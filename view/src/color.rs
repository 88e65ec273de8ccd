//! Colours of strains and tissues, and scales of the colour bar.

use implant_preview_core::measure::MMHG_PER_KPA;
use implant_preview_core::measure::bands::{self, SkinLimits};

/// A colour as sRGB, 0 to 1 each.
pub type Rgb = [f32; 3];

/// A colour as bytes.
#[must_use]
pub fn bytes(color: Rgb) -> [u8; 3] {
    color.map(|part| (255.0 * part.clamp(0.0, 1.0)).round() as u8)
}

/// Colours in a look-up table.
pub const TABLE_SIZE: usize = 256;

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
    /// Words of the bands, with the field values of their middles; empty without bands.
    pub words: Vec<(f32, &'static str)>,
    /// Greatest value of the field, to be marked.
    pub greatest: Option<f32>,
    /// The colours from low to high.
    pub table: Vec<Rgb>,
}

/// The greatest finite value, at least 0.
#[must_use]
pub fn greatest(values: &[f32]) -> f32 {
    values.iter().copied().filter(|v| v.is_finite()).fold(0.0, f32::max)
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

/// Pattern of a tissue on a cut face.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pattern {
    /// One colour.
    #[default]
    Plain,
    /// The epidermis as a line along the outer surface.
    Skin,
    /// Lobules.
    Fat,
}

/// The pattern of a tissue.
#[must_use]
pub fn pattern(name: &str) -> Pattern {
    match name.trim().to_lowercase().as_str() {
        "skin" => Pattern::Skin,
        "adipose" | "fat" => Pattern::Fat,
        _ => Pattern::Plain,
    }
}

/// The implant: gel in a shell.
pub const IMPLANT: Rgb = [0.70, 0.73, 0.77];
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

/// Colours of the bands from "usual" to "beyond", each from its start to its end. Lightness falls throughout.
const BANDS: [(Rgb, Rgb); 4] = [
    ([0.87, 0.90, 0.84], [0.44, 0.71, 0.71]),
    ([0.88, 0.60, 0.14], [0.75, 0.39, 0.05]),
    ([0.75, 0.24, 0.16], [0.66, 0.15, 0.15]),
    ([0.46, 0.05, 0.24], [0.20, 0.01, 0.16]),
];

/// Colour of a whole band, counted from "usual".
#[must_use]
pub fn band(band: usize) -> Rgb {
    let (low, high) = BANDS[band.min(BANDS.len() - 1)];
    std::array::from_fn(|k| 0.5 * (low[k] + high[k]))
}

/// The cover over the implant in the bar of its card.
pub const COVER: Rgb = [0.80, 0.66, 0.36];

/// Upper end of the colours of strain \[-\] of a skin without a reserve; greater strains have the last colour.
pub const MOST_STRAIN: f64 = 0.8;
/// Upper end of the colours of the share of a reserve \[-\]; greater shares have the last colour.
pub const MOST_RESERVE: f64 = 1.5;
/// Upper end of the colours of strain against practice \[-\]: a little above the strains at which skin tears.
pub const MOST_OF_PRACTICE: f64 = 0.6;

/// Upper end of the colours of a strain with these limits \[unit of the limits\].
#[must_use]
pub fn most(skin: SkinLimits) -> f64 {
    match skin {
        SkinLimits::Practice(_) => MOST_OF_PRACTICE,
        SkinLimits::Reserve(_) => MOST_RESERVE,
        SkinLimits::Tearing => MOST_STRAIN,
    }
}

/// Colour of a value by the level of its band \[unit of the limits\]; values above `most` have the last colour.
#[must_use]
pub fn in_band(limits: &bands::Limits, most: f64, value: f32) -> Rgb {
    let value = value.min(most as f32);
    let end = |band: &bands::Band| band.limit.unwrap_or(most) as f32;
    // Neighbours of one level share one ramp.
    let levels = limits.bands.chunk_by(|a, b| a.level == b.level);
    let mut from = 0.0;
    for level in levels {
        let [.., last] = level else { continue };
        let (low, high) = BANDS[last.level.min(BANDS.len() - 1)];
        let to = end(last);
        if value <= to {
            let t = ((value - from) / (to - from)).clamp(0.0, 1.0);
            return std::array::from_fn(|k| low[k] + (high[k] - low[k]) * t);
        }
        from = to;
    }
    BANDS[BANDS.len() - 1].1
}

/// Linear red, green and blue of a strain of the skin on the scale of the picture, for files of other programs. `skin`: what the strain is
/// compared with.
#[must_use]
pub fn linear_of_strain(strain: f32, skin: SkinLimits) -> Rgb {
    let (limits, to_limits) = skin.limits();
    let colour = in_band(&limits, most(skin), to_limits as f32 * strain);
    colour.map(|v| if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) })
}

impl Scale {
    /// The stretch of skins with other limits as shares of their reserves \[-\], up to the `greatest` one.
    #[must_use]
    pub fn of_reserve(greatest: f32) -> Self {
        Self { unit: "% of the reserve", ..strain_scale(greatest, SkinLimits::Reserve(1.0)) }
    }
}

/// The strain of a skin in the bands of its limits.
pub(crate) fn strain_scale(greatest: f32, skin: SkinLimits) -> Scale {
    let (limits, to_limits) = skin.limits();
    let most = most(skin);
    let strain = |limit: f64| (limit / to_limits) as f32;
    let tick = |value: f32| (value, format!("{:.0}", 100.0 * value));
    let (mut from, mut words) = (0.0, Vec::new());
    for band in &*limits.bands {
        let to = band.limit.unwrap_or(most);
        words.push((strain(0.5 * (from + to)), band.word));
        from = to;
    }
    let inner = limits.bands.iter().filter_map(|band| band.limit);
    let ticks = [0.0].into_iter().chain(inner).chain([most]);
    Scale {
        title: "Skin stretch".to_owned(),
        unit: "%",
        low: 0.0,
        high: strain(most),
        ticks: ticks.map(|limit| tick(strain(limit))).collect(),
        words,
        greatest: Some(greatest),
        table: table(|t| in_band(&limits, most, t * most as f32)),
    }
}

/// Colours of taut, wrinkled and slack skin; the lightness falls.
const WRINKLES: [Rgb; 3] = [[0.87, 0.84, 0.78], [0.48, 0.66, 0.74], [0.50, 0.42, 0.58]];

/// The state of the skin: three colours, each with its word in place of a number.
pub(crate) fn wrinkle_scale() -> Scale {
    let state = |t: f32| WRINKLES[((3.0 * t) as usize).min(2)];
    Scale {
        title: "Wrinkles".to_owned(),
        unit: "",
        low: -0.5,
        high: 2.5,
        ticks: (0..)
            .zip(["taut", "wrinkled", "slack"])
            .map(|(k, s)| (k as f32, s.to_owned()))
            .collect(),
        words: Vec::new(),
        greatest: None,
        table: table(state),
    }
}

/// Contact pressure: field values in kPa, labels in mmHg; without contact the colour of skin.
pub(crate) fn pressure_scale(greatest: f32) -> Scale {
    // The end is one of 20, 40, 80, 100, 200, … mmHg: equal for similar implants.
    let end_mmhg = nice_above((f64::from(greatest) * MMHG_PER_KPA).max(11.0));
    let high = (end_mmhg / MMHG_PER_KPA) as f32;
    let ticks = (0..=4).map(|k| 0.25 * k as f32).map(|t| {
        let mmhg = f64::from(t) * end_mmhg;
        (t * high, format!("{mmhg:.0}"))
    });
    let skin = tissue("skin", 0);
    let map = |t: f32| if t < NO_CONTACT { skin } else { sequential(t) };
    Scale {
        title: "Pressure".to_owned(),
        unit: "mmHg",
        low: 0.0,
        high,
        ticks: ticks.collect(),
        words: Vec::new(),
        greatest: Some(greatest),
        table: table(map),
    }
}

/// Fraction of the scale of pressure below which there is no contact \[-\].
const NO_CONTACT: f32 = 0.015;

pub(crate) fn even(
    title: String,
    unit: &'static str,
    low: f32,
    high: f32,
    map: fn(f32) -> Rgb,
) -> Scale {
    let decimals = decimals_for(f64::from(high - low) / 4.0);
    let ticks = (0..=4)
        .map(|k| low + (high - low) * k as f32 / 4.0)
        .map(|v| (v, format!("{v:.decimals$}")))
        .collect();
    Scale { title, unit, low, high, ticks, words: Vec::new(), greatest: None, table: table(map) }
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
    fn bands_of_strain_darken_throughout_and_jump_at_their_limits() {
        for (limits, most) in [(&bands::STRAIN, MOST_STRAIN), (&bands::RESERVE, MOST_RESERVE)] {
            let color = |value: f64| in_band(limits, most, value as f32);
            let mut last = f32::INFINITY;
            for k in 0..800 {
                let now = luminance(color(most * f64::from(k) / 800.0));
                assert!(now < last, "at {k}: {now} after {last}");
                last = now;
            }
            for limit in limits.bands.iter().filter_map(|band| band.limit) {
                let (a, b) = (color(limit - 1e-4), color(limit + 1e-4));
                let jump: f32 = a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum();
                assert!(jump > 0.15, "{limit}: {jump}");
            }
            assert!(luminance(color(0.0)) > 4.0 * luminance(color(0.99 * most)));
            assert!(color(2.0).iter().zip(color(most)).all(|(a, b)| (a - b).abs() < 1e-6));
        }
    }

    #[test]
    fn the_legend_of_strain_has_the_words_of_the_cards() {
        let of_skin = |knee: Option<f64>, expected: &[&str]| {
            let scale = strain_scale(0.21, SkinLimits::of_skin(knee));
            let words: Vec<&str> = scale.words.iter().map(|(_, word)| *word).collect();
            assert_eq!(words, expected);
            assert_eq!(scale.greatest, Some(0.21));
            for (value, word) in scale.words {
                let strain = f64::from(value);
                assert_eq!(bands::stretch(strain, knee.map(|knee| strain / knee)).1, word);
            }
            scale.ticks.into_iter().map(|(_, label)| label).collect::<Vec<_>>()
        };
        let of_sheet = of_skin(None, &["usual", "high", "very high", "beyond"]);
        assert_eq!(of_sheet, ["0", "25", "50", "54", "80"]);
        // A skin that turns steep at 20 %.
        let of_reserve = of_skin(Some(0.2), &["reserve left", "little reserve", "no reserve"]);
        assert_eq!(of_reserve, ["0", "16", "20", "30"]);
    }

    #[test]
    fn each_state_of_the_skin_has_one_colour_and_its_word() {
        let scale = wrinkle_scale();
        let at = |value: f32| {
            let t = (value - scale.low) / (scale.high - scale.low);
            scale.table[(t * TABLE_SIZE as f32) as usize]
        };
        for (k, word) in ["taut", "wrinkled", "slack"].into_iter().enumerate() {
            let (value, label) = &scale.ticks[k];
            assert_eq!(label, word);
            for off in [-0.4, 0.0, 0.4] {
                assert_eq!(at(value + off).map(f32::to_bits), WRINKLES[k].map(f32::to_bits));
            }
        }
        assert!(WRINKLES.windows(2).all(|pair| luminance(pair[0]) > luminance(pair[1])));
    }

    #[test]
    fn pressure_is_labelled_in_mmhg_and_without_contact_has_the_colour_of_skin() {
        let scale = pressure_scale(1.69);
        assert_eq!(scale.ticks.last().map(|(_, label)| label.as_str()), Some("20"));
        assert!((f64::from(scale.high) * MMHG_PER_KPA - 20.0).abs() < 1e-4);
        assert_eq!((scale.table[0], scale.table[8]), (tissue("skin", 0), sequential(8.5 / 256.0)));
    }

    #[test]
    fn scale_ends_are_round_numbers_above_the_value() {
        for (value, nice) in [(0.13, 0.2), (3.0, 4.0), (8.1, 10.0), (42.0, 80.0), (100.0, 100.0)] {
            assert!((nice_above(value) - nice).abs() < 1e-9 * nice, "{value}");
        }
    }

    #[test]
    fn the_linear_colours_of_a_file_are_those_of_the_scale() {
        let skin = SkinLimits::Tearing;
        let scale = strain_scale(0.6, skin);
        for k in [0, 40, 90, 200] {
            let strain = scale.high * (k as f32 + 0.5) / TABLE_SIZE as f32;
            let linear = linear_of_strain(strain, skin);
            let srgb = linear.map(|v| {
                if v <= 0.003_130_8 { 12.92 * v } else { 1.055 * v.powf(1.0 / 2.4) - 0.055 }
            });
            let [a, b] = [srgb, scale.table[k]];
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-3), "{k}: {a:?} {b:?}");
        }
    }
}
