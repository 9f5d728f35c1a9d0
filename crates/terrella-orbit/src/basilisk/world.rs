//! State of a simulation: messages are applied one after the other, and each yields a snapshot to draw.
//!
//! A message has positions in inertial axes relative to an origin that the simulation chooses. Here they are all translated to the Earth's centre
//! by one subtraction in f64. Epoch and ground locations are only sent when they change, and kept.

use super::attitude::rotation_of_mrp;
use super::message::{Body, Camera, Craft, EpochDate, Location, MAX_LOCATIONS, Message, is_black};
use super::undrawn::Undrawn;
use glam::{DMat3, DQuat, DVec3};
use std::collections::BTreeSet;
use std::sync::Arc;
use terrella_frames::{
    Calendar, Duration, Epoch, moon_position_gcrf_m, rfc3339, sun_position_gcrf_m, tai_from_utc_day,
};

/// Most simulated time, seconds: some 95 years.
const MAX_ELAPSED_S: f64 = 3e9;
/// Years that an epoch may have.
const YEARS: std::ops::RangeInclusive<i64> = 1900..=2099;
/// Farther than this from the Earth nothing is drawn, metres.
const MAX_DISTANCE_M: f64 = 1e14;
/// How far a matrix may be from a rotation.
const ROTATION_TOLERANCE: f64 = 1e-6;
/// Nearer to the Earth's centre than this is no place of a craft or a body, metres.
const LEAST_DISTANCE_M: f64 = 1.0;
/// Limit of the number of notes for the user.
const MAX_NOTES: usize = 64;

/// One instant of a simulation, about the Earth's centre, inertial axes (J2000, taken as GCRF).
#[derive(Clone, Debug, PartialEq)]
pub struct Snapshot {
    /// The simulation's count of its message.
    pub frame_number: i64,
    /// When.
    pub epoch: Epoch,
    /// Simulated time, seconds.
    pub elapsed_s: f64,
    /// Rotation to Earth-fixed axes, from the simulation.
    pub itrf_from_gcrf: DMat3,
    /// Whether the Earth rotates: false if that rotation is the identity.
    pub turns: bool,
    /// Position of the Sun, metres; from the ephemeris for the epoch if the simulation has none.
    pub sun_m: DVec3,
    /// The Moon, metres; likewise.
    pub moon_m: DVec3,
    /// The spacecraft.
    pub craft: Vec<CraftState>,
    /// The cameras.
    pub cameras: Arc<[Camera]>,
    /// Places on the Earth.
    pub places: Arc<[Place]>,
    /// Whether the script's settings request a sky without stars (`skyBox = "black"`).
    pub is_sky_black: bool,
}

/// A spacecraft of a snapshot.
#[derive(Clone, Debug, PartialEq)]
pub struct CraftState {
    /// Its name.
    pub name: Arc<str>,
    /// Metres from the Earth's centre.
    pub position_m: DVec3,
    /// Metres a second, seen from the Earth's centre.
    pub velocity_m_s: DVec3,
    /// Its attitude.
    pub inertial_from_body: DQuat,
}

/// A ground location on the Earth.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Its label.
    pub name: Arc<str>,
    /// Metres from the Earth's centre, ITRF, as sent: Basilisk puts sites on a sphere.
    pub position_itrf_m: DVec3,
    /// Upwards there, ITRF; zero where that is not said.
    pub up: DVec3,
    /// Red, green, blue.
    pub color: Option<[u8; 3]>,
}

/// Names of the spacecraft and places of a simulation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Roster {
    /// Spacecraft, in the order of the messages.
    pub craft: Vec<Arc<str>>,
    /// Places on the ground.
    pub places: Arc<[Place]>,
}

impl Snapshot {
    /// A spacecraft by name; `None` for the first one.
    pub fn craft(&self, name: Option<&str>) -> Option<&CraftState> {
        match name {
            None => self.craft.first(),
            Some(name) => self.craft.iter().find(|craft| &*craft.name == name),
        }
    }

