#![no_main]

#[path = "../bodies/contour_cache.rs"]
mod body;

libfuzzer_sys::fuzz_target!(|data: &[u8]| body::run(data));
