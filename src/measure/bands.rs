//! The limits of strain and pressure: value, word and source, in one table.
//!
//! The words describe; the limits are not a diagnosis. A limit of the cover over the implant is not part of the table: no
//! measurement of a limit was found.

use super::STRAIN_BANDS;

/// Contact pressures above which the word changes \[mmHg\]: 30–60 mmHg were measured right after clinical
/// filling of expanders; above 80 mmHg one pig study found blood flow near zero.
pub const PRESSURE_BANDS_MMHG: [f64; 2] = [60.0, 80.0];

/// A band of values with its word.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Band {
    /// Upper limit of the band, the limit included; the last band has none.
    pub limit: Option<f64>,
    /// Word for a value in the band.
    pub word: &'static str,
    /// Origin of the upper limit; empty in the last band.
    pub source: &'static str,
}

/// The bands of a quantity, from low to high.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// The quantity.
    pub quantity: &'static str,
    /// Unit of the limits; empty without one.
    pub unit: &'static str,
    /// The bands.
    pub bands: &'static [Band],
    /// What a reader of the words must know.
    pub note: &'static str,
}

/// Greatest principal strain of the skin \[-\], against the model's own rest.
pub const STRAIN: Limits = Limits {
    quantity: "greatest principal strain",
    unit: "",
    bands: &[
        Band {
            limit: Some(STRAIN_BANDS[0]),
            word: "usual",
            source: "Strains below 25 % are usual.",
        },
        Band {
            limit: Some(STRAIN_BANDS[1]), word: "high", source: "Strains of 25–50 % are high."
        },
        Band {
            limit: Some(STRAIN_BANDS[2]),
            word: "very high",
            source: "Mean failure strain of excised back skin: 54 ± 17 %.",
        },
        Band { limit: None, word: "beyond", source: "" },
    ],
    note: "Strains count from the rest of the model. Standing, the skin of the breast already carries strains of up to \
        60 % in places (39 women).",
};

/// Contact pressure \[mmHg\].
pub const PRESSURE: Limits = Limits {
    quantity: "contact pressure",
    unit: "mmHg",
    bands: &[
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[0]),
            word: "usual",
            source: "30–60 mmHg were measured right after clinical filling of expanders.",
        },
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[1]),
            word: "high",
            source: "Above 80 mmHg blood flow was near zero in one study of pigs; in another it fell only moderately \
                to 100 mmHg.",
        },
        Band { limit: None, word: "very high", source: "" },
    ],
    note: "The pressure directly after filling; relaxation is not modelled.",
};

/// All limits.
pub const LIMITS: [&Limits; 2] = [&STRAIN, &PRESSURE];

/// Contact pressures measured right after clinical filling of expanders \[mmHg\].
pub const FILLING_PRESSURE_MMHG: (f64, f64) = (30.0, 60.0);

/// Fraction of the geometric area gain of an expander that was realised in vivo \[-\].
pub const REALISED_AREA_GAIN: f64 = 0.35;

impl Limits {
    /// Index of the band of a value, 0 for the lowest band.
    #[must_use]
    pub fn band(&self, value: f64) -> usize {
        self.bands.iter().filter(|band| band.limit.is_some_and(|limit| value > limit)).count()
    }

    /// Word for a value.
    #[must_use]
    pub fn word(&self, value: f64) -> &'static str {
        self.bands[self.band(value)].word
    }
}

/// Band of a greatest principal strain \[-\], 0 to 3.
#[must_use]
pub fn strain_band(strain: f64) -> usize {
    STRAIN.band(strain)
}

/// Band of a contact pressure \[mmHg\], 0 to 2.
#[must_use]
pub fn pressure_band(mmhg: f64) -> usize {
    PRESSURE.band(mmhg)
}

/// Word for a greatest principal strain \[-\].
#[must_use]
pub fn strain_word(strain: f64) -> &'static str {
    STRAIN.word(strain)
}

/// Word for a contact pressure \[mmHg\].
#[must_use]
pub fn pressure_word(mmhg: f64) -> &'static str {
    PRESSURE.word(mmhg)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_change_at_their_limits() {
        let strains = [0.25, 0.26, 0.5, 0.51, 0.54, 0.55].map(strain_word);
        assert_eq!(strains[..2], ["usual", "high"]);
        assert_eq!(strains[2..4], ["high", "very high"]);
        assert_eq!(strains[4..], ["very high", "beyond"]);
        assert_eq!([60.0, 60.1, 80.1].map(pressure_word), ["usual", "high", "very high"]);
    }

    #[test]
    fn every_table_has_increasing_limits_with_sources_and_an_open_end() {
        for limits in LIMITS {
            let (last, below) = limits.bands.split_last().unwrap();
            assert_eq!((last.limit, last.source), (None, ""));
            let values: Vec<f64> = below.iter().map(|band| band.limit.unwrap()).collect();
            assert!(values.windows(2).all(|pair| pair[0] < pair[1]), "{}", limits.quantity);
            assert!(below.iter().all(|band| !band.source.is_empty()));
        }
    }
}
