//! Cost of a start: peak memory and processor time of a separate process.

use crate::{Place, REPOSITORY, words};
use std::process::{Child, Stdio};
use std::time::Duration;

/// Resources used by a process so far.
#[derive(Clone, Copy, Debug, Default)]
struct Cost {
    /// Peak memory, megabytes.
    peak_mb: f64,
    /// Processor time of all its threads, seconds.
    processor_s: f64,
}

impl Cost {
    /// As reported by Linux; `None` for a process that has ended.
    fn of(process: u32) -> Option<Self> {
        let read = |file: &str| std::fs::read_to_string(format!("/proc/{process}/{file}")).ok();
        let status = read("status")?;
        let peak = status
            .lines()
            .find_map(|line| line.strip_prefix("VmHWM:"))?;
        let peak_kib: f64 = peak.trim().strip_suffix("kB")?.trim().parse().ok()?;
        // After the name, which may hold anything: fields 14 and 15 of proc(5), in hundredths of a second on every Linux here.
        let stat = read("stat")?;
        let (_, fields) = stat.rsplit_once(')')?;
        let fields: Vec<f64> = fields
            .split_whitespace()
            .map(|field| field.parse().unwrap_or(0.0))
            .collect();
        let [user, system] = [11, 12].map(|at| fields.get(at).copied().unwrap_or(0.0));
        Some(Self {
            peak_mb: peak_kib * 1024.0 / 1e6,
            processor_s: (user + system) / 100.0,
        })
    }

    /// Follows a process to its end. Both values only increase, and only the last milliseconds are missed.
    fn until_end(child: &mut Child) -> Self {
        let mut cost = Self::default();
        loop {
            if let Some(now) = Self::of(child.id()) {
                cost = now;
            }
            if child.try_wait().expect("a child of ours").is_some() {
                return cost;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    }
}

/// A still of the built-in scene, from the built-in maps, with the software adapter. `None` if there is none.
fn still(more: &[&str]) -> Option<Cost> {
    let place = Place::new();
    let scene = format!("{REPOSITORY}/config/iss.toml");
    let arguments = ["--adapter", "llvmpipe", "frame", &scene, "-o", "a.png"];
    let mut command = place.command(&[&arguments[..], more].concat());
    command.env("TERRELLA_TEXTURES", format!("{REPOSITORY}/textures"));
    command.stderr(Stdio::piped());
    let mut child = command.spawn().expect("the command starts");
    let cost = Cost::until_end(&mut child);
    let output = child.wait_with_output().expect("it has ended");
    let said = words(&output);
    if said.contains("no graphics adapter") {
        eprintln!("SKIPPED: memory of a still: {said}");
        return None;
    }
    assert!(output.status.success(), "{said}");
    Some(cost)
}

/// Limit of a still's memory, megabytes: between that with maps that are uploaded while they are read (about 360, of which the maps on the software
/// adapter take 110 and files in memory, mostly the driver's compiler and the program, 100), and that with all maps in memory until they are
/// uploaded (430).
const MOST_MB: f64 = 385.0;

/// Most processor time of a small still, seconds: three times what a development build takes, for slow machines.
const MOST_PROCESSOR_S: f64 = 2.5;

#[test]
fn a_still_holds_no_map_beside_the_one_on_the_gpu() {
    if !cfg!(target_os = "linux") {
        eprintln!("SKIPPED: memory of a still: only Linux tells it");
        return;
    }
    let (Some(whole), Some(small)) = (still(&[]), still(&["--size", "64x36"])) else {
        return;
    };
    println!(
        "a still took {:.0} MB; of 64 × 36 pixels {:.0} MB and {:.2} s of processor time",
        whole.peak_mb, small.peak_mb, small.processor_s
    );
    for cost in [whole, small] {
        // A figure that was not read would pass.
        assert!((100.0..MOST_MB).contains(&cost.peak_mb), "{cost:?}");
    }
    let processor_s = small.processor_s;
    assert!((0.1..MOST_PROCESSOR_S).contains(&processor_s), "{small:?}");
}
