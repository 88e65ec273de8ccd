//! The pictures: what stands on them, views and zoom, keys.

use super::*;
use implant_preview::scene::{ChestShape, Side};

/// The places of the words of the directions on the picture, of those that are drawn.
pub(super) fn directions(harness: &Harness<'static, App>) -> Vec<(String, egui::Pos2)> {
    directions_in(harness, "3-D view")
}

fn directions_in(harness: &Harness<'static, App>, canvas: &str) -> Vec<(String, egui::Pos2)> {
    let view = harness.get_by_role_and_label(Role::Canvas, canvas).rect();
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => {
            Some((text.galley.text(), text.visual_bounding_rect(), shape.clip_rect))
        }
        _ => None,
    });
    let words = ["head", "feet", "midline", "side"];
    texts
        .filter(|(text, ..)| words.contains(text))
        .filter(|(_, rect, clip)| view.contains_rect(*rect) && clip.contains_rect(*rect))
        .map(|(text, rect, _)| (text.to_owned(), rect.center()))
        .collect()
}

#[test]
fn the_words_of_the_directions_stand_at_the_edges_of_the_picture_on_every_plan() {
    for size in [DESKTOP, egui::vec2(1024.0, 768.0), PHONE] {
        for (shape, is_right) in [("round", false), ("anatomical", false), ("round", true)] {
            let mut harness = app(size, |scene| {
                *scene = flat_plan();
                scene.side = is_right.then_some(Side::Right);
            });
            press(&mut harness, "Inside");
            if size == PHONE {
                press(&mut harness, "Implant");
            }
            press(&mut harness, shape);
            if size == PHONE {
                press(&mut harness, "View");
            }
            press(&mut harness, "Front");
            harness.run_steps(40);
            let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
            let words = directions(&harness);
            let at = |word: &str| words.iter().find(|(text, _)| text == word).map(|(_, at)| *at);
            let [head, feet] = ["head", "feet"].map(|word| at(word).unwrap());
            let [left, right] = ["midline", "side"].map(|word| at(word).unwrap());
            let [midline, side] = if is_right { [right, left] } else { [left, right] };
            let third = view.size() / 3.0;
            assert!(head.y < view.top() + third.y, "{size} {shape}: {words:?} in {view:?}");
            assert!(feet.y > view.bottom() - third.y, "{size} {shape}: {words:?} in {view:?}");
            assert!(midline.x < view.left() + third.x, "{size} {shape}: {words:?} in {view:?}");
            assert!(side.x > view.right() - third.x, "{size} {shape}: {words:?} in {view:?}");
        }
    }
}

#[test]
fn the_picture_the_answer_and_the_headline_name_the_time_that_is_shown() {
    let mut harness = app(WIDE, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    let times = ["on the table", "after a week", "after six months"];
    // In sight on the picture, beside the answer.
    let seen = |harness: &Harness<'static, App>| -> Vec<&str> {
        let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        let is_on_picture = |time: &&str| {
            let label = harness.query_by_label(time);
            label.is_some_and(|label| view.contains_rect(label.rect()))
        };
        let found: Vec<&str> = times.into_iter().filter(is_on_picture).collect();
        for time in times {
            let words = format!("Skin: {time}");
            assert_eq!(harness.query_by_label(&words).is_some(), found.contains(&time), "{time}");
            assert_eq!(harness.state().summary().contains(time), found.contains(&time), "{time}");
        }
        found
    };
    let mean = |harness: &Harness<'static, App>| {
        harness.state().outcome().unwrap().contact_pressure_mmhg.unwrap().mean
    };
    let height = |harness: &Harness<'static, App>| {
        let solution = harness.state().session().solution();
        solution.membrane().iter().map(|at| at.z).fold(0.0, f64::max)
    };
    assert!(seen(&harness).is_empty());
    let (table, shape) = (mean(&harness), height(&harness));
    press(&mut harness, "Six months");
    assert_eq!(seen(&harness), ["after six months"]);
    // Shape and numbers are those of the time.
    assert!(mean(&harness) < 0.8 * table && height(&harness) != shape, "{}", mean(&harness));
    press(&mut harness, "Under tension");
    assert_eq!(seen(&harness), ["after six months"]);
    press(&mut harness, "On the table");
    assert_eq!(seen(&harness), ["on the table"]);
    press(&mut harness, "Pin as A");
    press(&mut harness, "A week");
    assert!(
        text_with(&harness, "Time after the operation: this plan A week; A On the table").is_some()
    );
}

