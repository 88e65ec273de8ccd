use super::*;

type Listed<'a> = (&'a str, f64, Option<f64>, Option<f64>, Option<f64>);

/// Name, width, height of an anatomical base, projection and volume of all sizes, as listed.
fn listed(shelf: &Shelf) -> Vec<Listed<'_>> {
    let height = |size: &ShelfSize| (!size.is_round()).then(|| size.size().base_height_mm());
    shelf
        .sizes()
        .iter()
        .map(|s| {
            (s.name(), s.width_mm(), height(s), s.listed_projection_mm(), s.listed_volume_ml())
        })
        .collect()
}

#[test]
fn tables_of_all_forms_have_the_same_sizes() {
    let expected =
        Shelf::from_csv("name,width_mm,volume_ml\nRound 300,123,300\nHigh,115,280").unwrap();
    assert_eq!(
        listed(&expected),
        [("Round 300", 123.0, None, None, Some(300.0)), ("High", 115.0, None, None, Some(280.0))]
    );
    for text in [
        "Name;Width (cm);Volume (cc)\nRound 300;12,3;300\nHigh;11.5;280\n",
        "\u{feff}volume\tprice\twidth_cm\tname\r\n300\t9\t12.3\tRound 300\r\n\r\n280\t\t11,5\tHigh\r\n",
        "ml,\"Base width [mm]\",Size\r300,\"123,0\",Round 300\r280,115,High\r",
        "Modell;Basisbreite;Volumen\nRound 300;12,3 cm;300 ml\nHigh;115 mm;280 cm³\n;;\n",
        "Nombre;Anchura;Vol.\n;cm;cc\nRound 300;12,3;300\nHigh;11,5;280\n",
        "sep=;\nProduct;W;V (cc)\nRound 300;12,3*;300\nHigh;11,5;280 †\n",
    ] {
        assert_eq!(Shelf::from_csv(text).as_ref(), Ok(&expected), "{text:?}");
    }
}

#[test]
fn a_table_of_a_clinic_keeps_volume_and_projection_of_its_maker() {
    let text =
        "Reference;Width (cm);Projection (cm);Volume (cc)\nMM-240;11,5;3,9;240\nRD-275;12;3,7;275";
    let shelf = Shelf::from_csv(text).unwrap();
    let [small, round] = shelf.sizes() else { panic!("{shelf:?}") };
    assert_eq!((small.name(), small.label()), ("MM-240", "MM-240 · 240 cc"));
    assert_eq!((round.label(), round.volume_ml()), ("RD-275 · 275 cc", 275.0));
    for (size, [width, projection, volume]) in
        [(small, [115.0, 39.0, 240.0]), (round, [120.0, 37.0, 275.0])]
    {
        let dome = size.size();
        assert_eq!((dome.base_width_mm(), dome.projection_mm()), (width, projection));
        assert!((dome.volume_ml() - volume).abs() < 1e-9, "{dome:?}");
        // Volume by π r² p.
        let cylinder = std::f64::consts::PI * (0.5 * width).powi(2) * projection / 1000.0;
        assert!((dome.fullness() - volume / cylinder).abs() < 1e-12);
        assert_eq!(size.note(), None);
    }
}

#[test]
fn a_volume_that_no_dome_has_is_kept_beside_the_nearest_dome() {
    let text = "ref;width_cm;projection_cm;volume_cc\nflat;12;4;200\nfull;12;4;400";
    let shelf = Shelf::from_csv(text).unwrap();
    let [flat, full] = shelf.sizes() else { panic!("{shelf:?}") };
    // Cylinder of 12 × 4 cm: 452.4 ml.
    assert_eq!((flat.size().fullness(), full.size().fullness()), (0.55, 0.8));
    assert_eq!((flat.label(), full.label()), ("flat · 200 cc", "full · 400 cc"));
    assert_eq!(
        flat.note().unwrap(),
        "the listed 200 ml need a fullness of 0.44; allowed: 0.55 to 0.8; the shape shown has 249 ml"
    );
    assert!(full.note().unwrap().contains("400 ml need a fullness of 0.88"));
    assert_eq!(Shelf::from_csv(&shelf.to_csv()).as_ref(), Ok(&shelf));
}

