//! The threads that read standard input, TCP and UDP. They are the standard library's: each blocks on its socket for as long as
//! nothing comes, which a pool of workers is not for.

use super::lockstep::MAX_WAITING;
use super::options::{LiveError, Pacing};
use super::packet::MAX_PACKET_BYTES;
use super::shared::{RateLimiter, Shared};
use super::split::Splitter;
use std::io::{ErrorKind, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream, UdpSocket};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// How many simulators may be connected; the one silent longest makes place for a new one.
pub const MAX_CONNECTIONS: usize = 4;
/// How many closed connections may still be in their last step; more than may wait for a frame.
const MAX_ENDING: usize = 2 * MAX_WAITING;
/// Bytes of one reading.
const CHUNK: usize = 8192;
/// How often a thread that waits for bytes looks whether the feed ends.
pub const LOOK: Duration = Duration::from_millis(100);
/// How often the listening thread looks for a simulator.
const LISTEN: Duration = Duration::from_millis(10);
/// How long a simulator may leave an answer unread.
const WRITE: Duration = Duration::from_secs(1);

/// What serves one connection until it ends.
pub type Serve = fn(TcpStream, &Shared, &AtomicU64);

pub fn spawn(
    name: &str,
    body: impl FnOnce() + Send + 'static,
) -> Result<JoinHandle<()>, LiveError> {
    let thread = Builder::new().name(format!("terrella-live-{name}"));
    thread
        .spawn(body)
        .map_err(|source| LiveError::Thread { source })
}

