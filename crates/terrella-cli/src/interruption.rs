//! Interruptions: Ctrl-C, SIGTERM, and a closed terminal.
//!
//! Work with results to save stops by itself and registers for it ([`stop_by_itself`]); any other work ends at once. In both cases no partial file
//! is left, and the exit code is 128 plus the signal number. A second request ends any work at once.

use std::io::Write;
use std::process::exit;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
#[cfg(target_os = "linux")]
use terrella_files::read_text;
use terrella_files::remove_unfinished;

/// The number of the first signal; 0 before.
static ASKED_BY: AtomicU8 = AtomicU8::new(0);
/// Whether the current work stops by itself.
static STOPS_BY_ITSELF: AtomicBool = AtomicBool::new(false);
/// Work to do at the first request.
static FIRST: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Whether the program is ending, regardless of its work.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// Added to a signal number in exit codes, as shells do.
const SIGNALLED: u8 = 128;

/// Registers work that polls [`is_asked`] and stops by itself.
pub fn stop_by_itself() {
    STOPS_BY_ITSELF.store(true, Ordering::SeqCst);
}

/// Registers work to do at the first request, whatever the program is doing.
pub fn do_first(first: impl FnOnce() + Send + 'static) {
    *FIRST.lock().unwrap_or_else(PoisonError::into_inner) = Some(Box::new(first));
}

/// Whether the program has been asked to end.
pub fn is_asked() -> bool {
    ASKED_BY.load(Ordering::SeqCst) != 0
}

/// The exit code after a request to end.
pub fn exit_code() -> Option<u8> {
    match ASKED_BY.load(Ordering::SeqCst) {
        0 => None,
        number => Some(SIGNALLED + number),
    }
}

fn ask(number: u8) {
    let is_first = ASKED_BY
        .compare_exchange(0, number, Ordering::SeqCst, Ordering::SeqCst)
        .is_ok();
    let first = FIRST.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(first) = first {
        first();
    }
    if is_first && STOPS_BY_ITSELF.load(Ordering::SeqCst) {
        return;
    }
    IS_ENDING.store(true, Ordering::SeqCst);
    remove_unfinished();
    // No one can be informed if standard error is closed.
    let _ = writeln!(
        std::io::stderr(),
        "error: interrupted; no partial file is left"
    );
    end(SIGNALLED + number);
}

/// Ends the program while its other threads run. The C library's `exit` would free the graphics driver's tables under them, and crashes were
/// observed. So a shell replaces the process and exits at once.
#[cfg(unix)]
fn end(code: u8) -> ! {
    use std::os::unix::process::CommandExt;
    let mut shell = std::process::Command::new("/bin/sh");
    let _ = shell.args(["-c", "exit \"$0\"", &code.to_string()]).exec();
    // Reached only without a shell.
    exit(code.into())
}

#[cfg(windows)]
fn end(code: u8) -> ! {
    exit(code.into())
}

/// Blocks while the program is ending: work that fails because its files were removed is not reported.
pub fn wait_for_end() {
    while IS_ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// Starts to handle interruptions. Call it before any other thread exists, because a signal would end the process there.
#[cfg(unix)]
pub fn listen() {
    use nix::sys::signal::{SigSet, Signal};
    let ignored = ignored_signals();
    let mut signals = SigSet::empty();
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP] {
        // Signals stay ignored for `nohup` and for background jobs of a shell.
        if ignored & (1 << (signal as u32 - 1)) == 0 {
            signals.add(signal);
        }
    }
    // A thread instead of a handler: it may lock, write and remove files like any other.
    let heard = signals
        .thread_block()
        .map_err(std::io::Error::from)
        .and_then(|()| {
            let name = std::thread::Builder::new().name("terrella interruptions".into());
            name.spawn(move || {
                while let Ok(signal) = signals.wait() {
                    ask(signal as u8);
                }
            })
        });
    if let Err(error) = heard {
        tracing::warn!(
            "cannot handle signals; an interruption will leave hidden partial files: {error}"
        );
    }
}

/// Signals that were ignored at the program's start, one bit each from the lowest.
#[cfg(target_os = "linux")]
fn ignored_signals() -> u64 {
    let status = read_text("/proc/self/status".as_ref(), 1 << 16);
    let status = status.ok().flatten().unwrap_or_default();
    let digits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    digits
        .and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok())
        .unwrap_or_default()
}

/// Unknown without an unsafe call.
#[cfg(all(unix, not(target_os = "linux")))]
fn ignored_signals() -> u64 {
    0
}

/// Starts to handle Ctrl-C and the closing of the console.
#[cfg(windows)]
pub fn listen() {
    const INTERRUPT: u8 = 2;
    if let Err(error) = ctrlc::set_handler(|| ask(INTERRUPT)) {
        tracing::warn!(
            "cannot handle signals; an interruption will leave hidden partial files: {error}"
        );
    }
}
