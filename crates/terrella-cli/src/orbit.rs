//! `terrella orbit`

use super::scene_args::{SceneArgs, begin, open_flight};
use super::{Common, print, reject_usage, values};
use clap::error::ErrorKind;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use terrella::frames::{Duration, Epoch, Geodetic, rfc3339};
use terrella_orbit::{Frame, Header, VisibilityRule};
use terrella_play::{
    Axes, Ephemeris, EphemerisRequest, EventTable, Flight, Layout, OutputError, PassRequest,
    PassTable, PendingFile, Selection, Span, early_end, names, omm, select,
};

/// The command's name.
const NAME: &str = "orbit";

/// Arguments of `terrella orbit`.
#[derive(Debug, Args)]
pub struct OrbitArgs {
    #[command(flatten)]
    scene: SceneArgs,
    /// Start time, for example 2026-11-25T05:00:00Z, or now [default: the scene's]
    #[arg(long, value_name = "TIME", value_parser = values::instant, conflicts_with = "names")]
    start: Option<Epoch>,
    /// Seconds between states, from the scene's start on
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds, default_value = "60", conflicts_with = "at")]
    every: f64,
    /// Also print the state at the end if --every does not meet it; --oem always writes that
    #[arg(long, conflicts_with_all = ["at", "passes", "events", "names"])]
    include_end: bool,
    /// Print only the state at this time, or now
    #[arg(long, value_name = "TIME", value_parser = values::instant)]
    at: Option<Epoch>,
    /// Reference frame of positions and velocities, or geodetic coordinates
    #[arg(long, value_enum, default_value_t = FrameName::Itrf)]
    frame: FrameName,
    /// Print CSV, which a scene reads with source = "csv"
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Print JSON
    #[arg(long)]
    json: bool,
    /// Write an orbit ephemeris message (CCSDS OEM) instead of printing
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "csv", "json"])]
    oem: Option<PathBuf>,
    /// Write an orbit mean-elements message (CCSDS OMM) instead of printing: of the satellites that --satellite names, or of all
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "csv", "json"])]
    omm: Option<PathBuf>,
    /// Print the passes over a place, from the scene's start to its end: latitude and longitude in degrees, south and west negative, and
    /// height in metres above the ellipsoid. A satellite is visible while it is outside the umbra and the Sun is more than 6° below the horizon, however faint it is
    #[arg(
        long, value_name = "LAT,LON[,HEIGHT]", value_parser = values::place, allow_hyphen_values = true,
        conflicts_with_all = ["every", "frame", "oem", "omm"]
    )]
    passes: Option<Geodetic>,
    /// With --passes: minimum elevation above the horizon, degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::elevation_deg, default_value = "10", requires = "passes")]
    min_elevation: f64,
    /// Number of days from the scene's start, as far as the orbit is valid [default: to the scene's end]
    #[arg(long, value_name = "N", value_parser = values::days, conflicts_with = "names")]
    days: Option<f64>,
    /// With --passes: standard magnitude of the satellite, at 1000 km and half lit; prints how bright it is where it is visible
    #[arg(long, value_name = "MAGNITUDE", value_parser = values::magnitude, allow_hyphen_values = true, requires = "passes")]
    standard_magnitude: Option<f64>,
    /// With --standard-magnitude: only passes that reach this magnitude or a brighter one, which is a smaller number, are visible
    #[arg(long, value_name = "MAGNITUDE", value_parser = values::magnitude, allow_hyphen_values = true, requires = "standard_magnitude")]
    max_magnitude: Option<f64>,
    /// With --passes: time zone of the printed times, as an offset from UTC
    #[arg(
        long, value_name = "±HH:MM", value_parser = values::time_zone_min, allow_hyphen_values = true, requires = "passes",
        conflicts_with_all = ["csv", "json"]
    )]
    time_zone: Option<i32>,
    /// Print events: entry into the Earth's penumbra and umbra, exit, nodes and apsides; of numerical propagation also what it finds
    #[arg(long, conflicts_with_all = ["every", "frame", "oem", "omm", "passes"])]
    events: bool,
    /// List all satellites, with catalogue number or designator, and the time span of each
    #[arg(long, conflicts_with_all = ["every", "at", "frame", "oem", "omm", "passes", "events", "satellite"])]
    names: bool,
    /// Name of a satellite; repeatable [default: the one that cameras follow, or the only one of an orbit file]
    #[arg(long, value_name = "NAME")]
    satellite: Vec<String>,
    /// All satellites of the scene or orbit file, each within its time span
    #[arg(long, conflicts_with = "satellite")]
    all: bool,
}

/// Frames by name.
#[derive(Clone, Copy, Debug, ValueEnum)]
enum FrameName {
    /// True equator, mean equinox of date
    Teme,
    /// Earth-fixed
    Itrf,
    /// The celestial reference frame
    Gcrf,
    /// Mean equator and equinox of J2000
    Eme2000,
    /// Earth-fixed, before polar motion
    Pef,
    /// Latitude, longitude, height
    Geodetic,
}

impl FrameName {
    fn axes(self) -> Axes {
        Axes::Frame(match self {
            Self::Teme => Frame::Teme,
            Self::Itrf => Frame::Itrf,
            Self::Gcrf => Frame::Gcrf,
            Self::Eme2000 => Frame::Eme2000,
            Self::Pef => Frame::Pef,
            Self::Geodetic => return Axes::Geodetic,
        })
    }
}

