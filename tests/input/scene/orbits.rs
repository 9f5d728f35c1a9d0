//! `[orbit]`: sources, several satellites, and which keys go together.

use super::{Bad, Folder, scene, utc};
use glam::DVec3;
use terrella_orbit::Frame;
use terrella_orbit::kepler::{Anomaly, OrbitSize};
use terrella_orbit::live::{Extrapolation, LiveOptions, Pacing};
use terrella_orbit::numerical::{AtmosphereModel, EventSelection, Solver, ThrustAxes};
use terrella_play::scene::{Motion, OrbitParameters, OrbitSource};

#[rustfmt::skip]
const BAD: &[Bad] = &[
    // Names and types, also in the second of several tables.
    ("[orbit]\neccentricty = 0.1", 2, &["[orbit] eccentricty:", "did you mean eccentricity?"]),
    ("[[orbit]]\n[[orbit]]\nfil = \"sat.tle\"", 3, &["[orbit] fil:", "did you mean file?"]),
    ("[[orbit]]\n[[orbit]]\nj2 = 1", 3, &["[orbit] j2 = 1", "must be true or false"]),
    ("[[orbit]]\n[[orbit]]\nspeed = 1", 3, &["[orbit] speed:", "belongs in [time]"]),
    ("orbit = 3", 1, &["orbit = 3", "must be a table, not a whole number", "[orbit]"]),
    ("orbit = [1, 2]", 1, &["orbit = [1, 2]", "must be a table"]),
    ("[[camera]]\nfov_deg = 45", 1, &["camera", "must be a table, not a list"]),
    ("[orbit]\nsource = \"keplr\"", 2, &["[orbit] source = \"keplr\":", "did you mean \"kepler\"?"]),
    // Keys that have another name now.
    ("[orbit]\nnode_deg = 35", 2, &["[orbit] node_deg:", "now called raan_deg"]),
    ("[orbit]\nargument_deg = 35", 2, &["[orbit] argument_deg:", "now called argument_of_periapsis_deg"]),
    // Keys of other sources.
    ("[orbit]\nj2 = true", 2, &["[orbit] j2 = true:", "is for source = \"kepler\"", "\"tle\""]),
    ("[orbit]\nfile = \"sat.tle\"\ninclination_deg = 5", 3, &["[orbit] inclination_deg = 5:", "whose start the scene gives"]),
    ("[orbit]\nsource = \"kepler\"\nfile = \"sat.tle\"", 3, &["[orbit] file", "read from files"]),
    ("[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\ndrag = true", 4, &["[orbit] drag = true:", "is for source = \"numerical\""]),
    ("[orbit]\nsource = \"numerical\"\nsemi_major_axis_km = 7000\nj2 = true", 4, &["[orbit] j2 = true:", "takes gravity_degree"]),
    ("[orbit]\nsource = \"oem\"", 2, &["[orbit] source = \"oem\":", "add file"]),
    ("[orbit]\nstrict = true", 2, &["[orbit] strict = true:", "add file"]),
    // Starts.
    ("[orbit]\nsource = \"kepler\"", 2, &["[orbit] source = \"kepler\":", "semi_major_axis_km", "position_km"]),
    ("[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\nperiapsis_km = 6900", 4, &["[orbit] periapsis_km = 6900:", "leave one out"]),
    ("[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\neccentricity = 1.5", 3, &["[orbit] semi_major_axis_km = 7000:", "below 0 with one above 1"]),
    ("[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\neccentricity = 1", 3, &["[orbit] semi_major_axis_km", "parabola", "periapsis_km"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\neccentricity = 1\nmean_anomaly_deg = 3", 5, &["[orbit] mean_anomaly_deg = 3:", "parabola"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\neccentricity = 2\nj2 = true", 5, &["[orbit] j2 = true:", "below 1"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\neccentricity = -0.1", 4, &["[orbit] eccentricity = -0.1:", "must be from 0 to 1e6"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\ninclination_deg = 181", 4, &["[orbit] inclination_deg = 181:", "from 0 to 180 degrees"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = nan", 3, &["[orbit] periapsis_km = nan:", "finite number"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\ntrue_anomaly_deg = 1\nmean_anomaly_deg = 1", 5, &["[orbit] mean_anomaly_deg = 1:", "leave one out"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\nframe = \"itrf\"", 4, &["[orbit] frame = \"itrf\":", "do not rotate with the Earth"]),
    ("[orbit]\nsource = \"kepler\"\nposition_km = [7000, 0, 0]", 3, &["[orbit] position_km", "velocity_km_s"]),
    ("[orbit]\nsource = \"kepler\"\nposition_km = [7000, 0]\nvelocity_km_s = [0, 7, 0]", 3, &["[orbit] position_km = [7000, 0]:", "three numbers"]),
    ("[orbit]\nsource = \"kepler\"\nposition_km = [7000, 0, inf]\nvelocity_km_s = [0, 7, 0]", 3, &["[orbit] position_km", "each number must be from"]),
    ("[orbit]\nsource = \"kepler\"\nposition_km = [7000, 0, 0]\nvelocity_km_s = [0, 7, 0]\nraan_deg = 3", 5, &["[orbit] raan_deg = 3:", "by elements or by position_km"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\nepoch = \"noon\"", 4, &["[orbit] epoch = \"noon\":", "2018-01-15T12:00:00Z"]),
    ("[orbit]\nsource = \"kepler\"\nperiapsis_km = 7000\nname = \"a\\nb\"", 4, &["[orbit] name", "one line"]),
    // Forces.
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ngravity_degree = 4\ngravity_order = 5", 5, &["[orbit] gravity_order = 5:", "to its degree, 4"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ndrag = false\nair_model = \"us1976\"", 5, &["[orbit] air_model", "drag = false"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ngravity_degree = 21", 4, &["[orbit] gravity_degree = 21:", "from 0 to 20"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nmass_kg = 0", 4, &["[orbit] mass_kg = 0:", "kilograms"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ntolerance = 1", 4, &["[orbit] tolerance = 1:", "must be from 1e-14 to 0.001"]),
    ("[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ndrag = false\ncd = 2", 5, &["[orbit] cd = 2:", "no meaning with drag = false"]),
    // Keys in other tables that refer to satellites.
    ("[camera]\nfollow = \"ISS\"", 2, &["[camera] follow = \"ISS\":", "[orbit]"]),
    ("[orbit]\n[camera]\nfollow = \" \"", 3, &["[camera] follow = \" \":", "must not be empty"]),
    ("[time]\norientation = \"nowhere\"", 2, &["[time] orientation = \"nowhere\":", "cannot be opened"]),
];

#[test]
fn bad_satellites_are_rejected_with_file_line_key_and_remedy() {
    Folder::new().rejects(BAD);
}

#[test]
fn several_satellites_keep_their_order_and_lines() {
    let scene = scene(
        "[time]\nstart = \"2018-01-20T00:00:00Z\"\n[[orbit]]\n[[orbit]]\nsource = \"kepler\"\nname = \"B\"\n\
         periapsis_km = 7000\n[camera]\nfollow = \"b\"",
    );
    let sources: Vec<_> = scene.orbits.iter().map(|orbit| orbit.source).collect();
    assert_eq!(sources, [OrbitSource::Tle, OrbitSource::Kepler]);
    assert_eq!(scene.orbit_line(1, "periapsis_km"), Some(7));
    assert_eq!(scene.orbit_line(0, "source"), None);
    assert_eq!(scene.line("orbit", "source"), None);
    assert_eq!(scene.followed(&["ISS (ZARYA)", "B"]).ok(), Some(1));
    let rejection = scene.followed(&["ISS (ZARYA)", "C"]);
    // The scene's own name counts, whatever the file calls it.
    assert_eq!(rejection.ok(), Some(1));
    let summary = scene.summary();
    assert_eq!(summary.matches("\n[[orbit]]\n").count(), 2, "{summary}");
    assert!(summary.contains("line 7 of the file"), "{summary}");
    // A start without an epoch starts with the scene.
    let Some(Motion::Kepler { start, .. }) = &scene.orbits[1].motion else {
        panic!("no conic");
    };
    assert_eq!(start.epoch, utc("2018-01-20T00:00:00Z"));
}

#[test]
fn one_name_is_followed_or_none() {
    let follows = |name: &str| {
        let text = format!(
            "[[orbit]]\nsource = \"kepler\"\nperiapsis_km = 7000\n[[orbit]]\nsource = \"kepler\"\nperiapsis_km = 8000\n\
             [camera]\nfollow = \"{name}\""
        );
        scene(&text)
            .followed(&["Kepler", "Kepler"])
            .map_err(|error| error.to_string())
    };
    let twice = follows("kepler").expect_err("two of them");
    assert!(
        twice.starts_with("scene.toml:8: [camera] follow") && twice.contains("2 satellites"),
        "{twice}"
    );
    let near = follows("Keppler").expect_err("none of them");
    assert!(near.contains("did you mean \"Kepler\"?"), "{near}");
}

#[test]
fn starts_and_forces_are_read_in_their_units() {
    let kepler = scene(
        "[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = 7000\neccentricity = 0.1\ninclination_deg = 90\nraan_deg = 180\n\
         argument_of_periapsis_deg = -90\nmean_anomaly_deg = 45\nepoch = 2018-01-01T00:00:00Z\nframe = \"teme\"\nj2 = true",
    );
    let Some(Motion::Kepler { start, j2: true }) = &kepler.orbits[0].motion else {
        panic!("{:?}", kepler.orbits);
    };
    assert_eq!(
        (start.epoch, start.frame),
        (utc("2018-01-01T00:00:00Z"), Frame::Teme)
    );
    let OrbitParameters::Elements(elements) = &start.parameters else {
        panic!("{start:?}");
    };
    assert_eq!(elements.size, OrbitSize::SemiMajorAxis(7e6));
    assert_eq!(elements.inclination_rad, 90f64.to_radians());
    assert_eq!(elements.anomaly, Anomaly::Mean(45f64.to_radians()));
    let summary = kepler.summary();
    let words: Vec<_> = summary.split_whitespace().collect();
    for [key, value] in [
        ["semi_major_axis_km", "7000"],
        ["inclination_deg", "90"],
        ["argument_of_periapsis_deg", "-90"],
    ] {
        let reported = words.windows(2).any(|pair| pair == [key, value]);
        assert!(reported, "{key} {value} is not in\n{summary}");
    }

    let numerical = scene(
        "[orbit]\nsource = \"numerical\"\nposition_km = [1, 2, 7000]\nvelocity_km_s = [7.5, 0, -0.1]\nframe = \"itrf\"\n\
         gravity_degree = 4\ndrag = false\nsun = false\nmoon = false\nradiation = false\nmass_kg = 5\narea_m2 = 2\n\
         tolerance = 1e-8",
    );
    let Some(Motion::Numerical { start, forces }) = &numerical.orbits[0].motion else {
        panic!("{:?}", numerical.orbits);
    };
    assert_eq!(
        start.parameters,
        OrbitParameters::State {
            position_m: DVec3::new(1e3, 2e3, 7e6),
            velocity_m_s: DVec3::new(7500.0, 0.0, -100.0)
        }
    );
    assert_eq!((forces.gravity_degree, forces.tolerance), (4, 1e-8));
    assert_eq!(forces.gravity_order, 4);
    assert!(forces.drag.is_none() && !forces.sun && !forces.moon && !forces.radiation);
    assert_eq!(
        (forces.craft.mass_kg, forces.craft.drag_area_m2),
        (5.0, 2.0)
    );
    assert_eq!(forces.craft.sunlit_area_m2, 2.0);

    let zonal = scene(
        "[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\ngravity_degree = 6\ngravity_order = 0\nair_model = \"exponential\"",
    );
    let Some(Motion::Numerical { forces, .. }) = &zonal.orbits[0].motion else {
        panic!("{:?}", zonal.orbits);
    };
    assert_eq!((forces.gravity_degree, forces.gravity_order), (6, 0));
    assert_eq!((forces.method, forces.burns.len()), (Solver::Automatic, 0));
    assert_eq!(forces.events, EventSelection::default());
    assert_eq!(forces.drag, Some(AtmosphereModel::Exponential));
}

#[test]
fn burns_events_and_the_method_are_read() {
    let text = "[orbit]\nsource = \"numerical\"\nperiapsis_km = 7000\nmethod = \"implicit\"\nevents = [\"eclipses\", \"nodes\"]\n\
         burns = [{ start = 2018-01-15T12:10:00Z, duration_s = 90, acceleration_m_s2 = [0.5, 0, -1] },\n\
         { start = \"2018-01-15T13:00:00Z\", duration_s = 0.5, acceleration_m_s2 = [0, 2.5, 0], axes = \"gcrf\" }]";
    let scene = scene(text);
    let Some(Motion::Numerical { forces, .. }) = &scene.orbits[0].motion else {
        panic!("{:?}", scene.orbits);
    };
    assert_eq!(forces.method, Solver::Implicit);
    let events = forces.events;
    assert!(events.nodes && events.shadow && !events.apsides);
    let [first, second] = forces.burns[..] else {
        panic!("{:?}", forces.burns);
    };
    assert_eq!(first.first, utc("2018-01-15T12:10:00Z"));
    assert_eq!(first.last, utc("2018-01-15T12:11:30Z"));
    assert_eq!(first.acceleration_m_s2, DVec3::new(0.5, 0.0, -1.0));
    assert_eq!(first.axes, ThrustAxes::Flight);
    assert_eq!(second.last, utc("2018-01-15T13:00:00.5Z"));
    assert_eq!(second.axes, ThrustAxes::Gcrf);
    // The summary writes them as a scene would.
    let summary = scene.summary();
    for reported in [
        "acceleration_m_s2 = [0.5, 0, -1], axes = \"flight\"",
        "[\"nodes\", \"eclipses\"]",
        "\"implicit\"",
        "drag, sunlight, burns",
    ] {
        assert!(
            summary.contains(reported),
            "{reported} is not in\n{summary}"
        );
    }
}

#[rustfmt::skip]
const BAD_LIVE: &[Bad] = &[
    ("[orbit]\nsource = \"live\"", 2, &["[orbit] source = \"live\":", "needs a place to listen on", "tcp://127.0.0.1:5005"]),
    ("[orbit]\nlisten = \"stdin\"", 2, &["[orbit] listen = \"stdin\":", "is for source = \"live\"", "\"tle\""]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nfile = \"sat.tle\"", 4, &["[orbit] file", "read from files"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nperiapsis_km = 7000", 4, &["[orbit] periapsis_km", "whose start the scene gives"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\ndrag = true", 4, &["[orbit] drag = true:", "\"numerical\""]),
    ("[orbit]\nsource = \"live\"\nlisten = 5005", 3, &["[orbit] listen = 5005:", "must be a string", "not a whole number"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"127.0.0.1:5005\"", 3, &["[orbit] listen = \"127.0.0.1:5005\":", "\"tcp://127.0.0.1:5005\""]),
    ("[orbit]\nsource = \"live\"\nlisten = \"http://127.0.0.1:5005\"", 3, &["[orbit] listen", "\"ws://\""]),
    ("[orbit]\nsource = \"live\"\nlisten = \"tcp://example.org:5005\"", 3, &["[orbit] listen", "an IP address and a port"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"tcp://127.0.0.1:70000\"", 3, &["[orbit] listen", "a port"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"udp://0.0.0.0:5005\"", 3, &["[orbit] listen", "control the image", "allow_remote = true"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nallow_remote = true", 4, &["[orbit] allow_remote = true:", "standard input is none"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"tcp://[::1]:5005\"\nallowed_origins = [\"https://a.b\"]", 4, &["[orbit] allowed_origins", "ws://"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"ws://[::1]:5005\"\nallowed_origins = [\"example.org\"]", 4, &["[orbit] allowed_origins", "https://example.org"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"ws://[::1]:5005\"\nallowed_origins = \"*\"", 4, &["[orbit] allowed_origins", "a list of strings"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\npacing = \"lock\"", 4, &["[orbit] pacing = \"lock\":", "did you mean \"lockstep\"?"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\npacing = \"lockstep\"\nrate = 2", 5, &["[orbit] rate = 2:", "\"broadcast\"", "its own instant"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\npacing = \"lockstep\"\nplayback_delay_s = 0", 5, &["[orbit] playback_delay_s", "nothing comes late"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\ntimeout_s = 5", 4, &["[orbit] timeout_s = 5:", "no simulator waits"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\npacing = \"lockstep\"\ntimeout_s = 4000", 5, &["[orbit] timeout_s = 4000:", "from 0.001 to 3600 seconds"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nplayback_delay_s = 61", 4, &["[orbit] playback_delay_s = 61:", "from 0 to 60 seconds"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nrate = 0", 4, &["[orbit] rate = 0:", "simulated seconds per second"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nstale_after_s = nan", 4, &["[orbit] stale_after_s = nan:", "finite"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nextrapolate_s = -1", 4, &["[orbit] extrapolate_s = -1:", "from 0 to"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\nextrapolation = \"cubic\"", 4, &["[orbit] extrapolation = \"cubic\":", "\"two-body\", \"linear\""]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\ngap_s = 0", 4, &["[orbit] gap_s = 0:", "seconds"]),
    ("[orbit]\nsource = \"live\"\nlisten = \"stdin\"\npackets_per_s = 0", 4, &["[orbit] packets_per_s = 0:", "1 to 1000000 packets"]),
    // Several in one scene; the second is invalid.
    ("[[orbit]]\nsource = \"live\"\nlisten = \"stdin\"\n[[orbit]]\nsource = \"live\"\nlisten = \"stdin\"", 6, &["[orbit] listen = \"stdin\":", "one standard input", "give this one a port"]),
    ("[[orbit]]\nsource = \"live\"\nlisten = \"tcp://127.0.0.1:5005\"\n[[orbit]]\nsource = \"live\"\nlisten = \"ws://127.0.0.1:5005\"", 6, &["[orbit] listen = \"ws://127.0.0.1:5005\":", "another port"]),
    ("[[orbit]]\nsource = \"live\"\nlisten = \"udp://0.0.0.0:5005\"\nallow_remote = true\n[[orbit]]\n[[orbit]]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:5005\"", 8, &["[orbit] listen", "another port"]),
    ("[[orbit]]\nsource = \"live\"\nlisten = \"stdin\"\npacing = \"lockstep\"\n[[orbit]]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:5005\"\npacing = \"lockstep\"", 8, &["[orbit] pacing = \"lockstep\":", "one instant", "\"broadcast\""]),
];

#[test]
fn bad_live_satellites_are_rejected_with_file_line_key_and_remedy() {
    Folder::new().rejects(BAD_LIVE);
}

#[rustfmt::skip]
const BAD_BASILISK: &[Bad] = &[
    ("[orbit]\nsubscribe = \"tcp://127.0.0.1:5570\"", 2, &["[orbit] subscribe", "is for source = \"basilisk\"", "\"tle\""]),
    ("[orbit]\nsource = \"basilisk\"\nlisten = 5556", 3, &["[orbit] listen = 5556:", "must be a string"]),
    ("[orbit]\nsource = \"basilisk\"\nlisten = \"udp://127.0.0.1:5556\"", 3, &["[orbit] listen = \"udp://127.0.0.1:5556\":", "tcp://127.0.0.1:5556"]),
    ("[orbit]\nsource = \"basilisk\"\nlisten = \"tcp://0.0.0.0:5556\"", 3, &["[orbit] listen", "control the image", "allow_remote = true"]),
    ("[orbit]\nsource = \"basilisk\"\nsubscribe = \"tcp://192.0.2.1:5570\"", 3, &["[orbit] subscribe", "allow_remote = true"]),
    ("[orbit]\nsource = \"basilisk\"\nlisten = \"tcp://127.0.0.1:1\"\nsubscribe = \"tcp://127.0.0.1:2\"", 3, &["[orbit] listen", "one of them"]),
    ("[orbit]\nsource = \"basilisk\"\nsubscribe = \"tcp://127.0.0.1:2\"\ntimeout_s = 1", 4, &["[orbit] timeout_s = 1:", "publishes does not"]),
    ("[orbit]\nsource = \"basilisk\"\ntimeout_s = 0", 3, &["[orbit] timeout_s = 0:", "from 0.001 to 3600 seconds"]),
    ("[orbit]\nsource = \"basilisk\"\nrate = 2", 3, &["[orbit] rate = 2:", "is for source = \"live\""]),
    ("[orbit]\nsource = \"basilisk\"\nstrict = true", 3, &["[orbit] strict = true:", "skipped"]),
    ("[orbit]\nsource = \"basilisk\"\nfile = \"missing.bin\"", 3, &["[orbit] file = \"missing.bin\":"]),
    ("[orbit]\nsource = \"basilisk\"\nfile = \"sat.tle\"\nlisten = \"tcp://127.0.0.1:1\"", 4, &["[orbit] listen", "simulations that run"]),
    ("[[orbit]]\n[[orbit]]\nsource = \"basilisk\"", 3, &["[orbit] source = \"basilisk\":", "its own satellites"]),
];

#[test]
fn bad_simulations_are_rejected_with_file_line_key_and_remedy() {
    Folder::new().rejects(BAD_BASILISK);
}

#[test]
fn keys_of_simulations_reach_them() {
    use terrella_orbit::basilisk::{Endpoint, Meeting, SimulationOptions};
    let options = |keys: &str| {
        let scene = scene(&format!("[orbit]\nsource = \"basilisk\"\n{keys}"));
        assert!(scene.is_live());
        let summary = scene.full_summary();
        let met = scene.orbits[0].basilisk.clone().expect("it runs");
        assert!(
            summary.contains(&met.meeting.endpoint().to_string()),
            "{summary}"
        );
        met
    };
    let usual = SimulationOptions::new(Meeting::Listen(Endpoint::TWO_WAY));
    assert_eq!(options(""), usual);
    let given = options(
        "name = \"sat-1\"\nlisten = \"tcp://[::]:5557\"\nallow_remote = true\ntimeout_s = 2.5\nstale_after_s = 7",
    );
    let listen = "tcp://[::]:5557".parse().expect("an endpoint");
    assert_eq!(
        given,
        SimulationOptions {
            craft: Some("sat-1".to_owned()),
            allow_remote: true,
            timeout: std::time::Duration::from_millis(2500),
            stale_after_s: 7.0,
            ..SimulationOptions::new(Meeting::Listen(listen))
        }
    );
    let published = options("subscribe = \"tcp://localhost:5570\"");
    let endpoint = "tcp://127.0.0.1:5570".parse().expect("an endpoint");
    assert_eq!(published.meeting, Meeting::Subscribe(endpoint));
}

#[test]
fn live_keys_reach_the_feed() {
    let scene = scene(
        "[[orbit]]\nsource = \"live\"\nname = \"A\"\nlisten = \"ws://localhost:5005\"\nrate = 60\nplayback_delay_s = 0.5\n\
         stale_after_s = 3\nextrapolate_s = 90\nextrapolation = \"linear\"\ngap_s = 30\npackets_per_s = 50\n\
         allowed_origins = [\"https://example.org\"]\n\
         [[orbit]]\nsource = \"live\"\nlisten = \"tcp://[::]:5006\"\nallow_remote = true\npacing = \"lockstep\"\ntimeout_s = 2.5\n\
         [[orbit]]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:5005\"\n\
         [[orbit]]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:0\"\n\
         [[orbit]]\nsource = \"live\"\nlisten = \"udp://127.0.0.1:0\"\n\
         [output]\nwait_s = 5",
    );
    let options: Vec<_> = scene
        .orbits
        .iter()
        .filter_map(|orbit| orbit.live.clone())
        .collect();
    assert_eq!(
        options[0],
        LiveOptions {
            name: "A".to_owned(),
            rate: 60.0,
            playback_delay_s: 0.5,
            stale_after_s: 3.0,
            extrapolation_limit_s: 90.0,
            extrapolation: Extrapolation::Linear,
            gap_s: 30.0,
            max_packets_per_s: 50,
            allowed_origins: vec!["https://example.org".to_owned()],
            ..LiveOptions::new("ws://127.0.0.1:5005".parse().unwrap())
        }
    );
    assert_eq!(
        options[1],
        LiveOptions {
            pacing: Pacing::Lockstep,
            allow_remote: true,
            frame_timeout: std::time::Duration::from_millis(2500),
            ..LiveOptions::new("tcp://[::]:5006".parse().unwrap())
        }
    );
    assert_eq!(
        options[2],
        LiveOptions::new("udp://127.0.0.1:5005".parse().unwrap())
    );
    assert!(scene.is_live() && scene.output.wait_s == 5.0);
    let summary = scene.full_summary();
    for part in [
        "\"ws://127.0.0.1:5005\"",
        "[\"https://example.org\"]",
        "not used: is for pacing = \"lockstep\"",
        "frames that a simulator waits for, each up to 2.5 s",
        "the time that the simulator sends",
    ] {
        assert!(summary.contains(part), "{part} is not in\n{summary}");
    }
    assert!(!summary.contains("unknown"), "{summary}");
}
