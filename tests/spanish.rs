//! The app's screens in Spanish, without a GPU. The language belongs to the process: these tests have a program of their own.

#![cfg(all(feature = "app", not(target_arch = "wasm32")))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/frames.rs"]
mod frames;
#[path = "common/window.rs"]
mod window;

use eframe::egui::{self, Role};
use egui_kittest::Harness;
use egui_kittest::kittest::{By, NodeT, Queryable};
use frames::{cut_texts, painted_texts, settle};
use implant_preview::app::App;
use implant_preview::clinical::Size;
use implant_preview::curve::CurveSpec;
use implant_preview::platform::desktop::beside_window;
use implant_preview::scene::Scene;
use std::collections::BTreeSet;
use std::sync::{Mutex, MutexGuard, PoisonError};
use window::{flat_plan, plan_on_a_body, window};

/// Tall enough for all folds.
const WIDE: egui::Vec2 = egui::Vec2::new(1280.0, 2800.0);
const DESKTOP: egui::Vec2 = egui::Vec2::new(1440.0, 900.0);
const PHONE: egui::Vec2 = egui::Vec2::new(390.0, 844.0);

/// The table of the texts.
const TABLE: &str = include_str!("../src/app/texts/table.tsv");

/// One test at a time: one of them changes the language.
fn alone() -> MutexGuard<'static, ()> {
    static LANGUAGE: Mutex<()> = Mutex::new(());
    LANGUAGE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The app in a language, with a change of the opening plan on a small grid, solved and at rest.
fn app(language: &str, size: egui::Vec2, change: impl FnOnce(&mut Scene)) -> Harness<'static, App> {
    let mut scene = flat_plan();
    change(&mut scene);
    let ctx = egui::Context::default();
    let mut app = App::new(&ctx, None, scene, beside_window).unwrap();
    app.restore_language(Some(language));
    let mut harness = window(size, 400, app);
    settle(&mut harness);
    harness
}

fn press(harness: &mut Harness<'static, App>, button: &str) {
    harness.get_by_role_and_label(Role::Button, button).click();
    settle(harness);
}

/// Opens a fold, which may be scrolled out of sight.
fn unfold(harness: &mut Harness<'static, App>, fold: &'static str) {
    harness.get_by_label(fold).focus();
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
}

/// All texts of the screen, for eyes and for screen readers.
fn texts(harness: &Harness<'static, App>) -> BTreeSet<String> {
    let everything = By::new().predicate(|_| true).recursive(true);
    let named = harness.query_all(everything).flat_map(|node| {
        let node = node.accesskit_node();
        [node.label(), node.value()].into_iter().flatten()
    });
    named.chain(painted_texts(harness)).chain([harness.state().summary()]).collect()
}

/// English of a screen: texts of the table, and texts with frequent English words.
fn english(harness: &Harness<'static, App>) -> Vec<String> {
    const WORDS: [&str; 22] = [
        "the", "of", "and", "with", "is", "are", "this", "skin", "cover", "pressure", "width",
        "pinch", "pocket", "stretch", "answer", "usual", "high", "fat", "adipose", "percent",
        "most", "up",
    ];
    // Titles of publications, the choice of the language.
    let stays = |text: &str| text.contains("Nikolaev, Non-linear") || text == "English";
    let rows = TABLE.lines().filter_map(|line| line.split_once('\t'));
    let words: BTreeSet<&str> =
        rows.filter(|(english, spanish)| english != spanish).map(|(english, _)| english).collect();
    let spanish: BTreeSet<&str> =
        TABLE.lines().filter_map(|line| Some(line.split_once('\t')?.1)).collect();
    texts(harness)
        .into_iter()
        .filter(|text| !stays(text) && !spanish.contains(text.as_str()))
        .filter(|text| {
            let mut tokens = text.split(|c: char| !c.is_alphabetic());
            words.contains(text.as_str())
                || tokens.any(|token| WORDS.contains(&token.to_lowercase().as_str()))
        })
        .collect()
}

/// Texts of a screen with a decimal point; dates have points, as has the example of a date.
fn with_decimal_points(harness: &Harness<'static, App>) -> Vec<String> {
    let has_point = |text: &str| {
        text.split(|c: char| !c.is_ascii_digit() && c != '.').any(|number| {
            number.split_once('.').is_some_and(|(whole, decimals)| {
                !whole.is_empty()
                    && decimals.starts_with(|c: char| c.is_ascii_digit())
                    && !decimals.trim_end_matches('.').contains('.')
            })
        })
    };
    texts(harness).into_iter().filter(|text| has_point(text)).collect()
}

