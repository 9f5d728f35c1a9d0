//! Depth of requests for missing tiles. Readers record it from any number of threads without waiting.
//!
//! A request for the next finer tile is recorded in its parent ([`Node::wanted`](super::Node)) and is never lost. This table records the tiles below
//! it, so that all of them load at once. A full table, or two threads that write at the same moment, may lose some requests. They are repeated once
//! heights have changed there.

use super::HeightTileKey;
use crate::elevation::floor::floor;
use std::f64::consts::TAU;
use std::sync::atomic::{AtomicBool, AtomicU32, AtomicU64, Ordering};

/// Capacity in keys.
const SLOTS: usize = 4096;
/// Probes per key.
const TRIES: usize = 4;
/// Maximum number of known eyes. Further eyes use the result of these, or wait for one tile after
/// another.
const EYES: usize = 4;

const PRESENT: u64 = 1 << 63;
const IS_ANY: u64 = 1 << 62;
/// A key that was taken. It stays, so that it is not recorded again while heights are unchanged.
const TAKEN: u64 = 1 << 61;

/// An eye as seen from heights: accurate enough to estimate the level of detail requested.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::elevation) struct NearEye {
    /// Geodetic, radians.
    pub lat_rad: f64,
    /// Geodetic, radians.
    pub lon_rad: f64,
    /// Height above all ground, as an angle at the Earth's radius, radians.
    pub height_rad: f64,
    /// Samples that appear smaller than this need no refinement, radians.
    pub tolerance_rad: f64,
}

/// The request table.
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

    /// Records a missing tile whose ancestors may be missing too.
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

    /// Passes on at most `most` keys, each once.
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

    /// Forgets taken keys: heights changed, so requests may have changed too.
    pub fn forget_taken(&self) {
        for slot in &self.keys {
            if slot.load(Ordering::Relaxed) & TAKEN != 0 {
                slot.store(0, Ordering::Relaxed);
            }
        }
    }

    /// Whether any keys have not been taken.
    pub fn has_any(&self) -> bool {
        self.has_any.load(Ordering::Relaxed)
    }

    /// Sets the eyes from now on.
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

    /// Approximate level of detail that an eye can see at a place; 0, the finest, without eyes.
    pub fn level_seen(&self, lat_rad: f64, lon_rad: f64, finest_rad: f64) -> u8 {
        let count = self.eye_count.load(Ordering::Relaxed) as usize;
        let mut least = f64::INFINITY;
        for eye in &self.eyes[..count.min(EYES)] {
            let [lat, lon, height_rad, tolerance_rad] =
                [0, 1, 2, 3].map(|k| f64::from_bits(eye[k].load(Ordering::Relaxed)));
            let turns = (lon_rad - lon) * (1.0 / TAU);
            let aside = (turns - floor(turns + 0.5)) * TAU;
            // Degrees of longitude are shorter away from the equator: a loose bound, 1 − φ²/2 ≤ cos
            // φ.
            let shorter = (1.0 - 0.5 * lat_rad * lat_rad).max(0.0);
            let (up, across) = (lat_rad - lat, aside * shorter);
            let away_rad = (up * up + across * across + height_rad * height_rad).sqrt();
            least = least.min(tolerance_rad * away_rad);
        }
        if count == 0 {
            return 0;
        }
        // A tile is visible where its parent's samples, twice as wide, appear larger than the tolerance.
        let steps = least / finest_rad;
        let level = (steps.to_bits() >> 52).saturating_sub(1023);
        if steps > 1.0 { level.min(31) as u8 } else { 0 }
    }
}
