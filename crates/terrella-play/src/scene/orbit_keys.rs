//! Declares the keys of `[orbit]` and `[tracks]`, as [`keys`](super::keys) does those of the other tables.

use super::articulations::{AXIS, RATE_DEG_S};
use super::choices::{AirModel, FrameName, Method};
use super::choices::{OrbitSource, OrbitSource::*};
use super::craft::{AttitudeName, ModelAxes};
use super::field::{Bounds, Choice, Field, RawPath};
use super::keys::{TURN_DEG, only};
use super::record::{Notes, Record};
#[cfg(test)]
use super::table::About;
use super::table::{Key, Only, Table, Value, given_or, method, table};
use super::text::SceneText;
use serde::Deserialize;
#[cfg(test)]
use serde_json::json;
use std::ops::{Range, RangeInclusive};
use terrella_orbit::live::{Extrapolation, LiveOptions, Pacing, Transport};
use terrella_orbit::numerical::Spacecraft;
use toml::Spanned;

/// `before_min` and `after_min` of a trail or ground track, minutes: at most a week.
pub(super) const SPAN_MIN: RangeInclusive<f64> = 0.0..=10_080.0;
/// Sizes of orbits, positions and their parts, kilometres: a thousand times the distance of the Sun.
const ORBIT_KM: RangeInclusive<f64> = -1e11..=1e11;
const FILE: &Only = &only(
    &[Tle, Omm, Oem, Opm, Czml, Csv, Sp3, Stk, Basilisk],
    "is for sources that are read from files: \"tle\", \"omm\", \"oem\", \"opm\", \"czml\", \"csv\", \"sp3\", \"stk\" and \"basilisk\"",
);
const STRICT: &Only = &only(
    &[Tle, Omm, Oem, Opm, Czml, Csv, Sp3, Stk],
    "is for files of which parts can be skipped: \"tle\", \"omm\", \"oem\", \"opm\", \"czml\", \"csv\", \"sp3\" and \"stk\"",
);
const MANY: &Only = &only(
    &[Tle, Omm, Oem, Czml, Csv, Sp3, Stk],
    "is for files of many satellites: \"tle\", \"omm\", \"oem\", \"czml\", \"csv\", \"sp3\" and \"stk\"",
);
const MOTION: &Only = &only(
    &[Kepler, Numerical],
    "is for source = \"kepler\" and \"numerical\", whose start the scene gives",
);
const KEPLER: &Only = &only(
    &[Kepler],
    "is for source = \"kepler\"; \"numerical\" takes gravity_degree",
);
const FORCES: &Only = &only(
    &[Numerical],
    "is for source = \"numerical\", where forces are integrated",
);
const SENT: &Only = &only(
    &[OrbitSource::Live, Basilisk],
    "is for source = \"live\" and \"basilisk\", what a simulator sends",
);
const LIVE: &Only = &only(
    &[OrbitSource::Live],
    "is for source = \"live\", states that a simulator sends",
);
const PUBLISHED: &Only = &only(
    &[Basilisk],
    "is for source = \"basilisk\", simulations that publish their steps",
);

