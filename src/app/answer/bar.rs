//! The bars of the cards without a toolkit: coloured parts, limits, mark of the value, line of the sampled patients.

use super::cards::{BarScale, Card, cover_marks};
use crate::view::color::{self, Rgb};

/// The bar of a card; places are fractions of its length \[-\].
pub(crate) struct Bar {
    /// Ends of the parts from the left, with their colours.
    pub(crate) parts: Vec<(f64, Rgb)>,
    /// Limits with their texts, the most important first.
    pub(crate) limits: Vec<(f64, String)>,
    /// Does a limit part two colours, or stand on one?
    pub(crate) has_bands: bool,
    /// Unit at the end of the bar; empty where the limits have theirs.
    pub(crate) unit: &'static str,
    /// The value.
    pub(crate) value: Option<f64>,
    /// 10th and 90th percentile of the sampled patients.
    pub(crate) range: Option<[f64; 2]>,
    /// Level of the word, 0 for a calm one.
    pub(crate) level: Option<usize>,
}

impl Bar {
    pub(super) fn of(card: &Card) -> Self {
        let (mut parts, mut limits) = (Vec::new(), Vec::new());
        let most = match card.scale {
            BarScale::Bands { most, .. } => most,
            BarScale::Part { whole } => whole.max(1e-9),
        };
        let at = |value: f64| (value / most).clamp(0.0, 1.0);
        let mut unit = "";
        match &card.scale {
            BarScale::Bands { limits: of, in_percent, mark, .. } => {
                limits.extend(mark.iter().map(|(value, text)| (at(*value), text.clone())));
                for band in &*of.bands {
                    parts.push((at(band.limit.unwrap_or(most)), color::band(band.level)));
                    let text = |limit: f64| match in_percent {
                        true => format!("{:.0} %", 100.0 * limit),
                        false => format!("{limit:.0}"),
                    };
                    // Beside a mark only the limits of a higher level than its own have a number.
                    let has_number = mark.is_none() || band.level > 0;
                    let limit = band.limit.filter(|_| has_number);
                    limits.extend(limit.map(|limit| (at(limit), text(limit))));
                }
                unit = of.unit;
            }
            BarScale::Part { .. } => {
                parts.extend(card.value.map(|value| (at(value), color::COVER)));
                limits.extend(cover_marks(most).map(|(limit, text)| (at(limit), text)));
            }
        }
        Self {
            parts,
            limits,
            has_bands: matches!(card.scale, BarScale::Bands { .. }),
            unit,
            value: card.value.map(at),
            range: card.range.map(|range| range.map(at)),
            level: card.verdict.map(|(level, _)| level),
        }
    }
}
