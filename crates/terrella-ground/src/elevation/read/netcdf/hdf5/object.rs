//! Object headers (HDF5 File Format Specification, IV.A.1): the messages that describe a group or a data set.

use super::source::{Block, Fault, Fields, Source};
use std::io::{Read, Seek};

/// Maximum blocks and messages of one header.
const MAX_BLOCKS: usize = 64;
const MAX_MESSAGES: usize = 4096;

/// Message types that are read.
pub mod kind {
    pub const DATASPACE: u16 = 0x01;
    pub const LINK_INFO: u16 = 0x02;
    pub const DATATYPE: u16 = 0x03;
    pub const OLD_FILL: u16 = 0x04;
    pub const FILL: u16 = 0x05;
    pub const LINK: u16 = 0x06;
    pub const EXTERNAL: u16 = 0x07;
    pub const LAYOUT: u16 = 0x08;
    pub const FILTERS: u16 = 0x0B;
    pub const ATTRIBUTE: u16 = 0x0C;
    pub const CONTINUATION: u16 = 0x10;
    pub const SYMBOL_TABLE: u16 = 0x11;
    pub const ATTRIBUTE_INFO: u16 = 0x15;
}

/// One message: a range in a block.
struct Message {
    kind: u16,
    /// The message is stored elsewhere, and its contents locate it.
    is_shared: bool,
    block: usize,
    start: usize,
    bytes: usize,
}

/// The header of an object.
pub struct Object {
    blocks: Vec<Block>,
    messages: Vec<Message>,
}

impl Object {
    pub fn read<R: Read + Seek>(source: &mut Source<'_, R>, address: u64) -> Result<Self, Fault> {
        let mut object = Self {
            blocks: Vec::new(),
            messages: Vec::new(),
        };
        // The fixed part; version 2 has the longest.
        let rest = source
            .sizes
            .file
            .saturating_sub(address.saturating_add(source.sizes.base));
        let start = source.block(address, rest.min(34))?;
        let is_new = start.bytes.starts_with(b"OHDR");
        let mut continued = Vec::new();
        let style = match is_new {
            true => {
                let (block, style, first) = new_header(source, address, &start)?;
                object.add(block, first, style, &mut continued)?;
                style
            }
            false => {
                let mut fields = start.fields();
                if fields.byte()? != 1 {
                    return Err(start.fields().damaged("no header of an object"));
                }
                fields.take(7)?;
                let bytes = u64::from(fields.word()?);
                let block = source.block(address.saturating_add(16), bytes)?;
                object.add(block, 0, Style::Old, &mut continued)?;
                Style::Old
            }
        };
        while let Some((address, bytes)) = continued.pop() {
            let (block, first) = match style {
                Style::Old => (source.block(address, bytes)?, 0),
                Style::New { .. } => {
                    let what = "no continued header of an object";
                    (source.checked(address, bytes, b"OCHK", what)?, 4)
                }
            };
            if object.blocks.len() >= MAX_BLOCKS {
                return Err(block.fields().damaged("a header of more than 64 blocks"));
            }
            object.add(block, first, style, &mut continued)?;
        }
        Ok(object)
    }

    /// Adds the messages of a block, and the blocks that it refers to.
    fn add(
        &mut self,
        block: Block,
        first: usize,
        style: Style,
        continued: &mut Vec<(u64, u64)>,
    ) -> Result<(), Fault> {
        let mut fields = block.fields();
        fields.take(first)?;
        // A rest shorter than a message header is a gap.
        while fields.bytes.len() >= style.bytes() {
            let (kind, bytes, flags) = match style {
                Style::Old => {
                    let (kind, bytes, flags) = (fields.short()?, fields.short()?, fields.byte()?);
                    fields.take(3)?;
                    (kind as u16, bytes, flags)
                }
                Style::New { is_ordered } => {
                    let kind = u16::from(fields.byte()?);
                    let (bytes, flags) = (fields.short()?, fields.byte()?);
                    fields.take(if is_ordered { 2 } else { 0 })?;
                    (kind, bytes, flags)
                }
            };
            let start = block.bytes.len() - fields.bytes.len();
            let mut message = fields.part(bytes)?;
            if kind == kind::CONTINUATION {
                continued.push((message.defined()?, message.length()?));
            }
            self.messages.push(Message {
                kind,
                is_shared: flags & 2 != 0,
                block: self.blocks.len(),
                start,
                bytes,
            });
            if self.messages.len() > MAX_MESSAGES {
                return Err(fields.damaged("a header of more than 4096 messages"));
            }
        }
        self.blocks.push(block);
        Ok(())
    }

    /// The messages of a kind, and whether each is stored elsewhere.
    pub fn all(&self, kind: u16) -> impl Iterator<Item = (bool, Fields<'_>)> {
        let of_kind = self.messages.iter().filter(move |one| one.kind == kind);
        of_kind.map(|message| {
            let block = &self.blocks[message.block];
            let mut fields = block.fields();
            // Both bounds are inside the block.
            fields.at += message.start as u64;
            fields.bytes = &block.bytes[message.start..message.start + message.bytes];
            (message.is_shared, fields)
        })
    }

    /// The first message of a kind that is stored in the header itself.
    pub fn one(&self, kind: u16) -> Option<Fields<'_>> {
        self.all(kind)
            .find_map(|(is_shared, fields)| (!is_shared).then_some(fields))
    }

    /// Whether it is a group; other objects are data sets and types.
    pub fn is_group(&self) -> bool {
        [kind::SYMBOL_TABLE, kind::LINK_INFO, kind::LINK]
            .into_iter()
            .any(|kind| self.has(kind))
    }

    /// Whether a message of a kind exists, here or elsewhere.
    pub fn has(&self, kind: u16) -> bool {
        self.messages.iter().any(|message| message.kind == kind)
    }
}

/// Format of message headers.
#[derive(Clone, Copy)]
enum Style {
    Old,
    New {
        /// Whether messages have a creation order field.
        is_ordered: bool,
    },
}

impl Style {
    /// Bytes before the contents of a message.
    fn bytes(self) -> usize {
        match self {
            Self::Old => 8,
            Self::New { is_ordered } => 4 + if is_ordered { 2 } else { 0 },
        }
    }
}

/// The first block of a version 2 header, and the start of its messages.
fn new_header<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    start: &Block,
) -> Result<(Block, Style, usize), Fault> {
    let mut fields = start.fields();
    fields.take(4)?;
    if fields.byte()? != 2 {
        return Err(start
            .fields()
            .damaged("a header of an object of an unknown version"));
    }
    let flags = fields.byte()?;
    fields.take(if flags & 0x20 == 0 { 0 } else { 16 })?;
    fields.take(if flags & 0x10 == 0 { 0 } else { 4 })?;
    let bytes = fields.number(1 << (flags & 3))?;
    let first = start.bytes.len() - fields.bytes.len();
    let bytes = bytes.saturating_add(first as u64 + 4);
    let block = source.checked(address, bytes, b"OHDR", "no header of an object")?;
    let is_ordered = flags & 4 != 0;
    Ok((block, Style::New { is_ordered }, first))
}
