//! The numbers of one picture, as `terrella frame --stats` writes them.

use super::flight::Moment;
use super::maps::DroppedLayer;
use super::offscreen::{OffscreenRenderer, TimedFrame};
use super::quality_control::HeldQuality;
use glam::DVec3;
use std::time::Duration;
use terrella::FrameStats;
use terrella::frames::{Geodetic, rfc3339};
use terrella_imagery::tile::TileKey;

/// The numbers of one picture. Every key is always there, but `relief` only where terrain is, `tiles` only where a pack
/// is drawn, `exposure_ev` only where it was metered, `drawn_size` only where it is another, `quality` only where the scene holds a
/// frame time, `satellite` only where there is one, and `layers_missing` only where there are any.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PictureStats {
    /// Name of the adapter.
    pub adapter: String,
    /// vulkan, gl, metal or dx12.
    pub backend: String,
    /// Width and height, pixels.
    pub size: [u32; 2],
    /// Width and height that were drawn and enlarged to [`Self::size`]; left out where they are the same.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub drawn_size: Option<[u32; 2]>,
    /// Wall time of one frame, milliseconds: choosing, writing, drawing, waiting for the device. Not the first frame.
    pub frame_ms: f64,
    /// Wall time of its `prepare` alone, milliseconds.
    pub prepare_ms: f64,
    /// Blocks left by the horizon test.
    pub blocks_visible: u32,
    /// Blocks left by the frustum test too.
    pub blocks_drawn: u32,
    /// Triangles drawn, air and craft included.
    pub triangles: u32,
    /// Draw calls, air and craft included.
    pub draw_calls: u32,
    /// Bytes of all textures, mip levels included.
    pub texture_bytes: u64,
    /// Exposure value: light is multiplied by 2 to the power of it before display. Omitted if the scene sets it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub exposure_ev: Option<f64>,
    /// Terrain; omitted if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relief: Option<ReliefStats>,
    /// The quality that would hold the scene's frame time in the window; omitted without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub quality: Option<HeldQuality>,
    /// The tiles of the pack; omitted if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tiles: Option<TileStats>,
    /// Features that are drawn.
    pub features_on: Vec<String>,
    /// Features that are off and cost nothing.
    pub features_off: Vec<String>,
    /// Maps that are not there and without which it is drawn.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub layers_missing: Vec<String>,
    /// Position of the eye.
    pub eye: EyePosition,
    /// Illumination of the satellite; omitted if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub satellite: Option<SatelliteLight>,
    /// Position of the subsolar point.
    pub sun: SubsolarPoint,
    /// The instant, UTC, RFC 3339.
    pub epoch: String,
}

/// How terrain is drawn.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReliefStats {
    /// The surface, as scenes name it.
    pub surface: String,
    /// Triangles of the surface, those without area included.
    pub triangles: u32,
    /// Bytes that it holds in memory.
    pub resident_bytes: u64,
    /// Upper bound of the vertical distance between the drawn terrain and the data, metres; omitted by surfaces without a bound.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_m: Option<f64>,
    /// The same, pixels of the picture.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_px: Option<f64>,
}

/// State of the image's tiles. Lists are by level, the finest first.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TileStats {
    /// Texels of the day map per pixel, where there are fewest; 1 and more is sharp.
    pub texels_per_pixel: f64,
    /// Tiles that the image needs.
    pub wanted: Vec<u32>,
    /// Tiles on the GPU.
    pub resident: Vec<u32>,
    /// Maps of blocks drawn with the requested tile.
    pub hits: u32,
    /// Maps of blocks drawn with something coarser.
    pub fallbacks: u32,
    /// Bytes decoded so far.
    pub decoded_bytes: u64,
    /// Bytes uploaded so far.
    pub uploaded_bytes: u64,
    /// Tiles that made room for others so far.
    pub evictions: u64,
    /// Tiles that could not be read so far.
    pub failures: u64,
    /// Tiles that had not come when the picture was drawn.
    pub missing: Vec<String>,
}

impl TileStats {
    fn new(stats: &FrameStats, missing: &[TileKey]) -> Self {
        let counters = &stats.tiles;
        Self {
            texels_per_pixel: stats.texels_per_pixel,
            wanted: counters.requested.to_vec(),
            resident: counters.resident.to_vec(),
            hits: counters.hits,
            fallbacks: counters.fallbacks,
            decoded_bytes: counters.decoded_bytes,
            uploaded_bytes: counters.uploaded_bytes,
            evictions: counters.evictions,
            failures: counters.failures,
            missing: missing.iter().map(TileKey::to_string).collect(),
        }
    }
}

/// Where the eye is, above the scene's figure.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct EyePosition {
    /// Geodetic latitude, degrees.
    pub lat_deg: f64,
    /// Longitude east, degrees, −180…180.
    pub lon_deg: f64,
    /// Height above the ellipsoid, kilometres.
    pub height_km: f64,
}

