//! The satellites of a scene, each source opened.

mod files;

pub(super) use files::open_many;

use super::error::PlayError;
use crate::scene::YEARS;
use crate::scene::{
    ForceOptions, InitialState, Motion, Orbit, OrbitParameters, OrbitSource, Scene,
};
use std::sync::Arc;
use terrella::frames::{Duration, EarthOrientation, Epoch, Orientation, utc_from_rfc3339};
use terrella_orbit::basilisk::{
    Meeting, RecordedCraft, Recording, Simulation, SimulationError, SimulationOptions,
};
use terrella_orbit::constants::EARTH_GM_M3_S2;
use terrella_orbit::kepler::{
    Anomaly, Drift, KeplerElements, KeplerFeed, KeplerOptions, OrbitSize,
};
use terrella_orbit::live::{LiveError, LiveFeed, LiveOptions};
use terrella_orbit::numerical::{
    Event, ForceModel, Gravity, NumericalFeed, NumericalOptions, Shadow,
};
use terrella_orbit::{Feed, Frame, MeanElements, OrbitError, OrbitFiles, OrbitState, Sgp4Feed};

/// A satellite of a scene.
pub struct Satellite {
    feed: Arc<dyn Feed>,
    elements: Option<MeanElements>,
    state_epoch: Option<Epoch>,
    live: Option<Arc<LiveFeed>>,
    simulation: Option<Arc<Simulation>>,
    recording: Option<Arc<Recording>>,
    events: Option<Vec<Event>>,
    faults: Vec<FileRemark>,
    faults_left_out: usize,
}

/// Whether live satellites listen for their simulators.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Listener {
    Open,
    Closed,
}

/// Inputs for opening satellites.
pub(super) struct Sources<'t> {
    /// The Earth's orientation.
    pub table: Option<&'t EarthOrientation>,
    pub listener: Listener,
    /// Files that have been read: many satellites may come from one.
    pub files: OrbitFiles,
}

/// Time span over which states of files are integrated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Integrated {
    /// None: they are valid at their epoch only, which is the requested time.
    AtEpoch,
    /// Over the time of the scene.
    OverScene,
}

impl Satellite {
    fn of(feed: impl Feed + 'static) -> Self {
        Self {
            feed: Arc::new(feed),
            elements: None,
            state_epoch: None,
            live: None,
            simulation: None,
            recording: None,
            events: None,
            faults: Vec::new(),
            faults_left_out: 0,
        }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        self.feed.name()
    }

    /// Its motion.
    pub fn feed(&self) -> &dyn Feed {
        self.feed.as_ref()
    }

    /// The same, to be kept beside the flight.
    pub fn shared_feed(&self) -> Arc<dyn Feed> {
        Arc::clone(&self.feed)
    }

    /// The mean elements that it flies by, if it is flown by SGP4.
    pub fn elements(&self) -> Option<&MeanElements> {
        self.elements.as_ref()
    }

    /// The epoch of the state that it is propagated from, if its file has one state.
    pub fn state_epoch(&self) -> Option<Epoch> {
        self.state_epoch
    }

    /// The live feed, if its states come from a simulator.
    pub fn live(&self) -> Option<&LiveFeed> {
        self.live.as_deref()
    }

    /// The simulation that it flies in, if that runs meanwhile.
    pub fn simulation(&self) -> Option<&Arc<Simulation>> {
        self.simulation.as_ref()
    }

    /// The simulation that it flies in, if that was saved.
    pub fn recording(&self) -> Option<&Arc<Recording>> {
        self.recording.as_ref()
    }

    /// Events along its motion, in order of time, if it is integrated.
    pub fn events(&self) -> Option<&[Event]> {
        self.events.as_deref()
    }

    /// The errors of other records of its file, and how many more there are that are not kept.
    pub fn faults(&self) -> (&[FileRemark], usize) {
        (&self.faults, self.faults_left_out)
    }
}

/// A reader's remark about a file that is used anyway.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileRemark {
    /// "skipped" where something in the file is not used, else "noticed".
    pub label: &'static str,
    /// Position, problem and remedy.
    pub text: String,
}

impl FileRemark {
    fn of(error: &OrbitError) -> Self {
        Self {
            label: match error.is_notice() {
                true => "noticed",
                false => "skipped",
            },
            text: error.to_string(),
        }
    }
}

/// How long before and after the scene a motion is integrated, so that instants at its edges have neighbours.
const MARGIN_S: f64 = 60.0;

