//! Where simulators are met: addresses as Basilisk writes them, and the sockets under them.

use std::fmt;
use std::io::{self, ErrorKind, Read, Write};
use std::net::{IpAddr, Ipv4Addr, Shutdown, SocketAddr, TcpListener, TcpStream};
#[cfg(unix)]
use std::os::unix::fs::FileTypeExt;
#[cfg(unix)]
use std::os::unix::net::{UnixListener, UnixStream};
use std::path::PathBuf;
use std::str::FromStr;
use std::time::Duration;
#[cfg(unix)]
use terrella_files::Unfinished;
use terrella_files::excerpt;

/// A place where a simulator is met: `tcp://127.0.0.1:5556`, or on Unix `ipc:///path`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Endpoint {
    /// An address and a port.
    Tcp(SocketAddr),
    /// A socket in the file system, which other machines do not reach.
    #[cfg(unix)]
    Ipc(PathBuf),
}

/// Text that is no endpoint.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "{text:?} is not a valid endpoint; write \"tcp://127.0.0.1:5556\" with an IP address or localhost and a port, or \"ipc:///path\""
)]
pub struct BadEndpoint {
    /// The text.
    pub text: String,
}

impl Endpoint {
    /// The default endpoint of Basilisk's viewer: port 5556 of this machine.
    pub const TWO_WAY: Self = Self::Tcp(SocketAddr::new(IpAddr::V4(Ipv4Addr::LOCALHOST), 5556));

    /// Whether other machines can reach it.
    pub fn is_remote(&self) -> bool {
        match self {
            Self::Tcp(address) => !address.ip().is_loopback(),
            #[cfg(unix)]
            Self::Ipc(_) => false,
        }
    }
}

impl FromStr for Endpoint {
    type Err = BadEndpoint;

    fn from_str(text: &str) -> Result<Self, BadEndpoint> {
        let bad = || BadEndpoint {
            text: excerpt(text),
        };
        if let Some(address) = text.strip_prefix("tcp://") {
            let address = match address.strip_prefix("localhost:") {
                Some(port) => format!("127.0.0.1:{port}"),
                None => address.to_owned(),
            };
            return address.parse().map(Self::Tcp).map_err(|_| bad());
        }
        #[cfg(unix)]
        if let Some(path) = text.strip_prefix("ipc://")
            && !path.is_empty()
            && !path.contains('\0')
        {
            return Ok(Self::Ipc(path.into()));
        }
        Err(bad())
    }
}

impl fmt::Display for Endpoint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => write!(f, "tcp://{address}"),
            #[cfg(unix)]
            Self::Ipc(path) => write!(f, "ipc://{}", path.display()),
        }
    }
}

/// A listening socket for simulators.
#[derive(Debug)]
pub enum Listener {
    Tcp(TcpListener),
    #[cfg(unix)]
    Ipc(UnixListener, Unfinished),
}

impl Listener {
    /// Binds an endpoint; calls to it do not block.
    pub fn bind(endpoint: &Endpoint) -> io::Result<Self> {
        match endpoint {
            Endpoint::Tcp(address) => {
                let listener = TcpListener::bind(address)?;
                listener.set_nonblocking(true)?;
                Ok(Self::Tcp(listener))
            }
            #[cfg(unix)]
            Endpoint::Ipc(path) => {
                // A socket without a listener is left over from a program that has ended and is removed. Connecting to a regular file fails
                // in the same way, but the file stays.
                let is_socket = std::fs::symlink_metadata(path)
                    .is_ok_and(|found| found.file_type().is_socket());
                let is_rejected = |error: io::Error| error.kind() == ErrorKind::ConnectionRefused;
                if is_socket && UnixStream::connect(path).is_err_and(is_rejected) {
                    std::fs::remove_file(path)?;
                }
                let (listener, unfinished) =
                    Unfinished::create(path, |path| UnixListener::bind(path))?;
                listener.set_nonblocking(true)?;
                Ok(Self::Ipc(listener, unfinished))
            }
        }
    }

    /// Where it is bound, with the port that was found for port 0.
    pub fn endpoint(&self) -> io::Result<Endpoint> {
        Ok(match self {
            Self::Tcp(listener) => Endpoint::Tcp(listener.local_addr()?),
            #[cfg(unix)]
            Self::Ipc(_, socket) => Endpoint::Ipc(socket.path().to_owned()),
        })
    }

