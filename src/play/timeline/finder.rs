//! Passes are looked for on a thread of their own, so that no picture waits for them.

use super::super::flight::Flight;
use crate::frames::{Epoch, Geodetic};
use crate::orbit::{Feed, Observer, OrbitError, OrbitState, Pass, passes};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, Scope};

/// Most passes that are marked on the line.
const MOST_MARKS: usize = 500;

/// The place, and how high the satellite must stand above its horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lookout {
    /// Where, on the ground.
    pub place: Geodetic,
    /// Radians.
    pub least_elevation_rad: f64,
}

/// What is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Order {
    /// All passes of a span.
    Marks(Lookout, (Epoch, Epoch)),
    /// The first one that rises after the one instant and before the other.
    Next(Lookout, (Epoch, Epoch)),
}

/// What was found.
#[derive(Debug)]
pub enum Answer {
    /// Passes in order of time; what the satellite's feed refuses ends them.
    Marks(Vec<Pass>),
    /// The next one.
    Next(Next),
}

/// What comes next.
#[derive(Debug)]
pub enum Next {
    /// A pass that rises.
    Pass(Pass),
    /// It stands high enough all the time that was looked through.
    Always,
    /// It never does again in that time.
    Never,
    /// The feed's words.
    Refused(String),
}

/// The thread's other end. It stops its search and ends when this is dropped.
pub struct Finder {
    orders: Sender<(u64, Order)>,
    answers: Receiver<(u64, Answer)>,
    /// Number of the newest order of each kind; an older one is given up.
    newest: Arc<[AtomicU64; 2]>,
    count: u64,
}

