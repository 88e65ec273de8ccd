//! What leaves the screen for paper and files: picture and `report`, the table of all `numbers`.

pub(crate) mod numbers;
pub(crate) mod report;
