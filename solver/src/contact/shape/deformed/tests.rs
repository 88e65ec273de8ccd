use super::super::traits::Gauge;
use super::*;
use glam::DMat3;
use std::f64::consts::{PI, TAU};

/// Shapes at rest and numbers of their deformation, over their range.
fn soft() -> impl Iterator<Item = Deformed<HalfBall>> {
    let plain = HalfBall::round(60.0, 40.0);
    let shapes = [
        plain,
        plain.filled(0.58),
        plain.anatomical(52.0, 18.0),
        plain.anatomical(70.0, -9.0).filled(0.75),
    ];
    shapes.into_iter().flat_map(|rest| {
        (0..12).map(move |k| {
            let random = |salt: f64| (12.9898 * (f64::from(k) + 1.7 * salt)).sin();
            let modes = [
                0.1 + 0.25 * random(1.0),
                0.2 * random(2.0),
                0.1 * random(6.0),
                0.1 * random(3.0),
                0.15 * random(4.0),
                0.15 * random(5.0),
                0.15 * random(7.0),
                0.2 * random(8.0),
            ];
            Deformed::at_rest(rest, 20.0).with_modes(modes)
        })
    })
}

#[test]
fn a_source_returns_to_its_image_and_no_volume_changes() {
    for shape in soft() {
        let map = shape.map::<f64>();
        for k in 0..60 {
            let t = f64::from(k);
            let at = [70.0 * (0.7 * t).sin(), 66.0 * (1.3 * t).cos(), 90.0 * (0.37 * t).sin()];
            let source = map.source(at);
            let image = map.image(source.place);
            assert!((0..3).all(|a| (image[a] - at[a]).abs() < 1e-11), "{image:?} {at:?}");
            let rows = map.whole_jacobian(&source);
            let matrix = DMat3::from_cols_array_2d(&rows);
            assert!((matrix.determinant() - 1.0).abs() < 1e-12);
            for axis in 0..3 {
                let moved = |step: f64| {
                    let mut to = at;
                    to[axis] += step;
                    map.source(to).place
                };
                let (after, before) = (moved(1e-4), moved(-1e-4));
                let expected = rows.map(|row| row[axis]);
                for (k, expected) in expected.into_iter().enumerate() {
                    let slope = (after[k] - before[k]) / 2e-4;
                    assert!((slope - expected).abs() < 1e-7, "{slope} {expected}");
                }
            }
        }
        // The base stays in its plane.
        assert!(map.source([20.0, -30.0, 0.0]).place[2] == 0.0);
    }
}

/// The volume inside of the gauge by rays from the middle of the base: ⅓∮∫r³ du dφ, u the cosine of the angle to the base's normal, r by bisection.
#[test]
fn the_volume_inside_of_the_gauge_is_that_at_rest() {
    for shape in soft().filter(|shape| shape.rest.onto_ball().is_some()) {
        let gauge = shape.gauge::<f64>();
        let radius = |direction: DVec3| {
            let (mut inside, mut outside) = (0.0, 200.0);
            for _ in 0..60 {
                let radius = 0.5 * (inside + outside);
                let is_inside = gauge.length_squared((direction * radius).to_array()) < 1.0;
                *(if is_inside { &mut inside } else { &mut outside }) = radius;
            }
            inside
        };
        let (steps, turns) = (256, 128);
        let mut volume = 0.0;
        for step in 0..steps {
            let (u, du) = tanh_sinh((f64::from(step) + 0.5) / f64::from(steps));
            let across = (1.0 - u * u).max(0.0).sqrt();
            for turn in 0..turns {
                let way = DVec2::from_angle(TAU * f64::from(turn) / f64::from(turns));
                let share = du * TAU / f64::from(steps * turns) / 3.0;
                volume += radius((across * way).extend(u)).powi(3) * share;
            }
        }
        let error = volume / shape.rest.volume() - 1.0;
        assert!(error.abs() < 1e-11, "{error} {:?}", shape.modes);
    }
}

/// A map of [0, 1] onto itself whose derivative vanishes at the ends to all orders, and the derivative.
fn tanh_sinh(s: f64) -> (f64, f64) {
    let t = 6.4 * (s - 0.5);
    let inner = 0.5 * PI * t.sinh();
    let u = 0.5 * (1.0 + inner.tanh());
    (u, 6.4 * 0.5 * 0.5 * PI * t.cosh() / inner.cosh().powi(2))
}

