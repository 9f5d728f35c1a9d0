//! The monotonic clock of every platform. The standard library's panics in a web page, where the page's clock is used.

pub use web_time::Instant;
