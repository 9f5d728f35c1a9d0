//! Terrella: a realistic Earth that any program can draw.
//!
//! The library is a wgpu component. The host owns device, queue, pass and depth buffer, and calls three verbs:
//! [`Earth::new`] (in a web page [`Earth::create`]), [`Earth::prepare`] and [`Earth::render`]; `examples/minimal.rs` is a whole host.
//!
//! ```
//! use terrella::frames::Epoch;
//! use terrella::{Earth, EarthOptions, EyeView, FrameRequest, LayerSelection, Sky};
//! use terrella::{find_textures, glam::DVec3, load_layers, wgpu};
//!
//! /// Once: reads the starter maps, uploads them and compiles pipelines.
//! fn create(
//!     device: &wgpu::Device,
//!     queue: &wgpu::Queue,
//! ) -> Result<Earth, Box<dyn std::error::Error>> {
//!     let layers = load_layers(&find_textures()?, LayerSelection::default())?;
//!     Ok(Earth::new(device, queue, &EarthOptions::new(layers))?)
//! }
//!
//! /// Each frame: the Earth from 12 000 km above the equator, drawn into the host's pass.
//! fn draw(
//!     earth: &mut Earth,
//!     queue: &wgpu::Queue,
//!     pass: &mut wgpu::RenderPass<'_>,
//!     size: (u32, u32),
//! ) {
//!     let aspect = f64::from(size.0) / f64::from(size.1);
//!     let view = EyeView::itrf(DVec3::X * 1.8e7, DVec3::NEG_X, DVec3::Z, 0.9, aspect);
//!     let sky = Sky::at(Epoch::from_gregorian_utc(2018, 6, 21, 9, 0, 0, 0));
//!     earth.prepare(queue, FrameRequest::new(&view, &sky, size));
//!     earth.render(pass);
//! }
//! ```
//!
//! ```text
//!  EyeView, Sky ──► Earth::prepare ─────────────────────────────► FrameStats
//!  (your camera,         │
//!   the Sun's date)      ▼
//!                   cull, select LOD ──► FramePlan ──► GPU buffers ──► Earth::render ──► your pass
//!                   (pure code)          (blocks, meshes,   ▲
//!                        │                levels, ground)   │ uploads, within a budget a frame
//!                        └──► tile requests ──► decoder threads
//! ```
//!
//! | item | purpose |
//! |---|---|
//! | [`Earth`] | the façade: `new`, `prepare`, `render` |
//! | [`EarthOptions`] | the options of an Earth: maps, air, shading, the host's formats |
//! | [`EyeView`] | the camera, in the host's own axes and unit |
//! | [`EarthView`] | a further view of the same Earth: split screens, stereo, cameras of instruments |
//! | [`Sky`] | Sun, Moon and stars at an [`Epoch`] |
//! | [`FrameStats`] | statistics of a frame |
//! | [`Atmosphere`], [`Shading`] | the air; the light on the ground |
//! | [`Exposure`], [`Tone`] | exposure and tone curve |
//! | [`MapUploader`], [`UploadedMaps`] | maps that are uploaded while they are read, and shared by several Earths |
//! | [`GpuMap`], [`MapFade`] | maps that change while the Earth is drawn, the host's own textures among them |
//! | [`Quality`], [`ScaledTarget`] | quality that changes while the Earth is drawn; rendering at a lower resolution |
//! | [`GroundOptions`], `SurfaceSettings` | terrain, and the surface that draws it |
//! | [`TileOptions`] | imagery larger than memory, streamed |
//! | `OffscreenEarth` | an Earth that owns its device and renders into memory, for programs without wgpu |
//! | `orbit::Feed` | where a satellite is, for `tracks::Tracks` and for your camera |
//!
//! # Features
//!
//! A host pays only for what it draws. By default this crate is the Earth and its air from the starter maps (`maps`), as whole maps in memory, on
//! all backends of wgpu. `tables` compiles in the tables of the default air; without it each start computes them, for half a second, in a debug
//! build for 40. `packs`, `terrain`, `tracks`, `celestial` and `offscreen` add the parts of these names, and `serde` reads and writes
//! [`SurfaceLight`]. Without `terrain`, [`GroundOptions`] has no value, and without `tiles`, [`TileOptions`] has none; the compiler drops all code
//! that would use one. With `default-features = false` the host chooses wgpu's backends, by the features `vulkan`, `gles`, `metal` and `dx12`, in a
//! web page `webgpu` and `webgl`, or by its own dependency on wgpu, which is re-exported as [`wgpu`].
//!
//! # Crates and modules
//!
//! | crate | content |
//! |---|---|
//! | `terrella-files` | opening untrusted files, writing durable ones, loading in the background |
//! | `terrella-frames` | reference frames and time, here as [`frames`] |
//! | `terrella-orbit` | satellites, here as `orbit` with the feature `tracks` |
//! | `terrella-ground` | elevation, globe, air and light as numbers |
//! | `terrella-imagery` | maps and packs of tiles |
//! | `terrella-model` | spacecraft models: glTF files |
//! | `terrella` | this crate: everything drawn with a GPU |
//! | `terrella-pack` | packs made from large maps, and fetched maps |
//! | `terrella-sensor` | camera sensors: lenses, point spread, electrons, noise |
//! | `terrella-play` | scene files, pictures, films, the window |
//! | `terrella-reference` | the reference renderer: exact ray casting on the CPU |
//! | `terrella-measure` | frame rates, error against run time |
//! | `terrella-cli` | the command |
//! | `terrella-maps` | the starter maps |
//!
//! A module may use those above it in this table and none below. The compiler enforces this between crates, `tests/house` within a crate.
//!
//! | module | knows | must not know |
//! |---|---|---|
//! | `files` | opening files from outside, files that are not finished, text from outside in messages | anything below |
//! | `durable` | files that survive a power failure: synced, then renamed | anything below |
//! | `clock` | the monotonic clock of every platform | anything below |
//! | `parallel` | work distributed over the cores, or done in sequence without threads | anything below |
//! | `loaders` | threads that load tiles in the background | anything below |
//! | [`frames`] | ellipsoid, time scales, Earth rotation, Sun; f64 | anything below |
//! | `orbit` | readers and propagators: a state at an epoch | GPU |
//! | `basilisk` | Basilisk simulations: sockets, messages and files, and their recorded state | GPU |
//! | `step` | the smooth step | GPU, files |
//! | `height` | elevation ranges, and statistics of streamed elevation data | GPU, files |
//! | `elevation` | elevation data: grids, their pyramids, readers | GPU |
//! | `globe` | the block sphere and the terrain surfaces: vertices, culling, level of detail | GPU, files |
//! | `half` | half floats | GPU, files |
//! | `air` | density, scattering tables, the billboard | GPU, files |
//! | `light` | exposure, tone curves, metering | GPU, files |
//! | `imagery` | maps and packs on disk, checks, mip levels, slopes, streaming | GPU, orbits |
//! | `model` | spacecraft models: glTF files as triangles, materials and textures | GPU, orbits |
//! | `shipped` | scenes that are compiled in | |
//! | `plan` | the content of a frame, as plain values | GPU, files, orbits |
//! | `gpu` | adapter, targets, shaders, one file per drawable | files, orbits |
//! | `earth` | the façade | the command |
//! | `offscreen` | an Earth that renders into memory | files, the command |
//! | `celestial` | stars, the Milky Way, Sun and Moon behind the Earth | files but the star catalogue, the command |
//! | `tracks` | trails, ground tracks, footprints and markers of feeds, lines on the globe, ground stations | files but coast lines and borders, the command |
//! | `pack` | packs built from large maps | GPU, orbits |
//! | `fetch` | maps from their public sources into a cache; the only network access | GPU, orbits |
//! | `sensor` | lenses, point spread, light to electrons and raw frames | GPU, files, scenes |
//! | `scene` | the TOML file, defaults, checks with line and key | GPU |
//! | `play` | clock, cameras, window, stills, video | |
//! | `reference` | the image as it should be, ray by ray in double precision | code of what draws |
//! | `measure` | harness, error against run time, stability | |
//! | `cli` | arguments, progress, exit codes | mathematics |
//!
//! `docs/architecture.md` explains how each part works and why, and where to change what; `docs/glossary.md` explains the project's terms.

