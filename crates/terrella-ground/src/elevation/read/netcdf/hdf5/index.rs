//! Chunk indexes (HDF5 File Format Specification, III.A.1 and VII): the location of each chunk.

use super::chunks::Entry;
use super::message::Dataspace;
use super::source::{Block, Fault, Fields, Source};
use super::tree;
use std::io::{Read, Seek};

/// Maximum depth of a B-tree of version 1.
const MAX_LEVEL: u8 = 16;
/// Maximum elements of an array.
const MAX_ELEMENTS: u64 = 1 << 26;

/// Kind of a chunk index.
pub enum Index {
    /// B-tree of version 1.
    Tree1,
    /// A single chunk; if filtered, its size and the mask of skipped filters.
    Single(Option<(u64, u32)>),
    /// Chunks are contiguous.
    Implicit,
    FixedArray,
    ExtensibleArray,
    /// B-tree of version 2.
    Tree2,
}

/// Dimensions of the chunked data.
pub struct Shape<'a> {
    pub space: &'a Dataspace,
    /// Sides of a chunk, in values.
    pub chunk: &'a [u64],
    /// Bytes of an unfiltered chunk.
    pub chunk_bytes: u64,
    pub is_filtered: bool,
}

/// Receives the position of a chunk, in chunks along each dimension, and its location.
type Put<'a> = dyn FnMut(&[u64], Entry) -> Result<(), Fault> + 'a;

impl Index {
    /// Reads the index type from a layout message of version 4 or later.
    pub fn read(fields: &mut Fields<'_>, is_filtered: bool) -> Result<Self, Fault> {
        // Parameters that arrays and trees repeat in their own headers are skipped.
        Ok(match fields.byte()? {
            1 if is_filtered => Self::Single(Some((fields.length()?, fields.word()?))),
            1 => Self::Single(None),
            2 => Self::Implicit,
            3 => {
                fields.take(1)?;
                Self::FixedArray
            }
            4 => {
                fields.take(5)?;
                Self::ExtensibleArray
            }
            5 => {
                fields.take(6)?;
                Self::Tree2
            }
            _ => return Err(fields.damaged("an unknown index of chunks")),
        })
    }
}

/// Passes on all chunks of an index.
pub fn read<R: Read + Seek>(
    source: &mut Source<'_, R>,
    index: &Index,
    address: u64,
    shape: &Shape<'_>,
    put: &mut Put<'_>,
) -> Result<(), Fault> {
    let plain = |at: u64| Entry {
        at,
        bytes: shape.chunk_bytes,
        skipped: 0,
    };
    match index {
        Index::Tree1 => tree1(source, address, shape, MAX_LEVEL, put),
        Index::Single(filtered) => {
            let mut entry = plain(address);
            if let Some((bytes, skipped)) = *filtered {
                entry = Entry {
                    at: address,
                    bytes,
                    skipped,
                };
            }
            put(&vec![0; shape.chunk.len()], entry)
        }
        Index::Implicit => {
            let grid = Grid::of(shape);
            for n in 0..grid.count().min(MAX_ELEMENTS) {
                let at = n.saturating_mul(shape.chunk_bytes).saturating_add(address);
                put(&grid.place(n), plain(at))?;
            }
            Ok(())
        }
        Index::FixedArray => fixed_array(source, address, shape, put),
        Index::ExtensibleArray => extensible_array(source, address, shape, put),
        Index::Tree2 => {
            let records = tree::records(source, address)?;
            let mut fields = records.block.fields();
            let sizes = fields.sizes;
            let rank = shape.chunk.len();
            let mut place = vec![0; rank];
            while !fields.bytes.is_empty() {
                let mut record = fields.part(records.record)?;
                let rest = records.record.checked_sub(sizes.address + 8 * rank);
                let mut entry = plain(record.defined()?);
                if shape.is_filtered {
                    let bytes = rest.and_then(|rest| rest.checked_sub(4));
                    let bytes = bytes.ok_or_else(|| record.damaged("a record that is cut off"))?;
                    (entry.bytes, entry.skipped) = (record.number(bytes)?, record.word()?);
                }
                for of_dimension in &mut place {
                    *of_dimension = record.number(8)?;
                }
                put(&place, entry)?;
            }
            Ok(())
        }
    }
}

