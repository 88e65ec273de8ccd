//! Measures of breasts by formula.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops where something is missing"
)]

#[path = "common/torso.rs"]
mod formula;

use glam::DVec3;
use implant_preview_body::deform::gained_ml;
use implant_preview_body::fit::{Settings, fit};
use implant_preview_body::frame::Frame;
use implant_preview_body::marks::{Marks, Side};
use implant_preview_body::measures::{Measures, measures};
use implant_preview_body::mound::{asymmetry_mm, change, mound};
use implant_preview_body::surface::Surface;

fn body(projection: f64) -> (Surface, Marks) {
    (formula::torso(projection, 200, 160), formula::marks(projection))
}

#[test]
fn a_breast_by_formula_has_its_projection_volume_and_poles() {
    for projection in [41.0, 62.3, 89.5] {
        let (surface, marks) = body(projection);
        for side in [Side::Left, Side::Right] {
            let fitted = fit(&surface, &marks, side, &Settings::default()).unwrap();
            let found = mound(&fitted, &marks, side).unwrap();
            println!("{projection} {side:?}: {found:?}, {:.1} ml", formula::volume_ml(projection));
            assert!((found.projection_mm - projection).abs() < 1.0);
            assert!((found.volume_ml - formula::volume_ml(projection)).abs() < 5.0);
            assert!((found.upper_percent - 50.0).abs() < 0.5);
        }
    }
}

/// Another breast over the same chest is the body after: the differences are those of the formula.
#[test]
fn before_and_after_over_one_chest_differ_by_the_formula() {
    let ((before, marks), (after, moved)) = (body(41.0), body(62.3));
    let side = Side::Left;
    let fitted = fit(&before, &marks, side, &Settings::default()).unwrap();
    let found = change(&fitted, [(&before, &marks), (&after, &moved)], side).unwrap();
    let exact = formula::volume_ml(62.3) - formula::volume_ml(41.0);
    // Both breasts have grown, of the other one a part lies in the patch.
    println!("{found:?}, {exact:.1} ml, by the surfaces {:.1} ml", gained_ml(&before, &after));
    assert!((0.5 * gained_ml(&before, &after) - exact).abs() < 0.01 * exact);
    assert!((found.after.volume_ml - found.before.volume_ml - found.gained_ml).abs() < 1e-9);
    assert!(found.gained_ml > 0.97 * exact && found.gained_ml < 1.15 * exact, "{found:?}");
    let rise = found.after.projection_mm - found.before.projection_mm;
    assert!((rise - 21.3).abs() < 0.7, "{rise}");
    // The nipple moves along the normal of the breast, which the chest's normal meets within 6°.
    assert!((found.nipple_mm.length() - 21.3).abs() < 0.1 && found.nipple_mm.z > 21.1);
    // Nothing moves: nothing changes, to the last bit.
    let same = change(&fitted, [(&before, &marks), (&before, &marks)], side).unwrap();
    assert!(same.before == same.after && same.gained_ml == 0.0 && same.nipple_mm == DVec3::ZERO);
    assert_eq!(Some(same.before), mound(&fitted, &marks, side));
}

#[test]
fn poles_shift_with_the_level_of_the_nipple() {
    let (surface, marks) = body(62.3);
    let fitted = fit(&surface, &marks, Side::Left, &Settings::default()).unwrap();
    let upper = |by_mm: f64| {
        let mut marks = marks;
        marks.nipples[0].y += by_mm;
        mound(&fitted, &marks, Side::Left).unwrap().upper_percent
    };
    // Sections of (1 − s²)² over an ellipse at t of its half axis have areas in proportion to (1 − t²)^2.5.
    let (mut above, mut all) = (0.0, 0.0);
    for k in 0..2000 {
        let t = (f64::from(k) + 0.5) / 1000.0 - 1.0;
        let share = (1.0 - t * t).powf(2.5);
        all += share;
        above += if t > 0.25 { share } else { 0.0 };
    }
    let exact = 100.0 * above / all;
    let found = upper(17.0) - upper(0.0) + 50.0;
    println!("{found:.2} % of {exact:.2} %");
    assert!((found - exact).abs() < 0.5, "{found} {exact}");
}