/// The energy against its integral over points of the body, with the gradient by differences of the image.
#[test]
fn the_energy_is_that_of_the_gradient_of_the_image() {
    for shape in soft().step_by(3) {
        let (map, DVec3 { x: a, y: b, z: p }) = (shape.map::<f64>(), shape.rest.half_axes());
        let (heights, rings, turns) = (60, 8, 16);
        let mut total = 0.0;
        for i in 0..heights {
            let (u, du) = tanh_sinh((f64::from(i) + 0.5) / f64::from(heights));
            let height = p * u;
            let middle = shape.rest.axis(height);
            let angle = (height / p).clamp(0.0, 1.0).acos();
            let half = [DVec2::X, DVec2::Y].map(|d| shape.rest.reach(angle, d).dot(d));
            for j in 0..rings {
                let share = ((f64::from(j) + 0.5) / f64::from(rings)).sqrt();
                for k in 0..turns {
                    let turn = DVec2::from_angle(TAU * f64::from(k) / f64::from(turns));
                    let place = middle + turn * share * DVec2::from_array(half);
                    let at = place.extend(height);
                    let column = |axis: DVec3| {
                        let step = 1e-4 * axis;
                        let ends = [at + step, at - step].map(|at| map.image(at.to_array()));
                        (DVec3::from(ends[0]) - DVec3::from(ends[1])) / 2e-4
                    };
                    let gradient =
                        DMat3::from_cols(column(DVec3::X), column(DVec3::Y), column(DVec3::Z));
                    let trace: f64 = gradient.to_cols_array().iter().map(|g| g * g).sum();
                    let volume =
                        PI * half[0] * half[1] * p * du / f64::from(heights * rings * turns);
                    total += 20.0 / 6.0 * (trace - 3.0) * volume;
                }
            }
        }
        // The rule of midpoints over the rings is exact but for the term of fourth order.
        let energy = shape.energy();
        assert!((total / energy - 1.0).abs() < 5e-3, "{total} {energy} {:?} {a} {b}", shape.modes);
    }
}

#[test]
fn forces_and_variations_are_derivatives() {
    for shape in soft() {
        let gel = shape.gel();
        let forces = gel.balance(shape.modes).forces;
        let scale = gel.balance([0.0; MODES]).stiffness[0][0];
        let gauge = shape.gauge::<f64>();
        let at = [25.0, -31.0, 17.0];
        let variation = gauge.variation(at);
        for k in 0..MODES {
            let with = |step: f64| {
                let mut moved = shape.clone();
                moved.modes[k] += step;
                moved
            };
            let (after, before) = (with(1e-5), with(-1e-5));
            let slope = (gel.energy(after.modes) - gel.energy(before.modes)) / 2e-5;
            assert!((slope - forces[k]).abs() < 1e-7 * scale, "{slope} {forces:?}");
            let length = |of: &Deformed<HalfBall>| of.gauge::<f64>().length(at).0;
            let slope = (length(&after) - length(&before)) / 2e-5;
            assert!((slope - variation[k]).abs() < 1e-8, "{slope} {variation:?} {k}");
            // Of small strains the second derivatives are those of the energy.
            let moved = |step: f64| {
                let mut modes = [0.0; MODES];
                modes[k] = step;
                gel.balance(modes).forces
            };
            let (after, before) = (moved(1e-4), moved(-1e-4));
            for l in 0..MODES {
                let slope = (after[l] - before[l]) / 2e-4;
                let own = gel.balance([0.0; MODES]).stiffness[k][l];
                assert!((slope - own).abs() < 1e-5 * scale, "{slope} {own} {k} {l}");
            }
        }
        let rest = gel.balance([0.0; MODES]).forces;
        assert!(rest.iter().all(|force| force.abs() < 1e-9 * scale));
    }
}

#[test]
fn lines_and_sizes_of_a_deformed_body_lie_on_its_surface() {
    for shape in soft() {
        let gauge = shape.gauge::<f64>();
        let length = |at: DVec3| gauge.length(at.to_array()).0;
        let half = shape.half_axes();
        assert!((length(shape.apex()) - 1.0).abs() < 1e-12);
        let mut highest = 0.0_f64;
        for turn in 0..64 {
            let direction = DVec2::from_angle(TAU * f64::from(turn) / 64.0);
            for k in 0..=60 {
                let at = shape.point(FRAC_PI_2 * f64::from(k) / 60.0, direction);
                assert!((length(at) - 1.0).abs() < 1e-9, "{} {k}", length(at));
                highest = highest.max(at.z);
            }
            let low = shape.point(shape.angle_at(0.4 * half.z, direction), direction);
            assert!((low.z - 0.4 * half.z).abs() < 1e-9);
        }
        assert!((shape.top() / highest - 1.0).abs() < 5e-4, "{} {highest}", shape.top());
        assert!(shape.top() >= highest - 1e-9);
        for k in 0..=20 {
            let angle = FRAC_PI_2 * f64::from(k) / 20.0;
            let height = half.z * angle.cos();
            for turn in 0..8 {
                let direction = DVec2::from_angle(TAU * f64::from(turn) / 8.0);
                let at = (shape.axis(height) + shape.reach(angle, direction)).extend(height);
                assert!((length(at) - 1.0).abs() < 1e-7, "{} {angle}", length(at));
            }
        }
        let reach = |direction: DVec2| shape.reach(FRAC_PI_2, direction).dot(direction);
        let edge = DVec2::new(reach(DVec2::X), reach(DVec2::Y));
        let other = DVec2::new(reach(DVec2::NEG_X), reach(DVec2::NEG_Y));
        assert!((0.5 * (edge + other) - half.truncate()).length() < 1e-9);
        assert!(shape.greatest_half_axes().cmpge(half.truncate() - 1e-9).all());
        let rest = Deformed::at_rest(shape.rest, 20.0);
        assert!((rest.half_axes() - shape.rest.half_axes()).length() < 1e-12);
        assert!((rest.apex_radius() / shape.rest.apex_radius() - 1.0).abs() < 1e-12);
        assert!((rest.least_length() / shape.rest.least_length() - 1.0).abs() < 1e-12);
    }
}

