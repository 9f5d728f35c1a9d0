//! The drawn sky: positions and brightness.

use crate::common::{Rig, gpu, plain};
use crate::{stars, utc};
use glam::{DVec2, DVec3};
use std::f64::consts::PI;
use std::sync::Arc;
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions, StarCatalogue};
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Observer, Orientation};
use terrella::{
    Aperture, Atmosphere, DiffractionPattern, EarthOptions, EyeView, Ghosts, LayerImage, Pipelines,
};

const DATE: &str = "2018-01-20T21:00:00Z";

pub fn bare_earth() -> EarthOptions {
    EarthOptions {
        atmosphere: Atmosphere::None,
        ..EarthOptions::new(plain([90; 3]))
    }
}

pub fn grey_moon() -> Option<Arc<LayerImage>> {
    let map = LayerImage::from_rgba8(64, 32, vec![255; 64 * 32 * 4]);
    Some(Arc::new(map.expect("a map")))
}

/// The light of a sky alone, pixels of RGB, by whatever view.
pub fn drawn(
    rig: &mut Rig,
    options: &CelestialOptions,
    view: &EyeView,
    epoch: Epoch,
    size: (u32, u32),
) -> Vec<[f32; 4]> {
    let mut celestial = celestial(rig, options);
    drawn_with(rig, &mut celestial, view, epoch, size)
}

pub fn celestial(rig: &Rig, options: &CelestialOptions) -> Celestial {
    let gpu = gpu();
    Celestial::new(&gpu.device, &gpu.queue, &rig.earth, options).expect("sound options")
}

/// With a sky that is made already.
pub fn drawn_with(
    rig: &mut Rig,
    celestial: &mut Celestial,
    view: &EyeView,
    epoch: Epoch,
    size: (u32, u32),
) -> Vec<[f32; 4]> {
    let moment = CelestialMoment {
        epoch,
        orientation: Orientation::default(),
        view,
        target: size.into(),
        velocity_m_s: None,
    };
    rig.draw_light_with(celestial, &moment)
}

pub fn above(lat: f64, lon: f64, height_m: f64) -> DVec3 {
    Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat, lon, height_m))
}

/// How much brighter than in truth, so that it is far above the rounding of half floats.
const GAIN: f64 = 1e7;

/// Only one star.
fn one_star(hip: u32) -> CelestialOptions {
    let all = stars();
    let one = all.stars().iter().filter(|star| star.hip == hip);
    CelestialOptions {
        stars: Some(Arc::new(StarCatalogue::of(one.copied().collect()))),
        star_gain: GAIN,
        stars_fade_by_day: false,
        ..CelestialOptions::NOTHING
    }
}

/// Where the light's middle is, and its sum times each pixel's solid angle.
fn measured(light: &[[f32; 4]], view: &EyeView, size: (u32, u32)) -> (DVec2, f64) {
    let (mut sum, mut middle, mut power) = (0.0, DVec2::ZERO, 0.0);
    let tangent = 1.0 / view.clip_from_view.y_axis.y;
    let pixel = 2.0 * tangent / f64::from(size.1);
    for (n, texel) in light.iter().enumerate() {
        let at = DVec2::new(
            (n as u32 % size.0) as f64 + 0.5,
            (n as u32 / size.0) as f64 + 0.5,
        );
        let off = (at - 0.5 * DVec2::new(size.0.into(), size.1.into())) * pixel;
        let light = f64::from(texel[1]);
        sum += light;
        middle += light * at;
        power += light * pixel * pixel / (1.0 + off.length_squared()).powf(1.5);
    }
    (middle / sum, power)
}

