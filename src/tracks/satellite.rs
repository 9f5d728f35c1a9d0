//! One satellite: its curves followed through time, and what of it stands in a frame.

use super::curve::{Curve, STEP_RAD, Sample, Window};
use super::footprint::{WIDEST_HALF_ANGLE_RAD, footprint_outline, is_hidden};
use super::{Eye, NEAREST_MARKER_M, Stage, TrackLabel, TrackSpan, TrackStyle};
use crate::frames::{Duration, EARTH_ROTATION_RATE_RAD_S, Ellipsoid, Epoch, Orientation};
use crate::gpu::{Fill, LinePoint, Mark};
use crate::gpu::{TRACK_FROM_PREVIOUS, TRACK_ON_GROUND};
use crate::orbit::constants::EARTH_GM_M3_S2;
use crate::orbit::{Feed, Frame, Freshness, OrbitState};
use glam::{DMat3, DVec3, DVec4};

/// Longest revolution that spans are counted in, seconds; the span of what takes longer is counted in days.
const LONGEST_REVOLUTION_S: f64 = 2.0 * 86_400.0;
/// Of a feed that is live, what lies later than so long before now is asked anew: late packets change it.
const UNSETTLED_S: f64 = 10.0;
/// Radii of a marker and of the ring on the ground, pixels, for lines 2 pixels wide.
const MARKER_PX: f32 = 4.0;
const RING_PX: f32 = 6.0;
/// Opacity of a trail's oldest point, of the first after now, and of the last.
const OLDEST: f64 = 0.12;
const AHEAD: f64 = 0.6;
const LATEST: f64 = 0.15;
/// Opacity of a footprint's outline and of its fill.
const OUTLINE_OPACITY: u8 = 220;
const FILL_OPACITY: u8 = 44;

/// What is wrong with a style.
pub(super) fn check(style: &TrackStyle) -> Result<(), &'static str> {
    let is_sound = |span: TrackSpan| {
        let (before, after) = match span {
            TrackSpan::Revolutions { before, after } => (before, after),
            TrackSpan::Seconds { before_s, after_s } => (before_s, after_s),
        };
        (0.0..=1e9).contains(&before) && (0.0..=1e9).contains(&after)
    };
    if ![style.trail, style.ground_track]
        .into_iter()
        .flatten()
        .all(is_sound)
    {
        return Err("spans must be from 0 to 1e9");
    }
    let half_angle = style
        .footprint
        .and_then(|footprint| footprint.half_angle_rad);
    if half_angle.is_some_and(|angle| !(angle > 0.0 && angle <= std::f64::consts::FRAC_PI_2)) {
        return Err("the half angle of a sensor must be above 0 and at most π/2");
    }
    if !(style.width_px > 0.0 && style.width_px <= 64.0) {
        return Err("the width of lines must be above 0 and at most 64 pixels");
    }
    Ok(())
}

/// Now, and the rotations from inertial axes to the Earth as it stands now, each made when it is first asked for.
pub(super) struct Axes {
    pub now: Epoch,
    orientation: Orientation,
    itrf_from: [Option<DMat3>; Frame::ALL.len()],
}

impl Axes {
    pub fn new(now: Epoch, orientation: Orientation) -> Self {
        Self {
            now,
            orientation,
            itrf_from: [None; Frame::ALL.len()],
        }
    }

    fn itrf_from(&mut self, frame: Frame) -> DMat3 {
        let kept = &mut self.itrf_from[frame as usize];
        *kept.get_or_insert_with(|| frame.itrf_from(self.now, &self.orientation))
    }
}

pub(super) struct Satellite {
    style: TrackStyle,
    trail: Option<Curve>,
    ground: Option<Curve>,
    base: Option<Base>,
    /// Where it is, in the base's axes, if that is known.
    now_m: Option<DVec3>,
    now_s: f64,
}

/// What curves are counted from.
#[derive(Clone, Copy)]
struct Base {
    epoch: Epoch,
    frame: Frame,
    revolution_s: f64,
}

impl Base {
    fn seconds(&self, epoch: Epoch) -> f64 {
        (epoch - self.epoch).to_seconds()
    }

    fn window(&self, span: TrackSpan, now_s: f64) -> Window {
        let (before_s, after_s) = match span {
            TrackSpan::Seconds { before_s, after_s } => (before_s, after_s),
            TrackSpan::Revolutions { before, after } => {
                (before * self.revolution_s, after * self.revolution_s)
            }
        };
        Window {
            from_s: now_s - before_s,
            now_s,
            to_s: now_s + after_s,
        }
    }
}

