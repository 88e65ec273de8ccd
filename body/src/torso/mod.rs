//! The built-in torso of a woman, shaped by what a tape measures.
//!
//! The front of a trunk from the MakeHuman base mesh (CC0 1.0; no person), symmetric, 5722 vertices, quantised to 0.05 mm. Shoulders and
//! stumps of arms are drawn beside it and are no part of it: they are no chest. A tape's numbers move
//! the mound of the breast over the bare chest: the chest widens as a whole, then the mound, skin less bare chest of a [fit](crate::fit), is
//! moved across with the nipple, stretched across and between nipple and fold, and scaled to its volume, on a trunk as long as the way from
//! notch to nipple asks for. The volume is that which a fit of the shaped torso measures. The tape's own numbers leave every vertex as it is.

mod shape;

use crate::fit::{Bare, FitError};
use crate::half::{self, mirrored};
use crate::marks::{BreastMarks, Marks, Side};
use crate::surface::Surface;
use glam::DVec3;
use shape::{Mound, NEAR_MM};

/// Range of the trunk's length over that of the built-in torso \[-\].
const LONG: [f64; 2] = [0.75, 1.3];
/// The way from nipple to fold that [`Tape::OWN`] gives \[mm\].
const OWN_NIPPLE_FOLD_MM: f64 = 84.6;
/// What a fit of the plan measures of the breast beyond the volume over the mound's bare chest, under [`Tape::OWN`], and the difference
/// that ends the search \[ml\].
const OWN_BEYOND_ML: f64 = 49.9;
const NEAR_ML: f64 = 0.5;
/// Fits of a trunk whose length gives the way from notch to nipple.
const TRUNKS: usize = 3;

/// A body: its surface and a surgeon's marks.
#[derive(Clone, Debug, PartialEq)]
pub struct Torso {
    /// The surface \[mm\]: x towards the patient's left, y to the head, z forwards.
    pub surface: Surface,
    /// The marks in its coordinates.
    pub marks: Marks,
}

/// What a tape measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tape {
    /// Width of the chest at the level of the folds, straight \[mm\].
    pub chest_width_mm: f64,
    /// Width of the breast from its medial to its lateral end, straight \[mm\].
    pub breast_width_mm: f64,
    /// From the sternal notch to the nipple, straight \[mm\].
    pub notch_nipple_mm: f64,
    /// From the nipple to the fold, along the skin \[mm\]; `None`: as the others give it.
    pub nipple_fold_mm: Option<f64>,
    /// Between the nipples, straight \[mm\].
    pub nipple_nipple_mm: f64,
    /// Volume between skin and bare chest \[ml\].
    pub breast_volume_ml: f64,
}

impl Tape {
    /// That of the built-in torso.
    pub const OWN: Self = Self {
        chest_width_mm: 260.0,
        breast_width_mm: 136.6,
        notch_nipple_mm: 206.2,
        nipple_fold_mm: None,
        nipple_nipple_mm: 224.6,
        breast_volume_ml: 374.2,
    };
}

/// The built-in torso.
#[must_use]
pub fn builtin() -> Torso {
    Torso { surface: half::both_halves(half::TRUNK), marks: marks() }
}

/// The marks of the built-in torso.
fn marks() -> Marks {
    let of_left = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    let left = BreastMarks {
        fold: of_left(108.17, 300.15, 120.1),
        upper: of_left(80.53, 440.9, 123.73),
        medial: of_left(23.79, 346.19, 152.15),
        lateral: of_left(140.58, 371.08, 84.61),
        implant_centre: None,
    };
    // The vertex on the bump.
    let nipple = of_left(112.45, 352.95, 180.85);
    Marks {
        sternal_notch: of_left(0.0, 500.21, 89.78),
        navel: of_left(0.0, 119.77, 153.74),
        nipples: [nipple, mirrored(nipple)],
        breasts: both(left),
    }
}

/// The marks of a left breast and of its image.
fn both(left: BreastMarks) -> [Option<BreastMarks>; 2] {
    let BreastMarks { fold, upper, medial, lateral, .. } = left;
    let [fold, upper, medial, lateral] = [fold, upper, medial, lateral].map(mirrored);
    [Some(left), Some(BreastMarks { fold, upper, medial, lateral, implant_centre: None })]
}

