//! Messages that describe values (HDF5 File Format Specification, IV.A.2): sizes, types and attributes.

use super::source::{Fault, Fields};
use crate::elevation::read::netcdf::number::NumberType;

/// Maximum number of dimensions (IV.A.2.b).
pub const MAX_RANK: usize = 32;

/// Dimensions of a data set.
pub struct Dataspace {
    pub sides: Vec<u64>,
    /// Maximum sizes; all bits set means unlimited.
    pub most: Vec<u64>,
}

impl Dataspace {
    pub fn read(mut fields: Fields<'_>) -> Result<Self, Fault> {
        let (version, rank, flags) = (fields.byte()?, fields.byte()?, fields.byte()?);
        let is_null = match version {
            1 => {
                fields.take(5)?;
                false
            }
            2 => fields.byte()? == 2,
            _ => return Err(fields.damaged("sizes of an unknown version")),
        };
        let rank = usize::from(rank);
        if rank > MAX_RANK {
            return Err(fields.damaged("values of more than 32 dimensions"));
        }
        let read = |fields: &mut Fields<'_>| {
            let sides = (0..rank).map(|_| fields.length());
            sides.collect::<Result<Vec<_>, _>>()
        };
        let sides = read(&mut fields)?;
        let most = match flags & 1 {
            0 => sides.clone(),
            _ => {
                let undefined = u64::MAX >> (64 - 8 * fields.sizes.length);
                let most = read(&mut fields)?;
                let all = most.into_iter();
                all.map(|most| if most == undefined { u64::MAX } else { most })
                    .collect()
            }
        };
        let sides = if is_null { vec![0] } else { sides };
        Ok(Self { sides, most })
    }

    /// Number of values.
    fn count(&self) -> u64 {
        let product = |all: u64, side: &u64| all.saturating_mul(*side);
        self.sides.iter().fold(1, product)
    }
}

/// Supported types of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Datatype {
    Number {
        kind: NumberType,
        is_little: bool,
    },
    /// Text of a fixed length.
    Text,
    /// Text in a global heap.
    HeapText,
    /// Lists of object addresses in a global heap.
    HeapReferences,
    /// Address of an object.
    Reference,
    Other,
}

/// A type, and the bytes per value.
pub fn datatype(mut fields: Fields<'_>) -> Result<(Datatype, usize), Fault> {
    use NumberType::{Byte, Double, Float, Int, Long, Short};
    use NumberType::{UnsignedByte, UnsignedInt, UnsignedLong, UnsignedShort};
    let class = fields.byte()? & 0x0F;
    let bits = fields.number(3)?;
    let bytes = fields.word()? as usize;
    let is_little = bits & 1 == 0;
    let number = |kind| Datatype::Number { kind, is_little };
    let read = match class {
        0 => {
            let (offset, precision) = (fields.short()?, fields.short()?);
            let is_whole = offset == 0 && precision == 8 * bytes;
            match (bytes, bits & 8 != 0) {
                _ if !is_whole => Datatype::Other,
                (1, true) => number(Byte),
                (2, true) => number(Short),
                (4, true) => number(Int),
                (8, true) => number(Long),
                (1, false) => number(UnsignedByte),
                (2, false) => number(UnsignedShort),
                (4, false) => number(UnsignedInt),
                (8, false) => number(UnsignedLong),
                _ => Datatype::Other,
            }
        }
        1 => {
            let (offset, precision) = (fields.short()?, fields.short()?);
            let [_, exponent, _, mantissa] = *fields.take(4)? else {
                return Ok((Datatype::Other, bytes));
            };
            // IEEE 754; VAX sets both bits of the byte order.
            match (offset, precision, exponent, mantissa, bits & 0x40) {
                (0, 32, 8, 23, 0) if bytes == 4 => number(Float),
                (0, 64, 11, 52, 0) if bytes == 8 => number(Double),
                _ => Datatype::Other,
            }
        }
        3 => Datatype::Text,
        7 if bits & 0x0F == 0 => Datatype::Reference,
        9 if bits & 0x0F == 1 => Datatype::HeapText,
        9 if matches!(datatype(fields), Ok((Datatype::Reference, _))) => Datatype::HeapReferences,
        _ => Datatype::Other,
    };
    Ok((read, bytes))
}

/// An attribute with undecoded values.
pub struct Attribute<'a> {
    pub name: String,
    pub datatype: Datatype,
    /// Bytes per value.
    pub bytes: usize,
    pub count: u64,
    pub values: Fields<'a>,
}

/// Reads an attribute; `None` if its type is stored elsewhere.
pub fn attribute(mut fields: Fields<'_>) -> Result<Option<Attribute<'_>>, Fault> {
    let (version, flags) = (fields.byte()?, fields.byte()?);
    let (name, of_type, of_space) = (fields.short()?, fields.short()?, fields.short()?);
    // Version 1 pads all three.
    let padded = |bytes: usize| match version {
        1 => bytes.next_multiple_of(8),
        _ => bytes,
    };
    match version {
        1 => {}
        2 | 3 if flags != 0 => return Ok(None),
        2 => {}
        3 => drop(fields.take(1)?),
        _ => return Err(fields.damaged("an attribute of an unknown version")),
    }
    let name = fields.take(padded(name))?;
    let name = name.split(|byte| *byte == 0).next().unwrap_or_default();
    let (datatype, bytes) = datatype(fields.part(padded(of_type))?)?;
    let count = Dataspace::read(fields.part(padded(of_space))?)?.count();
    Ok(Some(Attribute {
        name: String::from_utf8_lossy(name).into_owned(),
        datatype,
        bytes,
        count,
        values: fields,
    }))
}
