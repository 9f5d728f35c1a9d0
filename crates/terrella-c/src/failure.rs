//! Statuses and their error messages.

use std::cell::UnsafeCell;
use std::ffi::{CStr, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};
use terrella::{EarthError, OffscreenError};
use terrella_orbit::OrbitError;
use terrella_play::PlayError;

/// The result of a call. `terrella_message` returns the error message.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(non_camel_case_types, reason = "the names that C has")]
pub enum TerrellaStatus {
    /// Done.
    TERRELLA_OK = 0,
    /// A required pointer is null.
    TERRELLA_NULL = 1,
    /// An argument is out of range or invalid.
    TERRELLA_ARGUMENT = 2,
    /// A freed handle, a value that was never a handle, or a handle of another type.
    TERRELLA_HANDLE = 3,
    /// A scene is invalid, or does not cover the requested time.
    TERRELLA_SCENE = 4,
    /// A file cannot be read or is invalid.
    TERRELLA_FILE = 5,
    /// No graphics adapter, out of device memory, a missing device feature, or a lost device.
    TERRELLA_DEVICE = 6,
    /// The handle was made before `fork`, and this is the child.
    TERRELLA_FORKED = 7,
    /// An internal error. Do not use the handle of the call any more. Please report it.
    TERRELLA_BROKEN = 8,
}

/// Why a call failed.
#[derive(Debug)]
pub(crate) struct Failure {
    pub status: TerrellaStatus,
    pub words: String,
}

impl Failure {
    pub fn new(status: TerrellaStatus, words: impl Into<String>) -> Self {
        Self {
            status,
            words: words.into(),
        }
    }

    pub fn argument(words: impl Into<String>) -> Self {
        Self::new(TerrellaStatus::TERRELLA_ARGUMENT, words)
    }

    pub fn device(words: impl ToString) -> Self {
        Self::new(TerrellaStatus::TERRELLA_DEVICE, words.to_string())
    }

    pub fn file(words: impl ToString) -> Self {
        Self::new(TerrellaStatus::TERRELLA_FILE, words.to_string())
    }
}

impl From<OffscreenError> for Failure {
    fn from(error: OffscreenError) -> Self {
        let words = error.to_string();
        match error {
            OffscreenError::Earth(EarthError::Exposure(_)) => {
                Self::argument(format!("options.exposure_ev: {words}"))
            }
            OffscreenError::NoPicture => Self::argument(format!("camera: {words}")),
            OffscreenError::Empty { .. }
            | OffscreenError::TooLarge { .. }
            | OffscreenError::TooMuchMemory { .. }
            | OffscreenError::TruthTooLarge { .. } => Self::argument(format!("size: {words}")),
            OffscreenError::Imagery(_) => Self::file(words),
            _ => Self::device(words),
        }
    }
}

impl From<PlayError> for Failure {
    fn from(error: PlayError) -> Self {
        let words = error.to_string();
        match error {
            PlayError::Offscreen(error) => error.into(),
            PlayError::Context(_)
            | PlayError::Earth(_)
            | PlayError::Picture(_)
            | PlayError::DeviceLost(_) => Self::device(words),
            error if error.is_bad_scene() => Self::new(TerrellaStatus::TERRELLA_SCENE, words),
            _ => Self::file(words),
        }
    }
}

impl From<OrbitError> for Failure {
    fn from(error: OrbitError) -> Self {
        Self::new(TerrellaStatus::TERRELLA_SCENE, error.to_string())
    }
}

/// Bytes of a message with its final zero byte.
const MESSAGE_BYTES: usize = 2048;

thread_local! {
    /// It has no destructor, so that its address is valid until the thread ends.
    static MESSAGE: UnsafeCell<[u8; MESSAGE_BYTES]> = const { UnsafeCell::new([0; MESSAGE_BYTES]) };
}

