//! What a scene may ask for, and what it gets where it asks for nothing. Units are in the names.

use std::ops::RangeInclusive;

/// Largest scene file, bytes. A scene of every key with generous comments is a hundredth of it.
pub const MAX_FILE_BYTES: u64 = 1 << 20;

/// First and last year (UTC) that a scene may reach: those of [`utc_from_rfc3339`](crate::frames::utc_from_rfc3339).
pub const YEARS: RangeInclusive<i32> = 1900..=2099;

/// Longest playback, simulated seconds (about 32 years).
pub const MAX_DURATION_S: f64 = 1e9;
/// Fastest playback, forwards or backwards.
pub const MAX_SPEED: f64 = 1e6;
/// Frames per second of playback.
pub const FRAME_RATE_HZ: RangeInclusive<f64> = 1.0..=240.0;
/// Most frames in one playback (at 30 per second, almost four days).
pub const MAX_FRAMES: f64 = 1e7;

/// Most satellites, `[[orbit]]` tables, in one scene.
pub const MAX_ORBITS: usize = 1000;
/// Sizes of orbits, positions and their parts, kilometres: a thousand times the distance of the Sun.
pub const ORBIT_KM: RangeInclusive<f64> = -1e11..=1e11;
/// Eccentricity of an orbit that is given by elements.
pub const ECCENTRICITY: RangeInclusive<f64> = 0.0..=1e6;
/// Inclination, degrees.
pub const INCLINATION_DEG: RangeInclusive<f64> = 0.0..=180.0;
/// Every other angle of an orbit, degrees.
pub const ANGLE_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Each part of a velocity, kilometres per second.
pub const SPEED_KM_S: RangeInclusive<f64> = -5000.0..=5000.0;
/// Degree and order of the Earth's gravity; 0 is a point, 1 would be the same.
pub const GRAVITY_DEGREE: RangeInclusive<i64> = 0..=20;
/// Mass of a satellite, kilograms.
pub const MASS_KG: RangeInclusive<f64> = 1e-6..=1e9;
/// Area of a satellite, square metres.
pub const AREA_M2: RangeInclusive<f64> = 0.0..=1e9;
/// Coefficients of drag and of sunlight.
pub const COEFFICIENT: RangeInclusive<f64> = 0.0..=100.0;
/// Error allowed in a step of an integration, relative to distance and speed.
pub const TOLERANCE: RangeInclusive<f64> = 1e-14..=1e-3;

/// Most satellites of one scene whose states simulators send: each has threads and a port of its own.
pub const MAX_LIVE_ORBITS: usize = 64;
/// Simulated seconds in a second of a simulator that nobody waits for.
pub const RATE: RangeInclusive<f64> = 1e-3..=1e6;
/// How far pictures are behind a simulator that nobody waits for, seconds.
pub const PLAYBACK_DELAY_S: RangeInclusive<f64> = 0.0..=60.0;
/// How long a simulator waits for its picture, seconds.
pub const TIMEOUT_S: RangeInclusive<f64> = 1e-3..=3600.0;
/// Age of the last state from which on a simulator is told to be silent, seconds.
pub const STALE_AFTER_S: RangeInclusive<f64> = 1e-3..=1e6;
/// How far a satellite goes on beyond its simulator's last state, simulated seconds.
pub const EXTRAPOLATE_S: RangeInclusive<f64> = 0.0..=1e6;
/// How far apart two states are a jump, simulated seconds.
pub const GAP_S: RangeInclusive<f64> = 1e-3..=1e7;
/// Packets that a simulator may send in a second.
pub const PACKETS_PER_S: RangeInclusive<i64> = 1..=1_000_000;
/// Most web pages that may connect to a simulator's port.
pub const MAX_ORIGINS: usize = 16;
/// Time before or after now that a satellite's curve is drawn over, minutes: a week.
pub const SPAN_MIN: RangeInclusive<f64> = 0.0..=10_080.0;
/// Half angle of a sensor's cone about straight down, degrees.
pub const SENSOR_HALF_ANGLE_DEG: RangeInclusive<f64> = 0.001..=90.0;
/// Width of satellites' lines, pixels.
pub const TRACK_PX: RangeInclusive<f64> = 0.5..=16.0;

/// Vertical field of view, degrees: a thousandth of a degree away from no view at all and from a
/// half space, where a perspective projection has no meaning.
pub const FOV_DEG: RangeInclusive<f64> = 0.001..=179.999;
/// Geodetic latitude, degrees.
pub const LAT_DEG: RangeInclusive<f64> = -90.0..=90.0;
/// Longitude east, degrees, before it is brought to −180…180.
pub const LON_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// Height of the eye above the ellipsoid, kilometres: from one metre to seven times the distance of the Sun.
pub const HEIGHT_KM: RangeInclusive<f64> = 0.001..=1e9;

