//! Playing a scene: clock, cameras, window, stills and video.
//!
//! [`Flight`] is a scene prepared for playback; for any time it returns a [`Moment`]: the eye and the sky. An [`OffscreenRenderer`] draws moments
//! without a display. There are three outputs: [`write_still`], [`export()`] (frames and video) and [`play_in_window`]. The first two, and image
//! files, need the feature `command`; without it [`ScenePictures`] returns the images of a scene in memory.
//!
//! | file | content |
//! |---|---|
//! | `clock` | simulated time, exact frame instants |
//! | `camera` | the four cameras of scenes, pure functions |
//! | `camera_path`, `spline` | what a scene's keys make of its camera in the course of time |
//! | `flight` | scene and orbit to moments |
//! | `satellites`, `opening` | the scene's sources of motion, opened; which of them says when the scene begins |
//! | `live`, `live_status` | the time of scenes whose simulator gives it; what the window reports of it |
//! | `basilisk/` | the same of simulations of Basilisk, and the pictures of their cameras |
//! | `simulator_time` | the window's time by either of them |
//! | `ephemeris` | where its satellites are, as tables and messages |
//! | `access_table` | when stations and satellites have access to each other |
//! | `coverage_map`, `coverage_cells` | how the sensors of satellites cover the ground |
//! | `coverage_layer`, `coverage_scale` | the same as a map on the globe; its colours and classes |
//! | `pass_table` | when they pass over a place |
//! | `event_table` | their eclipses, nodes and apsides, and what was found along integrated motions |
//! | `table_span` | the time of such a table |
//! | `maps` | the scene's maps: a folder or a pack |
//! | `colours` | colour spaces of their files |
//! | `dated_maps/` | maps that change with the date |
//! | `relief` | its elevation data |
//! | `craft/` | the spacecraft that the chase camera follows |
//! | `attitude`, `articulation` | how spacecraft and parts of their models are turned |
//! | `craft_models`, `model_layer/` | models of its satellites: the files, and how they are drawn |
//! | `tracks/` | trails, ground tracks, footprints and names of its satellites |
//! | `sky`, `sky_parts` | stars, Milky Way, Sun and Moon |
//! | `scene_files` | all input files of its images |
//! | `pictures` | a scene's images in memory, for calling programs |
//! | `scene_painter` | the layers of an image, and their order of preparation and drawing |
//! | `offscreen`, `still`, `stats`, `export`, `video/` | the offscreen renderer; images, their statistics, films |
//! | `outlook`, `export_words`, `written` | lighting of a film; summaries before it and of its files |
//! | `film/` | films and their images: formats, averaged light, ranges, continuing a film, the page `frames.json` |
//! | `file_checks` | early checks of files that are read later |
//! | `radiance` | an image's light as a file |
//! | `sensor_bands`, `raw_picture`, `seen_truth` | a sensor's view, row by row; its raw frame; ground truth of its pixels |
//! | `raw`, `raw_format`, `raw_manifest`, `raw_film` | the frame as a file, its format, the page of all its parameters, and raw films |
//! | `truth`, `truth_manifest` | ground truth as files |
//! | `float_files` | arrays and images of floats |
//! | `mp4` | checks that a video file is complete |
//! | `output` | files that are either complete or absent |
//! | `window`, `window_renderer`, `surface` | the window: its events, its renderer, its surface |
//! | `controls`, `keys`, `panel`, `overlay` | what the user has set, by which keys; the panel, and egui under it |
//! | `film_plan`, `panel_film` | the film of what the window plays, and its dialog |
//! | `picture_change` | what the user switches, made by a thread while the window goes on |
//! | `pointer`, `hand`, `orbit_camera` | clicks and drags; the eye that they move; the camera over the globe |
//! | `pose` | an eye and what it faces |
//! | `picking` | what is under a click |
//! | `egui_pass` | panel and names, drawn over pictures |
//! | `place_text` | places as a person reads them |
//! | `timeline/` | the time line along the bottom: scrubbing, real time, passes |
//! | `quality_control` | the scene's resolution, and adaptive quality |
//! | `frame_cost` | cost of frames, for adaptive quality |

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]

