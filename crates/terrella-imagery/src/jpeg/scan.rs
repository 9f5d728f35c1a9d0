//! A scan: its blocks, skipped bit by bit (T.81, F.2.2, G.1.2 and G.2).

use super::Fault;
use super::bits::{Bits, Bytes};
use super::frame::{Band, Component, Frame};
use super::huffman::{Table, Tables};
use std::io::Read;

/// A scan's header.
pub(super) struct Scan {
    /// Components with their tables for DC and AC.
    parts: Vec<ScanComponent>,
    band: Band,
    restart_interval: u32,
}

#[derive(Clone, Copy)]
struct ScanComponent {
    component: usize,
    dc: u8,
    ac: u8,
}

/// The tables of a component.
#[derive(Clone, Copy, Default)]
struct PartTables<'a> {
    dc: Option<&'a Table>,
    ac: Option<&'a Table>,
}

/// Coding of a block.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Sequential,
    DcFirst,
    DcRefine,
    AcFirst,
    AcRefine,
}

/// Position in a scan.
struct Cursor<'a, 'b, R> {
    bits: Bits<'b, R>,
    kind: Kind,
    band: Band,
    /// Tables of the block's component.
    tables: PartTables<'a>,
    /// Blocks to come that have nothing new.
    empty_blocks: u32,
}

impl Scan {
    /// Reads a header, and notes in the frame what the scan brings.
    pub fn read(header: &[u8], frame: &mut Frame, restart_interval: u32) -> Result<Self, Fault> {
        let wrong = || Fault::damaged("a wrong scan header");
        let (count, rest) = header.split_first().ok_or_else(wrong)?;
        let (listed, rest) = rest
            .split_at_checked(2 * usize::from(*count))
            .ok_or_else(wrong)?;
        let [first, last, bits] = *rest else {
            return Err(wrong());
        };
        let mut parts = Vec::new();
        for [id, tables] in listed.as_chunks::<2>().0 {
            let component = frame.components.iter().position(|c| c.id == *id);
            let component = component.ok_or_else(wrong)?;
            if parts
                .iter()
                .any(|part: &ScanComponent| part.component == component)
            {
                return Err(wrong());
            }
            parts.push(ScanComponent {
                component,
                dc: tables >> 4,
                ac: tables & 15,
            });
        }
        let band = match frame.is_progressive {
            true => Band {
                first,
                last,
                high: bits >> 4,
                low: bits & 15,
            },
            false => Band::ALL,
        };
        let is_order = match (band.first, band.last) {
            // In progressive images DC has separate scans, and AC scans have one component.
            (0, last) => last == if frame.is_progressive { 0 } else { 63 },
            (first, last) => first <= last && last < 64 && parts.len() == 1,
        };
        let refines = band.high == 0 || band.high == band.low + 1;
        if parts.is_empty() || !is_order || !refines || band.low > 13 {
            return Err(wrong());
        }
        for part in &parts {
            frame.components[part.component].take(band)?;
        }
        Ok(Self {
            parts,
            band,
            restart_interval,
        })
    }

    fn kind(&self, frame: &Frame) -> Kind {
        match (frame.is_progressive, self.band.first, self.band.high) {
            (false, ..) => Kind::Sequential,
            (true, 0, 0) => Kind::DcFirst,
            (true, 0, _) => Kind::DcRefine,
            (true, _, 0) => Kind::AcFirst,
            (true, ..) => Kind::AcRefine,
        }
    }

