//! Properties of any input, shared by the property tests and the fuzz targets.

use implant_preview::body::before_after::Before;
use implant_preview::body::marks::Side;
use implant_preview::body::torso::builtin;
use implant_preview::clinical::{
    Column, Draft, LengthUnit, MAX_SIZES, Measurements, PracticeTable, Reading, Shelf,
};
use implant_preview::curve::{Curve, CurveSpec, ScaledCurve};
use implant_preview::measure::{Fields, surfaces};
use implant_preview::scene::{Scene, SceneError, read};
use implant_preview::simulate;
use implant_preview::solve::{Progress, Solution, Solver, Verdict};
use implant_preview::table::{self, Decimals, Rows, Table};
use implant_preview::tensile::{self, Given, StrainUnit, StressUnit};
use serde_json::json;
use std::collections::HashSet;
use std::io::BufReader;
use std::sync::Arc;

pub(crate) mod choices;

/// Greatest number of characters of a message.
pub(crate) const MESSAGE: usize = 300;

/// Checks that a message is one short, printable line.
pub(crate) fn check_message(error: &impl ToString) {
    let line = error.to_string();
    assert!(line.chars().count() < MESSAGE, "{} characters: {line:.500}", line.chars().count());
    assert!(!line.chars().any(char::is_control), "{line:?}");
    assert!(line.len() > 5, "{line:?} says nothing");
}

/// Checks that a table of sizes is rejected with one line, or read with any choice of its columns: every row is a size or left out with
/// one line, every size has a dome of its numbers and a name that a scene allows, the shelf is equal after a round trip. Returns whether
/// a row is a size.
pub(crate) fn check_shelf(bytes: &[u8], choices: &[(usize, usize)]) -> bool {
    let draft = Draft::text_of(bytes).map_err(|error| error.to_string());
    let mut draft = match draft.and_then(|text| Draft::of(&text)) {
        Ok(draft) => draft,
        Err(line) => {
            check_message(&line);
            return false;
        }
    };
    let mut is_size = false;
    for choice in [None].into_iter().chain(choices.iter().map(Some)) {
        if let Some((column, content)) = choice {
            draft.choose(*column, Column::ALL[content % Column::ALL.len()]);
            draft.choose_unit(
                *column,
                if content % 2 == 0 { LengthUnit::Mm } else { LengthUnit::Cm },
            );
        }
        let Reading { shelf, skipped, skipped_rows } = draft.read();
        assert!(skipped.len() <= skipped_rows && shelf.sizes().len() <= MAX_SIZES);
        skipped.iter().for_each(|row| check_message(&row.reason));
        let mut labels = HashSet::new();
        for size in shelf.sizes() {
            let (dome, label) = (size.size(), size.label());
            assert!(labels.insert(label.to_owned()), "{label}");
            assert!(!label.is_empty() && label.chars().count() <= 60, "{label}");
            assert!(!label.chars().any(char::is_control), "{label:?}");
            let is_kept = (dome.volume_ml() / size.volume_ml() - 1.0).abs() < 1e-9;
            assert!(is_kept || size.note().is_some(), "{size:?}");
            let listed = size.listed_projection_mm().unwrap_or(dome.projection_mm());
            assert!((dome.projection_mm() - listed).abs() < 1e-9, "{size:?}");
        }
        is_size |= !shelf.sizes().is_empty();
        if !shelf.sizes().is_empty() {
            assert_eq!(Shelf::from_csv(&shelf.to_csv()).as_ref(), Ok(&shelf));
        }
    }
    is_size
}

/// Checks that a practice table is rejected with one line, or equal after a round trip, with a volume within its rows at every width
/// of the table. Returns whether the table is accepted.
pub(crate) fn check_practice(text: &str) -> bool {
    let table = match PracticeTable::from_csv(text) {
        Ok(table) => table,
        Err(line) => {
            assert!(line.chars().count() < MESSAGE && line.len() > 5, "{line:.500}");
            assert!(!line.chars().any(char::is_control), "{line:?}");
            return false;
        }
    };
    assert_eq!(PracticeTable::from_csv(&table.to_csv()).as_ref(), Ok(&table));
    let volumes = table.starts().iter().map(|row| row[1]);
    let (least, most) = (volumes.clone().fold(f64::MAX, f64::min), volumes.fold(0.0, f64::max));
    let (from, to) = table.widths_mm();
    for k in 0..=40 {
        let width = from + (to - from) * f64::from(k) / 40.0;
        let volume = table.volume(width, &Measurements::default()).expect("within its widths");
        let volume = volume.volume_ml();
        assert!(least - 1e-9 <= volume && volume <= most + 1e-9, "{width}: {volume}");
    }
    assert!(table.volume(from - 0.01, &Measurements::default()).is_none());
    assert!(table.volume(to + 0.01, &Measurements::default()).is_none());
    true
}

