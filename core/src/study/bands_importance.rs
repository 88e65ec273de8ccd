//! The importance of the unknowns for the quantities of bands.

use super::bands::FIRST_SAMPLE;
use super::importance::{Index, MIN_ROWS, Row, index};
use super::{Bands, Case, Quantity};

impl Bands {
    /// The items of a row of the importance of an unknown: A, B, and A with the unknown of B.
    fn row_items(&self, unknown: usize, row: usize) -> [usize; 3] {
        let (first, rows) = (FIRST_SAMPLE + self.settings.samples, self.settings.importance_rows);
        [FIRST_SAMPLE + row, first + row, first + (unknown + 1) * rows + row]
    }

    /// Sobol indices of a quantity by unknown, from the rows that have converged; `None` without enough rows or without
    /// variance.
    #[must_use]
    pub fn importance(&self, quantity: Quantity) -> Vec<Option<Index>> {
        let row = |k: usize, row: usize| -> Option<Row> {
            let [a, b, mixed] = self.row_items(k, row).map(|item| self.value(quantity, item));
            Some([a?, b?, mixed?])
        };
        let indices = |k: usize| {
            let rows = 0..self.settings.importance_rows;
            let found: Vec<Row> = rows.filter_map(|r| row(k, r)).collect();
            index(&found)
        };
        (0..self.unknowns.len()).map(indices).collect()
    }

    /// What the samples did not allow, in one line each. Empty before the end of the study.
    pub(super) fn remarks(&self) -> Vec<String> {
        let (done, all) = self.queue.progress();
        let rows = self.settings.importance_rows;
        if done < all || rows == 0 {
            return Vec::new();
        }
        let is_answer = |item: usize| self.queue.case(item).is_some_and(Case::is_converged);
        let answers = |k: usize| {
            let is_whole = |row: &usize| self.row_items(k, *row).into_iter().all(is_answer);
            (0..rows).filter(is_whole).count()
        };
        let short = |k: usize| {
            let (name, found) = (self.unknowns[k].0.name(), answers(k));
            (found < MIN_ROWS).then(|| format!("{name} ({found})"))
        };
        let short: Vec<String> = (0..self.unknowns.len()).filter_map(short).collect();
        if short.is_empty() {
            return Vec::new();
        }
        vec![format!(
            "No importance of {}: rows with an answer, of {rows}; an index needs {MIN_ROWS}.",
            short.join(", ")
        )]
    }
}
