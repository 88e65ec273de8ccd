//! Fits of torsos with a known chest.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/torso.rs"]
mod torso;

use glam::{DMat3, DVec2, DVec3};
use implant_preview_body::fit::{BodyFit, Settings, fit};
use implant_preview_body::marks::{Marks, Side};
use implant_preview_body::raster::View;
use implant_preview_body::surface::Surface;

/// Projections of breasts of 181, 275 and 395 ml \[mm\].
const PROJECTIONS: [f64; 3] = [41.0, 62.3, 89.5];

fn fitted(surface: &Surface, marks: &Marks, side: Side) -> BodyFit {
    fit(surface, marks, side, &Settings::default()).unwrap()
}

fn average() -> (Surface, Marks) {
    (torso::torso(PROJECTIONS[1], 160, 120), torso::marks(PROJECTIONS[1]))
}

/// Greatest difference of the fields of two fits within a distance from the centre \[mm\].
fn difference(one: &BodyFit, other: &BodyFit, reach_mm: f64) -> f64 {
    let pairs = [
        (&one.skin_mm, &other.skin_mm),
        (&one.bare_mm, &other.bare_mm),
        (&one.wall_mm, &other.wall_mm),
        (&one.thickness_mm, &other.thickness_mm),
    ];
    let of = |(a, b): (&Vec<f64>, &Vec<f64>)| {
        let near = (0..a.len()).filter(|node| one.grid.place(*node).length() <= reach_mm);
        near.map(|node| (a[node] - b[node]).abs()).fold(0.0, f64::max)
    };
    pairs.into_iter().map(of).fold(0.0, f64::max)
}

#[test]
fn the_chest_under_breasts_of_three_sizes_is_found() {
    for projection in PROJECTIONS {
        let (surface, marks) = (torso::torso(projection, 200, 160), torso::marks(projection));
        let bare = torso::torso(0.0, 200, 160);
        let found = fitted(&surface, &marks, Side::Left);
        let (grid, welded) = (found.grid, bare.weld());
        let view = View::new(&bare, &welded, &found.frame, 1.0);
        let exact = view.heights(grid, &view.connected());
        let near: Vec<usize> =
            (0..grid.len()).filter(|&node| grid.place(node).length() <= 60.0).collect();
        let apart = |&node: &usize| found.bare_mm[node] - exact[node];
        let squares: f64 = near.iter().map(|node| apart(node).powi(2)).sum();
        let rms = (squares / near.len() as f64).sqrt();
        let most = near.iter().map(|node| apart(node).abs()).fold(0.0, f64::max);
        let volume = |under: &[f64]| {
            let depth = |node: &usize| found.skin_mm[*node] - under[*node];
            near.iter().map(depth).sum::<f64>() * grid.spacing_mm.powi(2) / 1e3
        };
        let (volume, expected) = (volume(&found.bare_mm), volume(&exact));
        let quality = &found.quality;
        println!(
            "{projection}: rms {rms:.2}, most {most:.2} mm, {volume:.0} of {expected:.0} ml, {quality:?}"
        );
        assert!(rms <= 1.5 && most <= 4.0, "{rms} {most}");
        assert!((volume / expected - 1.0).abs() < 0.06, "{volume} {expected}");
        // The parabola through an ellipse of 156 mm at the middle, which is rounder to the side.
        assert!((125.0..156.0).contains(&quality.radius_across_mm), "{quality:?}");
        assert!((torso::volume_ml(projection) / expected - 1.0).abs() < 0.05);
        assert!(quality.air_ml == 0.0 && quality.holes == 0 && quality.warnings().is_empty());
    }
}

#[test]
fn a_rigid_motion_of_file_and_marks_and_another_unit_give_the_same_fields() {
    let (surface, marks) = average();
    let still = fitted(&surface, &marks, Side::Left);
    let turn = DMat3::from_euler(glam::EulerRot::XYZ, 0.4, -1.9, 2.6);
    let way = DVec3::new(-310.0, 42.0, 1270.0);
    for factor in [1.0, 10.0, 1000.0] {
        let moved = |p: DVec3| (turn * p + way) / factor * factor;
        let positions = surface.positions.iter().map(|p| moved(*p)).collect();
        let surface = Surface { positions, ..surface.clone() };
        let found = fitted(&surface, &marks.mapped(moved), Side::Left);
        let apart = difference(&found, &still, 200.0);
        assert!(apart < 1e-9, "{factor}: {apart:e}");
        assert!(found.frame.origin.distance(moved(still.frame.origin)) < 1e-9);
        let axes = turn * still.frame.axes - found.frame.axes;
        assert!(axes.to_cols_array().iter().all(|x| x.abs() < 1e-11), "{axes}");
    }
}

