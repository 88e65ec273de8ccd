//! The centred dome as an axisymmetric two-point boundary problem, solved by shooting: a reference
//! for the grid solver that shares with it the curves and the coupled law, but no grid and no table.
//!
//! A material point is named by its distance s from the pocket's centre at rest, 0 ≤ s ≤ a. It moves
//! to radius r(s) and height z(s). Principal stretches λ₁ = √(r′² + z′²) along the meridian and
//! λ₂ = r/s along the hoop; T₁, T₂ are the nominal tensions (Biot stress times thickness, summed over
//! the layers). The membrane's equations of equilibrium, without friction:
//!
//! * in contact, s ≤ s_c: (r, z) = (R sin θ, z₀ + p cos θ), (s T₁)′ = T₂ cos ψ, λ₁ = |dP/dθ| θ′, where
//!   ψ is the angle of the dome's meridian below the horizontal (ψ = θ on a hemisphere);
//! * free, s ≥ s_c: V = s T₁ sin φ is constant, (s T₁ cos φ)′ = T₂, φ the sheet's own angle;
//! * the tangent is continuous at s_c; at s = a the sheet is clamped: r = a, z = 0.
//!
//! Both parts are integrated over x = ln s, where the apex is no singular point, in variables that
//! lose no digits at small strains: the hoop strain r′ = λ₁ cos φ gives dε₂/dx = ε₁ − λ₁(1 − cos φ) − ε₂,
//! and heights are counted as a drop from the apex. The method is Gragg's extrapolated midpoint rule of
//! order 8 with step control (E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential
//! Equations I*, 2nd ed., 1993, §II.9); at a curve's kinks the steps shrink. The unknowns are the
//! apex strain and s_c: for every apex strain there is one s_c from which the free part comes down to
//! the wall at s = a, and where it meets the wall, inside or outside of r = a, tells whether the apex
//! strain is too small or too large. Both are found in brackets.
//!
//! Uses `curve`, `springs`, `implant`, `scene`. Used by the tests.

use crate::curve::Curve;
use crate::implant::Dome;
use crate::scene::{Scene, SceneError, Springs};
use crate::solve::Material;
use crate::springs::coupled::{biot_stress, equivalent_strain};
use AxisymmetricError::NotFound;
use glam::DVec2;
use std::f64::consts::PI;

/// Greatest local error of one step, relative to the size of what is integrated.
const STEP_TOLERANCE: f64 = 1e-12;
/// Width of a bracket in which a root (of a logarithm or an angle) counts as found.
const ROOT_TOLERANCE: f64 = 1e-13;
/// Pocket and dome meet at the wall when their radii differ by less than this share of the base
/// radius: then the sheet touches the dome all the way.
const FULL_CONTACT: f64 = 1e-9;
/// Where integration starts, as a share of the apex's radius of curvature (the error is its square).
const START: f64 = 1e-5;
/// A dome this far from the pocket's centre, as a share of the base radius, is off centre.
const CENTRED: f64 = 1e-9;
/// The longest step in ln s.
const LONGEST_STEP: f64 = 2.0;
/// A shape that is this far from the clamp at its best (see [`Shot`]) does not meet it.
const TOO_FAR: f64 = 1e-8;
/// Steps in ln s in which the contact's edge is looked for.
const SCAN_STEP: f64 = 0.1;
/// The most steps that one part may take.
const MAX_STEPS: usize = 20_000;

/// Why a scene has no axisymmetric reference solution, in one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum AxisymmetricError {
    /// The scene is out of its limits.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The dome does not stand in the pocket's centre.
    #[error(
        "implant.center_mm is {distance_mm} mm off the pocket's centre; \
         an axisymmetric solution needs a centred dome"
    )]
    OffCentre {
        /// Distance of the centres \[mm\].
        distance_mm: f64,
    },
    /// The paper's springs depend on the direction in the sheet.
    #[error("springs is nikolaev; an axisymmetric solution needs the isotropic coupled springs")]
    Nikolaev,
    /// The dome does not touch the sheet.
    #[error("insertion is 0; an axisymmetric solution needs a dome that lifts the sheet")]
    Flat,
    /// The equations could not be integrated, or no pair of apex stretch and contact radius meets the clamp.
    #[error("no axisymmetric solution was found: {problem}")]
    NotFound {
        /// What went wrong.
        problem: &'static str,
    },
}

