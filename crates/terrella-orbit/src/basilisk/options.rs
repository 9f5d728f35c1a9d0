//! How a simulation is met.

use super::endpoint::Endpoint;
use std::ops::RangeInclusive;
use std::time::Duration;

/// Which end of which socket this side is.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Meeting {
    /// Simulators connect and wait for replies (`liveStream`, `noDisplay`).
    Listen(Endpoint),
    /// A simulator publishes without waiting for subscribers (`broadcastStream`).
    Subscribe(Endpoint),
}

impl Meeting {
    /// The endpoint.
    pub fn endpoint(&self) -> &Endpoint {
        match self {
            Self::Listen(endpoint) | Self::Subscribe(endpoint) => endpoint,
        }
    }
}

/// Settings of a simulation that is met.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulationOptions {
    /// Where.
    pub meeting: Meeting,
    /// The spacecraft that carries the scene's cameras; `None` for the first one.
    pub craft: Option<String>,
    /// Lets the endpoint be one of another machine, or one that other machines reach.
    pub allow_remote: bool,
    /// How long a simulator waits for a picture or for a step to be drawn before it is answered without.
    pub timeout: Duration,
    /// The simulation is reported as silent when its last message came longer ago, seconds.
    pub stale_after_s: f64,
}

impl SimulationOptions {
    /// Of [`Self::timeout`], seconds.
    pub const TIMEOUTS_S: RangeInclusive<f64> = 1e-3..=3600.0;
    /// Range of [`Self::stale_after_s`].
    pub const STALE_AGES_S: RangeInclusive<f64> = 1e-3..=1e6;

    /// Answers within 10 s, silent after 1 s, this machine alone.
    pub fn new(meeting: Meeting) -> Self {
        Self {
            meeting,
            craft: None,
            allow_remote: false,
            timeout: Duration::from_secs(10),
            stale_after_s: 1.0,
        }
    }

    /// Rejects settings that cannot be; [`Simulation`](super::Simulation) does so too.
    ///
    /// # Errors
    /// A setting out of its range, an endpoint of another machine that is not allowed.
    pub fn check(&self) -> Result<(), SimulationError> {
        let within = |key, value: f64, range: RangeInclusive<f64>| match range.contains(&value) {
            true => Ok(()),
            false => Err(SimulationError::Setting {
                key,
                value,
                least: *range.start(),
                most: *range.end(),
            }),
        };
        within("timeout, s,", self.timeout.as_secs_f64(), Self::TIMEOUTS_S)?;
        within("stale_after_s", self.stale_after_s, Self::STALE_AGES_S)?;
        let endpoint = self.meeting.endpoint();
        match endpoint.is_remote() && !self.allow_remote {
            false => Ok(()),
            true => Err(SimulationError::Remote {
                endpoint: endpoint.clone(),
            }),
        }
    }
}

/// Why a simulation cannot be met.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum SimulationError {
    /// A setting out of its range.
    #[error("{key} must be from {least} to {most}, not {value}")]
    Setting {
        key: &'static str,
        value: f64,
        /// The least that it may be.
        least: f64,
        most: f64,
    },
    /// The endpoint is of another machine.
    #[error("{endpoint} reaches beyond this machine; take 127.0.0.1, or write allow_remote = true")]
    Remote { endpoint: Endpoint },
    /// The endpoint cannot be bound.
    #[error(
        "cannot listen on {endpoint}: {source}; close the other viewer that does, or use another port here and in the simulation"
    )]
    Bind {
        endpoint: Endpoint,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// No thread for it.
    #[error("cannot start a thread for the simulation: {source}; close other programs")]
    Thread {
        /// Error of the operating system.
        source: std::io::Error,
    },
}
