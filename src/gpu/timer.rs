//! Timestamps that the device writes at the ends of passes.

use super::read_back::map;

/// Why timestamps could not be read.
#[derive(Debug, thiserror::Error)]
#[error("the device's times could not be read back: {0}")]
pub struct TimerError(String);

/// Timestamps before the first of a few passes and at the end of each.
///
/// No timestamp is written in the middle of a pass: a tile-based GPU reaches such a point in its last tile, when all others are finished. For the
/// same reason, none is written at the beginning of a later pass.
pub struct GpuTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    read_back: wgpu::Buffer,
    /// Duration of a tick, milliseconds.
    tick_ms: f64,
}

/// Limit of passes that are timed together.
const MAX_PASSES: u32 = 3;
const TICK_BYTES: u64 = wgpu::QUERY_SIZE as u64;

impl GpuTimer {
    /// The feature that a device must have been opened with.
    pub const FEATURES: wgpu::Features = wgpu::Features::TIMESTAMP_QUERY;

    /// A timer; `None` if the device was opened without [`Self::FEATURES`].
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        let has = device.features();
        if !has.contains(Self::FEATURES) {
            return None;
        }
        let buffer = |label, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: u64::from(MAX_PASSES + 1) * TICK_BYTES,
                usage,
                mapped_at_creation: false,
            })
        };
        use wgpu::BufferUsages as Use;
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("terrella times"),
                ty: wgpu::QueryType::Timestamp,
                count: MAX_PASSES + 1,
            }),
            resolved: buffer("terrella times", Use::QUERY_RESOLVE | Use::COPY_SRC),
            read_back: buffer("terrella times read back", Use::COPY_DST | Use::MAP_READ),
            tick_ms: f64::from(queue.get_timestamp_period()) * 1e-6,
        })
    }

    /// Timestamp writes of the `n`-th pass, from 0, at most 2.
    pub fn writes(&self, n: u32) -> wgpu::RenderPassTimestampWrites<'_> {
        wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: (n == 0).then_some(0),
            end_of_pass_write_index: Some((n + 1).min(MAX_PASSES)),
        }
    }

    /// Resolves the timestamps of the first `passes` passes. Call it after the last of them.
    pub fn resolve(&self, encoder: &mut wgpu::CommandEncoder, passes: u32) {
        // Waiting for an unwritten query would never end.
        let written = passes.min(MAX_PASSES) + 1;
        let bytes = u64::from(written) * TICK_BYTES;
        encoder.resolve_query_set(&self.queries, 0..written, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.read_back, 0, bytes);
    }

    /// Duration of each pass, milliseconds. Waits for the device.
    pub fn read(&self, device: &wgpu::Device, passes: u32) -> Result<Vec<f64>, TimerError> {
        let mapped = map(device, &self.read_back, None).map_err(TimerError)?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&mapped);
        drop(mapped);
        self.read_back.unmap();
        let passes = ticks.windows(2).take(passes.min(MAX_PASSES) as usize);
        // A counter that wrapped has no meaning.
        let span = |pair: &[u64]| pair[1].saturating_sub(pair[0]) as f64 * self.tick_ms;
        Ok(passes.map(span).collect())
    }
}