/// The texts on the picture with their places, and the place of the handle that moves the implant: all of them move with the camera.
fn seen(harness: &Harness<'static, App>) -> (Vec<(String, egui::Pos2)>, Option<egui::Rect>) {
    let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Text(text) => {
            Some((text.galley.text().to_owned(), text.visual_bounding_rect()))
        }
        _ => None,
    });
    let texts = texts.filter(|(_, rect)| view.contains_rect(*rect));
    let handle = harness.query_by_role_and_label(Role::Button, "Move the implant");
    (texts.map(|(text, rect)| (text, rect.center())).collect(), handle.map(|node| node.rect()))
}

#[test]
fn a_view_is_reached_after_one_click_while_the_pointer_stays_on_its_button() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    wait_for_studies(&mut harness);
    let at = |harness: &Harness<'static, App>, view: &'static str| {
        harness.get_by_role_and_label(Role::Button, view).rect().center()
    };
    let click = |harness: &mut Harness<'static, App>, at: egui::Pos2| {
        harness.hover_at(at);
        harness.drag_at(at);
        harness.drop_at(at);
        harness.run();
        seen(harness)
    };
    let opening = seen(&harness);
    for view in ["Front", "Side", "Top", "All"] {
        let at = at(&harness, view);
        let once = click(&mut harness, at);
        assert_eq!(once, click(&mut harness, at), "{view} stops half-way");
        assert_eq!(once == opening, view == "All", "{view}: {once:?} {opening:?}");
    }
}

#[test]
fn the_wheel_zooms_and_stops_before_the_tissue() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    wait_for_studies(&mut harness);
    let opening = seen(&harness);
    let picture = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
    let zoom = |harness: &mut Harness<'static, App>, turns: u32| {
        harness.hover_at(picture.center() - egui::vec2(80.0, 60.0));
        for _ in 0..turns {
            // Three notches at once.
            harness.event(egui::Event::MouseWheel {
                unit: egui::MouseWheelUnit::Point,
                delta: egui::vec2(0.0, 300.0),
                phase: egui::TouchPhase::Move,
                source: egui::MouseWheelSource::Unknown,
                modifiers: egui::Modifiers::NONE,
            });
        }
        harness.run();
        harness.remove_cursor();
        harness.run();
        seen(harness)
    };
    let near = zoom(&mut harness, 10);
    assert_ne!(near, opening, "the wheel zooms nothing");
    assert_eq!(near, zoom(&mut harness, 2), "the eye goes on into the tissue");
}

#[test]
fn beside_a_drawn_torso_only_head_and_feet_have_words() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    press(&mut harness, "Front");
    harness.run_steps(40);
    for (canvas, expected) in
        [("3-D view", ["feet", "head"]), ("Cross-section", ["midline", "side"])]
    {
        let words = directions_in(&harness, canvas).into_iter().map(|(word, _)| word);
        let words: std::collections::BTreeSet<String> = words.collect();
        assert!(words.iter().eq(&expected), "{canvas}: {words:?}");
    }
}