/// Whether nothing is wrong and nothing was there.
pub fn is_nothing(kind: ErrorKind) -> bool {
    matches!(
        kind,
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}

/// Reads until the end, an error or the feed's own end. Any stream: a pipe, standard input, a connection.
pub fn stream(read: &mut dyn Read, write: &mut dyn Write, shared: &Shared, heard: impl Fn()) {
    let mut splitter = Splitter::default();
    let mut allowance = RateLimiter::new(shared.options.max_packets_per_s);
    let mut chunk = [0; CHUNK];
    let mut is_first = true;
    while !shared.is_stopped() {
        let bytes = match read.read(&mut chunk) {
            Ok(0) => {
                while let Some(received) = splitter.finish() {
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
            shared.lock().counters.refused += 1;
            return;
        }
        heard();
        splitter.push(bytes);
        while let Some(received) = splitter.next() {
            if shared.is_stopped() {
                return;
            }
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
pub fn stdin(shared: &Arc<Shared>) -> Result<(), LiveError> {
    let shared = Arc::clone(shared);
    spawn("stdin", move || {
        stream(
            &mut std::io::stdin(),
            &mut std::io::stdout(),
            &shared,
            || {},
        );
        shared.end();
    })
    .map(drop)
}

/// Serves one TCP connection until it ends.
pub fn tcp(connection: TcpStream, shared: &Shared, heard: &AtomicU64) {
    let begun = Instant::now();
    let first = heard.load(Ordering::Relaxed);
    let Ok(mut write) = connection.try_clone() else {
        return;
    };
    let mut read = connection;
    stream(&mut read, &mut write, shared, || {
        heard.store(
            first + begun.elapsed().as_millis() as u64,
            Ordering::Relaxed,
        );
    });
}

/// A connection and the thread that serves it.
struct Link {
    connection: TcpStream,
    /// When it last said something, milliseconds since the feed was opened.
    heard: Arc<AtomicU64>,
    thread: JoinHandle<()>,
}

impl Link {
    fn close(&self) {
        // It may be closed by the other side.
        let _ = self.connection.shutdown(Shutdown::Both);
    }

    fn end(self) {
        self.close();
        // A thread that panicked has said so itself.
        let _ = self.thread.join();
    }
}

/// Listens; each connection gets a thread. Gives the address that was bound.
pub fn listen(
    address: SocketAddr,
    serve: Serve,
    shared: &Arc<Shared>,
) -> Result<(SocketAddr, JoinHandle<()>), LiveError> {
    let bind = |source| LiveError::Bind { address, source };
    let listener = TcpListener::bind(address).map_err(bind)?;
    listener.set_nonblocking(true).map_err(bind)?;
    let bound = listener.local_addr().map_err(bind)?;
    let shared = Arc::clone(shared);
    let thread = spawn("listen", move || accept(&listener, serve, &shared))?;
    Ok((bound, thread))
}

fn accept(listener: &TcpListener, serve: Serve, shared: &Arc<Shared>) {
    let begun = Instant::now();
    let mut links: Vec<Link> = Vec::with_capacity(MAX_CONNECTIONS);
    // Closed, and perhaps waiting for a frame still.
    let mut ending: Vec<Link> = Vec::new();
    while !shared.is_stopped() {
        let ended = links.extract_if(.., |link| link.thread.is_finished());
        let ended = ended.chain(ending.extract_if(.., |link| link.thread.is_finished()));
        ended.for_each(Link::end);
        if ending.len() >= MAX_ENDING {
            std::thread::sleep(LISTEN);
            continue;
        }
        let Ok((connection, _)) = listener.accept() else {
            std::thread::sleep(LISTEN);
            continue;
        };
        if links.len() >= MAX_CONNECTIONS {
            let silent = links.iter().enumerate();
            let silent = silent.min_by_key(|(_, link)| link.heard.load(Ordering::Relaxed));
            if let Some(at) = silent.map(|(at, _)| at) {
                shared.lock().counters.refused += 1;
                let link = links.swap_remove(at);
                link.close();
                ending.push(link);
            }
        }
        match start(connection, serve, shared, begun) {
            Some(link) => {
                shared.lock().counters.connections += 1;
                links.push(link);
            }
            None => shared.lock().counters.refused += 1,
        }
    }
    links.into_iter().chain(ending).for_each(Link::end);
}

fn start(
    connection: TcpStream,
    serve: Serve,
    shared: &Arc<Shared>,
    begun: Instant,
) -> Option<Link> {
    connection.set_nonblocking(false).ok()?;
    connection.set_read_timeout(Some(LOOK)).ok()?;
    connection.set_write_timeout(Some(WRITE)).ok()?;
    // An answer goes out at once.
    connection.set_nodelay(true).ok()?;
    let heard = Arc::new(AtomicU64::new(begun.elapsed().as_millis() as u64));
    let own = connection.try_clone().ok()?;
    let (shared, its_heard) = (Arc::clone(shared), Arc::clone(&heard));
    let thread = spawn("connection", move || serve(own, &shared, &its_heard)).ok()?;
    Some(Link {
        connection,
        heard,
        thread,
    })
}

/// Binds a UDP port. Gives its address.
pub fn udp(
    address: SocketAddr,
    shared: &Arc<Shared>,
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

fn datagrams(socket: &UdpSocket, shared: &Shared) {
    let mut allowance = RateLimiter::new(shared.options.max_packets_per_s);
    // One byte more than allowed, so that what is too long is seen to be.
    let mut datagram = [0; MAX_PACKET_BYTES + 1];
    while !shared.is_stopped() {
        let (length, from) = match socket.recv_from(&mut datagram) {
            Ok(received) => received,
            Err(error) => {
                if !is_nothing(error.kind()) {
                    // Such as "port unreachable" for an answer that nobody took.
                    std::thread::sleep(Duration::from_millis(1));
                }
                continue;
            }
        };
        let bytes = datagram.get(..length).unwrap_or_default();
        message(bytes, shared, &mut allowance, |reply| {
            // A simulator that is gone needs no answer.
            let _ = socket.send_to(&reply, from);
            true
        });
    }
}

/// Takes a datagram or a WebSocket message: it holds whole packets. `false` where an answer could not be sent.
pub fn message(
    bytes: &[u8],
    shared: &Shared,
    allowance: &mut RateLimiter,
    mut send: impl FnMut(Vec<u8>) -> bool,
) -> bool {
    let mut splitter = Splitter::default();
    splitter.push(bytes);
    while splitter.has_more() {
        if shared.is_stopped() {
            return false;
        }
        if !allowance.has_one(Instant::now()) {
            shared.lock().counters.over_rate += 1;
            std::thread::sleep(allowance.pause());
            return true;
        }
        if let Some(received) = splitter.finish()
            && !shared.take(received, &mut send)
        {
            return false;
        }
    }
    true
}
