use super::*;
use crate::mesh::NodeKind;
use crate::scene::ChestShape;

/// A scene with a wall of these heights, 5 mm apart.
fn scene(columns: usize, height: impl Fn(DVec2) -> f64) -> Scene {
    let half = 0.5 * (columns - 1) as f64;
    let place =
        |k: usize| DVec2::new((k % columns) as f64 - half, (k / columns) as f64 - half) * 5.0;
    let heights_mm = (0..columns * columns).map(|k| Some(height(place(k)))).collect();
    let grid = HeightsGrid { spacing_mm: 5.0, columns, rows: columns, heights_mm, smooth_mm: 0.0 };
    Scene { chest_grid: Some(ChestGrid { grid }), ..Scene::default() }
}

fn sphere(radius: f64) -> impl Fn(DVec2) -> f64 {
    move |at| Chest::Curved { across_mm: radius, along_mm: radius }.height(at)
}

#[test]
fn a_grid_is_read_and_written_and_is_the_wall() {
    let round = scene(51, sphere(150.0));
    let text = round.to_json();
    assert_eq!(text.matches("\"chest\"").count(), 1);
    assert_eq!(Scene::from_json(&text), Ok(round.clone()));
    let problem = round.problem().unwrap();
    let radii = ChestShape { radius_across_mm: 150.0, radius_along_mm: Some(150.0) };
    let exact = Scene { chest: Some(radii), ..Scene::default() }.problem().unwrap();
    assert!(
        problem.mirrored() == [true; 2] && problem.obstacle.dome.chest == problem.obstacle.wall.0
    );
    // Nodes outside of the patch stand where the sphere is steep.
    let kinds = problem.sheet().kinds().iter();
    let within: Vec<bool> = kinds.map(|kind| *kind != NodeKind::Outside).collect();
    for layer in 0..problem.rest.layers() {
        let pairs = problem.rest.nodes(layer).zip(exact.rest.nodes(layer)).zip(&within);
        for ((found, exact), _) in pairs.filter(|(_, within)| **within) {
            assert!(found.distance(exact) < 2e-3, "{found} {exact}");
        }
    }
    assert!(!round.same_physics(&Scene::default()));
    assert_eq!(round.chest_warnings(&problem.obstacle.wall.0), [""; 0]);
    let tilted = scene(51, |at| sphere(150.0)(at) + 0.1 * at.x);
    let wall = tilted.problem().unwrap().obstacle.wall.0;
    let [warning] = &*tilted.chest_warnings(&wall) else { panic!("one line") };
    assert!(warning.starts_with("The grid of the chest is tilted by 6°"), "{warning}");
}

#[test]
fn a_wall_that_carries_no_tissue_is_one_line() {
    let line = |scene: &Scene| {
        let line = scene.validate().unwrap_err().to_string();
        assert!(!line.contains('\n') && line.len() < 160, "{line}");
        line
    };
    let round = scene(51, sphere(150.0));
    let with = |edit: &dyn Fn(&mut HeightsGrid)| {
        let mut scene = round.clone();
        edit(&mut scene.chest_grid.as_mut().unwrap().grid);
        line(&scene)
    };
    for (found, expected) in [
        (
            with(&|grid| grid.spacing_mm = 0.2),
            "chest.grid.spacing_mm is 0.2; allowed: 0.5 to 50 mm",
        ),
        (with(&|grid| grid.columns = 3), "chest.grid.columns is 3; allowed: 4 to 257"),
        (
            with(&|grid| grid.rows = 50),
            "chest.grid.heights_mm is a list of 2601; allowed: 2550 numbers",
        ),
        (
            with(&|grid| grid.heights_mm = [Some(f64::NAN); 2601].into()),
            "chest.grid.heights_mm[0] is NaN; allowed: -1000 to 1000 mm",
        ),
        (
            line(&scene(31, sphere(150.0))),
            "chest.grid.heights_mm is known over 56 % of the simulated tissue; allowed: 60 % or more",
        ),
        (line(&scene(51, |at| -at.x * at.x / 20.0)), "chest.grid is steep by "),
        (
            line(&scene(61, |at| 0.6 * at.x)),
            "chest.grid is tilted by 31° at the pocket's centre; allowed: up to 20°",
        ),
        // Steep only where the grid's margin goes on.
        (line(&scene(21, |at| -at.x.powi(4) / 5e5)), "chest.grid.heights_mm is known over "),
        (line(&scene(61, |at| 3.0 * (0.3 * at.x).cos())), "chest.grid is hollow with a radius of "),
        (
            line(&scene(61, |at| -40.0 * (-(at - 40.0).length_squared() / 800.0).exp())),
            "chest.grid is ",
        ),
    ] {
        assert!(found.starts_with(expected), "{found}");
    }
    let mut both = round.clone();
    both.chest = Some(ChestShape::USUAL);
    assert!(line(&both).starts_with("chest: both radii and a grid"));
    let text = round.to_json().replacen("\"grid\"", "\"radius_across_mm\": 140, \"grid\"", 1);
    let error = Scene::from_json(&text).unwrap_err().to_string();
    assert!(error.starts_with("chest: both radii and a grid"), "{error}");
}

