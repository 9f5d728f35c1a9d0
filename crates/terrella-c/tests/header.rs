//! `include/terrella.h` is what cbindgen makes of the sources, and names the version.

use std::ffi::CStr;
use std::path::Path;
use terrella_c::{
    TERRELLA_VERSION_MAJOR, TERRELLA_VERSION_MINOR, TERRELLA_VERSION_PATCH, terrella_version,
};

#[test]
fn the_version_is_that_of_the_package() {
    let parts = [
        TERRELLA_VERSION_MAJOR,
        TERRELLA_VERSION_MINOR,
        TERRELLA_VERSION_PATCH,
    ];
    let text = parts.map(|part| part.to_string()).join(".");
    assert_eq!(text, env!("CARGO_PKG_VERSION"));
    // SAFETY: the function gives a text that ends with a zero and lives as long as the library.
    let loaded = unsafe { CStr::from_ptr(terrella_version()) };
    assert_eq!(loaded.to_str(), Ok(text.as_str()));
    for file in [
        include_str!("../build.rs"),
        include_str!("../cmake/terrella-config.cmake.in"),
    ] {
        let soname = format!("libterrella_c.so.{TERRELLA_VERSION_MAJOR}\"");
        assert!(file.contains(&soname), "{soname}");
    }
}

#[test]
fn the_header_is_that_of_the_sources() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config::from_file(folder.join("cbindgen.toml")).expect("cbindgen.toml");
    let made = cbindgen::Builder::new()
        .with_config(config)
        .with_crate(folder)
        .generate()
        .expect("the sources are read");
    let mut text = Vec::new();
    made.write(&mut text);
    let text = String::from_utf8(text).expect("UTF-8");
    let path = folder.join("include/terrella.h");
    if std::env::var_os("TERRELLA_UPDATE_HEADER").is_some() {
        std::fs::write(&path, &text).expect("written");
    }
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "{} is not what cbindgen makes of the sources; run `TERRELLA_UPDATE_HEADER=1 cargo test -p terrella-c --test header`",
        path.display()
    );
}
