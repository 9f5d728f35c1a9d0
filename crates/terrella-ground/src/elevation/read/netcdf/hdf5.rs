//! The container of NetCDF-4: the subset of HDF5 that NetCDF-4, GMT, GDAL and h5py use for grids.
//!
//! Format: The HDF Group, "HDF5 File Format Specification", version 3.0 (superblocks 0 to 3, object headers 1 and 2, all chunk indexes). Unidata,
//! "NetCDF-4 File Format"; The HDF Group, "HDF5 Dimension Scale Specification". The reader reads the variables of all groups; those below the root
//! are named by their path, `group/name`. A complete HDF5 reader has some 30 000 lines and maps files into memory. This one reads each block within
//! limits, and verifies its checksum if it has one.

mod chunks;
mod filters;
mod group;
mod heap;
mod index;
pub(super) mod layout;
mod message;
mod object;
mod source;
mod tree;

use super::number::NumberType;
use super::stored::Values;
use super::variable::{AttributeValue, Attributes, Contents, TEXT_BYTES, Variable};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use layout::Layout;
use message::{Attribute, Dataspace, Datatype};
use object::{Object, kind};
use source::{Fault, Fields, Sizes, Source};
use std::collections::HashMap;
use std::io::{Read, Seek, SeekFrom};

/// The class name of a dimension scale.
const SCALE: &str = "DIMENSION_SCALE";

/// Prefix that NetCDF-4 writes, before the length, for the scale of a dimension without
/// coordinates.
const NO_VARIABLE: &str = "This is a netCDF dimension but not a netCDF variable";

/// Prefix that NetCDF-4 writes for a variable that has the name of a dimension but is not its scale.
const NOT_A_SCALE: &str = "_nc4_non_coord_";

/// Reads the headers of a file, from its first byte.
pub(super) fn contents<R: Read + Seek>(
    reader: &mut R,
    context: &FileContext,
) -> Result<Contents, HeightFileError> {
    read(reader).map_err(|fault| fault.of_file(context))
}

/// Attributes of an object.
struct Said {
    attributes: Attributes,
    /// The addresses of the dimension scales of each dimension.
    scales: Vec<Option<u64>>,
}

fn read<R: Read + Seek>(reader: &mut R) -> Result<Contents, Fault> {
    let (mut source, root) = superblock(reader)?;
    let root = Object::read(&mut source, root)?;
    let of_file = said(&mut source, &root)?;
    let mut sets = Vec::new();
    let mut dimensions = Vec::new();
    // Dimensions by the address of their scale's header.
    let mut scales = HashMap::new();
    for (member, object) in group::tree(&mut source, &root)? {
        let Some(space) = object.one(kind::DATASPACE) else {
            continue;
        };
        let space = Dataspace::read(space)?;
        let of_set = said(&mut source, &object)?;
        let class = super::variable::text(&of_set.attributes, "CLASS");
        if let ([length], Some(SCALE)) = (&space.sides[..], class) {
            scales.insert(member.address, dimensions.len());
            dimensions.push((member.name.clone(), *length));
        }
        sets.push((member, object, space, of_set));
    }
    let mut variables = Vec::new();
    for (member, object, space, of_set) in sets {
        let name = super::variable::text(&of_set.attributes, "NAME");
        if name.is_some_and(|name| name.starts_with(NO_VARIABLE)) {
            continue;
        }
        let Some(datatype) = object.one(kind::DATATYPE) else {
            continue;
        };
        let (datatype, bytes) = message::datatype(datatype)?;
        let (kind, is_little) = match datatype {
            Datatype::Number { kind, is_little } => (kind, is_little),
            // A grid mapping has attributes only.
            Datatype::Text | Datatype::HeapText if space.sides.is_empty() => {
                (NumberType::Char, true)
            }
            _ => continue,
        };
        let own = scales.get(&member.address).copied();
        let of_variable = space.sides.iter().enumerate().map(|(n, length)| {
            let scale = of_set.scales.get(n).copied().flatten();
            let scale = scale.and_then(|scale| scales.get(&scale)).copied();
            // A dimension without a scale has no name.
            own.or(scale).unwrap_or_else(|| {
                dimensions.push((String::new(), *length));
                dimensions.len() - 1
            })
        });
        let of_variable = of_variable.collect();
        let name = match member.name.rsplit_once('/') {
            Some((group, name)) => format!("{group}/{}", name.trim_start_matches(NOT_A_SCALE)),
            None => member.name.trim_start_matches(NOT_A_SCALE).to_owned(),
        };
        let layout = Layout::read(&object, space, bytes, is_little, source.sizes)?;
        variables.push(Variable {
            name,
            dimensions: of_variable,
            attributes: of_set.attributes,
            kind,
            values: Values::Hdf5(Box::new(layout)),
        });
    }
    Ok(Contents {
        dimensions,
        attributes: of_file.attributes,
        variables,
    })
}

