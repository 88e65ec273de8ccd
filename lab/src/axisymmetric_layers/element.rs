//! Elements: quadrilateral of a solid, ring of the skin, ring of the attachment. Each computes energy \[µJ = kPa·mm³\],
//! gradient and Hessian by its nodes' coordinates, in the order r₀, z₀, r₁, z₁ …
//!
//! Uses `springs`, `law`, `wall`. Used by `assembly`.

use super::law::SolidLaw;
use super::wall::Wall;
use implant_preview_core::mesh::Attachment;
use implant_preview_core::springs::Material;
use implant_preview_core::springs::coupled::{
    PrincipalResponse, principal_response, relaxed_response,
};
use std::f64::consts::PI;

/// Energy, gradient and Hessian of an element with `N` coordinates.
#[derive(Clone, Copy, Debug)]
pub(super) struct Linearised<const N: usize> {
    pub(super) energy: f64,
    pub(super) gradient: [f64; N],
    pub(super) hessian: [[f64; N]; N],
}

impl<const N: usize> Linearised<N> {
    fn zero() -> Self {
        Self { energy: 0.0, gradient: [0.0; N], hessian: [[0.0; N]; N] }
    }
}

/// Abscissae of Gauss quadrature with two points on \[−1, 1\]; their weights are 1.
const GAUSS_2: [f64; 2] = [-0.577_350_269_189_625_8, 0.577_350_269_189_625_8];

/// Abscissae and weights of Gauss quadrature with three points on \[−1, 1\].
const GAUSS_3: [(f64, f64); 3] =
    [(-0.774_596_669_241_483_4, 5.0 / 9.0), (0.0, 8.0 / 9.0), (0.774_596_669_241_483_4, 5.0 / 9.0)];

/// Quadrature point of a quadrilateral.
#[derive(Clone, Copy, Debug)]
struct Point {
    /// Rest volume 2πR dR dZ \[mm³\].
    volume: f64,
    /// Derivatives of the shape functions by R and Z \[1/mm\].
    by_r: [f64; 4],
    by_z: [f64; 4],
    /// Shape functions / R \[1/mm\].
    hoop: [f64; 4],
}

impl Point {
    /// Deformation gradient in the plane, row by row, and the hoop stretch.
    fn deformation(&self, x: &[f64; 8]) -> [f64; 5] {
        let mut f = [0.0; 5];
        for a in 0..4 {
            let (r, z) = (x[2 * a], x[2 * a + 1]);
            f[0] += r * self.by_r[a];
            f[1] += r * self.by_z[a];
            f[2] += z * self.by_r[a];
            f[3] += z * self.by_z[a];
            f[4] += r * self.hoop[a];
        }
        f
    }
}

/// The variables t, D, h of the law.
fn state(f: &[f64; 5]) -> [f64; 3] {
    [f[..4].iter().map(|x| x * x).sum(), f[0] * f[3] - f[1] * f[2], f[4]]
}

/// Bilinear quadrilateral with 2 × 2 Gauss points and the mean dilatation J̄ of the cell. Nodes counter-clockwise from the lower
/// inner corner.
#[derive(Clone, Debug)]
pub(super) struct Quadrilateral {
    points: [Point; 4],
    /// Rest volume \[mm³\].
    volume: f64,
}

impl Quadrilateral {
    /// The cell with corners \[R, Z\] at rest \[mm\].
    pub(super) fn new(corners: [[f64; 2]; 4]) -> Self {
        let point = |k: usize| {
            let (xi, eta) = (GAUSS_2[k % 2], GAUSS_2[k / 2]);
            let (a, b) =
                ([0.5 * (1.0 - xi), 0.5 * (1.0 + xi)], [0.5 * (1.0 - eta), 0.5 * (1.0 + eta)]);
            let shape = [a[0] * b[0], a[1] * b[0], a[1] * b[1], a[0] * b[1]];
            let by_xi = [-b[0], b[0], b[1], -b[1]].map(|slope| 0.5 * slope);
            let by_eta = [-a[0], -a[1], a[1], a[0]].map(|slope| 0.5 * slope);
            let sum = |of: &[f64; 4], axis: usize| -> f64 {
                of.iter().zip(&corners).map(|(n, corner)| n * corner[axis]).sum()
            };
            // The Jacobian ∂(R, Z)/∂(ξ, η).
            let [r_xi, z_xi] = [0, 1].map(|axis| sum(&by_xi, axis));
            let [r_eta, z_eta] = [0, 1].map(|axis| sum(&by_eta, axis));
            let determinant = r_xi * z_eta - r_eta * z_xi;
            let radius = sum(&shape, 0);
            let by =
                |k: usize, [xi, eta]: [f64; 2]| (by_xi[k] * xi + by_eta[k] * eta) / determinant;
            Point {
                volume: 2.0 * PI * radius * determinant,
                by_r: [0, 1, 2, 3].map(|k| by(k, [z_eta, -z_xi])),
                by_z: [0, 1, 2, 3].map(|k| by(k, [-r_eta, r_xi])),
                hoop: shape.map(|n| n / radius),
            }
        };
        let points = std::array::from_fn(point);
        Self { points, volume: points.iter().map(|p| p.volume).sum() }
    }

