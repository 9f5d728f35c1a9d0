//! Playing a scene: clock, cameras, window, stills and video.
//!
//! [`Flight`] is a scene made ready; at any instant it gives a [`Moment`]: where the eye is and what lights the Earth.
//! A [`Picture`] draws moments without a display. Three ways lead out: [`write_still`], [`export()`] (frames and video)
//! and [`play_in_window`].
//!
//! | file | what |
//! |---|---|
//! | `clock` | simulated time, exact frame instants |
//! | `camera` | the four cameras, pure functions |
//! | `flight` | scene and orbit to moments |
//! | `satellites` | the scene's sources of motion, opened |
//! | `live` | the time of scenes whose simulator gives it |
//! | `ephemeris` | where its satellites are, as tables and messages |
//! | `pass_table` | when they pass over a place |
//! | `maps` | the scene's maps: a folder or a pack |
//! | `relief` | its heights |
//! | `craft/` | the spacecraft that the chase camera follows |
//! | `tracks/` | trails, ground tracks, footprints and names of its satellites |
//! | `picture`, `still`, `stats`, `export`, `video/` | pictures, their numbers, films |
//! | `destination` | files that are whole or not there |
//! | `window`, `stage`, `surface`, `overlay`, `panel`, `controls`, `keys` | the window |
//! | `egui_pass` | panel and names, drawn over pictures |
//! | `place_text` | places as a person reads them |
//! | `timeline/` | the time line along the bottom: scrubbing, real time, passes |
//! | `cost` | what its frames cost, for adaptive quality |

pub mod camera;
pub mod clock;
mod controls;
mod cost;
mod craft;
mod destination;
mod egui_pass;
mod ephemeris;
mod error;
mod export;
mod flight;
mod keys;
mod live;
mod maps;
mod overlay;
mod panel;
mod pass_table;
mod picture;
mod place_text;
mod progress;
mod relief;
mod satellites;
mod stage;
mod stats;
mod still;
mod surface;
mod timeline;
mod tracks;
mod video;
mod window;

pub use craft::CraftPose;
pub use destination::{OutputError, PendingFile};
pub use ephemeris::{Axes, Ephemeris, EphemerisRequest, Layout, Span, omm};
pub use error::{PlayError, VideoError, WindowError};
pub use export::{ExportRequest, export};
pub use flight::{Flight, Moment, Satellite, ViewRequest};
pub use maps::earth_options;
pub use pass_table::{PassRequest, PassTable};
pub(crate) use picture::rgba_image;
pub use picture::{Measured, Picture, target_bytes};
pub use progress::Progress;
pub use relief::read_ground;
pub use satellites::Tracked;
pub use stats::{Eye, Stats, SubsolarPoint};
pub use still::{StillRequest, write_still};
pub use video::EncoderChoice;
pub use window::{WindowRequest, play_in_window};
