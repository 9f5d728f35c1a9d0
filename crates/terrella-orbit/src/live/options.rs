//! Settings of a live feed, their ranges, and its errors.

use super::super::pushed::{Extrapolation, REACH_S};
use std::fmt;
use std::net::{IpAddr, Ipv4Addr, SocketAddr};
use std::ops::RangeInclusive;
use std::str::FromStr;
use std::time::Duration;

/// Source of states.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Transport {
    /// Standard input; replies go to standard output.
    Stdin,
    /// A TCP port that simulators connect to. Port 0 takes a free one.
    Tcp(SocketAddr),
    /// A UDP port: a datagram is one binary packet, or one or more lines.
    Udp(SocketAddr),
    /// A WebSocket port: a message is as a datagram.
    WebSocket(SocketAddr),
}

impl Transport {
    /// The port that is listened on; `None` for standard input.
    pub fn address(&self) -> Option<SocketAddr> {
        match *self {
            Self::Stdin => None,
            Self::Tcp(address) | Self::Udp(address) | Self::WebSocket(address) => Some(address),
        }
    }

    /// The same way in by another port.
    pub(super) fn at(&self, address: SocketAddr) -> Self {
        match self {
            Self::Stdin => Self::Stdin,
            Self::Tcp(_) => Self::Tcp(address),
            Self::Udp(_) => Self::Udp(address),
            Self::WebSocket(_) => Self::WebSocket(address),
        }
    }

    /// Whether both would use the same input. Port 0 selects a free one and never collides.
    pub fn collides_with(&self, other: &Self) -> bool {
        let is_udp = |transport: &Self| matches!(transport, Self::Udp(_));
        match (self.address(), other.address()) {
            (None, None) => true,
            (Some(a), Some(b)) => {
                let is_one_ip =
                    a.ip() == b.ip() || a.ip().is_unspecified() || b.ip().is_unspecified();
                is_udp(self) == is_udp(other) && a.port() != 0 && a.port() == b.port() && is_one_ip
            }
            _ => false,
        }
    }
}

impl fmt::Display for Transport {
    /// As [`Transport::from_str`] reads it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Stdin => f.write_str("stdin"),
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            Self::Udp(address) => write!(f, "udp://{address}"),
            Self::WebSocket(address) => write!(f, "ws://{address}"),
        }
    }
}

impl FromStr for Transport {
    type Err = LiveError;

    /// `stdin`, or `tcp://`, `udp://` or `ws://` and an IP address with a port; `localhost` is 127.0.0.1.
    fn from_str(text: &str) -> Result<Self, LiveError> {
        let unknown = || LiveError::Listen {
            given: text.to_owned(),
        };
        if text == "stdin" {
            return Ok(Self::Stdin);
        }
        let (scheme, place) = text.split_once("://").ok_or_else(unknown)?;
        let address = match place.strip_prefix("localhost:") {
            Some(port) => {
                let port = port.parse().map_err(|_| unknown())?;
                SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), port)
            }
            None => place.parse().map_err(|_| unknown())?,
        };
        match scheme {
            "tcp" => Ok(Self::Tcp(address)),
            "udp" => Ok(Self::Udp(address)),
            "ws" => Ok(Self::WebSocket(address)),
            _ => Err(unknown()),
        }
    }
}

/// How simulator and player keep pace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Pacing {
    /// Nobody: states come when they come, and pictures are drawn from the newest.
    #[default]
    Broadcast,
    /// The simulator waits until the picture of its state is drawn.
    Lockstep,
}

/// Settings of a live feed.
#[derive(Clone, Debug, PartialEq)]
pub struct LiveOptions {
    /// Source of states.
    pub transport: Transport,
    /// Who waits for whom.
    pub pacing: Pacing,
    /// The satellite's name until a packet gives one.
    pub name: String,
    /// Lets the port be bound to an address that other machines reach. Whoever reaches it can steer the picture.
    pub allow_remote: bool,
    /// Web pages whose scripts may connect by WebSocket, as their browser names them: `https://example.org`. Without it
    /// every page that is open in a browser on this machine could.
    pub allowed_origins: Vec<String>,
    /// Simulated seconds in a second, 1e-3…1e6; broadcast only.
    pub rate: f64,
    /// How far pictures are behind the simulator, seconds, 0…60, so that late packets still come in time; broadcast only.
    pub playback_delay_s: f64,
    /// The feed is stale when the last state came longer ago, seconds, above 0.
    pub stale_after_s: f64,
    /// Maximum extrapolation beyond the last state, simulated seconds, 0…1e6; later times are an error.
    pub extrapolation_limit_s: f64,
    /// How the satellite goes on there.
    pub extrapolation: Extrapolation,
    /// States farther apart in simulated time are a jump: one alone is dropped, two are a restart. Seconds, above 0.
    pub gap_s: f64,
    /// How long a simulator waits for a frame before it gets an error, 1 ms…1 h; lockstep only.
    pub frame_timeout: Duration,
    /// Packets a second, 1…1 000 000; more are dropped unread.
    pub max_packets_per_s: u32,
}

