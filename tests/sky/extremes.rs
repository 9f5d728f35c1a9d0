//! Eyes and dates at the limits: every pixel is finite.

use crate::drawn::{above, bare_earth, celestial, drawn, drawn_with, grey_moon};
use crate::{common::Rig, stars, utc};
use glam::DVec3;
use terrella::celestial::CelestialOptions;
use terrella::frames::{Duration, Observer, Orientation};
use terrella::{Atmosphere, EarthOptions, EyeView, Ghosts, Sky, SurfaceLight};

const SIZE: (u32, u32) = (96, 64);

fn all() -> CelestialOptions {
    CelestialOptions {
        stars: Some(stars()),
        milky_way: grey_moon(),
        sun: true,
        moon: grey_moon(),
        glare: true,
        aperture: None,
        ghosts: Some(Ghosts {
            part: 1e-3,
            blades: Some(7),
        }),
        star_gain: 1e5,
        stars_fade_by_day: false,
    }
}

#[test]
fn every_pixel_is_a_number() {
    let day = utc("2017-08-21T18:25:32Z");
    let mut dates = vec![day];
    // 1800 and 2200, beyond what dates in text may be.
    for years in [-217.6, 182.4] {
        dates.push(day + Duration::from_days(365.25 * years));
    }
    for atmosphere in [Atmosphere::None, Atmosphere::Billboard] {
        let options = EarthOptions {
            atmosphere,
            light: SurfaceLight {
                eclipses: true,
                ..SurfaceLight::default()
            },
            ..bare_earth()
        };
        let mut rig = Rig::of_light(&options, SIZE);
        let mut celestial = celestial(&rig, &all());
        for epoch in &dates {
            let at_earth = Observer::at_rest(*epoch, &Orientation::default(), DVec3::X * 7e6);
            let moon = at_earth.moon_m() + DVec3::X * 7e6;
            let eyes = [
                above(36.97, -87.67, 2.0),
                above(36.97, -87.67, 4e5),
                above(0.0, 0.0, 35_786e3),
                // On the Moon's near side, in it, and beyond it.
                moon * (1.0 - 1.738e6 / moon.length()),
                moon,
                moon * 1.1,
                DVec3::X * 1.5e11,
                DVec3::X * 1e20,
            ];
            for eye in eyes {
                let observer = Observer::at_rest(*epoch, &Orientation::default(), eye);
                let looks = [
                    observer.sun_m(),
                    observer.moon_m(),
                    -eye,
                    eye.cross(DVec3::Z),
                ];
                for (look, fov_deg) in looks
                    .into_iter()
                    .flat_map(|look| [(look, 0.001), (look, 60.0), (look, 179.0)])
                {
                    let fov = f64::to_radians(fov_deg);
                    let view = EyeView::itrf(eye, look, DVec3::Z, fov, 1.5);
                    // The sky over a night, and the Earth by the date's own Sun and Moon.
                    let sky = drawn_with(&mut rig, &mut celestial, &view, *epoch, SIZE);
                    let earth = rig.draw_light_of(&view, &Sky::at(*epoch));
                    let bad = sky
                        .iter()
                        .chain(&earth)
                        .flatten()
                        .filter(|value| !value.is_finite() || **value < 0.0);
                    assert_eq!(
                        bad.count(),
                        0,
                        "{atmosphere:?} {epoch} {eye} {look} {fov_deg}"
                    );
                }
            }
        }
    }
}

/// A total eclipse leaves nothing of the Sun, on the ground of that place and minute; an hour before it is whole.
#[test]
fn the_moon_covers_the_sun_over_kentucky() {
    let eye = above(36.965, -87.671, 100.0);
    let sun = CelestialOptions {
        sun: true,
        ..CelestialOptions::NOTHING
    };
    let mut rig = Rig::of_light(&bare_earth(), SIZE);
    let mut light = |date: &str| {
        let epoch = utc(date);
        let observer = Observer::at_rest(epoch, &Orientation::default(), eye);
        let view = EyeView::itrf(eye, observer.sun_m(), DVec3::Z, 0.012, 1.5);
        let light = drawn(&mut rig, &sun, &view, epoch, SIZE);
        light.iter().map(|texel| f64::from(texel[1])).sum::<f64>()
    };
    let (whole, total) = (light("2017-08-21T16:50:00Z"), light("2017-08-21T18:25:32Z"));
    let before = light("2017-08-21T18:23:00Z");
    assert!(total < 1e-6 * whole, "{total} of {whole}");
    assert!(before > 1e-4 * whole, "{before} of {whole}");
}