/// The equilibrium of a sheet of coupled springs over a centred dome. Lengths in mm, forces in N.
///
/// Local errors of the integration are kept below 1e-12 of what is integrated; a shape that ends
/// more than 1e-8 of the pocket radius from the clamp, or of the apex's height from the wall, is
/// refused.
///
/// Tested for projections of 0.4 to 1.2 base radii, pockets of 1 to 1.5 base radii and insertions from
/// 0.1. Far outside of these (insertions of 0.001, an apex drawn into a tent many base radii wide, soft
/// curves stretched over needles) the search is slow and may end in [`AxisymmetricError::NotFound`].
#[derive(Clone, Debug)]
pub struct Membrane {
    dome: Dome,
    layers: Vec<Material>,
    pocket_radius: f64,
    shot: Shot,
}

impl Membrane {
    /// Solves a scene with a centred dome, coupled springs and insertion > 0. The scene's solver
    /// settings are not used.
    ///
    /// # Errors
    /// One line that says what the scene lacks, or that no solution was found.
    ///
    /// # Examples
    /// ```
    /// use implant_preview::experiment::axisymmetric::Membrane;
    /// use implant_preview::scene::Scene;
    /// let membrane = Membrane::solve(&Scene::default())?;
    /// assert!(membrane.apex_stretch() > 1.0 && membrane.area_ratio() < 2.0);
    /// # Ok::<(), implant_preview::experiment::axisymmetric::AxisymmetricError>(())
    /// ```
    pub fn solve(scene: &Scene) -> Result<Self, AxisymmetricError> {
        scene.validate()?;
        let center = DVec2::from(scene.implant.center_mm);
        let (radius, projection) = (scene.implant.base_radius_mm, scene.implant.projection_mm);
        if center.length() > CENTRED * radius {
            return Err(AxisymmetricError::OffCentre { distance_mm: center.length() });
        }
        if scene.springs != Springs::Coupled {
            return Err(AxisymmetricError::Nikolaev);
        }
        if scene.insertion <= 0.0 {
            return Err(AxisymmetricError::Flat);
        }
        let mut layers = Vec::with_capacity(scene.layers.len());
        for (layer, given) in scene.layers.iter().enumerate() {
            layers.push(Material {
                curve: Curve::new(&given.curve)
                    .map_err(|source| SceneError::Curve { layer, source })?,
                poisson_ratio: given.poisson_ratio,
                thickness_mm: given.thickness_mm,
            });
        }
        let problem = Problem {
            layers: &layers,
            dome: Dome::new(DVec2::ZERO, radius, projection, scene.insertion),
            pocket_radius: scene.pocket_radius_mm.max(radius),
            apex_height: scene.insertion * projection,
        };
        let shot = problem.solve()?;
        let (dome, pocket_radius) = (problem.dome, problem.pocket_radius);
        Ok(Self { dome, layers, pocket_radius, shot })
    }

    /// Radius and height (r, z) \[mm\] of the material point at radius `s_mm` \[mm\], 0 to the pocket
    /// radius (values outside are taken as the nearest end).
    #[must_use]
    pub fn position(&self, s_mm: f64) -> (f64, f64) {
        let apex = self.dome.apex().z;
        match self.state(s_mm) {
            Place::Contact { angle, .. } => {
                (self.dome.base_radius * angle.sin(), apex - drop_on(&self.dome, angle))
            }
            Place::Free { s, hoop, drop, .. } => (s * (1.0 + hoop), apex - drop),
        }
    }

