//! Cost of frames: the time that this program and the device work on each, without waiting for the screen.

use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, JoinHandle};
use std::time::{Duration, Instant};

/// Longest wait for one frame: a device that hangs must not hang this thread.
const POLL_TIMEOUT: Duration = Duration::from_secs(1);

/// Times frames to their completion on the device.
///
/// A thread waits for each submission. A frame's cost is the time from its beginning, or from the completion of the
/// frame before if that was later, to its own completion: the device works on one frame after the other.
pub struct FrameCosts {
    frames: Option<Sender<(Instant, wgpu::SubmissionIndex)>>,
    costs_ms: Receiver<f64>,
    thread: Option<JoinHandle<()>>,
}

impl FrameCosts {
    /// Starts the thread.
    pub fn new(device: &wgpu::Device) -> std::io::Result<Self> {
        let (frames, to_time) = channel();
        let (to_caller, costs_ms) = channel();
        let device = device.clone();
        let thread = Builder::new()
            .name("terrella frame costs".into())
            .spawn(move || time_frames(&device, &to_time, &to_caller))?;
        Ok(Self {
            frames: Some(frames),
            costs_ms,
            thread: Some(thread),
        })
    }

    /// Has a frame timed that began then and was submitted so.
    pub fn time(&self, begin: Instant, submission: wgpu::SubmissionIndex) {
        if let Some(frames) = &self.frames {
            // The thread ends early only with the device.
            let _ = frames.send((begin, submission));
        }
    }

    /// Costs of frames that were completed since the last call, milliseconds, in their order. Never waits.
    pub fn completed_ms(&self) -> impl Iterator<Item = f64> + '_ {
        self.costs_ms.try_iter()
    }
}

impl Drop for FrameCosts {
    fn drop(&mut self) {
        self.frames = None;
        if let Some(thread) = self.thread.take() {
            // It panics nowhere; if it did, the message was printed then.
            let _ = thread.join();
        }
    }
}

fn time_frames(
    device: &wgpu::Device,
    frames: &Receiver<(Instant, wgpu::SubmissionIndex)>,
    costs_ms: &Sender<f64>,
) {
    let mut last_done = None;
    for (begin, submission) in frames {
        let waited = device.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: Some(POLL_TIMEOUT),
        });
        let done = Instant::now();
        let from = last_done.map_or(begin, |last: Instant| begin.max(last));
        last_done = Some(done);
        // A frame that takes longer than the time-out is reported too, with the time-out.
        let is_timed = matches!(waited, Ok(_) | Err(wgpu::PollError::Timeout));
        let cost = done.saturating_duration_since(from);
        if !is_timed || costs_ms.send(cost.as_secs_f64() * 1e3).is_err() {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::GpuContext;

    #[test]
    fn every_frame_is_timed_once_and_the_thread_ends() {
        let Ok(gpu) = pollster::block_on(GpuContext::open(None)) else {
            eprintln!("SKIPPED: no adapter; `cargo xtask prepare` installs a software one");
            return;
        };
        let costs = FrameCosts::new(&gpu.device).expect("a thread");
        for _ in 0..5 {
            let begin = Instant::now();
            costs.time(begin, gpu.queue.submit([]));
        }
        let mut seen = Vec::new();
        let deadline = Instant::now() + Duration::from_secs(20);
        while seen.len() < 5 && Instant::now() < deadline {
            seen.extend(costs.completed_ms());
            std::thread::sleep(Duration::from_millis(2));
        }
        assert_eq!(seen.len(), 5);
        assert!(
            seen.iter().all(|cost| (0.0..5_000.0).contains(cost)),
            "{seen:?}"
        );
        drop(costs);
    }
}
