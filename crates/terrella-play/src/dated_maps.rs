//! Maps that change with the date: loaded in advance by a thread, and blended on the GPU.
//!
//! ```text
//! files ─► MapLoader, a thread: decoded, uploaded ─► DatedMapsLayer: which two, how much of each ─► MapFade ─► Earth::set_map
//! ```
//!
//! An Earth starts with the blend of maps for its first epoch (`at_once`). From then on a frame uses the maps that have arrived, and the previous
//! ones until then.

mod at_once;
mod loader;

use super::error::PlayError;
use super::flight::Flight;
use crate::scene::{BetweenMaps, DatedMaps};
use at_once::MapFiles;
pub(super) use at_once::set_dated_layers;
use loader::{Loaded, MapLoader};
use std::collections::BTreeMap;
use std::time::{Duration, Instant};
use terrella::frames::Epoch;
use terrella::{Earth, EarthError};
use terrella::{GpuContext, GpuMap, MapFade};

/// How often what two maps lend to the light of the air is set again while one passes into the other.
const AIR_STEPS: f64 = 16.0;

/// The maps of a scene that change with the date.
pub struct DatedMapsLayer {
    layers: Vec<MapPlayer>,
}

impl DatedMapsLayer {
    /// The dated maps of a flight's scene; `None` if no map changes. Starts the thread of each.
    ///
    /// # Errors
    /// A thread that cannot be started, or an error of the device.
    pub fn of(flight: &Flight, gpu: &GpuContext) -> Result<Option<Self>, PlayError> {
        let scene = flight.scene();
        let tables = scene.earth.dated_maps.iter();
        let layers = tables.map(|maps| MapPlayer::new(scene, maps, gpu));
        let layers = layers.collect::<Result<Vec<_>, PlayError>>()?;
        Ok((!layers.is_empty()).then_some(Self { layers }))
    }

    /// Sets the maps of an epoch on the Earth, as far as they have arrived; waits for them at most this long. Call it before [`Earth::prepare`].
    pub fn prepare(&mut self, gpu: &GpuContext, earth: &mut Earth, epoch: Epoch, wait: Duration) {
        let deadline = Instant::now() + wait;
        for layer in &mut self.layers {
            layer.prepare(gpu, earth, epoch, deadline);
        }
    }

    /// Whether maps of the last epoch have not arrived yet.
    #[cfg(feature = "window")]
    pub fn is_loading(&self) -> bool {
        self.layers.iter().any(|layer| layer.is_loading)
    }
}

/// One layer's maps.
struct MapPlayer {
    maps: DatedMaps,
    loader: MapLoader,
    /// `None` for a map that cannot be read, which was reported once.
    held: BTreeMap<usize, Option<GpuMap>>,
    /// Made when two maps first pass into each other, of their size.
    fade: Option<MapFade>,
    shown: Option<BetweenMaps>,
    /// Of the light of the air, in steps, with the maps that it is between.
    air_step: Option<(usize, usize, u32)>,
    last: Option<Epoch>,
    is_loading: bool,
    has_failed: bool,
}

impl MapPlayer {
    fn new(
        scene: &crate::scene::Scene,
        maps: &DatedMaps,
        gpu: &GpuContext,
    ) -> Result<Self, PlayError> {
        if scene.earth.strict {
            let places = maps.within(scene.time.start, scene.time.end());
            MapFiles::of(scene, maps)?.check(&places)?;
        }
        Ok(Self {
            loader: MapLoader::new(scene, maps, gpu)?,
            maps: maps.clone(),
            held: BTreeMap::new(),
            fade: None,
            shown: None,
            air_step: None,
            last: None,
            is_loading: false,
            has_failed: false,
        })
    }

    fn prepare(&mut self, gpu: &GpuContext, earth: &mut Earth, epoch: Epoch, deadline: Instant) {
        let at = self.maps.at(epoch);
        let is_back = self.last.is_some_and(|last| epoch < last);
        self.last = Some(epoch);
        let next = self
            .maps
            .next(if is_back { at.from } else { at.to }, is_back);
        let mut wanted = vec![at.from, at.to];
        wanted.extend(next);
        wanted.dedup();
        self.held
            .retain(|place, map| map.is_none() || wanted.contains(place));
        let held = &self.held;
        let missing = wanted.iter().filter(|place| !held.contains_key(place));
        self.loader.request(missing.copied().collect());
        let needed = [at.from, at.to];
        loop {
            let has_all = needed.iter().all(|place| self.held.contains_key(place));
            let left = match has_all {
                true => Duration::ZERO,
                false => deadline.saturating_duration_since(Instant::now()),
            };
            match self.loader.take(left) {
                Some(Loaded { place, map }) => self.keep(place, map, &wanted),
                None if has_all || left.is_zero() => break,
                None => {}
            }
        }
        self.is_loading = !needed.iter().all(|place| self.held.contains_key(place));
        if self.is_loading {
            return;
        }
        if let Err(error) = self.show(gpu, earth, at)
            && !std::mem::replace(&mut self.has_failed, true)
        {
            tracing::warn!("{} stay as they are: {error}", self.maps.layer.key());
        }
    }

    fn keep(&mut self, place: usize, map: Result<GpuMap, String>, wanted: &[usize]) {
        let map = match map {
            Ok(map) => Some(map),
            Err(problem) => {
                tracing::warn!("{problem}; the previous map stays until the date of the next one");
                None
            }
        };
        if wanted.contains(&place) {
            self.held.insert(place, map);
        }
    }

    fn show(
        &mut self,
        gpu: &GpuContext,
        earth: &mut Earth,
        at: BetweenMaps,
    ) -> Result<(), EarthError> {
        if self.shown == Some(at) {
            return Ok(());
        }
        let map = |place: usize| self.held.get(&place).and_then(Option::as_ref);
        let (from, to) = match (map(at.from), map(at.to)) {
            (Some(from), Some(to)) => (from, to),
            (Some(one), None) | (None, Some(one)) => (one, one),
            (None, None) => return Ok(()),
        };
        self.shown = Some(at);
        if at.weight <= 0.0 || std::ptr::eq(from, to) {
            self.air_step = None;
            return earth.set_map(&gpu.queue, from);
        }
        let fade = match self.fade.take() {
            Some(fade) => fade,
            None => MapFade::new(&gpu.device, from.layer(), from.size())?,
        };
        let fade = self.fade.insert(fade);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let weight = at.weight as f32;
        fade.draw(&gpu.device, &gpu.queue, &mut encoder, (from, to), weight);
        gpu.queue.submit([encoder.finish()]);
        let step = (at.from, at.to, (AIR_STEPS * at.weight) as u32);
        if self.air_step != Some(step) {
            self.air_step = Some(step);
            earth.set_map(&gpu.queue, &fade.map_between((from, to), weight))?;
        }
        Ok(())
    }
}
