//! Postures: the weight of an implant that yields.
#![allow(clippy::unwrap_used)]
#![allow(clippy::float_cmp, reason = "equal to the last bit")]

use implant_preview_core::measure::{Outcome, Status};
use implant_preview_core::scene::{Fill, Posture, Scene};
use implant_preview_core::simulate::simulate;
use std::f64::consts::PI;

/// Weight per volume of gel \[kPa/mm\].
const WEIGHT: f64 = 970.0 * 9.81e-6;

fn plan(fill: Option<Fill>, posture: Posture) -> Scene {
    let mut scene = Scene::opening();
    scene.implant.fill = fill;
    scene.body.posture = posture;
    (scene.solver.nodes_per_side, scene.solver.tolerance) = (65, 2e-4);
    scene
}

fn solved(fill: Option<Fill>, posture: Posture) -> Outcome {
    let found = simulate(&plan(fill, posture)).unwrap();
    assert_eq!(found.status, Status::Converged);
    found
}

#[test]
fn a_rigid_implant_is_the_same_in_every_posture() {
    let [none, others @ ..] = Posture::ALL.map(|posture| solved(None, posture));
    for other in others {
        assert_eq!(none.contact_force_n, other.contact_force_n);
        assert_eq!(none.profile_skin, other.profile_skin);
        assert_eq!(none.solver.nodes_solved, other.solver.nodes_solved);
    }
}

/// A standing body shears, a bare one by s = 3 ρ g z_c / E\* of its centroid's height z_c = 3h/8. Half of an ellipsoid sheared by s has s h / πR less of its
/// volume above the middle of its base. Skin and fat hold a part of it.
#[test]
fn a_standing_implant_sags_and_a_lying_one_is_lower() {
    let mut last = 0.0;
    for fill in [Fill::FormStable, Fill::Cohesive, Fill::Soft, Fill::Saline] {
        let [none, lying, standing] = Posture::ALL.map(|posture| solved(Some(fill), posture));
        let share = |of: &Outcome| of.implant_in_body.unwrap().upper_pole_share;
        let height = |of: &Outcome| of.implant_in_body.unwrap().height_mm;
        assert!((share(&none) - 0.5).abs() < 1e-9 && (share(&lying) - 0.5).abs() < 1e-9);
        let scene = plan(Some(fill), Posture::Standing);
        let (radius, h) = (scene.implant.base_radius_mm, scene.implant.projection_mm);
        let shear = 3.0 * WEIGHT * (3.0 / 8.0 * h) / fill.modulus_kpa(radius);
        let (lost, bare) = (share(&none) - share(&standing), shear * h / (PI * radius));
        assert!(lost > last && lost < bare && lost > 0.3 * bare, "{fill:?} {lost} {bare}");
        assert!(height(&lying) < height(&none));
        assert!(standing.solver.nodes_solved > none.solver.nodes_solved);
        last = lost;
    }
}

#[test]
fn files_have_postures_by_name() {
    let of = |posture: &str| {
        let text = format!(
            "{{\"implant\": {{\"base_radius_mm\": 60, \"projection_mm\": 40}}, \"posture\": {posture}}}"
        );
        Scene::from_json(&text).map_err(|error| error.to_string())
    };
    for (name, posture) in
        [("none", Posture::None), ("lying", Posture::Lying), ("standing", Posture::Standing)]
    {
        let scene = of(&format!("\"{name}\"")).unwrap();
        assert_eq!(scene.body.posture, posture);
        assert_eq!(scene.to_json().contains("posture"), posture != Posture::None);
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    }
    for wrong in ["null", "\"upright\"", "1"] {
        assert!(of(wrong).unwrap_err().contains("posture"), "{wrong}");
    }
}
