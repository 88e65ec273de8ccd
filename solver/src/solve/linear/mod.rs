//! Linear systems on nested grids.

pub(crate) mod columns;
pub(crate) mod galerkin;
