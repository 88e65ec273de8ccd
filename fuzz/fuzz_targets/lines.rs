//! Any bytes as a file of scenes, one a line; layered tissue in the first line is solved on a coarse grid.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    hostile::check_lines(bytes);
    hostile::check_first_solve(bytes);
});
