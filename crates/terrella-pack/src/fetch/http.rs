//! HTTP. The only file of the program that accesses the network by itself (`tests/house` enforces it), and only for this module.
//!
//! Nothing is trusted: sizes are counted during the transfer, compressed replies are rejected (none is requested), and redirects are followed here,
//! where the allowed targets are known.

use super::address::{host, joined, may_follow};
use super::error::FetchError;
use super::token::Token;
use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};
use terrella_files::{self as files, printable};
use ureq::tls::{Certificate, PemItem, RootCerts, TlsConfig, parse_pem};
use ureq::{Agent, Error};

/// Redirects that are followed for one file.
const MOST_REDIRECTS: u32 = 5;

/// A server that gives less on average, once its time is over, is too slow, bytes a second.
const SLOWEST_BYTES_PER_S: f64 = 2000.0;

/// Largest file of certificates, bytes.
const MAX_PEM_BYTES: u64 = 4 << 20;

/// Options of requests.
#[derive(Clone, Debug)]
pub struct ClientOptions {
    /// Timeout for a connection, for the start of a reply and for each further piece of it.
    pub timeout: Duration,
    /// A file with certificates (PEM) of authorities that are trusted instead of those that come with the program.
    pub authorities: Option<std::path::PathBuf>,
    /// Hosts (with the port unless it is the default one) that redirects may lead to, besides the requested one.
    pub redirect_hosts: Vec<String>,
}

impl Default for ClientOptions {
    fn default() -> Self {
        Self {
            timeout: Duration::from_secs(30),
            authorities: None,
            redirect_hosts: Vec::new(),
        }
    }
}

/// A client, shared by all threads.
pub(super) struct Client {
    agent: Agent,
    options: ClientOptions,
    token: Option<Token>,
}

/// Why one request gave nothing.
#[derive(Debug, thiserror::Error)]
pub(super) enum GetError {
    /// A status other than 200.
    #[error("the server answers {code}")]
    Status {
        code: u16,
        /// Value of its header Retry-After.
        retry_after: Option<String>,
    },
    /// Elsewhere than it may.
    #[error("the server sends on to {to}")]
    Redirect { to: String },
    /// More than a file may have.
    #[error("the answer has more than {most} bytes{}", reported.map_or(String::new(), |reported| format!(" (the server says {reported})")))]
    TooLarge { most: u64, reported: Option<u64> },
    /// A media type other than the requested one.
    #[error("the answer is {found} and must be {wanted}")]
    Media { found: String, wanted: &'static str },
    /// A compressed reply, which was not requested.
    #[error("the answer is compressed ({0}), which was not asked for")]
    Compressed(String),
    /// Broken off.
    #[error("the answer breaks off after {0} bytes")]
    Truncated(u64),
    /// Nothing for too long, or too little.
    #[error("the server is too slow ({0})")]
    Slow(String),
    /// It cannot be trusted.
    #[error("the server's certificate is not good: {0}")]
    Certificate(String),
    /// No connection, or one that broke.
    #[error("no connection: {0}")]
    Connection(String),
    /// The file could not be written.
    #[error("{0}")]
    Write(std::io::Error),
    /// No longer wanted.
    #[error("stopped")]
    Cancelled,
}

impl GetError {
    /// The same without the token: servers repeat addresses.
    fn without(self, token: &Token) -> Self {
        match self {
            Self::Redirect { to } => Self::Redirect {
                to: token.hidden(&to),
            },
            Self::Media { found, wanted } => Self::Media {
                found: token.hidden(&found),
                wanted,
            },
            Self::Compressed(text) => Self::Compressed(token.hidden(&text)),
            Self::Slow(text) => Self::Slow(token.hidden(&text)),
            Self::Certificate(text) => Self::Certificate(token.hidden(&text)),
            Self::Connection(text) => Self::Connection(token.hidden(&text)),
            other @ (Self::Status { .. }
            | Self::TooLarge { .. }
            | Self::Truncated(_)
            | Self::Write(_)
            | Self::Cancelled) => other,
        }
    }
}

impl Client {
    /// One that sends this token with each request.
    pub(super) fn new(options: ClientOptions, token: Option<Token>) -> Result<Self, FetchError> {
        let roots = match &options.authorities {
            Some(path) => RootCerts::new_with_certs(&certificates(path)?),
            None => RootCerts::WebPki,
        };
        let timeout = Some(options.timeout);
        let config = Agent::config_builder()
            .tls_config(TlsConfig::builder().root_certs(roots).build())
            .http_status_as_error(false)
            .max_redirects(0)
            .max_redirects_will_error(false)
            .user_agent(concat!("terrella/", env!("CARGO_PKG_VERSION")))
            .accept_encoding("identity")
            .timeout_resolve(timeout)
            .timeout_connect(timeout)
            .timeout_recv_response(timeout)
            .timeout_per_read(timeout)
            .max_response_header_size(64 << 10)
            .build();
        Ok(Self {
            agent: config.into(),
            options,
            token,
        })
    }

