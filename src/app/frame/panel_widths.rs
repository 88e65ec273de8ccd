//! Widths of the side panels, which the user drags.

use crate::app::widgets::theme;
use eframe::egui::{self, Rect, Ui};

/// Widths of the side panels that the user has chosen, plan and answer \[points\].
#[derive(Default)]
pub(crate) struct PanelWidths([Option<f32>; 2]);

impl PanelWidths {
    /// The widths in a window: the picture keeps a third.
    pub(crate) fn fitting(&self, window: f32) -> [f32; 2] {
        let (least, most) = theme::PANEL_WIDTH;
        let usual = (0.24 * window).clamp(least, most);
        self.0.map(|width| width.unwrap_or(usual).min(window / 3.0).max(least))
    }

    /// Moves the inner edges of the panels with the pointer; a double-click restores the usual width.
    pub(crate) fn drag(&mut self, ui: &Ui, plan: Rect, answer: Rect) {
        for (k, (panel, edge)) in
            [(plan, plan.right()), (answer, answer.left())].into_iter().enumerate()
        {
            let area = Rect::from_x_y_ranges(edge - 3.0..=edge + 3.0, panel.y_range());
            let id = ui.scope_id().with(("panel edge", k));
            let response = ui.interact(area, id, egui::Sense::CLICK | egui::Sense::DRAG);
            if response.hovered() || response.dragged() {
                ui.set_cursor_icon(egui::CursorIcon::ResizeHorizontal);
                let stroke = egui::Stroke::new(2.0, theme::palette(ui.visuals()).accent);
                ui.painter().vline(edge, panel.y_range(), stroke);
            }
            if response.double_clicked() {
                self.0[k] = None;
            } else if let Some(at) = response.interact_pointer_pos().filter(|_| response.dragged())
            {
                let width = if k == 0 { at.x - panel.left() } else { panel.right() - at.x };
                self.0[k] = Some(width);
            }
        }
    }
}
