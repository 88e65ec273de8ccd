//! Strains at the nodes, and what is drawn in colour.

use super::contact::Contact;
use crate::implant::Dome;
use crate::sheet::{NodeKind, Sheet};
use crate::solve::{Material, Solver, TriangleGradient};
use crate::springs::coupled::{biot_stress, equivalent_strain};
use glam::{DVec2, DVec3};

/// What is drawn in colour, per node; zero outside the sheet. Shape of each: (nodes_per_side², ).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fields {
    /// Greatest principal engineering strain λ₁ − 1 \[-\].
    pub principal_strain: Vec<f32>,
    /// Area stretch λ₁λ₂ \[-\].
    pub area_stretch: Vec<f32>,
    /// Greatest principal nominal stress of each layer \[kPa\], from the skin inwards.
    pub stress_kpa: Vec<Vec<f32>>,
    /// Contact pressure \[kPa\].
    pub contact_pressure_kpa: Vec<f32>,
    /// Deformed thickness of each layer \[mm\], from the skin inwards.
    pub thickness_mm: Vec<Vec<f32>>,
    /// Unit normal of the deformed sheet, pointing to the skin.
    pub normal: Vec<[f32; 3]>,
}

/// The fields of a solver's present shape.
#[must_use]
pub fn fields(solver: &Solver) -> Fields {
    let problem = solver.problem();
    let (sheet, x) = (&problem.sheet, solver.positions());
    let strains = NodalStrains::recover(sheet, x);
    let per_node = |f: &dyn Fn(Stretch) -> f64| -> Vec<f32> {
        (0..sheet.len())
            .map(|k| match sheet.kinds()[k] {
                NodeKind::Outside => 0.0,
                NodeKind::Free | NodeKind::Clamped => f(strains.at(k)) as f32,
            })
            .collect()
    };
    Fields {
        principal_strain: per_node(&|s| s.principal()[0]),
        area_stretch: per_node(&|s| s.area_stretch()),
        stress_kpa: problem
            .materials
            .iter()
            .map(|m| per_node(&|s| biot_stress(&m.curve, m.poisson_ratio, s.principal())[0]))
            .collect(),
        contact_pressure_kpa: Contact::find(solver).nodal_pressure(),
        thickness_mm: problem
            .materials
            .iter()
            .map(|m| per_node(&|s| m.thickness_mm * s.thickness_stretch(m.poisson_ratio)))
            .collect(),
        normal: strains.normals(),
    }
}

