//! Tracks of satellites over the globe: orbit trails, ground tracks, sensor footprints, sub-satellite points and markers, for any
//! [`Feed`], drawn into a host's pass with the Earth.
//!
//! # Use
//!
//! ```text
//! let mut tracks = Tracks::new(&device, &TracksOptions::of(&earth), &styles)?;
//! // once a frame, after Earth::prepare with the same view
//! tracks.prepare(&queue, &moment, feeds);
//! // in the pass
//! earth.render(&mut pass);
//! tracks.render(&mut pass);
//! ```
//!
//! [`Tracks::set_lines`] adds [`Polylines`] that are fixed to the Earth: a graticule, coast lines, or the host's own.
//!
//! [`Tracks::set_polygons`] fills [`Polygons`] on the ground.
//!
//! [`Tracks::set_places`] marks places on the ground; [`read_place_names`] reads the names of cities.
//!
//! [`Tracks::set_stations`] adds ground stations: markers, visibility areas, and access lines.
//!
//! The host draws names at the positions that [`Tracks::labels`] returns. The command does so with egui.
//!
//! # How data flows
//!
//! ```text
//! feed ─► sampled curve ─► eye-relative points ─► lines of constant width ─► pixels
//!         f64, kept        f32, one subtraction   cut before the eye         each by its own ray
//! ```
//!
//! **Samples.** A curve is sampled half a degree of arc apart, by the state's own speed over radius, so that Molniya's
//! perigee is as smooth as its apogee. It follows time: only what enters the span is asked of the feed, only what leaves it
//! is dropped, and the ends between samples are cut. Where a feed has no state the curve ends. Of a live feed, what lies
//! after now, and the last seconds before, is asked again in each frame. [`Tracks::prepare`] asks for at most
//! [`SAMPLES_A_FRAME`] states, from now outwards, and goes on in the next frame; [`Tracks::prepare_complete`] asks for all.
//! In steady state neither allocates.
//!
//! **Trail.** The orbit's shape as the stars see it: places of other times in inertial axes, turned as the Earth stands now. An
//! undisturbed orbit is a closed ellipse, and the satellite is on it. Precession within the span is left out, 4 m a day.
//!
//! **Ground track.** The feet of the ellipsoid's normals, Earth-fixed. It is a curve in space: no date line, no poles.
//!
//! **Footprint.** The ground within the sensor's field of view and in sight, by the exact ellipsoid
//! ([`footprint_outline`] about nadir, else [`AimedField::outline`](terrella_orbit::AimedField::outline)). Its fill is decided for each pixel
//! by where the pixel's ray meets the ground.
//!
//! **Swath.** Triangles between the edges of what the field of view passes over, sampled as curves are. Parts that are passed over twice are
//! tinted twice.
//!
//! **Lines.** One instance a segment, cut against the plane before the eye and against three times the picture, widened on
//! screen, neighbours joined at their bisector, edges smoothed by distance. A dark edge sets them off from bright ground.
//!
//! **Polygons.** One instance a triangle, small enough to follow the ellipsoid, on corners that neighbours share: nothing shows through, and
//! nothing is covered twice. Edges are smoothed by distance.
//!
//! **Hiding.** Whether the globe hides a point is decided by the ray to it ([`is_hidden`]), in scaled space, where the
//! ellipsoid is the unit sphere: exact at the limb, whatever the mesh. What else the host has drawn hides by depth; what lies on the ground is tested a
//! tenth of its distance nearer (marks half), 500 m at least, so that the inscribed mesh does not hide it. Depth is not written.
//!
//! **Air.** What lies beyond the near boundary of the Earth's air is drawn through it, each pixel as the ground or the sky that its
//! ray meets. A line behind the limb is dimmed and tinted, one in front is not.

mod buffers;
mod curve;
mod footprint;
mod ink;
mod limits;
mod lines;
mod moon_shadow;
mod place_names;
mod places;
mod polygons;
mod projection;
mod satellite;
mod sensor;
mod stations;
mod still;
mod style;
mod turn;
mod twilight;
mod vector_map;

