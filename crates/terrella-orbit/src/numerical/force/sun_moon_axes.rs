//! Sun, Moon and the Earth's axes along a span, interpolated.

use glam::{DMat3, DVec3};
use std::f64::consts::{PI, TAU};
use terrella_frames::{
    Duration, EARTH_ROTATION_RATE_RAD_S, Epoch, Orientation, earth_rotation_angle_rad,
    intermediate_from_gcrf, itrf_from_pef, moon_position_gcrf_m, sun_position_gcrf_m,
};

/// Length of a piece, seconds.
const PIECE_S: f64 = 4.0 * 86_400.0;
/// Chebyshev nodes in a piece: leaves 1e-3 m of the Moon's place and 1e-13 of the axes.
const NODES: usize = 13;
/// Numbers kept: Sun, Moon, three columns of a matrix.
const SERIES: usize = 15;
/// The Earth's turn against its own origin of the equator, radians per second of UT1 (IERS Conventions 2010, 5.15).
const ROTATION_RAD_S: f64 = TAU * 1.002_737_811_911_354_5 / 86_400.0;

#[derive(Clone, Debug)]
struct Piece {
    number: i64,
    /// Chebyshev coefficients.
    series: Box<[[f64; NODES]; SERIES]>,
}

/// Where Sun, Moon and the axes are, seconds from an epoch. Each is looked up at its source a few times in four days and
/// interpolated between.
///
/// The Earth turns on steadily from its angle at the epoch: a leap second on the way, after which UT1 − UTC as given would
/// be a second out, is no step here.
#[derive(Clone, Debug)]
pub(in crate::numerical) struct SunMoonAxes {
    epoch: Epoch,
    angle_rad: f64,
    itrf_from_pef: DMat3,
    pieces: [Option<Piece>; 2],
    older: usize,
}

impl SunMoonAxes {
    pub fn new(epoch: Epoch, orientation: &Orientation) -> Self {
        Self {
            epoch,
            angle_rad: earth_rotation_angle_rad(epoch, orientation.ut1_minus_utc_s),
            itrf_from_pef: itrf_from_pef(orientation),
            pieces: [None, None],
            older: 0,
        }
    }

    /// The Sun's place in GCRF, metres.
    pub fn sun_m(&mut self, t: f64) -> DVec3 {
        self.vector(t, 0)
    }

    /// The Moon's place in GCRF, metres.
    pub fn moon_m(&mut self, t: f64) -> DVec3 {
        self.vector(t, 3)
    }

    /// The axes of the equator of date: z to the pole, not turning with the Earth.
    pub fn intermediate_from_gcrf(&mut self, t: f64) -> DMat3 {
        DMat3::from_cols(self.vector(t, 6), self.vector(t, 9), self.vector(t, 12))
    }

    /// The Earth-fixed axes.
    pub fn itrf_from_gcrf(&mut self, t: f64) -> DMat3 {
        let (sin, cos) = (self.angle_rad + ROTATION_RAD_S * t).sin_cos();
        let turn = DMat3::from_cols(
            DVec3::new(cos, -sin, 0.0),
            DVec3::new(sin, cos, 0.0),
            DVec3::Z,
        );
        self.itrf_from_pef * turn * self.intermediate_from_gcrf(t)
    }

    /// The Earth's rotation as a vector in GCRF, radians per second.
    pub fn rotation_rad_s(&mut self, t: f64) -> DVec3 {
        self.intermediate_from_gcrf(t).row(2) * EARTH_ROTATION_RATE_RAD_S
    }

    fn vector(&mut self, t: f64, first: usize) -> DVec3 {
        let number = (t / PIECE_S).floor();
        let x = 2.0 * (t / PIECE_S - number) - 1.0;
        let piece = self.piece(number as i64);
        let value = |row: &[f64; NODES]| {
            // Clenshaw's recurrence.
            let (mut b1, mut b2) = (0.0, 0.0);
            for c in row[1..].iter().rev() {
                (b1, b2) = (2.0 * x * b1 - b2 + c, b1);
            }
            x * b1 - b2 + row[0]
        };
        let rows = &piece.series;
        DVec3::new(
            value(&rows[first]),
            value(&rows[first + 1]),
            value(&rows[first + 2]),
        )
    }

