//! Roots, limb and horizon compared with exact geometry.

use super::*;

/// A number as the sum of two, 106 bits: enough to compute roots by the textbook formula.
#[derive(Clone, Copy)]
struct Double(f64, f64);

impl Double {
    fn sum(a: f64, b: f64) -> Self {
        let s = a + b;
        let v = s - a;
        Self(s, (a - (s - v)) + (b - v))
    }

    fn product(a: f64, b: f64) -> Self {
        let p = a * b;
        Self(p, a.mul_add(b, -p))
    }

    fn add(self, o: Self) -> Self {
        let s = Self::sum(self.0, o.0);
        let t = Self::sum(self.1, o.1);
        let s = Self::sum(s.0, s.1 + t.0);
        Self::sum(s.0, s.1 + t.1)
    }

    fn negative(self) -> Self {
        Self(-self.0, -self.1)
    }

    fn times(self, o: Self) -> Self {
        let p = Self::product(self.0, o.0);
        Self::sum(p.0, p.1 + self.0 * o.1 + self.1 * o.0)
    }

    fn over(self, o: Self) -> Self {
        let q = self.0 / o.0;
        let rest = self.add(o.times(Self(q, 0.0)).negative());
        let more = rest.0 / o.0;
        let rest = rest.add(o.times(Self(more, 0.0)).negative());
        Self::sum(q, more).add(Self(rest.0 / o.0, 0.0))
    }

    fn root(self) -> Self {
        let r = self.0.sqrt();
        let rest = self.add(Self::product(r, r).negative());
        Self::sum(r, rest.0 / (2.0 * r))
    }

    fn dot(a: DVec3, b: DVec3) -> Self {
        Self::product(a.x, b.x)
            .add(Self::product(a.y, b.y))
            .add(Self::product(a.z, b.z))
    }
}

/// t of |e + t d| = s by the paper's own formula, in 106 bits. `None` if the ray misses.
fn textbook(eye: DVec3, d: DVec3, s: f64) -> Option<f64> {
    let a = Double::dot(d, d);
    let b = Double::dot(eye, d);
    let c = Double::dot(eye, eye).add(Double::product(s, s).negative());
    let square = b.times(b).add(a.times(c).negative());
    (square.0 > 0.0).then(|| b.add(square.root()).negative().over(a).0)
}

const HEIGHTS_M: [f64; 11] = [
    1.0, 10.0, 100.0, 500.0, 2e3, 1e4, 4e5, 3.6e7, 3.8e8, 1e9, 1e12,
];

#[test]
fn roots_are_those_of_106_bits() {
    let (mut worst, mut worst_naive, mut rays) = (0.0_f64, 0.0_f64, 0);
    for height_m in HEIGHTS_M {
        for up in [
            DVec3::X,
            DVec3::new(0.3, -0.5, 0.8).normalize(),
            DVec3::NEG_Z,
        ] {
            let eye = up * (1.0 + height_m / 6_378_137.0);
            let length = eye.length();
            let limb = 1.0_f64.atan2(((length - 1.0) * (length + 1.0)).sqrt());
            let aside = up.any_orthonormal_vector();
            for step in 0..200 {
                // Down to a millionth of the limb's angle from the limb.
                let below = limb * (1.0 - f64::from(step) / 200.0).powi(3).max(1e-6);
                let (sin, cos) = (limb - below).sin_cos();
                let d = (aside * sin - up * cos).normalize();
                let exact = textbook(eye, d, 1.0).unwrap();
                let Cast::Hit(t) = cast(eye, d, 1.0) else {
                    panic!("{height_m} m, {below} rad under the limb: missed");
                };
                // An ulp of the ray or of the eye moves the place by that amount, divided by the sine of incidence.
                let root = -(eye + d * exact).dot(d);
                let unit = f64::EPSILON * (1.0 + exact) * (1.0 + 1.0 / root);
                let error = (t - exact).abs();
                let b = eye.dot(d);
                let naive = -b - (b * b - (eye.length_squared() - 1.0)).max(0.0).sqrt();
                worst = worst.max(error / unit);
                worst_naive = worst_naive.max((naive - exact).abs() / unit);
                rays += 1;
            }
        }
    }
    println!(
        "{rays} rays: off by {worst:.2} units of rounding; b² − c as printed: {worst_naive:.0}"
    );
    assert!(worst < 8.0 && worst_naive > 1e3 * worst);
}

/// A caster over the ellipsoid itself, for an eye at `height_m`.
fn caster(lat: f64, height_m: f64, spread_rad: f64) -> (Caster, DVec3) {
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(Geodetic::from_degrees(lat, 33.0, height_m));
    let mut caster = Caster::new(&Ellipsoid::WGS84, eye, height_m);
    caster.spread_rad = spread_rad;
    if spread_rad > 0.0 {
        caster.far_rad = caster.near_rad + 0.08;
    }
    (caster, eye)
}

