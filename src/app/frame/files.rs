//! Opening and saving of files: dialogs and dropped files, in the background, on the desktop and in the
//! page.

use crate::app::plan::device::Device;
use crate::app::texts::{shown, tr};
use crate::body::marks::Marks;
use crate::body::propose::propose;
use crate::body::read::{self, Format, Read};
use crate::clinical::Draft;
use crate::scene::{MAX_SCENE_BYTES, Scene, Side};
use crate::study::volume_and_width;
use crate::table::decode;
use eframe::egui::{Context, DroppedFileHandle};
use std::sync::mpsc::{Receiver, Sender, channel};
use web_time::{Duration, Instant};

/// Extensions of tables of sizes; other files are scenes.
const TABLES: [&str; 3] = ["csv", "tsv", "txt"];

/// Is the file of this name a table of sizes?
pub(crate) fn is_table(name: &str) -> bool {
    let extension = name.rsplit_once('.').map(|(_, extension)| extension.to_lowercase());
    extension.is_some_and(|extension| TABLES.contains(&&*extension))
}

/// Is the file of this name a body's surface?
fn is_surface(name: &str) -> bool {
    let extension = name.rsplit_once('.').map(|(_, extension)| extension);
    extension.is_some_and(|extension| Format::of_extension(extension).is_some())
}

/// Extension of reports.
pub(crate) const REPORT: &str = "html";

/// Time within which no user cancels a dialog.
const LEAST_DIALOG: Duration = Duration::from_millis(300);
/// Greatest number of characters of a reference in the name of a file.
const MAX_NAME: usize = 40;

/// The name of a file with the visit: device, the maker's name of the size, volume, date of the visit or of today, reference and an
/// extension, as "implant-MM-240-240ml-2026-11-25-4711.html"; `what` stands before the extension.
pub(crate) fn name_with_visit(
    scene: &Scene,
    device: Device,
    what: &str,
    extension: &str,
) -> String {
    let visit = scene.visit.clone().unwrap_or_default();
    name(scene, device, (visit.date, &visit.reference), what, extension)
}

/// The name of a file without the visit: device, the maker's name, volume and today's date, as "implant-300ml-2026-11-25-numbers.csv"; `what`
/// stands before the extension.
pub(crate) fn name_without_visit(
    scene: &Scene,
    device: Device,
    what: &str,
    extension: &str,
) -> String {
    name(scene, device, (String::new(), ""), what, extension)
}

/// The name of a file of a plan with the implant's size and the visit, as "tissue-12cm-300ml-2026-11-25-4711.stl"; a file of the implant
/// alone has its volume and, where one is stated, the maker's name, as "implant-MM-240-240ml-2026-11-25-4711.glb".
pub(crate) fn name_with_size(scene: &Scene, device: Device, what: &str, extension: &str) -> String {
    let [volume, width] = volume_and_width(scene);
    let (what, implant) = (device.english(what), device.english("implant"));
    let size = match what == implant {
        true => makers_name(scene).unwrap_or_default(),
        false => format!("{}cm", width.replace(" × ", "x")),
    };
    let reference = scene.visit.as_ref().map_or("", |visit| &visit.reference);
    let [date, reference] = [date_of_visit(scene), word_of_name(reference)];
    joined([what, size, format!("{volume}ml"), date, reference], extension)
}

/// The name of a file of a patient without an implant, as "body-before-2026-11-25-4711.ply".
pub(crate) fn name_with_patient(scene: &Scene, what: &str, extension: &str) -> String {
    let reference = scene.visit.as_ref().map_or("", |visit| &visit.reference);
    joined([what.to_owned(), date_of_visit(scene), word_of_name(reference)], extension)
}

fn name(
    scene: &Scene,
    device: Device,
    (date, reference): (String, &str),
    what: &str,
    extension: &str,
) -> String {
    let device = device.english("implant");
    let size = sizes_of_sides(scene).unwrap_or_else(|| {
        let [volume, _] = volume_and_width(scene);
        let maker = makers_name(scene).map(|maker| format!("{maker}-")).unwrap_or_default();
        format!("{maker}{volume}ml")
    });
    let parts = [device, size, dated(date), word_of_name(reference), what.to_owned()];
    joined(parts, extension)
}

/// The volumes of both sides where they differ, as "left-300ml-right-260ml".
fn sizes_of_sides(scene: &Scene) -> Option<String> {
    let sides = [scene, scene.other_side.as_deref()?];
    let [own, other] = sides.map(|scene| volume_and_width(scene)[0].clone());
    let of = |scene: &Scene, volume: &str| {
        let side = scene.side.map_or("", Side::word);
        format!("{side}-{volume}ml")
    };
    (own != other).then(|| format!("{}-{}", of(sides[0], &own), of(sides[1], &other)))
}

