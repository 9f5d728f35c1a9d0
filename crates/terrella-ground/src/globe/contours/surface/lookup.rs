//! Lookup tables of fixed size: a set-associative cache and a hash map. Nothing is allocated in a frame.

/// Ways of a set: an entry may be in any of this number of adjacent places.
const WAYS: usize = 8;

/// Hashes a key.
fn mix(key: u64) -> u64 {
    let key = (key ^ (key >> 31)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    key ^ (key >> 29)
}

#[derive(Clone, Copy)]
struct Entry<T> {
    key: u64,
    used: u64,
    value: T,
}

/// A cache of values by key; of eight entries in one set, the least recently used one is evicted.
pub struct SetCache<T> {
    entries: Vec<Entry<T>>,
}

impl<T: Copy + Default> SetCache<T> {
    /// Allocates room for 2^`bits` entries.
    pub fn new(bits: u32) -> Self {
        let empty = Entry {
            key: u64::MAX,
            used: 0,
            value: T::default(),
        };
        Self {
            entries: vec![empty; 1 << bits],
        }
    }

    fn set(&mut self, key: u64) -> &mut [Entry<T>] {
        let at = (mix(key) as usize % (self.entries.len() / WAYS)) * WAYS;
        &mut self.entries[at..at + WAYS]
    }

    /// The value of a key, if it is still cached. `now` increases from frame to frame.
    pub fn get(&mut self, key: u64, now: u64) -> Option<T> {
        let entry = self.set(key).iter_mut().find(|entry| entry.key == key)?;
        entry.used = now;
        Some(entry.value)
    }

    /// Stores a value.
    pub fn put(&mut self, key: u64, now: u64, value: T) {
        let set = self.set(key);
        let place = set
            .iter()
            .position(|entry| entry.key == key)
            .or_else(|| (0..WAYS).min_by_key(|k| set[*k].used))
            .unwrap_or(0);
        set[place] = Entry {
            key,
            used: now,
            value,
        };
    }

    /// Visits all entries; those for which `keep` returns false are dropped.
    pub fn retain(&mut self, mut keep: impl FnMut(u64, &mut T) -> bool) {
        for entry in &mut self.entries {
            if entry.key != u64::MAX && !keep(entry.key, &mut entry.value) {
                entry.key = u64::MAX;
            }
        }
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.entries[..]) as u64
    }
}

/// A hash map of keys to numbers that can be cleared at once.
pub struct KeyMap {
    slots: Vec<(u64, u32, u32)>,
    round: u32,
    count: usize,
}

impl KeyMap {
    /// Allocates 2^`bits` slots, of which half may be used.
    pub fn new(bits: u32) -> Self {
        Self {
            slots: vec![(0, 0, 0); 1 << bits],
            round: 1,
            count: 0,
        }
    }

    /// Removes all keys.
    pub fn clear(&mut self) {
        self.round = self.round.wrapping_add(1);
        self.count = 0;
        if self.round == 0 {
            self.slots.fill((0, 0, 0));
            self.round = 1;
        }
    }

    fn find(&self, key: u64) -> usize {
        let mask = self.slots.len() - 1;
        let mut at = mix(key) as usize & mask;
        while self.slots[at].1 == self.round && self.slots[at].0 != key {
            at = (at + 1) & mask;
        }
        at
    }

    /// The number of a key.
    pub fn get(&self, key: u64) -> Option<u32> {
        let slot = self.slots[self.find(key)];
        (slot.1 == self.round).then_some(slot.2)
    }

    /// Sets the number of a key; false if there is no room.
    pub fn set(&mut self, key: u64, value: u32) -> bool {
        let at = self.find(key);
        if self.slots[at].1 != self.round {
            if 2 * self.count >= self.slots.len() {
                return false;
            }
            self.count += 1;
        }
        self.slots[at] = (key, self.round, value);
        true
    }

    /// Number of keys.
    pub fn len(&self) -> usize {
        self.count
    }

    /// Memory, bytes.
    pub fn bytes(&self) -> u64 {
        size_of_val(&self.slots[..]) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_hold_what_was_set_until_cleared() {
        let mut keys = KeyMap::new(10);
        for round in 0..3u32 {
            for k in 0..512u64 {
                assert!(keys.set(k << 33, k as u32 + round));
            }
            assert!(!keys.set(7, 7));
            assert!((0..512u64).all(|k| keys.get(k << 33) == Some(k as u32 + round)));
            assert_eq!((keys.get(3), keys.len()), (None, 512));
            keys.clear();
            assert_eq!((keys.get(0), keys.len()), (None, 0));
        }
    }

    #[test]
    fn a_cache_forgets_the_longest_unused() {
        let mut cache = SetCache::<u64>::new(6);
        for k in 0..1_000u64 {
            cache.put(k, k, 2 * k);
            assert_eq!(cache.get(k, k), Some(2 * k));
            assert_eq!(cache.get(0, k), if k < 1_000 { Some(0) } else { None });
        }
        assert!(
            (0..1_000)
                .filter(|k| cache.get(*k, 1_000).is_some())
                .count()
                <= 64
        );
    }
}
