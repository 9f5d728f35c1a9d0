//! Frame times, uploads and memory of a flight, and their summary.

use image::RgbaImage;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Sender, channel};
use std::thread::JoinHandle;
use std::time::Duration;
use terrella::FrameStats;
use terrella_measure::{SortedSample, jank, median};

/// Time that `prepare` may take.
const MAX_PREPARE_MS: f64 = 2.0;

/// Times of one frame.
#[derive(Clone, Copy, Debug)]
pub struct Frame {
    /// All of it, the device waited for.
    pub whole: Duration,
    /// `prepare` and the expected views before it.
    pub prepare: Duration,
    /// Processor time of the frame's thread in it.
    pub prepare_cpu: Duration,
}

/// Recorded values of each frame of a flight.
pub struct Record {
    frames_ms: Vec<f64>,
    prepare_ms: Vec<f64>,
    /// Processor time of the thread.
    prepare_cpu_ms: Vec<f64>,
    /// Without the copying of tiles.
    choosing_ms: Vec<f64>,
    texels_per_pixel: Vec<f64>,
    uploads: Vec<u64>,
    stand_ins: Vec<f64>,
    last: FrameStats,
    uploaded_before: Option<u64>,
    writer: Option<Writer>,
}

/// Writes frames as PNG in a separate thread, so that no frame waits for it.
struct Writer {
    sender: Option<Sender<RgbaImage>>,
    thread: Option<JoinHandle<()>>,
}

impl Record {
    pub fn new(name: &str, folder: Option<&Path>) -> Self {
        Self {
            frames_ms: Vec::new(),
            prepare_ms: Vec::new(),
            prepare_cpu_ms: Vec::new(),
            choosing_ms: Vec::new(),
            texels_per_pixel: Vec::new(),
            uploads: Vec::new(),
            stand_ins: Vec::new(),
            last: FrameStats::default(),
            uploaded_before: None,
            writer: folder.map(|folder| Writer::new(folder.join(name))),
        }
    }

    pub fn add(&mut self, frame: Frame, stats: &FrameStats) {
        let ms = |time: Duration| time.as_secs_f64() * 1e3;
        self.frames_ms.push(ms(frame.whole));
        self.prepare_ms.push(ms(frame.prepare));
        self.prepare_cpu_ms.push(ms(frame.prepare_cpu));
        self.choosing_ms
            .push(ms(frame.prepare.saturating_sub(stats.tile_upload)));
        if stats.texels_per_pixel > 0.0 {
            self.texels_per_pixel.push(stats.texels_per_pixel);
        }
        let uploaded = stats.tiles.uploaded_bytes;
        self.uploads
            .push(uploaded - self.uploaded_before.unwrap_or(uploaded));
        self.uploaded_before = Some(uploaded);
        let draws = stats.tiles.hits + stats.tiles.fallbacks;
        if draws > 0 {
            self.stand_ins
                .push(f64::from(stats.tiles.fallbacks) / f64::from(draws));
        }
        self.last = *stats;
    }

    pub fn keeps_frames(&self) -> bool {
        self.writer.is_some()
    }

    pub fn keep(&mut self, frame: RgbaImage) {
        if let Some(sender) = self
            .writer
            .as_ref()
            .and_then(|writer| writer.sender.as_ref())
        {
            sender.send(frame).expect("the writer runs");
        }
    }

    pub fn print(&self, name: &str) {
        let frames = quantiles(&self.frames_ms);
        let median = median(&self.frames_ms);
        let long = self.frames_ms.iter().filter(|ms| **ms > 2.0 * median);
        let jank = jank(&self.frames_ms);
        // Our own work of those frames: choosing and copying, in the frame's own thread.
        let own = self.frames_ms.iter().zip(&self.prepare_ms);
        let own = own.filter(|(frame, prepare)| {
            **frame > 2.0 * median && **frame - **prepare <= 2.0 * median
        });
        let choosing = quantiles(&self.choosing_ms);
        let slow = self
            .choosing_ms
            .iter()
            .filter(|ms| **ms > MAX_PREPARE_MS)
            .count();
        let tiles = self.last.tiles;
        println!("\n{name}: {} frames", self.frames_ms.len());
        println!("  frame            {frames} ms");
        println!(
            "  over 2 x median  {} frames, jank sum {jank:.1} ms; {} of them only by our own prepare",
            long.count(),
            own.count()
        );
        println!("  longest          {}", self.longest());
        println!("  prepare          {} ms", quantiles(&self.prepare_ms));
        println!(
            "    less uploads   {choosing} ms, {slow} frames over {MAX_PREPARE_MS} ms{}",
            slowest(&self.choosing_ms)
        );
        let busy = self.prepare_cpu_ms.iter();
        println!(
            "    processor time {} ms, {} frames over {MAX_PREPARE_MS} ms{}",
            quantiles(&self.prepare_cpu_ms),
            busy.filter(|ms| **ms > MAX_PREPARE_MS).count(),
            slowest(&self.prepare_cpu_ms)
        );
        println!(
            "  jank of our own  {:.2} ms, by processor time {:.2} ms; were all frames else alike {:.2} ms",
            self.own_jank(&self.prepare_ms),
            self.own_jank(&self.prepare_cpu_ms),
            self.even_jank()
        );
        println!(
            "  uploaded         {:.1} MB in all, at most {:.2} MB a frame",
            tiles.uploaded_bytes as f64 / 1e6,
            self.uploads.iter().max().copied().unwrap_or(0) as f64 / 1e6
        );
        println!(
            "  stand-ins        {} of all maps of blocks",
            quantiles(&self.stand_ins)
        );
        println!("  texels a pixel   {}", quantiles(&self.texels_per_pixel));
        println!(
            "  tiles            {} loads, {} completed, {} cancelled, {} failed, {} evicted, {:.1} MB decoded",
            tiles.loads,
            tiles.completed,
            tiles.cancelled,
            tiles.failures,
            tiles.evictions,
            tiles.decoded_bytes as f64 / 1e6
        );
        println!(
            "  textures         {:.1} MB",
            self.last.texture_bytes as f64 / 1e6
        );
        match peak_mb() {
            Some(mb) => println!("  peak memory      {mb:.0} MB"),
            None => println!("  peak memory      not given by this system"),
        }
    }
}

