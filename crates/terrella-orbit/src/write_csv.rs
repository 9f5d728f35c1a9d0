//! States as CSV, in the columns that [`Ephemerides`](super::Ephemerides) reads.

use super::OrbitState;
use super::write_ccsds::{one_line, real, shifted};
use terrella_frames::{Geodetic, TimeScale, ccsds_time};

/// The header line of a table of [`csv_row`]: the column names with a line feed. Each row is complete in itself.
pub fn csv_header() -> &'static str {
    "name,frame,epoch_utc,x_km,y_km,z_km,vx_km_s,vy_km_s,vz_km_s,lat_deg,lon_deg,height_km,error_m\n"
}

/// One row for the satellite of that name, with a line feed. The state, in its own frame, has enough digits for an exact round trip; the
/// sub-satellite point has centimetres and is for people. `error_m`, metres, is the uncertainty ([`Feed::error_m`](super::Feed::error_m)); empty if
/// the source does not know it.
pub fn csv_row(name: &str, state: &OrbitState, place: &Geodetic, error_m: Option<f64>) -> String {
    let mut row = csv_field(name);
    for text in [state.frame.name(), &ccsds_time(state.epoch, TimeScale::Utc)] {
        row.push(',');
        row.push_str(text);
    }
    row.push('Z');
    let (r, v) = (state.position_m.to_array(), state.velocity_m_s.to_array());
    for metres in r.into_iter().chain(v) {
        row.push(',');
        row.push_str(&shifted(metres, -3));
    }
    row + &format!(
        ",{:.7},{:.7},{:.5},{}\n",
        place.lat_rad.to_degrees(),
        place.lon_rad.to_degrees(),
        place.height_m / 1e3,
        error_m.map(real).unwrap_or_default()
    )
}

/// Text on one line as RFC 4180 writes a field; one with a mark of comments is quoted too, as is one of nothing.
pub fn csv_field(text: &str) -> String {
    let text = one_line(text);
    match text.contains([',', '"', '#']) || text.is_empty() {
        true => format!("\"{}\"", text.replace('"', "\"\"")),
        false => text,
    }
}
