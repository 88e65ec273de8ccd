//! Cells at rest over a curved wall, and principal values.

use super::*;
use crate::curve::CurveSpec;
use crate::mesh::{Chest, Pocket};
use crate::springs::Material;

const CHEST: Chest = Chest::Curved { across_mm: 110.0, along_mm: 200.0 };
const THICKNESS_MM: f64 = 14.0;

fn law(skin_mm: f64) -> LayeredLaw {
    let fat = CurveSpec::Exponential { scale_kpa: 2.0, rate: 3.0 };
    LayeredLaw::new(&[
        Material::of(&CurveSpec::Skin {}, 0.45, skin_mm),
        Material::of(&fat, 0.45, THICKNESS_MM),
    ])
}

fn rest(nodes: usize) -> Rest {
    Rest::layered(Sheet::new(nodes, 60.0), &[THICKNESS_MM], 2).over(CHEST)
}

/// Forces after an affine map of the body over a curved wall, and the greatest force on a node within the pocket's middle.
fn after(rest: &Rest, law: &LayeredLaw, map: impl Fn(DVec3) -> DVec3) -> (Vec<Vec<DVec3>>, f64) {
    let exact = Exact::new(rest, law, Pocket::round(30.0), None);
    let x: Vec<Vec<DVec3>> =
        (0..rest.layers()).map(|l| rest.nodes(l).map(&map).collect()).collect();
    let forces = exact.forces(&x);
    let places = rest.sheet().rest();
    let inside = |k: &usize| places[*k].length() < 45.0;
    let middle = |layer: &Vec<DVec3>| {
        (0..layer.len()).filter(inside).map(|k| layer[k].length()).fold(0.0, f64::max)
    };
    let greatest = forces[1..rest.layers() - 1].iter().map(middle).fold(0.0, f64::max);
    (forces, greatest)
}

#[test]
fn a_rotation_of_the_body_over_a_curved_wall_turns_its_forces() {
    let (law, rest) = (law(1.5), rest(17));
    let turn = DMat3::from_axis_angle(DVec3::new(0.6, -0.64, 0.48), 1.1);
    let stretch = DVec3::new(1.01, 1.02, 1.0);
    let (before, _) = after(&rest, &law, |x| x * stretch);
    let (turned, _) = after(&rest, &law, |x| turn * (x * stretch) + DVec3::new(3.0, -8.0, 40.0));
    let pairs = before.iter().flatten().zip(turned.iter().flatten());
    let error = pairs.map(|(f, g)| (turn * *f).distance(*g)).fold(0.0, f64::max);
    let greatest = before.iter().flatten().map(|f| f.length()).fold(0.0, f64::max);
    assert!(greatest > 1.0 && error < 1e-9 * greatest, "{error:e} {greatest:e}");
}

/// A homogeneous deformation of the body over a curved wall: the force on inner nodes vanishes by the second power of the
/// spacing beside the force of a cell's stress, and the energy is that of the volume.
#[test]
fn homogeneous_deformation_over_a_curved_wall_is_of_second_order() {
    let f = DMat3::from_cols(
        DVec3::new(1.10, 0.03, 0.02),
        DVec3::new(-0.05, 1.06, -0.04),
        DVec3::new(0.08, 0.03, 0.92),
    );
    let law = law(1e-9);
    let solid = &law.solids[0];
    let (stress, _) = solid.response(f.to_cols_array_2d());
    let stress = matrix(stress).to_cols_array().iter().map(|p| p * p).sum::<f64>().sqrt();
    let errors = [17, 33].map(|nodes| {
        let rest = rest(nodes);
        let (_, greatest) = after(&rest, &law, |x| f * x);
        let exact = Exact::new(&rest, &law, Pocket::round(30.0), None);
        let x: Vec<Vec<DVec3>> =
            (0..rest.layers()).map(|l| rest.nodes(l).map(|x| f * x).collect()).collect();
        let places = exact.places();
        let mut volume = 0.0;
        exact.each(&places, &x, |element| volume += element.shape.volume);
        let spacing = rest.sheet().spacing_mm();
        let expected = solid.energy_of(f.to_cols_array_2d()) * volume * spacing * spacing;
        let energy = exact.energy(&places, &x);
        (greatest / (stress * spacing * spacing), (energy / expected - 1.0).abs())
    });
    let [(coarse, energy), (fine, fine_energy)] = errors;
    assert!(fine < 1e-5 && fine < coarse / 3.5, "{errors:?}");
    assert!(energy < 1e-6 && fine_energy < 1e-6, "{errors:?}");
}

/// The volume of a layer of a sphere: cells over a curved wall.
#[test]
fn cells_over_a_sphere_have_its_volume() {
    let radius = 150.0;
    let chest = Chest::Curved { across_mm: radius, along_mm: radius };
    let rest = Rest::layered(Sheet::new(65, 60.0), &[THICKNESS_MM], 2).over(chest);
    let law = law(1.5);
    let exact = Exact::new(&rest, &law, Pocket::round(30.0), None);
    let x: Vec<Vec<DVec3>> = (0..rest.layers()).map(|l| rest.nodes(l).collect()).collect();
    let mut volume = 0.0;
    exact.each(&exact.places(), &x, |element| volume += element.shape.volume);
    volume *= rest.sheet().spacing_mm().powi(2);
    let cap = |r: f64| std::f64::consts::TAU / 3.0 * r.powi(3) * (1.0 - (60.0 / radius).cos());
    let expected = cap(radius + THICKNESS_MM) - cap(radius);
    assert!((volume / expected - 1.0).abs() < 1e-3, "{volume} {expected}");
    assert!(exact.energy(&exact.places(), &x).abs() < 1e-9);
}

#[test]
fn principal_values_and_directions_diagonalise_a_matrix() {
    let a = DMat3::from_cols(
        DVec3::new(2.0, -0.3, 0.7),
        DVec3::new(-0.3, 1.1, 0.4),
        DVec3::new(0.7, 0.4, 1.9),
    );
    let (values, directions) = principal(a);
    for (value, direction) in values.into_iter().zip(directions) {
        assert!((a * direction - direction * value).length() < 1e-11);
        assert!((direction.length() - 1.0).abs() < 1e-12);
    }
}
