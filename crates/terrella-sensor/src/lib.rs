//! A camera sensor: from the light of a scene to the numbers of a raw frame.
//!
//! A [`Sensor`] takes the image of a pinhole camera, as a renderer draws it, through these steps:
//!
//! ```text
//! pinhole picture ─► distortion ─► point spread and pixel ─► electrons ─► noise, full well ─► numbers
//!  (PinholeFrame)      (Lens)            (Psf)             (Radiometry)     (Detector)      (RawFrame)
//! ```
//!
//! [`Sensor::pinhole`] returns the required image, [`Sensor::expose`] applies lens and pixels to it, and [`Sensor::read_out`] makes the frame.
//! Light is relative: 1 is a white diffuse sheet that faces the Sun in space. Pixel coordinates are those of OpenCV: the centre of the upper left
//! pixel is (0, 0). All random numbers are functions of seed, pixel and frame.
//!
//! | file | content |
//! |---|---|
//! | `distortion`, `lens` | Brown–Conrady and fisheye models, their inverse; pixels to rays |
//! | `pinhole` | the required image |
//! | `psf`, `fourier` | point spread functions and their transfer; the transform that applies them |
//! | `radiometry` | the Sun's spectrum, aperture, exposure, quantum efficiency, vignetting |
//! | `detector`, `philox` | wells, noise and converter; random numbers |
//! | `mosaic`, `shutter` | Bayer patterns; when rows are exposed |
//! | `limits`, `error` | ranges of the parameters |
//! | `sensor` | the complete sensor |

mod detector;
mod distortion;
mod error;
mod fourier;
mod lens;
pub mod limits;
mod mosaic;
mod philox;
mod pinhole;
mod psf;
mod radiometry;
mod sensor;
mod shutter;

pub use detector::{Detector, RawFrame, Wells};
pub use distortion::Distortion;
pub use error::SensorError;
pub use lens::{Lens, PlaneRect};
pub use mosaic::Mosaic;
pub use pinhole::{PinholeFrame, PinholePicture};
pub use psf::{Kernel, Psf, pixel_transfer};
pub use radiometry::{ASTRONOMICAL_UNIT_M, Band, Radiometry, solar_photons_m2_s};
pub use sensor::Sensor;
pub use shutter::{Shutter, bands};
