//! Terrella: a realistic Earth that any program can draw.
//!
//! The library is a wgpu component: the host owns device, queue, pass and depth buffer, and calls three verbs,
//! [`Earth::new`], [`Earth::prepare`] and [`Earth::render`]. The command `terrella` plays scene files with the same
//! public interface. This page is the architecture of both.
//!
//! # One frame, as data flows
//!
//! ```text
//! scene.toml ─► scene ─► clock ─► orbit ─► frames ─► view ─► globe ──► gpu ──► picture
//!              (what)   (when)   (where   (ITRF,    (eye,   (which    (draw)
//!                                is it)   Sun)      rays)   blocks)
//!                                                      ├──► air (which part of the screen)
//!                                                      └──► levels ─► imagery::stream ─► gpu
//!                                                          (how fine)  (which tiles are there)
//! ```
//!
//! Every arrow is a plain value ([`frames::Epoch`], [`orbit::OrbitState`], [`EyeView`], [`globe::Block`],
//! [`FrameStats`]), so each room can be tested alone.
//!
//! # Rooms
//!
//! A room may use those above it in this table and none below; `tests/house` reads the sources and holds it.
//!
//! | room | knows | must not know |
//! |---|---|---|
//! | [`frames`] | ellipsoid, time scales, Earth rotation, Sun; f64 | anything below |
//! | [`orbit`] | readers and propagators: a state at an epoch | GPU |
//! | [`elevation`] | heights of the ground: grids, their pyramids, readers of elevation data | GPU |
//! | [`globe`] | the block sphere, and surfaces with relief: lattice, horizon and frustum tests, level choice | GPU, files |
//! | [`air`] | density, scattering tables, the billboard | GPU, files |
//! | [`imagery`] | maps and packs on disk, checks, mip levels, slopes, streaming | GPU, orbits |
//! | [`scene`] | the TOML file, defaults, checks with line and key | GPU |
//! | [`gpu`] | adapter, targets, shaders, one file per drawable | files, orbits |
//! | [`earth`] | the façade | the command |
//! | [`tracks`] | trails, ground tracks, footprints and markers of feeds | files, the command |
//! | `play` | clock, cameras, window, stills, video | |
//! | `measure` | harness, reference renderer, error against run time, stability | |
//! | `cli` | arguments, progress, exit codes | mathematics |
//!
//! # The Earth, after Wang and Dai 2011
//!
//! "Realistic rendering of virtual earth in real-time application", Journal of Beijing University of Aeronautics and
//! Astronautics 37(8). What is kept, and what is mended:
//!
//! - **Blocks.** 16 × 8 blocks of 22.5°, n × n cells each (6 as printed, 1…48). Latitudes are geodetic, so that cells
//!   meet the texels of an equirectangular map. Neighbours share vertices bit for bit: no cracks.
//! - **Visibility.** The printed rule, (e − v)·n > 0 at a block's corners, loses visible blocks near the ground (a third
//!   of all views at 100 km). [`globe::select_blocks`] finds the largest P′·e′ over a whole block in closed form, and
//!   the facets that face the eye; the printed rule remains as [`Visibility::Paper`].
//! - **Where a pixel looks.** The mesh says which pixels show the ground; what they show is found by the pixel's own
//!   ray on the exact ellipsoid. So a coarse mesh costs accuracy at its silhouette only, and there is no seam at ±180°,
//!   no swirl at the poles, and no derivative to go wrong at the limb: the mip level follows the ray's footprint. How
//!   many cells that silhouette needs is chosen for each picture ([`globe::Meshes`]).
//! - **Shading.** The three layers as printed ([`Shading::Paper`], display values), or real sunlight in linear light.
//!   n and L of the printed formula are both taken in Earth-fixed axes.
//! - **Air.** The square of side 2√(L1·L2) that faces the eye, enlarged to the air's tangent cone, carries a halo that is
//!   computed ([`air::AirTables`]): single scattering along each ray and higher orders after Hillaire 2020. In the air
//!   the shader marches along the ray instead of reading the table.
//!
//! # Imagery larger than memory
//!
//! A *pack* ([`imagery::pack`] describes the format) holds each map at several levels, cut into one tile for each block,
//! with borders. `terrella pack build` makes it from maps of any size ([`imagery::build`], feature `pack-build`).
//!
//! - **The coarsest level is a whole map**, drawn as the maps of a scene without a pack are, and resident from the first
//!   frame. It is the last stand-in of everything, so that there is never a hole.
//! - **Levels.** [`globe::screen_level`] takes the coarsest level whose texels are small enough on screen, by each block's
//!   own distance and with hysteresis; [`globe::paper_level`] is the paper's Table 1. Blocks in the dark request no day
//!   tiles, blocks in daylight no city lights.
//! - **Streaming** ([`imagery::stream`]) knows no GPU: slots of fixed pools are allocated to requests, decoder threads of low
//!   priority take the most urgent first, finished tiles are handed out in parts within a budget per frame, and what
//!   was drawn in a frame is never overwritten in it. The cache is a state machine without threads or a clock, which
//!   property tests drive.
//! - **Drawing.** Each block has a bind group of its own tiles or whole maps, made anew only when one of them changes. The
//!   same shader draws both: a placement (centre and scale of texture coordinates) is all that differs. Triangles that lie in
//!   several blocks, the projected grid's and the clipmap's, are drawn once for each block in sight that has tiles and once for
//!   the others; a pixel is kept by the draw of its own block. Of their lists only ranges near a block ([`globe::IndexRange`]) are
//!   drawn for it.
//! - **Live and kept pictures.** [`Earth::prepare`] never waits. [`Earth::prepare_complete`] waits up to a time-out and
//!   answers what is missing. [`Earth::expect`] says where the eye will be soon.
//!
//! # Ground with relief
//!
//! Where heights are given ([`elevation`]: grids over one another, filtered to any spacing, bounded), a [`globe::Surface`]
//! turns each view into patches of triangles ([`globe::Patch`]) about local origins: the displaced blocks, a projected grid, an
//! unfull quadtree, q-Bézier patches or a clipmap ([`SurfaceKind`]). Surfaces are pure code: no GPU, no files. One drawable
//! keeps their patches on the GPU, writes what changed, and draws them with the Earth's own shader, which then takes the
//! place of a pixel from the mesh, moved onto the pixel's ray. The projected grid's vertices are made on the GPU; contours can be
//! drawn without vertices, by casting the pixel's ray at small trees of them ([`globe::contours::ContourPages`]). Origins are
//! subtracted from the eye in f64; neighbours' edges agree to the last bit. `measure::surfaces` holds all of them against the
//! data: metres, pixels, holes, popping, time. Trees over one grid of heights are built on threads, the same to the last bit,
//! and kept as bytes with a checksum; `measure::terrain` measures them.
//!
//! # Quality against time
//!
//! [`Quality`] is what can be changed while the Earth is drawn ([`Earth::set_quality`]); its levels ([`Quality::levels`])
//! give up one thing after the other, the cheapest loss for the time it saves first. [`AdaptiveQuality`] goes down and up by what
//! frames cost: a state machine without a clock, with hysteresis. The window does so where a scene has
//! `[quality] target_ms`; pictures that are kept are always drawn in full.
//!
//! # Precision
//!
//! Positions are f64 up to one subtraction, eye from vertex, on the CPU; the GPU gets small f32 offsets. Nothing on the
//! GPU is a two-float sum. Horizon, limb and air are computed in *scaled space*, (x/a, y/a, z/b), where the ellipsoid is
//! the unit sphere and tangents stay tangents. Forms that cancel are avoided: L2 = h(L + R)/L for L − R²/L, Lagrange's
//! identity for b² − c. Depth is reversed Z unless the host's is not. `tests/render` (`precision`, `picture`) measures
//! it all; `tests/accuracy/extreme` holds each form beside the printed one against arithmetic of 320 bits
//! (`measure::numeric::stability_table`). What f32 sets an end to: a direction is known to 6e-8 rad, a tenth of a pixel
//! for views down to 0.1° over 1000 lines, six pixels at 0.001°.
//!
//! # Nothing unused is paid for
//!
//! A layer that is off is not read from disk, not uploaded, not bound and not in the shader's text: variants are made
//! from one source by [`gpu::ShaderVariant`]. `terrella bench` (`measure::bench`) proves it: each layer is switched off in
//! turn, and its time, textures and shader bytes are told. Steady state allocates nothing of its own (`tests/steady_state.rs`).
//!
//! # Features
//!
//! A host pays for what it draws. `default-features = false` is the Earth and its air from maps held whole, and no more;
//! `orbit`, `tracks`, `live`, `packs`, `pack-build`, `terrain` and `scene` add their rooms, `command` (default) is all of them, the
//! window, the video writer and the command line. Without `terrain` there is no value of [`GroundOptions`], without `packs` none of
//! [`TileOptions`], and the compiler drops all that would use one. The host chooses wgpu's backends, by the features `vulkan`,
//! `gles`, `metal` and `dx12` or by its own dependency on wgpu, which is also [`wgpu`] here.

pub mod air;
pub mod earth;
#[cfg(feature = "terrain")]
pub mod elevation;
pub mod frames;
pub mod globe;
pub mod gpu;
pub mod imagery;
#[cfg(feature = "command")]
pub mod measure;
#[cfg(feature = "orbit")]
pub mod orbit;
#[cfg(feature = "command")]
pub mod play;
#[cfg(feature = "scene")]
pub mod scene;
#[cfg(feature = "tracks")]
pub mod tracks;

pub use {glam, wgpu};

pub use air::Atmosphere;
pub use earth::{
    AdaptiveQuality, DepthBuffer, DiagnosticOptions, Diagnostics, Earth, EarthError, EarthOptions,
    EyeView, FrameStats, GroundOptions, Quality, QualityChange, QualityLevel, QualityReduction,
    Sky, SurfaceOutput, TILED_SUBDIVISION, TileOptions, Viewport,
};
pub use globe::{Figure, LevelRule, Shading, Subdivision, Visibility};
#[cfg(feature = "terrain")]
pub use globe::{SurfaceKind, SurfaceSettings};
