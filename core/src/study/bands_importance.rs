//! The importance of the unknowns for the quantities of bands: from polynomials of the samples, else from rows.

use super::bands::FIRST_SAMPLE;
use super::importance::{Index, MIN_ROWS, Row, index};
use super::{Bands, Case, Quantity, unit_sample};

/// Greatest part of the variance that a polynomial misses where its indices stand for those of rows \[-\].
const MOST_ERROR: f64 = 0.05;

impl Bands {
    /// Fits the polynomial of the next quantity; adds the rows after the last one if a polynomial misses too much.
    pub(super) fn fit(&mut self) {
        let Some(quantity) = self.fits.next() else { return };
        let values: Vec<Option<f64>> = self.sample_values(quantity).collect();
        let distributions: Vec<_> = self.unknowns.iter().map(|(_, of)| of.distribution).collect();
        let (count, seed) = (distributions.len(), self.settings.seed);
        let point = |sample| (0..count).map(|k| unit_sample(sample, k, seed)).collect();
        self.fits.fit(&values, &distributions, point);
        if self.fits.is_complete() && !self.missed().is_empty() {
            self.add_rows();
        }
    }

    /// Adds the rows of B, and for each unknown those of A with the unknown of B.
    fn add_rows(&mut self) {
        let (first, rows) = (FIRST_SAMPLE + self.settings.samples, self.settings.importance_rows);
        self.queue.extend(first..first + rows * (self.unknowns.len() + 1));
    }

    /// The quantities whose polynomials miss too much, with the part of the variance \[-\].
    fn missed(&self) -> Vec<(Quantity, f64)> {
        let error = |quantity| Some((quantity, self.fits.of(quantity)?.error));
        let errors = Quantity::ALL.into_iter().filter_map(error);
        errors.filter(|(_, error)| *error > MOST_ERROR).collect()
    }

    /// Sobol indices of a quantity by unknown, once all samples are solved; `None` without enough answers or without variance.
    #[must_use]
    pub fn importance(&self, quantity: Quantity) -> Vec<Option<Index>> {
        match (self.fits.of(quantity), self.better_rows(quantity)) {
            (None, _) => vec![None; self.unknowns.len()],
            (Some(_), Some(rows)) => rows,
            (Some(fit), None) => fit.indices.iter().copied().map(Some).collect(),
        }
    }

    /// Part of the variance that the polynomial behind [`Self::importance`] misses \[-\]; `None` for indices from rows.
    #[must_use]
    pub fn importance_error(&self, quantity: Quantity) -> Option<f64> {
        let fit = self.fits.of(quantity)?;
        self.better_rows(quantity).is_none().then_some(fit.error)
    }

    /// The indices from rows of a quantity whose polynomial misses too much, if their standard errors are smaller than what it misses.
    fn better_rows(&self, quantity: Quantity) -> Option<Vec<Option<Index>>> {
        let missed = self.fits.of(quantity).map(|fit| fit.error).filter(|e| *e > MOST_ERROR)?;
        let rows = self.importance_by_rows(quantity);
        let is_better = |index: &Option<Index>| {
            index.is_some_and(|index| index.standard_error.iter().all(|error| *error < missed))
        };
        rows.iter().all(is_better).then_some(rows)
    }

    /// The indices from the rows that have converged.
    fn importance_by_rows(&self, quantity: Quantity) -> Vec<Option<Index>> {
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

    /// The items of a row of the importance of an unknown: A, B, and A with the unknown of B.
    fn row_items(&self, unknown: usize, row: usize) -> [usize; 3] {
        let (first, rows) = (FIRST_SAMPLE + self.settings.samples, self.settings.importance_rows);
        [FIRST_SAMPLE + row, first + row, first + (unknown + 1) * rows + row]
    }

    /// What the samples did not allow, in one line each. Empty before the end of the study.
    pub(super) fn remarks(&self) -> Vec<String> {
        let (done, all) = self.queue.progress();
        let rows = self.settings.importance_rows;
        if done < all || rows == 0 || !self.fits.is_complete() {
            return Vec::new();
        }
        let is_answer = |item: usize| self.queue.case(item).is_some_and(Case::is_converged);
        let samples = FIRST_SAMPLE..FIRST_SAMPLE + self.settings.samples;
        let answers = samples.filter(|item| is_answer(*item)).count();
        if answers < MIN_ROWS {
            return vec![format!(
                "No importance: samples with an answer: {answers}; an index needs {MIN_ROWS}."
            )];
        }
        let least = 100.0 * MOST_ERROR;
        let (of_rows, of_polynomials): (Vec<_>, Vec<_>) = self
            .missed()
            .into_iter()
            .partition(|(quantity, _)| self.importance_error(*quantity).is_none());
        let remark = |of: &[(Quantity, f64)], why: String| {
            let name = |(quantity, error): &(Quantity, f64)| {
                format!("{} ({:.0} %)", quantity.name(), 100.0 * error)
            };
            let names: Vec<String> = of.iter().map(name).collect();
            (!of.is_empty()).then(|| format!("{why}: {}.", names.join(", ")))
        };
        let remarks = [
            remark(
                &of_rows,
                format!(
                    "Importance from {rows} rows, because polynomials of the samples miss more than {least:.0} % of the variance"
                ),
            ),
            remark(
                &of_polynomials,
                format!(
                    "Importance from polynomials of the samples that miss more than {least:.0} % of the variance, because {rows} rows tell less"
                ),
            ),
        ];
        remarks.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::scene::Scene;
    use crate::study::{
        Bands, BandsSettings, Cases, Evaluator, Job, JobThreads, MapSettings, Quantity, run,
    };

    /// The bands of a sheet on a coarse grid, with rows for all samples or for none that a polynomial follows.
    fn solved(samples: usize, has_rows: bool) -> Bands {
        let grid = Some(MapSettings { nodes_per_side: 17, ..MapSettings::default() });
        let rows = if has_rows { samples } else { 16 };
        let settings =
            BandsSettings { samples, importance_rows: rows, grid, ..BandsSettings::default() };
        let mut bands = Bands::new(&Scene::sheet(), settings).unwrap();
        if has_rows {
            bands.add_rows();
        }
        let work = |solver: &mut Evaluator, job: &Job| solver.evaluate(job);
        let mut threads = JobThreads::new(2.try_into().unwrap(), work, || false).unwrap();
        run(&mut bands, &mut Cases::default(), &mut threads).unwrap();
        bands
    }

    #[test]
    #[ignore = "41 000 scenes: minutes"]
    fn indices_of_polynomials_are_those_of_4096_rows_within_both_errors() {
        let (few, many) = (solved(256, false), solved(4096, true));
        let mut compared = 0;
        for quantity in Quantity::ALL {
            let Some(error) = few.importance_error(quantity) else { continue };
            let wanted = many.importance_by_rows(quantity);
            for (found, wanted) in few.importance(quantity).into_iter().zip(wanted) {
                let (found, wanted) = (found.unwrap(), wanted.unwrap());
                let differences =
                    [found.first_order - wanted.first_order, found.total - wanted.total];
                for (which, difference) in differences.into_iter().enumerate() {
                    let errors = found.standard_error[which].hypot(wanted.standard_error[which]);
                    // Of a jackknife of 8 parts one in 200 differences is above 4 errors.
                    assert!(difference.abs() < 4.0 * errors + error, "{found:?} {wanted:?}");
                }
                compared += 1;
            }
        }
        assert!(compared >= 8 * 8, "{compared}");
    }
}