    /// Interpolates between this snapshot and a later one, at a fraction 0…1: Hermite's cubic for positions, the shortest arc for attitudes.
    /// Content that is not in both is taken from this one.
    pub fn toward(&self, later: &Self, part: f64) -> Self {
        let span_s = later.elapsed_s - self.elapsed_s;
        let craft = self.craft.iter().map(|craft| {
            let Some(next) = later.craft(Some(&craft.name)) else {
                return craft.clone();
            };
            let (position_m, velocity_m_s) = between(craft, next, span_s, part);
            let attitude = craft.inertial_from_body;
            CraftState {
                name: Arc::clone(&craft.name),
                position_m,
                velocity_m_s,
                inertial_from_body: attitude.slerp(next.inertial_from_body, part),
            }
        });
        let turn = DQuat::from_mat3(&self.itrf_from_gcrf);
        let turned = turn.slerp(DQuat::from_mat3(&later.itrf_from_gcrf), part);
        Self {
            frame_number: self.frame_number,
            epoch: self.epoch + seconds(span_s * part),
            elapsed_s: self.elapsed_s + span_s * part,
            itrf_from_gcrf: match self.itrf_from_gcrf == later.itrf_from_gcrf {
                true => self.itrf_from_gcrf,
                false => DMat3::from_quat(turned),
            },
            turns: self.turns,
            sun_m: self.sun_m.lerp(later.sun_m, part),
            moon_m: self.moon_m.lerp(later.moon_m, part),
            craft: craft.collect(),
            cameras: Arc::clone(&self.cameras),
            places: Arc::clone(&self.places),
            is_sky_black: self.is_sky_black,
        }
    }
}

/// Position and velocity between two states: Hermite's cubic.
pub fn between(a: &CraftState, b: &CraftState, span_s: f64, part: f64) -> (DVec3, DVec3) {
    let (s, s2, s3) = (part, part * part, part.powi(3));
    let (v0, v1) = (a.velocity_m_s * span_s, b.velocity_m_s * span_s);
    let chord = b.position_m - a.position_m;
    let position_m =
        a.position_m + chord * (3.0 * s2 - 2.0 * s3) + v0 * (s3 - 2.0 * s2 + s) + v1 * (s3 - s2);
    let slope =
        chord * (6.0 * s - 6.0 * s2) + v0 * (3.0 * s2 - 4.0 * s + 1.0) + v1 * (3.0 * s2 - 2.0 * s);
    let velocity_m_s = match span_s > 0.0 {
        true => slope / span_s,
        false => a.velocity_m_s,
    };
    (position_m, velocity_m_s)
}

/// Seconds as a duration, to the nanosecond.
pub fn seconds(seconds: f64) -> Duration {
    Duration::from_total_nanoseconds((seconds * 1e9).round() as i128)
}

/// Why a message gives nothing to draw.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum UpdateFault {
    /// Its time is not a number, negative, or beyond a century.
    #[error("its simulated time is not from 0 s to 3e9 s")]
    Time,
    /// Its date is outside the years that can be drawn.
    #[error("its date is outside the years 1900 to 2099")]
    Date,
    /// There are celestial bodies, but no Earth.
    #[error("there is no Earth among its celestial bodies; the Earth is what is drawn here")]
    NoEarth,
}

/// State that is kept from message to message.
#[derive(Clone, Debug)]
pub struct World {
    start: Epoch,
    has_epoch: bool,
    locations: Vec<Location>,
    places: Arc<[Place]>,
    cameras: Arc<[Camera]>,
    undrawn: Undrawn,
    is_sky_black: bool,
    /// The bodies that are not drawn and have been reported.
    bodies_noted: BTreeSet<String>,
    notes: Vec<String>,
}

impl World {
    /// The state before the first message. `start` is the epoch of simulated time 0 if no message contains it.
    pub fn new(start: Epoch) -> Self {
        Self {
            start,
            has_epoch: false,
            locations: Vec::new(),
            places: Arc::new([]),
            cameras: Arc::new([]),
            undrawn: Undrawn::default(),
            is_sky_black: false,
            bodies_noted: BTreeSet::new(),
            notes: Vec::new(),
        }
    }

    /// When simulated time is 0.
    pub fn start(&self) -> Epoch {
        self.start
    }

    /// The places on the Earth.
    pub fn places(&self) -> Arc<[Place]> {
        Arc::clone(&self.places)
    }

    /// Notes for the user, each sentence once, in order of occurrence.
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    fn note(&mut self, note: String) {
        if self.notes.len() < MAX_NOTES && !self.notes.contains(&note) {
            self.notes.push(note);
        }
    }

    /// Takes when simulated time is 0.
    pub fn take_epoch(&mut self, date: &EpochDate) {
        match epoch_of(date) {
            Some(start) => {
                self.start = start;
                self.has_epoch = true;
            }
            None => self.note(format!(
                "the simulation's epoch is no date of the years 1900 to 2099 and is left out: {date:?}"
            )),
        }
    }

