//! Curves of every kind from their numbers.
#![no_main]

#[path = "../../tests/common/hostile.rs"]
#[allow(dead_code)]
mod hostile;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    hostile::check_spec(&hostile::choices::Choices(bytes).curve());
});