/// A hollow is deep or not by the tissue in it.
#[test]
fn the_limit_of_a_hollow_is_that_of_the_tissue_at_its_place() {
    let dent = |at: DVec2| -9.0 * (-(at - DVec2::new(60.0, 0.0)).length_squared() / 400.0).exp();
    let with_factor = |there: f64| {
        let mut scene = scene(61, dent);
        scene.layers[1].thickness_mm = 20.0;
        let factor = |k: usize| if k % 61 > 30 { there } else { 1.0 };
        scene.thickness_field = Some(crate::scene::ThicknessGrid {
            spacing_mm: 5.0,
            columns: 61,
            rows: 61,
            factors: (0..61 * 61).map(factor).collect(),
        });
        scene
    };
    assert_eq!(with_factor(0.5).validate(), Ok(()));
    let error = with_factor(1.0).validate().unwrap_err().to_string();
    assert!(error.starts_with("chest.grid is hollow with a radius of "), "{error}");
    assert!(error.ends_with("times the tissue there; chest.grid.smooth_mm 6 would do"), "{error}");
}

#[test]
fn smoothing_keeps_planes_flattens_waves_and_is_said() {
    let thick = |height: &dyn Fn(DVec2) -> f64| {
        let mut scene = scene(61, height);
        scene.layers[1].thickness_mm = 20.0;
        scene
    };
    let smoothed = |height: &dyn Fn(DVec2) -> f64| {
        let mut scene = thick(height);
        scene.chest_grid.as_mut().unwrap().grid.smooth_mm = 6.0;
        scene
    };
    let heights = |scene: &Scene| scene.chest_grid.as_ref().unwrap().grid.whole().unwrap();
    let plane = smoothed(&|at| 0.03 * at.x - 0.02 * at.y + 1.0);
    for (after, before) in
        heights(&plane).iter().zip(&*plane.chest_grid.clone().unwrap().grid.heights_mm)
    {
        assert!((after - before.unwrap()).abs() < 1e-12);
    }
    // A Gaussian mean lowers a wave cos(kx) by exp(-k²σ²/2).
    let wave = smoothed(&|at| 1.5 * (0.2 * at.x).cos());
    let middle = heights(&wave)[30 * 61 + 30];
    assert!((middle - 1.5 * (-0.5_f64 * 1.44).exp()).abs() < 5e-3, "{middle}");
    assert!(thick(&|at| 1.5 * (0.2 * at.x).cos()).validate().is_err());
    assert_eq!(wave.validate(), Ok(()));
    assert_eq!(Scene::from_json(&wave.to_json()), Ok(wave.clone()));
    let wall = wave.problem().unwrap().obstacle.wall.0;
    let said = "The heights of the chest are smoothed by 6 mm; they moved by up to 0.8 mm.";
    assert_eq!(wave.chest_warnings(&wall), [said]);
    let mut wrong = wave;
    wrong.chest_grid.as_mut().unwrap().grid.smooth_mm = 21.0;
    let error = wrong.validate().unwrap_err().to_string();
    assert_eq!(error, "chest.grid.smooth_mm is 21; allowed: 0 to 20 mm");
}
