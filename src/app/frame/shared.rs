//! The state that all panels read. A panel changes the draft of the scene and its own state only; all else is an `Action`.

use super::status::{Pending, Timing};
use crate::app::answer::PreviousResults;
use crate::app::answer::before_after::has_body;
use crate::app::answer::compare::Compare;
use crate::app::answer::measured::Measured;
use crate::app::answer::practice::{Against, Practices};
use crate::app::answer::uncertainty::Uncertainty;
use crate::app::picture::viewport::{Options, Viewport};
use crate::app::plan::Choices;
use crate::app::plan::volume_marks::VolumeMarks;
use crate::session::Session;
use crate::view::cross_section::SectionPlane;
use web_time::{Duration, Instant};

/// Time of a solve after which the app shows its progress and hides the previous results.
pub(crate) const LONG: Duration = Duration::from_millis(400);
/// Time of a solve after which its picture is marked as provisional.
const PROVISIONAL: Duration = Duration::from_secs(1);

/// A solve in progress.
#[derive(Clone, Copy)]
pub(crate) struct RunningSolve {
    /// Start of the first solve of several without a shape in between: of a drag of a slow plan, say.
    pub(crate) since: Instant,
    /// Start of the solve of the present plan.
    pub(crate) start: Instant,
    /// Completed fraction \[-\], 0 to 1.
    pub(crate) fraction: f64,
}

/// The state that all panels read.
pub(crate) struct Shared {
    pub(crate) session: Session,
    /// The choices of the plan.
    pub(crate) choices: Choices,
    pub(crate) viewport: Viewport,
    pub(crate) options: Options,
    pub(crate) compare: Compare,
    pub(crate) uncertainty: Uncertainty,
    pub(crate) volume_marks: VolumeMarks,
    pub(crate) practices: Practices,
    /// The measures of her body.
    pub(crate) measured: Measured,
    pub(crate) timing: Timing,
    pub(crate) solving: Option<RunningSolve>,
    /// Is the cross-section shown under the picture where there is room?
    pub(crate) show_strip: bool,
    /// Does the file of the plan keep the surface of her body?
    pub(crate) keep_surface: bool,
    /// The chosen plane of the cross-section.
    pub(crate) chosen_plane: Option<SectionPlane>,
    /// Is the switch "Research" on?
    pub(crate) research: bool,
    /// Address of the page without its fragment; `None` on the desktop.
    pub(crate) page_address: Option<String>,
}

impl Shared {
    /// The file of the plan, with or without the surface of her body.
    pub(crate) fn document(&self) -> String {
        match self.keep_surface {
            true => self.session.document_json(),
            false => self.session.document_json_without_surface(),
        }
    }

    /// Has the plan the surface of her body?
    pub(crate) fn has_surface(&self) -> bool {
        has_body(&self.session)
    }

    /// Is the drawn body a usual one, in place of hers, whose chest the plan has without her surface?
    pub(crate) fn has_stand_in(&self) -> bool {
        self.session.scene().chest_grid.is_some() && !self.has_surface()
    }

    /// The plane of the cross-section: the chosen one, else that in which the implant shows its shape.
    pub(crate) fn section_plane(&self) -> SectionPlane {
        self.chosen_plane.unwrap_or_else(|| SectionPlane::of(self.session.scene()))
    }

    /// Have solves been running for more than a time, without a shape in between?
    fn is_solving_for(&self, time: Duration) -> bool {
        self.session.is_working()
            && self.solving.is_some_and(|running| running.since.elapsed() > time)
    }

    /// Is a long solve in progress?
    pub(crate) fn is_long(&self) -> bool {
        self.is_solving_for(LONG)
    }

    /// Has the running solve taken so long that its picture is marked as provisional?
    pub(crate) fn is_provisional(&self) -> bool {
        self.is_solving_for(PROVISIONAL)
    }

    /// What is still computed beside the figures of the solved plan.
    pub(crate) fn pending(&self) -> Option<Pending> {
        let scene = self.session.scene();
        if self.practices.against(scene) == Against::Waiting {
            Some(Pending::Practice)
        } else if !self.volume_marks.is_known(scene) {
            Some(Pending::LargestVolume)
        } else {
            (!self.uncertainty.is_known(scene)).then_some(Pending::Ranges)
        }
    }

    /// Visibility of the results of the previous scene.
    pub(crate) fn previous_results(&self) -> PreviousResults {
        if self.is_long() { PreviousResults::Hidden } else { PreviousResults::Shown }
    }

    /// Has the present plan a result with a shape?
    pub(crate) fn has_shape(&self) -> bool {
        self.session.result().is_some() && !self.session.has_no_shape()
    }
}
