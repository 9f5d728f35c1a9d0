//! Tables of the default atmosphere, which ship with the crate. Computing them would add most of a second to every start.
//!
//! The feature `air-tables` compiles them in. Hosts without it, such as web pages, load the same two files beside the program and [`supply`] them.
//!
//! `default.bin` is little-endian. It starts with `scattering` and `bounce` as IEEE halves; only the GPU uses them, in this form. `through`,
//! `sunlight`, `transmittance`, `sources`, `profile` and the sky's albedo follow as f32. `above_clouds.bin` has the same layout for
//! [`AirAboveClouds`], without `transmittance`, `sources` and `profile`. `TERRELLA_UPDATE_AIR=1 cargo test -p terrella-ground shipped` writes both
//! files. Without the variable the same tests compare them.

use super::above_clouds::SHIPPED_M;
use super::{
    AirAboveClouds, AirTables, BOUNCE, PROFILE, RAYS, SCATTERING, SOURCES, SUNLIGHT, THROUGH,
    TRANSMITTANCE, TableSize,
};
use crate::air::AirOptions;
use crate::half::float_of_half;
use glam::{Vec3, Vec4};
use std::sync::{Arc, OnceLock};

#[cfg(any(test, feature = "air-tables"))]
const COMPILED_IN: Option<[&[u8]; 2]> = Some([
    include_bytes!("default.bin"),
    include_bytes!("above_clouds.bin"),
]);
#[cfg(not(any(test, feature = "air-tables")))]
const COMPILED_IN: Option<[&[u8]; 2]> = None;

/// Bytes that are not the tables of the default atmosphere.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the tables of the air have {bytes} bytes and not {expected}; take the file of this version"
)]
pub struct AirFileError {
    /// Their number.
    pub bytes: usize,
    /// The number in this version.
    pub expected: usize,
}

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

const _: () = if let Some([default, above_clouds]) = COMPILED_IN {
    assert!(
        default.len() == OF_DEFAULT.bytes(),
        "default.bin has another size"
    );
    assert!(
        above_clouds.len() == OF_ABOVE_CLOUDS.bytes(),
        "above_clouds.bin has another size"
    );
};

/// The tables of [`AirOptions::default`], if they are compiled in.
pub(super) fn default_tables() -> Option<AirTables> {
    COMPILED_IN.map(|[default, _]| read_default(default))
}

/// The tables of the same atmosphere above clouds at [`SHIPPED_M`], if they are compiled in.
pub(super) fn above_clouds() -> Option<AirAboveClouds> {
    COMPILED_IN.map(|[_, above_clouds]| read_above_clouds(above_clouds))
}

/// Takes the contents of `default.bin` followed by those of `above_clouds.bin`, for programs without the feature `air-tables`. Call it before the
/// first Earth is made; otherwise the tables are computed, which takes seconds on one thread.
///
/// # Errors
/// Another number of bytes. Nothing is then supplied.
pub fn supply(files: &[u8]) -> Result<(), AirFileError> {
    let expected = OF_DEFAULT.bytes() + OF_ABOVE_CLOUDS.bytes();
    if files.len() != expected {
        return Err(AirFileError {
            bytes: files.len(),
            expected,
        });
    }
    let (default, above_clouds) = files.split_at(OF_DEFAULT.bytes());
    let air = AirOptions::default();
    super::MADE.set(air, Arc::new(read_default(default)));
    let above_clouds = Arc::new(read_above_clouds(above_clouds));
    super::MADE_ABOVE_CLOUDS.set((air, SHIPPED_M), above_clouds);
    Ok(())
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
    use super::*;
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

    fn compiled_in() -> (AirTables, AirAboveClouds) {
        let default = default_tables().expect("compiled into tests");
        (default, above_clouds().expect("compiled into tests"))
    }

    #[test]
    fn the_shipped_air_is_the_computed_one() {
        let (default, above_clouds) = compiled_in();
        let computed = AirTables::compute(&AirOptions::default());
        compare("default.bin", &named(&default), &named(&computed));
        let computed = AirAboveClouds::compute(&AirOptions::default(), SHIPPED_M);
        compare(
            "above_clouds.bin",
            &named_above_clouds(&above_clouds),
            &named_above_clouds(&computed),
        );
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        let [default, above] = COMPILED_IN.expect("compiled into tests");
        let (tables, above_clouds) = compiled_in();
        assert!(bytes_of(&named(&tables)) == default);
        assert!(bytes_of(&named_above_clouds(&above_clouds)) == above);
        let mut changed = default.to_vec();
        if let Some(last) = changed.last_mut() {
            *last ^= 1;
        }
        assert!(bytes_of(&named(&read_default(&changed))) == changed);
    }

    #[test]
    fn files_of_another_size_are_rejected() {
        let files = COMPILED_IN.expect("compiled into tests").concat();
        supply(&files).expect("the shipped files");
        let error = supply(&files[1..]).expect_err("a byte is missing");
        assert_eq!(
            (error.bytes, error.expected),
            (files.len() - 1, files.len())
        );
    }
}
