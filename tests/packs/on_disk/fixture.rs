//! Small packs whose every texel is known.

use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock};
use tempfile::TempDir;
use terrella_ground::globe::Block;
use terrella_imagery::pack::{
    LayerEntry, LevelEntry, MANIFEST_FILE, Manifest, Pack, TileFile, tile_path, write_ktx2,
};
use terrella_imagery::tile::{
    MapLayer, Storage, TILE_BORDER, TILE_MIPS, Tile, TileFormat, TileKey, TileShape,
};

/// A pack in a separate folder.
pub struct Fixture {
    folder: TempDir,
    pub manifest: Manifest,
}

impl Fixture {
    /// The maps of [`texel`] with these levels in these storages; `gap` selects the blocks without a tile.
    pub fn new(
        storages: &[Storage],
        layers: &[(MapLayer, &[u32])],
        gap: impl Fn(TileKey) -> bool,
    ) -> Self {
        let shapes = |ladder: &[u32]| -> Vec<TileShape> {
            let shape = |pixels: &u32| TileShape::new(*pixels).expect("in range");
            ladder.iter().map(shape).collect()
        };
        let layers: Vec<_> = layers
            .iter()
            .map(|(layer, ladder)| (*layer, shapes(ladder)))
            .collect();
        Self::of_shapes(storages, &layers, gap)
    }

    /// The same with levels that may be cut into parts.
    pub fn of_shapes(
        storages: &[Storage],
        layers: &[(MapLayer, Vec<TileShape>)],
        gap: impl Fn(TileKey) -> bool,
    ) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let mut manifest = Manifest {
            name: "Known texels".into(),
            attribution: vec!["Nobody's data".into()],
            storages: storages.to_vec(),
            layers: Vec::new(),
            heights: None,
        };
        for (layer, shapes) in layers {
            let levels = (0..).zip(shapes).map(|(level, shape)| {
                let mut entry = LevelEntry {
                    shape: *shape,
                    tiles: Vec::new(),
                };
                for storage in storages {
                    let file = |(block, part): (Block, u16)| {
                        let key = TileKey {
                            layer: *layer,
                            level,
                            block: block.index() as u8,
                            part,
                        };
                        (!gap(key)).then(|| {
                            let contents = write_ktx2(&part_tile(*storage, *shape, key));
                            let path = tile_path(*storage, *layer, *shape, block, part);
                            write(&folder.path().join(path), &contents);
                            TileFile::of(&contents)
                        })
                    };
                    entry.tiles.push(entry.places().map(file).collect());
                }
                entry
            });
            manifest.layers.push(LayerEntry {
                layer: *layer,
                source: "a formula".into(),
                exaggeration: (*layer == MapLayer::Normals).then_some(4.0),
                levels: levels.collect(),
            });
        }
        let fixture = Self { folder, manifest };
        fixture.write_manifest(&fixture.manifest);
        fixture
    }

    /// All maps on two small levels in both storages, made once for the tests that only read.
    pub fn shared() -> &'static Self {
        static MADE: LazyLock<Fixture> = LazyLock::new(Fixture::small);
        &MADE
    }

    /// All maps on two small levels in both storages.
    pub fn small() -> Self {
        let layers = MapLayer::ALL.map(|layer| (layer, &[33, 16][..]));
        Self::new(&Storage::ALL, &layers, |_| false)
    }

    /// The day map on two small levels in both storages: a fifth of the files.
    pub fn day() -> Self {
        Self::new(&Storage::ALL, &[(MapLayer::Day, &[33, 16])], |_| false)
    }

    pub fn dir(&self) -> &Path {
        self.folder.path()
    }

    pub fn write_manifest(&self, manifest: &Manifest) {
        write(
            &self.dir().join(MANIFEST_FILE),
            manifest.to_toml().as_bytes(),
        );
    }

    pub fn open(&self) -> Arc<Pack> {
        Arc::new(Pack::open(self.dir()).expect("a good pack"))
    }

    pub fn path(&self, storage: Storage, key: TileKey) -> PathBuf {
        self.open()
            .tile_path(storage, key)
            .expect("in the manifest")
    }
}

pub fn write(path: &Path, contents: &[u8]) {
    std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
    std::fs::write(path, contents).expect("written");
}

