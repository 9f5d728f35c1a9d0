//! Orbit parameter messages (OPM, CCSDS 502.0-B): KVN and XML. A message has one state of a satellite; its receiver propagates it.
//!
//! Our own reader, for the reasons of `oem.rs`, whose axes and dates it shares.

mod feed;
mod maneuver;
mod message;
mod messages;
mod record;

pub use feed::OpmFeed;
pub use maneuver::Maneuver;
pub use message::ParameterMessage;
pub use messages::ParameterMessages;
