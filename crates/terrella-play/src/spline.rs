//! Smooth ways through values that are given at times: numbers, and directions and attitudes on their spheres. Pure f64.
//!
//! - Numbers by monotone cubics (Fritsch and Butland 1984): the slope has no jump, and nothing is passed beyond: between two values
//!   there are only values between them.
//! - Directions and attitudes, points of a unit sphere in three and four dimensions, by a centripetal Catmull–Rom curve in the
//!   pyramid of Barry and Goldman 1988, with great arcs in place of its straight lines: without cusps and loops however the points
//!   are spaced. How far along that curve the way is at a time is a monotone cubic too, so that the speed has no jump either.
//!
//! Before the first time the first value holds, after the last the last.

use glam::DVec4;

/// A number over time.
#[derive(Clone, Debug, PartialEq)]
pub struct NumberTrack {
    times: Vec<f64>,
    values: Vec<f64>,
    slopes: Vec<f64>,
}

impl NumberTrack {
    /// Through these values at these times, which rise; `None` without any.
    pub fn new(points: &[(f64, f64)]) -> Option<Self> {
        if points.is_empty() {
            return None;
        }
        let (times, values): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        Some(Self {
            slopes: slopes(&times, &values),
            times,
            values,
        })
    }

    /// The value at a time.
    pub fn at(&self, time: f64) -> f64 {
        let (i, s) = segment(&self.times, time);
        let (Some(&to), Some(&next)) = (self.values.get(i + 1), self.times.get(i + 1)) else {
            return self.values[i];
        };
        let (from, step) = (self.values[i], next - self.times[i]);
        let (m0, m1) = (self.slopes[i] * step, self.slopes[i + 1] * step);
        // Hermite's form about the first value: a constant stays one to the last bit.
        let rise = to - from;
        from + s * (m0 + s * (3.0 * rise - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * rise)))
    }
}

/// Slopes of a monotone cubic: zero at extremes, else the weighted harmonic mean of the slopes on both sides.
fn slopes(times: &[f64], values: &[f64]) -> Vec<f64> {
    let steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
    let rises = values.windows(2).zip(&steps);
    let secants: Vec<f64> = rises
        .map(|(pair, step)| (pair[1] - pair[0]) / step)
        .collect();
    let (Some(&first), Some(&last)) = (secants.first(), secants.last()) else {
        return vec![0.0; values.len()];
    };
    let inner = secants.windows(2).zip(steps.windows(2));
    let mut slopes = vec![first];
    slopes.extend(inner.map(|(secant, step)| {
        if secant[0] * secant[1] <= 0.0 {
            return 0.0;
        }
        let weights = (2.0 * step[1] + step[0], step[1] + 2.0 * step[0]);
        (weights.0 + weights.1) / (weights.0 / secant[0] + weights.1 / secant[1])
    }));
    slopes.push(last);
    slopes
}

/// The number of the value before a time, and how far to the next it is, 0…1.
fn segment(times: &[f64], time: f64) -> (usize, f64) {
    let last = times.len().saturating_sub(1);
    match times.partition_point(|known| *known <= time) {
        0 => (0, 0.0),
        after if after > last => (last, 0.0),
        after => {
            let (from, to) = (times[after - 1], times[after]);
            (after - 1, (time - from) / (to - from))
        }
    }
}

/// A point on a unit sphere over time.
#[derive(Clone, Debug, PartialEq)]
pub struct SphereTrack {
    times: Vec<f64>,
    points: Vec<DVec4>,
    /// The curve's own measure at each point.
    knots: Vec<f64>,
    along: NumberTrack,
}

impl SphereTrack {
    /// Through these unit vectors at these times, which rise; `None` without any. Neighbours are not opposite.
    pub fn new(points: &[(f64, DVec4)]) -> Option<Self> {
        let (times, points): (Vec<f64>, Vec<DVec4>) = points.iter().copied().unzip();
        let mut knots = vec![0.0];
        for pair in points.windows(2) {
            // The last is there: one more than pairs.
            let last = knots[knots.len() - 1];
            knots.push(last + angle(pair[0], pair[1]).sqrt());
        }
        let along: Vec<_> = times.iter().copied().zip(knots.iter().copied()).collect();
        Some(Self {
            along: NumberTrack::new(&along)?,
            times,
            points,
            knots,
        })
    }

    /// Attitudes as points: of each and its opposite, which is the same attitude, the one nearer to that before.
    pub fn of_attitudes(attitudes: &[(f64, glam::DQuat)]) -> Option<Self> {
        let mut before = DVec4::ZERO;
        let points: Vec<_> = attitudes
            .iter()
            .map(|(time, attitude)| {
                let point = DVec4::from(*attitude);
                before = if point.dot(before) < 0.0 {
                    -point
                } else {
                    point
                };
                (*time, before)
            })
            .collect();
        Self::new(&points)
    }