    /// Takes places on the ground, new ones and those in place of others of their name.
    pub fn take_locations(&mut self, locations: Vec<Location>) {
        if locations.is_empty() {
            return;
        }
        for location in locations {
            let has_room = self.locations.len() < MAX_LOCATIONS;
            let mut known = self.locations.iter_mut();
            match known.find(|one| one.name == location.name) {
                Some(known) => *known = location,
                None if has_room => self.locations.push(location),
                None => self.note(format!(
                    "of the ground locations the first {MAX_LOCATIONS} are drawn"
                )),
            }
        }
        let elsewhere = self.locations.iter().any(|one| !is_earth(&one.body));
        if elsewhere {
            self.note("ground locations on other bodies than the Earth are not drawn".to_owned());
        }
        let shown = self.locations.iter().filter(|one| {
            let position = one.position_fixed_m;
            is_earth(&one.body) && !one.is_hidden && is_sound(position) && one.up.is_finite()
        });
        self.places = shown
            .map(|one| Place {
                name: match one.label.trim().is_empty() {
                    true => one.name.as_str().into(),
                    false => one.label.as_str().into(),
                },
                position_itrf_m: one.position_fixed_m,
                up: one.up.normalize_or_zero(),
                color: one.color,
            })
            .collect();
    }

    /// Applies a message: updates the kept state and returns its snapshot.
    ///
    /// # Errors
    /// The reason why it cannot be drawn.
    pub fn take(&mut self, message: Message) -> Result<Snapshot, UpdateFault> {
        if let Some(date) = &message.epoch {
            self.take_epoch(date);
        }
        self.take_locations(message.locations);
        if let Some(skybox) = &message.skybox {
            self.is_sky_black = is_black(skybox);
        }
        self.tell_undrawn(message.undrawn);
        let elapsed_s = message.elapsed_ns * 1e-9;
        if !(0.0..=MAX_ELAPSED_S).contains(&elapsed_s) {
            return Err(UpdateFault::Time);
        }
        let epoch = self.start + seconds(elapsed_s);
        if !YEARS.contains(&i64::from(epoch.to_gregorian_utc().0)) {
            return Err(UpdateFault::Date);
        }
        if !self.has_epoch {
            self.note(format!(
                "no epoch has come: simulated time is counted from {}, the start of [time]",
                rfc3339(self.start)
            ));
        }
        let earth = self.earth(&message.bodies)?;
        self.tell_bodies(&message.bodies);
        let other = |name: &str| {
            let body = message.bodies.iter().find(|body| is_named(body, name))?;
            let from_earth_m = body.position_m - earth.position_m;
            is_sound(from_earth_m).then_some(from_earth_m)
        };
        let (sun_m, moon_m) = (other("sun"), other("moon"));
        if sun_m.is_none() {
            self.note(
                "the simulation has no Sun: light comes from where the Sun is at the epoch"
                    .to_owned(),
            );
        }
        if *self.cameras != *message.cameras {
            self.cameras = message.cameras.into();
        }
        Ok(Snapshot {
            is_sky_black: self.is_sky_black,
            frame_number: message.frame_number,
            epoch,
            elapsed_s,
            itrf_from_gcrf: earth.itrf_from_gcrf,
            turns: earth.itrf_from_gcrf != DMat3::IDENTITY,
            sun_m: sun_m.unwrap_or_else(|| sun_position_gcrf_m(epoch)),
            moon_m: moon_m.unwrap_or_else(|| moon_position_gcrf_m(epoch)),
            craft: self.craft(message.craft, &earth),
            cameras: Arc::clone(&self.cameras),
            places: Arc::clone(&self.places),
        })
    }

    fn earth(&mut self, bodies: &[Body]) -> Result<EarthState, UpdateFault> {
        let Some(body) = bodies.iter().find(|body| is_named(body, "earth")) else {
            if !bodies.is_empty() {
                return Err(UpdateFault::NoEarth);
            }
            self.note(
                "the simulation has no celestial body: the Earth stands at its origin and does not turn"
                    .to_owned(),
            );
            return Ok(EarthState::default());
        };
        let mut earth = EarthState {
            position_m: finite(body.position_m),
            velocity_m_s: finite(body.velocity_m_s),
            ..EarthState::default()
        };
        match body.fixed_from_inertial {
            Some(rotation) if is_rotation(&rotation) => earth.itrf_from_gcrf = rotation,
            Some(_) => self.note(
                "the Earth's rotation, as the simulation says it, is no rotation and is left out: the Earth does not turn"
                    .to_owned(),
            ),
            None => {}
        }
        if earth.itrf_from_gcrf == DMat3::IDENTITY {
            self.note(
                "the simulation does not turn the Earth (its rotation is the identity): longitudes are counted from the inertial x axis"
                    .to_owned(),
            );
        }
        Ok(earth)
    }

