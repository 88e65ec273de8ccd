//! Tables: comma-separated values with a point as the decimal separator.

use crate::measure::Outcome;

/// Formats a number for a table: ten significant digits, no trailing zeros.
#[must_use]
pub fn number(value: f64) -> String {
    let digits = format!("{value:.9e}");
    digits
        .parse::<f64>()
        .map_or(digits, |rounded| if rounded == 0.0 { "0".to_owned() } else { rounded.to_string() })
}

/// The profile of a result as a table: arc length `s_mm`, distance from the axis `r_mm`, height `z_mm`, stretches \[-\].
#[must_use]
pub fn profile(outcome: &Outcome) -> String {
    let mut table = "s_mm,r_mm,z_mm,stretch_meridional,stretch_hoop\n".to_owned();
    for p in &outcome.profile {
        let row = [p.s_mm, p.r_mm, p.z_mm, p.stretch_meridional, p.stretch_hoop].map(number);
        table += &row.join(",");
        table.push('\n');
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_keep_ten_digits_and_drop_the_rest() {
        assert_eq!(number(0.1 + 0.2), "0.3");
        assert_eq!(number(-0.0), "0");
        assert_eq!(number(40.000_000_000_001), "40");
        assert_eq!(number(1.0 / 3.0), "0.3333333333");
    }
}
