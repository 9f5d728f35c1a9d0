//! Drawing, timing and comparing.

use super::change::{Change, Plan};
use super::numbers::Numbers;
use super::rows::Row;
use super::{Folder, ReportError, ReportRequest, Study};
use crate::frames::Ellipsoid;
use crate::gpu::GpuContext;
use crate::measure::errors::{
    Difference, Geolocation, PlacesEarth, Silhouette, geolocation, silhouette,
};
use crate::measure::reference::{
    FullMaps, Reference, ReferenceOptions, ReferencePicture, StillError, whole_maps,
};
use crate::measure::{GroundPath, Rig, Sample, Spread};
use crate::play::{Flight, PlayError, Progress};
use crate::{Atmosphere, EarthOptions, EyeView, Shading, Sky, Visibility};
use image::RgbaImage;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Heights that can be looked from, kilometres.
const HEIGHTS_KM: std::ops::RangeInclusive<f64> = 1.0..=1e6;
/// Places on the path that are tried for a Sun of [`SUN_ELEVATION_DEG`].
const PARTS: usize = 360;
/// Most bytes of maps put together of a pack's tiles, for each of at most three true Earths.
const MAP_BYTES: u64 = 256 << 20;
/// How high the Sun stands over the point below the eye: day and dusk are both in sight from far.
const SUN_ELEVATION_DEG: f64 = 40.0;

/// What a true picture depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct TrueKey {
    height_km: f64,
    shading: Shading,
    atmosphere: Atmosphere,
    size: (u32, u32),
}

/// What limb and places depend on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct GeometryKey {
    height_km: f64,
    subdivision: u32,
    visibility: Visibility,
    size: (u32, u32),
}

/// Measures everything that is wanted, or what is complete when it is stopped.
pub(super) fn run(
    flight: &Flight,
    request: &ReportRequest<'_>,
    folder: &Folder,
    progress: &dyn Progress,
    tell: &dyn Fn(&str),
) -> Result<Study, ReportError> {
    let wrong = |km: &&f64| !HEIGHTS_KM.contains(*km);
    if let Some(height_km) = request.heights_km.iter().flatten().find(wrong) {
        return Err(ReportError::Height(*height_km));
    }
    progress.begin("loading maps", None);
    let gpu = pollster::block_on(GpuContext::open(request.adapter)).map_err(PlayError::from)?;
    let options = flight.earth_options(gpu.bc_support())?;
    progress.end();
    let heights_km = request.heights_km.as_deref();
    let plan = Plan::new(&gpu, &options, request.size, request.quick, heights_km);
    let wanted = |change: &Change| plan.heights_of(change, request.size).len();
    let info = gpu.adapter.get_info();
    let mut study = Study {
        scene: match flight.scene().path.file_name() {
            Some(name) => name.to_string_lossy().into_owned(),
            None => flight.scene().path.display().to_string(),
        },
        adapter: format!("{} ({})", info.name, info.backend),
        size: request.size,
        subdivision: options.subdivision,
        repeats: request.repeats,
        samples: request.samples,
        heights_km: plan.heights_km.clone(),
        rows: Vec::new(),
        wanted: plan.changes.iter().map(wanted).sum(),
        unavailable: plan.unavailable.clone(),
        is_stopped: false,
        notes: Vec::new(),
        pictured_km: Vec::new(),
        numbers: Numbers::default(),
    };
    let mut bench = Bench {
        flight,
        request,
        gpu,
        options,
        progress,
        sky: flight.sky_at(flight.scene().time.start),
        references: Vec::new(),
        notes: Vec::new(),
        truths: Vec::new(),
        geometry: Vec::new(),
    };
    progress.begin("measurements", Some(study.wanted as u64));
    'changes: for change in &plan.changes {
        let begin = Instant::now();
        let size = change.size(request.size);
        let mut rig = match Rig::new(&bench.gpu, &change.apply(&bench.options), size) {
            // A size that does not fit is no reason to throw the others away.
            Err(error) if matches!(change, Change::Size(_)) => {
                study.wanted -= wanted(change);
                study
                    .notes
                    .push(format!("Size {}: {error}.", change.value()));
                continue;
            }
            opened => opened?,
        };
        let mut places: Option<(u32, PlacesEarth)> = None;
        for height_km in plan.heights_of(change, request.size) {
            if progress.cancelled() {
                break 'changes;
            }
            let begin_row = Instant::now();
            let Some(truth) = bench.truth(change, height_km)? else {
                break 'changes;
            };
            let true_s = begin_row.elapsed().as_secs_f64();
            let (row, picture, difference) =
                bench.measure(*change, height_km, &mut rig, &mut places, &truth)?;
            if *change == Change::Scene {
                write_pictures(folder, height_km, &picture, &truth, &difference)?;
                study.pictured_km.push(height_km);
            }
            study.rows.push(row);
            progress.step();
            if study.rows.len() == 1 {
                let row_s = begin.elapsed().as_secs_f64() - true_s;
                tell(&estimate(
                    &plan,
                    request.size,
                    &bench.options,
                    study.wanted,
                    row_s,
                    true_s,
                ));
            }
        }
        // What is complete stays, whatever comes.
        folder.write_tables(&study)?;
    }
    progress.end();
    study.notes.append(&mut bench.notes);
    if study.is_complete() {
        study.numbers = Numbers::gather(&bench.gpu, request.quick, request.repeats, progress)?;
    }
    study.is_stopped = progress.cancelled();
    Ok(study)
}

