//! Frictionless one-sided contact of the inner face with dome and wall by augmented Lagrangians.
//!
//! A node has two constraints c ≥ 0 \[mm\]: the dome's gauge times its projection, and the height above the wall. With
//! the multiplier λ \[mN\] and the penalty κ \[N/m\] the term (p² − λ²)/(2κ), p = max(0, λ − κ c), is added to the energy; p is
//! the contact force per unit of ∇c; after a minimisation λ becomes p.
//!
//! Uses `wall`. Used by `newton`.

use super::wall::Wall;

/// The dome's section, draped over the wall w: r²/R² + |(z − w − z₀)/p|ᵐ = 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Section {
    /// Base radius R \[mm\].
    pub(super) base_radius: f64,
    /// Projection p \[mm\].
    pub(super) projection: f64,
    /// Exponent m of the heights \[-\]: 2 for half of an ellipsoid.
    pub(super) exponent: f64,
    /// Height z₀ of the base above the wall \[mm\].
    pub(super) base_height: f64,
    pub(super) wall: Wall,
}

/// Constraint of a node: value \[mm\], gradient \[-\], Hessian by rr, rz, zz \[1/mm\].
#[derive(Clone, Copy, Debug)]
pub(super) struct Constraint {
    pub(super) value: f64,
    pub(super) gradient: [f64; 2],
    pub(super) hessian: [f64; 3],
}

impl Section {
    /// Constraints of dome and wall at a point.
    pub(super) fn constraints(&self, [r, z]: [f64; 2]) -> [Constraint; 2] {
        let (a, p, m) = (self.base_radius.powi(-2), self.projection, self.exponent);
        let [w, steep, bend] = self.wall.height(r);
        let y = (z - w - self.base_height) / p;
        // Half of the derivatives of |y|ᵐ by z; the second one has no bound at the base with m < 2.
        let power = y.abs().powf(m);
        let first = 0.5 * m * y.abs().powf(m - 1.0).copysign(y) / p;
        let b = 0.5 * m * (m - 1.0) * y.abs().max(1e-3).powf(m - 2.0) / (p * p);
        // The gauge's centre is singular; no node of a solution is near.
        let level = (a * r * r + power).sqrt().max(1e-6);
        // The gauge's derivatives.
        let slope = [(a * r - first * steep) / level, first / level];
        let dome = Constraint {
            value: p * (level - 1.0),
            gradient: slope.map(|s| p * s),
            hessian: [
                p * (a + b * steep * steep - first * bend - slope[0] * slope[0]) / level,
                p * (-b * steep - slope[0] * slope[1]) / level,
                p * (b - slope[1] * slope[1]) / level,
            ],
        };
        let wall = Constraint { value: z - w, gradient: [-steep, 1.0], hessian: [-bend, 0.0, 0.0] };
        [dome, wall]
    }
}

/// Multipliers and penalties of the inner face's nodes.
#[derive(Clone, Debug)]
pub(super) struct Contact {
    pub(super) section: Section,
    /// λ of dome and wall for each node \[mN\].
    multipliers: Vec<[f64; 2]>,
    /// κ \[N/m\].
    penalties: Vec<f64>,
}

/// Contact term of a node.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Term {
    pub(super) energy: f64,
    pub(super) gradient: [f64; 2],
    /// By rr, rz, zz.
    pub(super) hessian: [f64; 3],
}

impl Contact {
    pub(super) fn new(section: Section, penalties: Vec<f64>) -> Self {
        Self { section, multipliers: vec![[0.0; 2]; penalties.len()], penalties }
    }

    /// Contact forces p of dome and wall \[mN\] at a node.
    fn forces(&self, node: usize, constraints: &[Constraint; 2]) -> [f64; 2] {
        let of = |k: usize| {
            (self.multipliers[node][k] - self.penalties[node] * constraints[k].value).max(0.0)
        };
        [of(0), of(1)]
    }

    /// The term of a node at a point \[mm\].
    pub(super) fn term(&self, node: usize, at: [f64; 2]) -> Term {
        let constraints = self.section.constraints(at);
        let forces = self.forces(node, &constraints);
        let penalty = self.penalties[node];
        let mut sum = Term::default();
        for k in 0..2 {
            let (force, c) = (forces[k], &constraints[k]);
            sum.energy += (force * force - self.multipliers[node][k].powi(2)) / (2.0 * penalty);
            if force > 0.0 {
                let [n, m] = c.gradient;
                sum.gradient = [sum.gradient[0] - force * n, sum.gradient[1] - force * m];
                let rank_one = [penalty * n * n, penalty * n * m, penalty * m * m];
                for e in 0..3 {
                    sum.hessian[e] += rank_one[e] - force * c.hessian[e];
                }
            }
        }
        sum
    }

    /// Sets λ to p; returns the greatest violation of c ≥ 0, λ ≥ 0, λ c = 0 \[mm\].
    pub(super) fn update(&mut self, nodes: impl Iterator<Item = [f64; 2]>) -> f64 {
        let mut violation = 0.0_f64;
        for (node, at) in nodes.enumerate() {
            let constraints = self.section.constraints(at);
            let forces = self.forces(node, &constraints);
            for k in 0..2 {
                let moved = (forces[k] - self.multipliers[node][k]).abs() / self.penalties[node];
                violation = violation.max(moved);
            }
            self.multipliers[node] = forces;
        }
        violation
    }

    /// Force of the dome on the tissue along the axis \[mN\].
    pub(super) fn axial_force(&self, nodes: impl Iterator<Item = [f64; 2]>) -> f64 {
        let one = |(node, at): (usize, [f64; 2])| {
            let constraints = self.section.constraints(at);
            self.forces(node, &constraints)[0] * constraints[0].gradient[1]
        };
        nodes.enumerate().map(one).sum()
    }

    /// Normal force of the dome \[mN\] on each node.
    pub(super) fn normal_forces(&self, nodes: impl Iterator<Item = [f64; 2]>) -> Vec<f64> {
        let one = |(node, at): (usize, [f64; 2])| {
            let constraints = self.section.constraints(at);
            let [r, z] = constraints[0].gradient;
            self.forces(node, &constraints)[0] * r.hypot(z)
        };
        nodes.enumerate().map(one).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_term_s_derivatives_are_those_of_its_energy() {
        let wall = Wall { radius_mm: Some(90.0) };
        for exponent in [1.3, 2.0, 4.0] {
            let (base_radius, projection, base_height) = (55.0, 40.0, -8.0);
            check(Section { base_radius, projection, exponent, base_height, wall });
        }
    }

    fn check(section: Section) {
        let mut contact = Contact::new(section, vec![300.0]);
        contact.update([[10.0, 29.0]].into_iter());
        let step = 1e-5;
        for at in [[10.0, 30.0], [30.0, -0.5], [40.0, 18.0]] {
            let here = contact.term(0, at);
            for i in 0..2 {
                let moved = |sign: f64| {
                    let mut moved = at;
                    moved[i] += sign * step;
                    contact.term(0, moved)
                };
                let (up, down) = (moved(1.0), moved(-1.0));
                let slope = (up.energy - down.energy) / (2.0 * step);
                assert!((slope - here.gradient[i]).abs() < 1e-5, "{at:?}");
                for j in 0..2 {
                    let bend = (up.gradient[j] - down.gradient[j]) / (2.0 * step);
                    assert!((bend - here.hessian[i + j]).abs() < 1e-4, "{at:?}");
                }
            }
        }
        assert!(contact.axial_force([[10.0, 30.0]].into_iter()) > 0.0);
    }
}
