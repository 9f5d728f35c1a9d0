//! Formats of raw frames.

/// The format of a raw frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Deserialize, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RawFormat {
    /// Greyscale PNG of 16 bits.
    Png,
    /// Greyscale TIFF of 16 bits.
    Tiff,
    /// A NumPy array.
    Npy,
}

impl RawFormat {
    /// The ending of its files.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Png => "png",
            Self::Tiff => "tiff",
            Self::Npy => "npy",
        }
    }
}
