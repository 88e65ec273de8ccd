//! A surface with fewer vertices: those of a cell of a cubic grid become their mean.
//!
//! Errors, of a trunk of 104 000 triangles in 12 000 vertices: see the test there. The surface's border moves inwards by up to half of a cell.

use crate::surface::Surface;
use glam::DVec3;
use std::collections::HashMap;

/// Growth of the cells from one attempt to the next \[-\].
const GROWTH: f64 = 1.06;

/// The surface with no more vertices and triangles than given, without colours; one that has no more keeps its vertices.
#[must_use]
pub fn reduced(surface: &Surface, most_vertices: usize, most_triangles: usize) -> Surface {
    let Surface { positions, triangles, .. } = surface;
    if positions.len() <= most_vertices && triangles.len() <= most_triangles {
        return Surface {
            positions: positions.clone(),
            triangles: triangles.clone(),
            colors: None,
        };
    }
    let fewest = most_vertices.min(most_triangles / 2).max(1) as f64;
    // A vertex a cell of the area: fewer than any surface has.
    let mut cell_mm = (surface.area() / fewest).sqrt().max(f64::MIN_POSITIVE);
    loop {
        let found = clustered(surface, cell_mm);
        if found.positions.len() <= most_vertices && found.triangles.len() <= most_triangles {
            return found;
        }
        cell_mm *= GROWTH;
    }
}

/// The surface with one vertex a cell: the mean of the vertices in it; triangles of three cells remain, each once.
fn clustered(surface: &Surface, cell_mm: f64) -> Surface {
    let mut clusters: HashMap<[i64; 3], u32> = HashMap::new();
    let mut sums: Vec<(DVec3, f64)> = Vec::new();
    let mut cluster_of = vec![u32::MAX; surface.positions.len()];
    let mut triangles = Vec::new();
    for triangle in &surface.triangles {
        let corners = triangle.map(|k| {
            let cluster = &mut cluster_of[k as usize];
            if *cluster == u32::MAX {
                let position = surface.positions[k as usize];
                let cell = (position / cell_mm).floor().to_array().map(|x| x as i64);
                *cluster = *clusters.entry(cell).or_insert_with(|| {
                    sums.push((DVec3::ZERO, 0.0));
                    sums.len() as u32 - 1
                });
                let (sum, count) = &mut sums[*cluster as usize];
                *sum += position;
                *count += 1.0;
            }
            *cluster
        });
        let [a, b, c] = corners;
        if a != b && b != c && c != a {
            triangles.push(corners);
        }
    }
    // Equal triangles begin with their least corner.
    triangles.iter_mut().for_each(|triangle| {
        let least = (0..3).min_by_key(|k| triangle[*k]).unwrap_or(0);
        triangle.rotate_left(least);
    });
    triangles.sort_unstable();
    triangles.dedup();
    let positions = sums.into_iter().map(|(sum, count)| sum / count).collect();
    without_unused(Surface { positions, triangles, colors: None })
}

/// The surface without vertices that no triangle has, in the order of the triangles.
fn without_unused(surface: Surface) -> Surface {
    let mut place = vec![u32::MAX; surface.positions.len()];
    let mut positions = Vec::with_capacity(surface.positions.len());
    let mut triangles = surface.triangles;
    for corner in triangles.iter_mut().flatten() {
        let place = &mut place[*corner as usize];
        if *place == u32::MAX {
            *place = positions.len() as u32;
            positions.push(surface.positions[*corner as usize]);
        }
        *corner = *place;
    }
    Surface { positions, triangles, colors: None }
}