impl Record {
    /// Jank that frames would not have if our own work took no time: of frames with their time without `prepare` plus these times of it, minus that
    /// of the frames alone. Beyond twice the flight's median in both.
    fn own_jank(&self, own_ms: &[f64]) -> f64 {
        let budget = 2.0 * median(&self.frames_ms);
        let rest = self.frames_ms.iter().zip(&self.prepare_ms);
        let rest = rest.map(|(frame, prepare)| frame - prepare);
        let beyond = |ms: f64| (ms - budget).max(0.0);
        rest.zip(own_ms)
            .map(|(rest, own)| beyond(rest + own) - beyond(rest))
            .sum()
    }

    /// Jank of frames with the median time without `prepare`, plus their own processor time: that of a machine without other load.
    fn even_jank(&self) -> f64 {
        let rest = self.frames_ms.iter().zip(&self.prepare_ms);
        let rest: Vec<_> = rest.map(|(frame, prepare)| frame - prepare).collect();
        let rest = median(&rest);
        let frames: Vec<_> = self.prepare_cpu_ms.iter().map(|own| rest + own).collect();
        jank(&frames)
    }

    /// Additional cost of this flight compared with the same without tiles.
    pub fn print_difference(&self, without: &Self, name: &str) {
        let of = |record: &Self, value: fn(&[f64]) -> f64| {
            [
                &record.frames_ms,
                &record.prepare_ms,
                &record.prepare_cpu_ms,
            ]
            .map(|ms| value(ms))
        };
        let p99 = |sample: &[f64]| SortedSample::new(sample.to_vec()).quantile(0.99);
        println!("\n{name}: tiles add, ms of frame, prepare, prepare's processor time");
        for (what, value) in [
            ("median", median as fn(&[f64]) -> f64),
            ("p99", p99),
            ("jank sum", jank),
        ] {
            let (with, without) = (of(self, value), of(without, value));
            let [frame, prepare, cpu] = [0, 1, 2].map(|n| with[n] - without[n]);
            println!("  {what:<16} {frame:.3}, {prepare:.3}, {cpu:.3}");
        }
        let own = |record: &Self| record.own_jank(&record.prepare_cpu_ms);
        println!(
            "  jank of our own  {:.2} ms by processor time ({:.2} with, {:.2} without); were all frames else alike {:.2} ms",
            own(self) - own(without),
            own(self),
            own(without),
            self.even_jank() - without.even_jank()
        );
    }

    /// The longest frames: number, duration, and our own part.
    fn longest(&self) -> String {
        let mut order: Vec<usize> = (0..self.frames_ms.len()).collect();
        order.sort_unstable_by(|a, b| self.frames_ms[*b].total_cmp(&self.frames_ms[*a]));
        let words = order.iter().take(4).map(|n| {
            format!(
                "{:.1} ms (frame {n}: choosing {:.2}, copying {:.2} ms, {:.1} MB)",
                self.frames_ms[*n],
                self.choosing_ms[*n],
                self.prepare_ms[*n] - self.choosing_ms[*n],
                self.uploads[*n] as f64 / 1e6
            )
        });
        words.collect::<Vec<_>>().join(", ")
    }
}

/// Which frames took over the limit.
fn slowest(times_ms: &[f64]) -> String {
    let slow = times_ms.iter().enumerate();
    let slow: Vec<_> = slow
        .filter(|(_, ms)| **ms > MAX_PREPARE_MS)
        .map(|(frame, ms)| format!("{ms:.1} ms in frame {frame}"))
        .take(8)
        .collect();
    match slow.is_empty() {
        true => String::new(),
        false => format!(": {}", slow.join(", ")),
    }
}

/// The process's largest memory so far, megabytes.
fn peak_mb() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))?;
    let kib: f64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kib * 1024.0 / 1e6)
}

/// Quantiles of a sample as one line.
fn quantiles(sample: &[f64]) -> String {
    let sorted = SortedSample::new(sample.to_vec());
    let [min, p50, p95, p99, max] = [0.0, 0.5, 0.95, 0.99, 1.0].map(|part| sorted.quantile(part));
    format!("{min:.3} min, {p50:.3} median, {p95:.3} p95, {p99:.3} p99, {max:.3} max")
}

impl Writer {
    fn new(folder: PathBuf) -> Self {
        std::fs::create_dir_all(&folder).expect("a folder for the frames");
        let (sender, receiver) = channel::<RgbaImage>();
        let thread = std::thread::spawn(move || {
            for (number, frame) in receiver.iter().enumerate() {
                let path = folder.join(format!("{number:06}.png"));
                frame.save(&path).expect("a frame is written");
            }
        });
        Self {
            sender: Some(sender),
            thread: Some(thread),
        }
    }
}

impl Drop for Writer {
    fn drop(&mut self) {
        drop(self.sender.take());
        if let Some(thread) = self.thread.take() {
            thread.join().expect("the writer ends well");
        }
    }
}
