//! Progress of long work, and the wish to stop it.

/// Receives the progress of long work, and decides whether to continue. The command shows progress bars; `()` shows nothing and never stops.
pub trait Progress: Sync {
    /// Work begins; `steps` is how many there will be, where that is known.
    fn begin(&self, what: &str, steps: Option<u64>);
    /// One step is done.
    fn step(&self);
    /// The work that was begun last is over.
    fn end(&self);
    /// A message about the work for the user, before or after it.
    fn say(&self, line: &str) {
        let _ = line;
    }
    /// True once the work is no longer wanted: it stops at the next step and leaves nothing unfinished behind.
    fn cancelled(&self) -> bool {
        false
    }
}

impl Progress for () {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn end(&self) {}
}
