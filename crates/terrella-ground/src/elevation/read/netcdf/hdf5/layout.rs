//! Storage layout of a data set (HDF5 File Format Specification, IV.A.2.i).

use super::chunks::{Chunks, Entry};
use super::filters::Filters;
use super::index::{self, Index};
use super::message::Dataspace;
use super::object::{Object, kind};
use super::source::{Fault, Fields, Sizes, Source};
use std::io::{Read, Seek};

/// Maximum chunk size, bytes, and maximum chunks of a variable.
const CHUNK_BYTES: usize = 256 << 20;
const MAX_CHUNKS: usize = 1 << 21;

/// Values of a data set of one or two dimensions, after other dimensions of length 1.
pub struct Layout {
    /// Whether values are little-endian.
    pub is_little: bool,
    sizes: Sizes,
    space: Dataspace,
    kind: Kind,
    /// Stored bytes of values that were never written.
    fill: Vec<u8>,
}

/// Kind of storage.
enum Kind {
    Rows { address: Option<u64>, bytes: u64 },
    Held(Vec<u8>),
    Chunked(Box<Chunked>),
    Unsupported(String),
}

struct Chunked {
    /// Chunk sides in values, without the dimension of a value's bytes.
    sides: Vec<u64>,
    index: Index,
    address: Option<u64>,
    filters: Filters,
    /// Whether chunks beyond the last row or column are unfiltered.
    has_plain_edges: bool,
}

/// Resolved location of the values.
pub enum Place {
    /// Contiguous rows from this byte on.
    Rows {
        begin: u64,
    },
    /// Contiguous rows in memory.
    Held(Vec<u8>),
    Chunks(Chunks),
    /// No value was written: all have this value.
    Fill(Vec<u8>),
}

impl Layout {
    /// Reads the layout of a data set with values of `bytes` bytes.
    pub fn read(
        object: &Object,
        space: Dataspace,
        bytes: usize,
        is_little: bool,
        sizes: Sizes,
    ) -> Result<Self, Fault> {
        let mut fill = vec![0; bytes];
        let value = match (object.one(kind::FILL), object.one(kind::OLD_FILL)) {
            (Some(fields), _) => fill_value(fields)?,
            (None, Some(mut fields)) => {
                let bytes = fields.word()? as usize;
                Some(fields.take(bytes)?)
            }
            (None, None) => None,
        };
        if let Some(value) = value.filter(|value| value.len() == bytes) {
            fill.copy_from_slice(value);
        }
        let kind = match object.one(kind::LAYOUT) {
            _ if object.has(kind::EXTERNAL) => {
                Kind::Unsupported("keeps its values in other files".to_owned())
            }
            None => Kind::Unsupported("has values without a layout".to_owned()),
            Some(layout) => match storage(layout, object, space.sides.len()) {
                Err(Fault::Unsupported(cause)) => Kind::Unsupported(cause),
                kind => kind?,
            },
        };
        Ok(Self {
            is_little,
            sizes,
            space,
            kind,
            fill,
        })
    }

    /// Resolves the location of the values for these rows, columns and value sizes.
    pub fn place<R: Read + Seek>(
        &self,
        reader: &mut R,
        (rows, columns): (usize, usize),
        bytes: usize,
    ) -> Result<Place, Fault> {
        let all = rows as u64 * columns as u64 * bytes as u64;
        let at = self.sizes.base;
        match &self.kind {
            Kind::Unsupported(cause) => Err(Fault::Unsupported(cause.clone())),
            Kind::Rows { address: None, .. } => Ok(Place::Fill(self.fill.clone())),
            Kind::Rows {
                address: Some(address),
                bytes,
            } => {
                let begin = self.sizes.within(*address, *bytes)?;
                match *bytes < all {
                    true => Err(Fault::Damaged {
                        what: "too few values",
                        at: begin,
                    }),
                    false => Ok(Place::Rows { begin }),
                }
            }
            Kind::Held(held) if (held.len() as u64) < all => Err(Fault::Damaged {
                what: "too few values in a header",
                at,
            }),
            Kind::Held(held) => Ok(Place::Held(held.clone())),
            Kind::Chunked(chunked) => {
                let mut source = Source::new(reader, self.sizes);
                self.chunks(&mut source, chunked, (rows, columns), bytes)
            }
        }
    }

