//! A pool of memory that bands are taken from, so that reading waits while encoding is behind.

use std::sync::{Arc, Condvar, Mutex, MutexGuard};

/// The pool. Clones share it.
#[derive(Clone)]
pub(super) struct Pool(Arc<SharedPool>);

struct SharedPool {
    state: Mutex<PoolState>,
    changed: Condvar,
}

struct PoolState {
    free: u64,
    is_stopped: bool,
}

/// So many bytes, given back when dropped.
pub(super) struct Permit {
    pool: Pool,
    bytes: u64,
}

impl Pool {
    pub(super) fn new(bytes: u64) -> Self {
        Self(Arc::new(SharedPool {
            state: Mutex::new(PoolState {
                free: bytes,
                is_stopped: false,
            }),
            changed: Condvar::new(),
        }))
    }

    fn state(&self) -> MutexGuard<'_, PoolState> {
        // Counters are good whatever happened elsewhere.
        self.0
            .state
            .lock()
            .unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Waits for so many bytes; `None` once the work has stopped.
    pub(super) fn take(&self, bytes: u64) -> Option<Permit> {
        let mut state = self.state();
        while !state.is_stopped && state.free < bytes {
            state = self
                .0
                .changed
                .wait(state)
                .unwrap_or_else(|poisoned| poisoned.into_inner());
        }
        if state.is_stopped {
            return None;
        }
        state.free -= bytes;
        Some(Permit {
            pool: self.clone(),
            bytes,
        })
    }

    /// Ends all waiting: nothing is given any more.
    pub(super) fn stop(&self) {
        self.state().is_stopped = true;
        self.0.changed.notify_all();
    }

    /// Whether the work has been stopped.
    pub(super) fn is_stopped(&self) -> bool {
        self.state().is_stopped
    }
}

impl Drop for Permit {
    fn drop(&mut self) {
        self.pool.state().free += self.bytes;
        self.pool.0.changed.notify_all();
    }
}
