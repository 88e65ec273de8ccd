//! The clinic's shelf on the page of the range: the table of its sizes, and their dots on the chart.

use super::axes::Words;
use super::plane::Plane;
use super::shelf_preview::{AS_EXPANDERS, Decision, Preview};
use super::{Range, readout};
use crate::app::frame::action::{Action, Task};
use crate::app::frame::commands::entry_of;
use crate::app::frame::messages::Notice;
use crate::app::frame::toolbar::Layout;
use crate::app::plan::device::Device;
use crate::app::plan::{new_base, usual_apex};
use crate::app::texts::{shown, tr};
use crate::app::widgets::{remark, set_accessible_name};
use crate::clinical::{Draft, Shelf, ShelfSize};
use crate::contact::HALF_ELLIPSOID;
use crate::scene::{Field, Scene};
use crate::study::{JudgedMap, Map, Parameter, with_values};
use eframe::egui::{self, Color32, Painter, Pos2, Rect, RichText, Stroke, Ui, Vec2};

/// Radius of a dot, and distance of a pointer that means the dot \[points\].
const RADIUS: f32 = 3.5;
const REACH: f32 = 9.0;
/// Greatest height of the list, and that of six sizes with the heads \[points\].
const LIST_HEIGHT: f32 = 300.0;
const SIX_SIZES: f32 = 190.0;
/// Share of the window's height that the list takes at least \[-\].
const LIST_SHARE: f32 = 0.25;
/// What the last column is.
const JUDGED: &str = "The worst of the three cards for each size, for this patient and this margin of the pocket. A quick, coarse computation.";
/// Greatest height of the field of a pasted table \[points\].
const PASTED_HEIGHT: f32 = 70.0;

/// The shelf and its dots for the present map.
#[derive(Default)]
pub(crate) struct Sizes {
    pub(crate) shelf: Shelf,
    /// Number of changes of the shelf.
    pub(crate) revision: u64,
    /// The start of the map and the revision of the shelf to which the dots belong.
    key: Option<(u64, u64)>,
    dots: Vec<Dot>,
    /// The table that is being pasted; `None` while the field is closed.
    pasted: Option<String>,
    /// The table that is being looked at before it is taken.
    preview: Option<Preview>,
    /// Is the list unfolded by the next frame?
    unfolds: bool,
}

/// A size within the axes.
struct Dot {
    index: usize,
    at: (f64, f64),
    words: String,
}

impl Sizes {
    /// Replaces the shelf.
    pub(crate) fn set(&mut self, shelf: Shelf) {
        self.shelf = shelf;
        self.revision += 1;
    }

    /// Follows map and shelf. `start` counts the starts of maps.
    pub(super) fn update(&mut self, map: &Map, start: u64) {
        let key = (start, self.revision);
        if self.key == Some(key) {
            return;
        }
        let is_size = |parameter| {
            [Parameter::BaseWidth, Parameter::of(Field::Projection), Parameter::Volume]
                .contains(&parameter)
        };
        let is_over_sizes =
            map.base().implant.is_round() && map.axes().iter().all(|axis| is_size(axis.field));
        let dot = |(index, size): (usize, &ShelfSize)| {
            let at = map.place(&with_size(map.base(), size).ok()?)?;
            Some(Dot { index, at: (at[0], at[1]), words: words(size) })
        };
        let sizes = self.shelf.sizes().iter().enumerate();
        let sizes = sizes.filter(|(_, size)| is_over_sizes && size.is_round());
        self.dots = sizes.filter_map(dot).collect();
        self.key = Some(key);
    }

    /// Has the clinic a shelf?
    pub(super) fn is_in_use(&self) -> bool {
        !self.shelf.sizes().is_empty()
    }

