#![no_main]

#[path = "../bodies/pack_heights.rs"]
mod body;

libfuzzer_sys::fuzz_target!(|data: &[u8]| body::run(data));
