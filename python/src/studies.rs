//! Matrices of numbers, maps, bands and times.

use super::interrupt::{self, Stop};
use super::pool::threads;
use super::{failed, json, refused};
use implant_preview_core::scene::{Scene, read};
use implant_preview_core::study::many::{Many, ManySettings};
use implant_preview_core::study::{
    Bands, BandsSettings, Cases, Evaluator, Job, JobThreads, MapOptions, Quantity, Study, Template,
    Times, run,
};
use implant_preview_core::table::Decimals;
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2};
use pyo3::prelude::*;

/// Runs a study to its end; a signal of the interpreter ends it.
fn finish(py: Python<'_>, study: &mut (impl Study + Send), wanted: Option<usize>) -> PyResult<()> {
    let stop = Stop::default();
    let flag = stop.flag();
    let work = move |evaluator: &mut Evaluator, job: &Job| {
        evaluator.stop_at(&flag);
        evaluator.evaluate(job)
    };
    py.detach(|| {
        let mut interrupt = None;
        let is_ended = || {
            interrupt = Python::attach(|py| py.check_signals()).err();
            interrupt.is_some()
        };
        let mut runner = JobThreads::new(threads(wanted), work, is_ended).map_err(failed)?;
        run(study, &mut Cases::default(), &mut runner).map_err(failed)?;
        drop(runner);
        interrupt.map_or(Ok(()), Err)
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

#[pyfunction]
pub(crate) fn times(py: Python<'_>, scene: &str, threads: Option<usize>) -> PyResult<String> {
    let scene = Scene::from_json(scene).map_err(refused)?;
    let mut times = Times::new(&scene).map_err(refused)?;
    finish(py, &mut times, threads)?;
    Ok(json(&times.file()))
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
        let scene = template.scene(&cells, Decimals::Point);
        scenes.push(scene.map_err(|error| refused(format!("row {row} of X: {error}")))?);
    }
    let shape = [scenes.len(), quantities.len()];
    let settings = ManySettings::new(self::threads(threads));
    let stop = Stop::default();
    let flag = stop.flag();
    let work = move |evaluator: &mut Evaluator, scene: Scene| {
        evaluator.stop_at(&flag);
        let case = evaluator.case(&scene, &Job::default());
        let value =
            |quantity: &Quantity| case.values.get(*quantity).filter(|_| case.is_converged());
        quantities.iter().map(|quantity| value(quantity).unwrap_or(f64::NAN)).collect::<Vec<f64>>()
    };
    let mut rows = Many::new(scenes.into_iter(), settings, work).map_err(failed)?;
    let mut all = Vec::with_capacity(shape[0] * shape[1]);
    while let Some(finished) = interrupt::next(py, |end| rows.next_until(end))? {
        py.check_signals()?;
        let row = finished.result.map_err(failed)?;
        all.extend(row);
    }
    PyArray1::from_vec(py, all).reshape(shape)
}
