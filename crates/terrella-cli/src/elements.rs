//! `terrella elements`: elements of satellites from their public sources.

use super::Common;
use anyhow::{Context, bail};
use clap::{Args, Subcommand};
use std::path::{Path, PathBuf};
use std::time::Duration;
use terrella_orbit::{Catalogue, Feed, Sgp4Feed};
use terrella_pack::fetch::{
    ClientOptions, ElementMedia, ElementQuery, ElementSource, FetchedElements,
};
use terrella_play::PendingFile;

/// Arguments of `terrella elements`.
#[derive(Debug, Args)]
pub struct ElementsArgs {
    #[command(subcommand)]
    command: ElementsCommand,
}

#[derive(Debug, Subcommand)]
enum ElementsCommand {
    /// Download elements from CelesTrak or another server into a file that scenes, `play` and `orbit` read
    ///
    /// Elements that were downloaded less than two hours ago are taken from the cache: CelesTrak asks that the same data be downloaded once
    /// in that time at most. Nothing is downloaded unless this command is run.
    Fetch(FetchArgs),
}

/// Arguments of `terrella elements fetch`.
#[derive(Debug, Args)]
struct FetchArgs {
    /// Catalogue numbers, for example 25544 (ISS)
    #[arg(required_unless_present = "group", value_name = "NUMBER", value_parser = clap::value_parser!(u32).range(1..=999_999_999))]
    numbers: Vec<u32>,
    /// All satellites of a group of the source, for example stations, gps-ops, weather
    #[arg(long, value_name = "NAME", conflicts_with = "numbers")]
    group: Option<String>,
    /// File to write [default: the number or the group, with .tle or .json added]
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// The source: celestrak, or a TOML file that describes a server (docs/orbits.md)
    #[arg(long, value_name = "SOURCE", default_value = "celestrak")]
    source: String,
    /// Folder for downloads [default: terrella/elements in the user's cache folder]
    #[arg(long, value_name = "DIR")]
    cache: Option<PathBuf>,
    /// Timeout of a request, seconds
    #[arg(long, value_name = "SECONDS", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..=3600))]
    timeout: u64,
    /// Certificates (PEM) of authorities to trust instead of the default ones
    #[arg(long, value_name = "FILE")]
    ca: Option<PathBuf>,
}

/// Runs one of the commands for elements.
pub fn run(args: &ElementsArgs, common: &Common) -> anyhow::Result<()> {
    match &args.command {
        ElementsCommand::Fetch(args) => fetch(args, common),
    }
}

fn fetch(args: &FetchArgs, common: &Common) -> anyhow::Result<()> {
    let source = ElementSource::find(&args.source)?;
    let ending = source.media.ending();
    let queries: Vec<_> = match &args.group {
        Some(group) => vec![ElementQuery::Group(group.clone())],
        None => args
            .numbers
            .iter()
            .copied()
            .map(ElementQuery::Satellite)
            .collect(),
    };
    if source.media == ElementMedia::Json && queries.len() > 1 {
        bail!(
            "this source answers with JSON, one file for each satellite; give one catalogue number"
        );
    }
    let output = match (&args.output, queries.as_slice()) {
        (Some(output), _) => output.clone(),
        (None, [ElementQuery::Satellite(number)]) => PathBuf::from(format!("{number}.{ending}")),
        (None, [ElementQuery::Group(group)]) => PathBuf::from(format!("{group}.{ending}")),
        (None, _) => bail!("--output: give the file for the elements of several satellites"),
    };
    // Create the file before any request, so that a file that cannot be written fails at once.
    let file = PendingFile::create(&output, "elements of this source", ending)?;
    let options = ClientOptions {
        timeout: Duration::from_secs(args.timeout),
        authorities: args.ca.clone(),
        redirect_hosts: Vec::new(),
    };
    let fetched = source.fetch(&queries, &cache(args)?, options, &check)?;
    let texts: Vec<_> = fetched.iter().map(|one| one.text.trim_end()).collect();
    file.write_whole((texts.join("\n") + "\n").as_bytes())?;
    if !common.quiet {
        for one in &fetched {
            eprintln!("{}", said(one, &source));
        }
        let catalogue = Catalogue::from_file(&output, false)?;
        eprintln!("{}: {}", output.display(), satellites(&catalogue));
    }
    Ok(())
}

/// The folder for downloads.
fn cache(args: &FetchArgs) -> anyhow::Result<PathBuf> {
    if let Some(cache) = &args.cache {
        return Ok(cache.clone());
    }
    let folder = |name: &str| std::env::var_os(name).map(PathBuf::from);
    let folder = |name| folder(name).filter(|path| path.is_absolute());
    let user = folder("XDG_CACHE_HOME")
        .or_else(|| folder("LOCALAPPDATA"))
        .or_else(|| folder("HOME").map(|home| home.join(".cache")));
    let user =
        user.context("--cache: give the folder for downloads; this user has no cache folder")?;
    Ok(user.join("terrella").join("elements"))
}

/// Checks that a response has the requested elements: servers that have none respond with a sentence.
fn check(query: &ElementQuery, text: &str) -> Result<(), String> {
    let read = Catalogue::from_text(text, Path::new("the answer"), false);
    let catalogue = read.map_err(|error| {
        let line = text.lines().next().unwrap_or_default();
        let line: String = line.chars().take(80).filter(|c| !c.is_control()).collect();
        format!("it answers {line:?}, which has no elements ({error})")
    })?;
    match query {
        ElementQuery::Group(_) if !catalogue.feeds.is_empty() => Ok(()),
        ElementQuery::Group(_) => Err("the answer has no elements".to_string()),
        ElementQuery::Satellite(number) => {
            let mut numbers = catalogue.feeds.iter().map(Sgp4Feed::catalogue_number);
            match numbers.any(|found| found == u64::from(*number)) {
                true => Ok(()),
                false => Err(format!("the answer has no elements of {number}")),
            }
        }
    }
}

fn said(fetched: &FetchedElements, source: &ElementSource) -> String {
    let minutes = |time: Duration| time.as_secs() / 60;
    match fetched.age {
        None => format!("downloaded from {}", fetched.url),
        Some(age) => format!(
            "downloaded {} min ago from {}; it is asked again after {} min",
            minutes(age),
            fetched.url,
            minutes(source.min_age())
        ),
    }
}

/// The satellite's name, or the number of satellites.
fn satellites(catalogue: &Catalogue) -> String {
    match catalogue.feeds.as_slice() {
        [one] => one.name().to_owned(),
        all => format!("{} satellites", all.len()),
    }
}
