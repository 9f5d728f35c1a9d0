//! Huffman tables (T.81, annex C and F.2.2.3).

use super::Fault;
use super::bits::Bits;
use std::io::Read;

/// Codes up to this length are decoded by one table lookup.
const FAST_BITS: u32 = 9;

/// The four tables of either kind.
#[derive(Default)]
pub(super) struct Tables {
    dc: [Option<Table>; 4],
    ac: [Option<Table>; 4],
}

impl Tables {
    /// Takes a segment of definitions.
    pub fn define(&mut self, mut segment: &[u8]) -> Result<(), Fault> {
        while let [kind, rest @ ..] = segment {
            let (counts, rest) = rest.split_first_chunk::<16>().ok_or_else(wrong)?;
            let total: usize = counts.iter().map(|count| usize::from(*count)).sum();
            let (symbols, rest) = rest.split_at_checked(total).ok_or_else(wrong)?;
            let tables = match kind >> 4 {
                0 => &mut self.dc,
                1 => &mut self.ac,
                _ => return Err(wrong()),
            };
            let slot = tables.get_mut(usize::from(kind & 15)).ok_or_else(wrong)?;
            *slot = Some(Table::new(counts, symbols)?);
            segment = rest;
        }
        Ok(())
    }

    pub fn dc(&self, number: u8) -> Result<&Table, Fault> {
        Self::defined(&self.dc, number)
    }

    pub fn ac(&self, number: u8) -> Result<&Table, Fault> {
        Self::defined(&self.ac, number)
    }

    fn defined(tables: &[Option<Table>; 4], number: u8) -> Result<&Table, Fault> {
        let table = tables.get(usize::from(number)).and_then(Option::as_ref);
        table.ok_or(Fault::damaged("a scan with a table that is not there"))
    }
}

fn wrong() -> Fault {
    Fault::damaged("a wrong Huffman table")
}

/// Codes of one table.
pub(super) struct Table {
    /// Length and symbol by the next bits; length 0 for codes that are longer or invalid.
    fast: Box<[(u8, u8); 1 << FAST_BITS]>,
    /// By length: the first code, the one after the last, and the place of the first one's symbol.
    ranges: [(u32, u32, u32); 17],
    symbols: Vec<u8>,
}

impl Table {
    fn new(counts: &[u8; 16], symbols: &[u8]) -> Result<Self, Fault> {
        let mut table = Self {
            fast: Box::new([(0, 0); 1 << FAST_BITS]),
            ranges: [(0, 0, 0); 17],
            symbols: symbols.to_vec(),
        };
        let (mut code, mut place) = (0_u32, 0_u32);
        for (length, count) in (1..).zip(counts) {
            let end = code + u32::from(*count);
            if end > 1 << length {
                return Err(wrong());
            }
            table.ranges[length as usize] = (code, end, place);
            place += u32::from(*count);
            code = end << 1;
        }
        table.fill_fast();
        Ok(table)
    }

    fn fill_fast(&mut self) {
        for (prefix, entry) in (0_u32..).zip(self.fast.iter_mut()) {
            let window = (prefix << (16 - FAST_BITS)) as u16;
            let found = find(&self.ranges, window, 1..=FAST_BITS);
            if let Some((length, place)) = found {
                // At most nine.
                *entry = (length as u8, self.symbols[place]);
            }
        }
    }

    /// A short code of an AC coefficient, whose low bits count the bits that follow it: both are skipped. `None`, and nothing is skipped,
    /// where the code is longer, or the data may end first.
    #[inline]
    pub fn coefficient<R: Read>(&self, bits: &mut Bits<'_, R>) -> Result<Option<u8>, Fault> {
        let window = bits.peek_32()?;
        let (length, symbol) = self.fast[(window >> (64 - FAST_BITS)) as usize];
        let all = u32::from(length) + u32::from(symbol & 15);
        Ok((length > 0 && bits.skip(all)).then_some(symbol))
    }

    /// The next symbol; `None` where the data end first.
    #[inline]
    pub fn symbol<R: Read>(&self, bits: &mut Bits<'_, R>) -> Result<Option<u8>, Fault> {
        let window = bits.peek_16()?;
        let (length, symbol) = self.fast[usize::from(window >> (16 - FAST_BITS))];
        if length > 0 {
            return Ok(bits.skip(length.into()).then_some(symbol));
        }
        let Some((length, place)) = find(&self.ranges, window, FAST_BITS + 1..=16) else {
            // Zeros beyond the last bit may be no code.
            return match bits.skip(16) {
                true => Err(Fault::damaged("bits that are no code")),
                false => Ok(None),
            };
        };
        Ok(bits.skip(length).then_some(self.symbols[place]))
    }
}

/// The length of the code that these bits begin with, among these lengths, and its symbol's place.
fn find(
    ranges: &[(u32, u32, u32); 17],
    window: u16,
    mut lengths: std::ops::RangeInclusive<u32>,
) -> Option<(u32, usize)> {
    lengths.find_map(|length| {
        let code = u32::from(window) >> (16 - length);
        let (first, end, place) = ranges[length as usize];
        (first..end)
            .contains(&code)
            .then(|| (length, (place + code - first) as usize))
    })
}