/// Illumination of the satellite, and the uncertainty of its position.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SatelliteLight {
    /// "sunlit", "penumbra" or "umbra" of the Earth.
    pub light: String,
    /// Part of the Sun's disc that the Earth leaves in sight, 0…1.
    pub sunlight: f64,
    /// Uncertainty of the position, metres (one standard deviation); omitted if its source has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub error_m: Option<f64>,
}

/// The subsolar point.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SubsolarPoint {
    /// Geodetic latitude, degrees.
    pub lat_deg: f64,
    /// Longitude east, degrees, −180…180.
    pub lon_deg: f64,
}

impl PictureStats {
    /// Statistics of a measured image of `moment`, its missing tiles, and the maps. Without [`Self::quality`], which needs further images.
    pub fn new(
        renderer: &OffscreenRenderer,
        moment: &Moment,
        measured: &TimedFrame,
        missing: &[TileKey],
        dropped: &[DroppedLayer],
    ) -> Self {
        let info = renderer.adapter_info();
        let (width, height) = renderer.size();
        let counts = &measured.stats;
        let diagnostics = renderer.earth().diagnostics();
        let [sky_on, sky_off] = renderer.sky_features();
        let names = |names: Vec<&str>| names.into_iter().map(str::to_owned).collect();
        Self {
            adapter: info.name,
            backend: info.backend.to_string(),
            size: [width, height],
            drawn_size: Some(renderer.drawn_size().into())
                .filter(|drawn| *drawn != [width, height]),
            frame_ms: milliseconds(measured.frame),
            prepare_ms: milliseconds(measured.prepare),
            blocks_visible: counts.blocks_visible,
            blocks_drawn: counts.blocks_drawn,
            triangles: counts.triangles,
            draw_calls: counts.draw_calls,
            texture_bytes: counts.texture_bytes,
            exposure_ev: renderer.meters_exposure().then_some(counts.exposure_ev),
            relief: renderer.earth().surface_name().map(|surface| ReliefStats {
                surface: surface.to_owned(),
                triangles: counts.ground.triangles,
                resident_bytes: counts.ground.resident_bytes,
                error_m: counts.ground.error_m,
                error_px: counts.ground.error_px,
            }),
            quality: None,
            tiles: renderer
                .earth()
                .has_tiles()
                .then(|| TileStats::new(counts, missing)),
            features_on: names([diagnostics.features_on, sky_on].concat()),
            features_off: names([diagnostics.features_off, sky_off].concat()),
            layers_missing: names(dropped.iter().map(|dropped| dropped.layer).collect()),
            eye: EyePosition::new(counts.eye),
            satellite: moment.satellite.map(|satellite| {
                let (light, sunlight) = satellite.illumination;
                SatelliteLight {
                    light: light.name().to_owned(),
                    sunlight,
                    error_m: satellite.error_m,
                }
            }),
            sun: SubsolarPoint::new(moment.sky.sun_itrf),
            epoch: rfc3339(moment.epoch),
        }
    }

    /// As indented JSON with a line end.
    pub fn to_json(&self) -> String {
        // Numbers, strings and lists cannot fail to be written; the error is kept for the type's sake.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_else(|error| error.to_string());
        text.push('\n');
        text
    }
}

impl EyePosition {
    fn new(place: Geodetic) -> Self {
        Self {
            lat_deg: place.lat_rad.to_degrees(),
            lon_deg: place.lon_rad.to_degrees(),
            height_km: place.height_m / 1000.0,
        }
    }
}

impl SubsolarPoint {
    /// Where the ellipsoid's normal points at the Sun: its geodetic latitude is the direction's, on any figure.
    fn new(sun_itrf: DVec3) -> Self {
        Self {
            lat_deg: sun_itrf.z.atan2(sun_itrf.x.hypot(sun_itrf.y)).to_degrees(),
            lon_deg: sun_itrf.y.atan2(sun_itrf.x).to_degrees(),
        }
    }
}

/// Rounded to microseconds: further digits would be noise.
fn milliseconds(duration: Duration) -> f64 {
    (duration.as_secs_f64() * 1e6).round() / 1e3
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_its_direction_is_the_vertical() {
        let normal = terrella::frames::Ellipsoid::normal((-23.0_f64).to_radians(), 2.5);
        let point = SubsolarPoint::new(normal);
        assert!((point.lat_deg + 23.0).abs() < 1e-12);
        assert!((point.lon_deg - 2.5_f64.to_degrees()).abs() < 1e-12);
    }

    #[test]
    fn milliseconds_to_the_microsecond() {
        assert_eq!(milliseconds(Duration::from_nanos(1_234_567)), 1.235);
    }
}
