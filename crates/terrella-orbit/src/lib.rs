//! Orbits: where a satellite is at an epoch, propagated, interpolated or sent; whatever says so is a [`Feed`].
//!
//! | to | look in |
//! |---|---|
//! | propagate an orbit from mean elements (TLE, OMM) by SGP4 | `sgp4_feed.rs`, `sgp4_set.rs`; read them: `tle_text.rs`, `tle_fields.rs`, `omm/`, `catalogue.rs`, `choose.rs`; how long they fly: `decay.rs` |
//! | propagate Keplerian elements, with J2 or without | [`kepler`] |
//! | integrate under forces; eclipses, nodes, apsides and impact on the way | [`numerical`] |
//! | propagate the state of an OPM over its manoeuvres | [`ParameterMessages`], `opm/` |
//! | interpolate an ephemeris (Lagrange, Hermite) | [`interpolated`]; read one: `oem/`, `czml.rs`, `ephemeris_csv.rs`, `sp3.rs`, `stk.rs`, `runs.rs`, `ephemerides.rs`, `found.rs` |
//! | read attitudes (AEM, CSV of quaternions) | [`AttitudeHistory`], `attitude/` |
//! | take many satellites from a file | [`OrbitFiles`], `orbit_files.rs` |
//! | notice a file that was cut off | `cut.rs` |
//! | read dates in any form of ISO 8601 | `iso8601.rs` |
//! | take states that a simulator sends | [`live`] |
//! | find passes over a place | `passes.rs` |
//! | turn a state vector from frame to frame | `state.rs` |
//! | tell what kind of orbits a file holds | `recognise.rs` |
//! | see how long a feed answers | [`Feed::validity`], `validity.rs` |
//!
//! Time scales and leap seconds are in [`frames`](terrella_frames). Why the readers of OEM and OMM and the
//! integrators are our own stands in `oem.rs`, `omm.rs` and `numerical/integrate.rs`.

// docs.rs says of each item which feature it needs.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod access;
mod attitude;
#[cfg(feature = "basilisk")]
pub mod basilisk;
mod catalogue;
mod choose;
#[cfg(any(feature = "basilisk", feature = "live"))]
pub(crate) mod connections;
pub mod constants;
mod coverage;
mod csv_row;
mod cut;
mod czml;
mod decay;
mod encoding;
mod entry;
mod ephemerides;
mod ephemeris_csv;
mod error;
mod field_of_view;
mod file;
mod found;
pub mod interpolated;
mod iso8601;
pub mod kepler;
#[cfg(feature = "live")]
pub mod live;
mod mean_elements;
pub mod numerical;
mod oem;
mod omm;
mod one_dimension;
mod opm;
mod orbit_files;
mod passes;
mod recognise;
mod rejected;
mod runs;
mod sgp4_feed;
mod sgp4_set;
mod sp3;
mod start_error;
mod state;
mod stk;
mod text;
mod tle_fields;
mod tle_text;
mod validity;
mod visible;
mod write_ccsds;
mod write_csv;

use terrella_frames::Epoch;

pub use access::{Access, AccessFrom, AccessRule, MAX_ACCESSES, accesses};
pub use attitude::{AttitudeError, AttitudeHistory};
pub use catalogue::Catalogue;
pub use coverage::{
    Cell, CellCoverage, GroundSensor, MAX_CELLS, coverage, coverage_grid, coverage_while,
};
pub use cut::CutOff;
pub use entry::{RecordError, RecordFault};
pub use ephemerides::Ephemerides;
pub use error::{LineFault, OrbitError};
pub use field_of_view::{AimedField, EDGE_POINTS, FieldOfView, FieldShape};
pub use interpolated::EphemerisFeed;
pub use mean_elements::MeanElements;
pub use oem::write_oem;
pub use omm::write_omm;
pub use opm::{Maneuver, OpmFeed, ParameterMessage, ParameterMessages};
pub use orbit_files::{OrbitFile, OrbitFiles};
pub use passes::{LookAngles, Observer, Pass, next_pass, passes};
pub use sgp4_feed::{Sgp4Feed, TleFeed};
pub use start_error::StartError;
pub use state::{Frame, OrbitState};
pub use visible::{VisibilityRule, VisibleInterval, visible_intervals};
pub use write_ccsds::Header;
pub use write_csv::{csv_field, csv_header, csv_row};

