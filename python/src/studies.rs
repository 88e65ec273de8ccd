//! Matrices of numbers, maps and bands.

use super::pool::threads;
use super::{failed, json, refused};
use implant_preview_core::scene::{Scene, read};
use implant_preview_core::study::many::{Many, ManySettings};
use implant_preview_core::study::{
    Bands, BandsSettings, Case, Cases, Evaluator, Finished, Job, MapOptions, Quantity, Runner,
    Study, Template, run,
};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;
use std::num::NonZeroUsize;
use std::sync::mpsc::{Sender, channel};

/// Runs the jobs of studies on threads; a signal of the interpreter ends the study.
struct Threads {
    jobs: Sender<Job>,
    cases: Many<Vec<Case>>,
    submitted: usize,
    taken: usize,
    threads: NonZeroUsize,
    interrupt: Option<PyErr>,
}

impl Threads {
    fn new(threads: NonZeroUsize) -> PyResult<Self> {
        let (jobs, receiver) = channel::<Job>();
        let settings = ManySettings { in_order: false, ..ManySettings::new(threads) };
        let work = |evaluator: &mut Evaluator, job: Job| evaluator.evaluate(&job);
        let cases = Many::new(receiver.into_iter(), settings, work).map_err(failed)?;
        Ok(Self { jobs, cases, submitted: 0, taken: 0, threads, interrupt: None })
    }
}

impl Runner for Threads {
    type Job = Job;
    type Done = Vec<Case>;

    fn submit(&mut self, job: Job) -> usize {
        // The receiver lives as long as the threads.
        let _ = self.jobs.send(job);
        self.submitted += 1;
        self.submitted - 1
    }

    fn cancel(&mut self, _index: usize) {}

    fn poll(&mut self) -> Option<Finished<Vec<Case>>> {
        None
    }

    fn next(&mut self) -> Option<Finished<Vec<Case>>> {
        if self.taken == self.submitted {
            return None;
        }
        if let Err(interrupt) = Python::attach(|py| py.check_signals()) {
            self.interrupt = Some(interrupt);
            return None;
        }
        self.taken += 1;
        self.cases.next()
    }

    fn workers(&self) -> usize {
        self.threads.get()
    }
}

/// Runs a study to its end.
fn finish(py: Python<'_>, study: &mut (impl Study + Send), wanted: Option<usize>) -> PyResult<()> {
    let mut threads = Threads::new(threads(wanted))?;
    py.detach(|| {
        run(study, &mut Cases::default(), &mut threads).map_err(failed)?;
        threads.interrupt.take().map_or(Ok(()), Err)
    })
}

#[pyfunction]
pub(crate) fn map(
    py: Python<'_>,
    scene: &str,
    options: &str,
    threads: Option<usize>,
) -> PyResult<String> {
    let scene = Scene::from_json(scene).map_err(refused)?;
    let options: MapOptions = read::json(options, "options").map_err(refused)?;
    let mut map = options.map(&scene).map_err(refused)?;
    finish(py, &mut map, threads)?;
    Ok(json(&map.file(options.show, None)))
}

#[pyfunction]
pub(crate) fn bands(
    py: Python<'_>,
    scene: &str,
    options: &str,
    threads: Option<usize>,
) -> PyResult<String> {
    let scene = Scene::from_json(scene).map_err(refused)?;
    let settings = BandsSettings::from_json(options).map_err(refused)?;
    let mut bands = Bands::new(&scene, settings).map_err(refused)?;
    finish(py, &mut bands, threads)?;
    Ok(json(&bands.report()))
}

/// The quantities of the scenes in which parameters have the values of the rows, NaN where a scene has no answer.
#[pyfunction]
pub(crate) fn matrix<'py>(
    py: Python<'py>,
    template: &str,
    names: Vec<String>,
    values: PyReadonlyArray2<'py, f64>,
    quantities: Vec<String>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyArray2<f64>>> {
    let template = Template::new(template, &names).map_err(refused)?;
    let quantities: Vec<Quantity> = quantities
        .iter()
        .map(|name| Quantity::of_name(name))
        .collect::<Result<_, _>>()
        .map_err(refused)?;
    let values = values.as_array();
    if values.ncols() != names.len() {
        return Err(refused(format!(
            "X has {} columns; allowed: {}, one for each name",
            values.ncols(),
            names.len()
        )));
    }
    let mut scenes = Vec::with_capacity(values.nrows());
    for (row, numbers) in values.rows().into_iter().enumerate() {
        let cells: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        let scene = template.scene(&cells);
        scenes.push(scene.map_err(|error| refused(format!("row {row} of X: {error}")))?);
    }
    let shape = [scenes.len(), quantities.len()];
    let settings = ManySettings::new(self::threads(threads));
    let work = move |evaluator: &mut Evaluator, scene: Scene| {
        let case = evaluator.case(&scene, &Job::default());
        let value =
            |quantity: &Quantity| case.values.get(*quantity).filter(|_| case.is_converged());
        quantities.iter().map(|quantity| value(quantity).unwrap_or(f64::NAN)).collect::<Vec<f64>>()
    };
    let mut rows = Many::new(scenes.into_iter(), settings, work).map_err(failed)?;
    let mut all = Vec::with_capacity(shape[0] * shape[1]);
    while let Some(finished) = py.detach(|| rows.next()) {
        py.check_signals()?;
        let row = finished.result.map_err(failed)?;
        all.extend(row);
    }
    PyArray1::from_vec(py, all).reshape(shape)
}
