//! Huffman codes of a LERC blob (`Huffman` of the reference implementation).

use super::LercError;
use super::bits::{Bytes, Words};

/// Longest code, bits.
const LONGEST: u32 = 32;

/// A code tree: each node stores the branches for 0 and 1.
pub(super) struct Codes {
    nodes: Vec<[Branch; 2]>,
}

#[derive(Clone, Copy, PartialEq)]
enum Branch {
    None,
    Node(usize),
    Value(usize),
}

impl Codes {
    /// Reads the lengths of all codes, then the codes. There are at most 256: LERC uses Huffman codes only for bytes.
    pub fn read(bytes: &mut Bytes<'_>) -> Result<Self, LercError> {
        let damaged = LercError::Damaged("a table of codes that contradicts itself");
        let (version, size) = (bytes.i32()?, bytes.i32()?);
        let (first, end) = (bytes.i32()?, bytes.i32()?);
        if version < 2 || size != 256 || first < 0 || first >= end || end - first > size {
            return Err(damaged);
        }
        // Below 2^31; checked not to be negative.
        let (first, end, size) = (first as usize, end as usize, size as usize);
        let lengths = bytes.packed(end - first)?;
        if lengths.len() != end - first {
            return Err(damaged);
        }
        let mut codes = Self {
            nodes: vec![[Branch::None; 2]],
        };
        let mut words = Words::new(bytes.0);
        for (n, length) in (first..end).zip(lengths) {
            if length > LONGEST {
                return Err(LercError::Damaged("a code of more than 32 bits"));
            }
            if length > 0 {
                let code = words.number(length);
                let code = code.ok_or(LercError::Damaged("the data end too early"))?;
                codes
                    .add(n % size, code, length)
                    .ok_or(LercError::Damaged("codes of which one begins another"))?;
            }
        }
        bytes.take(words.used_bytes())?;
        Ok(codes)
    }

    fn add(&mut self, value: usize, code: u32, length: u32) -> Option<()> {
        let mut node = 0;
        for bit in (0..length).rev() {
            let side = (code >> bit & 1) as usize;
            let next = match (self.nodes[node][side], bit) {
                (Branch::None, 0) => Branch::Value(value),
                (Branch::None, _) => {
                    self.nodes.push([Branch::None; 2]);
                    Branch::Node(self.nodes.len() - 1)
                }
                (Branch::Node(next), 1..) => Branch::Node(next),
                (Branch::Node(_) | Branch::Value(_), _) => return None,
            };
            self.nodes[node][side] = next;
            if let Branch::Node(next) = next {
                node = next;
            }
        }
        Some(())
    }

    /// The value of the next code.
    pub fn next(&self, words: &mut Words<'_>) -> Result<u8, LercError> {
        let mut node = 0;
        loop {
            let side = words
                .bit()
                .ok_or(LercError::Damaged("codes end too early"))?;
            match self.nodes[node][side as usize] {
                Branch::Node(next) => node = next,
                // Below 256.
                Branch::Value(value) => return Ok(value as u8),
                Branch::None => return Err(LercError::Damaged("an unknown code")),
            }
        }
    }
}