/// A table that includes the track keys among its own: `[tracks]` has them for all satellites, `[orbit]` for
/// one.
macro_rules! table_with_tracks {
    ($name:ident = $table:literal { $($before:tt)* } { $($after:tt)* }) => {
        table!($name = $table {
            $($before)*
            /// The trail: the orbit, drawn over a time; `true` is the last revolution. By default false.
            trail: toml::Value, of "true, false or { before_min = 90, after_min = 45 }";
            /// The ground track: where the satellite passes overhead, drawn over a time; `true` is half a revolution to each side of now.
            /// By default false.
            ground_track: toml::Value, of "true, false or { before_min = 90, after_min = 45 }";
            /// A dot where the satellite is, with its name.
            marker: bool, default false;
            /// A ring where the satellite is overhead.
            subpoint: bool, default false;
            /// The outline of the ground that the satellite sees. By default drawn where sensor_half_angle_deg is given.
            footprint: bool;
            /// Half angle of the sensor's conical field of view. By default the sensor sees all the ground to the horizon.
            sensor_half_angle_deg: f64, of "degrees", in 0.001..=90.0;
            // A list of any length, so that a wrong length gets our own message.
            /// Half angles of the sensor's rectangular field of view, along the flight and across it. By default the field is a cone.
            sensor_half_angles_deg: Vec<f64>, of "[along, across], two numbers of degrees", in 0.001..=90.0;
            /// Angle of the sensor's boresight off nadir.
            sensor_off_nadir_deg: f64, of "degrees", in 0.0..=90.0, default 0.0;
            /// Direction of the boresight off nadir, clockwise from the direction of flight: 90 is to the right.
            sensor_azimuth_deg: f64, of "degrees", in TURN_DEG, default 90.0;
            /// Whether lines from the satellite show the sensor's field of view in space.
            sensor_lines: bool, default false;
            /// The swath: the ground that the sensor passes over in a time, tinted; `true` is half a revolution to each side of now. By default
            /// false.
            swath: toml::Value, of "true, false or { before_min = 90, after_min = 45 }";
            /// Whether the footprint is tinted.
            footprint_fill: bool, default false;
            $($after)*
        });
    };
}