/// A state in axes that do not turn with the Earth: its own, or TEME, which costs least to come to.
fn inertial(state: &OrbitState, orientation: &Orientation) -> OrbitState {
    match state.frame.is_earth_fixed() {
        true => state.in_frame(Frame::Teme, orientation),
        false => *state,
    }
}

/// Time of a revolution by the energy, T = 2π√(a³/μ) with 1/a = 2/r − v²/μ; a day where there is none or it is too long.
fn revolution_s(state: &OrbitState) -> f64 {
    const DAY_S: f64 = 86_400.0;
    let inverse =
        2.0 / state.position_m.length() - state.velocity_m_s.length_squared() / EARTH_GM_M3_S2;
    if inverse <= 0.0 {
        return DAY_S;
    }
    let time_s = std::f64::consts::TAU / (EARTH_GM_M3_S2 * inverse.powi(3)).sqrt();
    match time_s <= LONGEST_REVOLUTION_S {
        true => time_s,
        false => DAY_S,
    }
}

impl Satellite {
    pub fn new(style: &TrackStyle, most: usize) -> Self {
        Self {
            style: *style,
            trail: style.trail.map(|_| Curve::new(most)),
            ground: style.ground_track.map(|_| Curve::new(most)),
            base: None,
            now_m: None,
            now_s: 0.0,
        }
    }

    /// Follows the feed to now. Answers whether its curves are whole.
    pub fn follow(
        &mut self,
        feed: &dyn Feed,
        axes: &mut Axes,
        ellipsoid: &Ellipsoid,
        budget: &mut usize,
    ) -> bool {
        self.now_m = None;
        if self.style.is_nothing() {
            return true;
        }
        let (first, last) = feed.validity();
        let orientation = axes.orientation;
        let state_at = |epoch: Epoch| {
            let state = feed.state_at(epoch).ok()?;
            let state = inertial(&state, &orientation);
            // Division by a radius of 0, and what is no number, end here.
            let is_sound = state.position_m.is_finite() && state.position_m != DVec3::ZERO;
            is_sound.then_some(state)
        };
        let is_known = first <= axes.now && axes.now <= last;
        let state = match is_known {
            true => state_at(axes.now),
            // Without a state of now there may be one to count from.
            false if self.base.is_none() && first <= last => state_at(axes.now.clamp(first, last)),
            false => None,
        };
        if let Some(state) = state
            && self.base.is_none_or(|base| base.frame != state.frame)
        {
            self.curves().for_each(Curve::clear);
            self.base = Some(Base {
                epoch: axes.now,
                frame: state.frame,
                revolution_s: revolution_s(&state),
            });
        }
        let Some(base) = self.base else {
            return true;
        };
        self.now_m = state.filter(|_| is_known).map(|state| state.position_m);
        self.now_s = base.seconds(axes.now);
        let now_s = self.now_s;
        if feed.freshness() != Freshness::Settled {
            self.curves()
                .for_each(|curve| curve.forget_after(now_s - UNSETTLED_S));
        }
        let reach = (base.seconds(first), base.seconds(last));
        let itrf_from_inertial = axes.itrf_from(base.frame);
        let sample = |t_s: f64| {
            // Seconds are rounded; the ends of what is known are not to be missed for that.
            let epoch = (base.epoch + Duration::from_seconds(t_s)).clamp(first, last);
            let state = state_at(epoch)?.in_frame(base.frame, &orientation);
            let speed = state.velocity_m_s.length();
            let step_s = STEP_RAD * state.position_m.length() / speed.max(1.0);
            Some(Sample {
                t_s,
                point_m: state.position_m,
                step_s,
            })
        };
        let mut is_whole = true;
        if let (Some(curve), Some(span)) = (&mut self.trail, self.style.trail) {
            is_whole &= curve.follow(base.window(span, now_s), reach, budget, sample);
        }
        if let (Some(curve), Some(span)) = (&mut self.ground, self.style.ground_track) {
            let on_ground = |t_s: f64| {
                let sample = sample(t_s)?;
                // The Earth turns on from where it stands now.
                let turned = EARTH_ROTATION_RATE_RAD_S * (t_s - now_s);
                let place_itrf_m =
                    DMat3::from_rotation_z(-turned) * (itrf_from_inertial * sample.point_m);
                Some(Sample {
                    point_m: foot(place_itrf_m, ellipsoid),
                    // The ground turns below what hardly moves.
                    step_s: 1.0 / (1.0 / sample.step_s + EARTH_ROTATION_RATE_RAD_S / STEP_RAD),
                    ..sample
                })
            };
            is_whole &= curve.follow(base.window(span, now_s), reach, budget, on_ground);
        }
        is_whole
    }

