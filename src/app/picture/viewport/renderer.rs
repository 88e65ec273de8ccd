//! Renderer of the pictures: one shader program, five meshes for each picture, a colour table.
//!
//! Uploads changes only: a mesh, its indices or a table with the same `Arc` as before is not uploaded
//! again.

use crate::view::color::{Rgb, bytes};
use crate::view::mesh::{Mesh, Vertex};
use eframe::glow::{self, HasContext as _};
use glam::{Mat4, Vec2, Vec3, Vec4};
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::sync::Arc;

/// Materials in drawing order; the number is the shader's `u_material`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Material {
    /// Outer skin, inner face and lateral face of the tissue; removed in front of the cut.
    Tissue = 0,
    /// Cut faces.
    Cap = 1,
    /// The implant.
    Implant = 2,
    /// The chest wall.
    Wall = 3,
    /// The torso with its skin, in place of all others.
    Torso = 4,
}

const MATERIALS: [Material; 5] =
    [Material::Tissue, Material::Cap, Material::Implant, Material::Wall, Material::Torso];

/// How the areola is drawn; the number is the shader's `u_areola`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Areola {
    /// Not drawn.
    Hidden = 0,
    /// A disc in its own colour.
    Disc = 1,
    /// Its edge, on the colours of a quantity.
    Edge = 2,
}

/// Content of a frame.
#[derive(Clone)]
pub(crate) struct Frame {
    /// Number of the picture.
    pub(crate) picture: u64,
    /// The pictures in use; the buffers of others are freed.
    pub(crate) pictures: Arc<[u64]>,
    /// A mesh for each material.
    pub(crate) meshes: [Arc<Mesh>; 5],
    /// Colour table of the displayed quantity.
    pub(crate) table: Arc<Vec<Rgb>>,
    /// Field values at the ends of the table.
    pub(crate) range: [f32; 2],
    /// The camera.
    pub(crate) clip_from_world: Mat4,
    pub(crate) eye: Vec3,
    pub(crate) right: Vec3,
    pub(crate) up: Vec3,
    /// Planes of the cut, and its axis on the chest wall.
    pub(crate) planes: Option<[Vec3; 2]>,
    pub(crate) axis: Vec2,
    /// Draw the springs?
    pub(crate) net: bool,
    /// How the areola is drawn.
    pub(crate) areola: Areola,
    /// Width of a cell of the grid at rest \[mm\].
    pub(crate) cell_mm: f32,
    /// Middle of the grid \[cells\].
    pub(crate) grid_centre: f32,
    /// Radius of the pocket's edge, drawn as a line \[cells\], 0: no line; and that radius by the edge's distance downwards.
    pub(crate) pocket: [f32; 2],
    /// Radius of the circle where the implant meets the chest wall \[mm\].
    pub(crate) foot: [f32; 2],
    /// The plane at which the torso ends behind: normal and height of the origin over it \[mm\].
    pub(crate) end: Vec4,
    /// Colour of the background at the lower and at the upper edge.
    pub(crate) behind: [Vec3; 2],
}

/// Buffers of a mesh on the graphics card.
struct Buffers {
    vertex_array: glow::VertexArray,
    vertices: glow::Buffer,
    indices: glow::Buffer,
    uploaded: Option<Arc<Mesh>>,
}

impl Buffers {
    /// Are the indices of this mesh on the graphics card? Deformation changes vertices only.
    fn has_indices_of(&self, mesh: &Mesh) -> bool {
        self.uploaded.as_ref().is_some_and(|uploaded| Arc::ptr_eq(&uploaded.indices, &mesh.indices))
    }
}

/// Draws [`Frame`]s.
pub(crate) struct Renderer {
    program: glow::Program,
    /// Buffers of each picture, by its number.
    buffers: BTreeMap<u64, Vec<Buffers>>,
    table: glow::Texture,
    uploaded_table: Option<Arc<Vec<Rgb>>>,
}

const ATTRIBUTES: [(&str, i32); 5] =
    [("a_position", 3), ("a_normal", 3), ("a_grid", 2), ("a_value", 1), ("a_color", 3)];

