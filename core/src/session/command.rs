//! Commands of a user, and why a command is rejected.

use crate::scene::{Letter, Scene, SceneError};

/// A user's command.
#[derive(Clone, Debug)]
pub enum Command {
    /// Replaces the scene. Edits of one gesture (a drag of a slider) are one undo step.
    Edit {
        /// The complete new scene.
        scene: Box<Scene>,
        /// Number of the gesture; consecutive edits of equal number are merged in the history.
        gesture: u64,
    },
    /// Opens the text of a scene file. The pins of a file with the field `pins` replace the present pins.
    Open(String),
    /// Reverts the edits of a gesture, if they are the last ones. Neither undo nor redo has a step of them.
    CancelGesture(u64),
    /// Reverts the last undo step.
    Undo,
    /// Repeats the last reverted step.
    Redo,
    /// Pins the current scene under the first free letter. During its solve the pin waits for the result.
    Pin,
    /// Removes a pin.
    Unpin(Letter),
    /// Changes the name of a pin.
    Rename(Letter, String),
    /// Opens the scene of a pin in place of the current scene, as one undo step. The pin, the visit and the measured base of the same patient's breast stay.
    OpenPin(Letter),
}

/// Error of a rejected command, in one line.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CommandError {
    /// A scene, a file or a name is invalid.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// All letters are taken.
    #[error("4 scenes are pinned; allowed: up to 4. Remove a pin first.")]
    Full,
    /// The scene or the letter is pinned already.
    #[error("This plan is pinned already, as {0}.")]
    Pinned(Letter),
    /// The current scene has no converged result.
    #[error("This scene has no finished result; only a scene with a result can be pinned.")]
    NoResult,
    /// The letter has no pin.
    #[error("There is no pin {0}.")]
    NoPin(Letter),
}
