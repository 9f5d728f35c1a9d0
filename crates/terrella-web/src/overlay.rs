//! What is drawn over the globe: satellites, stations and lines.

use crate::pushed::{Playback, PushError};
use crate::satellites::{MOST, Satellite, ShownTracks, styles};
use std::time::Duration;
use terrella::frames::Ellipsoid;
use terrella::tracks::{
    LineStyle, Polylines, Station, TrackMoment, Tracks, TracksError, TracksOptions, VectorMap,
};
use terrella::{Earth, Epoch, Sky, wgpu};

/// Styles of lines on the ground, as scene files have them.
const GRATICULE: LineStyle = LineStyle::thin([255; 3], 0.3);
const GRATICULE_STEP_DEG: f64 = 10.0;
const COASTS: LineStyle = LineStyle::thin([255, 242, 196], 0.8);
const BORDERS: LineStyle = LineStyle::thin([255; 3], 0.6);
const TWILIGHT: LineStyle = LineStyle::thin([255, 176, 102], 0.8);

/// Lines on the ground that are drawn.
#[derive(Clone, Copy, Debug, Default)]
pub struct ShownLines {
    pub coasts: bool,
    pub borders: bool,
    pub graticule: bool,
    /// The terminator, and the ends of twilight.
    pub twilight: bool,
}

/// Satellites, stations and lines, and how they are drawn.
#[derive(Default)]
pub struct Overlay {
    pub satellites: Vec<Satellite>,
    pub stations: Vec<Station>,
    playback: Playback,
    /// What is drawn of satellites; `None` for the default of their number.
    shown_tracks: Option<ShownTracks>,
    shown: ShownLines,
    map: VectorMap,
    tracks: Option<Tracks>,
}

impl Overlay {
    /// Draws these satellites beside the others or in place of all of them.
    ///
    /// # Errors
    /// A device that cannot draw them. The others then stay.
    pub fn set_satellites(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        mut satellites: Vec<Satellite>,
        are_beside: bool,
    ) -> Result<(), TracksError> {
        let kept = if are_beside { self.satellites.len() } else { 0 };
        satellites.truncate(MOST.saturating_sub(kept));
        let count = kept + satellites.len();
        self.tracks = self.made(device, earth, count, &self.stations, self.shown)?;
        if !are_beside {
            self.satellites.clear();
            self.playback = Playback::default();
        }
        self.satellites.extend(satellites);
        Ok(())
    }

    /// Takes a packet that the page pushed; see [`Playback::push`]. Returns the satellite's index.
    ///
    /// # Errors
    /// A packet without a state.
    pub fn push(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        packet: &str,
        (arrival, rate): (Duration, f64),
    ) -> Result<usize, PushError> {
        let pushed = self
            .playback
            .push(&mut self.satellites, packet, arrival, rate);
        let (index, is_new) = pushed?;
        if is_new {
            let count = self.satellites.len();
            match self.made(device, earth, count, &self.stations, self.shown) {
                Ok(tracks) => self.tracks = tracks,
                Err(error) => {
                    self.satellites.pop();
                    return Err(error.into());
                }
            }
        }
        Ok(index)
    }

    /// The instant at which pushed states are shown; see [`Playback::epoch`].
    pub fn live_epoch(&self, now: Duration) -> Option<Epoch> {
        self.playback.epoch(&self.satellites, now)
    }

    /// Draws these stations in place of others.
    ///
    /// # Errors
    /// A station off the globe, or too many. The others then stay.
    pub fn set_stations(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        stations: Vec<Station>,
    ) -> Result<(), TracksError> {
        let count = self.satellites.len();
        self.tracks = self.made(device, earth, count, &stations, self.shown)?;
        self.stations = stations;
        Ok(())
    }

    /// Draws these parts of satellites; `None` for the default of their number.
    ///
    /// # Errors
    /// A device that cannot draw them. Nothing has then changed.
    pub fn set_shown_tracks(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        shown: Option<ShownTracks>,
    ) -> Result<(), TracksError> {
        let before = std::mem::replace(&mut self.shown_tracks, shown);
        let count = self.satellites.len();
        match self.made(device, earth, count, &self.stations, self.shown) {
            Ok(tracks) => {
                self.tracks = tracks;
                Ok(())
            }
            Err(error) => {
                self.shown_tracks = before;
                Err(error)
            }
        }
    }