#[track_caller]
fn assert_spanish(harness: &Harness<'static, App>) {
    assert_eq!(english(harness), Vec::<String>::new());
    assert_eq!(with_decimal_points(harness), Vec::<String>::new());
}

#[test]
fn the_opening_plan_is_in_spanish() {
    let _alone = alone();
    let mut harness = app("es-ES", DESKTOP, |_| {});
    harness.state_mut().restore_research(Some("on"));
    harness.run();
    for text in [
        "Qué ocurre",
        "Estiramiento de la piel",
        "Cobertura mínima",
        "no fina",
        "Presión sobre el tejido",
        "Pellizco",
        "Cobertura 10 mm (6–17): piel 1,5 + grasa 8,5",
        "Proyección según anchura y volumen.",
        "Cambiar anchura, volumen o pellizco · arrastrar la imagen para girarla",
        "modelo estándar, 33 nodos por lado",
    ] {
        assert!(harness.query_all_by_label(text).count() > 0, "{text}");
    }
    for slider in
        ["Anchura (cm)", "Volumen (ml)", "Proyección (cm)", "Pellizco (cm)", "Margen (cm)"]
    {
        harness.get_by_role_and_label(Role::Slider, slider);
    }
    // Practice's volumes are solved beside the frames.
    let start = std::time::Instant::now();
    let is_compared =
        |text: &String| text.starts_with("300 ml, 12 cm: como la práctica. Estiramiento 1");
    let is_done = |harness: &Harness<'static, App>| harness.state().summary().contains(" Al día.");
    while !texts(&harness).iter().any(is_compared) || !is_done(&harness) {
        assert!(start.elapsed().as_secs() < 240, "{:?}", texts(&harness));
        harness.step();
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    let summary = harness.state().summary();
    assert!(
        summary.starts_with("Plan: implante de 300 ml, 12 cm de anchura. Estiramiento de la piel "),
        "{summary}"
    );
    assert!(summary.contains(" mmHg, habitual.") && summary.contains(" Al día."), "{summary}");
    assert_spanish(&harness);
    // Files and the form's names stay English.
    let form = harness.state().plan_json();
    assert!(form.contains(r#""name":"width_cm","label":"Anchura""#), "{form}");
    assert!(
        form.contains(r#""choices":["tight","normal","#)
            && form.contains(r#""words":["tensa","normal","#),
        "{form}"
    );
    assert!(form.contains(" a 24 cm"), "{form}");
}

#[test]
fn spanish_numbers_have_commas_and_fields_read_both_signs() {
    let _alone = alone();
    for (language, name, width, margin, undo) in [
        ("es", "Anchura (cm)", "12,5", "1,0", "Deshacer"),
        ("en", "Width (cm)", "12.5", "1.0", "Undo"),
    ] {
        let mut harness = app(language, DESKTOP, |_| {});
        for typed in ["12,5", "12.5"] {
            harness.get_by_role_and_label(Role::SpinButton, name).focus();
            harness.run();
            harness.event(egui::Event::Text(typed.to_owned()));
            harness.run();
            harness.key_press(egui::Key::Enter);
            settle(&mut harness);
            let field = harness.get_by_role_and_label(Role::SpinButton, name);
            assert_eq!(field.value().as_deref(), Some(width), "{typed}");
            let radius = harness.state().session().scene().implant.base_radius_mm;
            assert_eq!(radius.to_bits(), 62.5_f64.to_bits(), "{typed}");
            press(&mut harness, undo);
        }
        // The form has the texts of the screen and the numbers of JSON.
        let form = harness.state().plan_json();
        assert!(form.contains(&format!(r#""text":"{margin}""#)), "{form}");
        assert!(form.contains(r#""most":24.0"#), "{form}");
    }
}

#[test]
fn folds_menus_and_the_comparison_are_in_spanish() {
    let _alone = alone();
    let mut harness = app("es", WIDE, |_| {});
    for fold in ["Tejido", "Avanzado", "Detalles", "Origen de los límites"] {
        unfold(&mut harness, fold);
    }
    press(&mut harness, "Fijar como A");
    assert_spanish(&harness);
    for (menu, item) in [("Archivo", "Guardar informe (HTML)…"), ("Ver", "Comandos…")] {
        press(&mut harness, menu);
        assert!(harness.query_all_by_label(item).count() > 0, "{item}");
        assert_spanish(&harness);
        harness.key_press(egui::Key::Escape);
        harness.run();
    }
    press(&mut harness, "Ayuda");
    harness.get_by_label("Una vista previa, no un producto sanitario.");
    assert_spanish(&harness);
}

#[test]
fn an_expander_is_an_expansor() {
    let _alone = alone();
    let mut harness = app("es", WIDE, |_| {});
    press(&mut harness, "expansor");
    for text in ["Cobertura mínima", "Posición del expansor", "Gama de expansores", "Llenado (ml)"]
    {
        assert!(harness.query_all_by_label(text).count() > 0, "{text}");
    }
    assert!(harness.state().summary().starts_with("Plan: expansor de 300 ml"));
    assert_spanish(&harness);
}

#[test]
fn a_plan_without_an_answer_says_so_in_spanish() {
    let _alone = alone();
    for size in [DESKTOP, PHONE] {
        let harness = app("es", size, |scene| {
            let size = Size::of_width_and_volume(120.0, 350.0).unwrap();
            scene.implant.projection_mm = size.projection_mm();
            scene.layers[1].curve = CurveSpec::Adipose {}.into();
            scene.layers[1].poisson_ratio = 0.45;
            scene.layers[0].curve.strain_scale = 0.15;
        });
        let words = "La piel es demasiado tensa para 350 ml con 12 cm, y una grasa tan blanda cede bajo ella.";
        assert!(harness.query_all_by_label(words).count() > 0, "{size}");
        assert!(harness.state().summary().contains(words));
        assert!(harness.query_all_by_label("Sin respuesta").count() > 0);
        assert_spanish(&harness);
    }
}

#[test]
fn the_range_of_implants_is_in_spanish() {
    let _alone = alone();
    let mut harness = app("es", DESKTOP, |_| {});
    press(&mut harness, "Gama de implantes");
    harness.run();
    harness.get_by_role_and_label(Role::Canvas, "Gama de implantes, gráfico");
    assert_spanish(&harness);
}

/// It stands in the row of the sides, in both languages; below it where a small screen has no room.
#[test]
fn the_switch_of_both_sides_stands_in_their_row() {
    let _alone = alone();
    for (language, [left, both, own]) in
        [("en", ["left", "both alike", "each own"]), ("es", ["izquierdo", "iguales", "propias"])]
    {
        let mut harness = app(language, egui::vec2(1280.0, 800.0), |_| {});
        let place = |harness: &Harness<'static, App>, name: &str| {
            harness.get_by_role_and_label(Role::Button, name).rect()
        };
        let before = place(&harness, left);
        press(&mut harness, both);
        press(&mut harness, own);
        assert_eq!(place(&harness, left), before);
        let apart = place(&harness, own).center().y - before.center().y;
        assert!(apart.abs() < 1.0, "{language}: {apart}");
    }
}

#[test]
fn nothing_is_cut_on_screens_of_a_desk() {
    let _alone = alone();
    for size in [DESKTOP, egui::vec2(1280.0, 800.0), egui::vec2(1024.0, 768.0)] {
        let mut harness = app("es", size, |scene| scene.solver = Scene::opening().solver);
        for chips in [&[][..], &["medir"][..], &["expansor"][..]] {
            for chip in chips {
                press(&mut harness, chip);
            }
            let words = ["Al día", "Comparando con la práctica…", "Calculando el mayor volumen…"];
            let mut words = words.into_iter().chain(["Calculando los intervalos…"]);
            let status = words.find_map(|words| harness.query_by_label(words)).unwrap().rect();
            for fold in ["Tejido", "Origen de los límites"] {
                let fold = harness.get_by_label(fold).rect();
                assert!(fold.bottom() < status.top(), "{size} {chips:?}: {fold:?}");
            }
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{size} {chips:?}");
        }
        // The last column of the fill steps, which lie below the cards.
        harness.get_by_label("Guardar pasos de llenado (CSV)…").scroll_to_me();
        harness.run();
        let is_last = |text: &String| text == "Queda\n(cm²)";
        assert!(painted_texts(&harness).iter().any(is_last), "{size}");
        let picture = harness.get_by_role_and_label(Role::Canvas, "Vista 3D").rect();
        assert!(picture.width() > 0.46 * size.x, "{size}: {picture:?}");
    }
}

#[test]
fn her_measures_are_in_spanish_and_whole_in_wide_and_narrow_columns() {
    let _alone = alone();
    for (width, tab) in [(1280.0, None), (1024.0, None), (390.0, Some("Más"))] {
        let size = egui::vec2(width, 2600.0);
        let mut harness = app("es", size, |scene| *scene = plan_on_a_body());
        tab.into_iter().for_each(|tab| press(&mut harness, tab));
        unfold(&mut harness, "Detalles");
        let painted = painted_texts(&harness);
        for text in ["Medidas antes | después", "Escotadura–pezón, cm", "ganancia"] {
            assert!(painted.iter().any(|found| found == text), "{width} {text}: {painted:?}");
        }
        assert_spanish(&harness);
        assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{width}");
    }
}

#[test]
fn nothing_is_cut_on_a_phone() {
    let _alone = alone();
    let mut harness = app("es", PHONE, |_| {});
    for tab in ["Implante", "Paciente", "Bolsillo", "Más"] {
        press(&mut harness, tab);
        for answer in ["Estiramiento", "Cobertura", "Presión"] {
            assert!(harness.query_all_by_label(answer).count() > 0, "{answer}");
        }
        if tab != "Más" {
            assert_eq!(cut_texts(&harness), Vec::<String>::new(), "{tab}");
        }
        assert_spanish(&harness);
    }
    let harness = app("es", egui::vec2(320.0, 568.0), |_| {});
    let buttons = ["Archivo", "Deshacer", "Rehacer", "Reiniciar", "Ayuda", "Informe"];
    let rects = buttons.map(|name| harness.get_by_role_and_label(Role::Button, name).rect());
    for (pair, names) in rects.windows(2).zip(buttons.windows(2)) {
        assert!(pair[0].right() < pair[1].left(), "{names:?} overlap: {pair:?}");
    }
    assert!(rects[5].right() <= 320.0, "{:?}", rects[5]);
}

#[test]
fn the_language_is_chosen_in_the_menu_and_kept_once() {
    let _alone = alone();
    let mut harness = app("en-GB", DESKTOP, |_| {});
    assert_eq!(harness.state_mut().take_language_to_store(), None);
    press(&mut harness, "View");
    press(&mut harness, "Español");
    harness.get_by_role_and_label(Role::Button, "Archivo");
    assert_eq!(harness.state_mut().take_language_to_store().as_deref(), Some("es"));
    assert_eq!(
        (harness.state_mut().take_language_to_store(), harness.state().language()),
        (None, "es")
    );
    assert_spanish(&harness);
    // An unknown text in the storage is no choice.
    let mut harness = app("es", DESKTOP, |_| {});
    press(&mut harness, "Ver");
    press(&mut harness, "English");
    harness.get_by_role_and_label(Role::Button, "File");
    // The list of commands has both languages.
    harness.key_press_modifiers(egui::Modifiers::COMMAND, egui::Key::K);
    harness.run();
    harness.event(egui::Event::Text("español".to_owned()));
    harness.run();
    harness.key_press(egui::Key::Enter);
    harness.run();
    harness.get_by_role_and_label(Role::Button, "Archivo");
}

#[test]
fn the_reason_of_a_table_that_is_no_shelf_is_spanish() {
    let _alone = alone();
    let mut harness = app("es", DESKTOP, |_| {});
    for (text, reason) in [
        (
            "name;width_cm;volume_ml\nA;12;x",
            "línea 2: volumen: \"x\"; permitido: un número, como 12,5",
        ),
        (
            "name;width_cm;volume_ml\nA;25;300",
            "línea 2: anchura: «25»; permitido: un número de 2 a 24 cm",
        ),
        ("name;color;volume_ml\nA;2;3", "ninguna columna es la anchura; permitido: una columna de"),
        ("name;width_cm;volume_ml\nA;;300", "línea 2: la fila no tiene anchura; permitido: una"),
        (
            "name;width_cm;volume_ml\n\"A;12",
            "línea 2: unas comillas no se cierran; permitido: cada signo",
        ),
    ] {
        harness.state_mut().restore_shelf(text);
        let words = harness.state().notice_in_words();
        assert!(words.contains(reason), "{words}");
    }
    harness.run();
}
