//! Common parts of all messages that are written.

use terrella_frames::{Epoch, TimeScale, ccsds_time};

/// Who wrote a message and when.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The originator: an agency or a program.
    pub originator: String,
    /// When it is written.
    pub created: Epoch,
}

impl Header {
    pub(super) fn date(&self) -> String {
        ccsds_time(self.created, TimeScale::Utc)
    }

    pub(super) fn originator(&self) -> String {
        one_line(&self.originator)
    }
}

/// Text that stays on its line.
pub(super) fn one_line(text: &str) -> String {
    let printable = text.chars().map(|c| if c.is_control() { ' ' } else { c });
    printable.collect::<String>().trim().to_owned()
}

/// The shortest decimal number that reads back as the same one.
pub(super) fn real(value: f64) -> String {
    match value != 0.0 && !(1e-4..1e15).contains(&value.abs()) {
        true => format!("{value:e}"),
        false => format!("{value}"),
    }
}

/// `value` · 10^`power` in decimal: the digits of [`real`], the point elsewhere.
pub(super) fn shifted(value: f64, power: i32) -> String {
    let text = format!("{value:e}");
    let parts = text
        .split_once('e')
        .and_then(|(mantissa, exponent)| Some((mantissa, exponent.parse::<i32>().ok()?)));
    let Some((mantissa, exponent)) = parts else {
        return text;
    };
    let exponent = exponent + power;
    let (sign, unsigned) = match mantissa.strip_prefix('-') {
        Some(unsigned) => ("-", unsigned),
        None => ("", mantissa),
    };
    let digits = unsigned.replace('.', "");
    match usize::try_from(exponent) {
        _ if value == 0.0 => "0".to_owned(),
        Ok(before @ 0..15) if before + 1 < digits.len() => {
            let (whole, fraction) = digits.split_at(before + 1);
            format!("{sign}{whole}.{fraction}")
        }
        Ok(before @ 0..15) => format!("{sign}{digits:0<width$}", width = before + 1),
        Err(_) if exponent >= -4 => {
            let zeros = "0".repeat(exponent.unsigned_abs() as usize - 1);
            format!("{sign}0.{zeros}{digits}")
        }
        _ => format!("{mantissa}e{exponent}"),
    }
}

#[cfg(test)]
mod tests {
    use super::super::entry::scaled_number;
    use super::*;

    #[test]
    fn metres_written_as_kilometres_are_read_back_bit_for_bit() {
        let mut random = 0x9e37_79b9_7f4a_7c15_u64;
        for k in 0..100_000 {
            random ^= random << 13;
            random ^= random >> 7;
            random ^= random << 17;
            let value = match k % 2 {
                0 => (random >> 11) as f64 * 2e-9 * if random & 1 == 0 { 1.0 } else { -1.0 },
                _ => f64::from_bits(random),
            };
            if value.is_finite() && (value == 0.0 || value.abs() > 1e-290) {
                let text = shifted(value, -3);
                assert_eq!(scaled_number(&text, 3), Some(value), "{value:e}: {text}");
                assert_eq!(real(value).parse(), Ok(value));
            }
        }
        for (value, text) in [
            (0.0, "0"),
            (-6_655_994.25, "-6655.99425"),
            (7.0, "0.007"),
            (7e3, "7"),
            (-7.1e8, "-710000"),
            (0.123, "0.000123"),
            (0.0123, "1.23e-5"),
        ] {
            assert_eq!(shifted(value, -3), text);
        }
    }
}
