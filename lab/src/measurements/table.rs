//! A comparison of measured values with predictions: rows, tables and plot.
//!
//! Uses no other module. Used by `treloar`, `fat`, `skin_pull`, `expander`, the charts and the command line.

use serde::Serialize;
use serde_json::json;
use std::fmt::Write;

/// A measured value beside a prediction; both have the unit of the [`Comparison`].
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Row {
    /// The measured quantity.
    pub quantity: String,
    /// Law and material of the prediction.
    pub model: String,
    /// Value of the comparison's argument.
    pub at: Option<f64>,
    /// Measured value.
    pub measured: Option<f64>,
    /// Least and greatest measured value, or the mean with one standard deviation to either side.
    pub range: Option<[f64; 2]>,
    /// Predicted value; `None` without an equilibrium.
    pub predicted: Option<f64>,
}

impl Row {
    /// Predicted − measured value; without a measured value the distance of the prediction from the measured range.
    #[must_use]
    pub fn difference(&self) -> Option<f64> {
        let predicted = self.predicted?;
        match (self.measured, self.range) {
            (Some(measured), _) => Some(predicted - measured),
            (None, Some([least, most])) => Some(predicted - predicted.clamp(least, most)),
            (None, None) => None,
        }
    }

    /// [`Self::difference`] over the measured value \[-\].
    #[must_use]
    pub fn relative_difference(&self) -> Option<f64> {
        let measured = self.measured.filter(|measured| measured.abs() > 0.0)?;
        Some(self.difference()? / measured.abs())
    }

    /// Is the prediction within the measured range?
    #[must_use]
    pub fn is_within(&self) -> Option<bool> {
        let ([least, most], predicted) = (self.range?, self.predicted?);
        Some((least..=most).contains(&predicted))
    }
}

/// How a series is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Markers at measured values.
    Points,
    /// A polyline of predicted values.
    Line,
    /// A filled polygon: a measured range.
    Band,
}

/// A series of points (x, y).
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Text of the legend.
    pub label: String,
    /// How the series is drawn.
    pub mark: Mark,
    /// Points, of a band the corners of its polygon.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A band between two values over a range of x.
    #[must_use]
    pub fn band(label: &str, [left, right]: [f64; 2], [low, high]: [f64; 2]) -> Self {
        let points = vec![(left, low), (right, low), (right, high), (left, high)];
        Self { label: label.to_owned(), mark: Mark::Band, points }
    }
}

/// An axis of a plot.
#[derive(Clone, Debug, PartialEq)]
pub struct PlotAxis {
    /// Quantity with its unit.
    pub name: &'static str,
    /// Least and greatest value.
    pub range: [f64; 2],
    /// Decimals of the labels.
    pub decimals: usize,
    /// Greatest number of labels.
    pub labels: usize,
}

/// A measurement with its predictions.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Name in file names.
    pub name: &'static str,
    /// Title of table and chart.
    pub title: &'static str,
    /// Authors, journal and year of the measurement.
    pub source: &'static str,
    /// Unit of the measured and predicted values; empty without one.
    pub unit: &'static str,
    /// Name of the argument with its unit.
    pub argument: &'static str,
    /// Measured and predicted values.
    pub rows: Vec<Row>,
    /// What a reader of the table must know: assumptions and what the model lacks.
    pub remarks: Vec<String>,
    /// Axes of the chart, x and y.
    pub axes: [PlotAxis; 2],
    /// Series of the chart, bands first.
    pub series: Vec<Series>,
}

/// A number with four significant digits.
fn digits(value: Option<f64>) -> String {
    let Some(value) = value.filter(|value| value.is_finite()) else { return String::new() };
    if value.abs() < 1e-12 {
        return "0".to_owned();
    }
    let decimals = (3 - value.abs().log10().floor() as i32).clamp(0, 6) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

fn word(is_within: Option<bool>) -> &'static str {
    match is_within {
        Some(true) => "yes",
        Some(false) => "no",
        None => "",
    }
}

impl Comparison {
    /// The rows as CSV with a line of column names.
    #[must_use]
    pub fn csv(&self) -> String {
        let mut csv = String::from(
            "quantity,model,at,measured,measured_least,measured_greatest,predicted,difference,\
             relative_difference,within_range\n",
        );
        for row in &self.rows {
            let [least, most] = [0, 1].map(|k| row.range.map(|range| range[k]));
            let numbers = [
                row.at,
                row.measured,
                least,
                most,
                row.predicted,
                row.difference(),
                row.relative_difference(),
            ];
            // Writing to a String cannot fail.
            let _ = writeln!(
                csv,
                "{},{},{},{}",
                row.quantity,
                row.model,
                numbers.map(digits).join(","),
                word(row.is_within())
            );
        }
        csv
    }

    /// The rows as a table in Markdown, below the title, above the remarks.
    #[must_use]
    pub fn markdown(&self) -> String {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let mut text = format!(
            "## {}\n\n{}\n\n| quantity | model | {} | measured{unit} | range | predicted | difference | relative | \
             within the range |\n| --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
            self.title, self.source, self.argument
        );
        for row in &self.rows {
            let range = row.range.map_or_else(String::new, |[least, most]| {
                format!("{}–{}", digits(Some(least)), digits(Some(most)))
            });
            let predicted =
                if row.predicted.is_some() { digits(row.predicted) } else { "none".to_owned() };
            let relative = row
                .relative_difference()
                .map_or_else(String::new, |share| format!("{:+.0} %", 100.0 * share));
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {range} | {predicted} | {} | {relative} | {} |",
                row.quantity,
                row.model,
                digits(row.at),
                digits(row.measured),
                digits(row.difference()),
                word(row.is_within())
            );
        }
        text.push('\n');
        for remark in &self.remarks {
            let _ = writeln!(text, "* {remark}");
        }
        text
    }
}

/// All comparisons as JSON text.
#[must_use]
pub fn json(comparisons: &[Comparison]) -> String {
    let row = |row: &Row| {
        json!({
            "quantity": row.quantity, "model": row.model, "at": row.at, "measured": row.measured,
            "measured_range": row.range, "predicted": row.predicted, "difference": row.difference(),
            "relative_difference": row.relative_difference(), "within_range": row.is_within(),
        })
    };
    let one = |c: &Comparison| {
        json!({
            "name": c.name, "title": c.title, "source": c.source, "unit": c.unit, "argument": c.argument,
            "rows": c.rows.iter().map(row).collect::<Vec<_>>(), "remarks": c.remarks,
        })
    };
    let all: Vec<_> = comparisons.iter().map(one).collect();
    serde_json::to_string_pretty(&all).unwrap_or_default() + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(measured: Option<f64>, range: Option<[f64; 2]>, predicted: Option<f64>) -> Row {
        Row {
            quantity: "q".to_owned(),
            model: "m".to_owned(),
            at: None,
            measured,
            range,
            predicted,
        }
    }

    #[test]
    fn differences_are_those_from_the_value_or_else_from_the_range() {
        let with = row(Some(2.0), Some([1.0, 3.0]), Some(3.5));
        assert_eq!((with.difference(), with.relative_difference()), (Some(1.5), Some(0.75)));
        assert_eq!(with.is_within(), Some(false));
        let ranged = |predicted| row(None, Some([30.0, 60.0]), Some(predicted)).difference();
        assert_eq!([12.0, 45.0, 70.0].map(ranged), [Some(-18.0), Some(0.0), Some(10.0)]);
        assert_eq!(row(Some(1.0), None, None).difference(), None);
        assert_eq!(digits(Some(0.012_345)), "0.01235");
        assert_eq!(digits(Some(120.0)), "120");
    }
}
