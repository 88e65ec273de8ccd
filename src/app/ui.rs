//! Layout of the panels: side panels on wide screens, a bottom sheet with tabs on narrow ones.

use super::toolbar::Layout;
use super::widgets::{self, Control, Kind};
use super::{App, controls, messages, plots, readings, status, theme};
use crate::scene::Scene;
use eframe::egui::{self, Ui};

/// A tab of the bottom sheet on narrow screens.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum NarrowTab {
    Implant,
    Tissue,
    Results,
    Plots,
}

impl App {
    /// Arranges toolbar, side panels, insertion and picture on a wide screen.
    pub(super) fn wide(&mut self, ui: &mut Ui, scene: &mut Scene) {
        egui::Panel::top("toolbar").resizable(false).show(ui, |ui| self.toolbar(ui, Layout::Wide));
        egui::Panel::bottom("status").resizable(false).show(ui, |ui| {
            ui.add_space(theme::SPACE_SMALL);
            status::show(ui, &self.session, &self.timing);
            ui.add_space(theme::SPACE_SMALL);
        });
        let mut is_open = self.show_left;
        side_panel(egui::Panel::left("controls")).show_collapsible(ui, &mut is_open, |ui| {
            column("controls").show(ui, |ui| {
                widgets::heading(ui, "Scene");
                self.position_notice = controls::implant(ui, scene, &mut self.is_hemisphere);
                controls::layers(ui, scene);
                ui.add_space(theme::SPACE);
                controls::method(ui, scene, &self.session);
                self.focus.scroll_into_view(ui);
            });
        });
        self.show_left = is_open;
        let mut is_open = self.show_right;
        side_panel(egui::Panel::right("results")).show_collapsible(ui, &mut is_open, |ui| {
            column("results").show(ui, |ui| {
                readings::show(ui, &self.session, self.previous_results());
                self.plots(ui);
                self.focus.scroll_into_view(ui);
            });
        });
        self.show_right = is_open;
        let insertion = egui::Panel::bottom("insertion").resizable(false);
        insertion.show(ui, |ui| self.insertion_row(ui, scene));
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    /// Arranges toolbar, picture and bottom sheet on a narrow screen.
    pub(super) fn narrow(&mut self, ui: &mut Ui, scene: &mut Scene) {
        let toolbar = egui::Panel::top("toolbar").resizable(false);
        toolbar.show(ui, |ui| self.toolbar(ui, Layout::Narrow));
        // The picture keeps half of the screen.
        let height = 0.42 * ui.ctx().content_rect().height();
        let sheet = egui::Panel::bottom("sheet").exact_size(height).resizable(false);
        sheet.show(ui, |ui| {
            status::show(ui, &self.session, &self.timing);
            ui.horizontal(|ui| {
                for (tab, name) in [
                    (NarrowTab::Implant, "Implant"),
                    (NarrowTab::Tissue, "Tissue"),
                    (NarrowTab::Results, "Results"),
                    (NarrowTab::Plots, "Plots"),
                ] {
                    ui.selectable_value(&mut self.narrow_tab, tab, name);
                }
            });
            ui.separator();
            egui::ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
                match self.narrow_tab {
                    NarrowTab::Implant => {
                        self.insertion_row(ui, scene);
                        self.position_notice =
                            controls::implant(ui, scene, &mut self.is_hemisphere);
                    }
                    NarrowTab::Tissue => {
                        controls::layers(ui, scene);
                        controls::method(ui, scene, &self.session);
                    }
                    NarrowTab::Results => {
                        readings::show(ui, &self.session, self.previous_results());
                    }
                    NarrowTab::Plots => self.plots(ui),
                }
                self.focus.scroll_into_view(ui);
            });
        });
        egui::CentralPanel::no_frame().show(ui, |ui| self.picture(ui, scene));
    }

    fn plots(&self, ui: &mut Ui) {
        plots::section(ui, &self.session);
        plots::curves(ui, &self.session, self.previous_results());
    }

    /// The slider of the insertion with its play button.
    fn insertion_row(&mut self, ui: &mut Ui, scene: &mut Scene) {
        ui.add_space(theme::SPACE_SMALL);
        ui.horizontal(|ui| {
            let name = if self.is_playing { "Pause" } else { "Play" };
            let button = ui.add_sized([56.0, 24.0], egui::Button::new(name));
            if button.on_hover_text(format!("{name} the insertion (space)")).clicked() {
                self.toggle_playback();
            }
            ui.vertical(|ui| {
                let mut percent = 100.0 * scene.insertion;
                let slider = Control {
                    label: "Insertion",
                    unit: "%",
                    kind: Kind::Percent,
                    range: 0.0..=100.0,
                    reset: 100.0,
                    decimals: 0,
                    step: 1.0,
                    tooltip: "Height of the implant under the tissue, from flat (0 %) to full (100 %).",
                    ..Control::default()
                };
                if slider.show(ui, &mut percent).is_changed {
                    scene.insertion = (percent / 100.0).clamp(0.0, 1.0);
                    self.is_playing = false;
                }
            });
        });
        ui.add_space(theme::SPACE_SMALL);
    }

    /// The 3-D view with notices above it, or the page that replaces the view.
    fn picture(&mut self, ui: &mut Ui, scene: &mut Scene) {
        self.show_notice(ui);
        if self.session.is_stopped() {
            self.stopped_page(ui);
        } else if self.session.has_no_shape() {
            messages::no_shape_page(ui, self.session.invalid(), scene);
        } else {
            if self.is_long() {
                self.progress_bar(ui);
            }
            self.viewport.show(ui, &self.session, &mut self.options);
        }
    }
}

/// A side panel of limited width. A wide line or figure widens a panel for good, and the picture pays.
fn side_panel(panel: egui::Panel) -> egui::Panel {
    panel.default_size(theme::PANEL_WIDTH).max_size(1.15 * theme::PANEL_WIDTH).resizable(false)
}

/// The scrolled content of a side panel, at the panel's full width. A content that shrinks would make
/// the panel narrower by some points in every frame.
fn column(name: &str) -> egui::ScrollArea {
    egui::ScrollArea::vertical().id_salt(name).auto_shrink([false, true])
}