/// The date of a plan's visit, or today's.
pub(crate) fn date_of_visit(scene: &Scene) -> String {
    dated(scene.visit.as_ref().map(|visit| visit.date.clone()).unwrap_or_default())
}

/// A date, or today's in place of none.
fn dated(date: String) -> String {
    if date.is_empty() { today() } else { date }
}

/// The parts that are not empty as the name of a file.
fn joined<const N: usize>(parts: [String; N], extension: &str) -> String {
    let parts: Vec<String> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    format!("{}.{extension}", parts.join("-"))
}

/// The maker's name of the size as a part of a file's name, without the volume that stands behind it.
fn makers_name(scene: &Scene) -> Option<String> {
    let name = scene.implant_reference.split(" · ").next().map(word_of_name);
    name.filter(|name| !name.is_empty())
}

/// A text as a part of a file's name on every system: letters, digits and hyphens; what is between them is one hyphen.
fn word_of_name(text: &str) -> String {
    let signs: String = text.chars().map(|c| if c.is_alphanumeric() { c } else { ' ' }).collect();
    let words: Vec<&str> = signs.split_whitespace().collect();
    words.join("-").chars().take(MAX_NAME).collect()
}

/// Result of a file operation in the background.
pub(crate) enum FileEvent {
    /// The text of a file that was read.
    Opened { name: String, text: String },
    /// A body's surface, and its marks as its shape suggests them.
    Surface { name: String, read: Box<Read>, proposed: Option<Box<Marks>> },
    /// The name of a file that was written.
    Saved(String),
    /// An error message of one line.
    Failed(String),
}

/// Channel between file operations in the background and the app.
pub(crate) struct Files {
    sender: Sender<FileEvent>,
    receiver: Receiver<FileEvent>,
}

impl Files {
    pub(crate) fn new() -> Self {
        let (sender, receiver) = channel();
        Self { sender, receiver }
    }

    /// Returns the next event, if there is one.
    pub(crate) fn next(&self) -> Option<FileEvent> {
        self.receiver.try_recv().ok()
    }

    /// Opens a dialog for a scene file or a body's surface and reads the file.
    pub(crate) fn open(&self, ctx: &Context) {
        self.pick(ctx, tr("Plan or scan"), &["json", "html", "ply", "stl", "obj", "glb"]);
    }

    /// Opens a dialog for a table of sizes and reads the file.
    pub(crate) fn open_table(&self, ctx: &Context) {
        self.pick(ctx, tr("Table"), &TABLES);
    }

    fn pick(&self, ctx: &Context, kind: &str, extensions: &[&str]) {
        let dialog = rfd::AsyncFileDialog::new().add_filter(kind, extensions).pick_file();
        self.run(ctx, async move {
            let file = match chosen(dialog).await {
                Ok(file) => file,
                Err(event) => return event,
            };
            let name = file.file_name();
            Some(content_of(name, Ok(file.read().await)))
        });
    }

    /// Opens a dialog for a file name and writes the content.
    #[cfg(not(target_arch = "wasm32"))]
    pub(crate) fn save(&self, ctx: &Context, suggestion: &str, content: impl Into<Vec<u8>>) {
        let content = content.into();
        let extension = suggestion.rsplit('.').next().unwrap_or_default();
        let dialog = rfd::AsyncFileDialog::new()
            .add_filter(extension.to_uppercase(), &[extension])
            .set_file_name(suggestion)
            .save_file();
        self.run(ctx, async move {
            let file = match chosen(dialog).await {
                Ok(file) => file,
                Err(event) => return event,
            };
            let name = file.file_name();
            Some(match file.write(&content).await {
                Ok(()) => FileEvent::Saved(name),
                Err(error) => FileEvent::Failed(tr!("{name} was not saved: {error}", name, error)),
            })
        });
    }

    /// Passes the content to the browser's downloads. A dialog in the page could only report that a download
    /// was offered, not that the file was saved.
    #[cfg(target_arch = "wasm32")]
    pub(crate) fn save(&self, _: &Context, name: &str, content: impl Into<Vec<u8>>) {
        let name = name.to_owned();
        let event = match download(&name, &content.into()) {
            Ok(()) => FileEvent::Saved(name),
            Err(error) => FileEvent::Failed(tr!(
                "{name} was not saved: {error}",
                name,
                error = format_args!("{error:?}")
            )),
        };
        // `self` owns the receiver, so sending cannot fail.
        let _ = self.sender.send(event);
    }

