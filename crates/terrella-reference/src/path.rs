//! A ray's way through the air, cut where the air changes its law.

use super::geometry::{ScaledRay, half_chord};
use super::grid::Gauss;
use glam::DVec3;

/// Heights between which a ray is integrated in one piece, metres: over them densities change by a small factor.
#[rustfmt::skip]
pub(super) const SHELLS_M: [f64; 15] = [
    0.0, 800.0, 2_000.0, 4_000.0, 7_000.0, 11_000.0, 15_000.0, 20_000.0, 26_000.0, 34_000.0, 45_000.0, 60_000.0,
    72_000.0, 84_000.0, 100_000.0,
];

/// Heights at which sunlight that grazes the Earth passes over it, metres: between them its colour changes steeply.
const GRAZING_M: [f64; 4] = [0.0, 4_000.0, 12_000.0, 30_000.0];

/// Ends and inner breakpoints of the pieces: two of each shell and of each grazing cylinder.
const MAX_BREAKPOINTS: usize = 2 + 2 * (SHELLS_M.len() + GRAZING_M.len());

/// The part of a ray inside the air. Lengths are equatorial radii of scaled space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Path {
    /// The line's point nearest to the centre.
    foot: DVec3,
    direction: DVec3,
    /// foot² − 1, without cancellation.
    foot_above: f64,
    nearest: f64,
    /// From where to where, measured from the foot.
    from: f64,
    to: f64,
    /// Whether it ends on the ground.
    pub meets_ground: bool,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct PathPoint {
    /// From the centre, of length 1 + `height`.
    pub point: DVec3,
    /// Above the ground, equatorial radii.
    pub height: f64,
}

impl Path {
    /// The part of a ray from its start to the ground or out of the air, whose upper boundary is at radius `top`; `None` if it misses the air.
    pub fn new(line: &ScaledRay, top: f64) -> Option<Self> {
        Self::until(line, top, f64::INFINITY)
    }

    /// The same of a ray that ends at a distance from its start, if it comes so far: on ground above the sphere.
    pub fn until(line: &ScaledRay, top: f64, distance: f64) -> Option<Self> {
        let nearest = line.nearest;
        let half = half_chord(top, nearest);
        if nearest >= top || half <= -line.along {
            return None;
        }
        let ground = line.ground();
        let from = (-line.along).max(-half);
        let to = ground.map_or(half, |_| -half_chord(1.0, nearest));
        Some(Self {
            foot: line.point(line.along),
            direction: line.direction,
            foot_above: (nearest - 1.0) * (nearest + 1.0),
            nearest,
            from,
            to: to.min(distance - line.along).max(from),
            meets_ground: ground.is_some(),
        })
    }

    /// From radius 1 + `height` at zenith cosine `mu` out of the air, whatever is in the way.
    pub fn out_of_air(height: f64, mu: f64, top: f64) -> Self {
        let radius = 1.0 + height;
        let across = ((1.0 - mu) * (1.0 + mu)).max(0.0).sqrt();
        let nearest = radius * across;
        // (r sin)² − 1 = (r² − 1) − r² cos².
        let foot_above = height * (radius + 1.0) - radius * radius * mu * mu;
        Self {
            foot: DVec3::new(0.0, 0.0, nearest),
            direction: DVec3::X,
            foot_above,
            nearest,
            from: radius * mu,
            to: half_chord(top, nearest).max(radius * mu),
            meets_ground: false,
        }
    }

    /// The point where the path ends.
    pub fn end(&self) -> DVec3 {
        self.foot + self.direction * self.to
    }

    /// Its direction, a unit vector.
    pub fn direction(&self) -> DVec3 {
        self.direction
    }

    /// A place by its distance from the foot.
    pub fn place(&self, at: f64) -> PathPoint {
        let above = self.foot_above + at * at;
        PathPoint {
            point: self.foot + self.direction * at,
            // r − 1 = (r² − 1)/(r + 1).
            height: (above / (1.0 + (1.0 + above).max(0.0).sqrt())).max(0.0),
        }
    }

    /// The breakpoints of its pieces in rising order, both ends among them. `shells` are radii; with a `sun` the pieces also
    /// end where the ray enters or leaves the Earth's shadow and the steepest part of twilight.
    pub fn breakpoints(&self, shells: &[f64], radius_m: f64, sun: Option<DVec3>) -> Breakpoints {
        let mut breakpoints = Breakpoints::default();
        breakpoints.push(self.from);
        breakpoints.push(self.to);
        let mut cut = |at: f64| {
            if at > self.from && at < self.to {
                breakpoints.push(at);
            }
        };
        for shell in shells {
            let half = half_chord(*shell, self.nearest);
            if half > 0.0 {
                cut(-half);
                cut(half);
            }
        }
        if let Some(sun) = sun {
            self.grazing(sun, radius_m, &mut cut);
        }
        breakpoints.sorted()
    }

    /// Where the ray passes, on the night side, through a cylinder about the axis to the Sun.
    fn grazing(&self, sun: DVec3, radius_m: f64, cut: &mut impl FnMut(f64)) {
        let (p, d) = (self.foot.reject_from(sun), self.direction.reject_from(sun));
        let (square, half) = (d.length_squared(), p.dot(d));
        for lift_m in GRAZING_M {
            let radius = 1.0 + lift_m / radius_m;
            let root = half * half - square * (p.length() - radius) * (p.length() + radius);
            if square < 1e-14 || root <= 0.0 {
                continue;
            }
            for root in [-root.sqrt(), root.sqrt()] {
                let at = (root - half) / square;
                if (self.foot + self.direction * at).dot(sun) < 0.0 {
                    cut(at);
                }
            }
        }
    }
}

/// The ends of the pieces that a path is integrated in.
#[derive(Clone, Copy, Debug)]
pub(super) struct Breakpoints {
    at: [f64; MAX_BREAKPOINTS],
    count: usize,
}

impl Default for Breakpoints {
    fn default() -> Self {
        Self {
            at: [0.0; MAX_BREAKPOINTS],
            count: 0,
        }
    }
}

impl Breakpoints {
    fn push(&mut self, at: f64) {
        if let Some(place) = self.at.get_mut(self.count) {
            *place = at;
            self.count += 1;
        }
    }

    fn sorted(mut self) -> Self {
        self.at[..self.count].sort_unstable_by(f64::total_cmp);
        self
    }

    pub fn pieces(&self) -> impl Iterator<Item = (f64, f64)> {
        self.at[..self.count]
            .windows(2)
            .map(|pair| (pair[0], pair[1]))
    }

    /// Nodes and weights of all pieces in order.
    pub fn nodes<'b>(&'b self, rule: &'b Gauss) -> impl Iterator<Item = (f64, f64)> + 'b {
        self.pieces().flat_map(|(from, to)| rule.on(from, to))
    }
}
