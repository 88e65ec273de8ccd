//! State and stress of a tension field: skin that wrinkles instead of being compressed.
//!
//! [`relaxed`] has the law; this file states what the law does at given strains. Uses `coupled`. Used by `measure`.

use super::coupled::{biot_stress, relaxed};
use crate::curve::Curve;

/// State of a tension field.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum FieldState {
    /// No strain is relaxed: tension in both principal directions, or undeformed.
    #[default]
    Taut,
    /// Uniaxial tension, ε₂ < −ν ε₁ with ε₁ > 0: the second principal tension is zero, and the crests of the wrinkles run
    /// along the first principal direction.
    Wrinkled,
    /// No tension in any direction: ε₁ ≤ 0.
    Slack,
}

/// State of a tension field at principal Biot strains \[-\].
#[inline]
#[must_use]
pub fn state(strain: [f64; 2], poisson_ratio: f64) -> FieldState {
    let (greater, least) = (strain[0].max(strain[1]), strain[0].min(strain[1]));
    if least >= -poisson_ratio * greater.max(0.0) {
        FieldState::Taut
    } else if greater > 0.0 {
        FieldState::Wrinkled
    } else {
        FieldState::Slack
    }
}

/// The greatest strain that wrinkles take up \[-\], 0 or more: relaxed minus given strain, in slack skin that of the direction
/// of the greatest compression. 0.05: of 100 mm of skin 5 mm lie in folds.
#[inline]
#[must_use]
pub fn wrinkle_strain(strain: [f64; 2], poisson_ratio: f64) -> f64 {
    let at = relaxed(strain, poisson_ratio);
    (at[0] - strain[0]).max(at[1] - strain[1])
}

/// Principal Biot (nominal) stresses \[kPa\] of a tension field: taut those of the coupled law, wrinkled that of uniaxial
/// tension and zero, slack zero.
#[must_use]
pub fn stress(curve: &Curve, poisson_ratio: f64, strain: [f64; 2]) -> [f64; 2] {
    biot_stress(curve, poisson_ratio, relaxed(strain, poisson_ratio))
}

/// Steps of the bisection in [`strain_of`]: the strain is exact to rounding.
const BISECTIONS: usize = 60;

/// Principal Biot strains \[-\] of taut skin under two principal nominal stresses, 0 or more \[kPa\]: the inverse of [`stress`]. `None`
/// above an equivalent strain.
///
/// With the secant S of the curve at ē the strains are (T₁ − νT₂)/S and (T₂ − νT₁)/S, and ē is the strain of the uniaxial stress
/// √(T₁² + T₂² − 2νT₁T₂).
#[must_use]
pub fn strain_of(
    curve: &Curve,
    poisson_ratio: f64,
    [one, two]: [f64; 2],
    greatest: f64,
) -> Option<[f64; 2]> {
    let nu = poisson_ratio;
    let uniaxial = (one * one + two * two - 2.0 * nu * one * two).max(0.0).sqrt();
    let (mut least, mut most) = (0.0, greatest);
    if curve.stress(most) < uniaxial {
        return None;
    }
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (least + most);
        if curve.stress(middle) < uniaxial {
            least = middle;
        } else {
            most = middle;
        }
    }
    let secant = curve.secant(most);
    Some([(one - nu * two) / secant, (two - nu * one) / secant])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::springs::Material;
    use crate::springs::coupled::{CoupledLaw, equivalent_strain};

    #[test]
    fn the_state_is_that_of_the_tensions_of_the_law() {
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        for poisson_ratio in [0.0, 0.3, 0.45, 0.5] {
            let law = CoupledLaw::new(&[Material::new(curve.clone(), poisson_ratio, 1.0)]);
            let mut counts = [0; 3];
            for k in 0..4000 {
                let t = f64::from(k);
                let strain = [0.6 * (0.1 + 0.37 * t).sin(), 0.6 * (0.11 * t).cos()];
                let greater_first = [strain[0].max(strain[1]), strain[0].min(strain[1])];
                let tension = law.response(greater_first).tension;
                let expected = match tension {
                    [first, second] if first > 0.0 && second > 0.0 => FieldState::Taut,
                    [first, _] if first > 0.0 => FieldState::Wrinkled,
                    _ => FieldState::Slack,
                };
                assert_eq!(state(strain, poisson_ratio), expected, "{strain:?}");
                assert_eq!(state([strain[1], strain[0]], poisson_ratio), expected, "{strain:?}");
                counts[expected as usize] += 1;
                let of_curve = stress(&curve, poisson_ratio, greater_first);
                for (of_curve, of_table) in of_curve.into_iter().zip(tension) {
                    assert!((of_curve - of_table).abs() < 1e-2, "{strain:?}");
                    assert!(of_curve >= 0.0, "{strain:?}");
                }
            }
            assert!(counts.into_iter().all(|count| count > 500), "{counts:?}");
        }
        assert_eq!(state([0.0; 2], 0.45), FieldState::Taut);
    }

    #[test]
    fn the_strain_of_a_stress_is_the_inverse_of_the_law() {
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        for poisson_ratio in [0.0, 0.3, 0.45, 0.5] {
            for given in [[13.0, 13.0], [20.0, 10.0], [60.0, 20.0], [5.0, 0.0], [0.0, 0.0]] {
                let strain = strain_of(&curve, poisson_ratio, given, 1.0).unwrap();
                assert!(equivalent_strain(strain, poisson_ratio) < 0.7);
                let found = stress(&curve, poisson_ratio, strain);
                for (found, given) in found.into_iter().zip(given) {
                    assert!((found - given).abs() < 1e-9, "{poisson_ratio}: {found} {given}");
                }
            }
            assert_eq!(strain_of(&curve, poisson_ratio, [300.0, 0.0], 0.5), None);
        }
    }

    #[test]
    fn taut_skin_has_the_stress_of_the_coupled_law_and_slack_skin_none() {
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        let bits = |stress: [f64; 2]| stress.map(f64::to_bits);
        let taut = [0.2, -0.08];
        assert_eq!(bits(stress(&curve, 0.45, taut)), bits(biot_stress(&curve, 0.45, taut)));
        assert!(wrinkle_strain(taut, 0.45).abs() < 1e-15);
        let [along, across] = stress(&curve, 0.45, [0.2, -0.3]);
        assert!((along - curve.stress(0.2)).abs() < 1e-12 && across.abs() < 1e-12);
        // −0.45 · 0.2 = −0.09 without a fold.
        assert!((wrinkle_strain([0.2, -0.3], 0.45) - 0.21).abs() < 1e-12);
        assert!(stress(&curve, 0.45, [-0.1, -0.3]).iter().all(|stress| stress.abs() < 1e-15));
        assert!((wrinkle_strain([-0.1, -0.3], 0.45) - 0.3).abs() < 1e-12);
    }
}
