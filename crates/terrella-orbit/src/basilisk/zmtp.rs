//! ZMTP 3.1 with the NULL mechanism: the part of ZeroMQ's wire protocol that a replying and a subscribing peer need.
//!
//! Written by hand over a blocking stream. The crates for ZeroMQ bring an asynchronous runtime or a C++ library. Neither can limit the length of a
//! frame or the time that a peer takes for it, or close a connection after a reply and not before.
//!
//! ```text
//! greeting   FF 00×8 7F | 03 01 | "NULL" 00×16 | as-server 00 | 00×31                 64 bytes, both ways
//! frame      flags (1 more, 2 long, 4 command) | length, 1 or 8 bytes big endian | bytes
//! READY      a command: 05 "READY", then properties: length name, 4-byte length value
//! ```
//! (ZeroMQ RFC 37.)

use std::io::{self, ErrorKind, Read, Write};
use std::time::{Duration, Instant};

/// Most bytes of a command.
const MAX_COMMAND_BYTES: usize = 4096;
/// Most frames of a message.
const MAX_FRAMES: usize = 16;
/// How long a peer may take over a message once it has begun.
const MESSAGE_TIME: Duration = Duration::from_secs(20);
/// Timeout for a peer's greeting.
const HANDSHAKE_TIME: Duration = Duration::from_secs(5);
/// Bytes of one reading.
const CHUNK: usize = 16 * 1024;

const MORE: u8 = 1;
const LONG: u8 = 2;
const COMMAND: u8 = 4;

