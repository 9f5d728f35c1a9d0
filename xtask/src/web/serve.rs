//! A server of one folder for this machine only, with the strictest content security policy under which the pages work.

use anyhow::Context;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::{Ipv4Addr, SocketAddr, TcpListener, TcpStream};
use std::path::{Component, Path, PathBuf};
use std::thread::JoinHandle;
use std::time::Duration;

/// No external content, no inline scripts and styles, no `eval`; only wasm may compile.
const POLICY: &str = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' blob:; connect-src 'self'";
/// Limit on the length of a request, bytes, and on the wait for one.
const MAX_REQUEST: u64 = 16 << 10;
const PATIENCE: Duration = Duration::from_secs(10);

pub struct Server {
    address: SocketAddr,
    accepting: JoinHandle<()>,
}

impl Server {
    /// Serves a folder at a port of this machine; 0 selects a free one.
    pub fn start(folder: &Path, port: u16) -> anyhow::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, port))
            .with_context(|| format!("cannot serve at port {port}; take another by --port"))?;
        let address = listener.local_addr().context("the server has no address")?;
        let folder = folder.to_owned();
        let accepting = std::thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                let folder = folder.clone();
                // A browser that disconnects early is not an error.
                std::thread::spawn(move || drop(answer(stream, &folder)));
            }
        });
        Ok(Self { address, accepting })
    }

    /// The URL of the server.
    pub fn address(&self) -> String {
        format!("http://{}", self.address)
    }

    /// Serves until the program ends.
    pub fn wait(self) {
        drop(self.accepting.join());
    }
}

fn answer(stream: TcpStream, folder: &Path) -> std::io::Result<()> {
    stream.set_read_timeout(Some(PATIENCE))?;
    let mut lines = BufReader::new(stream.try_clone()?.take(MAX_REQUEST)).lines();
    let first = lines.next().transpose()?.unwrap_or_default();
    // The rest of the request is irrelevant but must be read.
    while lines
        .next()
        .transpose()?
        .is_some_and(|line| !line.is_empty())
    {}
    let (status, kind, body) = match file_of(&first, folder).map(|path| (fs::read(&path), path)) {
        Some((Ok(body), path)) => ("200 OK", kind(&path), body),
        _ => ("404 Not Found", "text/plain", b"not found".to_vec()),
    };
    let mut stream = stream;
    write!(
        stream,
        "HTTP/1.1 {status}\r\ncontent-type: {kind}\r\ncontent-length: {}\r\ncontent-security-policy: {POLICY}\r\n\
         x-content-type-options: nosniff\r\ncache-control: no-cache\r\nconnection: close\r\n\r\n",
        body.len()
    )?;
    stream.write_all(&body)
}

/// The file of a request's first line; `None` outside the folder.
fn file_of(request: &str, folder: &Path) -> Option<PathBuf> {
    let address = request
        .strip_prefix("GET /")?
        .split([' ', '?', '#'])
        .next()?;
    let name = if address.is_empty() {
        "index.html"
    } else {
        address
    };
    let path = Path::new(name);
    let is_inside = path
        .components()
        .all(|part| matches!(part, Component::Normal(_)));
    is_inside.then(|| folder.join(path))
}

fn kind(path: &Path) -> &'static str {
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("json") => "application/json",
        Some("svg") => "image/svg+xml",
        Some("jpg") => "image/jpeg",
        Some("png") => "image/png",
        Some("wasm") => "application/wasm",
        _ => "application/octet-stream",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_files_of_the_folder_are_served() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("pages");
        fs::create_dir(&folder).unwrap();
        fs::write(folder.join("index.html"), "<p>hello").unwrap();
        fs::write(dir.path().join("secret"), "secret").unwrap();
        let server = Server::start(&folder, 0).unwrap();
        let ask = |path: &str| {
            let mut stream = TcpStream::connect(server.address).unwrap();
            write!(stream, "GET {path} HTTP/1.1\r\nhost: x\r\n\r\n").unwrap();
            let mut answer = String::new();
            stream.read_to_string(&mut answer).unwrap();
            answer
        };
        let page = ask("/?a=b");
        assert!(
            page.starts_with("HTTP/1.1 200") && page.ends_with("<p>hello"),
            "{page}"
        );
        assert!(page.contains("default-src 'none'") && page.contains("text/html"));
        for path in ["/../secret", "//etc/passwd", "/missing", "/./../secret"] {
            let answer = ask(path);
            assert!(answer.starts_with("HTTP/1.1 404"), "{path}: {answer}");
        }
    }
}
