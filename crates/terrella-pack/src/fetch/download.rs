//! Files fetched by several threads: each is requested, checked and stored, or requested again later.

use super::cache::{Kept, Shelf};
use super::check::{self, Complaint};
use super::error::FetchError;
use super::http::{Client, GetError};
use super::pace::{LONGEST_WAIT, Pace, back_off, retry_after, sleep_until};
use super::plan::Wanted;
use super::source::Media;
use crate::BuildProgress;
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant, SystemTime};

/// Number of consecutive failures after which the server is not contacted any more.
const MOST_FAILURES_IN_A_ROW: u64 = 20;

/// Requirements of files, and how they are requested.
pub(super) struct Job<'a> {
    /// Where they are stored.
    pub shelf: &'a Shelf,
    /// Kind of picture.
    pub media: Media,
    /// Required width and height, texels.
    pub side: Option<u32>,
    pub most_bytes: u64,
    /// The server answers 404 for a missing tile.
    pub may_be_missing: bool,
    /// BLAKE3 of pictures that the server sends where it has nothing.
    pub placeholders: &'a [String],
    /// Number of simultaneous requests.
    pub connections: u32,
    /// Number of times that a file is requested again.
    pub retries: u32,
    /// When requests may begin.
    pub pace: &'a Pace,
    /// Asks.
    pub client: &'a Client,
    /// Receives each file, and decides whether to continue.
    pub progress: &'a dyn BuildProgress,
}

/// Result of a download.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Fetched {
    /// Files that came now.
    pub new: u64,
    /// Bytes of those.
    pub bytes: u64,
    /// Files that were there already.
    pub kept: u64,
    /// Files that the server has not.
    pub missing: u64,
    /// Files that could not be fetched.
    pub failed: u64,
    /// Requests that were repeated.
    pub retries: u64,
    /// Address and cause of the first failure.
    pub first_failure: Option<(String, String)>,
}

/// Action after a failure.
enum Next {
    /// Ask again, not before this has passed.
    Again(Option<Duration>),
    /// There is no such file.
    Missing,
    /// This file will not come.
    Failed,
    /// Nothing will come.
    End(&'static str),
}

/// Result of a request: bytes, or the reason and the next action.
type Answered = Result<u64, (String, Next)>;

impl GetError {
    fn next(&self) -> Next {
        match self {
            Self::Status {
                code,
                retry_after: header,
            } => match code {
                404 | 410 | 204 => Next::Missing,
                408 | 425 | 429 | 500 | 502 | 503 | 504 => {
                    let asked = header
                        .as_deref()
                        .and_then(|header| retry_after(header, SystemTime::now()));
                    match asked {
                        Some(wait) if wait > LONGEST_WAIT => {
                            Next::End("come back when the server says so")
                        }
                        asked => Next::Again(asked),
                    }
                }
                401 | 403 => Next::End(
                    "the source may want a key, or does not want to be asked so often; see its terms",
                ),
                400 => {
                    Next::End("correct layer, level, time or address in the source's description")
                }
                _ => Next::Failed,
            },
            Self::Redirect { .. } => Next::End(
                "correct the address, or allow that host with --redirect-host if you trust it",
            ),
            Self::Certificate(_) => Next::End(
                "check the address and this machine's clock; an authority of your own is given with --ca",
            ),
            Self::Truncated(_) | Self::Slow(_) | Self::Connection(_) => Next::Again(None),
            Self::TooLarge { .. } | Self::Media { .. } | Self::Compressed(_) => Next::Failed,
            Self::Write(_) | Self::Cancelled => Next::Failed,
        }
    }
}

/// State that the threads share.
struct SharedDownload<'a> {
    job: &'a Job<'a>,
    next: AtomicUsize,
    stopped: AtomicBool,
    failures_in_a_row: AtomicU64,
    done: Mutex<Fetched>,
    error: Mutex<Option<FetchError>>,
}

impl Job<'_> {
    /// Fetches what is not there yet.
    ///
    /// # Errors
    /// [`FetchError`] if nothing more can be fetched. Single files that could not be are counted.
    pub(super) fn run(&self, files: &[Wanted]) -> Result<Fetched, FetchError> {
        let shared = SharedDownload {
            job: self,
            next: AtomicUsize::new(0),
            stopped: AtomicBool::new(false),
            failures_in_a_row: AtomicU64::new(0),
            done: Mutex::new(Fetched::default()),
            error: Mutex::new(None),
        };
        std::thread::scope(|scope| {
            for n in 0..self.connections.clamp(1, 64) {
                let shared = &shared;
                let thread = std::thread::Builder::new().name(format!("terrella fetch {n}"));
                if let Err(error) = thread.spawn_scoped(scope, move || shared.work(files)) {
                    shared.end(FetchError::Client(format!(
                        "no thread can be started: {error}"
                    )));
                }
            }
        });
        let error = shared
            .error
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner);
        match error {
            Some(error) => Err(error),
            None if self.progress.cancelled() => Err(FetchError::Cancelled),
            None => Ok(shared
                .done
                .into_inner()
                .unwrap_or_else(PoisonError::into_inner)),
        }
    }
}

