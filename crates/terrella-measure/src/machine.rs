//! Machine, source revision and time of a measurement. Plain `std`: `xtask` includes this file too.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// Model and number of the processors; on other systems than Linux the architecture.
pub fn cpu() -> String {
    cpu_of(&read("/proc/cpuinfo"))
}

/// Name and kernel of the operating system; on other systems than Linux its kind.
pub fn os() -> String {
    os_of(
        &read("/etc/os-release"),
        &read("/proc/sys/kernel/osrelease"),
    )
}

/// The commit that is checked out at `root`, with a word where sources differ from it; "unknown" outside of git.
pub fn commit(root: &Path) -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .args(arguments)
            .current_dir(root)
            .output();
        let output = output.ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(commit) = git(&["rev-parse", "HEAD"]) else {
        return "unknown".to_owned();
    };
    // Only code counts: pages and recorded runs are rewritten during the measurement.
    match git(&["status", "--porcelain", "--", ".", ":!docs", ":!README.md"]).as_deref() {
        Some("") => commit,
        _ => commit + " with changes",
    }
}

/// Now, UTC: 2026-11-23T06:43:12Z.
pub fn date() -> String {
    let since = SystemTime::now().duration_since(UNIX_EPOCH);
    date_of(since.map_or(0, |since| since.as_secs()))
}

fn read(path: &str) -> String {
    std::fs::read_to_string(path).unwrap_or_default()
}

fn cpu_of(cpuinfo: &str) -> String {
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

fn os_of(os_release: &str, kernel: &str) -> String {
    let name = os_release
        .lines()
        .find_map(|line| line.strip_prefix("PRETTY_NAME="));
    match (name, kernel.trim()) {
        (Some(name), kernel) => format!("{}, Linux {kernel}", name.trim_matches('"')),
        (None, "") => std::env::consts::OS.to_owned(),
        (None, kernel) => format!("Linux {kernel}"),
    }
}

/// A time of Unix as a date.
fn date_of(unix_s: u64) -> String {
    // Howard Hinnant's `civil_from_days`, years from March on.
    let days = unix_s / 86_400 + 719_468;
    let (era, day) = (days / 146_097, days % 146_097);
    let year = (day - day / 1_460 + day / 36_524 - day / 146_096) / 365;
    let day = day - (365 * year + year / 4 - year / 100);
    let month = (5 * day + 2) / 153;
    let day = day - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = era * 400 + year + u64::from(month <= 2);
    let (hour, minute, second) = (unix_s / 3600 % 24, unix_s / 60 % 60, unix_s % 60);
    format!("{year:04}-{month:02}-{day:02}T{hour:02}:{minute:02}:{second:02}Z")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(date_of(0), "1970-01-01T00:00:00Z");
        assert_eq!(date_of(951_782_400), "2000-02-29T00:00:00Z");
        assert_eq!(date_of(951_868_800), "2000-03-01T00:00:00Z");
        assert_eq!(date_of(1_798_761_599), "2026-12-31T23:59:59Z");
        assert_eq!(date_of(4_107_542_400), "2100-03-01T00:00:00Z");
    }

    #[test]
    fn the_machine_is_named() {
        let info = "processor : 0\nmodel name\t: A  CPU\nprocessor : 1\nmodel name\t: A  CPU\n";
        assert_eq!(cpu_of(info), "A CPU, 2 processors");
        assert_eq!(cpu_of(""), std::env::consts::ARCH);
        let release = "ID=x\nPRETTY_NAME=\"Debian 12\"\n";
        assert_eq!(os_of(release, "6.1\n"), "Debian 12, Linux 6.1");
        assert_eq!(os_of("", "6.1"), "Linux 6.1");
        assert_eq!(os_of("", ""), std::env::consts::OS);
    }

    #[test]
    fn outside_of_git_no_commit_is_named() {
        assert_eq!(commit(Path::new("/no/such/folder")), "unknown");
    }
}
