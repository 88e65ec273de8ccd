//! Wrinkles of the skin where the skin is a tension field: state, direction, share, and the warning of visible folds.
//!
//! The state is that of the law at the nodal strains ([`tension_field::state`]), of no threshold of the strain: the skin is
//! wrinkled where its second principal tension is zero. The crests run along the first principal direction, that of the
//! tension.

use super::layered::pocket_weight;
use crate::solve::{Solution, Tissue};
use crate::springs::tension_field::{self, FieldState};
use glam::DVec2;

/// Wrinkle strain up to which skin counts as taut \[-\]: rounding of positions in f32. Tissue at rest is taut.
const ROUNDING: f64 = 1e-6;

/// Wrinkle strain from which folds of the skin may be visible \[-\].
///
/// A tension field wrinkles under any compression. Real skin lies on fat and does not fold below the critical strain of a
/// stiff film on a soft base, ¼(3 E_fat/E_skin)^⅔ (H. G. Allen, 1969): 0.02 for the fat `low` (1.5 kPa) under skin of 200 kPa,
/// 0.06 for the fat `high` (4 kPa) under skin of 100 kPa. At 0.02, folds 20 mm apart are 2 mm high: √0.02/π of their distance on either side.
const VISIBLE_STRAIN: f64 = 0.02;

/// Fraction of the skin over the pocket with visible folds above which the result warns \[-\]: no fold over the implant is
/// usual, and a few nodes are no area.
const VISIBLE_OVER_POCKET: f64 = 0.01;

/// Fraction of the skin of the whole patch with visible folds above which the result warns \[-\]: skin gathers a little
/// beyond the pocket on the side to which an implant lies off centre.
const VISIBLE_ON_PATCH: f64 = 0.05;

/// Principal strains at a node, and the Poisson ratio of the membrane's layer that wrinkles last; `None` where compression is not
/// relaxed.
fn skin(solution: &Solution, node: usize) -> Option<([f64; 2], f64)> {
    let problem = solution.problem();
    let ratios = problem.membrane().iter().map(|layer| layer.poisson_ratio);
    let greatest = ratios.max_by(f64::total_cmp).filter(|_| problem.wrinkles())?;
    Some((solution.elastic_deformation().principal(node), greatest))
}

/// State of the skin at a node; `None` where the skin is no tension field.
pub(super) fn state(solution: &Solution, node: usize) -> Option<FieldState> {
    let (strain, nu) = skin(solution, node)?;
    let is_taut = tension_field::wrinkle_strain(strain, nu) <= ROUNDING;
    Some(if is_taut { FieldState::Taut } else { tension_field::state(strain, nu) })
}

/// The strain that wrinkles take up at a node \[-\]; `None` where the skin is no tension field.
pub(super) fn strain(solution: &Solution, node: usize) -> Option<f64> {
    skin(solution, node).map(|(strain, nu)| tension_field::wrinkle_strain(strain, nu))
}

/// Direction of the crests at a node, a unit vector at rest; `None` where the skin is taut or slack.
pub(super) fn direction(solution: &Solution, node: usize) -> Option<DVec2> {
    let is_wrinkled = state(solution, node) == Some(FieldState::Wrinkled);
    is_wrinkled.then(|| {
        let direction = solution.elastic_deformation().first_direction(node);
        let natural = solution.problem().rest.natural();
        natural.map_or(direction, |natural| natural.stretched(direction).normalize())
    })
}

/// Shares of the skin, by area at rest.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Shares {
    /// Of the skin of the whole patch: wrinkled or slack.
    pub(super) wrinkled: f64,
    /// Of the skin of the whole patch: with folds that may be visible.
    visible: f64,
    /// Of the skin over the pocket: with folds that may be visible.
    visible_over_pocket: f64,
}