fn tell(words: &str) {
    // A zero byte would end the text early.
    let words = words.replace('\0', "?");
    let words = &words[..words.floor_char_boundary(MESSAGE_BYTES - 1)];
    MESSAGE.with(|message| {
        // SAFETY: only this thread uses the buffer, and no other reference to it exists: `terrella_message` returns a pointer only.
        let message = unsafe { &mut *message.get() };
        for (to, from) in message.iter_mut().zip(words.bytes().chain([0])) {
            *to = from;
        }
    });
}

/// Runs the work of a call, catches panics and stores the error message.
pub(crate) fn answer(work: impl FnOnce() -> Result<(), Failure>) -> TerrellaStatus {
    match catch_unwind(AssertUnwindSafe(work)) {
        Ok(Ok(())) => TerrellaStatus::TERRELLA_OK,
        Ok(Err(failure)) => {
            tell(&failure.words);
            failure.status
        }
        Err(panic) => {
            let words = panic.downcast_ref::<String>().map(String::as_str);
            let words = words.or_else(|| panic.downcast_ref::<&str>().copied());
            tell(&format!(
                "the library broke down, please report it: {}",
                words.unwrap_or("no words")
            ));
            TerrellaStatus::TERRELLA_BROKEN
        }
    }
}

/// The error message of this thread's last failed call, in UTF-8; empty if there was none. The pointer is valid until the thread ends. The
/// thread's next failed call overwrites the text. A message of more than 2047 bytes is truncated. Use the pointer in this thread only.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_message() -> *const c_char {
    MESSAGE.with(|message| message.get().cast_const().cast())
}

/// The name of a status, for logs: "TERRELLA_OK" and so on; "no status" for any other number. The text never changes and is valid as long
/// as the library is loaded.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_status_name(status: u32) -> *const c_char {
    let name: &'static CStr = match status {
        0 => c"TERRELLA_OK",
        1 => c"TERRELLA_NULL",
        2 => c"TERRELLA_ARGUMENT",
        3 => c"TERRELLA_HANDLE",
        4 => c"TERRELLA_SCENE",
        5 => c"TERRELLA_FILE",
        6 => c"TERRELLA_DEVICE",
        7 => c"TERRELLA_FORKED",
        8 => c"TERRELLA_BROKEN",
        _ => c"no status",
    };
    name.as_ptr()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message() -> String {
        // SAFETY: it points to this thread's text, which ends with a zero byte and is copied before another call.
        unsafe { CStr::from_ptr(terrella_message()) }
            .to_string_lossy()
            .into_owned()
    }

    #[test]
    fn a_panic_stays_inside() {
        let status = answer(|| panic!("deliberate"));
        assert_eq!(status, TerrellaStatus::TERRELLA_BROKEN);
        assert!(message().contains("deliberate"), "{}", message());
    }

    #[test]
    fn words_are_kept_for_their_thread() {
        answer(|| Err(Failure::argument("a\0b")));
        assert_eq!(message(), "a?b");
        let other = std::thread::spawn(message).join().expect("a thread");
        assert_eq!(other, "");
        assert_eq!(answer(|| Ok(())), TerrellaStatus::TERRELLA_OK);
        assert_eq!(message(), "a?b");
    }

    #[test]
    fn the_message_keeps_its_address_and_fits_its_buffer() {
        let before = terrella_message();
        answer(|| Err(Failure::argument("short")));
        assert_eq!(message(), "short");
        // Two bytes each, after one byte: the limit is within a character.
        answer(|| Err(Failure::argument(format!("a{}", "ä".repeat(2000)))));
        assert_eq!(terrella_message(), before);
        assert_eq!(message(), format!("a{}", "ä".repeat(1023)));
        answer(|| Err(Failure::argument(format!("ab{}", "ä".repeat(2000)))));
        assert_eq!(message(), format!("ab{}", "ä".repeat(1022)));
        answer(|| Err(Failure::argument("short")));
        assert_eq!((terrella_message(), message()), (before, "short".into()));
    }
}
