//! A quantity as a polynomial of the unknowns, fitted to samples: Sobol indices without further scenes.
//!
//! The terms are products of polynomials that are orthonormal for the distribution of each unknown: Hermite's of the normal variable
//! behind a normal or lognormal unknown, Legendre's of a uniform one. The square of a coefficient is the variance of its term, and
//! Sobol indices are sums of squares (Sudret, Reliab. Eng. Syst. Saf. 93, 2008, 964–979). The fit is sparse, as in Blatman and Sudret
//! (J. Comput. Phys. 230, 2011, 2345–2367): terms are picked one by one by orthogonal least squares (Chen, Billings and Luo, Int. J.
//! Control 50, 1989, 1873–1896). Candidates and number of terms are those of the least error of cross-validation: in turn an eighth of the
//! samples is predicted by a polynomial that is picked and fitted without them. The leave-one-out error of terms picked with all samples is
//! up to 20 times smaller than the error of new samples.

use super::importance::Index;
use super::sequence::normal_quantile;
use crate::clinical::spread::Distribution;
use std::ops::Range;

/// Sets of candidates: greatest degree of a term of one unknown, and of a term of two unknowns, the sum of both degrees.
const CANDIDATES: [(usize, usize); 3] = [(2, 0), (4, 2), (5, 4)];
const MOST_DEGREE: usize = 5;
/// Greatest number of terms.
const MOST_TERMS: usize = 64;
/// Parts into which the samples are divided.
const PARTS: usize = 8;
/// Least square of a candidate's part that is orthogonal to the picked terms \[square of the candidate\].
const INDEPENDENT: f64 = 1e-6;
/// Least square that a further term explains \[square of the values\].
const ROUNDING: f64 = 1e-20;
/// Polynomials that are orthonormal for a distribution.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Family {
    Hermite,
    Legendre,
    /// Of a distribution without spread: the constant.
    Constant,
}

impl Family {
    fn of(distribution: Distribution) -> Self {
        match distribution {
            Distribution::LogNormal { gsd, .. } if gsd > 1.0 => Self::Hermite,
            Distribution::Normal { sd, .. } if sd > 0.0 => Self::Hermite,
            Distribution::Uniform { least, most } if least < most => Self::Legendre,
            _ => Self::Constant,
        }
    }

    /// The polynomials by degree at a probability of the distribution.
    fn values(self, probability: f64) -> [f64; MOST_DEGREE + 1] {
        let mut values = [1.0; MOST_DEGREE + 1];
        let x = match self {
            Self::Hermite => normal_quantile(probability),
            Self::Legendre => 2.0 * probability - 1.0,
            Self::Constant => return values,
        };
        let mut before = 0.0;
        for degree in 0..MOST_DEGREE {
            let (n, last) = (degree as f64, values[degree]);
            values[degree + 1] = match self {
                Self::Hermite => (x * last - n.sqrt() * before) / (n + 1.0).sqrt(),
                _ => {
                    let back = n * before / (2.0 * n - 1.0).abs().sqrt();
                    (x * (2.0 * n + 1.0).sqrt() * last - back) * (2.0 * n + 3.0).sqrt() / (n + 1.0)
                }
            };
            before = last;
        }
        values
    }
}

/// The polynomials of one unknown each, by unknown and degree, at a point.
type Point = Vec<[f64; MOST_DEGREE + 1]>;

/// A product of polynomials: unknowns and degrees above 0. The constant has none.
type Term = Vec<(usize, usize)>;

fn value(term: &Term, point: &Point) -> f64 {
    term.iter().map(|(unknown, degree)| point[*unknown][*degree]).product()
}

/// The candidates at the points of the samples.
#[derive(Debug)]
pub(super) struct Basis {
    unknowns: usize,
    /// The constant, then the candidates of each set without those of the sets before.
    terms: Vec<Term>,
    /// Number of terms of each set.
    sizes: [usize; CANDIDATES.len()],
    /// Values of each term by sample.
    columns: Vec<Vec<f64>>,
    /// All samples, and for each part all others.
    fitted: Vec<Fitted>,
}

