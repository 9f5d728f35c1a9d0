//! Parser of Protocol Buffers: fields of a message are skipped or read without copies and allocations.
//!
//! Written by hand: there are a dozen messages, a third of their fields are used, and the sender is not trusted. Lengths are checked against the
//! available bytes before use; unused fields are skipped.

use std::fmt;

/// Why bytes are no message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
#[allow(missing_docs, reason = "the messages say what fields are")]
pub enum WireFault {
    /// The bytes end within a field.
    #[error("ends within a field")]
    Short,
    /// A number of more than 64 bits.
    #[error("holds a number of more than 64 bits")]
    LongNumber,
    /// Field 0, or a field of a kind that proto3 has not.
    #[error("holds a field of number {number} and kind {kind}, which proto3 does not have")]
    Field {
        number: u64,
        /// Its wire type.
        kind: u8,
    },
    /// A known field of another kind than it has.
    #[error("field {number} has a different type than Basilisk writes")]
    Kind {
        /// The field's number.
        number: u32,
    },
}

/// A field's value in its wire format.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::basilisk) enum Value<'b> {
    /// Whole numbers, truth values.
    Varint(u64),
    /// Doubles.
    Fixed64([u8; 8]),
    /// Text, messages, packed numbers.
    Bytes(&'b [u8]),
    /// Four bytes, which no field in use has.
    Fixed32,
}

/// A field of a message.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::basilisk) struct Field<'b> {
    pub number: u32,
    pub value: Value<'b>,
}

/// The fields of a message, in the order of its bytes. Ends with the first fault.
#[derive(Clone, Debug)]
pub(in crate::basilisk) struct Fields<'b> {
    rest: &'b [u8],
}

impl<'b> Fields<'b> {
    /// Of a message's bytes.
    pub fn of(bytes: &'b [u8]) -> Self {
        Self { rest: bytes }
    }

    fn take(&mut self, len: u64) -> Result<&'b [u8], WireFault> {
        let len = usize::try_from(len).map_err(|_| WireFault::Short)?;
        let (taken, rest) = self.rest.split_at_checked(len).ok_or(WireFault::Short)?;
        self.rest = rest;
        Ok(taken)
    }

    fn field(&mut self) -> Result<Field<'b>, WireFault> {
        let tag = varint(&mut self.rest)?;
        let (number, kind) = (tag >> 3, (tag & 7) as u8);
        let fault = WireFault::Field { number, kind };
        let number = match u32::try_from(number) {
            Ok(number @ 1..) => number,
            _ => return Err(fault),
        };
        let value = match kind {
            0 => Value::Varint(varint(&mut self.rest)?),
            1 => {
                let bytes = self.take(8)?;
                Value::Fixed64(bytes.try_into().map_err(|_| WireFault::Short)?)
            }
            2 => {
                let len = varint(&mut self.rest)?;
                Value::Bytes(self.take(len)?)
            }
            5 => {
                self.take(4)?;
                Value::Fixed32
            }
            _ => return Err(fault),
        };
        Ok(Field { number, value })
    }
}

impl<'b> Iterator for Fields<'b> {
    type Item = Result<Field<'b>, WireFault>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.rest.is_empty() {
            return None;
        }
        let field = self.field();
        if field.is_err() {
            self.rest = &[];
        }
        Some(field)
    }
}

/// Takes a variable-length number off the front of `bytes`.
pub fn varint(bytes: &mut &[u8]) -> Result<u64, WireFault> {
    let mut value = 0_u64;
    for shift in (0..64).step_by(7) {
        let (&byte, rest) = bytes.split_first().ok_or(WireFault::Short)?;
        *bytes = rest;
        let bits = u64::from(byte & 0x7f);
        if shift == 63 && bits > 1 {
            return Err(WireFault::LongNumber);
        }
        value |= bits << shift;
        if byte & 0x80 == 0 {
            return Ok(value);
        }
    }
    Err(WireFault::LongNumber)
}

/// Puts a variable-length number behind `bytes`.
pub fn put_varint(bytes: &mut Vec<u8>, mut value: u64) {
    while value > 0x7f {
        bytes.push(value as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

impl<'b> Field<'b> {
    fn wrong<T>(&self) -> Result<T, WireFault> {
        let number = self.number;
        Err(WireFault::Kind { number })
    }

    /// A whole number with a sign.
    pub fn whole(&self) -> Result<i64, WireFault> {
        match self.value {
            Value::Varint(value) => Ok(value.cast_signed()),
            _ => self.wrong(),
        }
    }

    /// A truth value.
    pub fn is_true(&self) -> Result<bool, WireFault> {
        Ok(self.whole()? != 0)
    }

    /// A number, finite or not.
    pub fn number(&self) -> Result<f64, WireFault> {
        match self.value {
            Value::Fixed64(bytes) => Ok(f64::from_le_bytes(bytes)),
            _ => self.wrong(),
        }
    }

    /// A message, or anything else that is bytes.
    pub fn bytes(&self) -> Result<&'b [u8], WireFault> {
        match self.value {
            Value::Bytes(bytes) => Ok(bytes),
            _ => self.wrong(),
        }
    }

    /// Text; what is not UTF-8 is replaced, and it is cut after `most` characters.
    pub fn text(&self, most: usize) -> Result<String, WireFault> {
        let bytes = self.bytes()?;
        // A character has at most four bytes: later bytes cannot be shown.
        let bytes = bytes.get(..4 * most).unwrap_or(bytes);
        let text = String::from_utf8_lossy(bytes);
        Ok(text.chars().take(most).collect())
    }
}

/// Up to `N` numbers of a repeated field, packed or one by one.
#[derive(Clone, Copy, PartialEq)]
pub struct Numbers<const N: usize> {
    values: [f64; N],
    count: usize,
}

impl<const N: usize> Default for Numbers<N> {
    fn default() -> Self {
        Self {
            values: [0.0; N],
            count: 0,
        }
    }
}

impl<const N: usize> fmt::Debug for Numbers<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.values.fmt(f)
    }
}

