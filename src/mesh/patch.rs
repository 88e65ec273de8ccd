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
}

impl Patch {
    /// The pocket alone, clamped at its rim: the tissue around the pocket does not move.
    #[must_use]
    pub fn clamped_at_pocket(pocket_radius_mm: f64) -> Self {
        Self { radius_mm: pocket_radius_mm, pocket_radius_mm, edge: Edge::Clamped }
    }
}
