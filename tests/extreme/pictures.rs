//! Every extreme picture is a defined one.

use crate::common::{gpu, plain};
use terrella::measure::extreme::{cases, run};

#[test]
fn every_extreme_case_gives_a_defined_picture_or_a_clear_error() {
    let layers = plain([120, 130, 140]);
    let mut failed = Vec::new();
    for case in cases() {
        let start = std::time::Instant::now();
        let outcome = run(&case, gpu(), &layers);
        let line = format!(
            "{}: expected {}; {} ({} not finite)",
            outcome.name, outcome.expected, outcome.what_was_drawn, outcome.nan_pixels
        );
        println!(
            "{} {line} [{:.2} s]",
            if outcome.passed { "ok    " } else { "FAILED" },
            start.elapsed().as_secs_f64()
        );
        if !outcome.passed {
            failed.push(line);
        }
    }
    assert!(
        failed.is_empty(),
        "{} cases:\n{}",
        failed.len(),
        failed.join("\n")
    );
}
