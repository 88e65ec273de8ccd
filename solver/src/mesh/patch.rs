//! The patch of simulated tissue and the boundary condition at its edge.

/// A disc of tissue about the pocket's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patch {
    /// Radius of the simulated tissue \[mm\]; the grid covers it.
    pub radius_mm: f64,
    /// Radius of the pocket, inside of which the tissue is detached from the wall \[mm\].
    pub pocket_radius_mm: f64,
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

/// Isotropic springs between the inner face beyond the pocket and the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attachment {
    /// Stiffness per area beyond the ramp \[kPa/mm\].
    pub stiffness_kpa_per_mm: f64,
    /// Width over which the stiffness rises from zero at the pocket's radius \[mm\].
    pub ramp_mm: f64,
}

impl Patch {
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
        let held = |attachment: Attachment| self.pocket_radius_mm + attachment.ramp_mm;
        self.attachment().map_or(self.radius_mm, |a| held(a).min(self.radius_mm))
    }

    /// The pocket alone, clamped at its rim: the tissue around the pocket does not move.
    #[must_use]
    pub fn clamped_at_pocket(pocket_radius_mm: f64) -> Self {
        Self { radius_mm: pocket_radius_mm, pocket_radius_mm, edge: Edge::Clamped }
    }
}
