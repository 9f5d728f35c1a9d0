//! Searches passes, and times of light, on a separate thread, so that no image waits for them.

use super::super::flight::Flight;
use super::light::LightBands;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, Scope};
use terrella::frames::{Epoch, Geodetic};
use terrella_orbit::{
    Feed, Observer, OrbitError, OrbitState, Pass, VisibilityRule, passes, visible_intervals,
};

/// Most passes that are marked on the time line.
const MAX_PASSES: usize = 500;

/// A place on the ground, and the minimum elevation of a pass over it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassSite {
    pub place: Geodetic,
    /// Minimum elevation above its horizon, radians.
    pub min_elevation_rad: f64,
    /// Whether only passes count in which the satellite can be seen: it is in sunlight, and the sky is dark.
    pub is_visible: bool,
}

/// The query.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PassQuery {
    /// All passes of a span.
    InSpan(PassSite, (Epoch, Epoch)),
    /// The first one that rises after the one instant and before the other.
    Next(PassSite, (Epoch, Epoch)),
    /// When it is dark in a span.
    Light((Epoch, Epoch)),
}

/// Result of a search.
#[derive(Debug)]
pub enum PassResult {
    /// Passes in order of time; what the satellite's feed rejects ends them.
    InSpan(Vec<Pass>),
    Next(Upcoming),
    Light(LightBands),
}

/// The outcome of a search for the next pass.
#[derive(Debug)]
pub enum Upcoming {
    /// A pass that rises.
    Pass(Pass),
    /// It is above the mask for the whole searched time.
    AlwaysAbove,
    /// It never does again in that time.
    NoneFound,
    /// The feed's error.
    Failed(String),
}

/// The caller's end of the thread that searches. Dropping it stops the search and ends the thread.
pub struct PassSearch {
    queries: Sender<(u64, PassQuery)>,
    answers: Receiver<(u64, PassResult)>,
    /// Number of the newest query of each kind; an older one is given up.
    newest: Arc<[AtomicU64; 3]>,
    count: u64,
}

impl PassSearch {
    /// Starts the thread. `wake` is called on it for every result.
    pub fn start<'scope>(
        scope: &'scope Scope<'scope, '_>,
        flight: &'scope Flight,
        wake: impl Fn() + Send + 'scope,
    ) -> std::io::Result<Self> {
        let (queries, to_search) = channel();
        let (found, answers) = channel();
        let newest = Arc::new([const { AtomicU64::new(0) }; 3]);
        let known = newest.clone();
        let work = move || {
            while let Ok((number, query)) = to_search.recv() {
                let is_wanted = || known[kind(&query)].load(Ordering::Relaxed) == number;
                if let Some(answer) = find(flight, &query, &is_wanted) {
                    if found.send((number, answer)).is_err() {
                        break;
                    }
                    wake();
                }
            }
        };
        Builder::new()
            .name("terrella passes".to_owned())
            .spawn_scoped(scope, work)?;
        Ok(Self {
            queries,
            answers,
            newest,
            count: 0,
        })
    }

    /// Starts a search; one of the same kind that is not answered yet never will be.
    pub fn ask(&mut self, query: PassQuery) {
        self.count += 1;
        self.newest[kind(&query)].store(self.count, Ordering::Relaxed);
        // It fails only if the thread broke down, which has been reported then.
        let _ = self.queries.send((self.count, query));
    }

    /// The result since the last call.
    pub fn answer(&self) -> Option<PassResult> {
        let mut answers = self.answers.try_iter();
        answers.find_map(|(number, answer)| {
            let kind = match &answer {
                PassResult::InSpan(_) => 0,
                PassResult::Next(_) => 1,
                PassResult::Light(_) => 2,
            };
            let is_newest = self.newest[kind].load(Ordering::Relaxed) == number;
            is_newest.then_some(answer)
        })
    }
}

impl Drop for PassSearch {
    fn drop(&mut self) {
        for newest in self.newest.iter() {
            newest.store(u64::MAX, Ordering::Relaxed);
        }
    }
}

fn kind(query: &PassQuery) -> usize {
    match query {
        PassQuery::InSpan(..) => 0,
        PassQuery::Next(..) => 1,
        PassQuery::Light(_) => 2,
    }
}

/// `None` if the result is no longer needed, or there is no satellite.
fn find(
    flight: &Flight,
    query: &PassQuery,
    is_wanted: &(dyn Fn() -> bool + Sync),
) -> Option<PassResult> {
    let feed = Wanted {
        feed: flight.feed()?,
        is_wanted,
    };
    let orientation = |epoch| flight.orientation_at(epoch);
    let observer = |site: &PassSite| {
        let min_elevation_rad = site.min_elevation_rad;
        Observer::new(
            site.place,
            flight.ellipsoid(),
            min_elevation_rad,
            &orientation,
        )
    };
    let answer = match query {
        PassQuery::InSpan(site, (first, last)) => {
            let observer = observer(site);
            let found = passes(&feed, &observer, *first, *last).map_while(Result::ok);
            let counted = found.filter(|pass| counts(&feed, &observer, site, pass));
            PassResult::InSpan(counted.take(MAX_PASSES).collect())
        }
        PassQuery::Next(site, (from, until)) => {
            PassResult::Next(next(&feed, &observer(site), site, (*from, *until)))
        }
        PassQuery::Light(span) => PassResult::Light(LightBands::of(flight, *span, is_wanted)?),
    };
    is_wanted().then_some(answer)
}

