//! Actions of panels, commands of menus, keys and list. A panel adds its actions to a list; `perform` executes them.

use super::messages::Notice;
use crate::app::picture::viewport::{Before, PictureSubject};
use crate::app::scan;
use crate::app::texts::Language;
use crate::scene::Scene;
use crate::session::Command;
use crate::view::camera::View;
use crate::view::cross_section::SectionPlane;
use crate::view::place::Place;
use crate::view::quantity::Quantity;
use eframe::egui::ThemePreference;

/// A command of menus, keys and list.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Task {
    OpenPlan,
    /// A table of sizes, or any other table that the app reads.
    OpenTable,
    SavePlan,
    SaveNumbers,
    SaveTable,
    TakeHome(Purpose),
    CopyLink,
    SaveProfile,
    UsualImplant,
    HalfSphere,
    Undo,
    Redo,
    StartOver,
    Pin,
    Look(View),
    /// What the picture is about.
    Show(PictureSubject),
    /// Cut open; in half.
    Cut(bool, bool),
    /// Number of the quantity.
    Colour(usize),
    Grid,
    Areola,
    CrossSection,
    Torso,
    KeepSurface,
    /// Shows the body before, or no more.
    ShowBefore(Before),
    Ruler,
    Research,
    Play,
    /// The range of implants in place of the picture?
    ShowRange(bool),
    Theme(ThemePreference),
    Language(Language),
    List,
    Help,
}

/// Purpose of a picture of the plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Purpose {
    File,
    Clipboard,
    Report,
}

/// An action of a panel.
pub(crate) enum Action {
    Run(Task),
    Session(Command),
    /// A scene of a panel, as one step of the history.
    Replace(Scene),
    /// A plan that the app has offered, as one step of the history.
    Accept(Box<Scene>),
    /// The nearest plan with an answer.
    TakeNearest(Scene),
    Cancel,
    /// Ends the step of a scan.
    EndScan(scan::Choice),
    Resume,
    ColourBy(Quantity),
    /// Direction of the cut \[°\].
    CutAt(f32),
    /// The plane of the cross-section.
    ShowSection(SectionPlane),
    /// Values of the picture that stay.
    KeepValues(Place),
    /// A file by its name.
    Save(String, Vec<u8>),
    /// The text of a table of sizes by its name.
    ReadShelf(String, String),
    Notify(Notice),
    CloseNotice,
}