#[test]
fn a_star_is_as_bright_at_any_size_and_between_pixels() {
    let options = one_star(32_349);
    let catalogue = stars();
    let star = &catalogue.stars()[0];
    assert_eq!(star.hip, 32_349);
    let epoch = utc(DATE);
    let eye = above(0.0, 75.0, 35_786e3);
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    let years = (epoch.to_jde_tt_days() - 2_448_349.062_5) / 365.25;
    let sirius = observer.itrf_from_gcrf() * observer.seen(star.direction_at(years));
    let mut worst = (0.0_f64, 0.0_f64);
    for size in [(320, 180), (640, 360), (1280, 720), (3840, 2160)] {
        let mut rig = Rig::of_light(&bare_earth(), size);
        let aspect = f64::from(size.0) / f64::from(size.1);
        let fov = 40_f64.to_radians();
        let pixel = 2.0 * (0.5 * fov).tan() / f64::from(size.1);
        // A drift of a tenth of a pixel a frame; far from the middle too.
        let frames = if size.0 > 1000 { 3 } else { 24 };
        for frame in 0..frames {
            let across = sirius.cross(DVec3::Z).normalize();
            let aside = 0.1 * f64::from(frame) * pixel + 0.15;
            let forward = sirius + aside * across + 0.3 * aside * DVec3::Z;
            let view = EyeView::itrf(eye, forward, DVec3::Z, fov, aspect);
            let light = drawn(&mut rig, &options, &view, epoch, size);
            let (middle, power) = measured(&light, &view, size);
            let clip = view.to_itrf().1 * sirius.extend(0.0);
            let ndc = DVec2::new(clip.x, -clip.y) / clip.w;
            let expected = (0.5 + 0.5 * ndc) * DVec2::new(size.0.into(), size.1.into());
            worst.0 = worst.0.max((middle - expected).length());
            worst.1 = worst
                .1
                .max((power / (GAIN * f64::from(star.light.y)) - 1.0).abs());
        }
    }
    println!("place {:.4} px, light {:.5}", worst.0, worst.1);
    assert!(worst.0 < 0.02, "{worst:?}");
    // Half floats store light to 0.05 % a pixel. The solid angle of the star's pixel is used for its neighbours too.
    assert!(worst.1 < 0.01, "{worst:?}");
}

#[test]
fn the_earth_and_the_moon_hide_stars() {
    let epoch = utc(DATE);
    let size = (64, 64);
    let mut rig = Rig::of_light(&bare_earth(), size);
    let eye = above(0.0, 75.0, 35_786e3);
    let everything = CelestialOptions {
        stars: Some(stars()),
        star_gain: 1e6,
        stars_fade_by_day: false,
        ..CelestialOptions::NOTHING
    };
    // 17° of Earth fill the picture of 10°.
    let view = EyeView::itrf(eye, -eye, DVec3::Z, 10_f64.to_radians(), 1.0);
    let light = drawn(&mut rig, &everything, &view, epoch, size);
    assert!(
        light.iter().all(|texel| texel[0] == 0.0),
        "stars before the Earth"
    );
    let view = EyeView::itrf(eye, eye, DVec3::Z, 40_f64.to_radians(), 1.0);
    let light = drawn(&mut rig, &everything, &view, epoch, size);
    let stars = light.iter().filter(|texel| texel[1] > 0.0).count();
    assert!(stars > 500, "{stars}");
}