/// The samples that a polynomial is fitted to.
#[derive(Debug)]
struct Fitted {
    /// The others.
    left_out: Range<usize>,
    /// Products of the columns.
    products: Vec<Vec<f64>>,
}

/// Terms picked one by one.
struct Picked {
    terms: Vec<usize>,
    /// For each picked term the products of its part that is orthogonal to those before, of unit length, with all candidates, and with
    /// the values.
    rows: Vec<Vec<f64>>,
    slopes: Vec<f64>,
}

/// Terms and coefficients.
type Polynomial = Vec<(usize, f64)>;

/// What cross-validation has chosen.
struct Choice {
    error: f64,
    terms: usize,
    /// Of all samples, and without each part.
    picked: Vec<Picked>,
}

/// A quantity as a polynomial.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Expansion {
    /// Mean square that polynomials of the other samples miss \[variance of the samples\].
    pub(super) error: f64,
    /// Indices by unknown; the standard errors are those of the jackknife: each part of the samples left out in turn.
    pub(super) indices: Vec<Index>,
}

impl Basis {
    /// The candidates for unknowns of these distributions at points, which are probabilities by unknown.
    pub(super) fn new(distributions: &[Distribution], points: &[Vec<f64>]) -> Self {
        let families: Vec<Family> = distributions.iter().map(|of| Family::of(*of)).collect();
        let mut terms = vec![Term::new()];
        let sizes = CANDIDATES.map(|(alone, together)| {
            let further = candidates(&families, alone, together).into_iter();
            let further: Vec<Term> = further.filter(|term| !terms.contains(term)).collect();
            terms.extend(further);
            terms.len()
        });
        let points: Vec<Point> = points.iter().map(|point| polynomials(&families, point)).collect();
        let column = |term: &Term| points.iter().map(|point| value(term, point)).collect();
        let columns: Vec<Vec<f64>> = terms.iter().map(column).collect();
        let mut all = vec![vec![0.0; terms.len()]; terms.len()];
        let mut fitted: Vec<Fitted> = (0..PARTS)
            .map(|part| {
                let left_out = part * points.len() / PARTS..(part + 1) * points.len() / PARTS;
                let products = products(&columns, &left_out);
                add(&mut all, &products, 1.0);
                Fitted { left_out, products }
            })
            .collect();
        for Fitted { products, .. } in &mut fitted {
            let left_out = std::mem::replace(products, all.clone());
            add(products, &left_out, -1.0);
        }
        fitted.insert(0, Fitted { left_out: 0..0, products: all });
        Self { unknowns: families.len(), terms, sizes, columns, fitted }
    }

    /// The polynomial of the values of the samples; `None` without variance.
    pub(super) fn fit(&self, values: &[f64]) -> Option<Expansion> {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        let square = values.iter().map(|value| (value - mean).powi(2)).sum::<f64>();
        let variance = square / values.len() as f64;
        if variance <= (1e-12 * mean).powi(2) || !variance.is_finite() {
            return None;
        }
        let choice = self.choose(values)?;
        Some(Expansion { error: choice.error / square, indices: self.indices(&choice)? })
    }

    /// The set of candidates and the number of terms with the least error, the sum of squares that the samples left out are missed by.
    fn choose(&self, values: &[f64]) -> Option<Choice> {
        let of_set = |size: &usize| {
            let picked = |of| self.pick(of, *size, values);
            let picked: Vec<Picked> = self.fitted.iter().map(picked).collect();
            let most = picked.iter().map(|picked| picked.terms.len()).min()?;
            let mut errors = vec![0.0; most];
            for (of, picked) in self.fitted.iter().zip(&picked).skip(1) {
                for sample in of.left_out.clone() {
                    for (error, found) in errors.iter_mut().zip(self.predicted(picked, sample)) {
                        *error += (found - values[sample]).powi(2);
                    }
                }
            }
            let terms = (1..=most).min_by(|a, b| errors[a - 1].total_cmp(&errors[b - 1]))?;
            Some(Choice { error: errors[terms - 1], terms, picked })
        };
        let choices = self.sizes.iter().filter_map(of_set).filter(|of| of.error.is_finite());
        choices.reduce(|a, b| if b.error < a.error { b } else { a })
    }