    /// The next connection, if one waits.
    pub fn accept(&self) -> io::Result<Option<Stream>> {
        let accepted = match self {
            Self::Tcp(listener) => listener.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(false)?;
                stream.set_nodelay(true)?;
                Ok(Stream::Tcp(stream))
            }),
            #[cfg(unix)]
            Self::Ipc(listener, _) => listener.accept().and_then(|(stream, _)| {
                stream.set_nonblocking(false)?;
                Ok(Stream::Ipc(stream))
            }),
        };
        match accepted {
            Ok(stream) => Ok(Some(stream)),
            Err(error) if error.kind() == ErrorKind::WouldBlock => Ok(None),
            Err(error) => Err(error),
        }
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        #[cfg(unix)]
        if let Self::Ipc(_, socket) = self {
            // Somebody else's by now, or gone: nothing is left to do.
            let _ = std::fs::remove_file(socket.path());
        }
    }
}

/// A connection.
#[derive(Debug)]
pub enum Stream {
    Tcp(TcpStream),
    #[cfg(unix)]
    Ipc(UnixStream),
}

impl Stream {
    pub fn connect(endpoint: &Endpoint, timeout: Duration) -> io::Result<Self> {
        match endpoint {
            Endpoint::Tcp(address) => {
                let stream = TcpStream::connect_timeout(address, timeout)?;
                stream.set_nodelay(true)?;
                Ok(Self::Tcp(stream))
            }
            #[cfg(unix)]
            Endpoint::Ipc(path) => Ok(Self::Ipc(UnixStream::connect(path)?)),
        }
    }

    /// How long reading and writing may block.
    pub fn set_timeouts(&self, read: Duration, write: Duration) -> io::Result<()> {
        match self {
            Self::Tcp(stream) => {
                stream.set_read_timeout(Some(read))?;
                stream.set_write_timeout(Some(write))
            }
            #[cfg(unix)]
            Self::Ipc(stream) => {
                stream.set_read_timeout(Some(read))?;
                stream.set_write_timeout(Some(write))
            }
        }
    }

    /// Holds back output until [`Self::end_writing`], so that the peer receives everything at the same time: for TCP on Linux.
    pub fn hold(&self) {
        #[cfg(target_os = "linux")]
        if let Self::Tcp(stream) = self {
            // Without this option, the end of the stream arrives a little later than the reply.
            let _ = rustix::net::sockopt::set_tcp_cork(stream, true);
        }
    }

    /// Closes the stream for writing. Data already sent still arrives.
    pub fn end_writing(&self) {
        // A connection that is gone already needs no goodbye.
        let _ = match self {
            Self::Tcp(stream) => stream.shutdown(Shutdown::Write),
            #[cfg(unix)]
            Self::Ipc(stream) => stream.shutdown(Shutdown::Write),
        };
    }
}

impl Read for Stream {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.read(buffer),
            #[cfg(unix)]
            Self::Ipc(stream) => stream.read(buffer),
        }
    }
}

impl Write for Stream {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self {
            Self::Tcp(stream) => stream.write(bytes),
            #[cfg(unix)]
            Self::Ipc(stream) => stream.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match self {
            Self::Tcp(stream) => stream.flush(),
            #[cfg(unix)]
            Self::Ipc(stream) => stream.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_as_basilisk_writes_them() {
        let read = |text: &str| text.parse::<Endpoint>().map(|one| one.to_string());
        assert_eq!(
            read("tcp://127.0.0.1:5556"),
            Ok(Endpoint::TWO_WAY.to_string())
        );
        assert_eq!(
            read("tcp://localhost:5556"),
            Ok(Endpoint::TWO_WAY.to_string())
        );
        let remote: Endpoint = "tcp://0.0.0.0:5556".parse().expect("an address");
        assert!(remote.is_remote() && !Endpoint::TWO_WAY.is_remote());
        for bad in [
            "",
            "5556",
            "tcp://",
            "tcp://host:1",
            "tcp://127.0.0.1",
            "ipc://",
            "udp://127.0.0.1:1",
        ] {
            assert!(read(bad).is_err(), "{bad}");
        }
        #[cfg(unix)]
        assert_eq!(read("ipc:///tmp/bsk:1"), Ok("ipc:///tmp/bsk:1".to_owned()));
    }

    #[cfg(unix)]
    #[test]
    fn a_socket_that_was_left_behind_is_bound_anew_and_one_in_use_is_not() {
        let folder = std::env::temp_dir().join(format!("terrella-ipc-{}", std::process::id()));
        std::fs::create_dir_all(&folder).expect("a folder");
        let endpoint = Endpoint::Ipc(folder.join("socket"));
        let Endpoint::Ipc(path) = &endpoint else {
            return;
        };
        drop(UnixListener::bind(path).expect("binds"));
        assert!(path.exists());
        let bound = Listener::bind(&endpoint).expect("binds again");
        assert!(Listener::bind(&endpoint).is_err());
        drop(bound);
        assert!(!path.exists());
        // A file that is not a socket stays.
        std::fs::write(path, b"a file").expect("writes");
        assert!(Listener::bind(&endpoint).is_err());
        assert_eq!(std::fs::read(path).expect("reads"), b"a file");
        std::fs::remove_dir_all(&folder).expect("removes");
    }
}
