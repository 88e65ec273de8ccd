//! The equilibrium of a centred dome as a boundary value problem in one variable: the reference
//! that the sheet of springs is held against.
//!
//! The coupled law is that of an isotropic membrane, so that under a centred dome the exact answer of
//! the sheet is axisymmetric. With the material radius s, the principal stretches are λ₁ = √(r′² + z′²)
//! along the meridian and λ₂ = r/s around it; with the nominal tensions T₁, T₂ (curves exactly, not
//! their tables) and the slope φ of the meridian (cos φ = r′/λ₁, sin φ = −z′/λ₁):
//!
//! * on the dome, without friction, what the dome gives is normal to it: (s T₁)′ = T₂ cos φ along the
//!   dome's own meridian;
//! * off it: s T₁ sin φ is constant (the contact force / 2π) and (s T₁ cos φ)′ = T₂, from which
//!   (s T₁)′ = T₂ cos φ and φ′ = −T₂ sin φ / (s T₁);
//! * the meridian's tangent is continuous where contact ends; r = s = a, z = 0 at the border.
//!
//! Unknowns are the apex stretch and where contact ends: found by shooting, first each in its bracket,
//! then both by Newton's method.
//!
//! Uses `curve`, `springs`, `implant`, `solve` (its materials). Used by `work_precision` and the tests.

mod runge_kutta;
mod shooting;

use crate::contact::Dome;
use crate::measure::ProfilePoint;
use crate::springs::Material;
use shooting::{Knot, Shooting};
use std::f64::consts::PI;

/// Why there is no axisymmetric solution to compare with.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisymmetricError {
    /// The dome does not stand in the middle of the pocket.
    #[error("the dome's centre is {distance_mm} mm off; allowed: a dome in the pocket's centre")]
    OffCentre {
        /// Distance of the dome's axis from the pocket's \[mm\].
        distance_mm: f64,
    },
    /// The pocket does not hold the dome.
    #[error(
        "the pocket radius is {pocket_radius_mm} mm; allowed: at least the base radius \
         {base_radius_mm} mm"
    )]
    Pocket {
        /// Pocket radius a \[mm\].
        pocket_radius_mm: f64,
        /// Base radius R \[mm\].
        base_radius_mm: f64,
    },
    /// A sheet without layers carries nothing.
    #[error("there are no layers; allowed: at least one")]
    NoLayers,
    /// Shooting did not meet the border.
    #[error("no axisymmetric solution was found; the border is missed by {miss:.1e} of the radius")]
    NotFound {
        /// Distance from the border at the end of the sheet / pocket radius \[-\]; NaN when it was
        /// not reached at all.
        miss: f64,
    },
}

/// Apex strain beyond which a shot is no answer \[-\].
const MOST_STRAIN: f64 = 10.0;

/// The axisymmetric equilibrium. Figures agree with the stored references within 1e-6; the border is
/// met within 1e-8 of the pocket radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Stretch at the apex, the same in every direction \[-\].
    pub apex_stretch: f64,
    /// The meridian's parameter θ where contact ends \[rad\]: r = R sin θ, z = z₀ + p cos θ; on a
    /// hemisphere the angle from its axis.
    pub contact_angle: f64,
    /// Material radius where contact ends \[mm\].
    pub contact_material_radius_mm: f64,
    /// Force between dome and sheet along the axis \[N\].
    pub contact_force_n: f64,
    /// Deformed area / area at rest \[-\].
    pub area_ratio: f64,
    /// From the apex to the border.
    knots: Vec<Knot>,
}

impl Solution {
    /// The profile at a material radius \[mm\], 0 to the pocket radius (clamped to it): cubic Hermite
    /// interpolation between steps so short that it adds less than 1e-8 of the radius.
    #[must_use]
    pub fn point(&self, s_mm: f64) -> ProfilePoint {
        let last = self.knots.len() - 1;
        let s = s_mm.clamp(0.0, self.knots[last].s);
        let high = self.knots.partition_point(|knot| knot.s < s).clamp(1, last);
        let [r, z, strain] = self.knots[high - 1].interpolate(&self.knots[high], s);
        ProfilePoint {
            s_mm: s,
            r_mm: r,
            z_mm: z,
            stretch_meridional: 1.0 + strain,
            stretch_hoop: if s > 0.0 { r / s } else { self.apex_stretch },
        }
    }
}

/// Finds the axisymmetric equilibrium of a sheet with coupled springs, clamped on the circle of the
/// pocket radius \[mm\], over a dome in its centre. Takes milliseconds. Tested for projections from 0.3 to
/// 1.5 of the base radius; far flatter or taller domes may have no answer that shooting finds.
///
/// # Errors
/// [`AxisymmetricError`] if the dome is off centre or does not fit the pocket, if there is no layer, or
/// if shooting does not meet the border.
pub fn solve(
    dome: &Dome,
    pocket_radius_mm: f64,
    materials: &[Material],
) -> Result<Solution, AxisymmetricError> {
    let (distance_mm, base_radius_mm) = (dome.center.length(), dome.base_radius);
    if distance_mm > 1e-9 * base_radius_mm {
        return Err(AxisymmetricError::OffCentre { distance_mm });
    }
    if pocket_radius_mm < base_radius_mm * (1.0 - 1e-9) {
        return Err(AxisymmetricError::Pocket { pocket_radius_mm, base_radius_mm });
    }
    if materials.is_empty() {
        return Err(AxisymmetricError::NoLayers);
    }
    if dome.apex().z <= 1e-9 * base_radius_mm {
        return Ok(flat(pocket_radius_mm));
    }
    let shooting = Shooting::new(dome, pocket_radius_mm, materials);
    let (strain, angle) = shooting.aim()?;
    let mut knots = Vec::new();
    let shot = shooting.shoot(strain, angle, shooting::FINE, Some(&mut knots));
    let miss = shot.hoop.hypot(shot.height / pocket_radius_mm);
    // A sheet stretched tenfold has run away along a softening curve: no answer to compare with.
    if miss.is_nan() || miss > 1e-8 || strain > MOST_STRAIN {
        return Err(AxisymmetricError::NotFound { miss });
    }
    Ok(Solution {
        apex_stretch: 1.0 + strain,
        contact_angle: angle,
        contact_material_radius_mm: shot.contact_radius,
        contact_force_n: 2.0 * PI * shot.vertical / 1000.0,
        area_ratio: 2.0 * shot.area / pocket_radius_mm.powi(2),
        knots,
    })
}

/// A sheet that nothing lifts.
fn flat(pocket_radius_mm: f64) -> Solution {
    let knot = |s| Knot { s, value: [s, 0.0, 0.0], slope: [1.0, 0.0, 0.0] };
    Solution {
        apex_stretch: 1.0,
        contact_angle: 0.0,
        contact_material_radius_mm: 0.0,
        contact_force_n: 0.0,
        area_ratio: 1.0,
        knots: vec![knot(0.0), knot(pocket_radius_mm)],
    }
}