impl Renderer {
    /// Compiles the shaders and creates the buffers.
    ///
    /// # Errors
    /// Returns the message of the driver in one line.
    pub(crate) fn new(gl: &glow::Context) -> Result<Self, String> {
        let version = if cfg!(target_arch = "wasm32") { "#version 300 es" } else { "#version 330" };
        let prefix = format!("{version}\nprecision highp float;\nprecision highp int;\n");
        // SAFETY: all calls run on the context's thread, with objects created here by that context.
        unsafe {
            let program = link(gl, &prefix)?;
            let table = gl.create_texture()?;
            let mut renderer =
                Self { program, buffers: BTreeMap::new(), table, uploaded_table: None };
            renderer.add_buffers(gl, 0)?;
            Ok(renderer)
        }
    }

    /// Draws a frame into the present viewport, over its content.
    /// `window`: its lower edge and height \[pixels\].
    pub(crate) fn paint(&mut self, gl: &glow::Context, frame: &Frame, window: [f32; 2]) {
        // SAFETY: as in `new`; egui restores its own state after a paint callback.
        unsafe {
            self.free_others(gl, &frame.pictures);
            // Without memory for its buffers a picture stays empty.
            if self.add_buffers(gl, frame.picture).is_err() {
                return;
            }
            let Some(set) = self.buffers.get_mut(&frame.picture) else { return };
            for (buffers, mesh) in set.iter_mut().zip(&frame.meshes) {
                buffers.upload(gl, mesh);
            }
            self.upload_table(gl, &frame.table);

            gl.enable(glow::DEPTH_TEST);
            gl.depth_func(glow::LESS);
            gl.depth_mask(true);
            gl.disable(glow::BLEND);
            gl.disable(glow::CULL_FACE);
            // The edges of the cut are smooth; the window stays opaque.
            gl.enable(glow::SAMPLE_ALPHA_TO_COVERAGE);
            gl.color_mask(true, true, true, false);
            gl.clear_depth_f32(1.0);
            gl.clear(glow::DEPTH_BUFFER_BIT);
            gl.use_program(Some(self.program));
            self.set_frame_uniforms(gl, frame);
            gl.uniform_2_f32(self.uniform(gl, "u_window").as_ref(), window[0], window[1]);
            for (material, buffers) in MATERIALS.into_iter().zip(&self.buffers[&frame.picture]) {
                let Some(mesh) = &buffers.uploaded else { continue };
                let cut = material == Material::Tissue && frame.planes.is_some();
                gl.uniform_1_i32(self.uniform(gl, "u_material").as_ref(), material as i32);
                gl.uniform_1_i32(self.uniform(gl, "u_cut").as_ref(), i32::from(cut));
                gl.bind_vertex_array(Some(buffers.vertex_array));
                gl.draw_elements(glow::TRIANGLES, mesh.indices.len() as i32, glow::UNSIGNED_INT, 0);
            }
            gl.bind_vertex_array(None);
            gl.use_program(None);
            gl.disable(glow::DEPTH_TEST);
            gl.disable(glow::SAMPLE_ALPHA_TO_COVERAGE);
            gl.color_mask(true, true, true, true);
        }
    }

    /// Frees the resources on the graphics card.
    pub(crate) fn destroy(&self, gl: &glow::Context) {
        // SAFETY: this context created the objects; they are not used again.
        unsafe {
            gl.delete_program(self.program);
            gl.delete_texture(self.table);
            self.buffers.values().flatten().for_each(|buffers| buffers.delete(gl));
        }
    }

    /// Creates the buffers of a picture, if they are missing.
    unsafe fn add_buffers(&mut self, gl: &glow::Context, picture: u64) -> Result<(), String> {
        if let Entry::Vacant(place) = self.buffers.entry(picture) {
            // SAFETY: as in `new`.
            let set = MATERIALS.iter().map(|_| unsafe { Buffers::new(gl, self.program) });
            place.insert(set.collect::<Result<_, _>>()?);
        }
        Ok(())
    }