/// Width of the cross-section's scale bar for a length \[points\].
fn bar(harness: &Harness<'static, App>) -> (String, f32) {
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    let text = harness.output().shapes.iter().find_map(|shape| match &shape.shape {
        egui::Shape::Text(text) if strip.contains_rect(text.visual_bounding_rect()) => {
            let words = text.galley.text();
            (words.ends_with(" cm") || words.ends_with(" mm")).then(|| words.to_owned())
        }
        _ => None,
    });
    // The line of the bar is the longest level one in the lower left corner.
    let lines = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::LineSegment { points: [a, b], .. } => Some((*a, *b)),
        _ => None,
    });
    let level = lines.filter(|(a, b)| (a.y - b.y).abs() < 0.1 && strip.contains(*a));
    let level = level.filter(|(a, _)| (a.x - strip.left() - 16.0).abs() < 0.5);
    (text.unwrap(), level.map(|(a, b)| (b.x - a.x).abs()).fold(0.0, f32::max))
}

#[test]
fn the_scale_of_the_cross_section_follows_from_the_width_and_not_from_the_volume() {
    for chest in [None, Scene::opening().chest] {
        let mut harness = app(DESKTOP, |scene| {
            *scene = flat_plan();
            scene.chest.clone_from(&chest);
        });
        let scale = bar(&harness);
        assert!(scale.1 > 20.0, "{scale:?}");
        for volume in ["225", "400", "452", "150"] {
            type_into(&mut harness, "Volume (ml)", volume);
            assert_eq!(bar(&harness), scale, "{volume} ml");
        }
        harness.state_mut().set_plan("in_place_percent", "30").unwrap();
        settle(&mut harness);
        assert_eq!(bar(&harness), scale, "inserted in part");
        // A wider implant makes it smaller, and back.
        type_into(&mut harness, "Width (cm)", "16");
        assert_ne!(bar(&harness), scale);
        type_into(&mut harness, "Width (cm)", "12");
        assert_eq!(bar(&harness), scale);
    }
}

#[test]
fn without_a_cut_its_direction_waits() {
    let mut harness = researching(DESKTOP, |scene| *scene = flat_plan());
    let is_able = |harness: &Harness<'static, App>| {
        let field = harness.get_by_role_and_label(Role::SpinButton, "Direction of the cut");
        !field.accesskit_node().is_disabled()
    };
    press(&mut harness, "Inside");
    assert!(is_able(&harness));
    press(&mut harness, "Stretch");
    assert!(!is_able(&harness));
}

/// Height of the drawn cross-section of the tissue \[points\].
fn height(harness: &Harness<'static, App>) -> f32 {
    let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
    let meshes = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
        egui::Shape::Mesh(mesh) if strip.expand(1.0).contains_rect(shape.clip_rect) => Some(mesh),
        _ => None,
    });
    // The implant and the tissue; the ground has four corners.
    let points = meshes.filter(|mesh| mesh.vertices.len() > 4).flat_map(|mesh| &mesh.vertices);
    let [low, high] = points.fold([f32::MAX, f32::MIN], |[low, high], vertex| {
        [low.min(vertex.pos.y), high.max(vertex.pos.y)]
    });
    high - low
}

