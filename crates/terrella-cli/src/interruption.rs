//! Requests to end: Ctrl-C, SIGTERM, and a terminal that is closed.
//!
//! Work that has something to save stops by itself and says so before ([`stop_by_itself`]); any other ends at once. Either way nothing
//! unfinished is left, and the exit code is 128 and the number of the signal. The second request ends everything at once.

use std::io::Write;
use std::process::exit;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};
#[cfg(target_os = "linux")]
use terrella_files::read_text;
use terrella_files::remove_unfinished;

/// The number of the first signal; 0 before.
static ASKED_BY: AtomicU8 = AtomicU8::new(0);
/// Whether the work under way stops by itself.
static STOPS_BY_ITSELF: AtomicBool = AtomicBool::new(false);
/// What is done first of all.
static FIRST: Mutex<Option<Box<dyn FnOnce() + Send>>> = Mutex::new(None);

/// Whether the program ends now, whatever its work is at.
static IS_ENDING: AtomicBool = AtomicBool::new(false);

/// What a shell adds to the number of a signal.
const SIGNALLED: u8 = 128;

/// The work that now begins asks [`is_asked`] again and again, and stops then.
pub fn stop_by_itself() {
    STOPS_BY_ITSELF.store(true, Ordering::SeqCst);
}

/// Does this at once at the first request, whatever the program is busy with.
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
    // Nobody is left to tell if standard error is closed.
    let _ = writeln!(
        std::io::stderr(),
        "error: interrupted; no partial file is left"
    );
    end(SIGNALLED + number);
}

/// Ends the program while its other threads work. The C library's `exit` would take down the graphics driver's tables under them,
/// which has been seen to crash: another program takes this one's place, and that ends at once.
#[cfg(unix)]
fn end(code: u8) -> ! {
    use std::os::unix::process::CommandExt;
    let mut shell = std::process::Command::new("/bin/sh");
    let _ = shell.args(["-c", "exit \"$0\"", &code.to_string()]).exec();
    // There is no shell.
    exit(code.into())
}

#[cfg(windows)]
fn end(code: u8) -> ! {
    exit(code.into())
}

/// Where the program ends, its work fails because its files are gone. That is not reported.
pub fn wait_for_end() {
    while IS_ENDING.load(Ordering::SeqCst) {
        std::thread::park();
    }
}

/// From here on requests are heard. Called before there is another thread, which would be ended by a signal.
#[cfg(unix)]
pub fn listen() {
    use nix::sys::signal::{SigSet, Signal};
    let ignored = ignored_signals();
    let mut signals = SigSet::empty();
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP] {
        // As `nohup` asks, and a shell for what it starts in the background.
        if ignored & (1 << (signal as u32 - 1)) == 0 {
            signals.add(signal);
        }
    }
    // No handler: a thread takes the signals, and may lock, write and remove files like any other.
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

/// Signals that this program was started to ignore, one bit each from the lowest.
#[cfg(target_os = "linux")]
fn ignored_signals() -> u64 {
    let status = read_text("/proc/self/status".as_ref(), 1 << 16);
    let status = status.ok().flatten().unwrap_or_default();
    let digits = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    digits
        .and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok())
        .unwrap_or_default()
}

/// Not known without a call that is not safe.
#[cfg(all(unix, not(target_os = "linux")))]
fn ignored_signals() -> u64 {
    0
}

/// From here on Ctrl-C and the end of the console are heard.
#[cfg(windows)]
pub fn listen() {
    const INTERRUPT: u8 = 2;
    if let Err(error) = ctrlc::set_handler(|| ask(INTERRUPT)) {
        tracing::warn!(
            "cannot handle signals; an interruption will leave hidden partial files: {error}"
        );
    }
}
