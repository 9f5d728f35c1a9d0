//! States as CSV, in the columns that [`Ephemerides`](super::Ephemerides) reads.

use super::write_ccsds::{one_line, shifted};
use super::{Frame, OrbitState};
use crate::frames::{Geodetic, TimeScale, ccsds_time};

/// The two lines before the rows of [`csv_row`]: what the numbers are, and the names of the columns. Both are ended.
pub fn csv_header(name: &str, frame: Frame) -> String {
    // The line is read as a list of key = value.
    let name = one_line(name).replace([',', '='], " ");
    format!(
        "# frame = {}, scale = UTC, name = {name}\n\
         epoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s,lat_deg,lon_deg,height_km\n",
        frame.name()
    )
}

/// One row, ended. The state has as many digits as it takes to read the same one back, the place below it is to a
/// centimetre and for people.
pub fn csv_row(state: &OrbitState, place: &Geodetic) -> String {
    let mut row = ccsds_time(state.epoch, TimeScale::Utc) + "Z";
    let (r, v) = (state.position_m.to_array(), state.velocity_m_s.to_array());
    for metres in r.into_iter().chain(v) {
        row.push(',');
        row.push_str(&shifted(metres, -3));
    }
    row + &format!(
        ",{:.7},{:.7},{:.5}\n",
        place.lat_rad.to_degrees(),
        place.lon_rad.to_degrees(),
        place.height_m / 1e3
    )
}