#[test]
fn the_push_is_watched_unfaded_and_changes_neither_plan_nor_answer() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    unfold(&mut harness, "Tissue");
    wait_for_studies(&mut harness);
    let (scene, whole) = (harness.state().session().scene().clone(), height(&harness));
    let solves = harness.state().session().counters().solves;
    let answer = |harness: &Harness<'static, App>| {
        ["Skin stretch", "Cover over implant", "Pressure on the tissue"]
            .map(|card| harness.get_all_by_label(card).count())
    };
    let (cards, summary) = (answer(&harness), harness.state().summary());
    harness.get_by_role_and_label(Role::Button, "Show insertion").click();
    let (mut heights, mut percents) = (Vec::new(), Vec::new());
    let mut time = harness.ctx.input(|input| input.time);
    for _ in 0..2000 {
        time += 0.04;
        harness.input_mut().time = Some(time);
        harness.step();
        if harness.query_by_label("Pause").is_none() {
            if heights.is_empty() {
                continue;
            }
            break;
        }
        heights.push(height(&harness));
        assert_eq!(harness.state().session().scene(), &scene);
        assert_eq!((answer(&harness), harness.state().summary()), (cards, summary.clone()));
        assert!(harness.query_by_label_contains("Computing:").is_none(), "faded");
        let of = |role| harness.get_by_role_and_label(role, "In place (%)");
        let percent = of(Role::SpinButton).value().unwrap();
        assert_eq!(of(Role::Slider).accesskit_node().numeric_value(), percent.parse().ok());
        match harness.query_by_label("Computing the insertion…") {
            // Said from the first frame on; the picture stands still.
            Some(_) => assert_eq!(percent, "100"),
            None => percents.push(percent.parse::<u32>().unwrap()),
        }
    }
    // From flat to in place.
    assert!(percents.windows(2).all(|pair| pair[0] <= pair[1]), "{percents:?}");
    assert!(percents[0] < 10 && percents[percents.len() - 1] > 90, "{percents:?}");
    harness.run();
    let least = heights.iter().copied().fold(f32::MAX, f32::min);
    assert!(least < 0.5 * whole, "{least} of {whole}");
    let steps: std::collections::BTreeSet<i32> = heights.iter().map(|h| (2.0 * h) as i32).collect();
    assert!(steps.len() > 20, "{steps:?}");
    assert!((height(&harness) - whole).abs() < 0.5);
    assert!(!harness.state().session().can_undo());
    assert_eq!(harness.state().session().counters().solves, solves);
}

#[test]
fn the_field_of_the_insertion_has_whole_percent() {
    let mut harness = app(DESKTOP, |scene| {
        *scene = flat_plan();
        scene.insertion = 0.77336;
    });
    unfold(&mut harness, "Tissue");
    let field = harness.get_by_role_and_label(Role::SpinButton, "In place (%)");
    assert_eq!(field.value().as_deref(), Some("77"));
    harness.run();
}

#[test]
fn the_legend_of_a_phone_is_below_the_tissue_beside_the_scale_bar() {
    for size in [PHONE, egui::vec2(844.0, 390.0), egui::vec2(360.0, 640.0)] {
        let mut harness = app(size, |scene| *scene = flat_plan());
        press(&mut harness, "Stretch");
        let view = harness.get_by_role_and_label(Role::Canvas, "3-D view").rect();
        let places = |words: &str| -> Vec<egui::Rect> {
            let texts = harness.output().shapes.iter().filter_map(|shape| match &shape.shape {
                egui::Shape::Text(text) => Some((text.galley.text(), text.visual_bounding_rect())),
                _ => None,
            });
            let texts =
                texts.filter(|(text, rect)| text.contains(words) && view.contains_rect(*rect));
            texts.map(|(_, rect)| rect).collect()
        };
        let [legend] = places("Skin stretch [")[..] else { panic!("one legend") };
        let [scale] = places(" cm")[..] else { panic!("one scale bar") };
        assert!(legend.top() > view.bottom() - 64.0 && legend.bottom() < view.bottom(), "{legend}");
        assert!(legend.left() > scale.right(), "{size}: {legend} {scale}");
    }
}

#[test]
fn the_outline_of_the_implant_in_the_cross_section_has_no_spike() {
    for chest in [None, Some(ChestShape::USUAL), Some(ChestShape::ROUND)] {
        for shape in ["round", "anatomical"] {
            let mut harness =
                app(DESKTOP, |scene| Scene { chest, ..flat_plan() }.clone_into(scene));
            press(&mut harness, shape);
            settle(&mut harness);
            for plane in ["midline to side", "feet to head"] {
                press(&mut harness, plane);
                let strip = harness.get_by_role_and_label(Role::Canvas, "Cross-section").rect();
                let shapes = harness.output().shapes.iter();
                let is_outline = |shape: &&egui::epaint::ClippedShape| {
                    let is_closed = matches!(&shape.shape, egui::Shape::Path(path) if path.closed);
                    is_closed && strip.expand(1.0).contains_rect(shape.clip_rect)
                };
                let outlines: Vec<_> = shapes.filter(is_outline).cloned().collect();
                let [outline] = &outlines[..] else { panic!("one outline") };
                let place = outline.shape.visual_bounding_rect().expand(4.0);
                for drawn in harness.ctx.tessellate(outlines.clone(), 1.0) {
                    let egui::epaint::Primitive::Mesh(mesh) = drawn.primitive else { continue };
                    let is_near = mesh.vertices.iter().all(|vertex| place.contains(vertex.pos));
                    assert!(is_near, "{chest:?} {shape} {plane}: {} {place}", mesh.calc_bounds());
                }
            }
        }
    }
}

