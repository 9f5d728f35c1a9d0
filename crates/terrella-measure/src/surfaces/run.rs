//! State shared by the measurements of all settings.

use super::{Candidate, SurfacePath, TestGround};
use terrella::frames::Ellipsoid;
use terrella::{EarthOptions, EyeView, GpuContext, GroundOptions, Sky};
use terrella_play::Progress;

/// The picture, the Earth and the adapter that everything is measured with.
pub(super) struct FlightMeter<'s> {
    pub gpu: &'s GpuContext,
    pub options: &'s EarthOptions,
    pub sky: Sky,
    /// Of all pictures, pixels: those that are timed and those that are compared with the data.
    pub size: (u32, u32),
    /// Frames of a flight that are timed.
    pub places: u32,
    pub progress: &'s dyn Progress,
}

impl FlightMeter<'_> {
    pub fn figure(&self) -> Ellipsoid {
        self.options.figure.ellipsoid()
    }

    /// The view at a time of a flight, seconds.
    pub fn view(&self, path: SurfacePath, ground: &TestGround, time_s: f64) -> EyeView {
        let aspect = f64::from(self.size.0) / f64::from(self.size.1);
        let elevation = ground.elevation.as_ref();
        path.view(time_s, ground.site, &self.figure(), elevation, aspect)
    }

    pub fn ground_options(&self, ground: &TestGround, candidate: &Candidate) -> GroundOptions {
        GroundOptions {
            elevation: ground.elevation.clone(),
            surface: candidate.surface,
            tolerance_px: candidate.tolerance_px,
        }
    }
}