#[test]
fn height_is_that_of_a_base_and_of_a_round_implant_its_projection() {
    let text = "Ref;Width;Height;Projection;Volume (cc)\nA;12;10,8;4,1;240\nB;12;12;4,1;300";
    let shelf = Shelf::from_csv(text).unwrap();
    assert_eq!(
        listed(&shelf),
        [
            ("A", 120.0, Some(108.0), Some(41.0), Some(240.0)),
            ("B", 120.0, None, Some(41.0), Some(300.0))
        ]
    );
    assert!((shelf.sizes()[0].size().volume_ml() - 240.0).abs() < 1e-9);
    assert_eq!(Shelf::from_csv(&shelf.to_csv()).as_ref(), Ok(&shelf));
    let round = Shelf::from_csv("Artikel;Ø (mm);Höhe (mm);Volumen\nA;120;41;300").unwrap();
    assert_eq!(listed(&round), [("A", 120.0, None, Some(41.0), Some(300.0))]);
    let both = Shelf::from_csv("Ref;Diameter;Height;Projection\nA;120;118;41").unwrap();
    assert_eq!(listed(&both), [("A", 120.0, None, Some(41.0), None)]);
    // Without a projection the volume gives it, on the oval base.
    let volume = Shelf::from_csv("Ref;Width;Height;Volume\nA;12;10.8;240").unwrap();
    let size = volume.sizes()[0].size();
    assert_eq!((size.aspect(), volume.sizes()[0].listed_projection_mm()), (0.9, None));
    assert!((size.volume_ml() - 240.0).abs() < 1e-9);
}

#[test]
fn titles_units_by_size_notes_and_repetitions_are_told() {
    let text = "Round implants 2026;;;;\n;;;;\nCat. No.;Price;Base;Proj.;cc\nModerate;;;;\nA-1;99;105;36;200\nA-2;99;110;x;225\n\
        A-1;99;105;36;200\nA-1;99;110;38;230\n;;115;39;\n* nominal volumes;;;;\n";
    let draft = Draft::of(text).unwrap();
    let columns: Vec<_> = draft.columns().iter().map(|c| (c.title.as_str(), c.column)).collect();
    assert_eq!(
        columns,
        [
            ("Cat. No.", Column::Name),
            ("Price", Column::Ignored),
            ("Base", Column::Width),
            ("Proj.", Column::Projection),
            ("cc", Column::Volume)
        ]
    );
    let width = &draft.columns()[2];
    assert_eq!((width.unit, width.origin), (LengthUnit::Mm, UnitOrigin::Guessed));
    assert_eq!(width.sample, "105, 110");
    let reading = draft.read();
    let labels: Vec<&str> = reading.shelf.sizes().iter().map(ShelfSize::label).collect();
    assert_eq!(labels, ["A-1 · 200 cc", "A-1 · 230 cc", "11.5 × 3.9 cm"]);
    let skipped: Vec<_> = reading.skipped.iter().map(|s| (s.line, s.reason.as_str())).collect();
    assert_eq!(
        skipped,
        [
            (1, "above the names of the columns"),
            (4, "no number in the columns of a size"),
            (6, "the projection is \"x\"; allowed: a number, as 12.5"),
            (7, "the size of line 5 again"),
            (10, "no number in the columns of a size")
        ]
    );
    assert_eq!(reading.skipped_rows, 5);
}

#[test]
fn columns_of_unknown_names_are_chosen() {
    let text = "Kode;Bredde;Fylde\nA;12,5;300\nB;13;350";
    assert_eq!(Shelf::from_csv(text).unwrap_err(), draft_error(text));
    let mut draft = Draft::of(text).unwrap();
    draft.choose(0, Column::Name);
    draft.choose(1, Column::Width);
    assert!(draft.missing().unwrap().starts_with("no column is the projection or the volume"));
    draft.choose(2, Column::Volume);
    assert_eq!(draft.missing(), None);
    assert_eq!(draft.columns()[1].unit, LengthUnit::Cm);
    let shelf = draft.read().shelf;
    assert_eq!(
        listed(&shelf),
        [("A", 125.0, None, None, Some(300.0)), ("B", 130.0, None, None, Some(350.0))]
    );
    // Another unit leaves no row; another content takes it from the column that had it.
    draft.choose_unit(1, LengthUnit::Mm);
    let reading = draft.read();
    assert_eq!((reading.shelf.sizes().len(), reading.skipped_rows), (0, 2));
    draft.choose(1, Column::Volume);
    assert_eq!(draft.columns()[2].column, Column::Ignored);
    assert!(draft.missing().unwrap().starts_with("no column is the width"));
}

fn draft_error(text: &str) -> String {
    Draft::of(text).unwrap().missing().unwrap().to_owned()
}