/// Reads the superblock: the sizes of fields, and the address of the root group.
fn superblock<R: Read + Seek>(reader: &mut R) -> Result<(Source<'_, R>, u64), Fault> {
    let file = reader.seek(SeekFrom::End(0))?;
    let mut sizes = Sizes {
        base: 0,
        file,
        address: 8,
        length: 8,
    };
    // The longest fixed part and 8 addresses.
    let mut source = Source::new(reader, sizes);
    let block = source.block(0, file.min(96))?;
    let mut fields = block.fields();
    fields.take(8)?;
    let version = fields.byte()?;
    let possible = |bytes: u8| matches!(bytes, 2 | 4 | 8).then_some(usize::from(bytes));
    let impossible = || block.fields().damaged("a superblock of impossible sizes");
    fields.take(if version < 2 { 4 } else { 0 })?;
    sizes.address = possible(fields.byte()?).ok_or_else(impossible)?;
    sizes.length = possible(fields.byte()?).ok_or_else(impossible)?;
    fields.sizes = sizes;
    let root = match version {
        0 | 1 => {
            // Version 1 has one more field.
            fields.take(if version == 0 { 9 } else { 13 })?;
            sizes.base = fields.defined()?;
            fields.take(3 * sizes.address)?;
            fields.address()?;
            fields.defined()?
        }
        2 | 3 => {
            fields.take(1)?;
            sizes.base = fields.defined()?;
            fields.take(2 * sizes.address)?;
            let root = fields.defined()?;
            let bytes = 16 + 4 * sizes.address as u64;
            source.checked(0, bytes, b"\x89HDF", "no superblock")?;
            root
        }
        _ => {
            return Err(Fault::Unsupported(format!(
                "is HDF5 with a superblock of version {version}"
            )));
        }
    };
    source.sizes = sizes;
    Ok((source, root))
}

/// Reads the attributes of an object that hold text or numbers, and the scales of its dimensions.
fn said<R: Read + Seek>(source: &mut Source<'_, R>, object: &Object) -> Result<Said, Fault> {
    let mut said = Said {
        attributes: Vec::new(),
        scales: Vec::new(),
    };
    for (is_shared, fields) in object.all(kind::ATTRIBUTE) {
        if !is_shared {
            said.add(source, fields)?;
        }
    }
    if let Some(mut info) = object.one(kind::ATTRIBUTE_INFO) {
        let flags = info.take(2)?[1];
        info.take(if flags & 1 == 0 { 0 } else { 2 })?;
        if let (Some(heap), Some(index)) = (info.address()?, info.address()?) {
            let heap = heap::FractalHeap::read(source, heap)?;
            let records = tree::records(source, index)?;
            let mut fields = records.block.fields();
            while !fields.bytes.is_empty() {
                let id = fields.part(records.record)?;
                if let Some(attribute) = heap.object(source, id)? {
                    said.add(source, attribute.fields())?;
                }
            }
        }
    }
    Ok(said)
}

impl Said {
    fn add<R: Read + Seek>(
        &mut self,
        source: &mut Source<'_, R>,
        fields: Fields<'_>,
    ) -> Result<(), Fault> {
        let Some(mut attribute) = message::attribute(fields)? else {
            return Ok(());
        };
        let value = match attribute.datatype {
            Datatype::Number { kind, is_little } => {
                let mut numbers = Vec::new();
                let most = TEXT_BYTES / kind.bytes() as u64;
                for _ in 0..attribute.count.min(most) {
                    let mut bytes = attribute.values.take(attribute.bytes)?.to_vec();
                    if is_little {
                        bytes.reverse();
                    }
                    numbers.extend(kind.number(&bytes));
                }
                AttributeValue::Numbers(kind, numbers)
            }
            Datatype::Text => {
                let text = attribute.values.take(attribute.bytes)?;
                AttributeValue::Text(
                    String::from_utf8_lossy(&text[..text.len().min(TEXT_BYTES as usize)])
                        .into_owned(),
                )
            }
            Datatype::HeapText => {
                let text = in_heap(source, &mut attribute, 1)?.unwrap_or_default();
                AttributeValue::Text(String::from_utf8_lossy(&text).into_owned())
            }
            Datatype::HeapReferences if attribute.name == "DIMENSION_LIST" => {
                for _ in 0..attribute.count.min(message::MAX_RANK as u64) {
                    // The first scale is NetCDF's.
                    let bytes = source.sizes.address;
                    let scale = in_heap(source, &mut attribute, bytes)?;
                    let mut all = [0; 8];
                    let scale = scale.filter(|scale| scale.len() >= bytes);
                    self.scales.push(scale.map(|scale| {
                        all[..bytes].copy_from_slice(&scale[..bytes]);
                        u64::from_le_bytes(all)
                    }));
                }
                return Ok(());
            }
            Datatype::HeapReferences | Datatype::Reference | Datatype::Other => return Ok(()),
        };
        self.attributes.push((attribute.name, value));
        Ok(())
    }
}

/// The next value of variable length, with elements of `bytes` bytes; truncated to the maximum text length.
fn in_heap<R: Read + Seek>(
    source: &mut Source<'_, R>,
    attribute: &mut Attribute<'_>,
    bytes: usize,
) -> Result<Option<Vec<u8>>, Fault> {
    let count = attribute.values.word()? as usize;
    let (heap, index) = (attribute.values.address()?, attribute.values.word()?);
    let Some(heap) = heap.filter(|_| count > 0) else {
        return Ok(None);
    };
    let mut value = heap::global(source, heap, index)?;
    value.truncate(count.saturating_mul(bytes).min(TEXT_BYTES as usize));
    Ok(Some(value))
}
