//! Work in parts, on a number of threads.

use rayon::{ThreadPool, ThreadPoolBuilder};
use std::sync::{OnceLock, mpsc};

/// Most threads that are started.
const MAX_THREADS: usize = 64;

/// Largest number of cells that one thread builds at a time. Smaller grids are built in one part, and no thread is started for them.
pub(super) const PART_CELLS: u64 = 1 << 16;

/// Threads that work is done on.
pub(super) struct Workers {
    threads: usize,
    /// Started by the first work in more than one part; `None` if that failed.
    pool: OnceLock<Option<ThreadPool>>,
}

impl Workers {
    /// This number of threads, at most 64. With one or none the calling thread is used.
    pub fn new(threads: usize) -> Self {
        Self {
            threads: threads.min(MAX_THREADS),
            pool: OnceLock::new(),
        }
    }

    fn pool(&self) -> Option<&ThreadPool> {
        let start = || {
            let pool = ThreadPoolBuilder::new().num_threads(self.threads).build();
            let warn = |error| tracing::warn!("trees are built on one thread: {error}");
            pool.map_err(warn).ok()
        };
        self.pool.get_or_init(start).as_ref()
    }

    /// The results of `work` for 0…`count`, in this order for any number of threads. `done` receives the number of each finished part, on the
    /// calling thread. A single part is processed on the calling thread.
    pub fn map<T: Send>(
        &self,
        count: usize,
        work: impl Fn(usize) -> T + Sync,
        done: &mut dyn FnMut(usize),
    ) -> Vec<T> {
        let is_parallel = self.threads > 1 && count > 1;
        let Some(pool) = is_parallel.then(|| self.pool()).flatten() else {
            let one = |index| {
                let answer = work(index);
                done(index);
                answer
            };
            return (0..count).map(one).collect();
        };
        let (sender, answers) = mpsc::channel();
        let mut found: Vec<Option<T>> = std::iter::repeat_with(|| None).take(count).collect();
        pool.in_place_scope(|scope| {
            for index in 0..count {
                let (sender, work) = (sender.clone(), &work);
                // Nobody listens where a panic on the calling thread gave the work up.
                scope.spawn(move |_| drop(sender.send((index, work(index)))));
            }
            drop(sender);
            for (index, answer) in answers {
                found[index] = Some(answer);
                done(index);
            }
        });
        // All are there: a panic of a thread was passed on above.
        found.into_iter().flatten().collect()
    }
}

#[cfg(test)]
mod tests {
    use super::Workers;

    #[test]
    fn answers_stand_in_order_and_each_is_reported_once() {
        for threads in [0, 1, 2, 5, 200] {
            let mut reported = Vec::new();
            let answers = Workers::new(threads).map(37, |k| k * k, &mut |k| reported.push(k));
            assert_eq!(answers, (0..37).map(|k| k * k).collect::<Vec<_>>());
            reported.sort_unstable();
            assert_eq!(reported, (0..37).collect::<Vec<_>>());
        }
        assert!(Workers::new(3).map(0, |k| k, &mut |_| ()).is_empty());
    }
}