#[test]
fn a_right_breast_has_the_numbers_of_a_left_one() {
    let (surface, marks) = average();
    let [left, right] = [Side::Left, Side::Right].map(|side| fitted(&surface, &marks, side));
    // The triangles' diagonals are not mirrored: facets of 6 mm, of the breast's border above all.
    let apart = difference(&left, &right, 70.0);
    assert!(apart < 1.0, "{apart}");
    assert!((left.frame.handedness(), right.frame.handedness()) == (1.0, -1.0));
    assert!((left.quality.yaw_degrees + right.quality.yaw_degrees).abs() < 0.5);
    let mirror = DVec3::new(-1.0, 1.0, 1.0);
    let mut mirrored = surface;
    mirrored.positions.iter_mut().for_each(|p| *p *= mirror);
    mirrored.turn();
    let swapped = |marks: Marks| Marks {
        nipples: [marks.nipples[1], marks.nipples[0]],
        breasts: [marks.breasts[1], marks.breasts[0]],
        ..marks
    };
    let found = fitted(&mirrored, &swapped(marks.mapped(|p| p * mirror)), Side::Right);
    let apart = difference(&left, &found, 200.0);
    assert!(apart < 1e-9, "{apart}");
}

#[test]
fn a_surface_that_is_inside_out_is_turned() {
    let (mut surface, marks) = average();
    let found = fitted(&surface, &marks, Side::Left);
    surface.turn();
    let turned = fitted(&surface, &marks, Side::Left);
    assert!(difference(&found, &turned, 200.0) < 1e-9);
    assert_eq!(turned.quality.warnings(), ["Turned round: the surface was inside out."]);
}

#[test]
fn holes_are_filled_and_stray_parts_do_not_count() {
    let (surface, marks) = average();
    let whole = fitted(&surface, &marks, Side::Left);
    let mut torn = surface.clone();
    // Two holes of 30 mm, on the breast and beside it; a stray sheet in front of the breast.
    for at in [DVec2::new(20.0, 30.0), DVec2::new(10.0, -95.0)] {
        torn.triangles.retain(|triangle| {
            let [a, b, c] = surface.corners(*triangle);
            let middle = whole.frame.local((a + b + c) / 3.0);
            middle.z < -60.0 || middle.truncate().distance(at) > 15.0
        });
    }
    let first = torn.positions.len() as u32;
    let corners = [[-20.0, -20.0], [30.0, -10.0], [10.0, 40.0]];
    torn.positions.extend(corners.map(|[x, y]| whole.frame.point(DVec3::new(x, y, 120.0))));
    torn.triangles.push([first, first + 1, first + 2]);
    let found = fitted(&torn, &marks, Side::Left);
    assert_eq!(found.quality.holes, 2);
    let apart = difference(&whole, &found, 90.0);
    // The harmonic function is flatter than the breast.
    assert!(apart < 5.0, "{apart}");
    assert!(found.quality.warnings()[0].starts_with("Holes of the scan up to 40 mm across"));
}

#[test]
fn the_height_field_is_that_of_rays_at_all_nodes() {
    let (surface, marks) = (torso::torso(62.3, 64, 48), torso::marks(62.3));
    let BodyFit { frame, grid, .. } = fitted(&surface, &marks, Side::Left);
    let welded = surface.weld();
    let view = View::new(&surface, &welded, &frame, 1.0);
    let drawn = view.heights(grid, &view.connected());
    let triangles: Vec<[DVec3; 3]> =
        surface.triangles.iter().map(|t| surface.corners(*t).map(|p| frame.local(p))).collect();
    let (mut hits, mut misses) = (0, 0);
    for node in 0..grid.len() {
        let at = grid.place(node);
        // The highest hit of the ray along −z on a triangle that faces outwards (Möller and Trumbore).
        let hit = |[a, b, c]: &[DVec3; 3]| {
            let (u, v, from) = (*b - *a, *c - *a, at.extend(500.0) - *a);
            let normal = u.cross(v);
            if normal.z <= 0.05 * normal.length() {
                return None;
            }
            let share = from.dot(normal) / normal.z;
            let (u, v, from) = (u.truncate(), v.truncate(), from.truncate());
            let (s, t) = (from.perp_dot(v) / normal.z, u.perp_dot(from) / normal.z);
            (s >= 0.0 && t >= 0.0 && s + t <= 1.0).then_some(500.0 - share)
        };
        let ray = triangles.iter().filter_map(hit).fold(f64::NEG_INFINITY, f64::max);
        if ray == f64::NEG_INFINITY {
            assert!(drawn[node].is_nan(), "{at}: {}", drawn[node]);
            misses += 1;
        } else {
            assert!((drawn[node] - ray).abs() < 1e-9, "{at}: {} {ray}", drawn[node]);
            hits += 1;
        }
    }
    assert!(hits > 4000 && misses > 50, "{hits} {misses}");
}

