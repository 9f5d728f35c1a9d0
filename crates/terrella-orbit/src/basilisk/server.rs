//! Two-way simulations: they connect, send requests, and wait for every reply without a timeout.
//!
//! A simulator whose request gets no reply hangs forever, so every path through this code must reply. Each request has a stand-in that is sent if
//! its reply fails, even by a panic. When this side ends, it closes a connection together with a reply, in one segment, while no request can be in
//! transit, or after a second without a request.

use super::endpoint::{Listener, Stream};
use super::message::{MAX_MESSAGE_BYTES, viewer_input};
use super::shared::{Session, SharedSimulation};
use super::zmtp::{Connection, ZmtpError};
use crate::connections::{Connections, GRACE, Standing};
use std::cell::Cell;
use std::io;
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// How often a thread that waits for bytes looks whether all ends.
pub const LOOK: Duration = Duration::from_millis(50);
/// Time after which an unread reply is an error.
pub const WRITE: Duration = Duration::from_secs(5);
/// How often the listening thread looks for a simulator.
const LISTEN: Duration = Duration::from_millis(10);
/// Takes connections until all ends, and waits for their threads.
pub fn listen(listener: &Listener, shared: &Arc<SharedSimulation>) {
    let mut connections = Connections::default();
    while !shared.is_stopped() {
        connections.tidy();
        let accepted = match connections.is_full() {
            true => Ok(None),
            false => listener.accept(),
        };
        match accepted {
            Ok(Some(stream)) => match start(stream, shared) {
                Ok((standing, thread)) => connections.add(standing, thread, ()),
                Err(error) => tracing::warn!("a simulator is turned away: {error}"),
            },
            Ok(None) => std::thread::sleep(LISTEN),
            Err(error) => {
                tracing::debug!("a simulator did not get through: {error}");
                std::thread::sleep(LISTEN);
            }
        }
    }
    connections.end(|()| {});
}

/// Starts the thread of a connection.
fn start(
    stream: Stream,
    shared: &Arc<SharedSimulation>,
) -> io::Result<(Arc<Standing>, JoinHandle<()>)> {
    let standing = Arc::new(Standing::default());
    let (its_standing, its_shared) = (Arc::clone(&standing), Arc::clone(shared));
    let thread = Builder::new().name("terrella-basilisk".to_owned());
    let thread = thread.spawn(move || serve(stream, &its_shared, &its_standing))?;
    Ok((standing, thread))
}

fn serve(stream: Stream, shared: &SharedSimulation, standing: &Standing) {
    let is_leaving = || shared.is_stopped() || standing.is_dismissed();
    let connection = stream.set_timeouts(LOOK, WRITE).map_err(ZmtpError::from);
    let connection = connection.and_then(|()| {
        Connection::greet(
            stream,
            "REP",
            &["REQ", "DEALER"],
            MAX_MESSAGE_BYTES,
            &is_leaving,
        )
    });
    let mut connection = match connection {
        Ok(connection) => connection,
        Err(error) => {
            tracing::debug!("a connection is given up: {error}");
            return;
        }
    };
    let mut attended = Attended {
        session: shared.session(),
        shared,
        standing,
    };
    let leaves_since = Cell::new(None);
    let must_go = || {
        is_leaving() && {
            let since = leaves_since.get().unwrap_or_else(Instant::now);
            leaves_since.set(Some(since));
            since.elapsed() >= GRACE
        }
    };
    loop {
        let request = match connection.receive(&must_go) {
            Ok(request) => request,
            Err(ZmtpError::Closed | ZmtpError::Stopped) => break,
            Err(error) => {
                shared.tell(&[format!("a simulator is disconnected: {error}")]);
                break;
            }
        };
        let _waiting = standing.wait();
        match attended.answer(&mut connection, request, &is_leaving) {
            Ok(Sent::More) => {}
            Ok(Sent::Last) | Err(_) => break,
        }
    }
    connection.stream().end_writing();
}

/// Whether a reply is the last of its connection.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sent {
    More,
    Last,
}

/// A session that is left however its thread ends.
struct Attended<'s> {
    session: Session,
    shared: &'s SharedSimulation,
    standing: &'s Standing,
}

impl Drop for Attended<'_> {
    fn drop(&mut self) {
        self.shared.leave(&mut self.session);
    }
}

/// A request, with Basilisk's names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Request<'r> {
    Ping,
    Update(&'r [u8]),
    Input,
    /// The image of a camera; `None` if the camera's number is invalid.
    Image(Option<i64>),
    Unknown,
}

impl<'r> Request<'r> {
    fn of(frames: &'r [Vec<u8>]) -> Self {
        let words = frames.first().map_or(&[][..], Vec::as_slice);
        match (words, frames) {
            (b"PING", _) => Self::Ping,
            (b"SIM_UPDATE", [_, .., message]) => Self::Update(message),
            (b"REQUEST_INPUT", _) => Self::Input,
            _ => match words.strip_prefix(b"REQUEST_IMAGE_") {
                Some(number) => {
                    let number = std::str::from_utf8(number).ok();
                    Self::Image(number.and_then(|number| number.parse().ok()))
                }
                None => Self::Unknown,
            },
        }
    }