    /// Energy alone; infinite for an inverted cell.
    pub(super) fn energy(&self, law: &SolidLaw, x: &[f64; 8]) -> f64 {
        let mut squares = [0.0; 4];
        let mut mean = 0.0;
        for (point, square) in self.points.iter().zip(&mut squares) {
            let variables = state(&point.deformation(x));
            match law.isochoric_value(variables) {
                Some(value) => *square = value,
                None => return f64::INFINITY,
            }
            mean += point.volume / self.volume * variables[1] * variables[2];
        }
        let volumetric = law.volumetric(mean)[0];
        let one = |(p, s): (&Point, &f64)| p.volume * law.energy(s + volumetric);
        self.points.iter().zip(&squares).map(one).sum()
    }

    /// Energy, gradient and Hessian; `None` for an inverted cell.
    pub(super) fn linearise(&self, law: &SolidLaw, x: &[f64; 8]) -> Option<Linearised<8>> {
        let gradients = self.points.map(|point| Gradients::new(&point, x));
        let mut mean = 0.0;
        let mut mean_by = [0.0; 8];
        for (point, g) in self.points.iter().zip(&gradients) {
            let [_, d, h] = g.state;
            let weight = point.volume / self.volume;
            mean += weight * d * h;
            for i in 0..8 {
                mean_by[i] += weight * (h * g.by[1][i] + d * g.by[2][i]);
            }
        }
        let [volumetric, vol_slope, vol_bend] = law.volumetric(mean);
        let mut sum = Linearised::zero();
        let mut pressure = 0.0;
        for (point, g) in self.points.iter().zip(&gradients) {
            let local = law.isochoric(g.state)?;
            let square = local.value + volumetric;
            let [slope, bend] = law.slopes(square).map(|w| w * point.volume);
            sum.energy += point.volume * law.energy(square);
            pressure += slope * vol_slope;
            let by: [f64; 8] = std::array::from_fn(|i| {
                (0..3).map(|v| local.gradient[v] * g.by[v][i]).sum::<f64>() + vol_slope * mean_by[i]
            });
            let rows: [[f64; 8]; 3] = std::array::from_fn(|v| {
                std::array::from_fn(|i| (0..3).map(|w| local.hessian[v][w] * g.by[w][i]).sum())
            });
            for i in 0..8 {
                sum.gradient[i] += slope * by[i];
                for j in 0..8 {
                    let curved: f64 = (0..3).map(|v| g.by[v][i] * rows[v][j]).sum();
                    sum.hessian[i][j] += bend * by[i] * by[j]
                        + slope * (curved + vol_bend * mean_by[i] * mean_by[j]);
                }
            }
            point.add_second(
                slope * local.gradient[0],
                slope * local.gradient[1],
                &mut sum.hessian,
            );
        }
        // The second derivative of J̄.
        for (point, g) in self.points.iter().zip(&gradients) {
            let weight = pressure * point.volume / self.volume;
            let [_, by_d, by_h] = &g.by;
            for i in 0..8 {
                for j in 0..8 {
                    sum.hessian[i][j] += weight * (by_d[i] * by_h[j] + by_h[i] * by_d[j]);
                }
            }
            point.add_second(0.0, weight * g.state[2], &mut sum.hessian);
        }
        Some(sum)
    }
}

