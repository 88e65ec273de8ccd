//! Plan, pins, shelf and practice table from one start of the app to the next: the platform stores a text of each.

use crate::app::plan::Choices;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use web_time::{Duration, Instant};

/// Delay between a change and its text for the storage; changes in between are stored once.
pub(crate) const DELAY: Duration = Duration::from_millis(400);

/// What of plan and pins is stored.
#[derive(Debug)]
pub(crate) struct Keep {
    /// The session's revision of the stored pins.
    pub(crate) revision: u64,
    /// When the present pins are to be stored.
    pub(crate) pins_due: Option<Instant>,
    /// The stored plan with its choices and the switch of the cross-section, or that of the start, which is not stored.
    pub(crate) plan: (Scene, Choices, bool),
    /// When the present plan is to be stored.
    pub(crate) plan_due: Option<Instant>,
    /// The revision of the stored shelf.
    pub(crate) shelf: u64,
    /// When the present shelf is to be stored.
    pub(crate) shelf_due: Option<Instant>,
    /// The revision of the stored practice table.
    pub(crate) practice: u64,
    /// When the present practice table is to be stored.
    pub(crate) practice_due: Option<Instant>,
    pub(crate) has_failed: bool,
    /// Is the chosen language to be stored?
    pub(crate) is_language_due: bool,
    /// Is the switch "Research" to be stored?
    pub(crate) is_research_due: bool,
}

impl Keep {
    /// Nothing to store at the start with a scene.
    pub(crate) fn new(scene: Scene) -> Self {
        let plan = (scene, Choices::default(), true);
        Self {
            revision: 0,
            pins_due: None,
            plan,
            plan_due: None,
            shelf: 0,
            shelf_due: None,
            practice: 0,
            practice_due: None,
            has_failed: false,
            is_language_due: false,
            is_research_due: false,
        }
    }
}

/// A stored plan.
#[derive(Serialize, Deserialize)]
pub(crate) struct KeptPlan {
    pub(crate) scene: serde_json::Value,
    pub(crate) choices: Choices,
    /// Is the cross-section under the picture?
    pub(crate) cross_section: bool,
}

/// Is a text to be stored now? It is then stored once.
pub(crate) fn is_due(due: &mut Option<Instant>, is_closing: bool) -> bool {
    due.take_if(|due| is_closing || Instant::now() >= *due).is_some()
}
