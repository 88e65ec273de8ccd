//! Strains at which the sheet of the paper's springs is unstable under uniaxial tension.

/// The end of the tested strains \[-\].
pub(crate) const END: f64 = 1.0;

/// Curve, Poisson ratio, first and last unstable strain of each stretch \[-\], in steps of 0.02.
pub(crate) const UNSTABLE: [(&str, f64, &[[f64; 2]]); 15] = [
    ("linear", 0.05, &[]),
    ("linear", 0.1, &[]),
    ("linear", 0.2, &[[0.90, END]]),
    ("linear", 0.3, &[[0.52, END]]),
    ("linear", 0.4, &[[0.34, END]]),
    ("linear", 0.49, &[[0.24, END]]),
    ("skin", 0.3, &[]),
    ("skin", 0.35, &[]),
    ("skin", 0.4, &[[0.34, 0.40]]),
    ("skin", 0.45, &[[0.28, 0.40]]),
    // The second stretch: the part of Ef read at −νε has reached the stiffening section.
    ("skin", 0.49, &[[0.24, 0.42], [0.98, END]]),
    ("adipose", 0.05, &[[0.40, END]]),
    ("adipose", 0.1, &[[0.28, END]]),
    ("adipose", 0.3, &[[0.16, END]]),
    ("adipose", 0.49, &[[0.12, END]]),
];

/// Are the found stretches the known ones, to a tolerance?
pub(crate) fn are_close(found: &[[f64; 2]], wanted: &[[f64; 2]], tolerance: f64) -> bool {
    let close =
        |(a, b): (&[f64; 2], &[f64; 2])| a.iter().zip(b).all(|(a, b)| (a - b).abs() < tolerance);
    found.len() == wanted.len() && found.iter().zip(wanted).all(close)
}