#[test]
fn places_lie_on_their_rays() {
    let mut worst = 0.0_f64;
    for lat in [-90.0, -35.0, 0.0, 60.0, 89.9999] {
        for height_m in HEIGHTS_M {
            let (caster, eye) = caster(lat, height_m, 0.0);
            let base = (1.0 + caster.above) * caster.sin_limb;
            let (east, north) = caster.level_axes();
            for step in 0..400 {
                let nadir = caster.limb_rad * f64::from(step) / 400.0;
                let turn = f64::from(step) * 0.7;
                let aside = east * turn.cos() + north * turn.sin();
                let d = (aside * nadir.sin() - caster.up * nadir.cos()) * caster.radii_m;
                let foot = caster.foot(d);
                assert!((foot.place.length() - 1.0).abs() < 4e-15, "{foot:?}");
                let to = foot.place * base * caster.radii_m - eye;
                // The subtraction itself has an error of nanometres.
                let off = to.normalize().cross(d.normalize()).length();
                let allowed = 1e-13 + 8e-9 / to.length();
                assert!(off < allowed, "{lat}° {height_m} m {nadir}: {off}");
                worst = worst.max(off / allowed);
            }
        }
    }
    println!("off the ray by {worst:.2} of what the test's own subtraction leaves");
}

#[test]
fn directions_and_places_are_each_other_s_inverse() {
    for height_m in HEIGHTS_M {
        for spread in [0.0, 0.003, 0.15] {
            let (caster, _) = caster(41.0, height_m, spread);
            let (aside, _) = caster.level_axes();
            for step in 0..=200 {
                let theta = caster.far_rad * f64::from(step) / 200.0;
                let foot = caster.foot(caster.direction(theta, aside));
                let found = foot
                    .place
                    .cross(caster.up)
                    .length()
                    .atan2(foot.place.dot(caster.up));
                // Near the limb of an unspread grid, θ is a square root of the angle.
                let by_limb = if spread == 0.0 { 2e-7 } else { 0.0 };
                assert!(
                    (found - theta).abs() < 1e-9 * theta + 1e-11 + by_limb,
                    "{height_m} m, spread {spread}: {found} for {theta}"
                );
                assert!(foot.stretch.0 > 0.0 && foot.stretch.1 >= 0.0, "{foot:?}");
            }
        }
    }
}

#[test]
fn stretch_is_the_derivative() {
    for height_m in [1.0, 2e3, 4e5, 1e9] {
        for spread in [0.001, 0.15] {
            let (caster, _) = caster(41.0, height_m, spread);
            let (aside, other) = caster.level_axes();
            for part in [0.1, 0.5, 0.9, 0.999] {
                let nadir = caster.limb_rad * part;
                let h = 1e-3 * (caster.limb_rad - nadir);
                let at = |nadir: f64, turn: f64| {
                    let aside = aside * turn.cos() + other * turn.sin();
                    caster.foot((aside * nadir.sin() - caster.up * nadir.cos()) * caster.radii_m)
                };
                let along = at(nadir + h, 0.0).place.distance(at(nadir - h, 0.0).place) / (2.0 * h);
                let across =
                    at(nadir, 1e-3).place.distance(at(nadir, -1e-3).place) / (2e-3 * nadir.sin());
                let reported = at(nadir, 0.0).stretch;
                assert!(
                    (reported.0 / along - 1.0).abs() < 1e-4,
                    "{height_m} {spread} {part}: {reported:?} {along}"
                );
                assert!(
                    (reported.1 / across - 1.0).abs() < 1e-4,
                    "{height_m} {spread} {part}: {reported:?} {across}"
                );
            }
        }
    }
}

#[test]
fn rays_that_miss_end_on_the_limb() {
    let mut worst = 0.0_f64;
    for height_m in HEIGHTS_M {
        let (caster, eye) = caster(52.0, height_m, 0.0);
        let (aside, other) = caster.level_axes();
        for step in 0..64 {
            let turn = f64::from(step) * 0.1;
            let aside = aside * turn.cos() + other * turn.sin();
            for over in [1e-9, 1e-3, 0.1, 0.9] {
                let nadir = caster.limb_rad + over * (std::f64::consts::PI - caster.limb_rad);
                let d = (aside * nadir.sin() - caster.up * nadir.cos()) * caster.radii_m;
                let place = caster.foot(d).place;
                // On the limb's circle, in the ray's own plane through the centre.
                worst = worst.max((place.dot(caster.up) - caster.sin_limb).abs());
                assert!(
                    place.dot(caster.up.cross(aside)).abs() < 1e-12,
                    "{height_m}"
                );
                // The line of sight there is tangent to the ground: perpendicular to its normal.
                let base = (1.0 + caster.above) * caster.sin_limb;
                let to = place * base * caster.radii_m - eye;
                let normal = (place / caster.radii_m).normalize();
                let slack = 1e-12 + 4e-9 / to.length();
                assert!(normal.dot(to.normalize()).abs() < slack, "{height_m}");
                let unit = (d / caster.radii_m).normalize();
                let Cast::Limb(limb) = cast(caster.up * (1.0 + caster.above), unit, base) else {
                    panic!("{height_m} m: a ray over the limb hits");
                };
                assert!(
                    limb.distance(place * base) < 1e-12 * base + 2e-8,
                    "{height_m}"
                );
            }
        }
    }
    println!("off the limb by {worst:.2e} radii");
    assert!(worst < 1e-15);
}
