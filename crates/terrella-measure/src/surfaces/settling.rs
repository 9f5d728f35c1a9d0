//! How a surface becomes fine after a jump.

use super::flight_errors::SETTLE;
use super::rows::{SettlingRow, rounded};
use super::run::FlightMeter;
use super::{Candidate, SurfacePath, SurfacesError, TestGround};
use crate::SortedSample;
use crate::errors::GeolocationRenderer;
use crate::frame_timer::milliseconds;
use cpu_time::ThreadTime;
use terrella::internals::earth::PixelLattice;

/// Frames that are waited for at most.
const MOST_FRAMES: usize = 900;
/// After so many frames without any change nothing is waited for.
const STILL_FRAMES: usize = 60;
/// One of this many pixels in both directions is compared.
const SPREAD: u32 = 10;
/// Criterion of settling: factor of the last error, and tolerance, pixels.
const SETTLED: f64 = 1.1;
const DOUBLE: f64 = 2.0;
const MORE_PX: f64 = 0.02;

impl FlightMeter<'_> {
    /// Jumps from the orbit to the low flight, and stays there. `None` if it was stopped.
    pub fn settling(
        &self,
        ground: &TestGround,
        candidate: &Candidate,
    ) -> Result<Option<SettlingRow>, SurfacesError> {
        let options = self.ground_options(ground, candidate);
        let mut earth = GeolocationRenderer::with_ground(self.gpu, &options)?;
        let middle = |path: SurfacePath| self.view(path, ground, 0.5 * path.duration_s());
        earth.settle(&middle(SurfacePath::Orbit), self.size, SETTLE);
        let view = middle(SurfacePath::Low);
        let points = PixelLattice::spread(self.size, SPREAD, (SPREAD / 2, SPREAD / 2));
        let (mut errors_px, mut prepare_ms_most) = (Vec::new(), 0.0_f64);
        while errors_px.len() < MOST_FRAMES && !is_still(&errors_px) {
            if self.progress.cancelled() {
                return Ok(None);
            }
            let begin = ThreadTime::now();
            earth.prepare(&view, self.size);
            prepare_ms_most = prepare_ms_most.max(milliseconds(begin.elapsed()));
            let picture = self.look(&mut earth, ground, &view, &points)?;
            let pixels = picture.iter().flat_map(|p| p.distances().map(|(_, px)| px));
            errors_px.push(SortedSample::new(pixels.collect()).quantile(0.99));
        }
        let setting = &candidate.setting;
        let settled_px = errors_px.last().copied().unwrap_or_default();
        Ok(Some(SettlingRow {
            data: ground.name.into(),
            surface: setting.surface,
            parameter: setting.parameter.into(),
            value: setting.value.clone(),
            is_default: setting.is_default,
            frames: within_after(&errors_px, SETTLED),
            frames_to_double: within_after(&errors_px, DOUBLE),
            first_px: rounded(errors_px.first().copied().unwrap_or_default(), 4),
            settled_px: rounded(settled_px, 4),
            prepare_ms_most: rounded(prepare_ms_most, 3),
        }))
    }
}

fn is_still(errors_px: &[f64]) -> bool {
    let last = errors_px.rchunks(STILL_FRAMES).next().unwrap_or_default();
    last.len() == STILL_FRAMES && last.iter().all(|error| *error == last[0])
}

/// The first frame from which on errors are at most so many times the last one.
fn within_after(errors_px: &[f64], times: f64) -> u32 {
    let Some(last) = errors_px.last() else {
        return 0;
    };
    let most = times * last + MORE_PX;
    let above = errors_px.iter().rposition(|error| *error > most);
    above.map_or(0, |frame| frame as u32 + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settled_is_what_stays() {
        assert_eq!(within_after(&[], SETTLED), 0);
        assert_eq!(within_after(&[1.0, 1.0], SETTLED), 0);
        assert_eq!(within_after(&[40.0, 9.0, 1.1, 1.0], SETTLED), 2);
        // Worse once more.
        assert_eq!(within_after(&[40.0, 1.0, 9.0, 1.1, 1.0], SETTLED), 3);
        assert_eq!(within_after(&[40.0, 1.9, 1.2, 1.0], DOUBLE), 1);
        let mut errors = vec![3.0; STILL_FRAMES];
        assert!(is_still(&errors));
        errors[3] = 2.0;
        assert!(!is_still(&errors) && !is_still(&errors[..5]));
    }
}
