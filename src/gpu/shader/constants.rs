//! Constants that shaders and Rust share: shaders import them by name.

#[cfg(feature = "terrain")]
use super::relief_constants::RELIEF;
use super::value::Value::{self, F32, U32, Vec3};
use crate::plan::{
    BLENDED_DETAIL_LEVELS, EMPTY_DETAIL_LEVEL, FINE_DETAIL_TILES, GLOW_DAY_SIN, GLOW_NIGHT_SIN,
    GREEN_LIGHT, LAYER_HEIGHTS, LAYER_SIGMAS, LIMB_SEGMENTS, LOW_LIGHT, PER_BLOCK_TILES, RED_LIGHT,
    WHOLE_MAP,
};
use glam::DVec3;
use std::f64::consts::PI;
use terrella_frames::{MOON_RADIUS_M, SUN_RADIUS_M, SUN_RADIUS_RAD};
use terrella_ground::air::{self, TableSize};
use terrella_ground::globe::{BLOCK_COUNT, COLUMNS, ROWS};
use terrella_ground::light::{self, Bloom, DiffractionPattern, agx};
use terrella_imagery::tile::{MAP_LAYERS, MapLayer, TILE_BORDER};
use terrella_imagery::{
    CLOUD_ALBEDO, CLOUD_SLOPE_STEP, CityLight, DETAIL_MEAN, DETAIL_STEP, FLOOR_SEEN_M, LAMP_COLOR,
    LAMP_GLOW, LAND_SLOPE_STEP, NEIGHBOURHOODS,
};

/// Size limit of the cells of blocks with parts, in vectors of four words, each word with two cells. Together with the other placement data this
/// fits a buffer of 16 KiB, which every adapter supports.
pub const PART_CELL_WORDS: u32 = 380;
/// Bits of such a cell that hold the layer of the array texture.
pub const PART_INDEX_BITS: u32 = 12;

/// Flag of a truth texel: at least half of it is land.
pub const TRUTH_LAND: u32 = 1 << 8;
/// Flag of a truth texel: the centre of the Sun's disc is above the horizon.
pub const TRUTH_SUNLIT: u32 = 1 << 9;

/// Flag of a track point: a segment connects it with the point before.
pub(crate) const FROM_PREVIOUS: u32 = 1;
/// Flag of track elements that are on the ground.
pub(crate) const ON_GROUND: u32 = 2;
/// Flag of a line point: the line has no dark outline.
pub(crate) const UNCASED: u32 = 4;

/// Sine of the Sun's elevation above which city lights are off: at sunset.
pub const LAMPS_OUT_SIN: f64 = 0.0;
/// Sine of the Sun's elevation below which all city lights are on: −6°, the end of civil twilight.
pub(crate) const LAMPS_FULL_SIN: f64 = -0.104_528_463;
/// Sine of the Sun's elevation below which the sea has no sunglint.
#[cfg(feature = "tiles")]
pub(crate) const GLINT_ENDS_SIN: f64 = -0.01;

/// Colour of city lights.
const LAMP_COLOR_RGB: DVec3 = {
    let [red, green, blue] = LAMP_COLOR;
    DVec3::new(red as f64, green as f64, blue as f64)
};

/// Refractive index of sea water in the middle of the visible spectrum: 1.3408 at 550 nm, 35 ‰ and 20 °C by Quan and Fry 1995 (Appl. Opt. 34,
/// 3477).
const SEA_WATER_INDEX: f64 = 1.34;
/// Fresnel reflectance of its smooth surface at normal incidence.
const SEA_REFLECTANCE: f64 = {
    let root = (SEA_WATER_INDEX - 1.0) / (SEA_WATER_INDEX + 1.0);
    root * root
};

