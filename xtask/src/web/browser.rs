//! The browser of the tests, and its own software Vulkan device. Native pictures are drawn on it: two software devices filter textures with other
//! fractions, and on one device every difference is the page's.

use anyhow::bail;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The browser of the tests, unless `CHROMIUM` names another.
const BROWSER: &str = "/usr/bin/chromium";
/// Where Debian keeps the browser's files; its program is a script that starts it.
const DEBIAN: &str = "/usr/lib/chromium";
/// Vulkan's description of the device, beside the browser's program.
const DESCRIPTION: &str = "vk_swiftshader_icd.json";

/// A Vulkan driver by its description.
#[derive(Debug, PartialEq)]
pub struct Driver {
    description: PathBuf,
}

/// The program that the tests start.
fn program() -> PathBuf {
    std::env::var_os("CHROMIUM").map_or_else(|| BROWSER.into(), PathBuf::from)
}

/// Runs a script of the tests with the browser, whose path the script reads from `CHROMIUM`.
pub fn script(file: &Path) -> Command {
    let mut node = Command::new("node");
    node.env("CHROMIUM", program()).arg(file);
    node
}

/// The driver in the browser of the tests.
///
/// # Errors
/// The browser's folder has none.
pub fn driver() -> anyhow::Result<Driver> {
    beside(&program())
}

fn beside(browser: &Path) -> anyhow::Result<Driver> {
    let program = browser
        .canonicalize()
        .unwrap_or_else(|_| browser.to_owned());
    let own = program.parent().unwrap_or(Path::new("/"));
    let debian = (browser == Path::new(BROWSER)).then_some(Path::new(DEBIAN));
    let folders = [own].into_iter().chain(debian);
    let mut found = folders.map(|folder| folder.join(DESCRIPTION));
    match found.find(|file| file.exists()) {
        Some(description) => Ok(Driver { description }),
        None => bail!(
            "{DESCRIPTION} is not beside {}; set CHROMIUM to Chromium's own program, not to a script that starts it",
            browser.display()
        ),
    }
}

impl Driver {
    /// Variables with which a native program draws on this device alone: the Vulkan loader's, by their new name and by the old one.
    pub fn variables(&self) -> [(&'static str, &Path); 2] {
        ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"].map(|name| (name, &*self.description))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn the_driver_is_beside_the_program_or_its_absence_is_named() {
        let folder = tempfile::tempdir().unwrap();
        let browser = folder.path().join("chrome");
        fs::write(&browser, "").unwrap();
        let error = beside(&browser).unwrap_err().to_string();
        assert!(error.contains("set CHROMIUM"), "{error}");
        let description = folder.path().canonicalize().unwrap().join(DESCRIPTION);
        fs::write(&description, "{}").unwrap();
        assert_eq!(beside(&browser).unwrap(), Driver { description });
    }
}
