//! The order of the modules of all crates: imports point to modules further left only, and no files import each other
//! in a circle.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The modules from left to right, as in ARCHITECTURE.md; of body, charts, lab and view the crate.
const ORDER: [&str; 22] = [
    "number", "curve", "springs", "mesh", "contact", "model", "solve", "measure", "export", "body",
    "table", "tensile", "clinical", "scene", "simulate", "study", "session", "charts", "lab",
    "view", "app", "platform",
];

/// The sources of the crates, from left to right.
const CRATES: [&str; 7] =
    ["solver/src", "body/src", "core/src", "charts/src", "lab/src", "view/src", "src"];

/// All files of all crates.
fn all_files() -> Vec<PathBuf> {
    let mut found = Vec::new();
    for source in CRATES {
        files(&Path::new(env!("CARGO_MANIFEST_DIR")).join(source), &mut found);
    }
    found
}

/// The path of a file in its crate's `src`, of body, charts, lab and view in the crate's name.
fn inside(path: &Path) -> PathBuf {
    let root = path.strip_prefix(env!("CARGO_MANIFEST_DIR")).unwrap();
    let source = CRATES.into_iter().find(|source| root.starts_with(source)).unwrap();
    let inside = root.strip_prefix(source).unwrap();
    match source {
        "solver/src" | "core/src" | "src" => inside.to_owned(),
        _ => Path::new(source).parent().unwrap().join(inside),
    }
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
    inside(path).components().next().unwrap().as_os_str().to_string_lossy().replace(".rs", "")
}

/// The code of a file without its comments and its own tests; names of other crates are paths of modules there.
fn code_of(module: &str, text: &str) -> String {
    let code = text.split("#[cfg(test)]\nmod ").next().unwrap();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: String = lines.collect::<Vec<_>>().join(" ");
    let own = match module.split("::").next() {
        Some(name @ ("body" | "charts" | "lab" | "view")) => format!("crate::{name}::"),
        _ => "crate::".to_owned(),
    };
    code.replace("crate::", &own)
        .replace("implant_preview_solver::", "crate::")
        .replace("implant_preview_core::", "crate::")
        .replace("implant_preview_", "crate::")
}

/// The modules that a file names.
fn imports(module: &str, text: &str) -> BTreeSet<String> {
    code_of(module, text)
        .split("crate::")
        .skip(1)
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
        for import in imports(module, text) {
            if index(&import).is_some_and(|there| there > here) {
                found.push(format!("{file} imports {import}"));
            }
        }
    }
    found
}

