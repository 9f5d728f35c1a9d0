//! The time, and the lights of the Earth at that time.

use bevy::ecs::change_detection::DetectChanges;
use bevy::ecs::component::Component;
use bevy::ecs::reflect::ReflectComponent;
use bevy::ecs::system::{Query, Res};
use bevy::ecs::world::Ref;
use bevy::reflect::Reflect;
use bevy::reflect::std_traits::ReflectDefault;
use bevy::time::Time;
use std::ops::RangeInclusive;
use std::time::SystemTime;
use terrella::Sky;
use terrella::frames::{Duration, Epoch};

/// The displayed instant, in the years 1 to 9999: exact to the nanosecond, with leap seconds. The default is the present.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
pub struct EarthEpoch(pub Epoch);

impl Default for EarthEpoch {
    fn default() -> Self {
        let since_1970 = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH);
        let seconds = since_1970.map_or(0.0, |time| time.as_secs_f64());
        Self(Epoch::from_unix_seconds(seconds))
    }
}

/// Advances [`EarthEpoch`] with Bevy's [`Time`]. Without it the epoch is constant, or the app sets it.
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(Component, Clone, Debug, PartialEq)]
pub struct EarthClock {
    /// Seconds of epoch per second of the app; negative runs backwards. A clock with a rate that is not finite stands still. Every
    /// clock stops at the ends of the years 1 and 9999.
    pub rate: f64,
}

impl Default for EarthClock {
    fn default() -> Self {
        Self { rate: 1.0 }
    }
}

/// Lights of the Earth, computed from [`EarthEpoch`] on every change. An app with its own ephemeris writes it after
/// [`TerrellaSystems::Sky`](crate::TerrellaSystems::Sky).
#[derive(Component, Clone, Copy, Debug, PartialEq, Reflect)]
#[reflect(opaque)]
#[reflect(Component, Clone, Debug, Default, PartialEq)]
pub struct EarthSky(pub Sky);

impl Default for EarthSky {
    fn default() -> Self {
        Self(Sky::at(EarthEpoch::default().0))
    }
}

/// Maximum step of a clock in one frame, nanoseconds: three thousand years.
const LONGEST_STEP_NS: f64 = 1e20;

/// Instants with a sky: the years 1 to 9999.
fn range() -> RangeInclusive<Epoch> {
    Epoch::from_gregorian_utc_at_midnight(1, 1, 1)
        ..=Epoch::from_gregorian_utc_at_midnight(9999, 12, 31)
}

/// Whether this instant has a sky.
pub(crate) fn has_sky(epoch: Epoch) -> bool {
    range().contains(&epoch)
}

pub(crate) fn advance_epochs(time: Res<Time>, mut clocks: Query<(&EarthClock, &mut EarthEpoch)>) {
    // The nanoseconds of a frame fit into an f64 exactly.
    let elapsed_ns = time.delta().as_nanos() as f64;
    let (first, last) = range().into_inner();
    for (clock, mut epoch) in &mut clocks {
        let step_ns = (elapsed_ns * clock.rate).round();
        if step_ns == 0.0 || !step_ns.is_finite() {
            continue;
        }
        let step_ns = step_ns.clamp(-LONGEST_STEP_NS, LONGEST_STEP_NS) as i128;
        let next = epoch.0 + Duration::from_total_nanoseconds(step_ns);
        epoch.0 = next.clamp(first, last);
    }
}

pub(crate) fn compute_skies(mut skies: Query<(Ref<EarthEpoch>, &mut EarthSky)>) {
    for (epoch, mut sky) in &mut skies {
        // An epoch without a sky is a fault, which cameras report.
        if epoch.is_changed() && has_sky(epoch.0) {
            sky.0 = Sky::at(epoch.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use bevy::ecs::schedule::{IntoScheduleConfigs, Schedule};
    use bevy::ecs::world::World;

    fn after(frames: u32, delta: std::time::Duration, rate: f64) -> (Epoch, Sky) {
        let start: Epoch = "2018-06-21T09:00:00Z".parse().expect("a date");
        let mut world = World::new();
        let mut time = Time::<()>::default();
        let earth = world.spawn((EarthEpoch(start), EarthSky::default(), EarthClock { rate }));
        let earth = earth.id();
        let mut schedule = Schedule::default();
        schedule.add_systems((advance_epochs, compute_skies).chain());
        for _ in 0..frames {
            time.advance_by(delta);
            world.insert_resource(time);
            schedule.run(&mut world);
        }
        let earth = world.entity(earth);
        let read = "the Earth has a date and a sky";
        (
            earth.get::<EarthEpoch>().expect(read).0,
            earth.get::<EarthSky>().expect(read).0,
        )
    }

    #[test]
    fn an_hour_of_frames_is_an_hour_to_the_nanosecond() {
        // At 144 frames per second a frame is not an integer number of nanoseconds. The clock adds what Bevy
        // counts.
        let delta = std::time::Duration::from_nanos(6_944_444);
        let (epoch, sky) = after(5184, delta, 100.0);
        let expected: Epoch = "2018-06-21T09:59:59.999769600Z".parse().expect("a date");
        assert_eq!(epoch, expected);
        assert_eq!(sky, Sky::at(expected));
    }

    #[test]
    fn a_clock_of_no_rate_stands_still_and_one_too_fast_does_not_break() {
        let start: Epoch = "2018-06-21T09:00:00Z".parse().expect("a date");
        let delta = std::time::Duration::from_millis(16);
        for rate in [0.0, f64::NAN, f64::INFINITY] {
            assert_eq!(after(2, delta, rate).0, start, "{rate}");
        }
        for rate in [1e300, -1e300] {
            let (epoch, sky) = after(9, delta, rate);
            assert!(epoch == *range().start() || epoch == *range().end());
            assert_eq!(sky, Sky::at(epoch));
        }
    }
}
