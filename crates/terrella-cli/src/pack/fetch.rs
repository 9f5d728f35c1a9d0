//! `terrella pack fetch`: maps from their public sources, and a pack from them.

use super::options::{PackOptions, Shown};
use super::{bytes, print, report_built};
use crate::Common;
use crate::interruption::stop_by_itself;
use anyhow::{Context, bail};
use clap::Args;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use terrella_imagery::SLOPE_EXAGGERATION;
use terrella_pack::fetch::{
    ClientOptions, FetchOptions, Fineness, Layer, LayerDone, Request, SourceLayer, find_source,
    source_names, write_heights,
};
use terrella_pack::mosaic::Bounds;
use terrella_pack::source::SourceLimits;
use terrella_pack::{BuildOptions, Relief, build};

/// Arguments of `terrella pack fetch`.
#[derive(Debug, Args)]
#[command(
    after_help = "A source is one of --list, or a TOML file (docs/packs.md); @TIME selects the date of a source that has several: \
    blue_marble@2004-06, viirs_snpp@2024-06-21. Run the same command again to resume; files in the cache are not downloaded again. \
    `terrella pack build --day CACHE/day` builds from the cache without the network."
)]
pub struct FetchArgs {
    /// Sources, each NAME, NAME@TIME or FILE.toml; of several sources of one map, later ones cover earlier ones
    #[arg(required_unless_present = "list", value_name = "SOURCE")]
    sources: Vec<String>,
    /// The pack's folder
    #[arg(short, long, value_name = "DIR", required_unless_present_any = ["list", "dry_run", "download_only", "heights"])]
    output: Option<PathBuf>,
    /// Minimum texels round the Earth: the coarsest level with as many is downloaded, or the finest available
    #[arg(long, value_name = "TEXELS", default_value_t = 21_600, value_parser = clap::value_parser!(u32).range(16..=10_000_000))]
    width: u32,
    /// Level to download, instead of --width
    #[arg(long, value_name = "N", conflicts_with = "width")]
    level: Option<u32>,
    /// Download only this part of the Earth: west, south, east and north in degrees; coarser imagery surrounds it
    #[arg(long, value_name = "W,S,E,N", allow_hyphen_values = true, value_parser = parse_region)]
    region: Option<Bounds>,
    /// With --region: texels round the Earth of the surrounding imagery, from the same source; 0 for none
    #[arg(
        long,
        value_name = "TEXELS",
        default_value_t = 2048,
        requires = "region"
    )]
    ground_width: u32,
    /// With --region: width in degrees of the blend into the surrounding imagery
    #[arg(
        long,
        value_name = "DEGREES",
        default_value_t = 0.25,
        requires = "region"
    )]
    feather: f64,
    /// Map of the whole Earth that fills poles and gaps of the sources; for one kind of map at a time
    #[arg(long, value_name = "MAP")]
    under: Option<PathBuf>,
    /// Folder for downloads [default: the output's name with .cache added]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Print what would be downloaded, without using the network
    #[arg(long)]
    dry_run: bool,
    /// Download into the cache without building a pack
    #[arg(long, conflicts_with_all = ["output", "heights"])]
    download_only: bool,
    /// Write a GeoTIFF of elevation data for a scene, instead of a pack
    #[arg(long, value_name = "FILE.tif", conflicts_with = "output")]
    heights: Option<PathBuf>,
    /// List the built-in sources with attribution and terms
    #[arg(long)]
    list: bool,
    /// Number of parallel requests [default: the source's, mostly 4]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=32))]
    connections: Option<u32>,
    /// Maximum requests per second [default: the source's, mostly 20]
    #[arg(long, value_name = "PER_S", value_parser = parse_rate)]
    rate: Option<f64>,
    /// Number of retries of a failed download
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(0..=20))]
    retries: u32,
    /// Timeout of a request, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=3600))]
    timeout: u64,
    /// Continue without files that cannot be downloaded; they are reported
    #[arg(long)]
    allow_missing: bool,
    /// Additional host that redirects may lead to; repeatable
    #[arg(long, value_name = "HOST")]
    redirect_host: Vec<String>,
    /// Certificates (PEM) of authorities to trust instead of the default ones
    #[arg(long, value_name = "FILE")]
    ca: Option<PathBuf>,
    /// Factor by which slopes of an elevation source are exaggerated [default: 4]
    #[arg(long, value_name = "TIMES")]
    exaggeration: Option<f64>,
    #[command(flatten)]
    pack: PackOptions,
}

