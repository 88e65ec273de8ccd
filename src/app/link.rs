//! A link with the whole plan and its pins: the plan's file, compressed (deflate, RFC 1951), as base64 of addresses
//! (RFC 4648 §5), in the fragment of the page's address. Browsers send no fragment to a server. The link leaves out the visit.

use super::App;
use super::messages::{Notice, Severity};
use super::texts::tr;
use crate::scene::MAX_SCENE_BYTES;
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;
use eframe::egui;

/// What precedes the plan in a fragment.
const START: &str = "#plan=";
/// Level of the compression, 0 to 10: a plan takes a millisecond.
const LEVEL: u8 = 10;

impl App {
    /// Sets the address of the page without its fragment; links start with it.
    pub fn set_page_address(&mut self, address: String) {
        self.page_address = Some(address);
    }

    /// Opens the plan in the fragment of an address; a fragment without a plan changes nothing. Returns whether there was one.
    pub fn open_link(&mut self, fragment: &str) -> bool {
        let Some(text) = fragment.strip_prefix(START) else { return false };
        let before = self.session.scene().clone();
        let opened = plan(text).and_then(|json| self.open(json).map_err(|e| e.to_string()));
        let is_changed = !before.is_same_plan(self.session.scene());
        let done = tr("Opened the plan of the link. Undo brings the previous one back.").to_owned();
        let notice = self.show_opened(opened, tr("The link"), done);
        // The page of a link that was open already says nothing.
        self.notice = (is_changed || notice.severity == Severity::Error).then_some(notice);
        self.request_frame();
        true
    }

    /// Copies the link of the plan, in a page.
    pub(super) fn copy_link(&mut self, ctx: &egui::Context, address: &str) {
        let link = format!("{address}{START}{}", text(&self.session.shared_document_json()));
        let length = link.len();
        ctx.copy_text(link);
        let left_out = match self.session.scene().visit {
            Some(_) => tr(", without the entries for the file"),
            None => "",
        };
        self.notice = Some(Notice::info(tr!(
            "The link is in the clipboard: {length} characters, which hold the whole plan{left_out}. Nothing is stored \
             elsewhere.",
            length,
            left_out
        )));
    }
}

/// A file as text for an address.
fn text(json: &str) -> String {
    URL_SAFE_NO_PAD.encode(miniz_oxide::deflate::compress_to_vec(json.as_bytes(), LEVEL))
}

/// The file in the text of an address.
fn plan(text: &str) -> Result<String, String> {
    const DAMAGED: &str = "The link is damaged or cut; allowed: a link as copied";
    let bytes = URL_SAFE_NO_PAD.decode(text).map_err(|_| DAMAGED)?;
    let json = miniz_oxide::inflate::decompress_to_vec_with_limit(&bytes, MAX_SCENE_BYTES);
    Ok(String::from_utf8(json.map_err(|_| DAMAGED)?).map_err(|_| DAMAGED)?)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn a_text_of_an_address_holds_its_file() {
        let json = Scene::opening().to_json();
        let link = text(&json);
        assert_eq!(plan(&link).unwrap(), json);
        assert!(link.len() < 1500, "{} characters", link.len());
        assert!(link.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_'));
    }

    #[test]
    fn a_damaged_text_is_refused_in_one_line() {
        let link = text(&Scene::opening().to_json());
        for damaged in ["", "%%%", "AAAA", &link[..link.len() / 2]] {
            let error = plan(damaged).unwrap_err();
            assert!(error.contains("allowed") && !error.contains('\n'), "{damaged}: {error}");
        }
    }

    #[test]
    fn a_text_that_unpacks_beyond_the_limit_of_a_file_is_refused() {
        let bomb = text(&" ".repeat(MAX_SCENE_BYTES + 1));
        assert!(bomb.len() < 100_000);
        plan(&bomb).unwrap_err();
    }
}
