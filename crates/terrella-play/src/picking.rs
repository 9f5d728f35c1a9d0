//! The object under a click, and the information about it.

use super::flight::{Flight, Moment};
use super::orbit_camera::Globe;
use super::place_text::place_text;
use glam::{DVec2, DVec3, DVec4};
use terrella::EyeView;
use terrella::frames::{Epoch, Geodetic};

/// How far from a satellite's marker a click still means it, pixels.
pub const MARKER_PX: f64 = 10.0;

/// The selection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Picked {
    /// A satellite, by its place in the scene.
    Satellite(usize),
    /// A place of the ground.
    Place(Geodetic),
}

/// Information about it.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOut {
    /// The satellite's name, or what it is.
    pub title: String,
    /// Labels and values.
    pub rows: Vec<(&'static str, String)>,
    /// Where it is on screen, parts of the picture's width and height; `None` where it is not to be seen.
    pub at: Option<DVec2>,
    /// Latitude and longitude of a place that satellites can pass over, degrees.
    pub passes_over_deg: Option<[f64; 2]>,
}

/// Where a point is on screen, parts of the picture's width and height from the upper left corner; `None` behind the eye.
pub fn on_screen(view: &EyeView, point_itrf_m: DVec3) -> Option<DVec2> {
    let (eye_itrf_m, clip_from_itrf) = view.to_itrf();
    let clip: DVec4 = clip_from_itrf * (point_itrf_m - eye_itrf_m).extend(1.0);
    let at = DVec2::new(0.5 + 0.5 * clip.x / clip.w, 0.5 - 0.5 * clip.y / clip.w);
    (clip.w > 0.0 && at.is_finite()).then_some(at)
}

/// Whether the ground hides a point from the eye.
fn is_hidden(view: &EyeView, globe: &Globe<'_>, point_itrf_m: DVec3) -> bool {
    let (eye_itrf_m, _) = view.to_itrf();
    let away = point_itrf_m - eye_itrf_m;
    let Some(ray) = away.try_normalize() else {
        return true;
    };
    let met = globe.meet(eye_itrf_m, ray);
    // A place of the ground is met itself, to rounding.
    met.is_some_and(|met| met.distance(eye_itrf_m) < 0.999 * away.length() - 1.0)
}

/// What is under a pixel of a picture: the nearest of the satellites that are drawn close by, else the ground. `near` are those whose markers
/// are there, by their places in the scene.
pub fn pick(
    flight: &Flight,
    moment: &Moment,
    globe: &Globe<'_>,
    size_px: DVec2,
    at_px: DVec2,
    near: &[usize],
) -> Option<Picked> {
    let view = &moment.view;
    let (eye_itrf_m, _) = view.to_itrf();
    // The craft of the chase camera has no marker.
    let craft = moment.craft.map(|_| flight.followed());
    let near = near.iter().copied().chain(craft).filter_map(|index| {
        let position = flight.motion_of(index, moment.epoch).ok()?.position_itrf_m;
        let off_px = (on_screen(view, position)? * size_px).distance(at_px);
        let is_near = off_px <= MARKER_PX && position.distance(eye_itrf_m) > 1.0;
        (is_near && !is_hidden(view, globe, position)).then_some((index, off_px))
    });
    if let Some((index, _)) = near.min_by(|one, other| one.1.total_cmp(&other.1)) {
        return Some(Picked::Satellite(index));
    }
    let ray = ray(view, size_px, at_px)?;
    let met = globe.meet(eye_itrf_m, ray)?;
    Some(Picked::Place(globe.ellipsoid.geodetic_from_itrf(met)))
}

/// The direction of a pixel, ITRF, unit.
pub fn ray(view: &EyeView, size_px: DVec2, at_px: DVec2) -> Option<DVec3> {
    if size_px.min_element() < 1.0 {
        return None;
    }
    let size = (size_px.x as u32, size_px.y as u32);
    let rays = view.pixel_rays(size.into());
    let ray = rays.corner + at_px.x * rays.right + at_px.y * rays.down;
    ray.try_normalize()
}