// docs.rs shows the required feature of each item.
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(all(feature = "offscreen", target_family = "wasm"))]
compile_error!(
    "the feature `offscreen` waits for the device, which a web page cannot: leave it out there"
);

#[cfg(feature = "celestial")]
pub mod celestial;
#[doc(hidden)]
#[allow(missing_docs, reason = "documented where hosts meet it")]
pub mod earth;
#[doc(hidden)]
#[allow(missing_docs, reason = "documented where hosts meet it")]
pub mod gpu;
#[cfg(feature = "offscreen")]
#[doc(hidden)]
#[allow(missing_docs, reason = "documented where hosts meet it")]
pub mod offscreen;
#[doc(hidden)]
#[allow(missing_docs, reason = "documented where hosts meet it")]
pub mod plan;
#[doc(hidden)]
#[allow(missing_docs, reason = "documented where hosts meet it")]
pub mod shipped;
#[cfg(feature = "tracks")]
pub mod tracks;

/// Internals of the Earth, for the tests, benches, fuzz targets and the command of this repository. Hosts need none of them, and they change in any
/// version. See the table of modules above.
#[doc(hidden)]
pub mod internals {
    #[cfg(feature = "offscreen")]
    pub use crate::offscreen;
    pub use crate::{earth, gpu, plan, shipped};
}