    /// Takes coast lines and borders.
    pub fn set_vector_map(&mut self, map: VectorMap) {
        self.map = map;
    }

    /// Draws these lines on the ground.
    ///
    /// # Errors
    /// A device that cannot draw them. Nothing has then changed.
    pub fn set_lines(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        shown: ShownLines,
    ) -> Result<(), TracksError> {
        let count = self.satellites.len();
        self.tracks = self.made(device, earth, count, &self.stations, shown)?;
        self.shown = shown;
        Ok(())
    }

    /// Adapts to another quality or appearance of the Earth.
    ///
    /// # Errors
    /// A device that cannot draw so.
    pub fn follow(&mut self, earth: &Earth) -> Result<(), TracksError> {
        match &mut self.tracks {
            Some(tracks) => tracks.follow(earth),
            None => Ok(()),
        }
    }

    /// The drawable of so many satellites, stations and lines; `None` for nothing.
    fn made(
        &self,
        device: &wgpu::Device,
        earth: &Earth,
        satellites: usize,
        stations: &[Station],
        shown: ShownLines,
    ) -> Result<Option<Tracks>, TracksError> {
        let ground_lines = self.lines(shown)?;
        if satellites == 0 && stations.is_empty() && ground_lines.is_empty() && !shown.twilight {
            return Ok(None);
        }
        let styles = styles(satellites, self.shown_tracks);
        let mut tracks = Tracks::new(device, &TracksOptions::of(earth), &styles)?;
        tracks.set_lines(ground_lines)?;
        tracks.set_stations(stations, 0)?;
        tracks.set_twilight(shown.twilight.then_some(TWILIGHT))?;
        Ok(Some(tracks))
    }

    fn lines(&self, shown: ShownLines) -> Result<Vec<Polylines>, TracksError> {
        let ellipsoid = &Ellipsoid::WGS84;
        let mut all = Vec::new();
        if shown.graticule {
            all.push(Polylines::graticule(
                GRATICULE,
                ellipsoid,
                GRATICULE_STEP_DEG,
            )?);
        }
        for (is_shown, style, lines) in [
            (shown.borders, BORDERS, &self.map.borders),
            (shown.coasts, COASTS, &self.map.coast_lines),
        ] {
            if is_shown && !lines.is_empty() {
                let lines = lines.iter().map(|line| line.iter().copied());
                all.push(Polylines::on_ground(style, ellipsoid, lines)?);
            }
        }
        Ok(all)
    }

    /// Uploads a frame. Returns whether it is whole: curves of satellites grow over some frames.
    pub fn prepare(&mut self, queue: &wgpu::Queue, moment: &TrackMoment<'_>, sky: &Sky) -> bool {
        let Some(tracks) = &mut self.tracks else {
            return true;
        };
        tracks.set_sun(sky.sun_itrf);
        let feeds = self.satellites.iter().map(Satellite::feed);
        tracks.prepare(queue, moment, feeds).is_complete
    }

    /// Draws it, after the Earth.
    pub fn render(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(tracks) = &self.tracks {
            tracks.render(pass);
        }
    }

    /// Where names belong in the frame prepared last: of each 0 for a satellite or 1 for a station, its index, and x and y, pixels.
    pub fn labels(&self) -> impl Iterator<Item = [f64; 4]> + '_ {
        let label =
            |kind: f64, index: usize, [x, y]: [f32; 2]| [kind, index as f64, x.into(), y.into()];
        self.tracks.iter().flat_map(move |tracks| {
            let satellites = tracks.labels().iter();
            let satellites = satellites.map(move |one| label(0.0, one.satellite, one.at_px));
            let stations = tracks.station_labels().iter();
            let stations = stations.map(move |one| label(1.0, one.station, one.at_px));
            satellites.chain(stations)
        })
    }
}