#[test]
fn imports_point_to_modules_further_left() {
    let paths = all_files();
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

/// The module path of a file, as "solve::fas::level".
fn module_path(path: &Path) -> String {
    let inside = inside(path).with_extension("");
    let parts: Vec<_> = inside.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    parts.into_iter().filter(|part| part != "mod").collect::<Vec<_>>().join("::")
}

/// The files that a file imports from, by their module paths. Imports between a folder's own `mod.rs` and the
/// files of the folder are left out: they are one module in parts.
fn imported_files(module: &str, text: &str, modules: &BTreeSet<String>) -> BTreeSet<String> {
    let code = code_of(module, text);
    let mut found = BTreeSet::new();
    let parent = |path: &str| path.rsplit_once("::").map_or("", |(parent, _)| parent).to_owned();
    for (keyword, base) in [
        ("crate::", String::new()),
        ("super::super::", parent(&parent(module))),
        (" super::", parent(module)),
    ] {
        for rest in code.split(keyword).skip(1) {
            let is_path = |c: &char| c.is_alphanumeric() || "_:".contains(*c);
            let stem: String = rest.chars().take_while(is_path).collect();
            // `a::{b, c::d}` names a::b and a::c::d.
            let list = rest[stem.len()..].strip_prefix('{').and_then(|list| list.split('}').next());
            for item in list.unwrap_or_default().split(',') {
                let item: String = item.trim().chars().take_while(is_path).collect();
                let path = format!("{stem}{item}");
                let mut target = if base.is_empty() { path } else { format!("{base}::{path}") };
                while !target.is_empty() && !modules.contains(&target) {
                    target = parent(&target);
                }
                let is_own = module.starts_with(&format!("{target}::"))
                    || target.starts_with(&format!("{module}::"));
                if !target.is_empty() && target != module && !is_own {
                    found.insert(target);
                }
            }
        }
    }
    found
}

/// A circle of imports, if there is one.
fn circle(imports: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn walk(
        file: &str,
        imports: &BTreeMap<String, BTreeSet<String>>,
        path: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = path.iter().position(|seen| seen == file) {
            return Some(path[start..].to_vec());
        }
        if !done.insert(file.to_owned()) {
            return None;
        }
        path.push(file.to_owned());
        let found = imports[file].iter().find_map(|next| walk(next, imports, path, done));
        path.pop();
        found
    }
    let mut done = BTreeSet::new();
    imports.keys().find_map(|file| walk(file, imports, &mut Vec::new(), &mut done))
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let paths = all_files();
    let modules: BTreeSet<String> = paths.iter().map(|path| module_path(path)).collect();
    let imports: BTreeMap<_, _> = paths
        .iter()
        .map(|path| {
            let (module, text) = (module_path(path), std::fs::read_to_string(path).unwrap());
            let imports = imported_files(&module, &text, &modules);
            (module, imports)
        })
        .collect();
    assert!(imports.values().map(BTreeSet::len).sum::<usize>() > 300);
    assert_eq!(circle(&imports), None);
}

#[test]
fn a_circle_of_imports_is_found() {
    let modules: BTreeSet<String> =
        ["a", "a::b", "a::c", "d"].map(str::to_owned).into_iter().collect();
    let imports = |texts: [(&str, &str); 4]| {
        let of = |(module, text): (&str, &str)| {
            (module.to_owned(), imported_files(module, text, &modules))
        };
        texts.into_iter().map(of).collect::<BTreeMap<_, _>>()
    };
    let one_way = imports([
        ("a", "mod b; use b::B;"),
        ("a::b", "use super::A; use super::c::C;"),
        ("a::c", "use crate::d::D;\n// use crate::a::b::B"),
        ("d", ""),
    ]);
    assert!(one_way["a::b"].contains("a::c") && one_way["a::c"].contains("d"));
    assert_eq!(circle(&one_way), None);
    let around = imports([
        ("a", ""),
        ("a::b", "use super::{A, c::C};"),
        ("a::c", "use crate::d::D;"),
        ("d", "use crate::a::b::B;"),
    ]);
    assert_eq!(circle(&around).unwrap().len(), 3);
}

/// The files that name `App`: its state, its interface to the platform, frames, actions, the arrangement of the screen, the step of a scan.
const OF_APP: [&str; 6] = [
    "app",
    "app::frame::interface",
    "app::frame::logic",
    "app::frame::perform",
    "app::frame::scan",
    "app::frame::ui",
];

#[test]
fn panels_do_not_name_the_app() {
    for path in all_files() {
        let module = module_path(&path);
        if module.starts_with("app") && !OF_APP.contains(&&*module) {
            let code = code_of(&module, &std::fs::read_to_string(&path).unwrap());
            let mut words = code.split(|c: char| !(c.is_alphanumeric() || c == '_'));
            assert!(words.all(|word| word != "App"), "{module}");
        }
    }
}

#[test]
fn an_import_to_the_right_is_found() {
    let file = |text: &str| vec![("a.rs".to_owned(), "measure".to_owned(), text.to_owned())];
    assert_eq!(against_the_order(&file("use crate::scene::Scene;")), ["a.rs imports scene"]);
    assert_eq!(against_the_order(&file("let x = crate::view::color::table();")).len(), 1);
    assert!(against_the_order(&file("use crate::solve::Solver;\n// crate::app::App")).is_empty());
}
