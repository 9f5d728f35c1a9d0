//! The tracks of a scene's satellites in images and the window: the player draws them as any host of [`terrella::tracks`] would, and writes their
//! names over the finished image.
//!
//! Lines of `[layers]` and ground stations are drawn with them. A scene without any of these has no layer: nothing is created.

mod labels;
mod roster;
mod still;
mod style;
mod swarm;

use super::egui_pass::EguiTarget;
use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::satellites::orientation_at;
use crate::scene::{Orbit, Scene};
use labels::{Labels, NamePlace};
use roster::RosterTracks;
use still::Still;
use style::style;
use swarm::Swarm;
use terrella::frames::EarthOrientation;
use terrella::tracks::{
    Station, TrackLabel, TrackMoment, TrackStats, TrackStyle, Tracks, TracksOptions,
};
use terrella::{Earth, FrameStats, GpuContext, Tone};

/// Limit of satellites above which those of a table for many satellites have markers without names.
const MAX_NAMED: usize = 100;
/// And these are smaller by as much.
const CROWD_WIDTH: f32 = 0.4;

/// The tracks of a picture or a window.
pub struct TracksLayer {
    tracks: Tracks,
    swarm: Swarm,
    /// Whether the name of each is written; empty if all are.
    is_named: Vec<bool>,
    /// The place of each in the scene; none where a simulation says what there is.
    scene_places: Vec<usize>,
    orientation: Option<EarthOrientation>,
    /// Made for the first name.
    labels: Option<Labels>,
    /// Format of the images that names are written on.
    format: wgpu::TextureFormat,
    is_complete: bool,
    /// Present if a simulation defines the objects.
    roster: Option<RosterTracks>,
    still: Still,
    stations: Vec<Station>,
    station_names: Vec<String>,
    /// The satellite whose height the stations' circles are of.
    followed: usize,
    /// Whether satellites have tracks.
    has_tracks: bool,
    shown: ShownTracks,
}

/// Which of the existing tracks are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct ShownTracks {
    /// Those of satellites.
    pub satellites: bool,
    pub stations: bool,
}

impl Default for ShownTracks {
    fn default() -> Self {
        Self {
            satellites: true,
            stations: true,
        }
    }
}

/// How much of a curve is computed within a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrackDetail {
    /// Within the frame's time; the rest in later frames.
    Live,
    /// All of it: for pictures that are kept.
    Complete,
}

impl TracksLayer {
    /// Whether a flight's scene requests any.
    pub fn is_wanted(flight: &Flight) -> bool {
        let scene = flight.scene();
        has_tracks(scene)
            || scene.layers.is_on()
            || !scene.stations.is_empty()
            || !scene.geojson.is_empty()
            || scene.coverage.is_some()
    }

    /// Bytes of the WGSL that the driver got.
    pub fn shader_bytes(&self) -> u64 {
        self.tracks.shader_bytes()
    }

    /// The layer of a scene's satellites, with names on images of the format `shown`; `None` if none of them shows anything.
    pub fn of(
        flight: &Flight,
        gpu: &GpuContext,
        earth: &Earth,
        shown: wgpu::TextureFormat,
    ) -> Result<Option<Self>, PlayError> {
        Self::of_scene(flight.scene(), flight, gpu, earth, shown)
    }

    /// The same of another scene with the same flight.
    pub fn of_scene(
        scene: &Scene,
        flight: &Flight,
        gpu: &GpuContext,
        earth: &Earth,
        shown: wgpu::TextureFormat,
    ) -> Result<Option<Self>, PlayError> {
        Self::with_options(scene, flight, gpu, &TracksOptions::of(earth), shown)
    }

    /// The layer for images of the format `shown`, drawn over an Earth's light after its development with this curve.
    pub fn over_light(
        flight: &Flight,
        gpu: &GpuContext,
        earth: &Earth,
        shown: wgpu::TextureFormat,
        tone: Tone,
    ) -> Result<Option<Self>, PlayError> {
        let options = TracksOptions::over_developed(earth, shown, tone);
        Self::with_options(flight.scene(), flight, gpu, &options, shown)
    }

