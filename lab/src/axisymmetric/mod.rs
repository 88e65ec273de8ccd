//! Reference solution for a centred dome: the equilibrium as a boundary value problem in one variable.
//!
//! The coupled law describes an isotropic membrane; over a centred dome the exact solution is axisymmetric.
//! With the material radius s, the principal stretches are λ₁ = √(r′² + z′²) along the meridian and
//! λ₂ = r/s along the hoop; with the nominal tensions T₁, T₂ (from the curves, not from tables) and the
//! slope φ of the meridian (cos φ = r′/λ₁, sin φ = −z′/λ₁):
//!
//! * on the dome, without friction, the contact pressure is normal to the dome: (s T₁)′ = T₂ cos φ along
//!   the dome's meridian;
//! * off the dome: s T₁ sin φ is constant (the contact force / 2π) and (s T₁ cos φ)′ = T₂, hence
//!   (s T₁)′ = T₂ cos φ and φ′ = −T₂ sin φ / (s T₁);
//! * the meridian's tangent is continuous at the contact edge; r = s = a, z = 0 at the border.
//!
//! The unknowns are the apex stretch and the contact edge. Shooting brackets each unknown, then Newton's
//! method refines both.
//!
//! Uses `curve`, `springs`, `implant`, `solve` (its materials). Used by `work_precision` and the tests.

mod meridian;
mod runge_kutta;
mod shooting;

use implant_preview_core::contact::Dome;
use implant_preview_core::measure::ProfilePoint;
use implant_preview_core::springs::Material;
use shooting::{Knot, Shooting};
use std::f64::consts::PI;

/// Reason for the absence of an axisymmetric solution.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisymmetricError {
    /// The dome is not centred in the pocket.
    #[error("the dome's centre is {distance_mm} mm off; allowed: a dome in the pocket's centre")]
    OffCentre {
        /// Distance between the axes of dome and pocket \[mm\].
        distance_mm: f64,
    },
    /// The dome is anatomical, or no half-ball's image.
    #[error("the dome is no solid of revolution; allowed: a round implant")]
    NotRound,
    /// The pocket is smaller than the dome.
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
    /// The sheet has no layers.
    #[error("there are no layers; allowed: at least one")]
    NoLayers,
    /// Shooting did not satisfy the boundary conditions.
    #[error(
        "no axisymmetric solution was found; the distance from the border is {miss:.1e} of the radius"
    )]
    NotFound {
        /// Distance between the end of the sheet and the border / pocket radius \[-\]; NaN if the shot
        /// did not reach the border.
        miss: f64,
    },
}

/// Greatest apex strain of a solution \[-\].
const MAX_STRAIN: f64 = 10.0;

/// The axisymmetric equilibrium. Results agree with the stored references within 1e-6; the error of the
/// boundary conditions is below 1e-8 of the pocket radius.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// Stretch at the apex, equal in every direction \[-\].
    pub apex_stretch: f64,
    /// Parameter θ of the dome's meridian at the contact edge \[rad\]: z = z₀ + p cos θ, of half of an ellipsoid r = R sin θ; on a
    /// hemisphere the angle from the axis.
    pub contact_angle: f64,
    /// Material radius at the contact edge \[mm\].
    pub contact_material_radius_mm: f64,
    /// Force between dome and sheet along the axis \[N\].
    pub contact_force_n: f64,
    /// Deformed area / area at rest \[-\].
    pub area_ratio: f64,
    /// Profile from the apex to the border.
    knots: Vec<Knot>,
}

impl Solution {
    /// The profile at a material radius \[mm\], clamped to 0 … pocket radius: cubic Hermite interpolation
    /// with an error below 1e-8 of the radius.
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

/// Solves the axisymmetric equilibrium of a sheet with coupled springs over a centred dome, clamped on the
/// circle of the pocket radius \[mm\]. Run time: milliseconds. Tested for projections from 0.3 to 1.5 of the
/// base radius; shooting may fail for much flatter or taller domes.
///
/// # Errors
/// [`AxisymmetricError`] if the dome is off centre, anatomical or larger than the pocket, if the sheet has no layer, or
/// if shooting does not satisfy the boundary conditions.
pub fn solve(
    dome: &Dome,
    pocket_radius_mm: f64,
    materials: &[Material],
) -> Result<Solution, AxisymmetricError> {
    let (distance_mm, base_radius_mm) = (dome.center.length(), dome.reference_length());
    if distance_mm > 1e-9 * base_radius_mm {
        return Err(AxisymmetricError::OffCentre { distance_mm });
    }
    if !dome.is_round() || dome.shape.half_ball().is_none() {
        return Err(AxisymmetricError::NotRound);
    }
    if pocket_radius_mm < base_radius_mm * (1.0 - 1e-9) {
        return Err(AxisymmetricError::Pocket { pocket_radius_mm, base_radius_mm });
    }
    if materials.is_empty() {
        return Err(AxisymmetricError::NoLayers);
    }
    if dome.top() <= 1e-9 * base_radius_mm {
        return Ok(flat(pocket_radius_mm));
    }
    let shooting = Shooting::new(dome, pocket_radius_mm, materials);
    let (strain, angle) = shooting.solve()?;
    let mut knots = Vec::new();
    let shot = shooting.shoot(strain, angle, shooting::FINE, Some(&mut knots));
    let miss = shot.hoop.hypot(shot.height / pocket_radius_mm);
    // A tenfold stretch indicates divergence along a softening curve.
    if miss.is_nan() || miss > 1e-8 || strain > MAX_STRAIN {
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

/// The flat sheet at zero insertion.
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
