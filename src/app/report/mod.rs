//! Picture and report: the window as PNG, or one HTML file with picture, plan, results and the plan's file. The report
//! loads nothing and runs no script.
//!
//! This file takes the picture of the window and saves the files; `page` writes the HTML.

mod page;

use super::answer::{self, PreviousResults};
use super::compare;
use super::messages::Notice;
use super::{App, files, plan, status};
use crate::measure::bands;
use crate::session::Session;
use eframe::egui::{self, ColorImage, Rect};
use page::Page;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};

/// What a picture of the window is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purpose {
    Picture,
    Report,
}

impl Purpose {
    fn file(self) -> &'static str {
        match self {
            Self::Picture => "plan.png",
            Self::Report => "report.html",
        }
    }
}

/// A picture of the window, with the place of the 3-D view in it \[pixels\].
type Shot = (Purpose, Rect, Arc<ColorImage>);

/// Greatest number of frames between the request of a picture and its pixels: a desktop has those of the next frame.
const FRAMES_ALONE: u8 = 3;

/// Pictures of the window on their way.
pub(super) struct Shots {
    wanted: Option<Purpose>,
    /// Place of the 3-D view or the chart in the latest frame \[points\].
    view: Rect,
    /// Number of frames that show the view alone, for a report.
    frames_alone: u8,
    sender: Sender<Shot>,
    receiver: Receiver<Shot>,
}

impl Default for Shots {
    fn default() -> Self {
        let (sender, receiver) = channel();
        Self { wanted: None, view: Rect::NOTHING, frames_alone: 0, sender, receiver }
    }
}

impl Shots {
    /// Requests a picture of the next frame: a menu of this frame is then closed.
    pub(super) fn want(&mut self, purpose: Purpose, ctx: &egui::Context) {
        self.wanted = Some(purpose);
        ctx.request_repaint();
    }

    /// Stores the place of the 3-D view or the chart \[points\].
    pub(super) fn set_view(&mut self, view: Rect) {
        self.view = view;
    }

    /// Is a picture for a report being taken? Controls and notices over the view are then left out.
    pub(super) fn is_for_report(&self) -> bool {
        self.frames_alone > 0
    }

    /// Takes the wanted picture of this frame.
    pub(super) fn take(&mut self, ctx: &egui::Context) {
        if self.frames_alone > 0 {
            self.frames_alone -= 1;
            ctx.request_repaint();
        }
        let Some(purpose) = self.wanted.take() else { return };
        let (sender, context) = (self.sender.clone(), ctx.clone());
        let view = self.view * ctx.pixels_per_point();
        if purpose == Purpose::Report {
            self.frames_alone = FRAMES_ALONE;
        }
        ctx.request_screenshot(move |image| {
            // Sending fails if the app was closed in the meantime.
            let _ = sender.send((purpose, view, image));
            context.request_repaint();
        });
    }
}

impl App {
    /// Saves the pictures and reports whose pixels have arrived.
    pub(super) fn save_shots(&mut self, ctx: &egui::Context) {
        while let Ok((purpose, view, image)) = self.shots.receiver.try_recv() {
            self.shots.frames_alone = 0;
            let content = match purpose {
                Purpose::Picture => png_of(&image),
                Purpose::Report => png_of(&cropped(&image, view))
                    .map(|picture| self.report(&picture).html().into_bytes()),
            };
            match content {
                Ok(content) => self.files.save(ctx, purpose.file(), content),
                Err(error) => {
                    let text = format!("{} was not saved: {error}", purpose.file());
                    self.notice = Some(Notice::error(text));
                }
            }
        }
    }

    /// The content of the report.
    fn report(&self, picture: &[u8]) -> Page<'_> {
        let session: &Session = &self.session;
        let findings = self.uncertainty.findings();
        let sampled = |scene: &_| self.uncertainty.values(scene);
        let outcome = answer::visible(session, PreviousResults::Shown);
        Page {
            picture: page::data_address(picture),
            date: date_in_words(&files::date()),
            headline: answer::headline(session, PreviousResults::Shown),
            plan: plan::rows(session.scene()),
            model: status::model(session.scene()),
            cards: answer::rows(session, findings),
            warnings: outcome.map_or(&[][..], |outcome| &outcome.warnings),
            table: compare::rows(session, &sampled),
            bands: self.uncertainty.about_bands(),
            limits: bands::LIMITS.map(answer::text_of).to_vec(),
            plan_json: session.document_json(),
        }
    }
}

/// A date (UTC, RFC 3339) in words, as "2026-01-31, 12:34 UTC".
fn date_in_words(date: &str) -> String {
    let minutes = date.get(..16).map(|minutes| minutes.replace('T', ", "));
    minutes.map_or_else(|| date.to_owned(), |minutes| format!("{minutes} UTC"))
}

/// The part of a picture within a rectangle \[pixels\].
fn cropped(image: &ColorImage, part: Rect) -> ColorImage {
    let [width, height] = image.size;
    let clamp = |value: f32, most: usize| (value.round().max(0.0) as usize).min(most);
    let (left, right) = (clamp(part.left(), width), clamp(part.right(), width));
    let (top, bottom) = (clamp(part.top(), height), clamp(part.bottom(), height));
    let rows = (top..bottom).map(|y| &image.pixels[y * width + left..y * width + right.max(left)]);
    let size = [right.saturating_sub(left), bottom.saturating_sub(top)];
    ColorImage::new(size, rows.flatten().copied().collect())
}

/// A picture as PNG, without transparency.
fn png_of(image: &ColorImage) -> Result<Vec<u8>, png::EncodingError> {
    let [width, height] = image.size;
    let mut content = Vec::new();
    let mut encoder = png::Encoder::new(&mut content, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|c| [c.r(), c.g(), c.b()]).collect();
    encoder.write_header()?.write_image_data(&pixels)?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Color32, pos2};

    #[test]
    fn a_date_has_no_seconds() {
        assert_eq!(date_in_words("2026-01-31T12:34:56.789Z"), "2026-01-31, 12:34 UTC");
        assert_eq!(date_in_words("now"), "now");
    }

    #[test]
    fn a_crop_has_the_pixels_of_its_part_and_stays_within_the_picture() {
        let pixels = (0..12).map(Color32::from_gray).collect();
        let image = ColorImage::new([4, 3], pixels);
        let part = cropped(&image, Rect::from_min_max(pos2(1.0, 1.0), pos2(3.0, 9.0)));
        assert_eq!(part.size, [2, 2]);
        let grays: Vec<u8> = part.pixels.iter().map(Color32::r).collect();
        assert_eq!(grays, [5, 6, 9, 10]);
    }

    #[test]
    fn a_png_has_the_pixels_of_its_picture() {
        let pixels = vec![Color32::RED, Color32::GREEN, Color32::BLUE, Color32::WHITE];
        let content = png_of(&ColorImage::new([2, 2], pixels)).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(content)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height), (2, 2));
        assert_eq!(bytes[..12], [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]);
    }
}
