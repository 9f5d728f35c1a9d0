//! `terrella doctor`

use super::{Common, print};
use std::fmt::Write;
use terrella::{AdapterReport, ContextError, adapter_reports};

/// Prints all adapters. No adapter at all is a failure.
pub fn run(common: &Common) -> anyhow::Result<()> {
    let reports = pollster::block_on(adapter_reports());
    if reports.is_empty() {
        return Err(ContextError::NoAdapter.into());
    }
    let mut text = String::new();
    for report in &reports {
        // Writing to a string cannot fail.
        let _ = describe(&mut text, report);
    }
    if let Some(wanted) = &common.adapter {
        let wanted_lower = wanted.to_lowercase();
        let named = |report: &AdapterReport| report.name.to_lowercase().contains(&wanted_lower);
        if !reports.iter().any(named) {
            print(&text)?;
            return Err(ContextError::NotNamed {
                wanted: wanted.clone(),
                present: reports.iter().map(|report| report.name.clone()).collect(),
            }
            .into());
        }
    }
    print(&text)
}

fn describe(text: &mut String, report: &AdapterReport) -> std::fmt::Result {
    let chosen = if report.chosen {
        ", used by default"
    } else {
        ""
    };
    writeln!(
        text,
        "{} ({}, {}{chosen})",
        report.name, report.backend, report.kind
    )?;
    if !report.driver.is_empty() {
        writeln!(text, "  driver  {}", report.driver)?;
    }
    for line in &report.can {
        writeln!(text, "  can     {line}")?;
    }
    for line in &report.dropped {
        writeln!(text, "  lacks   {line}")?;
    }
    writeln!(text)
}
