//! Number types.

/// Number type of the file. All containers deliver big-endian bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum NumberType {
    Byte,
    Char,
    Short,
    Int,
    Float,
    Double,
    UnsignedByte,
    UnsignedShort,
    UnsignedInt,
    Long,
    UnsignedLong,
}

impl NumberType {
    /// The type of a classic container's code. CDF-5 has all types, the others only the first six.
    pub(super) fn from_code(code: u32, version: u8) -> Option<Self> {
        use NumberType::{Byte, Char, Double, Float, Int, Long, Short};
        use NumberType::{UnsignedByte, UnsignedInt, UnsignedLong, UnsignedShort};
        let all = [
            Byte,
            Char,
            Short,
            Int,
            Float,
            Double,
            UnsignedByte,
            UnsignedShort,
            UnsignedInt,
            Long,
            UnsignedLong,
        ];
        let known = if version == 5 { &all[..] } else { &all[..6] };
        known.get((code as usize).checked_sub(1)?).copied()
    }

    /// Rank by width: a float is above an integer of the same size.
    pub(super) fn rank(self) -> usize {
        2 * self.bytes() + usize::from(matches!(self, Self::Float | Self::Double))
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Byte | Self::Char | Self::UnsignedByte => 1,
            Self::Short | Self::UnsignedShort => 2,
            Self::Int | Self::Float | Self::UnsignedInt => 4,
            Self::Double | Self::Long | Self::UnsignedLong => 8,
        }
    }

    /// The first number of `bytes`, if it contains one.
    #[inline]
    pub(super) fn number(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::Byte => f64::from(*bytes.first()? as i8),
            Self::Char => return None,
            Self::Short => f64::from(i16::from_be_bytes(*bytes.first_chunk()?)),
            Self::Int => f64::from(i32::from_be_bytes(*bytes.first_chunk()?)),
            Self::Float => f64::from(f32::from_be_bytes(*bytes.first_chunk()?)),
            Self::Double => f64::from_be_bytes(*bytes.first_chunk()?),
            Self::UnsignedByte => f64::from(*bytes.first()?),
            Self::UnsignedShort => f64::from(u16::from_be_bytes(*bytes.first_chunk()?)),
            Self::UnsignedInt => f64::from(u32::from_be_bytes(*bytes.first_chunk()?)),
            Self::Long => i64::from_be_bytes(*bytes.first_chunk()?) as f64,
            Self::UnsignedLong => u64::from_be_bytes(*bytes.first_chunk()?) as f64,
        })
    }

    /// Reinterprets a negative number of a signed integer type as unsigned. Other numbers stay.
    #[inline]
    pub(super) fn unsigned(self, number: f64) -> f64 {
        match self {
            Self::Byte | Self::Short | Self::Int | Self::Long if number < 0.0 => {
                number + (8.0 * self.bytes() as f64).exp2()
            }
            _ => number,
        }
    }

    /// The library's default fill value.
    pub(super) fn default_fill(self) -> Option<f64> {
        match self {
            Self::Byte | Self::Char | Self::UnsignedByte => None,
            Self::Short => Some(-32_767.0),
            Self::Int => Some(-2_147_483_647.0),
            Self::Float | Self::Double => Some(9.969_209_968_386_869e36),
            Self::UnsignedShort => Some(65_535.0),
            Self::UnsignedInt => Some(4_294_967_295.0),
            Self::Long => Some(-9_223_372_036_854_775_806_i64 as f64),
            Self::UnsignedLong => Some(18_446_744_073_709_551_614_u64 as f64),
        }
    }
}
