//! From light to display values: how bright a picture is shown, and by which curve. Pure numbers, no GPU here.
//!
//! Light is scene-referred and linear from the maps to the colour target: a diffuse white sheet that faces the Sun in space
//! is 1. What an 8-bit target shows of it is decided once and last: `shown = curve(light · 2^EV)`, dithered and encoded
//! (`shaders/common/displayed.wgsl`). A float target gets the light itself.
//!
//! | file | what |
//! |---|---|
//! | `exposure.rs` | exposure values, fixed or metered, and how a metered one follows in time |
//! | `meter.rs` | the exposure that a view asks for |
//! | `display_slope.rs` | how steeply those curves rise |
//! | `bloom.rs` | light that a lens scatters before that |
//! | `aperture.rs` | light that its aperture diffracts |
//! | `ghosts.rs` | images of the aperture that reflections in it make |
//! | `srgb.rs` | encoding of display values |
//! | `tone.rs` | tone curves, the shaders' twins |
//! | `agx.rs` | one of them |
//! | `grade.rs`, `white_balance.rs`, `grain.rs` | what a camera does to light before the curve, and after it |
//! | `hdr.rs` | the same for displays of high dynamic range |
//! | `response.rs` | measured camera responses |
//! | `response_text.rs` | their files |

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
pub use response::Response;
pub use response_text::{MAX_RESPONSE_BYTES, ResponseError};
pub use tone::Tone;
pub use tone::{
    CAMERA_HALF_RAISED, CAMERA_SATURATION, CAMERA_STRAIGHT, CAMERA_TOE, CAMERA_TOE_LEAST,
    CAMERA_WHITE,
};
pub use tone::{FILMIC, FILMIC_SCALE, NEUTRAL_DESATURATION, NEUTRAL_START};
pub use white_balance::WhiteBalance;
