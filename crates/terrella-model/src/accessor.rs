//! Accessors: numbers in buffers (specification, section 3.6.2).

use super::container::Container;
use super::error::{ModelError, ModelFault};
use super::json::Accessor;
use terrella_files::printable;

/// Kinds of components by their numbers in files.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(number: u64) -> Option<Self> {
        Some(match number {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// The number in these bytes; normalized integers are converted by the equations of section 3.6.2.2.
    fn number(self, bytes: &[u8], normalized: bool) -> f32 {
        let (value, most) = match (self, bytes) {
            (Self::I8, [a]) => (f32::from(i8::from_le_bytes([*a])), 127.0),
            (Self::U8, [a]) => (f32::from(*a), 255.0),
            (Self::I16, [a, b]) => (f32::from(i16::from_le_bytes([*a, *b])), 32_767.0),
            (Self::U16, [a, b]) => (f32::from(u16::from_le_bytes([*a, *b])), 65_535.0),
            (Self::U32, [a, b, c, d]) => {
                return u32::from_le_bytes([*a, *b, *c, *d]) as f32;
            }
            (Self::F32, [a, b, c, d]) => {
                return f32::from_le_bytes([*a, *b, *c, *d]);
            }
            _ => return f32::NAN,
        };
        match normalized {
            true => f32::max(value / most, -1.0),
            false => value,
        }
    }

    fn index(self, bytes: &[u8]) -> u32 {
        match (self, bytes) {
            (Self::U8, [a]) => u32::from(*a),
            (Self::U16, [a, b]) => u32::from(u16::from_le_bytes([*a, *b])),
            (Self::U32, [a, b, c, d]) => u32::from_le_bytes([*a, *b, *c, *d]),
            _ => u32::MAX,
        }
    }
}

impl Container {
    pub fn accessor(&self, index: u64, pointer: &str) -> Result<&Accessor, ModelError> {
        self.object(&self.document.accessors, "accessor", index, pointer)
    }

    /// Rows of N numbers. At most as many as bytes of the buffers hold, or as zeros where a sparse accessor has no buffer, which
    /// callers have bounded.
    pub fn vectors<const N: usize>(
        &self,
        index: u64,
        pointer: &str,
    ) -> Result<Vec<[f32; N]>, ModelError> {
        let accessor = self.accessor(index, pointer)?;
        let pointer = format!("/accessors/{index}");
        self.check_kind(accessor, N, &pointer)?;
        let component = self.component(accessor.component_type, &pointer)?;
        let read = |bytes: &[u8]| {
            let mut row = [0.0; N];
            for (slot, bytes) in row.iter_mut().zip(bytes.chunks(component.size())) {
                *slot = component.number(bytes, accessor.normalized);
            }
            row
        };
        let row_bytes = N * component.size();
        let mut rows = match accessor.buffer_view {
            Some(_) => {
                let rows = self.rows(accessor, row_bytes, &pointer)?;
                rows.map(read).collect()
            }
            None => vec![[0.0; N]; self.count(accessor.count, &pointer)?],
        };
        if let Some(sparse) = &accessor.sparse {
            let pointer = format!("{pointer}/sparse");
            let kind = self.index_component(sparse.indices.component_type, &pointer)?;
            let count = self.count(sparse.count, &pointer)?;
            let packed = |view: u64, offset: u64, size: usize| {
                let bytes = self.view(view, offset, &pointer)?;
                let needed = count as u64 * size as u64;
                let enough = bytes.get(..count.saturating_mul(size));
                enough.ok_or_else(|| {
                    let had = bytes.len() as u64;
                    let what = "a buffer view";
                    self.error(ModelFault::Bounds { what, needed, had }, &pointer)
                })
            };
            let (indices, values) = (&sparse.indices, &sparse.values);
            let places = packed(indices.buffer_view, indices.byte_offset, kind.size())?;
            let values = packed(values.buffer_view, values.byte_offset, row_bytes)?;
            let places = places.chunks_exact(kind.size());
            for (at, (place, value)) in places.zip(values.chunks_exact(row_bytes)).enumerate() {
                let index = kind.index(place);
                let count = rows.len();
                let Some(row) = rows.get_mut(index as usize) else {
                    return Err(self.error(ModelFault::Index { at, index, count }, &pointer));
                };
                *row = read(value);
            }
        }
        Ok(rows)
    }

    /// Indices of vertices, each below `vertices`.
    pub fn indices(
        &self,
        index: u64,
        vertices: usize,
        pointer: &str,
    ) -> Result<Vec<u32>, ModelError> {
        let accessor = self.accessor(index, pointer)?;
        let pointer = format!("/accessors/{index}");
        self.check_kind(accessor, 1, &pointer)?;
        let component = self.index_component(accessor.component_type, &pointer)?;
        if accessor.sparse.is_some() || accessor.buffer_view.is_none() {
            return Err(self.error(ModelFault::Missing("bufferView for its indices"), pointer));
        }
        let rows = self.rows(accessor, component.size(), &pointer)?;
        let checked = rows.enumerate().map(|(at, bytes)| {
            let index = component.index(bytes);
            match (index as usize) < vertices {
                true => Ok(index),
                false => {
                    let count = vertices;
                    Err(self.error(ModelFault::Index { at, index, count }, &pointer))
                }
            }
        });
        checked.collect()
    }

    /// The rows of an accessor in its buffer view, all of them there.
    fn rows(
        &self,
        accessor: &Accessor,
        row_bytes: usize,
        pointer: &str,
    ) -> Result<impl Iterator<Item = &[u8]> + use<'_>, ModelError> {
        let view = accessor.buffer_view.unwrap_or_default();
        let bytes = self.view(view, accessor.byte_offset, pointer)?;
        let views = &self.document.buffer_views;
        let stride = self
            .object(views, "buffer view", view, pointer)?
            .byte_stride;
        let stride = stride.unwrap_or(row_bytes as u64);
        if !(row_bytes as u64..=252).contains(&stride) && stride != row_bytes as u64 {
            let fault = ModelFault::Value {
                key: "byteStride",
                text: stride.to_string(),
                expected: "4 to 252 bytes, and no fewer than a row has",
            };
            return Err(self.error(fault, format!("/bufferViews/{view}")));
        }
        let count = accessor.count;
        let needed = match count {
            0 => 0,
            count => (count - 1)
                .saturating_mul(stride)
                .saturating_add(row_bytes as u64),
        };
        if needed > bytes.len() as u64 {
            let (what, had) = ("a buffer view", bytes.len() as u64);
            return Err(self.error(ModelFault::Bounds { what, needed, had }, pointer));
        }
        let rows = bytes.chunks(stride as usize).take(count as usize);
        Ok(rows.filter_map(move |row| row.get(..row_bytes)))
    }

    /// A count as `usize`.
    fn count(&self, count: u64, pointer: &str) -> Result<usize, ModelError> {
        let limit = super::MAX_VERTICES;
        match usize::try_from(count) {
            Ok(small) if count <= limit => Ok(small),
            _ => {
                let what = "elements of an accessor";
                Err(self.error(ModelFault::TooMany { what, count, limit }, pointer))
            }
        }
    }

    fn component(&self, number: u64, pointer: &str) -> Result<Component, ModelError> {
        Component::of(number).ok_or_else(|| {
            let expected = "5120, 5121, 5122, 5123, 5125 or 5126";
            self.wrong("componentType", number.to_string(), expected, pointer)
        })
    }

    fn index_component(&self, number: u64, pointer: &str) -> Result<Component, ModelError> {
        let component = Component::of(number);
        let is_whole =
            |kind: &Component| matches!(kind, Component::U8 | Component::U16 | Component::U32);
        component.filter(is_whole).ok_or_else(|| {
            let expected = "5121, 5123 or 5125 for indices";
            self.wrong("componentType", number.to_string(), expected, pointer)
        })
    }

    fn check_kind(
        &self,
        accessor: &Accessor,
        columns: usize,
        pointer: &str,
    ) -> Result<(), ModelError> {
        let expected = match columns {
            1 => "SCALAR",
            2 => "VEC2",
            3 => "VEC3",
            _ => "VEC4",
        };
        match accessor.kind == expected {
            true => Ok(()),
            false => Err(self.wrong("type", printable(&accessor.kind), expected, pointer)),
        }
    }

    /// The error that a value is not what it must be.
    pub fn wrong(
        &self,
        key: &'static str,
        text: String,
        expected: &'static str,
        pointer: &str,
    ) -> ModelError {
        let fault = ModelFault::Value {
            key,
            text,
            expected,
        };
        self.error(fault, pointer)
    }
}
