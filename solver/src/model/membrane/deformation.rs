//! Deformation at the nodes: stretch, normal and area, the basis of results and fields.
//!
//! One pass over the cells. On a square cell the columns of a triangle's deformation gradient F are two edges of
//! the cell over the spacing; cells at the fitted border have gradients of their own.

use super::triangle::{Principal, Rest, sums};
use crate::contact::Dome;
use crate::mesh::part::Part;
use crate::mesh::{NodeKind, Sheet, Surface};
use glam::{DVec2, DVec3};
use std::ops::{Add, AddAssign};

/// Lower bound of the area stretch in the thickness \[-\]; a degenerate triangle is below the bound.
pub(crate) const LEAST_AREA_STRETCH: f64 = 1e-6;

/// Exponent of the area stretch in the thickness stretch: −ν/(1−ν).
pub(crate) fn thickness_exponent(poisson_ratio: f64) -> f64 {
    -poisson_ratio / (1.0 - poisson_ratio)
}

/// A symmetric 2 × 2 tensor in the sheet's rest frame: the metric C, or the stretch tensor U.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stretch {
    xx: f64,
    yy: f64,
    xy: f64,
}

impl Stretch {
    /// U = √C of a metric C, by Cayley–Hamilton: U = (C + √det C · I) / √(tr C + 2√det C).
    fn of_metric(metric: Self) -> Self {
        let Self { xx, yy, xy } = metric;
        let area = (xx * yy - xy * xy).max(0.0).sqrt();
        let scale = 1.0 / (xx + yy + 2.0 * area).sqrt().max(f64::MIN_POSITIVE);
        Self { xx: (xx + area) * scale, yy: (yy + area) * scale, xy: xy * scale }
    }

    fn scaled(self, factor: f64) -> Self {
        Self { xx: self.xx * factor, yy: self.yy * factor, xy: self.xy * factor }
    }

    /// The tensor mirrored along x, along y.
    fn mirrored(self, [along_x, along_y]: [bool; 2]) -> Self {
        Self { xy: if along_x == along_y { self.xy } else { -self.xy }, ..self }
    }

    /// Principal engineering strains, the greater first \[-\].
    pub(crate) fn principal(self) -> [f64; 2] {
        let mean = 0.5 * (self.xx + self.yy);
        let half = 0.5 * (self.xx - self.yy);
        let radius = (half * half + self.xy * self.xy).sqrt();
        [mean + radius - 1.0, mean - radius - 1.0]
    }

    /// Unit vector of the first principal direction, in the rest frame; along x where both stretches are equal.
    fn first_direction(self) -> DVec2 {
        DVec2::from_angle(0.5 * (2.0 * self.xy).atan2(self.xx - self.yy))
    }

    /// λ₁λ₂ \[-\].
    pub(crate) fn area_stretch(self) -> f64 {
        self.xx * self.yy - self.xy * self.xy
    }

    /// λ₃ = (λ₁λ₂)^(−ν/(1−ν)): plane stress in logarithmic strains \[-\].
    pub(crate) fn thickness_stretch(self, poisson_ratio: f64) -> f64 {
        self.area_stretch().max(LEAST_AREA_STRETCH).powf(thickness_exponent(poisson_ratio))
    }
}

impl Add for Stretch {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { xx: self.xx + other.xx, yy: self.yy + other.yy, xy: self.xy + other.xy }
    }
}

/// The deformation of a node: first sums over the adjacent triangles, then means.
#[derive(Clone, Copy, Debug, Default)]
struct Node {
    /// Σ C·A, then U of the mean metric C \[-\].
    stretch: Stretch,
    /// Twice the sum of the deformed triangles' area vectors \[mm²\]; points to the skin.
    normal: DVec3,
    /// A third of the triangles' rest areas \[mm²\].
    rest_area: f64,
    /// A third of the triangles' deformed areas \[mm²\].
    deformed_area: f64,
}

impl Add for Node {
    type Output = Self;
    #[inline]
    fn add(self, other: Self) -> Self {
        Self {
            stretch: self.stretch + other.stretch,
            normal: self.normal + other.normal,
            rest_area: self.rest_area + other.rest_area,
            deformed_area: self.deformed_area + other.deformed_area,
        }
    }
}

