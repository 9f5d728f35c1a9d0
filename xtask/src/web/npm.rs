//! npm packages for tests and measurements in a browser, installed below `target`.

use crate::process::{self, repository_root};
use anyhow::{Context, bail};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// A package and its version.
pub struct Package {
    pub name: &'static str,
    pub version: &'static str,
}

/// The browser automation library, which includes no browser.
pub const PLAYWRIGHT: Package = Package {
    name: "playwright-core",
    version: "1.65.1",
};
/// The library that frames are timed beside, and that an example draws over the Earth.
pub const CESIUM: Package = Package {
    name: "cesium",
    version: "1.145.0",
};

/// The folder whose `node_modules` has these packages, after installing those that are missing.
///
/// # Errors
/// A package cannot be installed, for example without a network.
pub fn installed(packages: &[Package]) -> anyhow::Result<PathBuf> {
    let tools = repository_root().join("target/web/tools");
    fs::create_dir_all(&tools).with_context(|| tools.display().to_string())?;
    if packages.iter().all(|package| is_there(&tools, package)) {
        return Ok(tools);
    }
    let names = packages
        .iter()
        .map(|one| format!("{}@{}", one.name, one.version));
    let names: Vec<_> = names.collect();
    let mut npm = Command::new("npm");
    // With `--no-save` npm would remove the packages of other tests.
    npm.args(["install", "--save-exact", "--no-audit", "--no-fund"])
        .args(&names);
    npm.env("PLAYWRIGHT_SKIP_BROWSER_DOWNLOAD", "1");
    let advice = || {
        format!(
            "the npm packages {} are missing and cannot be installed into {}; install node and npm, and check the network",
            names.join(", "),
            tools.display()
        )
    };
    process::run(npm.current_dir(&tools)).with_context(advice)?;
    for package in packages {
        if !is_there(&tools, package) {
            bail!(
                "npm installed no {} {} into {}; delete its folder node_modules and try again",
                package.name,
                package.version,
                tools.display()
            );
        }
    }
    Ok(tools)
}

/// Whether a folder has a package in its version.
fn is_there(tools: &Path, package: &Package) -> bool {
    let manifest = tools.join("node_modules").join(package.name);
    let text = fs::read_to_string(manifest.join("package.json")).unwrap_or_default();
    let manifest: Value = serde_json::from_str(&text).unwrap_or_default();
    manifest["version"] == package.version
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_package_is_there_in_its_version_only() {
        let tools = tempfile::tempdir().unwrap();
        let folder = tools.path().join("node_modules/playwright-core");
        assert!(!is_there(tools.path(), &PLAYWRIGHT));
        fs::create_dir_all(&folder).unwrap();
        for (version, expected) in [("1.0.0", false), (PLAYWRIGHT.version, true)] {
            let text = format!("{{\"version\": \"{version}\"}}");
            fs::write(folder.join("package.json"), text).unwrap();
            assert_eq!(is_there(tools.path(), &PLAYWRIGHT), expected, "{version}");
        }
    }
}
