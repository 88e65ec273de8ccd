//! The plane of the pocket: the muscle over the implant, whole and in part.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::{DVec2, DVec3};
use implant_preview_core::curve::Curve;
use implant_preview_core::measure::{Outcome, SolverMethod, Status};
use implant_preview_core::mesh::{NodeKind, Rest, Sheet, Taper};
use implant_preview_core::scene::{CheckedScene, Plane, Scene};
use implant_preview_core::simulate::{self, Simulation};
use implant_preview_core::solve::{Method, Options, Problem, Solver, Verdict};
use implant_preview_lab::axisymmetric_layers::{self, Input};
use serde_json::{Value, json};

/// The opening plan in a plane, over a flat or its curved chest.
fn plan(plane: Option<Plane>, is_flat: bool, nodes: usize) -> Scene {
    let mut scene = Scene::opening();
    if is_flat {
        scene.set_chest(None);
    }
    scene.set_plane(plane);
    scene.solver.nodes_per_side = nodes;
    scene
}

fn solved(scene: &Scene) -> Simulation {
    simulate::run(&CheckedScene::new(scene.clone()).unwrap(), Options::default(), None)
}

fn outcome(scene: &Scene) -> Outcome {
    let found = solved(scene).outcome;
    assert_eq!((found.status, found.solver.method), (Status::Converged, SolverMethod::Multigrid));
    found
}

/// Greatest distance of the nodes within the patch of two shapes, in all layers and of the skin \[mm\].
fn apart(one: &Solver, other: &Solver) -> [f64; 2] {
    let kinds = one.problem().sheet().kinds();
    let greatest = |a: &[DVec3], b: &[DVec3]| {
        let within = (0..kinds.len()).filter(|&k| kinds[k] != NodeKind::Outside);
        within.map(|k| a[k].distance(b[k])).fold(0.0, f64::max)
    };
    let outer = || one.outer().iter().zip(other.outer());
    let all = outer().map(|(a, b)| greatest(a, b)).fold(0.0, f64::max);
    let [a, b] = [one, other].map(|of| of.outer().last().unwrap());
    [all.max(greatest(one.positions(), other.positions())), greatest(a, b)]
}

fn solve(problem: Problem, method: Method) -> Solver {
    let mut solver = Solver::with_options(problem, Options { method, ..Options::default() });
    solver.advance(&mut || false);
    solver
}

/// An edge of a muscle of 5 kPa under fat of 2.
fn edge(at_mm: f64) -> Taper {
    Taper { at_mm, width_mm: 15.0, modulus_above: 0.4 }
}

/// The tissue of a problem with another edge of its innermost layer.
fn with_taper(mut problem: Problem, taper: Taper) -> Problem {
    problem.rest = problem.rest.tapered(Some(taper));
    problem
}

#[test]
fn below_the_muscle_the_result_is_that_of_the_axisymmetric_layers() {
    for (is_flat, chest) in [(true, None), (false, Some(150.0))] {
        let mut scene = plan(Some(Plane::Below), is_flat, 129);
        scene.chest = chest.map(|radius| implant_preview_core::scene::ChestShape {
            radius_across_mm: radius,
            radius_along_mm: Some(radius),
        });
        let problem = scene.problem().unwrap();
        let meshes = [[72, 6], [144, 12]].map(|cells| {
            axisymmetric_layers::solve(&Input::of(&scene, &problem, cells).unwrap()).unwrap()
        });
        let limit = |of: &dyn Fn(&axisymmetric_layers::Solution) -> f64| {
            let [coarse, fine] = [&meshes[0], &meshes[1]].map(of);
            fine + (fine - coarse) / 3.0
        };
        let found = outcome(&scene);
        let force = found.contact_force_n.unwrap() / limit(&|of| of.contact_force_n) - 1.0;
        let apart = found.profile_skin.iter().enumerate().map(|(k, point)| {
            let [r, z] = [0, 1].map(|axis| limit(&|of| of.skin[k][axis]));
            (point.r_mm - r).hypot(point.z_mm - z) / scene.implant.base_radius_mm
        });
        let skin = apart.fold(0.0, f64::max);
        assert!(force.abs() < 0.01 && skin < 1.5e-3, "{chest:?}: {force}, {skin} R");
    }
}

/// The heights of the layers of nodes: where the muscle ends, its cells are the inner half of the fat.
#[test]
fn the_fat_keeps_its_thickness_where_the_muscle_ends() {
    let (muscle, fat) = (8.0, 8.5);
    let taper = edge(-20.0);
    let rest = Rest::layered(Sheet::new(33, 130.0), &[muscle, fat], 4).tapered(Some(taper));
    assert_eq!(rest.mirrored(), [true, false]);
    for rest in [rest.coarser().unwrap(), rest] {
        let outer = rest.layers() - 1;
        let kinds = rest.sheet().kinds();
        for k in (0..kinds.len()).filter(|&k| kinds[k] == NodeKind::Free) {
            let place = rest.sheet().rest()[k];
            let share = taper.share(DVec2::new(place.x, place.y));
            let heights: Vec<f64> = (0..=outer).map(|layer| rest.node(layer, k).z).collect();
            assert!(heights.windows(2).all(|pair| pair[0] < pair[1]), "{heights:?}");
            assert!((heights[outer] - (muscle * share + fat)).abs() < 1e-12);
            let cells = muscle * share + (1.0 - share) * 0.5 * fat;
            assert!((heights[2] - cells).abs() < 1e-12);
        }
    }
}

