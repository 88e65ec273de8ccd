//! Properties of any input, shared by the property tests and the fuzz targets.

use implant_preview::body::before_after::Before;
use implant_preview::body::marks::Side;
use implant_preview::body::torso::builtin;
use implant_preview::clinical::{
    Column, Draft, LengthUnit, MAX_SIZES, Measurements, PracticeTable, Reading, Shelf,
};
use implant_preview::curve::{Curve, CurveSpec, Fat, Interpolation, ScaledCurve, Section};
use implant_preview::measure::{Fields, surfaces};
use implant_preview::scene::{Scene, SceneError, read};
use implant_preview::simulate;
use implant_preview::solve::{Progress, Solution, Solver, Verdict};
use implant_preview::table::{self, Decimals, Rows, Table};
use implant_preview::tensile::{self, Given, StrainUnit, StressUnit};
use serde_json::{Value, json};
use std::collections::HashSet;
use std::io::BufReader;
use std::sync::Arc;

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

/// A source of choices from bytes, common to fuzz targets and property tests; zeros follow the last byte.
pub(crate) struct Choices<'a>(pub(crate) &'a [u8]);

impl Choices<'_> {
    fn byte(&mut self) -> u8 {
        match self.0 {
            [first, rest @ ..] => {
                self.0 = rest;
                *first
            }
            [] => 0,
        }
    }

    fn below(&mut self, count: u8) -> u8 {
        self.byte() % count
    }

    fn share(&mut self) -> f64 {
        f64::from(u16::from_le_bytes([self.byte(), self.byte()])) / 65535.0
    }

    /// A number: mostly in the range, sometimes an end of the range, sometimes arbitrary.
    pub(crate) fn number(&mut self, least: f64, most: f64) -> f64 {
        const ODD: [f64; 12] = [
            0.0,
            -0.0,
            -1.0,
            1e9,
            1e308,
            -1e308,
            5e-324,
            1e-300,
            f64::MAX,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
        ];
        match self.byte() {
            0..=199 => least + (most - least) * self.share(),
            200..=214 => least,
            215..=229 => most,
            230..=239 => most + (most - least) * self.share(),
            240..=246 => ODD[usize::from(self.below(12))],
            247..=251 => 10.0_f64.powf(24.0 * self.share() - 12.0),
            _ => f64::from_bits(u64::from_le_bytes([0; 8].map(|_: u8| self.byte()))),
        }
    }

    /// A positive number of any order of magnitude in the range; sometimes arbitrary.
    fn magnitude(&mut self, least: f64, most: f64) -> f64 {
        if self.byte() < 240 {
            least * (most / least).powf(self.share())
        } else {
            self.number(least, most)
        }
    }

    /// A curve of any kind.
    pub(crate) fn curve(&mut self) -> CurveSpec {
        match self.below(8) {
            0 => CurveSpec::Skin {},
            1 if self.byte() < 128 => CurveSpec::Adipose {},
            1 => CurveSpec::Fat { variant: Fat::ALL[usize::from(self.below(3))] },
            2 => CurveSpec::Linear { modulus_kpa: self.magnitude(1e-6, 1e7) },
            3 => CurveSpec::Arctangent {
                scale_kpa: self.magnitude(1e-6, 1e7),
                rate: self.magnitude(1e-3, 100.0),
            },
            4 => CurveSpec::Exponential {
                scale_kpa: self.magnitude(1e-6, 1e6),
                rate: self.magnitude(1e-3, 100.0),
            },
            5 | 6 => {
                let interpolation =
                    [Interpolation::Line, Interpolation::Spline][usize::from(self.below(2))];
                CurveSpec::Points { points: self.points(), interpolation }
            }
            _ => CurveSpec::Sections { sections: self.sections() },
        }
    }

    /// Points from [0, 0] in steps of any size, including near-vertical steps and plateaus.
    fn points(&mut self) -> Vec<[f64; 2]> {
        let mut points = vec![[0.0, 0.0]];
        for _ in 0..self.below(12) {
            let [strain, stress] = points[points.len() - 1];
            let step = [self.magnitude(1e-10, 0.5), self.magnitude(1e-9, 1e3)];
            points.push([strain + step[0], stress + step[1]]);
        }
        if self.byte() == 255 {
            let k = usize::from(self.byte()) % points.len();
            points[k][usize::from(self.below(2))] = self.number(0.0, 1.0);
        }
        points
    }

    fn sections(&mut self) -> Vec<Section> {
        let mut sections = Vec::new();
        let mut end = 0.0;
        for _ in 0..self.below(6) {
            let from = if self.byte() < 250 { end } else { self.number(0.0, 1.0) };
            let to = from + self.magnitude(1e-8, 0.5);
            end = to;
            sections.push(match self.below(6) {
                0 => Section::Linear { from, to, modulus_kpa: self.magnitude(1e-6, 1e7) },
                1 => Section::Cubic {
                    from,
                    to,
                    end_stress_kpa: self.magnitude(1e-6, 1e7),
                    end_slope_kpa: self.magnitude(1e-6, 1e9),
                },
                2 => {
                    let count = self.below(9);
                    let term = |c: &mut Self| {
                        let size = c.magnitude(1e-6, 1e6);
                        if c.byte() < 200 { size } else { -size }
                    };
                    let coefficients_kpa = (0..count).map(|_| term(self)).collect();
                    Section::Polynomial { from, to, coefficients_kpa }
                }
                kind => {
                    let (scale_kpa, rate) =
                        (self.magnitude(1e-6, 1e4), self.magnitude(1e-3, 100.0));
                    match kind {
                        3 => Section::Arctangent { from, to, scale_kpa, rate },
                        4 => Section::Sine { from, to, scale_kpa, rate },
                        _ => Section::Exponential { from, to, scale_kpa, rate },
                    }
                }
            });
        }
        sections
    }

    /// Measurements of a person, some of them inconsistent.
    fn patient(&mut self) -> Value {
        const CLASSES: [&str; 5] = ["tight", "normal", "lax", "very_lax", "jelly"];
        let mut patient = json!({ "pinch_mm": self.number(4.0, 120.0) });
        if self.below(2) == 1 {
            patient["base_width_mm"] = json!(self.number(60.0, 240.0));
        }
        match self.below(3) {
            0 => patient["skin_pull_mm"] = json!(self.number(5.0, 80.0)),
            1 => patient["skin_class"] = json!(CLASSES[usize::from(self.below(5))]),
            _ => {}
        }
        if self.below(3) == 1 {
            let path = format!("layers[{}].thickness_mm", self.below(10));
            patient["derived"] = json!([path, "layers[0].curve.strain_scale"]);
        }
        patient
    }

    /// A scene with all fields, as JSON text.
    pub(crate) fn scene(&mut self) -> String {
        const TISSUES: [&str; 7] = ["skin", "adipose", "", "Kapsel", "\u{1b}[2J", "\n", "💧"];
        const SPRINGS: [&str; 3] = ["coupled", "coupled", "nikolaev"];
        let radius = self.number(10.0, 120.0);
        let center = [self.number(-20.0, 20.0), self.number(-20.0, 20.0)];
        let least = radius + center[0].hypot(center[1]);
        let layers: Vec<Value> = (0..=self.below(9))
            .map(|_| {
                let tissue = usize::from(self.below(7));
                let mut curve = json!(self.curve());
                if self.below(4) == 1 {
                    curve["strain_scale"] = json!(self.magnitude(0.05, 20.0));
                    curve["stress_scale"] = json!(self.number(0.05, 20.0));
                }
                json!({
                    "tissue": TISSUES[tissue],
                    "thickness_mm": self.number(0.2, 60.0),
                    "poisson_ratio": self.number(0.0, 0.5),
                    "curve": curve,
                })
            })
            .collect();
        let springs = usize::from(self.below(3));
        let mut scene = json!({
            "implant": { "base_radius_mm": radius, "projection_mm": self.number(2.0, 120.0),
                "center_mm": center },
            "pocket_radius_mm": self.number(least, 200.0),
            "insertion": self.number(0.0, 1.0),
            "layers": layers,
            "springs": SPRINGS[springs],
            "solver": { "nodes_per_side": 17 + usize::from(self.byte()),
                "tolerance": self.magnitude(1e-7, 1e-2) },
        });
        match self.byte() {
            255 => {}
            254 => scene["schema"] = json!("implant-preview/scene/1"),
            _ => scene["tissue_model"] = json!("sheet"),
        }
        if self.below(4) == 1 {
            scene["patient"] = self.patient();
        }
        scene.to_string()
    }

    /// A scene with all fields, mostly of layered tissue, as JSON text.
    pub(crate) fn layered_scene(&mut self) -> String {
        const MODELS: [&str; 4] = ["layered", "layered", "layered", "sheet"];
        let model = MODELS[usize::from(self.below(4))];
        let attachment = json!({ "stiffness_kpa_per_mm": self.magnitude(0.1, 50.0),
            "ramp_mm": self.number(1.0, 40.0) });
        let margin = self.number(20.0, 60.0);
        let cells = match self.byte() {
            0..=99 => json!("auto"),
            100..=239 => json!(1 + self.below(8)),
            240..=247 => json!([0, 9, 255, 65_535][usize::from(self.below(4))]),
            _ => json!(self.number(1.0, 8.0)),
        };
        let keeps_springs = self.byte() >= 240;
        let mut scene: Value = serde_json::from_str(&self.scene()).expect("written above");
        let pocket = scene["pocket_radius_mm"].as_f64().unwrap_or(100.0);
        scene["tissue_model"] = json!(model);
        scene["patch_radius_mm"] = json!(pocket + margin);
        scene["attachment"] = attachment;
        scene["solver"]["cells_through"] = cells;
        if !keeps_springs {
            scene["springs"] = json!("coupled");
        }
        scene.to_string()
    }

    /// A scene with a chest, mostly of radii that its patch allows, as JSON text.
    pub(crate) fn chest_scene(&mut self) -> String {
        let sign = |c: &mut Self| if c.byte() < 192 { 1.0 } else { -1.0 };
        let across = sign(self) * self.number(100.0, 400.0);
        let along = (self.byte() < 128).then(|| sign(self) * self.number(100.0, 2000.0));
        let mut scene: Value = serde_json::from_str(&self.layered_scene()).expect("written above");
        scene["chest"] = json!({ "radius_across_mm": across, "radius_along_mm": along });
        scene.to_string()
    }

    /// A scene with an anatomical implant, a scan of the chest and a thickness field, any of them absent, as JSON text.
    pub(crate) fn scanned_scene(&mut self) -> String {
        // Heights without data from a corner on, or nothing but gaps: the first choice, of which every input has one.
        let gaps = self.byte();
        let mut scene: Value = serde_json::from_str(&self.layered_scene()).expect("written above");
        if self.byte() < 128 {
            scene["implant"]["base_height_mm"] = json!(self.number(40.0, 160.0));
            scene["implant"]["apex_shift_mm"] = json!(self.number(-20.0, 20.0));
        }
        let count = 7 + usize::from(self.byte() % 4);
        let grid = |c: &mut Self, name: &str, least: f64, most: f64| {
            let numbers: Vec<f64> = (0..count * count).map(|_| c.number(least, most)).collect();
            json!({ "spacing_mm": c.number(45.0, 50.0), "columns": count, "rows": count, name: numbers })
        };
        if self.byte() < 128 {
            let mut heights = grid(self, "heights_mm", -9.0, 9.0);
            let list = heights["heights_mm"].as_array_mut().into_iter().flatten().enumerate();
            for (_, height) in list.filter(|(k, _)| gaps == 255 || *k < usize::from(gaps / 16)) {
                *height = Value::Null;
            }
            scene["chest"] = json!({ "grid": heights });
        }
        if self.byte() < 128 {
            scene["thickness_field"] = grid(self, "factors", 0.6, 2.0);
        }
        scene.to_string()
    }
}
