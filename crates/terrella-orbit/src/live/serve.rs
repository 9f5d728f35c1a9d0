//! The threads that read standard input, TCP and UDP. They are the standard library's: each blocks on its socket for as long as
//! nothing comes, which a pool of workers is not for.

use super::super::connections::{Connections, GRACE, Standing};
use super::super::pushed::MAX_PACKET_BYTES;
use super::options::{LiveError, Pacing};
use super::shared::{RateLimiter, SharedFeed};
use super::split::{Received, Splitter};
use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Bytes of one reading.
const CHUNK: usize = 8192;
/// How often a thread that waits for bytes looks whether the feed ends.
pub const LOOK: Duration = Duration::from_millis(100);
/// How often the listening thread looks for a simulator.
const LISTEN: Duration = Duration::from_millis(10);
/// Time after which an unread reply is an error.
const WRITE: Duration = Duration::from_secs(1);

/// Serves one connection until it ends.
pub type Serve = fn(TcpStream, &SharedFeed, &Standing);

pub fn spawn(
    name: &str,
    body: impl FnOnce() + Send + 'static,
) -> Result<JoinHandle<()>, LiveError> {
    let thread = Builder::new().name(format!("terrella-live-{name}"));
    thread
        .spawn(body)
        .map_err(|source| LiveError::Thread { source })
}

