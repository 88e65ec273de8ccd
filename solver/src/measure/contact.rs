//! Contact between dome and tissue: pressure and contact edge.
//!
//! Under a sheet the pressure follows from the curvature and jumps to zero at the contact's edge, where a node's own surroundings are
//! partly free: the pressure there is extrapolated. Under solid tissue the pressure falls to zero at the edge, and the force on a node
//! is the integral of the pressure times the node's function: the pressure is force / area at every node.

use super::Pressure;
use super::contact_area::Contacted;
use crate::mesh::NodeKind;
use crate::mesh::part::Part;
use crate::solve::Solution;
use glam::{DMat3, DVec3, dvec3};

/// Range of distances from the contact of the nodes that locate the contact edge \[grid spacings\].
const EDGE_BAND: (f64, f64) = (1.0, 6.0);

/// The middle of the implant \[axes of its base\].
const MIDDLE: f64 = 0.5;

/// Columns and rows to either side from which the pressure at the contact's edge is extrapolated.
const REACH: usize = 4;

/// Contact at every node; all arrays are arrays over the part that determines the shape.
#[derive(Clone, Debug)]
pub(super) struct Contact {
    part: Part,
    /// Normal force of the dome on the sheet \[kPa·mm²\]; zero outside of the contact.
    force: Vec<f64>,
    /// Deformed area around each node \[mm²\].
    area: Vec<f64>,
    /// Under a sheet: do the node and its neighbours of two rings touch the dome? Of one ring where the contact is small.
    inside: Vec<bool>,
    is_solid: bool,
    nodes_per_side: usize,
    /// Vertical force \[kPa·mm²\].
    vertical_force: f64,
    /// Sum of the dome's forces \[kPa·mm²\].
    resultant: DVec3,
    /// Pressure \[kPa\]; zero outside of the contact.
    at_nodes: Vec<f64>,
    /// Mean and greatest pressure \[kPa\].
    pressure: Option<Pressure>,
    /// Greatest pressure of the middle and around it \[kPa\].
    peaks: [f64; 2],
}

/// The contact edge on a centred dome.
pub(super) struct Edge {
    /// Polar angle about the ellipsoid's centre \[rad\].
    pub(super) angle: f64,
    /// Distance from the pocket's centre at rest \[mm\].
    pub(super) material_radius: f64,
}

impl Contact {
    /// The contact of a solution.
    pub(super) fn new(solution: &Solution) -> Self {
        let (reactions, deformation) = (solution.part_reactions(), solution.inner_deformation());
        let force = reactions.force.clone();
        let part = solution.part();
        let area = part.nodes().map(|k| deformation.deformed_area(k)).collect();
        let n = solution.problem().sheet().nodes_per_side();
        // A node with a contact offset disturbs the forces on its neighbours: two rings of nodes are left out.
        let [first, first_row] = part.first();
        let within = |marks: &[bool]| -> Vec<bool> {
            let mut within = Vec::with_capacity(marks.len());
            for (row, marked) in (first_row..).zip(marks.chunks_exact(part.columns())) {
                within.extend((first..).zip(marked).map(|(column, is_marked)| {
                    // A node in contact is free: the node has neighbours on all sides.
                    *is_marked
                        && (row - 1..=row + 1).all(|row| {
                            (column - 1..=column + 1)
                                .all(|column| marks[part.index_at(column, row)])
                        })
                }));
            }
            within
        };
        let touching: Vec<bool> = force.iter().map(|force| *force > 0.0).collect();
        let one_ring = within(&touching);
        let two_rings = within(&one_ring);
        let inside = if two_rings.contains(&true) { two_rings } else { one_ring };
        let (vertical_force, resultant) = (reactions.vertical_force(), reactions.resultant());
        let at_nodes = vec![0.0; part.len()];
        let mut contact = Self {
            part,
            force,
            area,
            inside,
            is_solid: !solution.outer().is_empty(),
            nodes_per_side: n,
            vertical_force,
            resultant,
            at_nodes,
            pressure: None,
            peaks: [0.0; 2],
        };
        contact.find_pressure(solution);
        contact.find_peaks(solution);
        contact
    }

