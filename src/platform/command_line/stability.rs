//! `stability`: stability of a uniformly stretched sheet, as a table and a map for each curve.

use super::output::{self, File, OutputFolder};
use super::{ExitStatus, InputError};
use crate::curve::{Curve, CurveSpec, FULL_STRAIN};
use crate::export::number;
use crate::scene::Field;
use crate::springs::Springs;
use crate::springs::stability::Load;
use implant_preview_lab::charts::stability_map::{Map, draw};
use implant_preview_lab::stability::{Point, row};
use implant_preview_lab::tension::springs_name;
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;

const COLUMNS: &str = "springs,curve,load,poisson_ratio,strain,transverse_strain,\
    least_eigenvalue_sheet,least_eigenvalue_waves,wave_x,wave_y,wave_angle_deg,polarisation_deg,\
    least_eigenvalue_out_of_plane,status\n";

/// Number of steps of the strain from 0 to 1, and of the Poisson ratio from 0 to 0.5.
const STRAINS: u32 = 100;
const POISSON_RATIOS: u32 = 50;

/// The curves: both presets, a line, and an exponential whose slope rises by a factor of 55.
const CURVES: [(&str, CurveSpec); 4] = [
    ("skin", CurveSpec::Skin {}),
    ("adipose", CurveSpec::Adipose {}),
    ("linear", CurveSpec::Linear { modulus_kpa: 100.0 }),
    ("exponential", CurveSpec::Exponential { scale_kpa: 2.0, rate: 4.0 }),
];

/// The map of a curve, law and load; rows with rising Poisson ratio.
struct Mapped {
    springs: Springs,
    curve: &'static str,
    load: Load,
    points: Vec<Point>,
}

pub(super) fn run(folder: &OutputFolder) -> Result<ExitStatus, InputError> {
    let folder = folder.create()?;
    let steps = |count: u32, end: f64| -> Vec<f64> {
        (0..=count).map(|k| end * f64::from(k) / f64::from(count)).collect()
    };
    let strains = steps(STRAINS, FULL_STRAIN);
    let mut poisson_ratios = steps(POISSON_RATIOS, Field::PoissonRatio.limits.1);
    // At ν = 0 every state is neutral, and near ν = 0 the stiffness varies strongly: one more row.
    poisson_ratios.insert(1, 0.5 * poisson_ratios[1]);
    let mapped = map_all(&strains, &poisson_ratios)?;
    let mut files = vec![File::new(&folder.join("stability.csv"), table(&mapped))];
    for (curve, _) in CURVES {
        let of = |springs: Springs, load: Load| -> Vec<Point> {
            let is_wanted = |m: &&Mapped| (m.springs, m.curve, m.load) == (springs, curve, load);
            mapped.iter().filter(is_wanted).flat_map(|m| m.points.iter().copied()).collect()
        };
        let map = Map {
            title: format!("Stability of the paper's springs: {curve}"),
            strains: &strains,
            poisson_ratios: &poisson_ratios,
            panels: Load::ALL.map(|load| (load, of(Springs::Nikolaev, load))),
            note: coupled_note(&Load::ALL.map(|load| of(Springs::Coupled, load)).concat()),
        };
        let picture = draw(&map).map_err(|error| output::input_error(folder, error))?;
        files.push(File::new(&folder.join(format!("stability-{curve}.svg")), picture));
    }
    output::write_all(&files)?;
    Ok(ExitStatus::Converged)
}

fn map_all(strains: &[f64], poisson_ratios: &[f64]) -> Result<Vec<Mapped>, InputError> {
    let mut maps = Vec::new();
    for springs in [Springs::Nikolaev, Springs::Coupled] {
        for (name, spec) in &CURVES {
            let curve =
                Curve::new(spec).map_err(|error| output::input_error(Path::new(name), error))?;
            maps.extend(Load::ALL.map(|load| (springs, *name, curve.clone(), load)));
        }
    }
    let map = |(springs, name, curve, load): &(Springs, &'static str, Curve, Load)| {
        let rows = poisson_ratios.par_iter().map(|&nu| row(*springs, curve, nu, *load, strains));
        let points = rows.collect::<Vec<_>>().concat();
        Mapped { springs: *springs, curve: name, load: *load, points }
    };
    Ok(maps.par_iter().map(map).collect())
}

/// Summary of the coupled springs, for the chart of the paper's springs.
fn coupled_note(points: &[Point]) -> String {
    let least = points.iter().map(|p| p.wave.stiffness).fold(f64::INFINITY, f64::min);
    let unstable = points.iter().filter(|p| p.wave.stiffness < 0.0).count();
    if unstable == 0 {
        format!(
            "Coupled springs: stable at every point of both maps ({}), least stiffness {least:.2}.",
            points.len()
        )
    } else {
        format!(
            "Coupled springs: unstable at {unstable} of the {} points of both maps.",
            points.len()
        )
    }
}

fn table(mapped: &[Mapped]) -> String {
    let rounded = |value: f64, unit: f64| number((value / unit).round() * unit);
    let mut table = COLUMNS.to_owned();
    for Mapped { springs, curve, load, points } in mapped {
        let springs = springs_name(*springs);
        let load = load.name();
        for point in points {
            let status = match point.wave.stiffness {
                least if least > 0.0 => "stable",
                least if least < 0.0 => "unstable",
                _ => "neutral",
            };
            // Writing to a String cannot fail.
            let _ = writeln!(
                table,
                "{springs},{curve},{load},{},{},{},{},{},{},{},{},{},{},{status}",
                number(point.poisson_ratio),
                number(point.strain),
                number(point.transverse_strain),
                rounded(point.sheet, 1e-6),
                rounded(point.wave.stiffness, 1e-6),
                rounded(point.wave.vector[0], 1e-4),
                rounded(point.wave.vector[1], 1e-4),
                rounded(point.wave.angle.to_degrees(), 0.01),
                rounded(point.wave.polarisation.to_degrees(), 0.01),
                rounded(point.least_out_of_plane(), 1e-6),
            );
        }
    }
    table
}
