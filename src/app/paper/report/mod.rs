//! Picture and report: the composed picture as PNG or in the clipboard, and one HTML file with pictures, plan, results and
//! the plan's file. The report loads nothing and runs no script.
//!
//! `offscreen` (pictures of contents that are not on the screen) | `dialog` (in front of a report) | `figure` (the composed picture), `page` (the HTML), `answers` (its bars), `html` (texts).

mod answers;
mod dialog;
mod figure;
mod html;
mod offscreen;
mod page;

pub(crate) use dialog::{Choice, ReportDialog};

use crate::app::answer::before_after;
use crate::app::answer::compare;
use crate::app::answer::filling::Filling;
use crate::app::answer::practice::{Practices, rule_in_short};
use crate::app::answer::times::PlanTimes;
use crate::app::answer::uncertainty::Findings;
use crate::app::answer::{self, PreviousResults};
use crate::app::answer::{no_answer, plots};
use crate::app::frame::shared::Shared;
use crate::app::frame::{files, status};
use crate::app::picture::viewport::{Before, Options, Shown};
use crate::app::plan;
use crate::app::plan::device::Device;
use crate::app::plan::volume_marks::VolumeMarks;
use crate::app::range::Range;
use crate::app::texts::{self, tr};
use crate::app::widgets::theme::SPACE;
use crate::scene::Scene;
use crate::session::{Pin, Session};
use crate::study::volume_and_width;
use crate::view::camera::Standing;
use crate::view::cross_section::SectionPlane;
use answers::Answers;
use eframe::egui::{self, ColorImage, Ui, Vec2, vec2};
use figure::Figure;
use page::{Page, Picture};

const DISCLAIMER: &str = "Not a medical device: a physical model, no patient's anatomy, healing or blood supply. Do not base a decision on it \
     alone.";
/// Pixels per point of a standard pose.
const POSE_SCALE: f32 = 3.5;
/// Sizes of the report's pictures \[points\] with their pixels per point: of plan and pins side by side, of the cross-section, which its
/// drawing fills, of cross-section and range of half the page's width. The texts of a broader picture would be too small to read.
const PINS: (Vec2, f32) = (vec2(700.0, 180.0), 2.5);
const SECTION: (Vec2, f32) = (vec2(560.0, 330.0), 2.5);
const HALF: (Vec2, f32) = (vec2(430.0, 245.0), 2.0);

/// The composed picture of the plan. Needs the graphics of a frame.
///
/// # Errors
/// Returns why no picture was made.
pub(crate) fn figure(shared: &mut Shared) -> Result<ColorImage, String> {
    let Shared { session, choices, options, uncertainty, viewport, practices, .. } = shared;
    let (session, options, device) = (&*session, &*options, choices.device);
    let practices = &*practices;
    let figure = Figure {
        headline: answer::headline(session, practices, PreviousResults::Shown),
        plan: plan::rows_of_sides(session.scene(), device),
        heading: answer::with_side(tr("What happens"), session),
        cards: cards((session, practices), device, uncertainty.of_cards(session.scene())),
        remarks: remarks(session, device),
        patient: plan::patient_in_words(session.scene()),
        origin: format!("{} · {}", origin(), status::model(session.scene(), true)),
    };
    let envelope = uncertainty.envelope().unwrap_or_default();
    let shown = Shown { envelope, is_on_paper: true, ..Shown::new(session, options, practices) };
    let has_picture = no_answer::has_picture(session);
    let size = figure.size(device, has_picture);
    viewport.aside(|viewport| {
        let gl = viewport.graphics()?;
        offscreen::picture(&gl, device, (size, figure::SCALE), |ui| {
            figure.show(ui, |ui| {
                if has_picture {
                    viewport.show(ui, shown);
                }
            });
        })
    })
}