/// `5,44,12,48` as bounds.
fn parse_region(text: &str) -> Result<Bounds, String> {
    let numbers: Result<Vec<f64>, _> = text.split(',').map(|word| word.trim().parse()).collect();
    match numbers
        .ok()
        .and_then(|numbers| <[f64; 4]>::try_from(numbers).ok())
    {
        Some(edges) => Bounds::new(edges),
        None => Err(
            "must be west, south, east and north in degrees, for example 5,44,12,48".to_string(),
        ),
    }
}

fn parse_rate(text: &str) -> Result<f64, String> {
    let rate = text
        .parse()
        .ok()
        .filter(|rate: &f64| (0.01..=1000.0).contains(rate));
    rate.ok_or_else(|| "must be from 0.01 to 1000 requests a second".to_string())
}

/// Fetches maps and builds the requested output.
pub fn run(args: &FetchArgs, common: &Common) -> anyhow::Result<()> {
    if args.list {
        return list();
    }
    if !(0.0..=90.0).contains(&args.feather) {
        bail!("--feather: must be from 0 to 90 degrees");
    }
    let requests = args.sources.iter().map(|text| Request::find(text));
    let layers = Layer::group(requests.collect::<Result<_, _>>()?);
    let options = options(args)?;
    if args.dry_run {
        return dry_run(&layers, &options);
    }
    if args.output.is_some() && !layers.iter().any(|layer| layer.layer == SourceLayer::Day) {
        bail!(
            "a pack needs a day map: add a source such as blue_marble, or download with --download-only and use `pack build`"
        );
    }
    if args.heights.is_some()
        && layers
            .iter()
            .any(|layer| layer.layer != SourceLayer::Elevation)
    {
        bail!("--heights: give only sources of elevation data, such as terrarium");
    }
    if args.under.is_some() && layers.len() > 1 {
        bail!(
            "--under: is a map of one kind; download one kind of map at a time with --download-only, then use `pack build`"
        );
    }
    let has_heights = layers
        .iter()
        .any(|layer| layer.layer == SourceLayer::Elevation);
    if args.exaggeration.is_some() && !(has_heights && args.output.is_some()) {
        bail!("--exaggeration: needs a pack with a source of elevation data");
    }
    if args.output.is_none() && !args.pack.is_default() {
        bail!("--name, --attribution, --storage, --pixels, --restart: need --output");
    }
    stop_by_itself();
    let begun = Instant::now();
    let shown = Shown::new(common.quiet);
    let mut done = Vec::new();
    for layer in &layers {
        let fetched = layer.fetch(&options, &shown)?;
        for (what, fetched) in &fetched.fetched {
            tracing::info!(
                what,
                new = fetched.new,
                kept = fetched.kept,
                missing = fetched.missing,
                retries = fetched.retries,
                "fetched"
            );
            if !common.quiet {
                eprintln!(
                    "{what}: {} files downloaded ({}), {} already in the cache, {} requests retried",
                    fetched.new,
                    bytes(fetched.bytes),
                    fetched.kept,
                    fetched.retries
                );
            }
        }
        done.push(fetched);
    }
    args.pack.check_notes(&shown)?;
    if let Some(path) = &args.heights {
        heights(args, &done[0], path, &shown, common)?;
    } else if let Some(output) = &args.output {
        let manifest = build(&build_options(args, &done, output)?, &shown)?;
        report_built(output, &manifest, begun, common);
    }
    args.pack.check_notes(&shown)
}