    /// The tables that each component needs.
    fn tables<'t>(&self, kind: Kind, tables: &'t Tables) -> Result<Vec<PartTables<'t>>, Fault> {
        let has_dc = matches!(kind, Kind::Sequential | Kind::DcFirst);
        let has_ac = matches!(kind, Kind::Sequential | Kind::AcFirst | Kind::AcRefine);
        let of_part = |part: &ScanComponent| {
            Ok(PartTables {
                dc: has_dc.then(|| tables.dc(part.dc)).transpose()?,
                ac: has_ac.then(|| tables.ac(part.ac)).transpose()?,
            })
        };
        self.parts.iter().map(of_part).collect()
    }

    /// The only component, if it is one: its coding units are its blocks.
    fn alone<'f>(&self, frame: &'f Frame) -> Option<&'f Component> {
        match self.parts.as_slice() {
            [part] => frame.components.get(part.component),
            _ => None,
        }
    }

    /// Skips all blocks, and gives the marker after them.
    pub fn walk<R: Read>(
        &self,
        frame: &mut Frame,
        tables: &Tables,
        bytes: &mut Bytes<R>,
    ) -> Result<u8, Fault> {
        let kind = self.kind(frame);
        let of_parts = self.tables(kind, tables)?;
        let mut cursor = Cursor {
            bits: Bits::new(bytes),
            kind,
            band: self.band,
            tables: PartTables::default(),
            empty_blocks: 0,
        };
        let ((columns, rows), unit_rows) = match self.alone(frame) {
            Some(one) => (one.blocks, 8 * frame.most.1 / one.sampling.1),
            None => (frame.units, 8 * frame.most.1),
        };
        let mut unit = 0_u32;
        for row in 0..rows {
            for column in 0..columns {
                let interval = self.restart_interval;
                if interval > 0 && unit > 0 && unit.is_multiple_of(interval) {
                    cursor.restart(unit / interval - 1)?;
                }
                unit += 1;
                if !self.unit(&mut cursor, frame, &of_parts, (column, row))? {
                    return Err(Fault::damaged(format!(
                        "the picture's data end at row {} of {}",
                        row * unit_rows,
                        frame.height
                    )));
                }
            }
        }
        cursor.bits.end()
    }

    /// Skips the blocks of a coding unit. False if the data end in it.
    fn unit<'t, R: Read>(
        &self,
        cursor: &mut Cursor<'t, '_, R>,
        frame: &mut Frame,
        of_parts: &[PartTables<'t>],
        (column, row): (u32, u32),
    ) -> Result<bool, Fault> {
        let is_alone = self.parts.len() == 1;
        for (part, tables) in self.parts.iter().zip(of_parts) {
            cursor.tables = *tables;
            let component = &mut frame.components[part.component];
            let (across, down) = if is_alone { (1, 1) } else { component.sampling };
            for n in 0..across * down {
                let place =
                    (row * down + n / across) * component.stride + (column * across + n % across);
                let nonzero = component.nonzero.get_mut(place as usize);
                if !cursor.block(nonzero)? {
                    return Ok(false);
                }
            }
        }
        Ok(true)
    }
}

impl<R: Read> Cursor<'_, '_, R> {
    /// The restart marker of this number must follow.
    fn restart(&mut self, number: u32) -> Result<(), Fault> {
        self.empty_blocks = 0;
        let marker = self.bits.end()?;
        if u32::from(marker) == 0xD0 + number % 8 {
            return Ok(());
        }
        Err(Fault::damaged(format!(
            "marker {marker:02X} stands where restart marker {} must be",
            number % 8
        )))
    }

    /// Skips a block. False if the data end in it.
    fn block(&mut self, nonzero: Option<&mut u64>) -> Result<bool, Fault> {
        let done = match self.kind {
            Kind::Sequential => self.sequential(),
            Kind::DcFirst => self.dc(),
            Kind::DcRefine => self.take(1),
            Kind::AcFirst => self.ac_first(nonzero),
            Kind::AcRefine => self.ac_refine(nonzero),
        };
        Ok(done?.is_some())
    }

    fn take(&mut self, count: u8) -> Result<Option<u32>, Fault> {
        self.bits.take(count.into())
    }

    /// A symbol of AC, as the zeros before a coefficient and its bits.
    fn ac_symbol(&mut self) -> Result<Option<(u8, u8)>, Fault> {
        let Some(table) = self.tables.ac else {
            return Ok(None);
        };
        let symbol = table.symbol(&mut self.bits)?;
        Ok(symbol.map(|symbol| (symbol >> 4, symbol & 15)))
    }

    fn dc(&mut self) -> Result<Option<u32>, Fault> {
        let Some(table) = self.tables.dc else {
            return Ok(None);
        };
        let Some(size) = table.symbol(&mut self.bits)? else {
            return Ok(None);
        };
        if size > 16 {
            return Err(Fault::damaged("a difference of more than 16 bits"));
        }
        self.take(size)
    }