/// Information about a selection at a moment; `None` if it has no state any longer.
pub fn read_out(
    flight: &Flight,
    moment: &Moment,
    globe: &Globe<'_>,
    picked: Picked,
) -> Option<ReadOut> {
    let (title, place, speed_m_s) = match picked {
        Picked::Place(place) => ("Place".to_owned(), place, None),
        Picked::Satellite(index) => {
            let motion = flight.motion_of(index, moment.epoch).ok()?;
            let name = flight.satellites().get(index)?.name();
            let place = flight
                .ellipsoid()
                .geodetic_from_itrf(motion.position_itrf_m);
            (name.to_owned(), place, Some(motion.velocity_m_s.length()))
        }
    };
    let point_itrf_m = globe.ellipsoid.itrf_from_geodetic(place);
    let at = on_screen(&moment.view, point_itrf_m);
    let mut rows = vec![
        ("position", place_text(place.lat_rad, place.lon_rad)),
        ("altitude", altitude_text(place.height_m)),
    ];
    if let Some(speed_m_s) = speed_m_s {
        rows.push(("speed", format!("{:.3} km/s", speed_m_s / 1000.0)));
    }
    let sun = moment.sky.sun_itrf;
    let solar_time = clock_text(apparent_solar_time_h(sun, place.lon_rad));
    rows.push(("solar time", format!("{solar_time} (apparent)")));
    Some(ReadOut {
        title,
        rows,
        passes_over_deg: match picked {
            Picked::Place(place) if flight.feed().is_some() && !flight.scene().is_live() => {
                Some([place.lat_rad, place.lon_rad].map(f64::to_degrees))
            }
            _ => None,
        },
        at: at.filter(|_| !is_hidden(&moment.view, globe, point_itrf_m)),
    })
}

/// The position of a satellite that can be followed.
pub fn position_of(flight: &Flight, satellite: usize, epoch: Epoch) -> Option<DVec3> {
    Some(flight.motion_of(satellite, epoch).ok()?.position_itrf_m)
}

/// Local apparent solar time, hours 0…24: noon is when the Sun is in the meridian.
pub fn apparent_solar_time_h(sun_itrf: DVec3, lon_rad: f64) -> f64 {
    let hour_angle_rad = lon_rad - sun_itrf.y.atan2(sun_itrf.x);
    (12.0 + hour_angle_rad.to_degrees() / 15.0).rem_euclid(24.0)
}

fn clock_text(hours: f64) -> String {
    let minutes = (60.0 * hours).round() as u32 % (24 * 60);
    format!("{:02}:{:02}", minutes / 60, minutes % 60)
}

