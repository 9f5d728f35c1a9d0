//! Heaps (HDF5 File Format Specification, III.D, III.E and III.G): names, attributes and variable-length values.

use super::source::{Block, Fault, Fields, Source, bytes_of};
use std::io::{Read, Seek};

/// Maximum rows of an indirect block; block sizes double from row to row.
const MAX_ROWS: usize = 64;

/// Reads one variable-length value from a global heap.
pub fn global<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    index: u32,
) -> Result<Vec<u8>, Fault> {
    let head = source.block(address, 8 + source.sizes.length as u64)?;
    let mut fields = head.fields();
    if fields.take(4)? != b"GCOL" {
        return Err(head.fields().damaged("no global heap"));
    }
    fields.take(4)?;
    let heap = source.block(address, fields.length()?)?;
    let mut fields = heap.fields();
    fields.take(head.bytes.len())?;
    loop {
        let number = fields.short()?;
        fields.take(6)?;
        let bytes = fields.length()?;
        let bytes = usize::try_from(bytes).unwrap_or(usize::MAX);
        if number == index as usize && number != 0 {
            return fields.take(bytes).map(<[u8]>::to_vec);
        }
        if number == 0 {
            return Err(heap
                .fields()
                .damaged("a global heap without a value that is wanted"));
        }
        fields.take(bytes.checked_next_multiple_of(8).unwrap_or(usize::MAX))?;
    }
}

/// Reads the names of a local heap.
pub fn local<R: Read + Seek>(source: &mut Source<'_, R>, address: u64) -> Result<Block, Fault> {
    let sizes = source.sizes;
    let bytes = 8 + 2 * sizes.length as u64 + sizes.address as u64;
    let head = source.block(address, bytes)?;
    let mut fields = head.fields();
    if fields.take(4)? != b"HEAP" {
        return Err(head.fields().damaged("no local heap"));
    }
    fields.take(4)?;
    let bytes = fields.length()?;
    fields.length()?;
    let data = fields.defined()?;
    source.block(data, bytes)
}

/// A fractal heap, used for many links or attributes.
pub struct FractalHeap {
    /// Byte of its header, for messages.
    at: u64,
    offset_bytes: usize,
    length_bytes: usize,
    id_bytes: usize,
    width: u64,
    start: u64,
    /// Rows of direct blocks; later rows hold indirect blocks.
    direct_rows: usize,
    root: Option<u64>,
    root_rows: usize,
}

impl FractalHeap {
    pub fn read<R: Read + Seek>(source: &mut Source<'_, R>, address: u64) -> Result<Self, Fault> {
        let sizes = source.sizes;
        let bytes = 26 + 12 * sizes.length as u64 + 3 * sizes.address as u64;
        let head = source.block(address, bytes)?;
        let mut fields = head.fields();
        if fields.take(4)? != b"FRHP" {
            return Err(head.fields().damaged("no fractal heap"));
        }
        fields.byte()?;
        let id_bytes = fields.short()?;
        if fields.short()? != 0 {
            return Err(Fault::Unsupported("compresses its attributes".to_owned()));
        }
        fields.byte()?;
        let largest = u64::from(fields.word()?);
        // Counts and sizes of huge objects, free space and objects.
        fields.take(10 * sizes.length + 2 * sizes.address)?;
        let width = fields.short()? as u64;
        let (start, direct) = (fields.length()?, fields.length()?);
        let bits = fields.short()?;
        fields.short()?;
        let (root, root_rows) = (fields.address()?, fields.short()?);
        source.checked(address, bytes, b"FRHP", "no fractal heap")?;
        let sizes = [start, direct];
        let are_possible = sizes.iter().all(|size| size.is_power_of_two()) && start <= direct;
        if !are_possible || width == 0 || !(1..=64).contains(&bits) || root_rows > MAX_ROWS {
            return Err(head.fields().damaged("a fractal heap of impossible sizes"));
        }
        Ok(Self {
            at: head.at,
            offset_bytes: bits.div_ceil(8),
            length_bytes: (direct.ilog2() as usize).div_ceil(8).min(bytes_of(largest)),
            id_bytes,
            width,
            start,
            direct_rows: (direct.ilog2() - start.ilog2()) as usize + 2,
            root,
            root_rows,
        })
    }

    /// Bytes of an object's ID.
    pub fn id_bytes(&self) -> usize {
        self.id_bytes
    }

    /// Reads an object by its ID; `None` if it is too large for the heap.
    pub fn object<R: Read + Seek>(
        &self,
        source: &mut Source<'_, R>,
        mut id: Fields<'_>,
    ) -> Result<Option<Block>, Fault> {
        let flags = id.byte()?;
        match flags >> 4 & 3 {
            0 => {
                let offset = id.number(self.offset_bytes)?;
                let bytes = id.number(self.length_bytes)?;
                self.managed(source, offset, bytes).map(Some)
            }
            1 => Ok(None),
            _ => Err(id.damaged("an object of a heap of an unknown kind")),
        }
    }

    fn managed<R: Read + Seek>(
        &self,
        source: &mut Source<'_, R>,
        offset: u64,
        bytes: u64,
    ) -> Result<Block, Fault> {
        let damaged = |what| Fault::Damaged { what, at: self.at };
        let astray = || damaged("a fractal heap without an object that is wanted");
        let mut block = self.root.ok_or_else(astray)?;
        let (mut rows, mut first) = (self.root_rows, 0u64);
        // With no rows, the root is a direct block.
        while rows > 0 {
            let inside = offset.checked_sub(first).ok_or_else(astray)?;
            let (row, column, row_start) = self.locate(inside, rows).ok_or_else(astray)?;
            let size = self.block_bytes(row);
            let entry = row as u64 * self.width + column;
            let sizes = source.sizes;
            let head = 5 + sizes.address as u64 + self.offset_bytes as u64;
            let bytes = head + (entry + 1) * sizes.address as u64;
            let indirect = source.block(block, bytes)?;
            if !indirect.bytes.starts_with(b"FHIB") {
                return Err(indirect.fields().damaged("no block of a fractal heap"));
            }
            let mut fields = indirect.fields();
            fields.take(bytes as usize - sizes.address)?;
            block = fields.defined()?;
            first = first.saturating_add(row_start + column * size);
            rows = match row < self.direct_rows {
                true => 0,
                // Each child is equally wide and has enough rows to fill its size.
                false => (size.ilog2() - (self.start * self.width).ilog2()) as usize + 1,
            };
            if rows >= self.root_rows {
                return Err(astray());
            }
        }
        let inside = offset.checked_sub(first).ok_or_else(astray)?;
        source.block(block.saturating_add(inside), bytes)
    }

    /// Bytes of each block of a row.
    fn block_bytes(&self, row: usize) -> u64 {
        self.start
            .checked_shl(row.saturating_sub(1) as u32)
            .unwrap_or(u64::MAX >> 1)
    }

    /// Row, column and start of the row for the block that contains an offset.
    fn locate(&self, offset: u64, rows: usize) -> Option<(usize, u64, u64)> {
        let mut start = 0u64;
        for row in 0..rows {
            let size = self.block_bytes(row);
            let of_row = size.checked_mul(self.width)?;
            if offset - start < of_row {
                return Some((row, (offset - start) / size, start));
            }
            start = start.checked_add(of_row)?;
        }
        None
    }
}