/// Reads a B-tree of version 1 with its subtrees.
fn tree1<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    shape: &Shape<'_>,
    most_level: u8,
    put: &mut Put<'_>,
) -> Result<(), Fault> {
    let sizes = source.sizes;
    let rank = shape.chunk.len();
    let head_bytes = 8 + 2 * sizes.address as u64;
    let head = source.block(address, head_bytes)?;
    let mut fields = head.fields();
    let signature = fields.take(4)?;
    let (node, level, count) = (fields.byte()?, fields.byte()?, fields.short()?);
    if signature != b"TREE" || node != 1 || level > most_level {
        return Err(head.fields().damaged("no B-tree of chunks"));
    }
    let entry_bytes = 8 + 8 * (rank + 1) + sizes.address;
    let node = source.block(address, head_bytes + (count * entry_bytes) as u64)?;
    let mut fields = node.fields();
    fields.take(head_bytes as usize)?;
    let mut place = vec![0; rank];
    for _ in 0..count {
        let bytes = u64::from(fields.word()?);
        let skipped = fields.word()?;
        for (of_dimension, side) in place.iter_mut().zip(shape.chunk) {
            let first = fields.number(8)?;
            if first % side != 0 {
                return Err(fields.damaged("a chunk between two places"));
            }
            *of_dimension = first / side;
        }
        fields.take(8)?;
        let at = fields.defined()?;
        match level.checked_sub(1) {
            Some(below) => tree1(source, at, shape, below, put)?,
            None if !shape.is_filtered && bytes != shape.chunk_bytes => {
                return Err(fields.damaged("a chunk of another number of bytes"));
            }
            None => put(&place, Entry { at, bytes, skipped })?,
        }
    }
    Ok(())
}

/// The chunks of all possible values. Numbers run fastest along the last dimension, and slowest along the unlimited
/// one.
struct Grid {
    /// Chunks along each dimension, in numbering order.
    sides: Vec<u64>,
    /// The slowest dimension.
    slowest: usize,
}

impl Grid {
    fn of(shape: &Shape<'_>) -> Self {
        let Dataspace { sides, most } = shape.space;
        let slowest = most.iter().position(|most| *most == u64::MAX).unwrap_or(0);
        let side = |n: usize| {
            let values = if n == slowest && most[n] == u64::MAX {
                sides[n]
            } else {
                most[n]
            };
            values.div_ceil(shape.chunk[n])
        };
        let others = (0..sides.len()).filter(|n| *n != slowest);
        let order = std::iter::once(slowest).chain(others);
        Self {
            sides: order.map(side).collect(),
            slowest,
        }
    }

    fn count(&self) -> u64 {
        let product = |all: u64, side: &u64| all.saturating_mul(*side);
        self.sides.iter().fold(1, product)
    }

    /// The position of a chunk number, in chunks along each dimension.
    fn place(&self, number: u64) -> Vec<u64> {
        let mut rest = number;
        let mut place = vec![0; self.sides.len()];
        for n in (1..self.sides.len()).rev() {
            let side = self.sides[n].max(1);
            place[n] = rest % side;
            rest /= side;
        }
        place[0] = rest;
        // Moves the slowest dimension back to its place.
        place[..=self.slowest].rotate_left(1);
        place
    }
}

/// Elements of an array; each is the location of a chunk.
struct Elements<'a, 'p> {
    grid: Grid,
    shape: &'a Shape<'a>,
    bytes: usize,
    put: &'a mut Put<'p>,
}

impl Elements<'_, '_> {
    /// Passes on elements with consecutive numbers.
    fn take(&mut self, fields: &mut Fields<'_>, first: u64, count: u64) -> Result<(), Fault> {
        for number in first..first.saturating_add(count) {
            let mut element = fields.part(self.bytes)?;
            let Some(at) = element.address()? else {
                continue;
            };
            let mut entry = Entry {
                at,
                bytes: self.shape.chunk_bytes,
                skipped: 0,
            };
            if self.shape.is_filtered {
                let bytes = element.bytes.len().checked_sub(4);
                let bytes = bytes.ok_or_else(|| element.damaged("an element that is cut off"))?;
                (entry.bytes, entry.skipped) = (element.number(bytes)?, element.word()?);
            }
            if number < self.grid.count() {
                (self.put)(&self.grid.place(number), entry)?;
            }
        }
        Ok(())
    }

