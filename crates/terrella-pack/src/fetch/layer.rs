//! One map of a pack from its sources: what is needed, fetched into the cache, and described as a mosaic.

use super::cache::{Shelf, write_whole};
use super::download::{Fetched, Job};
use super::error::FetchError;
use super::http::{Client, ClientOptions};
use super::pace::Pace;
use super::plan::{Fineness, TilePlan};
use super::source::{Files, MapSource, SourceLayer, Tiles};
use super::token::Token;
use crate::BuildProgress;
use crate::mosaic::{Bounds, Crs, MOSAIC_FILE};
use std::fmt::Write;
use std::path::PathBuf;
use terrella_imagery::pack::quoted;

/// How maps are fetched.
#[derive(Clone, Debug)]
pub struct FetchOptions {
    /// Folder of fetched files.
    pub cache: PathBuf,
    /// How fine.
    pub fineness: Fineness,
    /// Which part of the Earth; all of it without.
    pub region: Option<Bounds>,
    /// With a region: least width in texels of the map of the whole Earth beneath it; 0 for none.
    pub ground_width: u32,
    /// With a region: width of the blend at its edges into the map beneath, degrees.
    pub feather_deg: f64,
    /// A map of the whole Earth below all that is fetched.
    pub under: Option<PathBuf>,
    /// Number of simultaneous requests; by default the source's.
    pub connections: Option<u32>,
    /// Requests begun in a second; by default the source's own.
    pub requests_per_s: Option<f64>,
    /// Number of times that a file is requested again.
    pub retries: u32,
    /// Goes on without files that cannot be fetched.
    pub allow_missing: bool,
    /// Options of requests.
    pub client: ClientOptions,
}

/// A source at a time.
#[derive(Clone, Debug)]
pub struct Request {
    /// The source.
    pub source: MapSource,
    /// The time, as the source names it.
    pub time: Option<String>,
}

impl Request {
    /// From `NAME`, `NAME@TIME` or the path of a description, with or without a time.
    ///
    /// # Errors
    /// [`FetchError`] for sources and times that there are not.
    pub fn find(text: &str) -> Result<Self, FetchError> {
        let (name, time) = match text.rsplit_once('@') {
            Some((name, time)) => (name, Some(time)),
            None => (text, None),
        };
        let source = super::named::find_source(name)?;
        let time = source.time(time)?;
        Ok(Self { source, time })
    }
}

/// All sources of one map.
#[derive(Clone, Debug)]
pub struct Layer {
    /// Which map.
    pub layer: SourceLayer,
    /// Its sources, the lowest first.
    pub requests: Vec<Request>,
}

/// Cost of a fetch.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// The source's name, time and level, for people.
    pub what: String,
    /// Files that are needed.
    pub files: u64,
    /// Their approximate size in bytes, if the source gives it.
    pub bytes: Option<u64>,
    /// An address, as an example.
    pub example: String,
}

/// A map that has been fetched.
#[derive(Clone, Debug)]
pub struct LayerDone {
    /// Which map.
    pub layer: SourceLayer,
    /// The mosaic, for `pack build`.
    pub mosaic: PathBuf,
    /// The fetched layers.
    pub fetched: Vec<(String, Fetched)>,
}

