//! Plan, pins, shelf, practice table and preferences from one start to the next, in the store of a platform.

use crate::app::App;

/// A store of the kept texts.
pub(super) trait Store {
    /// Names of the texts.
    const PLAN: &'static str;
    const PINS: &'static str;
    const SHELF: &'static str;
    const PRACTICE: &'static str;
    const LANGUAGE: &'static str;
    const RESEARCH: &'static str;
    /// Why the store failed.
    type Error;

    /// The kept text of a name; `None` without one.
    fn read(&self, name: &str) -> Result<Option<String>, Self::Error>;

    /// Keeps a text in place of that of its name.
    fn write(&self, name: &str, text: &str) -> Result<(), Self::Error>;
}

/// Reads the kept preferences into a new app: the texts of later notices are in the kept language.
pub(super) fn restore_preferences<S: Store>(app: &mut App, store: &S) {
    let kept = |name| store.read(name).ok().flatten();
    app.restore_language(kept(S::LANGUAGE).as_deref());
    app.restore_research(kept(S::RESEARCH).as_deref());
}

/// Reads the kept plan, pins, shelf and practice table into a new app.
pub(super) fn restore<S: Store>(app: &mut App, store: &S) {
    for (name, restore) in [
        (S::PLAN, App::restore_plan as fn(&mut App, &str)),
        (S::PINS, App::restore_pins),
        (S::SHELF, App::restore_shelf),
        (S::PRACTICE, App::restore_practice_table),
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
        (S::PRACTICE, app.take_practice_table_to_store(is_closing)),
        (S::LANGUAGE, app.take_language_to_store()),
        (S::RESEARCH, app.take_research_to_store()),
    ] {
        if text.is_some_and(|text| store.write(name, &text).is_err()) {
            app.report_storage_failure();
        }
    }
}

/// Texts by name in one place.
#[cfg(any(target_arch = "wasm32", test))]
pub(super) trait Texts {
    /// Why the place failed.
    type Error;

    /// The text of a name; `None` without one.
    fn get(&self, name: &str) -> Result<Option<String>, Self::Error>;

    /// Sets the text of a name.
    fn set(&self, name: &str, text: &str) -> Result<(), Self::Error>;
}

/// Reads a text of a tab: its own one, or at the first start of the tab the shared one, which becomes its own. Two tabs are two
/// plans: neither reads what the other one has written since.
#[cfg(any(target_arch = "wasm32", test))]
pub(super) fn read_of_tab<T: Texts>(
    tab: &T,
    shared: &T,
    name: &str,
) -> Result<Option<String>, T::Error> {
    let own = tab.get(name)?;
    let text = match &own {
        Some(text) => text.clone(),
        // An empty text is the own one of a tab that starts without a shared one.
        None => shared.get(name)?.unwrap_or_default(),
    };
    if own.is_none() {
        // A place that keeps nothing is reported with the first change.
        let _ = tab.set(name, &text);
    }
    Ok((!text.is_empty()).then_some(text))
}

/// Keeps a text of a tab, for its next start and for that of a new tab.
#[cfg(any(target_arch = "wasm32", test))]
pub(super) fn write_of_tab<T: Texts>(
    tab: &T,
    shared: &T,
    name: &str,
    text: &str,
) -> Result<(), T::Error> {
    tab.set(name, text)?;
    shared.set(name, text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::cell::RefCell;
    use std::collections::HashMap;

    #[derive(Default)]
    struct Memory(RefCell<HashMap<String, String>>);

    impl Texts for Memory {
        type Error = ();

        fn get(&self, name: &str) -> Result<Option<String>, ()> {
            Ok(self.0.borrow().get(name).cloned())
        }

        fn set(&self, name: &str, text: &str) -> Result<(), ()> {
            self.0.borrow_mut().insert(name.to_owned(), text.to_owned());
            Ok(())
        }
    }

    #[test]
    fn a_tab_keeps_its_own_text_and_a_new_one_starts_with_the_last_written() {
        let [first, second, third, shared] = std::array::from_fn(|_| Memory::default());
        let read = |tab: &Memory| read_of_tab(tab, &shared, "plan").unwrap();
        assert_eq!(read(&first), None);
        write_of_tab(&second, &shared, "plan", "pinch 3").unwrap();
        // A reload of the tab without an edit: still the opening plan.
        assert_eq!(read(&first), None);
        write_of_tab(&first, &shared, "plan", "333 ml").unwrap();
        write_of_tab(&second, &shared, "plan", "pinch 4").unwrap();
        assert_eq!(read(&first).as_deref(), Some("333 ml"));
        assert_eq!(read(&second).as_deref(), Some("pinch 4"));
        assert_eq!(read(&third).as_deref(), Some("pinch 4"));
        write_of_tab(&first, &shared, "plan", "350 ml").unwrap();
        assert_eq!(read(&third).as_deref(), Some("pinch 4"));
    }
}