mod access_table;
mod articulation;
mod attitude;
#[cfg(test)]
#[path = "../../../tests/common/backends.rs"]
mod backends;
// Where a file is built without the command, what only that needs of it is left unused.
mod basilisk;
pub mod camera;
mod camera_path;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod caption_image;
mod caption_legend;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod captions;
pub mod clock;
#[cfg(feature = "window")]
mod colours;
#[cfg(feature = "window")]
mod controls;
mod coverage_cells;
mod coverage_layer;
mod coverage_map;
mod coverage_scale;
mod craft;
mod craft_models;
mod dated_maps;
mod egui_pass;
mod ephemeris;
mod error;
mod event_table;
#[cfg(feature = "window")]
mod export;
#[cfg(feature = "window")]
mod export_words;
mod file_checks;
#[cfg_attr(not(feature = "window"), allow(dead_code, unused_imports))]
mod film;
#[cfg(feature = "window")]
mod film_estimate;
#[cfg(feature = "window")]
mod film_plan;
mod flight;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod float_files;
#[cfg(feature = "window")]
mod focus;
#[cfg(feature = "window")]
mod frame_cost;
#[cfg(feature = "window")]
mod gap_words;
mod geo_layers;
mod geojson;
#[cfg(feature = "window")]
mod hand;
#[cfg(feature = "window")]
mod icons;
#[cfg(feature = "window")]
mod keys;
#[cfg(feature = "window")]
mod live;
#[cfg(feature = "window")]
mod live_status;
mod look_target;
#[cfg(test)]
mod look_target_tests;
mod map_lines;
#[cfg(feature = "window")]
mod map_scale;
mod maps;
mod model_layer;
mod mp4;
mod name_table;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod offscreen;
mod opening;
#[cfg(feature = "window")]
mod orbit_camera;
mod outlook;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod output;
#[cfg(feature = "window")]
mod overlay;
#[cfg(feature = "window")]
mod panel;
#[cfg(feature = "window")]
mod panel_film;
#[cfg(feature = "window")]
mod panel_help;
#[cfg(feature = "window")]
mod panel_layers;
mod pass_table;
#[cfg(feature = "window")]
mod picking;
#[cfg(feature = "window")]
mod picture_change;
mod pictures;
mod place_names;
mod place_text;
#[cfg(feature = "window")]
mod pointer;
mod pose;
mod progress;
mod quality_control;
#[cfg(feature = "window")]
mod radiance;
#[cfg(feature = "window")]
mod raw;
#[cfg(feature = "window")]
mod raw_film;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod raw_format;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod raw_manifest;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod raw_picture;
mod relief;
#[cfg(feature = "window")]
mod satellite_list;
mod satellites;
pub mod scene;
mod scene_files;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod scene_painter;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod seen_truth;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod sensor_bands;
#[cfg(feature = "window")]
mod shader_watch;
#[cfg(feature = "window")]
mod simulator_time;
mod sky;
mod sky_parts;
mod spline;
mod stats;
#[cfg(feature = "window")]
mod still;
mod stretches;
#[cfg(feature = "window")]
mod surface;
#[cfg(feature = "window")]
mod switches;
mod table_span;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod text_overlay;
#[cfg(feature = "window")]
mod theme;
#[cfg(feature = "window")]
mod timeline;
#[cfg_attr(not(feature = "window"), allow(dead_code))]
mod tracks;
#[cfg(feature = "window")]
mod truth;
#[cfg(feature = "window")]
mod truth_manifest;
#[cfg(feature = "window")]
mod video;
#[cfg(feature = "window")]
mod window;
#[cfg(feature = "window")]
mod window_renderer;
#[cfg(feature = "window")]
mod written;

pub use access_table::{AccessRequest, AccessTable};
#[cfg(feature = "window")]
pub use basilisk::{ServeRequest, serve};
pub use coverage_map::{CoverageMap, CoverageRequest};
pub use craft::CraftPose;
pub use ephemeris::{Axes, Ephemeris, EphemerisRequest, Layout, Selection, Span, omm, select};
pub use error::{PlayError, VideoError, WindowError};
pub use event_table::EventTable;
#[cfg(feature = "window")]
pub use export::{ExportRequest, export};
pub use film::{
    CameraRecord, DrawnFrame, Existing, FilmError, FilmFrames, FilmInput, FilmKey, FilmPainter,
    FilmPicture, FilmRequest, FrameRange, FrameRecord, HdrPicture, LightPicture, Painted,
    PictureFormat, PictureLook, PictureSettings, SharedFolder, Shutter, checksum,
};
pub use flight::{Flight, Moment, SatelliteState, ViewRequest};
pub use maps::{DroppedLayer, earth_options, shared_options};
pub use mp4::mp4_problem;
pub use name_table::names;
#[cfg(feature = "window")]
pub use offscreen::rgba_image;
pub use offscreen::{OffscreenRenderer, TimedFrame};
pub use outlook::{LightOutlook, LightTimes, night_note};
pub use output::{OutputError, PendingFile, png_bytes};
pub use pass_table::{PassRequest, PassTable};
pub use pictures::{ScenePictures, Shot, take_starter_files};
pub use place_text::GroundPlace;
pub use progress::Progress;
pub use quality_control::{HeldQuality, QualityControl, scene_quality};
#[cfg(feature = "window")]
pub use raw_film::{RawFilmRequest, write_raw_film};
pub use raw_format::RawFormat;
pub use relief::read_ground;
pub use satellites::{FileRemark, Satellite};
pub use scene_files::{SceneFile, scene_files};
pub use stats::{EyePosition, PictureStats, ReliefStats, SatelliteLight, SubsolarPoint, TileStats};
#[cfg(feature = "window")]
pub use still::{StillRequest, write_still};
pub use table_span::early_end;
#[cfg(feature = "window")]
pub use tracks::{TrackDetail, TracksLayer};
#[cfg(feature = "window")]
pub use video::{EncoderChoice, VideoCodec, VideoCoding};
#[cfg(feature = "window")]
pub use window::{WindowRequest, play_in_window};
#[cfg(feature = "window")]
pub use written::written_picture;
