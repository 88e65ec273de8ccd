//! Plan, pins, shelf and practice table from one start of the app to the next: the platform stores a text of each.

use crate::app::plan::Choices;
use crate::scene::Scene;
use serde::{Deserialize, Serialize};
use web_time::{Duration, Instant};

/// Delay between a change and its text for the storage; changes in between are stored once.
pub(in crate::app) const DELAY: Duration = Duration::from_millis(400);

/// What of plan and pins is stored.
#[derive(Debug)]
pub(in crate::app) struct Keep {
    /// The session's revision of the stored pins.
    pub(in crate::app) revision: u64,
    /// When the present pins are to be stored.
    pub(in crate::app) pins_due: Option<Instant>,
    /// The stored plan with its choices and the switch of the cross-section, or that of the start, which is not stored.
    pub(in crate::app) plan: (Scene, Choices, bool),
    /// When the present plan is to be stored.
    pub(in crate::app) plan_due: Option<Instant>,
    /// The revision of the stored shelf.
    pub(in crate::app) shelf: u64,
    /// When the present shelf is to be stored.
    pub(in crate::app) shelf_due: Option<Instant>,
    /// The revision of the stored practice table.
    pub(in crate::app) practice: u64,
    /// When the present practice table is to be stored.
    pub(in crate::app) practice_due: Option<Instant>,
    pub(in crate::app) has_failed: bool,
    /// Is the chosen language to be stored?
    pub(in crate::app) is_language_due: bool,
    /// Is the switch "Research" to be stored?
    pub(in crate::app) is_research_due: bool,
}

impl Keep {
    /// Nothing to store at the start with a scene.
    pub(in crate::app) fn new(scene: Scene) -> Self {
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
pub(in crate::app) struct KeptPlan {
    pub(in crate::app) scene: serde_json::Value,
    pub(in crate::app) choices: Choices,
    /// Is the cross-section under the picture?
    pub(in crate::app) cross_section: bool,
}

/// Is a text to be stored now? It is then stored once.
pub(in crate::app) fn is_due(due: &mut Option<Instant>, is_closing: bool) -> bool {
    due.take_if(|due| is_closing || Instant::now() >= *due).is_some()
}
