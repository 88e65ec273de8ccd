use super::*;
use implant_preview_core::body::deform::{Weights, deform};
use implant_preview_core::body::fit::fit;
use implant_preview_core::body::marks::Side;
use implant_preview_core::body::read::Unit;
use implant_preview_core::measure::{Field, Fields};
use implant_preview_core::scene::{CheckedScene, Scene};
use implant_preview_core::simulate::run;
use implant_preview_core::solve::Options;
use std::collections::HashSet;

fn solved(mut scene: Scene, insertion: f64) -> Fields {
    scene.insertion = insertion;
    scene.solver.nodes_per_side = 33;
    let scene = CheckedScene::new(scene).unwrap();
    Fields::new(run(&scene, Options::default(), None).solution)
}

fn fields(insertion: f64) -> Fields {
    solved(Scene::default(), insertion)
}

fn positions(torso: &Torso, fields: &Fields) -> Vec<Vec3> {
    drawn(torso, fields).vertices.iter().map(position).collect()
}

fn drawn(torso: &Torso, fields: &Fields) -> Mesh {
    let attached = &torso.attached(fields.solution().problem(), None);
    torso.mesh(&[Shape { attached, fields, toward: None }], None, Vec::new())
}

#[test]
fn without_an_implant_the_torso_stays_and_with_one_both_breasts_rise_alike() {
    let torso = Torso::new().unwrap();
    let [flat, full] = [0.0, 1.0].map(|insertion| positions(&torso, &fields(insertion)));
    let rest: Vec<Vec3> = torso.before.vertices.iter().map(position).collect();
    let greatest =
        |of: &[Vec3]| of.iter().zip(&rest).map(|(a, b)| a.distance(*b)).fold(0.0, f32::max);
    assert!(greatest(&flat) < 0.05, "{}", greatest(&flat));
    assert!((15.0..70.0).contains(&greatest(&full)), "{}", greatest(&full));
    // Away from the patches every vertex stays to the last bit.
    let moved: HashSet<u32> = torso.points.iter().map(|point| point.vertex).collect();
    for (k, (at, rest)) in full.iter().zip(&rest).enumerate() {
        assert!(moved.contains(&(k as u32)) || at == rest);
    }
    let rise = |side: usize| {
        let way = |p: &Point| full[p.vertex as usize].distance(rest[p.vertex as usize]);
        torso.points.iter().filter(|p| p.side == side).map(way).fold(0.0, f32::max)
    };
    assert!((rise(0) - rise(1)).abs() < 0.01 * rise(0), "{} {}", rise(0), rise(1));
}

/// The normals of neighbours across the patch's border turn by no more than those of the torso at rest, and 2°.
#[test]
fn the_skin_passes_the_border_of_the_patch_without_a_seam() {
    let torso = Torso::new().unwrap();
    let full = fields(1.0);
    let full = drawn(&torso, &full);
    let normal = |v: &Vertex| Vec3::new(v[3], v[4], v[5]);
    let of = |side| torso.points.iter().filter(move |point| point.side == side);
    let other: HashSet<u32> = of(1).map(|point| point.vertex).collect();
    let turned = of(0).filter(|p| {
        p.place.truncate().length() > 118.0 && p.share > 0.99 && !other.contains(&p.vertex)
    });
    let turn = |p: &Point| {
        let [rest, now] =
            [&torso.before.vertices, &full.vertices].map(|of| normal(&of[p.vertex as usize]));
        rest.angle_between(now).to_degrees()
    };
    let turned: Vec<f32> = turned.map(turn).collect();
    assert!(turned.len() > 40, "{}", turned.len());
    let greatest = turned.iter().copied().fold(0.0, f32::max);
    assert!(greatest < 2.0, "{greatest}");
}

/// The greatest turn of the drawn normals \[°\] on the triangles that the edge of the tissue crosses, within 10 mm of the edge, of a plan on the
/// built-in torso.
fn turn_across_the_edge(scene: Scene) -> f32 {
    let torso = Torso::of_torso(&scene.fitted_torso().unwrap().unwrap());
    let full = solved(scene, 1.0);
    let now = drawn(&torso, &full);
    let attached = torso.attached(full.solution().problem(), None);
    let mut from_edge = vec![0.0_f64; now.vertices.len()];
    for moved in &attached.moved {
        let weights = moved.weights.as_ref().map_or(0.0, Weights::from_edge_mm);
        from_edge[moved.vertex as usize] += weights;
    }
    let crosses = |triangle: &&[u32; 3]| {
        // Beside skin far from the edge stays what lies below the wall.
        let of = triangle.map(|k| from_edge[k as usize]);
        let is_out = of.map(|mm| mm <= 0.0);
        is_out.contains(&true) && is_out.contains(&false) && of.iter().all(|mm| *mm < 15.0)
    };
    let crossed: HashSet<u32> =
        now.indices.as_chunks::<3>().0.iter().filter(crosses).flatten().copied().collect();
    assert!(crossed.len() > 100, "{}", crossed.len());
    let normal = |of: &[Vertex], k: u32| Vec3::from_slice(&of[k as usize][3..6]);
    let turn = |k: u32| normal(&torso.before.vertices, k).angle_between(normal(&now.vertices, k));
    let near = crossed.into_iter().filter(|k| from_edge[*k as usize] < 10.0);
    near.map(turn).fold(0.0, f32::max).to_degrees()
}

