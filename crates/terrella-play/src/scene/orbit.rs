//! `[orbit]` after checking: a satellite and the source of its motion.

use super::choices::OrbitSource;
use super::craft::CraftOptions;
use super::many::Many;
use super::tracks::Track;
use glam::DVec3;
use std::path::PathBuf;
use terrella::frames::Epoch;
use terrella_orbit::Frame;
use terrella_orbit::basilisk::SimulationOptions;
use terrella_orbit::kepler::KeplerElements;
use terrella_orbit::live::LiveOptions;
use terrella_orbit::numerical::{AtmosphereModel, EventSelection, Solver, Spacecraft, Thrust};

/// `[orbit]`, or one of several `[[orbit]]`: a satellite and the source of its motion.
#[derive(Clone, Debug, PartialEq)]
pub struct Orbit {
    /// The kind of source.
    pub source: OrbitSource,
    /// The file of a source that is one, absolute or relative to the working directory; `None` is the built-in ISS set, or a
    /// simulation of Basilisk that runs.
    pub file: Option<PathBuf>,
    /// Which satellite of the file, where `None` is its only one; without a file, what it is called.
    pub name: Option<String>,
    /// Which of many satellites of the file are flown; once they are opened, each is an orbit of its own with its name.
    pub all: Option<Many>,
    /// Whether one bad record rejects the file; else bad records of other satellites and bad states of ephemerides are passed
    /// over and reported.
    pub strict: bool,
    /// The motion that the scene itself describes: for [`OrbitSource::Kepler`] and [`OrbitSource::Numerical`].
    pub motion: Option<Motion>,
    /// How states of a simulator are taken: for [`OrbitSource::Live`].
    pub live: Option<LiveOptions>,
    /// How a running simulation is met: for [`OrbitSource::Basilisk`] without a file.
    pub basilisk: Option<SimulationOptions>,
    /// What is drawn of its path: trail, ground track, footprint, marker.
    pub track: Track,
    /// What is drawn of the spacecraft itself.
    pub craft: CraftOptions,
}

impl Orbit {
    /// The default of a scene: the built-in space station.
    pub(super) fn built_in() -> Self {
        Self {
            source: OrbitSource::Tle,
            file: None,
            name: None,
            all: None,
            strict: false,
            motion: None,
            live: None,
            basilisk: None,
            track: Track::default(),
            craft: CraftOptions::default(),
        }
    }

    /// Takes the elements of this index in the table's pattern, if it has one.
    pub(super) fn take_place(&mut self, place: u32) {
        if let (Some(Many::Pattern(walker)), Some(motion)) = (&self.all, &mut self.motion)
            && let OrbitParameters::Elements(elements) = &mut motion.start_mut().parameters
        {
            *elements = walker.elements(elements, place);
        }
    }

    /// Whether a running simulator supplies its state.
    pub fn is_simulated(&self) -> bool {
        self.live.is_some() || self.basilisk.is_some()
    }

    /// Whether it uses the built-in elements of the space station.
    pub fn is_built_in(&self) -> bool {
        self.source == OrbitSource::Tle && self.file.is_none()
    }
}

/// A motion described in the scene.
#[derive(Clone, Debug, PartialEq)]
pub enum Motion {
    /// Along a conic.
    Kepler {
        /// From where.
        start: InitialState,
        /// Whether node and periapsis drift by the Earth's flattening.
        j2: bool,
    },
    /// Integrated under forces.
    Numerical {
        /// From where.
        start: InitialState,
        /// Forces that are integrated.
        forces: ForceOptions,
    },
}

impl Motion {
    /// Initial state.
    pub fn start(&self) -> &InitialState {
        match self {
            Self::Kepler { start, .. } | Self::Numerical { start, .. } => start,
        }
    }

    /// Initial state, mutable.
    pub(super) fn start_mut(&mut self) -> &mut InitialState {
        match self {
            Self::Kepler { start, .. } | Self::Numerical { start, .. } => start,
        }
    }
}

/// Initial state of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InitialState {
    /// Epoch of the state.
    pub epoch: Epoch,
    /// In which axes.
    pub frame: Frame,
    /// How it is given.
    pub parameters: OrbitParameters,
}

/// Parameters of an initial state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum OrbitParameters {
    /// As classical elements.
    Elements(KeplerElements),
    /// As a state.
    State {
        /// Metres from the Earth's centre.
        position_m: DVec3,
        /// Metres per second, as seen in the frame.
        velocity_m_s: DVec3,
    },
}

/// Forces of a numerical motion, and its integration options.
#[derive(Clone, Debug, PartialEq)]
pub struct ForceOptions {
    /// Degree of the Earth's gravity; 0 and 1 are a point.
    pub gravity_degree: u32,
    /// Its order, not above the degree; 0 leaves the zonal terms J2, J3, … alone.
    pub gravity_order: u32,
    /// The air whose drag acts; `None` for none.
    pub drag: Option<AtmosphereModel>,
    /// The Sun's gravity.
    pub sun: bool,
    /// The Moon's.
    pub moon: bool,
    /// The pressure of sunlight.
    pub radiation: bool,
    /// What air and sunlight act on.
    pub craft: Spacecraft,
    /// Thrusts, each over its own time.
    pub burns: Vec<Thrust>,
    /// Error allowed in a step, relative to distance and speed.
    pub tolerance: f64,
    /// How it is integrated.
    pub method: Solver,
    /// What is looked for along it; the impact always is.
    pub events: EventSelection,
}
