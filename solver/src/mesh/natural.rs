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
}
