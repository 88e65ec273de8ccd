//! All numbers of the plan as a table: a row for each quantity, columns for the plan and for each pin, with percentiles
//! where bands are known.

use crate::app::answer::measured::Measured;
use crate::body::before_after as body;
use crate::export;
use crate::measure::{Outcome, Status};
use crate::scene::field::TORSO;
use crate::scene::{Field, Scene, Side};
use crate::session::Session;
use crate::study::{Quantity, Samples};
use std::rc::Rc;

/// The value of a row; `None` where a row does not apply.
type Value = Box<dyn Fn(&Scene, &Outcome) -> Option<f64>>;

/// A quantity with its unit, as a row.
struct Row {
    name: String,
    unit: &'static str,
    /// The quantity of a study with the same value.
    quantity: Option<Quantity>,
    value: Value,
}

impl Row {
    fn new(
        name: impl Into<String>,
        unit: &'static str,
        value: impl Fn(&Scene, &Outcome) -> Option<f64> + 'static,
    ) -> Self {
        Self { name: name.into(), unit, quantity: None, value: Box::new(value) }
    }

    /// The row of a number of the plan.
    fn of_plan(name: &str, number: Field) -> Self {
        Self::new(name, number.scale.unit, move |scene, _| number.shown(scene))
    }

    /// The row of a quantity of studies.
    fn of(quantity: Quantity) -> Self {
        let (factor, unit) = quantity.display();
        let unit = if unit == "cm²" { "cm2" } else { unit };
        let value = move |_: &Scene, outcome: &Outcome| Some(factor * quantity.of(outcome)?);
        Self { quantity: Some(quantity), ..Self::new(quantity.title(), unit, value) }
    }

    /// 10th and 90th percentile of a sampled scene, in the unit of the row.
    fn band(&self, samples: Option<&Samples>) -> [Option<f64>; 2] {
        let band = || {
            let quantity = self.quantity?;
            let [low, _, high] = samples?.band(quantity)?;
            Some([low, high].map(|value| Some(quantity.display().0 * value)))
        };
        band().unwrap_or_default()
    }
}

/// The rows of scenes with so many layers: the plan, then the results. Units are those of ASCII.
fn rows(layers: usize) -> Vec<Row> {
    let mut rows = vec![
        Row::of_plan("Width", Field::BaseRadius),
        Row::of_plan("Height of the base", Field::BaseHeight),
        Row::of_plan("Apex lower by", Field::ApexShift),
        Row::of_plan("Projection", Field::Projection),
        Row::new("Pocket margin", "cm", |scene, _| {
            Some(0.1 * (scene.pocket_radius_mm - scene.implant.greatest_half_axis_mm()))
        }),
        Row::of_plan("To the side", Field::CenterX),
        Row::of_plan("Up", Field::CenterY),
        Row::of_plan("In place", Field::Insertion),
        Row::of_plan("New fold lower", Field::PocketLowered),
        Row::of_plan("Fluid in the pocket, at most", Field::PocketVoid),
        Row::of_plan("Pinch", Field::Pinch),
        Row::of_plan("Radius of the chest across", Field::ChestAcross),
        Row::of_plan("Radius of the chest along", Field::ChestAlong),
    ];
    let by_rows = TORSO.into_iter().chain(Field::PLAIN);
    rows.extend(by_rows.map(|number| Row::of_plan(number.label, number)));
    for k in 0..layers {
        rows.push(Row::new(
            format!("Thickness at rest, layer {}", k + 1),
            "mm",
            move |scene, _| Some(scene.layers.get(k)?.thickness_mm),
        ));
    }
    rows.extend(Quantity::ALL.map(Row::of));
    rows.extend([
        Row::new("Skin stretched above 54 %", "%", |_, outcome| {
            Some(100.0 * outcome.strain.as_ref()?.fraction_above.get("0.54")?)
        }),
        Row::new("Skin wrinkled or slack", "%", |_, outcome| Some(100.0 * outcome.wrinkled?)),
        Row::new("Stretch at the apex", "x", |_, outcome| outcome.apex_stretch),
        Row::new("Skin area before", "cm2", |_, outcome| Some(outcome.area_before_cm2)),
        Row::new("Skin area after", "cm2", |_, outcome| outcome.area_after_cm2),
        Row::new("Skin gained beyond the pocket", "cm2", |_, outcome| {
            Some(outcome.skin_area?.gained_beyond_cm2())
        }),
        Row::new("Projection in the body", "mm", |_, outcome| outcome.projection_mm),
        Row::new("Half width in the body, across", "mm", |_, outcome| {
            Some(outcome.implant_in_body?.half_width_mm[0])
        }),
        Row::new("Half width in the body, along", "mm", |_, outcome| {
            Some(outcome.implant_in_body?.half_width_mm[1])
        }),
        Row::new("Modulus of the fill with its shell", "kPa", |_, outcome| {
            Some(outcome.implant_in_body?.modulus_kpa)
        }),
        Row::new("Contact angle", "degrees", |_, outcome| outcome.contact_angle_deg),
        Row::new("Contact radius, at rest", "mm", |_, outcome| outcome.contact_material_radius_mm),
    ]);
    for k in 0..layers {
        rows.push(Row::new(format!("Thinnest, layer {}", k + 1), "mm", move |_, outcome| {
            Some(outcome.layers.get(k)?.thickness_mm?.least)
        }));
        rows.push(Row::new(
            format!("Greatest stress, layer {}", k + 1),
            "kPa",
            move |_, outcome| outcome.layers.get(k)?.max_stress_kpa,
        ));
    }
    rows.push(Row::new("Error of positions, of half the width", "%", |_, outcome| {
        Some(100.0 * outcome.solver.estimated_position_error?)
    }));
    rows
}