    /// Principal stretches \[λ₁ along the meridian, λ₂ along the hoop\] \[-\] at material radius
    /// `s_mm` \[mm\], 0 to the pocket radius (values outside are taken as the nearest end).
    #[must_use]
    pub fn stretches(&self, s_mm: f64) -> [f64; 2] {
        let (hoop, tension) = match self.state(s_mm) {
            Place::Contact { hoop, tension, .. } | Place::Free { hoop, tension, .. } => {
                (hoop, tension)
            }
        };
        [1.0 + meridional_strain(&self.layers, tension, hoop, hoop), 1.0 + hoop]
    }

    /// Stretch at the apex \[-\], the same in all directions.
    #[must_use]
    pub fn apex_stretch(&self) -> f64 {
        1.0 + self.shot.apex_strain
    }

    /// Where contact ends: polar angle about the ellipsoid's centre \[rad\], 0 (apex) to π/2 (base).
    #[must_use]
    pub fn contact_angle(&self) -> f64 {
        let (sin, cos) = self.shot.edge_angle.sin_cos();
        (self.dome.base_radius * sin).atan2(self.dome.projection * cos)
    }

    /// Where contact ends: distance from the pocket's centre at rest \[mm\].
    #[must_use]
    pub fn contact_material_radius_mm(&self) -> f64 {
        self.shot.edge.exp()
    }

    /// Vertical force between dome and sheet \[N\].
    #[must_use]
    pub fn contact_force_n(&self) -> f64 {
        2.0 * PI * self.shot.lift / 1000.0
    }

    /// Area of the stretched sheet, as a multiple of the pocket's \[-\].
    #[must_use]
    pub fn area_ratio(&self) -> f64 {
        2.0 * self.shot.area / self.pocket_radius.powi(2)
    }

    fn state(&self, s_mm: f64) -> Place {
        let s = s_mm.clamp(0.0, self.pocket_radius);
        let x = s.ln();
        let first = &self.shot.contact[0];
        if x <= self.shot.edge || self.shot.free.is_empty() {
            let system = Contact { layers: &self.layers, dome: &self.dome };
            // Nearer to the apex than integration started the sheet is stretched evenly.
            let [turn, hoop, tension, _] = between(&system, &self.shot.contact, x.max(first.0));
            return Place::Contact { angle: s * turn, hoop, tension };
        }
        let system = Free { layers: &self.layers, lift: self.shot.lift };
        let [hoop, drop, pull, _] = between(&system, &self.shot.free, x);
        Place::Free { s, hoop, drop, tension: pull.hypot(self.shot.lift) / s }
    }
}

/// A material point: strain ε₂ \[-\], tension T₁ \[kPa·mm\], lengths in mm.
enum Place {
    Contact { angle: f64, hoop: f64, tension: f64 },
    Free { s: f64, hoop: f64, drop: f64, tension: f64 },
}

/// What is integrated over x = ln s; see [`Contact`] and [`Free`].
type State = [f64; 4];
/// x and the state there.
type Node = (f64, State);

/// One choice of the unknowns, integrated.
#[derive(Clone, Debug)]
struct Shot {
    /// Strain at the apex \[-\].
    apex_strain: f64,
    /// Steps over the dome, up to the contact's edge or farther, and over the free part (empty: none).
    contact: Vec<Node>,
    free: Vec<Node>,
    /// The contact's edge: ln s_c, and the dome's parameter θ there.
    edge: f64,
    edge_angle: f64,
    /// V = s T₁ sin φ \[mN\].
    lift: f64,
    /// ∫ r λ₁ ds over the sheet \[mm²\].
    area: f64,
    /// How far outside of r = a the sheet ends, as a share of a, and how far below the wall, as a
    /// share of the apex's height.
    miss: f64,
    depth: f64,
}

