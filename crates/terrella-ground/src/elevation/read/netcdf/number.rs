//! Types of numbers.

/// Number type of the file: its code and bytes.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum NumberType {
    Byte,
    Char,
    Short,
    Int,
    Float,
    Double,
}

impl NumberType {
    pub(super) fn from_code(code: u32) -> Option<Self> {
        use NumberType::{Byte, Char, Double, Float, Int, Short};
        let all = [Byte, Char, Short, Int, Float, Double];
        all.get((code as usize).checked_sub(1)?).copied()
    }

    /// Its place in the order of width.
    pub(super) fn rank(self) -> u32 {
        self as u32
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::Byte | Self::Char => 1,
            Self::Short => 2,
            Self::Int | Self::Float => 4,
            Self::Double => 8,
        }
    }

    /// The first number of some bytes that hold one at least.
    pub(super) fn number(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::Byte => f64::from(*bytes.first()? as i8),
            Self::Char => return None,
            Self::Short => f64::from(i16::from_be_bytes(*bytes.first_chunk()?)),
            Self::Int => f64::from(i32::from_be_bytes(*bytes.first_chunk()?)),
            Self::Float => f64::from(f32::from_be_bytes(*bytes.first_chunk()?)),
            Self::Double => f64::from_be_bytes(*bytes.first_chunk()?),
        })
    }

    /// Numbers of whole, signed kinds that are meant as unsigned, and no others: what a negative one stands for.
    pub(super) fn unsigned(self, number: f64) -> f64 {
        match self {
            Self::Byte | Self::Short | Self::Int if number < 0.0 => {
                number + (8.0 * self.bytes() as f64).exp2()
            }
            _ => number,
        }
    }

    /// What the library fills unwritten values with.
    pub(super) fn default_fill(self) -> Option<f64> {
        match self {
            Self::Byte | Self::Char => None,
            Self::Short => Some(-32_767.0),
            Self::Int => Some(-2_147_483_647.0),
            Self::Float | Self::Double => Some(9.969_209_968_386_869e36),
        }
    }
}