    /// The point at a time.
    pub fn at(&self, time: f64) -> DVec4 {
        let (i, s) = segment(&self.times, time);
        let p1 = self.points[i];
        let Some(&p2) = self.points.get(i + 1).filter(|_| s > 0.0) else {
            return p1;
        };
        let (k1, k2) = (self.knots[i], self.knots[i + 1]);
        if k2 <= k1 {
            return p1;
        }
        // Beyond the ends the curve goes on as it came.
        let before = i.checked_sub(1).map(|n| (self.knots[n], self.points[n]));
        let (k0, p0) = before.unwrap_or_else(|| (2.0 * k1 - k2, slerp(p1, p2, -1.0)));
        let after = self.knots.get(i + 2).zip(self.points.get(i + 2));
        let (k3, p3) = match after {
            Some((knot, point)) => (*knot, *point),
            None => (2.0 * k2 - k1, slerp(p1, p2, 2.0)),
        };
        let u = self.along.at(time).clamp(k1, k2);
        // Between two equal points the curve is that point.
        let between = |(ka, a): (f64, DVec4), (kb, b): (f64, DVec4)| match kb > ka {
            true => slerp(a, b, (u - ka) / (kb - ka)),
            false => a,
        };
        let (a1, a2, a3) = (
            between((k0, p0), (k1, p1)),
            between((k1, p1), (k2, p2)),
            between((k2, p2), (k3, p3)),
        );
        let (b1, b2) = (between((k0, a1), (k2, a2)), between((k1, a2), (k3, a3)));
        between((k1, b1), (k2, b2))
    }
}

/// Angle between unit vectors, without cancellation at either end.
fn angle(a: DVec4, b: DVec4) -> f64 {
    2.0 * (a - b).length().atan2((a + b).length())
}