impl AddAssign for Node {
    #[inline]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

/// The contribution of a triangle to each of its nodes; f₁, f₂ are the columns of F.
#[inline]
fn contribution([f1, f2]: [DVec3; 2], rest_area: f64) -> Node {
    let across = f1.cross(f2) * rest_area;
    let third = rest_area / 3.0;
    let metric = Stretch { xx: f1.length_squared(), yy: f2.length_squared(), xy: f1.dot(f2) };
    Node {
        stretch: metric.scaled(third),
        normal: across,
        rest_area: third,
        deformed_area: across.length() / 3.0,
    }
}

/// Stretch, normal and area at every node, from the triangles around it, weighted by area at rest:
/// second-order accurate inside the sheet, first-order on its border. Of a symmetric shape the solved part alone is
/// computed; other nodes are its mirror images.
#[derive(Clone, Debug, Default)]
pub struct Deformation {
    part: Part,
    /// On the part; zero outside the sheet.
    nodes: Vec<Node>,
    /// Principal engineering strains, the greater first \[-\], on the part.
    principal: Vec<[f64; 2]>,
}

impl Deformation {
    /// The deformation of the sheet with its nodes at `x` \[mm\], shape (nodes_per_side², ).
    #[must_use]
    pub fn new(surface: Surface, x: &[DVec3]) -> Self {
        Self::of_part(surface, x, Part::whole(surface.sheet().nodes_per_side()))
    }

    /// The deformation of a shape that the nodes of a part determine.
    pub(crate) fn of_part(surface: Surface, x: &[DVec3], part: Part) -> Self {
        let quarter = 0.25 * surface.sheet().spacing_mm() * surface.sheet().spacing_mm();
        let triangle = |rest: &Rest, x| [contribution(Principal::columns(rest, x), rest.area); 3];
        let square = |[bottom, top, left, right]: [DVec3; 4]| {
            let of = |columns: [DVec3; 2]| contribution(columns, quarter);
            let upper = [of([top, right]), of([top, left])];
            let lower = [of([bottom, left]), of([bottom, right])];
            // The k-th triangle has no corner k.
            let (above, below) = (upper[0] + upper[1], lower[0] + lower[1]);
            [upper[1] + below, upper[0] + below, above + lower[1], above + lower[0]]
        };
        let mut nodes = sums(surface, x, part, |_, _| true, triangle, square);
        let principal = nodes
            .iter_mut()
            .map(|node| {
                if node.rest_area > 0.0 {
                    node.stretch = Stretch::of_metric(node.stretch.scaled(1.0 / node.rest_area));
                    node.stretch.principal()
                } else {
                    [0.0; 2]
                }
            })
            .collect();
        Self { part, nodes, principal }
    }

    /// The part that was computed.
    pub(crate) fn part(&self) -> Part {
        self.part
    }

    /// The part's nodes that belong to the sheet's triangles.
    pub(crate) fn inside(&self) -> impl Iterator<Item = usize> + '_ {
        let nodes = self.part.nodes().zip(&self.nodes);
        nodes.filter(|(_, node)| node.rest_area > 0.0).map(|(k, _)| k)
    }

    /// Principal engineering strains at a node, the greater first \[-\].
    #[must_use]
    pub fn principal(&self, node: usize) -> [f64; 2] {
        self.principal[self.part.index(node)]
    }

    /// Unit vector of the first principal direction at a node, in the rest frame; its sign has no meaning. Along x where
    /// both strains are equal.
    #[must_use]
    pub fn first_direction(&self, node: usize) -> DVec2 {
        self.stretch(node).first_direction()
    }

    /// Area stretch λ₁λ₂ at a node \[-\].
    #[must_use]
    pub fn area_stretch(&self, node: usize) -> f64 {
        self.nodes[self.part.index(node)].stretch.area_stretch()
    }

    /// Unit normal at a node, pointing to the skin; straight up outside the sheet.
    #[must_use]
    pub fn normal(&self, node: usize) -> DVec3 {
        let normal = self.nodes[self.part.index(node)].normal.normalize_or(DVec3::Z);
        let [x, y] = self.part.is_image(node).map(|is_image| if is_image { -1.0 } else { 1.0 });
        DVec3::new(x * normal.x, y * normal.y, normal.z)
    }

    /// Deformed area around a node \[mm²\].
    pub(crate) fn deformed_area(&self, node: usize) -> f64 {
        self.nodes[self.part.index(node)].deformed_area
    }

    /// Area at rest around a node \[mm²\].
    pub(crate) fn rest_area(&self, node: usize) -> f64 {
        self.nodes[self.part.index(node)].rest_area
    }

    fn stretch(&self, node: usize) -> Stretch {
        let stretch = self.nodes[self.part.index(node)].stretch;
        stretch.mirrored(self.part.is_image(node))
    }

