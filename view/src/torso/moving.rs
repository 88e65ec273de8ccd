//! The vertices of a body that move with the columns of a tissue: places, colours of a quantity, normals.

use super::normals::{soften, turn};
use super::{NO_NET, Point, Torso, position};
use crate::mesh::{Mesh, Vertex};
use implant_preview_core::body::deform::{Columns, Moves, Weights};
use implant_preview_core::body::grid::smooth_step;
use implant_preview_core::measure::{Field, Fields};
use implant_preview_core::mesh::Rest;
use implant_preview_core::solve::Problem;
use std::sync::Arc;

/// Width at the patch's border over which the colour of a quantity becomes that of the skin \[mm\].
const FADE_MM: f64 = 25.0;
/// Share of a column's height between which the colour of the skin comes to show \[-\]: where the body leaves the fitted skin, at the flank, a narrower range
/// would be ragged from vertex to vertex.
const SKIN_SHARE: [f64; 2] = [0.6, 0.9];
/// The share of a vertex beyond the patch; means over neighbours that even the shares.
const UNKNOWN: f32 = -1.0;
const EVENINGS: usize = 4;

/// How the vertices of a body move with the columns of a tissue at rest.
#[derive(Debug)]
pub struct Attached {
    rest: Rest,
    /// The side whose vertices these are; `None`: one tissue for all sides.
    of_side: Option<usize>,
    /// Vertices that move.
    moved: Vec<Moved>,
    turned: Around,
    softened: Around,
}

/// Vertices whose normals, or softened normals, change, and the triangles around them.
#[derive(Debug)]
struct Around {
    vertices: Vec<u32>,
    triangles: Vec<[u32; 3]>,
}

/// A vertex that moves.
#[derive(Clone, Copy, Debug)]
struct Moved {
    vertex: u32,
    /// Its side in `turns`.
    side: usize,
    weights: Weights,
    /// The part of the displacement, and of the colour of a quantity, that it takes \[-\].
    share: f64,
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
        let [low, high] = SKIN_SHARE;
        let mut on_skin = vec![UNKNOWN; self.before.vertices.len()];
        for (point, weights) in &found {
            if point.place.truncate().length() < border {
                let share = weights.as_ref().map_or(0.0, Weights::share);
                let of = &mut on_skin[point.vertex as usize];
                *of = of.max(smooth_step((share - low) / (high - low)) as f32);
            }
        }
        self.even(&mut on_skin);
        let of = |(point, weights): (&Point, Option<Weights>)| {
            let Point { vertex, side, place, share, is_nearest } = *point;
            let weights = weights?;
            // Along a curved wall the patch ends before its radius over the plane.
            let from_border = border - place.truncate().length();
            let near_border = weights.fade() * smooth_step(from_border / FADE_MM);
            let is_coloured = is_nearest || only == Some(0) && of_side.is_none();
            let part = if is_coloured { (share * near_border) as f32 } else { 0.0 };
            let part = part * on_skin[vertex as usize].max(0.0);
            Some(Moved { vertex, side, weights, share, part })
        };
        let moved: Vec<Moved> = found.into_iter().filter_map(of).collect();
        let mut is_reached = vec![false; self.before.vertices.len()];
        moved.iter().for_each(|moved| is_reached[moved.vertex as usize] = true);
        let [turned, softened] = [(); 2].map(|()| self.around(&mut is_reached));
        Attached { rest: problem.rest.clone(), of_side, moved, turned, softened }
    }

    /// Gives each known value the mean of those around it, some times: the colour ends at no edge of triangles.
    fn even(&self, values: &mut Vec<f32>) {
        for _ in 0..EVENINGS {
            let mut sums = vec![(0.0, 0.0); values.len()];
            for triangle in self.before.indices.as_chunks::<3>().0 {
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
            let by = moved.share * (self.turns[moved.side] * moves.of(&moved.weights));
            // A vertex of both sides moves with both.
            let own = &mut vertices[moved.vertex as usize];
            let at = position(own) + by.as_vec3();
            own[..3].copy_from_slice(&at.to_array());
            let Some(field) = field else { continue };
            let value = |fields: &Fields| moved.weights.value(fields.values(field));
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