/// The boundary problem. Lengths in mm, tensions in kPa·mm.
struct Problem<'a> {
    layers: &'a [Material],
    dome: Dome,
    pocket_radius: f64,
    apex_height: f64,
}

impl Problem<'_> {
    fn solve(&self) -> Result<Shot, AxisymmetricError> {
        let (a, dome) = (self.pocket_radius, &self.dome);
        let share = (self.apex_height / dome.projection).sqrt();
        // What a sphere under a wide sheet shows at small insertions.
        let slope = 0.4 * share * dome.projection / dome.base_radius;
        let guess = (0.4 * slope * slope).min(0.3).ln();
        let mut edge = (0.4 * share * dome.base_radius).min(0.5 * a).ln();
        let mut best: Option<(f64, Shot)> = None;
        root_near(guess, 0.2, (-90.0, 12.0), |log_strain| {
            let (miss, shot) = self.shoot(log_strain.exp(), edge)?;
            if let Some(shot) = shot {
                edge = shot.edge;
                if best.as_ref().is_none_or(|(least, _)| miss.abs() <= *least) {
                    best = Some((miss.abs(), shot));
                }
            }
            Ok(miss)
        })?;
        match best {
            Some((_, shot)) if shot.miss.abs() < TOO_FAR && shot.depth.abs() < TOO_FAR => Ok(shot),
            _ => Err(NotFound { problem: "no shape meets the clamp" }),
        }
    }

    /// Integrates from an apex strain: how far the sheet ends from the clamp \[-\], negative if the
    /// strain is too small (then there may be no shot).
    fn shoot(
        &self,
        apex_strain: f64,
        edge_guess: f64,
    ) -> Result<(f64, Option<Shot>), AxisymmetricError> {
        let (dome, a) = (&self.dome, self.pocket_radius);
        let radius = dome.base_radius;
        let wall_angle = (-dome.base_height / dome.projection).clamp(0.0, 1.0).acos();
        let wall_radius = dome.wall_radius();
        // Near full contact the sheet ends off the wall's circle by the square of how far the edge
        // is from it: roots make that linear.
        let reach = ((a - wall_radius) / radius).max(0.0);
        let contact = self.over_the_dome(apex_strain, a.ln(), wall_angle)?;
        let over = Contact { layers: self.layers, dome };
        let angle_at = |x: f64| x.exp() * between(&over, &contact, x)[0];
        let (start, (end, last)) = (contact[0].0, contact[contact.len() - 1]);
        let angle = end.exp() * last[0];
        let too_small = angle.min(wall_angle) - wall_angle - reach.sqrt();
        if reach <= FULL_CONTACT {
            let shot = || self.leave(contact.clone(), apex_strain);
            return Ok(if angle < wall_angle {
                (too_small, if end >= a.ln() { Some(shot()?) } else { None })
            } else {
                let wall = if angle > wall_angle {
                    let before = contact[contact.len().max(2) - 2].0;
                    let ends = [before, end].map(|x| (x, angle_at(x) - wall_angle));
                    root_between(ends, |x| Ok(angle_at(x) - wall_angle))?
                } else {
                    end
                };
                (a.ln() - wall, if end >= a.ln() { Some(shot()?) } else { None })
            });
        }

        // Free from an edge on: how far below the wall it ends, as a share of the apex's height.
        let upto = |edge: f64| {
            let mut nodes = contact.clone();
            nodes.truncate(contact.partition_point(|node| node.0 < edge).max(1));
            if edge > nodes[nodes.len() - 1].0 {
                nodes.push((edge, between(&over, &contact, edge)));
            }
            nodes
        };
        let depth = |edge: f64| -> Result<f64, AxisymmetricError> {
            let y = between(&over, &contact, edge);
            if y[2] <= 0.0 {
                return Ok(-1.0);
            }
            let drop = drop_on(dome, edge.exp() * y[0]) / self.apex_height;
            if drop >= 1.0 {
                return Ok(drop);
            }
            Ok(self.leave(vec![(edge, y)], apex_strain)?.depth)
        };
        // With a larger contact the sheet ends lower, until its tension ceases on the dome's side: the
        // smallest contact counts.
        let near = edge_guess.min(end - 0.02).max(start);
        let edge = match root_near(near, 0.02, (start, end), depth) {
            Ok(edge) => edge,
            Err(_) => {
                let mut x = start;
                let mut below = (x, depth(x)?);
                loop {
                    x += SCAN_STEP;
                    if below.0 >= end {
                        return Ok((too_small - 1.0, None));
                    }
                    let next = (x.min(end), depth(x.min(end))?);
                    if next.1 >= 0.0 {
                        break root_between([below, next], depth)?;
                    }
                    below = next;
                }
            }
        };
        let shot = self.leave(upto(edge), apex_strain)?;
        let landing = (a * (1.0 + shot.miss) - wall_radius) / radius;
        let miss = if landing > 0.0 {
            a * shot.miss / radius / (landing.sqrt() + reach.sqrt())
        } else {
            -(-landing).sqrt() - reach.sqrt()
        };
        Ok((miss, Some(shot)))
    }

    /// The part on the dome from the apex on: to x = `edge`, past the parameter `last_angle`, or to
    /// where T₁ ends.
    fn over_the_dome(
        &self,
        apex_strain: f64,
        edge: f64,
        last_angle: f64,
    ) -> Result<Vec<Node>, AxisymmetricError> {
        let dome = &self.dome;
        let radius = dome.base_radius;
        let system = Contact { layers: self.layers, dome };
        let sharpness = radius / dome.projection * apex_strain.min(1.0).sqrt();
        let start = (START * radius * sharpness).min(START * edge.exp());
        let stretch = 1.0 + apex_strain;
        let tension = tensions(self.layers, [apex_strain; 2])[0];
        let first = [stretch / radius, apex_strain, tension, 0.5 * stretch * stretch];
        let scale = |y: &State| [y[0].abs(), apex_strain, tension, y[3].abs()];
        march(&system, (start.ln(), first), edge, scale, |x, y| {
            x.exp() * y[0] >= last_angle || y[2] <= 0.0
        })
    }

    /// The free part from the end of contact to the clamp.
    fn leave(&self, contact: Vec<Node>, apex_strain: f64) -> Result<Shot, AxisymmetricError> {
        let (edge, [turn, hoop, tension, area]) = contact[contact.len() - 1];
        let edge_angle = edge.exp() * turn;
        let a = self.pocket_radius;
        let Incline { sin, cos, .. } = incline(&self.dome, edge_angle);
        let pull = edge.exp() * tension;
        let lift = pull * sin;
        let system = Free { layers: self.layers, lift };
        let first = [hoop, drop_on(&self.dome, edge_angle), pull * cos, area];
        let scale = |y: &State| [apex_strain, self.apex_height, pull.max(y[2].abs()), 1.0];
        let free = march(&system, (edge, first), a.ln(), scale, |_, _| false)?;
        let [hoop, drop, _, area] = free[free.len() - 1].1;
        let area = area * a * a;
        let depth = drop / self.apex_height - 1.0;
        Ok(Shot { apex_strain, contact, free, edge, edge_angle, lift, area, miss: hoop, depth })
    }
}

