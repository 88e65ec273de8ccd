//! The order of the modules: imports point to modules further left only.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

/// The modules from left to right, as in ARCHITECTURE.md.
const ORDER: [&str; 14] = [
    "curve",
    "springs",
    "mesh",
    "contact",
    "model",
    "solve",
    "measure",
    "scene",
    "simulate",
    "session",
    "experiment",
    "view",
    "app",
    "platform",
];

fn source() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src")
}

fn files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            files(&path, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
}

/// The module of a file: the first part of its path in `src`.
fn module(path: &Path) -> String {
    let inside = path.strip_prefix(source()).unwrap();
    inside.components().next().unwrap().as_os_str().to_string_lossy().replace(".rs", "")
}

/// The modules that a file names, without its comments and its own tests.
fn imports(text: &str) -> BTreeSet<String> {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    lines
        .flat_map(|line| line.split("crate::").skip(1))
        .map(|rest| rest.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect())
        .collect()
}

/// Imports against the order, as "file imports module".
fn against_the_order(sources: &[(String, String, String)]) -> Vec<String> {
    let index = |module: &str| ORDER.iter().position(|name| *name == module);
    let mut found = Vec::new();
    for (file, module, text) in sources {
        let here =
            index(module).unwrap_or_else(|| panic!("{file}: {module} is missing in the order"));
        for import in imports(text) {
            if index(&import).is_some_and(|there| there > here) {
                found.push(format!("{file} imports {import}"));
            }
        }
    }
    found
}

#[test]
fn imports_point_to_modules_further_left() {
    let mut paths = Vec::new();
    files(&source(), &mut paths);
    let sources: Vec<_> = paths
        .iter()
        .map(|path| {
            (path.display().to_string(), module(path), std::fs::read_to_string(path).unwrap())
        })
        .filter(|(_, module, _)| module != "lib" && module != "main")
        .collect();
    assert!(sources.len() > 100, "{} files", sources.len());
    let found = against_the_order(&sources);
    assert!(found.is_empty(), "{found:#?}");
}

#[test]
fn an_import_to_the_right_is_found() {
    let file = |text: &str| vec![("a.rs".to_owned(), "measure".to_owned(), text.to_owned())];
    assert_eq!(against_the_order(&file("use crate::scene::Scene;")), ["a.rs imports scene"]);
    assert_eq!(against_the_order(&file("let x = crate::view::color::table();")).len(), 1);
    assert!(against_the_order(&file("use crate::solve::Solver;\n// crate::app::App")).is_empty());
}
