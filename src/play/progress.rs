//! How long work tells how far it is.

/// Told how far work is. The command shows bars; `()` shows nothing.
pub trait Progress: Sync {
    /// Work begins; `steps` is how many there will be, where that is known.
    fn begin(&self, what: &str, steps: Option<u64>);
    /// One step is done.
    fn step(&self);
    /// The work that was begun last is over.
    fn end(&self);
}

impl Progress for () {
    fn begin(&self, _what: &str, _steps: Option<u64>) {}
    fn step(&self) {}
    fn end(&self) {}
}
