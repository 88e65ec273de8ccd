//! `charts`: the paper's charts 1 to 4 for both spring laws, and the errors of the Poisson ratio.

use super::output::{self, File, OutputFolder};
use super::tension::{COLUMNS, table_rows};
use super::{ExitStatus, InputError};
use crate::curve::{Curve, CurveSpec};
use crate::export::number;
use crate::springs::Springs;
use implant_preview_lab::charts::tension::{Chart, Kind, Series, draw};
use implant_preview_lab::tension::{Protocol, Report, Test, run as run_tension, springs_name};
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;

/// Poisson ratios of the paper's charts.
const POISSON_RATIOS: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.45, 0.49];
/// Greatest relative error of the Poisson ratio reported in the paper.
const PAPER_ERROR: f64 = 0.35;

/// A test with its reports by both protocols.
struct TestReports {
    tissue: &'static str,
    test: Test,
    equilibrium: Report,
    paper: Report,
}

pub(super) fn run(folder: &OutputFolder) -> Result<ExitStatus, InputError> {
    let folder = folder.create()?;
    let reports = run_tests()?;
    let mut files = Vec::new();
    for (k, (tissue, kind)) in [
        ("skin", Kind::Stress),
        ("skin", Kind::Transverse),
        ("adipose", Kind::Stress),
        ("adipose", Kind::Transverse),
    ]
    .into_iter()
    .enumerate()
    {
        let of_tissue: Vec<&TestReports> = reports.iter().filter(|p| p.tissue == tissue).collect();
        let name = match kind {
            Kind::Stress => format!("chart-{}-{tissue}-stress", k + 1),
            Kind::Transverse => format!("chart-{}-{tissue}-transverse", k + 1),
        };
        let chart = chart(k + 1, tissue, kind, &of_tissue);
        let picture = draw(&chart).map_err(|error| output::input_error(folder, error))?;
        files.push(File::new(&folder.join(format!("{name}.svg")), picture));
        files.push(File::new(&folder.join(format!("{name}.csv")), table(&of_tissue)));
    }
    let (csv, markdown) = poisson_errors(&reports);
    files.push(File::new(&folder.join("poisson_error.csv"), csv));
    files.push(File::new(&folder.join("poisson_error.md"), markdown));
    output::write_all(&files)?;
    Ok(ExitStatus::Converged)
}

fn run_tests() -> Result<Vec<TestReports>, InputError> {
    let mut tests = Vec::new();
    for (tissue, spec) in [("skin", CurveSpec::Skin {}), ("adipose", CurveSpec::Adipose {})] {
        let curve =
            Curve::new(&spec).map_err(|error| output::input_error(Path::new(tissue), error))?;
        for springs in [Springs::Nikolaev, Springs::Coupled] {
            for poisson_ratio in POISSON_RATIOS {
                let curve = curve.clone();
                let protocol = Protocol::Equilibrium;
                let test = Test { springs, curve, poisson_ratio, cells: 4, angle: 0.0, protocol };
                tests.push((tissue, test));
            }
        }
    }
    Ok(tests
        .into_par_iter()
        .map(|(tissue, test)| TestReports {
            tissue,
            equilibrium: run_tension(&test),
            paper: run_tension(&Test { protocol: Protocol::Paper, ..test.clone() }),
            test,
        })
        .collect())
}

/// The table of a chart: the equilibrium, with the columns of `tension`.
fn table(reports: &[&TestReports]) -> String {
    let rows = reports.iter().map(|p| table_rows(&p.test, p.tissue, &p.equilibrium));
    COLUMNS.to_owned() + &rows.collect::<String>()
}

