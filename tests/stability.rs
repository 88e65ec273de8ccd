//! Stability of a homogeneously stretched sheet: wave stiffness compared with forces and energy of a finite sheet,
//! limits of the paper's springs, stability of coupled springs.

use glam::{DMat2, DVec2};
use implant_preview::curve::{Curve, CurveSpec};
use implant_preview::springs::Material;
use implant_preview::springs::Springs;
use implant_preview::springs::coupled::CoupledLaw;
use implant_preview::springs::paper::{self, Spring};
use implant_preview::springs::stability::{Lattice, Limits, Load, Search, Stack, Wave};
use implant_preview_lab::sample::{STABILITY_THRESHOLD, Sample};
use implant_preview_lab::stability::row;
use std::f64::consts::{FRAC_PI_2, PI, SQRT_2};

#[path = "common/unstable_strains.rs"]
mod unstable_strains;
use unstable_strains::{UNSTABLE, are_close};

const LAWS: [Springs; 2] = [Springs::Nikolaev, Springs::Coupled];
const CURVES: [&str; 4] = ["skin", "adipose", "linear", "exponential"];

fn layer(name: &str, poisson_ratio: f64, thickness_mm: f64) -> Material {
    let spec = match name {
        "skin" => CurveSpec::Skin {},
        "adipose" => CurveSpec::Adipose {},
        "linear" => CurveSpec::Linear { modulus_kpa: 100.0 },
        _ => CurveSpec::Exponential { scale_kpa: 2.0, rate: 4.0 },
    };
    Material::new(Curve::new(&spec).expect("a good curve"), poisson_ratio, thickness_mm)
}

/// Small-strain edge stiffness \[kPa·mm\].
fn stiffness(layers: &[Material]) -> f64 {
    layers.iter().map(|l| l.thickness_mm * l.curve.slope(0.0)).sum()
}

/// The wave of least stiffness of one layer.
fn weakest(springs: Springs, layer: &Material, load: Load, strain: f64) -> Wave {
    let layers = [layer.clone()];
    let stack = Stack::new(springs, &layers);
    stack.lattice(stack.strains(load, strain)).weakest_wave(Search::FINE)
}

/// The lattice of one layer, its sample of 2 × 2 cells and the stretches.
fn lattice(springs: Springs, l: &Material, load: Load, strain: f64) -> (Lattice, Sample, DVec2) {
    let layers = [l.clone()];
    let stack = Stack::new(springs, &layers);
    let strains = stack.strains(load, strain);
    let sample = Sample::new(2, springs, &l.curve, l.poisson_ratio);
    (stack.lattice(strains), sample, DVec2::ONE + DVec2::from(strains))
}

#[test]
fn wave_stiffness_equals_the_restoring_forces_of_a_sheet() {
    // The middle node of 2 × 2 cells has all neighbours of a node of the infinite sheet: a displacement
    // U cos(k·X) has the restoring force D(k) U.
    let step = 1e-6;
    for springs in LAWS {
        for (name, nu) in [("skin", 0.45), ("adipose", 0.3), ("linear", 0.1)] {
            let layer = layer(name, nu, 1.0);
            for (load, strain) in
                [(Load::Uniaxial, 0.23), (Load::Uniaxial, 0.81), (Load::Equibiaxial, 0.37)]
            {
                let (lattice, sample, stretch) = lattice(springs, &layer, load, strain);
                for k in 0..24 {
                    let t = f64::from(k);
                    let wave = [0.5 * PI * (1.0 - (2.3 * t).cos()), 0.5 * PI * (1.0 + t.sin())];
                    let motion = DVec2::from_angle(0.7 * t);
                    let moved = |step: f64| -> DVec2 {
                        let center = DVec2::ONE;
                        let at = |p: &DVec2| {
                            let phase = (*p - center).dot(DVec2::from(wave));
                            *p * stretch + step * phase.cos() * motion
                        };
                        let shape: Vec<DVec2> = sample.rest().iter().map(at).collect();
                        sample.forces(&shape)[4]
                    };
                    let found = (moved(-step) - moved(step)) / (2.0 * step);
                    let [xx, yy, xy, _] = lattice.dynamical_matrix(wave);
                    let wanted =
                        DVec2::new(xx * motion.x + xy * motion.y, xy * motion.x + yy * motion.y);
                    let error = (found / stiffness(std::slice::from_ref(&layer)) - wanted).length();
                    assert!(error < 2e-6, "{springs:?} {name} {load:?} {wave:?}: {error}");
                }
            }
        }
    }
}

