//! A surface from arrays of Python and JavaScript.

#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use glam::DVec3;
use implant_preview_body::marks::Side;
use implant_preview_body::surface::Surface;

const CORNERS: [f64; 9] = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 2.0, -3.5];

#[test]
fn arrays_are_a_surface_with_their_bits() {
    let expected = Surface {
        positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, 2.0, -3.5)],
        triangles: vec![[0, 1, 2], [2, 1, 0]],
        colors: None,
    };
    // Of either integer.
    assert_eq!(Surface::of_arrays(&CORNERS, &[0_i64, 1, 2, 2, 1, 0]).as_ref(), Ok(&expected));
    assert_eq!(Surface::of_arrays(&CORNERS, &[0_u32, 1, 2, 2, 1, 0]), Ok(expected));
}

#[test]
fn wrong_arrays_are_one_line() {
    let line = |positions: &[f64], triangles: &[i64]| {
        Surface::of_arrays(positions, triangles).unwrap_err().to_string()
    };
    let of = |k: usize, value: f64| {
        let mut positions = CORNERS;
        positions[k] = value;
        line(&positions, &[0, 1, 2])
    };
    assert_eq!(line(&CORNERS[..8], &[0, 1, 2]), "positions has 8 numbers; allowed: three of each");
    assert_eq!(line(&CORNERS, &[0, 1]), "triangles has 2 numbers; allowed: three of each");
    assert_eq!(of(4, f64::NAN), "positions[1] is [1.0, NaN, 0.0]; allowed: numbers up to 1e7 mm");
    assert_eq!(
        of(8, 1.1e7),
        "positions[2] is [0.0, 2.0, 11000000.0]; allowed: numbers up to 1e7 mm"
    );
    for wrong in [3, -1] {
        let expected = format!("triangles[0] is [0, 1, {wrong}]; allowed: vertices 0 to 2");
        assert_eq!(line(&CORNERS, &[0, 1, wrong]), expected);
    }
    assert_eq!(line(&CORNERS, &[]), "triangles is empty; allowed: 1 triangle or more");
    let none = "triangles[0] is [0, 0, 0]; allowed: no vertex, for positions is empty";
    assert_eq!(line(&[], &[0, 0, 0]), none);
}

#[test]
fn a_side_is_read_by_its_word() {
    for side in [Side::Left, Side::Right] {
        assert_eq!(side.word().parse(), Ok(side));
    }
    let line = "Left".parse::<Side>().unwrap_err().to_string();
    assert_eq!(line, "side is \"Left\"; allowed: \"left\" or \"right\"");
}