/// The point on the great arc from `a` to `b`, at `s` of its length; beyond 0…1 it goes on.
fn slerp(a: DVec4, b: DVec4, s: f64) -> DVec4 {
    // Perpendicular to `a`, towards `b`; undefined for opposite and equal points.
    let across = b - a * a.dot(b);
    let length = across.length();
    if length < 1e-150 {
        return a;
    }
    let (sin, cos) = (s * angle(a, b)).sin_cos();
    let point = a * cos + across * (sin / length);
    point / point.length()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DQuat, DVec3};

    fn direction(lat_deg: f64, lon_deg: f64) -> DVec4 {
        let (sin_lat, cos_lat) = lat_deg.to_radians().sin_cos();
        let (sin_lon, cos_lon) = lon_deg.to_radians().sin_cos();
        DVec4::new(cos_lat * cos_lon, cos_lat * sin_lon, sin_lat, 0.0)
    }

    /// Unevenly in time and in space, with a halt.
    fn places() -> Vec<(f64, DVec4)> {
        let places = [
            (0.0, 10.0, 20.0),
            (1.0, 12.0, 21.0),
            (5.0, 60.0, 110.0),
            (6.0, 60.0, 110.0),
            (6.5, -20.0, 150.0),
            (9.0, -21.0, 150.0),
        ];
        places
            .map(|(t, lat, lon)| (t, direction(lat, lon)))
            .to_vec()
    }

    #[test]
    fn a_track_goes_through_its_points_and_stays_at_its_ends() {
        let track = SphereTrack::new(&places()).expect("points");
        for (time, point) in places() {
            assert!((track.at(time) - point).length() < 1e-12, "{time}");
        }
        assert_eq!(track.at(-5.0), places()[0].1);
        assert_eq!(track.at(99.0), places()[5].1);
        assert_eq!(track.at(5.5), places()[2].1, "the halt");
        let numbers = [(0.0, 1.0), (2.0, 5.0), (3.0, 5.0), (4.0, -1.0)];
        let track = NumberTrack::new(&numbers).expect("points");
        for (time, value) in numbers {
            assert_eq!(track.at(time), value);
        }
        assert_eq!(
            (track.at(-1.0), track.at(9.0), track.at(2.5)),
            (1.0, -1.0, 5.0)
        );
    }

    /// Neither position nor speed jumps, at keyframes or between them.
    #[test]
    fn speed_has_no_jump() {
        let track = SphereTrack::new(&places()).expect("points");
        let step = 1e-6;
        let velocity = |time: f64| (track.at(time + step) - track.at(time)) / step;
        for n in 1..8999 {
            let time = f64::from(n) * 1e-3;
            let jump = (velocity(time) - velocity(time - step)).length();
            // Of the fastest, 4 a second.
            assert!(jump < 1e-3, "{time}: {jump}");
            assert!((track.at(time).length() - 1.0).abs() < 1e-12);
        }
        // One that does jump, or this test could not fail.
        let bent = |time: f64| match time < 1.0 {
            true => slerp(places()[0].1, places()[1].1, time),
            false => slerp(places()[1].1, places()[2].1, (time - 1.0) / 4.0),
        };
        let before = (bent(1.0) - bent(1.0 - step)) / step;
        assert!(((bent(1.0 + step) - bent(1.0)) / step - before).length() > 1e-2);
        let numbers = NumberTrack::new(&[(0.0, 1.0), (2.0, 5.0), (2.5, 5.5), (4.0, -1.0)]);
        let numbers = numbers.expect("points");
        let slope = |time: f64| (numbers.at(time + step) - numbers.at(time)) / step;
        for n in 1..3999 {
            let time = f64::from(n) * 1e-3;
            assert!((slope(time) - slope(time - step)).abs() < 1e-4, "{time}");
        }
    }

    #[test]
    fn numbers_stay_between_their_neighbours() {
        let points = [
            (0.0, 3.0),
            (1.0, 0.001),
            (1.1, 0.002),
            (8.0, 3.0),
            (9.0, 2.9),
        ];
        let track = NumberTrack::new(&points).expect("points");
        for pair in points.windows(2) {
            let (low, high) = (pair[0].1.min(pair[1].1), pair[0].1.max(pair[1].1));
            for n in 0..=100 {
                let time = pair[0].0 + f64::from(n) * 0.01 * (pair[1].0 - pair[0].0);
                let value = track.at(time);
                assert!(
                    (low - 1e-12..=high + 1e-12).contains(&value),
                    "{time}: {value}"
                );
            }
        }
    }

    /// Of two keys the way is the great arc, evenly.
    #[test]
    fn one_and_two_points() {
        let (a, b) = (direction(0.0, 0.0), direction(0.0, 90.0));
        let two = SphereTrack::new(&[(10.0, a), (20.0, b)]).expect("points");
        for (time, lon) in [(10.0, 0.0), (12.5, 22.5), (15.0, 45.0), (20.0, 90.0)] {
            assert!(
                (two.at(time) - direction(0.0, lon)).length() < 1e-12,
                "{time}"
            );
        }
        let one = SphereTrack::new(&[(10.0, a)]).expect("a point");
        assert_eq!((one.at(0.0), one.at(10.0), one.at(20.0)), (a, a, a));
        assert_eq!(
            NumberTrack::new(&[(1.0, 2.0)]).expect("a value").at(7.0),
            2.0
        );
        let line = NumberTrack::new(&[(1.0, 2.0), (3.0, 4.0)]).expect("values");
        assert!((line.at(1.5) - 2.5).abs() < 1e-15);
        assert!(NumberTrack::new(&[]).is_none() && SphereTrack::new(&[]).is_none());
    }

    /// Of points close together the curve is the flat one of Barry and Goldman, its knots the sums of the square roots of distances.
    #[test]
    fn the_curve_is_centripetal() {
        let scale = 1e-5;
        let flat =
            [(0.0, 0.0), (1.0, 0.0), (1.0, 9.0), (3.0, 9.0)].map(|(x, y)| DVec3::new(x, y, 0.0));
        let mut knots = vec![0.0];
        for pair in flat.windows(2) {
            knots.push(knots[knots.len() - 1] + (scale * (pair[1] - pair[0]).length()).sqrt());
        }
        let point = |flat: DVec3| DVec4::new(scale * flat.x, scale * flat.y, 1.0, 0.0).normalize();
        let points: Vec<_> = knots.iter().copied().zip(flat.map(point)).collect();
        let track = SphereTrack::new(&points).expect("points");
        for part in [0.2, 0.5, 0.9] {
            let u = knots[1] + part * (knots[2] - knots[1]);
            let between = |a: DVec3, b: DVec3, i: usize, k: usize| {
                a.lerp(b, (u - knots[i]) / (knots[k] - knots[i]))
            };
            let [a1, a2, a3] = [0, 1, 2].map(|i| between(flat[i], flat[i + 1], i, i + 1));
            let wanted = between(between(a1, a2, 0, 2), between(a2, a3, 1, 3), 1, 2);
            let found = track.at(u) / track.at(u).z / scale;
            assert!(
                (found.truncate().truncate() - wanted.truncate()).length() < 1e-4,
                "{part}"
            );
        }
    }

    /// An attitude and its opposite quaternion are one: the track takes the short way.
    #[test]
    fn attitudes_turn_the_short_way() {
        let turned = |deg: f64| DQuat::from_axis_angle(DVec3::Z, f64::to_radians(deg));
        let track = SphereTrack::of_attitudes(&[
            (0.0, turned(0.0)),
            (1.0, -turned(60.0)),
            (2.0, turned(120.0)),
        ]);
        let track = track.expect("points");
        for (time, deg) in [(0.5, 30.0), (1.0, 60.0), (1.75, 105.0)] {
            let at = DQuat::from_vec4(track.at(time));
            assert!(at.angle_between(turned(deg)) < 1e-7, "{time}");
        }
    }
}
