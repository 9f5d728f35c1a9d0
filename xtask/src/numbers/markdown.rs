//! Tables and numbers in Markdown.

use super::record::Recorded;
use anyhow::bail;
use std::fmt::Write;

/// The recorded lines unchanged, with a column for each recorded one.
pub fn as_recorded(run: &Recorded) -> anyhow::Result<String> {
    let rows = run.rows()?;
    let rows = rows.iter().map(|row| row.fields.to_vec());
    Ok(table(run.columns()?, rows))
}

/// A table with these heads and rows.
pub fn table<H: AsRef<str>>(heads: &[H], rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut text = String::from("|");
    for head in heads {
        // Writing to a string cannot fail.
        let _ = write!(text, " {} |", head.as_ref());
    }
    let _ = writeln!(text, "\n|{}", "---|".repeat(heads.len()));
    for row in rows {
        text.push('|');
        for field in row {
            // A bar would end the field.
            let _ = write!(text, " {} |", field.replace('|', "\\|"));
        }
        text.push('\n');
    }
    // An empty head must not leave two spaces.
    text.replace("|  |", "| |")
}

/// One sentence: when and where a run was measured, and by which command.
pub fn whereabouts(run: &Recorded) -> anyhow::Result<String> {
    let mut place = run.says("cpu").to_owned();
    if run.says("adapter") != "none" {
        let _ = write!(place, ", {} ({})", run.says("adapter"), run.says("driver"));
    }
    Ok(format!(
        "By `{}` on {}: {place}, {}, commit {}.",
        run.says("command"),
        date(run.says("date"))?,
        run.says("os"),
        short(run.says("commit")),
    ))
}

/// An abbreviated commit.
fn short(commit: &str) -> String {
    let digits = commit.chars().take_while(char::is_ascii_hexdigit).count();
    match digits {
        40 => commit[..10].to_owned() + &commit[40..],
        _ => commit.to_owned(),
    }
}

/// 2026-11-23… as "23 November 2026".
fn date(iso: &str) -> anyhow::Result<String> {
    const MONTHS: [&str; 12] = [
        "January",
        "February",
        "March",
        "April",
        "May",
        "June",
        "July",
        "August",
        "September",
        "October",
        "November",
        "December",
    ];
    let mut parts = iso
        .get(..10)
        .unwrap_or_default()
        .split('-')
        .map(str::parse::<usize>);
    match (parts.next(), parts.next(), parts.next()) {
        (Some(Ok(year)), Some(Ok(month @ 1..=12)), Some(Ok(day @ 1..=31))) => {
            Ok(format!("{day} {} {year}", MONTHS[month - 1]))
        }
        _ => bail!("its date {iso:?} is no date like 2026-11-23"),
    }
}

/// A whole number with spaces between thousands: 35 786.
pub fn thousands(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (n, digit) in digits.chars().enumerate() {
        if n > 0 && (digits.len() - n) % 3 == 0 {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

/// A number with this many significant digits, without an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let decimals = digits as i32 - 1 - value.abs().log10().floor() as i32;
    // Rounding up to one more digit is rare, and correct.
    format!("{value:.*}", decimals.max(0) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_as_people_do() {
        assert_eq!(thousands(35786.0), "35 786");
        assert_eq!(thousands(100.0), "100");
        assert_eq!(thousands(1000.0), "1 000");
        assert_eq!(significant(0.000299, 1), "0.0003");
        assert_eq!(significant(12.3456, 3), "12.3");
        assert_eq!(significant(0.0, 2), "0");
        assert_eq!(date("2026-11-03T10:00:00Z").unwrap(), "3 November 2026");
        assert!(date("2026-13-03").is_err() && date("today").is_err());
        assert_eq!(short(&"a".repeat(40)), "a".repeat(10));
        assert_eq!(short("unknown"), "unknown");
    }

    #[test]
    fn a_table_has_a_line_for_each_row() {
        let rows = [vec!["|a|".to_owned(), "1".to_owned()]];
        assert_eq!(
            table(&["", "n"], rows),
            "| | n |\n|---|---|\n| \\|a\\| | 1 |\n"
        );
    }
}
