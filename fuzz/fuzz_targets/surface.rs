//! Any bytes as the surface of a body: PLY, STL, OBJ, GLB.
#![no_main]

#[path = "../../body/tests/common/files.rs"]
#[allow(dead_code)]
mod files;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    files::check_surface(bytes, ["", "a.stl", "a.obj", "a.ply", "a.glb"][bytes.len() % 5]);
});