use crate::earth::{Earth, EarthView, EyeView, Viewport};
use crate::gpu::{AirTextures, DepthBuffer, Development, PassFormat, ShaderError};
use crate::gpu::{DrawnTracks, TrackKinds, TrackUniforms, TracksDrawable};
use crate::plan::AirSide;
use buffers::TrackBuffers;
pub use buffers::{NEAREST_MARKER_M, PlaceLabel, StationLabel, TrackLabel};
pub use footprint::{
    OUTLINE_POINTS, WIDEST_HALF_ANGLE_RAD, footprint_outline, is_beyond_air, is_hidden,
};
use glam::DVec3;
pub use lines::{LineStyle, MAX_LINE_POINTS, Polylines};
use moon_shadow::InkedShadow;
pub use moon_shadow::{SHADOW_POINTS, ShadowPart, shadow_outline};
pub use place_names::{NamedPlace, PlaceNamesError, read_place_names};
use places::InkedPlace;
pub use places::{GroundMark, MAX_PLACES};
use polygons::InkedPolygons;
pub use polygons::{FillCell, FillRow, FillStyle, MAX_TRIANGLES, Polygons};
use projection::EyeProjection;
use satellite::{Axes, Satellite};
use stations::InkedStation;
pub use stations::{CIRCLE_POINTS, MAX_STATIONS, Station};
use still::InkedLines;
pub use style::{Footprint, TrackSpan, TrackStyle};
use terrella_frames::{Ellipsoid, Epoch, MoonShadow, Orientation};
use terrella_ground::air::TOP;
use terrella_ground::light::{Grade, Tone};
use terrella_orbit::Feed;
pub use turn::EarthTurn;
use twilight::InkedTwilight;
pub use twilight::{TWILIGHT_DEG, TWILIGHT_POINTS, twilight_line};
pub use vector_map::{VectorMap, VectorMapError};

/// Most states that [`Tracks::prepare`] asks feeds for to grow their curves.
pub const SAMPLES_A_FRAME: usize = 512;
/// Most points of one curve.
pub const MAX_POINTS: usize = 16_384;
/// Most points of all curves.
pub const MAX_POINTS_IN_ALL: usize = 262_144;

/// The Earth's pass, figure and atmosphere, which tracks are drawn with.
#[derive(Clone, Debug, PartialEq)]
pub struct TracksOptions {
    /// The figure of the Earth.
    pub ellipsoid: Ellipsoid,
    /// Format of the colour target.
    pub color_format: wgpu::TextureFormat,
    /// Sample count of the pass.
    pub samples: u32,
    /// Depth buffer of the pass.
    pub depth: DepthBuffer,
    /// Where exposed light becomes what is shown: after the pass, tracks are light that is shown in their colours.
    pub development: Development,
    /// By which curve.
    pub tone: Tone,
    /// After which white balance.
    pub grade: Grade,
    air: Option<AirTextures>,
}

impl TracksOptions {
    /// Those of an Earth, as it is drawn now.
    pub fn of(earth: &Earth) -> Self {
        let format = earth.format();
        Self {
            ellipsoid: earth.ellipsoid(),
            color_format: format.color,
            samples: format.samples,
            depth: format.depth,
            development: format.development,
            tone: format.tone,
            grade: format.grade,
            air: earth.air_textures().cloned(),
        }
    }
}

/// The moment, the eye and the satellites that a frame shows.
#[derive(Clone, Copy, Debug)]
pub struct TrackMoment<'m> {
    /// The epoch that the frame shows.
    pub epoch: Epoch,
    /// The Earth's orientation now, as states are brought into Earth-fixed axes.
    pub orientation: Orientation,
    /// How the Earth stands and turns where that is another than the epoch's: in a simulation that says so itself.
    pub turn: Option<EarthTurn>,
    /// The view from the eye.
    pub view: &'m EyeView,
    /// The part of the target that the pass draws to.
    pub target: Viewport,
}

/// What a frame's tracks are.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackStats {
    /// Points of lines.
    pub points: u32,
    /// Dots and rings.
    pub marks: u32,
    /// States requested from feeds to extend curves.
    pub samples: u32,
    /// Pairs of a station and a satellite in its view.
    pub accesses: u32,
    /// Triangles.
    pub triangles: u32,
    /// Draw calls.
    pub draw_calls: u32,
    /// Bytes written to the GPU.
    pub uploaded_bytes: u64,
    /// Whether all curves are as long as their spans, or as what their feeds know.
    pub is_complete: bool,
}

/// Why tracks could not be made.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TracksError {
    /// The shader file is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// Lines that cannot be drawn.
    #[error("lines: {what}")]
    Lines {
        /// What they must be.
        what: &'static str,
    },
    /// An angle or span that has no meaning.
    #[error("satellite {satellite}: {what}")]
    Style {
        /// The satellite's place among the styles.
        satellite: usize,
        /// What it must be.
        what: &'static str,
    },
}

