//! Words for strain and pressure, with their limits.

use super::STRAIN_BANDS;

/// Contact pressures above which the word changes \[mmHg\]: 30–60 mmHg were measured right after clinical
/// filling of expanders; above 80 mmHg one pig study found blood flow near zero.
pub const PRESSURE_BANDS_MMHG: [f64; 2] = [60.0, 80.0];

/// Words from low to high; strain uses four, pressure three.
const WORDS: [&str; 4] = ["usual", "high", "very high", "beyond what excised skin withstood"];

/// Band of a value, 0 for the lowest.
fn band<const N: usize>(value: f64, limits: [f64; N]) -> usize {
    limits.iter().filter(|limit| value > **limit).count()
}

/// Band of a greatest principal strain \[-\], 0 to 3.
#[must_use]
pub fn strain_band(strain: f64) -> usize {
    band(strain, STRAIN_BANDS)
}

/// Band of a contact pressure \[mmHg\], 0 to 2.
#[must_use]
pub fn pressure_band(mmhg: f64) -> usize {
    band(mmhg, PRESSURE_BANDS_MMHG)
}

/// Word for a greatest principal strain \[-\].
#[must_use]
pub fn strain_word(strain: f64) -> &'static str {
    WORDS[strain_band(strain)]
}

/// Word for a contact pressure \[mmHg\].
#[must_use]
pub fn pressure_word(mmhg: f64) -> &'static str {
    WORDS[pressure_band(mmhg)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_change_at_their_limits() {
        let strains = [0.25, 0.26, 0.5, 0.51, 0.54, 0.55].map(strain_word);
        assert_eq!(strains[..2], ["usual", "high"]);
        assert_eq!(strains[2..4], ["high", "very high"]);
        assert_eq!(strains[4..], ["very high", "beyond what excised skin withstood"]);
        assert_eq!([60.0, 60.1, 80.1].map(pressure_word), ["usual", "high", "very high"]);
    }
}