pub use terrella_frames as frames;
#[cfg(feature = "terrain")]
pub use terrella_ground::elevation;
#[cfg(feature = "tracks")]
pub use terrella_orbit as orbit;
pub use {glam, wgpu};

pub use earth::{
    AdaptiveQuality, Appearance, ChangeMaker, DepthBuffer, DiagnosticOptions, Diagnostics, Earth,
    EarthError, EarthOptions, EarthView, EyeView, FrameRequest, FrameStats, GroundOptions,
    Pipelines, PixelRays, Quality, QualityChange, QualityLadder, QualityLadderError, QualityLevel,
    QualityReduction, QualityStep, ReadyChange, Sky, SurfaceOutput, TILED_SUBDIVISION, TileOptions,
    TruthPoint, TruthView, ViewError, ViewFrame, Viewport,
};
#[cfg(feature = "offscreen")]
pub use gpu::{AdapterReport, ContextError, GpuContext, GpuFault, PictureError, adapter_reports};
pub use gpu::{
    Attachments, BloomPass, Developer, Development, FrameTargets, GpuMap, MapError, MapFade,
    MapUploader, PassFormat, ScaledTarget, ShaderError, TruthTargets, TruthTexel,
    UndevelopedPicture, UploadedMaps,
};
#[cfg(feature = "offscreen")]
pub use offscreen::{
    Drawing, LayerDtype, LayerValues, OffscreenEarth, OffscreenError, TRUTH_LAYERS, TruthLayer,
    TruthPicture,
};
pub use plan::{LightEffect, SurfaceLight};
pub use terrella_frames::Epoch;
pub use terrella_ground::air::{AirFileError, supply as supply_air_tables};
pub use terrella_ground::air::{AirOptions, Atmosphere};
pub use terrella_ground::globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
#[cfg(feature = "terrain")]
pub use terrella_ground::globe::{
    SurfaceKind, SurfaceSettings, clipmap::ClipmapOptions, contours::ContourOptions,
    contours::PageOptions, projected_grid::GridOptions, quadtree::QuadtreeOptions,
};
pub use terrella_ground::height::HeightTileStats;
pub use terrella_ground::light::{
    Adaptation, Aperture, Bloom, DiffractionPattern, Exposure, Ghosts, Grade, Grain, Hdr,
    HdrTransfer, Response, Tone, WhiteBalance, exposure_factor,
};
#[cfg(all(feature = "packs", feature = "terrain"))]
pub use terrella_imagery::pack::PackHeights;
#[cfg(feature = "tiles")]
pub use terrella_imagery::stream::{HostedTiles, TileLoad, TileLoading};
pub use terrella_imagery::{
    CityLights, DetailTilesError, EarthLayers, ImageryError, LayerImage, LayerSelection, MapBands,
    MapFolder, MapRows, MapSink, PLACES_FILE, Season, TexelFormat, find_textures, load_layers,
    load_layers_to, load_seasonal_layers, supply_detail_tiles,
    tile::{LayerLayout, MapLayer, Tile, TileError, TileFormat, TileKey, TileShape, TileSource},
};
#[cfg(feature = "packs")]
pub use terrella_imagery::{
    pack::{Pack, PackTiles},
    tile::Storage,
};