/// Tensions \[T₁, T₂\] \[kPa·mm\] of principal strains \[-\], by the exact curves.
fn tensions(layers: &[Material], strain: [f64; 2]) -> [f64; 2] {
    layers.iter().fold([0.0; 2], |sum, layer| {
        let stress = biot_stress(&layer.curve, layer.poisson_ratio, strain);
        [sum[0] + layer.thickness_mm * stress[0], sum[1] + layer.thickness_mm * stress[1]]
    })
}

/// T₁ and ∂T₁/∂ε₁ \[kPa·mm\].
fn meridional_tension(layers: &[Material], [a, b]: [f64; 2]) -> (f64, f64) {
    layers.iter().fold((0.0, 0.0), |(tension, slope), layer| {
        let (curve, nu) = (&layer.curve, layer.poisson_ratio);
        let plane = 1.0 / (1.0 - nu * nu);
        let [along, across] = biot_stress(curve, nu, [a, b]);
        let e = equivalent_strain([a, b], nu);
        let stiffness = if e > 1e-9 {
            // Ef/ē, from the work T·ε = Ef ē; ∂ē/∂ε₁ = n.
            let secant = (along * a + across * b) / (e * e);
            let n = (a + nu * b) * plane / e;
            secant * plane + (curve.slope(e) - secant) * n * n
        } else {
            curve.slope(0.0) * plane
        };
        (tension + layer.thickness_mm * along, slope + layer.thickness_mm * stiffness)
    })
}

