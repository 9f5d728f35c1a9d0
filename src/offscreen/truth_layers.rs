//! The layers of ground truth: names, units, meanings, and values of a pixel.

use crate::TruthPoint;

/// Number type of a layer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LayerDtype {
    /// 32-bit floats.
    F32,
    /// 64-bit floats.
    F64,
}

impl LayerDtype {
    /// NumPy's name.
    pub fn name(self) -> &'static str {
        match self {
            Self::F32 => "<f4",
            Self::F64 => "<f8",
        }
    }
}

/// Ground truth of a pixel.
#[derive(Clone, Copy, Debug)]
pub struct TruthPixel {
    /// The point on the ground; `None` if no ground is visible.
    pub point: Option<TruthPoint>,
    /// [`crate::TruthView::limb_distance_rad`].
    pub limb_distance_rad: Option<f64>,
    /// Whether there is a map of open water.
    pub has_water: bool,
}

#[derive(Clone, Copy, Debug)]
pub struct TruthLayer {
    /// Its name; its file has `.npy` after it.
    pub name: &'static str,
    /// The unit of its numbers, "1" for dimensionless ones.
    pub unit: &'static str,
    pub what: &'static str,
    /// Their type.
    pub dtype: LayerDtype,
    value: Value,
}

#[derive(Clone, Copy, Debug)]
enum Value {
    Ground(fn(&TruthPoint) -> f64),
    /// Of ground, three components.
    Vector(fn(&TruthPoint) -> [f64; 3]),
    Pixel(fn(&TruthPixel) -> f64),
}

const fn layer(
    name: &'static str,
    unit: &'static str,
    what: &'static str,
    value: Value,
) -> TruthLayer {
    TruthLayer {
        name,
        unit,
        what,
        dtype: LayerDtype::F32,
        value,
    }
}

const fn wide(layer: TruthLayer) -> TruthLayer {
    TruthLayer {
        dtype: LayerDtype::F64,
        ..layer
    }
}

pub const TRUTH_LAYERS: &[TruthLayer] = &[
    wide(layer(
        "lat_deg",
        "degree",
        "geodetic latitude",
        Value::Ground(|point| point.place.lat_rad.to_degrees()),
    )),
    wide(layer(
        "lon_deg",
        "degree",
        "longitude, east of Greenwich, -180 to 180",
        Value::Ground(|point| point.place.lon_rad.to_degrees()),
    )),
    layer(
        "range_m",
        "metre",
        "distance from the eye",
        Value::Ground(|point| point.range_m),
    ),
    layer(
        "height_m",
        "metre",
        "height of the drawn ground above mean sea level, which is drawn on the ellipsoid",
        Value::Ground(|point| point.place.height_m),
    ),
    layer(
        "sun_elevation_deg",
        "degree",
        "elevation of the Sun's centre over the ellipsoid's horizon, without refraction",
        Value::Ground(|point| point.sun_elevation_rad.to_degrees()),
    ),
    layer(
        "lit",
        "1",
        "fraction of the Sun's disc above that horizon: 1 by day, 0 by night",
        Value::Ground(|point| point.sunlit),
    ),
    layer(
        "moon_shadow",
        "1",
        "fraction of the Sun's disc that the Moon hides",
        Value::Ground(|point| point.moon_shadow),
    ),
    layer(
        "land",
        "1",
        "fraction of the pixel that is no open water: land, and the ice of a season; NaN everywhere without a map of open water",
        Value::Pixel(|pixel| match (&pixel.point, pixel.has_water) {
            (Some(point), true) => point.land,
            _ => f64::NAN,
        }),
    ),
    layer(
        "cloud_cover",
        "1",
        "cloud cover between the eye and the ground of the pixel; 0 without clouds",
        Value::Ground(|point| point.cloud_cover),
    ),
    layer(
        "normal_itrf",
        "1",
        "unit normal of the drawn ground, ITRF axes",
        Value::Vector(|point| point.normal_itrf.to_array()),
    ),
    layer(
        "limb_distance_deg",
        "degree",
        "angle from the ellipsoid's limb, below 0 on the disc; of sky too",
        Value::Pixel(|pixel| pixel.limb_distance_rad.map_or(f64::NAN, f64::to_degrees)),
    ),
];

impl TruthLayer {
    /// The name of its file.
    pub fn file(&self) -> String {
        format!("{}.npy", self.name)
    }

    /// Numbers a pixel.
    pub fn components(&self) -> usize {
        match self.value {
            Value::Vector(_) => 3,
            _ => 1,
        }
    }

    /// The axes of its array for a picture of this width and height.
    pub fn shape(&self, (width, height): (u32, u32)) -> Vec<u32> {
        match self.value {
            Value::Vector(_) => vec![height, width, 3],
            _ => vec![height, width],
        }
    }

    /// Its channels in an image of 32-bit floats.
    pub fn channels(&self) -> Vec<String> {
        let name = self.name;
        match (self.value, self.dtype) {
            (Value::Vector(_), _) => ["x", "y", "z"].map(|axis| format!("{name}.{axis}")).into(),
            (_, LayerDtype::F64) => vec![name.to_owned(), format!("{name}_rest")],
            (_, LayerDtype::F32) => vec![name.to_owned()],
        }
    }

    /// Its values at a pixel; a layer of one component uses the first. NaN without a value.
    pub fn values(&self, pixel: &TruthPixel) -> [f64; 3] {
        let one = |value| [value, f64::NAN, f64::NAN];
        match self.value {
            Value::Ground(of) => one(pixel.point.as_ref().map_or(f64::NAN, of)),
            Value::Pixel(of) => one(of(pixel)),
            Value::Vector(of) => pixel.point.as_ref().map_or([f64::NAN; 3], of),
        }
    }
}
