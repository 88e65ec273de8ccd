//! Tests of the forces of a level: those of the exact sums, gradients of the energy.

use super::*;
use crate::curve::CurveSpec;
use crate::mesh::{Attachment, Chest, NaturalStretch, Pocket, Sheet, Weight};
use crate::model::layered::LayeredLaw;
use crate::model::layered::exact::Exact;
use crate::model::layered::lanes::Layered;
use crate::model::membrane::assembly;
use crate::model::membrane::lanes::Membrane;
use crate::model::membrane::law::SheetLaw;
use crate::springs::solids::SolidKind;
use crate::springs::{Material, Springs};

/// Forces in lanes of f32 equal the forces of the assembly in f64.
#[test]
fn lane_forces_equal_the_forces_of_the_assembly() {
    let skin = || Material::of(&CurveSpec::Skin {}, 0.3, 2.0);
    let adipose = Material::of(&CurveSpec::Adipose {}, 0.45, 2.0);
    let stacks = [vec![skin()], vec![skin(), adipose]];
    for (springs, materials) in [Springs::Coupled, Springs::Nikolaev]
        .into_iter()
        .flat_map(|s| stacks.clone().map(|m| (s, m)))
    {
        for mirrored in [[false; 2], [true, false], [false, true], [true; 2]] {
            let n = 33;
            let law = SheetLaw::new(springs, &materials);
            let rest = Rest::of_sheet(Sheet::new(n, (n / 2) as f64));
            let sheet = rest.sheet();
            let mut level = Level::new(n, mirrored, true, 0, &Membrane::new(&law));
            let first = level.layout.first();
            // A bulge with ripples, symmetric about both axes.
            let bulge = |p: DVec2| {
                let r = p.length() / 16.0;
                let z = 6.0 * (1.0 - r * r) + 0.2 * (0.9 * p.x).cos() * (0.7 * p.y).cos();
                DVec3::new(0.02 * p.x * (p.y * 0.5).cos(), -0.03 * p.y * (1.0 - r), z)
            };
            let Level { layout, u, .. } = &mut level;
            let mut x: Vec<DVec3> = rest.nodes(0).collect();
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let k = (j + first[1]) * n + i + first[0];
                    let d = bulge(sheet.rest()[k]);
                    let at = j * layout.pitch + i;
                    (u.x[at], u.y[at], u.z[at]) = (d.x as f32, d.y as f32, d.z as f32);
                }
            });
            layout.mirror(u);
            for (k, p) in sheet.rest().iter().enumerate() {
                if sheet.kinds()[k] == crate::mesh::NodeKind::Free {
                    x[k] = p.extend(0.0) + bulge(*p);
                }
            }
            let mut exact = vec![DVec3::ZERO; sheet.len()];
            assembly::forces(rest.membrane(), &law, &x, &mut exact);
            let greatest = exact.iter().map(|f| f.length()).fold(0.0, f64::max);
            level.find_forces(&Membrane::new(&law));
            let Level { layout, f, .. } = &level;
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let [x, y, z] = f.at(j * layout.pitch + i).map(f64::from);
                    let force = DVec3::new(x, y, z) * law.stiffness();
                    let error = force.distance(exact[(j + first[1]) * n + i + first[0]]);
                    assert!(error < 1e-4 * greatest, "{springs:?} ({i}, {j}): {error:.1e}");
                }
            });
        }
    }
}

/// Forces of the layered body in lanes of f32 equal those in f64, which are the gradient of the energy.
#[test]
fn layered_forces_equal_the_exact_forces_and_the_gradient_of_the_energy() {
    let curved = Chest::Curved { across_mm: 130.0, along_mm: 300.0 };
    for chest in [Chest::Flat, curved] {
        for &solid in SolidKind::ALL {
            compare_layered_forces(chest.clone(), solid, None, POCKET);
        }
        let lowered = Pocket { lowered_mm: 12.0, ..POCKET };
        compare_layered_forces(chest.clone(), SolidKind::Curve, None, lowered);
        let natural = |direction| NaturalStretch::new([1.08, 1.03], direction);
        for natural in [natural(0.0), natural(0.7)] {
            compare_layered_forces(chest.clone(), SolidKind::Curve, natural, POCKET);
        }
    }
}

const POCKET: Pocket = Pocket::round(40.0);