impl<const N: usize> Numbers<N> {
    fn push(&mut self, value: f64) {
        if let Some(slot) = self.values.get_mut(self.count) {
            *slot = value;
        }
        self.count = self.count.saturating_add(1);
    }

    /// Adds what the field holds; more than `N` are counted and not kept.
    pub fn add(&mut self, field: &Field<'_>) -> Result<(), WireFault> {
        if let Value::Fixed64(_) = field.value {
            self.push(field.number()?);
            return Ok(());
        }
        let (chunks, rest) = field.bytes()?.as_chunks::<8>();
        if !rest.is_empty() {
            return Err(WireFault::Short);
        }
        chunks
            .iter()
            .for_each(|bytes| self.push(f64::from_le_bytes(*bytes)));
        Ok(())
    }

    /// The numbers if there are `N` of them.
    pub fn all(&self) -> Option<&[f64; N]> {
        (self.count == N).then_some(&self.values)
    }
}

/// Up to `N` whole numbers of a repeated field, packed or one by one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wholes<const N: usize> {
    values: [i64; N],
    count: usize,
}

impl<const N: usize> Default for Wholes<N> {
    fn default() -> Self {
        Self {
            values: [0; N],
            count: 0,
        }
    }
}

impl<const N: usize> Wholes<N> {
    fn push(&mut self, value: i64) {
        if let Some(slot) = self.values.get_mut(self.count) {
            *slot = value;
        }
        self.count = self.count.saturating_add(1);
    }

    /// Adds what the field holds; more than `N` are counted and not kept.
    pub fn add(&mut self, field: &Field<'_>) -> Result<(), WireFault> {
        if let Value::Varint(_) = field.value {
            self.push(field.whole()?);
            return Ok(());
        }
        let mut bytes = field.bytes()?;
        while !bytes.is_empty() {
            self.push(varint(&mut bytes)?.cast_signed());
        }
        Ok(())
    }

    /// The numbers if there are `N` of them.
    pub fn all(&self) -> Option<&[i64; N]> {
        (self.count == N).then_some(&self.values)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_every_length_come_back() {
        for value in [0, 1, 127, 128, 300, u64::from(u32::MAX), u64::MAX] {
            let mut bytes = Vec::new();
            put_varint(&mut bytes, value);
            let mut rest = bytes.as_slice();
            assert_eq!(varint(&mut rest), Ok(value));
            assert!(rest.is_empty());
            let mut short = &bytes[..bytes.len() - 1];
            assert_eq!(varint(&mut short), Err(WireFault::Short));
        }
        let mut long: &[u8] = &[0xff; 11];
        assert_eq!(varint(&mut long), Err(WireFault::LongNumber));
        let mut over: &[u8] = &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 2];
        assert_eq!(varint(&mut over), Err(WireFault::LongNumber));
    }

    #[test]
    fn a_length_beyond_the_bytes_ends_the_message() {
        // Field 1, bytes, 2⁶³ of them.
        let mut bytes = vec![0x0a];
        put_varint(&mut bytes, 1 << 63);
        bytes.extend([0; 32]);
        let fields: Vec<_> = Fields::of(&bytes).collect();
        assert_eq!(fields, [Err(WireFault::Short)]);
        // A group, and field 0.
        for tag in [0x0b, 0x02] {
            let bytes = [tag, 0];
            let fields: Vec<_> = Fields::of(&bytes).collect();
            assert!(matches!(fields[..], [Err(WireFault::Field { .. })]));
        }
    }

    #[test]
    fn repeated_numbers_are_read_packed_and_one_by_one() {
        let mut packed = vec![0x12, 24];
        let mut single = Vec::new();
        for value in [1.5_f64, -2.0, f64::NAN] {
            packed.extend(value.to_le_bytes());
            single.push(0x11);
            single.extend(value.to_le_bytes());
        }
        for bytes in [packed, single] {
            let mut numbers = Numbers::<3>::default();
            for field in Fields::of(&bytes) {
                numbers.add(&field.expect("a field")).expect("numbers");
            }
            let all = numbers.all().expect("three");
            assert_eq!(all[..2], [1.5, -2.0]);
            assert!(all[2].is_nan());
        }
        let odd = [0x12, 7, 0, 0, 0, 0, 0, 0, 0];
        let field = Fields::of(&odd).next().expect("one").expect("a field");
        assert_eq!(Numbers::<3>::default().add(&field), Err(WireFault::Short));
    }
}
