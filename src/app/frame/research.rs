//! The switch "Research": without it the screen shows what a surgeon needs. A value that differs from its default stays in sight.

use eframe::egui::{Context, Id};

fn key() -> Id {
    Id::unique("research")
}

/// Notes for the panels of a context whether the switch is on.
pub(crate) fn note(ctx: &Context, is_on: bool) {
    ctx.data_mut(|data| data.insert_temp(key(), is_on));
}

/// Is the switch on?
pub(crate) fn is_on(ctx: &Context) -> bool {
    ctx.data(|data| data.get_temp(key())).unwrap_or_default()
}