impl Finder {
    /// Starts the thread. `wake` is called on it whenever there is an answer.
    pub fn start<'scope>(
        scope: &'scope Scope<'scope, '_>,
        flight: &'scope Flight,
        wake: impl Fn() + Send + 'scope,
    ) -> std::io::Result<Self> {
        let (orders, inbox) = channel();
        let (outbox, answers) = channel();
        let newest = Arc::new([AtomicU64::new(0), AtomicU64::new(0)]);
        let known = newest.clone();
        let work = move || {
            while let Ok((number, order)) = inbox.recv() {
                let is_wanted = || known[kind(&order)].load(Ordering::Relaxed) == number;
                if let Some(answer) = find(flight, &order, &is_wanted) {
                    if outbox.send((number, answer)).is_err() {
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
            orders,
            answers,
            newest,
            count: 0,
        })
    }

    /// Asks; an order of the same kind that is not answered yet will not be.
    pub fn ask(&mut self, order: Order) {
        self.count += 1;
        self.newest[kind(&order)].store(self.count, Ordering::Relaxed);
        // It fails only if the thread broke down, which has been told then.
        let _ = self.orders.send((self.count, order));
    }

    /// What has been found since it was last asked.
    pub fn answer(&self) -> Option<Answer> {
        let mut answers = self.answers.try_iter();
        answers.find_map(|(number, answer)| {
            let kind = match &answer {
                Answer::Marks(_) => 0,
                Answer::Next(_) => 1,
            };
            let is_newest = self.newest[kind].load(Ordering::Relaxed) == number;
            is_newest.then_some(answer)
        })
    }
}

impl Drop for Finder {
    fn drop(&mut self) {
        for newest in self.newest.iter() {
            newest.store(u64::MAX, Ordering::Relaxed);
        }
    }
}

fn kind(order: &Order) -> usize {
    match order {
        Order::Marks(..) => 0,
        Order::Next(..) => 1,
    }
}

/// `None` where nobody waits for it any more, or there is no satellite.
fn find(flight: &Flight, order: &Order, is_wanted: &(dyn Fn() -> bool + Sync)) -> Option<Answer> {
    let feed = Wanted {
        feed: flight.feed()?,
        is_wanted,
    };
    let orientation = |epoch| flight.orientation_at(epoch);
    let observer = |lookout: &Lookout| {
        let least_rad = lookout.least_elevation_rad;
        Observer::new(lookout.place, flight.ellipsoid(), least_rad, &orientation)
    };
    let answer = match order {
        Order::Marks(lookout, (first, last)) => {
            let observer = observer(lookout);
            let found = passes(&feed, &observer, *first, *last);
            Answer::Marks(found.map_while(Result::ok).take(MOST_MARKS).collect())
        }
        Order::Next(lookout, (from, until)) => {
            Answer::Next(next(&feed, &observer(lookout), *from, *until))
        }
    };
    is_wanted().then_some(answer)
}

fn next(feed: &dyn Feed, observer: &Observer<'_>, from: Epoch, until: Epoch) -> Next {
    // The pass that it is in is not the next one.
    let mut found = passes(feed, observer, from, until);
    match found.next() {
        None => Next::Never,
        Some(Err(error)) => Next::Refused(error.to_string()),
        Some(Ok(pass)) if pass.begin > from => Next::Pass(pass),
        Some(Ok(pass)) if !pass.sets && pass.end >= until.min(feed.validity().1) => Next::Always,
        Some(Ok(_)) => match found.next() {
            None => Next::Never,
            Some(Err(error)) => Next::Refused(error.to_string()),
            Some(Ok(pass)) => Next::Pass(pass),
        },
    }
}

/// A feed that refuses everything once its answers are not wanted any more: so every search ends at once.
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
    use crate::frames::Duration;
    use crate::scene::Scene;
    use std::path::Path;
    use std::sync::mpsc::channel;
    use std::time::Duration as WallTime;

    fn flight(scene: &str) -> Flight {
        let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
        Flight::open(scene).expect("opens")
    }

    fn lookout(lat_deg: f64, lon_deg: f64) -> Lookout {
        Lookout {
            place: Geodetic::from_degrees(lat_deg, lon_deg, 0.0),
            least_elevation_rad: 10f64.to_radians(),
        }
    }

    /// Asks and waits.
    fn answers(flight: &Flight, orders: &[Order]) -> Vec<Answer> {
        std::thread::scope(|scope| {
            let (woken, waits) = channel();
            let wake = move || {
                let _ = woken.send(());
            };
            let mut finder = Finder::start(scope, flight, wake).expect("a thread");
            orders.iter().for_each(|order| finder.ask(*order));
            let mut found = Vec::new();
            while waits.recv_timeout(WallTime::from_secs(60)).is_ok() {
                found.extend(finder.answer());
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
        let vienna = lookout(48.2, 16.4);
        let [Answer::Next(Next::Pass(first))] = &answers(&flight, &[Order::Next(vienna, day)])[..]
        else {
            panic!("no pass within a day")
        };
        assert!(first.rises && first.begin > from);
        // Asked from its first instant it answers with another one.
        let [Answer::Next(Next::Pass(second))] =
            &answers(&flight, &[Order::Next(vienna, (first.begin, day.1))])[..]
        else {
            panic!("no second pass within a day")
        };
        assert!(second.begin > first.end);
        let marks = answers(&flight, &[Order::Marks(vienna, day)]);
        let [Answer::Marks(marks)] = &marks[..] else {
            panic!("{marks:?}")
        };
        let apart_s = |a: &Pass, b: &Pass| (a.begin - b.begin).to_seconds().abs();
        assert!(marks.len() > 3);
        assert!(apart_s(&marks[0], first) < 0.01 && apart_s(&marks[1], second) < 0.01);
        let pole = answers(&flight, &[Order::Next(lookout(90.0, 0.0), day)]);
        assert!(matches!(pole[..], [Answer::Next(Next::Never)]), "{pole:?}");
    }

    #[test]
    fn a_newer_order_takes_the_place_of_an_older_one() {
        let flight = flight("[camera]\nmode = \"nadir\"\n");
        let from = flight.scene().time.start;
        let long = (from, from + Duration::from_days(30.0));
        let orders = [lookout(90.0, 0.0), lookout(-90.0, 0.0), lookout(48.2, 16.4)]
            .map(|lookout| Order::Next(lookout, long));
        let found = answers(&flight, &orders);
        assert!(
            matches!(found[..], [Answer::Next(Next::Pass(_))]),
            "{found:?}"
        );
    }
}