/// The files of a height's pictures, as the page names them.
pub(super) fn picture_name(height_km: f64, what: &str) -> String {
    format!("pictures/{height_km}km_{what}.png")
}

fn write_pictures(
    folder: &Folder,
    height_km: f64,
    picture: &RgbaImage,
    truth: &ReferencePicture,
    difference: &Difference,
) -> Result<(), ReportError> {
    let write = |what: &str, picture: &RgbaImage| {
        let file = folder.pending(&picture_name(height_km, what))?;
        file.write_png(picture)
    };
    write("drawn", picture)?;
    write("true", &truth.to_rgba8())?;
    let map = image::DynamicImage::from(difference.map.clone()).to_rgba8();
    Ok(write("flip", &map)?)
}

/// What the first measurement says about the time of all: `row_s` and `true_s` are what it took, without the true
/// picture and for that alone.
fn estimate(
    plan: &Plan,
    scene: (u32, u32),
    options: &EarthOptions,
    rows: usize,
    row_s: f64,
    true_s: f64,
) -> String {
    let mut keys = Vec::new();
    for change in &plan.changes {
        for height_km in plan.heights_of(change, scene) {
            let key = TrueKey::new(change, options, height_km, scene);
            if !keys.contains(&key) {
                keys.push(key);
            }
        }
    }
    let pixels = |(width, height): (u32, u32)| f64::from(width) * f64::from(height);
    let true_parts: f64 = keys
        .iter()
        .map(|key| pixels(key.size) / pixels(scene))
        .sum();
    let minutes = (true_parts * true_s + rows as f64 * row_s) / 60.0;
    format!(
        "{rows} measurements and {} true pictures, about {:.0} minutes at the first one's pace",
        keys.len(),
        minutes.max(1.0)
    )
}

impl TrueKey {
    /// Of a change of the scene's options and size.
    fn new(change: &Change, scene: &EarthOptions, height_km: f64, size: (u32, u32)) -> Self {
        let (mut shading, mut atmosphere) = (scene.shading, scene.atmosphere);
        match *change {
            Change::Shading(other) => shading = other,
            Change::Atmosphere(other) => atmosphere = other,
            _ => {}
        }
        Self {
            height_km,
            shading,
            atmosphere,
            size: change.size(size),
        }
    }
}

/// What measurements share.
struct Bench<'r> {
    flight: &'r Flight,
    request: &'r ReportRequest<'r>,
    gpu: GpuContext,
    /// The scene's.
    options: EarthOptions,
    progress: &'r dyn Progress,
    sky: Sky,
    references: Vec<Reference>,
    notes: Vec<String>,
    truths: Vec<(TrueKey, Arc<ReferencePicture>)>,
    geometry: Vec<(GeometryKey, (Silhouette, Geolocation))>,
}