/// The pictures of the report with what belongs to them, in their order on paper: all drawn while the view is elsewhere.
fn pictures(shared: &mut Shared, range: &mut Range) -> Result<Pictures, String> {
    let has_stand_in = shared.has_stand_in();
    let Shared { session, compare, uncertainty, viewport, choices, practices, .. } = shared;
    let (session, compare, device) = (&*session, &*compare, choices.device);
    let practices = &*practices;
    // The same views in every report, whatever the screen shows.
    let mut options = Options::default();
    // In columns, a third of the page's width on paper, or a fifth; before and after one over the other.
    let is_before_and_after = before_after::has_measures(session);
    if is_before_and_after {
        options.before = Before::Beside;
    }
    let (poses_of_plan, size): (&[Standing], _) = match &session.scene().other_side {
        None => (&Standing::OF_SIDE, vec2(270.0, if is_before_and_after { 470.0 } else { 260.0 })),
        Some(_) => (&Standing::ALL, vec2(162.0, if is_before_and_after { 330.0 } else { 180.0 })),
    };
    let standing = |standing| Shown {
        is_on_paper: true,
        standing: Some(standing),
        ..Shown::new(session, &options, practices)
    };
    // A pin of this plan is its picture.
    let is_other = |pin: &&Pin| !pin.scene().is_same_plan(session.scene());
    let has_pins = session.pins().iter().filter(is_other).any(|pin| pin.solution().is_some());
    let section = uncertainty.findings().map_or(&[][..], Findings::section);
    let range = range.for_report(session);
    viewport.aside(|viewport| {
        let gl = viewport.graphics()?;
        let take = |name: &str, size, add: &mut dyn FnMut(&mut Ui)| {
            let image = offscreen::picture(&gl, device, size, add)?;
            let address = page::data_address(&png_of(&image)?);
            let name = device.words(name);
            Ok::<Picture, String>(Picture { name, address, caption: String::new() })
        };
        let mut poses = Vec::new();
        if no_answer::has_picture(session) {
            for &pose in poses_of_plan {
                let name = name_of_pose(pose, session);
                let name = match has_stand_in {
                    true => tr!("{name}, of a usual torso", name),
                    false => name,
                };
                poses.push(take(&name, (size, POSE_SCALE), &mut |ui| {
                    viewport.show(ui, standing(pose));
                })?);
            }
        }
        let mut pins = None;
        if has_pins {
            let shown = standing(Standing::ThreeQuarter);
            let name = tr("Pins and plan side by side");
            pins = Some(take(name, PINS, &mut |ui| viewport.show_side_by_side(ui, shown))?);
        }
        // An anatomical implant has a shape of its own in each plane.
        let is_round = session.scene().implant.is_round();
        let size = if range.is_ok() || !is_round { HALF } else { SECTION };
        let mut further = Vec::new();
        for plane in plots::PLANES.into_iter().rev() {
            let name = match (is_round, plane) {
                (true, SectionPlane::Along) => continue,
                (true, SectionPlane::Across) => tr("Cross-section").to_owned(),
                (false, _) => {
                    let name = plots::name_of(plane, session.scene());
                    format!("{}, {name}", tr("Cross-section"))
                }
            };
            let name = answer::with_side(&name, session);
            further.push(take(&name, size, &mut |ui| {
                egui::Frame::new().inner_margin(SPACE).show(ui, |ui| {
                    plots::section_chart(ui, session, compare, (section, plane), size.0.y - 48.0);
                });
            })?);
        }
        let mut range = match range {
            Ok(range) => range,
            Err(how) => {
                let (missing, accuracy) = (Some(how), String::new());
                return Ok(Pictures { poses, pins, further, missing, accuracy });
            }
        };
        let [title, caption] = [&range.title, &range.caption].map(|text| device.words(text));
        let title = answer::with_side(&title, session);
        let chart = take(&title, HALF, &mut |ui| {
            egui::Frame::new().inner_margin(SPACE).show(ui, |ui| range.show(ui));
        })?;
        further.push(Picture { caption, ..chart });
        let accuracy = match range.accuracy.as_str() {
            "" => String::new(),
            words => tr!("Range of implants: {words}", words),
        };
        Ok(Pictures { poses, pins, further, missing: None, accuracy })
    })
}

