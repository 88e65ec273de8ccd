//! The table and the code agree: every text of the code has a row, every row is a text of the code.

use super::*;
use crate::app::frame::commands::COMMANDS;
use crate::clinical::{BUILT_IN_SOURCE, Corrected, SkinClass};
use crate::measure::bands::{self, PracticeStretch};
use crate::measure::no_shape;
use crate::scene::visit::Side;
use crate::scene::{Field, Scene};
use crate::solve::Invalid;
use crate::study::{NOTES, Quantity};
use crate::view::quantity;
use std::collections::{BTreeSet, HashSet};
use std::fs;
use std::path::Path;

/// A text of the code: the code before it, and its value.
type Literal = (String, String);

/// The texts of a Rust file up to its tests, without comments.
fn literals(code: &str) -> Vec<Literal> {
    let code = code.split("\nmod tests {").next().unwrap_or_default();
    let mut found = Vec::new();
    let (mut before, mut rest) = (String::new(), code);
    while let Some(sign) = rest.chars().next() {
        if rest.starts_with("//") {
            rest = rest.split_once('\n').map_or("", |(_, after)| after);
        } else if rest.starts_with("'\"'") || rest.starts_with("'\\\"'") {
            rest = &rest[if rest.starts_with("'\"'") { 3 } else { 4 }..];
        } else if sign == '"' {
            let (text, after) = text_of(&rest[1..]);
            found.push((std::mem::take(&mut before), text));
            rest = after;
        } else {
            before.push(sign);
            rest = &rest[sign.len_utf8()..];
        }
    }
    found
}

/// The value of a literal from behind its first quote, and the code behind its last.
fn text_of(code: &str) -> (String, &str) {
    let mut text = String::new();
    let mut signs = code.char_indices();
    while let Some((at, sign)) = signs.next() {
        match sign {
            '"' => return (text, &code[at + 1..]),
            '\\' => match signs.next().map(|(_, sign)| sign) {
                // A continued line.
                Some('\n') => {
                    let after = signs.as_str();
                    let blank = after.len() - after.trim_start().len();
                    for _ in 0..blank {
                        signs.next();
                    }
                }
                Some('n') => text.push('\n'),
                Some(other) => text.push(other),
                None => {}
            },
            sign => text.push(sign),
        }
    }
    (text, "")
}

/// All texts of the Rust files of a folder.
fn literals_below(folder: &Path) -> Vec<Literal> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).into_iter().flatten() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(literals_below(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.extend(literals(&fs::read_to_string(&path).unwrap()));
        }
    }
    found
}

/// A text with empty places.
fn without_names(text: &str) -> String {
    parts(text).map(|part| if let Part::Text(words) = part { words } else { "{}" }).collect()
}

fn root(folder: &str) -> Vec<Literal> {
    literals_below(&Path::new(env!("CARGO_MANIFEST_DIR")).join(folder))
}

#[test]
fn every_text_to_translate_has_a_row() {
    let rows: HashSet<String> = rows().map(|(english, _)| english).collect();
    let keys = root("src/app").into_iter().filter(|(before, _)| {
        let before = before.trim_end();
        let before = before.strip_suffix("tr(").or_else(|| before.strip_suffix("tr!("));
        // Not `include_str!(`.
        before.is_some_and(|before| !before.ends_with(|c: char| c.is_alphanumeric() || c == '_'))
    });
    let missing: BTreeSet<String> =
        keys.map(|(_, text)| text).filter(|text| !rows.contains(text)).collect();
    assert!(missing.is_empty(), "without a row: {missing:#?}");
}