/// Content fetched from one source: tiles of some levels, or files.
enum Work<'a> {
    Tiles(&'a Tiles, Vec<(TilePlan, bool)>),
    Files(&'a Files),
}

impl Layer {
    /// Puts requests together by the maps that they are for, in the order in which maps are first named.
    pub fn group(requests: Vec<Request>) -> Vec<Self> {
        let mut layers: Vec<Self> = Vec::new();
        for request in requests {
            match layers
                .iter_mut()
                .find(|layer| layer.layer == request.source.layer)
            {
                Some(layer) => layer.requests.push(request),
                None => layers.push(Self {
                    layer: request.source.layer,
                    requests: vec![request],
                }),
            }
        }
        layers
    }

    /// Cost of fetching it, without any request.
    ///
    /// # Errors
    /// [`FetchError::Option`] for invalid levels and regions.
    pub fn estimate(&self, options: &FetchOptions) -> Result<Vec<Estimate>, FetchError> {
        let mut estimates = Vec::new();
        for request in &self.requests {
            match work(&request.source, options)? {
                Work::Files(files) => estimates.push(Estimate {
                    what: format!("{}, files", request.source.name),
                    files: files.file.len() as u64,
                    bytes: None,
                    example: files.file[0].url.clone(),
                }),
                Work::Tiles(tiles, plans) => {
                    estimates.extend(plans.iter().map(|(plan, _)| Estimate {
                        what: what(request, plan.level),
                        files: plan.count(),
                        bytes: tiles.usual_tile_bytes.map(|bytes| bytes * plan.count()),
                        example: plan.tiles().next().map_or(String::new(), |(column, row)| {
                            tiles
                                .wanted(request.time.as_deref(), plan.level, column, row)
                                .url
                        }),
                    }))
                }
            }
        }
        Ok(estimates)
    }

    /// Fetches what is not in the cache, and describes it there as a mosaic.
    ///
    /// # Errors
    /// [`FetchError`]; what has been fetched stays for the next run.
    pub fn fetch(
        &self,
        options: &FetchOptions,
        progress: &dyn BuildProgress,
    ) -> Result<LayerDone, FetchError> {
        let mut done = Vec::new();
        let mut text = self.head(options)?;
        for request in &self.requests {
            let source = &request.source;
            let token = source.token_env.as_deref().map(Token::from_environment);
            let client = Client::new(options.client.clone(), token.transpose()?)?;
            let gentle = source.gentleness;
            let pace = Pace::new(options.requests_per_s.unwrap_or(gentle.requests_per_s));
            let connections = options.connections.unwrap_or(gentle.connections);
            match work(source, options)? {
                Work::Tiles(tiles, plans) => {
                    if tiles.crs == Crs::WebMercator && options.under.is_none() {
                        progress.note(&format!(
                            "{} ends at {:.2} degrees north and south: give a map below it with --under to fill the poles",
                            source.name,
                            tiles.end_deg()
                        ));
                    }
                    for (plan, is_region) in plans {
                        let folder = source.folder(request.time.as_deref(), Some(plan.level));
                        let shelf =
                            Shelf::open(&options.cache.join(&folder), &address_of(request, tiles))?;
                        let job = Job {
                            shelf: &shelf,
                            media: tiles.media,
                            side: Some(tiles.tile_size),
                            most_bytes: tiles.max_tile_bytes,
                            may_be_missing: tiles.may_be_missing,
                            placeholders: &tiles.placeholders,
                            connections,
                            retries: options.retries,
                            pace: &pace,
                            client: &client,
                            progress,
                        };
                        let wanted: Vec<_> = plan
                            .tiles()
                            .map(|(column, row)| {
                                tiles.wanted(request.time.as_deref(), plan.level, column, row)
                            })
                            .collect();
                        let what = what(request, plan.level);
                        done.push((what.clone(), fetch_all(&job, &what, &wanted, options)?));
                        push_tiles(
                            &mut text,
                            tiles,
                            &plan,
                            &folder,
                            is_region.then_some(options.feather_deg),
                        );
                    }
                }
                Work::Files(files) => {
                    let folder = source.folder(request.time.as_deref(), None);
                    let shelf = Shelf::open(&options.cache.join(&folder), &list_address(files))?;
                    let job = Job {
                        shelf: &shelf,
                        media: files.media,
                        side: None,
                        most_bytes: files.max_file_bytes,
                        may_be_missing: false,
                        placeholders: &[],
                        connections,
                        retries: options.retries,
                        pace: &pace,
                        client: &client,
                        progress,
                    };
                    let wanted = files.wanted();
                    let what = format!("{}, files", source.name);
                    done.push((what.clone(), fetch_all(&job, &what, &wanted, options)?));
                    push_files(&mut text, files, &folder, |name| shelf.path(name).is_file());
                }
            }
        }
        let mosaic = options.cache.join(self.layer.name()).join(MOSAIC_FILE);
        write_whole(&mosaic, text.as_bytes())?;
        Ok(LayerDone {
            layer: self.layer,
            mosaic,
            fetched: done,
        })
    }

    /// Head of the mosaic, and the layer beneath all fetched content.
    fn head(&self, options: &FetchOptions) -> Result<String, FetchError> {
        let mut text = String::from(
            "# Written by `terrella pack fetch`; give this folder to `terrella pack build`.\n",
        );
        let mut lines: Vec<&String> = Vec::new();
        for line in self
            .requests
            .iter()
            .flat_map(|request| &request.source.attribution)
        {
            if !lines.contains(&line) {
                lines.push(line);
            }
        }
        let names: Vec<_> = self
            .requests
            .iter()
            .map(|request| {
                let time = request
                    .time
                    .as_ref()
                    .map_or(String::new(), |time| format!(" {time}"));
                format!("{}{time}", request.source.name)
            })
            .collect();
        let _ = writeln!(text, "name = {}", quoted(&names.join(", ")));
        text.push_str("attribution = [\n");
        for line in lines {
            let _ = writeln!(text, "    {},", quoted(line));
        }
        text.push_str("]\n");
        if let Some(under) = &options.under {
            let whole = std::path::absolute(under).map_err(|error| FetchError::Option {
                option: "--under",
                cause: format!("{}: {error}", under.display()),
            })?;
            let _ = write!(
                text,
                "\n[[part]]\nfile = {}\nbounds_deg = [-180, -90, 180, 90]\n",
                quoted(&whole.to_string_lossy())
            );
        }
        Ok(text)
    }
}

/// Content requested from a source: with a region, the whole Earth coarsely and the region finely.
fn work<'a>(source: &'a MapSource, options: &FetchOptions) -> Result<Work<'a>, FetchError> {
    match (&source.tiles, &source.files) {
        (Some(tiles), _) => {
            let mut plans = Vec::new();
            let region = options.region.unwrap_or(Bounds::EARTH);
            let fine = tiles.plan(options.fineness, &region)?;
            if options.region.is_some() && options.ground_width > 0 {
                let ground = tiles.plan(Fineness::Width(options.ground_width), &Bounds::EARTH)?;
                if ground.level < fine.level {
                    plans.push((ground, false));
                }
            }
            plans.push((fine, options.region.is_some()));
            Ok(Work::Tiles(tiles, plans))
        }
        (None, Some(files)) => Ok(Work::Files(files)),
        // The reader of descriptions sees to one of them.
        (None, None) => Err(FetchError::Description {
            path: source.name.clone().into(),
            cause: "has neither tiles nor files".to_string(),
        }),
    }
}

