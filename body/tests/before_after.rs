//! The table of measures before and after, against surfaces by formula.

#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test stops where something is missing"
)]

#[path = "common/torso.rs"]
mod formula;

use implant_preview_body::before_after::{Before, Row};
use implant_preview_body::marks::{Marks, Side};
use implant_preview_body::surface::Surface;
use std::sync::Arc;

const COVER_MM: f64 = 10.0;

/// A torso whose left breast has one projection and whose right breast another one \[mm\].
fn body([left, right]: [f64; 2]) -> (Surface, Marks) {
    let [of_left, of_right] = [left, right].map(|projection| formula::torso(projection, 200, 160));
    let pairs = of_left.positions.iter().zip(&of_right.positions);
    let positions = pairs.map(|(a, b)| if a.x > 0.0 { *a } else { *b }).collect();
    let mut marks = formula::marks(left);
    let other = formula::marks(right);
    (marks.nipples[1], marks.breasts[1]) = (other.nipples[1], other.breasts[1]);
    (Surface { positions, ..of_left }, marks)
}

fn rows(side: Side, before: [f64; 2], after: [f64; 2]) -> Vec<Row> {
    let ((surface, marks), (after, moved)) = (body(before), body(after));
    let before = Before::new(Arc::new(surface), &marks, side, COVER_MM).unwrap();
    before.rows((&after, &moved), 100.0)
}

fn row(rows: &[Row], name: &str) -> Row {
    let found: Vec<&Row> = rows.iter().filter(|row| row.name == name).collect();
    assert_eq!(found.len(), 1, "{name}");
    *found[0]
}

/// Length of the skin from the nipple down to the fold, by formula \[mm\].
fn nipple_fold_mm(projection: f64) -> f64 {
    let at = |k: i32| {
        let y = -formula::BREAST[1] * f64::from(k) / 2000.0;
        formula::on_breast(0.0, y, projection)
    };
    (0..2000).map(|k| at(k).distance(at(k + 1))).sum()
}