#[test]
fn spanish_texts_have_decimal_commas() {
    let has_point = |text: &str| {
        // The example of a date.
        let text = text.replace("25.11.2026", "");
        let signs: Vec<char> = text.chars().collect();
        signs.windows(3).any(|s| s[0].is_ascii_digit() && s[1] == '.' && s[2].is_ascii_digit())
    };
    let found: Vec<String> =
        rows().map(|(_, spanish)| spanish).filter(|text| has_point(text)).collect();
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn every_row_is_a_text_of_the_code() {
    let texts: HashSet<String> = ["src", "body", "core", "solver", "view"]
        .iter()
        .flat_map(|folder| root(folder))
        .map(|(_, text)| without_names(&text))
        .collect();
    let unused: Vec<String> = rows()
        .map(|(english, _)| english)
        .filter(|english| {
            let english = english.strip_prefix("pressure: ").unwrap_or(english);
            !texts.contains(&without_names(english))
        })
        .collect();
    assert!(unused.is_empty(), "no text of the code: {unused:#?}");
}

#[test]
fn the_languages_have_the_same_places_and_spaces() {
    let mut known = HashSet::new();
    let ends = |text: &str| (text.starts_with([' ', '\n']), text.ends_with(' '));
    let places = |text: &str| -> BTreeSet<String> {
        let place = |part| {
            if let Part::Place(name, format) = part {
                Some(format!("{name}:{format}"))
            } else {
                None
            }
        };
        parts(text).filter_map(place).collect()
    };
    for (english, spanish) in rows() {
        assert!(known.insert(english.clone()), "two rows: {english}");
        assert_eq!(places(&english), places(&spanish), "{english}");
        assert_eq!(ends(&english), ends(&spanish), "{english}");
        assert!(!spanish.trim().is_empty(), "{english}");
    }
}

#[test]
fn the_words_of_other_modules_have_rows() {
    let practice = PracticeStretch { less: 0.1, same: 0.2, more: 0.3 }.limits();
    let bands = bands::LIMITS.iter().flat_map(|limits| limits.bands.iter());
    let bands = bands.chain(practice.bands.iter());
    let causes = [
        None,
        Some(Invalid::Penetrated),
        Some(Invalid::Inverted),
        Some(Invalid::NotFound),
        Some(Invalid::NotFinite),
    ];
    let plan = Scene::opening();
    let numbers = Field::ALL.iter().flat_map(|field| [field.label, field.help]);
    let words = bands
        .flat_map(|band| [band.word, band.source])
        .chain(bands::LIMITS.iter().map(|limits| limits.note))
        .chain(COMMANDS.iter().flat_map(|entry| [entry.name, entry.tooltip]))
        .chain(SkinClass::ALL.map(SkinClass::word))
        .chain(Side::ALL.into_iter().flat_map(|side| [side.word(), side.words()]))
        .chain(causes.map(no_shape))
        .chain(NOTES)
        .chain(numbers)
        .chain(Field::ALL.iter().map(|field| field.scale.unit).filter(|unit| unit.contains(' ')))
        .chain(Quantity::ALL.map(Quantity::title))
        .chain(Quantity::ALL.map(Quantity::label))
        .chain(quantity::Quantity::of_scene(&plan).map(|quantity| quantity.name()))
        .chain(Corrected::ALL.map(Corrected::words))
        .chain([bands::COVER, BUILT_IN_SOURCE, "skin", "adipose", "muscle"]);
    let missing: BTreeSet<&str> =
        words.filter(|word| !word.is_empty() && spanish(word).is_none()).collect();
    assert!(missing.is_empty(), "without a row: {missing:#?}");
}

#[test]
fn a_template_is_filled_with_signs_and_decimals() {
    let values: [(&str, &dyn Display); 2] = [("gain", &1.26), ("name", &"A")];
    assert_eq!(filled("{name}: {gain:+.1} or {gain:.0}, {gain}.", &values), "A: +1.3 or 1, 1.26.");
    assert_eq!(filled("no place", &values), "no place");
}

#[test]
fn a_finished_sentence_is_recognised_with_its_values() {
    for (english, spanish) in [
        (
            "The model has no answer for 300 ml on 12 cm.",
            "El modelo no tiene respuesta para 300 ml con 12 cm.",
        ),
        ("300 ml on 12 × 10.8 cm", "300 ml con 12 × 10.8 cm"),
        ("Use 280 ml", "Usar 280 ml"),
        ("Stress in adipose", "Tensión: grasa"),
        ("pinch 20 mm", "pellizco 20 mm"),
        (
            "The stress–strain curve of skin was extrapolated: the strains exceed its data.",
            "La curva tensión–deformación de piel se ha extrapolado: las deformaciones superan sus datos.",
        ),
        (
            "The void of the pocket stays at 3.1 ml: under a suction of 20.0 kPa, and on this grid, the tissue does not reach \
             further into the corner at the implant's rim.",
            "El hueco del bolsillo se queda en 3.1 ml: con una succión de 20.0 kPa, y en esta malla, el tejido no entra más en \
             el rincón del borde del implante.",
        ),
        (
            "The void of the pocket stays at 47.5 ml: under more suction than 2.5 kPa the solver finds no shape on this grid. Force \
             and pressure depend on the grid: choose a finer accuracy or a larger void.",
            "El hueco del bolsillo se queda en 47.5 ml: con más succión que 2.5 kPa el cálculo no halla ninguna forma en esta malla. \
             Fuerza y presión dependen de la malla: conviene elegir una precisión más fina o un hueco mayor.",
        ),
        ("Nobody's words", "Nobody's words"),
    ] {
        assert_eq!(sentence(english), spanish);
    }
    let folds = "Folds of the skin may be visible over the pocket: about 20 % of the skin on and around the implant is \
         wrinkled or slack. The computed shape does not contain the height of folds.";
    assert!(sentence(folds).starts_with(
        "Pueden verse pliegues de la piel sobre el bolsillo: cerca del 20 % de la piel"
    ));
}

#[test]
fn what_is_said_about_a_tensile_test_is_spanish() {
    let read = |text: &[u8]| crate::tensile::read(text, crate::tensile::Given::default());
    let mut said = Vec::new();
    for text in [
        &include_bytes!("../../../tests/fixtures/tensile/percent-mpa-unload.csv")[..],
        include_bytes!("../../../tests/fixtures/tensile/true-cycles-rupture.txt"),
        include_bytes!("../../../tests/fixtures/tensile/toe.json"),
        include_bytes!("../../../tests/fixtures/tensile/offset.json"),
        include_bytes!("../../../tests/fixtures/tensile/dup.json"),
        b"Stretch [-];Stress\n0,9;-8\n1;0\n1,1;x\n1,2;9\n1,3;9\n1,4;30000",
        b"0.1,0\n0.2,2",
    ] {
        let found = read(text).unwrap();
        said.push(found.summary());
        said.extend(found.notes);
    }
    for text in ["0,1", "0.1,2\n0.2,1", "1,2,3\n2,3,4", "Strain [mm];Stress [N]\n1;2"] {
        said.push(read(text.as_bytes()).unwrap_err().to_string());
    }
    assert!(said.len() > 30, "{said:#?}");
    for english in said {
        let spanish = sentence(&english);
        assert!(spanish != english && !spanish.contains(" strain"), "{spanish}");
    }
}
