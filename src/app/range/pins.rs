//! The pins on the chart of the range: places, letters, words.

use super::axes::Words;
use super::plane::Plane;
use crate::app::texts::tr;
use crate::app::widgets::set_accessible_name;
use crate::app::widgets::theme;
use crate::session::Session;
use crate::study::Map;
use eframe::egui::{self, Align2, Pos2, Rect, Sense, Stroke, TextStyle, Ui, Vec2};

/// Radius of a pin on the chart \[points\].
const RADIUS: f32 = 8.0;

/// The pins for the present map.
#[derive(Default)]
pub(super) struct Pins {
    /// The start of the map and the revision of the pins to which the list belongs.
    key: Option<(u64, u64)>,
    is_curve: bool,
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
        let is_curve = map.axes().len() == 1;
        *self = Self { key: Some(key), is_curve, ..Self::default() };
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

    /// Centres of the pins on the screen, on a curve at its lower end. A pin on an earlier one stands beside that.
    fn places(&self, plane: &Plane) -> Vec<Pos2> {
        let mut places: Vec<Pos2> = Vec::with_capacity(self.on_chart.len());
        for pin in &self.on_chart {
            let mut at = plane.at(pin.at);
            if self.is_curve {
                at.y = plane.rect.bottom() - RADIUS - 2.0;
            }
            while places.iter().any(|place| place.distance(at) < 2.0 * RADIUS) {
                at.x += 2.0 * RADIUS;
            }
            places.push(at);
        }
        places
    }

    /// The circles of the pins on the screen.
    pub(super) fn marks(&self, plane: &Plane) -> Vec<Rect> {
        let size = Vec2::splat(2.0 * RADIUS);
        self.places(plane).into_iter().map(|at| Rect::from_center_size(at, size)).collect()
    }

    /// Draws the pins, each a letter in a circle, with a line to the place of one that stands beside another.
    pub(super) fn show(&self, ui: &Ui, plane: &Plane) {
        let palette = theme::palette(ui.visuals());
        let font = TextStyle::Small.resolve(ui.style());
        let places = self.places(plane);
        let painter = ui.painter().with_clip_rect(plane.rect.expand(RADIUS));
        for (pin, at) in self.on_chart.iter().zip(&places).filter(|_| !self.is_curve) {
            painter.line_segment([*at, plane.at(pin.at)], Stroke::new(1.5, palette.text));
        }
        for (k, (pin, rect)) in self.on_chart.iter().zip(self.marks(plane)).enumerate() {
            let at = rect.center();
            let (fill, text) = match pin.is_of_map {
                true => (palette.text, ui.visuals().panel_fill),
                false => (ui.visuals().panel_fill, palette.text),
            };
            painter.circle(at, RADIUS, fill, Stroke::new(1.5, ui.visuals().panel_fill));
            if !pin.is_of_map {
                painter.circle_stroke(at, RADIUS - 1.5, Stroke::new(1.0, text));
            }
            painter.text(at, Align2::CENTER_CENTER, &pin.letter, font.clone(), text);
            let response = ui.interact(rect, ui.scope_id().with(("pin", k)), Sense::hover());
            set_accessible_name(&response, egui::Role::Image, &pin.words);
        }
    }

    /// The words of the pin at a point of the screen.
    pub(super) fn at(&self, plane: &Plane, point: Pos2) -> Option<&str> {
        let places = self.places(plane);
        let mut pins = self.on_chart.iter().zip(places);
        pins.find(|(_, at)| at.distance(point) <= RADIUS).map(|(pin, _)| &*pin.words)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::pos2;

    #[test]
    fn no_pin_covers_another() {
        let pin = |letter: &str, x| Pin {
            letter: letter.to_owned(),
            at: (x, 1.0),
            is_of_map: true,
            words: letter.to_owned(),
        };
        let on_chart = vec![pin("A", 1.0), pin("B", 1.0), pin("C", 1.01), pin("D", 9.0)];
        let pins = Pins { on_chart, ..Pins::default() };
        let rect = Rect::from_min_max(pos2(0.0, 0.0), pos2(400.0, 300.0));
        let plane = Plane { rect, x: (0.0, 10.0), y: (0.0, 2.0) };
        let places = pins.places(&plane);
        for (k, place) in places.iter().enumerate() {
            assert!(places[..k].iter().all(|other| other.distance(*place) >= 2.0 * RADIUS));
            let words = pins.at(&plane, *place);
            assert_eq!(words, Some(&*pins.on_chart[k].words));
        }
        // A pin apart from the others stands at its own place.
        assert_eq!(places[3], plane.at((9.0, 1.0)));
    }
}
