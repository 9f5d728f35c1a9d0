//! The page beside the layers of truth: what they are, and the view that they are of.

use super::flight::{Flight, Moment};
use super::raw_manifest::SensorCamera;
use terrella::TRUTH_LAYERS;
use terrella::TruthView;
use terrella::frames::{Ellipsoid, rfc3339};

/// The image of all layers.
pub const PICTURE: &str = "truth.exr";

/// Content of `truth.json`.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct TruthManifest {
    /// Identifier of the file format.
    format: &'static str,
    /// The scene's file.
    scene: String,
    /// The instant, UTC, RFC 3339.
    epoch: String,
    /// Width and height, pixels.
    size: [u32; 2],
    figure: Figure,
    eye: Eye,
    /// A pinhole camera; `None` where a sensor has its own.
    camera: Option<Camera>,
    /// The sensor whose pixels the layers have.
    sensor: Option<SensorCamera>,
    /// Unit vector to the Sun from the Earth's centre, ITRF axes.
    sun_itrf: [f64; 3],
    /// The Moon's centre from the Earth's, ITRF axes, metres.
    moon_itrf_m: Option<[f64; 3]>,
    layers: Vec<LayerEntry>,
    /// The image of all layers.
    picture: Picture,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Figure {
    equatorial_radius_m: f64,
    polar_radius_m: f64,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Eye {
    itrf_m: [f64; 3],
    lat_deg: f64,
    lon_deg: f64,
    height_m: f64,
}

/// The ray through (x, y), pixels from the upper left corner, is `corner_ray` + x `pixel_right` + y `pixel_down`, ITRF axes, of any
/// length.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Camera {
    fov_x_deg: f64,
    fov_y_deg: f64,
    corner_ray: [f64; 3],
    pixel_right: [f64; 3],
    pixel_down: [f64; 3],
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct LayerEntry {
    name: &'static str,
    file: String,
    dtype: &'static str,
    shape: Vec<u32>,
    unit: &'static str,
    what: &'static str,
    /// Its channels in the picture: their sum, or its three components.
    channels: Vec<String>,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize)]
struct Picture {
    file: &'static str,
}

impl TruthManifest {
    /// The page for a moment's layers.
    pub fn new(
        flight: &Flight,
        moment: &Moment,
        view: &TruthView,
        figure: &Ellipsoid,
        size: (u32, u32),
        sensor: Option<SensorCamera>,
    ) -> Self {
        let eye_itrf_m = view.eye_itrf_m();
        let eye = figure.geodetic_from_itrf(eye_itrf_m);
        let [corner, right, down] = view.corner_right_down();
        let projection = &moment.view.clip_from_view;
        let fov_deg = |scale: f64| 2.0 * (1.0 / scale).atan().to_degrees();
        Self {
            format: "terrella truth 1",
            scene: flight.scene().path.display().to_string(),
            epoch: rfc3339(moment.epoch),
            size: size.into(),
            figure: Figure {
                equatorial_radius_m: figure.equatorial_radius_m,
                polar_radius_m: figure.polar_radius_m,
            },
            eye: Eye {
                itrf_m: eye_itrf_m.to_array(),
                lat_deg: eye.lat_rad.to_degrees(),
                lon_deg: eye.lon_rad.to_degrees(),
                height_m: eye.height_m,
            },
            camera: sensor.is_none().then(|| Camera {
                fov_x_deg: fov_deg(projection.x_axis.x),
                fov_y_deg: fov_deg(projection.y_axis.y),
                corner_ray: corner.to_array(),
                pixel_right: right.to_array(),
                pixel_down: down.to_array(),
            }),
            sensor,
            sun_itrf: moment.sky.sun_itrf.to_array(),
            moon_itrf_m: moment.sky.moon_itrf_m.map(|moon| moon.to_array()),
            layers: TRUTH_LAYERS
                .iter()
                .map(|layer| LayerEntry {
                    name: layer.name,
                    file: layer.file(),
                    dtype: layer.dtype.name(),
                    shape: layer.shape(size),
                    unit: layer.unit,
                    what: layer.what,
                    channels: layer.channels(),
                })
                .collect(),
            picture: Picture { file: PICTURE },
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