    /// Vertical force between dome and sheet \[kPa·mm²\].
    pub(super) fn vertical_force(&self) -> f64 {
        self.vertical_force
    }

    /// Sum of the dome's forces on the tissue \[kPa·mm²\].
    pub(super) fn resultant(&self) -> DVec3 {
        self.resultant
    }

    /// Number of nodes of the sheet in contact.
    pub(super) fn nodes(&self) -> usize {
        self.touching().map(|(_, node)| self.part.multiplicity(node)).sum::<f64>() as usize
    }

    /// The part's nodes in contact: index in the arrays, node of the grid.
    fn touching(&self) -> impl Iterator<Item = (usize, usize)> {
        self.part.nodes().enumerate().filter(|(index, _)| self.force[*index] > 0.0)
    }

    /// Indices of a node and its eight neighbours.
    fn around(&self, node: usize) -> [[usize; 3]; 3] {
        around(node, self.nodes_per_side).map(|row| row.map(|k| self.part.index(k)))
    }

    /// Contact pressure at a node \[kPa\], the field with the greatest value of [`Self::pressure`]; zero
    /// outside of the contact.
    pub(super) fn pressure_at(&self, node: usize) -> f64 {
        self.at_nodes[self.part.index(node)]
    }

    /// Mean and greatest pressure \[kPa\]; `None` without contact.
    pub(super) fn pressure(&self) -> Option<Pressure> {
        self.pressure
    }

    /// Greatest pressure over the middle of the implant and around it \[kPa\]; zero without contact there.
    pub(super) fn peaks(&self) -> [f64; 2] {
        self.peaks
    }

    /// The mean pressure over a node inside of the contact and its neighbours inside \[kPa\]. Neighbours at the edge are left out:
    /// their surroundings are partly free.
    fn pressure_inside(&self, node: usize) -> f64 {
        let beside = self.around(node);
        let inside = beside.as_flattened().iter().filter(|&&k| self.inside[k]);
        let (force, area) =
            inside.fold((0.0, 0.0), |(f, a), &k| (f + self.force[k], a + self.area[k]));
        force / area
    }

    /// The pressure at a node at the contact's edge \[kPa\]: the linear fit of force / area over the nodes inside of the contact
    /// within [`REACH`] columns and rows. Only a part of the node's own surroundings is in contact. `None` without such nodes.
    fn pressure_at_edge(&self, node: usize) -> Option<f64> {
        let n = self.nodes_per_side;
        let (mut matrix, mut right, mut count) = (DMat3::ZERO, DVec3::ZERO, 0);
        let (mut sum, mut least, mut most) = (0.0, f64::MAX, f64::MIN);
        for j in 0..=2 * REACH {
            for i in 0..=2 * REACH {
                let within = |k: usize| k.checked_sub(REACH).filter(|&k| k < n);
                let (Some(column), Some(row)) = (within(node % n + i), within(node / n + j)) else {
                    continue;
                };
                let k = self.part.index_at(column, row);
                if !self.inside[k] {
                    continue;
                }
                let own = self.force[k] / self.area[k];
                let row = dvec3(1.0, i as f64 - REACH as f64, j as f64 - REACH as f64);
                matrix += DMat3::from_cols(row * row.x, row * row.y, row * row.z);
                right += row * own;
                sum += own;
                (least, most, count) = (least.min(own), most.max(own), count + 1);
            }
        }
        if count == 0 {
            return None;
        }
        let mean = sum / f64::from(count);
        // Nodes in one line determine no plane.
        if matrix.determinant() < 1.0 {
            return Some(mean);
        }
        let fitted = (matrix.inverse() * right).x;
        let spread = most - least;
        Some(fitted.clamp((least - spread).max(0.5 * least), most + spread))
    }

