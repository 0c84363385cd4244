//! Any bytes as charts drawn as PNG.

#![no_main]

#[path = "../../crates/wale/tests/reading/mod.rs"]
mod reading;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    reading::image(bytes);
});