fn options(args: &FetchArgs) -> anyhow::Result<FetchOptions> {
    let beside = args.output.as_ref().or(args.heights.as_ref()).map(|path| {
        let mut name = path.file_name().unwrap_or_default().to_os_string();
        name.push(".cache");
        path.with_file_name(name)
    });
    let cache = match (args.cache.clone().or(beside), args.dry_run) {
        (Some(cache), _) => cache,
        // Nothing is written there.
        (None, true) => PathBuf::new(),
        (None, false) => bail!("--cache: give the folder for downloads"),
    };
    Ok(FetchOptions {
        cache,
        fineness: args
            .level
            .map_or(Fineness::Width(args.width), Fineness::Level),
        region: args.region,
        ground_width: args.ground_width,
        feather_deg: args.feather,
        under: args.under.clone(),
        connections: args.connections,
        requests_per_s: args.rate,
        retries: args.retries,
        allow_missing: args.allow_missing,
        client: ClientOptions {
            timeout: Duration::from_secs(args.timeout),
            authorities: args.ca.clone(),
            redirect_hosts: args.redirect_host.clone(),
        },
    })
}

/// Options for a pack of the fetched maps.
fn build_options(
    args: &FetchArgs,
    done: &[LayerDone],
    output: &Path,
) -> anyhow::Result<BuildOptions> {
    let of = |layer| {
        done.iter()
            .find(|done| done.layer == layer)
            .map(|done| done.mosaic.clone())
    };
    let day = of(SourceLayer::Day).context("a pack needs a day map")?;
    Ok(BuildOptions {
        clouds: of(SourceLayer::Clouds),
        relief: of(SourceLayer::Elevation).map(|path| Relief::Elevation {
            path,
            offset_m: Some(0.0),
            exaggeration: args.exaggeration.unwrap_or(SLOPE_EXAGGERATION),
        }),
        night_lights: of(SourceLayer::NightLights),
        water: of(SourceLayer::Water),
        ..args.pack.build_options(&day, output)
    })
}

fn heights(
    args: &FetchArgs,
    done: &LayerDone,
    path: &Path,
    shown: &Shown,
    common: &Common,
) -> anyhow::Result<()> {
    let limits = SourceLimits {
        buffer_bytes: args.pack.memory_bytes() / 2,
    };
    let region = args.region.unwrap_or(Bounds::EARTH);
    let (columns, rows) = write_heights(&done.mosaic, &region, path, limits, shown)?;
    if !common.quiet {
        eprintln!("{}: {columns} x {rows} elevations", path.display());
    }
    Ok(())
}

fn dry_run(layers: &[Layer], options: &FetchOptions) -> anyhow::Result<()> {
    let mut text = String::new();
    let (mut files, mut total) = (0, 0);
    for layer in layers {
        for estimate in layer.estimate(options)? {
            let size = estimate
                .bytes
                .map_or("of unknown size".to_string(), |count| {
                    format!("about {}", bytes(count))
                });
            // Writing to a string cannot fail.
            let _ = writeln!(
                text,
                "{:<13} {}: {} files, {size}\n              {}",
                layer.layer.name(),
                estimate.what,
                estimate.files,
                estimate.example
            );
            files += estimate.files;
            total += estimate.bytes.unwrap_or(0);
        }
    }
    let _ = writeln!(
        text,
        "{files} files, about {} where known; nothing was downloaded",
        bytes(total)
    );
    print(&text)
}

fn list() -> anyhow::Result<()> {
    let mut text = String::new();
    for name in source_names() {
        let source = find_source(name)?;
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{name}  ({})\n  {}",
            source.layer.name(),
            source.title
        );
        for line in &source.attribution {
            let _ = writeln!(text, "  attribution: {line}");
        }
        let _ = writeln!(
            text,
            "  terms: {}\n  source: {}\n",
            source.licence, source.citation
        );
    }
    print(&text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn regions_and_rates_are_read() {
        assert!(
            parse_region("-10, -5,10,5").is_ok_and(|b| b.west_deg == -10.0 && b.north_deg == 5.0)
        );
        for bad in ["", "1,2,3", "1,2,3,4,5", "a,b,c,d", "0,10,5,10"] {
            assert!(parse_region(bad).is_err(), "{bad}");
        }
        assert_eq!(parse_rate("2.5"), Ok(2.5));
        for bad in ["0", "-1", "nan", "x", "2000"] {
            assert!(parse_rate(bad).is_err(), "{bad}");
        }
    }
}
