//! WebSocket connections (RFC 6455).

use super::super::connections::Standing;
use super::super::pushed::MAX_PACKET_BYTES;
use super::serve::{Departure, is_nothing, message};
use super::shared::{RateLimiter, SharedFeed};
use std::net::TcpStream;
use std::time::{Duration, Instant};
use tungstenite::handshake::HandshakeError;
use tungstenite::handshake::server::{ErrorResponse, Request, Response};
use tungstenite::http::StatusCode;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{Error, Message, WebSocket, accept_hdr_with_config};

/// How long a connection may take to become a WebSocket.
const HANDSHAKE: Duration = Duration::from_secs(5);

/// Serves one connection until it ends.
pub fn serve(connection: TcpStream, shared: &SharedFeed, standing: &Standing) {
    let Some(mut socket) = handshake(connection, shared, standing) else {
        // One that was dismissed meanwhile is counted already.
        if !standing.is_dismissed() {
            shared.lock().counters.rejected += 1;
        }
        return;
    };
    let mut allowance = RateLimiter::new(shared.options.max_packets_per_s);
    let mut departure = Departure::default();
    let mut has_begun = false;
    while !shared.is_stopped() && !departure.is_due(standing, has_begun) {
        let received = match socket.read() {
            Ok(received) => received,
            Err(Error::Io(error)) if is_nothing(error.kind()) => {
                // A part of a message may have come, which cannot be seen from here.
                has_begun = true;
                continue;
            }
            Err(Error::Capacity(_) | Error::Protocol(_) | Error::Utf8(_)) => {
                // Its stream cannot be read on: the simulator connects again.
                let mut inner = shared.lock();
                inner.counters.bad += 1;
                inner.last_fault = Some("a WebSocket frame that is too long or wrong".to_owned());
                return;
            }
            Err(_) => return,
        };
        has_begun = false;
        let is_text = received.is_text();
        let bytes = match received {
            Message::Text(text) => text.as_bytes().to_vec(),
            Message::Binary(bytes) => bytes.to_vec(),
            // Pings are answered by the next reading.
            _ => continue,
        };
        let send = |reply: Vec<u8>| {
            let reply = match (is_text, String::from_utf8(reply)) {
                (true, Ok(text)) => Message::text(text),
                (false, Ok(text)) => Message::binary(text.into_bytes()),
                (_, Err(error)) => Message::binary(error.into_bytes()),
            };
            socket.send(reply).is_ok()
        };
        if !message(&bytes, shared, standing, &mut allowance, send) {
            return;
        }
    }
    let _ = socket.close(None);
    let _ = socket.flush();
}

fn handshake(
    connection: TcpStream,
    shared: &SharedFeed,
    standing: &Standing,
) -> Option<WebSocket<TcpStream>> {
    let begun = Instant::now();
    let config = WebSocketConfig::default()
        .read_buffer_size(8192)
        .write_buffer_size(0)
        .max_write_buffer_size(64 << 10)
        .max_message_size(Some(MAX_PACKET_BYTES))
        .max_frame_size(Some(MAX_PACKET_BYTES));
    let allowed = &shared.options.allowed_origins;
    #[allow(clippy::result_large_err, reason = "the type is tungstenite's")]
    let check = |request: &Request, response: Response| -> Result<Response, ErrorResponse> {
        // Browsers send the origin of the page that connects; programs send none.
        let is_allowed = request.headers().get_all("Origin").iter().all(|origin| {
            let origin = origin.to_str().unwrap_or_default();
            allowed.iter().any(|allowed| allowed == origin)
        });
        if is_allowed {
            return Ok(response);
        }
        let mut rejection = ErrorResponse::new(Some("this page is not allowed here".to_owned()));
        *rejection.status_mut() = StatusCode::FORBIDDEN;
        Err(rejection)
    };
    let mut result = accept_hdr_with_config(connection, check, Some(config));
    loop {
        match result {
            Ok(socket) => return Some(socket),
            Err(HandshakeError::Interrupted(halfway))
                if begun.elapsed() < HANDSHAKE
                    && !shared.is_stopped()
                    && !standing.is_dismissed() =>
            {
                result = halfway.handshake();
            }
            Err(_) => return None,
        }
    }
}
