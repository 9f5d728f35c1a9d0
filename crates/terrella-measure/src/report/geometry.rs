//! Errors of limb and places, each measured once for all settings that draw the same mesh.

use crate::errors::{
    GeolocationErrors, GeolocationRenderer, SilhouetteErrors, geolocation, silhouette,
};
use terrella::frames::Ellipsoid;
use terrella::{EyeView, Figure, GpuContext, Visibility};
use terrella_play::PlayError;

/// Settings that limb and geolocation depend on. Maps have no effect.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct GeometryKey {
    pub height_km: f64,
    /// Cells per block edge.
    pub subdivision: u32,
    pub visibility: Visibility,
    /// Width and height, pixels.
    pub size: (u32, u32),
}

/// Errors of limb and places.
#[derive(Clone, Copy, Debug)]
pub(super) struct GeometryErrors {
    pub silhouette: SilhouetteErrors,
    pub geolocation: GeolocationErrors,
}

/// Measured errors, and the last renderer.
pub(super) struct GeometryMeter<'r> {
    gpu: &'r GpuContext,
    figure: Figure,
    renderer: Option<(u32, Visibility, GeolocationRenderer)>,
    found: Vec<(GeometryKey, GeometryErrors)>,
}

impl<'r> GeometryMeter<'r> {
    /// For an Earth of this figure.
    pub fn new(gpu: &'r GpuContext, figure: Figure) -> Self {
        Self {
            gpu,
            figure,
            renderer: None,
            found: Vec::new(),
        }
    }

    /// The errors of a view.
    pub fn measure(
        &mut self,
        key: GeometryKey,
        view: &EyeView,
    ) -> Result<GeometryErrors, PlayError> {
        if let Some((_, found)) = self.found.iter().find(|(known, _)| *known == key) {
            return Ok(*found);
        }
        let figure: Ellipsoid = self.figure.ellipsoid();
        let (cells, rule) = (key.subdivision, key.visibility);
        let known = self.renderer.take();
        let renderer = match known.filter(|(c, r, _)| (*c, *r) == (cells, rule)) {
            Some((.., renderer)) => renderer,
            None => GeolocationRenderer::new(self.gpu, self.figure, cells, rule)?,
        };
        let (.., renderer) = self.renderer.insert((cells, rule, renderer));
        let drawn = renderer.draw(view, key.size)?;
        // The mesh is that of the image: strips of the limb are magnified, and would get a finer one.
        let mut draw = |view: &EyeView, size: (u32, u32)| renderer.draw(view, size);
        let found = GeometryErrors {
            silhouette: silhouette(view, &figure, key.size, &mut draw)?,
            geolocation: geolocation(&drawn, view, &figure),
        };
        self.found.push((key, found));
        Ok(found)
    }
}
