//! The picture: the 3-D view (`viewport`) with its controls (`view_bar`, `view_menu`), the cross-section under it (`strip`), the
//! `handles` that move the implant on it, and the push of the implant to be watched (`insertion`).

pub(crate) mod handles;
pub(crate) mod insertion;
pub(crate) mod strip;
pub(crate) mod view_bar;
pub(crate) mod view_menu;
pub(crate) mod viewport;