    /// Picks terms among the first ones: after the constant each time the one that leaves least of the values.
    fn pick(&self, of: &Fitted, size: usize, values: &[f64]) -> Picked {
        let count = values.len() - of.left_out.len();
        let mut left: Vec<f64> = (0..size).map(|term| of.products[term][term]).collect();
        let with = |column: &Vec<f64>| {
            let of_left_out = of.left_out.clone().map(|k| column[k] * values[k]).sum::<f64>();
            product(column, values) - of_left_out
        };
        let mut slopes: Vec<f64> = self.columns[..size].iter().map(with).collect();
        let square = product(values, values);
        let mut picked = Picked { terms: Vec::new(), rows: Vec::new(), slopes: Vec::new() };
        let mut next = Some((f64::INFINITY, 0));
        while let Some((gain, term)) = next
            && gain > ROUNDING * square
            && picked.terms.len() < MOST_TERMS.min(count / 2)
        {
            let mut row = of.products[term][..size].to_vec();
            for earlier in &picked.rows {
                let factor = earlier[term];
                row.iter_mut().zip(earlier).for_each(|(value, earlier)| *value -= factor * earlier);
            }
            let length = left[term].sqrt();
            let slope = slopes[term] / length;
            for ((value, left), own) in row.iter_mut().zip(&mut left).zip(&mut slopes) {
                *value /= length;
                *left -= *value * *value;
                *own -= slope * *value;
            }
            picked.terms.push(term);
            picked.rows.push(row);
            picked.slopes.push(slope);
            let is_free = |term: &usize| {
                left[*term] > INDEPENDENT * of.products[*term][*term]
                    && !picked.terms.contains(term)
            };
            let gains = (0..size).filter(is_free).map(|k| (slopes[k] * slopes[k] / left[k], k));
            next = gains.reduce(|a, b| if b.0 > a.0 { b } else { a });
        }
        picked
    }

    /// The values of a sample by the polynomials of the first term, of the first two, and so on.
    fn predicted(&self, picked: &Picked, sample: usize) -> Vec<f64> {
        let (mut sum, mut parts, mut found) = (0.0, Vec::new(), Vec::new());
        for (k, term) in picked.terms.iter().enumerate() {
            let earlier = parts.iter().zip(&picked.rows);
            let along: f64 = earlier.map(|(part, row): (&f64, _)| part * row[*term]).sum();
            let part = (self.columns[*term][sample] - along) / picked.rows[k][*term];
            sum += part * picked.slopes[k];
            parts.push(part);
            found.push(sum);
        }
        found
    }

    /// Indices by unknown; `None` without variance.
    fn indices(&self, choice: &Choice) -> Option<Vec<Index>> {
        let indices = |picked: &Picked| self.sums(&picked.polynomial(choice.terms));
        let found = indices(&choice.picked[0])?;
        let others: Vec<_> = choice.picked[1..].iter().filter_map(indices).collect();
        let count = others.len() as f64;
        let index = |(k, [first_order, total]): (usize, [f64; 2])| {
            let standard_error = [0, 1].map(|which| {
                let mean = others.iter().map(|of| of[k][which]).sum::<f64>() / count;
                let squares = others.iter().map(|of| (of[k][which] - mean).powi(2)).sum::<f64>();
                (squares * (count - 1.0) / count).sqrt()
            });
            Index { first_order, total, standard_error }
        };
        Some(found.into_iter().enumerate().map(index).collect())
    }

    /// First-order and total indices: sums of squared coefficients.
    fn sums(&self, polynomial: &Polynomial) -> Option<Vec<[f64; 2]>> {
        let mut sums = vec![[0.0; 2]; self.unknowns];
        let mut variance = 0.0;
        for (term, coefficient) in polynomial {
            let (term, part) = (&self.terms[*term], coefficient * coefficient);
            variance += if term.is_empty() { 0.0 } else { part };
            for (unknown, _) in term {
                sums[*unknown][0] += if term.len() == 1 { part } else { 0.0 };
                sums[*unknown][1] += part;
            }
        }
        let of = |sum: [f64; 2]| sum.map(|part| part / variance);
        (variance > 0.0).then(|| sums.into_iter().map(of).collect())
    }
}

