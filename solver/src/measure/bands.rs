//! The limits of strain and pressure: value, word and source, in one table.
//!
//! The words describe; the limits are not a diagnosis. A limit of the cover over the implant is not part of the table: no
//! measurement of a limit was found.

use super::STRAIN_BANDS;
use std::borrow::Cow;

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
    /// Severity of the word, 0 for a calm one: its colour and its strokes. Bands of one level have one colour.
    pub level: usize,
    /// Origin of the upper limit; empty in the last band.
    pub source: &'static str,
}

/// The bands of a quantity, from low to high.
#[derive(Clone, Debug, PartialEq)]
pub struct Limits {
    /// The quantity.
    pub quantity: &'static str,
    /// Unit of the limits; empty without one.
    pub unit: &'static str,
    /// The bands.
    pub bands: Cow<'static, [Band]>,
    /// What a reader of the words must know.
    pub note: &'static str,
}

/// Greatest principal strain of the skin \[-\], against the model's own rest; for a skin without a reserve.
pub static STRAIN: Limits = Limits {
    quantity: "greatest principal strain",
    unit: "",
    bands: Cow::Borrowed(&[
        Band {
            limit: Some(STRAIN_BANDS[0]),
            word: "usual",
            level: 0,
            source: "Up to 25 % usual: less than half of the stretch at which skin tears; a convention of this program.",
        },
        Band {
            limit: Some(STRAIN_BANDS[1]),
            word: "high",
            level: 1,
            source: "25–50 % high: up to the stretch at which skin tears; a convention of this program.",
        },
        Band {
            limit: Some(STRAIN_BANDS[2]),
            word: "very high",
            level: 2,
            source: "50–54 % very high, above beyond: skin tore at 54 ± 17 % (mean of 56 samples of excised back skin; Ní \
                Annaidh and others, J Mech Behav Biomed Mater 5, 2012).",
        },
        Band { limit: None, word: "beyond", level: 3, source: "" },
    ]),
    note: STANDING,
};

/// What every strain of the skin leaves out.
const STANDING: &str = "The stretch counts from skin without tension. Standing alone stretches the skin of the breast by up to 60 % in \
    places (39 women; Norris and others, BMJ Open Sport Exerc Med 6, 2020).";

/// Greatest principal strain of the skin / strain at which this skin's curve turns steep \[-\]
/// ([`Curve::knee`](crate::curve::Curve::knee)). Its words name the reserve: those of [`STRAIN`] are of other stretches.
pub static RESERVE: Limits = Limits {
    quantity: "share of the skin's reserve",
    unit: "",
    bands: Cow::Borrowed(&[
        Band {
            limit: Some(0.8),
            word: "reserve left",
            level: 0,
            source: "Up to 80 % of the reserve, reserve left: a convention of this program.",
        },
        Band {
            limit: Some(1.0),
            word: "little reserve",
            level: 1,
            source: "80–100 % little reserve, above no reserve. The reserve is the stretch at which this skin gets twice as stiff as at \
                rest: from there each further millimetre costs more and more stress (curve of skin in vivo: Hendriks 2005, as in \
                Nikolaev 2013). The class of the skin sets the reserve within a factor of 2 (1 standard deviation).",
        },
        Band { limit: None, word: "no reserve", level: 2, source: "" },
    ]),
    note: STANDING,
};

/// Contact pressure \[mmHg\].
pub static PRESSURE: Limits = Limits {
    quantity: "contact pressure",
    unit: "mmHg",
    bands: Cow::Borrowed(&[
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[0]),
            word: "usual",
            level: 0,
            source: "Up to 60 mmHg usual: 30–60 mmHg were measured right after clinical filling of expanders.",
        },
        Band {
            limit: Some(PRESSURE_BANDS_MMHG[1]),
            word: "high",
            level: 1,
            source: "60–80 mmHg high, above very high: above 80 mmHg the blood flow of the skin was near zero in one study of pigs; in \
                another it fell only moderately to 100 mmHg (expanded skin; Ann Plast Surg 21, 1988).",
        },
        Band { limit: None, word: "very high", level: 2, source: "" },
    ]),
    note: "The pressure directly after filling; in the days after it falls.",
};

/// Least cover below which a plan has the practice's word \[mm\].
pub const THIN_COVER_MM: f64 = 5.0;

/// Cover at rest below which practice goes under the muscle \[mm\]: half of a pinch of 2 cm.
pub const PRACTICE_COVER_MM: f64 = 10.0;

/// What is known about a limit of the cover.
pub const COVER: &str = "Below 5 mm thin: a word of practice, no measured limit. With a pinch below 2 cm at the upper pole, a cover of 10 \
    mm at rest, surgeons go under the muscle (Tebbetts and Adams, Plast Reconstr Surg 116, 2005); 5 mm are half of that.";

/// All limits.
pub static LIMITS: [&Limits; 3] = [&STRAIN, &RESERVE, &PRESSURE];

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

    /// Are the limits those of [`PracticeStretch::limits`]?
    #[must_use]
    pub fn is_of_practice(&self) -> bool {
        self.quantity == OF_PRACTICE
    }

    /// Level and word of a value.
    #[must_use]
    pub fn verdict(&self, value: f64) -> (usize, &'static str) {
        let band = self.bands[self.band(value)];
        (band.level, band.word)
    }

    /// Word for a value.
    #[must_use]
    pub fn word(&self, value: f64) -> &'static str {
        self.bands[self.band(value)].word
    }
}

