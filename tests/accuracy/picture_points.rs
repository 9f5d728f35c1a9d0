//! A picture looked at in some of its points shows there what it shows when it is drawn whole.

use crate::common::{gpu, tilted};
use crate::hills::Hills;
use std::sync::Arc;
use std::time::Duration;
use terrella::GroundOptions;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::internals::earth::PixelLattice;
use terrella::{Subdivision, SurfaceKind, SurfaceSettings};
use terrella_ground::elevation::Elevation;
use terrella_ground::globe::contours::PageOptions;
use terrella_measure::errors::{GeolocationRenderer, GroundPicture};

const SIZE: (u32, u32) = (320, 180);
const FIGURE: Ellipsoid = Ellipsoid::WGS84;

const HILLS: Hills = Hills {
    waves: &[(2500.0, 60.0), (1500.0, 251.0), (300.0, 2e3)],
    finest_spacing_rad: 2e-5,
};

#[test]
fn points_show_what_the_whole_picture_shows() {
    let kinds = SurfaceKind::ALL
        .iter()
        .map(|kind| kind.settings(Subdivision::Auto));
    let cast = SurfaceSettings::CastContours(PageOptions::default());
    let place = Geodetic::from_degrees(46.0, 8.0, 0.0);
    let height_m = 4e3 + HILLS.height_m(place.lat_rad, place.lon_rad, 0.0);
    let view = tilted(
        Geodetic { height_m, ..place },
        30.0,
        -12.0,
        50.0,
        16.0 / 9.0,
    );
    for surface in kinds.chain([cast]) {
        let options = GroundOptions {
            elevation: Arc::new(HILLS),
            surface,
            tolerance_px: 1.0,
        };
        let mut earth = GeolocationRenderer::with_ground(gpu(), &options).expect("sound options");
        earth.settle(&view, SIZE, Duration::from_secs(30));
        let whole = earth.draw(&view, SIZE).expect("places");
        let mut errors_px = Vec::new();
        for points in [
            PixelLattice::spread(SIZE, 10, (3, 7)),
            PixelLattice::window(SIZE, (120, 80), (64, 36)),
            PixelLattice::whole(SIZE),
        ] {
            let drawn = earth.draw_points(&view, &points).expect("places");
            let (mut differ, mut compared) = (0, 0);
            for (x, y) in
                (0..points.points.1).flat_map(|y| (0..points.points.0).map(move |x| (x, y)))
            {
                let at = points.at(x, y);
                let expected = whole.along(at.x as u32, at.y as u32);
                let is_same = match (drawn.along(x, y), expected) {
                    // Triangles are moved to the rasterizer's own lattice, of 1/256 of a pixel of the target.
                    (Some(drawn), Some(expected)) => (drawn / expected - 1.0).abs() < 5e-3,
                    (drawn, expected) => drawn == expected,
                };
                differ += u32::from(!is_same);
                compared += 1;
            }
            // Along outlines that one side of which is far behind the other.
            assert!(
                differ * 50 <= compared,
                "{surface:?}: {differ} of {compared} of {points:?}"
            );
            let picture = GroundPicture::of_points(&drawn, &view, &points, &FIGURE, &HILLS);
            errors_px.push(
                picture
                    .expect("pixels")
                    .errors(&FIGURE, &HILLS, None)
                    .median_px,
            );
        }
        // In pixels of the picture, however few are looked at.
        let [spread, _, all] = errors_px[..] else {
            panic!("three")
        };
        assert!(
            (spread / all - 1.0).abs() < 0.25,
            "{surface:?}: {errors_px:?}"
        );
    }
}
