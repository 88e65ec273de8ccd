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

/// Greatest principal strain of the skin \[-\], against the model's own rest; for a skin without a reserve.
pub const STRAIN: Limits = Limits {
    quantity: "greatest principal strain",
    unit: "",
    bands: &[
        Band {
            limit: Some(STRAIN_BANDS[0]),
            word: "usual",
            source: "Up to 25 % usual: less than half of the stretch at which skin tears; a convention of this program.",
        },
        Band {
            limit: Some(STRAIN_BANDS[1]),
            word: "high",
            source: "25–50 % high: up to the stretch at which skin tears; a convention of this program.",
        },
        Band {
            limit: Some(STRAIN_BANDS[2]),
            word: "very high",
            source: "50–54 % very high, above beyond: skin tore at 54 ± 17 % (mean of 56 samples of excised back skin; Ní \
                Annaidh and others, J Mech Behav Biomed Mater 5, 2012).",
        },
        Band { limit: None, word: "beyond", source: "" },
    ],
    note: STANDING,
};

/// What every strain of the skin leaves out.
const STANDING: &str = "The stretch counts from the skin at rest. Standing alone stretches the skin of the breast by up to 60 % in \
    places (39 women; Norris and others, BMJ Open Sport Exerc Med 6, 2020).";

/// Greatest principal strain of the skin / strain at which this skin's curve turns steep \[-\]
/// ([`Curve::knee`](crate::curve::Curve::knee)).
pub const RESERVE: Limits = Limits {
    quantity: "share of the skin's reserve",
    unit: "",
    bands: &[
        Band {
            limit: Some(0.8),
            word: "usual",
            source: "Up to 80 % of the reserve usual: a convention of this program.",
        },
        Band {
            limit: Some(1.0),
            word: "high",
            source: "80–100 % high, above very high. The reserve is the stretch at which this skin gets twice as stiff as at \
                rest: from there each further millimetre costs more and more stress (curve of skin in vivo: Hendriks 2005, as in \
                Nikolaev 2013). The class of the skin sets the reserve within a factor of 2 (1 standard deviation).",
        },
        Band { limit: None, word: "very high", source: "" },
    ],
    note: STANDING,
};

/// Contact pressure \[mmHg\].
pub const PRESSURE: Limits = Limits {
    quantity: "contact pressure",
    unit: "mmHg",
    bands: &[
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[0]),
            word: "usual",
            source: "Up to 60 mmHg usual: 30–60 mmHg were measured right after clinical filling of expanders.",
        },
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[1]),
            word: "high",
            source: "60–80 mmHg high, above very high: above 80 mmHg the blood flow of the skin was near zero in one study of pigs; in \
                another it fell only moderately to 100 mmHg (expanded skin; Ann Plast Surg 21, 1988).",
        },
        Band { limit: None, word: "very high", source: "" },
    ],
    note: "The pressure directly after filling; relaxation is not modelled.",
};

/// Least cover below which a plan has the practice's word \[mm\].
pub const THIN_COVER_MM: f64 = 5.0;

/// What is known about a limit of the cover.
pub const COVER: &str = "Below 5 mm thin: a word of practice, no measured limit. With a pinch below 2 cm at the upper pole, a cover of 10 \
    mm at rest, surgeons go under the muscle (Tebbetts and Adams, Plast Reconstr Surg 116, 2005); 5 mm are half of that.";

/// All limits.
pub const LIMITS: [&Limits; 3] = [&STRAIN, &RESERVE, &PRESSURE];

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

    /// Band and word of a value.
    #[must_use]
    pub fn verdict(&self, value: f64) -> (usize, &'static str) {
        (self.band(value), self.word(value))
    }

    /// Word for a value.
    #[must_use]
    pub fn word(&self, value: f64) -> &'static str {
        self.bands[self.band(value)].word
    }
}

/// Band and word of the stretch of a skin: those of its share of the reserve \[-\], or of its greatest principal strain \[-\]
/// if the skin has no reserve.
#[must_use]
pub fn stretch(strain: f64, reserve: Option<f64>) -> (usize, &'static str) {
    reserve.map_or_else(|| STRAIN.verdict(strain), |share| RESERVE.verdict(share))
}

/// The limits of the greatest principal strain of a skin whose curve turns steep at the strain `knee` \[-\], and the factor
/// from a strain to their unit: the words are those of [`stretch`].
#[must_use]
pub fn strain_limits(knee: Option<f64>) -> (&'static Limits, f64) {
    knee.map_or((&STRAIN, 1.0), |knee| (&RESERVE, 1.0 / knee))
}

/// Band and word of a thin cover \[mm\]; `None` for any other.
#[must_use]
pub fn cover(least_mm: f64) -> Option<(usize, &'static str)> {
    (least_mm < THIN_COVER_MM).then_some((1, "thin"))
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