/// Angle from the Sun within which its glare is drawn, radians.
pub(crate) const GLARE_RADIUS_RAD: f64 = 0.25;
/// Scales of the diffraction pattern, by channel.
const APERTURE_SCALES: DVec3 = DVec3::from_array(DiffractionPattern::SCALES);
const APERTURE_FADING: DVec3 = DVec3::from_array(DiffractionPattern::FADING);
/// Radiance of the Milky Way's map where its value is 1, and of the sky where it is 0 (23.5 magnitudes a square arc second), relative to a white
/// sheet that faces the Sun in space; see `textures/SOURCES.md`.
const MILKY_WAY_LIGHT: f64 = 3.097e-8;
const MILKY_WAY_FLOOR: f64 = 1.052e-9;

/// Limit of the exposed light that a layer adds to a float target that is developed later: the sum of two layers must fit a half float.
const BRIGHTEST_EXPOSED: f64 = 30_000.0;

/// Number of directions below and above the limb in the sky view, together.
pub const VIEW_ANGLES: u32 = 96;
/// Number of azimuths from the Sun in the sky view.
pub const VIEW_AZIMUTHS: u32 = 32;

/// Size of a table along its axes, for shaders.
const fn texels(size: TableSize) -> DVec3 {
    DVec3::new(size.x as f64, size.y as f64, size.z as f64)
}

/// The constant with this name.
pub(super) fn shared(name: &str) -> Option<(&'static str, &'static Value)> {
    let mut all = SHARED.iter().chain(RELIEF);
    let (name, value) = all.find(|(known, _)| *known == name)?;
    Some((name, value))
}

#[cfg(not(feature = "terrain"))]
const RELIEF: &[(&str, Value)] = &[];

