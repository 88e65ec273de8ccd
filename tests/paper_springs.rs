//! The paper's equations (3) and (6): identities of their derivation, slopes and energies.

use implant_preview::curve::{Curve, CurveSpec};
use implant_preview::springs::paper::{self, Spring};

const POISSON_RATIOS: [f64; 7] = [0.0, 0.1, 0.2, 0.3, 0.4, 0.45, 0.5];

fn curves() -> [Curve; 3] {
    [CurveSpec::Skin {}, CurveSpec::Adipose {}, CurveSpec::Linear { modulus_kpa: 2.0 }]
        .map(|spec| Curve::new(&spec).expect("a good curve"))
}

#[test]
fn equation_1_holds_a_cell_in_uniaxial_tension_is_in_equilibrium_under_ef() {
    // Half of the cell's force along and across the pull, per L h / 2: the edge and the two
    // diagonals' parts: Ef(ε) along, zero across, the system of the paper's derivation.
    for curve in curves() {
        for nu in POISSON_RATIOS {
            for k in 1..=100 {
                let strain = 0.01 * f64::from(k);
                let (along, across) = (1.0 + strain, 1.0 - nu * strain);
                let length = (0.5 * (along * along + across * across)).sqrt(); // over √2 L
                let diagonal = paper::tension(Spring::Diagonal, &curve, nu, length - 1.0);
                let [pull, squeeze] =
                    [strain, -nu * strain].map(|e| paper::tension(Spring::Edge, &curve, nu, e));
                let share = diagonal / (2.0_f64.sqrt() * length);
                let stress = curve.stress(strain);
                assert!((pull + share * along - stress).abs() < 1e-12 * stress);
                assert!((squeeze + share * across).abs() < 1e-12 * stress);
            }
        }
    }
}

#[test]
fn edge_tension_is_equation_3_in_the_papers_own_form() {
    for curve in curves() {
        for nu in POISSON_RATIOS {
            for strain in [0.02, 0.3, 0.55, 1.0] {
                let denominator = (1.0 + nu) / (1.0 + strain) - nu;
                let wanted = curve.stress(strain) + curve.stress(-nu * strain) / denominator;
                let found = paper::tension(Spring::Edge, &curve, nu, strain);
                assert!((found - wanted).abs() < 1e-12 * curve.stress(strain));
            }
        }
    }
}

#[test]
fn compressed_springs_follow_ef_itself() {
    for curve in curves() {
        for spring in [Spring::Edge, Spring::Diagonal] {
            for strain in [-0.4, -0.1, -1e-6] {
                let found = paper::tension(spring, &curve, 0.3, strain);
                assert!((found - curve.stress(strain)).abs() <= 1e-15 * found.abs());
            }
        }
    }
}

#[test]
fn j_is_the_papers_formula_and_inverts_the_diagonal_strain() {
    for nu in POISSON_RATIOS {
        for k in 0..=100 {
            let edge = 0.01 * f64::from(k);
            let diagonal = paper::diagonal_strain(edge, -nu * edge);
            let j = paper::edge_strain_of_diagonal(nu, diagonal);
            assert!((j - edge).abs() < 1e-14, "nu {nu}, strain {edge}: {j}");
            let root = (2.0 * (1.0 + nu * nu) * (1.0 + diagonal).powi(2)
                - (1.0 + 2.0 * nu + nu * nu))
                .sqrt();
            assert!((j - (nu - 1.0 + root) / (1.0 + nu * nu)).abs() < 1e-13);
        }
    }
}

#[test]
fn slope_is_the_derivative_of_tension_and_tension_of_energy() {
    for curve in curves() {
        for nu in POISSON_RATIOS {
            for spring in [Spring::Edge, Spring::Diagonal] {
                // The last strains lie beyond the domain, on the straight continuation.
                for strain in [-0.51, -0.05, 0.013, 0.21, 0.333, 0.57, 0.91, 1.31, 2.3, 30.1] {
                    let step = 1e-5;
                    let at = |e: f64| {
                        (
                            paper::tension(spring, &curve, nu, e),
                            paper::energy(spring, &curve, nu, e),
                        )
                    };
                    let ((t0, w0), (t1, w1)) = (at(strain - step), at(strain + step));
                    let (tension, _) = at(strain);
                    let slope = paper::slope(spring, &curve, nu, strain);
                    let scale = curve.slope(0.0) + slope.abs();
                    assert!(
                        ((t1 - t0) / (2.0 * step) - slope).abs() < 3e-5 * scale,
                        "slope of {spring:?}, nu {nu}, strain {strain}"
                    );
                    assert!(
                        ((w1 - w0) / (2.0 * step) - tension).abs() < 3e-6 * (scale + w0.abs()),
                        "energy of {spring:?}, nu {nu}, strain {strain}"
                    );
                }
            }
        }
    }
}

#[test]
fn dj_is_the_derivative_of_j() {
    for nu in POISSON_RATIOS {
        for strain in [0.01, 0.2, 0.7] {
            let step = 1e-6;
            let difference = (paper::edge_strain_of_diagonal(nu, strain + step)
                - paper::edge_strain_of_diagonal(nu, strain - step))
                / (2.0 * step);
            let slope = paper::edge_strain_of_diagonal_slope(nu, strain);
            assert!((slope - difference).abs() < 1e-8);
        }
    }
}

#[test]
fn tension_stays_finite_and_continuous_beyond_the_domain_and_is_marked() {
    for curve in curves() {
        for nu in [0.1, 0.3, 0.5] {
            let limit = paper::edge_strain_limit(nu);
            assert!((1.0 - nu * limit - paper::LEAST_WIDTH).abs() < 1e-12);
            assert!(!paper::is_outside_domain(Spring::Edge, nu, limit));
            assert!(paper::is_outside_domain(Spring::Edge, nu, limit + 1e-9));
            let diagonal = paper::diagonal_strain(limit, -nu * limit);
            assert!(paper::is_outside_domain(Spring::Diagonal, nu, diagonal + 1e-9));
            for (spring, at) in [(Spring::Edge, limit), (Spring::Diagonal, diagonal)] {
                let [below, above] =
                    [at - 1e-9, at + 1e-9].map(|e| paper::tension(spring, &curve, nu, e));
                assert!((above - below).abs() < 1e-5 * below.abs());
                assert!(paper::tension(spring, &curve, nu, 1e6).is_finite());
                assert!(paper::energy(spring, &curve, nu, 1e6).is_finite());
            }
        }
    }
}