/// The strain ε₁ \[-\] at which a sheet with hoop strain ε₂ \[-\] carries T₁ \[kPa·mm\]: Newton's method
/// kept in its bracket (T₁ rises with ε₁ because the energy is convex).
fn meridional_strain(layers: &[Material], tension: f64, hoop: f64, guess: f64) -> f64 {
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    let mut strain = guess;
    for _ in 0..200 {
        let (value, slope) = meridional_tension(layers, [strain, hoop]);
        let excess = value - tension;
        if excess < 0.0 {
            low = strain;
        } else {
            high = strain;
        }
        let newton = strain - excess / slope;
        let near = 1e-11 * (newton.abs() + 1e-3 * hoop.abs());
        if (newton - strain).abs() <= near || !newton.is_finite() {
            return newton;
        }
        let inside = newton > low && newton < high;
        let closed = low.is_finite() && high.is_finite();
        strain = if inside || !closed { newton } else { 0.5 * (low + high) };
    }
    strain
}

/// Direction of the dome's meridian at its parameter θ.
struct Incline {
    sin: f64,
    cos: f64,
    /// 1 − cos ψ, without loss of digits.
    versine: f64,
    /// |dP/dθ| \[mm\].
    speed: f64,
}

fn incline(dome: &Dome, angle: f64) -> Incline {
    let (sin, cos) = angle.sin_cos();
    let (down, out) = (dome.projection * sin, dome.base_radius * cos);
    let speed = down.hypot(out);
    let (sin, cos) = (down / speed, out / speed);
    let versine = if cos > 0.0 { sin * sin / (1.0 + cos) } else { 1.0 - cos };
    Incline { sin, cos, versine, speed }
}

/// How far the dome's surface at its parameter θ lies below the apex \[mm\].
fn drop_on(dome: &Dome, angle: f64) -> f64 {
    2.0 * dome.projection * (0.5 * angle).sin().powi(2)
}

/// Ordinary differential equations over x = ln s.
trait System {
    /// dy/dx. `strain` is a guess of the meridional strain ε₁, and then its value.
    fn rate(&self, x: f64, y: &State, strain: &mut f64) -> State;
    /// Hoop strain ε₂ of a state, near which ε₁ is looked for first.
    fn hoop(&self, y: &State) -> f64;
}

/// The part on the dome: \[θ/s \[1/mm\], ε₂, T₁ \[kPa·mm\], ∫ r λ₁ ds / s² \[-\]\].
struct Contact<'a> {
    layers: &'a [Material],
    dome: &'a Dome,
}

impl System for Contact<'_> {
    fn rate(&self, x: f64, &[turn, hoop, tension, area]: &State, strain: &mut f64) -> State {
        let s = x.exp();
        *strain = meridional_strain(self.layers, tension, hoop, *strain);
        let across = tensions(self.layers, [*strain, hoop])[1];
        let Incline { versine, speed, .. } = incline(self.dome, s * turn);
        let stretch = 1.0 + *strain;
        [
            stretch / speed - turn,
            *strain - stretch * versine - hoop,
            across - tension - across * versine,
            stretch * (1.0 + hoop) - 2.0 * area,
        ]
    }

    fn hoop(&self, y: &State) -> f64 {
        y[1]
    }
}