    /// Asks for a picture and writes it. Gives its length.
    pub(super) fn get(
        &self,
        url: &str,
        wanted: &'static str,
        most_bytes: u64,
        out: &mut dyn Write,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<u64, GetError> {
        let got = self.get_with_token(url, wanted, most_bytes, out, is_cancelled);
        got.map_err(|error| match &self.token {
            Some(token) => error.without(token),
            None => error,
        })
    }

    fn get_with_token(
        &self,
        url: &str,
        wanted: &'static str,
        most_bytes: u64,
        out: &mut dyn Write,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<u64, GetError> {
        let token = self.token.as_ref();
        let mut at = token.map_or_else(|| url.to_string(), |token| token.filled(url));
        for _ in 0..=MOST_REDIRECTS {
            let mut request = self.agent.get(&at).header("accept", wanted);
            // Other hosts have no business with it.
            let is_own_host = host(&at) == host(url);
            if let Some(header) = token.and_then(|token| token.header(url))
                && is_own_host
            {
                request = request.header("authorization", header);
            }
            let response = request.call().map_err(|error| reported(error, 0))?;
            let header = |name: &str| {
                let value = response.headers().get(name)?.to_str().ok()?;
                Some(value.chars().take(200).collect::<String>())
            };
            let code = response.status().as_u16();
            if matches!(code, 301 | 302 | 303 | 307 | 308) {
                let to = header("location").unwrap_or_default();
                match joined(&at, &to) {
                    Some(next) if may_follow(url, &next, &self.options.redirect_hosts) => {
                        at = next;
                        continue;
                    }
                    _ => return Err(GetError::Redirect { to: printable(&to) }),
                }
            }
            if code != 200 {
                return Err(GetError::Status {
                    code,
                    retry_after: header("retry-after"),
                });
            }
            if let Some(encoding) =
                header("content-encoding").filter(|e| !e.eq_ignore_ascii_case("identity"))
            {
                return Err(GetError::Compressed(printable(&encoding)));
            }
            let media = header("content-type").unwrap_or_else(|| "of no type".to_string());
            let essence = media.split(';').next().unwrap_or_default().trim();
            if !is_media(essence, wanted) {
                return Err(GetError::Media {
                    found: printable(&media),
                    wanted,
                });
            }
            let length = header("content-length").and_then(|digits| digits.trim().parse().ok());
            if length.is_some_and(|length: u64| length > most_bytes) {
                return Err(GetError::TooLarge {
                    most: most_bytes,
                    reported: length,
                });
            }
            let mut body = response.into_body();
            return self.copy(&mut body.as_reader(), most_bytes, out, is_cancelled);
        }
        Err(GetError::Redirect {
            to: format!(
                "{} and on, more than {MOST_REDIRECTS} times",
                printable(&at)
            ),
        })
    }

    fn copy(
        &self,
        body: &mut dyn Read,
        most_bytes: u64,
        out: &mut dyn Write,
        is_cancelled: &dyn Fn() -> bool,
    ) -> Result<u64, GetError> {
        let (begun, mut count, mut piece) = (Instant::now(), 0_u64, vec![0; 64 << 10]);
        loop {
            if is_cancelled() {
                return Err(GetError::Cancelled);
            }
            let read = match body.read(&mut piece) {
                Ok(0) => return Ok(count),
                Ok(read) => read,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => return Err(reported(Error::from(error), count)),
            };
            count += read as u64;
            if count > most_bytes {
                return Err(GetError::TooLarge {
                    most: most_bytes,
                    reported: None,
                });
            }
            out.write_all(&piece[..read]).map_err(GetError::Write)?;
            let passed = begun.elapsed();
            if passed > self.options.timeout
                && (count as f64) < SLOWEST_BYTES_PER_S * passed.as_secs_f64()
            {
                return Err(GetError::Slow(format!(
                    "{count} bytes in {:.1} s",
                    passed.as_secs_f64()
                )));
            }
        }
    }
}

/// Whether a reply's type is the requested one, or unspecific: the content is checked in any case. `image/jpg` is a common mistake for
/// `image/jpeg`.
fn is_media(found: &str, wanted: &str) -> bool {
    const OF_BYTES: [&str; 2] = ["application/octet-stream", "binary/octet-stream"];
    found.eq_ignore_ascii_case(wanted)
        || OF_BYTES
            .iter()
            .any(|bytes| found.eq_ignore_ascii_case(bytes))
        || (wanted == "image/jpeg" && found.eq_ignore_ascii_case("image/jpg"))
}

/// Converts an error after `count` bytes.
fn reported(error: Error, count: u64) -> GetError {
    match error {
        Error::Timeout(what) => GetError::Slow(what.to_string()),
        Error::Tls(cause) => GetError::Certificate(printable(cause)),
        Error::Rustls(cause) => certificate_or_connection(&cause.to_string()),
        Error::Io(error) => match error.kind() {
            ErrorKind::UnexpectedEof => GetError::Truncated(count),
            ErrorKind::TimedOut | ErrorKind::WouldBlock => {
                GetError::Slow(printable(&error.to_string()))
            }
            _ => certificate_or_connection(&error.to_string()),
        },
        Error::Protocol(_) if count > 0 => GetError::Truncated(count),
        other => GetError::Connection(printable(&other.to_string())),
    }
}

fn certificate_or_connection(cause: &str) -> GetError {
    if cause.contains("certificate") {
        GetError::Certificate(printable(cause))
    } else {
        GetError::Connection(printable(cause))
    }
}

fn certificates(path: &Path) -> Result<Vec<Certificate<'static>>, FetchError> {
    let wrong = |cause: String| FetchError::Option {
        option: "--ca",
        cause: format!("{}: {cause}", path.display()),
    };
    let pem = files::read(path, MAX_PEM_BYTES).map_err(|error| wrong(error.to_string()))?;
    let pem = pem.ok_or_else(|| wrong(format!("has more than {MAX_PEM_BYTES} bytes")))?;
    let mut found = Vec::new();
    for item in parse_pem(&pem) {
        match item.map_err(|error| wrong(printable(&error.to_string())))? {
            PemItem::Certificate(certificate) => found.push(certificate),
            _ => {
                return Err(wrong(
                    "holds more than certificates; give a file without keys".to_string(),
                ));
            }
        }
    }
    if found.is_empty() {
        return Err(wrong("holds no certificate in PEM".to_string()));
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_compared_as_such() {
        assert!(is_media("IMAGE/PNG", "image/png") && is_media("image/jpg", "image/jpeg"));
        assert!(is_media("binary/octet-stream", "image/png"));
        assert!(
            !is_media("image/jpg", "image/png")
                && !is_media("", "image/png")
                && !is_media("text/html", "image/jpeg")
        );
    }

    #[test]
    fn what_servers_say_is_made_printable() {
        let said = printable(&format!("a\u{1b}[31m{}", "b".repeat(500)));
        assert!(said.len() < 250 && !said.contains('\u{1b}'), "{said}");
    }
}
