//! What tests of several bodies share.

use implant_preview_core::body::surface::Surface;

/// Triangles of the skin that an operation turns over: their normal after points against that before.
pub(crate) fn turned_over(before: &Surface, after: &Surface) -> usize {
    let normal = |surface: &Surface, triangle: &[u32; 3]| {
        let [a, b, c] = surface.corners(*triangle);
        (b - a).cross(c - a)
    };
    let is_turned = |t: &&[u32; 3]| normal(before, t).dot(normal(after, t)) <= 0.0;
    before.triangles.iter().filter(is_turned).count()
}
