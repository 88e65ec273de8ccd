//! The rest shape: a wall curved as a sphere, columns on its normals, a mound of thickness.
//!
//! Uses no other module. Used by `assembly`, `contact`, `element`, `mod`.

/// The chest wall: the plane, or a sphere that falls away from the pocket's centre.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Wall {
    /// Radius of the sphere \[mm\]; absent: the plane.
    pub radius_mm: Option<f64>,
}

impl Wall {
    /// \[R, Z\] at a height \[mm\] on the normal at a material radius s, a length along the wall \[mm\].
    pub(super) fn point(self, s: f64, height: f64) -> [f64; 2] {
        let Some(radius) = self.radius_mm else { return [s, height] };
        let (sin, cos) = (s / radius).sin_cos();
        [(radius + height) * sin, (radius + height) * cos - radius]
    }

    /// Height w of the wall, its slope and second derivative at a distance r from the axis.
    pub(super) fn height(self, r: f64) -> [f64; 3] {
        let Some(radius) = self.radius_mm else { return [0.0; 3] };
        let root = (radius * radius - r * r).max(1e-6 * radius * radius).sqrt();
        [root - radius, -r / root, -radius * radius / root.powi(3)]
    }
}

/// Solids thicker than given about the axis, layers in proportion: thicker by height · exp(−(s/width)²).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mound {
    /// Thickness added on the axis \[mm\].
    pub height_mm: f64,
    /// Width \[mm\].
    pub width_mm: f64,
}

impl Mound {
    /// Factor of the thickness at a material radius \[mm\] of solids of a total thickness \[mm\].
    pub(crate) fn factor(self, s: f64, thickness: f64) -> f64 {
        1.0 + self.height_mm * (-(s / self.width_mm).powi(2)).exp() / thickness
    }
}

/// Wall and mound, and the stretch of the skin over both.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RestShape {
    /// The wall.
    pub wall: Wall,
    /// The mound; absent: even thickness.
    pub mound: Option<Mound>,
    /// Strain of the skin at rest against skin without stress, the same in all directions \[-\]; a dead load holds it in balance.
    pub natural_strain: f64,
    /// Fraction of the skin's logarithmic stretch by the dome that growth takes over \[-\].
    pub growth: f64,
}
