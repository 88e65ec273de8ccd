//! Damaged files: each is rejected with one line, without a panic, in memory of a constant times its length.

#![cfg(not(target_arch = "wasm32"))]
#![allow(clippy::unwrap_used, reason = "a test stops where something is missing")]

#[path = "common/files.rs"]
mod files;

use dhat::{HeapStats, Profiler};
use files::{check_surface, cube, glb, phone_data, phone_json};
use implant_preview_body::read::{Format, MAX_BYTES, Unit, read};
use implant_preview_body::surface::Surface;
use implant_preview_body::write::write;
use serde_json::{Value, json};
use std::sync::Mutex;

#[path = "damaged/phones.rs"]
mod phones;

#[global_allocator]
static ALLOCATOR: dhat::Alloc = dhat::Alloc;

/// One test at a time: the profiler counts the allocations of the whole process.
static ALONE: Mutex<()> = Mutex::new(());

/// Greatest memory of a reader: a multiple of the file's length, and a rest \[bytes\].
const MEMORY: (usize, usize) = (64, 100_000);

/// The line of a rejected file, after the checks of line and memory: of a damaged file where and what, behind which the line says what to do.
fn line_of(bytes: &[u8], name: &str) -> String {
    let profiler = Profiler::builder().testing().build();
    let read = read(bytes, name);
    let peak = HeapStats::get().max_bytes;
    drop(profiler);
    assert!(
        peak <= MEMORY.0 * bytes.len() + MEMORY.1,
        "{peak} bytes of memory for {}",
        bytes.len()
    );
    let line = read.unwrap_err().to_string();
    assert!(!check_surface(bytes, name));
    match line.strip_prefix("the file is damaged: ") {
        Some(fault) => {
            let fault = fault.strip_suffix("; export the surface again, as PLY or STL");
            format!("damaged: {}", fault.expect("the line says what to do"))
        }
        None => line,
    }
}

const HEADER: &str = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
                      element face 1\nproperty list uchar int vertex_indices\nend_header\n";
const ROWS: &str = "0 0 0\n300 0 0\n0 300 9\n3 0 1 2\n";