/// In metres if kilometres would be too coarse.
pub fn altitude_text(height_m: f64) -> String {
    match height_m.abs() < 10_000.0 {
        // No negative zero.
        true => format!("{:.0} m", height_m.round() + 0.0),
        false => format!("{:.1} km", height_m / 1000.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{CameraMode, Scene};
    use std::path::Path;
    use terrella::Sky;
    use terrella::frames::Ellipsoid;

    const SIZE: DVec2 = DVec2::new(1280.0, 720.0);

    fn globe() -> Globe<'static> {
        Globe {
            ellipsoid: Ellipsoid::WGS84,
            ground: None,
        }
    }

    fn over_the_satellite(marker: bool) -> (Flight, Moment) {
        let text = format!("[camera]\nmode = \"geodetic\"\n[orbit]\nmarker = {marker}\n");
        let scene = Scene::from_toml(&text, Path::new("test.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        let epoch = flight.scene().time.start;
        let mut moment = flight.at(epoch, SIZE.x / SIZE.y).expect("a moment");
        let motion = flight.motion_of(0, epoch).expect("known");
        let eye = 1.4 * motion.position_itrf_m;
        moment.view = EyeView::itrf(eye, -eye, DVec3::Z, 0.8, SIZE.x / SIZE.y);
        (flight, moment)
    }

    #[test]
    fn a_click_means_the_marker_close_by_and_else_the_ground() {
        let (flight, moment) = over_the_satellite(true);
        assert_eq!(flight.scene().camera.mode, CameraMode::Geodetic);
        let pick = |at: DVec2| pick(&flight, &moment, &globe(), SIZE, at, &[0]);
        let middle = 0.5 * SIZE;
        assert_eq!(
            pick(middle + DVec2::new(6.0, 6.0)),
            Some(Picked::Satellite(0))
        );
        let Some(Picked::Place(place)) = pick(middle + DVec2::new(9.0, 9.0)) else {
            panic!("not the ground");
        };
        assert!(place.height_m.abs() < 1e-3, "{place:?}");
        // The place is drawn at the position of the click.
        let point = Ellipsoid::WGS84.itrf_from_geodetic(place);
        let drawn = on_screen(&moment.view, point).expect("ahead") * SIZE;
        assert!(
            drawn.distance(middle + DVec2::new(9.0, 9.0)) < 1e-3,
            "{drawn}"
        );
        let away = EyeView::itrf(2.0 * moment.view.eye_world, DVec3::Z, DVec3::X, 0.8, 1.0);
        let space = Moment {
            view: away,
            ..moment
        };
        assert_eq!(
            super::pick(&flight, &space, &globe(), SIZE, middle, &[0]),
            None
        );
    }

    #[test]
    fn a_satellite_that_is_not_drawn_or_hidden_is_not_picked() {
        let (flight, moment) = over_the_satellite(false);
        let picked = pick(&flight, &moment, &globe(), SIZE, 0.5 * SIZE, &[]);
        assert!(matches!(picked, Some(Picked::Place(_))), "{picked:?}");
        let (flight, mut moment) = over_the_satellite(true);
        let eye = -2.0 * moment.view.eye_world;
        moment.view = EyeView::itrf(eye, -eye, DVec3::Z, 0.8, SIZE.x / SIZE.y);
        let picked = pick(&flight, &moment, &globe(), SIZE, 0.5 * SIZE, &[0]);
        assert!(matches!(picked, Some(Picked::Place(_))), "{picked:?}");
        let hidden = read_out(&flight, &moment, &globe(), Picked::Satellite(0));
        assert_eq!(hidden.expect("known").at, None);
    }

    #[test]
    fn a_read_out_says_what_and_where() {
        let (flight, moment) = over_the_satellite(true);
        let said = read_out(&flight, &moment, &globe(), Picked::Satellite(0)).expect("known");
        assert_eq!(said.title, "ISS (ZARYA)");
        let names: Vec<_> = said.rows.iter().map(|(name, _)| *name).collect();
        assert_eq!(names, ["position", "altitude", "speed", "solar time"]);
        assert!(said.rows[1].1.ends_with(" km"), "{said:?}");
        assert!(said.at.expect("seen").distance(DVec2::splat(0.5)) < 1e-6);
        let place = Picked::Place(Geodetic::from_degrees(-33.0, 151.0, 12.0));
        let said = read_out(&flight, &moment, &globe(), place).expect("always");
        assert_eq!(said.rows[0].1, "33.000° S, 151.000° E");
        assert_eq!(said.rows[1].1, "12 m");
    }

    #[test]
    fn solar_time_is_noon_where_the_sun_is_in_the_meridian() {
        let sun = DVec3::new(0.0, 0.9, 0.4);
        assert!((apparent_solar_time_h(sun, 90f64.to_radians()) - 12.0).abs() < 1e-9);
        assert!((apparent_solar_time_h(sun, -90f64.to_radians()) % 24.0) < 1e-9);
        assert!((apparent_solar_time_h(sun, 0.0) - 6.0).abs() < 1e-9);
        // At Greenwich noon of 3 November the Sun is 16.4 minutes ahead of the mean.
        let noon = Epoch::from_gregorian_utc(2018, 11, 3, 12, 0, 0, 0);
        let minutes = 60.0 * (apparent_solar_time_h(Sky::at(noon).sun_itrf, 0.0) - 12.0);
        assert!((minutes - 16.4).abs() < 0.2, "{minutes}");
        assert_eq!(clock_text(23.999), "00:00");
        assert_eq!(clock_text(6.5), "06:30");
    }

    /// 30 000 satellites, and a click on each of a hundred of them and a hundred on nothing: what it takes, without what the next picture does.
    ///
    /// `cargo test --release -p terrella-play --features window print_picking -- --ignored --nocapture`
    #[test]
    #[ignore = "measures"]
    fn print_picking_times() {
        let many = "[[orbit]]\nsource = \"kepler\"\nwalker = \"53:15000/100/1\"\naltitude_km = 550\nmarker = true\n";
        let text = format!(
            "[camera]\nmode = \"geodetic\"\nheight_km = 20000\n{many}{}",
            many.replace("550", "1150")
        );
        let scene = Scene::from_toml(&text, Path::new("test.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        assert_eq!(flight.satellites().len(), 30_000);
        let gpu = terrella::OffscreenEarth::open_gpu(None).expect("an adapter");
        let options = flight.uploaded_options(&gpu).expect("maps");
        let size = (SIZE.x as u32, SIZE.y as u32);
        let shown = terrella::internals::gpu::FrameTargets::COLOR;
        let mut painter =
            crate::scene_painter::ScenePainter::new(gpu, &options, shown).expect("opens");
        let epoch = flight.scene().time.start;
        // Median of 20 frames.
        let prepared_ms = |painter: &mut crate::scene_painter::ScenePainter| {
            let mut times: Vec<_> = (0..20)
                .map(|second| {
                    let epoch = epoch + terrella::frames::Duration::from_seconds(f64::from(second));
                    let began = std::time::Instant::now();
                    let moment = flight.at(epoch, SIZE.x / SIZE.y).expect("a moment");
                    painter.prepare(&moment, size, crate::scene_painter::Patience::Live);
                    began.elapsed().as_secs_f64() * 1e3
                })
                .collect();
            times.sort_by(f64::total_cmp);
            times[10]
        };
        println!(
            "{:.1} ms to prepare a frame without satellites",
            prepared_ms(&mut painter)
        );
        painter.show_tracks(&flight).expect("tracks");
        let moment = flight.at(epoch, SIZE.x / SIZE.y).expect("a moment");
        painter.prepare(&moment, size, crate::scene_painter::Patience::Live);
        let labels: Vec<_> = painter.markers_near([0.0, 0.0], 1e9).collect();
        println!("{} dots in sight", labels.len());
        println!(
            "{:.1} ms to prepare a frame with them",
            prepared_ms(&mut painter)
        );
        let mut times = Vec::new();
        let mut found = 0;
        for step in 0..200 {
            let on_one = (step % 2 == 0).then(|| labels[step * labels.len() / 200]);
            let at = match on_one {
                Some(index) => {
                    let motion = flight.motion_of(index, epoch).expect("known");
                    on_screen(&moment.view, motion.position_itrf_m).expect("ahead") * SIZE
                }
                None => DVec2::new(6.4 * step as f64, 3.6 * step as f64),
            };
            let began = std::time::Instant::now();
            let near: Vec<_> =
                (painter.markers_near(at.as_vec2().to_array(), 1.0 + MARKER_PX as f32)).collect();
            let picked = pick(&flight, &moment, &globe(), SIZE, at, &near);
            times.push(began.elapsed().as_secs_f64() * 1e3);
            if let (Some(_), Some(Picked::Satellite(_))) = (on_one, picked) {
                found += 1;
            }
        }
        times.sort_by(f64::total_cmp);
        println!(
            "{found} of 100 found; {:.3} ms median, {:.3} ms at most",
            times[100], times[199]
        );
        assert_eq!(found, 100);
    }
}