/// A column of the table: a plan with its name and its result.
struct Column<'a> {
    name: String,
    scene: &'a Scene,
    outcome: Option<&'a Outcome>,
    samples: Option<&'a Samples>,
    /// The measures of her body.
    body: Option<Rc<[body::Row]>>,
}

/// The table, heads first. Each plan has a column, and two for percentiles if its bands are known; a missing value is empty.
pub(crate) fn table<'a>(
    (session, measured): (&'a Session, &Measured),
    sampled: &dyn Fn(&Scene) -> Option<&'a Samples>,
) -> Vec<Vec<String>> {
    let of =
        |name, scene, outcome, body| Column { name, scene, outcome, samples: sampled(scene), body };
    let pins = session.pins().iter().map(|pin| {
        let letter = pin.letter().to_string();
        let name = match pin.name() {
            "" => letter,
            name => format!("{letter}: {name}"),
        };
        of(name, pin.scene(), pin.outcome(), measured.of_pin(session, pin))
    });
    let body = measured.of_plan(session);
    let now = of("this plan".to_owned(), session.scene(), session.result(), body);
    let other = session.other_side().map(|other| {
        let name = format!("other side, {}", other.scene().side.map_or("", Side::word));
        of(name, other.scene(), other.outcome(), measured.of_other_side(session))
    });
    let columns: Vec<Column<'_>> = [now].into_iter().chain(other).chain(pins).collect();
    let mut head = vec!["quantity".to_owned(), "unit".to_owned()];
    let mut answers = vec!["Answer".to_owned(), String::new()];
    for Column { name, outcome, samples, .. } in &columns {
        head.push(name.clone());
        answers.push(answer(*outcome).to_owned());
        if samples.is_some() {
            head.extend([10, 90].map(|p| format!("{name}, percentile {p}")));
            answers.extend([String::new(), String::new()]);
        }
    }
    let layers = columns.iter().map(|column| column.scene.layers.len()).max().unwrap_or(0);
    let row = |row: Row| {
        let mut cells = vec![row.name.clone(), row.unit.to_owned()];
        for Column { scene, outcome, samples, .. } in &columns {
            let value = outcome.and_then(|outcome| (row.value)(scene, outcome));
            let band = row.band(*samples);
            let band = band.into_iter().filter(|_| samples.is_some());
            let values = [value].into_iter().chain(band);
            cells.extend(values.map(|value| value.map_or_else(String::new, export::number)));
        }
        cells
    };
    let rows = rows(layers).into_iter().map(row);
    [head, answers].into_iter().chain(rows).chain(of_body(&columns)).collect()
}