    /// The layer of a scene with the same flight for the pass of these options.
    pub(crate) fn with_options(
        scene: &Scene,
        flight: &Flight,
        gpu: &GpuContext,
        options: &TracksOptions,
        shown: wgpu::TextureFormat,
    ) -> Result<Option<Self>, PlayError> {
        let width_px = scene.track_px as f32;
        let stations = stations(scene);
        let still = Still::of(scene, flight)?;
        if let Some(roster) = RosterTracks::of(flight) {
            let mut tracks = Tracks::new(&gpu.device, options, &[])?;
            still.show(&mut tracks)?;
            return Ok(Some(Self {
                tracks,
                swarm: Swarm::default(),
                is_named: Vec::new(),
                scene_places: Vec::new(),
                orientation: flight.earth_orientation().cloned(),
                labels: None,
                format: shown,
                is_complete: false,
                roster: Some(roster),
                still,
                stations,
                station_names: station_names(scene),
                followed: 0,
                has_tracks: true,
                shown: ShownTracks::default(),
            }));
        }
        let is_crowded = scene.orbits.len() > MAX_NAMED;
        let drawn = scene.orbits.iter().zip(flight.satellites()).enumerate();
        let mut is_named = Vec::new();
        let mut scene_places = Vec::new();
        let mut followed = 0;
        // Stations look for satellites of which nothing else is drawn, too.
        let is_drawn = |orbit: &Orbit| !orbit.track.is_off() || !stations.is_empty();
        let (styles, feeds): (Vec<_>, Vec<_>) = drawn
            .filter(|(_, (orbit, _))| is_drawn(orbit))
            .map(|(index, (orbit, satellite))| {
                let is_followed = index == flight.followed();
                if is_followed {
                    followed = is_named.len();
                }
                scene_places.push(index);
                is_named.push(!is_crowded || orbit.all.is_none() || is_followed);
                let is_point = is_crowded && orbit.all.is_some() && !is_followed;
                let width_px = width_px * if is_point { CROWD_WIDTH } else { 1.0 };
                let table = scene.orbit_table(index);
                (style(table, orbit, width_px), satellite.shared_feed())
            })
            .unzip();
        if styles.is_empty()
            && !scene.layers.is_on()
            && stations.is_empty()
            && flight.scene().geojson.is_empty()
            && flight.scene().coverage.is_none()
        {
            return Ok(None);
        }
        let mut tracks = Tracks::new(&gpu.device, options, &styles)?;
        still.show(&mut tracks)?;
        tracks.set_stations(&stations, followed)?;
        Ok(Some(Self {
            tracks,
            swarm: Swarm::of(feeds),
            is_named,
            scene_places,
            orientation: flight.earth_orientation().cloned(),
            labels: None,
            format: shown,
            is_complete: false,
            roster: None,
            still,
            stations,
            station_names: station_names(scene),
            followed,
            has_tracks: has_tracks(scene),
            shown: ShownTracks::default(),
        }))
    }

    /// Whether it has all satellite elements of a scene with the same flight; lines can be changed.
    pub fn has_tracks_of(&self, scene: &Scene) -> bool {
        self.has_tracks || !has_tracks(scene)
    }

    /// Draws the lines of a scene from the next image on, and shows or hides all other elements.
    ///
    /// # Errors
    /// As [`Self::of`]. The tracks are then unchanged.
    pub(crate) fn show(
        &mut self,
        scene: &Scene,
        flight: &Flight,
        shown: ShownTracks,
    ) -> Result<(), PlayError> {
        let still = Still::of(scene, flight)?;
        still.show(&mut self.tracks)?;
        self.still = still;
        self.show_parts(shown)
    }

    /// Draws satellites and stations from the next picture on, or hides them. All that is needed is there.
    ///
    /// # Errors
    /// As [`Self::of`].
    pub(crate) fn show_parts(&mut self, shown: ShownTracks) -> Result<(), PlayError> {
        self.shown = shown;
        self.tracks.hide_satellites(!shown.satellites);
        let stations = shown_stations(&self.stations, shown);
        Ok(self.tracks.set_stations(stations, self.followed)?)
    }

    /// Whether any of it is drawn.
    pub fn is_shown(&self) -> bool {
        (self.has_tracks && self.shown.satellites)
            || !shown_stations(&self.stations, self.shown).is_empty()
            || !self.still.is_empty()
    }

    /// Makes the tracks again where a simulation has other craft or places than before.
    fn follow_roster(&mut self, gpu: &GpuContext) {
        let Some((styles, feeds)) = self.roster.as_mut().and_then(RosterTracks::changed) else {
            return;
        };
        let made = Tracks::new(&gpu.device, self.tracks.options(), &styles);
        let made = made.and_then(|mut tracks| {
            self.still.show(&mut tracks)?;
            tracks.hide_satellites(!self.shown.satellites);
            tracks.set_stations(shown_stations(&self.stations, self.shown), 0)?;
            Ok(tracks)
        });
        match made {
            Ok(tracks) => {
                self.tracks = tracks;
                self.swarm = Swarm::of(feeds);
            }
            // The styles come from a scene and have been checked; the shaders compiled before.
            Err(error) => tracing::warn!("tracks stay as they were: {error}"),
        }
    }

    /// Follows the Earth to another quality.
    pub fn follow(&mut self, earth: &Earth) -> Result<(), PlayError> {
        Ok(self.tracks.follow(earth)?)
    }

