//! Linear systems on nested grids.

pub(crate) mod galerkin;
