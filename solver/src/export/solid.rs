//! Triangle meshes: deformed tissue and skin with an inner face, an outer face and the lateral face along the border; the
//! implant, each closed; the surface of a body.

use super::glb::Material;
use crate::contact::Dome;
use crate::measure::Surfaces;
use crate::mesh::Chest;
use glam::{DVec2, DVec3, Vec3};
use std::collections::BTreeMap;

/// A part of a mesh; its triangles refer to [`Solid::vertices`].
#[derive(Clone, Debug, PartialEq)]
pub struct Part {
    /// `sheet`, `skin` or `border`; of an implant `dome` or `base`; of a torso `surface`.
    pub name: &'static str,
    /// Vertex indices, counter-clockwise seen from outside the tissue.
    pub triangles: Vec<[u32; 3]>,
}

/// What a mesh is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Body {
    /// Layers under the skin, or all layers.
    Tissue,
    /// The outermost layer.
    Skin,
    /// The implant.
    Implant,
    /// The whole skin of a body, as scanned; open or closed.
    Torso,
}

impl Body {
    /// The name in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Tissue => "tissue",
            Self::Skin => "skin",
            Self::Implant => "implant",
            Self::Torso => "body",
        }
    }

    pub(super) fn material(self) -> Material {
        match self {
            Self::Tissue => Material { colour: [0.84, 0.61, 0.25], roughness: 0.7 },
            Self::Skin | Self::Torso => Material { colour: [0.78, 0.46, 0.33], roughness: 0.6 },
            Self::Implant => Material { colour: [0.77, 0.82, 0.85], roughness: 0.25 },
        }
    }
}

/// A triangle mesh \[mm\], closed but for a torso.
#[derive(Clone, Debug, PartialEq)]
pub struct Solid {
    /// What the mesh is.
    pub body: Body,
    /// Positions \[mm\].
    pub vertices: Vec<Vec3>,
    /// The parts, which together are closed but for a torso.
    pub parts: Vec<Part>,
    /// Linear red, green and blue of each vertex \[-\]; empty for a body in the colour of its material.
    pub colours: Vec<[f32; 3]>,
}

impl Solid {
    /// All layers of the deformed tissue. Vertices: those of the sheet, then those of the skin in the same order.
    #[must_use]
    pub fn tissue(surfaces: &Surfaces) -> Self {
        Self::between(Body::Tissue, surfaces, 0, surfaces.positions.len() - 1)
    }

    /// The layers of the deformed tissue under its skin; without vertices where the skin is the only layer.
    #[must_use]
    pub fn under_skin(surfaces: &Surfaces) -> Self {
        let outer = surfaces.positions.len() - 2;
        if outer == 0 {
            return Self::empty(Body::Tissue);
        }
        Self::between(Body::Tissue, surfaces, 0, outer)
    }

    /// The outermost layer of the deformed tissue.
    #[must_use]
    pub fn skin(surfaces: &Surfaces) -> Self {
        let outer = surfaces.positions.len() - 1;
        Self::between(Body::Skin, surfaces, outer - 1, outer)
    }

    /// The implant, the skin and the tissue under it, each a closed body of its own; bodies without a shape are left out.
    #[must_use]
    pub fn bodies(surfaces: &Surfaces, dome: &Dome) -> Vec<Self> {
        let all = [Self::implant(dome), Self::skin(surfaces), Self::under_skin(surfaces)];
        all.into_iter().filter(|solid| !solid.vertices.is_empty()).collect()
    }

    /// The implant above the chest wall, a dome on a base on the wall; without vertices where it is not inserted.
    ///
    /// Over a curved wall the base has a vertex below every vertex of the dome, so that the draped implant keeps its volume.
    #[must_use]
    pub fn implant(dome: &Dome) -> Self {
        const RINGS: usize = 48;
        const AROUND: usize = 128;
        /// Radius of the base's inner ring, relative to the rim: shading ends there where a viewer shades over the rim.
        const INNER: f64 = 0.97;
        let body = Body::Implant;
        if dome.top() <= 1e-9 {
            return Self::empty(body);
        }
        let mut vertices = vec![dome.apex().as_vec3()];
        vertices.extend(dome.circles(RINGS, AROUND).skip(AROUND).map(DVec3::as_vec3));
        let centre = vertices.len() as u32;
        let on_wall = |at: DVec2| at.extend(dome.chest.height(at)).as_vec3();
        vertices.push(on_wall(dome.center));
        let at = |ring: usize, step: usize| (1 + (ring - 1) * AROUND + step % AROUND) as u32;
        let top = (0..AROUND).map(|k| [0, at(1, k), at(1, k + 1)]);
        let rings = (1..RINGS).flat_map(|ring| {
            (0..AROUND).flat_map(move |k| {
                let (a, b) =
                    ([at(ring, k), at(ring, k + 1)], [at(ring + 1, k), at(ring + 1, k + 1)]);
                [[a[0], b[0], b[1]], [a[0], b[1], a[1]]]
            })
        });
        let dome_triangles: Vec<[u32; 3]> = top.chain(rings).collect();
        let base = if dome.chest == Chest::Flat {
            let rim = dome.circles(RINGS, AROUND).skip(RINGS * AROUND);
            vertices.extend(
                rim.map(|point| on_wall(dome.center + INNER * (point.truncate() - dome.center))),
            );
            let inner = |step: usize| centre + 1 + (step % AROUND) as u32;
            (0..AROUND)
                .flat_map(|k| {
                    let (outer, next) = (at(RINGS, k), at(RINGS, k + 1));
                    [
                        [centre, inner(k + 1), inner(k)],
                        [inner(k), inner(k + 1), next],
                        [inner(k), next, outer],
                    ]
                })
                .collect()
        } else {
            let inner = dome.circles(RINGS, AROUND).skip(AROUND).take((RINGS - 1) * AROUND);
            vertices.extend(inner.map(|point| on_wall(point.truncate())));
            let below = |k: u32| match k {
                0 => centre,
                k if k < at(RINGS, 0) => centre + k,
                edge => edge,
            };
            dome_triangles.iter().map(|[a, b, c]| [below(*a), below(*c), below(*b)]).collect()
        };
        let parts = vec![
            Part { name: "dome", triangles: dome_triangles },
            Part { name: "base", triangles: base },
        ];
        Self { body, vertices, parts, colours: Vec::new() }
    }

