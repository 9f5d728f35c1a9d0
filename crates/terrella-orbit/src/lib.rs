//! Orbits: the state of a satellite at an epoch, propagated, interpolated or received. A source of states is a [`Feed`].
//!
//! | task | look in |
//! |---|---|
//! | propagate an orbit from mean elements (TLE, OMM) by SGP4 | `sgp4_feed.rs`, `sgp4_set.rs`; read them: `tle_text.rs`, `tle_fields.rs`, `omm/`,
//! `catalogue.rs`, `choose.rs`; their validity: `decay.rs` |
//! | propagate Keplerian elements, with J2 or without | [`kepler`] |
//! | integrate the motion under forces, with eclipses, nodes, apsides and impact | [`numerical`] |
//! | propagate the state of an OPM over its manoeuvres | [`ParameterMessages`], `opm/` |
//! | interpolate an ephemeris (Lagrange, Hermite) | [`interpolated`]; read one: `oem/`, `czml.rs`, `ephemeris_csv.rs`, `sp3.rs`, `stk.rs`, `runs.rs`, `ephemerides.rs`, `found.rs` |
//! | read attitudes (AEM, CSV of quaternions) | [`AttitudeHistory`], `attitude/` |
//! | read many satellites from a file | [`OrbitFiles`], `orbit_files.rs` |
//! | detect a truncated file | `cut.rs` |
//! | parse dates in any form of ISO 8601 | `iso8601.rs` |
//! | receive states from a simulator | [`live`]; without a transport, [`pushed`] |
//! | find passes over a place | `passes.rs` |
//! | find eclipses, nodes and apsides of any motion | `event_search.rs` |
//! | transform a state vector between frames | `state.rs` |
//! | detect the format of a file | `recognise.rs` |
//! | find the validity of a feed | [`Feed::validity`], `validity.rs` |
//!
//! Time scales and leap seconds are in [`frames`](terrella_frames). `oem.rs`, `omm.rs` and `numerical/integrate.rs` explain why the readers of OEM
//! and OMM and the integrators are our own.

// docs.rs shows the required feature of each item.
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
mod event_search;
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
pub mod pushed;
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
pub use event_search::{MotionEvent, MotionEventKind, SoughtEvents, motion_events};
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

/// Formats of orbit files. [`FileFormat::of_text`] detects the format of a file.
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
    /// First and last epoch at which the feed has a state.
    fn validity(&self) -> (Epoch, Epoch);
    /// The state at `epoch`; an epoch outside the validity interval is an error that names the interval.
    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError>;
    /// Uncertainty of the position at `epoch`, metres (one standard deviation), if the source knows it.
    fn error_m(&self, epoch: Epoch) -> Option<f64> {
        let _ = epoch;
        None
    }
    /// Time of impact on the ground, if it happens after the start; the validity ends there.
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
    /// Times within the validity, in order, at which the motion is not smooth: an engine fires, or another record begins. The state at such a time
    /// is the one after the change.
    fn breaks(&self) -> Vec<Epoch> {
        Vec::new()
    }
    /// The international designator, `1998-067A`, where the source has one.
    fn object_id(&self) -> Option<&str> {
        None
    }
    /// The identifier in a file whose names may repeat: the `id` of CZML.
    fn id(&self) -> Option<&str> {
        None
    }
    /// Whether its current state is up to date; only live feeds can be late.
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

    fn id(&self) -> Option<&str> {
        self.as_ref().id()
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
