//! State vectors: position and velocity, and the step from inertial axes to the turning Earth.

use glam::{DMat3, DVec3};
use terrella_frames::{
    EARTH_ROTATION_RATE_RAD_S, Epoch, Orientation, gcrf_from_eme2000, itrf_from_gcrf_oriented,
    itrf_from_pef, pef_from_teme,
};

/// The axes that a state is given in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// True equator, mean equinox of date: what SGP4 gives.
    Teme,
    /// Earth-fixed, z to the pole of rotation: ITRF before polar motion.
    Pef,
    /// Earth-fixed, with polar motion.
    Itrf,
    /// The celestial reference frame (CCSDS name ICRF, where about the Earth's centre).
    Gcrf,
    /// Mean equator and equinox of J2000, 0.02″ from GCRF.
    Eme2000,
}

impl Frame {
    /// All frames.
    pub const ALL: [Self; 5] = [Self::Teme, Self::Pef, Self::Itrf, Self::Gcrf, Self::Eme2000];

    /// As CCSDS files and the command line write it, in capitals.
    pub fn name(self) -> &'static str {
        match self {
            Self::Teme => "TEME",
            Self::Pef => "PEF",
            Self::Itrf => "ITRF",
            Self::Gcrf => "GCRF",
            Self::Eme2000 => "EME2000",
        }
    }

    /// The frame that a CCSDS file names, about the Earth's centre: `ICRF`, `GCRF`, `EME2000`, `TEME`, `ITRF2000`,
    /// `ITRF-97`…; letter case aside. Realisations of ITRF differ by centimetres and are taken as one. `ICRS` is what
    /// nyx-space calls ICRF. `GTOD` and `TDR` (true of date, turning with the Earth) are [`Frame::Pef`], `GRC`
    /// (Greenwich rotating coordinates) is taken with polar motion as Orekit takes it.
    pub fn from_ccsds_name(name: &str) -> Option<Self> {
        let name = name.to_ascii_uppercase();
        // The name is followed at most by the year or number of a realisation.
        let begins = |with: &str| {
            name.strip_prefix(with).is_some_and(|rest| {
                let number = rest.strip_prefix('-').unwrap_or(rest);
                number.bytes().all(|c| c.is_ascii_digit())
            })
        };
        match name.as_str() {
            "TEME" | "TEMEOFDATE" => Some(Self::Teme),
            "EME2000" | "J2000" => Some(Self::Eme2000),
            "PEF" | "GTOD" | "TDR" => Some(Self::Pef),
            "GRC" => Some(Self::Itrf),
            "ICRS" => Some(Self::Gcrf),
            _ if begins("ITRF") => Some(Self::Itrf),
            _ if begins("ICRF") || begins("GCRF") => Some(Self::Gcrf),
            _ => None,
        }
    }

    /// Whether it rotates with the Earth.
    pub fn is_earth_fixed(self) -> bool {
        matches!(self, Self::Pef | Self::Itrf)
    }

    /// Rotation that takes these axes to ITRF axes at `epoch`.
    pub fn itrf_from(self, epoch: Epoch, orientation: &Orientation) -> DMat3 {
        match self {
            Self::Itrf => DMat3::IDENTITY,
            Self::Pef => itrf_from_pef(orientation),
            Self::Teme => itrf_from_pef(orientation) * pef_from_teme(epoch, orientation),
            Self::Gcrf => itrf_from_gcrf_oriented(epoch, orientation),
            Self::Eme2000 => itrf_from_gcrf_oriented(epoch, orientation) * gcrf_from_eme2000(),
        }
    }
}

/// A state vector: position and velocity at an epoch, in the axes of `frame`, about the Earth's centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OrbitState {
    /// When the state holds.
    pub epoch: Epoch,
    /// The axes that it is given in.
    pub frame: Frame,
    /// Position, metres.
    pub position_m: DVec3,
    /// Velocity as seen in `frame`, metres per second.
    pub velocity_m_s: DVec3,
}