/// Why a connection is given up.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum ZmtpError {
    /// The peer has gone.
    #[error("the connection is closed")]
    Closed,
    /// The caller's `is_stopped` returned true.
    #[error("this side ends")]
    Stopped,
    /// The system.
    #[error("the connection failed: {0}")]
    Io(#[from] io::Error),
    /// The peer uses another protocol.
    #[error("the peer does not speak ZMTP 3 with the NULL mechanism: {what}")]
    Foreign {
        /// The difference.
        what: &'static str,
    },
    /// The peer breaks the limits.
    #[error("the peer sends {what}")]
    Limit { what: &'static str },
}

/// A connection whose both sides have said what they are.
pub struct Connection<S> {
    stream: S,
    /// Bytes that have come and are not used.
    waiting: Vec<u8>,
    used: usize,
    max_bytes: usize,
}

impl<S: Read + Write> Connection<S> {
    /// Greets as a socket of one type (`REP`, `SUB`) and accepts peers of some types. Reading from the stream must time out within a fraction of a
    /// second; then `is_stopped` is called. Messages have at most `max_bytes`.
    pub fn greet(
        stream: S,
        kind: &str,
        peers: &[&str],
        max_bytes: usize,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<Self, ZmtpError> {
        let mut connection = Self {
            stream,
            waiting: Vec::new(),
            used: 0,
            max_bytes,
        };
        let deadline = Instant::now() + HANDSHAKE_TIME;
        let mut greeting = [0; 64];
        greeting[0] = 0xff;
        greeting[9] = 0x7f;
        greeting[10] = 3;
        greeting[11] = 1;
        greeting[12..16].copy_from_slice(b"NULL");
        connection.write(&greeting)?;
        let foreign = |what| Err(ZmtpError::Foreign { what });
        let its: [u8; 64] = connection
            .take(64, deadline, is_stopped)?
            .try_into()
            .map_err(|_| ZmtpError::Closed)?;
        if its[0] != 0xff || its[9] & 1 != 1 || its[10] < 3 {
            return foreign("its greeting");
        }
        if its[12..32] != greeting[12..32] {
            return foreign("its mechanism");
        }
        let mut ready = b"\x05READY".to_vec();
        for (name, value) in [("Socket-Type", kind), ("Identity", "")] {
            ready.push(name.len() as u8);
            ready.extend(name.as_bytes());
            ready.extend((value.len() as u32).to_be_bytes());
            ready.extend(value.as_bytes());
        }
        connection.write(&frame(COMMAND, &ready))?;
        let (flags, body) = connection.frame(MAX_COMMAND_BYTES, deadline, is_stopped)?;
        match body.strip_prefix(b"\x05READY") {
            Some(properties) if flags & COMMAND != 0 => match property(properties, "Socket-Type") {
                Some(its) if peers.iter().any(|peer| peer.as_bytes() == its) => Ok(connection),
                _ => foreign("its kind of socket"),
            },
            _ => foreign("its first command"),
        }
    }

    /// The stream under it.
    pub fn stream(&self) -> &S {
        &self.stream
    }

    /// Sends a message.
    pub fn send(&mut self, frames: &[&[u8]]) -> Result<(), ZmtpError> {
        let mut bytes = Vec::with_capacity(frames.iter().map(|one| one.len() + 9).sum());
        for (index, body) in frames.iter().enumerate() {
            let more = if index + 1 < frames.len() { MORE } else { 0 };
            bytes.extend(frame(more, body));
        }
        self.write(&bytes)
    }

    fn write(&mut self, bytes: &[u8]) -> Result<(), ZmtpError> {
        self.stream.write_all(bytes)?;
        Ok(self.stream.flush()?)
    }

    /// Waits for the next message, and replies to heartbeats.
    ///
    /// # Errors
    /// [`ZmtpError::Stopped`] if `is_stopped` returns true before a message has begun.
    pub fn receive(&mut self, is_stopped: &dyn Fn() -> bool) -> Result<Vec<Vec<u8>>, ZmtpError> {
        loop {
            self.wait(is_stopped)?;
            // A message that has begun is read to its end: its sender waits for a reply.
            let deadline = Instant::now() + MESSAGE_TIME;
            let go_on = || false;
            let mut frames: Vec<Vec<u8>> = Vec::new();
            let mut left = self.max_bytes;
            loop {
                let (flags, body) = self.frame(left, deadline, &go_on)?;
                if flags & COMMAND != 0 {
                    self.answer_command(&body)?;
                    match frames.is_empty() {
                        true => break,
                        false => continue,
                    }
                }
                left -= body.len();
                frames.push(body);
                if flags & MORE == 0 {
                    return Ok(frames);
                }
                if frames.len() == MAX_FRAMES {
                    let what = "a message of too many frames";
                    return Err(ZmtpError::Limit { what });
                }
            }
        }
    }

    fn answer_command(&mut self, body: &[u8]) -> Result<(), ZmtpError> {
        match body.strip_prefix(b"\x04PING") {
            // Two bytes of time to live, then a context that comes back.
            Some(rest) => {
                let context = rest.get(2..).unwrap_or_default();
                let pong = [b"\x04PONG".as_slice(), context].concat();
                self.write(&frame(COMMAND, &pong))
            }
            // Subscriptions and similar commands are ignored.
            None => Ok(()),
        }
    }

    fn frame(
        &mut self,
        most: usize,
        deadline: Instant,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<(u8, Vec<u8>), ZmtpError> {
        let flags = self.byte(deadline, is_stopped)?;
        if flags & !(MORE | LONG | COMMAND) != 0 || flags & COMMAND != 0 && flags & MORE != 0 {
            let what = "flags of a frame that there are not";
            return Err(ZmtpError::Limit { what });
        }
        let len = match flags & LONG {
            0 => u64::from(self.byte(deadline, is_stopped)?),
            _ => {
                let bytes = self.take(8, deadline, is_stopped)?;
                let bytes: [u8; 8] = bytes.try_into().map_err(|_| ZmtpError::Closed)?;
                u64::from_be_bytes(bytes)
            }
        };
        let most = match flags & COMMAND {
            0 => most,
            _ => most.min(MAX_COMMAND_BYTES),
        };
        match usize::try_from(len) {
            Ok(len) if len <= most => Ok((flags, self.take(len, deadline, is_stopped)?)),
            _ => {
                let what = "a message that is too long";
                Err(ZmtpError::Limit { what })
            }
        }
    }

    fn byte(&mut self, deadline: Instant, is_stopped: &dyn Fn() -> bool) -> Result<u8, ZmtpError> {
        let byte = self.take(1, deadline, is_stopped)?;
        byte.first().copied().ok_or(ZmtpError::Closed)
    }

    /// Reads the next bytes. Memory grows with the bytes received, not with the announced length.
    fn take(
        &mut self,
        len: usize,
        deadline: Instant,
        is_stopped: &dyn Fn() -> bool,
    ) -> Result<Vec<u8>, ZmtpError> {
        while self.waiting.len() - self.used < len {
            if self.read()? == 0 && is_stopped() {
                return Err(ZmtpError::Stopped);
            }
            // Also of a peer that sends a byte now and then.
            if Instant::now() >= deadline {
                let what = "a message that takes too long";
                return Err(ZmtpError::Limit { what });
            }
        }
        let end = self.used + len;
        let taken = self.waiting[self.used..end].to_vec();
        self.used = end;
        if self.used == self.waiting.len() {
            self.waiting.clear();
            // One long message does not hold its room forever.
            self.waiting.shrink_to(4 * CHUNK);
            self.used = 0;
        }
        Ok(taken)
    }

    /// Waits until there is a byte.
    fn wait(&mut self, is_stopped: &dyn Fn() -> bool) -> Result<(), ZmtpError> {
        while self.used == self.waiting.len() {
            if self.read()? == 0 && is_stopped() {
                return Err(ZmtpError::Stopped);
            }
        }
        Ok(())
    }

    /// Reads once; 0 where nothing came in the stream's own time-out.
    fn read(&mut self) -> Result<usize, ZmtpError> {
        let mut chunk = [0; CHUNK];
        match self.stream.read(&mut chunk) {
            Ok(0) => Err(ZmtpError::Closed),
            Ok(count) => {
                if self.used > 0 && self.waiting.len() + count > self.waiting.capacity() {
                    self.waiting.drain(..self.used);
                    self.used = 0;
                }
                self.waiting.extend(&chunk[..count]);
                Ok(count)
            }
            Err(error) => match error.kind() {
                ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted => Ok(0),
                ErrorKind::ConnectionReset | ErrorKind::ConnectionAborted => Err(ZmtpError::Closed),
                _ => Err(error.into()),
            },
        }
    }
}

/// A frame as bytes.
fn frame(flags: u8, body: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(body.len() + 9);
    match u8::try_from(body.len()) {
        Ok(len) => bytes.extend([flags, len]),
        Err(_) => {
            bytes.push(flags | LONG);
            bytes.extend((body.len() as u64).to_be_bytes());
        }
    }
    bytes.extend(body);
    bytes
}

/// The value of a property of a READY command, its name's letter case aside.
fn property<'b>(mut bytes: &'b [u8], wanted: &str) -> Option<&'b [u8]> {
    while let Some((&name_len, rest)) = bytes.split_first() {
        let (name, rest) = rest.split_at_checked(usize::from(name_len))?;
        let (len, rest) = rest.split_first_chunk::<4>()?;
        let (value, rest) = rest.split_at_checked(u32::from_be_bytes(*len) as usize)?;
        if name.eq_ignore_ascii_case(wanted.as_bytes()) {
            return Some(value);
        }
        bytes = rest;
    }
    None
}

#[cfg(test)]
#[path = "zmtp_tests.rs"]
mod tests;