impl Picked {
    /// The polynomial of the first terms.
    fn polynomial(&self, terms: usize) -> Polynomial {
        let terms = terms.min(self.terms.len());
        let mut coefficients = self.slopes[..terms].to_vec();
        for k in (0..terms).rev() {
            let term = self.terms[k];
            coefficients[k] /= self.rows[k][term];
            let found = coefficients[k];
            let earlier = coefficients[..k].iter_mut().zip(&self.rows);
            earlier.for_each(|(coefficient, row)| *coefficient -= found * row[term]);
        }
        self.terms.iter().copied().zip(coefficients).collect()
    }
}

/// The terms up to a degree of one unknown and up to a sum of degrees of two.
fn candidates(families: &[Family], alone: usize, together: usize) -> Vec<Term> {
    let varied = |k: &usize| families[*k] != Family::Constant;
    let unknowns: Vec<usize> = (0..families.len()).filter(varied).collect();
    let mut found = Vec::new();
    for (place, a) in unknowns.iter().enumerate() {
        found.extend((1..=alone).map(|degree| vec![(*a, degree)]));
        for b in &unknowns[place + 1..] {
            let pairs = (1..together).flat_map(|m| (1..=together - m).map(move |n| (m, n)));
            found.extend(pairs.map(|(m, n)| vec![(*a, m), (*b, n)]));
        }
    }
    found
}

fn polynomials(families: &[Family], probabilities: &[f64]) -> Point {
    families.iter().zip(probabilities).map(|(family, at)| family.values(*at)).collect()
}

/// Products of columns over a range of samples.
fn products(columns: &[Vec<f64>], range: &Range<usize>) -> Vec<Vec<f64>> {
    let mut found = vec![vec![0.0; columns.len()]; columns.len()];
    for (i, a) in columns.iter().enumerate() {
        for (j, b) in columns[..=i].iter().enumerate() {
            let product = product(&a[range.clone()], &b[range.clone()]);
            (found[i][j], found[j][i]) = (product, product);
        }
    }
    found
}