    /// Whether only a simulator sends this; for an update this is known after it is parsed.
    fn is_known(self) -> bool {
        matches!(self, Self::Ping | Self::Input | Self::Image(Some(_)))
    }

    /// An empty reply that lets the simulator continue.
    fn stand_in(self, frame_number: i64) -> Vec<Vec<u8>> {
        match self {
            Self::Ping => vec![b"PONG".to_vec()],
            Self::Update(_) => vec![b"OK".to_vec()],
            Self::Input => input(frame_number, ""),
            Self::Image(_) => image(Vec::new()),
            Self::Unknown => vec![b"ERROR".to_vec()],
        }
    }
}

/// User input since the last request.
fn input(frame_number: i64, keys: &str) -> Vec<Vec<u8>> {
    vec![b"VIZARD_INPUT".to_vec(), viewer_input(frame_number, keys)]
}

/// Reply with an image: its length, and its file. No image has length 0.
fn image(file: Vec<u8>) -> Vec<Vec<u8>> {
    let (len, file) = match i32::try_from(file.len()) {
        Ok(len) => (len, file),
        Err(_) => (0, Vec::new()),
    };
    vec![len.to_be_bytes().to_vec(), file]
}

/// A request whose stand-in is sent if there was no reply, even after a panic.
struct Pending<'c> {
    connection: &'c mut Connection<Stream>,
    /// Routing frames back to the requester.
    envelope: &'c [Vec<u8>],
    stand_in: Vec<Vec<u8>>,
    is_answered: bool,
}

impl Pending<'_> {
    fn send(&mut self, answer: &[Vec<u8>]) -> Result<(), ZmtpError> {
        self.is_answered = true;
        let frames: Vec<_> = self.envelope.iter().chain(answer).collect();
        let frames: Vec<_> = frames.into_iter().map(Vec::as_slice).collect();
        self.connection.send(&frames)
    }
}

impl Drop for Pending<'_> {
    fn drop(&mut self) {
        if !self.is_answered {
            let stand_in = std::mem::take(&mut self.stand_in);
            // A connection that is gone waits for nothing.
            let _ = self.send(&stand_in);
        }
    }
}

impl Attended<'_> {
    /// Answers a request, whatever it is.
    fn answer(
        &mut self,
        connection: &mut Connection<Stream>,
        frames: Vec<Vec<u8>>,
        is_leaving: &dyn Fn() -> bool,
    ) -> Result<Sent, ZmtpError> {
        let begun = Instant::now();
        // The routing frames are before the empty frame.
        let empty = frames.iter().position(Vec::is_empty);
        let (envelope, words) = match empty {
            Some(empty) => frames.split_at(empty + 1),
            None => frames.split_at(0),
        };
        let request = Request::of(words);
        let frame_number = self.session.frame_number;
        let mut pending = Pending {
            connection,
            envelope,
            stand_in: request.stand_in(frame_number),
            is_answered: false,
        };
        if request.is_known() {
            self.counts();
        }
        let answer = match request {
            Request::Ping | Request::Unknown => request.stand_in(frame_number),
            Request::Input => input(frame_number, &self.shared.take_keys(&self.session)),
            Request::Update(message) => {
                if let Ok(snapshot) = self.shared.take(&mut self.session, message) {
                    self.counts();
                    self.shared.ask(&snapshot, None);
                }
                // A step that cannot be drawn is no reason to end a simulation; the user has a message.
                request.stand_in(frame_number)
            }
            Request::Image(id) => image(self.picture(id)),
        };
        // The simulator sees the end together with its reply, before it can send a request that no one would read.
        let sent = match is_leaving() {
            true => {
                pending.connection.stream().hold();
                Sent::Last
            }
            false => Sent::More,
        };
        let result = pending.send(&answer);
        if sent == Sent::Last {
            pending.connection.stream().end_writing();
        }
        drop(pending);
        match (request, answer.last()) {
            (Request::Update(_), _) => self.shared.count(false, false, begun.elapsed()),
            (Request::Image(_), Some(file)) => {
                self.shared.count(true, !file.is_empty(), begun.elapsed());
            }
            _ => {}
        }
        result.map(|()| sent)
    }

    /// Something good has come: this is a simulator.
    fn counts(&mut self) {
        self.standing.took_good();
        self.shared.enter(&mut self.session);
    }

    /// The image of a camera at the time of the session's last step; empty if there is none.
    fn picture(&self, id: Option<i64>) -> Vec<u8> {
        let Some(snapshot) = &self.session.snapshot else {
            return Vec::new();
        };
        let mut cameras = snapshot.cameras.iter();
        let camera = cameras.find(|camera| Some(camera.id) == id);
        match camera {
            Some(camera) => self.shared.ask(snapshot, Some(camera.clone())),
            None => {
                let note = "a picture is asked for of a camera that the simulation does not have";
                self.shared.tell(&[note.to_owned()]);
                Vec::new()
            }
        }
    }
}