/// The tracks of some satellites.
pub struct Tracks {
    satellites: Vec<Satellite>,
    lines: Vec<InkedLines>,
    polygons: Vec<InkedPolygons>,
    stations: Vec<InkedStation>,
    places: Vec<InkedPlace>,
    twilight: Option<InkedTwilight>,
    shadow_lines: Option<InkedShadow>,
    hides_satellites: bool,
    /// Direction to the Sun, unit.
    sun_itrf: DVec3,
    moon_shadow: Option<MoonShadow>,
    /// The satellite whose height the stations' circles are of.
    followed: usize,
    options: TracksOptions,
    kinds: TrackKinds,
    drawable: TracksDrawable,
    device: wgpu::Device,
    buffers: TrackBuffers,
    stats: TrackStats,
    /// False if the last view gives no picture.
    is_shown: bool,
}

impl Tracks {
    /// Makes the pipelines that the styles need. Styles stand in the order in which [`Self::prepare`] gets feeds.
    ///
    /// # Errors
    /// Angles and spans that are not finite or negative.
    pub fn new(
        device: &wgpu::Device,
        options: &TracksOptions,
        styles: &[TrackStyle],
    ) -> Result<Self, TracksError> {
        for (satellite, style) in styles.iter().enumerate() {
            style
                .check()
                .map_err(|what| TracksError::Style { satellite, what })?;
        }
        let mut kinds = TrackKinds::default();
        for style in styles.iter().map(TrackStyle::kinds) {
            kinds.lines |= style.lines;
            kinds.marks |= style.marks;
            kinds.fills |= style.fills;
            kinds.polygons |= style.polygons;
        }
        let curves = styles
            .iter()
            .map(|style| {
                usize::from(style.trail.is_some())
                    + usize::from(style.ground_track.is_some())
                    + usize::from(style.swath().is_some())
            })
            .sum::<usize>();
        let max_points = (MAX_POINTS_IN_ALL / curves.max(1)).min(MAX_POINTS);
        let format = options.format();
        Ok(Self {
            satellites: styles
                .iter()
                .map(|style| Satellite::new(style, &format, max_points))
                .collect(),
            lines: Vec::new(),
            polygons: Vec::new(),
            stations: Vec::new(),
            places: Vec::new(),
            twilight: None,
            shadow_lines: None,
            hides_satellites: false,
            sun_itrf: DVec3::X,
            moon_shadow: None,
            followed: 0,
            options: options.clone(),
            kinds,
            drawable: TracksDrawable::new(device, format, kinds, options.air.as_ref())?,
            device: device.clone(),
            buffers: TrackBuffers::default(),
            stats: TrackStats::default(),
            is_shown: false,
        })
    }

    /// The same tracks for a further view of their Earth: with these pipelines and the samples taken so far. Like the first they are
    /// prepared once a frame.
    pub fn new_view(&self, view: &EarthView) -> Self {
        let options = TracksOptions {
            air: view.air_textures().cloned(),
            ..self.options.clone()
        };
        let air = options.air.as_ref();
        Self {
            satellites: self.satellites.clone(),
            lines: self.lines.clone(),
            polygons: self.polygons.clone(),
            stations: self.stations.clone(),
            places: self.places.clone(),
            twilight: self.twilight.clone(),
            shadow_lines: self.shadow_lines.clone(),
            hides_satellites: self.hides_satellites,
            sun_itrf: self.sun_itrf,
            moon_shadow: self.moon_shadow,
            followed: self.followed,
            drawable: self.drawable.for_another_view(&self.device, air),
            options,
            kinds: self.kinds,
            device: self.device.clone(),
            buffers: TrackBuffers::default(),
            stats: TrackStats::default(),
            is_shown: false,
        }
    }

