//! Tables of sizes as makers write them, in five locales (`tests/fixtures/shelf`, made for these tests).

use implant_preview::clinical::{Column, Draft, LengthUnit, Reading, Shelf, ShelfSize, UnitOrigin};
use implant_preview::scene::Scene;
use std::f64::consts::PI;

/// Reference, width, height, projection, volume \[mm, ml\]; a height of 0 is that of a round base.
type Row = (&'static str, f64, f64, f64, f64);

fn draft(bytes: &[u8]) -> Draft {
    Draft::of(&Draft::text_of(bytes).expect("a text")).expect("a table")
}

/// The rows of a table and the lines that are left out, without a question.
fn check(bytes: &[u8], rows: &[Row], skipped: &[usize], ignored: &[&str]) -> Draft {
    let draft = draft(bytes);
    assert_eq!(draft.missing(), None);
    let names = draft.columns().iter().filter(|column| column.column == Column::Ignored);
    assert_eq!(names.map(|column| column.title.as_str()).collect::<Vec<_>>(), ignored);
    let Reading { shelf, skipped: left, skipped_rows } = draft.read();
    assert_eq!(left.iter().map(|row| row.line).collect::<Vec<_>>(), skipped, "{left:?}");
    assert_eq!(skipped_rows, skipped.len());
    assert_eq!(shelf.sizes().len(), rows.len());
    for (size, (name, width, height, projection, volume)) in shelf.sizes().iter().zip(rows) {
        assert_eq!((size.name(), size.width_mm()), (*name, *width));
        assert_eq!(size.listed_projection_mm(), Some(*projection), "{name}");
        assert_eq!(size.listed_volume_ml(), Some(*volume), "{name}");
        assert_eq!(size.label(), format!("{name} · {volume} cc"));
        let height = if *height > 0.0 { *height } else { *width };
        assert!((size.size().base_height_mm() - height).abs() < 1e-9, "{name}");
        // The dome has the maker's volume: f π a b p.
        let dome = size.size();
        let own = dome.fullness() * PI * 0.25 * width * height * projection / 1000.0;
        assert!((own - volume).abs() < 1e-9 && size.note().is_none(), "{name}: {own}");
        check_in_a_scene(size);
    }
    assert_eq!(Shelf::from_csv(&shelf.to_csv()).as_ref(), Ok(&shelf));
    draft
}

/// Checks that a scene holds the size with its name.
fn check_in_a_scene(size: &ShelfSize) {
    let mut scene = Scene::opening();
    let dome = size.size();
    scene.implant.set_base_radius(0.5 * dome.base_width_mm());
    scene.implant.projection_mm = dome.projection_mm();
    scene.implant.base_height_mm = Some(dome.base_height_mm());
    scene.implant.fullness = Some(dome.fullness());
    size.label().clone_into(&mut scene.implant_reference);
    scene.set_pocket_radius(scene.implant.least_pocket_mm() + 10.0);
    let text = serde_json::to_string(&scene).expect("JSON");
    let read = Scene::from_json(&text).expect("a scene");
    assert_eq!(read.implant_reference, size.label());
    let volume = read.implant.size().expect("a size").volume_ml();
    assert!((volume - size.volume_ml()).abs() < 1e-9, "{}: {volume}", size.label());
}

#[test]
fn a_table_of_prices_below_a_title_line() {
    let rows = [
        ("SR-200M", 110.0, 0.0, 32.0, 200.0),
        ("SR-250M", 117.0, 0.0, 34.0, 250.0),
        ("SR-300M", 125.0, 0.0, 36.0, 300.0),
        ("SR-275H", 110.0, 0.0, 42.0, 275.0),
        ("SR-325H", 116.0, 0.0, 45.0, 325.0),
    ];
    let bytes = include_bytes!("fixtures/shelf/en-title.csv");
    check(bytes, &rows, &[1, 4, 8, 12], &["Style", "List price"]);
}

#[test]
fn a_table_with_decimal_commas_keeps_the_volume_of_its_maker() {
    let rows = [
        ("MM-200", 110.0, 0.0, 35.0, 200.0),
        ("MM-240", 115.0, 0.0, 39.0, 240.0),
        ("MM-280", 122.0, 0.0, 41.0, 280.0),
        ("RD-275", 120.0, 0.0, 37.0, 275.0),
    ];
    check(include_bytes!("fixtures/shelf/es-comas.csv"), &rows, &[], &["Perfil"]);
}

#[test]
fn a_table_in_utf_16_with_units_in_its_cells() {
    let rows = [
        ("45-150", 95.0, 0.0, 34.0, 150.0),
        ("45-215", 107.5, 0.0, 38.0, 215.0),
        ("45-305", 120.0, 0.0, 42.5, 305.0),
        ("45-390", 130.0, 0.0, 47.0, 390.0),
    ];
    let bytes = include_bytes!("fixtures/shelf/de-unicode.txt");
    let draft = check(bytes, &rows, &[], &["Oberfläche"]);
    assert_eq!(draft.columns()[2].origin, UnitOrigin::Cells);
}

#[test]
fn an_anatomical_table_with_a_row_of_units() {
    let rows = [
        ("AN-240", 115.0, 105.0, 42.5, 240.0),
        ("AN-290", 120.0, 110.5, 45.0, 290.0),
        ("AN-335", 125.0, 115.0, 48.5, 335.0),
    ];
    let bytes = include_bytes!("fixtures/shelf/fr-anatomique.csv");
    let draft = check(bytes, &rows, &[6, 7], &["Stérilisation", "Prix €"]);
    assert_eq!(draft.read().skipped[0].reason, "the volume is \"NC\"; allowed: a number, as 12.5");
}

#[test]
fn a_table_of_diameters_in_windows_1252_without_units() {
    let rows = [
        ("R-175", 98.0, 0.0, 35.0, 175.0),
        ("R-225", 106.0, 0.0, 38.0, 225.0),
        ("R-305", 117.0, 0.0, 42.0, 305.0),
    ];
    let draft = check(include_bytes!("fixtures/shelf/pt-diametro.csv"), &rows, &[5], &[]);
    let lengths = draft.columns().iter().filter(|column| column.column.is_length());
    let read: Vec<_> = lengths.map(|column| (column.column, column.unit, column.origin)).collect();
    let guessed = |column| (column, LengthUnit::Mm, UnitOrigin::Guessed);
    assert_eq!(read, [guessed(Column::Width), guessed(Column::Projection)]);
    assert_eq!(draft.columns()[0].title, "Código");
}

#[test]
fn the_signs_of_windows_1252_are_read() {
    let bytes = b"Name;Width (cm);Volume (cc)\n\x84H\xf6he\x93 \x96 \x80\x99;12;300\n";
    let shelf = Draft::of(&Draft::text_of(bytes).unwrap()).unwrap().read().shelf;
    assert!(shelf.sizes()[0].label().starts_with("„Höhe“ – €™"), "{:?}", shelf.sizes());
}