/// The map keeps the volume: points of a grid in the body at rest whose images are above, counted.
#[test]
fn the_upper_share_is_that_of_points_in_the_body_and_a_half_of_a_body_alike_to_both_sides() {
    const PARTS: [usize; 3] = [24, 480, 24];
    for shape in soft() {
        let (gauge, half) = (shape.rest.gauge::<f64>(), 75.0);
        let (mut upper, mut whole) = (0.0, 0.0);
        let [across, along, up] = PARTS;
        for k in 0..across * along * up {
            let part = |k: usize, of: usize| ((k % of) as f64 + 0.5) / of as f64;
            let (x, y) = (part(k, across), part(k / across, along));
            let z = part(k / across / along, up);
            let at = [half * (2.0 * x - 1.0), half * (2.0 * y - 1.0), 41.0 * z];
            if gauge.length_squared(at) < 1.0 {
                whole += 1.0;
                upper += f64::from(u8::from(shape.map::<f64>().image(at)[1] >= 0.0));
            }
        }
        assert!(
            (shape.upper_share() - upper / whole).abs() < 5e-3,
            "{} {}",
            shape.upper_share(),
            upper / whole
        );
    }
    let mut alike = Deformed::at_rest(HalfBall::round(60.0, 40.0), 20.0);
    alike.modes = [0.2, 0.1, 0.05, 0.03, 0.1, 0.0, 0.0, 0.0];
    assert!((alike.upper_share() - 0.5).abs() < 1e-12);
    alike.modes[6] = 0.08;
    assert!((alike.upper_share() - 0.5).abs() < 1e-4);
    // Thinner above, emptier above.
    alike.modes[7] = -0.05;
    assert!(alike.upper_share() < 0.49, "{}", alike.upper_share());
    let fuller_below = Deformed::at_rest(HalfBall::round(60.0, 40.0).anatomical(60.0, 18.0), 20.0);
    assert!(fuller_below.upper_share() < 0.48, "{}", fuller_below.upper_share());
}

/// The energy of the weight is that of points of the body at rest, its derivatives are by differences; under it alone a standing body shears by
/// ρ g z_c / G of its centroid's height z_c, and a lying one is flattened.
#[test]
fn a_weight_shears_a_standing_body_and_flattens_a_lying_one() {
    let weight = DVec3::new(2e-3, -9.5e-3, -7e-3);
    for shape in soft() {
        let shape = shape.of_weight(weight);
        let (gel, map, half) = (shape.gel(), shape.map::<f64>(), 75.0);
        let (gauge, mut sum, mut count) = (shape.rest.gauge::<f64>(), 0.0, 0.0);
        let [across, along, up] = [60_usize; 3];
        for k in 0..across * along * up {
            let part = |k: usize, of: usize| ((k % of) as f64 + 0.5) / of as f64;
            let (x, y) = (part(k, across), part(k / across, along));
            let at = [
                half * (2.0 * x - 1.0),
                half * (2.0 * y - 1.0),
                41.0 * part(k / across / along, up),
            ];
            if gauge.length_squared(at) < 1.0 {
                sum -= weight.dot(map.image(at).into());
                count += 1.0;
            }
        }
        let (found, expected) = (gel.potential(shape.modes), shape.rest.volume() * sum / count);
        let scale = weight.length() * 41.0 * shape.rest.volume();
        assert!((found - expected).abs() < 2e-3 * scale, "{found} {expected}");
        let elastic = shape.clone().of_weight(DVec3::ZERO).gel();
        let (with, without) = (gel.balance(shape.modes), elastic.balance(shape.modes));
        for k in 0..MODES {
            let at = |step: f64| {
                let mut modes = shape.modes;
                modes[k] += step;
                gel.potential(modes)
            };
            let slope = (at(1e-5) - at(-1e-5)) / 2e-5;
            assert!((slope - (with.forces[k] - without.forces[k])).abs() < 1e-7 * scale);
        }
    }
    let rest = HalfBall::round(60.0, 40.0);
    let step = |weight: DVec3| {
        let gel = Deformed::at_rest(rest, 30.0).of_weight(weight).gel();
        let balance = gel.balance([0.0; MODES]);
        std::array::from_fn::<f64, MODES, _>(|k| -balance.forces[k] / balance.stiffness[k][k])
    };
    let standing = step(DVec3::new(0.0, -9.5e-3, 0.0));
    let shear = -9.5e-3 * (3.0 / 8.0 * 40.0) / (30.0 / 3.0);
    assert!((standing[5] / shear - 1.0).abs() < 1e-4, "{standing:?} {shear}");
    assert!(standing[..5].iter().all(|change| change.abs() < 1e-12));
    let lying = step(DVec3::new(0.0, 0.0, -9.5e-3));
    assert!(lying[0] > 0.0 && lying[3..].iter().all(|change| change.abs() < 1e-12));
}
