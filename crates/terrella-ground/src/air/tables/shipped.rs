//! Tables of the default atmosphere, which ship with the crate. Computing them would add most of a second to every start.
//!
//! `default.bin` is little-endian. It starts with `scattering` and `bounce` as IEEE halves; only the GPU uses them, in this form. `through`,
//! `sunlight`, `transmittance`, `sources`, `profile` and the sky's albedo follow as f32. `above_clouds.bin` has the same layout for
//! [`AirAboveClouds`], without `transmittance`, `sources` and `profile`. `TERRELLA_UPDATE_AIR=1 cargo test -p terrella-ground shipped` writes both
//! files. Without the variable the same tests compare them.

use super::{
    AirAboveClouds, AirTables, BOUNCE, PROFILE, RAYS, SCATTERING, SOURCES, SUNLIGHT, THROUGH,
    TRANSMITTANCE, TableSize,
};
use crate::half::float_of_half;
use glam::{Vec3, Vec4};
use std::sync::OnceLock;

const DEFAULT: &[u8] = include_bytes!("default.bin");
const ABOVE_CLOUDS: &[u8] = include_bytes!("above_clouds.bin");

/// Sizes of the tables in a file: half-float tables first, then f32 tables.
struct Layout<const HALVES: usize, const FLOATS: usize> {
    halves: [TableSize; HALVES],
    floats: [TableSize; FLOATS],
}

const OF_DEFAULT: Layout<2, 5> = Layout {
    halves: [SCATTERING, BOUNCE],
    floats: [THROUGH, SUNLIGHT, TRANSMITTANCE, SOURCES, PROFILE],
};

const OF_ABOVE_CLOUDS: Layout<2, 2> = Layout {
    halves: [
        TableSize::new(RAYS, SCATTERING.y, SCATTERING.z),
        TableSize::new(RAYS, BOUNCE.y, 1),
    ],
    floats: [TableSize::new(RAYS, 1, 1), SUNLIGHT],
};

const _: () = assert!(
    DEFAULT.len() == OF_DEFAULT.bytes(),
    "default.bin has another size"
);
const _: () = assert!(
    ABOVE_CLOUDS.len() == OF_ABOVE_CLOUDS.bytes(),
    "above_clouds.bin has another size"
);

/// The tables of [`AirOptions::default`](super::AirOptions).
pub(super) fn default_tables() -> AirTables {
    read_default(DEFAULT)
}

/// The tables of the same atmosphere above clouds at [`SHIPPED_M`](super::above_clouds::SHIPPED_M).
pub(super) fn above_clouds() -> AirAboveClouds {
    read_above_clouds(ABOVE_CLOUDS)
}

fn read_default(bytes: &[u8]) -> AirTables {
    let ([scattering, bounce], floats, sky_albedo) = OF_DEFAULT.read(bytes);
    let [through, sunlight, transmittance, sources, profile] = floats;
    AirTables {
        scattering,
        bounce,
        through,
        sunlight,
        transmittance,
        sources,
        profile,
        sky_albedo,
        interpolation: OnceLock::new(),
    }
}

fn read_above_clouds(bytes: &[u8]) -> AirAboveClouds {
    let ([scattering, bounce], [through, sunlight], sky_albedo) = OF_ABOVE_CLOUDS.read(bytes);
    AirAboveClouds {
        scattering,
        bounce,
        through,
        sunlight,
        sky_albedo,
        interpolation: OnceLock::new(),
    }
}

impl<const HALVES: usize, const FLOATS: usize> Layout<HALVES, FLOATS> {
    const fn bytes(&self) -> usize {
        let (mut bytes, mut n) = (12, 0);
        while n < HALVES {
            bytes += 8 * self.halves[n].texels();
            n += 1;
        }
        n = 0;
        while n < FLOATS {
            bytes += 16 * self.floats[n].texels();
            n += 1;
        }
        bytes
    }

    /// Reads the tables from a slice of [`Self::bytes`] bytes.
    fn read(&self, bytes: &[u8]) -> ([Vec<Vec4>; HALVES], [Vec<Vec4>; FLOATS], Vec3) {
        let of_halves = self.halves.iter().map(|size| 8 * size.texels()).sum();
        let (halves, floats) = bytes.split_at(of_halves);
        let halves = halves.as_chunks::<2>().0.iter();
        let mut halves = halves.map(|bytes| float_of_half(u16::from_le_bytes(*bytes)));
        let floats = floats.as_chunks::<4>().0.iter();
        let mut floats = floats.map(|bytes| f32::from_le_bytes(*bytes));
        let of_halves = self.halves.map(|size| take(&mut halves, size));
        let of_floats = self.floats.map(|size| take(&mut floats, size));
        let sky_albedo = std::array::from_fn(|_| floats.next().unwrap_or_default());
        (of_halves, of_floats, Vec3::from_array(sky_albedo))
    }
}

