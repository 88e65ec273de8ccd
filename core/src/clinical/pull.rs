//! The model of the anterior pull: from the displacement of the skin to the strain scale of the skin's curve.
//!
//! A grip of radius b lifts the centre of a flat sheet of skin of radius A = half the base width by d, with the force F.
//! Radial fibres only:
//!
//! ```text
//! vertical balance    T(r) = F L / (2π r d),   L = √((A−b)² + d²)      line tension [N/mm]
//! length of a fibre   ∫_b^A (1 + ε(T(r)))/(1 + ε(T₀)) dr = L
//! curve of the skin   T / h = preset(ε / s)
//! ```
//!
//! T₀ is the natural tension of the skin, under which a fibre is A − b long. With ε = s · preset⁻¹(T/h) the second equation is linear in s. Without T₀
//! the prestretch would count twice: in the scale and in the tension. Assumptions: b = 15 mm, F = 5 N, skin h = 1.5 mm. The
//! force of a pull is unknown (2–10 N); no measured force was found.

use super::{SKIN_THICKNESS_MM, limits};
use crate::curve::{Curve, CurveSpec};
use std::f64::consts::PI;

/// Radius of the fingertips' grip \[mm\].
pub const GRIP_RADIUS_MM: f64 = 15.0;

/// Force of the pull \[N\].
pub const GRIP_FORCE_N: f64 = 5.0;

/// kPa per N/mm².
const KPA: f64 = 1000.0;

/// Strain scale of the skin preset \[-\] for a pull and a base width \[mm\] of skin under a natural tension \[N/m\]; not a number outside of
/// [`limits::PULL_MM`] and [`limits::MEASURED_WIDTH_MM`], infinite where the grip hardly pulls more than that tension.
///
/// At a base width of 120 mm without a tension about (pull / 35 mm)^2.4, within 4 % from 15 to 45 mm.
#[must_use]
pub fn pull_strain_scale(pull_mm: f64, base_width_mm: f64, natural_tension_n_per_m: f64) -> f64 {
    let is_in = |value: f64, (least, most): (f64, f64)| (least..=most).contains(&value);
    if !(is_in(pull_mm, limits::PULL_MM) && is_in(base_width_mm, limits::MEASURED_WIDTH_MM)) {
        return f64::NAN;
    }
    let span = 0.5 * base_width_mm - GRIP_RADIUS_MM;
    let length = span.hypot(pull_mm);
    let stress_times_radius =
        KPA * GRIP_FORCE_N * length / (2.0 * PI * pull_mm * SKIN_THICKNESS_MM);
    let Ok(skin) = Curve::new(&CurveSpec::Skin {}) else { return f64::NAN };
    let strain = |radius: f64| inverse(&skin, stress_times_radius / radius);
    let at_rest = match natural_tension_n_per_m {
        tension if tension > 0.0 => inverse(&skin, tension / SKIN_THICKNESS_MM),
        _ => 0.0,
    };
    // By parts, ∫ ε dr = [ε r] − ∫ r dε: two strains are searched for instead of one a radius.
    let [inner, outer] = [GRIP_RADIUS_MM, GRIP_RADIUS_MM + span];
    let [most, least] = [inner, outer].map(strain);
    let radius = |strain: f64| stress_times_radius / skin.stress(strain);
    let strains = least * outer - most * inner + simpson(radius, least, most);
    let added = strains - length * at_rest;
    if added > 0.0 { (length - span) / added } else { f64::INFINITY }
}

/// The strain at a stress \[kPa\], by bisection.
fn inverse(curve: &Curve, stress: f64) -> f64 {
    let (mut low, mut high) = (0.0, 1.0);
    while curve.stress(high) < stress {
        high *= 2.0;
    }
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if curve.stress(middle) < stress {
            low = middle;
        } else {
            high = middle;
        }
    }
    0.5 * (low + high)
}

/// ∫ f over [from, to] by Simpson's rule.
fn simpson(f: impl Fn(f64) -> f64, from: f64, to: f64) -> f64 {
    const PANELS: u32 = 200;
    let step = (to - from) / f64::from(2 * PANELS);
    let weight = |k: u32| match k {
        0 => 1.0,
        k if k == 2 * PANELS => 1.0,
        k if k % 2 == 1 => 4.0,
        _ => 2.0,
    };
    let sum: f64 = (0..=2 * PANELS).map(|k| weight(k) * f(from + step * f64::from(k))).sum();
    sum * step / 3.0
}