/// Width of the chest at the level of the folds, without arms \[mm\].
fn chest_width(torso: &Torso) -> f64 {
    const LEVEL_MM: f64 = 4.0;
    let level = torso.marks.breasts[0].map_or(0.0, |breast| breast.fold.y);
    let near = torso.surface.positions.iter().filter(|at| (at.y - level).abs() < LEVEL_MM);
    2.0 * near.map(|at| at.x).fold(0.0, f64::max)
}

/// The torso with a tape's numbers, both sides alike, and the numbers that it has: others where no such breast is within the ranges of
/// the moves and stretches, as a great volume close under the notch.
///
/// # Errors
/// Those of [`crate::fit::fit`].
pub fn shaped(tape: &Tape) -> Result<(Torso, Tape), FitError> {
    let (torso, _, found) = shaped_with_arms(tape)?;
    Ok((torso, found))
}

/// As [`shaped`], with the shoulders and stumps of arms that are drawn beside the trunk. They are no chest: neither a fit nor proposed marks
/// have them.
///
/// # Errors
/// As [`shaped`].
pub fn shaped_with_arms(tape: &Tape) -> Result<(Torso, Surface, Tape), FitError> {
    let mut arms = half::both_halves(half::ARM);
    if *tape == Tape::OWN {
        let found = Tape { nipple_fold_mm: Some(OWN_NIPPLE_FOLD_MM), ..Tape::OWN };
        return Ok((builtin(), arms, found));
    }
    let wide = tape.chest_width_mm / Tape::OWN.chest_width_mm;
    let (mut long, mut beyond_ml) = (1.0, OWN_BEYOND_ML);
    let mut trunk = 0;
    loop {
        let scale = DVec3::new(wide, long, wide);
        let mut torso = builtin();
        torso.surface.positions.iter_mut().for_each(|at| *at *= scale);
        torso.marks = torso.marks.mapped(|at| at * scale);
        let down = torso.marks.sternal_notch.y - torso.marks.nipple(Side::Left).y;
        let mound = Mound::new(&torso, shape::CENTRE * scale)?;
        let volume_ml = tape.breast_volume_ml - beyond_ml;
        let shape = mound.shaped(&Tape { breast_volume_ml: volume_ml, ..*tape });
        let over_given = mound.tape(&shape);
        mound.reshape(&shape, &mut torso.surface.positions);
        torso.marks = mound.marks(&shape, &torso.marks);
        let breast_volume_ml = Bare::fitted(&torso.surface, &torso.marks)?.volume_ml(&torso.marks);
        let found = Tape { breast_volume_ml, ..over_given };
        trunk += 1;
        let missing = tape.notch_nipple_mm - found.notch_nipple_mm;
        let is_near = (tape.breast_volume_ml - breast_volume_ml).abs() < NEAR_ML;
        if trunk == TRUNKS || missing.abs() < NEAR_MM && is_near {
            arms.positions.iter_mut().for_each(|at| *at *= scale);
            mound.reshape(&shape, &mut arms.positions);
            return Ok((torso, arms, found));
        }
        // A longer way from notch to nipple is a longer trunk.
        let missing = missing * found.notch_nipple_mm / down;
        long = (long * (1.0 + missing / down)).clamp(LONG[0], LONG[1]);
        beyond_ml = breast_volume_ml - over_given.breast_volume_ml;
    }
}

#[cfg(test)]
mod tests {
    use super::shape::Shape;
    use super::*;
    use crate::fit::{Settings, fit_known};
    use crate::measures::along_skin;
    use crate::mound::mound;

    /// Numbers between those of two tapes.
    fn between(share: [f64; 6]) -> Tape {
        let of = |k: usize, [least, most]: [f64; 2]| least + (most - least) * share[k];
        Tape {
            chest_width_mm: of(0, [235.0, 300.0]),
            breast_width_mm: of(1, [120.0, 145.0]),
            notch_nipple_mm: of(2, [190.0, 235.0]),
            nipple_fold_mm: None,
            nipple_nipple_mm: of(4, [195.0, 235.0]),
            breast_volume_ml: of(5, [150.0, 450.0]),
        }
    }

    /// The place on the torus of a sequence without gaps (R₆).
    fn share(k: u32) -> [f64; 6] {
        [0.8566748838, 0.7338918566, 0.6287067244, 0.5385972573, 0.4614020091, 0.3952670457]
            .map(|step| (0.5 + step * f64::from(k)).fract())
    }