#[test]
fn damaged_text_is_rejected_in_one_line() {
    // A table of inputs.
    let _alone = ALONE.lock();
    let ply = |from: &str, to: &str| {
        let text = format!("{HEADER}{ROWS}");
        assert!(text.contains(from), "{from}");
        text.replacen(from, to, 1)
    };
    let facet = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 300 0 0\nvertex 0 300 0\nendloop\nendfacet\nendsolid a\n";
    let stl = |from: &str, to: &str| facet.replacen(from, to, 1);
    let many = "0 1 ".repeat(15_000);
    let cases: Vec<(String, &str, &str)> = vec![
        (String::new(), "a.ply", "the file is empty; allowed: a surface as PLY, STL, OBJ or GLB"),
        (
            "A letter to a patient.".to_owned(),
            "a.doc",
            "the format of the file is unknown; allowed: a surface as PLY, STL, OBJ or GLB",
        ),
        (
            "PK\u{3}\u{4}archive".to_owned(),
            "a.zip",
            "the file is an archive (ZIP); unpack the surface in it",
        ),
        (
            "{ \"asset\": {} }".to_owned(),
            "a.gltf",
            "glTF as text is not read; export it as GLB, in one file",
        ),
        ("<html>".repeat(30), "a.stl", "damaged: an STL text begins with \"solid\""),
        ("plywood".to_owned(), "a.ply", "damaged: a PLY file begins with \"ply\""),
        ("GLTF".to_owned(), "a.GLB", "damaged: a GLB file begins with \"glTF\""),
        ("text".to_owned(), "a.stl", "damaged: byte 4: it ends in the header of an STL file"),
        (
            "# nothing\ng a\n".to_owned(),
            "a.obj",
            "the file has 0 points and no surface; export the surface as triangles, as PLY or STL",
        ),
        // Headers of PLY.
        ("ply\n".to_owned(), "", "damaged: line 1: it ends before \"end_header\""),
        (ply("end_header\n", ""), "", "damaged: line 9: \"0\" is no word of a PLY header"),
        (ply("format ascii 1.0\n", ""), "", "damaged: line 8: the header has no line \"format\""),
        (
            ply("ascii", "binary"),
            "",
            "damaged: line 2: format \"binary\"; allowed: ascii, binary_little_endian, binary_big_endian",
        ),
        (ply("element vertex 3\n", ""), "", "damaged: line 3: a property before an element"),
        (
            ply("vertex 3", "vertex many"),
            "",
            "damaged: line 3: an element without a number of rows",
        ),
        (ply("vertex 3", "vertex -3"), "", "damaged: line 3: an element without a number of rows"),
        (
            ply("float x", "quaternion x"),
            "",
            "damaged: line 4: \"quaternion\" is no type; allowed: char to uint, float, double",
        ),
        (
            ply("list uchar int", "list uchar list"),
            "",
            "damaged: line 8: a list of lists; allowed: a list of numbers",
        ),
        (
            ply("property float z", "property float w"),
            "",
            "damaged: the vertices have no z; needed: x, y, z",
        ),
        (
            ply("vertex_indices", "corners"),
            "",
            "damaged: the faces have no corners (vertex_indices)",
        ),
        (
            ply("vertex 3", "vertex 4000000000"),
            "",
            "damaged: of 4000000000 rows of \"vertex\" the file has 5 at most",
        ),
        (
            ply("face 1", "face 4000000000"),
            "",
            "damaged: of 4000000000 rows of \"face\" the file has 5 at most",
        ),
        // A count of rows without content costs nothing.
        (
            ply("element face 1\n", "element nothing 4000000000\nelement face 1\n")
                .replace("3 0 1 2", "3 0 1 9"),
            "",
            "damaged: all 1 faces have corners beyond its 3 points",
        ),
        (ply("3 0 1 2\n", ""), "", "damaged: line 12, face 1 of 1: it ends"),
        // Rows of PLY.
        (ply("300 0 0", "300 0,5 0"), "", "damaged: line 11, vertex 2 of 3: \"0,5\" is no number"),
        (ply("3 0 1 2", "3 0 1"), "", "damaged: line 13, face 1 of 1: it ends"),
        (
            ply("3 0 1 2", "4000000000 0 1 2"),
            "",
            "damaged: line 13, face 1 of 1: a list of 4000000000 numbers; the rest of the file has up to 7",
        ),
        (
            ply("3 0 1 2", "1e308 0 1 2"),
            "",
            "damaged: line 13, face 1 of 1: a list of 1e308 numbers; the rest of the file has up to 7",
        ),
        (
            ply("3 0 1 2", "-3 0 1 2"),
            "",
            "damaged: line 13, face 1 of 1: a list of -3 numbers; the rest of the file has up to 7",
        ),
        (
            ply("3 0 1 2", "2.5 0 1 2"),
            "",
            "damaged: line 13, face 1 of 1: a list of 2.5 numbers; the rest of the file has up to 7",
        ),
        (
            ply("3 0 1 2", "nan 0 1 2"),
            "",
            "damaged: line 13, face 1 of 1: a list of NaN numbers; the rest of the file has up to 7",
        ),
        (ply("3 0 1 2", "3 0 0 2"), "", "damaged: none of its 1 faces is a triangle with an area"),
        (
            ply("3 0 1 2", &format!("30000 {many}")),
            "",
            "damaged: none of its 1 faces is a triangle with an area",
        )
            .to_owned(),
        (
            ply("0 300 9", "nan 300 9"),
            "",
            "damaged: none of its 1 faces is a triangle with an area",
        ),
        (
            ply("face 1", "face 0"),
            "",
            "the file has 3 points and no surface; export the surface as triangles, as PLY or STL",
        ),
        // STL as text.
        (stl("endsolid a\n", ""), "", "damaged: line 8: it ends before \"endsolid\""),
        (stl("vertex 300 0 0\n", ""), "", "damaged: line 6: a facet of 2 vertices; allowed: 3"),
        (
            stl("vertex 300 0 0", "vertex 300 0"),
            "",
            "damaged: line 5: a vertex without three numbers",
        ),
        (stl("vertex 300", "vertex x300"), "", "damaged: line 5: a vertex without three numbers"),
        (
            stl("outer loop", "outside loop\u{7}"),
            "",
            "damaged: line 3: \"outside\" is no word of an STL file, as facet or vertex",
        ),
        (
            "solid a\nendsolid a\n".to_owned(),
            "",
            "the file has 0 points and no surface; export the surface as triangles, as PLY or STL",
        ),
        // OBJ.
        (
            "v 0 0 0\nv 1 0\n".to_owned(),
            "",
            "damaged: line 2: a vertex of 2 numbers; allowed: 3, or 6 with a colour",
        ),
        ("v 0 0 0\nv 1 0 zero\n".to_owned(), "", "damaged: line 2: \"zero\" is no number"),
        (
            "v 0 0 0\nf 1 1 x/1\n".to_owned(),
            "",
            "damaged: line 2: \"x/1\" is no vertex; allowed: a whole number from 1, or from the end below 0",
        ),
        (
            "v 0 0 0\nf 1 1 0\n".to_owned(),
            "",
            "damaged: line 2: \"0\" is no vertex; allowed: a whole number from 1, or from the end below 0",
        ),
        (
            "v 0 0 0\nf 1 2 3\nf -1 -2 -9223372036854775808\n".to_owned(),
            "",
            "damaged: all 2 faces have corners beyond its 1 points",
        ),
        ("f 1 2 3\n".to_owned(), "a.obj", "damaged: all 1 faces have corners beyond its 0 points"),
        (
            "v 0 0 0\nf 1 1 99999999999999999999\n".to_owned(),
            "",
            "damaged: line 2: \"99999999999999999999\" is no vertex; allowed: a whole number from 1, or from the end below 0",
        ),
    ];
    assert!(cases.len() >= 40);
    for (text, name, expected) in cases {
        assert_eq!(line_of(text.as_bytes(), name), expected, "{text:.60}");
    }
}

