//! Seeded samples of a low-discrepancy sequence, equal to the last bit on every platform.
//!
//! The points are those of an Owen-scrambled Sobol sequence (Burley, J. Comput. Graph. Tech. 9(4), 2020), integers until
//! the last step. The quantile of the normal distribution needs a logarithm in its tails and lognormal values an
//! exponential: both are those of the crate `libm`, because the functions of a platform differ in the last bit.

use crate::clinical::spread::Distribution;

/// Greatest number of points.
pub const MAX_SAMPLES: usize = 1 << 16;
/// Half of the distance between two coordinates: a sample is the middle of its interval.
const HALF_STEP: f64 = 1.0 / (1_u64 << 24) as f64;

/// A coordinate of a point of the unit cube, 0 and 1 excluded. `index` is below [`MAX_SAMPLES`], `dimension` below 256.
#[must_use]
pub fn unit_sample(index: usize, dimension: usize, seed: u32) -> f64 {
    let point = (index % MAX_SAMPLES) as u32;
    let sample = sobol_burley::sample(point, (dimension % 256) as u32, seed);
    f64::from(sample) + HALF_STEP
}

/// Quantile of the standard normal distribution, relative error 1e-15, for probabilities from 1e-11 to 1 − 1e-11: Wichura's
/// PPND16 (Applied Statistics 37, 1988, algorithm AS 241) without its branch for extreme tails.
#[must_use]
pub fn normal_quantile(probability: f64) -> f64 {
    const A: [f64; 8] = [
        3.387_132_872_796_366_6,
        1.331_416_678_917_843_8e2,
        1.971_590_950_306_551_3e3,
        1.373_169_376_550_946e4,
        4.592_195_393_154_987e4,
        6.726_577_092_700_87e4,
        3.343_057_558_358_813e4,
        2.509_080_928_730_122_7e3,
    ];
    const B: [f64; 8] = [
        1.0,
        4.231_333_070_160_091e1,
        6.871_870_074_920_579e2,
        5.394_196_021_424_751e3,
        2.121_379_430_158_659_7e4,
        3.930_789_580_009_271e4,
        2.872_908_573_572_194_3e4,
        5.226_495_278_852_854e3,
    ];
    const C: [f64; 8] = [
        1.423_437_110_749_683_5,
        4.630_337_846_156_546,
        5.769_497_221_460_691,
        3.647_848_324_763_204_5,
        1.270_458_252_452_368_4,
        2.417_807_251_774_506e-1,
        2.272_384_498_926_918_4e-2,
        7.745_450_142_783_414e-4,
    ];
    const D: [f64; 8] = [
        1.0,
        2.053_191_626_637_759,
        1.676_384_830_183_803_8,
        6.897_673_349_851e-1,
        1.481_039_764_274_800_8e-1,
        1.519_866_656_361_645_7e-2,
        5.475_938_084_995_345e-4,
        1.050_750_071_644_416_9e-9,
    ];
    let polynomial = |c: &[f64; 8], x: f64| c.iter().rev().fold(0.0, |sum, c| sum * x + c);
    let centred = probability - 0.5;
    if centred.abs() <= 0.425 {
        let x = 0.180_625 - centred * centred;
        return centred * polynomial(&A, x) / polynomial(&B, x);
    }
    let tail = probability.min(1.0 - probability).max(1e-11);
    let x = (-libm::log(tail)).sqrt() - 1.6;
    let value = polynomial(&C, x) / polynomial(&D, x);
    if centred < 0.0 { -value } else { value }
}

/// Quantile of a distribution.
#[must_use]
pub fn quantile(distribution: Distribution, probability: f64) -> f64 {
    match distribution {
        Distribution::LogNormal { median, gsd } => {
            median * libm::exp(libm::log(gsd) * normal_quantile(probability))
        }
        Distribution::Normal { mean, sd } => mean + sd * normal_quantile(probability),
        Distribution::Uniform { least, most } => least + (most - least) * probability,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantiles_of_the_normal_distribution_are_those_of_tables() {
        for (probability, wanted) in [
            (0.5, 0.0),
            (0.9, 1.281_551_565_544_600_4),
            (0.975, 1.959_963_984_540_054),
            (0.999, 3.090_232_306_167_813_5),
            (0.001, -3.090_232_306_167_813_5),
            (1e-6, -4.753_424_308_822_899),
        ] {
            let found = normal_quantile(probability);
            assert!((found - wanted).abs() < 1e-12, "{probability}: {found}");
        }
        let widest = normal_quantile(HALF_STEP);
        assert!((-5.5..-5.2).contains(&widest), "{widest}");
    }

    #[test]
    fn points_are_stratified_and_seeds_differ() {
        for (dimension, seed) in [(0, 1), (7, 1), (15, 99)] {
            // Any 2^m first points have one point in each of 2^m equal intervals.
            let mut strata: Vec<usize> =
                (0..256).map(|k| (unit_sample(k, dimension, seed) * 256.0) as usize).collect();
            strata.sort_unstable();
            assert_eq!(strata, (0..256).collect::<Vec<_>>());
        }
        let points = |seed| (0..8).map(|k| unit_sample(k, 0, seed)).collect::<Vec<_>>();
        assert_ne!(points(1), points(2));
        assert_eq!(points(3), points(3));
    }
}
