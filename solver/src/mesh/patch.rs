//! The patch of simulated tissue, its pocket, and the boundary condition at its edge.

use crate::curve::present;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::f64::consts::PI;

/// A disc of tissue about the pocket's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Radius of the simulated tissue \[mm\]; the grid covers it.
    pub radius_mm: f64,
    /// Radius of the pocket, inside of which the tissue is detached from the wall \[mm\].
    pub pocket_radius_mm: f64,
    /// How much lower the pocket's lower edge is than that of the circle \[mm\].
    pub pocket_lowered_mm: f64,
    /// Boundary condition at the edge.
    pub edge: Edge,
}

/// Boundary condition at the edge of the patch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Edge {
    /// The edge is fixed at its position at rest.
    #[default]
    Clamped,
    /// The edge is fixed, and the inner face is attached to the wall between the pocket and the edge.
    Attached(Attachment),
}

/// Springs between the inner face beyond the pocket and the wall.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(rename = "AttachmentSettings")]
#[serde(deny_unknown_fields, default, expecting = "one JSON object")]
pub struct Attachment {
    /// Stiffness per area \[kPa/mm\], 0.1 to 50.
    #[serde(deserialize_with = "present")]
    pub stiffness_kpa_per_mm: f64,
    /// Width over which the stiffness rises from zero at the pocket's edge \[mm\], 1 to 40.
    #[serde(deserialize_with = "present")]
    pub ramp_mm: f64,
}

impl Default for Attachment {
    fn default() -> Self {
        Self { stiffness_kpa_per_mm: 2.0, ramp_mm: 10.0 }
    }
}

/// The pocket: a disc about the grid's centre; where its edge is lowered, the half y < 0 is that of an ellipse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pocket {
    /// Radius of the disc \[mm\].
    pub radius_mm: f64,
    /// How much further the half of the ellipse reaches than the disc \[mm\].
    pub lowered_mm: f64,
}

impl Pocket {
    /// A disc.
    #[must_use]
    pub const fn round(radius_mm: f64) -> Self {
        Self { radius_mm, lowered_mm: 0.0 }
    }

    /// Does the pocket reach further down than up?
    #[must_use]
    pub fn is_lowered(self) -> bool {
        self.lowered_mm > 0.0
    }

    /// Greatest distance of the edge from the centre \[mm\].
    #[must_use]
    pub fn reach_mm(self) -> f64 {
        self.radius_mm + self.lowered_mm
    }

    /// Radius / half-axis of the ellipse along y \[-\].
    fn factor(self) -> f64 {
        self.radius_mm / self.reach_mm()
    }

    /// Distance of a place beyond the edge \[mm\], negative within; of the ellipse to first order, along its axes exactly. The place has this
    /// distance from the centre and this y.
    #[must_use]
    pub fn beyond(self, distance_mm: f64, y_mm: f64) -> f64 {
        let over = distance_mm - self.radius_mm;
        if !self.is_lowered() || y_mm >= 0.0 {
            return over;
        }
        // The gauge g = |(x, q y)|, and g times the length of its gradient, |(x, q² y)|.
        let q = self.factor();
        let x_squared = (distance_mm * distance_mm - y_mm * y_mm).max(0.0);
        let [gauge, slope] = [q * y_mm, q * q * y_mm].map(|y| (x_squared + y * y).sqrt());
        (gauge - self.radius_mm) * gauge / slope
    }

    /// Distance of the edge from the centre in the direction of a unit vector \[mm\].
    #[must_use]
    pub fn edge(self, [x, y]: [f64; 2]) -> f64 {
        if !self.is_lowered() || y >= 0.0 {
            return self.radius_mm;
        }
        self.radius_mm / x.hypot(self.factor() * y)
    }

    /// Area \[mm²\].
    #[must_use]
    pub fn area_mm2(self) -> f64 {
        PI * self.radius_mm.powi(2) + 0.5 * PI * self.radius_mm * self.lowered_mm
    }
}

impl Patch {
    /// The pocket.
    #[must_use]
    pub fn pocket(&self) -> Pocket {
        Pocket { radius_mm: self.pocket_radius_mm, lowered_mm: self.pocket_lowered_mm }
    }

    /// What holds the inner face between the pocket and the edge.
    #[must_use]
    pub fn attachment(&self) -> Option<Attachment> {
        match self.edge {
            Edge::Clamped => None,
            Edge::Attached(attachment) => Some(attachment),
        }
    }

    /// Radius beyond which the tissue is held at rest, or nearly so \[mm\].
    #[must_use]
    pub fn reach_mm(&self) -> f64 {
        let held = |attachment: Attachment| self.pocket().reach_mm() + attachment.ramp_mm;
        self.attachment().map_or(self.radius_mm, |a| held(a).min(self.radius_mm))
    }

    /// The pocket alone, clamped at its rim: the tissue around the pocket does not move.
    #[must_use]
    pub fn clamped_at_pocket(pocket_radius_mm: f64) -> Self {
        Self {
            radius_mm: pocket_radius_mm,
            pocket_radius_mm,
            pocket_lowered_mm: 0.0,
            edge: Edge::Clamped,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::TAU;

    #[test]
    fn the_edge_of_a_lowered_pocket_is_a_circle_above_and_an_ellipse_below() {
        let (round, lowered) = (Pocket::round(70.0), Pocket { radius_mm: 70.0, lowered_mm: 14.0 });
        let mut area = 0.0;
        for k in 0..3600 {
            let (y, x) = (TAU * (f64::from(k) + 0.5) / 3600.0).sin_cos();
            let edge = lowered.edge([x, y]);
            area += 0.5 * edge * edge * TAU / 3600.0;
            assert!(lowered.beyond(edge, edge * y).abs() < 1e-9, "{x} {y}");
            // Near the edge the distance is that along the edge's normal.
            let [within, beyond] = [edge - 1.0, edge + 1.0].map(|r| lowered.beyond(r, r * y));
            assert!(within > -1.001 && within < -0.95 && beyond < 1.001 && beyond > 0.95);
            if y > 0.0 {
                for distance in [3.0, 70.0, 90.0] {
                    let own = lowered.beyond(distance, distance * y);
                    assert_eq!(own.to_bits(), (distance - 70.0_f64).to_bits());
                }
            }
            let own = round.beyond(64.0, 64.0 * y);
            assert_eq!(
                (own.to_bits(), round.edge([x, y]).to_bits()),
                ((-6.0_f64).to_bits(), 70.0_f64.to_bits())
            );
        }
        assert!((area / lowered.area_mm2() - 1.0).abs() < 1e-6);
        // Along the axis downwards the distance is exact.
        assert!((lowered.beyond(50.0, -50.0) + 34.0).abs() < 1e-9);
    }
}
