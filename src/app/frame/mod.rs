//! The frame: what runs, arranges and keeps the panels.
//!
//! `logic` runs frames, `perform` executes the actions of panels (`action`) and commands (`commands`, `keys`, `palette`), `ui` arranges
//! the screen with `toolbar`, `status` and `messages`. `shared` is what all panels read, `studies` runs jobs beside the app,
//! `files`, `link`, `opened`, `clipboard` bring plans in and out, `scan` a body. `interface` is the door to `platform` and the tests.

pub(crate) mod action;
pub(crate) mod clipboard;
pub(crate) mod commands;
pub(crate) mod controls;
pub(crate) mod files;
pub(crate) mod focus;
pub(crate) mod interface;
pub(crate) mod keys;
pub(crate) mod link;
pub(crate) mod logic;
pub(crate) mod messages;
pub(crate) mod opened;
pub(crate) mod palette;
pub(crate) mod panel_widths;
pub(crate) mod perform;
pub(crate) mod research;
pub(crate) mod scan;
pub(crate) mod shared;
pub(crate) mod stats;
pub(crate) mod status;
pub(crate) mod studies;
pub(crate) mod toolbar;
pub(crate) mod ui;
