//! Machine, source version and date of a recorded run.

#[path = "../../../crates/terrella-measure/src/machine.rs"]
mod machine;

use crate::process::repository_root;
use anyhow::Context;
use std::path::Path;
use std::process::Command;

/// The metadata of this run: `cpu`, `os`, `commit` and `date`.
pub fn of_this_run() -> [(&'static str, String); 4] {
    [
        ("cpu", machine::cpu()),
        ("os", machine::os()),
        ("commit", machine::commit(&repository_root())),
        ("date", machine::date()),
    ]
}

/// The program's default adapter, and its driver.
pub fn adapter(terrella: &Path) -> anyhow::Result<(String, String)> {
    let output = Command::new(terrella).arg("doctor").output();
    let output = output.with_context(|| format!("cannot start {}", terrella.display()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    taken(&text).context("`terrella doctor` names no adapter that is used by default")
}

/// The default adapter and driver in the output of `terrella doctor`.
fn taken(doctor: &str) -> Option<(String, String)> {
    let mut lines = doctor
        .lines()
        .skip_while(|line| !line.ends_with("used by default)"));
    let name = lines.next()?;
    let name = name.rsplit_once(" (").map_or(name, |(name, _)| name);
    let driver = lines
        .take_while(|line| line.starts_with(' '))
        .find_map(|line| line.trim().strip_prefix("driver"));
    let driver = driver.map_or("unknown", str::trim);
    Some((name.to_owned(), driver.to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_adapter_that_is_taken_is_named_with_its_driver() {
        let doctor = "one (gl, software)\n  driver  x\n\nllvmpipe (LLVM 15, 256 bits) (vulkan, software, used by default)\n  \
            driver  llvmpipe Mesa 22.3.6\n  can     draw\n\n";
        let (name, driver) = taken(doctor).unwrap();
        assert_eq!(name, "llvmpipe (LLVM 15, 256 bits)");
        assert_eq!(driver, "llvmpipe Mesa 22.3.6");
        assert_eq!(taken("one (gl, software)\n"), None);
        assert_eq!(taken("a (b, used by default)\n").unwrap().1, "unknown");
    }
}