impl SharedDownload<'_> {
    fn is_over(&self) -> bool {
        self.stopped.load(Ordering::Relaxed) || self.job.progress.cancelled()
    }

    /// Ends all threads; the first reason counts.
    fn end(&self, error: FetchError) {
        let mut first = self.error.lock().unwrap_or_else(PoisonError::into_inner);
        first.get_or_insert(error);
        self.stopped.store(true, Ordering::Relaxed);
    }

    fn count(&self, add: impl FnOnce(&mut Fetched)) {
        add(&mut self.done.lock().unwrap_or_else(PoisonError::into_inner));
    }

    fn may_be_missing(&self) -> bool {
        self.job.may_be_missing || !self.job.placeholders.is_empty()
    }

    fn work(&self, files: &[Wanted]) {
        while !self.is_over() {
            let number = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(wanted) = files.get(number) else {
                return;
            };
            match self.fetch(wanted, number as u64) {
                Ok(()) => self.job.progress.step(),
                Err(error) => self.end(error),
            }
        }
    }

    /// Fetches one file, with retries. A failure of this file alone is counted.
    fn fetch(&self, wanted: &Wanted, number: u64) -> Result<(), FetchError> {
        match self.job.shelf.kept(&wanted.key, &wanted.file) {
            Some(Kept::File { blake3, .. }) if self.job.placeholders.contains(&blake3) => {
                // It came before the description named it.
                self.job.shelf.remove(&wanted.key, &wanted.file)?;
                self.count(|done| done.missing += 1);
                return Ok(());
            }
            Some(Kept::File { .. }) => {
                self.count(|done| done.kept += 1);
                return Ok(());
            }
            Some(Kept::Missing) if self.may_be_missing() => {
                self.count(|done| done.missing += 1);
                return Ok(());
            }
            _ => {}
        }
        let is_over = || self.is_over();
        let mut attempt = 0;
        loop {
            if !self.job.pace.wait(&is_over) {
                return Ok(());
            }
            let (cause, next) = match self.once(wanted)? {
                Ok(bytes) => {
                    self.failures_in_a_row.store(0, Ordering::Relaxed);
                    self.count(|done| {
                        done.new += 1;
                        done.bytes += bytes;
                    });
                    return Ok(());
                }
                Err(failure) => failure,
            };
            tracing::debug!(url = wanted.url, cause, attempt, "not fetched");
            match next {
                _ if self.is_over() => return Ok(()),
                Next::Missing if self.may_be_missing() => {
                    self.failures_in_a_row.store(0, Ordering::Relaxed);
                    self.job.shelf.note(&wanted.key, Kept::Missing)?;
                    self.count(|done| done.missing += 1);
                    return Ok(());
                }
                Next::End(advice) => {
                    return Err(FetchError::Rejected {
                        url: wanted.url.clone(),
                        cause,
                        advice,
                    });
                }
                Next::Again(asked) if attempt < self.job.retries => {
                    let wait = back_off(attempt, number);
                    if let Some(asked) = asked {
                        // It is meant for all of us.
                        self.job.pace.hold(asked);
                    }
                    sleep_until(Instant::now() + wait, &is_over);
                    self.count(|done| done.retries += 1);
                    attempt += 1;
                }
                Next::Again(_) | Next::Missing | Next::Failed => {
                    self.count(|done| {
                        done.failed += 1;
                        done.first_failure
                            .get_or_insert((wanted.url.clone(), cause.clone()));
                    });
                    let in_a_row = 1 + self.failures_in_a_row.fetch_add(1, Ordering::Relaxed);
                    if in_a_row >= MOST_FAILURES_IN_A_ROW {
                        return Err(FetchError::Rejected {
                            url: wanted.url.clone(),
                            cause: format!(
                                "{cause}; it is the last of {in_a_row} failures in a row"
                            ),
                            advice: "check the address and the connection, then run the same command again",
                        });
                    }
                    return Ok(());
                }
            }
        }
    }

    /// Asks once. The outer error ends everything, the inner one is this request's.
    fn once(&self, wanted: &Wanted) -> Result<Answered, FetchError> {
        let job = self.job;
        let mut part = job.shelf.begin(&wanted.file)?;
        let is_over = || self.is_over();
        let got = job.client.get(
            &wanted.url,
            job.media.name(),
            job.most_bytes,
            &mut part,
            &is_over,
        );
        if let Err(error) = got {
            let path = part.path().to_path_buf();
            part.discard();
            return match error {
                GetError::Write(source) => Err(FetchError::Cache { path, source }),
                error => Ok(Err((error.to_string(), error.next()))),
            };
        }
        let checked = check::complaint(part.path(), job.media, job.side);
        let complaint = match checked {
            Ok(complaint) => complaint,
            Err(source) => {
                let path = part.path().to_path_buf();
                part.discard();
                return Err(FetchError::Cache { path, source });
            }
        };
        if let Some(complaint) = complaint {
            part.discard();
            // A server that breaks off without a word of its length, or garbles, may do better next time.
            let next = match complaint {
                Complaint::Damaged(_) => Next::Again(None),
                Complaint::Other(_) => Next::Failed,
            };
            return Ok(Err((complaint.text(), next)));
        }
        if job.placeholders.contains(&part.hash()) {
            part.discard();
            let cause = "it is a picture that the server sends where it has nothing";
            return Ok(Err((cause.into(), Next::Missing)));
        }
        if let Some(expected) = &wanted.blake3
            && part.hash() != *expected
        {
            let found = part.hash();
            part.discard();
            return Ok(Err((
                format!("its BLAKE3 is {found} and must be {expected}"),
                Next::Failed,
            )));
        }
        job.shelf.finish(part, &wanted.key, &wanted.file).map(Ok)
    }
}
