//! How wrong a surface is on a flight, frame by frame as it is flown.

use super::rows::{ErrorRow, rounded};
use super::run::FlightMeter;
use super::{Candidate, SurfacePath, SurfacesError, TestGround};
use crate::errors::{GeolocationRenderer, GroundPicture};
use crate::frame_timer::milliseconds;
use crate::{LogHistogram, SortedSample};
use cpu_time::ThreadTime;
use std::time::Duration;
use terrella::EyeView;
use terrella::internals::earth::PixelLattice;
use terrella_reference::TrueRelief;

/// Frames a second of simulated time.
pub(super) const FRAMES_PER_S: f64 = 60.0;
/// How long a flight's first view may take to become as fine as it would be had it been flown to.
pub(super) const SETTLE: Duration = Duration::from_secs(60);
/// Of this many pixels both ways one is looked at in each frame, another one in the next.
const SPREAD: u32 = 10;
/// A window of the picture, pixels, in which all are looked at.
const WINDOW: (u32, u32) = (96, 54);
/// Frames before the window is moved.
const WINDOW_FRAMES: u32 = 8;
/// Interval of frames that are compared with the exact image.
const EXACT_EVERY: u32 = 2 * WINDOW_FRAMES;

/// The exact images in the windows of a flight.
pub(super) struct ExactFlight {
    pictures: Vec<TrueRelief>,
}

impl FlightMeter<'_> {
    /// The exact pictures of a flight, for all surfaces; fewer if that was stopped.
    pub fn exact(&self, ground: &TestGround, path: SurfacePath) -> ExactFlight {
        let (figure, elevation) = (self.figure(), ground.elevation.as_ref());
        let frames = (0..frames(path)).step_by(EXACT_EVERY as usize);
        let pictures = frames
            .take_while(|_| !self.progress.cancelled())
            .filter_map(|frame| {
                let view = self.view_in_frame(path, ground, frame);
                TrueRelief::of_points(&view, &window(self.size, frame), &figure, elevation)
            });
        ExactFlight {
            pictures: pictures.collect(),
        }
    }

    /// Flies a path with one setting; `None` if that was stopped.
    pub fn errors(
        &self,
        ground: &TestGround,
        path: SurfacePath,
        candidate: &Candidate,
        exact: &ExactFlight,
    ) -> Result<Option<ErrorRow>, SurfacesError> {
        let options = self.ground_options(ground, candidate);
        let mut earth = GeolocationRenderer::with_ground(self.gpu, &options)?;
        earth.settle(&self.view_in_frame(path, ground, 0), self.size, SETTLE);
        let mut found = Found::default();
        let mut before: Option<GroundPicture> = None;
        for frame in 0..frames(path) {
            if self.progress.cancelled() {
                return Ok(None);
            }
            let view = self.view_in_frame(path, ground, frame);
            let begin = ThreadTime::now();
            let stats = earth.prepare(&view, self.size);
            found.prepare_ms.push(milliseconds(begin.elapsed()));
            found.add_stats(&stats);
            let spread = PixelLattice::spread(self.size, SPREAD, shift(frame));
            if let Some(picture) = self.look(&mut earth, ground, &view, &spread)? {
                found.add_errors(&picture);
                found.holes += picture.holes(&self.figure(), ground.elevation.as_ref()) as u64;
            }
            let window = window(self.size, frame);
            let Some(now) = self.look(&mut earth, ground, &view, &window)? else {
                continue;
            };
            found.holes += now.holes(&self.figure(), ground.elevation.as_ref()) as u64;
            let same_window = before.as_ref().filter(|_| !is_moved(frame));
            for jump_px in same_window
                .into_iter()
                .flat_map(|before| now.jumps_px(before))
            {
                found.jumps_px.add(jump_px);
            }
            let nth = (frame / EXACT_EVERY) as usize;
            let exact = exact.pictures.get(nth).filter(|_| frame % EXACT_EVERY == 0);
            if let Some(exact) = exact {
                found.elsewhere += now.elsewhere(exact);
                found.looked_at += now.inner_points();
            }
            before = Some(now);
        }
        Ok(Some(found.row(ground, path, candidate)))
    }

    /// Draws points of the view that was prepared last and holds them against the data.
    pub fn look(
        &self,
        earth: &mut GeolocationRenderer,
        ground: &TestGround,
        view: &EyeView,
        points: &PixelLattice,
    ) -> Result<Option<GroundPicture>, SurfacesError> {
        let places = earth.draw_points(view, points)?;
        let (figure, elevation) = (self.figure(), ground.elevation.as_ref());
        Ok(GroundPicture::of_points(
            &places, view, points, &figure, elevation,
        ))
    }

    fn view_in_frame(&self, path: SurfacePath, ground: &TestGround, frame: u32) -> EyeView {
        self.view(path, ground, f64::from(frame) / FRAMES_PER_S)
    }
}

/// Frames of a flight.
fn frames(path: SurfacePath) -> u32 {
    (path.duration_s() * FRAMES_PER_S) as u32
}

/// Which pixel of each square is looked at: after so many frames as it has pixels, each once.
fn shift(frame: u32) -> (u32, u32) {
    // Three columns and seven rows on, so that frames beside each other look far apart. The determinant, −1, has no divisor of a
    // side, so no pixel is met twice.
    let (column, row) = (frame % SPREAD, frame / SPREAD % SPREAD);
    ((column * 3 + row) % SPREAD, (column * 7 + row * 2) % SPREAD)
}

/// Whether the window has moved since the previous frame.
fn is_moved(frame: u32) -> bool {
    frame.is_multiple_of(WINDOW_FRAMES)
}