/// Round and anatomical, 300 ml, on the usual woman, and on five others.
#[test]
fn the_drawn_torso_of_any_tape_has_no_seam_at_the_edge_of_the_tissue() {
    let on = |torso: scene::Torso| {
        let mut scene = Scene::opening();
        scene.set_torso(torso);
        scene.implant.projection_mm = 39.8;
        scene
    };
    let usual = on(scene::Torso::default());
    let mut anatomical = usual.clone();
    anatomical.implant.base_height_mm = Some(108.0);
    anatomical.implant.apex_shift_mm = 12.0;
    anatomical.implant.projection_mm = 44.2;
    let others = (1..6).map(|k| {
        // Numbers without gaps between 0 and 1.
        let part = |step: f64| (f64::from(k) * step).fract();
        on(scene::Torso {
            chest_width_mm: 235.0 + 65.0 * part(0.8567),
            breast_width_mm: 120.0 + 25.0 * part(0.7339),
            notch_nipple_mm: 190.0 + 45.0 * part(0.6287),
            nipple_fold_mm: None,
            nipple_nipple_mm: 195.0 + 40.0 * part(0.5386),
            breast_volume_ml: 100.0 + 350.0 * part(0.4614),
        })
    });
    let scenes = [usual, anatomical].into_iter().chain(others);
    let turns: Vec<f32> = scenes.map(turn_across_the_edge).collect();
    assert!(turns.iter().all(|turn| *turn < 2.0), "{turns:?}");
}

/// Her own body: drawn as `deform` makes it, on either side.
#[test]
fn a_fitted_body_is_drawn_as_it_is_deformed() {
    let torso::Torso { surface, marks } = torso::builtin();
    for side in [Side::Left, Side::Right] {
        let settings = Settings::default();
        let fitted = fit(&surface, &marks, side, &settings).unwrap();
        let scene = Scene::of_body(&fitted, (&marks, side), settings.cover_mm, Unit::Mm).unwrap();
        let full = solved(scene, 1.0);
        let torso = Torso::of_body(&surface, &[fitted.frame], &marks).unwrap();
        let after = deform(&surface, &fitted.frame, full.solution());
        let now = positions(&torso, &full);
        let (mut apart, mut risen) = (0.0_f32, 0.0_f32);
        for (k, (at, before)) in after.positions.iter().zip(&surface.positions).enumerate() {
            apart = apart.max(now[k].distance(torso.frame.local(*at).as_vec3()));
            risen = risen.max(at.distance(*before) as f32);
            if at == before {
                assert_eq!(now[k], position(&torso.before.vertices[k]), "to the last bit");
            }
        }
        assert!(apart < 1e-3 && risen > 15.0, "{apart} {risen}");
        // The normals are those of all triangles.
        let mesh = drawn(&torso, &full);
        let mut all = mesh.vertices.clone();
        let triangles = mesh.indices.as_chunks::<3>().0;
        let mut normals = vec![Vec3::Z; all.len()];
        turn(&mut normals, &all, triangles, 0..all.len());
        soften(&mut all, &normals, triangles, 0..normals.len());
        for (own, all) in mesh.vertices.iter().zip(&all) {
            let [own, all] = [own, all].map(|v| Vec3::new(v[3], v[4], v[5]));
            assert!(own.distance(all) < 1e-4, "{own} {all}");
        }
        let (_, middle, azimuth) = torso.seen();
        let across = middle + Vec3::new(40.0 * azimuth.cos(), 0.0, 40.0 * azimuth.sin());
        let front = Vec3::new(azimuth.sin(), 0.0, azimuth.cos());
        let ray = Ray { origin: across + 900.0 * front, direction: -front };
        let found = torso.picked(&ray).expect("the body is in front of the eye");
        assert!(found.distance(ray.origin) < 900.0, "{found}");
    }
}