    #[test]
    fn both_halves_are_mirror_images_and_the_surface_has_one_part() {
        let Torso { surface, marks } = builtin();
        assert_eq!((surface.positions.len(), surface.triangles.len()), (5722, 11106));
        assert_eq!(surface.parts(), 1);
        let key = |at: &DVec3| [at.x, at.y, at.z].map(|x| (x / half::UNIT_MM).round() as i64);
        let keys: std::collections::HashSet<_> = surface.positions.iter().map(key).collect();
        assert!(surface.positions.iter().all(|at| keys.contains(&key(&at.with_x(-at.x)))));
        assert!(marks.check(Side::Left).is_ok() && marks.check(Side::Right).is_ok());
        // The marks lie on the skin.
        for side in [Side::Left, Side::Right] {
            let nipple = marks.nipple(side);
            let nearest = surface.positions.iter().map(|at| at.distance(nipple));
            assert!(nearest.fold(f64::INFINITY, f64::min) < 4.0);
        }
    }

    /// Each vertex of the trunk's border at an arm is one of the arm's, under any tape.
    #[test]
    fn arms_go_on_from_the_trunk_and_nipples_are_its_bumps() {
        let wide = Tape { chest_width_mm: 290.0, breast_volume_ml: 420.0, ..Tape::OWN };
        for tape in [Tape::OWN, wide] {
            let (Torso { surface, marks }, arms, _) = shaped_with_arms(&tape).unwrap();
            assert_eq!(arms.positions.len(), 252);
            let bits = |at: &DVec3| at.to_array().map(f64::to_bits);
            let trunk: std::collections::HashSet<_> = surface.positions.iter().map(bits).collect();
            let common = arms.positions.iter().filter(|at| trunk.contains(&bits(at))).count();
            assert_eq!(common, 2 * 57, "{tape:?}");
            // The middle of an areola is the bump's vertex, in front of the breast around.
            for mark in marks.nipples {
                let away = |at: &&DVec3| at.distance(mark);
                let by_distance = |a: &&DVec3, b: &&DVec3| away(a).total_cmp(&away(b));
                let bump = surface.positions.iter().min_by(by_distance).unwrap();
                assert!(bump.distance(mark) < 1.0, "{bump} {mark}");
                let around: Vec<&DVec3> =
                    surface.positions.iter().filter(|at| (6.0..14.0).contains(&away(at))).collect();
                let mean = around.iter().map(|at| at.z).sum::<f64>() / around.len() as f64;
                assert!(bump.z > mean + 2.0, "{bump} {mean}");
            }
        }
    }

    #[test]
    fn the_torsos_own_tape_leaves_every_vertex() {
        let own = builtin();
        let (torso, tape) = shaped(&Tape::OWN).unwrap();
        assert_eq!(torso, own);
        let mound = Mound::new(&own, shape::CENTRE).unwrap();
        let (found, given) = (mound.tape(&Shape::of([0.0; 4])), Tape::OWN);
        for (found, given) in [
            (found.chest_width_mm, given.chest_width_mm),
            (found.breast_width_mm, given.breast_width_mm),
            (found.notch_nipple_mm, given.notch_nipple_mm),
            (found.nipple_fold_mm.unwrap(), tape.nipple_fold_mm.unwrap()),
            (found.nipple_nipple_mm, given.nipple_nipple_mm),
            (found.breast_volume_ml + OWN_BEYOND_ML, given.breast_volume_ml),
        ] {
            assert!((found - given).abs() < 0.06, "{found} {given}");
        }
    }

    /// Number of triangles that lie on the other side than those of the built-in torso.
    fn turned(surface: &Surface) -> usize {
        let own = builtin().surface;
        let normal = |surface: &Surface, triangle: [u32; 3]| {
            let [a, b, c] = surface.corners(triangle);
            (b - a).cross(c - a)
        };
        let all = surface.triangles.iter();
        all.filter(|&&of| normal(surface, of).dot(normal(&own, of)) <= 0.0).count()
    }