    /// Frees the buffers of pictures that are not in use.
    unsafe fn free_others(&mut self, gl: &glow::Context, pictures: &[u64]) {
        self.buffers.retain(|picture, set| {
            let is_used = pictures.contains(picture);
            if !is_used {
                // SAFETY: this context created the objects; they are not used again.
                set.iter().for_each(|buffers| unsafe { buffers.delete(gl) });
            }
            is_used
        });
    }

    unsafe fn uniform(&self, gl: &glow::Context, name: &str) -> Option<glow::UniformLocation> {
        // SAFETY: the program lives as long as the renderer.
        unsafe { gl.get_uniform_location(self.program, name) }
    }

    unsafe fn set_frame_uniforms(&self, gl: &glow::Context, frame: &Frame) {
        let planes = frame.planes.unwrap_or_default();
        // SAFETY: the program is active.
        unsafe {
            gl.uniform_matrix_4_f32_slice(
                self.uniform(gl, "u_clip_from_world").as_ref(),
                false,
                &frame.clip_from_world.to_cols_array(),
            );
            for (name, v) in [
                ("u_eye", frame.eye),
                ("u_right", frame.right),
                ("u_up", frame.up),
                ("u_planes[0]", planes[0]),
                ("u_planes[1]", planes[1]),
                ("u_axis", frame.axis.extend(0.0)),
                ("u_behind[0]", frame.behind[0]),
                ("u_behind[1]", frame.behind[1]),
            ] {
                gl.uniform_3_f32(self.uniform(gl, name).as_ref(), v.x, v.y, v.z);
            }
            gl.uniform_2_f32(self.uniform(gl, "u_range").as_ref(), frame.range[0], frame.range[1]);
            let [x, y, z, w] = frame.end.to_array();
            gl.uniform_4_f32(self.uniform(gl, "u_end").as_ref(), x, y, z, w);
            let [across, along] = frame.foot;
            gl.uniform_2_f32(self.uniform(gl, "u_foot").as_ref(), across, along);
            let centre = frame.grid_centre;
            gl.uniform_2_f32(self.uniform(gl, "u_grid_centre").as_ref(), centre, centre);
            let [radius, lower] = frame.pocket;
            gl.uniform_1_f32(self.uniform(gl, "u_pocket").as_ref(), radius);
            gl.uniform_1_f32(self.uniform(gl, "u_lower").as_ref(), lower);
            gl.uniform_1_i32(self.uniform(gl, "u_net").as_ref(), i32::from(frame.net));
            gl.uniform_1_i32(self.uniform(gl, "u_areola").as_ref(), frame.areola as i32);
            gl.uniform_1_f32(self.uniform(gl, "u_cell").as_ref(), frame.cell_mm);
            gl.uniform_1_i32(self.uniform(gl, "u_table").as_ref(), 0);
            gl.active_texture(glow::TEXTURE0);
            gl.bind_texture(glow::TEXTURE_2D, Some(self.table));
        }
    }

    unsafe fn upload_table(&mut self, gl: &glow::Context, table: &Arc<Vec<Rgb>>) {
        if self.uploaded_table.as_ref().is_some_and(|uploaded| Arc::ptr_eq(uploaded, table)) {
            return;
        }
        let texel = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let texels: Vec<u8> = table.iter().flat_map(|color| texel(bytes(*color))).collect();
        // SAFETY: the texture belongs to this context; the slice contains width × 4 bytes.
        unsafe {
            gl.active_texture(glow::TEXTURE0);
            gl.bind_texture(glow::TEXTURE_2D, Some(self.table));
            for (parameter, value) in [
                (glow::TEXTURE_MIN_FILTER, glow::NEAREST),
                (glow::TEXTURE_MAG_FILTER, glow::NEAREST),
                (glow::TEXTURE_WRAP_S, glow::CLAMP_TO_EDGE),
                (glow::TEXTURE_WRAP_T, glow::CLAMP_TO_EDGE),
            ] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, parameter, value as i32);
            }
            gl.pixel_store_i32(glow::UNPACK_ALIGNMENT, 1);
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                glow::RGBA8 as i32,
                table.len() as i32,
                1,
                0,
                glow::RGBA,
                glow::UNSIGNED_BYTE,
                glow::PixelUnpackData::Slice(Some(&texels)),
            );
        }
        self.uploaded_table = Some(Arc::clone(table));
    }
}

