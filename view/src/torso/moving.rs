//! The vertices of a body that move with the columns of a tissue: places, colours of a quantity, normals.

use super::normals::{soften, turn};
use super::{NO_NET, Point, Torso, position};
use crate::mesh::{Mesh, Vertex};
use implant_preview_core::body::deform::{Columns, Moves, Weights};
use implant_preview_core::measure::{Field, Fields};
use implant_preview_core::mesh::Rest;
use implant_preview_core::solve::Problem;
use std::sync::Arc;

/// Width at the patch's border over which the colour of a quantity becomes that of the skin \[mm\].
pub(super) const FADE_MM: f64 = 25.0;
/// Share of a column's height between which the colour of the skin comes to show \[-\]: where the body leaves the fitted skin, at the flank, a narrower range
/// would be ragged from vertex to vertex.
const SKIN_SHARE: [f32; 2] = [0.2, 0.8];
/// The share of a vertex beyond the patch; means over neighbours that even the shares, of which fewer leave teeth at the flank.
const UNKNOWN: f32 = -1.0;
const EVENINGS: usize = 25;

/// How the vertices of a body move with the columns of a tissue at rest.
#[derive(Debug)]
pub struct Attached {
    rest: Rest,
    /// The side whose vertices these are; `None`: one tissue for all sides.
    of_side: Option<usize>,
    /// Vertices that move or have a colour.
    pub(super) moved: Vec<Moved>,
    turned: Around,
    softened: Around,
}

/// Vertices whose normals, or softened normals, change, and the triangles around them.
#[derive(Debug)]
struct Around {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// A vertex that moves, or that the colour of a quantity fades to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Moved {
    pub(super) vertex: u32,
    /// Its side in `turns`.
    side: usize,
    /// `None`: it stays.
    pub(super) weights: Option<Weights>,
    /// The part of the displacement that it takes \[-\].
    share: f64,
    /// How far it is within the colour of a quantity: 0.5 at its end, 1 where it is full. The renderer makes a smooth step of it, so that the end
    /// of the colour is even within large triangles.
    part: f32,
}

impl Torso {
    /// How the body moves with the tissue of a problem: that of a side (0: the plan's, 1: the other one), or of the plan alone, whose mirror image moves the
    /// other side of a built-in torso.
    #[must_use]
    pub fn attached(&self, problem: &Problem, of_side: Option<usize>) -> Attached {
        let only = if self.is_alike { of_side } else { of_side.or(Some(0)) };
        let columns = Columns::new(problem);
        let border = problem.sheet().radius_mm();
        let own = self.points.iter().filter(|point| only.is_none_or(|side| point.side == side));
        let weights = |point: &Point| match self.is_skin {
            true => columns.over(point.place.truncate()),
            false => columns.weights(point.place),
        };
        let found: Vec<(&Point, Option<Weights>)> =
            own.map(|point| (point, weights(point))).collect();
        let mut heights = vec![UNKNOWN; self.before.vertices.len()];
        for (point, weights) in &found {
            if point.place.truncate().length() < border {
                let share = weights.as_ref().map_or(0.0, Weights::share).clamp(0.0, 1.0);
                let of = &mut heights[point.vertex as usize];
                *of = of.max(share as f32);
            }
        }
        self.even(&mut heights);
        let [low, high] = SKIN_SHARE;
        let of = |(point, weights): (&Point, Option<Weights>)| {
            let Point { vertex, side, place, share, is_nearest } = *point;
            // Along a curved wall the patch ends before its radius over the plane.
            let over = border - place.truncate().length();
            let from_border = weights.as_ref().map_or(over, |at| over.min(at.from_edge_mm()));
            let on_skin = (heights[vertex as usize] - low) / (high - low);
            // A vertex that stays is at most at the end of the colour.
            let most = if weights.is_some() { 1.0 } else { 0.0 };
            let within = on_skin.min((from_border / FADE_MM) as f32).clamp(-1.0, most);
            let is_coloured = is_nearest || only == Some(0) && of_side.is_none();
            let part = if is_coloured { 0.5 * share as f32 * (1.0 + within) } else { 0.0 };
            let is_any = weights.is_some() || part > 0.0;
            is_any.then_some(Moved { vertex, side, weights, share, part })
        };
        let moved: Vec<Moved> = found.into_iter().filter_map(of).collect();
        let mut is_reached = vec![false; self.before.vertices.len()];
        let reached = moved.iter().filter(|moved| moved.weights.is_some());
        reached.for_each(|moved| is_reached[moved.vertex as usize] = true);
        let [turned, softened] = [(); 2].map(|()| self.around(&mut is_reached));
        Attached { rest: problem.rest.clone(), of_side, moved, turned, softened }
    }