    /// Follows an Earth to another quality or appearance: another sample count, another air or none. What was prepared must be prepared
    /// again, and those for further views be made again from it.
    ///
    /// # Errors
    /// None that [`Self::new`] did not have.
    pub fn follow(&mut self, earth: &Earth) -> Result<(), TracksError> {
        let options = TracksOptions::of(earth);
        if options != self.options {
            let (format, air) = (options.format(), options.air.as_ref());
            self.drawable = TracksDrawable::new(&self.device, format, self.kinds, air)?;
            self.options = options;
            for satellite in &mut self.satellites {
                satellite.ink = satellite.style.ink(&format);
            }
            for lines in &mut self.lines {
                *lines = InkedLines::new(lines.lines.clone(), &format);
            }
            for polygons in &mut self.polygons {
                *polygons = InkedPolygons::new(polygons.polygons.clone(), &format);
            }
            if let Some(twilight) = &mut self.twilight {
                *twilight = InkedTwilight::new(twilight.style, &format);
            }
            if let Some(lines) = &mut self.shadow_lines {
                *lines = InkedShadow::new(lines.style, &format);
            }
            for station in &mut self.stations {
                *station = InkedStation::new(station.station, &format);
            }
            for place in &mut self.places {
                *place = InkedPlace::new(place.mark, &self.options.ellipsoid, &format);
            }
            self.is_shown = false;
        }
        Ok(())
    }

    /// Hides the satellites' tracks and markers from the next [`Self::prepare`] on, or shows them again. Their curves grow no further meanwhile;
    /// stations go on looking for them.
    pub fn hide_satellites(&mut self, hides: bool) {
        self.hides_satellites = hides;
    }

    /// Says where the Sun is in the next frame: its direction, unit, ITRF axes, as in `Sky::sun_itrf`.
    pub fn set_sun(&mut self, direction_itrf: DVec3) {
        self.sun_itrf = direction_itrf.normalize_or(DVec3::X);
    }

    /// Says where the Moon's shadow is in the next frame, as `Sky::moon_shadow` has it.
    pub fn set_moon_shadow(&mut self, shadow: Option<MoonShadow>) {
        self.moon_shadow = shadow;
    }

    /// Makes the pipelines of further kinds.
    fn make_pipelines(&mut self, kinds: TrackKinds) -> Result<(), ShaderError> {
        if kinds != self.kinds {
            let (format, air) = (self.options.format(), self.options.air.as_ref());
            self.drawable = TracksDrawable::new(&self.device, format, kinds, air)?;
            self.kinds = kinds;
            self.is_shown = false;
        }
        Ok(())
    }

