//! The coupled law for the baselines: the closed form of the solver in f64, relative to the stiffness at small strain.

use crate::mesh::vec3::{add, cross, dot, scale};
use crate::model::membrane::node_stiffness::node_stiffness;
use crate::model::membrane::triangle::Rest;
use crate::springs::closed_form::{self, Group, area_stretch, spread, trace_of_stretch};
use crate::springs::coupled::CoupledLaw;
use crate::springs::table::Buckets;
use glam::{DMat3, DVec2, DVec3};

/// The law of a sheet.
#[derive(Clone, Debug)]
pub(super) struct Law {
    groups: Vec<Group<f64, Buckets<f64>>>,
}

/// A corner of a triangle, relative to its node.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    /// Rest area times weight \[spacing²\].
    area: f64,
    /// Gradients of the hat functions of the two other nodes \[1/spacing\].
    gradients: [DVec2; 2],
}

impl Corner {
    /// The corners of a triangle in the order of its nodes.
    pub(super) fn all(triangle: &Rest) -> [Self; 3] {
        let [a, b, c] = triangle.gradients;
        [[b, c], [c, a], [a, b]].map(|gradients| Self { area: triangle.area, gradients })
    }

    pub(super) fn is_like(&self, other: &Self) -> bool {
        let near = |a: DVec2, b: DVec2| a.distance_squared(b) < 1e-24;
        (self.area - other.area).abs() < 1e-12
            && near(self.gradients[0], other.gradients[0])
            && near(self.gradients[1], other.gradients[1])
    }
}

impl Law {
    pub(super) fn new(law: &CoupledLaw) -> Self {
        Self { groups: law.closed_form(1.0 / law.small_strain_stiffness()) }
    }

    /// A bound on the greatest eigenvalue of a triangle's elasticity tensor \[-\], F of columns f₁, f₂:
    /// max(Ef(ē)/ē, Ef′(ē))/(1−ν), summed over the layers.
    ///
    /// By the principal strains ε the stiffness is Ef/ē·K + (Ef′ − Ef/ē)·(Kε)(Kε)ᵀ/ē² with
    /// K = \[1 ν; ν 1\]/(1−ν²) and ē² = εᵀKε. Its eigenvalues are at most those of K, 1/(1−ν), times
    /// the greater modulus; rotations of the principal directions are softer.
    pub(super) fn greatest_stiffness(&self, f1: DVec3, f2: DVec3) -> f64 {
        let (i1, c12) = (f1.length_squared() + f2.length_squared(), f1.dot(f2));
        let s = area_stretch(f1.length_squared() * f2.length_squared() - c12 * c12);
        let t = trace_of_stretch(i1, s);
        let of_group = |group: &Group<f64, Buckets<f64>>| {
            let equivalent = group.equivalent_strain(i1, t);
            let (secant, slope) = group.secant_and_slope(equivalent);
            secant.max(secant + slope * equivalent) / group.one_minus_nu()
        };
        self.groups.iter().map(of_group).sum()
    }

    /// Adds −∂W/∂x of a triangle to a node's force and the positive part of ∂²W/∂x² to the node's Hessian; the edges
    /// lead to the two other nodes of the triangle \[spacings\].
    #[inline]
    pub(super) fn add_corner(
        &self,
        &Corner { area, gradients: [g1, g2] }: &Corner,
        [e1, e2]: [DVec3; 2],
        force: &mut DVec3,
        hessian: &mut DMat3,
    ) {
        let g = -(g1 + g2);
        let f1 = (e1 * g1.x + e2 * g2.x).to_array();
        let f2 = (e1 * g1.y + e2 * g2.y).to_array();
        let (c11, c22, c12) = (dot(f1, f1), dot(f2, f2), dot(f1, f2));
        let (i1, s) = (c11 + c22, area_stretch(c11 * c22 - c12 * c12));
        let t = trace_of_stretch(i1, s);
        let (p, q) = closed_form::tension(&self.groups, i1, s, t, || spread(c11, c22, c12));
        // F g and F adj(C) g.
        let turned = DVec2::new(c22 * g.x - c12 * g.y, c11 * g.y - c12 * g.x);
        let v = add(scale(f1, g.x), scale(f2, g.y));
        let w = add(scale(f1, turned.x), scale(f2, turned.y));
        *force -= DVec3::from(add(scale(v, p), scale(w, q))) * area;
        let k = closed_form::stiffness(&self.groups, i1, s);
        let tau = scale(add(v, scale(w, 1.0 / s)), 1.0 / k.t);
        let normal = scale(cross(f1, f2), 1.0 / s);
        let rest = [g.length_squared(), g.dot(turned), 1.0 / s];
        let block = node_stiffness(&k, rest, [v, tau, normal]).map(|part| part * area);
        let [xx, xy, xz, yy, yz, zz] = block;
        *hessian += DMat3::from_cols_array(&[xx, xy, xz, xy, yy, yz, xz, yz, zz]);
    }
}