/// Checks that a scene is rejected with one line, or within its limits, equal after a round trip and a valid problem.
pub(crate) fn check_scene(read: &Result<Scene, SceneError>) {
    let scene = match read {
        Ok(scene) => scene,
        Err(error) => return check_message(error),
    };
    scene.validate().expect("what was read is within its limits");
    let again = Scene::from_json(&scene.to_json()).expect("what was written can be read");
    assert_eq!(&again, scene);
    assert!(scene.same_physics(&again));
    for layer in &scene.layers {
        check_curve(&Curve::scaled(&layer.curve).expect("checked before"));
    }
    // A large sheet would only cost time.
    let mut small = scene.clone();
    small.solver.nodes_per_side = 17;
    let problem = small.problem().expect("checked before");
    assert!(problem.sheet().free_nodes() > 0);
    assert_eq!(problem.materials.len(), scene.layers.len());
    assert!(problem.sheet().radius_mm() >= problem.obstacle.dome.reference_length() * (1.0 - 1e-6));
}

/// Checks that bytes as the surface in a scene's `body` are rejected with one line, or equal after a round trip; fits and measures of it end. Returns whether
/// they are accepted.
pub(crate) fn check_kept_surface(bytes: &[u8]) -> bool {
    const SIGNS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let [count, kind, rest @ ..] = bytes else { return false };
    // Signs of base64, mostly whole triples of numbers; few vertices, so that triangles may have them.
    let sign = |byte: &u8| char::from(SIGNS[usize::from(byte & 63)]);
    let end = (8 * usize::from(*count)).min(rest.len());
    let [vertices, triangles] = [&rest[..end], &rest[end..]].map(|part| match kind {
        0 => String::from_utf8_lossy(part).into_owned(),
        1 => part.iter().map(sign).collect(),
        _ => part[..part.len() / 8 * 8].iter().map(sign).collect::<String>(),
    });
    // Small indices: low bytes of a few vertices, no high bytes.
    let small = |text: String| -> String {
        let of = |(k, c): (usize, char)| match k % 8 {
            0 => ['A', 'B', 'C'][c as usize % 3],
            3 => char::from(SIGNS[c as usize % 12]),
            _ => 'A',
        };
        text.chars().enumerate().map(of).collect()
    };
    let triangles = if *kind > 2 { small(triangles) } else { triangles };
    let marks = serde_json::to_value(builtin().marks).expect("marks are written");
    let scene = json!({ "implant": { "base_radius_mm": 60 }, "side": "left", "body": {
        "unit": "mm", "cover_mm": 10, "origin_mm": [80, 0, 100], "axes": [[1, 0, 0], [0, 1, 0], [0, 0, 1]],
        "marks": marks,
        "surface": { "least_mm": [-160, -250, -120], "step_mm": 0.005, "vertices": vertices, "triangles": triangles },
    } });
    let read = Scene::from_json(&scene.to_string());
    check_scene(&read);
    let Ok(mut scene) = read else { return false };
    let placement = scene.placement.clone().expect("given");
    let surface = placement.surface.expect("given").surface().clone();
    for side in [Side::Left, Side::Right] {
        let before = Before::new(surface.clone(), &placement.marks, side, placement.cover_mm);
        let rows = before.expect("marks of a body");
        let rows = rows.rows((&surface, &placement.marks), 0.0);
        assert!(rows.iter().all(|row| row.gain.is_none_or(|gain| gain.abs() < 1e-6)));
    }
    if let Err(error) = scene.add_other_side() {
        check_message(&error);
    }
    true
}

/// Slices of a solve of [`check_layered_solve`].
const SLICES: u32 = 300;

