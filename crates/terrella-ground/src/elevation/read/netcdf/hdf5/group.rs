//! Members of a group: names, and addresses of the targets of hard links.

use super::heap::{self, FractalHeap};
use super::object::{Object, kind};
use super::source::{Fault, Fields, Source};
use super::tree;
use std::collections::HashSet;
use std::io::{Read, Seek};

/// Maximum members of a group, and of all groups together.
const MAX_MEMBERS: usize = 1024;

/// Maximum depth of groups below the root.
const MAX_DEPTH: usize = 16;

/// Maximum depth of a name tree.
const MAX_LEVEL: u8 = 16;

pub struct Member {
    pub name: String,
    /// Address of its object's header.
    pub address: u64,
}

/// Reads the headers of all objects below the root group that are not groups, each with its path from the root. Of an object with
/// several paths only the first found is read, so cyclic links end.
pub fn tree<R: Read + Seek>(
    source: &mut Source<'_, R>,
    root: &Object,
) -> Result<Vec<(Member, Object)>, Fault> {
    let mut objects = Vec::new();
    let mut seen = HashSet::new();
    let mut waiting: Vec<_> = members(source, root)?
        .into_iter()
        .map(|member| (0, member))
        .collect();
    waiting.reverse();
    while let Some((depth, member)) = waiting.pop() {
        if !seen.insert(member.address) {
            continue;
        }
        let object = Object::read(source, member.address)?;
        if !object.is_group() {
            objects.push((member, object));
            continue;
        }
        let damaged = |what| Fault::Damaged {
            what,
            at: member.address,
        };
        if depth == MAX_DEPTH {
            return Err(damaged("a group more than 16 groups deep"));
        }
        let below = members(source, &object)?;
        if seen.len() + waiting.len() + below.len() > MAX_MEMBERS {
            return Err(damaged("groups of more than 1024 members in all"));
        }
        waiting.extend(below.into_iter().rev().map(|one| {
            let name = format!("{}/{}", member.name, one.name);
            (depth + 1, Member { name, ..one })
        }));
    }
    Ok(objects)
}

/// Reads the members of a group. Soft and external links are skipped.
fn members<R: Read + Seek>(
    source: &mut Source<'_, R>,
    group: &Object,
) -> Result<Vec<Member>, Fault> {
    let mut members = Vec::new();
    if let Some(mut table) = group.one(kind::SYMBOL_TABLE) {
        let (tree, names) = (table.defined()?, table.defined()?);
        let names = heap::local(source, names)?;
        symbols(source, tree, names.fields(), MAX_LEVEL, &mut members)?;
    }
    for (_, link) in group.all(kind::LINK) {
        members.extend(linked(link)?);
    }
    if let Some(mut info) = group.one(kind::LINK_INFO) {
        let flags = info.take(2)?[1];
        info.take(if flags & 1 == 0 { 0 } else { 8 })?;
        if let (Some(heap), Some(index)) = (info.address()?, info.address()?) {
            let heap = FractalHeap::read(source, heap)?;
            let records = tree::records(source, index)?;
            let mut fields = records.block.fields();
            while !fields.bytes.is_empty() {
                let mut record = fields.part(records.record)?;
                // The hash of the name comes first.
                record.take(4)?;
                let id = record.part(heap.id_bytes())?;
                if let Some(link) = heap.object(source, id)? {
                    members.extend(linked(link.fields())?);
                }
                few(&members, &fields)?;
            }
        }
    }
    Ok(members)
}

fn few(members: &[Member], fields: &Fields<'_>) -> Result<(), Fault> {
    match members.len() > MAX_MEMBERS {
        true => Err(fields.damaged("a group of more than 1024 members")),
        false => Ok(()),
    }
}

/// Target of a link message; `None` for a link that is not hard.
fn linked(mut link: Fields<'_>) -> Result<Option<Member>, Fault> {
    link.byte()?;
    let flags = link.byte()?;
    let style = if flags & 0x08 == 0 { 0 } else { link.byte()? };
    link.take(if flags & 0x04 == 0 { 0 } else { 8 })?;
    link.take(usize::from(flags & 0x10 != 0))?;
    let bytes = link.number(1 << (flags & 3))?;
    let name = link.take(usize::try_from(bytes).unwrap_or(usize::MAX))?;
    if style != 0 {
        return Ok(None);
    }
    Ok(Some(Member {
        name: String::from_utf8_lossy(name).into_owned(),
        address: link.defined()?,
    }))
}

/// Adds the members of a name tree of version 1.
fn symbols<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    names: Fields<'_>,
    most_level: u8,
    members: &mut Vec<Member>,
) -> Result<(), Fault> {
    let sizes = source.sizes;
    let head_bytes = 8 + 2 * sizes.address as u64;
    let head = source.block(address, head_bytes)?;
    let mut fields = head.fields();
    let signature = fields.take(4)?;
    let (node, level, count) = (fields.byte()?, fields.byte()?, fields.short()?);
    if signature != b"TREE" || node != 0 || level > most_level {
        return Err(head.fields().damaged("no B-tree of names"));
    }
    let entry = sizes.length + sizes.address;
    let node = source.block(address, head_bytes + (count * entry) as u64)?;
    let mut fields = node.fields();
    fields.take(head_bytes as usize)?;
    for _ in 0..count {
        fields.length()?;
        let child = fields.defined()?;
        match level.checked_sub(1) {
            Some(below) => symbols(source, child, names, below, members)?,
            None => symbol_node(source, child, names, members)?,
        }
        few(members, &fields)?;
    }
    Ok(())
}

/// Adds the members of a symbol table node.
fn symbol_node<R: Read + Seek>(
    source: &mut Source<'_, R>,
    address: u64,
    names: Fields<'_>,
    members: &mut Vec<Member>,
) -> Result<(), Fault> {
    let head = source.block(address, 8)?;
    let mut fields = head.fields();
    if fields.take(4)? != b"SNOD" {
        return Err(head.fields().damaged("no node of names"));
    }
    fields.take(2)?;
    let count = fields.short()?;
    let entry = 2 * source.sizes.address + 24;
    let node = source.block(address, 8 + (count * entry) as u64)?;
    let mut fields = node.fields();
    fields.take(8)?;
    for _ in 0..count {
        let mut entry = fields.part(entry)?;
        let (name, object) = (entry.address()?, entry.address()?);
        // Symbolic links have no object.
        let (Some(name), Some(address)) = (name, object) else {
            continue;
        };
        let name = usize::try_from(name).unwrap_or(usize::MAX);
        let name = names.bytes.get(name..).unwrap_or_default();
        let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
        members.push(Member {
            name: String::from_utf8_lossy(name).into_owned(),
            address,
        });
    }
    Ok(())
}
