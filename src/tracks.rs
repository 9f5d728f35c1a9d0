//! Tracks of satellites over the globe: orbit trails, ground tracks, sensor footprints, sub-satellite points and markers, for any [`Feed`], drawn
//! into a host's pass with the Earth.
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
//! **Samples.** A curve is sampled at steps of half a degree of arc, from the state's own speed over radius, so that Molniya's perigee is as smooth
//! as its apogee. It follows time: the feed is asked only for states that enter the span, samples that leave it are dropped, and the ends between
//! samples are cut. Where a feed has no state, the curve ends. For a live feed, states after now and of the last seconds are requested again in
//! each frame. [`Tracks::prepare`] requests at most [`SAMPLES_A_FRAME`] states, from now outwards, and continues in the next frame;
//! [`Tracks::prepare_complete`] requests all of them. In steady state neither allocates.
//!
//! **Trail.** The orbit's shape in inertial axes: positions at other times, with the present orientation of the Earth. An undisturbed orbit is a
//! closed ellipse, and the satellite is on it. Precession within the span is neglected, 4 m a day.
//!
//! **Ground track.** Sub-satellite points along the ellipsoid's normals, Earth-fixed. It is a curve in space: no date line, no poles.
//!
//! **Footprint.** The visible ground within the sensor's field of view, on the exact ellipsoid ([`footprint_outline`] for a cone about nadir, else
//! [`AimedField::outline`](terrella_orbit::AimedField::outline)). The shader of the fill tests where each pixel's ray meets the ground.
//!
//! **Swath.** Triangles between the edges of the ground that the field of view sweeps, sampled like curves. Ground that is swept twice is tinted
//! twice.
//!
//! **Lines.** One instance a segment, clipped against the plane in front of the eye and against three times the image, widened on screen, mitred
//! with its neighbours, and antialiased by distance. A dark outline separates them from bright ground.
//!
//! **Polygons.** One instance a triangle, small enough to follow the ellipsoid, with corners shared by neighbours: there are no gaps and no
//! overlaps. Edges are antialiased by distance.
//!
//! **Occlusion.** Whether the globe hides a point is decided by the ray to it ([`is_hidden`]), in scaled space, where the ellipsoid is the unit
//! sphere: exact at the limb, for any mesh. Other objects of the host hide by depth. Elements on the ground are tested at a depth nearer by a tenth
//! of their distance (marks by half), at least 500 m, so that the inscribed mesh does not hide them. Depth is not written.
//!
//! **Air.** Elements beyond the near boundary of the Earth's air are seen through it: each pixel is dimmed and tinted like the ground or sky that
//! its ray meets. A line behind the limb is affected, one in front is not.

mod buffers;
mod curve;
mod footprint;
mod ink;
mod limits;
mod lines;
mod moment;
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

use crate::earth::{Earth, EarthView};
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
pub use moment::TrackMoment;
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
use terrella_frames::{Ellipsoid, MoonShadow};
use terrella_ground::air::TOP;
use terrella_ground::light::{Grade, Tone};
use terrella_orbit::Feed;
pub use turn::EarthTurn;
use twilight::InkedTwilight;
pub use twilight::{TWILIGHT_DEG, TWILIGHT_POINTS, twilight_line};
pub use vector_map::{VectorMap, VectorMapError};

/// Largest number of states that [`Tracks::prepare`] requests from feeds to extend their curves.
pub const SAMPLES_A_FRAME: usize = 512;
/// Largest number of points of one curve.
pub const MAX_POINTS: usize = 16_384;
/// Largest number of points of all curves.
pub const MAX_POINTS_IN_ALL: usize = 262_144;

/// The Earth's pass, figure and atmosphere, for drawing tracks.
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
    /// Where exposed light is developed: if it is after the pass, tracks are drawn as light that is displayed in their colours.
    pub development: Development,
    /// Tone curve of the development.
    pub tone: Tone,
    /// White balance of the development.
    pub grade: Grade,
    air: Option<AirTextures>,
}

impl TracksOptions {
    /// The options for an Earth in its present state.
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

/// Statistics of a frame's tracks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TrackStats {
    /// Points of lines.
    pub points: u32,
    /// Dots and rings.
    pub marks: u32,
    /// States requested from feeds to extend curves.
    pub samples: u32,
    /// Number of pairs of a station and a satellite in its view.
    pub accesses: u32,
    /// Triangles.
    pub triangles: u32,
    /// Draw calls.
    pub draw_calls: u32,
    /// Bytes written to the GPU.
    pub uploaded_bytes: u64,
    /// Whether all curves cover their spans, or as much as their feeds have.
    pub is_complete: bool,
}

