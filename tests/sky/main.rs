//! The sky: positions, by other programs' tables, and rendering.

mod bad_input;
#[path = "../common/mod.rs"]
mod common;
mod drawn;
mod eclipses;
mod extremes;
mod places;

use std::path::Path;
use std::sync::Arc;
use terrella::celestial::StarCatalogue;
use terrella::frames::{Epoch, utc_from_rfc3339};

/// The star catalogue of the starter pack.
fn stars() -> Arc<StarCatalogue> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("textures/stars.bin");
    Arc::new(StarCatalogue::read(&path).expect("a good catalogue"))
}

/// A date, with its Z or without.
fn utc(text: &str) -> Epoch {
    utc_from_rfc3339(&format!("{}Z", text.trim_end_matches('Z'))).expect("a date")
}
