//! Any bytes as programs of knitting machines.

#![no_main]

#[path = "../../crates/wale/tests/reading/mod.rs"]
mod reading;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    reading::knitout(bytes);
});
