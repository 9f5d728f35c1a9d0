//! What the tags of a GeoTIFF say of its place, as they stand (OGC 19-008r4).

use std::io::{Read, Seek};
use tiff::decoder::Decoder;
use tiff::tags::Tag;

/// The key of the model: 1 is projected, 2 geographic, 3 geocentric.
pub(crate) const MODEL_TYPE: u16 = 1024;
/// The key of the raster: 1 has areas, 2 points.
pub(crate) const RASTER_TYPE: u16 = 1025;

/// What the tags say, as far as they are there.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct GeoTags {
    /// Size of a sample, to the east and to the south.
    pub scale: Option<Vec<f64>>,
    /// Column, row, (level) and longitude, latitude, (height) of points.
    pub tie: Option<Vec<f64>>,
    /// The affine map from columns and rows, 4 × 4 row-major.
    pub matrix: Option<Vec<f64>>,
    /// Pairs of (key, value) of the keys whose value is a number.
    pub keys: Vec<(u16, u16)>,
}

impl GeoTags {
    /// Tags that are not there or not of the right kind say nothing.
    pub(crate) fn read<R: Read + Seek>(decoder: &mut Decoder<R>) -> Self {
        let mut numbers = |tag| decoder.get_tag_f64_vec(tag).ok();
        let scale = numbers(Tag::ModelPixelScaleTag);
        let tie = numbers(Tag::ModelTiepointTag);
        let matrix = numbers(Tag::ModelTransformationTag);
        let keys = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag);
        Self {
            scale,
            tie,
            matrix,
            keys: keys.map(|keys| Self::read_keys(&keys)).unwrap_or_default(),
        }
    }

    /// The keys of a key directory: four numbers a key after a header of four.
    fn read_keys(directory: &[u16]) -> Vec<(u16, u16)> {
        let (entries, _) = directory.get(4..).unwrap_or(&[]).as_chunks::<4>();
        entries
            .iter()
            .filter(|[_, place, count, _]| *place == 0 && *count == 1)
            .map(|[key, _, _, value]| (*key, *value))
            .collect()
    }

    /// The value of a key that has one.
    pub(crate) fn key(&self, key: u16) -> Option<u16> {
        self.keys.iter().find(|(k, _)| *k == key).map(|(_, v)| *v)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_with_values_elsewhere_are_passed_over() {
        let directory = [1, 1, 0, 2, 1024, 0, 1, 2, 2049, 34737, 7, 0, 1025, 0];
        assert_eq!(GeoTags::read_keys(&directory), [(1024, 2)]);
        assert_eq!(GeoTags::read_keys(&[1]), []);
    }
}
