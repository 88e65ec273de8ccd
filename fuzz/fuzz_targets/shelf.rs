//! Any bytes as a table of sizes, with choices of its columns.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: (&[u8], [(u8, u8); 3])| {
    let (bytes, choices) = input;
    let choices = choices.map(|(column, content)| (usize::from(column), usize::from(content)));
    hostile::check_shelf(bytes, &choices);
});
