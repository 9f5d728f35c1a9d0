//! `terrella pack build`: an imagery pack from maps of any size.

use super::options::{PackOptions, Shown};
use super::report_built;
use crate::Common;
use crate::interruption::stop_by_itself;
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use std::time::Instant;
use terrella_imagery::SLOPE_EXAGGERATION;
use terrella_pack::{BuildOptions, Relief, VerticalDatum, build};

/// Arguments of `terrella pack build`.
#[derive(Debug, Args)]
#[command(
    after_help = "Maps are equirectangular PNG, JPEG or (Geo)TIFF files of the whole Earth, twice as wide as high, north up, left edge \
    at 180° W; or mosaics of georeferenced files: a TOML file, a virtual raster (.vrt), a file of tiles (MBTiles, PMTiles), or a folder of \
    GeoTIFFs, maps with world files or NASA's eight parts (docs/packs.md). TIFF may be compressed by LZW, deflate, PackBits, ZSTD, JPEG, \
    WebP or LERC. Run the same command again to resume an interrupted build."
)]
pub struct BuildArgs {
    /// Surface colour by day, sRGB
    #[arg(long, value_name = "MAP")]
    day: PathBuf,
    /// Cloud cover: grey, or the luminance of colour
    #[arg(long, value_name = "MAP")]
    clouds: Option<PathBuf>,
    /// Normal map in tangent space: red east, green north, blue up, middle 128
    #[arg(long, value_name = "MAP", conflicts_with = "elevation")]
    normals: Option<PathBuf>,
    /// Elevation in metres, from which slopes are computed: 16-bit PNG, TIFF of 16-bit or float samples, or a mosaic, also of
    /// Terrain-RGB or Terrarium tiles
    #[arg(long, value_name = "MAP")]
    elevation: Option<PathBuf>,
    /// City lights: grey, or the luminance of colour
    #[arg(long, value_name = "MAP")]
    night: Option<PathBuf>,
    /// Open water: white
    #[arg(long, value_name = "MAP")]
    water: Option<PathBuf>,
    /// Elevation data for streamed terrain, of the whole Earth or parts of it: GeoTIFF, PNG, NetCDF, SRTM (.hgt), ASCII grids, DTED
    /// and virtual rasters (.vrt) as scenes read them; finer
    /// files cover coarser ones, and those that do not fit into --memory are read in parts through a scratch file in the pack's folder
    #[arg(long, value_name = "FILE", num_args = 1..)]
    heights: Vec<PathBuf>,
    /// With --heights: the vertical datum of files that do not name one [default: sea]
    #[arg(long, value_enum, value_name = "DATUM", requires = "heights")]
    heights_above: Option<Datum>,
    /// The pack's folder
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    #[command(flatten)]
    pack: PackOptions,
    /// With --elevation: factor by which slopes are exaggerated
    #[arg(long, value_name = "TIMES", default_value_t = SLOPE_EXAGGERATION, requires = "elevation")]
    exaggeration: f64,
    /// With --elevation: metres to subtract from elevations [default: 11000 for PNG, 0 for TIFF]
    #[arg(
        long,
        value_name = "METRES",
        requires = "elevation",
        allow_negative_numbers = true
    )]
    elevation_offset: Option<f64>,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Datum {
    /// Mean sea level, as a country levels it
    Sea,
    /// The geoid EGM96
    Egm96,
    /// The geoid EGM2008
    Egm2008,
    /// The ellipsoid of WGS84
    Ellipsoid,
}

impl Datum {
    fn datum(self) -> VerticalDatum {
        match self {
            Self::Sea => VerticalDatum::Sea,
            Self::Egm96 => VerticalDatum::Egm96,
            Self::Egm2008 => VerticalDatum::Egm2008,
            Self::Ellipsoid => VerticalDatum::Ellipsoid,
        }
    }
}

/// Builds the pack.
pub fn run(args: &BuildArgs, common: &Common) -> anyhow::Result<()> {
    let elevation = args.elevation.as_ref().map(|path| Relief::Elevation {
        path: path.clone(),
        offset_m: args.elevation_offset,
        exaggeration: args.exaggeration,
    });
    let options = BuildOptions {
        clouds: args.clouds.clone(),
        relief: elevation.or_else(|| args.normals.clone().map(Relief::Normals)),
        night_lights: args.night.clone(),
        water: args.water.clone(),
        heights: args.heights.clone(),
        heights_above: args.heights_above.map(Datum::datum),
        ..args.pack.build_options(&args.day, &args.output)
    };
    stop_by_itself();
    let begun = Instant::now();
    let shown = Shown::new(common.quiet);
    let manifest = build(&options, &shown)?;
    report_built(&args.output, &manifest, begun, common);
    args.pack.check_notes(&shown)
}
