//! Samples of bands, equal to the last bit natively and in the browser.

/// The bits of [`samples`].
pub(crate) const SAMPLES: [u64; 9] = [
    4601414308860002304,
    4598709995586977792,
    4595124025386074112,
    13813588635842514932,
    13817141185615985922,
    4588477271753183282,
    4608205563090612005,
    4591108779733813737,
    4617004975961316928,
];

/// The bits of samples: points, normal and lognormal values in the middle and in both tails.
pub(crate) fn samples() -> [u64; 9] {
    use implant_preview::clinical::spread::Distribution;
    use implant_preview::study::{quantile, unit_sample};
    let normal = Distribution::Normal { mean: -0.035, sd: 0.03 };
    let lognormal = Distribution::LogNormal { median: 0.65, gsd: 1.9 };
    let point = |k: usize| unit_sample(k, k, 1);
    let values = [
        point(0),
        point(7),
        point(15),
        quantile(normal, point(1)),
        quantile(normal, 0.001),
        quantile(normal, 0.999),
        quantile(lognormal, point(2)),
        quantile(lognormal, 0.001),
        quantile(lognormal, 0.999),
    ];
    values.map(f64::to_bits)
}
