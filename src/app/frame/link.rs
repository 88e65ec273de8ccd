//! A link with the whole plan and its pins: the plan's file, compressed (deflate, RFC 1951), as base64 of addresses
//! (RFC 4648 §5), in the fragment of the page's address. Browsers send no fragment to a server. The link leaves out the visit.

use crate::scene::MAX_SCENE_BYTES;
use crate::session::Session;
use base64::Engine as _;
use base64::engine::general_purpose::URL_SAFE_NO_PAD;

/// What precedes the plan in a fragment.
const START: &str = "#plan=";
/// Level of the compression, 0 to 10: a plan takes a millisecond.
const LEVEL: u8 = 10;

/// The plan in the fragment of an address, as the JSON text of a file; `None` without a plan.
pub(crate) fn plan_of(fragment: &str) -> Option<Result<String, String>> {
    fragment.strip_prefix(START).map(plan)
}

/// The link of the session's plan on the page of an address.
pub(crate) fn link(address: &str, session: &Session) -> String {
    format!("{address}{START}{}", text(&session.shared_document_json()))
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
