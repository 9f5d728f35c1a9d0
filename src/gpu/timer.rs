//! Times that the device itself writes: how long a pass takes on it, and a part of the pass.

use std::cell::Cell;

/// Why times could not be read.
#[derive(Debug, thiserror::Error)]
#[error("the device's times could not be read back: {0}")]
pub struct TimerError(String);

/// Three timestamps of one pass: its beginning, a mark somewhere in it, its end.
pub struct GpuTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_back: wgpu::Buffer,
    /// Milliseconds of one tick.
    tick_ms: f64,
    can_mark: bool,
    /// Whether the pass that was begun last has been marked: a query that was not written must not be waited for.
    is_marked: Cell<bool>,
}

/// What a [`GpuTimer`] read.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassTimes {
    /// The whole pass, milliseconds.
    pub pass_ms: f64,
    /// From its beginning to the mark, milliseconds; `None` where none was set or the device cannot mark inside a pass.
    pub until_mark_ms: Option<f64>,
}

const BEGIN: u32 = 0;
const END: u32 = 1;
const MARK: u32 = 2;
const COUNT: u32 = 3;
const BYTES: u64 = COUNT as u64 * wgpu::QUERY_SIZE as u64;

impl GpuTimer {
    /// What it can use of a device: the first is needed, the second only for the mark.
    pub const FEATURES: wgpu::Features =
        wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES);

    /// A timer; `None` where the device was opened without `TIMESTAMP_QUERY`.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        let has = device.features();
        if !has.contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Use;
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("terrella times"),
                ty: wgpu::QueryType::Timestamp,
                count: COUNT,
            }),
            resolved: buffer("terrella times", Use::QUERY_RESOLVE | Use::COPY_SRC),
            read_back: buffer("terrella times read back", Use::COPY_DST | Use::MAP_READ),
            tick_ms: f64::from(queue.get_timestamp_period()) * 1e-6,
            can_mark: has.contains(wgpu::Features::TIMESTAMP_QUERY_INSIDE_PASSES),
            is_marked: Cell::new(false),
        })
    }

    /// What the pass is begun with.
    pub fn pass_writes(&self) -> wgpu::RenderPassTimestampWrites<'_> {
        self.is_marked.set(false);
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(BEGIN),
            end_of_pass_write_index: Some(END),
        }
    }

    /// Marks this place in the pass, where the device can.
    pub fn mark(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.can_mark {
            pass.write_timestamp(&self.queries, MARK);
            self.is_marked.set(true);
        }
    }

    /// Has the times copied; to be called once the pass is over.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.written(), &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.read_back, 0, BYTES);
    }

    fn written(&self) -> u32 {
        if self.is_marked.get() { COUNT } else { MARK }
    }

    /// Reads what was resolved. Waits for the device.
    pub fn read(&self, device: &wgpu::Device) -> Result<PassTimes, TimerError> {
        let failed = |what: &dyn std::fmt::Display| TimerError(what.to_string());
        let (sender, receiver) = std::sync::mpsc::channel();
        self.read_back
            .map_async(wgpu::MapMode::Read, .., move |result| {
                // The receiver lives until the end of this function; if it is gone nobody waits.
                let _ = sender.send(result);
            });
        device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|e| failed(&e))?;
        receiver
            .recv()
            .map_err(|e| failed(&e))?
            .map_err(|e| failed(&e))?;
        let mapped = self
            .read_back
            .get_mapped_range(..)
            .map_err(|e| failed(&e))?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&mapped);
        drop(mapped);
        self.read_back.unmap();
        // A counter may wrap: then there is no telling.
        let since = |n: u32| {
            let ticks = ticks[n as usize].saturating_sub(ticks[BEGIN as usize]);
            ticks as f64 * self.tick_ms
        };
        Ok(PassTimes {
            pass_ms: since(END),
            until_mark_ms: self.is_marked.get().then(|| since(MARK).min(since(END))),
        })
    }
}