    /// Passes on a data block: elements, or pages of them that may be unwritten.
    fn block<R: Read + Seek>(
        &mut self,
        source: &mut Source<'_, R>,
        data: &DataBlock<'_>,
    ) -> Result<(), Fault> {
        let all = data.count.saturating_mul(self.bytes as u64);
        let Some(page) = data.page else {
            let bytes = data.head_bytes.saturating_add(all).saturating_add(4);
            let block =
                source.checked(data.address, bytes, data.signature, "no block of an array")?;
            let mut fields = block.fields();
            fields.take(data.head_bytes as usize)?;
            return self.take(&mut fields, data.first, data.count);
        };
        let mut at = data.address.saturating_add(data.head_bytes + 4);
        for (n, first) in (0..data.count).step_by(page as usize).enumerate() {
            let count = page.min(data.count - first);
            let bytes = count * self.bytes as u64 + 4;
            let is_written = data.is_written(n);
            if is_written {
                let mut block = source.block(at, bytes)?;
                block.check()?;
                self.take(&mut block.fields(), data.first + first, count)?;
            }
            at = at.saturating_add(bytes);
        }
        Ok(())
    }
}

/// A data block of an array.
struct DataBlock<'a> {
    address: u64,
    signature: &'a [u8; 4],
    /// Bytes before its elements.
    head_bytes: u64,
    /// Number of its first element, and element count.
    first: u64,
    count: u64,
    /// Elements per page, if it has pages.
    page: Option<u64>,
    /// Bitmap of written pages, the highest bit of each byte first, and the bit of the first page.
    written: (&'a [u8], usize),
}

impl DataBlock<'_> {
    fn is_written(&self, page: usize) -> bool {
        let (bits, first) = self.written;
        let n = first + page;
        bits.get(n / 8)
            .is_some_and(|byte| byte << (n % 8) & 0x80 != 0)
    }
}

fn fixed_array<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    shape: &Shape<'_>,
    put: &mut Put<'_>,
) -> Result<(), Fault> {
    let sizes = source.sizes;
    let bytes = 12 + (sizes.length + sizes.address) as u64;
    let header = source.checked(address, bytes, b"FAHD", "no fixed array")?;
    let mut fields = header.fields();
    fields.take(6)?;
    let (element, page_bits) = (fields.byte()?, fields.byte()?);
    let count = fields.length()?;
    let Some(address) = fields.address()? else {
        return Ok(());
    };
    if count > MAX_ELEMENTS || page_bits > 32 {
        return Err(header.fields().damaged("a fixed array of impossible sizes"));
    }
    let page = 1 << page_bits;
    let is_paged = count > page;
    let head_bytes = 6 + sizes.address as u64;
    let map_bytes = if is_paged {
        count.div_ceil(page).div_ceil(8)
    } else {
        0
    };
    let written = match is_paged {
        true => source.block(address, head_bytes + map_bytes)?.bytes,
        false => Vec::new(),
    };
    let mut elements = Elements {
        grid: Grid::of(shape),
        shape,
        bytes: usize::from(element),
        put,
    };
    let data = DataBlock {
        address,
        signature: b"FADB",
        head_bytes: head_bytes + map_bytes,
        first: 0,
        count,
        page: is_paged.then_some(page),
        written: (written.get(head_bytes as usize..).unwrap_or_default(), 0),
    };
    elements.block(source, &data)
}

/// Sizes of an extensible array.
struct Extents {
    /// Bytes of an element count.
    offset_bytes: usize,
    /// Elements of the index block, and of the smallest data block.
    of_index: u64,
    smallest: u64,
    /// Elements per page.
    page: u64,
    /// Elements in use, from the first on.
    set: u64,
}

