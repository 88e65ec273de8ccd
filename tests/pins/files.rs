//! Files with pins.

use super::*;

#[test]
fn an_unstable_pin_of_a_file_ends_without_a_shape() {
    let mut session = settled(small());
    let scene = unstable();
    session.set_pins(vec![PinnedScene { letter: Letter::A, name: String::new(), scene }]).unwrap();
    settle_pins(&mut session);
    let only = &session.pins()[0];
    assert_eq!((only.has_shape(), only.outcome().unwrap().status), (false, Status::Unstable));
    let before = session.counters().solves;
    settle_pins(&mut session);
    assert_eq!(session.counters().solves, before);
}

#[test]
fn a_saved_file_contains_the_pins_and_solves_each_physics_once() {
    let mut first = settled(small());
    pin(&mut first);
    edit(&mut first, insertion(0.5));
    settle(&mut first);
    pin(&mut first);
    edit(&mut first, |scene| "capsule".clone_into(&mut scene.layers[1].tissue));
    pin(&mut first);
    first.apply(Command::Rename(Letter::B, "half".to_owned())).unwrap();
    first.apply(Command::Unpin(Letter::A)).unwrap();
    edit(&mut first, insertion(1.0));
    settle(&mut first);
    let file = first.document_json();

    let mut second = settled(Scene { insertion: 0.3, ..small() });
    second.apply(Command::Open(file.clone())).unwrap();
    assert_eq!(second.scene(), first.scene());
    assert_eq!(second.pinned_scenes(), first.pinned_scenes());
    assert_eq!(letters(&second), [Letter::B, Letter::C]);
    settle(&mut second);
    settle_pins(&mut second);
    // The first scene, the file's scene, and one for both pins.
    assert_eq!(second.counters().solves, 3);
    assert!(second.pins().iter().all(implant_preview::session::Pin::has_shape));
    // The same file again: nothing is solved.
    second.apply(Command::Open(file.clone())).unwrap();
    settle_pins(&mut second);
    assert_eq!(second.counters().solves, 3);
    // A file without pins leaves the pins alone.
    second.apply(Command::Open(small().to_json())).unwrap();
    assert_eq!(letters(&second), [Letter::B, Letter::C]);
    // A computation ignores the pins.
    assert_eq!(&Scene::from_json(&file).unwrap(), first.scene());
}

#[test]
fn without_pins_a_saved_file_is_the_scene() {
    let session = Session::new(small()).unwrap();
    assert_eq!(session.document_json(), small().to_json());
    assert!(Document::from_json(&small().to_json()).unwrap().pins.is_none());
}

#[test]
fn a_sheet_is_saved_with_pins_as_the_same_sheet() {
    let mut session = settled(small_sheet());
    pin(&mut session);
    let Document { scene, pins } = Document::from_json(&session.document_json()).unwrap();
    assert_eq!(scene.scene(), session.scene());
    assert_eq!(pins.unwrap()[0].scene, small_sheet());
}

#[test]
fn kept_pins_are_restored_without_a_second_solve_of_the_present_scene() {
    let mut first = settled(small());
    pin(&mut first);
    let text = pins_json(&first.pinned_scenes());
    let mut second = Session::new(small()).unwrap();
    second.set_pins(pins_from_json(&text).unwrap()).unwrap();
    settle(&mut second);
    settle_pins(&mut second);
    assert_eq!(second.counters().solves, 1);
    assert!(second.pins()[0].has_shape());
}

/// The default scene with these pins, as JSON text.
fn with_pins(pins: &Value) -> String {
    let mut scene: Value = serde_json::to_value(small()).unwrap();
    scene["pins"] = pins.clone();
    scene.to_string()
}

