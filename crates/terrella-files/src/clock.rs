//! The monotonic clock of every platform. The standard library's panics in a web page; this one asks the page there.

pub use web_time::Instant;
