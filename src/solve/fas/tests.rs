//! What holds of the scheme as a whole.

use super::*;
use crate::curve::{Curve, CurveSpec};
use crate::solve::assemble;
use crate::springs::{Material, Springs};
use glam::{DVec2, DVec3};

/// The finest grid's cycles, before contact is let end between its nodes, only ever lower the energy, as
/// far as f32 can tell.
#[test]
fn the_energy_falls_in_every_cycle() {
    let material = |spec: &CurveSpec, poisson_ratio| Material {
        curve: Curve::new(spec).unwrap(),
        poisson_ratio,
        thickness_mm: 2.0,
    };
    let (skin, adipose) = (CurveSpec::Skin {}, CurveSpec::Adipose {});
    for (center, projection, springs, layers) in [
        ([0.0, 0.0], 50.0, Springs::Coupled, vec![(&skin, 0.45), (&adipose, 0.3)]),
        ([8.0, -5.0], 35.0, Springs::Coupled, vec![(&adipose, 0.45)]),
        ([0.0, 0.0], 40.0, Springs::Nikolaev, vec![(&skin, 0.3)]),
    ] {
        let problem = Problem {
            sheet: Sheet::new(65, 75.0),
            dome: Dome::new(DVec2::from(center), 50.0, projection, 1.0),
            materials: layers.into_iter().map(|(spec, nu)| material(spec, nu)).collect(),
            springs,
            tolerance: LEAST_TOLERANCE,
        };
        let law = SheetLaw::new(springs, &problem.materials);
        let mut scheme = FullMultigrid::new(65, problem.dome.mirrored());
        scheme.set_law(&law);
        scheme.start(&problem, None, None);
        let mut x: Vec<DVec3> = problem.sheet.rest().iter().map(|p| p.extend(0.0)).collect();
        let mut energies = Vec::new();
        while scheme.step() == State::Working && !scheme.is_lifted {
            let is_after_cycle = scheme.current + 1 == scheme.levels.len()
                && scheme.cycles as usize == energies.len() + 1;
            if is_after_cycle {
                scheme.write_positions(&problem, &mut x, &mut Vec::new());
                energies.push(assemble::energy(&problem.sheet, &law, &x));
            }
        }
        println!("{energies:?}");
        assert!(energies.len() >= 2);
        for pair in energies.windows(2) {
            assert!(pair[1] <= pair[0] * (1.0 + 1e-6), "{energies:?}");
        }
        assert!(energies[energies.len() - 1] < energies[0]);
    }
}