/// Greatest principal strains of the skin \[-\] that practice's volumes give in the same tissue: what the stretch of a plan is
/// compared with. The error of the model's rest state is in both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PracticeStretch {
    /// A step of the rule less than practice's volume.
    pub less: f64,
    /// Practice's volume.
    pub same: f64,
    /// A step of the rule more.
    pub more: f64,
}

impl PracticeStretch {
    /// The words against practice, from low to high.
    pub const WORDS: [&str; 3] = ["below practice", "as practice", "above practice"];

    /// The limits of the strain \[-\] against practice; the strains at which skin tears stay.
    #[must_use]
    pub fn limits(self) -> Limits {
        let [_, high, tears] = STRAIN_BANDS;
        let [below, same, above] = Self::WORDS;
        let band = |limit, word, level, source| Band { limit, word, level, source };
        let bands = vec![
            band(Some(self.less.min(high)), below, 0, PRACTICE_SOURCE),
            band(Some(self.more.min(high)), same, 0, ""),
            band(Some(high), above, 1, ""),
            band(Some(tears), "very high", 2, STRAIN.bands[2].source),
            band(None, "beyond", 3, ""),
        ];
        Limits { quantity: OF_PRACTICE, unit: "", bands: Cow::Owned(bands), note: STANDING }
    }

    /// Level and word of a strain \[-\].
    #[must_use]
    pub fn verdict(self, strain: f64) -> (usize, &'static str) {
        let [_, high, tears] = STRAIN_BANDS;
        let [below, same, above] = Self::WORDS;
        match strain {
            strain if strain > tears => (3, "beyond"),
            strain if strain > high => (2, "very high"),
            strain if strain > self.more => (1, above),
            strain if strain > self.less => (0, same),
            _ => (0, below),
        }
    }
}

/// The quantity of limits against practice.
const OF_PRACTICE: &str = "greatest principal strain against practice";

/// What the words against practice mean.
const PRACTICE_SOURCE: &str = "As practice: the stretch lies between those of practice's volume less and plus a step of the rule, 30 \
    ml, computed for a round implant of the same filling in the same tissue. Above 50 % very high, whatever practice takes.";

/// Level and word of the stretch of a skin: against `practice` where that is known, else those of [`stretch`].
#[must_use]
pub fn stretch_by(
    practice: Option<PracticeStretch>,
    strain: f64,
    reserve: Option<f64>,
) -> (usize, &'static str) {
    practice.map_or_else(|| stretch(strain, reserve), |practice| practice.verdict(strain))
}

/// Level and word of the stretch of a skin: those of its share of the reserve \[-\], or of its greatest principal strain \[-\]
/// if the skin has no reserve.
#[must_use]
pub fn stretch(strain: f64, reserve: Option<f64>) -> (usize, &'static str) {
    reserve.map_or_else(|| STRAIN.verdict(strain), |share| RESERVE.verdict(share))
}

/// What the strain of a skin is compared with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SkinLimits {
    /// The strains of practice's volumes in the same tissue.
    Practice(PracticeStretch),
    /// The strain at which the skin's curve turns steep \[-\]: its reserve.
    Reserve(f64),
    /// The strains at which skin tears.
    Tearing,
}

impl SkinLimits {
    /// The limits of a skin by itself. `knee`: strain at which its curve turns steep \[-\], if it has a reserve.
    #[must_use]
    pub fn of_skin(knee: Option<f64>) -> Self {
        knee.map_or(Self::Tearing, Self::Reserve)
    }

    /// The limits with their words, and the factor from a strain to their unit.
    #[must_use]
    pub fn limits(self) -> (Limits, f64) {
        match self {
            Self::Practice(practice) => (practice.limits(), 1.0),
            Self::Reserve(knee) => (RESERVE.clone(), 1.0 / knee),
            Self::Tearing => (STRAIN.clone(), 1.0),
        }
    }

    /// Level and word of a greatest principal strain \[-\].
    #[must_use]
    pub fn verdict(self, strain: f64) -> (usize, &'static str) {
        match self {
            Self::Practice(practice) => practice.verdict(strain),
            Self::Reserve(knee) => RESERVE.verdict(strain / knee),
            Self::Tearing => STRAIN.verdict(strain),
        }
    }
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
    fn a_word_of_the_reserve_is_no_word_of_another_stretch() {
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 }.limits();
        for band in RESERVE.bands.iter() {
            assert!(
                STRAIN.bands.iter().chain(practice.bands.iter()).all(|it| it.word != band.word)
            );
        }
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

    #[test]
    fn words_against_practice_are_those_of_its_limits() {
        let practice = PracticeStretch { less: 0.19, same: 0.21, more: 0.23 };
        let limits = practice.limits();
        for k in 0..700 {
            let strain = 1e-3 * f64::from(k);
            assert_eq!(limits.verdict(strain), practice.verdict(strain), "{strain}");
        }
        let words = [0.19, 0.191, 0.231, 0.51].map(|strain| practice.verdict(strain).1);
        assert_eq!(words, ["below practice", "as practice", "above practice", "very high"]);
        let of = |limits: SkinLimits| limits.verdict(0.26);
        assert_eq!(of(SkinLimits::Practice(practice)), (1, "above practice"));
        assert_eq!(of(SkinLimits::of_skin(None)), stretch(0.26, None));
        assert_eq!(of(SkinLimits::of_skin(Some(0.25))), stretch(0.26, Some(0.26 / 0.25)));
        // A very lax skin, whose practice is near the strain that tears.
        let lax = PracticeStretch { less: 0.44, same: 0.48, more: 0.52 };
        for strain in [0.4, 0.49, 0.505, 0.53, 0.6] {
            assert_eq!(lax.limits().verdict(strain), lax.verdict(strain), "{strain}");
        }
    }
}