/// The stored bytes of a plain texel of a map `width` texels wide: all different in a smooth pattern, with an odd
/// number for each colour channel, which a BC7 block can hold exactly.
pub fn texel(layer: MapLayer, width: u32, column: u32, row: u32) -> Vec<u8> {
    let (x, y) = (
        f64::from(column) / f64::from(width),
        f64::from(row) / f64::from(width),
    );
    let wave = |turns: f64, phase: f64| {
        ((x * turns + phase).sin() * (y * turns * 1.7).cos() * 0.5 + 0.5).clamp(0.0, 1.0)
    };
    let byte = |value: f64| (value * 255.0) as u8;
    let slope = |value: f64| ((value * 254.0) as i16 - 127) as i8 as u8;
    let salt = layer.index() as f64;
    match layer {
        MapLayer::Day => vec![
            byte(wave(20.0, 0.0)) | 1,
            byte(wave(35.0, 1.0)) | 1,
            byte(wave(50.0, 2.0)) | 1,
            255,
        ],
        MapLayer::Normals => vec![slope(wave(30.0, salt)), slope(wave(25.0, salt + 1.0))],
        _ => vec![byte(wave(20.0 + salt, salt))],
    }
}

/// A block's tile with its neighbours' texels around it, over the date line and the poles too.
pub fn tile(storage: Storage, layer: MapLayer, shape: TileShape, block: Block) -> Tile {
    part_tile(
        storage,
        shape,
        TileKey::whole(layer, 0, block.index() as u8),
    )
}

/// The same of a part of a block; the key's level does not count.
pub fn part_tile(storage: Storage, shape: TileShape, key: TileKey) -> Tile {
    let (layer, part) = (key.layer, u32::from(key.part));
    let Block { column, row } = key.block();
    let first = [
        (column * shape.parts + part % shape.parts) * shape.pixels,
        (row * shape.parts + part / shape.parts) * shape.pixels,
    ];
    let format = layer.tile_format(storage);
    let (width, height) = (i64::from(shape.map_width()), i64::from(shape.map_height()));
    let base = |x: u32, y: u32| {
        let border = i64::from(TILE_BORDER);
        let mut column = i64::from(first[0] + x) - border;
        let mut row = i64::from(first[1] + y) - border;
        if row < 0 || row >= height {
            row = if row < 0 {
                -1 - row
            } else {
                2 * height - 1 - row
            };
            column += width / 2;
        }
        let column = column.rem_euclid(width) as u32;
        texel(layer, shape.map_width(), column, row as u32)
    };
    let mut texels = Vec::new();
    for mip in 0..TILE_MIPS {
        let units = shape.mip_side(mip).div_ceil(format.unit_side());
        let step = format.unit_side() << mip;
        for y in 0..units {
            for x in 0..units {
                texels.extend(unit(format, &base(x * step, y * step)));
            }
        }
    }
    Tile {
        format,
        shape,
        texels,
    }
}

/// A texel, or a block of 4 × 4 equal texels.
pub fn unit(format: TileFormat, texel: &[u8]) -> Vec<u8> {
    // Two ends alike and all indices 0.
    let bc4 = |value: u8| [value, value, 0, 0, 0, 0, 0, 0];
    match format {
        TileFormat::Rgba8Srgb | TileFormat::R8Unorm | TileFormat::Rg8Snorm => texel.to_vec(),
        TileFormat::Bc4Unorm => bc4(texel[0]).to_vec(),
        TileFormat::Bc5Snorm => [bc4(texel[0]), bc4(texel[1])].concat(),
        TileFormat::Bc7Srgb => {
            // Mode 6: a bit after six of zero; each channel's two ends of seven bits; two lowest bits; indices 0.
            let mut block = 1_u128 << 6;
            for (channel, value) in texel.iter().enumerate() {
                let high = u128::from(value >> 1);
                block |= high << (7 + 14 * channel) | high << (14 + 14 * channel);
            }
            block |= 0b11 << 63;
            block.to_le_bytes().to_vec()
        }
    }
}

pub fn key(layer: MapLayer, level: u8, block: u8) -> TileKey {
    TileKey {
        layer,
        level,
        block,
        part: 0,
    }
}
