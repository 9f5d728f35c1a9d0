//! Passes of a scene's satellites over a place.

use crate::failure::{Failure, TerrellaStatus, answer};
use crate::pointers::{check_out, read, write};
use crate::scene::{TerrellaScene, with_satellite};
use crate::time::TerrellaTime;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation, rfc3339};
use terrella_orbit::{Feed, Observer, OrbitError, Pass, VisibilityRule, passes, visible_intervals};

/// Place and time interval of a search for passes.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrellaPassSearch {
    /// Geodetic latitude (WGS84), degrees, −90 to 90.
    pub lat_deg: f64,
    /// Longitude east, degrees, −360 to 360.
    pub lon_deg: f64,
    /// Height above the ellipsoid, metres, −12 000 to 100 000.
    pub height_m: f64,
    /// Elevation mask: how high above the horizon a pass begins and ends, degrees, 0 to 89.999.
    pub min_elevation_deg: f64,
    /// Passes that are in progress at this instant or begin later.
    pub from: TerrellaTime,
    /// And that begin before this one. It is not before `from`.
    pub until: TerrellaTime,
    /// The satellite can be seen while it is outside the Earth's umbra and the Sun is lower than this, degrees, −90 to 90. Civil twilight
    /// ends at −6.
    pub sun_below_deg: f64,
    /// Its magnitude at a distance of 1000 km with half of its disc lit, −30 to 30. If this is null, no magnitudes are estimated.
    pub standard_magnitude: *const f64,
}

/// A pass of a satellite. Azimuths count from north to east, degrees.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TerrellaPass {
    /// When it rises above the mask; `from`, or the start of the satellite's data, if it is above the mask then.
    pub begin: TerrellaTime,
    /// Azimuth then.
    pub begin_azimuth_deg: f64,
    /// When it is highest.
    pub highest: TerrellaTime,
    /// Azimuth then.
    pub highest_azimuth_deg: f64,
    /// Elevation then, degrees.
    pub elevation_deg: f64,
    /// Distance then, metres.
    pub distance_m: f64,
    /// When it sets; `until`, or the end of the satellite's data, if it is above the mask then.
    pub end: TerrellaTime,
    /// Azimuth then.
    pub end_azimuth_deg: f64,
    /// Whether it rises at `begin`.
    pub rises: bool,
    /// Whether it sets at `end`.
    pub sets: bool,
    /// Its length, seconds.
    pub duration_s: f64,
    /// How often the satellite becomes visible in it; 0 if never. The rest applies only if this is not 0.
    pub visible_count: u32,
    /// When it is first visible.
    pub visible_begin: TerrellaTime,
    /// When it is last visible.
    pub visible_end: TerrellaTime,
    /// When it is brightest; `visible_begin` without a standard magnitude.
    pub brightest: TerrellaTime,
    /// Its magnitude then; NaN without a standard magnitude.
    pub magnitude: f64,
}

/// The passes of a satellite of a scene over a place, in their order, at most `capacity` of them. `count` receives the number written. If
/// it is `capacity` there may be more: search again from the end of the last one. `index` counts from 0 in the scene's order.
///
/// With a capacity of 0, nothing is searched, `count` receives 0, and `passes` may be null. An interval that ends before it begins is
/// `TERRELLA_ARGUMENT`. One that lies outside of the satellite's data is `TERRELLA_SCENE`. One that lies partly outside is searched as far
/// as the data reach.
///
/// # Safety
/// `passes` points to writable memory for `capacity` passes, and `count` to that for one number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn terrella_scene_passes(
    scene: *mut TerrellaScene,
    index: usize,
    search: *const TerrellaPassSearch,
    passes: *mut TerrellaPass,
    capacity: usize,
    count: *mut usize,
) -> TerrellaStatus {
    answer(|| {
        check_out(count, "count")?;
        // SAFETY: the caller's promise about its pointers, here and below.
        let search = unsafe { read(search, "search") }?;
        if capacity > 0 {
            check_out(passes, "passes")?;
        }
        let (observer_place, mask_rad) = place(search)?;
        let rule = rule(search)?;
        let span = (
            search.from.epoch("search.from")?,
            search.until.epoch("search.until")?,
        );
        let written = with_satellite(scene, index, |feed| {
            check_span(feed.name(), feed.validity(), span)?;
            let still = |_| Orientation::default();
            let observer = Observer::new(observer_place, &Ellipsoid::WGS84, mask_rad, &still);
            let found = self::passes(feed, &observer, span.0, span.1);
            let mut written = 0;
            for pass in found.take(capacity) {
                let pass = reported(feed, &observer, &pass?, &rule)?;
                // SAFETY: not null and aligned; there is room for `capacity` passes, of which this is none beyond the last.
                unsafe { passes.add(written).write(pass) };
                written += 1;
            }
            Ok(written)
        })?;
        // SAFETY: the same.
        unsafe { write(count, "count", written) }
    })
}