impl LiveOptions {
    /// Range of [`Self::rate`].
    pub const RATES: RangeInclusive<f64> = 1e-3..=1e6;
    /// Range of [`Self::playback_delay_s`].
    pub const PLAYBACK_DELAYS_S: RangeInclusive<f64> = 0.0..=60.0;
    /// Range of [`Self::stale_after_s`].
    pub const STALE_AGES_S: RangeInclusive<f64> = 1e-3..=1e6;
    /// Range of [`Self::extrapolation_limit_s`].
    pub const EXTRAPOLATION_LIMITS_S: RangeInclusive<f64> = 0.0..=1e6;
    /// Range of [`Self::gap_s`].
    pub const GAPS_S: RangeInclusive<f64> = 1e-3..=1e7;
    /// Of [`Self::frame_timeout`], seconds.
    pub const FRAME_TIMEOUTS_S: RangeInclusive<f64> = 1e-3..=3600.0;
    /// Range of [`Self::max_packets_per_s`].
    pub const PACKET_RATES_PER_S: RangeInclusive<i64> = 1..=1_000_000;

    /// Broadcast at the rate of real time, 0.1 s behind, stale after 1 s, an error 60 s beyond the last state.
    pub fn new(transport: Transport) -> Self {
        Self {
            transport,
            pacing: Pacing::default(),
            name: "live".to_owned(),
            allow_remote: false,
            allowed_origins: Vec::new(),
            rate: 1.0,
            playback_delay_s: 0.1,
            stale_after_s: 1.0,
            extrapolation_limit_s: REACH_S,
            extrapolation: Extrapolation::default(),
            gap_s: REACH_S,
            frame_timeout: Duration::from_secs(10),
            max_packets_per_s: 10_000,
        }
    }

    /// Rejects settings that cannot be; [`LiveFeed::open`](super::LiveFeed::open) does so too.
    ///
    /// # Errors
    /// A setting out of its range, or an address that other machines reach.
    pub fn check(&self) -> Result<(), LiveError> {
        let within = |key, value: f64, range: RangeInclusive<f64>| match range.contains(&value) {
            true => Ok(()),
            false => Err(LiveError::Setting {
                key,
                value,
                least: *range.start(),
                most: *range.end(),
            }),
        };
        within("rate", self.rate, Self::RATES)?;
        within(
            "playback_delay_s",
            self.playback_delay_s,
            Self::PLAYBACK_DELAYS_S,
        )?;
        within("stale_after_s", self.stale_after_s, Self::STALE_AGES_S)?;
        within(
            "extrapolation_limit_s",
            self.extrapolation_limit_s,
            Self::EXTRAPOLATION_LIMITS_S,
        )?;
        within("gap_s", self.gap_s, Self::GAPS_S)?;
        let timeout_s = self.frame_timeout.as_secs_f64();
        within("frame_timeout, s,", timeout_s, Self::FRAME_TIMEOUTS_S)?;
        let packets = f64::from(self.max_packets_per_s);
        let (least, most) = Self::PACKET_RATES_PER_S.into_inner();
        within("max_packets_per_s", packets, least as f64..=most as f64)?;
        let Some(address) = self.transport.address() else {
            return Ok(());
        };
        match address.ip().is_loopback() || self.allow_remote {
            true => Ok(()),
            false => Err(LiveError::NotLoopback { address }),
        }
    }
}

/// Why a live feed cannot listen, or has no state at an epoch.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum LiveError {
    /// A setting out of its range.
    #[error("{key} is {value}; expected {least} to {most}")]
    Setting {
        key: &'static str,
        /// The value that was given.
        value: f64,
        /// The least it may be.
        least: f64,
        /// The most it may be.
        most: f64,
    },
    /// No such way in.
    #[error(
        "cannot listen on {given:?}; expected \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port, such as \"tcp://127.0.0.1:5005\""
    )]
    Listen {
        /// As it was given.
        given: String,
    },
    /// An address that other machines may reach.
    #[error(
        "{address} can be reached from other machines, and anyone who reaches it can control the image; use 127.0.0.1 or ::1, or allow remote simulators"
    )]
    NotLoopback { address: SocketAddr },
    /// The port cannot be had.
    #[error("cannot listen on {address}: {source}; take another port, or 0 for a free one")]
    Bind {
        address: SocketAddr,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// No thread to be had.
    #[error("cannot start a thread for the live feed: {source}")]
    Thread {
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// No state has come yet.
    #[error(
        "{name}: no state has arrived on {from} yet; start the simulator, or correct where it sends"
    )]
    NoState {
        /// The satellite.
        name: String,
        /// Source of the expected states.
        from: Transport,
    },
    /// Before the states that are kept.
    #[error(
        "{name} is not known at {epoch}: the oldest state it has kept is at {oldest}; a live feed keeps 256"
    )]
    TooOld {
        /// The satellite.
        name: String,
        /// The requested epoch, UTC.
        epoch: String,
        /// The oldest state, UTC.
        oldest: String,
    },
    /// Too far beyond the last state.
    #[error(
        "{name} is not known at {epoch}: its last state is at {newest} and arrived {age_s:.1} s ago; it is extrapolated for {limit_s} s only: check that the simulator still sends, or raise extrapolation_limit_s"
    )]
    TooFar {
        /// The satellite.
        name: String,
        /// The requested epoch, UTC.
        epoch: String,
        /// The newest state, UTC.
        newest: String,
        /// How long ago it came, seconds.
        age_s: f64,
        limit_s: f64,
    },
}