    fn curves(&mut self) -> impl Iterator<Item = &mut Curve> {
        [&mut self.trail, &mut self.ground].into_iter().flatten()
    }

    /// Adds what is to be drawn of it.
    pub fn stage(&self, index: usize, eye: &Eye<'_>, axes: &mut Axes, stage: &mut Stage) {
        let Some(base) = self.base.filter(|_| !self.style.is_nothing()) else {
            return;
        };
        let itrf_from_inertial = axes.itrf_from(base.frame);
        let place_itrf_m = self.now_m.map(|place| itrf_from_inertial * place);
        let foot_itrf_m = place_itrf_m.map(|place| foot(place, eye.ellipsoid));
        if let (Some(footprint), Some(place)) = (self.style.footprint, place_itrf_m) {
            let half_angle_rad = footprint.half_angle_rad.unwrap_or(WIDEST_HALF_ANGLE_RAD);
            self.stage_footprint(place, half_angle_rad, footprint.is_filled, eye, stage);
        }
        if let (Some(curve), Some(span)) = (&self.ground, self.style.ground_track) {
            let window = base.window(span, self.now_s);
            let mut line = Line::new(self, TRACK_ON_GROUND, eye, &mut stage.points);
            curve.walk(window, foot_itrf_m, |t_s, place| {
                line.add(place, opacity(t_s, window));
            });
        }
        if let (Some(curve), Some(span)) = (&self.trail, self.style.trail) {
            let window = base.window(span, self.now_s);
            let mut line = Line::new(self, 0, eye, &mut stage.points);
            curve.walk(window, self.now_m, |t_s, place| {
                line.add(itrf_from_inertial * place, opacity(t_s, window));
            });
        }
        let scale = 0.5 * self.style.width_px;
        let [red, green, blue] = self.style.color;
        let mut mark = |place: DVec3, flags, radius_px: f32| {
            stage.marks.push(Mark {
                from_eye_m: (place - eye.itrf_m).as_vec3().to_array(),
                flags,
                color: [red, green, blue, 255],
                radius_px: radius_px * scale,
            });
        };
        if let Some(foot) = foot_itrf_m.filter(|_| self.style.subpoint) {
            mark(foot, TRACK_ON_GROUND, RING_PX);
        }
        if let Some(place) = place_itrf_m.filter(|_| self.style.marker)
            && place.distance(eye.itrf_m) >= NEAREST_MARKER_M
        {
            mark(place, 0, MARKER_PX);
            let at_px = eye
                .pixel(place)
                .filter(|_| !is_hidden(eye.itrf_m, place, eye.ellipsoid));
            stage.labels.extend(at_px.map(|at_px| TrackLabel {
                satellite: index,
                at_px,
                color: self.style.color,
            }));
        }
    }

    fn stage_footprint(
        &self,
        place_itrf_m: DVec3,
        half_angle_rad: f64,
        is_filled: bool,
        eye: &Eye<'_>,
        stage: &mut Stage,
    ) {
        let outline = &mut stage.outline;
        outline.clear();
        footprint_outline(place_itrf_m, half_angle_rad, eye.ellipsoid, |point| {
            outline.push(point);
        });
        let mut line = Line::new(self, TRACK_ON_GROUND, eye, &mut stage.points);
        for point in outline.iter().chain(outline.first()) {
            line.add(*point, f64::from(OUTLINE_OPACITY) / 255.0);
        }
        if is_filled && !outline.is_empty() {
            stage
                .fills
                .extend(self.fill(place_itrf_m, half_angle_rad, outline, eye));
        }
    }

    /// `None` where none of it can be on screen.
    fn fill(
        &self,
        place_itrf_m: DVec3,
        half_angle_rad: f64,
        outline: &[DVec3],
        eye: &Eye<'_>,
    ) -> Option<Fill> {
        let geodetic = eye.ellipsoid.geodetic_from_itrf(place_itrf_m);
        let down = -Ellipsoid::normal(geodetic.lat_rad, geodetic.lon_rad);
        // The cap lies in the ball about its foot that reaches its outline.
        let center = foot(place_itrf_m, eye.ellipsoid);
        let reach = outline.iter().map(|point| point.distance_squared(center));
        let radius_m = reach.fold(0.0, f64::max).sqrt();
        let bounds = eye.bounds(center, radius_m)?;
        let nearest_m = (center.distance(eye.itrf_m) - radius_m).max(0.0);
        let toward = (center - eye.itrf_m).normalize_or(down);
        let clip = eye.clip(eye.itrf_m + toward * nearest_m.max(1.0));
        let [red, green, blue] = self.style.color;
        Some(Fill {
            bounds,
            apex: (eye.ellipsoid.scaled_from_itrf() * place_itrf_m)
                .as_vec3()
                .to_array(),
            depth: (clip.z / clip.w).clamp(0.0, 1.0) as f32,
            down: down.as_vec3().to_array(),
            tangent: half_angle_rad.min(WIDEST_HALF_ANGLE_RAD).tan() as f32,
            color: [red, green, blue, FILL_OPACITY],
        })
    }
}

