//! The plan in an opened file: the file of a plan, a report or saved numbers.
//!
//! Uses `texts`. Used by `logic`.

use crate::app::texts::tr;
use serde_json::Value;

/// Members of which the file of a plan has one at least.
const MEMBERS: [&str; 8] = [
    "schema",
    "implant",
    "layers",
    "patient",
    "pocket_radius_mm",
    "tissue_model",
    "insertion",
    "solver",
];
const NO_PLAN: &str = "The file holds no plan. Allowed: a plan (JSON), a report (HTML) or numbers (JSON) that were saved here, a scan \
                       (PLY, STL, OBJ, GLB) or a table of sizes (CSV).";

/// The plan of a file as JSON text.
///
/// # Errors
/// Returns one line, if the file holds no plan.
pub(crate) fn plan_of(text: String) -> Result<String, String> {
    let no_plan = || Err(tr(NO_PLAN).to_owned());
    let start = text.trim_start();
    if start.starts_with('<') {
        let plan = plan_of_report(start);
        return plan.filter(|plan| is_plan(plan)).map_or_else(no_plan, Ok);
    }
    // A text that only begins as a plan is named with the place of its error.
    if !start.starts_with('{') {
        return no_plan();
    }
    match serde_json::from_str::<Value>(&text) {
        Ok(Value::Object(mut file)) if file.contains_key("program_version") => {
            file.remove("scene").map_or_else(no_plan, |scene| Ok(scene.to_string()))
        }
        Ok(file) if !has_members(&file) => no_plan(),
        _ => Ok(text),
    }
}

/// Has a text members of a plan?
fn is_plan(text: &str) -> bool {
    serde_json::from_str(text).is_ok_and(|file| has_members(&file))
}

/// An empty object is the plan of the defaults.
fn has_members(file: &Value) -> bool {
    let has_one = |file: &serde_json::Map<String, Value>| {
        file.is_empty() || MEMBERS.iter().any(|member| file.contains_key(*member))
    };
    file.as_object().is_some_and(has_one)
}

/// The text of the last preformatted part of a report: its plan's file.
fn plan_of_report(html: &str) -> Option<String> {
    let (_, rest) = html.rsplit_once("<pre>")?;
    let (text, _) = rest.split_once("</pre>")?;
    // The last of all: a replaced sign begins no other one.
    let signs = [("&lt;", "<"), ("&gt;", ">"), ("&quot;", "\""), ("&#39;", "'"), ("&amp;", "&")];
    Some(signs.iter().fold(text.to_owned(), |text, (name, sign)| text.replace(name, sign)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;

    #[test]
    fn a_report_and_saved_numbers_hold_their_plan() {
        let plan = Scene::opening().to_json();
        let html = format!(
            "<!doctype html><html><body><pre>x</pre><details><pre>{}</pre></details></body></html>",
            plan.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
        );
        let numbers =
            format!("{{\"strain\": 1, \"scene\": {plan}, \"program_version\": \"0.1.0\"}}");
        for file in [plan.clone(), html, numbers] {
            let read = plan_of(file).unwrap();
            assert_eq!(Scene::from_json(&read).unwrap(), Scene::opening());
        }
    }

    #[test]
    fn a_foreign_file_is_refused_in_a_users_words() {
        for file in [
            "{\"a\": 1}",
            "[1, 2]",
            "<svg></svg>",
            "<html><pre>{}x</pre></html>",
            "\u{1}noise",
            "",
            "12",
        ] {
            assert_eq!(plan_of(file.to_owned()).unwrap_err(), NO_PLAN, "{file}");
        }
        // A damaged plan goes on to the reader, which names the place.
        assert!(plan_of("{\"implant\": ".to_owned()).is_ok());
        assert_eq!(plan_of("{}".to_owned()).unwrap(), "{}");
    }
}