/// Solves layered tissue on the coarsest grid, up to [`SLICES`], and checks the result and the solids as closed meshes.
pub(crate) fn check_layered_solve(scene: &Scene) {
    if !scene.is_layered() {
        return;
    }
    let mut small = scene.clone();
    small.solver.nodes_per_side = 17;
    small.solver.tolerance = small.solver.tolerance.max(1e-3);
    let mut solver = Solver::new(small.problem().expect("checked before"));
    let mut slices = 0;
    let progress = solver.advance(&mut || {
        slices += 1;
        slices >= SLICES
    });
    let is_converged = progress == Progress::Done && solver.verdict() == Verdict::Converged;
    let solution = Arc::new(solver.into_solution());
    let outcome = simulate::measure(&small, &Fields::new(Arc::clone(&solution)));
    let text = format!("{outcome:?}");
    assert!(!text.contains("NaN"), "{text}");
    if is_converged {
        assert!(outcome.skin_area.is_some() && !text.contains("inf"), "{text}");
        assert_eq!(outcome.layers.len(), small.layers.len());
    }
    check_solids(&solution, small.layers.len());
}

/// Checks that every layer of a solution is a closed mesh of finite vertices: two neighbouring faces and the strip between
/// their borders.
fn check_solids(solution: &Solution, layers: usize) {
    let surfaces = surfaces(solution);
    assert_eq!(surfaces.positions.len(), layers + 1);
    assert!(surfaces.positions.iter().flatten().flatten().all(|x| x.is_finite()));
    let mut edges = HashSet::new();
    for [a, b, c] in &surfaces.triangles {
        for edge in [(a, b), (b, c), (c, a)] {
            assert!(edges.insert(edge), "two triangles on one side of an edge");
        }
    }
    // The strip has one quadrilateral on every edge of the border; the border is closed.
    let border: Vec<_> = edges.iter().filter(|(a, b)| !edges.contains(&(*b, *a))).collect();
    let starts: HashSet<u32> = border.iter().map(|(a, _)| **a).collect();
    let ends: HashSet<u32> = border.iter().map(|(_, b)| **b).collect();
    assert!(!border.is_empty() && starts == ends && starts.len() == border.len());
}

/// A curve as a file of its own.
pub(crate) fn check_curve_file(bytes: &[u8]) {
    match read::curve(bytes) {
        Ok(curve) => check_curve(&curve),
        Err(error) => check_message(&error),
    }
}

/// A raw tensile test in a file: a curve of at most 40 points or one per sample, with short sentences, or one line.
/// Returns whether it is a curve without asked units.
pub(crate) fn check_tensile(bytes: &[u8]) -> bool {
    let asked = Given { strain: Some(StrainUnit::Percent), stress: Some(StressUnit::Mpa) };
    for given in [Given::default(), asked] {
        match tensile::read(bytes, given) {
            Ok(found) => {
                assert!((2..=40).contains(&found.points.len()), "{:?}", found.points);
                check_curve(&Curve::new(&found.spec()).expect("a curve"));
                assert!(found.rms_kpa.is_finite());
                found.notes.iter().chain([&found.summary()]).for_each(check_message);
            }
            Err(error) => check_message(&error),
        }
    }
    tensile::read(bytes, Given::default()).is_ok()
}

/// Builds a curve from its parts; `true` if the curve is accepted.
pub(crate) fn check_spec(spec: &CurveSpec) -> bool {
    let read = Curve::new(spec);
    match &read {
        Ok(curve) => {
            check_curve(curve);
            let json = serde_json::to_string(spec).expect("JSON");
            let again: CurveSpec =
                serde_json::from_str(&json).expect("what was written can be read");
            assert_eq!(&again, spec);
            for (strain_scale, stress_scale) in [(0.05, 20.0), (20.0, 0.05), (0.7, 1.3)] {
                match Curve::scaled(&ScaledCurve { spec: spec.clone(), strain_scale, stress_scale })
                {
                    Ok(scaled) => check_curve(&scaled),
                    Err(error) => check_message(&SceneError::CurveFile(error)),
                }
            }
        }
        Err(error) => check_message(&SceneError::CurveFile(error.clone())),
    }
    read.is_ok()
}