/// The orientation at a time; the default without a table or outside it.
pub(super) fn orientation_at(
    table: Option<&EarthOrientation>,
    epoch: Epoch,
) -> Option<Orientation> {
    match table {
        None => Some(Orientation::default()),
        Some(table) => table.at(epoch),
    }
}

/// Adds a stand-in for every satellite whose built-in elements are not valid at the scene's start.
pub(super) fn stand_in(scene: &mut Scene) -> Result<(), PlayError> {
    if scene.is_live() || !scene.orbits.iter().any(Orbit::is_built_in) {
        return Ok(());
    }
    let feed = Sgp4Feed::built_in_iss()?;
    let (first, last) = feed.validity();
    if (first..=last).contains(&scene.time.start) {
        return Ok(());
    }
    let mean = feed.elements();
    let mean_motion_rad_s = mean.mean_motion_rev_day * std::f64::consts::TAU / 86_400.0;
    let elements = KeplerElements {
        // n² a³ = μ.
        size: OrbitSize::SemiMajorAxis((EARTH_GM_M3_S2 / mean_motion_rad_s.powi(2)).cbrt()),
        eccentricity: mean.eccentricity,
        inclination_rad: mean.inclination_deg.to_radians(),
        raan_rad: mean.raan_deg.to_radians(),
        argument_of_periapsis_rad: mean.arg_perigee_deg.to_radians(),
        anomaly: Anomaly::Mean(mean.mean_anomaly_deg.to_radians()),
    };
    for index in 0..scene.orbits.len() {
        if scene.orbits.get(index).is_some_and(Orbit::is_built_in) {
            scene.stand_in(index, elements, (first, last));
        }
    }
    Ok(())
}

/// Opens the satellite of that place in the scene.
pub(super) fn open(
    scene: &Scene,
    index: usize,
    orbit: &Orbit,
    integrated: Integrated,
    sources: &mut Sources<'_>,
) -> Result<Satellite, PlayError> {
    let (table, listener) = (sources.table, sources.listener);
    let name = orbit.name.as_deref();
    if let Some(options) = &orbit.live {
        let listen = options.transport.to_string();
        // The numbers are the scene's: so are the file and the line.
        let opened = live(options, listener)
            .map_err(|error| scene.reject_orbit(index, "listen", &listen, error.to_string()));
        return Ok(opened?);
    }
    if let Some(options) = &orbit.basilisk {
        let endpoint = options.meeting.endpoint().to_string();
        let key = match options.meeting {
            Meeting::Listen(_) => "listen",
            Meeting::Subscribe(_) => "subscribe",
        };
        let opened = simulation(options, scene.time.start, listener)
            .map_err(|error| scene.reject_orbit(index, key, &endpoint, error.to_string()));
        return Ok(opened?);
    }
    if let (OrbitSource::Basilisk, Some(file)) = (orbit.source, &orbit.file) {
        let recording = Recording::open(file, scene.time.start, name);
        let path = file.display().to_string();
        let recording = recording
            .map_err(|error| scene.reject_orbit(index, "file", &path, error.to_string()))?;
        for note in recording.notes() {
            tracing::warn!("{note}");
        }
        let recording = Arc::new(recording);
        return Ok(Satellite {
            recording: Some(Arc::clone(&recording)),
            ..Satellite::of(RecordedCraft::new(recording, name))
        });
    }
    match (&orbit.motion, &orbit.file) {
        (Some(motion), _) => {
            let start = motion.start();
            let default_name = match motion {
                Motion::Kepler { .. } => "Kepler",
                Motion::Numerical { .. } => "Numerical",
            };
            let orientation = orientation_at(table, start.epoch).ok_or_else(|| {
                let remedy = "the table of [time] orientation does not reach to this epoch; take one that does, or start later";
                scene.reject_orbit(index, "epoch", &terrella::frames::rfc3339(start.epoch), remedy.to_owned())
            })?;
            let name = name.unwrap_or(default_name);
            let opened = match motion {
                Motion::Kepler { start, j2 } => kepler(name, start, *j2, &orientation),
                Motion::Numerical { start, forces } => {
                    numerical(name, scene, start, forces, &orientation)
                }
            };
            // The numbers are the scene's: so are the file and the line.
            opened.map_err(|error| {
                let source = default_name.to_lowercase();
                scene
                    .reject_orbit(index, "source", &source, error.to_string())
                    .into()
            })
        }
        (None, Some(file)) => files::open(scene, index, orbit, file, integrated, sources),
        (None, None) => {
            let feed = Sgp4Feed::built_in_iss()?;
            Ok(Satellite {
                elements: Some(feed.elements().clone()),
                ..Satellite::of(feed)
            })
        }
    }
}

