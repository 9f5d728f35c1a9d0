//! B-trees of version 2 (HDF5 File Format Specification, III.A.2): all records in order.

use super::source::{Block, Fault, Source, bytes_of};
use std::io::{Read, Seek};

/// Maximum tree depth, and maximum bytes of all records.
const MAX_DEPTH: usize = 16;
const RECORD_BYTES: usize = 128 << 20;

/// The records of a tree, contiguous.
pub struct Records {
    pub block: Block,
    /// Bytes per record.
    pub record: usize,
}

/// Node sizes of one level.
#[derive(Clone, Copy)]
struct Level {
    /// Maximum records of all nodes below, and bytes of that count.
    all: u64,
    all_bytes: usize,
}

struct Tree<'a, 's, R> {
    source: &'a mut Source<'s, R>,
    record: usize,
    /// Bytes of a record count.
    count_bytes: usize,
    levels: Vec<Level>,
    records: Vec<u8>,
}

/// Reads all records of a tree. An empty tree has no records.
pub fn records<R: Read + Seek>(source: &mut Source<'_, R>, address: u64) -> Result<Records, Fault> {
    let sizes = source.sizes;
    let bytes = 22 + sizes.address as u64 + sizes.length as u64;
    let mut header = source.checked(address, bytes, b"BTHD", "no B-tree")?;
    let mut fields = header.fields();
    fields.take(6)?;
    let node = u64::from(fields.word()?);
    let (record, depth) = (fields.short()?, fields.short()?);
    fields.take(2)?;
    let root = fields.address()?;
    let count = fields.short()? as u64;
    if record == 0 || depth > MAX_DEPTH || node < 10 + record as u64 {
        return Err(header.fields().damaged("a B-tree of impossible sizes"));
    }
    let most = (node - 10) / record as u64;
    let count_bytes = bytes_of(most);
    let mut levels = vec![Level {
        all: most,
        all_bytes: 0,
    }];
    for _ in 0..depth {
        let below = levels[levels.len() - 1];
        let pointer = (sizes.address + count_bytes + below.all_bytes) as u64;
        let most = node.saturating_sub(10 + pointer) / (record as u64 + pointer);
        let all = (most + 1).saturating_mul(below.all).saturating_add(most);
        let all_bytes = bytes_of(all);
        levels.push(Level { all, all_bytes });
    }
    let mut tree = Tree {
        source,
        record,
        count_bytes,
        levels,
        records: Vec::new(),
    };
    if let Some(root) = root {
        tree.node(root, count, depth)?;
    }
    header.bytes = tree.records;
    Ok(Records {
        block: header,
        record,
    })
}

impl<R: Read + Seek> Tree<'_, '_, R> {
    /// Adds the records of a node and of its subtrees.
    fn node(&mut self, address: u64, count: u64, level: usize) -> Result<(), Fault> {
        let of_records = count * self.record as u64;
        let Some(below) = level.checked_sub(1) else {
            let leaf =
                self.source
                    .checked(address, 10 + of_records, b"BTLF", "no leaf of a B-tree")?;
            let mut fields = leaf.fields();
            fields.take(6)?;
            self.records.extend(fields.bytes);
            return match self.records.len() > RECORD_BYTES {
                true => Err(fields.damaged("a B-tree of more than 128 MiB of records")),
                false => Ok(()),
            };
        };
        let all_bytes = self.levels[below].all_bytes;
        let pointer = self.source.sizes.address + self.count_bytes + all_bytes;
        let bytes = 10 + of_records + (count + 1) * pointer as u64;
        let node = self
            .source
            .checked(address, bytes, b"BTIN", "no node of a B-tree")?;
        let mut records = node.fields();
        records.take(6)?;
        let mut children = records;
        children.take(of_records as usize)?;
        for n in 0..=count {
            let (child, of_child) = (children.defined()?, children.number(self.count_bytes)?);
            children.take(all_bytes)?;
            self.node(child, of_child, below)?;
            if n < count {
                self.records.extend(records.take(self.record)?);
            }
        }
        Ok(())
    }
}