/// The rows of her body before and after: none without her body.
fn of_body(columns: &[Column<'_>]) -> Vec<Vec<String>> {
    let [Column { body: Some(rows), .. }, ..] = columns else { return Vec::new() };
    let mut found = Vec::new();
    for (k, body::Row { name, unit, before, .. }) in rows.iter().enumerate() {
        let mut add = |name: String, value: fn(&body::Row) -> Option<f64>| {
            let mut cells = vec![name, (*unit).to_owned()];
            for Column { body, samples, .. } in columns {
                let value = body.as_ref().and_then(|rows| value(rows.get(k)?));
                cells.push(value.map_or_else(String::new, export::number));
                cells.extend(samples.iter().flat_map(|_| [String::new(), String::new()]));
            }
            found.push(cells);
        };
        match before {
            Some(_) => {
                add(format!("{name}, before"), |row| row.before);
                add(format!("{name}, after"), |row| row.after);
            }
            None => add((*name).to_owned(), |row| row.gain),
        }
    }
    found
}

/// State of an answer in a word.
fn answer(outcome: Option<&Outcome>) -> &'static str {
    match outcome.map(|outcome| outcome.status) {
        None => "being computed",
        Some(Status::Converged) => "converged",
        Some(Status::NotConverged) => "not converged",
        Some(Status::Unstable) => "no answer",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::answer::measured::tests::solved;
    use crate::scene::Letter;
    use crate::session::Command;
    use crate::solve::Progress;

    #[test]
    fn the_table_has_all_numbers_of_plan_and_pins() {
        let mut scene = Scene::opening();
        (scene.solver.nodes_per_side, scene.solver.tolerance) = (33, 1e-3);
        let mut session = Session::new(scene.clone()).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let pinned = session.result().unwrap().clone();
        session.apply(Command::Pin).unwrap();
        session.apply(Command::Rename(Letter::A, "a, \"b\"".to_owned())).unwrap();
        scene.implant.projection_mm += 2.0;
        session.apply(Command::Edit { scene: Box::new(scene), gesture: 1 }).unwrap();
        while session.advance(&mut || false) == Progress::Working {}
        let now = session.result().unwrap();

        let text = export::csv(&table((&session, &Measured::default()), &|_| None));
        let mut read = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
        let read: Vec<Vec<String>> = read.deserialize().map(Result::unwrap).collect();
        assert_eq!(read[0], ["quantity", "unit", "this plan", "A: a, \"b\""]);
        assert_eq!(read[1], ["Answer", "", "converged", "converged"]);
        let values = |name: &str, unit: &str| -> [f64; 2] {
            let mut found = read.iter().filter(|row| row[..2] == [name, unit]);
            let row = found.next().unwrap_or_else(|| panic!("{name}"));
            assert!(found.next().is_none(), "{name} twice");
            [&row[2], &row[3]].map(|cell| cell.parse().unwrap())
        };
        for (name, unit, of) in [
            (
                "Skin stretch",
                "%",
                (|o| 100.0 * o.strain.as_ref().unwrap().max_principal) as fn(&Outcome) -> f64,
            ),
            ("Volume", "ml", |o| o.implant_volume_ml),
            ("Pressure, greatest", "mmHg", |o| o.contact_pressure_mmhg.unwrap().max),
            ("Pressure, greatest", "kPa", |o| o.contact_pressure_kpa.unwrap().max),
            ("Least cover", "mm", |o| o.cover_mm.unwrap().least),
            ("Skin area gained", "cm2", |o| o.area_gain_cm2.unwrap()),
            ("Greatest stress, layer 2", "kPa", |o| o.layers[1].max_stress_kpa.unwrap()),
        ] {
            for (read, outcome) in values(name, unit).into_iter().zip([now, &pinned]) {
                assert!((read / of(outcome) - 1.0).abs() < 1e-8, "{name}: {read}");
            }
        }
        assert!(values("Fullness", "").iter().all(|value| (value - 2.0 / 3.0).abs() < 1e-8));
        assert!(read.iter().all(|row| row.len() == 4 && row.iter().all(|cell| cell.is_ascii())));
    }
    #[test]
    fn her_body_is_in_the_table_before_and_after() {
        let (mut session, measured) = (solved(), Measured::default());
        session.apply(Command::Pin).unwrap();
        let rows = measured.of_plan(&session).unwrap();
        let found = table((&session, &measured), &|_| None);
        let names = found.iter().filter(|row| row[0].starts_with("Notch to nipple, "));
        assert_eq!(names.count(), 4);
        for row in rows.iter() {
            let cells = |name: String| {
                let of = |cells: &&Vec<String>| cells[..2] == [name.clone(), row.unit.to_owned()];
                let mut of = found.iter().filter(of);
                let cells = of.next().unwrap_or_else(|| panic!("{name}")).clone();
                assert!(of.next().is_none() && cells.iter().all(|cell| cell.is_ascii()), "{name}");
                // The pin has the same shape.
                assert_eq!(cells[2], cells[3], "{name}");
                cells[2].parse::<f64>().ok()
            };
            let near = |a: Option<f64>, b: Option<f64>| {
                let Some((a, b)) = a.zip(b) else { return a == b };
                (a - b).abs() <= 1e-8 * b.abs()
            };
            match row.before {
                Some(_) => {
                    assert!(near(cells(format!("{}, before", row.name)), row.before), "{row:?}");
                    assert!(near(cells(format!("{}, after", row.name)), row.after), "{row:?}");
                }
                None => assert!(near(cells(row.name.to_owned()), row.gain), "{row:?}"),
            }
        }
    }
}