/// Whether a pass over a site matches the query.
fn counts(feed: &dyn Feed, observer: &Observer<'_>, site: &PassSite, pass: &Pass) -> bool {
    let rule = VisibilityRule::default();
    !site.is_visible
        || visible_intervals(feed, observer, pass, &rule).is_ok_and(|times| !times.is_empty())
}

fn next(
    feed: &dyn Feed,
    observer: &Observer<'_>,
    site: &PassSite,
    (from, until): (Epoch, Epoch),
) -> Upcoming {
    // The pass that it is in is not the next one.
    let mut found = passes(feed, observer, from, until).filter(|pass| match pass {
        Ok(pass) => counts(feed, observer, site, pass),
        Err(_) => true,
    });
    match found.next() {
        None => Upcoming::NoneFound,
        Some(Err(error)) => Upcoming::Failed(error.to_string()),
        Some(Ok(pass)) if pass.begin > from => Upcoming::Pass(pass),
        Some(Ok(pass)) if !pass.sets && pass.end >= until.min(feed.validity().1) => {
            Upcoming::AlwaysAbove
        }
        Some(Ok(_)) => match found.next() {
            None => Upcoming::NoneFound,
            Some(Err(error)) => Upcoming::Failed(error.to_string()),
            Some(Ok(pass)) => Upcoming::Pass(pass),
        },
    }
}

/// A feed that returns errors when its results are no longer needed: every search then ends quickly.
struct Wanted<'f> {
    feed: &'f dyn Feed,
    is_wanted: &'f (dyn Fn() -> bool + Sync),
}

impl Feed for Wanted<'_> {
    fn name(&self) -> &str {
        self.feed.name()
    }

    fn validity(&self) -> (Epoch, Epoch) {
        self.feed.validity()
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        match (self.is_wanted)() {
            true => self.feed.state_at(epoch),
            // Nobody reads it.
            false => Err(OrbitError::OutsideValidity {
                satellite: String::new(),
                epoch: String::new(),
                first: String::new(),
                last: String::new(),
            }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use std::path::Path;
    use std::sync::mpsc::channel;
    use std::time::Duration as WallTime;
    use terrella::frames::Duration;

    fn flight(scene: &str) -> Flight {
        let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
        Flight::open(scene).expect("opens")
    }

    fn site(lat_deg: f64, lon_deg: f64) -> PassSite {
        PassSite {
            place: Geodetic::from_degrees(lat_deg, lon_deg, 0.0),
            min_elevation_rad: 10f64.to_radians(),
            is_visible: false,
        }
    }

    /// Asks and waits.
    fn answers(flight: &Flight, queries: &[PassQuery]) -> Vec<PassResult> {
        std::thread::scope(|scope| {
            let (woken, waits) = channel();
            let wake = move || {
                let _ = woken.send(());
            };
            let mut pass_search = PassSearch::start(scope, flight, wake).expect("a thread");
            queries.iter().for_each(|query| pass_search.ask(*query));
            let mut found = Vec::new();
            while waits.recv_timeout(WallTime::from_secs(60)).is_ok() {
                found.extend(pass_search.answer());
                if !found.is_empty() {
                    break;
                }
            }
            found
        })
    }

    #[test]
    fn the_next_pass_is_not_the_present_one() {
        let flight = flight("[camera]\nmode = \"nadir\"\n");
        let from = flight.scene().time.start;
        let day = (from, from + Duration::from_days(1.0));
        let vienna = site(48.2, 16.4);
        let [PassResult::Next(Upcoming::Pass(first))] =
            &answers(&flight, &[PassQuery::Next(vienna, day)])[..]
        else {
            panic!("no pass within a day")
        };
        assert!(first.rises && first.begin > from);
        // Starting at its first epoch, the result is another one.
        let [PassResult::Next(Upcoming::Pass(second))] =
            &answers(&flight, &[PassQuery::Next(vienna, (first.begin, day.1))])[..]
        else {
            panic!("no second pass within a day")
        };
        assert!(second.begin > first.end);
        let marks = answers(&flight, &[PassQuery::InSpan(vienna, day)]);
        let [PassResult::InSpan(marks)] = &marks[..] else {
            panic!("{marks:?}")
        };
        let apart_s = |a: &Pass, b: &Pass| (a.begin - b.begin).to_seconds().abs();
        assert!(marks.len() > 3);
        assert!(apart_s(&marks[0], first) < 0.01 && apart_s(&marks[1], second) < 0.01);
        // The first pass visible from Vienna is days later, as `terrella orbit --passes` reports.
        let seen = PassSite {
            is_visible: true,
            ..vienna
        };
        let week = (from, from + Duration::from_days(14.0));
        let [PassResult::Next(Upcoming::Pass(seen))] =
            &answers(&flight, &[PassQuery::Next(seen, week)])[..]
        else {
            panic!("none is seen within two weeks")
        };
        assert!(seen.begin > first.begin, "{seen:?}");
        let pole = answers(&flight, &[PassQuery::Next(site(90.0, 0.0), day)]);
        assert!(
            matches!(pole[..], [PassResult::Next(Upcoming::NoneFound)]),
            "{pole:?}"
        );
    }

    #[test]
    fn a_newer_query_takes_the_place_of_an_older_one() {
        let flight = flight("[camera]\nmode = \"nadir\"\n");
        let from = flight.scene().time.start;
        let long = (from, from + Duration::from_days(30.0));
        let queries = [site(90.0, 0.0), site(-90.0, 0.0), site(48.2, 16.4)]
            .map(|site| PassQuery::Next(site, long));
        let found = answers(&flight, &queries);
        assert!(
            matches!(found[..], [PassResult::Next(Upcoming::Pass(_))]),
            "{found:?}"
        );
    }
}
