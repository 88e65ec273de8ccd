//! The state that all panels read. A panel changes the draft of the scene and its own state only; all else is an `Action`.

use super::answer::PreviousResults;
use super::compare::Compare;
use super::plan::Choices;
use super::practice::Practices;
use super::status::Timing;
use super::uncertainty::Uncertainty;
use super::viewport::{Options, Viewport};
use super::volume_marks::VolumeMarks;
use crate::session::Session;
use crate::view::cross_section::SectionPlane;
use web_time::{Duration, Instant};

/// Time of a solve after which the app shows its progress and hides the previous results.
pub(super) const LONG: Duration = Duration::from_millis(400);
/// Time of a solve after which its picture is marked as provisional.
const PROVISIONAL: Duration = Duration::from_secs(1);

/// A solve in progress.
#[derive(Clone, Copy)]
pub(super) struct RunningSolve {
    /// Start of the first solve of several without a shape in between: of a drag of a slow plan, say.
    pub(super) since: Instant,
    /// Start of the solve of the present plan.
    pub(super) start: Instant,
    /// Completed fraction \[-\], 0 to 1.
    pub(super) fraction: f64,
}

/// The state that all panels read.
pub(super) struct Shared {
    pub(super) session: Session,
    /// The choices of the plan.
    pub(super) choices: Choices,
    pub(super) viewport: Viewport,
    pub(super) options: Options,
    pub(super) compare: Compare,
    pub(super) uncertainty: Uncertainty,
    pub(super) volume_marks: VolumeMarks,
    pub(super) practices: Practices,
    pub(super) timing: Timing,
    pub(super) solving: Option<RunningSolve>,
    /// Is the cross-section shown under the picture where there is room?
    pub(super) show_strip: bool,
    /// The chosen plane of the cross-section.
    pub(super) chosen_plane: Option<SectionPlane>,
    /// Is the switch "Research" on?
    pub(super) research: bool,
    /// Address of the page without its fragment; `None` on the desktop.
    pub(super) page_address: Option<String>,
}

impl Shared {
    /// The plane of the cross-section: the chosen one, else that in which the implant shows its shape.
    pub(super) fn section_plane(&self) -> SectionPlane {
        self.chosen_plane.unwrap_or_else(|| SectionPlane::of(self.session.scene()))
    }

    /// Have solves been running for more than a time, without a shape in between?
    fn is_solving_for(&self, time: Duration) -> bool {
        self.session.is_working()
            && self.solving.is_some_and(|running| running.since.elapsed() > time)
    }

    /// Is a long solve in progress?
    pub(super) fn is_long(&self) -> bool {
        self.is_solving_for(LONG)
    }

    /// Has the running solve taken so long that its picture is marked as provisional?
    pub(super) fn is_provisional(&self) -> bool {
        self.is_solving_for(PROVISIONAL)
    }

    /// Visibility of the results of the previous scene.
    pub(super) fn previous_results(&self) -> PreviousResults {
        if self.is_long() { PreviousResults::Hidden } else { PreviousResults::Shown }
    }

    /// Has the present plan a result with a shape?
    pub(super) fn has_shape(&self) -> bool {
        self.session.result().is_some() && !self.session.has_no_shape()
    }
}