    /// Strains of the sheet, with the fraction of its rest area above each limit. Areas have a weight at every node; the greatest
    /// strain is that of the whole sheet.
    pub(crate) fn summary<const N: usize>(
        &self,
        limits: [f64; N],
        weight: impl Fn(usize) -> f64,
    ) -> Summary<N> {
        let (mut rest, mut deformed, mut above) = (0.0, 0.0, [0.0; N]);
        let mut greatest = f64::MIN;
        for ((k, node), [first, _]) in self.part.nodes().zip(&self.nodes).zip(&self.principal) {
            if node.rest_area <= 0.0 {
                continue;
            }
            let (weight, first) = (weight(k) * self.part.multiplicity(k), *first);
            rest += weight * node.rest_area;
            deformed += weight * node.deformed_area;
            greatest = greatest.max(first);
            for (above, limit) in above.iter_mut().zip(limits) {
                *above += if first > limit { weight * node.rest_area } else { 0.0 };
            }
        }
        Summary {
            greatest,
            area_ratio: deformed / rest,
            fraction_above: above.map(|area| area / rest),
        }
    }

    /// Stretch at the sheet's point above the dome's apex, which an anatomical dome has beside the centre of its base.
    pub(crate) fn at_apex(&self, sheet: &Sheet, dome: &Dome, x: &[DVec3]) -> Stretch {
        let n = sheet.nodes_per_side();
        let target = dome.apex().truncate();
        let mut nearest = (f64::INFINITY, n * n / 2);
        for k in self.part.nodes().filter(|&k| sheet.kinds()[k] == NodeKind::Free) {
            let distance = x[k].truncate().distance_squared(target);
            if distance < nearest.0 {
                nearest = (distance, k);
            }
        }
        let nearest = nearest.1;
        // Material coordinates of the target, from the gradient of the horizontal positions.
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
            sum = sum + self.stretch(k).scaled(weight);
        }
        sum
    }
}

/// Strains of a whole sheet \[-\].
pub(crate) struct Summary<const N: usize> {
    /// Greatest principal strain.
    pub(crate) greatest: f64,
    /// Deformed area / rest area of the triangles.
    pub(crate) area_ratio: f64,
    /// Fraction of the rest area with a greatest principal strain above each limit.
    pub(crate) fraction_above: [f64; N],
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::HalfBall;

    #[test]
    fn a_homogeneous_stretch_is_recovered_at_every_node() {
        let sheet = Sheet::new(33, 50.0);
        let (along, across, shear) = (1.4, 1.1, 0.2);
        let x: Vec<DVec3> = sheet
            .rest()
            .iter()
            .map(|p| DVec3::new(along * p.x + shear * p.y, across * p.y, 0.3 * p.x))
            .collect();
        let deformation =
            Deformation::new(crate::mesh::Rest::of_sheet(sheet.clone()).membrane(), &x);
        let normal = DVec3::new(along, 0.0, 0.3).cross(DVec3::new(shear, across, 0.0));
        // λ₁² + λ₂² = tr C, λ₁λ₂ = √det C.
        let trace = along * along + 0.09 + shear * shear + across * across;
        for k in deformation.inside() {
            let [first, second] = deformation.principal(k).map(|e| e + 1.0);
            assert!((first * first + second * second - trace).abs() < 1e-12);
            assert!((deformation.area_stretch(k) - normal.length()).abs() < 1e-12);
            assert!(deformation.normal(k).distance(normal.normalize()) < 1e-12);
            // U d is λ₁ d for the first direction: tested as |F d| = λ₁, the greatest stretch of all directions.
            let direction = deformation.first_direction(k);
            let pushed = DVec3::new(along, 0.0, 0.3) * direction.x
                + DVec3::new(shear, across, 0.0) * direction.y;
            assert!((pushed.length() - first).abs() < 1e-12);
        }
        let summary = deformation.summary([0.0, 1.0], |_| 1.0);
        assert!((summary.area_ratio - normal.length()).abs() < 1e-12);
        let [all, none] = summary.fraction_above;
        assert!((all - 1.0).abs() < 1e-12 && none < 1e-12);
    }
    /// y ↦ y + cy² stretches by 1 + 2cy, in closed form √(1 + 4cy') at the deformed y'.
    #[test]
    fn the_stretch_at_the_apex_is_that_at_the_shifted_apex() {
        let (sheet, rate) = (Sheet::new(33, 50.0), 0.004);
        let bent = |p: &DVec2| DVec3::new(p.x, p.y + rate * p.y * p.y, 0.0);
        let x: Vec<DVec3> = sheet.rest().iter().map(bent).collect();
        let deformation =
            Deformation::new(crate::mesh::Rest::of_sheet(sheet.clone()).membrane(), &x);
        for shift in [0.0, 18.0, -11.0] {
            let shape = HalfBall::round(40.0, 30.0).anatomical(46.0, shift);
            let dome = Dome::new(DVec2::new(3.0, -2.0), shape, 0.7);
            let found = deformation.at_apex(&sheet, &dome, &x).area_stretch();
            let expected = (1.0 + 4.0 * rate * (-2.0 - shift)).sqrt();
            assert!((found - expected).abs() < 1e-3, "{shift}: {found} {expected}");
        }
    }
}
