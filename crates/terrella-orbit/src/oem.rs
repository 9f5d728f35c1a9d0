//! Orbit ephemeris messages (OEM, CCSDS 502.0-B): KVN and XML.
//!
//! Our own reader, because the crates for it are immature (`ccsds-ndm` 0.0, `lox-odm` alpha), and because a fault must name
//! line, column and remedy and cost its own state only, or where it is in the metadata, its own message.

mod draft;
mod kvn;
mod metadata;
mod write;
mod xml;

use super::entry::RecordError;
use super::found::Each;
use super::text;
use std::path::Path;

pub(super) use metadata::{Axes, TimeSystem, axes_and_time};
pub use write::write_oem;

/// The key that begins a message in KVN.
const VERSION: &str = "CCSDS_OEM_VERS";

/// Whether a text is an OEM.
pub(super) fn is_oem(text: &str) -> bool {
    let text = text::unmarked(text).trim_start();
    text.starts_with('<')
        || match text::kvn::lines(text).next() {
            Some(text::kvn::KvnLine::Entry(entry)) => entry.key == VERSION,
            _ => false,
        }
}

/// Calls `each` for the object of every message in a text, and for every state that is left out of one.
pub(super) fn each_object(
    text: &str,
    origin: &Path,
    each: &mut Each<'_>,
) -> Result<(), RecordError> {
    let text = text::unmarked(text);
    match text.trim_start().starts_with('<') {
        true => xml::read(text, origin, each),
        false => kvn::read(text, origin, each),
    }
}