/// The stretch tensor U of the sheet at a point, in the sheet's rest frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stretch {
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Stretch {
    /// U = √C of a metric C, by Cayley–Hamilton: U = (C + √det C · I) / √(tr C + 2√det C).
    fn of_metric(metric: Self) -> Self {
        let Self { xx, yy, xy } = metric;
        let area = (xx * yy - xy * xy).max(0.0).sqrt();
        let trace = (xx + yy + 2.0 * area).sqrt().max(f64::MIN_POSITIVE);
        Self { xx: (xx + area) / trace, yy: (yy + area) / trace, xy: xy / trace }
    }

    fn add(&mut self, other: Self, weight: f64) {
        self.xx += other.xx * weight;
        self.yy += other.yy * weight;
        self.xy += other.xy * weight;
    }

    /// Principal engineering strains, the greater first \[-\].
    pub(super) fn principal(self) -> [f64; 2] {
        let mean = 0.5 * (self.xx + self.yy);
        let radius = (0.5 * (self.xx - self.yy)).hypot(self.xy);
        [mean + radius - 1.0, mean - radius - 1.0]
    }

    /// λ₁λ₂ \[-\].
    pub(super) fn area_stretch(self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// λ₃ = (λ₁λ₂)^(−ν/(1−ν)): plane stress in logarithmic strains \[-\].
    pub(super) fn thickness_stretch(self, poisson_ratio: f64) -> f64 {
        self.area_stretch().max(1e-6).powf(-poisson_ratio / (1.0 - poisson_ratio))
    }
}

/// Stretch at every node, from the mean metric of the triangles around it, weighted by area at rest:
/// second-order accurate inside the sheet, first-order on its border.
pub(super) struct NodalStrains {
    stretch: Vec<Stretch>,
    /// Normals of the deformed sheet, not of unit length.
    normal: Vec<DVec3>,
    /// Rest area around each node \[mm²\].
    area: Vec<f64>,
    deformed_area: f64,
}

impl NodalStrains {
    pub(super) fn recover(sheet: &Sheet, x: &[DVec3]) -> Self {
        let mut stretch = vec![Stretch::default(); sheet.len()];
        let mut normal = vec![DVec3::ZERO; sheet.len()];
        let mut area = vec![0.0; sheet.len()];
        let mut deformed_area = 0.0;
        for (nodes, weight) in sheet.triangles() {
            let triangle = TriangleGradient::new(sheet, nodes, weight, x);
            let [f1, f2] = triangle.columns;
            let across = f1.cross(f2) * triangle.rest_area;
            deformed_area += across.length();
            let metric =
                Stretch { xx: f1.length_squared(), yy: f2.length_squared(), xy: f1.dot(f2) };
            for k in nodes {
                stretch[k].add(metric, triangle.rest_area / 3.0);
                normal[k] += across;
                area[k] += triangle.rest_area / 3.0;
            }
        }
        for (stretch, area) in stretch.iter_mut().zip(&area) {
            let mut mean = Stretch::default();
            mean.add(*stretch, if *area > 0.0 { 1.0 / area } else { 0.0 });
            *stretch = Stretch::of_metric(mean);
        }
        Self { stretch, normal, area, deformed_area }
    }

    /// Unit normals, pointing to the skin; straight up outside the sheet.
    fn normals(&self) -> Vec<[f32; 3]> {
        self.normal.iter().map(|n| n.normalize_or(DVec3::Z).as_vec3().to_array()).collect()
    }

    pub(super) fn at(&self, node: usize) -> Stretch {
        self.stretch[node]
    }

    /// Deformed area / rest area of the triangles \[-\].
    pub(super) fn area_ratio(&self) -> f64 {
        self.deformed_area / self.area.iter().sum::<f64>()
    }

    pub(super) fn max_principal(&self) -> f64 {
        self.inside().map(|k| self.stretch[k].principal()[0]).fold(f64::MIN, f64::max)
    }

    /// Share of the rest area whose greatest principal strain is above a limit \[-\].
    pub(super) fn share_above(&self, limit: f64) -> f64 {
        let above: f64 = self
            .inside()
            .filter(|&k| self.stretch[k].principal()[0] > limit)
            .map(|k| self.area[k])
            .sum();
        above / self.area.iter().sum::<f64>()
    }

    /// Greatest principal Biot stress in a layer \[kPa\].
    pub(super) fn max_stress(&self, material: &Material) -> f64 {
        self.inside()
            .map(|k| {
                let strain = self.stretch[k].principal();
                biot_stress(&material.curve, material.poisson_ratio, strain)[0]
            })
            .fold(f64::MIN, f64::max)
    }

    pub(super) fn is_beyond_data(&self, material: &Material) -> bool {
        self.inside().any(|k| {
            let strain = self.stretch[k].principal();
            material.curve.is_beyond_data(equivalent_strain(strain, material.poisson_ratio))
        })
    }

    /// Stretch at the sheet's point on the dome's apex.
    pub(super) fn at_apex(&self, sheet: &Sheet, dome: &Dome, x: &[DVec3]) -> Stretch {
        let n = sheet.nodes_per_side();
        let target = dome.center;
        let distance = |k: &usize| x[*k].truncate().distance_squared(target);
        let nearest = (0..sheet.len())
            .filter(|&k| sheet.kinds()[k] == NodeKind::Free)
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
            .unwrap_or(n * n / 2);
        // The material point over the target, from the slope of the nodes' horizontal positions.
        let h = sheet.spacing_mm();
        let along = (x[nearest + 1] - x[nearest - 1]).truncate() / (2.0 * h);
        let across = (x[nearest + n] - x[nearest - n]).truncate() / (2.0 * h);
        let offset = target - x[nearest].truncate();
        let det = along.perp_dot(across);
        let local = DVec2::new(offset.perp_dot(across), along.perp_dot(offset)) / (det * h);
        let local = if local.is_finite() { local } else { DVec2::ZERO };
        let local = local.clamp(DVec2::splat(-1.0), DVec2::ONE);
        let (right, up) = (local.x >= 0.0, local.y >= 0.0);
        let beside = if right { nearest + 1 } else { nearest - 1 };
        let step = |k: usize| if up { k + n } else { k - n };
        let (u, v) = (local.x.abs(), local.y.abs());
        let mut sum = Stretch::default();
        for (k, weight) in [
            (nearest, (1.0 - u) * (1.0 - v)),
            (beside, u * (1.0 - v)),
            (step(nearest), (1.0 - u) * v),
            (step(beside), u * v),
        ] {
            let k = if sheet.kinds()[k] == NodeKind::Outside { nearest } else { k };
            sum.add(self.stretch[k], weight);
        }
        sum
    }

    fn inside(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.area.len()).filter(|&k| self.area[k] > 0.0)
    }
}