#[test]
fn every_measure_of_a_breast_that_grows_is_that_of_the_formula() {
    let (low, high) = (41.0, 62.3);
    for (side, before, after) in
        [(Side::Left, [low, low], [high, low]), (Side::Right, [low, low], [low, high])]
    {
        let rows = rows(side, before, after);
        assert_eq!(rows.len(), 17);
        rows.iter().for_each(|row| println!("{row:?}"));
        let k = side as usize;
        let [was, now] = [formula::marks(low), formula::marks(high)];
        let check = |name: &str, unit: &str, exact: [f64; 2], tolerance: f64| {
            let found = row(&rows, name);
            assert_eq!(found.unit, unit, "{name}");
            let values = [found.before.unwrap(), found.after.unwrap()];
            for (value, exact) in values.into_iter().zip(exact) {
                assert!((value - exact).abs() < tolerance, "{name}: {value} {exact}");
            }
            assert!((found.gain.unwrap() - (values[1] - values[0])).abs() < 1e-9, "{name}");
        };
        let both = |of: &dyn Fn(&Marks) -> f64| [of(&was), of(&now)];
        let nipple = |marks: &Marks| marks.nipples[k];
        let notch = both(&|marks| 0.1 * nipple(marks).distance(marks.sternal_notch));
        check("Notch to nipple", "cm", notch, 1e-9);
        let fold = [low, high].map(|projection| 0.1 * nipple_fold_mm(projection));
        check("Nipple to fold, along the skin", "cm", fold, 0.02);
        // The body is a mirror image of itself before: the midline is x = 0.
        check("Nipple to midline", "cm", both(&|marks| 0.1 * nipple(marks).x.abs()), 1e-9);
        let width = both(&|marks| {
            let breast = marks.breasts[k].unwrap();
            0.1 * breast.medial.distance(breast.lateral)
        });
        check("Width of the breast", "cm", width, 1e-9);
        check("Projection", "cm", [0.1 * low, 0.1 * high], 0.1);
        let volumes = [low, high].map(formula::volume_ml);
        check("Volume of the breast", "ml", volumes, 5.0);
        check("Upper pole", "%", [50.0; 2], 0.5);
        let gained = volumes[1] - volumes[0];
        let gain = |name: &str| {
            let found = row(&rows, name);
            assert_eq!((found.before, found.after), (None, None), "{name}");
            found.gain.unwrap()
        };
        assert!((gain("Volume gained") - gained).abs() < 0.01 * gained);
        assert!(
            (gain("Volume gained beside the implant") + 100.0 - gain("Volume gained")).abs() < 1e-9
        );
        let way = nipple(&now) - nipple(&was);
        let shift = [gain("Nipple to the side"), gain("Nipple upwards"), gain("Nipple forwards")];
        assert!((shift.iter().map(|x| x * x).sum::<f64>().sqrt() - way.length()).abs() < 1e-9);
        // Along the normal of the breast, which the chest's normal meets within 6°.
        assert!(shift[2] > 0.99 * (high - low) && shift[1].abs() < 0.11 * (high - low));
        // The other nipple stays.
        let [one, other] = [nipple(&now), was.nipples[1 - k]];
        check(
            "Nipple to nipple",
            "cm",
            [0.1 * was.nipples[0].distance(was.nipples[1]), 0.1 * one.distance(other)],
            1e-9,
        );
        let medial = |marks: &Marks| marks.breasts[k].unwrap().medial;
        let apart = medial(&was).x.abs();
        check("Between the breasts", "cm", [0.2 * apart; 2], 1e-9);
        let sign = if side == Side::Left { 1.0 } else { -1.0 };
        let up = (was.sternal_notch - was.navel).normalize();
        check("Left nipple higher by", "mm", [0.0, sign * way.dot(up)], 1e-9);
        let asymmetry = row(&rows, "Asymmetry of the skin");
        let [even, uneven] = [asymmetry.before.unwrap(), asymmetry.after.unwrap()];
        // 21.3 mm · (1 − s²)² along the normals: its root mean square over an ellipse is √(1/5), the slopes take a fifth.
        assert!(even < 0.6 && (0.7..0.8).contains(&(uneven / (0.447 * (high - low)))), "{uneven}");
    }
}

#[test]
fn nothing_gained_is_zero_to_the_last_bit_and_both_sides_are_alike() {
    let [left, right] =
        [Side::Left, Side::Right].map(|side| rows(side, [62.3, 62.3], [62.3, 62.3]));
    for (one, other) in left.iter().zip(&right) {
        assert_eq!(one.before, one.after, "{one:?}");
        let is_void = one.name == "Volume gained beside the implant";
        assert_eq!(one.gain, Some(if is_void { -100.0 } else { 0.0 }), "{one:?}");
        if let Some((one, other)) = one.before.zip(other.before) {
            assert!((one - other).abs() < 0.02 * one.abs().max(1.0), "{one} {other}");
        }
    }
}

#[test]
fn what_has_no_marks_or_no_chest_has_no_value() {
    let (surface, mut marks) = body([41.0, 41.0]);
    marks.breasts[1] = None;
    let before = Before::new(Arc::new(surface.clone()), &marks, Side::Left, COVER_MM).unwrap();
    let found = before.rows((&surface, &marks), 0.0);
    for name in ["Between the breasts", "Asymmetry of the skin"] {
        let row = row(&found, name);
        assert_eq!((row.before, row.after, row.gain), (None, None, None), "{name}");
    }
    assert!(row(&found, "Projection").before.is_some());
    // Without a breast's marks there is no chest under it, and what the surfaces enclose stays.
    let other = Before::new(Arc::new(surface.clone()), &marks, Side::Right, COVER_MM).unwrap();
    let found = other.rows((&surface, &marks), 0.0);
    assert_eq!(
        (row(&found, "Projection").before, row(&found, "Volume gained").gain),
        (None, Some(0.0))
    );
    // Marks at one place have no directions.
    marks.navel = marks.sternal_notch;
    let error = Before::new(Arc::new(surface), &marks, Side::Left, COVER_MM).unwrap_err();
    assert!(error.to_string().contains("navel"), "{error}");
}