    /// What the dots are, in a sentence; empty without dots.
    pub(super) fn legend(&self) -> &'static str {
        if self.dots.is_empty() { "" } else { tr("White dots: the sizes in stock.") }
    }

    /// Draws the dots of a map of two axes.
    pub(super) fn paint(&self, painter: &Painter, plane: &Plane) {
        for dot in &self.dots {
            let ring = Stroke::new(1.0, Color32::from_black_alpha(190));
            painter.circle(plane.at(dot.at), RADIUS, Color32::WHITE, ring);
        }
    }

    /// The dots on the screen.
    pub(super) fn marks(&self, plane: &Plane) -> Vec<Rect> {
        let size = Vec2::splat(2.0 * RADIUS);
        self.dots.iter().map(|dot| Rect::from_center_size(plane.at(dot.at), size)).collect()
    }

    /// Index of the size at a point of the screen.
    pub(super) fn at(&self, plane: &Plane, point: Pos2) -> Option<usize> {
        let distance = |dot: &&Dot| plane.at(dot.at).distance(point);
        let near = self.dots.iter().filter(|dot| distance(dot) <= REACH);
        near.min_by(|a, b| distance(a).total_cmp(&distance(b))).map(|dot| dot.index)
    }

    /// The place of a size on the screen, and its words with the worst of the three cards there.
    pub(super) fn readout(
        &self,
        map: JudgedMap<'_>,
        plane: &Plane,
        index: usize,
    ) -> Option<(Pos2, Vec<String>)> {
        let dot = self.dots.iter().find(|dot| dot.index == index)?;
        let value =
            |quantity| map.between(quantity, dot.at.0, dot.at.1).map(|value| (value, false));
        let mut lines = vec![dot.words.clone()];
        lines.extend(
            readout::worst(map.practice_at(dot.at.0, dot.at.1), &value).map(|worst| worst.words),
        );
        Some((plane.at(dot.at), lines))
    }
}

/// A size with its name, as "RD-275 · 275 cc: width 12 cm, projection 3.7 cm".
fn words(size: &ShelfSize) -> String {
    let dome = size.size();
    tr!(
        "{name}: width {width}, projection {projection}",
        name = size.label(),
        width = width_in_words(size.width_mm()),
        projection = Words::of(Parameter::of(Field::Projection)).text(dome.projection_mm())
    )
}

/// The scene with a size of the shelf: the listed numbers with the maker's name. The pocket keeps its margin, and the breast its base,
/// that of the plan: practice is the same for all sizes.
pub(crate) fn with_size(scene: &Scene, size: &ShelfSize) -> Result<Scene, String> {
    let (dome, base_mm) = (size.size(), new_base(scene));
    let mut scene = scene.clone();
    scene.implant.make_round();
    scene.implant.fullness = None;
    let mut values = vec![
        (Parameter::BaseWidth, size.width_mm()),
        (Parameter::of(Field::Projection), dome.projection_mm()),
    ];
    if !size.is_round() {
        let height = dome.base_height_mm();
        values.push((Parameter::of(Field::BaseHeight), height));
        values.push((Parameter::of(Field::ApexShift), usual_apex(height)));
    }
    if (dome.fullness() - HALF_ELLIPSOID).abs() > 1e-9 {
        scene.implant.fullness = Some(dome.fullness());
    }
    let mut scene = with_values(&scene, &values).map_err(|error| error.to_string())?;
    if let Some(patient) = &mut scene.patient {
        patient.measured.base_width_mm.get_or_insert(base_mm);
    }
    size.label().clone_into(&mut scene.implant_reference);
    Ok(scene)
}

/// Takes a size of the shelf: one step of the history. The first one keeps the base of the breast, which is said.
pub(crate) fn take_size(size: &ShelfSize, scene: &Scene, actions: &mut Vec<Action>) {
    match with_size(scene, size) {
        Ok(taken) => {
            actions.push(Action::Accept(Box::new(taken)));
            if scene.measured().base_width_mm.is_none() && scene.patient.is_some() {
                let width = width_in_words(new_base(scene));
                actions.push(Action::Notify(Notice::info(tr!(
                    "The breast's base stays {width}, so that practice takes one volume for all sizes: numbers of other widths change.",
                    width
                ))));
            }
        }
        Err(reason) => {
            let words = tr!("{name} was not taken. {reason}", name = size.name(), reason);
            actions.push(Action::Notify(Notice::caution(words)));
        }
    }
}

