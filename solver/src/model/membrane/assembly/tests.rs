//! Properties of energy, forces and Hessian.

use super::*;
use crate::curve::{Curve, CurveSpec};
use crate::mesh::{Rest, Sheet};
use crate::springs::Material;
use crate::springs::Springs;
use glam::DVec2;

fn materials() -> Vec<Material> {
    vec![
        Material::of(&CurveSpec::Skin {}, 0.45, 1.5),
        Material::of(&CurveSpec::Adipose {}, 0.3, 10.0),
    ]
}

/// A sheet in tension, bulged and bumpy.
fn bumpy(sheet: &Sheet) -> Vec<DVec3> {
    let bump = |k: usize, f: f64| 0.02 * (f * k as f64).sin();
    (0..sheet.len())
        .map(|k| {
            let p = sheet.rest()[k];
            let z = 0.4 * (1.0 - p.length_squared());
            DVec3::new(1.2 * p.x + bump(k, 1.3), 1.15 * p.y + bump(k, 2.1), z + bump(k, 3.7))
        })
        .collect()
}

fn both() -> [SheetLaw; 2] {
    [Springs::Coupled, Springs::Nikolaev].map(|springs| SheetLaw::new(springs, &materials()))
}

#[test]
fn forces_are_the_negative_slope_of_the_energy() {
    let rest = Rest::of_sheet(Sheet::new(9, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    for law in both() {
        let mut x = bumpy(sheet);
        let mut f = vec![DVec3::ZERO; sheet.len()];
        let totals = forces(surface, &law, &x, &mut f);
        assert!((totals.energy - energy(surface, &law, &x)).abs() < 1e-12 * totals.energy.abs());
        for (nodes, _) in sheet.triangles().step_by(3) {
            let k = nodes[0];
            for axis in 0..3 {
                let (home, step) = (x[k], 1e-6);
                x[k][axis] = home[axis] + step;
                let up = energy(surface, &law, &x);
                x[k][axis] = home[axis] - step;
                let down = energy(surface, &law, &x);
                x[k] = home;
                let slope = (up - down) / (2.0 * step);
                let error = (slope + f[k][axis]).abs();
                assert!(error < 1e-5 * totals.force_scale(), "{k} {axis}: {slope} {}", f[k][axis]);
            }
        }
    }
}

#[test]
fn the_true_hessian_is_the_slope_of_the_forces() {
    let rest = Rest::of_sheet(Sheet::new(9, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    for law in both() {
        let x = bumpy(sheet);
        let mut f = vec![DVec3::ZERO; sheet.len()];
        let mut hessian = BlockStencil9::new(9);
        let mut totals = Totals::default();
        let mut add = |rows| {
            let to = Sums { forces: &mut f, hessian: &mut hessian, totals: &mut totals };
            linearize_rows(surface, &law, &x, rows, Stiffness::True, to);
        };
        // In pieces, as the solver does.
        add(0..3);
        add(3..8);
        let direction: Vec<DVec3> = (0..sheet.len())
            .map(|k| {
                let t = k as f64;
                DVec3::new((5.1 * t).sin(), (3.3 * t).cos(), (2.7 * t).sin())
            })
            .collect();
        let step = 1e-7;
        let moved = |sign: f64| -> Vec<DVec3> {
            let x: Vec<DVec3> =
                x.iter().zip(&direction).map(|(x, d)| *x + *d * (sign * step)).collect();
            let mut f = vec![DVec3::ZERO; sheet.len()];
            forces(surface, &law, &x, &mut f);
            f
        };
        let (up, down) = (moved(1.0), moved(-1.0));
        let (mut error, mut scale) = (0.0_f64, 0.0_f64);
        for k in 0..sheet.len() {
            // Free nodes are inside the array; the others' rows need no boundary care.
            if sheet.kinds()[k] == crate::mesh::NodeKind::Free {
                let slope = (down[k] - up[k]) / (2.0 * step);
                error = error.max((slope - hessian.row(k, &direction)).length());
                scale = scale.max(slope.length());
            }
        }
        assert!(error < 1e-4 * scale, "{error} of {scale}");
    }
}

#[test]
fn the_hessian_is_symmetric() {
    let n = 17;
    let rest = Rest::of_sheet(Sheet::new(n, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    let free = |k: &usize| sheet.kinds()[*k] == crate::mesh::NodeKind::Free;
    let wave = |f: f64| -> Vec<DVec3> {
        let at = |k: usize| DVec3::new(k as f64, 0.3, 1.7 * k as f64) * f;
        let at = |k: usize| {
            if free(&k) { at(k).to_array().map(f64::sin).into() } else { DVec3::ZERO }
        };
        (0..sheet.len()).map(at).collect()
    };
    let (u, v) = (wave(5.1), wave(3.3));
    for law in both() {
        for stiffness in [Stiffness::True, Stiffness::Positive] {
            let mut f = vec![DVec3::ZERO; sheet.len()];
            let mut hessian = BlockStencil9::new(n);
            let mut totals = Totals::default();
            let to = Sums { forces: &mut f, hessian: &mut hessian, totals: &mut totals };
            linearize_rows(surface, &law, &bumpy(sheet), 0..n - 1, stiffness, to);
            let bend = |u: &[DVec3], v: &[DVec3]| -> f64 {
                let nodes = (0..sheet.len()).filter(free);
                nodes.map(|k| u[k].dot(hessian.row(k, v))).sum()
            };
            let scale = (bend(&u, &u) * bend(&v, &v)).abs().sqrt();
            let difference = (bend(&u, &v) - bend(&v, &u)).abs();
            assert!(difference < 1e-12 * scale, "{stiffness:?}: {difference} of {scale}");
        }
    }
}

/// The patch test, border cells included: coupled springs keep an evenly stretched sheet in balance
/// at every free node, and the virial −Σ f⊗X/A of all nodes is Ef(ε) along a uniaxial pull and
/// nothing across.
#[test]
fn an_evenly_pulled_sheet_is_balanced_and_shows_the_curve_in_every_direction() {
    let rest = Rest::of_sheet(Sheet::new(21, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    let area: f64 = sheet.triangles().map(|(t, w)| w * sheet.rest_area(t)).sum();
    let irregular = sheet
        .triangles()
        .filter(|(t, _)| t.iter().any(|k| sheet.kinds()[*k] == crate::mesh::NodeKind::Clamped));
    assert!(irregular.count() > 50);
    for (spec, nu) in [(CurveSpec::Skin {}, 0.45), (CurveSpec::Adipose {}, 0.2)] {
        let curve = Curve::new(&spec).unwrap();
        let material = Material::new(curve.clone(), nu, 1.0);
        let law = SheetLaw::new(Springs::Coupled, &[material]);
        for degrees in (0..180).step_by(7) {
            for strain in [0.01, 0.3, 0.8] {
                let along = DVec2::from_angle(f64::from(degrees).to_radians());
                let across = along.perp();
                let pulled = |p: &DVec2| {
                    let [a, b] = [p.dot(along), p.dot(across)];
                    (along * (a * (1.0 + strain)) + across * (b * (1.0 - nu * strain))).extend(0.0)
                };
                let x: Vec<DVec3> = sheet.rest().iter().map(pulled).collect();
                let mut f = vec![DVec3::ZERO; sheet.len()];
                forces(surface, &law, &x, &mut f);
                let stress = curve.stress(strain);
                let mut virial = [0.0; 3];
                for (k, f) in f.iter().enumerate() {
                    if sheet.kinds()[k] == crate::mesh::NodeKind::Free {
                        let error = f.length();
                        assert!(error < 1e-13 * stress, "{degrees}° {strain}: {error}");
                    }
                    let (f, p) = (f.truncate(), sheet.rest()[k]);
                    virial[0] -= f.dot(along) * p.dot(along) / area;
                    virial[1] -= f.dot(across) * p.dot(across) / area;
                    virial[2] -= f.dot(across) * p.dot(along) / area;
                }
                // The law's table is good to 1e-5 of its peak.
                let tolerance = 1e-5 * curve.stress(curve.line_start());
                let wanted = [stress, 0.0, 0.0];
                for (found, wanted) in virial.iter().zip(wanted) {
                    assert!((found - wanted).abs() < tolerance, "{degrees}° {strain}: {virial:?}");
                }
            }
        }
    }
}

#[test]
fn forces_sum_to_zero_and_give_no_torque() {
    let rest = Rest::of_sheet(Sheet::new(17, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    for law in both() {
        let x = bumpy(sheet);
        let mut f = vec![DVec3::ZERO; sheet.len()];
        let scale = forces(surface, &law, &x, &mut f).force_scale();
        let sum: DVec3 = f.iter().sum();
        let torque: DVec3 = x.iter().zip(&f).map(|(x, f)| x.cross(*f)).sum();
        assert!(sum.length() < 1e-12 * scale && torque.length() < 1e-12 * scale);
    }
}

#[test]
fn a_rotated_sheet_has_rotated_forces() {
    let rest = Rest::of_sheet(Sheet::new(17, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    let turn = DMat3::from_axis_angle(DVec3::new(0.48, 0.6, 0.64), 1.1);
    for law in both() {
        let x = bumpy(sheet);
        let turned: Vec<DVec3> = x.iter().map(|x| turn * *x).collect();
        let mut f = vec![DVec3::ZERO; sheet.len()];
        let mut g = f.clone();
        let scale = forces(surface, &law, &x, &mut f).force_scale();
        forces(surface, &law, &turned, &mut g);
        assert!(f.iter().zip(&g).all(|(f, g)| (turn * *f - *g).length() < 1e-12 * scale));
    }
}

#[test]
fn forces_in_closed_form_are_those_of_the_principal_strains() {
    let rest = Rest::of_sheet(Sheet::new(17, 1.0));
    let (sheet, surface) = (rest.sheet(), rest.membrane());
    for law in both() {
        let x = bumpy(sheet);
        let mut f = vec![DVec3::ZERO; sheet.len()];
        forces(surface, &law, &x, &mut f);
        let scale = f.iter().map(|f| f.length()).fold(0.0, f64::max);
        let closed = forces_at(
            surface,
            &law,
            &x,
            Part::whole(sheet.nodes_per_side()),
            &vec![true; sheet.len()],
        );
        for (a, b) in closed.iter().zip(&f) {
            assert!(a.distance(*b) < 1e-11 * scale, "{a} {b}");
        }
    }
}
