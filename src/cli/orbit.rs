//! `terrella orbit`

use super::{Common, print, values};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use terrella::frames::{Duration, Epoch, Geodetic};
use terrella::internals::play::{
    Axes, Ephemeris, EphemerisRequest, Flight, Layout, OutputError, PassRequest, PassTable,
    PendingFile, Span, omm,
};
use terrella::orbit::{Frame, Header};
use terrella::scene::Scene;

/// Arguments of `terrella orbit`.
#[derive(Debug, Args)]
pub struct OrbitArgs {
    /// The scene file
    scene: PathBuf,
    /// Seconds between states, from the scene's first instant to its last
    #[arg(long, value_name = "SECONDS", value_parser = values::seconds, default_value = "60", conflicts_with = "at")]
    every: f64,
    /// Print only the state at this instant
    #[arg(long, value_name = "UTC", value_parser = values::instant)]
    at: Option<Epoch>,
    /// Frame of positions and velocities, or latitude, longitude and height
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
    /// Write an orbit mean-elements message (CCSDS OMM) instead of printing: of the satellite that is named, or of all
    #[arg(long, value_name = "FILE", conflicts_with_all = ["at", "csv", "json"])]
    omm: Option<PathBuf>,
    /// Print when the satellite stands above the horizon of a place, from the scene's first instant to its last: latitude and
    /// longitude in degrees, south and west negative, and metres above the ellipsoid
    #[arg(
        long, value_name = "LAT,LON[,HEIGHT]", value_parser = values::place, allow_hyphen_values = true,
        conflicts_with_all = ["every", "at", "frame", "oem", "omm"]
    )]
    passes: Option<Geodetic>,
    /// With --passes: minimum elevation above the horizon, degrees
    #[arg(long, value_name = "DEGREES", value_parser = values::elevation_deg, default_value = "10", requires = "passes")]
    min_elevation: f64,
    /// With --passes: number of days from the scene's first instant, as far as the satellite's orbit is known
    #[arg(long, value_name = "N", value_parser = values::days, requires = "passes")]
    days: Option<f64>,
    /// Name of the satellite [default: the one that cameras follow]
    #[arg(long, value_name = "NAME")]
    satellite: Option<String>,
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

/// Prints states, passes or writes messages, as the arguments ask.
pub fn run(args: &OrbitArgs, common: &Common) -> anyhow::Result<()> {
    // Before anything is computed: a file that cannot be written is found at once.
    let oem_file = pending(args.oem.as_ref(), "ephemeris messages", "oem")?;
    let omm_file = pending(args.omm.as_ref(), "element messages", "omm")?;
    let flight = Flight::open_without_listening(Scene::load(&args.scene)?)?;
    let layout = match (args.csv, args.json) {
        (true, _) => Layout::Csv,
        (_, true) => Layout::Json,
        _ => Layout::Text,
    };
    if let Some(place) = args.passes {
        let request = PassRequest {
            place,
            min_elevation_rad: args.min_elevation.to_radians(),
            length: args.days.map(Duration::from_days),
            satellite: args.satellite.as_deref(),
        };
        return print(&PassTable::new(&flight, &request)?.print(layout));
    }
    let header = Header {
        originator: concat!("TERRELLA ", env!("CARGO_PKG_VERSION")).to_owned(),
        created: Epoch::now()?,
    };
    let satellite = args.satellite.as_deref();
    let request = EphemerisRequest {
        span: match args.at {
            Some(epoch) => Span::At(epoch),
            None => Span::Every(Duration::from_seconds(args.every)),
        },
        axes: args.frame.axes(),
        satellite,
    };
    let prints = oem_file.is_none() && omm_file.is_none();
    if let Some(file) = omm_file {
        let text = omm(&flight, satellite, file.target(), &header)?;
        file.write_whole(text.as_bytes())?;
    }
    if let Some(file) = oem_file {
        let ephemeris = Ephemeris::new(&flight, &request)?;
        let (text, worst_m) = ephemeris.oem(file.target(), &header)?;
        let target = file.target().display().to_string();
        file.write_whole(text.as_bytes())?;
        if !common.quiet {
            let count = ephemeris.states().len();
            eprintln!(
                "{target}: {count} states; between them a reader's interpolation is {worst_m:.3} m off at most"
            );
        }
    }
    if !prints {
        return Ok(());
    }
    print(&Ephemeris::new(&flight, &request)?.print(layout))
}

fn pending(
    path: Option<&PathBuf>,
    what: &'static str,
    extension: &'static str,
) -> Result<Option<PendingFile>, OutputError> {
    path.map(|path| PendingFile::create(path, what, extension))
        .transpose()
}
