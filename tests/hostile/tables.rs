//! Tables of scenes, of sizes and of practice, raw tensile tests.

use super::*;

#[test]
fn practice_tables_of_any_text_are_valid_or_rejected() {
    const PARTS: [&str; 13] = [
        "12",
        "-30",
        "cm",
        ";",
        "\n",
        "\"",
        "pull",
        "above",
        "1e308",
        "NaN",
        "0,5",
        "\u{1f}",
        "base width;at;",
    ];
    let place = any::<prop::sample::Index>;
    let edits = vec((place(), place(), prop::sample::select(&PARTS[..]), 0_u8..3), 1..4);
    let accepted = std::cell::Cell::new(0);
    check(8000, &edits, |edits| {
        let mut text: Vec<char> = PracticeTable::default().to_csv().chars().collect();
        for (at, to, part, kind) in edits {
            let (at, to) = (at.index(text.len()), to.index(text.len()));
            let to = if kind == 0 { at } else { to.clamp(at, (at + 6).min(text.len())) };
            let part = if kind == 2 { "" } else { part };
            text.splice(at..to, part.chars());
        }
        let is_accepted = hostile::check_practice(&text.into_iter().collect::<String>());
        accepted.set(accepted.get() + i32::from(is_accepted));
    });
    assert!(accepted.get() > 800, "{accepted:?} are too few to say much");
    check(4000, &bytes(), |bytes| {
        hostile::check_practice(&String::from_utf8_lossy(&bytes));
    });
}

#[test]
fn tensile_tests_of_any_table_are_read_or_rejected() {
    let accepted = std::cell::Cell::new(0);
    let head =
        "|(True )?(Strain|Stretch|ε)( \\[(%|-|mm)\\])?[,;](Stress|σ)( \\((kPa|MPa|Pa|N)\\))?\n";
    let cell = "-?[0-9]{1,4}([.,][0-9]{1,3})?(e[0-9]{1,3})?( %| kPa)?";
    let row = format!("({cell}|x?)[,;\t ]({cell})([,;]{cell})?\r?\n");
    let rows = vec(0..900_u16, 1..80).prop_map(|steps| {
        let total = |k: usize| steps[..k].iter().map(|step| f64::from(*step)).sum::<f64>();
        let row =
            |k: usize| format!("{};{}\n", total(k) / 9e4, total(k) * f64::from(steps[k]) / 1e4);
        (0..steps.len()).map(row).collect::<String>()
    });
    check(
        3000,
        &(head, prop_oneof![vec(row.as_str(), 0..30).prop_map(|rows| rows.concat()), rows]),
        |(head, rows)| {
            let text = head + &rows;
            let is_accepted = hostile::check_tensile(text.as_bytes());
            accepted.set(accepted.get() + i32::from(is_accepted));
        },
    );
    assert!(accepted.get() > 1000, "{accepted:?} are too few to say much");
}

#[test]
fn a_long_tensile_test_is_read_soon() {
    let _alone = ALONE.lock();
    let text: String = (0..100_000)
        .map(|k| {
            format!("{},{}\n", f64::from(k) / 1e6, i64::from(k) * 7919 % 100_003 + i64::from(k))
        })
        .collect();
    let start = Instant::now();
    hostile::check_tensile(text.as_bytes());
    let time = start.elapsed();
    assert!(time < 4 * SOON, "{time:?}");
}

/// Tables of sizes of cells that are often right.
fn shelf_bytes() -> impl Strategy<Value = Vec<u8>> {
    const HEADS: [&str; 4] = [
        "Ref.;Width (cm);Height;Projection;Volume",
        "Name;Ø;Höhe;cc;x",
        "Title\n;;;;\nP;W;Base;Vol. (cc);Ref.",
        "",
    ];
    const CELLS: [&str; 20] = [
        "12", "11,5", "39", "4.1", "4", "275", "300 cc", "12.0 cm", "118 mm", "1.250", "A-1",
        "A-1", "* note", "é", "", "\"", "1e308", "NaN", "-3", "0",
    ];
    let rows = vec(vec(0..CELLS.len(), 5), 0..8);
    (0..HEADS.len(), rows, prop::sample::select(&[";", "\t", ","][..])).prop_map(
        |(head, rows, separator)| {
            let row =
                |cells: &Vec<usize>| cells.iter().map(|k| CELLS[*k]).collect::<Vec<_>>().join(";");
            let text = [HEADS[head].to_owned()]
                .into_iter()
                .chain(rows.iter().map(row))
                .collect::<Vec<_>>()
                .join("\n");
            text.replace(';', separator).into_bytes()
        },
    )
}