#[test]
fn sun_and_moon_give_the_light_that_they_give() {
    let size = (256, 256);
    let mut rig = Rig::of_light(&bare_earth(), size);
    let eye = above(0.0, 75.0, 35_786e3);
    let sun = CelestialOptions {
        sun: true,
        ..CelestialOptions::NOTHING
    };
    let epoch = utc(DATE);
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    // As a disc and as a point.
    for (fov_deg, off) in [
        (1.0_f64, 0.002),
        (30.0, 0.02),
        (60.0, 0.002),
        (150.0, 0.002),
    ] {
        let fov = fov_deg.to_radians();
        let view = EyeView::itrf(eye, observer.sun_m(), DVec3::Z, fov, 1.0);
        let light = drawn(&mut rig, &sun, &view, epoch, size);
        let (_, power) = measured(&light, &view, size);
        // A white sheet that faces it is 1, at any distance.
        println!("{fov_deg}°: {power}");
        assert!((power / PI - 1.0).abs() < off, "{fov_deg}°: {power}");
    }
    // A full Moon over a map of 1 has 1/0.4923 of its light.
    let moon = CelestialOptions {
        moon: grey_moon(),
        ..CelestialOptions::NOTHING
    };
    let epoch = utc("2018-01-31T13:40:00Z");
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    let view = EyeView::itrf(eye, observer.moon_m(), DVec3::Z, 0.02, 1.0);
    // Totally eclipsed: nothing but the dark that our Earth's shadow leaves.
    let light = drawn(&mut rig, &moon, &view, epoch, size);
    let (_, eclipsed) = measured(&light, &view, size);
    let before = utc("2018-01-31T08:00:00Z");
    let observer = Observer::at_rest(before, &Orientation::default(), eye);
    let view = EyeView::itrf(eye, observer.moon_m(), DVec3::Z, 0.02, 1.0);
    let light = drawn(&mut rig, &moon, &view, before, size);
    let (_, full) = measured(&light, &view, size);
    // Allen's full Moon, −12.73, is 2.5e-6 of the Sun's light; this one is near it.
    let expected = PI * 2.5e-6 / 0.4923;
    println!("Moon: full {full:e} for {expected:e}, eclipsed {eclipsed:e}");
    assert!((0.8..1.3).contains(&(full / expected)), "{full}");
    assert!(eclipsed < 1e-3 * full, "{eclipsed}");
}

/// The light around a Sun that rises over the limb grows from zero, also while the limb hides its centre.
#[test]
fn glare_grows_while_the_sun_rises() {
    let size = (64, 64);
    let mut rig = Rig::of_light(&EarthOptions::new(plain([90; 3])), size);
    let epoch = utc(DATE);
    let far = Observer::at_rest(epoch, &Orientation::default(), above(0.0, 0.0, 4e5));
    let sun = far.sun_m().normalize();
    // The limb is above a place of the equator.
    let limb = sun.cross(DVec3::Z).normalize();
    let radius_m = Ellipsoid::WGS84.equatorial_radius_m;
    let glare = CelestialOptions {
        glare: true,
        ..CelestialOptions::NOTHING
    };
    // Height of the line to the Sun's centre over the limb, kilometres: its disc reaches 11 km up and down.
    let heights = (-7..=12).map(|step| 2.0 * f64::from(step));
    let sums: Vec<f64> = heights
        .map(|height_km| {
            let off = radius_m + 1e3 * height_km;
            let behind = ((radius_m + 4e5).powi(2) - off * off).sqrt();
            let eye = off * limb - behind * sun;
            let view = EyeView::itrf(eye, sun, DVec3::Z, 0.2, 1.0);
            let light = drawn(&mut rig, &glare, &view, epoch, size);
            light.iter().map(|light| f64::from(light[0])).sum()
        })
        .collect();
    println!("{sums:.3?}");
    assert_eq!(sums[0], 0.0);
    assert!(sums.last() > Some(&1.0));
    for pair in sums.windows(2) {
        assert!(pair[1] >= pair[0], "{sums:?}");
    }
}

