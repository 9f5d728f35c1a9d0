//! Compared with another program: satkit 0.24.1 (MIT licence), which has its own field, ephemerides (JPL DE440), axes (IERS
//! 2010 with daily UT1 and pole) and integrator (Verner 9(8), relative error 1e-13). EGM96 as here; a day from 2018-01-15
//! 12:00 UTC, GCRF.

use super::*;

/// Position (m) and velocity (m/s) at the start.
type Start = ([f64; 3], [f64; 3]);

const LEO: Start = ([5e6, -3e6, 3.6e6], [3.9e3, 6.5e3, 0.2e3]);
const GEO: Start = ([42_164_170.0, 0.0, 0.0], [0.0, 3074.66, 50.0]);
const HEO: Start = ([7e6, 0.0, 1e6], [0.0, 8.9e3, 4.5e3]);

#[test]
fn another_program_flies_to_the_same_places() {
    let zonal = Gravity::Zonal { degree: 4 };
    let full = Gravity::Field {
        degree: 20,
        order: 20,
    };
    // Start, field, with Sun and Moon, end after a day, most metres apart: high up the Moon's place, 12 km off, shows.
    let cases = [
        (
            "LEO zonal",
            LEO,
            zonal,
            false,
            [-5955906.938370697, -64470.987612304394, -2977326.8794387667],
            0.02,
        ),
        (
            "LEO field",
            LEO,
            full,
            false,
            [-5956222.175111525, -67155.0351438586, -2976346.403486314],
            0.02,
        ),
        (
            "LEO all",
            LEO,
            full,
            true,
            [-5956241.383899126, -67138.1950041939, -2976311.914410267],
            0.02,
        ),
        (
            "GEO zonal",
            GEO,
            zonal,
            false,
            [
                42_159_313.807_165_66,
                639_894.459_639_637_7,
                10_565.282_043_374_52,
            ],
            0.02,
        ),
        (
            "GEO field",
            GEO,
            full,
            false,
            [
                42_159_260.604_122_53,
                639_924.662_426_286,
                10_565.089_522_071_696,
            ],
            0.02,
        ),
        (
            "GEO all",
            GEO,
            full,
            true,
            [
                42_159_509.368_498_48,
                626_669.887_647_597_1,
                7_754.054_031_158_718,
            ],
            0.5,
        ),
        (
            "HEO zonal",
            HEO,
            zonal,
            false,
            [
                -46_847_744.650_806_18,
                -4_479_662.938_183_978,
                -9_039_087.744_698_973,
            ],
            0.02,
        ),
        (
            "HEO field",
            HEO,
            full,
            false,
            [
                -46_864_392.152_870_74,
                -4_467_545.509_990_911,
                -9_035_708.166_887_105,
            ],
            0.02,
        ),
        (
            "HEO all",
            HEO,
            full,
            true,
            [
                -46_866_678.049_931_38,
                -4_461_852.104_445_427,
                -9_033_516.406_535_137,
            ],
            0.5,
        ),
    ];
    // IERS finals2000A, the mean of both days: the pole in seconds of arc.
    let orientation = Orientation {
        ut1_minus_utc_s: 0.2075,
        x_pole_rad: 0.0378_f64.to_radians() / 3600.0,
        y_pole_rad: 0.2620_f64.to_radians() / 3600.0,
    };
    let mut worst = Vec::new();
    for (name, (r, v), gravity, bodies, expected, most) in cases {
        let state = OrbitState {
            epoch: epoch(),
            frame: Frame::Gcrf,
            position_m: r.into(),
            velocity_m_s: v.into(),
        };
        let model = ForceModel {
            gravity,
            sun: bodies,
            moon: bodies,
            orientation,
            ..ForceModel::default()
        };
        let options = NumericalOptions {
            relative_tolerance: 1e-13,
            ..after(1.0)
        };
        let end = fly(&state, &model, &options)
            .state_at(options.last)
            .unwrap()
            .position_m;
        let apart = (end - DVec3::from(expected)).length();
        println!("{name}: {apart:.4} m");
        worst.push((name, apart, most));
    }
    for (name, apart, most) in worst {
        assert!(apart < most, "{name}: {apart}");
    }
}
