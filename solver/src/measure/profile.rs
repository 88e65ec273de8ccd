//! The profiles: the tissue along the axes of the grid from the pocket's centre.

use super::{PROFILE_POINTS, ProfilePoint};
use crate::contact::TOUCH_F64;
use crate::mesh::{NaturalStretch, NodeKind, Rest};
use crate::solve::{Solution, Tissue};
use glam::{DVec2, DVec3};

/// A direction from the pocket's centre along an axis of the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// +x.
    Side,
    /// −x.
    Midline,
    /// +y.
    Head,
    /// −y.
    Feet,
}

impl Direction {
    /// The direction in a word.
    #[must_use]
    pub fn word(self) -> &'static str {
        match self {
            Self::Side => "side",
            Self::Midline => "midline",
            Self::Head => "head",
            Self::Feet => "feet",
        }
    }
}

/// A profile with its surface and its direction.
#[derive(Clone, Debug)]
pub struct Meridian {
    /// `inner_face` (to the pocket's edge) or `skin_membrane` (to the patch's radius).
    pub surface: &'static str,
    /// Direction from the pocket's centre.
    pub direction: Direction,
    /// 41 points in equal steps of the material radius.
    pub points: Vec<ProfilePoint>,
}

/// Both meridians of a solution, of layered tissue those of the inner face and of the skin's membrane; of a round shape half of one.
#[must_use]
pub fn meridians(solution: &Solution) -> Vec<Meridian> {
    let problem = solution.problem();
    let dome = &problem.obstacle.dome;
    let is_turned =
        problem.rest.is_even() && problem.rest.natural().is_none_or(NaturalStretch::is_even);
    let pocket = problem.patch.pocket();
    let is_centred = dome.center == DVec2::ZERO && !pocket.is_lowered();
    let is_round = is_turned && dome.is_round() && is_centred;
    let all = [Direction::Side, Direction::Midline, Direction::Head, Direction::Feet];
    let directions = if is_round { &all[..1] } else { &all };
    let inner = directions.iter().map(|&direction| Meridian {
        surface: "inner_face",
        direction,
        points: match direction {
            Direction::Side => along_x(solution),
            Direction::Feet => along(Layer::inner(solution), direction, pocket.reach_mm()),
            _ => along(Layer::inner(solution), direction, pocket.radius_mm),
        },
    });
    let is_layered = problem.tissue == Tissue::Layered;
    let skin = directions.iter().filter(|_| is_layered).map(|&direction| Meridian {
        surface: "skin_membrane",
        direction,
        points: along(Layer::membrane(solution), direction, problem.patch.radius_mm),
    });
    inner.chain(skin).collect()
}

/// A layer of nodes at rest and deformed.
#[derive(Clone, Copy)]
pub(super) struct Layer<'a> {
    pub(super) rest: &'a Rest,
    /// From the inner face outwards.
    pub(super) layer: usize,
    /// Deformed positions \[mm\].
    pub(super) x: &'a [DVec3],
}

impl<'a> Layer<'a> {
    fn inner(solution: &'a Solution) -> Self {
        Self { rest: &solution.problem().rest, layer: 0, x: solution.inner() }
    }

    /// The skin's membrane.
    pub(super) fn membrane(solution: &'a Solution) -> Self {
        let rest = &solution.problem().rest;
        Self { rest, layer: rest.layers() - 1, x: solution.membrane() }
    }
}

/// 41 points, material radius 0 … pocket radius in equal steps. Positions by cubic interpolation
/// between the nodes, stretches from central differences (second order).
///
/// The curvature of the sheet jumps at the contact edge: a point is interpolated from the nodes on its own side of
/// the edge. On the outer side the last node in contact has its position with contact offset, on the extension of the
/// free sheet.
pub(super) fn along_x(solution: &Solution) -> Vec<ProfilePoint> {
    let sheet = solution.problem().sheet();
    let row = sheet.nodes_per_side() / 2 * sheet.nodes_per_side();
    let pocket_radius = solution.problem().patch.pocket_radius_mm;
    beside_edges(Layer::inner(solution), Direction::Side, pocket_radius, &edges(solution, row))
}

/// 41 points of the inner face of layered tissue along +y, material radius 0 … pocket radius in equal steps.
pub(super) fn along_y(solution: &Solution) -> Vec<ProfilePoint> {
    along(Layer::inner(solution), Direction::Head, solution.problem().patch.pocket_radius_mm)
}

/// 41 points of the skin's outer surface along +x, material radius 0 … patch radius in equal steps.
#[must_use]
pub fn skin_surface(solution: &Solution) -> Vec<ProfilePoint> {
    let faces = solution.faces();
    let outer: Vec<DVec3> = faces[faces.len() - 1].iter().map(|p| p.as_dvec3()).collect();
    let layer = Layer { x: &outer, ..Layer::membrane(solution) };
    along(layer, Direction::Side, solution.problem().patch.radius_mm)
}

/// 41 points of a face, material radius 0 … `radius` in equal steps.
pub(super) fn along(layer: Layer, direction: Direction, radius: f64) -> Vec<ProfilePoint> {
    beside_edges(layer, direction, radius, &[])
}