impl Buffers {
    unsafe fn new(gl: &glow::Context, program: glow::Program) -> Result<Self, String> {
        // SAFETY: the attribute layout is that of `Vertex`.
        unsafe {
            let vertex_array = gl.create_vertex_array()?;
            let (vertices, indices) = (gl.create_buffer()?, gl.create_buffer()?);
            gl.bind_vertex_array(Some(vertex_array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(vertices));
            gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(indices));
            let mut offset = 0;
            for (name, size) in ATTRIBUTES {
                if let Some(location) = gl.get_attrib_location(program, name) {
                    let stride = size_of::<Vertex>() as i32;
                    gl.enable_vertex_attrib_array(location);
                    gl.vertex_attrib_pointer_f32(
                        location,
                        size,
                        glow::FLOAT,
                        false,
                        stride,
                        offset,
                    );
                }
                offset += 4 * size;
            }
            gl.bind_vertex_array(None);
            Ok(Self { vertex_array, vertices, indices, uploaded: None })
        }
    }

    unsafe fn delete(&self, gl: &glow::Context) {
        // SAFETY: this context created the objects; they are not used again.
        unsafe {
            gl.delete_vertex_array(self.vertex_array);
            gl.delete_buffer(self.vertices);
            gl.delete_buffer(self.indices);
        }
    }

    unsafe fn upload(&mut self, gl: &glow::Context, mesh: &Arc<Mesh>) {
        if self.uploaded.as_ref().is_some_and(|uploaded| Arc::ptr_eq(uploaded, mesh)) {
            return;
        }
        // SAFETY: the buffers belong to this context; the bytes are whole slices.
        unsafe {
            gl.bind_vertex_array(Some(self.vertex_array));
            gl.bind_buffer(glow::ARRAY_BUFFER, Some(self.vertices));
            let vertices = bytemuck::cast_slice(&mesh.vertices);
            gl.buffer_data_u8_slice(glow::ARRAY_BUFFER, vertices, glow::DYNAMIC_DRAW);
            if !self.has_indices_of(mesh) {
                gl.bind_buffer(glow::ELEMENT_ARRAY_BUFFER, Some(self.indices));
                let indices = bytemuck::cast_slice(&mesh.indices);
                gl.buffer_data_u8_slice(glow::ELEMENT_ARRAY_BUFFER, indices, glow::DYNAMIC_DRAW);
            }
            gl.bind_vertex_array(None);
        }
        self.uploaded = Some(Arc::clone(mesh));
    }
}

unsafe fn link(gl: &glow::Context, prefix: &str) -> Result<glow::Program, String> {
    let stages = [
        (glow::VERTEX_SHADER, include_str!("surface.vert")),
        (glow::FRAGMENT_SHADER, include_str!("surface.frag")),
    ];
    // SAFETY: this context creates every object here.
    unsafe {
        let program = gl.create_program()?;
        let mut shaders = Vec::new();
        for (kind, source) in stages {
            let shader = gl.create_shader(kind)?;
            gl.shader_source(shader, &format!("{prefix}{source}"));
            gl.compile_shader(shader);
            if !gl.get_shader_compile_status(shader) {
                return Err(format!("shader: {}", gl.get_shader_info_log(shader)));
            }
            gl.attach_shader(program, shader);
            shaders.push(shader);
        }
        gl.link_program(program);
        if !gl.get_program_link_status(program) {
            return Err(format!("program: {}", gl.get_program_info_log(program)));
        }
        for shader in shaders {
            gl.detach_shader(program, shader);
            gl.delete_shader(shader);
        }
        Ok(program)
    }
}
