//! OEM out, in KVN.

use super::super::interpolated::{EphemerisFeed, Interpolation};
use super::super::write_ccsds::{Header, one_line, real, shifted};
use crate::Frame;
use std::fmt::Write;
use terrella_frames::{Epoch, TimeScale, ccsds_time};

/// Writes an ephemeris as OEM (CCSDS 502.0-B-2, KVN, UTC), segment by segment.
///
/// Every number has as many digits as it takes to read the same one back; dates have all their nanoseconds. Where samples
/// have no velocity, which the format demands, the interpolation's is written. Error estimates become covariance
/// matrices of a third of the variance on each axis of the position and zeros elsewhere: what is known is their sum.
pub fn write_oem(feed: &EphemerisFeed, header: &Header) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write(&mut text, feed, header);
    text
}

fn write(text: &mut String, feed: &EphemerisFeed, header: &Header) -> std::fmt::Result {
    use crate::Feed;
    let utc = |epoch: Epoch| ccsds_time(epoch, TimeScale::Utc);
    writeln!(text, "CCSDS_OEM_VERS = 2.0")?;
    writeln!(text, "CREATION_DATE = {}", header.date())?;
    writeln!(text, "ORIGINATOR = {}", header.originator())?;
    for segment in feed.segments() {
        let samples = &segment.samples;
        let (first, last) = samples.span();
        // The format has no extrapolation: what goes beyond the samples is left out.
        let usable = (segment.usable.0.max(first), segment.usable.1.min(last));
        if usable.0 > usable.1 {
            continue;
        }
        writeln!(text, "\nMETA_START")?;
        writeln!(text, "OBJECT_NAME = {}", one_line(feed.name()))?;
        let id = feed.object_id().unwrap_or("UNKNOWN");
        writeln!(text, "OBJECT_ID = {}", one_line(id))?;
        writeln!(text, "CENTER_NAME = EARTH")?;
        writeln!(text, "REF_FRAME = {}", frame_name(samples.frame()))?;
        writeln!(text, "TIME_SYSTEM = UTC")?;
        writeln!(text, "START_TIME = {}", utc(first))?;
        writeln!(text, "USEABLE_START_TIME = {}", utc(usable.0))?;
        writeln!(text, "USEABLE_STOP_TIME = {}", utc(usable.1))?;
        writeln!(text, "STOP_TIME = {}", utc(last))?;
        let interpolation = samples.interpolation();
        writeln!(text, "INTERPOLATION = {}", interpolation.name())?;
        if interpolation != Interpolation::Linear {
            writeln!(text, "INTERPOLATION_DEGREE = {}", interpolation.degree())?;
        }
        writeln!(text, "META_STOP")?;
        for sample in samples.samples() {
            let velocity = sample.velocity_m_s.or_else(|| {
                let state = samples.state_at(sample.epoch);
                state.map(|state| state.velocity_m_s)
            });
            let (r, v) = (sample.position_m, velocity.unwrap_or_default());
            write!(text, "{}", utc(sample.epoch))?;
            for metres in r.to_array().into_iter().chain(v.to_array()) {
                write!(text, " {}", shifted(metres, -3))?;
            }
            writeln!(text)?;
        }
        if !segment.sigma_m.is_empty() {
            writeln!(text, "COVARIANCE_START")?;
            for (epoch, sigma_m) in &segment.sigma_m {
                let third = real((sigma_m / 1e3).powi(2) / 3.0);
                writeln!(text, "EPOCH = {}", utc(*epoch))?;
                writeln!(text, "{third}\n0 {third}\n0 0 {third}")?;
                writeln!(text, "0 0 0 0\n0 0 0 0 0\n0 0 0 0 0 0")?;
            }
            writeln!(text, "COVARIANCE_STOP")?;
        }
    }
    Ok(())
}

/// As the registry of the CCSDS names it.
fn frame_name(frame: Frame) -> &'static str {
    match frame {
        Frame::Itrf => "ITRF2000",
        Frame::Gcrf => "GCRF",
        other => other.name(),
    }
}