/// Forces in lanes against those in f64, node by node: one scene with all that acts on it.
fn compare_layered_forces(
    chest: Chest,
    solid: SolidKind,
    natural: Option<NaturalStretch>,
    pocket: Pocket,
) {
    let material = |spec: &CurveSpec, poisson_ratio, thickness_mm| Material {
        solid,
        ..Material::of(spec, poisson_ratio, thickness_mm)
    };
    let materials = [
        material(&CurveSpec::Skin {}, 0.45, 1.5),
        material(&CurveSpec::Adipose {}, 0.3, 8.0),
        material(&CurveSpec::Linear { modulus_kpa: 12.0 }, 0.45, 5.0),
    ];
    let law = LayeredLaw::new(&materials);
    let n = 33;
    let rest = Rest::layered(Sheet::new(n, 80.0), &[5.0, 8.0], 3).over(chest).stretched(natural);
    let weight = Weight { per_volume: DVec3::new(0.0, -0.1, 0.06), skin_mm: 1.5 };
    let rest = rest.weighed(Some(weight).filter(|_| pocket.is_lowered()).unwrap_or_default());
    let sheet = rest.sheet();
    let attachment = Some(Attachment::default());
    let exact = Exact::new(&rest, &law, pocket, attachment);
    let bulge = |p: DVec2, layer: usize| {
        let s = p.length() / 80.0;
        let z =
            (18.0 - 2.0 * layer as f64) * (1.0 - s * s) + (0.11 * p.x).cos() * (0.13 * p.y).cos();
        DVec3::new(0.06 * p.x * (p.y * 0.05).cos(), -0.04 * p.y, z) * (1.0 - s * s)
    };
    let layers = rest.layers();
    let mut x: Vec<Vec<DVec3>> = (0..layers).map(|l| rest.nodes(l).collect()).collect();
    for (l, x) in x.iter_mut().enumerate() {
        for (k, p) in sheet.rest().iter().enumerate() {
            if sheet.kinds()[k] == crate::mesh::NodeKind::Free {
                x[k] += bulge(*p, l);
            }
        }
    }
    let forces = exact.forces(&x);
    let greatest = forces.iter().flatten().map(|f| f.length()).fold(0.0, f64::max);
    // The gradient at some nodes: in the ring of four points, at the border, in the middle.
    for (l, k) in [
        (0, 16 * n + 16),
        (1, 16 * n + 24),
        (2, 12 * n + 20),
        (3, 16 * n + 30),
        (1, 5 * n + 6),
        (0, 16 * n + 27),
    ] {
        if sheet.kinds()[k] != crate::mesh::NodeKind::Free {
            continue;
        }
        for axis in 0..3 {
            let moved = |by: f64| {
                let mut x = x.clone();
                x[l][k][axis] += by;
                exact.energy(&exact.places(), &x)
            };
            let slope = (moved(1e-4) - moved(-1e-4)) / 2e-4;
            let error = (forces[l][k][axis] + slope).abs();
            assert!(error < 1e-4 * greatest, "{l} {k} {axis}: {error:e} of {greatest:e}");
        }
    }
    for mirrored in [[false; 2], [true, false], [true; 2]] {
        if mirrored[0] && !rest.mirrored()[0] || mirrored[1] && pocket.is_lowered() {
            continue;
        }
        let model = Layered::new(&law, &rest, pocket, attachment);
        let mut level = Level::new(n, mirrored, true, 0, &model);
        level.fit(&model, sheet.spacing_mm(), &rest);
        let Level { layout, u, .. } = &mut level;
        let first = layout.first();
        let length = layout.len();
        for l in 0..layers {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let k = (j + first[1]) * n + i + first[0];
                    let d = bulge(sheet.rest()[k], l) / sheet.spacing_mm();
                    let at = l * length + j * layout.pitch + i;
                    (u.x[at], u.y[at], u.z[at]) = (d.x as f32, d.y as f32, d.z as f32);
                }
            });
        }
        layout.mirror(u);
        level.find_forces(&model);
        let unit = law.skin.stiffness() * sheet.spacing_mm();
        let Level { layout, f, .. } = &level;
        for (l, exact) in forces.iter().enumerate() {
            layout.free_rows(|j, from, to| {
                for i in from..to {
                    let at = f.at(l * length + j * layout.pitch + i).map(f64::from);
                    let k = (j + first[1]) * n + i + first[0];
                    let error = (DVec3::from(at) * unit).distance(exact[k]);
                    assert!(error < 1e-4 * greatest, "{mirrored:?} {l} ({i}, {j}): {error:.1e}");
                }
            });
        }
    }
}