/// The window of a frame, spread evenly over the picture (Halton 1960).
fn window(picture: (u32, u32), frame: u32) -> PixelLattice {
    let nth = frame / WINDOW_FRAMES;
    let points = (WINDOW.0.min(picture.0), WINDOW.1.min(picture.1));
    let corner =
        |side: u32, of_window: u32, part: f64| (part * f64::from(side - of_window + 1)) as u32;
    let x = corner(picture.0, points.0, radical_inverse(2, nth));
    let y = corner(picture.1, points.1, radical_inverse(3, nth));
    PixelLattice::window(picture, (x, y), points)
}

/// The digits of a number in a base, mirrored at the point: 0…1.
fn radical_inverse(base: u32, mut n: u32) -> f64 {
    let (mut value, mut digit) = (0.0, 1.0 / f64::from(base));
    while n > 0 {
        value += f64::from(n % base) * digit;
        digit /= f64::from(base);
        n /= base;
    }
    value
}

/// Errors of a flight so far.
#[derive(Default)]
struct Found {
    prepare_ms: Vec<f64>,
    triangles: Vec<f64>,
    written_bytes: Vec<f64>,
    vertices_most: u32,
    resident_bytes: u64,
    gpu_bytes: u64,
    reported_px: Option<f64>,
    metres: LogHistogram,
    pixels: LogHistogram,
    worst_frame_px: f64,
    holes: u64,
    elsewhere: usize,
    looked_at: usize,
    jumps_px: LogHistogram,
}

impl Found {
    fn add_stats(&mut self, stats: &terrella::FrameStats) {
        let ground = &stats.ground;
        self.triangles.push(f64::from(ground.triangles));
        self.written_bytes.push(stats.uploaded_bytes as f64);
        self.vertices_most = self.vertices_most.max(ground.vertices);
        self.resident_bytes = self.resident_bytes.max(ground.resident_bytes);
        self.gpu_bytes = self.gpu_bytes.max(stats.ground_bytes);
        if let Some(reported) = ground.error_px {
            self.reported_px = Some(
                self.reported_px
                    .map_or(reported, |before| before.max(reported)),
            );
        }
    }

    fn add_errors(&mut self, picture: &GroundPicture) {
        let mut pixels = Vec::new();
        for (metres, px) in picture.distances() {
            self.metres.add(metres);
            self.pixels.add(px);
            pixels.push(px);
        }
        let p99 = SortedSample::new(pixels).quantile(0.99);
        self.worst_frame_px = self.worst_frame_px.max(p99);
    }

    fn row(self, ground: &TestGround, path: SurfacePath, candidate: &Candidate) -> ErrorRow {
        let setting = &candidate.setting;
        let frames = self.prepare_ms.len() as u32;
        let prepare = SortedSample::new(self.prepare_ms);
        let (triangles, written) = (
            SortedSample::new(self.triangles),
            SortedSample::new(self.written_bytes),
        );
        let percent = 100.0 * self.elsewhere as f64 / self.looked_at.max(1) as f64;
        ErrorRow {
            data: ground.name.into(),
            path,
            surface: setting.surface,
            parameter: setting.parameter.into(),
            value: setting.value.clone(),
            is_default: setting.is_default,
            frames,
            prepare_ms_median: rounded(prepare.median(), 3),
            prepare_ms_p99: rounded(prepare.quantile(0.99), 3),
            prepare_ms_most: rounded(prepare.max(), 3),
            triangles_median: triangles.median() as u64,
            triangles_most: triangles.max() as u64,
            vertices_most: self.vertices_most.into(),
            resident_bytes: self.resident_bytes,
            gpu_bytes: self.gpu_bytes,
            written_bytes_median: written.median() as u64,
            error_m_median: rounded(self.metres.quantile(0.5), 3),
            error_m_p99: rounded(self.metres.quantile(0.99), 3),
            error_m_most: rounded(self.metres.max(), 3),
            error_px_median: rounded(self.pixels.quantile(0.5), 4),
            error_px_p99: rounded(self.pixels.quantile(0.99), 4),
            error_px_most: rounded(self.pixels.max(), 4),
            worst_frame_px: rounded(self.worst_frame_px, 4),
            reported_px_most: self.reported_px.map(|reported| rounded(reported, 4)),
            holes: self.holes,
            elsewhere_percent: rounded(percent, 4),
            popping_px_p999: rounded(self.jumps_px.quantile(0.999), 4),
            popping_px_most: rounded(self.jumps_px.max(), 4),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_pixel_of_a_square_has_its_turn() {
        let mut seen = vec![0; (SPREAD * SPREAD) as usize];
        for frame in 0..SPREAD * SPREAD {
            let (x, y) = shift(frame);
            seen[(y * SPREAD + x) as usize] += 1;
        }
        assert!(seen.iter().all(|count| *count == 1), "{seen:?}");
    }

    #[test]
    fn windows_stay_within_the_picture_and_go_everywhere() {
        let size = (1280, 720);
        let mut seen = vec![false; 16 * 9];
        for frame in 0..3600 {
            let window = window(size, frame);
            let (first, last) = (window.at(0, 0), window.at(WINDOW.0 - 1, WINDOW.1 - 1));
            assert!(first.min_element() >= 0.5 && last.x <= 1279.5 && last.y <= 719.5);
            let middle = 0.5 * (first + last) / 80.0;
            seen[middle.y as usize * 16 + middle.x as usize] = true;
            let is_same = frame == 0 || window == super::window(size, frame - 1);
            assert!(is_same || is_moved(frame));
        }
        // Its middle comes into each part of the picture but those along the border.
        let inner = (1..8).flat_map(|y| (1..15).map(move |x| y * 16 + x));
        assert!(inner.clone().all(|k| seen[k]), "{seen:?}");
        let small = window((64, 36), 1000);
        assert_eq!((small.points, small.at(0, 0).x), ((64, 36), 0.5));
    }
}