    fn empty(body: Body) -> Self {
        Self { body, vertices: Vec::new(), parts: Vec::new(), colours: Vec::new() }
    }

    /// A body of the tissue of `surfaces` with a colour at each node of the sheet, the same on both faces.
    #[must_use]
    pub fn coloured(self, surfaces: &Surfaces, colour: impl Fn(usize) -> [f32; 3]) -> Self {
        let mut colours = vec![[0.0; 3]; self.vertices.len()];
        let number = numbers(surfaces);
        for (vertex, k) in &number {
            let colour = colour(surfaces.nodes[*vertex as usize] as usize);
            let k = *k as usize;
            (colours[k], colours[k + number.len()]) = (colour, colour);
        }
        Self { colours, ..self }
    }

    /// The layers from a face to a face further out.
    fn between(body: Body, surfaces: &Surfaces, inner: usize, outer: usize) -> Self {
        let (inner, outer) = (&surfaces.positions[inner], &surfaces.positions[outer]);
        let number = numbers(surfaces);
        let count = number.len() as u32;
        let mut vertices = vec![Vec3::ZERO; 2 * number.len()];
        for (&vertex, &k) in &number {
            vertices[k as usize] = inner[vertex as usize].into();
            vertices[(k + count) as usize] = outer[vertex as usize].into();
        }
        let skin: Vec<[u32; 3]> =
            surfaces.triangles.iter().map(|t| t.map(|vertex| number[&vertex] + count)).collect();
        let sheet = skin.iter().map(|[a, b, c]| [a - count, c - count, b - count]).collect();
        let border = border_edges(&skin)
            .into_iter()
            .flat_map(|[a, b]| {
                let (low_a, low_b) = (a - count, b - count);
                [[low_a, low_b, b], [low_a, b, a]]
            })
            .collect();
        Self {
            body,
            vertices,
            parts: vec![
                Part { name: "sheet", triangles: sheet },
                Part { name: "skin", triangles: skin },
                Part { name: "border", triangles: border },
            ],
            colours: Vec::new(),
        }
    }

    /// The mirror image in x, of a left breast the right one: the triangles still face outwards.
    #[must_use]
    pub fn mirrored(mut self) -> Self {
        self.vertices.iter_mut().for_each(|vertex| vertex.x = -vertex.x);
        let triangles = self.parts.iter_mut().flat_map(|part| &mut part.triangles);
        triangles.for_each(|triangle| triangle.swap(1, 2));
        self
    }

    /// All triangles of all parts.
    pub fn triangles(&self) -> impl Iterator<Item = [u32; 3]> + '_ {
        self.parts.iter().flat_map(|part| part.triangles.iter().copied())
    }
}

/// The number of each vertex of the surfaces on a face of a body. Border nodes without a triangle are omitted.
fn numbers(surfaces: &Surfaces) -> BTreeMap<u32, u32> {
    let mut number = BTreeMap::new();
    for vertex in surfaces.triangles.iter().flatten() {
        let next = number.len() as u32;
        number.entry(*vertex).or_insert(next);
    }
    number
}

