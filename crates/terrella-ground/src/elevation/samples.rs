//! Stored heights of a grid or a tile.

/// Stored heights of a grid or a tile.
#[derive(Clone, Debug, PartialEq)]
pub enum HeightSamples {
    /// Metres.
    F32(Vec<f32>),
    /// Metres are offset + scale × value. Samples shared by two tiles must decode to identical metres in both, to the last bit. One
    /// scale and offset for all tiles of a source is best.
    I16 {
        /// Steps.
        values: Vec<i16>,
        /// Metres at step 0; finite.
        offset_m: f64,
        /// Metres per step; finite and above 0.
        scale_m: f64,
    },
}

impl HeightSamples {
    pub fn len(&self) -> usize {
        match self {
            Self::F32(values) => values.len(),
            Self::I16 { values, .. } => values.len(),
        }
    }

    /// Whether there are no samples.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// A sample, metres.
    #[inline]
    pub(crate) fn at_m(&self, n: usize) -> f64 {
        match self {
            Self::F32(values) => f64::from(values[n]),
            Self::I16 {
                values,
                offset_m,
                scale_m,
            } => offset_m + scale_m * f64::from(values[n]),
        }
    }

    /// Bytes in memory.
    pub(crate) fn bytes(&self) -> u64 {
        match self {
            Self::F32(values) => size_of_val(values.as_slice()) as u64,
            Self::I16 { values, .. } => size_of_val(values.as_slice()) as u64,
        }
    }
}