impl Point {
    /// Adds `of_t` times the second derivative of t and `of_d` times that of D.
    fn add_second(&self, of_t: f64, of_d: f64, hessian: &mut [[f64; 8]; 8]) {
        for a in 0..4 {
            for b in 0..4 {
                let both = 2.0 * of_t * (self.by_r[a] * self.by_r[b] + self.by_z[a] * self.by_z[b]);
                hessian[2 * a][2 * b] += both;
                hessian[2 * a + 1][2 * b + 1] += both;
                let mixed = of_d * (self.by_r[a] * self.by_z[b] - self.by_z[a] * self.by_r[b]);
                hessian[2 * a][2 * b + 1] += mixed;
                hessian[2 * b + 1][2 * a] += mixed;
            }
        }
    }
}

/// The variables t, D, h at a quadrature point and their derivatives by the coordinates.
struct Gradients {
    state: [f64; 3],
    by: [[f64; 8]; 3],
}

impl Gradients {
    fn new(point: &Point, x: &[f64; 8]) -> Self {
        let f = point.deformation(x);
        let mut by = [[0.0; 8]; 3];
        for a in 0..4 {
            let (p, q) = (point.by_r[a], point.by_z[a]);
            by[0][2 * a] = 2.0 * (f[0] * p + f[1] * q);
            by[0][2 * a + 1] = 2.0 * (f[2] * p + f[3] * q);
            by[1][2 * a] = p * f[3] - q * f[2];
            by[1][2 * a + 1] = q * f[0] - p * f[1];
            by[2][2 * a] = point.hoop[a];
        }
        Self { state: state(&f), by }
    }
}

/// The skin's material, and how it bears compression.
#[derive(Clone, Debug)]
pub(super) struct Skin {
    pub(super) material: Material,
    /// Does the skin wrinkle instead of being compressed (tension field)? Else compression is the odd extension of its curve.
    pub(super) wrinkles: bool,
}

impl Skin {
    fn response(&self, strain: [f64; 2]) -> PrincipalResponse {
        let Material { curve, poisson_ratio, .. } = &self.material;
        let law = if self.wrinkles { relaxed_response } else { principal_response };
        law(curve, *poisson_ratio, strain)
    }
}

/// Ring of the skin: conical membrane with two Gauss points along the meridian.
#[derive(Clone, Debug)]
pub(super) struct SkinRing {
    /// Length along the meridian without stress \[mm\].
    length: f64,
    /// Area without stress \[mm²\] and the two shape functions / R \[1/mm\] at each point.
    points: [(f64, [f64; 2]); 2],
    /// Stretches of the grown ring along the meridian, and around the axis at each point \[-\].
    grown: (f64, [f64; 2]),
}

impl SkinRing {
    /// The ring between two points \[R, Z\] at rest \[mm\], where it is stretched evenly.
    pub(super) fn new([inner, outer]: [[f64; 2]; 2], natural_stretch: f64) -> Self {
        let released = |[r, z]: [f64; 2]| [r / natural_stretch, z / natural_stretch];
        let [inner, outer] = [released(inner), released(outer)];
        let length = (outer[0] - inner[0]).hypot(outer[1] - inner[1]);
        let points = GAUSS_2.map(|xi| {
            let radius = 0.5 * (inner[0] + outer[0] + xi * (outer[0] - inner[0]));
            let hoop = [0.5 * (1.0 - xi) / radius, 0.5 * (1.0 + xi) / radius];
            (2.0 * PI * radius * 0.5 * length, hoop)
        });
        Self { length, points, grown: (1.0, [1.0; 2]) }
    }

    /// Lets the ring grow by a power of its stretch from `rest` to `x`; returns the greatest change of a length \[-\].
    pub(super) fn grow(&mut self, rest: &[f64; 4], x: &[f64; 4], growth: f64) -> f64 {
        let chord = |at: &[f64; 4]| (at[2] - at[0]).hypot(at[3] - at[1]);
        let along = (chord(x) / chord(rest)).powf(growth);
        let mut greatest = along / self.grown.0 - 1.0;
        self.length *= along / self.grown.0;
        for (point, around_before) in self.points.iter_mut().zip(&mut self.grown.1) {
            let (area, hoop) = point;
            let radius = |at: &[f64; 4]| hoop[0] * at[0] + hoop[1] * at[2];
            let around = (radius(x) / radius(rest)).powf(growth);
            let change = around / *around_before;
            greatest = greatest.abs().max((change - 1.0).abs());
            *area *= change * along / self.grown.0;
            *hoop = hoop.map(|part| part / change);
            *around_before = around;
        }
        self.grown.0 = along;
        greatest
    }

