//! Overlays of one camera: the sky beyond the Earth, and tracks over it.

#[cfg(any(feature = "celestial", feature = "tracks"))]
use crate::EarthFault;
#[cfg(feature = "tracks")]
use crate::{EarthLines, EarthStation, EarthTrack};
#[cfg(feature = "tracks")]
use std::sync::Arc;
#[cfg(feature = "celestial")]
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions};
use terrella::frames::Epoch;
#[cfg(any(feature = "celestial", feature = "tracks"))]
use terrella::frames::Orientation;
#[cfg(feature = "tracks")]
use terrella::orbit::Feed;
#[cfg(feature = "tracks")]
use terrella::tracks::{TrackMoment, Tracks, TracksOptions};
use terrella::{Earth, EarthView, EyeView, FrameStats, Viewport, wgpu};

/// Satellites, stations and lines of the main world.
#[derive(Clone, Default)]
pub(super) struct SeenTracks {
    /// Change counter.
    pub revision: u64,
    #[cfg(feature = "tracks")]
    pub satellites: Arc<Vec<EarthTrack>>,
    #[cfg(feature = "tracks")]
    pub stations: Arc<Vec<EarthStation>>,
    #[cfg(feature = "tracks")]
    pub lines: Arc<Vec<EarthLines>>,
}

#[cfg(feature = "tracks")]
impl SeenTracks {
    fn is_empty(&self) -> bool {
        self.satellites.is_empty() && self.stations.is_empty() && self.lines.is_empty()
    }
}

/// The instant and the eye of an image.
#[derive(Clone, Copy)]
#[allow(dead_code, reason = "read by features")]
pub(super) struct Moment<'m> {
    pub epoch: Epoch,
    pub eye: &'m EyeView,
    pub target: Viewport,
}

/// The view of the Earth for which overlays are prepared.
#[derive(Clone, Copy)]
#[allow(dead_code, reason = "read by features")]
pub(super) enum Seat<'e> {
    Own(&'e Earth),
    Other(&'e EarthView),
}

/// Sky and tracks of one view.
#[derive(Default)]
pub(super) struct Overlays {
    #[cfg(feature = "celestial")]
    celestial: Option<Celestial>,
    #[cfg(feature = "tracks")]
    tracks: Option<Tracks>,
}

impl Overlays {
    /// The sky for the Earth's own view.
    #[cfg(feature = "celestial")]
    pub fn with_sky(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        earth: &Earth,
        options: Option<&CelestialOptions>,
    ) -> Result<Self, EarthFault> {
        let celestial = options.map(|options| Celestial::new(device, queue, earth, options));
        Ok(Self {
            celestial: celestial.transpose()?,
            ..Self::default()
        })
    }

    /// The same for another view.
    pub fn new_view(&self, device: &wgpu::Device, view: &EarthView) -> Self {
        // Unused if the features are off.
        let _ = (device, view);
        Self {
            #[cfg(feature = "celestial")]
            celestial: self
                .celestial
                .as_ref()
                .map(|celestial| celestial.new_view(device, view)),
            #[cfg(feature = "tracks")]
            tracks: self.tracks.as_ref().map(|tracks| tracks.new_view(view)),
        }
    }

    /// Rebuilds the tracks of the Earth's own view.
    #[cfg(feature = "tracks")]
    pub fn make_tracks(
        &mut self,
        device: &wgpu::Device,
        earth: &Earth,
        seen: &SeenTracks,
    ) -> Result<(), EarthFault> {
        self.tracks = None;
        if seen.is_empty() {
            return Ok(());
        }
        let styles: Vec<_> = seen.satellites.iter().map(|track| track.style).collect();
        let mut tracks = Tracks::new(device, &TracksOptions::of(earth), &styles)?;
        let stations: Vec<_> = seen.stations.iter().map(|station| station.0).collect();
        tracks.set_stations(&stations, 0)?;
        let lines = seen.lines.iter().map(|lines| (*lines.0).clone());
        tracks.set_lines(lines.collect())?;
        self.tracks = Some(tracks);
        Ok(())
    }

    /// Shares the tracks of the Earth's own view with another view.
    #[cfg(feature = "tracks")]
    pub fn share_tracks(&mut self, own: &Self, view: &EarthView) {
        self.tracks = own.tracks.as_ref().map(|tracks| tracks.new_view(view));
    }

    /// Prepares both for an image, after the Earth, and adds them to its statistics.
    pub fn prepare(
        &mut self,
        queue: &wgpu::Queue,
        seat: Seat<'_>,
        moment: Moment<'_>,
        seen: &SeenTracks,
        stats: &mut FrameStats,
    ) {
        let _ = (queue, seat, moment, seen, &stats);
        #[cfg(feature = "celestial")]
        if let Some(celestial) = &mut self.celestial {
            let moment = CelestialMoment {
                epoch: moment.epoch,
                orientation: Orientation::default(),
                view: moment.eye,
                target: moment.target,
                velocity_m_s: None,
            };
            let own = match seat {
                Seat::Own(earth) => celestial.prepare(queue, earth, &moment),
                Seat::Other(view) => celestial.prepare_view(queue, view, &moment),
            };
            stats.triangles += own.triangles;
            stats.draw_calls += own.draw_calls;
            stats.uploaded_bytes += own.uploaded_bytes;
        }
        #[cfg(feature = "tracks")]
        if let Some(tracks) = &mut self.tracks {
            let moment = TrackMoment {
                epoch: moment.epoch,
                orientation: Orientation::default(),
                turn: None,
                view: moment.eye,
                target: moment.target,
            };
            let feeds = seen
                .satellites
                .iter()
                .map(|track| &*track.feed as &dyn Feed);
            let own = tracks.prepare(queue, &moment, feeds);
            stats.triangles += own.triangles;
            stats.draw_calls += own.draw_calls;
            stats.uploaded_bytes += own.uploaded_bytes;
        }
    }

    /// Draws the sky: behind the Earth, and behind clouds above the eye.
    pub fn render_sky(&self, pass: &mut wgpu::RenderPass<'_>) {
        let _ = &pass;
        #[cfg(feature = "celestial")]
        if let Some(celestial) = &self.celestial {
            celestial.render(pass);
        }
    }

    /// Draws the tracks on top of everything.
    pub fn render_tracks(&self, pass: &mut wgpu::RenderPass<'_>) {
        let _ = &pass;
        #[cfg(feature = "tracks")]
        if let Some(tracks) = &self.tracks {
            tracks.render(pass);
        }
    }
}