#[test]
fn tables_of_sizes_of_any_bytes_are_read_or_rejected_with_any_choice_of_columns() {
    let accepted = std::cell::Cell::new(0);
    let choices = || vec((0..8_usize, 0..12_usize), 0..6);
    check(6000, &(shelf_bytes(), choices()), |(bytes, choices)| {
        accepted.set(accepted.get() + i32::from(hostile::check_shelf(&bytes, &choices)));
    });
    assert!(accepted.get() > 150, "{accepted:?} are too few to say much");
    // Tables of makers with a piece in place of others.
    let tables: [&[u8]; 5] = [
        include_bytes!("../fixtures/shelf/en-title.csv"),
        include_bytes!("../fixtures/shelf/es-comas.csv"),
        include_bytes!("../fixtures/shelf/de-unicode.txt"),
        include_bytes!("../fixtures/shelf/fr-anatomique.csv"),
        include_bytes!("../fixtures/shelf/pt-diametro.csv"),
    ];
    accepted.set(0);
    let edit = (any::<prop::sample::Index>(), 0..8_usize, shelf_bytes());
    check(3000, &(0..5_usize, vec(edit, 0..4), choices()), |(k, edits, choices)| {
        let mut bytes = tables[k].to_vec();
        for (at, length, piece) in edits {
            let at = at.index(bytes.len());
            let to = (at + length).min(bytes.len());
            bytes.splice(at..to, piece);
        }
        accepted.set(accepted.get() + i32::from(hostile::check_shelf(&bytes, &choices)));
    });
    assert!(accepted.get() > 1500, "{accepted:?} are too few to say much");
}

/// Pieces that tables consist of.
fn table_bytes() -> impl Strategy<Value = Vec<u8>> {
    let pieces = [
        ";", ",", "\t", "\"", "\"\"", "\n", "\r", "\r\n", " ", "a", "é", "1", "12,5", "1.250",
        "1.234,5", "300 cc", "sep=;\n", "\u{feff}", "\0", "\u{a0}",
    ];
    vec(0..=pieces.len(), 0..60).prop_map(move |chosen| {
        let piece = |k: usize| pieces.get(k).map_or(&b"\xff"[..], |piece| piece.as_bytes());
        // A letter that is not UTF-8 is rare, so that most tables are read.
        let is_broken = chosen.iter().all(|k| *k > 0);
        let kept = chosen.iter().filter(|k| is_broken || **k < pieces.len());
        kept.flat_map(|k| piece(*k)).copied().collect()
    })
}

#[test]
fn tables_of_any_bytes_are_read_or_rejected() {
    check(20_000, &bytes(), |bytes| hostile::check_table(&bytes));
    check(20_000, &table_bytes(), |bytes| hostile::check_table(&bytes));
    let pairs = |bytes: Vec<u8>| [b"\xff\xfe".to_vec(), bytes].concat();
    check(5000, &bytes(), |bytes| hostile::check_table(&pairs(bytes)));
}

#[test]
fn tables_by_another_writer_are_read_cell_by_cell_however_rows_are_joined() {
    let text = prop_oneof!["[a-z\"; ,\t.0-9é\r\n]{0,6}", "[a-z]{1,3}"];
    let rows = vec(vec(text, 3), 1..6);
    let ends = vec(0..3_usize, 6);
    check(5000, &(rows, ends, 0..3_usize), |(rows, ends, separator)| {
        let separator = [b';', b',', b'\t'][separator];
        let mut bytes = Vec::new();
        for (row, end) in rows.iter().zip(&ends) {
            let terminator = csv::Terminator::Any(b'\n');
            let mut writer = csv::WriterBuilder::new();
            let writer = writer.delimiter(separator).terminator(terminator);
            let mut writer = writer.from_writer(Vec::new());
            writer.write_record(row.iter().map(String::as_str).chain(["x"])).unwrap();
            bytes.extend_from_slice(writer.into_inner().unwrap().strip_suffix(b"\n").unwrap());
            bytes.extend_from_slice([&b"\n"[..], b"\r", b"\r\n"][*end]);
        }
        let form = Form { separator: Some(separator), ..Form::PLAIN };
        let table = Table::read_as(std::str::from_utf8(&bytes).unwrap(), form).unwrap();
        let found: Vec<Vec<&str>> = table.rows().map(|row| row.cells().take(3).collect()).collect();
        assert_eq!(found, rows, "{bytes:?}");
    });
}

#[test]
fn a_large_table_takes_little_time_and_memory() {
    for text in [
        ";".repeat(9_999_999),
        "a\n".repeat(1_900_000),
        "\"".repeat(9_999_999),
        "\"\"\"\n,".repeat(1_999_999),
        "1,5;".repeat(1_900_000),
    ] {
        let _alone = ALONE.lock();
        let start = Instant::now();
        let read = Table::read(&text);
        let time = start.elapsed();
        let profiler = Profiler::builder().testing().build();
        assert_eq!(Table::read(&text), read);
        let peak = HeapStats::get().max_bytes;
        drop(profiler);
        if let Err(error) = read {
            hostile::check_message(&error);
        }
        assert!(time < 5 * SOON, "{time:?} for {text:.10}");
        assert!(peak < LITTLE, "{peak} bytes for {text:.10}");
    }
}