    pub(super) fn energy(&self, skin: &Skin, x: &[f64; 4]) -> f64 {
        let along = (x[2] - x[0]).hypot(x[3] - x[1]) / self.length - 1.0;
        let point = |(area, hoop): &(f64, [f64; 2])| {
            let around = hoop[0] * x[0] + hoop[1] * x[2] - 1.0;
            area * skin.material.thickness_mm * skin.response([along, around]).energy
        };
        self.points.iter().map(point).sum()
    }

    pub(super) fn linearise(&self, skin: &Skin, x: &[f64; 4]) -> Linearised<4> {
        let (dr, dz) = (x[2] - x[0], x[3] - x[1]);
        let chord = dr.hypot(dz);
        let (c, s) = (dr / chord, dz / chord);
        // The stretch along the meridian: gradient, and second derivative n nᵀ/(chord·length) with the normal n.
        let along_by = [-c, -s, c, s].map(|v| v / self.length);
        let normal = [s, -c, -s, c];
        let mut sum = Linearised::zero();
        for (area, hoop) in &self.points {
            let around_by = [hoop[0], 0.0, hoop[1], 0.0];
            let strain = [chord / self.length - 1.0, hoop[0] * x[0] + hoop[1] * x[2] - 1.0];
            let response = skin.response(strain);
            let weight = area * skin.material.thickness_mm;
            sum.energy += weight * response.energy;
            let [t1, t2] = response.tension.map(|t| weight * t);
            let [k11, k12, k22] = response.stiffness.map(|k| weight * k);
            let bend = t1 / (chord * self.length);
            for i in 0..4 {
                sum.gradient[i] += t1 * along_by[i] + t2 * around_by[i];
                for j in 0..4 {
                    sum.hessian[i][j] += k11 * along_by[i] * along_by[j]
                        + k22 * around_by[i] * around_by[j]
                        + k12 * (along_by[i] * around_by[j] + around_by[i] * along_by[j])
                        + bend * normal[i] * normal[j];
                }
            }
        }
        sum
    }
}