/// The report as HTML text.
///
/// # Errors
/// Returns why no picture was made.
pub(crate) fn report(
    shared: &mut Shared,
    range: &mut Range,
    (filling, times): (&Filling, &PlanTimes),
) -> Result<String, String> {
    let Pictures { poses, pins, further, missing, accuracy } = pictures(shared, range)?;
    let Shared { session, choices, uncertainty, volume_marks, practices, measured, .. } = &*shared;
    let device = choices.device;
    let findings = uncertainty.of_cards(session.scene());
    let sampled = |scene: &_| uncertainty.values(scene);
    let page = Page {
        poses,
        pins,
        further,
        implant: plan::implants_in_words(session.scene(), device),
        missing: missing.map(|how| device.words(how)),
        visit: plan::visit_in_words(session.scene()),
        running: running_head(session.scene()),
        origin: origin(),
        headline: headline(session, practices, volume_marks),
        plan: plan::rows_of_sides(session.scene(), device),
        technical: [
            status::model(session.scene(), true),
            plan::poisson_ratios(session.scene()),
            uncertainty.seed_in_words(session.scene()).unwrap_or_default(),
            accuracy,
        ]
        .into_iter()
        .filter(|words| !words.is_empty())
        .collect(),
        answers: answers((session, practices), device, findings),
        remarks: remarks(session, device),
        table: compare::rows(
            session,
            &sampled,
            practices,
            answer::shares_of_pressure((session, practices), findings),
        ),
        measures: before_after::table(measured, session, before_after::Of::Pins),
        bands: uncertainty.about_bands(session.scene()),
        times: times.table(session.scene()),
        steps: filling.steps(session.scene()),
        limits: answer::limits_in_words(session, practices, device, rule_in_short).to_vec(),
        plan_json: shared.document(),
    };
    Ok(page.html())
}

/// The pictures of a report.
struct Pictures {
    /// The plan in the standard poses; none without a shape.
    poses: Vec<Picture>,
    pins: Option<Picture>,
    /// Cross-section and chart of the range.
    further: Vec<Picture>,
    /// How to get a picture that is missing.
    missing: Option<&'static str>,
    /// Grid and accuracy of the chart of the range; may be empty.
    accuracy: String,
}

/// The answer in one sentence and the largest volume that stays usual, behind its side where each side has a plan of its own.
fn headline(session: &Session, practices: &Practices, volume_marks: &VolumeMarks) -> String {
    let words = answer::headline(session, practices, PreviousResults::Shown);
    let largest = volume_marks.largest_in_words(practices);
    match session.other_side() {
        Some(_) if !largest.is_empty() => {
            format!("{words} {}:{largest}", plan::side_in_a_word(session.scene()))
        }
        _ => words + &largest,
    }
}

/// The name of a standard pose, with its side where each side has a plan of its own.
fn name_of_pose(pose: Standing, session: &Session) -> String {
    let name = match pose {
        Standing::Front => return tr("From the front").to_owned(),
        Standing::ThreeQuarter | Standing::OtherThreeQuarter => tr("Three-quarter view"),
        Standing::Side | Standing::OtherSide => tr("From the patient's side"),
    };
    match (pose, &session.scene().other_side) {
        (Standing::OtherThreeQuarter | Standing::OtherSide, Some(other)) => {
            format!("{name} · {}", plan::side_in_a_word(other))
        }
        _ => answer::with_side(name, session),
    }
}

/// The head of every page on paper: the visit, else the program, and the plan of each side.
fn running_head(scene: &Scene) -> String {
    let [visit, _] = plan::visit_in_words(scene);
    let visit = if visit.is_empty() { tr("Implant preview").to_owned() } else { visit };
    let size = |scene: &Scene| {
        let [volume, width] = volume_and_width(scene).map(texts::localized);
        format!("{volume} ml, {width} cm")
    };
    let of_side = |scene: &Scene| format!("{} {}", plan::side_in_a_word(scene), size(scene));
    let plans = match &scene.other_side {
        None => size(scene),
        Some(other) => format!("{} · {}", of_side(scene), of_side(other)),
    };
    format!("{visit} · {plans}")
}