    /// Writes an instant's tracks, and counts them.
    pub fn prepare(
        &mut self,
        gpu: &GpuContext,
        moment: &Moment,
        size: (u32, u32),
        detail: TrackDetail,
        stats: &mut FrameStats,
    ) -> TrackStats {
        self.follow_roster(gpu);
        let orientation = orientation_at(self.orientation.as_ref(), moment.epoch);
        let when = TrackMoment {
            epoch: moment.epoch,
            orientation: orientation.unwrap_or_default(),
            turn: moment.turn,
            view: &moment.view,
            target: size.into(),
        };
        self.tracks.set_sun(moment.sky.sun_itrf);
        self.tracks.set_moon_shadow(moment.sky.moon_shadow());
        self.swarm.look_at(moment.epoch);
        let feeds = self.swarm.feeds();
        let own = match detail {
            TrackDetail::Live => self.tracks.prepare(&gpu.queue, &when, feeds),
            TrackDetail::Complete => self.tracks.prepare_complete(&gpu.queue, &when, feeds),
        };
        self.is_complete = own.is_complete;
        stats.triangles += own.triangles;
        stats.draw_calls += own.draw_calls;
        stats.uploaded_bytes += own.uploaded_bytes;
        own
    }

    /// The places in the scene of the satellites whose dots are seen within so many pixels of one in the picture prepared last. They were
    /// projected when it was: nothing is propagated again.
    pub(crate) fn markers_near(
        &self,
        at_px: [f32; 2],
        within_px: f32,
    ) -> impl Iterator<Item = usize> {
        let labels = self.tracks.labels().iter().filter(move |label| {
            let [x, y] = [0, 1].map(|axis| label.at_px[axis] - at_px[axis]);
            x * x + y * y <= within_px * within_px
        });
        let places = labels.map(|label| self.scene_places.get(label.satellite));
        places.flatten().copied()
    }

    /// Whether all curves are as long as they will be.
    pub fn is_complete(&self) -> bool {
        self.is_complete
    }

    /// After the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.tracks.render(pass);
    }

    /// Writes the names over the finished picture on `view`, of `size` pixels with one sample each, where the tracks were drawn at
    /// `drawn_size` and enlarged.
    pub fn write_names(
        &mut self,
        gpu: &GpuContext,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        size: (u32, u32),
        drawn_size: (u32, u32),
    ) {
        let larger = |shown: u32, drawn: u32| shown as f32 / drawn.max(1) as f32;
        let [x, y] = [larger(size.0, drawn_size.0), larger(size.1, drawn_size.1)];
        let scaled = |at_px: [f32; 2]| [at_px[0] * x, at_px[1] * y];
        let named = |label: &TrackLabel, place: NamePlace| {
            let is_named = self.is_named.get(label.satellite).copied().unwrap_or(true);
            let name = self.swarm.name(label.satellite).filter(|_| is_named)?;
            let at_px = scaled(label.at_px);
            Some((TrackLabel { at_px, ..*label }, name, place))
        };
        // Names that come first have priority: the followed satellite, stations, the others in order.
        let all = || self.tracks.labels().iter();
        let is_followed = |label: &&TrackLabel| label.satellite == self.followed;
        let first = all().find(is_followed);
        let first = first.and_then(|label| named(label, NamePlace::Beside));
        let others = all().filter(|label| !is_followed(label));
        let others = others.filter_map(|label| named(label, NamePlace::BesideIfRoom));
        let stations = self.tracks.station_labels().iter().filter_map(|label| {
            let name = self.station_names.get(label.station)?;
            let label = TrackLabel {
                satellite: label.station,
                at_px: scaled(label.at_px),
                color: label.color,
            };
            Some((label, name.as_str(), NamePlace::BesideIfRoom))
        });
        let places = self.tracks.place_labels().iter().filter_map(|label| {
            let (name, place) = self.still.name(label, y)?;
            let label = TrackLabel {
                satellite: label.place,
                at_px: scaled(label.at_px),
                color: label.color,
            };
            Some((label, name, place))
        });
        let mut names = first
            .into_iter()
            .chain(stations)
            .chain(others)
            .chain(places)
            .peekable();
        if names.peek().is_none() {
            return;
        }
        let format = self.format;
        let labels = self
            .labels
            .get_or_insert_with(|| Labels::new(&gpu.device, format));
        let target = EguiTarget {
            device: &gpu.device,
            queue: &gpu.queue,
            encoder,
            view,
            size,
        };
        labels.write(target, self.still.most_cities, names);
    }
}

fn shown_stations(stations: &[Station], shown: ShownTracks) -> &[Station] {
    match shown.stations {
        true => stations,
        false => &[],
    }
}

fn has_tracks(scene: &Scene) -> bool {
    scene.orbits.iter().any(|orbit| !orbit.track.is_off())
}

/// A scene's ground stations, as they are drawn.
fn stations(scene: &Scene) -> Vec<Station> {
    let tables = scene.stations.iter().enumerate();
    tables
        .map(|(index, table)| Station {
            place: table.place,
            min_elevation_rad: table.min_elevation_deg.to_radians(),
            // The palette goes on after the satellites' tables.
            color: table.color.unwrap_or_else(|| {
                let satellites = scene.orbits.len();
                let last = satellites
                    .checked_sub(1)
                    .map(|last| scene.orbit_table(last));
                TrackStyle::new(last.map_or(0, |table| table + 1) + index).color
            }),
            width_px: scene.track_px as f32,
        })
        .collect()
}

fn station_names(scene: &Scene) -> Vec<String> {
    let tables = scene.stations.iter();
    tables.map(|table| table.name.clone()).collect()
}
