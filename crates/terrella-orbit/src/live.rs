//! States that a simulator sends during rendering.
//!
//! A simulator sends packets over standard input, TCP, UDP or WebSocket. The player requests states and never waits for the network. On a stream
//! both formats may be mixed; a WebSocket message or UDP datagram holds whole packets.
//!
//! # JSON
//!
//! One object in one line of at most 4096 bytes, ended by a line feed:
//!
//! ```text
//! {"seq":1,"epoch":"2018-01-15T12:00:00.000Z","frame":"GCRF","position_m":[6778136.3,0,0],"velocity_m_s":[0,7668.6,0]}
//! ```
//!
//! | key | value |
//! |---|---|
//! | `epoch` | UTC as RFC 3339, years 1900…2099, up to nine decimals |
//! | `frame` | `GCRF`, `EME2000`, `TEME`, `ITRF` or `PEF` |
//! | `position_m` | three numbers, metres from the Earth's centre, length 1…1e13 |
//! | `velocity_m_s` | three numbers, metres per second as seen in `frame`, below the speed of light |
//! | `seq` | the simulator's count, 0…2⁶⁴ − 1; required for a frame only |
//! | `message` | `"state"`, the default, or `"frame"` |
//! | `name` | name of the satellite, at most 64 characters; the first one is kept |
//!
//! Other keys are skipped. Replies are `{"message":"ack","seq":1}` and `{"message":"error","seq":1,"error":"…"}`, with `"seq":null` for a packet
//! that could not be read.
//!
//! # Binary
//!
//! 84 bytes, little endian:
//!
//! | byte | type | content |
//! |---|---|---|
//! | 0 | 4 bytes | `89 54 52 4C`, that is `\x89TRL` |
//! | 4 | u8 | version, 1 |
//! | 5 | u8 | kind: 1 state, 2 frame; replies: 3 drawn, 4 error |
//! | 6 | u16 | length of the whole packet, 84 |
//! | 8 | u64 | seq |
//! | 16 | i64 | epoch, nanoseconds of TAI since 1970-01-01T00:00:00 TAI (as IEEE 1588 counts) |
//! | 24 | u8 | frame: 0 TEME, 1 PEF, 2 ITRF, 3 GCRF, 4 EME2000 |
//! | 25 | 7 bytes | 0 |
//! | 32 | 3 × f64 | position, metres |
//! | 56 | 3 × f64 | velocity, metres per second |
//! | 80 | u32 | CRC-32 (zlib's) of the bytes before |
//!
//! A reply has the first 16 bytes, for an error up to 512 bytes of UTF-8, and the CRC-32; seq is 2⁶⁴ − 1 if it is unknown. The format of a reply is
//! that of the packet.
//!
//! # Pacing
//!
//! *Broadcast*: the simulator never waits. Images show [`LiveFeed::playback_epoch`], a little behind the simulator, so that late packets still
//! arrive in time. Between states Hermite's cubic interpolates. Beyond the last one the motion is extrapolated up to the limit, and
//! [`Feed::freshness`] reports it. After the limit the feed returns an error, and playback stops.
//!
//! *Lockstep*: the simulator sends frames and waits for each reply. The player takes a frame with [`LiveFeed::next_request`], draws its state, and
//! calls [`LiveFeed::acknowledge`]. A frame that is not drawn in time gets an error as reply; so does a packet that cannot be read.
//!
//! # Trust
//!
//! Ports are bound to this machine only unless [`LiveOptions::allow_remote`] is set; web pages cannot connect unless
//! [`LiveOptions::allowed_origins`] lists them. There is no encryption and no authentication. A bad packet is counted and dropped; memory is
//! bounded: 256 states, 4 KiB a packet, 4 simulators.
//!
//! A connection counts as a simulator from its first valid packet on. With more than four, the one that has been silent longest is dismissed, but
//! never one that waits for a frame. Eight more connections without a valid packet are allowed; each has 300 s for its first packet.

mod lockstep;
mod options;
mod reply;
mod serve;
mod shared;
mod split;
mod websocket;

pub use super::pushed::{
    Extrapolation, MAX_PACKET_BYTES, Packet, PacketFault, PacketFormat, PacketKind,
};
pub use lockstep::FrameRequest;
pub use options::{LiveError, LiveOptions, Pacing, Transport};
pub use shared::PacketCounters;
pub use split::{Received, Splitter};