#[test]
fn damaged_binaries_are_rejected_in_one_line() {
    let _alone = ALONE.lock();
    let ply = write(&cube(), Unit::Mm, Format::Ply);
    let start = ply.windows(11).position(|word| word == b"end_header\n").unwrap() + 11;
    let with = |at: usize, bytes: &[u8]| {
        let mut damaged = ply.clone();
        damaged[at..at + bytes.len()].copy_from_slice(bytes);
        damaged
    };
    let faces = start + 8 * 15;
    let cut = [&ply[..start], b"12.5 7.0 nothing"].concat();
    assert_eq!(line_of(&cut, ""), "damaged: of 8 rows of \"vertex\" the file has 1 at most");
    let line = line_of(&ply[..ply.len() - 1], "");
    assert_eq!(
        line,
        format!(
            "damaged: byte {}, face 12 of 12: a list of 3 numbers; the rest of the file has up to 2",
            ply.len() - 12
        )
    );
    let line = line_of(&with(faces, &[255]), "");
    assert_eq!(
        line,
        format!(
            "damaged: byte {}, face 1 of 12: a list of 255 numbers; the rest of the file has up to 38",
            faces + 1
        )
    );
    let stl = write(&cube(), Unit::Mm, Format::Stl);
    assert_eq!(line_of(&stl[..84], "a.stl"), "damaged: byte 84: it ends after 0 of 12 triangles");
    let mut counted = stl.clone();
    counted[80..84].copy_from_slice(&4_000_000_000_u32.to_le_bytes());
    let line = line_of(&counted, "a.stl");
    assert_eq!(
        line,
        format!("damaged: byte {}: it ends after 12 of 4000000000 triangles", stl.len())
    );
    let mut nan = stl;
    nan[84..].chunks_exact_mut(50).for_each(|t| t[12..16].copy_from_slice(&f32::NAN.to_le_bytes()));
    assert_eq!(line_of(&nan, ""), "damaged: none of its 12 faces is a triangle with an area");
}

#[test]
fn files_beyond_the_limits_are_rejected() {
    let _alone = ALONE.lock();
    assert_eq!(
        line_of(&vec![b' '; MAX_BYTES + 1], "a.ply"),
        "the file has 100.1 MB; allowed: up to 100 MB"
    );
    let ply = "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty char x\nproperty char y\nproperty char z\n\
               element face 2000001\nproperty list uchar uchar vertex_indices\nend_header\n";
    let mut bytes = ply.as_bytes().to_vec();
    bytes.extend([0, 0, 0]);
    bytes.extend([3, 0, 0, 0].repeat(2_000_001));
    assert_eq!(
        line_of(&bytes, ""),
        "the surface has more than 2 million triangles; export it with fewer"
    );
    let ply = ply.replace("vertex 1\n", "vertex 6000001\n").replace("face 2000001", "face 0");
    let mut bytes = ply.into_bytes();
    bytes.extend([0, 0, 0].repeat(6_000_001));
    assert_eq!(
        line_of(&bytes, ""),
        "the surface has more than 6 million points; export it with fewer"
    );
    // Meshes that many nodes have in common.
    let mut json = phone_json();
    json["nodes"] = (0..300).map(|_| json!({ "mesh": 0 })).collect();
    json["scenes"][0]["nodes"] = (0..300).collect();
    json["meshes"][0]["primitives"] = json!([{ "attributes": { "POSITION": 0 } }]);
    json["accessors"][0]["count"] = json!(30_000);
    json["bufferViews"][0]["byteLength"] = json!(360_000);
    let line = line_of(&glb(&json, &vec![0; 360_000]), "");
    assert_eq!(line, "damaged: surface 0 (meshes) stands in it too often");
}