#[test]
fn a_shelf_is_the_same_after_its_own_table() {
    let text = "name;width_cm;projection_cm;volume_ml\n\"A; \"\"flat\"\"\";12,3;3,7;\nB;11.1;;287.5\nC;10;3;157";
    let shelf = Shelf::from_csv(text).unwrap();
    assert_eq!(Shelf::from_csv(&shelf.to_csv()), Ok(shelf.clone()));
    assert_eq!(
        listed(&shelf),
        [
            ("A; \"flat\"", 123.0, None, Some(37.0), None),
            ("B", 111.0, None, None, Some(287.5)),
            ("C", 100.0, None, Some(30.0), Some(157.0))
        ]
    );
    let mut fewer = shelf.clone();
    fewer.remove(0);
    fewer.remove(7);
    assert_eq!((fewer.sizes(), Shelf::default().to_csv()), (&shelf.sizes()[1..], String::new()));
    // Three digits behind the point are no thousands; names may be numbers.
    let shelf = Shelf::from_csv("name;width_cm;volume_ml\n350;12.3456;287.1251\n").unwrap();
    assert_eq!(Shelf::from_csv(&shelf.to_csv()), Ok(shelf));
}

#[test]
fn errors_have_the_line_and_what_is_allowed() {
    let head = "name;width_cm;volume_ml\n";
    for (text, error) in [
        (String::new(), "the table is empty; allowed: names of columns and a row for each size"),
        (
            "name\nA".to_owned(),
            "no column is the width; allowed: one column of widths or diameters",
        ),
        ("name;width_mm;price\nA;1;2".to_owned(), "no column is the projection or the volume; "),
        ("width_mm;volume".to_owned(), "no row is a size; allowed: "),
        (head.to_owned(), "no row is a size; allowed: a width with a projection or a volume"),
        (
            format!("{head}A;12;300\n\nB;x;3"),
            "line 4: the width is \"x\"; allowed: a number, as 12.5",
        ),
        (format!("{head}A;12;NaN"), "line 2: the volume is \"NaN\"; allowed: a number, as 12.5"),
        (format!("{head}A;25;300"), "line 2: the width is “25”; allowed: a number from 2 to 24 cm"),
        (format!("{head}A;;300"), "line 2: the row has no width; allowed: a width"),
        (format!("{head}A;12;0"), "line 2: the volume is 0 ml; allowed: "),
        (format!("{head}A;12;"), "line 2: the volume is 0 ml; allowed: "),
        (format!("{head}A;12 in;300"), "line 2: the width is “12 in”; allowed units: mm, cm"),
        (format!("{head}A;12;300 g"), "line 2: the volume is “300 g”; allowed units: ml, cc, cm³"),
        (format!("{head}A;12;300\nA;12;300"), "line 3: the size of line 2 again"),
        (
            format!("{head}A;12;3000"),
            "line 2: 3000 ml on a base of 120 mm gives a projection of 398 mm; allowed: 2 to 120 mm",
        ),
        (
            "ref;width_cm;height_cm;volume_cc\nA;12;30;300".to_owned(),
            "line 2: the height is “30”; allowed: a number from 6 to 24 cm",
        ),
        (format!("{head}\"A;12;300"), "line 2: a quotation mark is not closed"),
    ] {
        let found = Shelf::from_csv(&text).unwrap_err();
        assert!(found.starts_with(error), "{text:?}: {found}");
        assert_eq!(found.lines().count(), 1);
    }
    let rows = |count| (0..count).map(|k| format!("{k};12;300\n")).collect::<String>();
    assert!(Shelf::from_csv(&format!("{head}{}", rows(500))).is_ok());
    let error = Shelf::from_csv(&format!("{head}{}", rows(501))).unwrap_err();
    assert_eq!(error, "line 502: more sizes; allowed: up to 500");
    // The rows beyond are counted, the first hundred listed.
    let reading = Draft::of(&format!("{head}{}", rows(700))).unwrap().read();
    assert_eq!((reading.skipped_rows, reading.skipped.len()), (200, 100));
}

#[test]
fn names_are_one_line_of_a_length_that_a_scene_allows() {
    let long = "x".repeat(70);
    let text = format!(
        "ref;width_cm;volume_cc\n{long};12;300\n\"two\nlines\u{1}\";18;1000.5\n{long};12;300.04"
    );
    let shelf = Shelf::from_csv(&text).unwrap();
    let labels: Vec<&str> = shelf.sizes().iter().map(ShelfSize::label).collect();
    assert_eq!(labels[0], format!("{}… · 300 cc", "x".repeat(45)));
    assert_eq!(labels[1], "two lines · 1000.5 cc");
    assert!(labels.iter().all(|label| label.chars().count() <= 60), "{labels:?}");
    assert_ne!(labels[0], labels[2]);
}
