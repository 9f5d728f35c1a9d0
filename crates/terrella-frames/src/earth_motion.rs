//! The Earth's motion about the Sun.

use super::time::JulianDate;
use glam::DVec3;
use std::cell::RefCell;

/// The Earth's centre in GCRF axes.
#[derive(Clone, Copy, Debug)]
pub(super) struct EarthMotion {
    /// Position relative to the Sun's centre, au.
    pub from_sun_au: DVec3,
    /// Velocity relative to the barycentre of the Solar System, au per day.
    pub velocity_au_day: DVec3,
}

/// The Earth's motion by VSOP2000 (simplified), from 1900 to 2100; none outside these years.
///
/// The series has 2 500 terms, and a search for eclipses asks for thousands of instants in a row. So it is evaluated eight times a day and
/// interpolated by cubics with its own velocities: within 0.05 m and 1e-5 m/s of the series.
pub(super) fn earth_motion(tt: JulianDate) -> Option<EarthMotion> {
    let nodes = tt.fraction * PER_DAY;
    let number = (tt.midnight - MJD_ZERO) as i64 * PER_DAY as i64 + nodes.floor() as i64;
    match (node(number), node(number + 1)) {
        (Some(before), Some(after)) => Some(between(&before, &after, nodes - nodes.floor())),
        _ => evaluated(tt).map(|node| EarthMotion {
            from_sun_au: node.from_sun[0],
            velocity_au_day: node.from_barycentre[1],
        }),
    }
}

const MJD_ZERO: f64 = 2_400_000.5;
/// Nodes in a day.
const PER_DAY: f64 = 8.0;

/// Position, au, and velocity, au per day, of the Earth at an instant.
#[derive(Clone, Copy)]
struct Node {
    from_sun: [DVec3; 2],
    from_barycentre: [DVec3; 2],
}

fn evaluated(tt: JulianDate) -> Option<Node> {
    let (from_sun, from_barycentre) = sofars::eph::epv00(tt.midnight, tt.fraction)?;
    Some(Node {
        from_sun: from_sun.map(DVec3::from),
        from_barycentre: from_barycentre.map(DVec3::from),
    })
}

/// A node that was evaluated, by its number; none outside the years of the series.
type Kept = Option<(i64, Option<Node>)>;

/// The Earth at a node; they are counted from the start of the modified Julian dates.
fn node(number: i64) -> Option<Node> {
    const KEPT: usize = 16;
    thread_local! {
        static NODES: RefCell<[Kept; KEPT]> = const { RefCell::new([None; KEPT]) };
    }
    NODES.with_borrow_mut(|nodes| {
        let kept = &mut nodes[number.rem_euclid(KEPT as i64) as usize];
        match *kept {
            Some((of, node)) if of == number => node,
            _ => {
                let node = evaluated(JulianDate {
                    midnight: number.div_euclid(PER_DAY as i64) as f64 + MJD_ZERO,
                    fraction: number.rem_euclid(PER_DAY as i64) as f64 / PER_DAY,
                });
                *kept = Some((number, node));
                node
            }
        }
    })
}

/// At a fraction of the time between two nodes.
fn between(before: &Node, after: &Node, t: f64) -> EarthMotion {
    let [position, _] = cubic(before.from_sun, after.from_sun, t);
    let [_, velocity] = cubic(before.from_barycentre, after.from_barycentre, t);
    EarthMotion {
        from_sun_au: position,
        velocity_au_day: velocity,
    }
}

/// Position and velocity on Hermite's cubic.
fn cubic(before: [DVec3; 2], after: [DVec3; 2], t: f64) -> [DVec3; 2] {
    let step = 1.0 / PER_DAY;
    let rise = after[0] - before[0];
    let (start, end) = (step * before[1], step * after[1]);
    let square = 3.0 * rise - 2.0 * start - end;
    let cube = start + end - 2.0 * rise;
    let position = before[0] + t * (start + t * (square + t * cube));
    let velocity = (start + t * (2.0 * square + 3.0 * t * cube)) / step;
    [position, velocity]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{ASTRONOMICAL_UNIT_M, Duration, Epoch};

    #[test]
    fn it_is_that_of_the_series() {
        let start = Epoch::from_gregorian_utc_at_midnight(1900, 1, 2);
        let mut worst = (0.0_f64, 0.0_f64);
        for step in 0..4000 {
            let tt = JulianDate::tt(start + Duration::from_days(f64::from(step) * 18.2347));
            let exact = evaluated(tt).expect("within the years");
            let found = earth_motion(tt).expect("within the years");
            let off = found.from_sun_au.distance(exact.from_sun[0]);
            let speed_off = found.velocity_au_day.distance(exact.from_barycentre[1]);
            worst = (worst.0.max(off), worst.1.max(speed_off));
        }
        let metres = worst.0 * ASTRONOMICAL_UNIT_M;
        let metres_per_second = worst.1 * ASTRONOMICAL_UNIT_M / 86_400.0;
        println!("interpolated: {metres:.3} m, {metres_per_second:.2e} m/s");
        assert!(metres < 0.05 && metres_per_second < 1e-5, "{worst:?}");
    }

    #[test]
    fn it_ends_where_the_series_ends() {
        let at = |year| {
            earth_motion(JulianDate::tt(Epoch::from_gregorian_utc(
                year, 6, 1, 5, 0, 0, 0,
            )))
        };
        assert!(at(1890).is_none() && at(2110).is_none());
        assert!(at(1901).is_some() && at(2099).is_some());
    }
}