    /// Sets the pressure at the nodes, its mean and its greatest value.
    ///
    /// The mean is the force over the area in contact, which changes without jumps: [`Contacted`]. Under a sheet the pressure is smooth inside of the
    /// contact and jumps to zero at its edge; a contact without nodes inside, or smaller than the area around a node, has its mean pressure
    /// everywhere. The area of solid tissue in contact with few nodes is not known: the mean is at most the greatest pressure.
    fn find_pressure(&mut self, solution: &Solution) {
        let touching: Vec<(usize, usize)> = self.touching().collect();
        let (mut force, mut max) = (0.0, 0.0_f64);
        for &(k, node) in &touching {
            force += self.part.multiplicity(node) * self.force[k];
            let pressure = if self.is_solid {
                self.force[k] / self.area[k]
            } else if self.inside[k] {
                self.pressure_inside(node)
            } else {
                self.pressure_at_edge(node).unwrap_or(0.0)
            };
            self.at_nodes[k] = pressure;
            max = max.max(pressure);
        }
        if force <= 0.0 {
            return;
        }
        let Self { part, nodes_per_side, .. } = *self;
        let contacted = Contacted { part, nodes_per_side, force: &self.force, area: &self.area };
        let area = if self.is_solid {
            let (sheet, dome) = (solution.problem().sheet(), &solution.problem().obstacle.dome);
            contacted.of_solid(|node| {
                let (gauge, gradient) = dome.gauge_and_gradient(solution.inner()[node]);
                (sheet.kinds()[node] == NodeKind::Free).then(|| gauge / gradient.length())
            })
        } else {
            contacted.of_sheet()
        };
        let mean = force / area;
        let mean = if self.is_solid { mean.min(max) } else { mean };
        for &(k, _) in touching.iter().filter(|(k, _)| !(self.is_solid || self.inside[*k])) {
            if self.at_nodes[k] <= 0.0 || max <= mean {
                self.at_nodes[k] = mean;
            }
        }
        self.pressure = Some(Pressure { mean, max: max.max(mean) });
    }

    /// Sets the greatest pressure over the middle of the implant, to half of its base's radius, and around it.
    fn find_peaks(&mut self, solution: &Solution) {
        let problem = solution.problem();
        let (sheet, dome) = (problem.sheet(), &problem.obstacle.dome);
        let axes = dome.wall_axes();
        for (k, node) in self.part.nodes().enumerate().filter(|(k, _)| self.force[*k] > 0.0) {
            let from_centre = (sheet.rest()[node] - dome.center) / axes;
            let peak = &mut self.peaks[usize::from(from_centre.length() > MIDDLE)];
            *peak = peak.max(self.at_nodes[k]);
        }
    }