/// A base width as the chart and the list have it, as "12 cm".
pub(crate) fn width_in_words(width_mm: f64) -> String {
    Words::of(Parameter::BaseWidth).text(width_mm)
}

impl Range {
    /// The folded list of the shelf; returns the index of a size to take.
    pub(super) fn shelf_list(
        &mut self,
        ui: &mut Ui,
        layout: Layout,
        actions: &mut Vec<Action>,
    ) -> Option<usize> {
        let count = self.sizes.shelf.sizes().len();
        let title = if count == 0 {
            tr("Sizes in stock").to_owned()
        } else {
            tr!("Sizes in stock: {count}", count)
        };
        let mut event = None;
        let unfolds = std::mem::take(&mut self.sizes.unfolds).then_some(true);
        egui::CollapsingHeader::new(title).id_salt("shelf").open(unfolds).show(ui, |ui| {
            self.shelf_buttons(ui, actions);
            if count == 0 {
                remark(ui, tr("The sizes of your clinic from a table of the maker or your own (CSV): reference, width, projection, volume, \
                    of anatomical implants the height. You check the columns before the table is taken. The table stays on this machine."));
                return;
            }
            let mut removed = None;
            // Room for the bar beside the words of the last column.
            let scroll = &mut ui.spacing_mut().scroll;
            scroll.floating_allocated_width = scroll.bar_width;
            let mut list =
                egui::ScrollArea::new([layout == Layout::Narrow, true]).max_height(LIST_HEIGHT);
            if layout == Layout::Wide {
                // A panel as high as its content has no room of its own.
                let share = LIST_SHARE * ui.ctx().content_rect().height();
                list = list.min_scrolled_height(SIX_SIZES.min(share));
            }
            self.verdicts.list();
            list.show(ui, |ui| {
                egui::Grid::new("shelf sizes").num_columns(6).spacing([14.0, 3.0]).show(ui, |ui| {
                    for title in [tr("Name"), tr("Width"), tr("Projection"), tr("Volume"), ""] {
                        ui.label(RichText::new(title).small().weak());
                    }
                    ui.label(RichText::new(tr("In this patient")).small().weak()).on_hover_text(tr(JUDGED));
                    ui.end_row();
                    for (index, size) in self.sizes.shelf.sizes().iter().enumerate() {
                        let take = ui.link(size.label());
                        set_accessible_name(&take, egui::Role::Button, &tr!("Take {name}", name = size.label()));
                        let hover = size.note().map_or_else(|| tr("Take this size").to_owned(), |note| shown(&note));
                        if take.on_hover_text(hover).clicked() {
                            event = Some(index);
                        }
                        let dome = size.size();
                        let width = Words::of(Parameter::BaseWidth);
                        ui.label(if size.is_round() {
                            width.text(size.width_mm())
                        } else {
                            format!("{} × {}", width.number(size.width_mm()), width.text(dome.base_height_mm()))
                        });
                        ui.label(Words::of(Parameter::of(Field::Projection)).text(dome.projection_mm()));
                        ui.label(match size.listed_volume_ml() {
                            Some(volume) => format!("{volume:.0} cc"),
                            None => format!("{:.0} ml", dome.volume_ml()),
                        });
                        let remove = ui.small_button("×");
                        set_accessible_name(&remove, egui::Role::Button, &tr!("Remove {name}", name = size.label()));
                        if remove.clicked() {
                            removed = Some(index);
                        }
                        // Its words come later: nothing stands to the right of them.
                        self.verdicts.cell(ui, index);
                        ui.end_row();
                    }
                });
            });
            if let Some(index) = removed {
                self.sizes.shelf.remove(index);
                self.sizes.revision += 1;
            }
        });
        event
    }

