//! A row of the verification table.
//!
//! Uses no other module. Used by `elements`, `solutions`, the command line.

use std::fmt::Write;

/// Bound of a figure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Greatest allowed value.
    AtMost(f64),
    /// Least allowed value.
    AtLeast(f64),
}

/// A check with its figure; figures are relative, without unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Check {
    /// What must hold.
    pub property: String,
    /// Where it is checked.
    pub place: String,
    /// The figure \[-\]; NaN if there is none.
    pub figure: f64,
    /// The bound of the figure.
    pub bound: Bound,
}

impl Check {
    /// A figure that must be small.
    pub(super) fn at_most(property: &str, place: &str, figure: f64, most: f64) -> Self {
        let (property, place) = (property.to_owned(), place.to_owned());
        Self { property, place, figure, bound: Bound::AtMost(most) }
    }

    /// Does the figure keep its bound? NaN does not.
    #[must_use]
    pub fn is_passed(&self) -> bool {
        match self.bound {
            Bound::AtMost(most) => self.figure <= most,
            Bound::AtLeast(least) => self.figure >= least,
        }
    }

    fn bound_text(&self) -> String {
        match self.bound {
            Bound::AtMost(most) => format!("≤ {}", short(most)),
            Bound::AtLeast(least) => format!("≥ {}", short(least)),
        }
    }
}

fn short(value: f64) -> String {
    if (1e-4..10.0).contains(&value.abs()) {
        format!("{value:.5}").trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        format!("{value:.1e}")
    }
}

fn word(check: &Check) -> &'static str {
    if check.is_passed() { "pass" } else { "fail" }
}

/// Writes the checks as CSV with a line of column names.
#[must_use]
pub fn csv(checks: &[Check]) -> String {
    let mut csv = String::from("property,place,figure,bound,result\n");
    for check in checks {
        let Check { property, place, figure, .. } = check;
        // Writing to a String cannot fail.
        let _ =
            writeln!(csv, "{property},{place},{figure:.4e},{},{}", check.bound_text(), word(check));
    }
    csv
}

/// Writes the checks as a table in Markdown.
#[must_use]
pub fn markdown(checks: &[Check]) -> String {
    let mut text = String::from(
        "| property | place | figure | bound | result |\n| --- | --- | --- | --- | --- |\n",
    );
    for check in checks {
        let Check { property, place, figure, .. } = check;
        let _ = writeln!(
            text,
            "| {property} | {place} | {} | {} | {} |",
            short(*figure),
            check.bound_text(),
            word(check)
        );
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_figure_beyond_its_bound_and_a_missing_one_fail() {
        let check = |figure| Check::at_most("p", "q", figure, 1e-3);
        assert!(
            check(1e-3).is_passed() && !check(2e-3).is_passed() && !check(f64::NAN).is_passed()
        );
        let order = Check { bound: Bound::AtLeast(1.8), ..check(2.1) };
        assert!(order.is_passed() && !Check { figure: 1.0, ..order }.is_passed());
        assert!(markdown(&[check(2e-3)]).contains("| 0.002 | ≤ 0.001 | fail |"));
    }
}