/// Whole files of all formats, small.
fn samples() -> Vec<Vec<u8>> {
    let mut files: Vec<Vec<u8>> =
        Format::ALL.iter().map(|format| write(&cube(), Unit::M, *format)).collect();
    files.push(write(&Surface { colors: None, ..cube() }, Unit::Mm, Format::Ply));
    files.push(glb(&phone_json(), &phone_data()));
    files.push(format!("{HEADER}{ROWS}").into_bytes());
    let big = "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty double x\nproperty list uchar short k\n\
               property ushort y\nproperty int z\nelement face 1\nproperty list uint ushort vertex_index\nend_header\n";
    let mut big = big.as_bytes().to_vec();
    for [x, y, z] in [[0.0, 0.0, 0.0], [300.0, 0.0, 7.0], [0.0, 300.0, 9.0_f64]] {
        big.extend(x.to_be_bytes());
        big.extend([1, 0, 5]);
        big.extend((y as u16).to_be_bytes());
        big.extend((z as i32).to_be_bytes());
    }
    big.extend([0, 0, 0, 3, 0, 0, 0, 1, 0, 2]);
    files.push(big);
    files.push(b"solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 3e2 0 0\nvertex 0 300 0\nendloop\nendfacet\nendsolid a\n".to_vec());
    files.push(b"# a\nv 0 0 0 1 0 0\nv 300 0 0 0 1 0\nv 300 300 \\\n 9 0 0 1\nv 0 300 0 0 0 0\nf 1/1/1 2//1 3 -1\ng a\nf 1 3 2\n".to_vec());
    files
}

#[test]
fn mutated_files_are_surfaces_or_rejected_in_one_line() {
    let _alone = ALONE.lock();
    let samples = samples();
    assert!(samples.iter().all(|file| check_surface(file, "")));
    let mut random = fastrand::Rng::with_seed(7);
    let pieces: [&[u8]; 16] = [
        b"0",
        b"-1",
        b"4000000000",
        b"4294967295",
        b"nan",
        b"inf",
        b"1e308",
        b"1e-320",
        b"\n",
        b" ",
        b"\\\n",
        b"\"",
        b"[",
        b"null",
        &[0xff; 4],
        &[0; 4],
    ];
    let mut accepted = 0;
    const MUTATIONS: usize = 20_000;
    for _ in 0..MUTATIONS {
        let mut file = samples[random.usize(..samples.len())].clone();
        for _ in 0..random.usize(1..4) {
            let at = random.usize(..file.len().max(1)).min(file.len());
            let end = (at + random.usize(0..6)).min(file.len());
            match random.u8(..6) {
                0 => file.truncate(at),
                1 => drop(file.splice(at..end, pieces[random.usize(..16)].iter().copied())),
                2 => file[at..end].iter_mut().for_each(|byte| *byte = random.u8(..)),
                3 => file[at..end].iter_mut().for_each(|byte| *byte ^= 1 << random.u8(..8)),
                4 => drop(file.drain(at..end)),
                _ => file.extend_from_within(at..end),
            }
        }
        let name = ["", "a.stl", "a.obj", "a.ply", "a.glb"][random.usize(..5)];
        accepted += usize::from(check_surface(&file, name));
    }
    // Both ends are met.
    assert!((MUTATIONS / 10..MUTATIONS * 9 / 10).contains(&accepted), "{accepted}");
}

#[test]
fn files_cut_anywhere_are_rejected_but_for_lines_of_obj_and_ends_without_content() {
    let _alone = ALONE.lock();
    for file in samples() {
        let is_obj = read(&file, "").unwrap().format == Format::Obj;
        for length in 0..file.len() {
            let is_surface = check_surface(&file[..length], "a.stl");
            let is_end = file[length..].iter().all(|byte| b" a\n\0".contains(byte));
            assert!(!is_surface || is_obj || is_end, "{length} of {}", file.len());
        }
    }
}
