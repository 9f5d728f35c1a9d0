//! Many satellites in one frame: their states are computed on all processors before the tracks request them sequentially.

use rayon::prelude::*;
use std::sync::Arc;
use terrella::frames::Epoch;
use terrella_orbit::{Feed, Freshness, OrbitError, OrbitState};

/// With fewer satellites, distributing the work costs more than it saves.
const FEWEST: usize = 256;

/// The motions of the satellites of a layer.
#[derive(Default)]
pub struct Swarm(Vec<Known>);

/// A satellite's motion, with its cached state of the current frame.
struct Known {
    feed: Arc<dyn Feed>,
    /// Validity of the feed, if it does not change.
    validity: Option<(Epoch, Epoch)>,
    state: Option<OrbitState>,
}

impl Swarm {
    pub fn of(feeds: Vec<Arc<dyn Feed>>) -> Self {
        let known = feeds.into_iter().map(|feed| Known {
            feed,
            validity: None,
            state: None,
        });
        Self(known.collect())
    }

    /// Computes the states of an instant, if there are many.
    pub fn look_at(&mut self, epoch: Epoch) {
        if self.0.len() >= FEWEST {
            self.0.par_iter_mut().for_each(|known| known.look_at(epoch));
        }
    }

    pub fn feeds(&self) -> impl Iterator<Item = &dyn Feed> {
        self.0.iter().map(|known| known as &dyn Feed)
    }

    pub fn name(&self, satellite: usize) -> Option<&str> {
        self.0.get(satellite).map(|known| known.feed.name())
    }
}

impl Known {
    fn look_at(&mut self, epoch: Epoch) {
        if self.feed.freshness() != Freshness::Settled {
            return;
        }
        let feed = &self.feed;
        let (first, last) = *self.validity.get_or_insert_with(|| feed.validity());
        let is_inside = first <= epoch && epoch <= last;
        self.state = match is_inside {
            true => self.feed.state_at(epoch).ok(),
            false => None,
        };
    }
}

impl Feed for Known {
    fn name(&self) -> &str {
        self.feed.name()
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.validity.unwrap_or_else(|| self.feed.validity())
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        match self.state.filter(|state| state.epoch == epoch) {
            Some(state) => Ok(state),
            None => self.feed.state_at(epoch),
        }
    }

    fn freshness(&self) -> Freshness {
        self.feed.freshness()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;
    use terrella::frames::Duration;
    use terrella_orbit::Sgp4Feed;

    fn feeds(iss: &Sgp4Feed, count: u32) -> Vec<Arc<dyn Feed>> {
        let origin: Arc<Path> = Arc::from(Path::new("many"));
        let feeds = (0..count).map(|k| {
            let mut elements = iss.elements().clone();
            elements.mean_anomaly_deg = f64::from(k % 360);
            let feed = Sgp4Feed::from_elements(elements, Arc::clone(&origin), 1);
            Arc::new(feed.expect("an orbit")) as Arc<dyn Feed>
        });
        feeds.collect()
    }

    /// `cargo test --release --lib print_swarm -- --ignored --nocapture`
    #[test]
    #[ignore = "measures"]
    fn print_swarm_times() {
        let iss = Sgp4Feed::built_in_iss().expect("built in");
        let mut swarm = Swarm::of(feeds(&iss, 30_000));
        for frame in 0..10 {
            let began = std::time::Instant::now();
            swarm.look_at(iss.epoch() + Duration::from_seconds(f64::from(frame)));
            println!(
                "frame {frame}: {:.1} ms",
                began.elapsed().as_secs_f64() * 1e3
            );
        }
    }

    #[test]
    fn states_are_those_of_the_feeds() {
        let iss = Sgp4Feed::built_in_iss().expect("built in");
        let feeds = feeds(&iss, 300);
        let mut swarm = Swarm::of(feeds.clone());
        for hours in [0.0, 1.0, 800.0] {
            let epoch = iss.epoch() + Duration::from_hours(hours);
            swarm.look_at(epoch);
            for (known, feed) in swarm.feeds().zip(&feeds) {
                assert_eq!(known.validity(), feed.validity());
                assert_eq!(known.state_at(epoch).ok(), feed.state_at(epoch).ok());
                // For another time the feed itself is called.
                let other = epoch + Duration::from_seconds(1.0);
                assert_eq!(known.state_at(other).ok(), feed.state_at(other).ok());
            }
        }
        // Far outside the validity nothing is cached.
        let late = iss.epoch() + Duration::from_days(90.0);
        swarm.look_at(late);
        assert!(swarm.feeds().all(|feed| feed.state_at(late).is_err()));
    }
}