/// Light that the aperture diffracts into spikes is missing from the disc, and arrives outside it.
#[test]
fn an_aperture_moves_light_from_the_disc_to_spikes() {
    let size = (256, 256);
    let mut rig = Rig::of_light(&bare_earth(), size);
    let eye = above(0.0, 75.0, 35_786e3);
    let epoch = utc(DATE);
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    let view = EyeView::itrf(eye, observer.sun_m(), DVec3::Z, 12_f64.to_radians(), 1.0);
    let mut light = |aperture: Option<Aperture>| {
        let sun = CelestialOptions {
            sun: true,
            glare: true,
            aperture: aperture.map(|aperture| Arc::new(DiffractionPattern::new(aperture))),
            ..CelestialOptions::NOTHING
        };
        drawn(&mut rig, &sun, &view, epoch, size)
    };
    let round = light(None);
    let spiked = light(Some(Aperture {
        blades: 6,
        f_number: 16.0,
        dust: 0.0,
    }));
    let power = |light: &[[f32; 4]]| measured(light, &view, size).1;
    let lost: f64 = {
        let disc = |light: &[[f32; 4]]| {
            let bright = light.iter().zip(&round).filter(|(_, round)| round[1] > 1e3);
            bright.map(|(texel, _)| f64::from(texel[1])).sum::<f64>()
        };
        1.0 - disc(&spiked) / disc(&round)
    };
    let gained = power(&spiked) / power(&round) - 1.0;
    println!("lost by the disc {lost:.5}, gained by the picture {gained:.5}");
    // Within the disc's edge some of it comes back.
    assert!((0.0005..0.02).contains(&lost), "{lost}");
    assert!(gained.abs() < 0.2 * lost, "{gained} of {lost}");
    // Spikes leave the Sun six ways: along a circle there are light and dark.
    let along = |light: &[[f32; 4]]| {
        let ring = (0..360).map(|degrees| {
            let (sin, cos) = f64::from(degrees).to_radians().sin_cos();
            let place = |part: f64| (128.0 + 40.0 * part) as usize;
            light[place(sin) * 256 + place(cos)][1]
        });
        let (least, most) = ring.fold((f32::MAX, 0.0_f32), |(a, b), v| (a.min(v), b.max(v)));
        most / least
    };
    let (with, without) = (along(&spiked), along(&round));
    assert!(with > 3.0 && without < 1.2, "{with} {without}");
}

/// Ghosts have their part of the Sun's light, mirrored about the middle of the picture, and the disc lacks it.
#[test]
fn ghosts_have_their_part_of_the_sun() {
    let size = (256, 256);
    let mut rig = Rig::of_light(&bare_earth(), size);
    let eye = above(0.0, 75.0, 35_786e3);
    let epoch = utc(DATE);
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    let sun = observer.sun_m().normalize();
    let right = sun.cross(DVec3::Z).normalize();
    let part = 1e-3;
    let mut light = |blades: Option<u32>, disc: bool, sun_deg: f64| {
        let (sin, cos) = f64::to_radians(sun_deg).sin_cos();
        // The Sun is left of the middle.
        let forward = cos * sun + sin * right;
        let view = EyeView::itrf(eye, forward, DVec3::Z, 24_f64.to_radians(), 1.0);
        let mut drawn_with = |ghosts: Option<Ghosts>| {
            let sky = CelestialOptions {
                sun: disc,
                glare: true,
                ghosts,
                ..CelestialOptions::NOTHING
            };
            drawn(&mut rig, &sky, &view, epoch, size)
        };
        let with = drawn_with(Some(Ghosts { part, blades }));
        let without = drawn_with(None);
        let pairs = with.iter().zip(&without);
        let more = pairs.map(|(a, b)| [0, 1, 2].map(|n| f64::from(a[n] - b[n])));
        (more.collect::<Vec<_>>(), with, without)
    };
    // In the plane of the image.
    let pixel = 2.0 * 12_f64.to_radians().tan() / 256.0;
    for blades in [None, Some(5)] {
        let (more, ..) = light(blades, false, 6.0);
        for channel in 0..3 {
            let sum: f64 = more.iter().map(|light| light[channel]).sum();
            let shares = [0.92, 0.99, 0.93][channel];
            let ratio = sum * pixel * pixel / (PI * part * shares);
            assert!((ratio - 1.0).abs() < 0.02, "{blades:?} {channel}: {ratio}");
        }
        // The Sun is 6° of 12° left, 63 pixels: a ghost is as far to the right, and none left of the Sun.
        let at = |x: usize| more[127 * 256 + x][1];
        assert!(at(128 + 75) > 1e-3 && at(128 - 75) == 0.0, "{blades:?}");
    }
    let (_, with, without) = light(None, true, 1.0);
    let brightest = |light: &[[f32; 4]]| light.iter().map(|light| light[1]).fold(0.0, f32::max);
    let kept = f64::from(brightest(&with)) / f64::from(brightest(&without));
    // Light of 16 bits has steps of 5e-4.
    assert!((kept - (1.0 - part)).abs() < 4e-4, "{kept}");
    // Far outside the image it has no ghosts.
    let (more, ..) = light(None, false, 30.0);
    assert!(more.iter().flatten().all(|more| *more == 0.0));
}

