use super::*;
use crate::tile::{TILE_MIPS, Tile, TileFormat, TileShape};

const FORMATS: [TileFormat; 6] = [
    TileFormat::Rgba8Srgb,
    TileFormat::R8Unorm,
    TileFormat::Rg8Snorm,
    TileFormat::Bc7Srgb,
    TileFormat::Bc4Unorm,
    TileFormat::Bc5Snorm,
];

/// A tile of texels that compress only in part.
fn tile(format: TileFormat, pixels: u32) -> Tile {
    let shape = TileShape::new(pixels).expect("in range");
    let texels = (0..shape.bytes(format) as u64)
        .map(|n| (n.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> (56 + n / 97 % 8)) as u8)
        .collect();
    Tile {
        format,
        shape,
        texels,
    }
}

fn word(bytes: &[u8], at: usize) -> u32 {
    u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
}

fn long(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().unwrap())
}

#[test]
fn tiles_of_all_formats_and_shapes_come_back() {
    for format in FORMATS {
        for pixels in [16, 17, 75, 135, 150, 256, 675] {
            let tile = tile(format, pixels);
            let file = write_ktx2(&tile);
            assert_eq!(file, write_ktx2(&tile), "the same bytes again");
            assert!(file.len() <= tile.texels.len() + MAX_OVERHEAD_BYTES);
            assert_eq!(read_ktx2(&file, format, tile.shape), Ok(tile));
        }
    }
}

