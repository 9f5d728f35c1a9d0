//! The tables of the default air, which come with the crate: computing them would take half a second of every start.
//!
//! `default.bin` is little-endian: `scattering` and `bounce` as IEEE halves, which is how the GPU holds them and all that they are for;
//! then `through`, `sunlight`, `transmittance`, `sources`, `profile` and the sky's albedo as f32.
//! `TERRELLA_UPDATE_AIR=1 cargo test -p terrella-ground shipped` writes it anew; without the variable the same test compares.

use super::{
    AirTables, BOUNCE, PROFILE, SCATTERING, SOURCES, SUNLIGHT, THROUGH, TRANSMITTANCE, TableSize,
};
use crate::half::float_of_half;
use glam::{Vec3, Vec4};
use std::sync::OnceLock;

const DEFAULT: &[u8] = include_bytes!("default.bin");

/// Bytes of the file.
const LENGTH: usize = 8 * (SCATTERING.texels() + BOUNCE.texels())
    + 16 * (THROUGH.texels() + SUNLIGHT.texels() + TRANSMITTANCE.texels())
    + 16 * (SOURCES.texels() + PROFILE.texels())
    + 12;

const _: () = assert!(DEFAULT.len() == LENGTH, "default.bin has another size");

/// The tables of [`AirOptions::default`](super::AirOptions).
pub(super) fn default_tables() -> AirTables {
    read(DEFAULT)
}

/// Tables from bytes, of which there are [`LENGTH`].
fn read(bytes: &[u8]) -> AirTables {
    let (halves, floats) = bytes.split_at(8 * (SCATTERING.texels() + BOUNCE.texels()));
    let halves = halves.as_chunks::<2>().0.iter();
    let mut halves = halves.map(|bytes| float_of_half(u16::from_le_bytes(*bytes)));
    let floats = floats.as_chunks::<4>().0.iter();
    let mut floats = floats.map(|bytes| f32::from_le_bytes(*bytes));
    AirTables {
        scattering: take(&mut halves, SCATTERING),
        bounce: take(&mut halves, BOUNCE),
        through: take(&mut floats, THROUGH),
        sunlight: take(&mut floats, SUNLIGHT),
        transmittance: take(&mut floats, TRANSMITTANCE),
        sources: take(&mut floats, SOURCES),
        profile: take(&mut floats, PROFILE),
        sky_albedo: Vec3::from_array(std::array::from_fn(|_| floats.next().unwrap_or_default())),
        interpolation: OnceLock::new(),
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
    use crate::air::AirOptions;
    use crate::half::half_bits;

    fn bytes_of(tables: &AirTables) -> Vec<u8> {
        let numbers =
            |texels: &[Vec4]| -> Vec<f32> { texels.iter().flat_map(|t| t.to_array()).collect() };
        let mut bytes = Vec::with_capacity(LENGTH);
        for table in [&tables.scattering, &tables.bounce] {
            bytes.extend(
                numbers(table)
                    .iter()
                    .flat_map(|number| half_bits(*number).to_le_bytes()),
            );
        }
        for table in [
            &tables.through,
            &tables.sunlight,
            &tables.transmittance,
            &tables.sources,
            &tables.profile,
        ] {
            bytes.extend(
                numbers(table)
                    .iter()
                    .flat_map(|number| number.to_le_bytes()),
            );
        }
        bytes.extend(
            tables
                .sky_albedo
                .to_array()
                .iter()
                .flat_map(|number| number.to_le_bytes()),
        );
        bytes
    }

    #[test]
    fn the_shipped_air_is_the_computed_one() {
        let computed = AirTables::compute(&AirOptions::default());
        if std::env::var_os("TERRELLA_UPDATE_AIR").is_some() {
            let path = concat!(env!("CARGO_MANIFEST_DIR"), "/src/air/tables/default.bin");
            std::fs::write(path, bytes_of(&computed)).expect("writes");
            return;
        }
        let shipped = default_tables();
        // Exponentials differ in the last bit from one system's library to another's; a half has 11 bits.
        for (name, shipped, computed, most) in [
            (
                "scattering",
                &shipped.scattering,
                &computed.scattering,
                1e-3,
            ),
            ("bounce", &shipped.bounce, &computed.bounce, 1e-3),
            ("through", &shipped.through, &computed.through, 1e-5),
            ("sunlight", &shipped.sunlight, &computed.sunlight, 1e-5),
            (
                "transmittance",
                &shipped.transmittance,
                &computed.transmittance,
                1e-5,
            ),
            ("sources", &shipped.sources, &computed.sources, 1e-5),
            ("profile", &shipped.profile, &computed.profile, 1e-5),
        ] {
            assert_eq!(shipped.len(), computed.len(), "{name}");
            for (shipped, computed) in shipped.iter().zip(computed) {
                let apart = (*shipped - *computed).abs().max_element();
                let size = computed.abs().max_element();
                assert!(
                    apart <= most * size + 1e-7,
                    "{name}: {shipped} for {computed}"
                );
            }
        }
        assert!(
            (shipped.sky_albedo - computed.sky_albedo)
                .abs()
                .max_element()
                < 1e-6
        );
    }

    #[test]
    fn what_is_read_is_what_was_written() {
        assert!(bytes_of(&default_tables()) == DEFAULT);
        let mut changed = DEFAULT.to_vec();
        changed[LENGTH - 1] ^= 1;
        assert!(bytes_of(&read(&changed)) == changed);
    }
}