fn what(request: &Request, level: u32) -> String {
    let time = request
        .time
        .as_ref()
        .map_or(String::new(), |time| format!(" {time}"));
    format!("{}{time}, level {level}", request.source.name)
}

/// Identity of a folder's files: different descriptions must not share a folder.
fn address_of(request: &Request, tiles: &Tiles) -> String {
    let time = request.time.as_deref().unwrap_or("always");
    format!(
        "{} {time} {} {}",
        tiles.url,
        tiles.media.name(),
        tiles.tile_size
    )
}

fn list_address(files: &Files) -> String {
    let mut hasher = blake3::Hasher::new();
    for file in &files.file {
        hasher.update(format!("{} {}\n", file.url, file.save_as).as_bytes());
    }
    format!("list {}", hasher.finalize().to_hex())
}

/// Fetches files; without some of them only where that is allowed.
fn fetch_all(
    job: &Job<'_>,
    what: &str,
    wanted: &[super::plan::Wanted],
    options: &FetchOptions,
) -> Result<Fetched, FetchError> {
    job.progress.begin(what, Some(wanted.len() as u64));
    let done = job.run(wanted);
    job.progress.end();
    let done = done?;
    if let Some((url, cause)) = &done.first_failure {
        if !options.allow_missing {
            return Err(FetchError::Incomplete {
                failed: done.failed,
                total: wanted.len() as u64,
                url: url.clone(),
                cause: cause.clone(),
            });
        }
        job.progress.note(&format!(
            "{what}: {} of {} files are left out, the first {url}: {cause}",
            done.failed,
            wanted.len()
        ));
    }
    if let Some(repeated) = job.shelf.most_repeated(wanted) {
        job.progress.note(&format!(
            "{what}: {} of {} tiles are one and the same picture with something in it, as {}; if the server sends it where it has nothing, \
             give `placeholders = [\"{}\"]` under [tiles] of the source's description",
            repeated.count,
            wanted.len(),
            repeated.path.display(),
            repeated.blake3
        ));
    }
    if done.missing > 0 {
        job.progress.note(&format!(
            "{what}: the server has nothing for {} of {} tiles",
            done.missing,
            wanted.len()
        ));
    }
    Ok(done)
}