#[test]
fn out_of_plane_wave_stiffness_follows_from_the_spring_tensions() {
    // Neighbours of a node: steps along x and y, rest length, width.
    let edge = |x, y| (x, y, 1.0, 1.0, Spring::Edge);
    let diagonal = |x, y| (x, y, SQRT_2, 0.5, Spring::Diagonal);
    let springs = [
        edge(1.0, 0.0),
        edge(-1.0, 0.0),
        edge(0.0, 1.0),
        edge(0.0, -1.0),
        diagonal(1.0, 1.0),
        diagonal(-1.0, 1.0),
        diagonal(1.0, -1.0),
        diagonal(-1.0, -1.0),
    ];
    for name in CURVES {
        let layer = layer(name, 0.4, 1.0);
        for (load, strain) in [(Load::Uniaxial, 0.3), (Load::Equibiaxial, 0.7)] {
            let (lattice, _, stretch) = lattice(Springs::Nikolaev, &layer, load, strain);
            for wave in [[0.3, 0.2], [PI, 0.0], [0.0, 2.0], [PI, PI], [2.5, 1.0]] {
                // Heights are cos(k·X); the force of a spring points to the height of the other end.
                let pull = |&(x, y, rest, width, kind): &(f64, f64, f64, f64, Spring)| {
                    let length = DVec2::new(x, y).mul_add(stretch, DVec2::ZERO).length();
                    let tension = paper::tension(
                        kind,
                        &layer.curve,
                        layer.poisson_ratio,
                        length / rest - 1.0,
                    );
                    width * tension * (1.0 - (wave[0] * x + wave[1] * y).cos()) / length
                };
                let wanted: f64 =
                    springs.iter().map(pull).sum::<f64>() / stiffness(std::slice::from_ref(&layer));
                let found = lattice.dynamical_matrix(wave)[3];
                assert!((found - wanted).abs() < 1e-12, "{name} {wave:?}: {found}, not {wanted}");
            }
            let sampled = (0..40_000).map(|k| {
                let [x, y] = [k % 200 + 1, k / 200 + 1].map(|k| PI * f64::from(k) / 200.0);
                let size = 4.0 * ((0.5 * x).sin().powi(2) + (0.5 * y).sin().powi(2));
                lattice.dynamical_matrix([x, y])[3] / size
            });
            let least = sampled.fold(f64::INFINITY, f64::min);
            let found = lattice.out_of_plane().into_iter().fold(f64::INFINITY, f64::min);
            assert!(found <= least + 1e-12 && found > least - 1e-3, "{name}: {found}, not {least}");
        }
    }
}

