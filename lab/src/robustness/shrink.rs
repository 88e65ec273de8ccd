//! Reduction of a failing scene to a simpler scene that still fails.

use implant_preview_core::curve::CurveSpec;
use implant_preview_core::scene::{Body, CellsThrough, Scene, Springs};

/// Greatest number of trial scenes, of a sheet and of layered tissue, whose solves take longer.
const MAX_TRIALS: [usize; 2] = [300, 80];

/// Simplifies a scene step by step as long as the scene fails.
pub(super) fn shrink(scene: &Scene, fails: impl Fn(&Scene) -> bool) -> Scene {
    let mut best = scene.clone();
    let mut trials = 0;
    let most = MAX_TRIALS[usize::from(scene.is_layered())];
    loop {
        let simpler = simpler(&best).into_iter().find(|candidate| {
            trials += 1;
            trials <= most && candidate.validate().is_ok() && *candidate != best && fails(candidate)
        });
        match simpler {
            Some(simpler) => best = simpler,
            None => return best,
        }
    }
}

/// Slightly simpler scenes, the simplest first.
fn simpler(scene: &Scene) -> Vec<Scene> {
    let mut all = Vec::new();
    let mut offer = |change: &dyn Fn(&mut Scene)| {
        let mut simpler = scene.clone();
        change(&mut simpler);
        all.push(simpler);
    };
    for k in 0..scene.layers.len() {
        offer(&|s| drop(s.layers.remove(k)));
    }
    for n in [17, 25, 33, 65, 129] {
        if n < scene.solver.nodes_per_side {
            offer(&|s| s.solver.nodes_per_side = n);
        }
    }
    if scene.is_layered() {
        let body = scene.body;
        let default = Body::around(scene.pocket_radius_mm, body.tissue_model);
        offer(&|s| s.solver.cells_through = Some(CellsThrough::Auto));
        offer(&|s| s.solver.cells_through = Some(CellsThrough::Count(1)));
        offer(&|s| s.body = Body { attachment: default.attachment, ..body });
        offer(&|s| s.body = Body { skin_state: default.skin_state, ..body });
        offer(&|s| s.body = Body { pocket_void_ml: None, ..body });
        let patch_radius_mm = default.patch_radius_mm;
        offer(&|s| s.body = Body { patch_radius_mm, ..body });
    }
    offer(&|s| s.springs = Springs::Coupled);
    offer(&|s| s.implant.center_mm = [0.0; 2]);
    offer(&|s| s.implant.center_mm[1] = 0.0);
    offer(&|s| s.insertion = 1.0);
    offer(&|s| s.implant.projection_mm = s.implant.base_radius_mm);
    offer(&|s| s.solver.tolerance = 1e-4);
    for k in 0..scene.layers.len() {
        offer(&|s| s.layers[k].curve = CurveSpec::Linear { modulus_kpa: 10.0 }.into());
        offer(&|s| s.layers[k].curve = CurveSpec::Skin {}.into());
        offer(&|s| s.layers[k].curve = CurveSpec::Adipose {}.into());
        if let CurveSpec::Points { points, interpolation } = &scene.layers[k].curve.spec
            && points.len() > 2
        {
            for p in 1..points.len() {
                let mut points = points.clone();
                points.remove(p);
                let curve = CurveSpec::Points { points, interpolation: *interpolation };
                offer(&|s| s.layers[k].curve.spec = curve.clone());
            }
        }
        offer(&|s| s.layers[k].poisson_ratio = 0.0);
        offer(&|s| s.layers[k].thickness_mm = 1.0);
    }
    // Fewer digits.
    for digits in [1.0, 10.0, 100.0] {
        let round = |value: f64| (value * digits).round() / digits;
        offer(&|s| {
            s.implant.base_radius_mm = round(s.implant.base_radius_mm);
            s.implant.projection_mm = round(s.implant.projection_mm);
            s.implant.center_mm = s.implant.center_mm.map(round);
            s.pocket_radius_mm = round(s.pocket_radius_mm);
        });
        offer(&|s| {
            let body = &mut s.body;
            body.patch_radius_mm = round(body.patch_radius_mm);
            body.attachment.stiffness_kpa_per_mm = round(body.attachment.stiffness_kpa_per_mm);
            body.attachment.ramp_mm = round(body.attachment.ramp_mm);
        });
        offer(&|s| s.insertion = round(s.insertion));
        offer(&|s| {
            for layer in &mut s.layers {
                layer.thickness_mm = round(layer.thickness_mm);
                layer.poisson_ratio = round(layer.poisson_ratio);
            }
        });
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::scene::Layer;

    #[test]
    fn properties_irrelevant_to_a_failure_are_removed() {
        let mut scene = Scene::sheet();
        scene.implant.center_mm = [3.217, 2.881];
        scene.layers =
            vec![Layer::skin(), Layer::adipose(), Layer { thickness_mm: 41.3, ..Layer::skin() }];
        scene.insertion = 0.731;
        let small = shrink(&scene, |s| s.layers.iter().any(|layer| layer.thickness_mm > 40.0));
        assert_eq!(small.layers.len(), 1);
        assert!(small.implant.center_mm.iter().all(|c| c.abs() <= 0.0));
        assert_eq!(small.solver.nodes_per_side, 17);
        assert!(small.layers[0].thickness_mm > 40.0);
    }
}
