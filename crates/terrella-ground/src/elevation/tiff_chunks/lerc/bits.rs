//! Bytes of a LERC blob, and integers packed into the fewest bits (`BitStuffer2` of the reference implementation).

use super::LercError;

/// Bytes that are still unread.
pub(super) struct Bytes<'a>(pub &'a [u8]);

impl<'a> Bytes<'a> {
    pub fn take(&mut self, count: usize) -> Result<&'a [u8], LercError> {
        let (taken, rest) = self
            .0
            .split_at_checked(count)
            .ok_or(LercError::Damaged("the data end too early"))?;
        self.0 = rest;
        Ok(taken)
    }

    pub fn array<const N: usize>(&mut self) -> Result<[u8; N], LercError> {
        let mut array = [0; N];
        array.copy_from_slice(self.take(N)?);
        Ok(array)
    }

    pub fn u8(&mut self) -> Result<u8, LercError> {
        Ok(self.array::<1>()?[0])
    }

    pub fn i32(&mut self) -> Result<i32, LercError> {
        Ok(i32::from_le_bytes(self.array()?))
    }

    pub fn f64(&mut self) -> Result<f64, LercError> {
        Ok(f64::from_le_bytes(self.array()?))
    }

    /// Packed integers: a byte of options, their count, and either the numbers or indices into a table.
    pub fn packed(&mut self, most: usize) -> Result<Vec<u32>, LercError> {
        let options = self.u8()?;
        let count = match options >> 6 {
            0 => u32::from_le_bytes(self.array()?),
            1 => u32::from(u16::from_le_bytes(self.array()?)),
            2 => u32::from(self.u8()?),
            _ => return Err(LercError::Damaged("a count of unknown width")),
        };
        let count = count as usize;
        if count > most {
            return Err(LercError::Damaged("more packed numbers than pixels"));
        }
        let bits = u32::from(options & 31);
        if options & 32 == 0 {
            return self.unpack(count, bits);
        }
        // The first table entry is 0 and is not stored.
        let stored = usize::from(self.u8()?)
            .checked_sub(1)
            .filter(|stored| *stored > 0 && bits > 0)
            .ok_or(LercError::Damaged("an empty table of numbers"))?;
        let mut table = vec![0];
        table.extend(self.unpack(stored, bits)?);
        let places = self.unpack(count, stored.ilog2() + 1)?;
        let number = |place: u32| table.get(place as usize).copied();
        let numbers = places.into_iter().map(number).collect::<Option<_>>();
        numbers.ok_or(LercError::Damaged("a place beyond the table of numbers"))
    }

    /// Numbers of `bits` bits, at most 31, the lowest bit first.
    fn unpack(&mut self, count: usize, bits: u32) -> Result<Vec<u32>, LercError> {
        let bytes = self.take((count * bits as usize).div_ceil(8))?;
        let (mut held, mut held_bits, mut rest) = (0_u64, 0, bytes.iter());
        let mut numbers = Vec::with_capacity(count);
        for _ in 0..count {
            while held_bits < bits {
                let byte = rest.next().copied().unwrap_or(0);
                held |= u64::from(byte) << held_bits;
                held_bits += 8;
            }
            // Below 2^31.
            numbers.push((held & ((1 << bits) - 1)) as u32);
            held >>= bits;
            held_bits -= bits;
        }
        Ok(numbers)
    }
}

/// Bits of 32-bit words, the highest bit first. Zeros follow the end, because the reference implementation reads one word
/// ahead.
pub(super) struct Words<'a> {
    bytes: &'a [u8],
    at_bit: usize,
}

impl<'a> Words<'a> {
    pub fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at_bit: 0 }
    }

    /// The next bit; `None` after the last word.
    pub fn bit(&mut self) -> Option<u32> {
        let (word, bit) = (self.at_bit / 32, self.at_bit % 32);
        // Words are little-endian.
        let byte = self.bytes.get(word * 4 + 3 - bit / 8)?;
        self.at_bit += 1;
        Some(u32::from(byte >> (7 - bit % 8)) & 1)
    }

    /// The next bits, at most 32, as a number.
    pub fn number(&mut self, bits: u32) -> Option<u32> {
        let mut number = 0;
        for _ in 0..bits {
            number = number << 1 | self.bit()?;
        }
        Some(number)
    }

    /// Bytes of all words started so far.
    pub fn used_bytes(&self) -> usize {
        self.at_bit.div_ceil(32) * 4
    }
}