/// Prints states or passes, or writes messages.
pub fn run(args: &OrbitArgs, common: &Common) -> anyhow::Result<()> {
    reject_conflicts(args);
    // Create the files before any computation, so that a file that cannot be written fails at once.
    let oem_file = pending(args.oem.as_ref(), "ephemeris messages", "oem")?;
    let omm_file = pending(args.omm.as_ref(), "element messages", "omm")?;
    let mut scene = args.scene.load(&args.satellite)?;
    if args.all || args.names {
        scene.take_all();
    }
    if let Some(start) = args.start {
        begin(NAME, &mut scene, start)?;
    }
    let flight = open_flight(scene, Flight::open_without_listening)?;
    let layout = Layout::of(args.csv, args.json);
    if args.names {
        return print(&names(&flight, layout));
    }
    let selection = match (args.all, args.satellite.as_slice()) {
        (true, _) => Selection::All,
        (false, []) => Selection::Followed,
        (false, names) => Selection::Named(names),
    };
    let satellites = select(&flight, selection)?;
    let length = args.days.map(Duration::from_days);
    if args.days.is_some() || args.passes.is_some() || args.events {
        let ends = satellites.iter();
        for end in ends.filter_map(|satellite| early_end(&flight, satellite, length)) {
            tracing::warn!("{end}");
        }
    }
    if args.events {
        let tables = satellites
            .into_iter()
            .map(|satellite| EventTable::new(&flight, satellite, length))
            .collect::<Result<Vec<_>, _>>()?;
        return print(&EventTable::print(&tables, layout));
    }
    if let Some(place) = args.passes {
        let request = PassRequest {
            place,
            min_elevation_rad: args.min_elevation.to_radians(),
            length,
            visibility: VisibilityRule {
                standard_magnitude: args.standard_magnitude,
                ..VisibilityRule::default()
            },
            max_magnitude: args.max_magnitude,
            time_zone_min: args.time_zone.unwrap_or_default(),
        };
        let tables = satellites
            .into_iter()
            .map(|satellite| PassTable::new(&flight, satellite, &request))
            .collect::<Result<Vec<_>, _>>()?;
        return print(&PassTable::print(&tables, layout));
    }
    let header = Header {
        originator: concat!("TERRELLA ", env!("CARGO_PKG_VERSION")).to_owned(),
        created: Epoch::now()?,
    };
    let request = EphemerisRequest {
        span: match args.at {
            Some(epoch) => Span::At(epoch),
            None => Span::Every {
                step: Duration::from_seconds(args.every),
                length,
                // The readers of a message know nothing beyond its last state.
                has_end: args.include_end || oem_file.is_some(),
            },
        },
        axes: args.frame.axes(),
        where_known: args.all,
    };
    let prints = oem_file.is_none() && omm_file.is_none();
    if let Some(file) = omm_file {
        let wanted = match selection {
            // A catalogue of the scene.
            Selection::Followed => select(&flight, Selection::All)?,
            _ => satellites.clone(),
        };
        let text = omm(&wanted, file.target(), &header)?;
        let target = file.target().display().to_string();
        file.write_whole(text.as_bytes())?;
        if !common.quiet {
            eprintln!("{target}: {} element sets", wanted.len());
        }
    }
    if !prints && oem_file.is_none() {
        return Ok(());
    }
    let ephemerides = satellites
        .into_iter()
        .map(|satellite| Ephemeris::new(&flight, satellite, &request))
        .collect::<Result<Vec<_>, _>>()?;
    for ephemeris in &ephemerides {
        let name = ephemeris.satellite().name();
        if ephemeris.left_out() > 0 {
            let (first, last) = ephemeris.satellite().feed().validity();
            tracing::warn!(
                "{name}: {} times left out; it is known from {} to {}",
                ephemeris.left_out(),
                rfc3339(first),
                rfc3339(last)
            );
        }
    }
    match oem_file {
        Some(file) => write_oem(file, &ephemerides, &header, common.quiet),
        None => print(&Ephemeris::print(&ephemerides, layout)),
    }
}

/// Ends the program, as clap does, where --at has no meaning: the error names --start.
fn reject_conflicts(args: &OrbitArgs) {
    let others = [
        ("--passes", args.passes.is_some()),
        ("--events", args.events),
        ("--days", args.days.is_some()),
        ("--start", args.start.is_some()),
    ];
    let other = others.into_iter().find(|(_, is_given)| *is_given);
    if let (Some((name, _)), Some(_)) = (other, args.at) {
        let message = match name {
            "--start" => "--at conflicts with --start: it prints one state".to_owned(),
            name => {
                format!(
                    "--at prints one state and conflicts with {name}; give its first time by --start, for example --start now"
                )
            }
        };
        reject_usage(NAME, ErrorKind::ArgumentConflict, message)
    }
}

/// Writes a message for each satellite, one after the other.
fn write_oem(
    file: PendingFile,
    ephemerides: &[Ephemeris<'_>],
    header: &Header,
    quiet: bool,
) -> anyhow::Result<()> {
    let messages = ephemerides
        .iter()
        .map(|ephemeris| ephemeris.oem(file.target(), header))
        .collect::<Result<Vec<_>, _>>()?;
    let texts: Vec<_> = messages.iter().map(|(text, _)| text.as_str()).collect();
    let target = file.target().display().to_string();
    file.write_whole(texts.join("\n").as_bytes())?;
    if quiet {
        return Ok(());
    }
    for (ephemeris, (_, worst_m)) in ephemerides.iter().zip(&messages) {
        let count = ephemeris.states().len();
        let name = match ephemerides.len() {
            1 => String::new(),
            _ => format!("{}: ", ephemeris.satellite().name()),
        };
        eprintln!(
            "{target}: {name}{count} states; interpolating between them is accurate to {worst_m:.3} m"
        );
    }
    Ok(())
}

fn pending(
    path: Option<&PathBuf>,
    what: &'static str,
    extension: &'static str,
) -> Result<Option<PendingFile>, OutputError> {
    path.map(|path| PendingFile::create(path, what, extension))
        .transpose()
}
