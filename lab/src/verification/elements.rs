//! Checks without a solve: homogeneous states of cells, membrane and law, rigid rotation, forces as the gradient of the energy.
//!
//! Uses `check`, `measurements::slab`, `model`. Used by `mod`.

use super::check::Check;
use crate::measurements::slab::{Slab, closed_equibiaxial};
use glam::{DMat3, DVec3};
use implant_preview_core::curve::{Curve, CurveError, CurveSpec, Fat};
use implant_preview_core::mesh::{Attachment, NodeKind, Pocket, Rest, Sheet};
use implant_preview_core::model::layered::LayeredLaw;
use implant_preview_core::model::layered::exact::Exact;
use implant_preview_core::model::membrane::assembly;
use implant_preview_core::springs::Material;

/// Grid of the checks: nodes per side, radius and pocket radius \[mm\].
const NODES: usize = 33;
const RADIUS_MM: f64 = 60.0;
const POCKET_MM: f64 = 40.0;
/// Fraction of the radius within which all cells around a node are whole squares.
const INSIDE: f64 = 0.8;
/// Weight of the second invariant in the solid law \[-\].
const BETA: f64 = 0.2;

/// Place of the checks that contain the cells on the patch's circle. The stabilisation of these cells counts the twist that a
/// linear displacement has in a distorted quadrilateral: they are consistent only as far as they are parallelograms.
const BORDER: &str = "cells with those on the patch's circle (not exact)";

/// Skin on fat.
fn materials() -> Result<[Material; 2], CurveError> {
    let (skin, fat) = (CurveSpec::Skin {}, CurveSpec::Fat { variant: Fat::Mid });
    Ok([Material::new(Curve::new(&skin)?, 0.45, 1.5), Material::new(Curve::new(&fat)?, 0.49, 8.5)])
}

/// All checks of this file.
pub(super) fn checks() -> Result<Vec<Check>, CurveError> {
    let materials = materials()?;
    let law = LayeredLaw::new(&materials);
    let rest = Rest::layered(Sheet::new(NODES, RADIUS_MM), &[materials[1].thickness_mm], 2);
    let exact = Exact::new(&rest, &law, Pocket::round(POCKET_MM), None);
    let mut checks = patch_test(&exact, &materials[1]);
    checks.push(rotation(&exact, &materials[1]));
    checks.push(gradient(&exact));
    checks.extend(homogeneous(&materials[1]));
    Ok(checks)
}

/// All layers of nodes, moved.
fn moved(exact: &Exact, to: impl Fn(DVec3) -> DVec3) -> Vec<Vec<DVec3>> {
    let nodes = |layer: usize| exact.rest.nodes(layer).map(&to).collect();
    (0..exact.rest.layers()).map(nodes).collect()
}

/// Forces of a homogeneous deformation, which vanish inside: in the membrane alone, in the middle layer of nodes, and on the faces,
/// where the solid's traction acts on the nodes' areas.
fn patch_test(exact: &Exact, solid: &Material) -> Vec<Check> {
    const F: DMat3 = DMat3::from_cols_array(&[
        1.12, 0.03, 0.02, //
        -0.05, 1.06, -0.04, //
        0.08, 0.03, 0.92,
    ]);
    let sheet = exact.rest.sheet();
    let area = sheet.spacing_mm().powi(2);
    let x = moved(exact, |rest| F * rest);
    let free = |k: &usize| sheet.kinds()[*k] == NodeKind::Free;
    let inside = |k: &usize| sheet.rest()[*k].length() < INSIDE * RADIUS_MM;
    let property = "homogeneous deformation without forces inside";

    let skin = &x[x.len() - 1];
    let mut forces = vec![DVec3::ZERO; sheet.len()];
    let totals = assembly::forces(exact.rest.membrane(), &exact.law.skin, skin, &mut forces);
    let greatest = (0..sheet.len()).filter(free).map(|k| forces[k].length()).fold(0.0, f64::max);
    let scale = totals.force_scale() / (sheet.free_nodes() as f64).sqrt();
    let mut checks =
        vec![Check::at_most(property, "membrane with its border", greatest / scale, 1e-10)];

    let law = &exact.law.solids[0];
    let (stress, _) = law.response(F.to_cols_array_2d());
    let traction = area * DVec3::from(stress[2]);
    let scale = area * stress.iter().flatten().map(|p| p * p).sum::<f64>().sqrt();
    let forces = exact.forces(&x);
    let top = x.len() - 1;
    let in_middle = |is_counted: &dyn Fn(&usize) -> bool| {
        let nodes = (0..sheet.len()).filter(free).filter(|k| is_counted(k));
        let of =
            |k: usize| forces[1..top].iter().map(|layer| layer[k].length()).fold(0.0, f64::max);
        nodes.map(of).fold(0.0, f64::max) / scale
    };
    checks.push(Check::at_most(property, "cells", in_middle(&inside), 1e-10));
    checks.push(Check::at_most(property, BORDER, in_middle(&|_| true), 0.05));
    let faces = (0..sheet.len()).filter(free).filter(inside).map(|k| {
        let (outer, inner) = (forces[top][k] + traction, forces[0][k] - traction);
        outer.length().max(inner.length())
    });
    let figure = faces.fold(0.0, f64::max) / scale;
    checks.push(Check::at_most(
        "traction of a homogeneous deformation",
        "faces of the cells",
        figure,
        1e-10,
    ));

    let energy = exact.energy(&exact.places(), &x)
        - assembly::energy(exact.rest.membrane(), &exact.law.skin, skin);
    let volume: f64 = sheet.triangles().map(|(t, weight)| weight * sheet.rest_area(t)).sum::<f64>()
        * solid.thickness_mm;
    let expected = law.energy_of(F.to_cols_array_2d()) * volume;
    let figure = (energy / expected - 1.0).abs();
    checks.push(Check::at_most("energy of a homogeneous deformation", BORDER, figure, 2e-3));
    checks
}