/// ∫ k N_a N_b 2πR ds \[kPa·mm\] of an attachment over the ring of material radii s₀ … s₁ on the wall as \[M₀₀, M₀₁, M₁₁\]: k rises linearly
/// from zero at the pocket's radius; quadrature of order five on every part between the ramp's ends, exact on the plane.
pub(super) fn attached_ring(
    Attachment { stiffness_kpa_per_mm, ramp_mm }: Attachment,
    [inner, outer]: [f64; 2],
    pocket_radius_mm: f64,
    wall: Wall,
) -> [f64; 3] {
    let stiffness = |radius_mm: f64| {
        let over = radius_mm - pocket_radius_mm;
        stiffness_kpa_per_mm * if over >= ramp_mm { 1.0 } else { (over / ramp_mm).max(0.0) }
    };
    let cuts = [inner, pocket_radius_mm, pocket_radius_mm + ramp_mm, outer];
    let cuts = cuts.map(|r| r.clamp(inner, outer));
    let mut sum = [0.0; 3];
    for part in cuts.windows(2) {
        let half = 0.5 * (part[1] - part[0]);
        for (xi, weight) in GAUSS_3 {
            let radius = 0.5 * (part[0] + part[1]) + xi * half;
            let share = (radius - inner) / (outer - inner);
            let around = 2.0 * PI * wall.point(radius, 0.0)[0];
            let k = stiffness(radius) * around * weight * half;
            sum[0] += k * (1.0 - share) * (1.0 - share);
            sum[1] += k * (1.0 - share) * share;
            sum[2] += k * share * share;
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use implant_preview_core::curve::{Curve, CurveSpec};

    fn compare<const N: usize>(
        x: [f64; N],
        energy: impl Fn(&[f64; N]) -> f64,
        linearise: impl Fn(&[f64; N]) -> Linearised<N>,
    ) {
        let step = 1e-5;
        let here = linearise(&x);
        assert!((here.energy / energy(&x) - 1.0).abs() < 1e-13);
        let force = here.gradient.iter().fold(0.0_f64, |max, g| max.max(g.abs()));
        let stiffness = here.hessian.iter().flatten().fold(0.0_f64, |max, k| max.max(k.abs()));
        for i in 0..N {
            let moved = |sign: f64| {
                let mut moved = x;
                moved[i] += sign * step;
                moved
            };
            let (up, down) = (moved(1.0), moved(-1.0));
            let slope = (energy(&up) - energy(&down)) / (2.0 * step);
            assert!((slope - here.gradient[i]).abs() < 1e-7 * force, "{i}");
            let (up, down) = (linearise(&up).gradient, linearise(&down).gradient);
            for j in 0..N {
                let bend = (up[j] - down[j]) / (2.0 * step);
                assert!((bend - here.hessian[i][j]).abs() < 1e-7 * stiffness, "{i} {j}");
            }
        }
    }

    #[test]
    fn forces_and_stiffness_are_the_derivatives_of_the_energy() {
        let adipose = Curve::new(&CurveSpec::Adipose {}).unwrap();
        let law = SolidLaw::new(&adipose, 0.45);
        for inner in [0.0, 37.0] {
            let cell = Quadrilateral::new([
                [inner, 0.0],
                [inner + 1.8, 0.2],
                [inner + 1.9, 2.6],
                [inner, 2.5],
            ]);
            let x = [
                1.1 * inner,
                4.0,
                1.1 * inner + 2.4,
                3.1,
                1.1 * inner + 2.9,
                5.0,
                1.1 * inner,
                6.1,
            ];
            compare(x, |x| cell.energy(&law, x), |x| cell.linearise(&law, x).unwrap());
        }
        let curve = Curve::new(&CurveSpec::Skin {}).unwrap();
        let material = Material::new(curve, 0.45, 1.5);
        let ring = SkinRing::new([[20.0, 3.0], [22.0, 2.6]], 1.03);
        // Taut, and wrinkled around the axis.
        for x in [[25.0, 12.0, 27.3, 11.0], [15.0, 12.0, 17.0, 11.0]] {
            for wrinkles in [false, true] {
                let skin = Skin { material: material.clone(), wrinkles };
                compare(x, |x| ring.energy(&skin, x), |x| ring.linearise(&skin, x));
            }
        }
        let [given, relaxed] = [false, true].map(|wrinkles| {
            let skin = Skin { material: material.clone(), wrinkles };
            ring.energy(&skin, &[15.0, 12.0, 17.0, 11.0])
        });
        assert!(relaxed < 0.9 * given, "{relaxed} {given}");
    }

    #[test]
    fn a_rigid_lift_and_the_rest_have_no_energy_and_an_inverted_cell_is_refused() {
        let linear = Curve::new(&CurveSpec::Linear { modulus_kpa: 5.0 }).unwrap();
        let law = SolidLaw::new(&linear, 0.3);
        let cell = Quadrilateral::new([[3.0, 0.0], [5.0, 0.0], [5.0, 2.0], [3.0, 2.0]]);
        let lifted = [3.0, 7.0, 5.0, 7.0, 5.0, 9.0, 3.0, 9.0];
        assert!(cell.energy(&law, &lifted).abs() < 1e-12);
        let inverted = [3.0, 2.0, 5.0, 2.0, 5.0, 0.0, 3.0, 0.0];
        assert!(cell.energy(&law, &inverted).is_infinite());
        assert!(cell.linearise(&law, &inverted).is_none());
    }

    #[test]
    fn the_attachment_of_a_ring_is_exact() {
        let attachment = Attachment::default();
        // Rings that contain both ends of the ramp; the sum over the shape functions is ∫ k 2πR dR.
        let total: f64 = (0..5)
            .map(|k| {
                let ring = [20.0 * f64::from(k), 20.0 * f64::from(k + 1)];
                let [a, b, c] = attached_ring(attachment, ring, 70.0, Wall::default());
                a + 2.0 * b + c
            })
            .sum();
        let ramp = 2.0 * PI * 2.0 / 10.0
            * ((80.0_f64.powi(3) - 70.0_f64.powi(3)) / 3.0
                - 70.0 * (80.0_f64.powi(2) - 70.0_f64.powi(2)) / 2.0);
        let beyond = 2.0 * PI * (100.0_f64.powi(2) - 80.0_f64.powi(2));
        assert!((total / (ramp + beyond) - 1.0).abs() < 1e-13);
    }
}
