//! The page beside a raw frame: every parameter of the sensor, the camera's pose, and statistics of the frame.

use super::flight::{Flight, Moment};
use super::sensor_bands::{SensorBands, axes};
use terrella::frames::rfc3339;
use terrella_sensor::{ASTRONOMICAL_UNIT_M, Distortion, Psf, RawFrame, Sensor, Shutter, Wells};

/// A camera with its lens, as `raw` pages and truth pages have it.
///
/// The pixel (u, v) of a direction (X, Y, Z) along `right`, `down` and `ahead`, counted as OpenCV counts (the centre of the upper left
/// pixel is (0, 0)), is `camera_matrix` times the distorted (X/Z, Y/Z).
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct SensorCamera {
    /// Width and height, pixels.
    size: [u32; 2],
    camera_matrix: [[f64; 3]; 3],
    /// `brown-conrady` or `fisheye`, the models of OpenCV.
    distortion_model: &'static str,
    /// In OpenCV's order.
    distortion: Vec<f64>,
    /// Rows that were drawn at one instant, from the top.
    poses: Vec<BandPose>,
    /// Largest image motion between a row's own time and that of its pose, pixels.
    motion_px: f64,
}

/// The camera at the instant of some rows; unit vectors and metres in ITRF axes.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct BandPose {
    first_row: u32,
    rows: u32,
    epoch: String,
    eye_itrf_m: [f64; 3],
    right: [f64; 3],
    down: [f64; 3],
    ahead: [f64; 3],
}

impl SensorCamera {
    /// That of a frame's bands. Neighbours with one instant are one.
    pub fn new(sensor: &Sensor, bands: &SensorBands) -> Self {
        let lens = &sensor.lens;
        let focal = lens.focal_px();
        let center = lens.principal_point_px();
        let mut poses: Vec<BandPose> = Vec::new();
        for band in &bands.bands {
            let epoch = rfc3339(band.moment.epoch);
            let (eye, _) = band.moment.view.to_itrf();
            let [right, down, ahead] = axes(&band.moment.view).map(|axis| axis.to_array());
            let rows = band.rows.len() as u32;
            match poses.last_mut() {
                Some(pose) if pose.epoch == epoch => pose.rows += rows,
                _ => poses.push(BandPose {
                    first_row: band.rows.start,
                    rows,
                    epoch,
                    eye_itrf_m: eye.to_array(),
                    right,
                    down,
                    ahead,
                }),
            }
        }
        let (distortion_model, distortion) = match lens.distortion() {
            Distortion::BrownConrady(k) => ("brown-conrady", k.to_vec()),
            Distortion::Fisheye(k) => ("fisheye", k.to_vec()),
        };
        Self {
            size: lens.size(),
            camera_matrix: [
                [focal, 0.0, center.x],
                [0.0, focal, center.y],
                [0.0, 0.0, 1.0],
            ],
            distortion_model,
            distortion,
            poses,
            motion_px: bands.motion_px,
        }
    }
}

