//! Reads the maps of a layer on a thread, those first that are wanted first.

use super::super::error::PlayError;
use super::at_once::{MapFiles, map_layer};
use crate::scene::{DatedMaps, Scene};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;
use terrella::{GpuContext, GpuMap};

/// A map that has come, or what is wrong with its file.
pub(super) struct Loaded {
    pub place: usize,
    pub map: Result<GpuMap, String>,
}

/// The thread. It ends with this.
pub(super) struct MapLoader {
    wishes: Arc<(Mutex<Wishes>, Condvar)>,
    loaded: Receiver<Loaded>,
    thread: Option<JoinHandle<()>>,
}

#[derive(Default)]
struct Wishes {
    /// Places in the list, the most urgent first.
    places: Vec<usize>,
    /// Maps that the thread is reading, or has read and no one has taken yet.
    under_way: Vec<usize>,
    is_over: bool,
}

impl MapLoader {
    pub fn new(scene: &Scene, maps: &DatedMaps, gpu: &GpuContext) -> Result<Self, PlayError> {
        let files = MapFiles::of(scene, maps)?;
        let (layer, shading) = (map_layer(maps.layer), scene.earth.shading);
        let (device, queue) = (gpu.device.clone(), gpu.queue.clone());
        let wishes: Arc<(Mutex<Wishes>, Condvar)> = Arc::default();
        let (send, loaded) = channel();
        let of_thread = wishes.clone();
        let run = move || {
            while let Some(place) = next_wish(&of_thread) {
                let map = files.load(place).map_err(|error| error.to_string());
                let map = map.and_then(|map| {
                    GpuMap::upload(&device, &queue, layer, &map, shading)
                        .map_err(|error| error.to_string())
                });
                if send.send(Loaded { place, map }).is_err() {
                    return;
                }
            }
        };
        let thread = std::thread::Builder::new().name("terrella dated maps".to_owned());
        let thread = thread.spawn(run).map_err(PlayError::NoThread)?;
        Ok(Self {
            wishes,
            loaded,
            thread: Some(thread),
        })
    }

    /// Wants these from now on, the most urgent first, and no others.
    pub fn request(&self, places: Vec<usize>) {
        let (wishes, changed) = &*self.wishes;
        let mut wishes = wishes.lock().unwrap_or_else(PoisonError::into_inner);
        let under_way = &wishes.under_way;
        let places = places
            .into_iter()
            .filter(|place| !under_way.contains(place))
            .collect();
        wishes.places = places;
        changed.notify_one();
    }

    /// The next that has come; waits for it at most for so long.
    pub fn take(&self, wait: Duration) -> Option<Loaded> {
        let loaded = match wait.is_zero() {
            true => self.loaded.try_recv().ok(),
            false => self.loaded.recv_timeout(wait).ok(),
        }?;
        let (wishes, _) = &*self.wishes;
        let mut wishes = wishes.lock().unwrap_or_else(PoisonError::into_inner);
        wishes.under_way.retain(|place| *place != loaded.place);
        Some(loaded)
    }
}

/// Waits for the next request; `None` if there will be no more.
fn next_wish((wishes, changed): &(Mutex<Wishes>, Condvar)) -> Option<usize> {
    let mut wishes = wishes.lock().unwrap_or_else(PoisonError::into_inner);
    loop {
        if wishes.is_over {
            return None;
        }
        if !wishes.places.is_empty() {
            let place = wishes.places.remove(0);
            wishes.under_way.push(place);
            return Some(place);
        }
        wishes = changed.wait(wishes).unwrap_or_else(PoisonError::into_inner);
    }
}

impl Drop for MapLoader {
    fn drop(&mut self) {
        let (wishes, changed) = &*self.wishes;
        wishes
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .is_over = true;
        changed.notify_one();
        if let Some(thread) = self.thread.take()
            && thread.join().is_err()
        {
            tracing::warn!("the thread that reads maps has panicked");
        }
    }
}