#[test]
fn invalid_pins_are_rejected_in_one_line_and_change_nothing() {
    let scene = json!({ "implant": { "base_radius_mm": 50 } });
    let pin = json!({ "scene": scene });
    let mut nested = scene.clone();
    nested["pins"] = json!([]);
    let mut deep = scene.clone();
    for _ in 0..30 {
        deep = json!({ "implant": { "base_radius_mm": 50 }, "pins": [{ "scene": deep }] });
    }
    let cases = [
        (json!({}), "pins: invalid type: map"),
        (json!(null), "pins is null; allowed: a list of at most 4 entries"),
        (json!([pin, pin, pin, pin, pin]), "a list of at most 4 entries"),
        (json!([{}]), "pins[0]: missing field `scene`"),
        (json!([[scene]]), "pins[0]"),
        (json!([{ "scene": [] }]), "pins[0].scene"),
        (json!([{ "scene": {} }]), "missing field `implant`"),
        (json!([pin, { "scene": scene, "colour": 1 }]), "pins[1].colour: unknown field"),
        (json!([{ "scene": scene, "name": 7 }]), "pins[0].name: invalid type"),
        (json!([{ "scene": scene, "name": "x".repeat(101) }]), "pins[0].name is 101 bytes long"),
        (json!([{ "scene": scene, "name": "a\nb" }]), "pins[0].name is a b; allowed: text without"),
        (json!([{ "scene": scene, "letter": "E" }]), "pins[0].letter: unknown variant `E`"),
        (
            json!([{ "scene": scene, "letter": "B" }, { "scene": scene, "letter": "B" }]),
            "pins[1].letter is B; allowed: a letter of one pin only",
        ),
        (
            json!([{ "scene": nested }]),
            "pins[0].scene: pins is a list; allowed: a scene without pins",
        ),
        (json!([{ "scene": deep }]), "pins"),
        (
            json!([pin, { "scene": { "implant": { "base_radius_mm": 500 } } }]),
            "pins[1].scene: implant.base_radius_mm is 500; allowed: 10 to 120 mm",
        ),
        (
            json!([{ "scene": { "implant": { "base_radius_mm": 50 }, "schema": "other" } }]),
            "pins[0].scene.schema: is \"other\"; allowed: implant-preview/scene/1",
        ),
    ];
    let mut session = settled(small());
    for (pins, wanted) in &cases {
        let text = with_pins(pins);
        let errors = [
            Scene::from_json(&text).unwrap_err().to_string(),
            session.apply(Command::Open(text)).unwrap_err().to_string(),
        ];
        for error in errors {
            assert!(error.contains(wanted), "{error}; wanted: {wanted}");
            assert!(error.lines().count() == 1 && error.len() < 300, "{error}");
        }
    }
    assert!(session.pins().is_empty() && !session.can_undo());
}

#[test]
fn letters_of_a_file_are_kept_and_missing_letters_filled() {
    let scene = json!({ "implant": { "base_radius_mm": 50 } });
    let pins = json!([{ "scene": scene }, { "scene": scene, "letter": "A" }, { "scene": scene }]);
    let read = Document::from_json(&with_pins(&pins)).unwrap().pins.unwrap();
    let letters: Vec<Letter> = read.iter().map(|pin| pin.letter).collect();
    assert_eq!(letters, [Letter::A, Letter::B, Letter::C]);
}

#[test]
fn a_foreign_text_is_no_list_of_pins() {
    let good = json!({ "schema": "implant-preview/pins/1", "pins": [] });
    assert_eq!(pins_from_json(&good.to_string()), Ok(Vec::new()));
    for (text, wanted) in [
        (String::new(), "is empty; allowed: one JSON object"),
        ("hello".to_owned(), "expected value"),
        ("\u{0}\u{feff}{".to_owned(), "expected value"),
        ("[]".to_owned(), "is a list"),
        (r#"{"schema":"implant-preview/pins/2","pins":[]}"#.to_owned(), "schema is"),
        (r#"{"pins":[]}"#.to_owned(), "missing field `schema`"),
        (r#"{"schema":"implant-preview/pins/1"}"#.to_owned(), "missing field `pins`"),
        (small().to_json(), "unknown field"),
        (format!("{good}x"), "trailing characters"),
        ("[".repeat(100_000), "is a list"),
    ] {
        let error = pins_from_json(&text).unwrap_err().to_string();
        assert!(error.contains(wanted), "{error}; wanted: {wanted}");
        assert!(error.lines().count() == 1 && error.len() < 300, "{error}");
    }
}