use super::connections::Standing;
use super::pushed::later;
use super::{Feed, Freshness, OrbitError, OrbitState};
use lockstep::Outcome;
use shared::SharedFeed;
use std::io::{Read, Write};
use std::net::SocketAddr;
use std::sync::Arc;
use std::thread::JoinHandle;
use std::time::Duration;
use terrella_files::printable;
use terrella_frames::{Epoch, rfc3339, utc_from_rfc3339};

/// A feed whose states arrive while it is in use. The [module](self) describes what simulators send.
///
/// Dropping it replies to all pending frames with an error, ends its threads and closes its port, within 0.4 s; a thread that reads standard input
/// ends with that.
#[derive(Debug)]
pub struct LiveFeed {
    shared: Arc<SharedFeed>,
    address: Option<SocketAddr>,
    thread: Option<JoinHandle<()>>,
}

impl LiveFeed {
    /// Listens on the transport of the options.
    ///
    /// # Errors
    /// A setting out of its range, an address that other machines reach, a port that is taken.
    pub fn open(options: LiveOptions) -> Result<Self, LiveError> {
        options.check()?;
        let shared = Arc::new(SharedFeed::new(options));
        let (address, thread) = match shared.options.transport {
            Transport::Stdin => {
                serve::stdin(&shared)?;
                return Ok(Self::of(shared, None, None));
            }
            Transport::Tcp(address) => serve::listen(address, serve::tcp, &shared)?,
            Transport::Udp(address) => serve::udp(address, &shared)?,
            Transport::WebSocket(address) => serve::listen(address, websocket::serve, &shared)?,
        };
        Ok(Self::of(shared, Some(address), Some(thread)))
    }

    /// Reads any stream, such as a pipe or a child's output, instead of the options' transport; replies go to `write`.
    ///
    /// The thread ends with the stream, or with the next bytes after the feed is dropped.
    ///
    /// # Errors
    /// A setting out of its range.
    pub fn from_stream(
        mut read: impl Read + Send + 'static,
        mut write: impl Write + Send + 'static,
        options: LiveOptions,
    ) -> Result<Self, LiveError> {
        let options = LiveOptions {
            transport: Transport::Stdin,
            ..options
        };
        options.check()?;
        let shared = Arc::new(SharedFeed::new(options));
        let its = Arc::clone(&shared);
        serve::spawn("stream", move || {
            serve::stream(&mut read, &mut write, &its, &Standing::default());
            its.end();
        })?;
        Ok(Self::of(shared, None, None))
    }

    /// A feed without a transport, which no packet reaches: to look at a set-up without taking its port.
    ///
    /// # Errors
    /// A setting out of its range, an address that other machines reach.
    pub fn unconnected(options: LiveOptions) -> Result<Self, LiveError> {
        options.check()?;
        let shared = Arc::new(SharedFeed::new(options));
        shared.end();
        Ok(Self::of(shared, None, None))
    }

    fn of(
        shared: Arc<SharedFeed>,
        address: Option<SocketAddr>,
        thread: Option<JoinHandle<()>>,
    ) -> Self {
        Self {
            shared,
            address,
            thread,
        }
    }

    /// The address that is listened on, with the port that was found for port 0; `None` for a stream.
    pub fn local_address(&self) -> Option<SocketAddr> {
        self.address
    }

    /// How it was set up.
    pub fn options(&self) -> &LiveOptions {
        &self.shared.options
    }

    /// Counters of received packets and their results.
    pub fn counters(&self) -> PacketCounters {
        self.shared.lock().counters
    }

    /// The error of the last bad packet.
    pub fn last_fault(&self) -> Option<String> {
        self.shared.lock().last_fault.clone()
    }

    /// How long ago the last state came; `None` before the first.
    pub fn age(&self) -> Option<Duration> {
        self.shared.lock().last_came.map(|came| came.elapsed())
    }

    /// Whether no more packets can arrive: the input stream has ended. A port never ends.
    pub fn has_ended(&self) -> bool {
        self.shared.has_ended()
    }

    /// The newest state that has come.
    pub fn newest(&self) -> Option<OrbitState> {
        self.shared.lock().buffer.newest().copied()
    }