    /// The way to the fold, measured along the skin of the surface, is that reported; half of the tapes have it and keep all other
    /// lengths within 1 %, the volume within 2 %.
    #[test]
    fn a_fold_is_as_far_from_the_nipple_as_the_tape_says() {
        let mut exact = 0;
        for (k, by) in (0..12).zip([-5.0, 4.0].into_iter().cycle()) {
            let free = between(share(k));
            let (torso, found) = shaped(&free).unwrap();
            let asked = found.nipple_fold_mm.unwrap() + by;
            let (after, of) = shaped(&Tape { nipple_fold_mm: Some(asked), ..free }).unwrap();
            let near = |a: f64, b: f64| (a / b - 1.0).abs() < 0.01;
            // A tape's volume is met to 2 %.
            let as_full = (of.breast_volume_ml / found.breast_volume_ml - 1.0).abs() < 0.02;
            exact += u32::from(
                near(of.nipple_fold_mm.unwrap(), asked)
                    && as_full
                    && near(of.breast_width_mm, found.breast_width_mm)
                    && near(of.nipple_nipple_mm, found.nipple_nipple_mm)
                    && near(of.notch_nipple_mm, found.notch_nipple_mm),
            );
            let by = of.nipple_fold_mm.unwrap() - found.nipple_fold_mm.unwrap();
            let [low, high] = [&torso, &after].map(|Torso { surface, marks }| {
                along_skin(surface, marks.nipples[0], marks.breasts[0].unwrap().fold)
            });
            assert!((high.unwrap() - low.unwrap() - by).abs() < 1.5, "{k}: {low:?} {high:?}, {by}");
            assert_eq!(turned(&after.surface), 0, "{k}");
        }
        assert!(exact >= 6, "{exact} of 12 tapes");
    }

    /// Tapes of which the fold's move turned triangles over while it had wider ranges.
    #[test]
    fn a_fold_at_either_limit_turns_no_triangle_over() {
        for k in [3, 17, 39, 47, 143, 178] {
            let part = share(k);
            let of = |k: usize, [least, most]: [f64; 2]| least + (most - least) * part[k];
            let tape = Tape {
                chest_width_mm: of(0, [220.0, 320.0]),
                breast_width_mm: of(1, [110.0, 150.0]),
                notch_nipple_mm: of(2, [170.0, 250.0]),
                nipple_fold_mm: Some(if k % 2 == 0 { 40.0 } else { 120.0 }),
                nipple_nipple_mm: of(4, [180.0, 250.0]),
                breast_volume_ml: of(5, [80.0, 500.0]),
            };
            assert_eq!(turned(&shaped(&tape).unwrap().0.surface), 0, "{tape:?}");
        }
    }

    /// Distances between the marks are those reported, no triangle turns over, and of tapes within ordinary ranges two thirds have all of
    /// their numbers within 2 %.
    #[test]
    fn a_shaped_torso_has_its_tapes_numbers() {
        let mut exact = 0;
        for tape in (0..24).map(|k| between(share(k))) {
            let (Torso { surface, marks }, found) = shaped(&tape).unwrap();
            let [left, right] = marks.breasts.map(Option::unwrap);
            let same = |at: f64, found: f64| assert!((at - found).abs() < 0.1, "{at} {found}");
            same(marks.notch_nipple(Side::Left), found.notch_nipple_mm);
            same(marks.nipples[0].distance(marks.nipples[1]), found.nipple_nipple_mm);
            same(left.medial.distance(left.lateral), found.breast_width_mm);
            let fit = fit_known(&surface, &marks, Side::Left, &Settings::default()).unwrap();
            let before = mound(&fit, &marks, Side::Left).unwrap();
            same(before.volume_ml, found.breast_volume_ml);
            assert_eq!(left.fold.with_x(-left.fold.x), right.fold);
            assert_eq!(turned(&surface), 0, "{tape:?}");
            let near = |found: f64, asked: f64| (found / asked - 1.0).abs() < 0.02;
            exact += u32::from(
                near(found.chest_width_mm, tape.chest_width_mm)
                    && near(found.breast_width_mm, tape.breast_width_mm)
                    && near(found.notch_nipple_mm, tape.notch_nipple_mm)
                    && near(found.nipple_nipple_mm, tape.nipple_nipple_mm)
                    && near(found.breast_volume_ml, tape.breast_volume_ml),
            );
        }
        assert!(exact >= 16, "{exact} of 24 tapes");
    }
}
