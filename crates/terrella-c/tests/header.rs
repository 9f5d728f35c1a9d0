//! `include/terrella.h` is what cbindgen makes of the sources.

use std::path::Path;

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
