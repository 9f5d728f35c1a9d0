//! Tracks of a simulation, whose spacecraft and places are known only after its messages.

use super::style::style;
use crate::flight::Flight;
use crate::scene::Orbit;
use glam::DVec3;
use std::sync::Arc;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::tracks::TrackStyle;
use terrella_orbit::Feed;
use terrella_orbit::basilisk::{
    Place, RecordedCraft, RecordedPlace, Recording, Roster, Simulation,
};

/// Limit of spacecraft and of places with tracks and names: more could not be distinguished.
const MAX_TRACKS: usize = 200;
/// Height of a place's marker above the ground, metres, so that the ground does not cut it.
const MARKER_HEIGHT_M: f64 = 10.0;
/// The radius of the sphere that Basilisk puts places on the Earth on, metres.
const BASILISK_RADIUS_M: f64 = 6_378_136.6;

/// The motions of craft and places, in the order of their styles.
type Feeds = Vec<Arc<dyn Feed>>;

/// Elements of a simulation's spacecraft and places.
pub struct RosterTracks {
    source: RosterSource,
    orbit: Orbit,
    width_px: f32,
    ellipsoid: Ellipsoid,
}

/// Source of the roster.
enum RosterSource {
    /// A running simulation, and the serial number of its last roster.
    Simulation(Arc<Simulation>, u64),
    /// One that was saved, until its roster is handed out.
    Recording(Arc<Recording>, bool),
}

impl RosterSource {
    fn of(flight: &Flight) -> Option<Self> {
        match (flight.shared_simulation(), flight.recording()) {
            (Some(simulation), _) => Some(Self::Simulation(simulation, 0)),
            (None, Some(recording)) => Some(Self::Recording(Arc::clone(recording), true)),
            (None, None) => None,
        }
    }

    fn changed(&mut self) -> Option<Roster> {
        match self {
            Self::Simulation(simulation, known) => {
                let (roster, serial) = simulation.roster();
                let is_new = std::mem::replace(known, serial) != serial;
                is_new.then(|| Roster::clone(&roster))
            }
            Self::Recording(recording, is_new) => {
                std::mem::take(is_new).then(|| recording.roster().clone())
            }
        }
    }

    fn craft(&self, name: &str) -> Arc<dyn Feed> {
        match self {
            Self::Simulation(simulation, _) => Arc::new(simulation.craft_feed(Some(name))),
            Self::Recording(recording, _) => {
                Arc::new(RecordedCraft::new(Arc::clone(recording), Some(name)))
            }
        }
    }

    fn place(&self, name: &Arc<str>, at_m: DVec3) -> Arc<dyn Feed> {
        let name = Arc::clone(name);
        match self {
            Self::Simulation(simulation, _) => Arc::new(simulation.place_feed(name, at_m)),
            Self::Recording(recording, _) => {
                Arc::new(RecordedPlace::new(Arc::clone(recording), name, at_m))
            }
        }
    }
}

impl RosterTracks {
    /// For a flight that is a simulation with visible elements.
    pub fn of(flight: &Flight) -> Option<Self> {
        let source = RosterSource::of(flight)?;
        let orbit = flight.scene().orbits.first()?.clone();
        let is_wanted = !orbit.track.is_off();
        is_wanted.then(|| Self {
            source,
            orbit,
            width_px: flight.scene().track_px as f32,
            ellipsoid: *flight.ellipsoid(),
        })
    }

    /// Styles and feeds, where they are others than those that were handed out last.
    pub fn changed(&mut self) -> Option<(Vec<TrackStyle>, Feeds)> {
        let roster = self.source.changed()?;
        let (mut styles, mut feeds) = (Vec::new(), Feeds::new());
        for (index, name) in roster.craft.iter().take(MAX_TRACKS).enumerate() {
            styles.push(style(index, &self.orbit, self.width_px));
            feeds.push(self.source.craft(name));
        }
        let places = roster.places.iter().filter(|_| self.orbit.track.marker);
        for (index, place) in places.take(MAX_TRACKS).enumerate() {
            let usual = TrackStyle::new(roster.craft.len() + index);
            styles.push(TrackStyle {
                color: place.color.unwrap_or(usual.color),
                width_px: self.width_px,
                trail: None,
                ground_track: None,
                footprint: None,
                subpoint: false,
                marker: true,
            });
            let at_m = on_ground(place, &self.ellipsoid);
            feeds.push(self.source.place(&place.name, at_m));
        }
        if roster.craft.len().max(roster.places.len()) > MAX_TRACKS {
            tracing::warn!(
                "tracks and names are limited to the first {MAX_TRACKS} spacecraft and places"
            );
        }
        Some((styles, feeds))
    }
}

/// Position of a place on the Earth's figure: Basilisk measures heights from a sphere, so latitude and longitude come from its vertical and the
/// height from that sphere. Without a vertical, the position is used directly.
fn on_ground(place: &Place, ellipsoid: &Ellipsoid) -> DVec3 {
    if place.up == DVec3::ZERO {
        return place.position_itrf_m;
    }
    let height_m = place.position_itrf_m.length() - BASILISK_RADIUS_M;
    ellipsoid.itrf_from_geodetic(Geodetic {
        lat_rad: place.up.z.clamp(-1.0, 1.0).asin(),
        lon_rad: place.up.y.atan2(place.up.x),
        height_m: height_m + MARKER_HEIGHT_M,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_on_the_sphere_comes_to_its_latitude_on_the_ellipsoid() {
        let (lat_rad, lon_rad) = (40.015_f64.to_radians(), -105.27_f64.to_radians());
        let up = Ellipsoid::normal(lat_rad, lon_rad);
        let place = Place {
            name: "Boulder".into(),
            position_itrf_m: up * (BASILISK_RADIUS_M + 1650.0),
            up,
            color: None,
        };
        let at = Ellipsoid::WGS84.geodetic_from_itrf(on_ground(&place, &Ellipsoid::WGS84));
        assert!((at.lat_rad - lat_rad).abs() < 1e-9 && (at.lon_rad - lon_rad).abs() < 1e-9);
        assert!((at.height_m - 1660.0).abs() < 1e-3, "{at:?}");
        let bare = Place {
            up: DVec3::ZERO,
            ..place
        };
        assert_eq!(on_ground(&bare, &Ellipsoid::WGS84), bare.position_itrf_m);
    }
}