    fn chunks<R: Read + Seek>(
        &self,
        source: &mut Source<'_, R>,
        chunked: &Chunked,
        (rows, columns): (usize, usize),
        bytes: usize,
    ) -> Result<Place, Fault> {
        let Some(address) = chunked.address else {
            return Ok(Place::Fill(self.fill.clone()));
        };
        // One dimension means a single row.
        let side = |n: usize| match self.space.sides.len().checked_sub(2 - n) {
            Some(n) => usize::try_from(chunked.sides[n]).unwrap_or(usize::MAX),
            None => 1,
        };
        let chunk = (side(0), side(1));
        // Chunks may exceed a dimension that can grow; the used part comes first.
        let others = chunked.sides.iter().rev().skip(2);
        let layers = others.fold(1_u64, |all, side| all.saturating_mul(*side));
        let layers = usize::try_from(layers).unwrap_or(usize::MAX);
        let chunk_bytes = chunk.0.saturating_mul(chunk.1).saturating_mul(bytes);
        let chunk_bytes = chunk_bytes.saturating_mul(layers);
        if chunk_bytes == 0 || chunk_bytes > CHUNK_BYTES {
            return Err(Fault::Unsupported(format!(
                "has chunks of {layers} × {} × {} values, more than 256 MiB or none",
                chunk.0, chunk.1
            )));
        }
        let (down, across) = (rows.div_ceil(chunk.0), columns.div_ceil(chunk.1));
        if down.saturating_mul(across) > MAX_CHUNKS {
            return Err(Fault::Unsupported(format!(
                "has more than 2 097 152 chunks, of {} × {} values",
                chunk.0, chunk.1
            )));
        }
        let mut entries = vec![Entry::ABSENT; down * across];
        let sizes = self.sizes;
        let shape = index::Shape {
            space: &self.space,
            chunk: &chunked.sides,
            chunk_bytes: chunk_bytes as u64,
            is_filtered: !chunked.filters.is_empty(),
        };
        index::read(
            source,
            &chunked.index,
            address,
            &shape,
            &mut |place, mut entry| {
                let (row, column) = match place {
                    [others @ .., row, column] if others.iter().all(|n| *n == 0) => (*row, *column),
                    [column] => (0, *column),
                    _ => return Ok(()),
                };
                // Chunks outside remain from an earlier, larger size.
                if row >= down as u64 || column >= across as u64 {
                    return Ok(());
                }
                entry.at = sizes.within(entry.at, entry.bytes)?;
                if entry.bytes > chunk_bytes as u64 * 2 + 4096 {
                    let what = "a chunk that is larger than its values";
                    return Err(Fault::Damaged { what, at: entry.at });
                }
                let (row, column) = (row as usize, column as usize);
                let is_edge = (row + 1) * chunk.0 > rows || (column + 1) * chunk.1 > columns;
                if is_edge && chunked.has_plain_edges {
                    entry.skipped = u32::MAX;
                }
                entries[row * across + column] = entry;
                Ok(())
            },
        )?;
        Ok(Place::Chunks(Chunks {
            chunk,
            across,
            bytes: chunk_bytes,
            entries,
            filters: chunked.filters.clone(),
            fill: self.fill.clone(),
        }))
    }
}

/// The value of a fill value message, if present.
fn fill_value(mut fields: Fields<'_>) -> Result<Option<&[u8]>, Fault> {
    let is_defined = match fields.byte()? {
        1 | 2 => fields.take(3)?[2] != 0,
        3 => fields.byte()? & 0x20 != 0,
        _ => return Err(fields.damaged("a fill value of an unknown version")),
    };
    if !is_defined {
        return Ok(None);
    }
    let bytes = fields.word()? as usize;
    fields.take(bytes).map(Some)
}

/// The storage kind of a layout message.
fn storage(mut fields: Fields<'_>, object: &Object, rank: usize) -> Result<Kind, Fault> {
    let version = fields.byte()?;
    if !(3..=5).contains(&version) {
        return Err(Fault::Unsupported(format!(
            "stores values by a layout of version {version}, of HDF5 before 1.6.3 or after 2.0"
        )));
    }
    let class = fields.byte()?;
    match class {
        0 => {
            let bytes = fields.short()?;
            return Ok(Kind::Held(fields.take(bytes)?.to_vec()));
        }
        1 => {
            return Ok(Kind::Rows {
                address: fields.address()?,
                bytes: fields.length()?,
            });
        }
        2 => {}
        _ => {
            let cause = "is a virtual data set, whose values lie in others";
            return Err(Fault::Unsupported(cause.to_owned()));
        }
    }
    let filters = match object.one(kind::FILTERS) {
        Some(fields) => Filters::read(fields)?,
        None if object.has(kind::FILTERS) => {
            return Err(Fault::Unsupported("shares its filters".to_owned()));
        }
        None => Filters::default(),
    };
    let flags = if version == 3 { 0 } else { fields.byte()? };
    let sides = usize::from(fields.byte()?);
    if sides != rank + 1 {
        return Err(fields.damaged("chunks of another number of dimensions"));
    }
    let (index, address, sides) = match version {
        3 => {
            let address = fields.address()?;
            let sides: Result<Vec<_>, _> = (0..rank).map(|_| fields.number(4)).collect();
            (Index::Tree1, address, sides?)
        }
        _ => {
            let bytes = usize::from(fields.byte()?);
            let sides: Result<Vec<_>, _> = (0..=rank).map(|_| fields.number(bytes)).collect();
            let is_filtered = flags & 2 != 0;
            let index = Index::read(&mut fields, is_filtered)?;
            (index, fields.address()?, sides?[..rank].to_vec())
        }
    };
    if sides.contains(&0) {
        return Err(fields.damaged("chunks of no values"));
    }
    Ok(Kind::Chunked(Box::new(Chunked {
        sides,
        index,
        address,
        filters,
        has_plain_edges: flags & 1 != 0,
    })))
}