/// Every field at its byte offset according to the KTX 2.0 specification, without our own reader.
#[test]
fn files_are_as_the_specification_says() {
    // Vulkan format, colour model, transfer function, side of a unit, bytes of a unit, and for each sample: bit
    // offset, bits, channel with qualifiers, lower, upper.
    type Sample = (u32, u32, u32, u32, u32);
    type Expected = (TileFormat, u32, u8, u8, u8, u32, &'static [Sample]);
    let expected: [Expected; 6] = [
        (
            TileFormat::Rgba8Srgb,
            43,
            1,
            2,
            1,
            4,
            &[
                (0, 8, 0, 0, 255),
                (8, 8, 1, 0, 255),
                (16, 8, 2, 0, 255),
                (24, 8, 15 | 0x10, 0, 255),
            ],
        ),
        (TileFormat::R8Unorm, 9, 1, 1, 1, 1, &[(0, 8, 0, 0, 255)]),
        (
            TileFormat::Rg8Snorm,
            17,
            1,
            1,
            1,
            2,
            &[
                (0, 8, 0x40, 0xffff_ff81, 0x7f),
                (8, 8, 0x41, 0xffff_ff81, 0x7f),
            ],
        ),
        (
            TileFormat::Bc7Srgb,
            146,
            134,
            2,
            4,
            16,
            &[(0, 128, 0, 0, 0xffff_ffff)],
        ),
        (
            TileFormat::Bc4Unorm,
            139,
            131,
            1,
            4,
            8,
            &[(0, 64, 0, 0, 0xffff_ffff)],
        ),
        (
            TileFormat::Bc5Snorm,
            142,
            132,
            1,
            4,
            16,
            &[
                (0, 64, 0x40, 0x8000_0000, 0x7fff_ffff),
                (64, 64, 0x41, 0x8000_0000, 0x7fff_ffff),
            ],
        ),
    ];
    for (format, vulkan, model, transfer, unit_side, unit_bytes, samples) in expected {
        let tile = tile(format, 75);
        let file = write_ktx2(&tile);
        assert_eq!(file[..12], *b"\xabKTX 20\xbb\r\n\x1a\n");
        let header: Vec<u32> = (0..9).map(|n| word(&file, 12 + 4 * n)).collect();
        assert_eq!(header, [vulkan, 1, 88, 88, 0, 0, 1, 4, 2], "{format:?}");
        let [dfd, dfd_len, kvd, kvd_len] = [48, 52, 56, 60].map(|at| word(&file, at) as usize);
        assert_eq!((long(&file, 64), long(&file, 72)), (0, 0), "no global data");

        // Levels: descriptor after the index, base first in the index and last in the file, without gaps.
        assert_eq!(dfd, 80 + 4 * 24);
        let mut end = file.len() as u64;
        for mip in 0..4 {
            let [offset, len, uncompressed] = [0, 8, 16].map(|n| long(&file, 80 + 24 * mip + n));
            assert_eq!(offset + len, end, "{format:?} level {mip}");
            end = offset;
            let units = (88u32 >> mip).div_ceil(unit_side.into());
            assert_eq!(uncompressed, u64::from(units * units * unit_bytes));
            let frame = &file[offset as usize..(offset + len) as usize];
            assert_eq!(frame[..4], [0x28, 0xb5, 0x2f, 0xfd], "a Zstandard frame");
            assert_eq!(zstd::decode_all(frame).unwrap(), tile.mip(mip as u32));
        }
        assert_eq!(end as usize, kvd + kvd_len);

        // Data format descriptor.
        assert_eq!(
            (dfd % 4, kvd, kvd % 4, kvd_len % 4),
            (0, dfd + dfd_len, 0, 0)
        );
        assert_eq!(word(&file, dfd) as usize, dfd_len);
        let block = &file[dfd + 4..dfd + dfd_len];
        assert_eq!(word(block, 0), 0, "Khronos, basic");
        assert_eq!(word(block, 4), 2 | (24 + 16 * samples.len() as u32) << 16);
        assert_eq!(block.len(), 24 + 16 * samples.len());
        assert_eq!(block[8..12], [model, 1, transfer, 0], "{format:?}");
        assert_eq!(block[12..16], [unit_side - 1, unit_side - 1, 0, 0]);
        assert_eq!(block[16..24], [unit_bytes as u8, 0, 0, 0, 0, 0, 0, 0]);
        for (sample, (offset, bits, channel, lower, upper)) in
            block[24..].chunks_exact(16).zip(samples)
        {
            assert_eq!(word(sample, 0), offset | (bits - 1) << 16 | channel << 24);
            assert_eq!(word(sample, 4), 0, "at the unit's corner");
            assert_eq!((word(sample, 8), word(sample, 12)), (*lower, *upper));
        }

        // Key/value data: sorted, ended by NUL, padded to four bytes.
        let entries = b"\x12\0\0\0KTXorientation\0rd\0\0\0\x13\0\0\0KTXwriter\0terrella\0\0";
        assert_eq!(file[kvd..kvd + kvd_len], *entries);
    }
}

/// The crate's whole reader, and its own table of descriptors.
#[test]
fn another_reader_understands_the_files() {
    for format in FORMATS {
        let tile = tile(format, 150);
        let reader = ktx2::Reader::new(write_ktx2(&tile)).expect("a good file");
        let header = reader.header();
        assert_eq!((header.pixel_width, header.pixel_height), (160, 160));
        let (descriptor, type_size) =
            ktx2::dfd::Basic::from_format(header.format.expect("a known format")).unwrap();
        assert_eq!(reader.basic_dfd(), Some(&descriptor));
        assert_eq!(header.type_size, type_size);
        let writer = reader.key_value_data().find(|(key, _)| *key == "KTXwriter");
        assert_eq!(writer, Some(("KTXwriter", &b"terrella\0"[..])));
        assert_eq!(reader.levels().len(), TILE_MIPS as usize);
        for (mip, level) in (0..).zip(reader.levels()) {
            assert_eq!(level.uncompressed_byte_length, tile.mip(mip).len() as u64);
            assert_eq!(zstd::decode_all(level.data).unwrap(), tile.mip(mip));
        }
    }
}

#[test]
fn a_file_that_ends_early_is_rejected_at_every_length() {
    for format in FORMATS {
        let tile = tile(format, 16);
        let file = write_ktx2(&tile);
        for len in 0..file.len() {
            let read = read_ktx2(&file[..len], format, tile.shape);
            assert!(read.is_err(), "{format:?} cut to {len} bytes");
        }
    }
}

/// With any single bit flipped, the file is rejected or its texels are unchanged.
#[test]
fn a_changed_byte_never_changes_texels() {
    for format in FORMATS {
        let tile = tile(format, 16);
        let good = write_ktx2(&tile);
        let mut rejected = 0;
        for at in 0..good.len() {
            for flip in [0xff, 0x01, 0x80] {
                let mut file = good.clone();
                file[at] ^= flip;
                match read_ktx2(&file, format, tile.shape) {
                    // Key/value data, and bits that Zstandard leaves without meaning.
                    Ok(read) => assert_eq!(read, tile, "{format:?} byte {at}"),
                    Err(_) => rejected += 1,
                }
            }
        }
        assert!(
            rejected * 10 > good.len() * 3 * 9,
            "{format:?}: {rejected} of {}",
            good.len() * 3
        );
    }
}

#[test]
fn other_formats_and_sizes_are_rejected_in_words() {
    let tile = tile(TileFormat::R8Unorm, 16);
    let file = write_ktx2(&tile);
    let rejection = |file: &[u8], format, pixels| {
        let shape = TileShape::new(pixels).expect("in range");
        read_ktx2(file, format, shape).expect_err("not this tile")
    };
    for format in FORMATS {
        if format != tile.format {
            let said = rejection(&file, format, 16);
            assert!(said.contains("Vulkan format is 9"), "{said}");
        }
    }
    let said = rejection(&file, tile.format, 75);
    assert_eq!(said, "the width is 24 and must be 88");
    let said = rejection(&vec![0; 1 << 20], tile.format, 16);
    assert!(said.contains("1048576 bytes"), "{said}");
    for (at, value, part) in [
        (0, 1, "no KTX2 file"),
        (16, 2, "type size"),
        (20, 23, "width"),
        (24, 0, "height"),
        (28, 1, "depth"),
        (32, 1, "array layers"),
        (36, 6, "faces"),
        (40, 3, "mip levels"),
        (40, 0xff, "mip levels"),
        (44, 0, "supercompression scheme"),
        (44, 3, "supercompression scheme"),
        (72, 1, "global data"),
        (52, 0xff, "descriptor"),
        (51, 0xff, "descriptor"),
        (63, 0xff, "key/value"),
        (87, 0xff, "ends within mip level 0"),
        (95, 0xff, "ends within mip level 0"),
        (200, 0xff, "descriptor"),
    ] {
        let mut file = file.clone();
        file[at] = value;
        let said = rejection(&file, tile.format, 16);
        assert!(said.contains(part), "byte {at}: {said}");
    }
    let kvd = word(&file, 56) as usize;
    let mut turned = file;
    turned[kvd + 4 + 15] = b'l';
    assert!(rejection(&turned, tile.format, 16).contains("KTXorientation"));
}

/// Files of earlier writers have no sizes of planes in a compressed file's descriptor.
#[test]
fn a_descriptor_without_plane_sizes_is_read() {
    let tile = tile(TileFormat::Bc7Srgb, 16);
    let mut file = write_ktx2(&tile);
    let dfd = word(&file, 48) as usize;
    assert_eq!(file[dfd + 20], 16);
    file[dfd + 20] = 0;
    assert_eq!(read_ktx2(&file, tile.format, tile.shape), Ok(tile));
}

/// Replaces the base level of a file, which is stored last.
fn with_base(file: &[u8], base: &[u8], declared: u64) -> Vec<u8> {
    let offset = long(file, 80) as usize;
    let mut file = file[..offset].to_vec();
    file.extend_from_slice(base);
    file[88..96].copy_from_slice(&(base.len() as u64).to_le_bytes());
    file[96..104].copy_from_slice(&declared.to_le_bytes());
    file
}

#[test]
fn bombs_do_not_go_off() {
    let tile = tile(TileFormat::R8Unorm, 16);
    let file = write_ktx2(&tile);
    let read = |file: &[u8]| read_ktx2(file, tile.format, tile.shape);
    // An index that promises more than the tile has.
    for declared in [577, 1 << 40, u64::MAX] {
        let said = read(&with_base(&file, b"", declared)).expect_err("a bomb");
        assert!(
            said.contains(&format!("{declared} bytes uncompressed")),
            "{said}"
        );
    }
    // A frame of a gigabyte of zeros in some thirty kilobytes, with and without its true length in front.
    let gigabyte = {
        let mut encoder = zstd::stream::Encoder::new(Vec::new(), 3).unwrap();
        let zeros = vec![0; 1 << 20];
        for _ in 0..1024 {
            std::io::Write::write_all(&mut encoder, &zeros).unwrap();
        }
        encoder.finish().unwrap()
    };
    assert!(gigabyte.len() < MAX_OVERHEAD_BYTES, "{}", gigabyte.len());
    let said = read(&with_base(&file, &gigabyte, 576)).expect_err("a bomb");
    assert!(
        said.contains("mip level 0 cannot be decompressed"),
        "{said}"
    );
    let two_frames = [zstd::bulk::compress(&[7; 576], 3).unwrap(), gigabyte].concat();
    assert!(read(&with_base(&file, &two_frames, 576)).is_err());
    // And one that has too little.
    let said = read(&with_base(
        &file,
        &zstd::bulk::compress(&[7; 575], 3).unwrap(),
        576,
    ));
    assert!(
        said.expect_err("too little")
            .contains("575 bytes instead of 576")
    );
    assert!(read(&with_base(&file, b"", 576)).is_err());
    let whole = zstd::bulk::compress(&[7; 576], 3).unwrap();
    assert_eq!(
        read(&with_base(&file, &whole, 576)).unwrap().mip(0),
        [7; 576]
    );
}

/// The crate's reader of whole files panics on this one; ours must not go near it.
#[test]
fn a_descriptor_that_overflows_is_rejected() {
    let tile = tile(TileFormat::Bc4Unorm, 16);
    let mut file = write_ktx2(&tile);
    let dfd = word(&file, 48) as usize;
    file[dfd + 16] = 255;
    assert!(read_ktx2(&file, tile.format, tile.shape).is_err());
}