/// Whether the error only means that no data was available.
pub fn is_nothing(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

/// Reads until the end, an error or the feed's own end. Any stream: a pipe, standard input, a connection.
pub fn stream(
    read: &mut dyn Read,
    write: &mut dyn Write,
    shared: &SharedFeed,
    standing: &Standing,
) {
    let mut splitter = Splitter::default();
    let mut allowance = RateLimiter::new(shared.options.max_packets_per_s);
    let mut chunk = [0; CHUNK];
    let mut is_first = true;
    let mut departure = Departure::default();
    while !shared.is_stopped() && !departure.is_due(standing, splitter.waiting() > 0) {
        let bytes = match read.read(&mut chunk) {
            Ok(0) => {
                while let Some(received) = splitter.finish() {
                    let _waiting = standing.wait();
                    note(&received, standing);
                    if !shared.take(received, |bytes| answer(&bytes, write)) {
                        return;
                    }
                }
                return;
            }
            Ok(length) => chunk.get(..length).unwrap_or_default(),
            Err(error) if is_nothing(error.kind()) => continue,
            Err(_) => return,
        };
        if std::mem::take(&mut is_first) && is_http(bytes) {
            // A web page that posts to every port it can think of.
            shared.lock().counters.rejected += 1;
            return;
        }
        splitter.push(bytes);
        while let Some(received) = splitter.next() {
            if shared.is_stopped() {
                return;
            }
            let _waiting = standing.wait();
            let is_waited_for = shared.options.pacing == Pacing::Lockstep;
            while is_waited_for && !shared.is_stopped() && !allowance.pause().is_zero() {
                // Nothing may go missing: the sender waits instead.
                std::thread::sleep(allowance.pause());
                allowance.refill(Instant::now());
            }
            if !allowance.has_one(Instant::now()) {
                shared.lock().counters.over_rate += 1;
                continue;
            }
            note(&received, standing);
            if !shared.take(received, |bytes| answer(&bytes, write)) {
                return;
            }
        }
        if !allowance.pause().is_zero() {
            // A flood: the sender is held back too.
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

/// When a dismissed connection leaves.
#[derive(Debug, Default)]
pub struct Departure {
    noticed: Option<Instant>,
}

impl Departure {
    /// Whether the connection must end now; with a partially read packet it stays a little longer, as its sender may wait for a reply.
    pub fn is_due(&mut self, standing: &Standing, has_begun: bool) -> bool {
        if !standing.is_dismissed() {
            return false;
        }
        let noticed = self.noticed.get_or_insert_with(Instant::now);
        !has_begun || noticed.elapsed() >= GRACE
    }
}

/// A connection counts from its first good packet on.
fn note(received: &Received, standing: &Standing) {
    if received.packet.is_ok() {
        standing.took_good();
    }
}

fn answer(bytes: &[u8], write: &mut dyn Write) -> bool {
    write.write_all(bytes).and_then(|()| write.flush()).is_ok()
}

fn is_http(bytes: &[u8]) -> bool {
    let methods: [&[u8]; 6] = [
        b"GET ",
        b"POST ",
        b"PUT ",
        b"HEAD ",
        b"OPTIONS ",
        b"DELETE ",
    ];
    methods.iter().any(|method| bytes.starts_with(method))
}

/// Standard input. The thread cannot be woken from it: it ends with the input, or with the next bytes after the feed's end.
pub fn stdin(shared: &Arc<SharedFeed>) -> Result<(), LiveError> {
    let shared = Arc::clone(shared);
    spawn("stdin", move || {
        stream(
            &mut std::io::stdin(),
            &mut std::io::stdout(),
            &shared,
            &Standing::default(),
        );
        shared.end();
    })
    .map(drop)
}

/// Serves one TCP connection until it ends.
pub fn tcp(connection: TcpStream, shared: &SharedFeed, standing: &Standing) {
    let Ok(mut write) = connection.try_clone() else {
        return;
    };
    let mut read = connection;
    stream(&mut read, &mut write, shared, standing);
}

/// Listens; each connection gets a thread. Gives the address that was bound.
pub fn listen(
    address: SocketAddr,
    serve: Serve,
    shared: &Arc<SharedFeed>,
) -> Result<(SocketAddr, JoinHandle<()>), LiveError> {
    let bind = |source| LiveError::Bind { address, source };
    let listener = TcpListener::bind(address).map_err(bind)?;
    listener.set_nonblocking(true).map_err(bind)?;
    let bound = listener.local_addr().map_err(bind)?;
    let shared = Arc::clone(shared);
    let thread = spawn("listen", move || accept(&listener, serve, &shared))?;
    Ok((bound, thread))
}

fn accept(listener: &TcpListener, serve: Serve, shared: &Arc<SharedFeed>) {
    let mut connections = Connections::default();
    while !shared.is_stopped() {
        let dismissed = connections.tidy();
        if dismissed > 0 {
            shared.lock().counters.rejected += dismissed as u64;
        }
        if connections.is_full() {
            std::thread::sleep(LISTEN);
            continue;
        }
        let Ok((connection, _)) = listener.accept() else {
            std::thread::sleep(LISTEN);
            continue;
        };
        let standing = Arc::new(Standing::default());
        match start(connection, serve, shared, &standing) {
            Some((thread, closer)) => {
                shared.lock().counters.connections += 1;
                connections.add(standing, thread, closer);
            }
            None => shared.lock().counters.rejected += 1,
        }
    }
    // It may be closed by the other side.
    connections.end(|connection| drop(connection.shutdown(Shutdown::Both)));
}

/// Starts the thread of a connection. Returns it, and a handle that closes the connection.
fn start(
    connection: TcpStream,
    serve: Serve,
    shared: &Arc<SharedFeed>,
    standing: &Arc<Standing>,
) -> Option<(JoinHandle<()>, TcpStream)> {
    connection.set_nonblocking(false).ok()?;
    connection.set_read_timeout(Some(LOOK)).ok()?;
    connection.set_write_timeout(Some(WRITE)).ok()?;
    // A reply is sent without delay.
    connection.set_nodelay(true).ok()?;
    let own = connection.try_clone().ok()?;
    let (shared, standing) = (Arc::clone(shared), Arc::clone(standing));
    let thread = spawn("connection", move || serve(own, &shared, &standing)).ok()?;
    Some((thread, connection))
}

/// Binds a UDP port. Gives its address.
pub fn udp(
    address: SocketAddr,
    shared: &Arc<SharedFeed>,
) -> Result<(SocketAddr, JoinHandle<()>), LiveError> {
    let bind = |source| LiveError::Bind { address, source };
    let socket = UdpSocket::bind(address).map_err(bind)?;
    socket.set_read_timeout(Some(LOOK)).map_err(bind)?;
    socket.set_write_timeout(Some(WRITE)).map_err(bind)?;
    let bound = socket.local_addr().map_err(bind)?;
    let shared = Arc::clone(shared);
    let thread = spawn("udp", move || datagrams(&socket, &shared))?;
    Ok((bound, thread))
}

fn datagrams(socket: &UdpSocket, shared: &SharedFeed) {
    let mut allowance = RateLimiter::new(shared.options.max_packets_per_s);
    let standing = Standing::default();
    // One byte more than allowed, so that what is too long is seen to be.
    let mut datagram = [0; MAX_PACKET_BYTES + 1];
    while !shared.is_stopped() {
        let (length, from) = match socket.recv_from(&mut datagram) {
            Ok(received) => received,
            Err(error) => {
                if !is_nothing(error.kind()) {
                    // For example "port unreachable" for a reply that no one received.
                    std::thread::sleep(Duration::from_millis(1));
                }
                continue;
            }
        };
        let bytes = datagram.get(..length).unwrap_or_default();
        message(bytes, shared, &standing, &mut allowance, |reply| {
            // A simulator that has disconnected needs no reply.
            let _ = socket.send_to(&reply, from);
            true
        });
    }
}

/// Processes a datagram or a WebSocket message: it holds whole packets. Returns `false` if a reply could not be sent.
pub fn message(
    bytes: &[u8],
    shared: &SharedFeed,
    standing: &Standing,
    allowance: &mut RateLimiter,
    mut send: impl FnMut(Vec<u8>) -> bool,
) -> bool {
    let mut splitter = Splitter::default();
    splitter.push(bytes);
    let _waiting = standing.wait();
    while splitter.has_more() {
        if shared.is_stopped() {
            return false;
        }
        if !allowance.has_one(Instant::now()) {
            shared.lock().counters.over_rate += 1;
            std::thread::sleep(allowance.pause());
            return true;
        }
        let Some(received) = splitter.finish() else {
            continue;
        };
        note(&received, standing);
        if !shared.take(received, &mut send) {
            return false;
        }
    }
    true
}