#[test]
fn differences_of_both_sides_are_those_of_the_breasts() {
    let (surface, marks) = body(62.3);
    let frame = Frame::of_body(&marks).unwrap();
    let alike = asymmetry_mm(&surface, &marks, &frame).unwrap();
    let found = measures(&surface, &marks, &frame).left_less_right().unwrap();
    println!("alike: {alike:.3} mm, {found:?}");
    assert!(alike < 0.6 && found.notch_nipple_mm.abs() < 1e-9 && found.base_width_mm.abs() < 1e-9);
    // The left breast projects 10 mm more.
    let (larger, other) = body(72.3);
    let mut positions = surface.positions.clone();
    positions
        .iter_mut()
        .zip(&larger.positions)
        .filter(|(p, _)| p.x > 0.0)
        .for_each(|(p, q)| *p = *q);
    let mut uneven = marks;
    (uneven.nipples[0], uneven.breasts[0]) = (other.nipples[0], other.breasts[0]);
    let apart = asymmetry_mm(&Surface { positions, ..surface }, &uneven, &frame).unwrap();
    // 10 mm · (1 − s²)², along the normals: the root of the mean of (1 − s²)⁴ over an ellipse is √(1/5) = 0.447; the slopes take 10 to 30 %.
    println!("apart: {apart:.3} mm");
    assert!(apart > 2.5 && apart < 4.5, "{apart}");
    // With the sides exchanged it is the same.
    let (mut surface, mut marks) = body(62.3);
    let right = surface.positions.iter_mut().zip(&larger.positions).filter(|(p, _)| p.x < 0.0);
    right.for_each(|(p, q)| *p = *q);
    (marks.nipples[1], marks.breasts[1]) = (other.nipples[1], other.breasts[1]);
    let exchanged = asymmetry_mm(&surface, &marks, &frame).unwrap();
    assert!((exchanged / apart - 1.0).abs() < 0.01, "{exchanged} {apart}");
}

/// A breast that moves forwards takes its marks with it: the other breast stays where it was.
#[test]
fn marks_that_move_with_the_skin_do_not_tilt_the_axes() {
    let (surface, marks) = body(62.3);
    let frame = Frame::of_body(&marks).unwrap();
    let mut moved = marks;
    moved.nipples[0] += DVec3::new(0.0, 4.0, 30.0);
    let tilted = Frame::of_body(&moved).unwrap();
    let turn = frame.axes.x_axis.angle_between(tilted.axes.x_axis).to_degrees();
    println!("the marks after would turn the axes by {turn:.1}°");
    assert!(turn > 5.0);
    let [before, after] = [marks, moved].map(|marks| measures(&surface, &marks, &frame));
    assert_eq!(before.breasts[1], after.breasts[1]);
    let midline = |found: &Measures, k: usize| found.breasts[k].unwrap().nipple_midline_mm;
    // The way forwards and up is none to the side.
    assert!((midline(&after, 0) - midline(&before, 0)).abs() < 1e-9);
    let rise = after.nipple_height_mm - before.nipple_height_mm;
    assert!((rise - 4.0 * frame.axes.y_axis.y - 30.0 * frame.axes.y_axis.z).abs() < 1e-9, "{rise}");
    // The skin is the same, so is its asymmetry.
    let asymmetry = [&marks, &moved].map(|marks| asymmetry_mm(&surface, marks, &frame));
    assert_eq!(asymmetry[0], asymmetry[1]);
    let apart = asymmetry_mm(&surface, &moved, &tilted).unwrap();
    assert!(apart > 5.0 * asymmetry[0].unwrap(), "{apart} {asymmetry:?}");
}