/// The answers of the plan, and of the other side where it has a plan of its own.
fn answers(
    (session, practices): (&Session, &Practices),
    device: Device,
    findings: Option<&Findings>,
) -> Vec<Answers> {
    let own = cards((session, practices), device, findings);
    let bars = answer::bars((session, practices), findings);
    let of_plan = Answers {
        heading: answer::with_side(tr("What happens"), session),
        cards: own.into_iter().zip(bars).collect(),
    };
    let of_other = session.other_side().map(|other| Answers {
        heading: format!("{} · {}", tr("What happens"), plan::side_in_a_word(other.scene())),
        cards: answer::cards_of_other_side((session, practices), device).unwrap_or_default(),
    });
    [of_plan].into_iter().chain(of_other).collect()
}

/// The cards in words; none without an answer.
fn cards(
    (session, practices): (&Session, &Practices),
    device: Device,
    findings: Option<&Findings>,
) -> Vec<[String; 4]> {
    if no_answer::applies(session) {
        return Vec::new();
    }
    answer::rows((session, practices), device, findings)
}

/// The warnings of the result; without an answer what that means, and what the picture is.
fn remarks(session: &Session, device: Device) -> Vec<String> {
    if no_answer::applies(session) {
        let about_picture = no_answer::about_picture(session);
        let words = device.words(&no_answer::words(session));
        return [words].into_iter().chain(about_picture).collect();
    }
    let outcome = answer::visible(session, PreviousResults::Shown);
    let warning = |warning: &String| device.warning(&texts::shown(warning));
    outcome.map_or_else(Vec::new, |outcome| outcome.warnings.iter().map(warning).collect())
}

/// Date and version, as "2026-01-31, 12:34 UTC · version 0.1.0".
fn origin() -> String {
    tr!(
        "{date} · version {version}",
        date = date_in_words(&files::local_date()),
        version = env!("CARGO_PKG_VERSION")
    )
}

/// A date (RFC 3339) in words with its distance from UTC, as "2026-01-31, 12:34 (UTC+01:00)".
fn date_in_words(date: &str) -> String {
    let Some(minutes) = date.get(..16).map(|minutes| minutes.replace('T', ", ")) else {
        return date.to_owned();
    };
    let zone = date.get(date.len() - 6..).filter(|zone| zone.starts_with(['+', '-']));
    match zone {
        Some(zone) => format!("{minutes} (UTC{})", zone.replace('-', "−")),
        None => format!("{minutes} UTC"),
    }
}

/// A picture as PNG, without transparency.
pub(crate) fn png_of(image: &ColorImage) -> Result<Vec<u8>, String> {
    let [width, height] = image.size;
    let mut content = Vec::new();
    let mut encoder = png::Encoder::new(&mut content, width as u32, height as u32);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    let pixels: Vec<u8> = image.pixels.iter().flat_map(|c| [c.r(), c.g(), c.b()]).collect();
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(&pixels));
    written.map_err(|error| error.to_string())?;
    Ok(content)
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::Color32;

    #[test]
    fn a_date_has_no_seconds() {
        assert_eq!(date_in_words("2026-01-31T12:34:56.789Z"), "2026-01-31, 12:34 UTC");
        assert_eq!(date_in_words("2026-01-31T12:34:56+01:00"), "2026-01-31, 12:34 (UTC+01:00)");
        assert_eq!(date_in_words("2026-01-31T12:34:56-03:30"), "2026-01-31, 12:34 (UTC−03:30)");
        assert_eq!(date_in_words("now"), "now");
    }

    #[test]
    fn a_png_has_the_pixels_of_its_picture() {
        let pixels = vec![Color32::RED, Color32::GREEN, Color32::BLUE, Color32::WHITE];
        let content = png_of(&ColorImage::new([2, 2], pixels)).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(content)).read_info().unwrap();
        let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut bytes).unwrap();
        assert_eq!((info.width, info.height), (2, 2));
        assert_eq!(bytes[..12], [255, 0, 0, 0, 255, 0, 0, 0, 255, 255, 255, 255]);
    }
}