/// Content of a raw frame's page.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct RawManifest {
    /// Identifier of the file format.
    format: &'static str,
    /// Version of the program.
    version: &'static str,
    /// The scene's file.
    scene: String,
    /// The frame's file beside the page.
    file: String,
    /// The middle of the first row's exposure, UTC, RFC 3339.
    epoch: String,
    /// Number of the frame, which selects its noise.
    frame: u32,
    seed: u64,
    camera: SensorCamera,
    optics: Optics,
    detector: DetectorEntry,
    /// Electrons of a pixel on the axis for a white diffuse sheet that faces the Sun in space, by band; filters aside.
    electrons_of_white: [f64; 3],
    sun_distance_au: f64,
    result: FrameResult,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Optics {
    focal_length_mm: f64,
    pixel_pitch_um: f64,
    f_number: f64,
    exposure_s: f64,
    transmission: f64,
    bands_nm: [[f64; 2]; 3],
    quantum_efficiency: [f64; 3],
    cos4: bool,
    vignetting: [f64; 3],
    psf: PsfEntry,
    oversampling: u32,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
#[serde(tag = "kind", rename_all = "lowercase")]
enum PsfEntry {
    None,
    Gaussian { sigma_px: f64 },
    Airy { lambda_n_px: f64 },
    Measured { side: usize, weights: Vec<f64> },
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct DetectorEntry {
    mosaic: &'static str,
    full_well_e: f64,
    blooming: bool,
    dark_current_e_s: f64,
    dsnu_e: f64,
    prnu: f64,
    hot_pixel_fraction: f64,
    hot_pixel_e_s: f64,
    read_noise_e: f64,
    bits: u32,
    bias_dn: f64,
    gain_e_dn: f64,
    shutter: &'static str,
    /// From one row to the next, seconds; 0 of a global shutter.
    line_time_s: f64,
    from_below: bool,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct FrameResult {
    /// Pixels whose number is the greatest.
    saturated: usize,
    /// Pixels that are hot, as [column, row]; the first thousand.
    hot_pixels: Vec<[u32; 2]>,
    /// Electrons beyond the full well that no pixel took.
    lost_e: f64,
}

/// Most hot pixels that are listed.
const MAX_HOT: usize = 1000;

/// Inputs of a page.
pub struct RawParts<'p> {
    /// The frame's file name.
    pub file: String,
    /// Instant of the first row.
    pub moment: &'p Moment,
    /// The sensor.
    pub sensor: &'p Sensor,
    /// Its bands.
    pub bands: &'p SensorBands,
    /// Number of the frame.
    pub number: u32,
    /// The raw frame.
    pub raw: &'p RawFrame,
    /// The wells that it was read from.
    pub wells: &'p Wells,
}

impl RawManifest {
    /// The page of a frame.
    pub fn new(flight: &Flight, parts: &RawParts<'_>) -> Self {
        let sensor = parts.sensor;
        let (lens, optics, detector) = (&sensor.lens, &sensor.radiometry, &sensor.detector);
        let sun_distance_au = parts.moment.sky.sun_distance_m / ASTRONOMICAL_UNIT_M;
        let photons = optics.photons(lens, sun_distance_au);
        let (line_time_s, from_below) = match sensor.shutter {
            Shutter::Global => (0.0, false),
            Shutter::Rolling {
                line_time_s,
                from_below,
            } => (line_time_s, from_below),
        };
        let white = detector.white();
        let width = parts.raw.width.max(1);
        let hot =
            (0..parts.raw.data.len() as u32).filter(|pixel| detector.is_hot(sensor.seed, *pixel));
        Self {
            format: "terrella raw 1",
            version: env!("CARGO_PKG_VERSION"),
            scene: flight.scene().path.display().to_string(),
            file: parts.file.clone(),
            epoch: rfc3339(parts.moment.epoch),
            frame: parts.number,
            seed: sensor.seed,
            camera: SensorCamera::new(sensor, parts.bands),
            optics: Optics {
                focal_length_mm: lens.focal_length_mm(),
                pixel_pitch_um: lens.pixel_pitch_um(),
                f_number: optics.f_number,
                exposure_s: optics.exposure_s,
                transmission: optics.transmission,
                bands_nm: optics.bands_nm,
                quantum_efficiency: optics.quantum_efficiency,
                cos4: optics.cos4,
                vignetting: optics.vignetting,
                psf: match &sensor.psf {
                    Psf::None => PsfEntry::None,
                    Psf::Gaussian { sigma_px } => PsfEntry::Gaussian {
                        sigma_px: *sigma_px,
                    },
                    Psf::Airy { lambda_n_px } => PsfEntry::Airy {
                        lambda_n_px: *lambda_n_px,
                    },
                    Psf::Measured(kernel) => PsfEntry::Measured {
                        side: kernel.side(),
                        weights: kernel.weights().to_vec(),
                    },
                },
                oversampling: sensor.oversampling,
            },
            detector: DetectorEntry {
                mosaic: sensor.mosaic.name(),
                full_well_e: detector.full_well_e,
                blooming: detector.blooming,
                dark_current_e_s: detector.dark_current_e_s,
                dsnu_e: detector.dsnu_e,
                prnu: detector.prnu,
                hot_pixel_fraction: detector.hot_pixel_fraction,
                hot_pixel_e_s: detector.hot_pixel_e_s,
                read_noise_e: detector.read_noise_e,
                bits: detector.bits,
                bias_dn: detector.bias_dn,
                gain_e_dn: detector.gain_e_dn,
                shutter: match sensor.shutter {
                    Shutter::Global => "global",
                    Shutter::Rolling { .. } => "rolling",
                },
                line_time_s,
                from_below,
            },
            electrons_of_white: std::array::from_fn(|band| {
                photons[band] * optics.quantum_efficiency[band]
            }),
            sun_distance_au,
            result: FrameResult {
                saturated: parts
                    .raw
                    .data
                    .iter()
                    .filter(|number| **number == white)
                    .count(),
                hot_pixels: hot
                    .take(MAX_HOT)
                    .map(|pixel| [pixel % width, pixel / width])
                    .collect(),
                lost_e: parts.wells.lost_e,
            },
        }
    }

    /// The page as JSON.
    pub fn to_json(&self) -> String {
        // Numbers, strings and lists cannot fail to be written; the error is kept for the type's sake.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_else(|error| error.to_string());
        text.push('\n');
        text
    }
}