/// The torso as a plan's chest: the left side is drawn as `deform` makes it, the right one as its image in the midplane.
#[test]
fn a_torso_as_a_chest_is_drawn_as_it_is_deformed_and_mirrored() {
    let mut scene = Scene::opening();
    scene.set_torso(scene::Torso::default());
    let fitted = scene.fitted_torso().unwrap().unwrap();
    let full = solved(scene, 1.0);
    let torso = Torso::of_torso(&fitted);
    let surface = &fitted.shaped.torso.surface;
    let after = deform(surface, &fitted.fit.frame, full.solution());
    let now: Vec<DVec3> =
        positions(&torso, &full).iter().map(|at| torso.frame.point(at.as_dvec3())).collect();
    let key = |at: DVec3| (at * 1e3).round().to_array().map(|x| x as i64);
    let places: std::collections::HashMap<[i64; 3], usize> =
        surface.positions.iter().enumerate().map(|(k, at)| (key(*at), k)).collect();
    let mut risen = 0.0_f64;
    for (k, before) in surface.positions.iter().enumerate() {
        // The other patch ends 6 cm beside the midline.
        if before.x > 70.0 {
            let apart = now[k].distance(after.positions[k]);
            assert!(apart < 1e-3, "{before} {apart}");
        }
        let mirror = DVec3::new(-1.0, 1.0, 1.0);
        let image = places[&key(*before * mirror)];
        assert!(now[image].distance(now[k] * mirror) < 1e-3, "{before}");
        risen = risen.max(now[k].distance(*before));
    }
    assert!(risen > 15.0, "{risen}");
}

/// Plans of their own: each side moves as its plan alone, on the built-in torso and on her own body.
#[test]
fn each_side_moves_with_its_own_plan() {
    let [small, large] = [0.4, 1.0].map(fields);
    let torso = Torso::new().unwrap();
    let of = |torso: &Torso, shapes: [(&Fields, Option<usize>); 2]| {
        let attached = shapes.map(|(of, side)| torso.attached(of.solution().problem(), side));
        let shape = |k: usize| Shape { attached: &attached[k], fields: shapes[k].0, toward: None };
        torso.mesh(&[shape(0), shape(1)], None, Vec::new())
    };
    let both = of(&torso, [(&small, Some(0)), (&large, Some(1))]);
    let alike = [&small, &large].map(|fields| drawn(&torso, fields));
    for side in [0, 1] {
        // Away from the other side's patch.
        let is_own = |k: &u32| torso.points.iter().all(|p| p.vertex != *k || p.side == side);
        let own: Vec<u32> = torso.points.iter().map(|p| p.vertex).filter(is_own).collect();
        assert!(own.len() > 500, "{}", own.len());
        for k in own {
            let [a, b] = [&both, &alike[side]].map(|mesh| position(&mesh.vertices[k as usize]));
            assert!(a.distance(b) < 1e-4, "{side} {a} {b}");
        }
    }
    // Where both patches overlap, a vertex has the colour of the nearer pocket's side.
    let coloured = |fields: [&Fields; 2]| {
        let attached = [0, 1].map(|k| torso.attached(fields[k].solution().problem(), Some(k)));
        let shape = |k: usize| Shape { attached: &attached[k], fields: fields[k], toward: None };
        torso.mesh(&[shape(0), shape(1)], Some(Field::PrincipalStrain), Vec::new()).vertices
    };
    let (mixed, of_small) = (coloured([&small, &large]), coloured([&small, &small]));
    let on_left = |k: usize| position(&torso.before.vertices[k]).x > torso.middle.x + 1.0;
    let left: Vec<usize> = (0..mixed.len()).filter(|k| on_left(*k)).collect();
    let has_small = |k: &&usize| mixed[**k][8].to_bits() == of_small[**k][8].to_bits();
    assert!(left.iter().all(|k| has_small(&k)) && left.len() > 1000, "{}", left.len());
    let differing = (0..mixed.len()).filter(|k| !has_small(&k)).count();
    assert!(differing > 500, "{differing}");
    // Of her own body a plan of one side moves that side alone.
    let torso::Torso { surface, marks } = torso::builtin();
    let settings = Settings::default();
    let fits =
        [Side::Left, Side::Right].map(|side| fit(&surface, &marks, side, &settings).unwrap());
    let frames = fits.each_ref().map(|fit| fit.frame);
    let hers = |k: usize, insertion| {
        let of = (&marks, [Side::Left, Side::Right][k]);
        solved(Scene::of_body(&fits[k], of, settings.cover_mm, Unit::Mm).unwrap(), insertion)
    };
    let (large, small) = (hers(0, 1.0), hers(1, 0.4));
    let hers = Torso::of_body(&surface, &frames, &marks).unwrap();
    let one = positions(&hers, &large);
    let both = of(&hers, [(&large, Some(0)), (&small, Some(1))]);
    let nipples = marks.nipples.map(|at| hers.frame.local(at).as_vec3());
    let rise = |at: &[Vec3], nipple: Vec3| {
        let near = hers.before.vertices.iter().map(position).zip(at);
        near.filter(|(before, _)| before.distance(nipple) < 20.0)
            .map(|(before, at)| before.distance(*at))
            .fold(0.0, f32::max)
    };
    let both: Vec<Vec3> = both.vertices.iter().map(position).collect();
    let [left, right] = nipples.map(|nipple| [rise(&one, nipple), rise(&both, nipple)]);
    assert!(left[0] > 12.0 && (left[0] - left[1]).abs() < 1.0, "{left:?}");
    assert!(right[0] < 1.0 && (3.0..0.8 * left[1]).contains(&right[1]), "{right:?}");
}