impl Bench<'_> {
    fn figure(&self) -> Ellipsoid {
        self.options.figure.ellipsoid()
    }

    /// The scene's camera at a height, over a place of the inclined path where the Sun stands at
    /// [`SUN_ELEVATION_DEG`].
    fn view(&self, height_km: f64, size: (u32, u32)) -> EyeView {
        let (path, figure) = (GroundPath::Inclined, self.figure());
        let camera = &self.flight.scene().camera;
        let (height_m, fov_rad) = (height_km * 1e3, camera.fov_deg.to_radians());
        let aspect = f64::from(size.0) / f64::from(size.1);
        let wanted = SUN_ELEVATION_DEG.to_radians().sin();
        let off = |part: f64| {
            let at = path.motion(&figure, height_m, part).position_itrf_m;
            let place = figure.geodetic_from_itrf(at);
            let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
            (up.dot(self.sky.sun_itrf) - wanted).abs()
        };
        let parts = (0..PARTS).map(|n| n as f64 / PARTS as f64);
        let part = parts.min_by(|a, b| off(*a).total_cmp(&off(*b)));
        path.view(
            &figure,
            height_m,
            part.unwrap_or(0.0),
            camera.mode,
            fov_rad,
            aspect,
        )
    }

    /// The true picture, computed once; `None` if that was stopped.
    fn truth(
        &mut self,
        change: &Change,
        height_km: f64,
    ) -> Result<Option<Arc<ReferencePicture>>, ReportError> {
        let key = TrueKey::new(change, &self.options, height_km, self.request.size);
        if let Some((_, truth)) = self.truths.iter().find(|(known, _)| *known == key) {
            return Ok(Some(truth.clone()));
        }
        let wanted = ReferenceOptions {
            shading: key.shading,
            atmosphere: key.atmosphere,
            ..ReferenceOptions::of(&self.options, self.request.samples)
        };
        let known = self.references.iter().position(|r| *r.options() == wanted);
        let index = match known {
            Some(index) => index,
            None => {
                let Some(maps) = self.true_maps()? else {
                    return Ok(None);
                };
                self.references.push(Reference::with_maps(maps, wanted)?);
                self.references.len() - 1
            }
        };
        let view = self.view(height_km, key.size);
        let stop = || self.progress.cancelled();
        let reference = &self.references[index];
        let picture = reference.render_unless(&view, &self.sky, key.size, &|| (), &stop);
        Ok(picture.map(|picture| {
            let picture = Arc::new(picture);
            self.truths.push((key, picture.clone()));
            picture
        }))
    }

    /// The scene's maps, against which a setting with less is held too; `None` if reading them was stopped.
    fn true_maps(&mut self) -> Result<Option<FullMaps>, ReportError> {
        let Some(tiles) = &self.options.tiles else {
            return Ok(Some(FullMaps::copied(&self.options.layers)?));
        };
        let stop = || self.progress.cancelled();
        let found = match whole_maps(tiles.source.as_ref(), MAP_BYTES, &stop) {
            Err(StillError::Interrupted) => return Ok(None),
            found => found?,
        };
        if self.notes.is_empty() {
            let coarser = found.coarser.iter();
            self.notes.extend(coarser.map(|(layer, width)| {
                format!(
                    "The true pictures have the {layer} map {width} texels wide, less than the pack has: finer ones do not \
                     fit into {} MiB.",
                    MAP_BYTES >> 20
                )
            }));
        }
        Ok(Some(found.maps))
    }

    fn measure(
        &mut self,
        change: Change,
        height_km: f64,
        rig: &mut Rig,
        places: &mut Option<(u32, PlacesEarth)>,
        truth: &ReferencePicture,
    ) -> Result<(Row, RgbaImage, Difference), ReportError> {
        let size = change.size(self.request.size);
        let view = self.view(height_km, size);
        let wait: Duration = self.flight.scene().output.wait();
        let picture = rig.draw(&view, &self.sky, wait)?;
        let difference = Difference::between(&picture, truth);
        // The first fills caches.
        let cells = rig.sample(&view, &self.sky)?.stats.subdivision;
        let (silhouette, geolocation) = self.geometry(change, cells, height_km, places)?;
        let samples = (0..self.request.repeats.max(1))
            .map(|_| rig.sample(&view, &self.sky))
            .collect::<Result<Vec<Sample>, _>>()?;
        let spread =
            |of: fn(&Sample) -> f64| Spread::of(&samples.iter().map(of).collect::<Vec<_>>());
        let stats = samples
            .last()
            .map(|sample| sample.stats)
            .unwrap_or_default();
        let row = Row {
            change,
            height_km,
            frame_ms: spread(|sample| sample.frame_ms),
            floor_ms: spread(|sample| sample.floor_ms),
            floor_ratio: spread(|sample| sample.frame_ms / sample.floor_ms),
            prepare_ms: spread(|sample| sample.prepare_ms).median,
            flip_mean: difference.flip_mean,
            flip_p99: difference.flip_p99,
            rmse_linear: difference.rmse_linear,
            silhouette,
            geolocation,
            texels_per_px: stats.texels_per_pixel,
            triangles: stats.triangles,
        };
        Ok((row, picture, difference))
    }

    /// Limb and places, measured once for each mesh, rule, height and size. The mesh is that of the picture: strips of the
    /// limb are magnified, and would have a finer one.
    fn geometry(
        &mut self,
        change: Change,
        subdivision: u32,
        height_km: f64,
        places: &mut Option<(u32, PlacesEarth)>,
    ) -> Result<(Silhouette, Geolocation), ReportError> {
        // Maps play no part.
        let visibility = match change {
            Change::Visibility(rule) => rule,
            _ => self.options.visibility,
        };
        let size = change.size(self.request.size);
        let key = GeometryKey {
            height_km,
            subdivision,
            visibility,
            size,
        };
        if let Some((_, found)) = self.geometry.iter().find(|(known, _)| *known == key) {
            return Ok(*found);
        }
        let (view, figure) = (self.view(height_km, size), self.figure());
        let known = places.take().filter(|(cells, _)| *cells == subdivision);
        let known = match known {
            Some(known) => known,
            None => {
                let shape = self.options.figure;
                let earth = PlacesEarth::new(&self.gpu, shape, subdivision, visibility)?;
                (subdivision, earth)
            }
        };
        let (_, earth) = places.insert(known);
        let drawn = earth.draw(&view, size)?;
        let mut draw = |view: &EyeView, size: (u32, u32)| earth.draw(view, size);
        let limb = silhouette(&view, &figure, size, &mut draw)?;
        let found = (limb, geolocation(&drawn, &view, &figure));
        self.geometry.push((key, found));
        Ok(found)
    }
}