/// Kinds of files of orbits. What kind a file is: [`FileFormat::of_text`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileFormat {
    /// Two-line elements.
    Tle,
    /// Orbit mean-elements message.
    Omm,
    /// Orbit ephemeris message.
    Oem,
    /// Orbit parameter message.
    Opm,
    /// CZML.
    Czml,
    /// States in columns.
    Csv,
    /// SP3, orbits of navigation satellites.
    Sp3,
    /// An ephemeris of STK.
    Stk,
}

/// A source of motion.
pub trait Feed: Send + Sync {
    /// The satellite's name, for panels and pictures.
    fn name(&self) -> &str;
    /// First and last epoch that the feed answers for.
    fn validity(&self) -> (Epoch, Epoch);
    /// The state at `epoch`; an epoch outside the validity interval is an error that names the interval.
    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError>;
    /// How far the position may be off at `epoch`, metres (one standard deviation), where the source knows.
    fn error_m(&self, epoch: Epoch) -> Option<f64> {
        let _ = epoch;
        None
    }
    /// When it meets the ground after its start, if it does so in the time that it is known of: its validity ends there.
    fn impact(&self) -> Option<Epoch> {
        None
    }
    /// Last instants before and after the epoch of mean elements at which their theory still gives an orbit, where that ends within
    /// the time that they hold for: the validity is cut there.
    fn decay(&self) -> (Option<Epoch>, Option<Epoch>) {
        (None, None)
    }
    /// Times within the validity, in order, in which it has no state: from the last instant before to the first one after.
    fn gaps(&self) -> Vec<(Epoch, Epoch)> {
        Vec::new()
    }
    /// Instants within the validity, in order, at which the motion is not smooth: an engine fires, or another record begins. The state
    /// of such an instant is that behind it.
    fn breaks(&self) -> Vec<Epoch> {
        Vec::new()
    }
    /// The international designator, `1998-067A`, where the source has one.
    fn object_id(&self) -> Option<&str> {
        None
    }
    /// Whether what it says now is up to date; only live feeds can be late.
    fn freshness(&self) -> Freshness {
        Freshness::Settled
    }
}

impl<F: Feed + ?Sized> Feed for std::sync::Arc<F> {
    fn name(&self) -> &str {
        self.as_ref().name()
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.as_ref().validity()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        self.as_ref().state_at(epoch)
    }

    fn error_m(&self, epoch: Epoch) -> Option<f64> {
        self.as_ref().error_m(epoch)
    }

    fn impact(&self) -> Option<Epoch> {
        self.as_ref().impact()
    }

    fn decay(&self) -> (Option<Epoch>, Option<Epoch>) {
        self.as_ref().decay()
    }

    fn gaps(&self) -> Vec<(Epoch, Epoch)> {
        self.as_ref().gaps()
    }

    fn breaks(&self) -> Vec<Epoch> {
        self.as_ref().breaks()
    }

    fn object_id(&self) -> Option<&str> {
        self.as_ref().object_id()
    }

    fn freshness(&self) -> Freshness {
        self.as_ref().freshness()
    }
}

/// Whether a feed's states are up to date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Freshness {
    /// All states are known: nothing is waited for.
    Settled,
    /// States come in time.
    Live,
    /// The last state is older than the feed's limit: it goes on from there. Seconds since it came.
    Stale {
        /// Age of the last state, seconds.
        age_s: f64,
    },
    /// No state has come yet.
    Waiting,
}