    /// The time of the current image in broadcast: behind the simulator by the delay, and at most at the limit of extrapolation, where it stays
    /// until new states arrive. `None` before the first state.
    ///
    /// It steps back when a simulator continues after a pause, and jumps when the simulator jumps.
    pub fn playback_epoch(&self) -> Option<Epoch> {
        let inner = self.shared.lock();
        let options = &self.shared.options;
        let newest = inner.buffer.newest()?.epoch;
        let oldest = inner.buffer.oldest()?.epoch;
        let known = (oldest, later(newest, options.extrapolation_limit_s));
        let now = self.shared.opened.elapsed();
        let shown = inner.clock.shown(now, options.playback_delay_s, known);
        // There is no playback in lockstep: the frame that was last requested.
        Some(shown.unwrap_or(newest))
    }

    /// The next frame that a simulator waits for, lockstep; never waits itself.
    pub fn next_request(&self) -> Option<FrameRequest> {
        self.shared.lockstep.next()
    }

    /// The same; waits for one, at most so long.
    pub fn wait_request(&self, timeout: Duration) -> Option<FrameRequest> {
        self.shared.lockstep.wait(timeout)
    }

    /// Reports to the simulator that the image is drawn. Returns `false` if it no longer waits.
    pub fn acknowledge(&self, request: &FrameRequest) -> bool {
        self.shared.lockstep.end(request, Outcome::Drawn)
    }

    /// Reports to the simulator why there is no image. Returns `false` if it no longer waits.
    pub fn reject(&self, request: &FrameRequest, reason: &str) -> bool {
        let reason = printable(reason);
        self.shared.lockstep.end(request, Outcome::Rejected(reason))
    }

    /// Where it listens, with the port that was found for port 0.
    pub fn listens_on(&self) -> Transport {
        let transport = &self.shared.options.transport;
        match self.address {
            Some(address) => transport.at(address),
            None => transport.clone(),
        }
    }
}

impl Feed for LiveFeed {
    fn name(&self) -> &str {
        let name = self.shared.name.get();
        name.unwrap_or(&self.shared.options.name)
    }

    /// From the oldest kept state to the limit after the latest one; it moves with time. Before the first state it is unbounded.
    fn validity(&self) -> (Epoch, Epoch) {
        let inner = self.shared.lock();
        match (inner.buffer.oldest(), inner.buffer.newest()) {
            (Some(oldest), Some(newest)) => {
                let limit_s = self.shared.options.extrapolation_limit_s;
                (oldest.epoch, later(newest.epoch, limit_s))
            }
            _ => {
                let year = |text| utc_from_rfc3339(text).unwrap_or_default();
                (year("1900-01-01T00:00:00Z"), year("2099-12-31T00:00:00Z"))
            }
        }
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let options = &self.shared.options;
        let name = || self.name().to_owned();
        let inner = self.shared.lock();
        let (Some(oldest), Some(newest)) = (inner.buffer.oldest(), inner.buffer.newest()) else {
            let from = self.listens_on();
            return Err(LiveError::NoState { name: name(), from }.into());
        };
        if let Some(state) = inner.buffer.between(epoch) {
            return Ok(state);
        }
        let (oldest, newest) = (oldest.epoch, newest.epoch);
        if epoch < newest {
            return Err(LiveError::TooOld {
                name: name(),
                epoch: rfc3339(epoch),
                oldest: rfc3339(oldest),
            }
            .into());
        }
        let is_near = epoch <= later(newest, options.extrapolation_limit_s);
        let beyond = is_near.then(|| inner.buffer.beyond(epoch, options.extrapolation));
        beyond.flatten().ok_or_else(|| {
            LiveError::TooFar {
                name: name(),
                epoch: rfc3339(epoch),
                newest: rfc3339(newest),
                age_s: inner.last_came.map_or(0.0, |t| t.elapsed().as_secs_f64()),
                limit_s: options.extrapolation_limit_s,
            }
            .into()
        })
    }

    fn freshness(&self) -> Freshness {
        let Some(came) = self.shared.lock().last_came else {
            return Freshness::Waiting;
        };
        let age_s = came.elapsed().as_secs_f64();
        match age_s > self.shared.options.stale_after_s {
            true => Freshness::Stale { age_s },
            false => Freshness::Live,
        }
    }
}

impl Drop for LiveFeed {
    fn drop(&mut self) {
        self.shared.close();
        if let Some(thread) = self.thread.take() {
            // A thread that panicked has said so itself.
            let _ = thread.join();
        }
    }
}
