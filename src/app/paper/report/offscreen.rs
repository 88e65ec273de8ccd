//! Pictures of contents that are not on the screen: drawn by the window's graphics context into memory.

use crate::app::plan::device::Device;
use crate::app::widgets::theme;
use eframe::egui::{self, Color32, ColorImage, Pos2, Rect, Theme, Ui, Vec2, vec2};
use eframe::egui_glow::Painter;
use eframe::glow::{self, HasContext as _};
use std::sync::Arc;

/// Samples of a pixel: WebGL 2 has at least four.
const SAMPLES: i32 = 4;

/// A picture of contents about a device on a light ground of a size \[points\], with `scale` pixels per point.
///
/// # Errors
/// Returns the message of the graphics driver in one line.
pub(super) fn picture(
    gl: &Arc<glow::Context>,
    device: Device,
    (size, scale): (Vec2, f32),
    mut add_contents: impl FnMut(&mut Ui),
) -> Result<ColorImage, String> {
    let (ctx, input) = (context(device), input(size, scale));
    let mut run = || {
        ctx.run_ui(input.clone(), |ui| {
            let ground = ui.visuals().panel_fill;
            ui.painter().rect_filled(ui.max_rect(), 0.0, ground);
            add_contents(ui);
        })
    };
    // The axes of a plot have their place from the second frame on.
    let mut textures = run().textures_delta;
    let output = run();
    textures.append(output.textures_delta);
    let primitives = ctx.tessellate(output.shapes, scale);
    let pixels = (scale * size).ceil();
    let size = [pixels.x as u32, pixels.y as u32];
    let mut painter = Painter::new(Arc::clone(gl), "", None, false).map_err(|e| e.to_string())?;
    let image = target(gl, size, || {
        painter.paint_and_update_textures(size, scale, &primitives, &mut textures);
    });
    painter.destroy();
    image
}

/// Height that contents about a device take in a width \[points\].
pub(super) fn height(
    device: Device,
    (width, scale): (f32, f32),
    mut add_contents: impl FnMut(&mut Ui),
) -> f32 {
    /// More than any contents take \[points\].
    const ROOM: f32 = 10_000.0;
    let mut height = 0.0;
    let mut output = context(device).run_ui(input(vec2(width, ROOM), scale), |ui| {
        add_contents(ui);
        height = ui.min_rect().height();
    });
    // Nothing is drawn.
    output.textures_delta.clear();
    height
}

/// A context of its own for contents about a device: neither focus nor pointer of the window reach them.
pub(super) fn context(device: Device) -> egui::Context {
    let ctx = egui::Context::default();
    theme::install(&ctx);
    ctx.set_theme(Theme::Light);
    device.note(&ctx);
    ctx
}

/// The input of a frame of a size \[points\] with `scale` pixels per point.
pub(super) fn input(size: Vec2, scale: f32) -> egui::RawInput {
    let screen_rect = Some(Rect::from_min_size(Pos2::ZERO, size));
    let mut input = egui::RawInput { screen_rect, ..egui::RawInput::default() };
    for viewport in input.viewports.values_mut() {
        viewport.native_pixels_per_point = Some(scale);
    }
    input
}

/// Objects of the graphics driver, deleted at the end, also where a later one is not created.
struct Objects<'a> {
    gl: &'a glow::Context,
    framebuffers: Vec<glow::Framebuffer>,
    buffers: Vec<glow::Renderbuffer>,
}

impl Objects<'_> {
    fn framebuffer(&mut self) -> Result<glow::Framebuffer, String> {
        // SAFETY: runs on the context's thread, as all of this file.
        let created = unsafe { self.gl.create_framebuffer()? };
        self.framebuffers.push(created);
        Ok(created)
    }

    fn buffer(&mut self) -> Result<glow::Renderbuffer, String> {
        // SAFETY: as above.
        let created = unsafe { self.gl.create_renderbuffer()? };
        self.buffers.push(created);
        Ok(created)
    }
}

impl Drop for Objects<'_> {
    fn drop(&mut self) {
        // SAFETY: as above; the objects were created by this context.
        unsafe {
            self.buffers.drain(..).for_each(|buffer| self.gl.delete_renderbuffer(buffer));
            self.framebuffers.drain(..).for_each(|target| self.gl.delete_framebuffer(target));
        }
    }
}

/// The pixels of what `paint` draws into a target in memory.
fn target(
    gl: &glow::Context,
    [width, height]: [u32; 2],
    paint: impl FnOnce(),
) -> Result<ColorImage, String> {
    let (columns, rows) = (width as i32, height as i32);
    let mut bytes = vec![0; 4 * (width * height) as usize];
    let mut objects = Objects { gl, framebuffers: Vec::new(), buffers: Vec::new() };
    let [drawn, resolved] = [objects.framebuffer()?, objects.framebuffer()?];
    let buffers = [objects.buffer()?, objects.buffer()?, objects.buffer()?];
    // SAFETY: all calls run on the context's thread, with objects that live until the end; the bytes have the size of the
    // pixels read. The framebuffer of the window is bound again.
    unsafe {
        let storage = [
            (drawn, glow::RGBA8, SAMPLES, glow::COLOR_ATTACHMENT0),
            (drawn, glow::DEPTH_COMPONENT24, SAMPLES, glow::DEPTH_ATTACHMENT),
            (resolved, glow::RGBA8, 0, glow::COLOR_ATTACHMENT0),
        ];
        for (buffer, (framebuffer, format, samples, attachment)) in buffers.iter().zip(storage) {
            gl.bind_renderbuffer(glow::RENDERBUFFER, Some(*buffer));
            gl.renderbuffer_storage_multisample(glow::RENDERBUFFER, samples, format, columns, rows);
            gl.bind_framebuffer(glow::FRAMEBUFFER, Some(framebuffer));
            gl.framebuffer_renderbuffer(
                glow::FRAMEBUFFER,
                attachment,
                glow::RENDERBUFFER,
                Some(*buffer),
            );
        }
        gl.bind_framebuffer(glow::FRAMEBUFFER, Some(drawn));
        let is_complete =
            gl.check_framebuffer_status(glow::FRAMEBUFFER) == glow::FRAMEBUFFER_COMPLETE;
        if is_complete {
            paint();
            gl.disable(glow::SCISSOR_TEST);
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(drawn));
            gl.bind_framebuffer(glow::DRAW_FRAMEBUFFER, Some(resolved));
            let (mask, filter) = (glow::COLOR_BUFFER_BIT, glow::NEAREST);
            gl.blit_framebuffer(0, 0, columns, rows, 0, 0, columns, rows, mask, filter);
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(resolved));
            gl.pixel_store_i32(glow::PACK_ALIGNMENT, 1);
            let pixels = glow::PixelPackData::Slice(Some(&mut bytes));
            gl.read_pixels(0, 0, columns, rows, glow::RGBA, glow::UNSIGNED_BYTE, pixels);
        }
        gl.bind_renderbuffer(glow::RENDERBUFFER, None);
        gl.bind_framebuffer(glow::FRAMEBUFFER, None);
        if !is_complete {
            return Err("the graphics have no memory for a picture".to_owned());
        }
    }
    // The first row of the graphics is the lowest one.
    let row = 4 * width as usize;
    let pixels = bytes.chunks_exact(row).rev().flat_map(|row| row.chunks_exact(4));
    let pixels = pixels.map(|p| Color32::from_rgb(p[0], p[1], p[2])).collect();
    Ok(ColorImage::new([width as usize, height as usize], pixels))
}
