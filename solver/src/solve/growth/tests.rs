use super::*;
use crate::curve::{Curve, CurveSpec};
use crate::mesh::{NaturalStretch, Sheet};
use crate::model::membrane::assembly;
use crate::model::membrane::deformation::Deformation;
use crate::model::membrane::law::SheetLaw;
use crate::springs::{Material, Springs};

/// A strip of skin that is pulled by λ along its natural tension and shrinks by μ across it keeps λ^(1−φ) and μ^(1−φ) over its natural
/// stretch, with the energy of that stretch per area of the skin that has grown.
#[test]
fn a_stretched_strip_keeps_what_has_not_grown() {
    let (natural, stretch, growth) = ([1.06, 1.02], [1.3, 0.97], 0.6);
    let rest = Rest::layered(Sheet::new(17, 60.0), &[8.0], 1)
        .stretched(NaturalStretch::new(natural, 0.0))
        .growing(growth);
    let x: Vec<DVec3> =
        rest.nodes(1).map(|x| DVec3::new(stretch[0] * x.x, stretch[1] * x.y, x.z)).collect();
    let rest = rest.clone().with_grown(Some(asked(&rest, &x)));
    let kept = [0, 1].map(|k| natural[k] * stretch[k].powf(1.0 - growth) - 1.0);
    let deformation = Deformation::new(rest.membrane(), &x);
    let middle = rest.sheet().len() / 2;
    let found = deformation.principal(middle);
    assert!((0..2).all(|k| (found[k] - kept[k]).abs() < 1e-6), "{found:?} {kept:?}");

    let modulus = 40.0;
    let curve = Curve::new(&CurveSpec::Linear { modulus_kpa: modulus }).unwrap();
    let skin = Material::new(curve, 0.4, 1.5);
    let law = SheetLaw::new(Springs::Coupled, &[skin]);
    let energy = assembly::energy(rest.membrane(), &law, &x);
    let [a, b] = kept;
    let density = 0.5 * modulus * 1.5 * (a * a + b * b + 0.8 * a * b) / (1.0 - 0.16);
    let grown: f64 = (0..2).map(|k| stretch[k].powf(growth) / natural[k]).product();
    let area = std::f64::consts::PI * 60.0 * 60.0 * grown;
    // The disc's border is a polygon.
    let polygon = Deformation::new(rest.outermost(), &x);
    let polygon: f64 = (0..x.len()).map(|k| polygon.rest_area(k)).sum();
    let expected = density * area * polygon / (std::f64::consts::PI * 60.0 * 60.0);
    assert!((energy / expected - 1.0).abs() < 1e-5, "{energy} {expected}");
}

#[test]
fn growths_are_mixed_to_the_fixed_point_of_a_linear_map() {
    // Γ ← b + Aγ with slow modes 0.95, 0.7 and 0.2.
    let slow = [0.95_f32, 0.7, 0.2];
    let asked =
        |x: &[f32]| -> Vec<f32> { (0..3).map(|k| 1.0 - slow[k] + slow[k] * x[k]).collect() };
    let mut growths = Growths::default();
    let mut x = vec![0.0_f32, 2.0, 3.0];
    for _ in 0..6 {
        let g = asked(&x);
        x = growths.mixed(&x, g);
    }
    assert!(x.iter().all(|x| (x - 1.0).abs() < 1e-3), "{x:?}");
}