    /// Reads a file dropped on the window.
    pub(crate) fn dropped(&self, ctx: &Context, file: DroppedFileHandle) {
        self.run(ctx, async move {
            let name = file
                .path()
                .file_name()
                .map_or_else(|| "dropped file".to_owned(), |n| n.to_string_lossy().into_owned());
            #[cfg(target_arch = "wasm32")]
            let bytes = file.bytes_async().await;
            #[cfg(not(target_arch = "wasm32"))]
            let bytes = file.bytes();
            Some(content_of(name, bytes))
        });
    }

    #[cfg(not(target_arch = "wasm32"))]
    fn run(&self, ctx: &Context, job: impl Future<Output = Option<FileEvent>> + Send + 'static) {
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        std::thread::spawn(move || {
            if let Some(event) = pollster::block_on(job) {
                // Sending fails if the app was closed in the meantime.
                let _ = sender.send(event);
                ctx.request_repaint();
            }
        });
    }

    #[cfg(target_arch = "wasm32")]
    fn run(&self, ctx: &Context, job: impl Future<Output = Option<FileEvent>> + 'static) {
        let (sender, ctx) = (self.sender.clone(), ctx.clone());
        wasm_bindgen_futures::spawn_local(async move {
            if let Some(event) = job.await {
                let _ = sender.send(event);
                ctx.request_repaint();
            }
        });
    }
}

/// The file that a user chose in a dialog; without a file nothing, or the error of a system without dialogs.
async fn chosen(
    dialog: impl Future<Output = Option<rfd::FileHandle>>,
) -> Result<rfd::FileHandle, Option<FileEvent>> {
    let start = Instant::now();
    dialog.await.ok_or_else(|| {
        let is_missing = cfg!(target_os = "linux") && start.elapsed() < LEAST_DIALOG;
        let error = tr("This system has no dialog for files; install zenity or a desktop portal.");
        is_missing.then(|| FileEvent::Failed(error.to_owned()))
    })
}

/// Present date and time (UTC, RFC 3339).
pub(crate) fn date() -> String {
    #[cfg(target_arch = "wasm32")]
    return js_sys::Date::new_0().to_iso_string().into();
    #[cfg(not(target_arch = "wasm32"))]
    jiff::Timestamp::now().strftime("%Y-%m-%dT%H:%M:%SZ").to_string()
}

/// Present date and time of the machine's time zone with its distance from UTC (RFC 3339).
pub(crate) fn local_date() -> String {
    #[cfg(target_arch = "wasm32")]
    {
        let now = js_sys::Date::new_0();
        // Minutes west of UTC.
        let offset = -now.get_timezone_offset() as i32;
        let sign = if offset < 0 { '-' } else { '+' };
        format!(
            "{}T{:02}:{:02}:{:02}{sign}{:02}:{:02}",
            today(),
            now.get_hours(),
            now.get_minutes(),
            now.get_seconds(),
            offset.abs() / 60,
            offset.abs() % 60
        )
    }
    #[cfg(not(target_arch = "wasm32"))]
    jiff::ZonedDateTime::now().strftime("%Y-%m-%dT%H:%M:%S%:z").to_string()
}

/// Present day of the machine's time zone as 2026-01-31.
pub(crate) fn today() -> String {
    #[cfg(target_arch = "wasm32")]
    {
        let now = js_sys::Date::new_0();
        format!("{:04}-{:02}-{:02}", now.get_full_year(), now.get_month() + 1, now.get_date())
    }
    #[cfg(not(target_arch = "wasm32"))]
    jiff::ZonedDateTime::now().date().to_string()
}

#[cfg(target_arch = "wasm32")]
fn download(name: &str, content: &[u8]) -> Result<(), wasm_bindgen::JsValue> {
    use wasm_bindgen::JsCast as _;
    let document = web_sys::window().and_then(|w| w.document()).ok_or("there is no document")?;
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(content));
    let address = web_sys::Url::create_object_url_with_blob(
        &web_sys::Blob::new_with_u8_array_sequence(&parts)?,
    )?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&address);
    link.set_download(name);
    link.click();
    // The address is not revoked: some browsers read the data only after the click.
    Ok(())
}

