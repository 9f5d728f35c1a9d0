//! How far down heights that are not there were asked for: noted by whoever reads, in any number of threads, without waiting.
//!
//! That the next finer tile is asked for, its coarser one notes ([`Node::wanted`](super::Node)), and that is never lost. What is
//! noted here are the tiles beneath it, so that all of them are loaded at once: of a table that is full, or noted by two threads in
//! the same moment, some are lost, and asked for again when heights have changed there.

use super::HeightTileKey;
use crate::elevation::floor::floor;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Keys that are held.
const SLOTS: usize = 4096;
/// Places that a key may have.
const TRIES: usize = 4;
/// Eyes that are known; more than those see what these do, or wait for one tile after another.
const EYES: usize = 4;

const PRESENT: u64 = 1 << 63;
const IS_ANY: u64 = 1 << 62;
/// It has been taken, and stays so that it is not noted again as long as heights are the same.
const TAKEN: u64 = 1 << 61;

/// An eye as heights see it: good enough to say how fine a tile might be asked for.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::elevation) struct NearEye {
    /// Geodetic, radians.
    pub lat_rad: f64,
    /// Geodetic, radians.
    pub lon_rad: f64,
    /// Above all ground, radians of the Earth's radius.
    pub height_rad: f64,
    /// Samples that are seen smaller need not be finer, radians.
    pub tolerance_rad: f64,
}

/// The table.
pub(in crate::elevation) struct Wants {
    keys: Vec<AtomicU64>,
    has_any: AtomicBool,
    eyes: [[AtomicU64; 4]; EYES],
    eye_count: AtomicU32,
}

impl Wants {
    pub fn new() -> Self {
        Self {
            keys: (0..SLOTS).map(|_| AtomicU64::new(0)).collect(),
            has_any: AtomicBool::new(false),
            eyes: Default::default(),
            eye_count: AtomicU32::new(0),
        }
    }

    /// Notes a tile that is not there, nor perhaps those over it.
    #[inline]
    pub fn note(&self, key: HeightTileKey, is_any: bool) {
        let packed = PRESENT
            | if is_any { IS_ANY } else { 0 }
            | u64::from(key.level) << 56
            | u64::from(key.column) << 28
            | u64::from(key.row);
        let mixed = packed.wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let first = (mixed >> 40) as usize;
        for k in 0..TRIES {
            let slot = &self.keys[(first + k) % SLOTS];
            let held = slot.load(Ordering::Relaxed);
            if held & !TAKEN == packed {
                return;
            }
            if held == 0 {
                slot.store(packed, Ordering::Relaxed);
                self.has_any.store(true, Ordering::Release);
                return;
            }
        }
    }

    /// Hands over at most so many of the keys, each once.
    pub fn take(&self, most: usize, mut each: impl FnMut(HeightTileKey, bool)) {
        if !self.has_any.swap(false, Ordering::Acquire) {
            return;
        }
        let mut left = most;
        for slot in &self.keys {
            let packed = slot.load(Ordering::Relaxed);
            if packed == 0 || packed & TAKEN != 0 {
                continue;
            }
            if left == 0 {
                self.has_any.store(true, Ordering::Relaxed);
                return;
            }
            left -= 1;
            slot.store(packed | TAKEN, Ordering::Relaxed);
            let key = HeightTileKey {
                level: (packed >> 56 & 0x1f) as u8,
                column: (packed >> 28 & 0x0fff_ffff) as u32,
                row: (packed & 0x0fff_ffff) as u32,
            };
            each(key, packed & IS_ANY != 0);
        }
    }

    /// Forgets what was taken: heights are others, and what is asked for now may be too.
    pub fn forget_taken(&self) {
        for slot in &self.keys {
            if slot.load(Ordering::Relaxed) & TAKEN != 0 {
                slot.store(0, Ordering::Relaxed);
            }
        }
    }

    /// Whether there are any that have not been taken.
    pub fn has_any(&self) -> bool {
        self.has_any.load(Ordering::Relaxed)
    }

    /// Who looks from now on.
    pub fn look(&self, eyes: impl Iterator<Item = NearEye>) {
        let mut count = 0;
        for (eye, held) in eyes.zip(&self.eyes) {
            let numbers = [eye.lat_rad, eye.lon_rad, eye.height_rad, eye.tolerance_rad];
            for (held, number) in held.iter().zip(numbers) {
                held.store(number.to_bits(), Ordering::Relaxed);
            }
            count += 1;
        }
        self.eye_count.store(count, Ordering::Relaxed);
    }

    /// About how fine a level some eye sees at a place; 0, the finest, where nobody looks.
    pub fn level_seen(&self, lat_rad: f64, lon_rad: f64, finest_rad: f64) -> u8 {
        let count = self.eye_count.load(Ordering::Relaxed) as usize;
        let mut least = f64::INFINITY;
        for eye in &self.eyes[..count.min(EYES)] {
            let [lat, lon, height_rad, tolerance_rad] =
                [0, 1, 2, 3].map(|k| f64::from_bits(eye[k].load(Ordering::Relaxed)));
            let turns = (lon_rad - lon) * (1.0 / TAU);
            let aside = (turns - floor(turns + 0.5)) * TAU;
            // Degrees of longitude are shorter away from the equator: a wide bound, 1 − φ²/2 ≤ cos φ.
            let shorter = (1.0 - 0.5 * lat_rad * lat_rad).max(0.0);
            let (up, across) = (lat_rad - lat, aside * shorter);
            let away_rad = (up * up + across * across + height_rad * height_rad).sqrt();
            least = least.min(tolerance_rad * away_rad);
        }
        if count == 0 {
            return 0;
        }
        // A tile shows where the samples in its place, twice as wide, are seen larger than the tolerance.
        let steps = least / finest_rad;
        let level = (steps.to_bits() >> 52).saturating_sub(1023);
        if steps > 1.0 { level.min(31) as u8 } else { 0 }
    }
}
