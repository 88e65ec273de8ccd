//! The polynomials of the quantities of bands, one quantity after the other.

use super::expansion::{Basis, Expansion};
use super::importance::MIN_ROWS;
use super::quantity::Quantity;
use crate::clinical::spread::Distribution;

/// The polynomials so far.
#[derive(Debug, Default)]
pub(super) struct Fits {
    /// By [`Quantity::ALL`]; none for a quantity without variance or with fewer than 16 values.
    found: Vec<Option<Expansion>>,
    /// The candidates at the samples of the last quantity.
    basis: Option<(Vec<usize>, Basis)>,
}

impl Fits {
    /// Are all quantities fitted?
    pub(super) fn is_complete(&self) -> bool {
        self.found.len() == Quantity::COUNT
    }

    /// The polynomial of a quantity.
    pub(super) fn of(&self, quantity: Quantity) -> Option<&Expansion> {
        self.found.get(quantity as usize)?.as_ref()
    }

    /// The next quantity.
    pub(super) fn next(&self) -> Option<Quantity> {
        Quantity::ALL.get(self.found.len()).copied()
    }

    /// Fits the next quantity to its values by sample; the unknowns of a sample are at the probabilities of its point.
    pub(super) fn fit(
        &mut self,
        values: &[Option<f64>],
        distributions: &[Distribution],
        point: impl Fn(usize) -> Vec<f64>,
    ) {
        let samples: Vec<usize> = (0..values.len()).filter(|k| values[*k].is_some()).collect();
        let values: Vec<f64> = values.iter().flatten().copied().collect();
        let expansion = if samples.len() < MIN_ROWS {
            None
        } else {
            let (_, basis) = match self.basis.take() {
                Some((of, basis)) if of == samples => self.basis.insert((of, basis)),
                _ => {
                    let points: Vec<Vec<f64>> = samples.iter().map(|k| point(*k)).collect();
                    self.basis.insert((samples, Basis::new(distributions, &points)))
                }
            };
            basis.fit(&values)
        };
        self.found.push(expansion);
        if self.is_complete() {
            self.basis = None;
        }
    }
}
