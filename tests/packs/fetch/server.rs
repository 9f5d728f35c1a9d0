//! A tile server on this machine, as good or as bad as a test needs it.

use rustls::pki_types::{CertificateDer, PrivateKeyDer, pem::PemObject};
use std::collections::HashMap;
use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

/// A reply.
#[derive(Clone, Debug)]
pub struct Answer {
    pub status: &'static str,
    pub headers: Vec<(&'static str, String)>,
    pub body: Vec<u8>,
    /// Length in the header; with `None` none, and the connection's end is the body's.
    pub length: Option<usize>,
    /// Pause after every byte.
    pub pause: Duration,
}

impl Answer {
    /// A picture of this type.
    pub fn picture(media: &str, body: Vec<u8>) -> Self {
        Self {
            status: "200 OK",
            headers: vec![("Content-Type", media.to_string())],
            length: Some(body.len()),
            body,
            pause: Duration::ZERO,
        }
    }

    /// A failure with a word of HTML.
    pub fn failure(status: &'static str) -> Self {
        Self {
            status,
            ..Self::picture("text/html", b"<html>no</html>".to_vec())
        }
    }

    pub fn with(mut self, name: &'static str, value: &str) -> Self {
        self.headers.push((name, value.to_string()));
        self
    }
}

/// Function that replies to a path's n-th request, from 0 on.
type Answering = dyn Fn(&str, usize) -> Answer + Send + Sync;

pub struct Server {
    pub port: u16,
    state: Arc<State>,
}

struct State {
    answer: Box<Answering>,
    is_over: AtomicBool,
    asked: Mutex<HashMap<String, usize>>,
    authorizations: Mutex<Vec<String>>,
    requests: Mutex<Vec<Instant>>,
    busy: AtomicUsize,
    most_busy: AtomicUsize,
}

impl Server {
    pub fn new(answer: impl Fn(&str, usize) -> Answer + Send + Sync + 'static) -> Self {
        Self::start(answer, serve)
    }

    /// With a certificate of an authority of the tests, for 127.0.0.1.
    pub fn with_tls(answer: impl Fn(&str, usize) -> Answer + Send + Sync + 'static) -> Self {
        let file = |name: &str| format!("{}/tests/data/tls/{name}", crate::REPOSITORY);
        let certificate = CertificateDer::from_pem_file(file("server.pem")).expect("a certificate");
        let key = PrivateKeyDer::from_pem_file(file("server.key")).expect("a key");
        let provider = Arc::new(rustls::crypto::ring::default_provider());
        let config = rustls::ServerConfig::builder_with_provider(provider)
            .with_safe_default_protocol_versions()
            .expect("versions")
            .with_no_client_auth()
            .with_single_cert(vec![certificate], key)
            .expect("a certificate and its key");
        let config = Arc::new(config);
        Self::start(answer, move |stream, state| {
            let connection =
                rustls::ServerConnection::new(Arc::clone(&config)).expect("a connection");
            serve(rustls::StreamOwned::new(connection, stream), state);
        })
    }

    fn start(
        answer: impl Fn(&str, usize) -> Answer + Send + Sync + 'static,
        serve: impl Fn(TcpStream, &State) + Clone + Send + 'static,
    ) -> Self {
        let listener = TcpListener::bind("127.0.0.1:0").expect("a port");
        let port = listener.local_addr().expect("an address").port();
        let state = Arc::new(State {
            answer: Box::new(answer),
            is_over: AtomicBool::new(false),
            asked: Mutex::default(),
            authorizations: Mutex::default(),
            requests: Mutex::default(),
            busy: AtomicUsize::new(0),
            most_busy: AtomicUsize::new(0),
        });
        let shared = Arc::clone(&state);
        std::thread::spawn(move || {
            for stream in listener.incoming() {
                if shared.is_over.load(Ordering::Relaxed) {
                    return;
                }
                let (Ok(stream), state) = (stream, Arc::clone(&shared)) else {
                    continue;
                };
                let serve = serve.clone();
                std::thread::spawn(move || serve(stream, &state));
            }
        });
        Self { port, state }
    }

    pub fn url(&self, path: &str) -> String {
        format!("http://127.0.0.1:{}{path}", self.port)
    }

    /// Number of requests for each path.
    pub fn asked(&self) -> HashMap<String, usize> {
        self.state.asked.lock().expect("whole").clone()
    }

    /// The headers `Authorization` of all requests that have one.
    pub fn authorizations(&self) -> Vec<String> {
        self.state.authorizations.lock().expect("whole").clone()
    }

    /// All requests.
    pub fn count(&self) -> usize {
        self.asked().values().sum()
    }

    /// When requests came.
    pub fn times(&self) -> Vec<Instant> {
        self.state.requests.lock().expect("whole").clone()
    }

    /// Largest number of simultaneous requests.
    pub fn most_busy(&self) -> usize {
        self.state.most_busy.load(Ordering::Relaxed)
    }
}

impl Drop for Server {
    fn drop(&mut self) {
        self.state.is_over.store(true, Ordering::Relaxed);
        let _ = TcpStream::connect(("127.0.0.1", self.port));
    }
}

fn serve(mut stream: impl Read + Write, state: &State) {
    // Connections are kept until something breaks.
    while answer_one(&mut stream, state).is_some() {}
}

fn answer_one(stream: &mut (impl Read + Write), state: &State) -> Option<()> {
    let mut head = Vec::new();
    while !head.ends_with(b"\r\n\r\n") && head.len() < 16_384 {
        let mut byte = [0];
        stream.read_exact(&mut byte).ok()?;
        head.push(byte[0]);
    }
    let first = String::from_utf8_lossy(&head).into_owned();
    let authorization = first.lines().find_map(|line| {
        let (name, value) = line.split_once(": ")?;
        name.eq_ignore_ascii_case("authorization")
            .then(|| value.to_string())
    });
    if let Some(value) = authorization {
        state.authorizations.lock().expect("whole").push(value);
    }
    state.requests.lock().expect("whole").push(Instant::now());
    let path = first.split(' ').nth(1)?.to_string();
    let nth = {
        let mut asked = state.asked.lock().expect("whole");
        let count = asked.entry(path.clone()).or_default();
        *count += 1;
        *count - 1
    };
    let busy = 1 + state.busy.fetch_add(1, Ordering::Relaxed);
    state.most_busy.fetch_max(busy, Ordering::Relaxed);
    let sent = send(stream, &(state.answer)(&path, nth));
    state.busy.fetch_sub(1, Ordering::Relaxed);
    stream.flush().ok()?;
    sent
}

/// `None` if the connection is no longer usable.
fn send(stream: &mut impl Write, answer: &Answer) -> Option<()> {
    let mut head = format!("HTTP/1.1 {}\r\n", answer.status);
    for (name, value) in &answer.headers {
        head.push_str(&format!("{name}: {value}\r\n"));
    }
    match answer.length {
        Some(length) => head.push_str(&format!("Content-Length: {length}\r\n\r\n")),
        None => head.push_str("Connection: close\r\n\r\n"),
    }
    stream.write_all(head.as_bytes()).ok()?;
    if answer.pause.is_zero() {
        stream.write_all(&answer.body).ok()?;
    } else {
        for byte in &answer.body {
            stream.write_all(&[*byte]).ok()?;
            std::thread::sleep(answer.pause);
        }
    }
    (answer.length == Some(answer.body.len())).then_some(())
}
