//! The same bodies for a given time, on new inputs each time: `cargo xtask fuzz`.
//!
//! Some inputs are added to the seeds, so that later ones are farther from the first. There is no coverage to select them by, unlike in `cargo
//! fuzz`: any that took longer than the mean, so was not rejected immediately, is a candidate.

use crate::fuzz_short::{Random, TARGETS, mutated};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// Most inputs that join a target's seeds.
const MOST_ADDED: usize = 2_000;
/// Longest input that joins them, bytes.
const LONGEST_ADDED: usize = 1 << 16;
/// An input that takes longer is a finding.
const HANGS: Duration = Duration::from_secs(5);

/// Result of a target's run.
struct Outcome {
    runs: u64,
    seconds: f64,
    slowest: Duration,
    findings: Vec<String>,
}

fn setting(name: &str) -> Option<String> {
    std::env::var(name).ok().filter(|value| !value.is_empty())
}

fn fuzz(target: &str, seeds: Vec<Vec<u8>>, body: fn(&[u8]), time: Duration, seed: u64) -> Outcome {
    let mut seeds = seeds;
    let first_seeds = seeds.len();
    let mut random = Random(seed | 1);
    let mut outcome = Outcome {
        runs: 0,
        seconds: 0.0,
        slowest: Duration::ZERO,
        findings: Vec::new(),
    };
    let mut sum = Duration::ZERO;
    let start = Instant::now();
    while start.elapsed() < time {
        let input = mutated(&seeds, &mut random);
        let begin = Instant::now();
        let ended_well = catch_unwind(AssertUnwindSafe(|| body(&input))).is_ok();
        let took = begin.elapsed();
        outcome.runs += 1;
        sum += took;
        outcome.slowest = outcome.slowest.max(took);
        if !ended_well || took > HANGS {
            let name = format!("{target}-{}", outcome.findings.len());
            let folder = Path::new(crate::REPOSITORY).join("fuzz/findings");
            std::fs::create_dir_all(&folder).expect("a folder");
            std::fs::write(folder.join(&name), &input).expect("writes");
            outcome.findings.push(name);
            if outcome.findings.len() >= 10 {
                break;
            }
        }
        // Longer than the mean: it went on beyond the first rejections.
        let is_deep = ended_well && u128::from(outcome.runs) * took.as_nanos() > sum.as_nanos();
        if is_deep && input.len() <= LONGEST_ADDED && random.below(64) == 0 {
            if seeds.len() < first_seeds + MOST_ADDED {
                seeds.push(input);
            } else {
                let place = first_seeds + random.below(MOST_ADDED);
                seeds[place] = input;
            }
        }
    }
    outcome.seconds = start.elapsed().as_secs_f64();
    outcome
}

#[test]
#[ignore = "as long as is asked for: cargo xtask fuzz"]
fn all_targets_for_a_time() {
    let seconds = setting("TERRELLA_FUZZ_SECONDS").map_or(60.0, |text| {
        text.parse().expect("TERRELLA_FUZZ_SECONDS is a number")
    });
    let only: Vec<String> = setting("TERRELLA_FUZZ_TARGETS")
        .map(|text| text.split(',').map(str::to_owned).collect())
        .unwrap_or_default();
    let known = |name: &String| TARGETS.iter().any(|target| target.0 == name);
    assert!(only.iter().all(known), "no such target among {only:?}");
    let seed = setting("TERRELLA_FUZZ_SEED").map_or_else(
        || std::process::id().into(),
        |text| text.parse().expect("TERRELLA_FUZZ_SEED is a number"),
    );
    let mut findings = Vec::new();
    println!(
        "\nseed {seed}\n| target | runs | seconds | slowest, ms | findings |\n|---|---|---|---|---|"
    );
    for (target, seeds, body, _) in TARGETS {
        if !only.is_empty() && !only.iter().any(|name| name == target) {
            continue;
        }
        let time = Duration::from_secs_f64(seconds);
        let outcome = fuzz(target, seeds(), *body, time, seed);
        println!(
            "| `{target}` | {} | {:.0} | {:.1} | {} |",
            outcome.runs,
            outcome.seconds,
            outcome.slowest.as_secs_f64() * 1e3,
            match outcome.findings.is_empty() {
                true => "none".to_owned(),
                false => outcome.findings.join(", "),
            }
        );
        findings.extend(outcome.findings);
    }
    assert!(findings.is_empty(), "inputs in fuzz/findings: {findings:?}");
}

/// The loop finds panics: a body that panics for one byte and never hangs.
#[test]
fn a_panic_is_found_and_kept() {
    fn body(input: &[u8]) {
        assert!(!input.starts_with(b"\xff\xff\xff\xff"), "found");
    }
    let seeds = vec![b"abcdefgh".to_vec()];
    let outcome = fuzz("self_test", seeds, body, Duration::from_secs(20), 7);
    assert_eq!(outcome.findings.len(), 10, "{} runs", outcome.runs);
    for name in outcome.findings {
        let path = Path::new(crate::REPOSITORY)
            .join("fuzz/findings")
            .join(name);
        let kept = std::fs::read(&path).expect("kept");
        assert!(kept.starts_with(b"\xff\xff\xff\xff"));
        std::fs::remove_file(path).expect("removed");
    }
}