fn extensible_array<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    shape: &Shape<'_>,
    put: &mut Put<'_>,
) -> Result<(), Fault> {
    let sizes = source.sizes;
    let bytes = 16 + 6 * sizes.length as u64 + sizes.address as u64;
    let header = source.checked(address, bytes, b"EAHD", "no extensible array")?;
    let mut fields = header.fields();
    fields.take(6)?;
    let [element, bits, of_index, smallest, pointers, page_bits] = *fields.take(6)? else {
        return Err(fields.damaged("a field that is cut off"));
    };
    fields.take(4 * sizes.length)?;
    let set = fields.length()?;
    fields.length()?;
    let Some(index_block) = fields.address()? else {
        return Ok(());
    };
    let are_powers = smallest.is_power_of_two() && pointers.is_power_of_two();
    let log_smallest = if are_powers { smallest.ilog2() } else { 0 };
    if !are_powers
        || bits > 64
        || u32::from(bits) < log_smallest
        || page_bits > 32
        || set > MAX_ELEMENTS
    {
        return Err(header
            .fields()
            .damaged("an extensible array of impossible sizes"));
    }
    let extents = Extents {
        offset_bytes: usize::from(bits).div_ceil(8),
        of_index: u64::from(of_index),
        smallest: u64::from(smallest),
        page: 1 << page_bits,
        set,
    };
    // The index block contains the data block addresses of the first super blocks, and the addresses of the other super
    // blocks.
    let supers = 1 + u32::from(bits) - log_smallest;
    let direct = (2 * u32::from(pointers).ilog2()).min(supers);
    let direct_blocks = 2 * (u64::from(pointers) - 1);
    let addresses = direct_blocks + u64::from(supers - direct);
    let bytes = 10 + extents.of_index * u64::from(element) + (addresses + 1) * sizes.address as u64;
    let block = source.checked(index_block, bytes, b"EAIB", "no index of an array")?;
    let mut fields = block.fields();
    fields.take(6 + sizes.address)?;
    let mut elements = Elements {
        grid: Grid::of(shape),
        shape,
        bytes: usize::from(element),
        put,
    };
    elements.take(&mut fields, 0, extents.of_index)?;
    let mut first = extents.of_index;
    for super_block in 0..supers {
        if first >= extents.set {
            break;
        }
        // A super block has 2^⌊n/2⌋ data blocks, each 2^⌈n/2⌉ times the smallest.
        let blocks = 1_u64 << (super_block / 2);
        let of_block = extents.smallest << super_block.div_ceil(2);
        if super_block < direct {
            for _ in 0..blocks {
                if let Some(address) = fields.address()? {
                    extents.data_block(
                        source,
                        &mut elements,
                        address,
                        (first, of_block),
                        (&[], 0),
                    )?;
                }
                first += of_block;
            }
            continue;
        }
        if let Some(address) = fields.address()? {
            let of_super = extents.super_block(source, address, blocks, of_block)?;
            let (maps, mut pointers) = of_super.fields_after(&extents, blocks, of_block)?;
            // The bitmaps of all data blocks are contiguous.
            let pages = (of_block / extents.page) as usize;
            for n in 0..blocks as usize {
                if let Some(address) = pointers.address()? {
                    let first = first + n as u64 * of_block;
                    let written = (maps, n * pages);
                    extents.data_block(
                        source,
                        &mut elements,
                        address,
                        (first, of_block),
                        written,
                    )?;
                }
            }
        }
        first = first.saturating_add(blocks * of_block);
    }
    Ok(())
}

/// A super block of an extensible array.
struct SuperBlock(Block);

impl SuperBlock {
    /// The page bitmaps of the data blocks, then the addresses of the data blocks.
    fn fields_after(
        &self,
        extents: &Extents,
        blocks: u64,
        of_block: u64,
    ) -> Result<(&[u8], Fields<'_>), Fault> {
        let mut fields = self.0.fields();
        fields.take(6 + fields.sizes.address + extents.offset_bytes)?;
        let maps = fields.take((blocks * extents.map_bytes(of_block)) as usize)?;
        Ok((maps, fields))
    }
}

impl Extents {
    /// Bytes of a data block's page bitmap.
    fn map_bytes(&self, of_block: u64) -> u64 {
        match of_block > self.page {
            true => (of_block / self.page).div_ceil(8),
            false => 0,
        }
    }

    fn super_block<R: Read + Seek>(
        &self,
        source: &mut Source<'_, R>,
        address: u64,
        blocks: u64,
        of_block: u64,
    ) -> Result<SuperBlock, Fault> {
        let address_bytes = source.sizes.address as u64;
        let of_blocks = blocks * (self.map_bytes(of_block) + address_bytes);
        let bytes = 10 + address_bytes + self.offset_bytes as u64 + of_blocks;
        let block = source.checked(address, bytes, b"EASB", "no super block of an array");
        block.map(SuperBlock)
    }

    fn data_block<R: Read + Seek>(
        &self,
        source: &mut Source<'_, R>,
        elements: &mut Elements<'_, '_>,
        address: u64,
        (first, count): (u64, u64),
        written: (&[u8], usize),
    ) -> Result<(), Fault> {
        let data = DataBlock {
            address,
            signature: b"EADB",
            head_bytes: 6 + (source.sizes.address + self.offset_bytes) as u64,
            first,
            count,
            page: (count > self.page).then_some(self.page),
            written,
        };
        elements.block(source, &data)
    }
}