fn push_tiles(
    text: &mut String,
    tiles: &Tiles,
    plan: &TilePlan,
    folder: &str,
    feather_deg: Option<f64>,
) {
    for (columns, rows) in &plan.blocks {
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "\n[[part]]\ntiles = \"../{folder}/{{row}}/{{column}}.{}\"\ncrs = \"{}\"\ntile_size = {}\ntile_deg = {:?}\n\
             columns = [{}, {}]\nrows = [{}, {}]\n",
            tiles.media.ending(),
            tiles.crs.name(),
            tiles.tile_size,
            plan.tile_deg,
            columns.start,
            columns.end,
            rows.start,
            rows.end
        );
        if let Some(feather_deg) = feather_deg.filter(|deg| *deg > 0.0) {
            let _ = writeln!(text, "feather_deg = {feather_deg:?}");
        }
        if let Some(no_data) = &tiles.no_data {
            let _ = writeln!(text, "no_data = {no_data:?}");
        }
        if tiles.encoding.is_some() {
            text.push_str("encoding = \"terrarium\"\n");
        }
    }
}

fn push_files(text: &mut String, files: &Files, folder: &str, is_there: impl Fn(&str) -> bool) {
    for file in files.file.iter().filter(|file| is_there(&file.save_as)) {
        let _ = write!(
            text,
            "\n[[part]]\nfile = \"../{folder}/{}\"\n",
            file.save_as
        );
        if let Some(bounds_deg) = file.bounds_deg {
            let _ = writeln!(text, "bounds_deg = {bounds_deg:?}");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::named::find_source;
    use super::*;
    use crate::mosaic::Description;
    use std::path::Path;
    use std::time::Duration;

    fn options() -> FetchOptions {
        FetchOptions {
            cache: PathBuf::from("cache"),
            fineness: Fineness::Width(2048),
            region: None,
            ground_width: 2048,
            feather_deg: 0.5,
            under: None,
            connections: None,
            requests_per_s: None,
            retries: 0,
            allow_missing: false,
            client: ClientOptions {
                timeout: Duration::from_secs(1),
                authorities: None,
                redirect_hosts: Vec::new(),
            },
        }
    }

    #[test]
    fn a_region_lies_on_coarser_ground() {
        let request = Request::find("blue_marble@2004-06").expect("a source");
        let layers = Layer::group(vec![request.clone(), request]);
        assert_eq!((layers.len(), layers[0].requests.len()), (1, 2));
        let mut options = options();
        options.region = Some(Bounds::new([5.0, 44.0, 12.0, 48.0]).expect("good"));
        options.fineness = Fineness::Level(6);
        let estimates = layers[0].estimate(&options).expect("good");
        assert_eq!(estimates.len(), 4);
        assert_eq!(estimates[0].what, "blue_marble 2004-06-01, level 2");
        assert_eq!((estimates[0].files, estimates[1].files), (15, 4));
        assert_eq!(estimates[1].bytes, Some(240_000));
        options.ground_width = 0;
        assert_eq!(layers[0].estimate(&options).expect("good").len(), 2);
    }

    #[test]
    fn what_is_written_is_a_mosaic() {
        let source = find_source("terrarium").expect("a source");
        let tiles = source.tiles.clone().expect("tiles");
        let layer = Layer {
            layer: source.layer,
            requests: vec![Request { source, time: None }],
        };
        let mut options = options();
        options.under = Some(PathBuf::from("a \"b\".png"));
        let mut text = layer.head(&options).expect("good");
        let region = Bounds::new([170.0, -10.0, -170.0, 10.0]).expect("good");
        let plan = tiles.plan(Fineness::Level(3), &region).expect("good");
        push_tiles(&mut text, &tiles, &plan, "terrarium/always/3", Some(0.5));
        let read =
            Description::from_toml(&text, Path::new("cache/elevation/mosaic.toml")).expect(&text);
        assert_eq!(read.parts.len(), 3);
        assert_eq!(read.attribution.len(), 12);
        assert_eq!(read.parts[2].feather_deg, 0.5);
        assert!(read.parts[2].encoding.is_some());
    }
}
