//! Mean elements for SGP4, however they were written.

use sgp4::chrono::{NaiveDate, NaiveDateTime, TimeDelta};
use terrella_frames::{Calendar, Epoch, utc_day};

/// One satellite's mean elements for SGP4 (WGS72, TEME): what a two-line set or an OMM holds.
#[derive(Clone, Debug, PartialEq)]
pub struct MeanElements {
    /// The satellite's name, or its catalogue number as in the file if it has none.
    pub name: String,
    /// The international designator, `1998-067A`.
    pub object_id: Option<String>,
    /// The number in the US catalogue.
    pub catalogue_number: u64,
    /// The epoch that they hold at.
    pub epoch: Epoch,
    /// Revolutions per day, after Kozai as published.
    pub mean_motion_rev_day: f64,
    /// Eccentricity, 0…1.
    pub eccentricity: f64,
    /// Inclination, 0…180°.
    pub inclination_deg: f64,
    /// Right ascension of the ascending node (RAAN), degrees.
    pub raan_deg: f64,
    /// Argument of perigee, degrees.
    pub arg_perigee_deg: f64,
    /// Mean anomaly, degrees.
    pub mean_anomaly_deg: f64,
    /// B*, per Earth radius.
    pub drag_term_per_er: f64,
    /// As published, half of the first derivative of the mean motion, rev/day². SGP4 does not use it.
    pub mean_motion_dot: f64,
    /// As published, a sixth of its second derivative, rev/day³. SGP4 does not use it.
    pub mean_motion_ddot: f64,
    /// Which set of this satellite.
    pub element_set_number: u64,
    /// Revolutions since launch.
    pub revolution_number: u64,
}

impl MeanElements {
    /// As the SGP4 propagator takes them.
    pub(super) fn for_sgp4(&self) -> sgp4::Elements {
        sgp4::Elements {
            object_name: None,
            international_designator: None,
            norad_id: self.catalogue_number,
            classification: sgp4::Classification::Unclassified,
            datetime: datetime(self.epoch),
            mean_motion_dot: self.mean_motion_dot,
            mean_motion_ddot: self.mean_motion_ddot,
            drag_term: self.drag_term_per_er,
            element_set_number: self.element_set_number,
            inclination: self.inclination_deg,
            right_ascension: self.raan_deg,
            eccentricity: self.eccentricity,
            argument_of_perigee: self.arg_perigee_deg,
            mean_anomaly: self.mean_anomaly_deg,
            mean_motion: self.mean_motion_rev_day,
            revolution_number: self.revolution_number,
            ephemeris_type: 0,
        }
    }
}

/// The UTC date from which SGP4 computes sidereal time; a leap second becomes the first second of the next day.
fn datetime(epoch: Epoch) -> NaiveDateTime {
    let (mjd, ns_of_day) = utc_day(epoch);
    let date = Calendar::from_mjd(mjd);
    let parts = (
        i32::try_from(date.year).ok(),
        u32::try_from(date.month).ok(),
        u32::try_from(date.day).ok(),
    );
    let naive = match parts {
        (Some(year), Some(month), Some(day)) => NaiveDate::from_ymd_opt(year, month, day),
        _ => None,
    };
    // Years outside chrono's ±262 000 have no satellites.
    let midnight = naive.unwrap_or_default().and_time(Default::default());
    midnight
        .checked_add_signed(TimeDelta::nanoseconds(ns_of_day))
        .unwrap_or(midnight)
}