/// An edge beyond the patch is no edge, a whole muscle whose cells have shapes of their own gives the whole one.
#[test]
fn an_edge_beyond_the_patch_changes_nothing() {
    for is_flat in [true, false] {
        let mut scene = plan(Some(Plane::Below), is_flat, 33);
        scene.solver.tolerance = 1e-5;
        let whole = scene.problem().unwrap();
        let far = with_taper(whole.clone(), edge(-400.0));
        assert!(!far.rest.is_even());
        let [whole, far] = [whole, far].map(|problem| solve(problem, Method::Automatic));
        assert_eq!([whole.verdict(), far.verdict()], [Verdict::Converged; 2]);
        let [all, skin] = apart(&whole, &far).map(|apart| apart / 60.0);
        // Cells on the patch's circle are stabilised otherwise in uneven tissue, with a muscle or without.
        let most = if is_flat { 1e-4 } else { 1e-5 };
        assert!(all < most && skin < most, "{all:e}, skin {skin:e}");
    }
}

/// Where the muscle has ended the tissue is that without one.
#[test]
fn beyond_its_edge_the_muscle_is_none() {
    for is_flat in [true, false] {
        let above = plan(None, is_flat, 65);
        let beyond = plan(Some(Plane::Below), is_flat, 65).problem().unwrap();
        let beyond = solve(with_taper(beyond, edge(400.0)), Method::Automatic);
        let above = solve(above.problem().unwrap(), Method::Automatic);
        let force = |of: &Solver| of.solution().reactions().force.iter().sum::<f64>();
        let difference = force(&beyond) / force(&above) - 1.0;
        let [beyond, above] = [&beyond, &above].map(|of| of.outer().last().unwrap());
        let kinds = plan(None, is_flat, 65).problem().unwrap().sheet().kinds().to_vec();
        let within = (0..kinds.len()).filter(|&k| kinds[k] != NodeKind::Outside);
        let apart = within.map(|k| beyond[k].distance(above[k])).fold(0.0, f64::max);
        assert!(difference.abs() < 0.005 && apart < 0.1, "{difference}, {apart} mm");
    }
}

/// The forces of the multigrid solutions in f32 lanes against the energy in f64.
#[test]
fn the_work_of_the_force_is_the_energy_in_a_dual_plane() {
    // Gauss's rule, exact for polynomials of degree 9.
    const GAUSS: [(f64, f64); 5] = [
        (0.046_910_077_030_668, 0.118_463_442_528_095),
        (0.230_765_344_947_158, 0.239_314_335_249_683),
        (0.5, 0.284_444_444_444_444),
        (0.769_234_655_052_842, 0.239_314_335_249_683),
        (0.953_089_922_969_332, 0.118_463_442_528_095),
    ];
    for (plane, is_flat) in [(Plane::DualPlaneIi, true), (Plane::DualPlaneIii, false)] {
        let plan = plan(Some(plane), is_flat, 65);
        let inserted = |insertion: f64| solved(&Scene { insertion, ..plan.clone() });
        let force = |insertion| inserted(insertion).outcome.contact_force_n.unwrap();
        let work: f64 = GAUSS.iter().map(|(at, weight)| weight * force(*at)).sum();
        // N·mm = mJ.
        let energy = 1e-3 * inserted(1.0).solution.elastic_energy();
        let figure = work * plan.implant.projection_mm / energy - 1.0;
        assert!(figure.abs() < 1e-3, "{plane:?}: {figure:e}");
    }
}

