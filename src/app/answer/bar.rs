//! The bars of the cards without a toolkit: coloured parts, limits, mark of the value, line of the sampled patients.

use super::cards::{BarScale, Card, cover_marks};
use crate::view::color::{self, Rgb};

/// The bar of a card; places are fractions of its length \[-\].
pub(in crate::app) struct Bar {
    /// Ends of the parts from the left, with their colours.
    pub(in crate::app) parts: Vec<(f64, Rgb)>,
    /// Limits with their texts.
    pub(in crate::app) limits: Vec<(f64, String)>,
    /// The value.
    pub(in crate::app) value: Option<f64>,
    /// 10th and 90th percentile of the sampled patients.
    pub(in crate::app) range: Option<[f64; 2]>,
    /// Band of the word, counted from the lowest.
    pub(in crate::app) band: Option<usize>,
}

impl Bar {
    pub(super) fn of(card: &Card) -> Self {
        let (mut parts, mut limits) = (Vec::new(), Vec::new());
        let most = match card.scale {
            BarScale::Bands { most, .. } => most,
            BarScale::Part { whole } => whole.max(1e-9),
        };
        let at = |value: f64| (value / most).clamp(0.0, 1.0);
        match card.scale {
            BarScale::Bands { limits: of, in_percent, .. } => {
                for (k, band) in of.bands.iter().enumerate() {
                    parts.push((at(band.limit.unwrap_or(most)), color::band(k)));
                    let text = |limit: f64| match in_percent {
                        true => format!("{:.0} %", 100.0 * limit),
                        false => format!("{limit:.0}"),
                    };
                    limits.extend(band.limit.map(|limit| (at(limit), text(limit))));
                }
            }
            BarScale::Part { .. } => {
                parts.extend(card.value.map(|value| (at(value), color::COVER)));
                limits.extend(cover_marks(most).map(|(limit, text)| (at(limit), text)));
            }
        }
        Self {
            parts,
            limits,
            value: card.value.map(at),
            range: card.range.map(|range| range.map(at)),
            band: card.verdict.map(|(band, _)| band),
        }
    }
}