/// Directed edges of exactly one triangle.
fn border_edges(triangles: &[[u32; 3]]) -> Vec<[u32; 2]> {
    let mut edges = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            if edges.remove(&[to, from]).is_none() {
                edges.insert([from, to], ());
            }
        }
    }
    edges.into_keys().collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{HalfBall, Shape, Superellipse};
    use crate::measure::{Stack, of_faces};
    use crate::mesh::Sheet;

    const CURVED: Chest = Chest::Curved { across_mm: 110.0, along_mm: -300.0 };

    fn flat_surfaces(thickness: f32) -> Surfaces {
        let sheet = Sheet::new(33, 50.0);
        let inner = sheet.rest().iter().map(|p| p.extend(0.0).as_vec3()).collect();
        let stack = Stack {
            between: Vec::new(),
            thickness_mm: vec![vec![thickness; sheet.len()]],
            normal: vec![Vec3::Z; sheet.len()],
        };
        let faces = stack.faces(inner);
        of_faces(&sheet, &stack, &faces)
    }

    fn flat(thickness: f32) -> Solid {
        Solid::tissue(&flat_surfaces(thickness))
    }

    fn volume(solid: &Solid) -> f64 {
        let of = |t: [u32; 3]| {
            let [a, b, c] = t.map(|k| solid.vertices[k as usize].as_dvec3());
            a.dot(b.cross(c)) / 6.0
        };
        solid.triangles().map(of).sum()
    }

    #[test]
    fn every_edge_belongs_to_two_triangles_that_run_it_in_opposite_directions() {
        let dome = Dome::new(DVec2::new(5.0, -3.0), HalfBall::round(60.0, 40.0), 0.7);
        let draped = dome.clone().over(CURVED);
        for solid in [flat(3.0), Solid::implant(&dome), Solid::implant(&draped)] {
            assert!(border_edges(&solid.triangles().collect::<Vec<_>>()).is_empty());
        }
    }

    #[test]
    fn a_coloured_skin_is_read_back_with_the_colours_of_its_nodes() {
        let surfaces = flat_surfaces(3.0);
        // The place of a node as its colour.
        let place = |node: usize| {
            let vertex = surfaces.nodes.iter().position(|k| *k as usize == node).unwrap();
            let [x, y, _] = surfaces.positions[0][vertex];
            [0.5 + 0.01 * x, 0.5 + 0.01 * y, 0.25]
        };
        let skin = Solid::skin(&surfaces).coloured(&surfaces, place);
        let bytes = crate::export::Format::Glb.encode(std::slice::from_ref(&skin));
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = file.blob.as_deref().unwrap();
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        let reader = primitive.reader(|_| Some(blob));
        let colours: Vec<[f32; 3]> = reader.read_colors(0).unwrap().into_rgb_f32().collect();
        assert_eq!(colours.len(), skin.vertices.len());
        for ([r, g, b], at) in colours.into_iter().zip(&skin.vertices) {
            assert!((r - 0.5 - 0.01 * at.x).abs() < 1e-6 && (g - 0.5 - 0.01 * at.y).abs() < 1e-6);
            assert!((b - 0.25).abs() < 1e-6);
        }
        // A viewer multiplies the colours with that of the material.
        let factor = primitive.material().pbr_metallic_roughness().base_color_factor();
        assert!(factor.iter().all(|part| (part - 1.0).abs() < 1e-6));
        // A body without colours has those of its material alone.
        let bytes = crate::export::Format::Glb.encode(&[Solid::skin(&surfaces)]);
        let file = gltf::Gltf::from_slice(&bytes).unwrap();
        let primitive = file.meshes().next().unwrap().primitives().next().unwrap();
        assert!(primitive.get(&gltf::Semantic::Colors(0)).is_none());
    }

    #[test]
    fn a_mirror_image_is_closed_and_has_the_volume_to_the_last_bit() {
        let dome = Dome::new(DVec2::new(5.0, -3.0), HalfBall::round(60.0, 40.0), 1.0);
        for solid in [flat(3.0), Solid::implant(&dome)] {
            let mirrored = solid.clone().mirrored();
            assert!(border_edges(&mirrored.triangles().collect::<Vec<_>>()).is_empty());
            assert_eq!(volume(&mirrored).to_bits(), volume(&solid).to_bits());
            assert!(
                mirrored
                    .vertices
                    .iter()
                    .zip(&solid.vertices)
                    .all(|(a, b)| *a == *b * Vec3::new(-1.0, 1.0, 1.0))
            );
        }
    }

    #[test]
    fn the_enclosed_volume_is_positive_area_times_thickness() {
        let disc = std::f64::consts::PI * 50.0 * 50.0 * 3.0;
        let volume = volume(&flat(3.0));
        assert!((volume / disc - 1.0).abs() < 0.01, "{volume} instead of nearly {disc}");
    }

    #[test]
    fn an_implant_in_place_has_its_volume() {
        let of = |shape: Shape| Dome::new(DVec2::new(5.0, -3.0), shape, 1.0);
        let round = HalfBall::round(60.0, 40.0);
        let dome = of(round.into());
        let filled = [0.55, 0.72, 0.8].map(|fullness| of(round.filled(fullness).into()));
        let another = of(Superellipse { radius: 60.0, projection: 40.0 }.into());
        for dome in [dome.clone(), dome.over(CURVED)].into_iter().chain(filled).chain([another]) {
            let ratio = volume(&Solid::implant(&dome)) / dome.volume();
            assert!(ratio < 1.0 && ratio > 0.998, "{ratio}");
        }
        let outside = Dome::new(DVec2::ZERO, HalfBall::round(60.0, 40.0), 0.0);
        assert!(Solid::implant(&outside).vertices.is_empty());
    }
}