    /// Gives each known value the mean of those around it, some times: the colour ends at no edge of triangles.
    fn even(&self, values: &mut Vec<f32>) {
        let is_known =
            |triangle: &&[u32; 3]| triangle.iter().any(|k| values[*k as usize] > UNKNOWN);
        let triangles = self.before.indices.as_chunks::<3>().0.iter();
        let triangles: Vec<[u32; 3]> = triangles.filter(is_known).copied().collect();
        for _ in 0..EVENINGS {
            let mut sums = vec![(0.0, 0.0); values.len()];
            for triangle in &triangles {
                let known = || triangle.iter().filter(|k| values[**k as usize] > UNKNOWN);
                let sum: f32 = known().map(|k| values[*k as usize]).sum();
                for k in known() {
                    let (of, count) = &mut sums[*k as usize];
                    (*of, *count) = (*of + sum, *count + known().count() as f32);
                }
            }
            let mean = |(sum, count): (f32, f32)| if count > 0.0 { sum / count } else { UNKNOWN };
            *values = sums.into_iter().map(mean).collect();
        }
    }

    /// The vertices of all triangles with a reached vertex, which are reached from now on.
    fn around(&self, is_reached: &mut [bool]) -> Around {
        let triangles = self.before.indices.as_chunks::<3>().0;
        let touches = |triangle: &&[u32; 3], is: &[bool]| triangle.iter().any(|k| is[*k as usize]);
        let beside: Vec<u32> =
            triangles.iter().filter(|t| touches(t, is_reached)).flatten().copied().collect();
        beside.iter().for_each(|k| is_reached[*k as usize] = true);
        let triangles = triangles.iter().filter(|t| touches(t, is_reached)).copied().collect();
        let all = 0..self.before.vertices.len() as u32;
        Around { vertices: all.filter(|k| is_reached[*k as usize]).collect(), triangles }
    }

    /// The body with the skin of the shapes of one or both sides, in the colours of a field, in the place of other vertices.
    #[must_use]
    pub fn mesh(&self, shapes: &[Shape<'_>], field: Option<Field>, mut room: Vec<Vertex>) -> Mesh {
        room.clone_from(&self.before.vertices);
        let vertices = &mut room;
        if field.is_some() {
            vertices.iter_mut().for_each(|vertex| vertex[8] = 0.0);
        }
        for shape in shapes {
            self.move_with(shape, field, vertices);
        }
        let mut normals = self.normals.clone();
        for Shape { attached: Attached { turned, .. }, .. } in shapes {
            let of = turned.vertices.iter().map(|k| *k as usize);
            turn(&mut normals, vertices, &turned.triangles, of);
        }
        for Shape { attached: Attached { softened, .. }, .. } in shapes {
            let of = softened.vertices.iter().map(|k| *k as usize);
            soften(vertices, &normals, &softened.triangles, of);
        }
        Mesh { vertices: room, indices: Arc::clone(&self.before.indices) }
    }

    /// Moves and colours the vertices of a side.
    fn move_with(&self, shape: &Shape<'_>, field: Option<Field>, vertices: &mut [Vertex]) {
        let Shape { attached, fields, toward } = *shape;
        let moves = Moves::new(fields.solution());
        let moves = match toward {
            Some((to, part)) => moves.toward(&Moves::new(to.solution()), part.into()),
            None => moves,
        };
        for moved in &attached.moved {
            let own = &mut vertices[moved.vertex as usize];
            if let Some(weights) = &moved.weights {
                let by = moved.share * (self.turns[moved.side] * moves.of(weights));
                // A vertex of both sides moves with both.
                let at = position(own) + by.as_vec3();
                own[..3].copy_from_slice(&at.to_array());
            }
            let Some(field) = field else { continue };
            let value = |fields: &Fields| match &moved.weights {
                Some(weights) => weights.value(fields.values(field)),
                None => Some(0.0),
            };
            let value = match toward {
                Some((to, part)) => {
                    value(fields).zip(value(to)).map(|(from, to)| from + part * (to - from))
                }
                None => value(fields),
            };
            if let Some(value) = value.filter(|_| moved.part > NO_NET - own[7]) {
                (own[7], own[8]) = (NO_NET - moved.part, value);
            }
        }
    }
}

/// The shape of a side, or a part of the way to another shape \[-\].
#[derive(Clone, Copy, Debug)]
pub struct Shape<'a> {
    /// How the body moves with the side's tissue.
    pub attached: &'a Attached,
    /// The shape.
    pub fields: &'a Fields,
    /// The other shape, and the part.
    pub toward: Option<(&'a Fields, f32)>,
}

impl Attached {
    /// Is this how a body moves with the tissue of a problem on a side, too?
    #[must_use]
    pub fn is_of(&self, problem: &Problem, of_side: Option<usize>) -> bool {
        self.of_side == of_side && self.rest == problem.rest
    }
}