/// All shared constants except those of terrain, by name.
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
    ("TILE_BORDER", U32(TILE_BORDER)),
    ("LIMB_SEGMENTS", U32(LIMB_SEGMENTS)),
    ("WHOLE_MAP", U32(WHOLE_MAP)),
    ("PER_BLOCK_TILES", U32(PER_BLOCK_TILES)),
    ("PART_CELL_WORDS", U32(PART_CELL_WORDS)),
    ("PART_INDEX_BITS", U32(PART_INDEX_BITS)),
    // Light.
    ("SUN_RADIUS_RAD", F32(SUN_RADIUS_RAD)),
    ("MOON_PER_SUN", F32(MOON_RADIUS_M / SUN_RADIUS_M)),
    ("GLARE_RADIUS_RAD", F32(GLARE_RADIUS_RAD)),
    ("APERTURE_SCALES", Vec3(APERTURE_SCALES)),
    ("SUN_PLACES", U32(light::SUN_PLACES)),
    ("SUN_PLACE", F32(light::SUN_PLACE)),
    ("APERTURE_FADING", Vec3(APERTURE_FADING)),
    ("MILKY_WAY_LIGHT", F32(MILKY_WAY_LIGHT)),
    ("MILKY_WAY_FLOOR", F32(MILKY_WAY_FLOOR)),
    ("LUMINANCE", Vec3(air::LUMINANCE)),
    ("LAMPS_OUT_SIN", F32(LAMPS_OUT_SIN)),
    ("LAMPS_FULL_SIN", F32(LAMPS_FULL_SIN)),
    ("LAMP_COLOR", Vec3(LAMP_COLOR_RGB)),
    ("LAMP_GLOW", F32(LAMP_GLOW)),
    ("CITY_LIGHT_RADIUS_M", F32(CityLight::MOST_RADIUS_M)),
    ("FLOOR_SEEN_M", F32(FLOOR_SEEN_M)),
    ("DETAIL_STEP", F32(DETAIL_STEP as f64)),
    ("CLOUD_SLOPE_STEP", F32(CLOUD_SLOPE_STEP as f64)),
    ("LAND_SLOPE_STEP", F32(LAND_SLOPE_STEP as f64)),
    ("DETAIL_MEAN", F32(DETAIL_MEAN as f64)),
    ("FINE_TILES", F32(FINE_DETAIL_TILES)),
    ("EMPTY_LEVEL", F32(EMPTY_DETAIL_LEVEL)),
    ("BLENDED_LEVELS", F32(BLENDED_DETAIL_LEVELS)),
    ("SEA_WATER_INDEX", F32(SEA_WATER_INDEX)),
    ("SEA_REFLECTANCE", F32(SEA_REFLECTANCE)),
    ("BRIGHTEST_EXPOSED", F32(BRIGHTEST_EXPOSED)),
    ("BRIGHTEST_SCATTERED", F32(Bloom::BRIGHTEST_SCATTERED)),
    // Display: the largest 8-bit value, and tone curves.
    ("LAST_CODE", F32(u8::MAX as f64)),
    ("GRAIN_BITS", U32(light::GRAIN_BITS)),
    ("GRAIN_INCREMENT", U32(light::GRAIN_INCREMENT)),
    ("GRAIN_MULTIPLIER", U32(light::GRAIN_MULTIPLIER)),
    ("GRAIN_SCALE", F32(light::GRAIN_SCALE)),
    ("GRAIN_SHIFT", U32(light::GRAIN_SHIFT)),
    ("RESPONSE_SAMPLES", U32(light::Response::SAMPLES as u32)),
    ("TONE_CAMERA_TOE", Vec3(light::CAMERA_TOE)),
    ("TONE_CAMERA_HAZE", F32(light::CAMERA_HAZE)),
    ("TONE_CAMERA_TOE_LEAST", F32(light::CAMERA_TOE_LEAST)),
    ("TONE_CAMERA_STRAIGHT", F32(light::CAMERA_STRAIGHT)),
    ("TONE_CAMERA_HALF_RAISED", F32(light::CAMERA_HALF_RAISED)),
    ("TONE_CAMERA_WHITE", F32(light::CAMERA_WHITE)),
    ("TONE_CAMERA_SATURATION", F32(light::CAMERA_SATURATION)),
    ("TONE_NEUTRAL_START", F32(light::NEUTRAL_START)),
    (
        "TONE_NEUTRAL_DESATURATION",
        F32(light::NEUTRAL_DESATURATION),
    ),
    ("TONE_FILMIC_SCALE", F32(light::FILMIC_SCALE)),
    ("TONE_FILMIC_A", F32(light::FILMIC[0])),
    ("TONE_FILMIC_B", F32(light::FILMIC[1])),
    ("TONE_FILMIC_C", F32(light::FILMIC[2])),
    ("TONE_FILMIC_D", F32(light::FILMIC[3])),
    ("TONE_FILMIC_E", F32(light::FILMIC[4])),
    ("TONE_AGX_INSET_X", Vec3(agx::INSET.x_axis)),
    ("TONE_AGX_INSET_Y", Vec3(agx::INSET.y_axis)),
    ("TONE_AGX_INSET_Z", Vec3(agx::INSET.z_axis)),
    ("TONE_AGX_OUTSET_X", Vec3(agx::OUTSET.x_axis)),
    ("TONE_AGX_OUTSET_Y", Vec3(agx::OUTSET.y_axis)),
    ("TONE_AGX_OUTSET_Z", Vec3(agx::OUTSET.z_axis)),
    ("TONE_AGX_FROM_X", Vec3(agx::REC709_FROM_REC2020.x_axis)),
    ("TONE_AGX_FROM_Y", Vec3(agx::REC709_FROM_REC2020.y_axis)),
    ("TONE_AGX_FROM_Z", Vec3(agx::REC709_FROM_REC2020.z_axis)),
    ("TONE_AGX_LEAST_LOG", F32(agx::LEAST_LOG)),
    ("TONE_AGX_MOST_LOG", F32(agx::MOST_LOG)),
    ("TONE_AGX_CONTRAST_LEAST", F32(agx::CONTRAST[0])),
    (
        "TONE_AGX_CONTRAST_LOW",
        Vec3(DVec3::new(
            agx::CONTRAST[1],
            agx::CONTRAST[2],
            agx::CONTRAST[3],
        )),
    ),
    (
        "TONE_AGX_CONTRAST_HIGH",
        Vec3(DVec3::new(
            agx::CONTRAST[4],
            agx::CONTRAST[5],
            agx::CONTRAST[6],
        )),
    ),
    ("TONE_AGX_DISPLAY_POWER", F32(agx::DISPLAY_POWER)),
    // The air and its tables; heights without a unit are in equatorial radii.
    ("LOWEST_SUN", F32(air::LOWEST_SUN)),
    ("SUN_SPACING", F32(air::SUN_SPACING)),
    ("AIR_TOP", F32(air::TOP)),
    ("AIR_RADIUS_M", F32(air::RADIUS_M)),
    ("AIR_SCALE_HEIGHT_M", F32(air::MOLECULE_SCALE_HEIGHT_M)),
    (
        "MOLECULE_SCALE_HEIGHT",
        F32(air::MOLECULE_SCALE_HEIGHT_M / air::RADIUS_M),
    ),
    (
        "AEROSOL_SCALE_HEIGHT",
        F32(air::AEROSOL_SCALE_HEIGHT_M / air::RADIUS_M),
    ),
    ("AEROSOL_ASYMMETRY", F32(air::AEROSOL_ASYMMETRY)),
    ("RAYLEIGH_A", F32(air::RAYLEIGH_PHASE[0])),
    ("RAYLEIGH_B", F32(air::RAYLEIGH_PHASE[1])),
    ("AIR_RAYS", F32(air::RAYS as f64)),
    ("SCATTERING_SIZE", Vec3(texels(air::SCATTERING_AND_CLOUDS))),
    ("SUNLIGHT_SIZE", Vec3(texels(air::SUNLIGHT_AND_CLOUDS))),
    ("TRANSMITTANCE_SIZE", Vec3(texels(air::TRANSMITTANCE))),
    ("SOURCES_SIZE", Vec3(texels(air::SOURCES))),
    ("SOURCE_BANDS", F32(air::SOURCE_BANDS as f64)),
    ("PROFILE_SIZE", Vec3(texels(air::PROFILE))),
    (
        "ALBEDO_SIZE",
        Vec3(DVec3::new(
            NEIGHBOURHOODS as f64,
            NEIGHBOURHOODS as f64 / 2.0,
            1.0,
        )),
    ),
    ("CLOUD_ALBEDO", F32(CLOUD_ALBEDO)),
    ("VIEW_ANGLES", F32(VIEW_ANGLES as f64)),
    ("VIEW_AZIMUTHS", F32(VIEW_AZIMUTHS as f64)),
    // Airglow and aurora; heights and widths of layers are in equatorial radii.
    ("AIRGLOW_LOW_LIGHT", Vec3(LOW_LIGHT)),
    ("AIRGLOW_GREEN_LIGHT", Vec3(GREEN_LIGHT)),
    ("AIRGLOW_RED_LIGHT", Vec3(RED_LIGHT)),
    ("AIRGLOW_HEIGHTS", Vec3(LAYER_HEIGHTS)),
    ("AIRGLOW_SIGMAS", Vec3(LAYER_SIGMAS)),
    ("GLOW_NIGHT_SIN", F32(GLOW_NIGHT_SIN)),
    ("GLOW_DAY_SIN", F32(GLOW_DAY_SIN)),
    // Flags of truth texels.
    ("TRUTH_LAND", U32(TRUTH_LAND)),
    ("TRUTH_SUNLIT", U32(TRUTH_SUNLIT)),
    // Flags of tracks.
    ("FROM_PREVIOUS", U32(FROM_PREVIOUS)),
    ("ON_GROUND", U32(ON_GROUND)),
    ("UNCASED", U32(UNCASED)),
];