table_with_tracks!(RawOrbit = "orbit" {
    /// The kind of source.
    source: Choice<OrbitSource>, of "the kind of source", default Tle;
    /// The file of elements or states. By default "tle" flies the built-in space station, and "basilisk" connects to a running
    /// simulation.
    file: RawPath, of "a file of elements or states", for FILE;
    /// Which satellite of the file; without a file, what the satellite is called.
    name: String, of "a string, the satellite's name";
    // True or a string, checked by many.rs.
    /// Whether this table flies many satellites of the file: all of them, those whose names match a pattern of `*` and `?`, or those in a
    /// range of catalogue numbers. By default false.
    all: toml::Value, of "true, false, a pattern of names like \"STARLINK*\" or a range of catalogue numbers like \"44713..44772\"", for MANY;
    /// Whether one bad record rejects the file.
    strict: bool, default false, for STRICT;
    // Any value: both a string and TOML's own date-time are read.
    /// Epoch of the initial state. By default the start of the scene.
    epoch: toml::Value, of "a UTC instant like \"2018-01-15T12:00:00Z\"", for MOTION;
    /// Reference frame of the initial state.
    frame: Choice<FrameName>, default FrameName::Gcrf, for MOTION;
    /// Constellation of circular orbits by its pattern i:T/P/F: inclination in degrees, number of satellites, number of planes and phasing.
    /// By default one satellite is flown.
    walker: String, of "a string like \"53:72/6/1\"", for KEPLER;
    /// Altitude of the satellites of a pattern above the equator.
    altitude_km: f64, of "kilometres", in 1.0..=1e6, for KEPLER;
    /// Arc over which the planes of a pattern are spread: 360 for delta patterns, 180 for stars.
    raan_span_deg: f64, of "degrees", in 0.0..=360.0, default 360.0, for KEPLER;
    /// Semi-major axis; negative for hyperbolas.
    semi_major_axis_km: f64, of "kilometres", in ORBIT_KM, for MOTION;
    /// Distance of the periapsis from the Earth's centre, in place of the semi-major axis.
    periapsis_km: f64, of "kilometres", in 0.001..=*ORBIT_KM.end(), for MOTION;
    /// Eccentricity: 0 is a circle, 1 a parabola.
    eccentricity: f64, in 0.0..=1e6, default 0.0, for MOTION;
    /// Inclination.
    inclination_deg: f64, of "degrees", in 0.0..=180.0, default 0.0, for MOTION;
    /// Right ascension of the ascending node (RAAN).
    raan_deg: f64, of "degrees", in TURN_DEG, default 0.0, for MOTION;
    /// Argument of periapsis.
    argument_of_periapsis_deg: f64, of "degrees", in TURN_DEG, default 0.0, for MOTION;
    /// True anomaly at the epoch.
    true_anomaly_deg: f64, of "degrees", in TURN_DEG, default 0.0, for MOTION;
    /// Mean anomaly at the epoch, in place of the true anomaly.
    mean_anomaly_deg: f64, of "degrees", in TURN_DEG, default 0.0, for MOTION;
    // Lists of any length, so that a wrong length gets our own message.
    /// Position of an initial state that is given as a state vector, from the Earth's centre.
    position_km: Vec<f64>, of "[x, y, z], three numbers of kilometres", in ORBIT_KM, for MOTION;
    /// Velocity of that state, as seen in the frame.
    velocity_km_s: Vec<f64>, of "[x, y, z], three numbers of kilometres per second", in -5000.0..=5000.0, for MOTION;
    /// Whether node and periapsis drift by the Earth's flattening.
    j2: bool, default false, for KEPLER;
    /// Degree of the Earth's gravity; 0 is a point mass.
    gravity_degree: i64, of "a whole number from 0 to 20", in 0..=20, default 20, for FORCES;
    /// Order of the Earth's gravity; 0 leaves the zonal terms alone. By default the degree.
    gravity_order: i64, of "a whole number from 0 to gravity_degree", for FORCES;
    /// Whether the air's drag acts.
    drag: bool, default true, for FORCES;
    /// Model of the air's density by height.
    air_model: Choice<AirModel>, default AirModel::Us1976, for FORCES;
    /// Whether the Sun's gravity acts.
    sun: bool, default true, for FORCES;
    /// Whether the Moon's gravity acts.
    moon: bool, default true, for FORCES;
    /// Whether the pressure of sunlight acts.
    radiation: bool, default true, for FORCES;
    /// Mass of the satellite.
    mass_kg: f64, of "kilograms", in 1e-6..=1e9, default Spacecraft::default().mass_kg, for FORCES;
    /// Area against air and sunlight.
    area_m2: f64, of "square metres", in 0.0..=1e9, default Spacecraft::default().drag_area_m2, for FORCES;
    /// Drag coefficient.
    cd: f64, in 0.0..=100.0, default Spacecraft::default().drag_coefficient, for FORCES;
    /// Coefficient of reflectivity: 1 where light is absorbed, 2 where it is reflected.
    cr: f64, in 0.0..=100.0, default Spacecraft::default().reflectivity, for FORCES;
    /// Error allowed in a step of the integration, relative to distance and speed.
    tolerance: f64, in 1e-14..=1e-3, default 1e-10, for FORCES;
    /// Method of integration.
    method: Choice<Method>, default Method::Automatic, for FORCES;
    // A list of tables, checked by burns.rs.
    /// Burns, each over its own time. By default none.
    burns: toml::Value, of "a list like [{ start = \"2018-01-15T12:30:00Z\", duration_s = 60, acceleration_m_s2 = [0.05, 0, 0], axes = \"flight\" }]", for FORCES;
    // A list of any length.
    /// Events that are looked for besides the impact. By default none.
    events: Vec<String>, of "a list of \"nodes\", \"apsides\" and \"eclipses\"", for FORCES;
    /// Address on which a simulator's connection is accepted. "live" needs it; by default "basilisk" listens on port 5556 of this machine.
    listen: String, of "a string: \"stdin\", or \"tcp://\", \"udp://\" or \"ws://\" with an IP address and a port", for SENT;
    /// Address on which a simulation publishes its steps, in place of listening.
    subscribe: String, of "a string: \"tcp://\" with an IP address and a port", for PUBLISHED;
    /// Whether the address may be one that other machines reach.
    allow_remote: bool, default false, for SENT;
    // A list of any length.
    /// Web pages whose scripts may connect. By default none.
    allowed_origins: Vec<String>, of "a list of strings, web pages like \"https://example.org\"", for LIVE;
    /// Whether the simulator waits for its pictures ("lockstep") or not.
    pacing: Choice<Pacing>, default Pacing::default(), for LIVE;
    /// Simulated seconds per second of a simulator that does not wait.
    rate: f64, of "simulated seconds per second", in LiveOptions::RATES, default usual_live().rate, for LIVE;
    /// How far pictures are behind a simulator that does not wait.
    playback_delay_s: f64, of "seconds", in LiveOptions::PLAYBACK_DELAYS_S, default usual_live().playback_delay_s, for LIVE;
    /// How long a simulator waits for its picture.
    timeout_s: f64, of "seconds", in LiveOptions::FRAME_TIMEOUTS_S, default usual_live().frame_timeout.as_secs_f64(), for SENT;
    /// Age of the last state from which on the simulator is reported as silent.
    stale_after_s: f64, of "seconds", in LiveOptions::STALE_AGES_S, default usual_live().stale_after_s, for SENT;
    /// How far the satellite is extrapolated beyond the last state.
    extrapolate_s: f64, of "simulated seconds", in LiveOptions::EXTRAPOLATION_LIMITS_S, default usual_live().extrapolation_limit_s, for LIVE;
    /// How the satellite is extrapolated.
    extrapolation: Choice<Extrapolation>, default Extrapolation::default(), for LIVE;
    /// Time between two states from which on they are a jump.
    gap_s: f64, of "simulated seconds", in LiveOptions::GAPS_S, default usual_live().gap_s, for LIVE;
    /// Packets that a connection may send in a second; more are dropped.
    packets_per_s: i64, of "a whole number of packets per second", in LiveOptions::PACKET_RATES_PER_S, default i64::from(usual_live().max_packets_per_s), for LIVE;
    /// Colour of all that is drawn of the satellite. By default one of a palette, by the satellite's place in the scene.
    color: String, of "a string, \"#\" and six hexadecimal digits";
    /// Model of the spacecraft: glTF 2.0. By default the chase camera shows the built-in spacecraft, and other cameras none.
    model: RawPath, of "a glTF file (.glb or .gltf)";
    /// Factor from the lengths in the model's file, metres, to those that are drawn.
    model_scale: f64, in 1e-6..=1e9, default 1.0;
    /// Least length of the model on screen: from afar it is enlarged to that. 0 keeps its true scale.
    model_length_px: f64, of "pixels", in 0.0..=4096.0, default 0.0;
    /// How the model's axes lie in the spacecraft's, which are x along flight, y to the right and z down: "gltf" for +Z forward and +Y up,
    /// "body" where they are the same.
    model_axes: Choice<ModelAxes>, default ModelAxes::default();
    /// Attitude of the spacecraft, built-in or model: "nadir" flies level with z down; "sun" turns −z to the Sun and x as near to flight as it
    /// can; "inertial" has the axes of GCRF.
    attitude: Choice<AttitudeName>, default AttitudeName::default();
    /// File of attitudes, in place of attitude: an AEM (CCSDS 504.0, KVN or XML), or CSV with the columns epoch_utc, qx, qy, qz, qw.
    /// By default none.
    attitude_file: RawPath, of "a file of attitudes";
    /// Rate at which the spacecraft spins about spin_axis on top of attitude, counter-clockwise, from the scene's start on. By default it
    /// does not.
    spin_rate_deg_s: f64, of "degrees a second", in RATE_DEG_S;
    // A list of any length.
    /// Axis of the spin in the axes of the spacecraft. By default [0, 0, 1].
    spin_axis: Vec<f64>, of "[x, y, z], three numbers", in AXIS;
    // A list of tables, checked by articulations.rs.
    /// Nodes of the model that rotate about an axis of their own, with their child nodes. By default none.
    articulations: toml::Value, of "a list like [{ node = \"Panel\", axis = [0, 1, 0], track = \"sun\", normal = [0, 0, 1] }]";
} {});

/// Default settings of a live feed; a scene always states the transport.
fn usual_live() -> LiveOptions {
    LiveOptions::new(Transport::Stdin)
}

table_with_tracks!(RawTracks = "tracks" {} {
    /// Width of all lines.
    width_px: f64, of "pixels", in 0.5..=16.0, default 2.0;
});