fn content_of(name: String, bytes: Result<Vec<u8>, String>) -> FileEvent {
    let bytes = match bytes {
        Ok(bytes) => bytes,
        Err(error) => return FileEvent::Failed(tr!("{name} cannot be read: {error}", name, error)),
    };
    if is_surface(&name) {
        return match read::read(&bytes, &name) {
            Ok(read) => {
                let proposed = propose(&read.surface).ok().map(Box::new);
                FileEvent::Surface { name, read: Box::new(read), proposed }
            }
            Err(error) => {
                let error = shown(&error.to_string());
                FileEvent::Failed(tr!("{name} cannot be read: {error}", name, error))
            }
        };
    }
    if bytes.len() > MAX_SCENE_BYTES {
        let megabytes = bytes.len() / 1_000_000;
        return FileEvent::Failed(tr!(
            "{name} has {megabytes} MB; allowed: up to 10 MB",
            name,
            megabytes
        ));
    }
    let text = if is_table(&name) { Draft::text_of(&bytes) } else { decode(&bytes) };
    match text {
        Ok(text) => FileEvent::Opened { text: text.into_owned(), name },
        Err(error) => FileEvent::Failed(tr!(
            "{name} {error}; allowed: a scene (JSON), a scan (PLY, STL, OBJ, GLB) or a table of sizes (CSV)",
            name,
            error = shown(&error.to_string())
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Visit;

    /// The opening plan with a visit.
    fn visited() -> Scene {
        let visit = Visit {
            reference: "K. M. 4711".to_owned(),
            date: "2026-11-25".to_owned(),
            ..Visit::default()
        };
        Scene { visit: Some(visit), ..Scene::opening() }
    }

    #[test]
    fn a_name_has_the_size_the_date_and_the_patient() {
        let mut scene = visited();
        let name = |scene: &Scene, what| name_with_size(scene, Device::Implant, what, "glb");
        assert_eq!(name(&scene, "implant"), "implant-225ml-2026-11-25-K-M-4711.glb");
        assert_eq!(name(&scene, "tissue"), "tissue-12cm-225ml-2026-11-25-K-M-4711.glb");
        let before = name_with_patient(&scene, "body-before", "ply");
        assert_eq!(before, "body-before-2026-11-25-K-M-4711.ply");
        assert_eq!(
            name_with_size(&scene, Device::Expander, "implant", "stl"),
            "expander-225ml-2026-11-25-K-M-4711.stl"
        );
        scene.implant.base_radius_mm = 57.5;
        scene.implant.base_height_mm = Some(108.0);
        let [volume, _] = volume_and_width(&scene);
        let skin = format!("skin-11.5x10.8cm-{volume}ml-2026-11-25-K-M-4711.glb");
        assert_eq!(name(&scene, "skin"), skin);
        scene.visit = None;
        let today = today();
        assert_eq!(name(&scene, "implant"), format!("implant-{volume}ml-{today}.glb"));
    }

    #[test]
    fn a_name_has_the_makers_name_of_the_size() {
        let mut scene = visited();
        scene.implant_reference = "MM/240 · 240 cc".to_owned();
        let name = |what| name_with_size(&scene, Device::Implant, what, "glb");
        assert_eq!(name("implant"), "implant-MM-240-225ml-2026-11-25-K-M-4711.glb");
        assert_eq!(name("tissue"), "tissue-12cm-225ml-2026-11-25-K-M-4711.glb");
        let report = name_with_visit(&scene, Device::Implant, "", "html");
        assert_eq!(report, "implant-MM-240-225ml-2026-11-25-K-M-4711.html");
    }

    #[test]
    fn a_name_has_the_sizes_of_both_sides_where_they_differ() {
        let mut scene = visited();
        scene.add_other_side().unwrap();
        let name = |scene: &Scene| name_with_visit(scene, Device::Implant, "", "html");
        assert_eq!(name(&scene), "implant-225ml-2026-11-25-K-M-4711.html");
        scene.other_side.as_mut().unwrap().implant.projection_mm *= 0.8;
        assert_eq!(name(&scene), "implant-left-225ml-right-180ml-2026-11-25-K-M-4711.html");
    }

    #[test]
    fn a_part_of_a_name_has_no_sign_that_a_system_refuses() {
        for (text, word) in [
            ("K. M. 4711", "K-M-4711"),
            ("../a\\b:c*?\"<>|", "a-b-c"),
            ("Ñandú 7", "Ñandú-7"),
            (" .. ", ""),
            ("", ""),
        ] {
            assert_eq!(word_of_name(text), word, "{text}");
        }
        assert_eq!(word_of_name(&"a".repeat(100)).len(), MAX_NAME);
    }
}