fn live(options: &LiveOptions, listener: Listener) -> Result<Satellite, LiveError> {
    let feed = match listener {
        Listener::Open => LiveFeed::open(options.clone())?,
        Listener::Closed => LiveFeed::unconnected(options.clone())?,
    };
    if listener == Listener::Open {
        tracing::info!("{} is waited for on {}", options.name, feed.listens_on());
    }
    let feed = Arc::new(feed);
    Ok(Satellite {
        live: Some(Arc::clone(&feed)),
        ..Satellite::of(feed)
    })
}

fn simulation(
    options: &SimulationOptions,
    start: Epoch,
    listener: Listener,
) -> Result<Satellite, SimulationError> {
    let simulation = Arc::new(match listener {
        Listener::Open => Simulation::open(options.clone(), start)?,
        Listener::Closed => Simulation::unconnected(options.clone(), start)?,
    });
    if listener == Listener::Open {
        tracing::info!("a simulation is waited for on {}", simulation.endpoint());
    }
    let feed = simulation.craft_feed(options.craft.as_deref());
    Ok(Satellite {
        simulation: Some(simulation),
        ..Satellite::of(feed)
    })
}

fn kepler(
    name: &str,
    start: &InitialState,
    j2: bool,
    orientation: &Orientation,
) -> Result<Satellite, OrbitError> {
    let year =
        |year: i32, day: &str| utc_from_rfc3339(&format!("{year}-{day}")).unwrap_or(start.epoch);
    let options = KeplerOptions {
        drift: if j2 { Drift::J2 } else { Drift::None },
        first: year(*YEARS.start(), "01-01T00:00:00Z"),
        last: year(*YEARS.end(), "12-31T23:59:59Z"),
    };
    Ok(Satellite::of(match start.parameters {
        OrbitParameters::Elements(elements) => {
            KeplerFeed::from_elements(name, start.frame, start.epoch, &elements, options)?
        }
        OrbitParameters::State { .. } => {
            let mut state = state(start)?;
            if state.frame.is_earth_fixed() {
                state = state.in_frame(Frame::Gcrf, orientation);
            }
            KeplerFeed::from_state(name, &state, options)?
        }
    }))
}

/// The time over which a motion is integrated for a scene, without that from its start to the scene.
fn integrated_span(scene: &Scene) -> (Epoch, Epoch) {
    let margin = Duration::from_seconds(MARGIN_S);
    let (a, b) = (scene.time.start, scene.time.end());
    (a.min(b) - margin, a.max(b) + margin)
}

fn state(start: &InitialState) -> Result<OrbitState, OrbitError> {
    let (position_m, velocity_m_s) = match start.parameters {
        OrbitParameters::State {
            position_m,
            velocity_m_s,
        } => (position_m, velocity_m_s),
        OrbitParameters::Elements(elements) => elements
            .conic(EARTH_GM_M3_S2, start.epoch)?
            .state_after(0.0),
    };
    Ok(OrbitState {
        epoch: start.epoch,
        frame: start.frame,
        position_m,
        velocity_m_s,
    })
}

fn numerical(
    name: &str,
    scene: &Scene,
    start: &InitialState,
    forces: &ForceOptions,
    orientation: &Orientation,
) -> Result<Satellite, OrbitError> {
    let degree = forces.gravity_degree as usize;
    let model = ForceModel {
        gravity: match degree {
            0 | 1 => Gravity::Point,
            degree => Gravity::Field {
                degree,
                order: forces.gravity_order as usize,
            },
        },
        drag: forces.drag,
        sun: forces.sun,
        moon: forces.moon,
        sunlight: forces.radiation.then_some(Shadow::Cone),
        thrusts: forces.burns.clone(),
        orientation: *orientation,
    };
    let (first, last) = integrated_span(scene);
    let options = NumericalOptions {
        relative_tolerance: forces.tolerance,
        solver: forces.method,
        watch: forces.events,
        ..NumericalOptions::between(first.min(start.epoch), last.max(start.epoch))
    };
    let state = state(start)?;
    let feed = NumericalFeed::new(name, &state, &model, &forces.craft, &options)?;
    Ok(Satellite {
        events: Some(feed.events().to_vec()),
        ..Satellite::of(feed)
    })
}