/// The free part: \[ε₂, drop from the apex \[mm\], s T₁ cos φ \[mN\], ∫ r λ₁ ds / s² \[-\]\].
struct Free<'a> {
    layers: &'a [Material],
    /// V = s T₁ sin φ \[mN\].
    lift: f64,
}

impl System for Free<'_> {
    fn rate(&self, x: f64, &[hoop, _, pull, area]: &State, strain: &mut f64) -> State {
        let s = x.exp();
        let total = pull.hypot(self.lift);
        let (sin, cos) = (self.lift / total, pull / total);
        let versine = if cos > 0.0 { sin * sin / (1.0 + cos) } else { 1.0 - cos };
        *strain = meridional_strain(self.layers, total / s, hoop, *strain);
        let across = tensions(self.layers, [*strain, hoop])[1];
        let stretch = 1.0 + *strain;
        [
            *strain - stretch * versine - hoop,
            s * stretch * sin,
            s * across,
            stretch * (1.0 + hoop) - 2.0 * area,
        ]
    }

    fn hoop(&self, y: &State) -> f64 {
        y[0]
    }
}

/// Substeps of the midpoint rules that are extrapolated.
const SUBSTEPS: [u32; 4] = [2, 4, 6, 8];

fn combine(y: &State, step: f64, rate: &State) -> State {
    std::array::from_fn(|k| y[k] + step * rate[k])
}

/// One step of Gragg's midpoint rule, extrapolated (order 8), and an estimate of its error.
fn step(
    system: &impl System,
    (x, y): Node,
    rate: &State,
    length: f64,
    strain: &mut f64,
) -> (State, State) {
    const N: usize = SUBSTEPS.len();
    let (mut above, mut row) = ([y; N], [y; N]);
    for (j, count) in SUBSTEPS.into_iter().enumerate() {
        let h = length / f64::from(count);
        let (mut before, mut now) = (y, combine(&y, h, rate));
        for k in 1..count {
            let rate = system.rate(x + f64::from(k) * h, &now, strain);
            (before, now) = (now, combine(&before, 2.0 * h, &rate));
        }
        let rate = system.rate(x + length, &now, strain);
        row[0] = std::array::from_fn(|k| 0.5 * (before[k] + now[k] + h * rate[k]));
        // Neville's scheme in the square of the substep.
        for i in 0..j {
            let ratio = f64::from(count) / f64::from(SUBSTEPS[j - i - 1]);
            let weight = 1.0 / (ratio * ratio - 1.0);
            row[i + 1] = std::array::from_fn(|k| row[i][k] + weight * (row[i][k] - above[i][k]));
        }
        above = row;
    }
    let error = std::array::from_fn(|k| (row[N - 1][k] - row[N - 2][k]).abs());
    (row[N - 1], error)
}

/// Integrates from a node to `end`, or to the first step after which `stop` holds.
fn march(
    system: &impl System,
    start: Node,
    end: f64,
    scale: impl Fn(&State) -> State,
    stop: impl Fn(f64, &State) -> bool,
) -> Result<Vec<Node>, AxisymmetricError> {
    let mut nodes = vec![start];
    let (mut x, mut y) = start;
    let mut strain = system.hoop(&y);
    let mut length = LONGEST_STEP.min(end - x);
    for _ in 0..MAX_STEPS {
        if x >= end || stop(x, &y) {
            return Ok(nodes);
        }
        let rate = system.rate(x, &y, &mut strain);
        // A step that cannot be shortened any more is at a kink: it is taken.
        let shortest = 1e-13 * (1.0 + x.abs());
        loop {
            let last = x + length >= end - shortest;
            let taken = if last { end - x } else { length };
            let mut trial = strain;
            let (next, error) = step(system, (x, y), &rate, taken, &mut trial);
            let size = scale(&y);
            let worst = (0..4).map(|k| error[k] / size[k]).fold(0.0, f64::max) / STEP_TOLERANCE;
            let sound = next.iter().chain(&error).all(|v| v.is_finite());
            let factor = if sound { (0.8 * worst.powf(-1.0 / 7.0)).clamp(0.1, 4.0) } else { 0.1 };
            length = (taken * factor).min(LONGEST_STEP);
            if sound && (worst <= 1.0 || taken <= shortest) {
                (x, y, strain) = (if last { end } else { x + taken }, next, trial);
                length = length.max(shortest);
                break;
            }
            if taken <= shortest {
                return Err(NotFound { problem: "the equations could not be integrated" });
            }
            length = length.max(0.5 * shortest);
        }
        nodes.push((x, y));
    }
    Err(NotFound { problem: "the equations took too many steps" })
}