/// Why tracks could not be created.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TracksError {
    /// The shader file is invalid.
    #[error(transparent)]
    Shader(#[from] ShaderError),
    /// Lines that cannot be drawn.
    #[error("lines: {what}")]
    Lines {
        /// The requirement.
        what: &'static str,
    },
    /// An angle or span out of range.
    #[error("satellite {satellite}: {what}")]
    Style {
        /// Index of the satellite's style.
        satellite: usize,
        /// The requirement.
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
    /// Index of the satellite whose altitude sets the stations' circles.
    followed: usize,
    options: TracksOptions,
    kinds: TrackKinds,
    drawable: TracksDrawable,
    device: wgpu::Device,
    buffers: TrackBuffers,
    stats: TrackStats,
    /// False if the last view has no image.
    is_shown: bool,
}

impl Tracks {
    /// Makes the pipelines that the styles need. Styles are in the order of the feeds of [`Self::prepare`].
    ///
    /// # Errors
    /// Angles and spans that are negative or not finite.
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

    /// The same tracks for a further view of their Earth: it shares the pipelines and starts with the samples taken so far. Prepare it once a frame
    /// too.
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

    /// Adapts to another quality or appearance of an Earth: another sample count, other air or none. Afterwards, prepare again, and make the tracks
    /// of further views again from these.
    ///
    /// # Errors
    /// None beyond those of [`Self::new`].
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

    /// Hides or shows the satellites' tracks and markers from the next [`Self::prepare`] on. Hidden curves are not extended; stations still look
    /// for the satellites.
    pub fn hide_satellites(&mut self, hides: bool) {
        self.hides_satellites = hides;
    }

    /// Sets the Sun for the next frame: its direction, unit, ITRF axes, as in `Sky::sun_itrf`.
    pub fn set_sun(&mut self, direction_itrf: DVec3) {
        self.sun_itrf = direction_itrf.normalize_or(DVec3::X);
    }

    /// Sets the Moon's shadow for the next frame, as `Sky::moon_shadow` returns it.
    pub fn set_moon_shadow(&mut self, shadow: Option<MoonShadow>) {
        self.moon_shadow = shadow;
    }

    /// Makes the missing pipelines of these kinds.
    fn make_pipelines(&mut self, kinds: TrackKinds) -> Result<(), ShaderError> {
        if kinds != self.kinds {
            let (format, air) = (self.options.format(), self.options.air.as_ref());
            self.drawable = TracksDrawable::new(&self.device, format, kinds, air)?;
            self.kinds = kinds;
            self.is_shown = false;
        }
        Ok(())
    }

    /// Samples new states and uploads this frame's tracks. Call once a frame, before the pass. It never waits.
    ///
    /// Requests at most [`SAMPLES_A_FRAME`] states from feeds, in addition to the current state of each. Curves that lack more grow in later
    /// frames, from now outwards. If the view has no image, nothing is drawn.
    pub fn prepare<'f>(
        &mut self,
        queue: &wgpu::Queue,
        moment: &TrackMoment<'_>,
        feeds: impl IntoIterator<Item = &'f dyn Feed>,
    ) -> TrackStats {
        self.prepare_within(queue, moment, feeds, SAMPLES_A_FRAME)
    }

    /// As [`Self::prepare`], with complete curves: for images that are kept.
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
        let view = moment.view.in_itrf(moment.target).ok();
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
        let ground_points = still::write_lines(&self.lines, &eye, &mut self.buffers.points);
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
            ground_points,
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

    /// Draws the tracks: after the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if self.is_shown {
            self.drawable.render(pass);
        }
    }

    /// Pass, figure and atmosphere that they are drawn with.
    pub fn options(&self) -> &TracksOptions {
        &self.options
    }

    /// Positions of satellite names in the last prepared image.
    pub fn labels(&self) -> &[TrackLabel] {
        &self.buffers.labels
    }

    /// Positions of station names in the last prepared image.
    pub fn station_labels(&self) -> &[StationLabel] {
        &self.buffers.station_labels
    }

    /// Positions of the names of marked places in the last prepared image.
    pub fn place_labels(&self) -> &[PlaceLabel] {
        &self.buffers.place_labels
    }

    /// Names of the elements that are drawn: "trails" (with all other lines), "marks", "fills", "polygons".
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

    /// Bytes of the WGSL that the driver got, for the elements that are on.
    pub fn shader_bytes(&self) -> u64 {
        self.drawable.shader_bytes
    }
}

impl TracksOptions {
    /// Options for a separate pass over the Earth's image after its development with this curve, one sample a pixel: there tracks have their
    /// display colours. A measured response is treated as linear, which only affects the air in front of tracks.
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