/// Forces after a rigid motion, over Young's modulus and the area of a cell.
fn rotation(exact: &Exact, solid: &Material) -> Check {
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, -0.64, 0.48), 1.1);
    let forces = exact.forces(&moved(exact, |rest| turn * rest + DVec3::new(3.0, -8.0, 40.0)));
    let inside = |k: &usize| exact.rest.sheet().rest()[*k].length() < INSIDE * RADIUS_MM;
    let of = |layer: &Vec<DVec3>| {
        (0..layer.len()).filter(inside).map(|k| layer[k].length()).fold(0.0, f64::max)
    };
    let greatest = forces.iter().map(of).fold(0.0, f64::max);
    let scale = solid.curve.small_strain_modulus() * exact.rest.sheet().spacing_mm().powi(2);
    Check::at_most("rigid rotation without forces", "cells and membrane", greatest / scale, 1e-10)
}

/// Slope of the energy against the forces, in four directions, attachment and wrinkled skin included.
fn gradient(exact: &Exact) -> Check {
    let attachment = Some(Attachment::default());
    let exact = Exact::new(exact.rest, exact.law, exact.pocket, attachment);
    let wave = |p: DVec3| {
        let [a, b] = [0.11 * p.x, 0.09 * p.y];
        p + DVec3::new(
            1.5 * (a + b).sin() - 0.04 * p.x,
            0.8 * (a - b).cos(),
            6.0 * a.cos() * b.cos(),
        )
    };
    let x = moved(&exact, wave);
    let forces = exact.forces(&x);
    let places = exact.places();
    let mut random = fastrand::Rng::with_seed(7);
    let mut figure: f64 = 0.0;
    for _ in 0..4 {
        let way: Vec<Vec<DVec3>> = forces
            .iter()
            .map(|layer| {
                let one = |f: &DVec3| *f * (0.2 + 1.6 * random.f64());
                layer.iter().map(one).collect()
            })
            .collect();
        let longest = way.iter().flatten().map(|d| d.length()).fold(0.0, f64::max);
        let step = 1e-5 / longest;
        let energy = |sign: f64| {
            let at = |(x, d): (&Vec<DVec3>, &Vec<DVec3>)| {
                x.iter().zip(d).map(|(x, d)| *x + *d * (sign * step)).collect::<Vec<_>>()
            };
            exact.energy(&places, &x.iter().zip(&way).map(at).collect::<Vec<_>>())
        };
        let slope = (energy(1.0) - energy(-1.0)) / (2.0 * step);
        let pairs = forces.iter().flatten().zip(way.iter().flatten());
        let power: f64 = pairs.map(|(f, d)| f.dot(*d)).sum();
        figure = figure.max((slope / -power - 1.0).abs());
    }
    Check::at_most(
        "gradient of the energy = − force",
        "cells; wrinkled skin; attachment",
        figure,
        1e-7,
    )
}

/// The law with its tables against the curve and against the closed form.
fn homogeneous(solid: &Material) -> Vec<Check> {
    let slab = Slab::new(solid);
    let (curve, nu) = (&solid.curve, solid.poisson_ratio);
    let (mut stress, mut across, mut biaxial) = (0.0_f64, 0.0_f64, 0.0_f64);
    for stretch in [1.05_f64, 1.2, 1.4, 1.8] {
        let (found, log) = slab.uniaxial(stretch);
        across = across.max((log / (-nu * stretch.ln()) - 1.0).abs());
        stress = stress.max((found / curve.stress(stretch - 1.0) - 1.0).abs());
        let closed = closed_equibiaxial(curve, nu, BETA, stretch);
        biaxial = biaxial.max((slab.equibiaxial(stretch) / closed - 1.0).abs());
    }
    let place = "law of the cells; fat ν 0.49";
    vec![
        Check::at_most("uniaxial stress = Ef", place, stress, 1e-4),
        Check::at_most("transverse logarithmic strain = −ν ln λ", place, across, 1e-6),
        Check::at_most("equibiaxial stress = closed form", place, biaxial, 1e-4),
    ]
}