    /// The contact edge on a dome in the pocket's centre; `None` off centre or without contact.
    ///
    /// A membrane leaves the dome tangentially: the gap grows with the square of the distance from the edge. The fit
    /// position = edge + b·√gap + c·gap by least squares over the free nodes near the edge locates the edge between
    /// the nodes.
    pub(super) fn edge(&self, solution: &Solution) -> Option<Edge> {
        let problem = solution.problem();
        let (sheet, dome, x) = (problem.sheet(), &problem.obstacle.dome, solution.inner());
        let pocket_radius = problem.patch.pocket_radius_mm;
        // The gap opens with the square of the distance under a membrane only.
        let is_centred =
            dome.center.length() <= 1e-9 * dome.reference_length() && solution.outer().is_empty();
        let reach =
            self.touching().map(|(_, k)| sheet.rest()[k].length_squared()).reduce(f64::max)?.sqrt();
        if !(is_centred && dome.is_round()) {
            return None;
        }
        let h = sheet.spacing_mm();
        let wall = Edge { angle: dome.wall_angle(), material_radius: pocket_radius };
        if reach > pocket_radius - 1.5 * h {
            return Some(wall);
        }
        let (mut for_angle, mut for_radius) = (Fit::default(), Fit::default());
        // Nodes in contact lie inside of the edge, the others outside.
        let (mut inner, mut outer) = (PolarAngle::of(DVec3::Z), PolarAngle::at(wall.angle));
        let band = (reach + EDGE_BAND.0 * h, reach + EDGE_BAND.1 * h);
        for (index, k) in self.part.nodes().enumerate() {
            if sheet.kinds()[k] != NodeKind::Free {
                continue;
            }
            let from_origin = x[k] - dome.origin();
            if self.force[index] > 0.0 {
                inner = inner.greater(PolarAngle::of(from_origin));
                continue;
            }
            let s = sheet.rest()[k].length();
            if s > reach {
                outer = outer.less(PolarAngle::of(from_origin));
            }
            if !(band.0..=band.1).contains(&s) {
                continue;
            }
            let multiplicity = self.part.multiplicity(k);
            let gap = dome.closest_point(x[k]).0.max(0.0).sqrt();
            for_angle.add(multiplicity, gap, PolarAngle::of(from_origin).angle());
            for_radius.add(multiplicity, gap, s);
        }
        let (inner, outer) = (inner.angle(), outer.angle());
        match (for_angle.at_zero(), for_radius.at_zero()) {
            (Some(angle), Some(radius)) => {
                let cell = h / dome.reference_length();
                Some(Edge {
                    angle: angle
                        .clamp(inner.min(outer) - cell, inner.max(outer) + cell)
                        .clamp(0.0, wall.angle),
                    material_radius: radius.clamp(reach - h, reach + 2.0 * h),
                })
            }
            _ => Some(Edge { angle: inner.min(wall.angle), material_radius: reach }),
        }
    }
}

/// The angle of a direction from the vertical, compared without trigonometry.
#[derive(Clone, Copy)]
struct PolarAngle {
    /// Horizontal and vertical component.
    direction: [f64; 2],
    /// Increases with the angle, from 0 up to 2 straight down.
    order: f64,
}

impl PolarAngle {
    fn of(direction: DVec3) -> Self {
        Self::new([direction.truncate().length(), direction.z])
    }

    fn at(angle: f64) -> Self {
        Self::new([angle.sin(), angle.cos()])
    }

    fn new([across, up]: [f64; 2]) -> Self {
        let fraction = across / (across + up.abs()).max(f64::MIN_POSITIVE);
        let order = if up < 0.0 { 2.0 - fraction } else { fraction };
        Self { direction: [across, up], order }
    }

    fn greater(self, other: Self) -> Self {
        if other.order > self.order { other } else { self }
    }

    fn less(self, other: Self) -> Self {
        if other.order < self.order { other } else { self }
    }

    /// \[rad\]
    fn angle(self) -> f64 {
        let [across, up] = self.direction;
        across.atan2(up)
    }
}

/// An interior node of a grid and its eight neighbours.
fn around(node: usize, nodes_per_side: usize) -> [[usize; 3]; 3] {
    let n = nodes_per_side;
    [node - n, node, node + n].map(|row| [row - 1, row, row + 1])
}

/// Least-squares fit of y = a + b·u + c·u².
#[derive(Default)]
struct Fit {
    /// Σ uᵏ, k = 0 … 4.
    powers: [f64; 5],
    /// Σ y·uᵏ, k = 0 … 2.
    moments: [f64; 3],
}

impl Fit {
    /// Adds a point with a weight.
    fn add(&mut self, weight: f64, u: f64, y: f64) {
        let mut power = weight;
        for k in 0..5 {
            self.powers[k] += power;
            if k < 3 {
                self.moments[k] += y * power;
            }
            power *= u;
        }
    }

    /// a, by Cramer's rule; `None` with too few points.
    fn at_zero(&self) -> Option<f64> {
        let p = &self.powers;
        if p[0] < 6.0 {
            return None;
        }
        let matrix = DMat3::from_cols(
            dvec3(p[0], p[1], p[2]),
            dvec3(p[1], p[2], p[3]),
            dvec3(p[2], p[3], p[4]),
        );
        let a = (matrix.inverse() * DVec3::from(self.moments)).x;
        a.is_finite().then_some(a)
    }
}