#[test]
fn pipelines_that_are_made_when_needed_draw_the_same() {
    let (epoch, size) = (utc(DATE), (96, 64));
    let everything = CelestialOptions {
        stars: Some(stars()),
        star_gain: 1e4,
        stars_fade_by_day: false,
        sun: true,
        moon: grey_moon(),
        glare: true,
        ..CelestialOptions::NOTHING
    };
    let air = EarthOptions::new(plain([90; 3]));
    for (options, height_m) in [(bare_earth(), 4e7), (air.clone(), 4e7), (air, 3e3)] {
        // Noon.
        let eye = above(-20.0, -90.0, height_m);
        let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
        let mut rigs = [Pipelines::AtOnce, Pipelines::WhenNeeded].map(|pipelines| {
            let options = EarthOptions {
                pipelines,
                color_format: gpu().float_format(),
                ..options.clone()
            };
            Rig::with_pipelines(&options, size)
        });
        for forward in [observer.sun_m(), observer.moon_m(), eye] {
            let forward = forward.normalize();
            let view = EyeView::itrf(eye, forward, DVec3::Z, 3_f64.to_radians(), 1.5);
            let [at_once, when_needed] = rigs
                .each_mut()
                .map(|rig| drawn(rig, &everything, &view, epoch, size));
            assert!(at_once == when_needed, "{height_m} {forward}");
            let is_lit = |texel: &[f32; 4]| texel[..3].iter().any(|light| *light > 0.0);
            let is_up = forward.dot(eye) > 0.0;
            let any_is_lit = at_once.iter().any(is_lit);
            assert!(any_is_lit || !is_up, "{height_m} {forward}");
        }
    }
}

/// Parts are added to a sky and taken away: it is drawn as one that is made with them.
#[test]
fn a_changed_sky_is_drawn_as_a_new_one() {
    let (epoch, size) = (utc(DATE), (96, 64));
    let without = CelestialOptions {
        sun: true,
        ..CelestialOptions::NOTHING
    };
    let with = CelestialOptions {
        stars: Some(stars()),
        star_gain: 1e4,
        stars_fade_by_day: false,
        moon: grey_moon(),
        ..without.clone()
    };
    let eye = above(-20.0, -90.0, 4e7);
    let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
    let mut rig = Rig::of_light(&bare_earth(), size);
    let mut changed = celestial(&rig, &without);
    for forward in [observer.sun_m(), observer.moon_m()] {
        let view = EyeView::itrf(eye, forward.normalize(), DVec3::Z, 3_f64.to_radians(), 1.5);
        let mut seen = Vec::new();
        for options in [&with, &without, &with] {
            drawn_with(&mut rig, &mut changed, &view, epoch, size);
            let gpu = gpu();
            let set = changed.set_options(&gpu.device, &gpu.queue, &rig.earth, options);
            set.expect("sound options");
            let image = drawn_with(&mut rig, &mut changed, &view, epoch, size);
            assert!(image == drawn(&mut rig, options, &view, epoch, size));
            seen.push(image);
        }
        assert!(seen[0] != seen[1] && seen[0] == seen[2]);
    }
    let too_bright = CelestialOptions {
        star_gain: f64::NAN,
        ..with
    };
    let gpu = gpu();
    let set = changed.set_options(&gpu.device, &gpu.queue, &rig.earth, &too_bright);
    assert!(set.is_err() && changed.options().star_gain == 1e4);
}