/// Rejects an interval that ends before it begins, or that lies outside of the satellite's data.
fn check_span(
    satellite: &str,
    (first, last): (Epoch, Epoch),
    (from, until): (Epoch, Epoch),
) -> Result<(), Failure> {
    let interval = format!("{} to {}", rfc3339(from), rfc3339(until));
    if until < from {
        return Err(Failure::argument(format!(
            "search.until: the interval {interval} ends before it begins; set until to a later time than from"
        )));
    }
    if last < from || until < first {
        return Err(Failure::new(
            TerrellaStatus::TERRELLA_SCENE,
            format!(
                "search: the interval {interval} is outside of the data of {satellite}, which cover {} to {}; \
                 search in that interval or give the scene an orbit file for the wanted one",
                rfc3339(first),
                rfc3339(last)
            ),
        ));
    }
    Ok(())
}

/// The place of a search, and its mask in radians.
fn place(search: &TerrellaPassSearch) -> Result<(Geodetic, f64), Failure> {
    for (name, value, least, most) in [
        ("lat_deg", search.lat_deg, -90.0, 90.0),
        ("lon_deg", search.lon_deg, -360.0, 360.0),
        ("height_m", search.height_m, -12_000.0, 100_000.0),
        ("min_elevation_deg", search.min_elevation_deg, 0.0, 89.999),
    ] {
        if !(least..=most).contains(&value) {
            return Err(Failure::argument(format!(
                "search.{name}: {value} is not from {least} to {most}"
            )));
        }
    }
    let place = Geodetic::from_degrees(search.lat_deg, search.lon_deg, search.height_m);
    Ok((place, search.min_elevation_deg.to_radians()))
}

/// When a satellite can be seen.
fn rule(search: &TerrellaPassSearch) -> Result<VisibilityRule, Failure> {
    let standard_magnitude = match search.standard_magnitude.is_null() {
        true => None,
        // SAFETY: not null; the caller's promise about its pointers.
        false => Some(*unsafe { read(search.standard_magnitude, "search.standard_magnitude") }?),
    };
    for (name, value, most) in [
        ("sun_below_deg", Some(search.sun_below_deg), 90.0),
        ("standard_magnitude", standard_magnitude, 30.0),
    ] {
        if let Some(value) = value.filter(|value| !(-most..=most).contains(value)) {
            return Err(Failure::argument(format!(
                "search.{name}: {value} is not from -{most} to {most}"
            )));
        }
    }
    Ok(VisibilityRule {
        sun_below_rad: search.sun_below_deg.to_radians(),
        standard_magnitude,
    })
}

fn reported(
    feed: &dyn Feed,
    observer: &Observer<'_>,
    pass: &Pass,
    rule: &VisibilityRule,
) -> Result<TerrellaPass, OrbitError> {
    let angles = |epoch| Ok::<_, OrbitError>(observer.look_angles(&feed.state_at(epoch)?));
    let highest = angles(pass.highest)?;
    let visible = visible_intervals(feed, observer, pass, rule)?;
    let visible_begin = visible.first().map_or(pass.begin, |one| one.begin);
    let brightest = visible.iter().filter_map(|one| one.brightest);
    let brightest = brightest.min_by(|one, other| one.1.total_cmp(&other.1));
    let (brightest, magnitude) = brightest.unwrap_or((visible_begin, f64::NAN));
    Ok(TerrellaPass {
        begin: TerrellaTime::of(pass.begin),
        begin_azimuth_deg: angles(pass.begin)?.azimuth_rad.to_degrees(),
        highest: TerrellaTime::of(pass.highest),
        highest_azimuth_deg: highest.azimuth_rad.to_degrees(),
        elevation_deg: pass.elevation_rad.to_degrees(),
        distance_m: highest.distance_m,
        end: TerrellaTime::of(pass.end),
        end_azimuth_deg: angles(pass.end)?.azimuth_rad.to_degrees(),
        rises: pass.rises,
        sets: pass.sets,
        duration_s: (pass.end - pass.begin).to_seconds(),
        visible_count: visible.len() as u32,
        visible_begin: TerrellaTime::of(visible_begin),
        visible_end: TerrellaTime::of(visible.last().map_or(pass.begin, |one| one.end)),
        brightest: TerrellaTime::of(brightest),
        magnitude,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use terrella::frames::utc_from_rfc3339;

    #[test]
    fn intervals_without_data_are_errors() {
        let day =
            |day: u32| utc_from_rfc3339(&format!("2018-01-{day:02}T00:00:00Z")).expect("a date");
        let check = |from, until| check_span("ISS", (day(10), day(20)), (day(from), day(until)));
        for (from, until) in [(11, 12), (5, 10), (20, 25), (15, 15), (1, 31)] {
            assert!(check(from, until).is_ok(), "{from} {until}");
        }
        for (from, until, status, named) in [
            (12, 11, TerrellaStatus::TERRELLA_ARGUMENT, "2018-01-12"),
            (21, 25, TerrellaStatus::TERRELLA_SCENE, "2018-01-20"),
            (5, 9, TerrellaStatus::TERRELLA_SCENE, "2018-01-10"),
        ] {
            let failure = check(from, until).expect_err("no data");
            assert_eq!(failure.status, status);
            assert!(failure.words.contains(named), "{}", failure.words);
        }
    }
}
