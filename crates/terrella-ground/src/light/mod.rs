//! From light to display values: exposure and tone curves. Pure numbers, without GPU use.
//!
//! Light is scene-referred and linear from the maps to the colour target: a diffuse white sheet that faces the Sun in space
//! is 1. The conversion for an 8-bit target happens once, at the end: `shown = curve(light · 2^EV)`, dithered and encoded
//! (`shaders/common/displayed.wgsl`). A float target receives the light itself.
//!
//! | file | what |
//! |---|---|
//! | `exposure.rs` | exposure values, fixed or metered, and adaptation over time |
//! | `meter.rs` | metered exposure of a view |
//! | `neighbourhoods.rs` | coarse maps for it |
//! | `display_slope.rs` | slopes of those curves |
//! | `bloom.rs` | light scattered by a lens |
//! | `aperture.rs` | light diffracted by its aperture |
//! | `ghosts.rs` | images of the aperture by internal reflections |
//! | `srgb.rs` | encoding of display values |
//! | `tone.rs` | tone curves, the shaders' twins |
//! | `agx.rs` | the AgX curve |
//! | `grade.rs`, `white_balance.rs`, `grain.rs` | camera processing before and after the curve |
//! | `hdr.rs` | output for displays of high dynamic range |
//! | `response.rs` | measured camera responses |
//! | `response_text.rs` | their file format |

pub mod agx;
mod aperture;
mod bloom;
mod display_slope;
mod exposure;
mod ghosts;
mod grade;
mod grain;
mod hdr;
mod meter;
mod neighbourhoods;
mod response;
mod response_text;
mod srgb;
mod tone;
mod white_balance;

pub use aperture::{Aperture, DiffractionPattern, SUN_PLACE, SUN_PLACES};
pub use bloom::Bloom;
pub use display_slope::DisplaySlope;
pub use exposure::{Adaptation, Exposure, exposure_factor};
pub use ghosts::{Ghost, Ghosts};
pub use grade::Grade;
pub use grain::{GRAIN_BITS, GRAIN_INCREMENT, GRAIN_MULTIPLIER, GRAIN_SCALE, GRAIN_SHIFT, Grain};
pub use hdr::{Hdr, HdrTransfer};
pub use meter::{Meter, MeterView, NightLight, VIEW_RAYS, view_rays};
pub use neighbourhoods::Lamps;
pub use response::Response;
pub use response_text::{MAX_RESPONSE_BYTES, ResponseError};
pub use tone::Tone;
pub use tone::{
    CAMERA_HALF_RAISED, CAMERA_HAZE, CAMERA_SATURATION, CAMERA_STRAIGHT, CAMERA_TOE,
    CAMERA_TOE_LEAST, CAMERA_WHITE,
};
pub use tone::{FILMIC, FILMIC_SCALE, NEUTRAL_DESATURATION, NEUTRAL_START};
pub use white_balance::WhiteBalance;