fn take(numbers: &mut impl Iterator<Item = f32>, size: TableSize) -> Vec<Vec4> {
    let mut texel =
        || Vec4::from_array(std::array::from_fn(|_| numbers.next().unwrap_or_default()));
    (0..size.texels()).map(|_| texel()).collect()
}

#[cfg(test)]
mod tests {
    use super::super::above_clouds::SHIPPED_M;
    use super::*;
    use crate::air::AirOptions;
    use crate::half::half_bits;

    /// Tables with their names, in file order, and whether they are stored as halves.
    type Named<'t> = Vec<(&'static str, bool, &'t [Vec4])>;

    fn named(tables: &AirTables) -> (Named<'_>, Vec3) {
        let named: Named<'_> = vec![
            ("scattering", true, &tables.scattering),
            ("bounce", true, &tables.bounce),
            ("through", false, &tables.through),
            ("sunlight", false, &tables.sunlight),
            ("transmittance", false, &tables.transmittance),
            ("sources", false, &tables.sources),
            ("profile", false, &tables.profile),
        ];
        (named, tables.sky_albedo)
    }

    fn named_above_clouds(tables: &AirAboveClouds) -> (Named<'_>, Vec3) {
        let named: Named<'_> = vec![
            ("scattering", true, &tables.scattering),
            ("bounce", true, &tables.bounce),
            ("through", false, &tables.through),
            ("sunlight", false, &tables.sunlight),
        ];
        (named, tables.sky_albedo)
    }

    fn bytes_of((tables, sky_albedo): &(Named<'_>, Vec3)) -> Vec<u8> {
        let mut bytes = Vec::new();
        for (_, is_half, texels) in tables {
            for number in texels.iter().flat_map(|texel| texel.to_array()) {
                match is_half {
                    true => bytes.extend(half_bits(number).to_le_bytes()),
                    false => bytes.extend(number.to_le_bytes()),
                }
            }
        }
        bytes.extend(
            sky_albedo
                .to_array()
                .iter()
                .flat_map(|number| number.to_le_bytes()),
        );
        bytes
    }

    /// Writes the computed tables to a file in this folder, or compares the two.
    fn compare(file: &str, shipped: &(Named<'_>, Vec3), computed: &(Named<'_>, Vec3)) {
        if std::env::var_os("TERRELLA_UPDATE_AIR").is_some() {
            let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/src/air/tables");
            std::fs::write(format!("{folder}/{file}"), bytes_of(computed)).expect("writes");
            return;
        }
        // Exponentials differ in the last bit between system libraries; a half has 11 bits.
        for ((name, is_half, shipped), (_, _, computed)) in shipped.0.iter().zip(&computed.0) {
            assert_eq!(shipped.len(), computed.len(), "{name}");
            let most = if *is_half { 1e-3 } else { 1e-5 };
            for (shipped, computed) in shipped.iter().zip(*computed) {
                let apart = (*shipped - *computed).abs().max_element();
                let size = computed.abs().max_element();
                assert!(
                    apart <= most * size + 1e-7,
                    "{name}: {shipped} for {computed}"
                );
            }
        }
        assert!((shipped.1 - computed.1).abs().max_element() < 1e-6);
    }

    #[test]
    fn the_shipped_air_is_the_computed_one() {
        let computed = AirTables::compute(&AirOptions::default());
        compare("default.bin", &named(&default_tables()), &named(&computed));
        let computed = AirAboveClouds::compute(&AirOptions::default(), SHIPPED_M);
        let shipped = above_clouds();
        compare(
            "above_clouds.bin",
            &named_above_clouds(&shipped),
            &named_above_clouds(&computed),
        );
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        assert!(bytes_of(&named(&default_tables())) == DEFAULT);
        assert!(bytes_of(&named_above_clouds(&above_clouds())) == ABOVE_CLOUDS);
        let mut changed = DEFAULT.to_vec();
        if let Some(last) = changed.last_mut() {
            *last ^= 1;
        }
        assert!(bytes_of(&named(&read_default(&changed))) == changed);
    }
}