/// The further down the muscle reaches the greater are force and cover; the cover without the muscle hardly changes.
#[test]
fn the_more_muscle_the_more_force_and_cover() {
    let planes = std::iter::once(None).chain(Plane::ALL.map(Some));
    let found: Vec<Outcome> = planes.map(|plane| outcome(&plan(plane, false, 65))).collect();
    let force = |of: &Outcome| of.contact_force_n.unwrap();
    // Below the fold the skin is lower by the muscle's thickness in the dual plane I.
    assert!(found[..4].windows(2).all(|pair| force(&pair[0]) < force(&pair[1])));
    assert!((force(&found[3]) / force(&found[4]) - 1.0).abs() < 0.03);
    assert!(found[0].cover_mm.unwrap().without_muscle.is_none());
    let above = found[0].cover_mm.unwrap();
    for of in &found[1..] {
        let (cover, thin) = (of.cover_mm.unwrap(), of.cover_mm.unwrap().without_muscle.unwrap());
        assert!(thin.apex <= cover.apex && thin.least <= cover.least);
        assert!((thin.apex / above.apex - 1.0).abs() < 0.1, "{thin:?} {above:?}");
    }
    // The muscle ends below the apex in the dual planes I and II, above it in III.
    let of_muscle = |of: &Outcome| {
        let cover = of.cover_mm.unwrap();
        cover.apex - cover.without_muscle.unwrap().apex
    };
    assert!(of_muscle(&found[1]) < 0.5 && found[2..].iter().all(|of| of_muscle(of) > 6.0));
    // What is below the edge, half of the fat or 4 mm, does not count; beside the edge the muscle is thinner by half a millimetre.
    let thinnest = |of: &Outcome| of.layers.last().unwrap().thickness_mm.unwrap().least;
    let least: Vec<f64> = found[1..].iter().map(thinnest).collect();
    assert!(least.iter().all(|thin| *thin > least[3] - 0.6), "{least:?}");
}

#[test]
fn a_plane_of_a_file_adds_its_muscle_and_is_written_with_it() {
    let mut file: Value = serde_json::from_str(&Scene::opening().to_json()).unwrap();
    assert!(file.get("pocket_plane").is_none());
    for (name, plane) in ["dual_3", "dual_2", "dual_1", "below"].into_iter().zip(Plane::ALL) {
        file["pocket_plane"] = json!(name);
        let scene = Scene::from_json(&file.to_string()).unwrap();
        let mut expected = Scene::opening();
        expected.set_plane(Some(plane));
        assert_eq!(scene, expected);
        assert_eq!((scene.layers.len(), &*scene.layers[2].tissue), (3, "muscle"));
        assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
        let mut above = scene.clone();
        above.set_plane(None);
        assert_eq!(above, Scene::opening());
    }
    // The muscle by its two numbers, which the written scene has as its layer.
    let mut by_numbers = file.clone();
    by_numbers["muscle"] = json!({ "thickness_mm": 10, "modulus_kpa": 12 });
    let scene = Scene::from_json(&by_numbers.to_string()).unwrap();
    let curve = Curve::scaled(&scene.layers[2].curve).unwrap();
    assert!((scene.layers[2].thickness_mm - 10.0).abs() < 1e-12);
    assert!((curve.slope(0.0) - 12.0).abs() < 1e-9);
    assert_eq!(Scene::from_json(&scene.to_json()).unwrap(), scene);
    let refused = |muscle: Value, plane: &str| {
        let mut file = file.clone();
        (file["muscle"], file["pocket_plane"]) = (muscle, json!(plane));
        Scene::from_json(&file.to_string()).unwrap_err().to_string()
    };
    for (line, words) in [
        (
            refused(json!({}), "above"),
            "muscle: given without its plane; allowed: with a `pocket_plane` below it",
        ),
        (
            refused(json!({ "thickness_mm": 0 }), "below"),
            "muscle.thickness_mm is 0; allowed: 0.2 to 60",
        ),
        (
            refused(json!({ "modulus_kpa": 2000 }), "dual_1"),
            "muscle.modulus_kpa is 2000; allowed: 0.1 to 1000",
        ),
        (refused(json!(null), "below"), "muscle"),
    ] {
        assert!(line.contains(words) && !line.contains('\n'), "{line}");
    }
    file["pocket_plane"] = json!("above");
    assert_eq!(Scene::from_json(&file.to_string()).unwrap(), Scene::opening());
    file["pocket_plane"] = json!("below");
    // A muscle of the file stays.
    file["layers"] =
        json!([{}, { "tissue": "adipose" }, { "tissue": "muscle", "thickness_mm": 11 }]);
    let own = Scene::from_json(&file.to_string()).unwrap();
    assert!(own.layers.len() == 3 && (own.layers[2].thickness_mm - 11.0).abs() < 1e-12);
    file["layers"] = json!([{}, { "tissue": "muscle" }]);
    let line = Scene::from_json(&file.to_string()).unwrap_err().to_string();
    assert_eq!(
        line,
        "pocket_plane is below the muscle; allowed: with a layer `muscle` under skin and another layer"
    );
    file["pocket_plane"] = json!("subfascial");
    let line = Scene::from_json(&file.to_string()).unwrap_err().to_string();
    assert!(line.contains("plane") && line.contains("dual_2") && !line.contains('\n'), "{line}");
    let sheet = json!({ "tissue_model": "sheet", "pocket_plane": "below", "implant": { "base_radius_mm": 50 } });
    let line = Scene::from_json(&sheet.to_string()).unwrap_err().to_string();
    assert_eq!(line, "pocket_plane is below the muscle; allowed: in layered tissue only");
}
