//! The pins on the chart of the range: places, letters, words.

use super::axes::Words;
use super::plane::Plane;
use crate::app::texts::tr;
use crate::app::theme;
use crate::app::widgets::set_accessible_name;
use crate::session::Session;
use crate::study::Map;
use eframe::egui::{self, Align2, Sense, Stroke, TextStyle, Ui, vec2};

/// Radius of a pin on the chart \[points\].
const RADIUS: f32 = 8.0;

/// The pins for the present map.
#[derive(Default)]
pub(super) struct Pins {
    /// The start of the map and the revision of the pins to which the list belongs.
    key: Option<(u64, u64)>,
    on_chart: Vec<Pin>,
    /// Letters of the pins beyond the axes.
    beyond: Vec<String>,
}

/// A pin within the axes.
struct Pin {
    letter: String,
    at: (f64, f64),
    /// Does the map have the other numbers of the pin, as those of the patient?
    is_of_map: bool,
    words: String,
}

impl Pins {
    /// Follows map and pins. `start` counts the starts of maps.
    pub(super) fn update(&mut self, map: &Map, start: u64, session: &Session) {
        let key = (start, session.pins_revision());
        if self.key == Some(key) {
            return;
        }
        *self = Self { key: Some(key), ..Self::default() };
        for pin in session.pins() {
            let letter = pin.letter().to_string();
            let Some([x, y]) = map.place(pin.scene()) else {
                self.beyond.push(letter);
                continue;
            };
            let is_of_map = map.has_points_of(pin.scene());
            let mut words = tr!("Pin {letter}", letter);
            if !pin.name().is_empty() {
                words += &format!(", {}", pin.name());
            }
            words += ": ";
            let place = map.axes().iter().zip([x, y]).map(|(axis, value)| {
                let words = Words::of(axis.field);
                format!("{} {}", words.name.to_lowercase(), words.text(value))
            });
            words += &place.collect::<Vec<_>>().join(", ");
            if !is_of_map {
                words += tr("; other numbers of this pin are not those of the chart");
            }
            self.on_chart.push(Pin { letter, at: (x, y), is_of_map, words });
        }
    }

    /// The pins that are not on the chart, in words; empty without any.
    pub(super) fn beyond(&self) -> String {
        match &self.beyond[..] {
            [] => String::new(),
            [one] => tr!("Pin {one} is not on this chart.", one),
            more => tr!("Pins {pins} are not on this chart.", pins = more.join(", ")),
        }
    }

    /// Draws the pins, each a letter in a circle; on a curve at its lower end.
    pub(super) fn show(&self, ui: &Ui, plane: &Plane, is_curve: bool) {
        let palette = theme::palette(ui.visuals());
        let font = TextStyle::Small.resolve(ui.style());
        for (k, pin) in self.on_chart.iter().enumerate() {
            let mut at = plane.at(pin.at);
            if is_curve {
                at.y = plane.rect.bottom() - RADIUS - 2.0;
            }
            let (fill, text) = match pin.is_of_map {
                true => (palette.text, ui.visuals().panel_fill),
                false => (ui.visuals().panel_fill, palette.text),
            };
            let painter = ui.painter().with_clip_rect(plane.rect.expand(RADIUS));
            painter.circle(at, RADIUS, fill, Stroke::new(1.5, ui.visuals().panel_fill));
            if !pin.is_of_map {
                painter.circle_stroke(at, RADIUS - 1.5, Stroke::new(1.0, text));
            }
            painter.text(at, Align2::CENTER_CENTER, &pin.letter, font.clone(), text);
            let rect = egui::Rect::from_center_size(at, vec2(2.0 * RADIUS, 2.0 * RADIUS));
            let response = ui.interact(rect, ui.scope_id().with(("pin", k)), Sense::hover());
            set_accessible_name(&response, egui::Role::Image, &pin.words);
        }
    }

    /// The words of the pin at a point of the screen.
    pub(super) fn at(&self, plane: &Plane, point: egui::Pos2) -> Option<&str> {
        let near = |pin: &&Pin| plane.at(pin.at).distance(point) <= RADIUS;
        self.on_chart.iter().find(near).map(|pin| &*pin.words)
    }
}