/// The profile beside edges of the contact, in one loop over its points: an edge moves the nodes that a point is interpolated from.
fn beside_edges(
    layer: Layer,
    direction: Direction,
    radius: f64,
    edges: &[Edge],
) -> Vec<ProfilePoint> {
    let Layer { rest, layer, x } = layer;
    let sheet = rest.sheet();
    let n = sheet.nodes_per_side();
    let half = n / 2;
    // Steps along the line, and beside it.
    let (step, side) = match direction {
        Direction::Side => (1, n),
        Direction::Midline => (-1, n),
        Direction::Head => (n as isize, 1),
        Direction::Feet => (-(n as isize), 1),
    };
    let node =
        |i: usize| ((half * n + half) as isize + (i as isize - half as isize) * step) as usize;
    let h = sheet.spacing_mm();
    // Stretch along and across the line at its i-th node.
    let stretches = |i: usize| {
        let k = node(i);
        let difference = |at: &dyn Fn(usize) -> DVec3| {
            let along = if i + 1 < n {
                (at(node(i + 1)) - at(node(i - 1))) / (2.0 * h)
            } else {
                (at(k) * 3.0 - at(node(i - 1)) * 4.0 + at(node(i - 2))) / (2.0 * h)
            };
            along.length()
        };
        let (up, down) = (k + side, k - side);
        let across = x[up].distance(x[down]);
        if rest.is_even() {
            let flat = sheet.rest();
            return (difference(&|k| x[k]), across / flat[up].distance(flat[down]));
        }
        let at_rest = |k: usize| rest.node(layer, k);
        let along = difference(&|k| x[k]) / difference(&at_rest);
        (along, across / at_rest(up).distance(at_rest(down)))
    };
    (0..PROFILE_POINTS)
        .map(|point| {
            let s = radius * point as f64 / (PROFILE_POINTS - 1) as f64;
            let column = s / h + half as f64;
            let middle = (column.floor() as usize).clamp(1, n - 3);
            let mut stretch = DVec2::ZERO;
            for (k, weight) in (middle - 1..=middle + 2).zip(cubic(column - middle as f64)) {
                let (along, across) = stretches(k);
                stretch += DVec2::new(along, across) * weight;
            }
            let (mut low, mut passed) = (middle, None);
            for edge in edges {
                let is_inside = (edge.position - column) * edge.outwards > 0.0;
                // Nodes low − 1 … low + 2 lie on the point's side of the edge's node, this node included.
                let is_right = is_inside != (edge.outwards > 0.0);
                if is_right && low < edge.node + 1 && low + 2 >= edge.node {
                    low = edge.node + 1;
                } else if !is_right && low + 2 > edge.node && low <= edge.node + 1 {
                    low = edge.node - 2;
                }
                if !is_inside {
                    passed = passed.or(Some(edge));
                }
            }
            let low = low.clamp(1, n - 3);
            let mut position = DVec3::ZERO;
            for (k, weight) in (low - 1..=low + 2).zip(cubic(column - low as f64)) {
                let own = edges.iter().find(|e| e.node == k && passed.is_some());
                position += own.map_or(x[node(k)], |e| e.balanced) * weight;
            }
            ProfilePoint {
                s_mm: s,
                r_mm: position.truncate().length(),
                z_mm: position.z,
                stretch_meridional: stretch.x,
                stretch_hoop: stretch.y,
            }
        })
        .collect()
}

/// The contact edge on a row of nodes.
struct Edge {
    /// The last node in contact.
    node: usize,
    /// Position of this node with its contact offset \[mm\].
    balanced: DVec3,
    /// 1 if the free sheet lies to the right of the node, else −1.
    outwards: f64,
    /// Position of the edge \[columns\].
    position: f64,
}

fn edges(solution: &Solution, row: usize) -> Vec<Edge> {
    let problem = solution.problem();
    let (sheet, dome, x) = (problem.sheet(), &problem.obstacle.dome, solution.inner());
    let n = sheet.nodes_per_side();
    let is_offset = |k: usize| solution.offset_nodes().iter().any(|(node, _)| *node == k);
    // Free nodes without contact.
    let is_off = |k: usize| {
        sheet.kinds()[k] == NodeKind::Free && dome.gauge(x[k]) > TOUCH_F64 && !is_offset(k)
    };
    let mut edges = Vec::new();
    for &(k, balanced) in solution.offset_nodes() {
        if k / n != row / n {
            continue;
        }
        for (outwards, next, second) in [(1.0, k + 1, k + 2), (-1.0, k - 1, k - 2)] {
            if !(is_off(next) && is_off(second)) {
                continue;
            }
            // The gap in front of the node is own + slope·s + bend·s²/2; the edge is at the minimum of the gap.
            let [own, near, far] = [balanced, x[next], x[second]].map(|p| dome.gauge(p));
            let bend = far - 2.0 * near + own;
            let slope = near - own - 0.5 * bend;
            let node = k - row;
            if bend > 0.0 && !edges.iter().any(|e: &Edge| e.node == node) {
                let position = node as f64 - outwards * slope / bend;
                edges.push(Edge { node, balanced, outwards, position });
            }
        }
    }
    edges
}

/// Lagrange weights of the nodes −1, 0, 1, 2 at t.
fn cubic(t: f64) -> [f64; 4] {
    [
        -t * (t - 1.0) * (t - 2.0) / 6.0,
        (t + 1.0) * (t - 1.0) * (t - 2.0) / 2.0,
        -(t + 1.0) * t * (t - 2.0) / 2.0,
        (t + 1.0) * t * (t - 1.0) / 6.0,
    ]
}