/// The state at x by one step from the node before it, as exact as the nodes themselves.
fn between(system: &impl System, nodes: &[Node], x: f64) -> State {
    let before = nodes.partition_point(|node| node.0 <= x).clamp(1, nodes.len()) - 1;
    let (from, y) = nodes[before];
    if x <= from {
        return y;
    }
    let mut strain = system.hoop(&y);
    let rate = system.rate(from, &y, &mut strain);
    step(system, (from, y), &rate, x - from, &mut strain).0
}

/// Root of a function that goes from negative to positive, looked for from a guess outwards.
fn root_near(
    guess: f64,
    mut stride: f64,
    (low, high): (f64, f64),
    mut f: impl FnMut(f64) -> Result<f64, AxisymmetricError>,
) -> Result<f64, AxisymmetricError> {
    let mut here = (guess, f(guess)?);
    let direction = if here.1 < 0.0 { 1.0 } else { -1.0 };
    loop {
        let x = (here.0 + direction * stride).clamp(low, high);
        let next = (x, f(x)?);
        if (next.1 < 0.0) != (here.1 < 0.0) {
            return root_between([here, next], f);
        }
        if x <= low || x >= high {
            return Err(NotFound { problem: "no shape meets the clamp" });
        }
        here = next;
        stride *= 1.6;
    }
}

/// Root between two points of opposite sign (T. R. Chandrupatla, Adv. Eng. Softw. 28(3), 1997:
/// inverse quadratic interpolation where it is safe, else bisection).
fn root_between(
    [(mut x2, mut f2), (mut x1, mut f1)]: [(f64, f64); 2],
    mut f: impl FnMut(f64) -> Result<f64, AxisymmetricError>,
) -> Result<f64, AxisymmetricError> {
    let mut t = 0.5_f64;
    for _ in 0..200 {
        let (best, miss) = if f2.abs() < f1.abs() { (x2, f2) } else { (x1, f1) };
        let width = (x2 - x1).abs();
        let least = (ROOT_TOLERANCE * (1.0 + best.abs())) / width.max(f64::MIN_POSITIVE);
        if least > 0.5 || miss.abs() <= f64::MIN_POSITIVE {
            return Ok(best);
        }
        let x = x1 + t.clamp(least, 1.0 - least) * (x2 - x1);
        let value = f(x)?;
        let (x3, f3);
        if (value < 0.0) == (f1 < 0.0) {
            (x3, f3) = (x1, f1);
        } else {
            (x3, f3) = (x2, f2);
            (x2, f2) = (x1, f1);
        }
        (x1, f1) = (x, value);
        let (xi, phi) = ((x1 - x2) / (x3 - x2), (f1 - f2) / (f3 - f2));
        let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
        t = if safe {
            f1 / (f2 - f1) * f3 / (f2 - f3)
                + (x3 - x1) / (x2 - x1) * f1 / (f3 - f1) * f2 / (f3 - f2)
        } else {
            0.5
        };
    }
    Err(NotFound { problem: "a root's bracket did not close" })
}
