//! When it is night below the satellite, and when the satellite is in the Earth's shadow.

use super::super::flight::Flight;
use terrella::frames::{
    Duration, Ellipsoid, Epoch, Illumination, illumination, sun_position_itrf_m,
};
use terrella_orbit::Frame;

/// Step in which changes are looked for, seconds; a longer span is looked at in [`MOST_STEPS`].
const STEP_S: f64 = 30.0;
/// Most steps of a span.
const MOST_STEPS: f64 = 50_000.0;
/// How exactly a change is found, seconds.
const EXACT_S: f64 = 1.0;

/// Bands of the time line, each from its begin to its end.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LightBands {
    /// The ground below the satellite is in night.
    pub night: Vec<(Epoch, Epoch)>,
    /// The satellite is in the Earth's umbra.
    pub umbra: Vec<(Epoch, Epoch)>,
}

/// Both of the dark, in this order.
type Dark = [bool; 2];

impl LightBands {
    /// Bands of the followed satellite; `None` without one, and when the result is no longer needed. Times at which its feed fails are in no band.
    pub fn of(
        flight: &Flight,
        (first, last): (Epoch, Epoch),
        is_wanted: &dyn Fn() -> bool,
    ) -> Option<Self> {
        let length_s = (last - first).to_seconds();
        let steps = (length_s / STEP_S).ceil().clamp(1.0, MOST_STEPS);
        let at = |t_s: f64| first + Duration::from_seconds(t_s);
        flight.feed()?;
        let mut bands = [Vec::new(), Vec::new()];
        let mut begun: [Option<f64>; 2] = [None; 2];
        let mut before: (f64, Dark) = (0.0, [false; 2]);
        for step in 0..=steps as u64 {
            if !is_wanted() {
                return None;
            }
            let t_s = length_s * step as f64 / steps;
            let dark = is_dark(flight, at(t_s)).unwrap_or_default();
            for which in 0..2 {
                if dark[which] == before.1[which] && step > 0 {
                    continue;
                }
                let change_s = match step {
                    0 => t_s,
                    _ => change(before.0, t_s, |t_s| {
                        is_dark(flight, at(t_s)).unwrap_or_default()[which] == dark[which]
                    }),
                };
                match begun[which].take() {
                    Some(begin_s) => bands[which].push((at(begin_s), at(change_s))),
                    None if dark[which] => begun[which] = Some(change_s),
                    None => {}
                }
            }
            before = (t_s, dark);
        }
        for (band, begun) in bands.iter_mut().zip(begun) {
            band.extend(begun.map(|begin_s| (at(begin_s), last)));
        }
        let [night, umbra] = bands;
        Some(Self { night, umbra })
    }
}

/// `None` where the satellite is not known.
fn is_dark(flight: &Flight, epoch: Epoch) -> Option<Dark> {
    let state = flight.feed()?.state_at(epoch).ok()?;
    let orientation = flight.orientation_at(epoch);
    let place = state.in_frame(Frame::Itrf, &orientation).position_m;
    let sun_m = sun_position_itrf_m(epoch, &orientation);
    let below = flight.ellipsoid().geodetic_from_itrf(place);
    let up = Ellipsoid::normal(below.lat_rad, below.lon_rad);
    let (light, _) = illumination(place, sun_m, flight.ellipsoid());
    Some([up.dot(sun_m) <= 0.0, light == Illumination::Umbra])
}

/// The time between two at which `is_after` becomes true, by bisection.
fn change(mut before_s: f64, mut after_s: f64, is_after: impl Fn(f64) -> bool) -> f64 {
    while after_s - before_s > EXACT_S {
        let middle_s = 0.5 * (before_s + after_s);
        match is_after(middle_s) {
            true => after_s = middle_s,
            false => before_s = middle_s,
        }
    }
    after_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Scene;
    use std::path::Path;

    /// An equatorial circle at an equinox has the Sun in its plane: it is in the umbra for 2 asin(R / a) less the Sun's disc, and the ground
    /// below is dark for half of a revolution.
    #[test]
    fn bands_are_those_of_plane_geometry() {
        let axis_km = 6_778.0_f64;
        let period_s = std::f64::consts::TAU * (axis_km.powi(3) / 398_600.441_8).sqrt();
        let text = format!(
            "[time]\nstart = \"2018-03-20T16:15:00Z\"\nduration_s = {}\n[orbit]\nsource = \"kepler\"\nsemi_major_axis_km = {axis_km}\n",
            3.0 * period_s
        );
        let scene = Scene::from_toml(&text, Path::new("test.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        let first = flight.scene().time.start;
        let span = (first, first + Duration::from_seconds(3.0 * period_s));
        let found = LightBands::of(&flight, span, &|| true).expect("a satellite");
        let share = |bands: &[(Epoch, Epoch)]| {
            assert_eq!(bands.len(), 3, "{bands:?}");
            let all = bands
                .iter()
                .map(|(begin, end)| (*end - *begin).to_seconds());
            all.sum::<f64>() / (3.0 * period_s)
        };
        let disc = 0.533_f64.to_radians();
        let umbra = (2.0 * (6_378.137 / axis_km).asin() - disc) / std::f64::consts::TAU;
        assert!((share(&found.umbra) - umbra).abs() < 1e-3, "{umbra}");
        // In these minutes the Sun's direction is nearly constant, and the ground rotates with the Earth: neither shifts the half.
        assert!((share(&found.night) - 0.5).abs() < 1e-3);
        assert_eq!(LightBands::of(&flight, span, &|| false), None);
    }
}