impl Shares {
    /// The shares of a solution; `None` where the skin is no tension field.
    pub(super) fn new(solution: &Solution) -> Option<Self> {
        let problem = solution.problem();
        if !problem.wrinkles() {
            return None;
        }
        let (deformation, part) = (solution.deformation(), solution.part());
        let (mut patch, mut pocket, mut sums) = (0.0, 0.0, Self::default());
        for k in deformation.inside() {
            let area = deformation.rest_area(k) * part.multiplicity(k);
            let over = match problem.tissue {
                Tissue::Sheet => area,
                Tissue::Layered => area * pocket_weight(problem.sheet(), problem.patch.pocket(), k),
            };
            patch += area;
            pocket += over;
            if state(solution, k) != Some(FieldState::Taut) {
                sums.wrinkled += area;
            }
            if strain(solution, k).is_some_and(|strain| strain > VISIBLE_STRAIN) {
                sums.visible += area;
                sums.visible_over_pocket += over;
            }
        }
        Some(Self {
            wrinkled: sums.wrinkled / patch,
            visible: sums.visible / patch,
            visible_over_pocket: sums.visible_over_pocket / pocket,
        })
    }

    /// The warning of visible folds. Wrinkled skin alone is no reason: beyond the pocket part of the skin often is, at
    /// compressions that real skin takes without a fold. Shares are rounded to tens of a percent: maps and bands count equal
    /// sentences.
    pub(super) fn warning(self) -> Option<String> {
        let place = if self.visible_over_pocket > VISIBLE_OVER_POCKET {
            "over the pocket"
        } else if self.visible > VISIBLE_ON_PATCH {
            "beyond the pocket"
        } else {
            return None;
        };
        let tens = (10.0 * self.wrinkled).round();
        let share = if tens < 1.0 {
            "less than 10 %".to_owned()
        } else {
            format!("about {:.0} %", 10.0 * tens)
        };
        Some(format!(
            "Folds of the skin may be visible {place}: {share} of the skin on and around the implant is wrinkled or \
             slack. The computed shape does not contain the height of folds."
        ))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::float_cmp, reason = "states are whole numbers, slack skin has no stress")]

    use super::*;
    use crate::measure::{Field, Fields, layers};
    use crate::mesh::NodeKind;
    use crate::solve::{Record, Solver, samples};
    use glam::{DVec3, Vec2};
    use std::sync::Arc;

    #[test]
    fn visible_folds_are_a_warning_and_wrinkles_alone_are_none() {
        let none = Shares { wrinkled: 0.6, visible: 0.04, visible_over_pocket: 0.005 };
        assert_eq!(none.warning(), None);
        let beyond = Shares { visible: 0.3, ..none }.warning().unwrap();
        assert!(beyond.contains("beyond the pocket") && beyond.contains("about 60 %"), "{beyond}");
        let over = Shares { visible_over_pocket: 0.02, wrinkled: 0.041, ..none };
        let over = over.warning().unwrap();
        assert!(over.contains("over the pocket") && over.contains("less than 10 %"), "{over}");
    }

    /// A solution whose skin is at these places, in the plane at rest.
    fn with_skin(mirrored: bool, place: impl Fn(DVec2) -> DVec2) -> Solution {
        let problem = samples::layered_at_rest(17);
        let mut solver = Solver::new(problem.clone());
        solver.advance(&mut || false);
        let solution = solver.solution();
        let rest = solution.problem().sheet().rest().to_vec();
        let mut record: Record = solution.record();
        record.mirrored = [mirrored; 2];
        for (x, rest) in record.outer.last_mut().unwrap().iter_mut().zip(&rest) {
            *x = place(*rest).extend(DVec3::from(*x).z).to_array();
        }
        Solution::restore(problem, record).unwrap()
    }

    /// A strip pulled along an angle \[degrees\]: stretches along and across.
    fn pulled(degrees: f64, along: f64, across: f64) -> Solution {
        let axis = DVec2::from_angle(degrees.to_radians());
        let place = move |p: DVec2| {
            axis * (along * axis.dot(p)) + axis.perp() * (across * axis.perp().dot(p))
        };
        with_skin(false, place)
    }

    #[test]
    fn a_strip_pulled_one_way_wrinkles_along_the_pull() {
        for degrees in [0.0, 30.0, 90.0, 135.0] {
            // Wider than 1 − ν · 0.2 = 0.91 there are no wrinkles.
            let taut = pulled(degrees, 1.2, 0.92);
            assert_eq!(Shares::new(&taut), Some(Shares::default()));
            let wrinkled = pulled(degrees, 1.2, 0.88);
            let shares = Shares::new(&wrinkled).unwrap();
            assert!((shares.wrinkled - 1.0).abs() < 1e-12, "{shares:?}");
            assert!((shares.visible_over_pocket - 1.0).abs() < 1e-12, "{shares:?}");
            let axis = DVec2::from_angle(degrees.to_radians());
            let fields = Fields::new(Arc::new(wrinkled));
            let (states, strains) =
                (fields.values(Field::WrinkleState), fields.values(Field::WrinkleStrain));
            let crests = fields.wrinkle_directions();
            for k in fields.solution().deformation().inside() {
                assert_eq!(fields.skin_state(k), Some(FieldState::Wrinkled));
                assert!(states[k] == 1.0 && (strains[k] - 0.03).abs() < 1e-6, "{k}");
                assert!(crests[k].as_dvec2().perp_dot(axis).abs() < 1e-6, "{k}: {}", crests[k]);
                assert!((crests[k].length() - 1.0).abs() < 1e-6);
            }
            // Outside of the patch.
            assert!(states[0] == 0.0 && crests[0] == Vec2::ZERO);
            let taut = Fields::new(Arc::new(taut));
            assert!(taut.wrinkle_directions().iter().all(|crest| *crest == Vec2::ZERO));
        }
    }

    #[test]
    fn crests_of_a_symmetric_shape_are_mirrored_with_the_shape() {
        // The circles of the skin shrink by more than the radii.
        let place = |p: DVec2| p * (0.7 + 0.15 * p.length() / 100.0);
        for mirrored in [true, false] {
            let fields = Fields::new(Arc::new(with_skin(mirrored, |p| place(p) * 1.15)));
            let solution = fields.solution();
            let rest = solution.problem().sheet().rest();
            let mut count = 0;
            for (k, crest) in fields.wrinkle_directions().iter().enumerate() {
                if *crest == Vec2::ZERO || solution.problem().sheet().kinds()[k] != NodeKind::Free {
                    continue;
                }
                let off = crest.as_dvec2().perp_dot(rest[k].normalize()).abs();
                assert!(off < 0.05, "{mirrored} {k}: {crest} at {}", rest[k]);
                count += 1;
            }
            assert!(count > 40, "{count}");
        }
    }

    #[test]
    fn slack_skin_has_no_stress_and_no_direction() {
        let slack = pulled(20.0, 0.97, 0.8);
        assert!((Shares::new(&slack).unwrap().wrinkled - 1.0).abs() < 1e-12);
        let loads = layers::loads(slack.problem().membrane(), slack.deformation(), true);
        assert!(loads[0].max_stress == 0.0 && !loads[0].is_beyond_data);
        let slack = Fields::new(Arc::new(slack));
        assert!(slack.values(Field::Stress(0)).iter().all(|stress| *stress == 0.0));
        assert!(slack.values(Field::WrinkleState).contains(&2.0));
        assert!(slack.wrinkle_directions().iter().all(|crest| *crest == Vec2::ZERO));
        // Wrinkled skin: that of uniaxial tension, 100 kPa · 0.2.
        let wrinkled = Fields::new(Arc::new(pulled(20.0, 1.2, 0.7)));
        let greatest = wrinkled.values(Field::Stress(0)).iter().copied().fold(0.0, f32::max);
        assert!((greatest - 20.0).abs() < 1e-3, "{greatest}");
    }

    #[test]
    fn tissue_at_rest_is_taut() {
        assert_eq!(Shares::new(&with_skin(false, |p| p)), Some(Shares::default()));
    }
}