#[test]
fn marks_and_surfaces_that_do_not_fit_are_one_line() {
    let (surface, marks) = average();
    let line = |surface: &Surface, marks: &Marks| {
        let line = fit(surface, marks, Side::Left, &Settings::default()).unwrap_err().to_string();
        assert!(!line.contains('\n') && line.len() < 200, "{line}");
        line
    };
    let with = |edit: &dyn Fn(&mut Marks)| {
        let mut marks = marks;
        edit(&mut marks);
        line(&surface, &marks)
    };
    let swapped = with(&|marks| std::mem::swap(&mut marks.sternal_notch, &mut marks.navel));
    assert!(swapped.starts_with("marks in the wrong order: upper_left is below fold_left"));
    let exchanged = with(&|marks| marks.nipples.swap(0, 1));
    assert!(exchanged.contains("lateral_left is nearer to the midline"), "{exchanged}");
    let other = with(&|marks| marks.breasts.swap(0, 1));
    assert!(other.contains("the marks are those of the other side"), "{other}");
    let none = with(&|marks| marks.breasts[0] = None);
    assert!(none.starts_with("no marks of the left breast; allowed: fold_left"), "{none}");
    let one_place = with(&|marks| marks.navel = marks.sternal_notch);
    assert_eq!(one_place, "sternal_notch and navel are at one place");
    let far = marks.mapped(|p| p + DVec3::X * 900.0);
    assert!(line(&surface, &far).starts_with("the surface has no skin within 100 mm"));
    // Marks in cm beside a surface in mm.
    assert!(line(&surface, &marks.scaled(0.1)).contains("check"));
    // Without the belly side of the breast.
    let mut cut = surface.clone();
    cut.triangles.retain(|triangle| surface.corners(*triangle).iter().all(|p| p.y > -60.0));
    assert!(line(&cut, &marks).starts_with("the scan ends inside of the operating field"));
    // The same side turned over.
    let mut mixed = surface.clone();
    cut.triangles.sort_unstable();
    let is_kept = |triangle: &[u32; 3]| cut.triangles.binary_search(triangle).is_ok();
    let turned = mixed.triangles.iter_mut().filter(|triangle| !is_kept(triangle));
    turned.for_each(|triangle| triangle.swap(0, 1));
    let line = line(&mixed, &marks);
    assert!(line.contains(" % of the triangles about it face inwards"), "{line}");
}

/// A mark off the skin has a warning, far off an error; the navel may lie beyond the scan.
#[test]
fn marks_off_the_skin_are_named() {
    let (surface, marks) = average();
    let front = marks.axes().unwrap().front;
    let moved = |mark: fn(&mut Marks) -> &mut DVec3, by: f64| {
        let mut marks = marks;
        *mark(&mut marks) += front * by;
        fit(&surface, &marks, Side::Left, &Settings::default())
    };
    let nipple: fn(&mut Marks) -> &mut DVec3 = |marks| &mut marks.nipples[0];
    assert!(moved(nipple, 12.0).unwrap().quality.off_skin.is_none());
    let found = moved(nipple, 30.0).unwrap().quality.warnings();
    assert!(found[0].starts_with("nipple_left is 29 mm off the skin: check"), "{found:?}");
    let error = moved(nipple, 80.0).unwrap_err().to_string();
    let words = " mm off the surface; allowed: up to 60 mm: check unit and marks";
    assert!(error.starts_with("nipple_left is 7") && error.ends_with(words), "{error}");
    let navel = moved(|marks| &mut marks.navel, 90.0).unwrap().quality.off_skin.unwrap();
    assert_eq!(navel.0, "navel");

    let mut other = marks;
    let [_, Some(right)] = marks.breasts else { panic!("{marks:?}") };
    other.breasts[0].as_mut().unwrap().implant_centre = Some(right.fold);
    let error = fit(&surface, &other, Side::Left, &Settings::default()).unwrap_err();
    let words = "marks in the wrong order: implant_centre_left is on the other side of the midline";
    assert_eq!(error.to_string(), words);
}

/// A proposed centre far above the nipple has a warning, a marked one none.
#[test]
fn a_proposed_centre_above_the_nipple_is_named() {
    let (surface, mut marks) = average();
    let centre = marks.breasts[0].as_mut().unwrap().implant_centre.take();
    let settings = Settings { base_radius_mm: 105.0, ..Settings::default() };
    let found = fit(&surface, &marks, Side::Left, &settings).unwrap().quality;
    let proposed = marks.implant_centre(Side::Left, 105.0).unwrap();
    let above = (proposed - marks.nipples[0]).dot(marks.axes().unwrap().head);
    assert!(above > 15.0 && (found.above_nipple_mm - above).abs() < 1e-9, "{above}");
    let words = format!("The implant's proposed centre is {above:.0} mm above the nipple");
    assert!(found.warnings()[0].starts_with(&words), "{:?}", found.warnings());
    assert_eq!(fitted(&surface, &marks, Side::Left).quality.warnings(), [""; 0]);
    marks.breasts[0].as_mut().unwrap().implant_centre = centre;
    let marked = fit(&surface, &marks, Side::Left, &settings).unwrap().quality;
    assert!(marked.warnings().is_empty() && marked.above_nipple_mm <= 0.0);
}
