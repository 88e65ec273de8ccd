//! Readers of surfaces.