#[test]
fn long_waves_have_the_acoustic_tensor_of_the_homogeneous_sheet() {
    // u·Q(n)·u is the second derivative of the energy of one cell along u ⊗ n.
    let step = 1e-4;
    for springs in LAWS {
        for (name, nu) in [("skin", 0.45), ("adipose", 0.3), ("exponential", 0.2)] {
            let layer = layer(name, nu, 1.0);
            for (load, strain) in [(Load::Uniaxial, 0.3), (Load::Equibiaxial, 0.6)] {
                let (lattice, _, stretch) = lattice(springs, &layer, load, strain);
                let cell = Sample::new(1, springs, &layer.curve, nu);
                for k in 0..12 {
                    let angle = FRAC_PI_2 * f64::from(k) / 11.0;
                    let n = DVec2::from_angle(angle);
                    let u = DVec2::from_angle(2.1 * f64::from(k));
                    let energy = |t: f64| {
                        let f = DMat2::from_diagonal(stretch)
                            + DMat2::from_cols(t * u * n.x, t * u * n.y);
                        let shape: Vec<DVec2> = cell.rest().iter().map(|p| f * *p).collect();
                        cell.energy(&shape)
                    };
                    let second = (energy(step) - 2.0 * energy(0.0) + energy(-step)) / (step * step);
                    let wanted = second / stiffness(std::slice::from_ref(&layer));
                    let quadratic = |[xx, yy, xy]: [f64; 3]| {
                        xx * u.x * u.x + yy * u.y * u.y + 2.0 * xy * u.x * u.y
                    };
                    let long = 1e-3;
                    let [xx, yy, xy, _] = lattice.dynamical_matrix((long * n).to_array());
                    let wave = quadratic([xx, yy, xy]) / (long * long);
                    assert!(
                        (wave - wanted).abs() < 1e-5 * (2.0 + wanted.abs()),
                        "{springs:?} {name}: {wave} {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn the_least_stiffness_bounds_the_stiffness_of_all_waves() {
    for springs in LAWS {
        for name in CURVES {
            for nu in [0.02, 0.25, 0.4, 0.5] {
                for (load, strain) in
                    [(Load::Uniaxial, 0.05), (Load::Uniaxial, 0.6), (Load::Equibiaxial, 0.35)]
                {
                    let (lattice, _, _) = lattice(springs, &layer(name, nu, 1.0), load, strain);
                    let weakest = lattice.weakest_wave(Search::FINE);
                    let stiffness = |wave: [f64; 2]| {
                        let [xx, yy, xy, _] = lattice.dynamical_matrix(wave);
                        let size: f64 = wave.iter().map(|k| 4.0 * (0.5 * k).sin().powi(2)).sum();
                        (0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy)) / size
                    };
                    let mut least = f64::INFINITY;
                    for k in 0..90_000 {
                        let [x, y] = [k % 300, k / 300].map(|k| PI * f64::from(k) / 299.0);
                        if x + y > 0.0 {
                            least = least.min(stiffness([x, y]));
                        }
                    }
                    let at = format!("{springs:?} {name} {nu} {load:?} {strain}");
                    assert!(weakest.stiffness <= least + 1e-10, "{at}: {weakest:?} {least}");
                    if weakest.vector.iter().any(|k| *k > 0.0) {
                        // Wave vector, stiffness and polarisation belong together.
                        let size = weakest.stiffness - stiffness(weakest.vector);
                        assert!(size.abs() < 1e-6, "{at}: {weakest:?}");
                        let [xx, yy, xy, _] = lattice.dynamical_matrix(weakest.vector);
                        let u = DVec2::from_angle(weakest.polarisation);
                        let pull = DVec2::new(xx * u.x + xy * u.y, xy * u.x + yy * u.y);
                        assert!(pull.perp_dot(u).abs() < 1e-5 * (1.0 + pull.length()), "{at}");
                    }
                    let quick = lattice.weakest_wave(Search::QUICK).stiffness;
                    assert!((quick - weakest.stiffness).abs() < 1e-4, "{at}: {quick} {weakest:?}");
                }
            }
        }
    }
}

#[test]
fn the_papers_springs_lose_stability_at_the_known_strains() {
    for (name, nu, wanted) in UNSTABLE {
        let found = Limits::new(Springs::Nikolaev, &[layer(name, nu, 1.0)]).uniaxial;
        assert!(are_close(&found, wanted, 0.0205), "{name} {nu}: {found:?} instead of {wanted:?}");
    }
}

#[test]
fn the_unstable_mode_is_a_zigzag_along_the_tension_resisted_by_edges_only() {
    // The stiffness of k = (π, π) along x consists of f′(ε) of the edges along x and f/(1 − νε) of the edges across.
    for (name, nu) in [("linear", 0.3), ("skin", 0.45), ("adipose", 0.1), ("adipose", 0.49)] {
        let l = layer(name, nu, 1.0);
        let lost = Limits::new(Springs::Nikolaev, std::slice::from_ref(&l))
            .first_loss(Load::Uniaxial)
            .unwrap();
        let zigzag = |strain: f64| {
            let across = -nu * strain;
            paper::slope(Spring::Edge, &l.curve, nu, strain)
                + paper::tension(Spring::Edge, &l.curve, nu, across) / (1.0 + across)
        };
        assert!(zigzag(lost - 1e-3) > 0.0 && zigzag(lost + 1e-3) < 0.0, "{name} {nu}: {lost}");
        let wave = weakest(Springs::Nikolaev, &l, Load::Uniaxial, lost + 0.01);
        assert!(wave.stiffness < 0.0 && wave.vector.iter().all(|k| PI - k < 1e-3), "{wave:?}");
        assert!(wave.polarisation.abs() < 1e-3 && (wave.angle - 0.25 * PI).abs() < 1e-3);
    }
}

#[test]
fn at_small_strain_the_papers_springs_are_stable_and_without_poisson_ratio_neutral() {
    for name in CURVES {
        for load in Load::ALL {
            for k in 1..=50 {
                let nu = 0.01 * f64::from(k);
                let stiffness =
                    weakest(Springs::Nikolaev, &layer(name, nu, 1.0), load, 1e-4).stiffness;
                assert!(stiffness > 0.9 * nu.min(0.25), "{name} {nu} {load:?}: {stiffness}");
            }
        }
        // ν = 0: no diagonals. Under uniaxial tension rows slide without a change of energy.
        let layer = layer(name, 0.0, 1.0);
        for strain in [0.0, 0.3, 1.0] {
            let wave = weakest(Springs::Nikolaev, &layer, Load::Uniaxial, strain);
            assert!(wave.stiffness.abs() < f64::MIN_POSITIVE, "{name} {strain}: {wave:?}");
        }
        assert!(Limits::new(Springs::Nikolaev, &[layer]).uniaxial.is_empty());
    }
}

#[test]
fn coupled_springs_are_stable_at_every_point_of_the_maps() {
    let strains: Vec<f64> = (0..=20).map(|k| 0.05 * f64::from(k)).collect();
    for name in CURVES {
        for load in Load::ALL {
            for k in 0..=10 {
                let nu = 0.05 * f64::from(k);
                for point in row(Springs::Coupled, &layer(name, nu, 1.0).curve, nu, load, &strains)
                {
                    let at = format!("{name} {point:?}");
                    assert!(point.wave.stiffness > 0.01 && point.sheet > 1e-3, "{at}");
                    // Without transverse tension out-of-plane waves are neutral, as at rest.
                    assert!(point.least_out_of_plane() > -1e-9, "{at}");
                }
            }
            assert!(Limits::new(Springs::Coupled, &[layer(name, 0.49, 1.0)]).of(load).is_empty());
        }
    }
}

#[test]
fn eigenvalues_of_growing_sheets_decrease_to_the_infinite_sheets_value() {
    // Adipose, ν = 0.3, far beyond its limit: the free sheet's least eigenvalue against D's.
    let layer = layer("adipose", 0.3, 1.0);
    let (lattice, _, stretch) = lattice(Springs::Nikolaev, &layer, Load::Uniaxial, 0.6);
    let [xx, yy, xy, _] = lattice.dynamical_matrix(lattice.weakest_wave(Search::FINE).vector);
    let limit = 0.5 * (xx + yy) - (0.5 * (xx - yy)).hypot(xy);
    let mut gaps = Vec::new();
    for cells in [1, 2, 4, 8] {
        let sample = Sample::new(cells, Springs::Nikolaev, &layer.curve, 0.3);
        let shape: Vec<DVec2> = sample.rest().iter().map(|p| *p * stretch).collect();
        gaps.push((sample.least_eigenvalue(&shape) - limit) / limit.abs());
    }
    assert!(gaps.windows(2).all(|pair| 0.0 < pair[1] && pair[1] < 0.75 * pair[0]), "{gaps:?}");
    assert!(gaps[3] < 0.15, "{gaps:?}");
}

#[test]
fn the_finite_sheet_is_unstable_where_its_least_eigenvalue_is_negative() {
    let strains: Vec<f64> = (1..=25).map(|k| 0.04 * f64::from(k)).collect();
    let mut seen = [0; 2];
    for (name, nu) in [("skin", 0.45), ("adipose", 0.05), ("linear", 0.3)] {
        let layer = layer(name, nu, 1.0);
        let sample = Sample::new(4, Springs::Nikolaev, &layer.curve, nu);
        for load in Load::ALL {
            for point in row(Springs::Nikolaev, &layer.curve, nu, load, &strains) {
                let stretch = 1.0 + DVec2::new(point.strain, point.transverse_strain);
                let shape: Vec<DVec2> = sample.rest().iter().map(|p| *p * stretch).collect();
                let is_stable = sample.is_stable(&shape);
                assert_eq!(is_stable, point.sheet >= -STABILITY_THRESHOLD, "{name} {point:?}");
                seen[usize::from(is_stable)] += 1;
            }
        }
    }
    assert!(seen.iter().all(|&count| count > 20), "{seen:?}");
}

#[test]
fn bonded_layers_add_and_share_their_transverse_strain() {
    let layers = [layer("skin", 0.45, 1.5), layer("adipose", 0.3, 10.0), layer("linear", 0.1, 0.4)];
    for springs in LAWS {
        let stack = Stack::new(springs, &layers);
        for strain in [0.1, 0.5, 0.9] {
            // No transverse load: forces on the upper side of one cell sum to zero over the layers.
            let strains = stack.strains(Load::Uniaxial, strain);
            assert!(strains[1] < -0.1 * strain && strains[1] > -0.45 * strain);
            let stretch = 1.0 + DVec2::from(strains);
            let [mut sum, mut size] = [0.0; 2];
            for layer in &layers {
                let cell = Sample::new(1, springs, &layer.curve, layer.poisson_ratio);
                let shape: Vec<DVec2> = cell.rest().iter().map(|p| *p * stretch).collect();
                let force = layer.thickness_mm * cell.forces(&shape)[2].y;
                (sum, size) = (sum + force, size + force.abs());
            }
            assert!(sum.abs() < 1e-6 * size, "{springs:?} {strain}: {sum} of {size}");
            // The stack is the sum of its layers.
            let wave = [1.1, 2.0];
            let whole = stack.lattice(strains).dynamical_matrix(wave);
            for entry in 0..4 {
                let sum: f64 = layers
                    .iter()
                    .map(|layer| {
                        let one = std::slice::from_ref(layer);
                        let lattice = Stack::new(springs, one).lattice(strains);
                        stiffness(one) * lattice.dynamical_matrix(wave)[entry]
                    })
                    .sum();
                let error = (stiffness(&layers) * whole[entry] - sum).abs();
                assert!(error < 1e-6 * stiffness(&layers), "{springs:?} {strain}: {error}");
            }
        }
    }
    // A factor on all thicknesses changes no limit.
    let [thin, thick] =
        [0.5, 20.0].map(|h| Limits::new(Springs::Nikolaev, &[layer("skin", 0.49, h)]));
    assert_eq!(thin, thick);
}

#[test]
fn out_of_plane_stiffness_of_coupled_springs_is_the_tension() {
    let l = layer("skin", 0.45, 1.0);
    let (lattice, _, stretch) = lattice(Springs::Coupled, &l, Load::Equibiaxial, 0.3);
    let [sx, sy, sxy] = CoupledLaw::new(std::slice::from_ref(&l)).second_piola_kirchhoff([
        stretch.x.powi(2),
        stretch.y.powi(2),
        0.0,
    ]);
    let k = DVec2::new(1e-3, 2e-3);
    let wanted = (sx * k.x * k.x + sy * k.y * k.y + 2.0 * sxy * k.x * k.y) / stiffness(&[l]);
    let found = lattice.dynamical_matrix(k.to_array())[3];
    assert!((found / wanted - 1.0).abs() < 1e-5, "{found} {wanted}");
}

#[test]
fn limits_need_a_few_hundred_states() {
    let layers = [layer("skin", 0.45, 1.5), layer("adipose", 0.45, 10.0)];
    let limits = Limits::new(Springs::Nikolaev, &layers);
    assert!(limits.states < 300, "{} states", limits.states);
    // The default scene's stack: skin is unstable below the stiffening of its curve, adipose is stabilised.
    assert_eq!((limits.uniaxial.len(), limits.equibiaxial.len()), (1, 1), "{limits:?}");
    for load in Load::ALL {
        let stack = Stack::new(Springs::Nikolaev, &layers);
        let [from, to] = limits.of(load)[0];
        for (strain, is_unstable) in
            [(from - 6e-4, false), (from, true), (to, true), (to + 6e-4, false)]
        {
            let wave = stack.lattice(stack.strains(load, strain)).weakest_wave(Search::FINE);
            assert_eq!(wave.stiffness < 0.0, is_unstable, "{load:?} {strain} {wave:?}");
        }
    }
}
