//! Simulations that publish their steps and do not wait.

use super::endpoint::{Endpoint, Stream};
use super::message::MAX_MESSAGE_BYTES;
use super::server::{LOOK, WRITE};
use super::shared::{Session, SharedSimulation};
use super::zmtp::{Connection, ZmtpError};
use std::time::Duration;

/// How long a connection may take to come about.
const CONNECT: Duration = Duration::from_secs(2);
/// How long to wait before the next try.
const RETRY: Duration = Duration::from_millis(100);

/// Subscribes to a publisher until all ends, again whenever it is gone.
pub fn follow(endpoint: &Endpoint, shared: &SharedSimulation) {
    while !shared.is_stopped() {
        match Stream::connect(endpoint, CONNECT) {
            Ok(stream) => {
                let mut session = shared.session();
                let ended = read(stream, shared, &mut session);
                shared.leave(&mut session);
                match ended {
                    ZmtpError::Closed | ZmtpError::Stopped => {}
                    error => shared.tell(&[format!("{endpoint} is disconnected: {error}")]),
                }
            }
            Err(error) => tracing::debug!("{endpoint}: {error}"),
        }
        std::thread::sleep(RETRY);
    }
}

fn read(stream: Stream, shared: &SharedSimulation, session: &mut Session) -> ZmtpError {
    let is_stopped = || shared.is_stopped();
    if let Err(error) = stream.set_timeouts(LOOK, WRITE) {
        return error.into();
    }
    let peers = ["PUB", "XPUB"];
    let connection = Connection::greet(stream, "SUB", &peers, MAX_MESSAGE_BYTES, &is_stopped);
    let mut connection = match connection {
        Ok(connection) => connection,
        Err(error) => return error,
    };
    // 1 subscribes, to all that begins with nothing.
    if let Err(error) = connection.send(&[b"\x01"]) {
        return error;
    }
    loop {
        match connection.receive(&is_stopped) {
            Ok(frames) => {
                if let [words, .., message] = frames.as_slice()
                    && words == b"SIM_UPDATE"
                {
                    // A bad one is counted and reported; the next may be good.
                    let _ = shared.take(session, message);
                }
            }
            Err(error) => return error,
        }
    }
}