#[test]
fn keys_step_the_insertion() {
    let mut harness = app(WIDE, |_| {});
    focus_picture(&mut harness);
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 0.98).abs() < 1e-9);
    harness.key_press(egui::Key::CloseBracket);
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 1.0).abs() < 1e-9);
}

#[test]
fn each_press_of_a_slow_frame_counts() {
    let mut harness = app(WIDE, |_| {});
    focus_picture(&mut harness);
    for pressed in [true, false, true, false, true, false] {
        harness.input_mut().events.push(egui::Event::Key {
            key: egui::Key::OpenBracket,
            physical_key: None,
            pressed,
            repeat: false,
            modifiers: egui::Modifiers::NONE,
        });
    }
    settle(&mut harness);
    assert!((harness.state().session().scene().insertion - 0.94).abs() < 1e-9);
}

#[test]
fn a_colour_the_section_and_the_theme_solve_nothing() {
    let mut harness = researching(WIDE, |_| {});
    let counters = harness.state().session().counters();
    focus_picture(&mut harness);
    for key in [egui::Key::Num1, egui::Key::Num3, egui::Key::Num5] {
        harness.key_press(key);
        harness.step();
    }
    press(&mut harness, "Inside");
    for item in ["Grid", "Areola"] {
        press(&mut harness, "View");
        harness.get_by_role_and_label(Role::CheckBox, item).click();
        harness.run();
    }
    harness.get_by_label("Front").click();
    harness.run();
    // Drawing computes fields; all other counters are unchanged.
    let drawn = harness.state().session().counters();
    assert_eq!(Counters { fields: counters.fields, ..drawn }, counters);
    assert_eq!(drawn.fields - counters.fields, 2);
}

#[test]
fn digits_change_the_colouring_only_with_the_focus_on_the_picture() {
    let mut harness = app(WIDE, |_| {});
    let drawn = |harness: &Harness<'static, App>| harness.state().session().counters().fields;
    let before = drawn(&harness);
    for key in [egui::Key::Num5, egui::Key::Num0, egui::Key::Num3] {
        harness.key_press(key);
        harness.run();
    }
    harness.key_press(egui::Key::OpenBracket);
    settle(&mut harness);
    assert_eq!(drawn(&harness), before);
    assert!((harness.state().session().scene().insertion - 1.0).abs() < 1e-12);
}

#[test]
fn a_standard_view_frames_the_body_again_after_the_picture_had_another_shape() {
    let mut harness = app(DESKTOP, |scene| *scene = flat_plan());
    let handle = |harness: &Harness<'static, App>| {
        harness.get_by_role_and_label(Role::Button, "Move the implant").rect().center()
    };
    for view in ["Front", "Side", "All"] {
        press(&mut harness, view);
        harness.run_steps(40);
        let framed = handle(&harness);
        // Half of the picture's width, and the whole one again.
        press(&mut harness, "Before | after");
        harness.run_steps(4);
        press(&mut harness, view);
        harness.run_steps(40);
        press(&mut harness, "Before | after");
        harness.run_steps(40);
        assert!(handle(&harness).distance(framed) < 1.0, "{view}: {} {framed}", handle(&harness));
    }
}