/// Heading of the eye, degrees clockwise from north.
pub const HEADING_DEG: RangeInclusive<f64> = -360.0..=360.0;
/// How far above the horizontal the eye looks, degrees.
pub const PITCH_DEG: RangeInclusive<f64> = -90.0..=90.0;

/// Cells per block edge.
pub const SUBDIVISION: RangeInclusive<i64> = 1..=48;

/// Most screen pixels that a texel of a tile may cover.
pub const TEXEL_PX: RangeInclusive<f64> = 0.25..=16.0;
/// Textures of maps and tiles, megabytes (10⁶ bytes): from what the coarsest maps take to more than any adapter has.
pub const TEXTURE_MB: RangeInclusive<f64> = 1.0..=1e6;
/// Tiles uploaded in one frame, megabytes.
pub const UPLOAD_MB: RangeInclusive<f64> = 0.01..=1e4;
/// How long a picture that is kept waits for its tiles, seconds.
pub const WAIT_S: RangeInclusive<f64> = 0.0..=3600.0;

/// Most files of heights.
pub const MAX_ELEVATION_FILES: usize = 1000;
/// Most pixels by which drawn ground may differ from its data.
pub const TOLERANCE_PX: RangeInclusive<f64> = 0.0..=1000.0;

/// Samples along an edge of a clipmap's level.
pub const CLIPMAP_SAMPLES: [i64; 3] = [65, 129, 257];
/// Levels of a clipmap besides the globe's.
pub const CLIPMAP_LEVELS: RangeInclusive<i64> = 0..=crate::globe::clipmap::MOST_LEVELS as i64;
/// Samples of a projected grid, across and down.
pub const GRID_SAMPLES: RangeInclusive<i64> = 2..=1025;

/// Most milliseconds that a frame may cost before quality is given up.
pub const TARGET_MS: RangeInclusive<f64> = 1.0..=1000.0;

/// Width and height of the picture, pixels: the largest texture side that desktop adapters promise.
pub const SIDE_PX: RangeInclusive<i64> = 1..=16_384;
/// Samples per pixel: the counts that every adapter can do.
pub const SAMPLES: [u32; 2] = [1, 4];

/// `[time] start` where a scene gives none.
pub const DEFAULT_START: &str = "2018-01-15T12:00:00Z";
/// `[time] duration_s` where a scene gives none: one revolution of the International Space Station.
pub const DEFAULT_DURATION_S: f64 = 5580.0;
/// `[time] speed` where a scene gives none.
pub const DEFAULT_SPEED: f64 = 60.0;
/// `[time] frame_rate_hz` where a scene gives none.
pub const DEFAULT_FRAME_RATE_HZ: f64 = 30.0;
/// `[orbit] gravity_degree` where a scene gives none: all there is.
pub const DEFAULT_GRAVITY_DEGREE: u32 = 20;
/// `[orbit] tolerance` where a scene gives none: millimetres a revolution.
pub const DEFAULT_TOLERANCE: f64 = 1e-10;
/// `[tracks] width_px` where a scene gives none.
pub const DEFAULT_TRACK_PX: f64 = 2.0;
/// `[camera] fov_deg` where a scene gives none.
pub const DEFAULT_FOV_DEG: f64 = 45.0;
/// `[camera] height_km` where a geodetic scene gives none: the whole disc in view.
pub const DEFAULT_HEIGHT_KM: f64 = 20_000.0;
/// `[camera] pitch_deg` where a geodetic scene gives none: straight down.
pub const DEFAULT_PITCH_DEG: f64 = -90.0;
/// `[output] size` where a scene gives none.
pub const DEFAULT_SIZE_PX: [u32; 2] = [1280, 720];
/// `[output] samples` where a scene gives none and there are edges to be seen: a craft's, or a limb without air. Else one.
pub const EDGE_SAMPLES: u32 = 4;
/// `[earth] texel_px` where a scene gives none.
pub const DEFAULT_TEXEL_PX: f64 = 1.0;
/// `[earth] texture_mb` where a scene gives none.
pub const DEFAULT_TEXTURE_MB: f64 = 512.0;
/// `[earth] upload_mb` where a scene gives none.
pub const DEFAULT_UPLOAD_MB: f64 = 8.0;
/// `[earth] tolerance_px` where a scene gives none.
pub const DEFAULT_TOLERANCE_PX: f64 = 1.0;
/// `[output] wait_s` where a scene gives none.
pub const DEFAULT_WAIT_S: f64 = 30.0;