/// `sums += factor values`
fn add(sums: &mut [Vec<f64>], values: &[Vec<f64>], factor: f64) {
    for (sums, values) in sums.iter_mut().zip(values) {
        sums.iter_mut().zip(values).for_each(|(sum, value)| *sum += factor * value);
    }
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::unit_sample;
    use std::f64::consts::{FRAC_PI_2, PI};

    const UNIFORM: Distribution = Distribution::Uniform { least: -1.0, most: 1.0 };
    const NORMAL: Distribution = Distribution::Normal { mean: 0.0, sd: 1.0 };

    /// The expansion of a function of the unit cube.
    fn fit(of: &[Distribution], samples: usize, f: impl Fn(&[f64]) -> f64) -> Option<Expansion> {
        let point = |k| (0..of.len()).map(|d| unit_sample(k, d, 5)).collect();
        let points: Vec<Vec<f64>> = (0..samples).map(point).collect();
        let values: Vec<f64> = points.iter().map(|point| f(point)).collect();
        Basis::new(of, &points).fit(&values)
    }

    fn compare(found: &Expansion, wanted: &[[f64; 2]]) {
        for (index, wanted) in found.indices.iter().zip(wanted) {
            for (k, found_one) in [index.first_order, index.total].into_iter().enumerate() {
                let allowed = found.error + 3.0 * index.standard_error[k] + 1e-9;
                assert!((found_one - wanted[k]).abs() < allowed, "{index:?} {wanted:?} {allowed}");
            }
        }
    }

    #[test]
    fn the_polynomials_are_those_of_hermite_and_legendre_with_unit_variance() {
        for probability in [0.02, 0.3, 0.5, 0.9] {
            let (x, values) = (normal_quantile(probability), Family::Hermite.values(probability));
            let wanted = [1.0, x, (x * x - 1.0) / 2.0_f64.sqrt()];
            let fifth = (x.powi(5) - 10.0 * x.powi(3) + 15.0 * x) / 120.0_f64.sqrt();
            assert!(values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!((values[5] - fifth).abs() < 1e-12, "{values:?} {fifth}");
            let (x, values) = (2.0 * probability - 1.0, Family::Legendre.values(probability));
            let wanted = [1.0, 3.0_f64.sqrt() * x, 5.0_f64.sqrt() * (1.5 * x * x - 0.5)];
            let fifth = 11.0_f64.sqrt() * (63.0 * x.powi(5) - 70.0 * x.powi(3) + 15.0 * x) / 8.0;
            assert!(values.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-12));
            assert!((values[5] - fifth).abs() < 1e-12, "{values:?} {fifth}");
        }
        assert!(Family::Constant.values(0.3).iter().all(|value| (value - 1.0).abs() < 1e-15));
    }

    #[test]
    fn a_polynomial_has_its_exact_indices_and_an_unknown_without_effect_none() {
        // x + x²/2 of a normal x, y z of uniform ones (variance 1/9), nothing of a constant and a last one.
        let constant = Distribution::LogNormal { median: 2.0, gsd: 1.0 };
        let of = [NORMAL, UNIFORM, constant, UNIFORM, NORMAL];
        let f = |u: &[f64]| {
            let (x, y, z) = (normal_quantile(u[0]), 2.0 * u[1] - 1.0, 2.0 * u[3] - 1.0);
            10.0 + x + 0.5 * x * x + y * z
        };
        let found = fit(&of, 64, f).unwrap();
        let all = 1.5 + 1.0 / 9.0;
        let (x, yz) = (1.5 / all, 1.0 / 9.0 / all);
        assert!(found.error < 1e-20, "{found:?}");
        compare(&found, &[[x; 2], [0.0, yz], [0.0; 2], [0.0, yz], [0.0; 2]]);
        assert!(fit(&of, 64, |_| 3.0).is_none());
    }

    #[test]
    fn a_function_like_ishigamis_has_its_indices_within_the_errors() {
        // Half of Ishigami's range.
        let f = |u: &[f64]| {
            let x: Vec<f64> = u.iter().map(|u| PI * (u - 0.5)).collect();
            x[0].sin() + x[1].sin().powi(2) + 0.1 * x[2].powi(4) * x[0].sin()
        };
        let (fourth, eighth) = (FRAC_PI_2.powi(4) / 5.0, FRAC_PI_2.powi(8) / 9.0);
        let first = [0.5 * (1.0 + 0.1 * fourth).powi(2), 0.125];
        let both = 0.005 * (eighth - fourth * fourth);
        let all = first[0] + first[1] + both;
        let found = fit(&[UNIFORM; 3], 256, f).unwrap();
        assert!((1e-4..0.05).contains(&found.error), "{found:?}");
        compare(
            &found,
            &[[first[0] / all, (first[0] + both) / all], [first[1] / all; 2], [0.0, both / all]],
        );
    }

    #[test]
    fn an_exponential_has_the_indices_of_its_lognormal_variable() {
        let f = |u: &[f64]| (0.8 * normal_quantile(u[0]) + 0.4 * normal_quantile(u[1])).exp();
        let found = fit(&[NORMAL; 3], 256, f).unwrap();
        assert!((1e-4..0.05).contains(&found.error), "{found:?}");
        let part = |squares: f64| squares.exp_m1() / 0.8_f64.exp_m1();
        compare(
            &found,
            &[[part(0.64), 1.0 - part(0.16)], [part(0.16), 1.0 - part(0.64)], [0.0; 2]],
        );
    }

    #[test]
    fn a_function_that_no_polynomial_follows_says_so_with_the_error_of_new_samples() {
        let f = |u: &[f64]| u.iter().map(|u| if *u > 0.7 { 1.0 } else { -0.5 }).product::<f64>();
        let found = fit(&[UNIFORM; 4], 128, f).unwrap();
        assert!(found.error > 0.3, "{found:?}");
    }
}