fn chart(number: usize, tissue: &str, kind: Kind, reports: &[&TestReports]) -> Chart {
    let quantity = match kind {
        Kind::Stress => "stress against elongation",
        Kind::Transverse => "contraction against elongation",
    };
    let panel = |springs: Springs| {
        reports
            .iter()
            .filter(|p| p.test.springs == springs)
            .enumerate()
            .map(|(rank, p)| series(kind, rank, p))
            .collect()
    };
    let curve = |p: &&TestReports| {
        let points = (0..=200).map(|k| 0.005 * f64::from(k));
        points.map(|strain| (strain, p.test.curve.stress(strain))).collect()
    };
    Chart {
        title: format!("Chart {number}: {tissue}, {quantity}"),
        tissue: tissue.to_owned(),
        kind,
        curve: reports.first().map(curve).unwrap_or_default(),
        panels: [
            ("The paper's springs".to_owned(), panel(Springs::Nikolaev)),
            ("Coupled springs".to_owned(), panel(Springs::Coupled)),
        ],
    }
}

/// The series of a test: stable branches as lines, the paper's protocol as points, losses of stability as
/// marks.
fn series(kind: Kind, rank: usize, reports: &TestReports) -> Series {
    let mut series = Series::new(reports.test.poisson_ratio);
    let mut branch = vec![(0.0, 0.0)];
    for row in &reports.equilibrium.rows {
        match row.measured {
            Some(m) => branch.push((m.strain, kind.value(row.load_kpa, m.transverse_strain))),
            None if !branch.is_empty() => {
                // The first loss is known to 0.001, further losses to one row.
                let at = match reports.equilibrium.stability_lost_at {
                    Some(strain) if series.lost.is_empty() => strain,
                    _ => row.strain_expected,
                };
                let stress = reports.test.curve.stress(at);
                let end = (at, kind.value(stress, -reports.test.poisson_ratio * at));
                branch.push(end);
                series.lost.push(end);
                series.branches.push(std::mem::take(&mut branch));
            }
            None => {}
        }
    }
    if !branch.is_empty() {
        series.branches.push(branch);
    }
    // One row in six, different for each Poisson ratio, so that coinciding series remain visible.
    series.points = reports
        .paper
        .rows
        .iter()
        .skip(rank)
        .step_by(POISSON_RATIOS.len())
        .filter_map(|row| {
            let m = row.measured?;
            Some((m.strain, kind.value(row.load_kpa, m.transverse_strain)))
        })
        .collect();
    series
}

/// Greatest relative error of the Poisson ratio per law, curve and ν, as CSV and as Markdown.
fn poisson_errors(reports: &[TestReports]) -> (String, String) {
    let mut csv = "springs,curve,poisson_ratio,greatest_error_equilibrium,greatest_error_paper_protocol,stability_lost_at,error_reported_in_paper\n".to_owned();
    let mut markdown = format!(
        "Greatest relative error of the measured Poisson ratio over the stable rows (strain 0 to 1); \
         the paper reports up to {:.0} %.\n\n\
         | springs | tissue | ν | equilibrium | paper's 15 000 iterations | stability lost at strain |\n\
         | --- | --- | --- | --- | --- | --- |\n",
        100.0 * PAPER_ERROR
    );
    for p in reports {
        let nu = p.test.poisson_ratio;
        let springs = springs_name(p.test.springs);
        let errors = [&p.equilibrium, &p.paper].map(|report| report.greatest_poisson_error(nu));
        let lost = p.equilibrium.stability_lost_at;
        // Writing to a String cannot fail.
        let _ = writeln!(
            csv,
            "{springs},{},{nu},{},{},{},{PAPER_ERROR}",
            p.tissue,
            errors[0].map(number).unwrap_or_default(),
            errors[1].map(number).unwrap_or_default(),
            lost.map(number).unwrap_or_default()
        );
        let percent = |error: Option<f64>| match error {
            Some(error) if error < 1e-6 => "< 0.0001 %".to_owned(),
            Some(error) => format!("{:.1} %", 100.0 * error),
            None => "no stable row".to_owned(),
        };
        let _ = writeln!(
            markdown,
            "| {springs} | {} | {nu} | {} | {} | {} |",
            p.tissue,
            percent(errors[0]),
            percent(errors[1]),
            lost.map_or_else(|| "never".to_owned(), |strain| format!("{strain:.2}"))
        );
    }
    (csv, markdown)
}