/// Where the ellipsoid's normal through a place stands.
fn foot(place_itrf_m: DVec3, ellipsoid: &Ellipsoid) -> DVec3 {
    let place = ellipsoid.geodetic_from_itrf(place_itrf_m);
    ellipsoid.surface_point(Ellipsoid::normal(place.lat_rad, place.lon_rad))
}

/// Fading with age, and with what is not yet.
fn opacity(t_s: f64, window: Window) -> f64 {
    let part = |of: f64, whole: f64| if whole > 0.0 { of / whole } else { 0.0 };
    if t_s <= window.now_s {
        1.0 + (OLDEST - 1.0) * part(window.now_s - t_s, window.now_s - window.from_s)
    } else {
        AHEAD + (LATEST - AHEAD) * part(t_s - window.now_s, window.to_s - window.now_s)
    }
}

/// A line being written.
struct Line<'l> {
    points: &'l mut Vec<LinePoint>,
    eye_itrf_m: DVec3,
    color: [u8; 3],
    half_width_px: f32,
    /// Of the next point.
    flags: u32,
}

impl<'l> Line<'l> {
    fn new(of: &Satellite, flags: u32, eye: &Eye<'_>, points: &'l mut Vec<LinePoint>) -> Self {
        Self {
            points,
            eye_itrf_m: eye.itrf_m,
            color: of.style.color,
            half_width_px: 0.5 * of.style.width_px,
            flags,
        }
    }

    fn add(&mut self, place_itrf_m: DVec3, opacity: f64) {
        let [red, green, blue] = self.color;
        self.points.push(LinePoint {
            from_eye_m: (place_itrf_m - self.eye_itrf_m).as_vec3().to_array(),
            flags: self.flags,
            color: [red, green, blue, (255.0 * opacity) as u8],
            half_width_px: self.half_width_px,
        });
        self.flags |= TRACK_FROM_PREVIOUS;
    }
}

impl Eye<'_> {
    fn clip(&self, place_itrf_m: DVec3) -> DVec4 {
        self.clip_from_eye * (place_itrf_m - self.itrf_m).extend(1.0)
    }

    /// Pixels from the viewport's upper left corner; `None` outside the picture.
    fn pixel(&self, place_itrf_m: DVec3) -> Option<[f32; 2]> {
        let clip = self.clip(place_itrf_m);
        let at = clip.truncate() / clip.w;
        let is_inside = clip.w > 0.0 && at.x.abs() <= 1.0 && at.y.abs() <= 1.0;
        let (width, height) = (f64::from(self.size.0), f64::from(self.size.1));
        is_inside.then_some([
            (0.5 * (at.x + 1.0) * width) as f32,
            (0.5 * (1.0 - at.y) * height) as f32,
        ])
    }

    /// The part of the screen that a ball may cover: least x and y, greatest x and y; `None` where it covers none.
    fn bounds(&self, center_itrf_m: DVec3, radius_m: f64) -> Option<[f32; 4]> {
        const WHOLE: [f64; 4] = [-1.0, -1.0, 1.0, 1.0];
        let corners = (0..8).map(|k| {
            let side = |bit: u32| {
                if k >> bit & 1 == 1 {
                    radius_m
                } else {
                    -radius_m
                }
            };
            self.clip(center_itrf_m + DVec3::new(side(0), side(1), side(2)))
        });
        let mut bounds = [
            f64::INFINITY,
            f64::INFINITY,
            f64::NEG_INFINITY,
            f64::NEG_INFINITY,
        ];
        for clip in corners {
            if clip.w <= 0.0 {
                return Some(WHOLE.map(|edge| edge as f32));
            }
            let (x, y) = (clip.x / clip.w, clip.y / clip.w);
            bounds = [
                bounds[0].min(x),
                bounds[1].min(y),
                bounds[2].max(x),
                bounds[3].max(y),
            ];
        }
        let [left, low, right, high] = bounds.map(|edge| edge.clamp(-1.0, 1.0) as f32);
        (left < right && low < high).then_some([left, low, right, high])
    }
}

#[cfg(test)]
#[path = "satellite_tests.rs"]
mod tests;
