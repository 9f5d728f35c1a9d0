//! Instants.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{buffer, check_out, text, write};
use std::ffi::c_char;
use terrella::frames::{Duration, Epoch, rfc3339, utc_from_rfc3339};

/// An instant, in international atomic time (TAI) since 1900-01-01T00:00:00 TAI. Differences are elapsed time, through leap seconds too.
/// `terrella_time_utc` and `terrella_time_unix` make it.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TerrellaTime {
    /// Whole seconds.
    pub tai_s: i64,
    /// Nanoseconds after that, 0 to 999 999 999.
    pub tai_ns: u32,
}

const NS_PER_S: i128 = 1_000_000_000;
/// 1900-01-01 and 2100-01-01: the dates that Sun and feeds are known for.
const SECONDS: std::ops::Range<i64> = 0..6_311_433_700;

impl TerrellaTime {
    pub(crate) fn of(epoch: Epoch) -> Self {
        let ns = epoch.to_tai_duration().total_nanoseconds();
        Self {
            tai_s: ns.div_euclid(NS_PER_S) as i64,
            tai_ns: ns.rem_euclid(NS_PER_S) as u32,
        }
    }

    pub(crate) fn epoch(self, name: &str) -> Result<Epoch, Failure> {
        if !SECONDS.contains(&self.tai_s) || i128::from(self.tai_ns) >= NS_PER_S {
            return Err(Failure::argument(format!(
                "{name}: {} s and {} ns of TAI after 1900 are not in the years 1900 to 2099; make it by terrella_time_utc",
                self.tai_s, self.tai_ns
            )));
        }
        let ns = i128::from(self.tai_s) * NS_PER_S + i128::from(self.tai_ns);
        Ok(Epoch::from_tai_duration(Duration::from_total_nanoseconds(
            ns,
        )))
    }
}

/// An instant from a text like "2018-01-15T12:00:00Z" or "2018-01-15T13:30:00.25+01:30" (RFC 3339); leap seconds are read.
///
/// # Safety
/// `text` ends with a zero byte; `time` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_time_utc(
    text: *const c_char,
    time: *mut TerrellaTime,
) -> TerrellaStatus {
    answer(|| {
        check_out(time, "time")?;
        // SAFETY: the caller's promise about `text`.
        let words = unsafe { self::text(text, "text") }?;
        let epoch = utc_from_rfc3339(words);
        let epoch = epoch.map_err(|error| Failure::argument(format!("text: {error}")))?;
        // SAFETY: the caller's promise about `time`.
        unsafe { write(time, "time", TerrellaTime::of(epoch)) }
    })
}

/// An instant from seconds since 1970-01-01T00:00:00Z as POSIX counts them, without leap seconds.
///
/// # Safety
/// `time` points to writable memory.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_time_unix(
    unix_s: f64,
    time: *mut TerrellaTime,
) -> TerrellaStatus {
    answer(|| {
        // 1900-01-01 to 2100-01-01.
        if !(-2_208_988_800.0..4_102_444_800.0).contains(&unix_s) {
            return Err(Failure::argument(format!(
                "unix_s: {unix_s} is not in the years 1900 to 2099"
            )));
        }
        let ns = Duration::from_seconds(unix_s);
        // SAFETY: the caller's promise about `time`.
        unsafe {
            write(
                time,
                "time",
                TerrellaTime::of(Epoch::from_unix_duration(ns)),
            )
        }
    })
}

/// The instant `elapsed_s` seconds after `time`; before it if negative.
///
/// # Safety
/// `later` points to writable memory, which may be that of `time`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_time_add(
    time: TerrellaTime,
    elapsed_s: f64,
    later: *mut TerrellaTime,
) -> TerrellaStatus {
    answer(|| {
        let epoch = time.epoch("time")?;
        if !elapsed_s.is_finite() || elapsed_s.abs() >= 1e10 {
            return Err(Failure::argument(format!(
                "elapsed_s: {elapsed_s} is not a number of seconds from -1e10 to 1e10"
            )));
        }
        let sum = TerrellaTime::of(epoch + Duration::from_seconds(elapsed_s));
        sum.epoch("the sum of time and elapsed_s")?;
        // SAFETY: the caller's promise about `later`.
        unsafe { write(later, "later", sum) }
    })
}

/// Writes an instant as a text in UTC, like "2018-01-15T12:00:00.000Z", with a zero byte at its end: 40 bytes are enough. A buffer that
/// is too short is `TERRELLA_ARGUMENT`, and nothing is written.
///
/// # Safety
/// `text` points to writable memory of `bytes` bytes.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_time_text(
    time: TerrellaTime,
    text: *mut c_char,
    bytes: usize,
) -> TerrellaStatus {
    answer(|| {
        let words = rfc3339(time.epoch("time")?);
        if words.len() >= bytes {
            return Err(Failure::argument(format!(
                "bytes: {bytes} are not enough for {words} and a zero"
            )));
        }
        // SAFETY: the caller's promise about `text`; only what is needed is touched.
        let room = unsafe {
            buffer(
                text.cast::<std::mem::MaybeUninit<u8>>(),
                words.len() + 1,
                "text",
            )
        }?;
        for (to, from) in room.iter_mut().zip(words.bytes().chain([0])) {
            to.write(from);
        }
        Ok(())
    })
}
