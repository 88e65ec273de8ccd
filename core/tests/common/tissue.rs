//! What the tissue over an implant gains on either side.

use implant_preview_core::body::deform::gained_ml;
use implant_preview_core::body::fit::BodyFit;
use implant_preview_core::body::surface::Surface;
use implant_preview_core::mesh::CELL_TRIANGLES;
use implant_preview_core::solve::Solution;

/// The inner face of a solution gains what the skin gains, within 1 % of the tissue's volume; what it gains \[ml\].
pub(crate) fn inner_gain(
    [before, after]: [&Surface; 2],
    solution: &Solution,
    fit: &BodyFit,
) -> f64 {
    let sheet = solution.problem().sheet();
    let n = sheet.nodes_per_side();
    let mut inner =
        Surface { positions: solution.problem().rest.nodes(0).collect(), ..Surface::default() };
    for (j, i) in (0..n - 1).flat_map(|j| (0..n - 1).map(move |i| (j, i))) {
        let corners = sheet.corners(i, j);
        inner.triangles.extend([1, 3].map(|k| CELL_TRIANGLES[k].map(|c| corners[c] as u32)));
    }
    let lifted = Surface { positions: solution.inner().to_vec(), ..inner.clone() };
    let (skin, inside) = (gained_ml(before, after), gained_ml(&inner, &lifted));
    let within = (0..fit.grid.len()).filter(|node| fit.grid.place(*node).length() <= 110.0);
    let depth = within.map(|node| fit.skin_mm[node] - fit.wall_mm[node]).sum::<f64>();
    let tissue = depth * fit.grid.spacing_mm.powi(2) / 1e3;
    assert!((skin - inside).abs() < 0.01 * tissue, "{skin} {inside} {tissue}");
    inside
}
