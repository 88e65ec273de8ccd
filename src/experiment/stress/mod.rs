//! Stress runs: random scenes and random work of a user, each held against what must always be true.
//!
//! `scenes` (what may be asked) | `check` (what must hold) | `edits` (a user's work) | `shrink` (the
//! smallest scene that still fails).

pub mod check;
mod scenes;

use crate::scene::Scene;
use fastrand::Rng;

/// The random scene of a number.
#[must_use]
pub fn scene(seed: u64, case: u64) -> Scene {
    scenes::scene(&mut Rng::with_seed(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(case)))
}
