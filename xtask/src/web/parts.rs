//! Parts of `cargo xtask web test` about pages of others: bundlers that move the package's files, libraries that share the camera, servers that
//! fail, and many elements in one page.

use super::browser;
use super::npm::{self, CESIUM, PLAYWRIGHT, Package};
use crate::process;
use anyhow::Context;
use std::ffi::OsStr;
use std::path::Path;

const fn package(name: &'static str, version: &'static str) -> Package {
    Package { name, version }
}

/// The bundlers, and the compiler that checks the package's types.
const BUNDLERS: [Package; 6] = [
    PLAYWRIGHT,
    package("vite", "8.4.0"),
    package("webpack", "5.113.0"),
    package("webpack-cli", "7.3.1"),
    package("esbuild", "0.28.2"),
    package("typescript", "7.0.2"),
];
/// The libraries of the examples.
const LIBRARIES: [Package; 3] = [PLAYWRIGHT, CESIUM, package("three", "0.187.0")];

/// Bundles a page with each bundler, and opens it.
///
/// # Errors
/// A missing program or package, a bundle without an Earth.
pub fn bundlers(dist: &Path, tests: &Path) -> anyhow::Result<()> {
    let tools = npm::installed(&BUNDLERS).context("no bundler is tested")?;
    // Below the tools: there `npx` finds the bundlers.
    run(
        dist,
        &tools,
        &tests.join("bundlers.mjs"),
        &tools.join("bundlers"),
        &[],
    )
}

/// Opens the examples, and measures how well the other library's picture fits.
///
/// # Errors
/// A missing program or package, a picture that does not fit.
pub fn examples(dist: &Path, tests: &Path, pictures: &Path) -> anyhow::Result<()> {
    let tools = npm::installed(&LIBRARIES).context("no example is tested")?;
    run(dist, &tools, &tests.join("examples.mjs"), pictures, &[])
}

/// Opens pages on servers that are slow, fail or send other files, and makes and removes many elements in one page.
///
/// # Errors
/// A missing program or package, a page without its picture or message, memory that grows.
pub fn servers(dist: &Path, tests: &Path, pages: &Path) -> anyhow::Result<()> {
    let tools = npm::installed(&[PLAYWRIGHT]).context("no page is tested")?;
    run(dist, &tools, &tests.join("servers.mjs"), pages, &[])
}

/// Runs a test of the pages in a folder, in the folder of the tools.
pub fn run(
    dist: &Path,
    tools: &Path,
    test: &Path,
    out: &Path,
    more: &[&OsStr],
) -> anyhow::Result<()> {
    let dist = std::path::absolute(dist).with_context(|| dist.display().to_string())?;
    process::run(
        browser::script(test)
            .arg(dist)
            .arg(out)
            .args(more)
            .current_dir(tools),
    )
}
