//! Work in parts, on a number of threads.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc;

/// Most threads that are started.
const MAX_THREADS: usize = 64;

/// What one thread builds at a time has this many cells at most. Grids that are not larger are built in one part, and no
/// thread is started for them.
pub(super) const PART_CELLS: u64 = 1 << 16;

/// Threads that work is done on.
pub(super) struct Workers {
    threads: usize,
}

impl Workers {
    /// So many, at least one and at most 64.
    pub fn new(threads: usize) -> Self {
        Self {
            threads: threads.clamp(1, MAX_THREADS),
        }
    }

    /// What `work` answers for 0…`count`, in this order, each on the first thread that is free. `done` hears the number of each
    /// part that is finished, on the calling thread. One thread, or one part, is worked on the calling thread: none is started.
    pub fn map<T: Send>(
        &self,
        count: usize,
        work: impl Fn(usize) -> T + Sync,
        done: &mut dyn FnMut(usize),
    ) -> Vec<T> {
        let threads = self.threads.min(count);
        if threads <= 1 {
            let one = |index| {
                let answer = work(index);
                done(index);
                answer
            };
            return (0..count).map(one).collect();
        }
        let next = AtomicUsize::new(0);
        let (sender, answers) = mpsc::channel();
        let mut found: Vec<Option<T>> = std::iter::repeat_with(|| None).take(count).collect();
        std::thread::scope(|scope| {
            for _ in 0..threads {
                let (sender, next, work) = (sender.clone(), &next, &work);
                scope.spawn(move || {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        // Nobody listens where a panic on the calling thread gave the work up.
                        if index >= count || sender.send((index, work(index))).is_err() {
                            break;
                        }
                    }
                });
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
    fn answers_stand_in_order_and_each_is_told_once() {
        for threads in [0, 1, 2, 5, 200] {
            let mut told = Vec::new();
            let answers = Workers::new(threads).map(37, |k| k * k, &mut |k| told.push(k));
            assert_eq!(answers, (0..37).map(|k| k * k).collect::<Vec<_>>());
            told.sort_unstable();
            assert_eq!(told, (0..37).collect::<Vec<_>>());
        }
        assert!(Workers::new(3).map(0, |k| k, &mut |_| ()).is_empty());
    }
}
