//! On what machine, of what source and when a run is recorded.

use crate::process::repository_root;
use anyhow::Context;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// What a recorded run says of its machine: `cpu`, `os`, `commit` and `date`.
pub fn of_this_run() -> [(&'static str, String); 4] {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    [
        ("cpu", cpu(&read("/proc/cpuinfo"))),
        (
            "os",
            os(
                &read("/etc/os-release"),
                &read("/proc/sys/kernel/osrelease"),
            ),
        ),
        ("commit", commit()),
        ("date", date(now.map_or(0, |since| since.as_secs()))),
    ]
}

/// The adapter that the program takes by default, and its driver.
pub fn adapter(terrella: &Path) -> anyhow::Result<(String, String)> {
    let output = Command::new(terrella).arg("doctor").output();
    let output = output.with_context(|| format!("cannot start {}", terrella.display()))?;
    let text = String::from_utf8_lossy(&output.stdout);
    taken(&text).context("`terrella doctor` names no adapter that is taken by default")
}

/// The same from what `terrella doctor` prints.
fn taken(doctor: &str) -> Option<(String, String)> {
    let mut lines = doctor
        .lines()
        .skip_while(|line| !line.ends_with("taken by default)"));
    let name = lines.next()?;
    let name = name.rsplit_once(" (").map_or(name, |(name, _)| name);
    let driver = lines
        .take_while(|line| line.starts_with(' '))
        .find_map(|line| line.trim().strip_prefix("driver"));
    let driver = driver.map_or("unknown", str::trim);
    Some((name.to_owned(), driver.to_owned()))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

/// Model and number of processors, from Linux' /proc/cpuinfo; else the architecture.
fn cpu(cpuinfo: &str) -> String {
    let models: Vec<_> = cpuinfo
        .lines()
        .filter_map(|line| line.strip_prefix("model name")?.split_once(':'))
        .map(|(_, model)| model.split_whitespace().collect::<Vec<_>>().join(" "))
        .collect();
    match models.first() {
        Some(model) => format!("{model}, {} processors", models.len()),
        None => std::env::consts::ARCH.to_owned(),
    }
}

/// Name and kernel, from os-release(5) and Linux; else the system's kind.
fn os(os_release: &str, kernel: &str) -> String {
    let name = os_release
        .lines()
        .find_map(|line| line.strip_prefix("PRETTY_NAME="));
    match (name, kernel.trim()) {
        (Some(name), kernel) => format!("{}, Linux {kernel}", name.trim_matches('"')),
        (None, "") => std::env::consts::OS.to_owned(),
        (None, kernel) => format!("Linux {kernel}"),
    }
}

/// The commit that is checked out, with a word where files differ from it; "unknown" outside of git.
fn commit() -> String {
    let git = |arguments: &[&str]| {
        let mut command = Command::new("git");
        let output = command
            .args(arguments)
            .current_dir(repository_root())
            .output();
        let output = output.ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "HEAD"]) else {
        return "unknown".to_owned();
    };
    // What is measured is code: pages and recorded runs are rewritten on the way.
    match git(&["status", "--porcelain", "--", ".", ":!docs", ":!README.md"]).as_deref() {
        Some("") => commit,
        _ => commit + " with changes",
    }
}

/// The date of a time of Unix, UTC: 2026-11-23.
fn date(unix_s: u64) -> String {
    // Howard Hinnant's `civil_from_days`, years from March on.
    let days = unix_s / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date(0), "1970-01-01");
        assert_eq!(date(951_782_400), "2000-02-29");
        assert_eq!(date(951_868_800), "2000-03-01");
        assert_eq!(date(1_798_761_599), "2026-12-31");
        assert_eq!(date(4_107_542_400), "2100-03-01");
    }

    #[test]
    fn the_machine_is_named() {
        let info = "processor : 0\nmodel name\t: A  CPU\nprocessor : 1\nmodel name\t: A  CPU\n";
        assert_eq!(cpu(info), "A CPU, 2 processors");
        assert_eq!(cpu(""), std::env::consts::ARCH);
        let release = "ID=x\nPRETTY_NAME=\"Debian 12\"\n";
        assert_eq!(os(release, "6.1\n"), "Debian 12, Linux 6.1");
        assert_eq!(os("", "6.1"), "Linux 6.1");
        assert_eq!(os("", ""), std::env::consts::OS);
    }

    #[test]
    fn the_adapter_that_is_taken_is_named_with_its_driver() {
        let doctor = "one (gl, software)\n  driver  x\n\nllvmpipe (LLVM 15, 256 bits) (vulkan, software, taken by default)\n  \
            driver  llvmpipe Mesa 22.3.6\n  can     draw\n\n";
        let (name, driver) = taken(doctor).unwrap();
        assert_eq!(name, "llvmpipe (LLVM 15, 256 bits)");
        assert_eq!(driver, "llvmpipe Mesa 22.3.6");
        assert_eq!(taken("one (gl, software)\n"), None);
        assert_eq!(taken("a (b, taken by default)\n").unwrap().1, "unknown");
    }
}