    fn sequential(&mut self) -> Result<Option<u32>, Fault> {
        if self.dc()?.is_none() {
            return Ok(None);
        }
        let Some(table) = self.tables.ac else {
            return Ok(None);
        };
        let mut at = 1;
        while at < 64 {
            let coefficient = table.coefficient(&mut self.bits)?;
            let symbol = match coefficient {
                Some(symbol) => symbol,
                None => match table.symbol(&mut self.bits)? {
                    Some(symbol) => symbol,
                    None => return Ok(None),
                },
            };
            match (symbol >> 4, symbol & 15) {
                (15, 0) => at += 16,
                // End of block.
                (_, 0) => break,
                (zeros, size) => {
                    at += zeros + 1;
                    if at > 64 {
                        return Err(beyond());
                    }
                    if coefficient.is_none() && self.take(size)?.is_none() {
                        return Ok(None);
                    }
                }
            }
        }
        Ok(Some(0))
    }

    /// The number of blocks that end with this one.
    fn end_of_band(&mut self, size: u8) -> Result<Option<u32>, Fault> {
        let more = self.take(size)?;
        Ok(more.map(|more| (1 << size) + more))
    }

    fn ac_first(&mut self, nonzero: Option<&mut u64>) -> Result<Option<u32>, Fault> {
        if self.empty_blocks > 0 {
            self.empty_blocks -= 1;
            return Ok(Some(0));
        }
        let (mut at, mut found) = (self.band.first, 0_u64);
        while at <= self.band.last {
            let Some((zeros, size)) = self.ac_symbol()? else {
                return Ok(None);
            };
            match (zeros, size) {
                (15, 0) => at += 16,
                (_, 0) => {
                    let Some(blocks) = self.end_of_band(zeros)? else {
                        return Ok(None);
                    };
                    self.empty_blocks = blocks - 1;
                    break;
                }
                _ => {
                    at += zeros;
                    if at > self.band.last {
                        return Err(beyond());
                    }
                    found |= 1 << at;
                    at += 1;
                    if self.take(size)?.is_none() {
                        return Ok(None);
                    }
                }
            }
        }
        if let Some(nonzero) = nonzero {
            *nonzero |= found;
        }
        Ok(Some(0))
    }

    fn ac_refine(&mut self, nonzero: Option<&mut u64>) -> Result<Option<u32>, Fault> {
        let mut unused = 0;
        let nonzero = nonzero.unwrap_or(&mut unused);
        let mut at = self.band.first;
        while self.empty_blocks == 0 && at <= self.band.last {
            let Some((zeros, size)) = self.ac_symbol()? else {
                return Ok(None);
            };
            if size > 1 {
                return Err(Fault::damaged("a refinement of more than one bit"));
            }
            if size == 0 && zeros < 15 {
                let Some(blocks) = self.end_of_band(zeros)? else {
                    return Ok(None);
                };
                self.empty_blocks = blocks;
                break;
            }
            // The sign of a new coefficient.
            if self.take(size)?.is_none() {
                return Ok(None);
            }
            let Some(place) = self.pass(at, zeros, *nonzero)? else {
                return Ok(None);
            };
            if size == 1 {
                if place > self.band.last {
                    return Err(beyond());
                }
                *nonzero |= 1 << place;
            }
            at = place + 1;
        }
        if self.empty_blocks > 0 {
            self.empty_blocks -= 1;
            // Bits of those that were there before.
            return Ok(self.pass(at, u8::MAX, *nonzero)?.map(u32::from));
        }
        Ok(Some(0))
    }

    /// Goes on over so many coefficients that are zero, and over the bits of those between them that are not, to the next
    /// that is zero.
    fn pass(&mut self, from: u8, mut zeros: u8, nonzero: u64) -> Result<Option<u8>, Fault> {
        for at in from..=self.band.last {
            if nonzero >> at & 1 == 1 {
                if self.take(1)?.is_none() {
                    return Ok(None);
                }
            } else if zeros == 0 {
                return Ok(Some(at));
            } else {
                zeros -= 1;
            }
        }
        Ok(Some(self.band.last + 1))
    }
}

fn beyond() -> Fault {
    Fault::damaged("a coefficient beyond the last of its block")
}
