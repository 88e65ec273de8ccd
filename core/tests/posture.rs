//! Postures: the weight of an implant that yields, and the change of the tissue's.
#![allow(clippy::unwrap_used)]
#![allow(clippy::float_cmp, reason = "equal to the last bit")]

use implant_preview_core::measure::{Outcome, Status};
use implant_preview_core::scene::{Fill, Posture, Scene};
use implant_preview_core::simulate::simulate;
use implant_preview_core::solve::{Method, Solver, Verdict};
use std::f64::consts::PI;

/// Weight per volume of gel \[kPa/mm\].
const WEIGHT: f64 = 970.0 * 9.81e-6;
/// The same of tissue.
const TISSUE_WEIGHT: f64 = 980.0 * 9.81e-6;

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
fn standing_as_it_was_measured_the_tissue_stays() {
    let [none, _, standing] = Posture::ALL.map(|posture| solved(None, posture));
    assert_eq!(none.contact_force_n, standing.contact_force_n);
    assert_eq!(none.profile_skin, standing.profile_skin);
    assert_eq!(none.solver.nodes_solved, standing.solver.nodes_solved);
}

/// Lying, a rigid implant bears the tissue over its contact and a part of that over the void beside it. The tissue, measured as it hung, moves towards
/// the head, thick tissue by more, and is lower.
#[test]
fn a_lying_implant_bears_the_tissue_over_it() {
    let mut last = 0.0;
    for fat_mm in [10.0, 20.0, 40.0] {
        let [none, lying] = [Posture::None, Posture::Lying].map(|posture| {
            let mut scene = plan(None, posture);
            scene.layers[1].thickness_mm = fat_mm;
            let found = simulate(&scene).unwrap();
            assert_eq!(found.status, Status::Converged);
            found
        });
        let scene = plan(None, Posture::None);
        let thickness_mm = scene.layers[0].thickness_mm + fat_mm;
        let [before, after] = [&none, &lying].map(|of| of.contact_force_n.unwrap());
        let contact_mm2 = 1e3 * before / none.contact_pressure_kpa.unwrap().mean;
        let pocket_mm2 = PI * scene.pocket_radius_mm.powi(2);
        let weight = |area: f64| 1e-3 * TISSUE_WEIGHT * area * thickness_mm;
        let [least, most] = [contact_mm2, pocket_mm2].map(weight);
        let borne = after - before;
        assert!(least < borne && borne < most, "{fat_mm}: {least} {borne} {most}");
        let up = |of: &Outcome| of.profile_skin_y[20].r_mm;
        let shift = up(&lying) - up(&none);
        assert!(shift > last, "{fat_mm}: {shift}");
        assert!(lying.skin_projection_mm < none.skin_projection_mm);
        last = shift;
    }
}

/// Multigrid against Newton's method from its shape: the weight acts on every face in both, beside a natural tension too, and tissue that it presses on
/// the flat wall slides there. With the weight left out of a face their forces differ by 1 to 3 %.
#[test]
fn both_methods_have_the_same_forces_of_lying_tissue() {
    for (fill, chest, tension) in [
        (None, false, 0.0),
        (Some(Fill::Cohesive), false, 0.0),
        (Some(Fill::Saline), false, 20.0),
        (None, true, 40.0),
        (Some(Fill::Cohesive), true, 0.0),
    ] {
        let mut scene = plan(fill, Posture::Lying);
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-5);
        scene.body.skin_state.natural_tension_n_per_m = tension;
        if !chest {
            scene.set_chest(None);
        }
        let mut multigrid = Solver::new(scene.problem().unwrap());
        multigrid.advance(&mut || false);
        let newton = multigrid.refined(1e-7, 1.0);
        let by = [&multigrid, &newton].map(|of| (of.verdict(), of.report().method, of.attempts()));
        let all = format!("{fill:?} {chest} {tension}: {by:?}");
        assert!(by.iter().all(|by| by.0 == Verdict::Converged && by.2 == 1), "{all}");
        assert!([0, 1].map(|k| by[k].1 == Method::Newton) == [false, true], "{all}");
        let [one, other] = [&multigrid, &newton].map(Solver::solution);
        let apart = one.membrane().iter().zip(other.membrane()).map(|(a, b)| a.distance(*b));
        let apart = apart.fold(0.0, f64::max) / scene.implant.base_radius_mm;
        let [a, b] = [&one, &other].map(|of| of.reactions().force.iter().sum::<f64>());
        assert!(
            apart < 2e-5 && (a / b - 1.0).abs() < 2e-4,
            "{all}: {apart:.1e} {:.1e}",
            a / b - 1.0
        );
    }
}

/// A standing body shears and gets thinner above. The energy of small strains of half of an ellipsoid, base radius R and height h, sheared by s and tilted by τ
/// (z_c = 3h/8 and h²/5 the means of z and z²) is least at
///
/// ```text
/// τ = (g/R) (2R²/5 − z_c²)/(4R²/5 + h²/5 − z_c²),   s = (g − τ/R) z_c,   g = 3 ϱ g / E*
/// ```
///
/// so that a bare body has s h/πR + 3τ/8 less of its volume above the middle of its base. Skin and fat hold a part of it.
#[test]
fn a_standing_implant_sags_and_a_lying_one_is_lower() {
    let mut last = 0.0;
    for fill in [Fill::FormStable, Fill::Cohesive, Fill::Soft, Fill::Saline] {
        let [none, lying, standing] = Posture::ALL.map(|posture| solved(Some(fill), posture));
        let share = |of: &Outcome| of.implant_in_body.unwrap().upper_pole_share;
        let height = |of: &Outcome| of.implant_in_body.unwrap().height_mm;
        assert!((share(&none) - 0.5).abs() < 1e-9);
        // The tissue over it moves towards the head.
        assert!(share(&lying) > 0.5 && share(&lying) < 0.52, "{fill:?} {}", share(&lying));
        let scene = plan(Some(fill), Posture::Standing);
        let (radius, h) = (scene.implant.base_radius_mm, scene.implant.projection_mm);
        let pull = 3.0 * WEIGHT / fill.modulus_kpa(radius);
        let (middle, squares) = (3.0 / 8.0 * h, [radius * radius, h * h / 5.0]);
        let around = middle * middle;
        let bent = (0.4 * squares[0] - around) / (0.8 * squares[0] + squares[1] - around);
        let [shear, tilt] = [pull * (1.0 - bent) * middle, pull * bent * radius];
        let bare = shear * h / (PI * radius) + 3.0 / 8.0 * tilt;
        let lost = share(&none) - share(&standing);
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
