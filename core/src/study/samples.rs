//! The values of the samples of bands: two scenes compared sample by sample.

use super::percentile;
use super::{Bands, Quantity, Unknown};
use std::collections::BTreeMap;

/// Fewest samples with an answer of a band: among fewer the 10th percentile is next to the lowest.
pub const LEAST_ANSWERS: usize = 10;

/// The values of all samples of a scene.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    seed: u32,
    unknowns: Vec<Unknown>,
    /// A value for each sample; `None` without an answer \[unit of the quantity\].
    values: BTreeMap<Quantity, Vec<Option<f64>>>,
}

impl Bands {
    /// The values of the samples solved so far.
    #[must_use]
    pub fn values(&self) -> Samples {
        let of = |quantity: Quantity| {
            let values: Vec<Option<f64>> = self.sample_values(quantity).collect();
            values.iter().any(Option::is_some).then_some((quantity, values))
        };
        Samples {
            seed: self.settings().seed,
            unknowns: self.unknowns().iter().map(|(unknown, _)| *unknown).collect(),
            values: Quantity::ALL.into_iter().filter_map(of).collect(),
        }
    }
}

impl Samples {
    /// The values of a quantity, those of answers only \[unit of the quantity\].
    pub fn of(&self, quantity: Quantity) -> impl Iterator<Item = f64> {
        self.values.get(&quantity).into_iter().flatten().copied().flatten()
    }

    /// 10th percentile, median and 90th percentile of a quantity; `None` from fewer than [`LEAST_ANSWERS`] samples.
    #[must_use]
    pub fn band(&self, quantity: Quantity) -> Option<[f64; 3]> {
        band(self.of(quantity).collect())
    }

    /// The same percentiles of this scene's value less the other's. Sample k of both scenes has every unknown at the same
    /// probability: the band is that of the difference for the same sampled patients, narrower than the difference of two
    /// bands. `None` if the samples are not those of the same unknowns and seed, or too few have both answers.
    #[must_use]
    pub fn difference(&self, other: &Self, quantity: Quantity) -> Option<[f64; 3]> {
        let pairs = self.values.get(&quantity)?.iter().zip(other.values_beside(self, quantity)?);
        band(pairs.filter_map(|(a, b)| Some((*a)? - (*b)?)).collect())
    }

    /// The values of a quantity of each sampled patient in this scene and in two others, those of patients with an answer in all three.
    /// Sample k of all scenes is one patient, as in [`Self::difference`]. `None` if the samples are not those of the same unknowns and
    /// seed.
    #[must_use]
    pub fn beside(&self, others: [&Self; 2], quantity: Quantity) -> Option<Vec<[f64; 3]>> {
        let [a, b] = others.map(|other| other.values_beside(self, quantity));
        let (own, a, b) = (self.values.get(&quantity)?, a?, b?);
        let all = own.iter().zip(a).zip(b).map(|((own, a), b)| Some([(*own)?, (*a)?, (*b)?]));
        Some(all.flatten().collect())
    }

    /// The values of a quantity, if the samples are those of the same unknowns and seed as another scene's.
    fn values_beside(&self, other: &Self, quantity: Quantity) -> Option<&[Option<f64>]> {
        let is_same = (self.seed, &self.unknowns) == (other.seed, &other.unknowns);
        self.values.get(&quantity).filter(|_| is_same).map(Vec::as_slice)
    }
}

fn band(values: Vec<f64>) -> Option<[f64; 3]> {
    if values.len() < LEAST_ANSWERS { None } else { percentile::band(values) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(values: Vec<Option<f64>>) -> Samples {
        let values = BTreeMap::from([(Quantity::ForceN, values)]);
        Samples { seed: 1, unknowns: vec![Unknown::PocketRadius], values }
    }

    #[test]
    fn the_band_of_a_difference_is_that_of_pairs() {
        let of = |shift: f64| samples((0..101).map(|k| Some(f64::from(k) + shift)).collect());
        let close = |band: Option<[f64; 3]>, known: [f64; 3]| {
            band.unwrap().iter().zip(known).all(|(a, b)| (a - b).abs() < 1e-9)
        };
        assert!(close(of(0.0).band(Quantity::ForceN), [10.0, 50.0, 90.0]));
        // A constant shift of wide bands is certain.
        assert!(close(of(3.0).difference(&of(0.0), Quantity::ForceN), [3.0; 3]));
        assert_eq!(of(0.0).band(Quantity::LeastCoverMm), None);
        let other_seed = Samples { seed: 2, ..of(0.0) };
        assert_eq!(of(0.0).difference(&other_seed, Quantity::ForceN), None);
    }

    #[test]
    fn pairs_without_both_answers_are_left_out() {
        let a = samples((0..12).map(|k| (k != 3).then_some(f64::from(k))).collect());
        let b = samples((0..12).map(|k| (k != 7).then_some(0.0)).collect());
        let [low, _, high] = a.difference(&b, Quantity::ForceN).unwrap();
        assert!((low - 0.9).abs() < 1e-9 && (high - 10.1).abs() < 1e-9, "{low} {high}");
        let few = samples(vec![Some(1.0); 9]);
        assert_eq!(few.band(Quantity::ForceN), None);
    }
    #[test]
    fn values_beside_those_of_other_scenes_are_of_the_same_patient() {
        let own = samples(vec![Some(1.0), Some(2.0), None, Some(4.0)]);
        let other = samples(vec![Some(10.0), None, Some(30.0), Some(40.0)]);
        let force = Quantity::ForceN;
        let expected = vec![[1.0, 10.0, 1.0], [4.0, 40.0, 4.0]];
        assert_eq!(own.beside([&other, &own], force), Some(expected));
        let foreign = Samples { seed: 2, ..other.clone() };
        assert_eq!(own.beside([&other, &foreign], force), None);
    }
}
