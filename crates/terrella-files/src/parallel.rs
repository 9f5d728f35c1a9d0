//! Work distributed over the cores, or done in sequence in a single-threaded program such as a web page.

pub use platform::{HAS_THREADS, ThreadSend, ThreadSync, join, map_on};

/// Results of `f` for 0…`count`, in order, on as many threads as the machine has cores: see [`map_on`].
pub fn map<T: ThreadSend>(count: usize, f: impl Fn(usize) -> T + ThreadSync) -> Vec<T> {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    map_on(cores, count, f)
}

#[cfg(not(target_family = "wasm"))]
mod platform {
    use std::sync::atomic::{AtomicUsize, Ordering};
    use std::thread::ScopedJoinHandle;

    /// Whether a program can start threads on this platform.
    pub const HAS_THREADS: bool = true;

    /// `Send` where there are threads, as `wgpu::WasmNotSend` is: GPU objects of a web page stay on its thread.
    pub trait ThreadSend: Send {}
    impl<T: Send + ?Sized> ThreadSend for T {}

    /// `Sync` where there are threads, as `wgpu::WasmNotSync` is.
    pub trait ThreadSync: Sync {}
    impl<T: Sync + ?Sized> ThreadSync for T {}

    /// Results of `f` for 0…`count`, in order, computed by at most `threads` threads, each of which takes the next item. Panics of `f` are
    /// propagated.
    pub fn map_on<T: ThreadSend>(
        threads: usize,
        count: usize,
        f: impl Fn(usize) -> T + ThreadSync,
    ) -> Vec<T> {
        let threads = threads.min(count);
        if threads < 2 {
            return (0..count).map(f).collect();
        }
        let next = AtomicUsize::new(0);
        let work = || {
            let mut made = Vec::new();
            loop {
                let n = next.fetch_add(1, Ordering::Relaxed);
                if n >= count {
                    return made;
                }
                made.push((n, f(n)));
            }
        };
        let mut made: Vec<(usize, T)> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
            threads.into_iter().flat_map(joined).collect()
        });
        made.sort_by_key(|(n, _)| *n);
        made.into_iter().map(|(_, value)| value).collect()
    }

    /// Results of both. `beside` runs on another thread, or before `here` if there is none, and so must not wait for it.
    pub fn join<A: ThreadSend, B>(
        beside: impl FnOnce() -> A + ThreadSend,
        here: impl FnOnce() -> B,
    ) -> (A, B) {
        std::thread::scope(|scope| {
            let thread = scope.spawn(beside);
            let here = here();
            (joined(thread), here)
        })
    }

    fn joined<T>(thread: ScopedJoinHandle<'_, T>) -> T {
        let made = thread.join();
        made.unwrap_or_else(|panic| std::panic::resume_unwind(panic))
    }
}

// Documented above.
#[cfg(target_family = "wasm")]
#[allow(missing_docs)]
mod platform {
    pub const HAS_THREADS: bool = false;

    pub trait ThreadSend {}
    impl<T: ?Sized> ThreadSend for T {}

    pub trait ThreadSync {}
    impl<T: ?Sized> ThreadSync for T {}

    pub fn map_on<T>(_: usize, count: usize, f: impl Fn(usize) -> T) -> Vec<T> {
        (0..count).map(f).collect()
    }

    pub fn join<A, B>(beside: impl FnOnce() -> A, here: impl FnOnce() -> B) -> (A, B) {
        let beside = beside();
        (beside, here())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Barrier;
    use std::sync::mpsc;

    #[test]
    fn results_are_in_order_however_many_threads_work() {
        let expected: Vec<usize> = (0..100).map(|n| n * n).collect();
        for threads in [0, 1, 2, 7, 1000] {
            assert_eq!(map_on(threads, 100, |n| n * n), expected, "{threads}");
        }
        assert!(map(0, |n| n).is_empty());
    }

    #[test]
    fn threads_work_at_the_same_time() {
        // Each waits for the others: one thread alone would wait forever.
        let together = Barrier::new(3);
        map_on(3, 3, |_| together.wait());
        let (send, receive) = mpsc::channel();
        let (_, received) = join(move || send.send(7), || receive.recv());
        assert_eq!(received, Ok(7));
    }

    #[test]
    fn panics_are_passed_on() {
        let panics = |n: usize| assert!(n != 5, "five");
        assert!(std::panic::catch_unwind(|| map_on(2, 10, panics)).is_err());
        assert!(std::panic::catch_unwind(|| join(|| panics(5), || ())).is_err());
    }
}