    fn piece(&mut self, number: i64) -> &Piece {
        let held = |p: &Option<Piece>| p.as_ref().is_some_and(|p| p.number == number);
        let slot = match self.pieces.iter().position(held) {
            Some(slot) => slot,
            None => {
                let slot = self.older;
                self.pieces[slot] = None;
                slot
            }
        };
        // Two are kept: the stages of a step may be on both sides of a boundary.
        self.older = 1 - slot;
        let epoch = self.epoch;
        self.pieces[slot].get_or_insert_with(|| Piece::at(epoch, number))
    }
}

impl Piece {
    fn at(epoch: Epoch, number: i64) -> Self {
        let angles: [f64; NODES] = std::array::from_fn(|k| PI * (k as f64 + 0.5) / NODES as f64);
        let values = angles.map(|angle| {
            let t = (number as f64 + 0.5 * (angle.cos() + 1.0)) * PIECE_S;
            let at = epoch + Duration::from_seconds(t);
            let axes = intermediate_from_gcrf(at);
            let vectors = [
                sun_position_gcrf_m(at),
                moon_position_gcrf_m(at),
                axes.x_axis,
                axes.y_axis,
                axes.z_axis,
            ];
            let mut row = [0.0; SERIES];
            for (three, vector) in row.chunks_exact_mut(3).zip(vectors) {
                three.copy_from_slice(&vector.to_array());
            }
            row
        });
        let mut series = Box::new([[0.0; NODES]; SERIES]);
        for (s, row) in series.iter_mut().enumerate() {
            for (j, c) in row.iter_mut().enumerate() {
                let sum: f64 = (0..NODES)
                    .map(|k| values[k][s] * (j as f64 * angles[k]).cos())
                    .sum();
                *c = sum * if j == 0 { 1.0 } else { 2.0 } / NODES as f64;
            }
        }
        Self { number, series }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella_frames::{itrf_from_gcrf_oriented, utc_from_rfc3339};

    #[test]
    fn interpolated_is_as_computed() {
        let epoch = utc_from_rfc3339("2018-01-15T12:34:56Z").unwrap();
        let orientation = Orientation {
            ut1_minus_utc_s: -0.2,
            x_pole_rad: 1e-6,
            y_pole_rad: 2e-6,
        };
        let mut sky = SunMoonAxes::new(epoch, &orientation);
        for k in -200..200 {
            let t = f64::from(k) * 17_777.7;
            let at = epoch + Duration::from_seconds(t);
            assert!(
                (sky.sun_m(t) - sun_position_gcrf_m(at)).length() < 0.1,
                "{k}"
            );
            assert!(
                (sky.moon_m(t) - moon_position_gcrf_m(at)).length() < 0.1,
                "{k}"
            );
            let axes = itrf_from_gcrf_oriented(at, &orientation);
            assert!(sky.itrf_from_gcrf(t).abs_diff_eq(axes, 3e-11), "{k}");
        }
    }

    #[test]
    fn a_leap_second_is_no_step() {
        let epoch = utc_from_rfc3339("2016-12-31T12:00:00Z").unwrap();
        let mut sky = SunMoonAxes::new(epoch, &Orientation::default());
        let (before, after) = (sky.itrf_from_gcrf(43_200.0), sky.itrf_from_gcrf(43_201.5));
        let turned = before.x_axis.angle_between(after.x_axis);
        assert!(
            (turned / (1.5 * EARTH_ROTATION_RATE_RAD_S) - 1.0).abs() < 1e-3,
            "{turned}"
        );
    }
}
