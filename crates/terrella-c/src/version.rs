//! The version of the interface, for the compiler and at run time.

use std::ffi::{CStr, c_char};

/// The major version of this header. A library of another major version has another soname, and before 1.0 one of another minor version.
pub const TERRELLA_VERSION_MAJOR: u32 = 0;
/// The minor version of this header.
pub const TERRELLA_VERSION_MINOR: u32 = 1;
/// The patch version of this header.
pub const TERRELLA_VERSION_PATCH: u32 = 0;

const VERSION: &CStr =
    match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
        Ok(version) => version,
        Err(_) => c"",
    };

/// The version of the loaded library, like "0.1.0". Never null; do not free it.
#[unsafe(no_mangle)]
pub extern "C" fn terrella_version() -> *const c_char {
    VERSION.as_ptr()
}
