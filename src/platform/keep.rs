//! Plan, pins, shelf and language from one start to the next, in the store of a platform.

use crate::app::App;

/// A store of the kept texts.
pub(super) trait Store {
    /// Names of the texts.
    const PLAN: &'static str;
    const PINS: &'static str;
    const SHELF: &'static str;
    const LANGUAGE: &'static str;
    /// Why the store failed.
    type Error;

    /// The kept text of a name; `None` without one.
    fn read(&self, name: &str) -> Result<Option<String>, Self::Error>;

    /// Keeps a text in place of that of its name.
    fn write(&self, name: &str, text: &str) -> Result<(), Self::Error>;
}

/// Reads the kept language into a new app: the texts of later notices are in this language.
pub(super) fn restore_language<S: Store>(app: &mut App, store: &S) {
    app.restore_language(store.read(S::LANGUAGE).ok().flatten().as_deref());
}

/// Reads the kept plan, pins and shelf into a new app.
pub(super) fn restore<S: Store>(app: &mut App, store: &S) {
    for (name, restore) in [
        (S::PLAN, App::restore_plan as fn(&mut App, &str)),
        (S::PINS, App::restore_pins),
        (S::SHELF, App::restore_shelf),
    ] {
        match store.read(name) {
            Ok(Some(text)) => restore(app, &text),
            Ok(None) => {}
            Err(_) => app.report_storage_failure(),
        }
    }
}

/// Keeps what has changed; at the end also changes of the last moments.
pub(super) fn keep<S: Store>(app: &mut App, store: &S, is_closing: bool) {
    for (name, text) in [
        (S::PLAN, app.take_plan_to_store(is_closing)),
        (S::PINS, app.take_pins_to_store(is_closing)),
        (S::SHELF, app.take_shelf_to_store(is_closing)),
        (S::LANGUAGE, app.take_language_to_store()),
    ] {
        if text.is_some_and(|text| store.write(name, &text).is_err()) {
            app.report_storage_failure();
        }
    }
}