/// A table: its text, form, rows and numbers. The rows in pieces are those of the whole.
pub(crate) fn check_table(bytes: &[u8]) {
    let text = match table::decode(bytes) {
        Ok(text) => text,
        Err(error) => return check_message(&error),
    };
    let table = match Table::read(&text) {
        Ok(table) => table,
        Err(error) => return check_message(&error),
    };
    let (form, text) = (table.form(), text.trim_start_matches('\u{feff}'));
    let mut pieces = Rows::new(BufReader::with_capacity(3, text.as_bytes()), form.separator());
    let mut others = std::iter::from_fn(|| pieces.next_row().expect("memory is read"))
        .skip(usize::from(form.has_separator_line))
        .filter(|row| !row.is_empty(form.separator()));
    let mut line = 0;
    for row in table.rows() {
        assert!(row.line > line && row.cells().len() <= table.columns());
        line = row.line;
        for (k, cell) in row.cells().enumerate() {
            match row.number(k, "a") {
                Ok(found) => {
                    assert!(found.value.is_finite() && cell.trim().ends_with(found.unit));
                    let again = Decimals::Point.read(&found.digits).map(|again| again.value);
                    assert!(again == Ok(found.value), "{cell:?}");
                }
                Err(error) => check_message(&error),
            }
        }
        let other = others.next().expect("as many rows");
        let text = String::from_utf8(other.bytes).expect("whole letters");
        let cells: Vec<_> = table::cells(&text, form.separator()).collect();
        assert!(
            other.line == row.line
                && cells.iter().map(|cell| &**cell).take(table.columns()).eq(row.cells())
        );
        assert!(cells.iter().skip(table.columns()).all(|cell| cell.trim().is_empty()));
    }
    assert!(others.next().is_none());
}

/// Scenes in a file: one scene, or one scene per line.
pub(crate) fn check_lines(bytes: &[u8]) {
    for format in [read::Format::Json, read::Format::JsonLines] {
        match read::scenes(bytes, format) {
            Ok(scenes) => {
                assert!(!scenes.is_empty());
                for scene in scenes {
                    check_scene(&Ok(scene.into_scene()));
                }
            }
            Err(error) => check_message(&error),
        }
    }
    if let Some(error) = std::str::from_utf8(bytes).ok().and_then(|text| read::texts(text).err()) {
        check_message(&error);
    }
}

/// Solves the first scene of a file if its tissue is layered; see [`check_layered_solve`].
pub(crate) fn check_first_solve(bytes: &[u8]) {
    if let Ok(scenes) = read::scenes(bytes, read::Format::JsonLines)
        && let Some(scene) = scenes.first()
    {
        check_layered_solve(scene.scene());
    }
}

/// Checks Ef(0) = 0, odd symmetry, increase and finiteness, and the energy between lower and upper sums.
pub(crate) fn check_curve(curve: &Curve) {
    assert!(curve.stress(0.0).abs() <= 0.0 && curve.energy(0.0).abs() <= 0.0);
    assert!(curve.data_end() > 0.0 && curve.line_start() >= curve.data_end());
    let mut strains: Vec<f64> = (0..=60).map(|k| 0.02 * f64::from(k) * curve.data_end()).collect();
    strains
        .extend(curve.breaks().take(200).flat_map(|b| [b * (1.0 - 1e-12), b, b * (1.0 + 1e-12)]));
    strains.extend([1e-12, 1e-6, 0.3, 1.0, 3.0, 9.9, 10.0, 11.0, 1e3, 1e6]);
    strains.sort_by(f64::total_cmp);
    // A piece is a sum, exact to rounding of the greatest term.
    let peak = curve.stress(curve.line_start());
    let (mut before, mut stress_before, mut energy_before) = (0.0, 0.0, 0.0);
    for &strain in &strains {
        let (stress, slope, energy) =
            (curve.stress(strain), curve.slope(strain), curve.energy(strain));
        assert!(stress.is_finite() && slope.is_finite() && energy.is_finite(), "at {strain}");
        assert!(curve.secant(strain).is_finite());
        let odd = [curve.stress(-strain) + stress, curve.energy(-strain) - energy];
        assert!(odd.iter().all(|difference| difference.abs() <= 0.0), "odd at {strain}");
        let noise = 1e-9 * stress.max(peak);
        assert!(stress >= stress_before - noise, "falls at {strain}: {stress_before} to {stress}");
        assert!(slope >= -noise / curve.data_end(), "slope {slope} at {strain}");
        let (step, rise) = (strain - before, energy - energy_before);
        // A break of a scaled curve is exact to rounding of the strain.
        let rounding = 4.0 * f64::EPSILON * strain * stress;
        let noise = noise * step + 1e-9 * energy.abs() + rounding;
        assert!(
            rise >= step * stress_before - noise && rise <= step * stress + noise,
            "energy at {strain}: {rise} over {step} between {stress_before} and {stress}"
        );
        (before, stress_before, energy_before) = (strain, stress, energy);
    }
}
