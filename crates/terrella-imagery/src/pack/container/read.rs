//! Reading a tile, of which nothing is believed.

use super::descriptor::{PLANE_SIZES, descriptor, vulkan_format};
use super::{MAX_OVERHEAD_BYTES, SCHEME_ZSTD};
use crate::pack::zstandard::decompress;
use crate::tile::{TILE_MIPS, Tile, TileFormat, TileShape};

/// Reads the tile of a KTX2 file, which must have this format and shape.
///
/// Header and level index are checked before anything is allocated; then exactly the bytes of the shape are allocated, and no more is decompressed
/// than fits.
///
/// # Errors
/// The error in the file, without its name.
pub fn read_ktx2(bytes: &[u8], format: TileFormat, shape: TileShape) -> Result<Tile, String> {
    let most = shape.bytes(format) + MAX_OVERHEAD_BYTES;
    if bytes.len() > most {
        return Err(format!(
            "it has {} bytes, and a tile of {} texels has at most {most}",
            bytes.len(),
            shape.side()
        ));
    }
    let start = bytes.first_chunk().ok_or("it ends within its header")?;
    let header =
        ktx2::Header::from_bytes(start).map_err(|error| format!("it is no KTX2 file: {error}"))?;
    check_header(start, &header, format, shape)?;
    // Only the crate's readers of header, level index and key/value data are used: the one for whole files adds one to a byte of the descriptor and
    // panics if it is 255.
    check_descriptor(bytes, &header.index, format)?;
    check_key_values(bytes, &header.index)?;
    let levels = levels(bytes, format, shape)?;

    let mut texels = vec![0; shape.bytes(format)];
    let mut rest = texels.as_mut_slice();
    for (mip, level) in (0..).zip(levels) {
        let (image, following) = rest.split_at_mut(format.image_bytes(shape.mip_side(mip)));
        decompress(level, image)
            .map_err(|cause| format!("mip level {mip} cannot be decompressed: {cause}"))?;
        rest = following;
    }
    Ok(Tile {
        format,
        shape,
        texels,
    })
}

fn check_header(
    bytes: &[u8; ktx2::Header::LENGTH],
    header: &ktx2::Header,
    format: TileFormat,
    shape: TileShape,
) -> Result<(), String> {
    // As numbers: the crate's enums are `None` for unknown ones.
    let word =
        |at: usize| u32::from_le_bytes([bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]]);
    let side = shape.side();
    let expected = [
        ("the Vulkan format", word(12), vulkan_format(format)),
        ("the type size", header.type_size, 1),
        ("the width", header.pixel_width, side),
        ("the height", header.pixel_height, side),
        ("the depth", header.pixel_depth, 0),
        ("the number of array layers", header.layer_count, 0),
        ("the number of faces", header.face_count, 1),
        ("the number of mip levels", header.level_count, TILE_MIPS),
        ("the supercompression scheme", word(44), SCHEME_ZSTD),
    ];
    for (what, found, needed) in expected {
        if found != needed {
            return Err(format!("{what} is {found} and must be {needed}"));
        }
    }
    if header.index.sgd_byte_length != 0 {
        return Err("it has supercompression global data, which Zstandard has not".into());
    }
    Ok(())
}

fn check_descriptor(bytes: &[u8], index: &ktx2::Index, format: TileFormat) -> Result<(), String> {
    let found = section(bytes, index.dfd_byte_offset, index.dfd_byte_length)
        .ok_or("it ends within its data format descriptor")?;
    let expected = descriptor(format);
    // Earlier revisions of the specification had the sizes of planes left out of compressed files.
    let mut unsized_planes = expected.clone();
    unsized_planes[PLANE_SIZES].fill(0);
    if found != expected && found != unsized_planes {
        return Err(format!(
            "its data format descriptor is not that of {format:?} texels"
        ));
    }
    Ok(())
}

/// Of the key/value data only the orientation matters.
fn check_key_values(bytes: &[u8], index: &ktx2::Index) -> Result<(), String> {
    let data = section(bytes, index.kvd_byte_offset, index.kvd_byte_length)
        .ok_or("it ends within its key/value data")?;
    for (key, value) in ktx2::KeyValueDataIterator::new(data) {
        if key == "KTXorientation" && value != b"rd\0" {
            return Err("its texels do not run right and down (KTXorientation)".into());
        }
    }
    Ok(())
}

fn section(bytes: &[u8], offset: u32, len: u32) -> Option<&[u8]> {
    let start = offset as usize;
    bytes.get(start..start.checked_add(len as usize)?)
}

/// The compressed levels, the base first, their declared sizes checked.
fn levels(
    bytes: &[u8],
    format: TileFormat,
    shape: TileShape,
) -> Result<[&[u8]; TILE_MIPS as usize], String> {
    let mut levels = [&bytes[..0]; TILE_MIPS as usize];
    for (mip, level) in (0..).zip(&mut levels) {
        let at = ktx2::Header::LENGTH + mip as usize * ktx2::LevelIndex::LENGTH;
        let entry = bytes
            .get(at..)
            .and_then(<[u8]>::first_chunk)
            .map(ktx2::LevelIndex::from_bytes)
            .ok_or("it ends within its level index")?;
        let needed = format.image_bytes(shape.mip_side(mip)) as u64;
        if entry.uncompressed_byte_length != needed {
            return Err(format!(
                "mip level {mip} says that it has {} bytes uncompressed and must have {needed}",
                entry.uncompressed_byte_length
            ));
        }
        let end = entry.byte_offset.checked_add(entry.byte_length);
        let range = usize::try_from(entry.byte_offset)
            .ok()
            .zip(end.and_then(|end| usize::try_from(end).ok()));
        *level = range
            .and_then(|(start, end)| bytes.get(start..end))
            .ok_or_else(|| format!("it ends within mip level {mip}"))?;
    }
    Ok(levels)
}
