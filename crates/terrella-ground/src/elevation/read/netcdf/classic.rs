//! The classic container (CDF-1, CDF-2) and the one for 64-bit data (CDF-5).
//!
//! Format: Unidata, "The NetCDF Classic Format Specification"; "CDF-5 Format Specification". All numbers are big-endian; names and values are padded
//! to four bytes.

use super::number::NumberType;
use super::stored::Values;
use super::variable::{AttributeValue, Attributes, Contents, MAX_ENTRIES, TEXT_BYTES, Variable};
use crate::elevation::read::HeightFileError;
use crate::elevation::read::error::FileContext;
use std::io::Read;

/// Largest header, bytes.
const HEADER_BYTES: u64 = 1 << 20;

/// Reads the header of a file, from its first byte.
pub(super) fn contents<R: Read>(
    reader: &mut R,
    context: &FileContext,
) -> Result<Contents, HeightFileError> {
    let mut head = HeaderReader {
        reader: reader.take(HEADER_BYTES),
        context,
        version: 0,
    };
    // The caller has checked the first three bytes.
    [_, _, _, head.version] = head.bytes()?;
    let records = head.count()?;
    let mut dimensions = Vec::new();
    for _ in 0..head.list(10)? {
        let name = head.name()?;
        // A single record is contiguous, as data without records are; several records are interleaved.
        let length = match head.count()? {
            0 if records == 1 => 1,
            length => length,
        };
        dimensions.push((name, length));
    }
    let attributes = head.attributes()?;
    let mut variables = Vec::new();
    for _ in 0..head.list(11)? {
        variables.push(head.variable(dimensions.len())?);
    }
    Ok(Contents {
        dimensions,
        attributes,
        variables,
    })
}

/// Reads the header byte by byte, within a limit.
struct HeaderReader<'a, R> {
    reader: std::io::Take<&'a mut R>,
    context: &'a FileContext,
    version: u8,
}

impl<R: Read> HeaderReader<'_, R> {
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], HeightFileError> {
        let mut bytes = [0; N];
        let read = self.reader.read_exact(&mut bytes);
        read.map_err(|error| self.context.reading(error))?;
        Ok(bytes)
    }

    fn word(&mut self) -> Result<u32, HeightFileError> {
        self.bytes().map(u32::from_be_bytes)
    }

    /// A count: 64 bits wide in CDF-5.
    fn count(&mut self) -> Result<u64, HeightFileError> {
        match self.version {
            5 => self.bytes().map(u64::from_be_bytes),
            _ => self.word().map(u64::from),
        }
    }

    /// Reads this many bytes and their padding; keeps only the first [`TEXT_BYTES`].
    fn run(&mut self, bytes: u64) -> Result<Vec<u8>, HeightFileError> {
        let kept = bytes.min(TEXT_BYTES);
        let mut run = vec![0; kept as usize];
        let read = self.reader.read_exact(&mut run);
        read.map_err(|error| self.context.reading(error))?;
        let rest = bytes.saturating_add(3) / 4 * 4 - kept;
        let skipped = std::io::copy(&mut (&mut self.reader).take(rest), &mut std::io::sink());
        if skipped.map_err(|error| self.context.reading(error))? < rest {
            return Err(self.context.damaged("the file ends too early"));
        }
        Ok(run)
    }

    fn name(&mut self) -> Result<String, HeightFileError> {
        let length = self.count()?;
        if length > TEXT_BYTES {
            return Err(self.context.damaged("a name of more than 256 bytes"));
        }
        let bytes = self.run(length)?;
        Ok(String::from_utf8_lossy(&bytes).into_owned())
    }

    /// Number of entries in a list with this tag.
    fn list(&mut self, tag: u32) -> Result<u64, HeightFileError> {
        let (found, count) = (self.word()?, self.count()?);
        match (found, count) {
            (0, 0) => Ok(0),
            (found, count) if found == tag && count <= MAX_ENTRIES => Ok(count),
            _ => Err(self.context.damaged("a list in the header is not one")),
        }
    }

    fn kind(&mut self) -> Result<NumberType, HeightFileError> {
        let code = self.word()?;
        NumberType::from_code(code, self.version)
            .ok_or_else(|| self.context.damaged("an unknown type of numbers"))
    }

    fn attributes(&mut self) -> Result<Attributes, HeightFileError> {
        let mut attributes = Vec::new();
        for _ in 0..self.list(12)? {
            let name = self.name()?;
            let kind = self.kind()?;
            let count = self.count()?;
            let bytes = self.run(count.saturating_mul(kind.bytes() as u64))?;
            let value = match kind {
                NumberType::Char => {
                    AttributeValue::Text(String::from_utf8_lossy(&bytes).into_owned())
                }
                // The rest after the last number is padding to four bytes.
                kind => {
                    let numbers = bytes.chunks_exact(kind.bytes());
                    let numbers = numbers.filter_map(|bytes| kind.number(bytes));
                    let count = usize::try_from(count).unwrap_or(usize::MAX);
                    AttributeValue::Numbers(kind, numbers.take(count).collect())
                }
            };
            attributes.push((name, value));
        }
        Ok(attributes)
    }

    fn variable(&mut self, dimensions: usize) -> Result<Variable, HeightFileError> {
        let name = self.name()?;
        let count = self.count()?;
        if count > MAX_ENTRIES {
            return Err(self.context.damaged("a variable of too many dimensions"));
        }
        let mut of_variable = Vec::new();
        for _ in 0..count {
            let dimension = self.count()?;
            if dimension >= dimensions as u64 {
                return Err(self
                    .context
                    .damaged("a variable of a dimension that is not there"));
            }
            of_variable.push(dimension as usize);
        }
        let attributes = self.attributes()?;
        let kind = self.kind()?;
        // The size that follows is redundant.
        self.count()?;
        let begin = match self.version {
            1 => u64::from(self.word()?),
            _ => self.bytes().map(u64::from_be_bytes)?,
        };
        Ok(Variable {
            name,
            dimensions: of_variable,
            attributes,
            kind,
            values: Values::Plain { begin },
        })
    }
}