    fn craft(&mut self, craft: Vec<Craft>, earth: &EarthState) -> Vec<CraftState> {
        let mut kept = Vec::with_capacity(craft.len());
        for one in craft {
            let position_m = one.position_m - earth.position_m;
            let velocity_m_s = one.velocity_m_s - earth.velocity_m_s;
            let attitude = rotation_of_mrp(one.mrp_bn);
            match attitude.filter(|_| is_sound(position_m) && velocity_m_s.is_finite()) {
                Some(inertial_from_body) => kept.push(CraftState {
                    name: one.name.into(),
                    position_m,
                    velocity_m_s,
                    inertial_from_body,
                }),
                None => self.note(format!(
                    "spacecraft {:?} is left out where its state is not finite or lies in the Earth's centre",
                    one.name
                )),
            }
        }
        kept
    }

    fn tell_undrawn(&mut self, undrawn: Undrawn) {
        let new: Vec<_> = undrawn.names_beyond(self.undrawn).collect();
        if !new.is_empty() {
            self.undrawn.join(undrawn);
            self.note(format!("not drawn: {}", new.join(", ")));
        }
    }

    fn tell_bodies(&mut self, bodies: &[Body]) {
        let drawn = |body: &Body| {
            ["earth", "sun", "moon"]
                .iter()
                .any(|one| is_named(body, one))
        };
        for body in bodies.iter().filter(|body| !drawn(body)) {
            if self.bodies_noted.len() < MAX_NOTES && !self.bodies_noted.contains(&body.name) {
                self.bodies_noted.insert(body.name.clone());
                self.note(format!("not drawn: {:?}", body.name));
            }
        }
    }
}

/// State of the Earth in a message.
struct EarthState {
    position_m: DVec3,
    velocity_m_s: DVec3,
    itrf_from_gcrf: DMat3,
}

impl Default for EarthState {
    fn default() -> Self {
        Self {
            position_m: DVec3::ZERO,
            velocity_m_s: DVec3::ZERO,
            itrf_from_gcrf: DMat3::IDENTITY,
        }
    }
}

/// Scripts name bodies directly or by SPICE's planet names.
fn is_named(body: &Body, name: &str) -> bool {
    body.name.strip_suffix("_planet_data").unwrap_or(&body.name) == name
}

fn is_earth(name: &str) -> bool {
    name.strip_suffix("_planet_data").unwrap_or(name) == "earth"
}

/// Finite, not at the Earth's centre, not beyond all that is drawn.
fn is_sound(from_earth_m: DVec3) -> bool {
    (LEAST_DISTANCE_M..=MAX_DISTANCE_M).contains(&from_earth_m.length())
}

fn finite(vector: DVec3) -> DVec3 {
    match vector.is_finite() {
        true => vector,
        false => DVec3::ZERO,
    }
}

fn is_rotation(matrix: &DMat3) -> bool {
    let difference = *matrix * matrix.transpose() - DMat3::IDENTITY;
    let worst = difference
        .to_cols_array()
        .into_iter()
        .fold(0.0, |worst: f64, part| worst.max(part.abs()));
    // A part that is not finite is not less either.
    worst < ROTATION_TOLERANCE && (matrix.determinant() - 1.0).abs() < ROTATION_TOLERANCE
}

fn epoch_of(date: &EpochDate) -> Option<Epoch> {
    let calendar = Calendar {
        year: date.year,
        month: date.month,
        day: date.day,
    };
    let is_date = YEARS.contains(&date.year)
        && (1..=12).contains(&date.month)
        && (1..=calendar.days_in_month()).contains(&date.day)
        && (0..=23).contains(&date.hour)
        && (0..=59).contains(&date.minute)
        && (0.0..61.0).contains(&date.second);
    is_date.then(|| {
        let minutes_s = (date.hour * 60 + date.minute) * 60;
        let ns = minutes_s * 1_000_000_000 + (date.second * 1e9).round() as i64;
        tai_from_utc_day(calendar.mjd(), ns)
    })
}

#[cfg(test)]
#[path = "world_tests.rs"]
mod tests;