impl OrbitState {
    /// The same state in other axes; a velocity is the one that is seen from them.
    ///
    /// Between Earth-fixed axes and others v = R⁻¹(v_fixed + ω × r). The slow turn of TEME and of the equator of date
    /// against the stars, 7e-12 rad/s, is left out of velocities: 5e-5 m/s in low orbit.
    pub fn in_frame(&self, frame: Frame, orientation: &Orientation) -> Self {
        if frame == self.frame {
            return *self;
        }
        let itrf_from_own = self.frame.itrf_from(self.epoch, orientation);
        let frame_from_itrf = frame.itrf_from(self.epoch, orientation).transpose();
        let position_itrf_m = itrf_from_own * self.position_m;
        let turning = rotation_rad_s(orientation).cross(position_itrf_m);
        let seen_from_stars = match self.frame.is_earth_fixed() {
            true => itrf_from_own * self.velocity_m_s + turning,
            false => itrf_from_own * self.velocity_m_s,
        };
        let velocity_itrf_axes = match frame.is_earth_fixed() {
            true => seen_from_stars - turning,
            false => seen_from_stars,
        };
        Self {
            epoch: self.epoch,
            frame,
            position_m: frame_from_itrf * position_itrf_m,
            velocity_m_s: frame_from_itrf * velocity_itrf_axes,
        }
    }

    /// Position in ITRF, metres, and the velocity as seen from the stars, metres per second, its components along the ITRF
    /// axes of this instant: the direction of flight for cameras.
    pub fn inertial_in_itrf_axes(&self, orientation: &Orientation) -> (DVec3, DVec3) {
        let itrf = self.in_frame(Frame::Itrf, orientation);
        let turning = rotation_rad_s(orientation).cross(itrf.position_m);
        (itrf.position_m, itrf.velocity_m_s + turning)
    }

    /// The same state in ITRF, UT1 taken as UTC and polar motion left out.
    pub fn in_itrf(&self) -> Self {
        self.in_frame(Frame::Itrf, &Orientation::default())
    }

    /// Position in ITRF, metres; UT1 taken as UTC and polar motion left out.
    pub fn position_itrf_m(&self) -> DVec3 {
        self.frame.itrf_from(self.epoch, &Orientation::default()) * self.position_m
    }

    /// Velocity as seen from the stars, its components along the ITRF axes of this instant, metres per second.
    ///
    /// The direction of flight for cameras, in the orbital plane.
    pub fn inertial_velocity_itrf_axes_m_s(&self) -> DVec3 {
        self.inertial_in_itrf_axes(&Orientation::default()).1
    }
}

/// ω, the Earth's rotation, in ITRF axes.
fn rotation_rad_s(orientation: &Orientation) -> DVec3 {
    itrf_from_pef(orientation) * DVec3::new(0.0, 0.0, EARTH_ROTATION_RATE_RAD_S)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn states_come_back_from_every_frame() {
        let orientation = Orientation {
            ut1_minus_utc_s: -0.4,
            x_pole_rad: 1e-6,
            y_pole_rad: 2e-6,
        };
        for from in Frame::ALL {
            let state = OrbitState {
                epoch: Epoch::from_gregorian_utc(2018, 1, 15, 12, 0, 0, 0),
                frame: from,
                position_m: DVec3::new(5e6, -3e6, 3.5e6),
                velocity_m_s: DVec3::new(4e3, 6e3, -1e3),
            };
            for to in Frame::ALL {
                let there = state.in_frame(to, &orientation);
                assert!(
                    (there.position_m.length() / state.position_m.length() - 1.0).abs() < 1e-14
                );
                let back = there.in_frame(from, &orientation);
                assert!(
                    (back.position_m - state.position_m).length() < 1e-7,
                    "{from:?} {to:?}"
                );
                assert!((back.velocity_m_s - state.velocity_m_s).length() < 1e-10);
            }
        }
    }

    #[test]
    fn frames_lie_as_far_apart_as_is_known() {
        let epoch = Epoch::from_gregorian_utc(2018, 1, 15, 12, 0, 0, 0);
        let none = Orientation::default();
        let apart = |a: Frame, b: Frame, o: &Orientation| {
            let state = OrbitState {
                epoch,
                frame: a,
                position_m: DVec3::X,
                velocity_m_s: DVec3::ZERO,
            };
            state
                .in_frame(b, o)
                .position_m
                .cross(DVec3::X)
                .length()
                .to_degrees()
                * 3600.0
        };
        // The frame bias is 0.023″ at most; TEME of 2018 is 18 years of precession from J2000, 15 minutes of arc.
        let bias = apart(Frame::Eme2000, Frame::Gcrf, &none);
        assert!((0.005..0.03).contains(&bias), "{bias}");
        let precessed = apart(Frame::Teme, Frame::Gcrf, &none);
        assert!((800.0..950.0).contains(&precessed), "{precessed}");
        let pole = Orientation {
            x_pole_rad: 0.3_f64.to_radians() / 3600.0,
            ..none
        };
        assert!((apart(Frame::Pef, Frame::Itrf, &pole) - 0.3).abs() < 1e-6);
    }
}
