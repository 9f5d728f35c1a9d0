//! Constants that shaders and Rust both know: shaders import them from here by name.

#[cfg(feature = "terrain")]
use super::relief_constants::RELIEF;
use super::value::Value::{self, F32, U32, Vec3};
use crate::air::{self, EARTH_AIR};
use crate::frames::SUN_RADIUS_RAD;
use crate::globe::{BLOCK_COUNT, COLUMNS, ROWS};
use crate::imagery::tile::{MAP_LAYERS, MapLayer};
use std::f64::consts::PI;

/// In place of a block's index: drawn with whole maps.
pub(crate) const WHOLE_MAP: u32 = 2 * BLOCK_COUNT;
/// With a block's index added: as much of what lies in several blocks as lies in that one, drawn with its tiles.
pub(crate) const PER_BLOCK_TILES: u32 = BLOCK_COUNT;

/// Flag of a point of a track to which a segment comes from the one before.
pub(crate) const FROM_PREVIOUS: u32 = 1;
/// Flag of what of a track lies on the ground.
pub(crate) const ON_GROUND: u32 = 2;

/// Sine of the Sun's elevation above which city lights are out.
pub(crate) const LAMPS_OUT_SIN: f64 = 0.02;
/// Sine of the Sun's elevation below which they are all on.
const LAMPS_FULL_SIN: f64 = -0.12;
/// Sine of the Sun's elevation below which the sea mirrors no Sun.
pub(crate) const GLINT_ENDS_SIN: f64 = -0.01;
/// Sine of the Sun's elevation above which the glint is whole.
const GLINT_FULL_SIN: f64 = 0.05;

/// A constant and its name.
pub(super) fn shared(name: &str) -> Option<(&'static str, &'static Value)> {
    let mut all = SHARED.iter().chain(RELIEF);
    let (name, value) = all.find(|(known, _)| *known == name)?;
    Some((name, value))
}

#[cfg(not(feature = "terrain"))]
const RELIEF: &[(&str, Value)] = &[];

/// All but those of relief, by name.
const SHARED: &[(&str, Value)] = &[
    ("PI", F32(PI)),
    // Blocks, and maps in the order of their bindings.
    ("BLOCK_COUNT", U32(BLOCK_COUNT)),
    ("BLOCK_COLUMNS", U32(COLUMNS)),
    ("BLOCK_ROWS", U32(ROWS)),
    ("MAP_LAYERS", U32(MAP_LAYERS as u32)),
    ("DAY", U32(MapLayer::Day as u32)),
    ("CLOUDS", U32(MapLayer::Clouds as u32)),
    ("NORMALS", U32(MapLayer::Normals as u32)),
    ("NIGHT_LIGHTS", U32(MapLayer::NightLights as u32)),
    ("WATER", U32(MapLayer::Water as u32)),
    ("WHOLE_MAP", U32(WHOLE_MAP)),
    ("PER_BLOCK_TILES", U32(PER_BLOCK_TILES)),
    // Light.
    ("SUN_RADIUS_RAD", F32(SUN_RADIUS_RAD)),
    ("LUMINANCE", Vec3(air::LUMINANCE)),
    ("LAMPS_OUT_SIN", F32(LAMPS_OUT_SIN)),
    ("LAMPS_FULL_SIN", F32(LAMPS_FULL_SIN)),
    ("GLINT_ENDS_SIN", F32(GLINT_ENDS_SIN)),
    ("GLINT_FULL_SIN", F32(GLINT_FULL_SIN)),
    // The air and its tables, per metre.
    ("LOWEST_SUN", F32(air::LOWEST_SUN)),
    ("AIR_RADIUS_M", F32(EARTH_AIR.radius_m)),
    (
        "MOLECULE_SCATTERING",
        Vec3(EARTH_AIR.molecules.scattering_per_m),
    ),
    (
        "MOLECULE_SCALE_HEIGHT_M",
        F32(EARTH_AIR.molecules.scale_height_m),
    ),
    // Grey: one number for all colours.
    (
        "AEROSOL_SCATTERING",
        F32(EARTH_AIR.aerosol.scattering_per_m.x),
    ),
    // Per scattering.
    (
        "AEROSOL_EXTINCTION",
        F32(EARTH_AIR.aerosol.extinction_per_m.x / EARTH_AIR.aerosol.scattering_per_m.x),
    ),
    (
        "AEROSOL_SCALE_HEIGHT_M",
        F32(EARTH_AIR.aerosol.scale_height_m),
    ),
    ("AEROSOL_ASYMMETRY", F32(EARTH_AIR.aerosol_asymmetry)),
    ("OZONE_ABSORPTION", Vec3(EARTH_AIR.ozone_absorption_per_m)),
    ("OZONE_CENTER_M", F32(EARTH_AIR.ozone_center_m)),
    ("OZONE_HALF_WIDTH_M", F32(EARTH_AIR.ozone_half_width_m)),
    // Flags of tracks.
    ("FROM_PREVIOUS", U32(FROM_PREVIOUS)),
    ("ON_GROUND", U32(ON_GROUND)),
];
