//! Names the shared library as programs will look for it.

fn main() {
    println!("cargo:rerun-if-changed=build.rs");
    let family = std::env::var("CARGO_CFG_TARGET_OS").unwrap_or_default();
    if family == "linux" {
        println!("cargo:rustc-cdylib-link-arg=-Wl,-soname,libterrella_c.so.0");
    }
}
