//! The natural stretch of a membrane: skin of a living body is under tension where nothing lies under it.

use glam::{DMat2, DVec2};

/// Stretch of the membrane of the tissue at rest against the membrane without stress, one over the whole surface: the symmetric tensor
/// U₀ in the plane of the grid. The rest metric of a triangle is that of its shape without stress, U₀⁻¹ times its shape at rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NaturalStretch {
    /// Principal stretches \[-\].
    stretches: [f64; 2],
    /// U₀.
    tensor: DMat2,
    /// U₀⁻¹.
    inverse: DMat2,
}

impl NaturalStretch {
    /// Stretches along a direction of the grid's plane and across it \[-\], both above 0; the direction is an angle from x to y \[rad\].
    /// `None` where both are 1.
    #[must_use]
    pub fn new(stretches: [f64; 2], direction: f64) -> Option<Self> {
        let is_one = stretches.iter().all(|stretch| stretch.to_bits() == 1.0_f64.to_bits());
        if is_one {
            return None;
        }
        let along = DVec2::from_angle(direction);
        let tensor = |[one, two]: [f64; 2]| {
            let (xx, xy, yy) = (along.x * along.x, along.x * along.y, along.y * along.y);
            let off = if is_even([one, two]) { 0.0 } else { (one - two) * xy };
            DMat2::from_cols(
                DVec2::new(two + (one - two) * xx, off),
                DVec2::new(off, two + (one - two) * yy),
            )
        };
        let inverse = tensor(stretches.map(f64::recip));
        Some(Self { stretches, tensor: tensor(stretches), inverse })
    }

    /// Is the stretch the same in all directions?
    #[must_use]
    pub fn is_even(&self) -> bool {
        is_even(self.stretches)
    }

    /// Is the stretch its own image mirrored along x, along y? Along both or along neither.
    #[must_use]
    pub fn mirrored(&self) -> [bool; 2] {
        // Of a direction along an axis rounding remains.
        [self.tensor.x_axis.y.abs() <= 1e-15; 2]
    }

    /// Principal stretches \[-\], along the direction and across it.
    #[must_use]
    pub fn stretches(&self) -> [f64; 2] {
        self.stretches
    }

    /// Growth up to which the membrane alone resists shear in its plane \[-\]. The shear stiffness of an isotropic membrane under the
    /// tensions σ₁ > σ₂ is ½(σ₁ − σ₂)(λ₁² + λ₂²)/(λ₁² − λ₂²), of which 1 − φ is left, and fibres that turn with the tissue take
    /// ½(σ₁ − σ₂) from it along the lesser tension: φ < 2λ₂²/(λ₁² + λ₂²). Beyond, the membrane flows in folds of any width.
    #[must_use]
    pub fn greatest_growth(&self) -> f64 {
        let [one, two] = self.stretches.map(|stretch| stretch * stretch);
        2.0 * one.min(two) / (one + two)
    }

    /// The same vector of the membrane at rest, of a vector of the membrane without stress.
    #[must_use]
    pub fn stretched(&self, vector: DVec2) -> DVec2 {
        self.tensor * vector
    }

    /// The same vector of the membrane without stress, of a vector of the membrane at rest.
    #[inline]
    #[must_use]
    pub fn released(&self, vector: DVec2) -> DVec2 {
        self.inverse * vector
    }
}

fn is_even([one, two]: [f64; 2]) -> bool {
    one.to_bits() == two.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::CurveSpec;
    use crate::springs::Material;
    use crate::springs::coupled::CoupledLaw;
    use std::f64::consts::{FRAC_PI_2, FRAC_PI_6};

    #[test]
    fn a_vector_is_released_by_the_stretch_of_its_direction() {
        let natural = NaturalStretch::new([1.08, 1.02], FRAC_PI_6).unwrap();
        let (along, across) =
            (DVec2::from_angle(FRAC_PI_6), DVec2::from_angle(FRAC_PI_6 + FRAC_PI_2));
        assert!((natural.released(along) * 1.08).distance(along) < 1e-15);
        assert!((natural.released(across) * 1.02).distance(across) < 1e-15);
        let vector = DVec2::new(0.3, -0.7);
        assert!(natural.stretched(natural.released(vector)).distance(vector) < 1e-15);
    }

    #[test]
    fn only_a_stretch_along_an_axis_or_an_even_one_is_mirrored() {
        let mirrored =
            |stretches, direction| NaturalStretch::new(stretches, direction).unwrap().mirrored();
        for direction in [0.0, FRAC_PI_2, -FRAC_PI_2] {
            assert_eq!(mirrored([1.08, 1.02], direction), [true; 2]);
        }
        assert_eq!(mirrored([1.04, 1.04], 0.3), [true; 2]);
        assert_eq!(mirrored([1.08, 1.02], 0.3), [false; 2]);
        assert_eq!(NaturalStretch::new([1.0, 1.0], 0.3), None);
    }

    /// Principal stretches of a deformation gradient and their directions before and after.
    fn principal(gradient: DMat2) -> [(f64, DVec2, DVec2); 2] {
        let square = gradient.transpose() * gradient;
        let (xx, xy, yy) = (square.x_axis.x, square.x_axis.y, square.y_axis.y);
        let before = DVec2::from_angle(0.5 * (2.0 * xy).atan2(xx - yy));
        [before, before.perp()].map(|before| {
            let after = gradient * before;
            (after.length(), before, after.normalize())
        })
    }

    /// A strip under natural tension that is sheared along it, and grows with that: its force per shear, by differences, changes its sign at the bound.
    #[test]
    fn skin_resists_shear_up_to_the_greatest_growth() {
        let curve = CurveSpec::Exponential { scale_kpa: 20.0, rate: 6.0 };
        let law = CoupledLaw::new(&[Material::of(&curve, 0.45, 1.5)]);
        for stretches in [[1.2, 1.03], [1.05, 1.12]] {
            let natural = NaturalStretch::new(stretches, 0.0).unwrap();
            // Shear along the greater tension.
            let along = if stretches[0] > stretches[1] { DVec2::X } else { DVec2::Y };
            let force = |growth: f64, shear: f64| {
                let outer = |a: DVec2, b: DVec2| DMat2::from_cols(a * b.x, a * b.y);
                let gradient = DMat2::IDENTITY + shear * outer(along, along.perp());
                let grown = principal(gradient)
                    .map(|(stretch, before, _)| stretch.powf(growth) * outer(before, before));
                let rest = natural.inverse * (grown[0] + grown[1]);
                let elastic = principal(gradient * rest.inverse());
                let tension = law.response(elastic.map(|(stretch, ..)| stretch - 1.0)).tension;
                let nominal = [0, 1].map(|k| tension[k] * outer(elastic[k].2, elastic[k].1));
                let nominal = (nominal[0] + nominal[1]) * rest.inverse().transpose();
                along.dot(nominal * along.perp()) * rest.determinant()
            };
            let bound = natural.greatest_growth();
            let stiffness = |growth: f64| (force(growth, 1e-5) - force(growth, -1e-5)) / 2e-5;
            assert!(stiffness(bound - 1e-3) > 0.0 && stiffness(bound + 1e-3) < 0.0, "{bound}");
        }
        let even = NaturalStretch::new([1.1, 1.1], 0.0).unwrap();
        assert!((even.greatest_growth() - 1.0).abs() < 1e-15);
    }
}