    /// Samples what is new and writes this frame's tracks to the GPU. Call once a frame, before the pass. Never waits.
    ///
    /// Asks feeds for [`SAMPLES_A_FRAME`] states at most beside one each for now; where curves lack more, they grow in the
    /// frames to come, from now outwards. Nothing is drawn of a view that gives no picture.
    pub fn prepare<'f>(
        &mut self,
        queue: &wgpu::Queue,
        moment: &TrackMoment<'_>,
        feeds: impl IntoIterator<Item = &'f dyn Feed>,
    ) -> TrackStats {
        self.prepare_within(queue, moment, feeds, SAMPLES_A_FRAME)
    }

    /// As [`Self::prepare`], all at once: for pictures that are kept.
    pub fn prepare_complete<'f>(
        &mut self,
        queue: &wgpu::Queue,
        moment: &TrackMoment<'_>,
        feeds: impl IntoIterator<Item = &'f dyn Feed>,
    ) -> TrackStats {
        self.prepare_within(queue, moment, feeds, usize::MAX)
    }

    fn prepare_within<'f>(
        &mut self,
        queue: &wgpu::Queue,
        moment: &TrackMoment<'_>,
        feeds: impl IntoIterator<Item = &'f dyn Feed>,
        budget: usize,
    ) -> TrackStats {
        let view = moment.view.in_itrf(moment.target);
        self.stats = TrackStats::default();
        self.is_shown = view.is_some();
        self.buffers.clear();
        let Some(view) = view else {
            return self.stats;
        };
        let ellipsoid = self.options.ellipsoid;
        let eye = EyeProjection::new(
            view.eye_itrf_m,
            view.clip_from_eye,
            moment.target.size,
            &ellipsoid,
        );
        for polygons in &self.polygons {
            polygons.write(&eye, &mut self.buffers.triangles);
        }
        for lines in &self.lines {
            let points = &mut self.buffers.points;
            lines.lines.write(lines.colors, &eye, points);
        }
        if let Some(twilight) = &self.twilight {
            twilight.write(self.sun_itrf, &eye, &mut self.buffers.points);
        }
        if let (Some(lines), Some(shadow)) = (&self.shadow_lines, &self.moon_shadow) {
            lines.write(shadow, &eye, &mut self.buffers.points);
        }
        let pixels_per_radian = eye.pixels_per_radian();
        for (index, place) in self.places.iter().enumerate() {
            place.write(index, pixels_per_radian, &eye, &mut self.buffers);
        }
        let mut axes = Axes::new(moment.epoch, moment.orientation, moment.turn);
        let mut left = budget;
        let mut is_complete = true;
        let has_stations = !self.stations.is_empty();
        let mut followed_itrf_m = None;
        for (index, (satellite, feed)) in self.satellites.iter_mut().zip(feeds).enumerate() {
            if self.hides_satellites {
                let _ = satellite.follow(feed, &mut axes, &ellipsoid, &mut 0, has_stations);
            } else {
                is_complete &=
                    satellite.follow(feed, &mut axes, &ellipsoid, &mut left, has_stations);
                satellite.write(index, &eye, &mut axes, &mut self.buffers);
            }
            if has_stations && let Some(place) = satellite.place_itrf_m(&mut axes) {
                self.buffers.satellites.push(place);
                if index == self.followed {
                    followed_itrf_m = Some(place);
                }
            }
        }
        let satellites = std::mem::take(&mut self.buffers.satellites);
        let mut accesses = 0;
        for (index, station) in self.stations.iter().enumerate() {
            let buffers = &mut self.buffers;
            accesses += station.write(index, &satellites, followed_itrf_m, &eye, buffers);
        }
        self.buffers.satellites = satellites;
        let frame = TrackUniforms {
            frame: view.uniforms(&ellipsoid),
            size_px: [
                moment.target.size.0.max(1) as f32,
                moment.target.size.1.max(1) as f32,
            ],
            air_top: TOP as f32,
            padding: 0.0,
        };
        let eye_scaled = view.eye_itrf_m * ellipsoid.scaled_from_itrf();
        let side = match eye_scaled.length() <= TOP {
            true => AirSide::Inside,
            false => AirSide::Outside,
        };
        let buffers = &mut self.buffers;
        self.drawable.set_side(side);
        let drawn = DrawnTracks {
            points: &mut buffers.points,
            marks: &buffers.marks,
            fills: &buffers.fills,
            triangles: &buffers.triangles,
        };
        let uploaded_bytes = self.drawable.write(&self.device, queue, &frame, drawn);
        let (draw_calls, triangles) = self.drawable.calls();
        self.stats = TrackStats {
            points: buffers.points.len() as u32,
            marks: buffers.marks.len() as u32,
            samples: (budget - left) as u32,
            accesses,
            triangles,
            draw_calls,
            uploaded_bytes,
            is_complete,
        };
        self.stats
    }

    /// Draws all of it: after the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.is_shown {
            self.drawable.render(pass);
        }
    }

    /// What they are drawn in.
    pub fn options(&self) -> &TracksOptions {
        &self.options
    }

    /// Where names belong in the picture prepared last.
    pub fn labels(&self) -> &[TrackLabel] {
        &self.buffers.labels
    }

    /// Where names of stations belong in the picture prepared last.
    pub fn station_labels(&self) -> &[StationLabel] {
        &self.buffers.station_labels
    }

    /// Where names of marked places belong in the picture prepared last.
    pub fn place_labels(&self) -> &[PlaceLabel] {
        &self.buffers.place_labels
    }

    /// Names of what is drawn: "trails" (with all other lines), "marks", "fills", "polygons".
    pub fn features_on(&self) -> Vec<&'static str> {
        let kinds = &self.kinds;
        [
            ("trails", kinds.lines),
            ("marks", kinds.marks),
            ("fills", kinds.fills),
            ("polygons", kinds.polygons),
        ]
        .into_iter()
        .filter(|(_, is_on)| *is_on)
        .map(|(name, _)| name)
        .collect()
    }

    /// Bytes of the WGSL that the driver got: of what is on alone.
    pub fn shader_bytes(&self) -> u64 {
        self.drawable.shader_bytes
    }
}

impl TracksOptions {
    /// Those for a pass of its own over the Earth's picture once it is developed by this curve, one sample a pixel: tracks have their display
    /// colours there. A measured response is taken for a linear curve, of the air before them alone.
    pub fn over_developed(earth: &Earth, color_format: wgpu::TextureFormat, tone: Tone) -> Self {
        Self {
            color_format,
            samples: 1,
            development: Development::InPass,
            tone: tone.response().map_or(tone, |_| Tone::Linear),
            grade: Grade::NONE,
            ..Self::of(earth)
        }
    }

    fn format(&self) -> PassFormat {
        PassFormat {
            color: self.color_format,
            further: &[],
            samples: self.samples,
            depth: self.depth,
            development: self.development,
            tone: self.tone,
            bloom: Default::default(),
            grade: self.grade,
        }
    }
}