    /// The buttons above the list, and the field of a pasted table.
    fn shelf_buttons(&mut self, ui: &mut Ui, actions: &mut Vec<Action>) {
        ui.horizontal_wrapped(|ui| {
            if ui
                .button(tr("Open table…"))
                .on_hover_text(tr("A table (CSV); dropping the file does the same"))
                .clicked()
            {
                actions.push(Action::Run(Task::OpenTable));
            }
            if ui.button(tr("Paste table")).clicked() {
                self.sizes.pasted = match self.sizes.pasted {
                    Some(_) => None,
                    None => Some(String::new()),
                };
            }
            // Above the field, which grows with its table.
            if let Some(text) = &self.sizes.pasted
                && ui.button(tr("Use this table")).clicked()
            {
                actions.push(Action::ReadShelf(tr("The table").to_owned(), text.clone()));
            }
            if self.sizes.is_in_use() && ui.button(tr("Remove all")).clicked() {
                self.sizes.set(Shelf::default());
            }
        });
        if let Some(text) = &mut self.sizes.pasted {
            let field = egui::TextEdit::multiline(text)
                .hint_text("Ref.;Width (cm);Projection (cm);Volume (cc)")
                .desired_rows(3)
                .desired_width(f32::INFINITY);
            let scroll = egui::ScrollArea::vertical().id_salt("pasted").max_height(PASTED_HEIGHT);
            let response = scroll.show(ui, |ui| ui.add(field)).inner;
            let name = tr("Table of sizes");
            set_accessible_name(&response, egui::Role::MultilineTextInput, name);
        }
    }

    /// Opens the preview of a table. Returns why there is none; the shelf stays as it is.
    pub(crate) fn read_shelf(&mut self, name: &str, text: &str) -> Option<Notice> {
        match Draft::of(text) {
            Ok(draft) => {
                self.sizes.preview = Some(Preview::new(name, draft));
                None
            }
            Err(error) => Some(unread(name, &error)),
        }
    }

    /// Is a table being looked at?
    pub(crate) fn has_preview(&self) -> bool {
        self.sizes.preview.is_some()
    }

    /// Shows the preview of a table; once the table is taken, opens the page with the list and returns a notice.
    pub(crate) fn shelf_preview(&mut self, ctx: &egui::Context) -> Option<Notice> {
        let preview = self.sizes.preview.as_mut()?;
        let decision = preview.show(ctx, self.sizes.shelf.sizes().len())?;
        let Preview { name, .. } = self.sizes.preview.take()?;
        let (mut taken, added) = match decision {
            Decision::Take(shelf) => (Shelf::default(), shelf),
            Decision::Add(shelf) => (self.sizes.shelf.clone(), shelf),
            Decision::Cancel => return None,
        };
        let count = added.sizes().len();
        if let Err(error) = taken.add(&added) {
            return Some(unread(&name, &error));
        }
        self.sizes.set(taken);
        self.sizes.pasted = None;
        (self.is_open, self.shows_more, self.sizes.unfolds) = (true, true, true);
        let device = Device::of(ctx);
        let page = device.words(tr(entry_of(Task::ShowRange(true)).name));
        let words =
            tr!("{count} sizes of {name} are in stock, on the page {page}.", count, name, page);
        Some(Notice::info(match device {
            Device::Implant => words,
            Device::Expander => format!("{words} {}", tr(AS_EXPANDERS)),
        }))
    }
}

/// A table that was not taken, and why.
fn unread(name: &str, error: &str) -> Notice {
    let error = shown(error);
    Notice::error(tr!(
        "{name} was not read; the sizes in stock are unchanged. {error}.",
        name,
        error
    ))
}
