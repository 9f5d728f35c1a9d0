//! Draws the pictures of a film.

use super::develop::{GatheredLight, LightPicture, PictureLook};
use super::error::FilmError;
use super::over_light::OverLight;
use super::picture::FilmPicture;
use super::settings::{PictureFormat, PictureSettings};
use crate::error::PlayError;
use crate::flight::{Flight, Moment};
use crate::offscreen::OffscreenRenderer;
use crate::quality_control::scene_quality;
use crate::tracks::TracksLayer;
use std::time::Duration;
use terrella::{EarthOptions, GpuContext, Hdr, exposure_factor};
use terrella_imagery::tile::TileKey;

/// Draws the pictures of a film, as its settings ask for.
pub struct FilmPainter {
    renderer: OffscreenRenderer,
    settings: PictureSettings,
    size: (u32, u32),
    pixels_a_side: u32,
    /// How light is shown, but for factor and frame.
    look: PictureLook,
    over: Option<OverLight>,
    wait: Duration,
}

/// A picture, and what is to be said of it.
pub struct Painted {
    /// The picture.
    pub picture: FilmPicture,
    /// Its exposure value.
    pub exposure_ev: f64,
    /// Tiles that it lacks.
    pub missing: Vec<TileKey>,
}

impl FilmPainter {
    /// What a device must be able to do for these settings.
    pub fn features(settings: &PictureSettings) -> wgpu::Features {
        match settings.need_light() {
            true => GpuContext::FLOAT_TARGET,
            false => wgpu::Features::empty(),
        }
    }

    /// Rejects settings that a scene cannot be drawn with.
    ///
    /// # Errors
    /// The paper's shading where pictures are made of light, and tracks, names and lines where they are light itself (captions are left out of these); a peak luminance without PQ or out of range.
    pub fn check(flight: &Flight, settings: &PictureSettings) -> Result<(), FilmError> {
        if let Some(peak_cd_m2) = settings.peak_cd_m2 {
            if settings.format != PictureFormat::Pq {
                return Err(FilmError::PeakWithoutPq);
            }
            if !Hdr::PEAKS_CD_M2.contains(&peak_cd_m2) {
                return Err(FilmError::Peak { peak_cd_m2 });
            }
        }
        if settings.alpha && settings.hdr().is_some() {
            return Err(FilmError::HdrAlpha);
        }
        if !settings.need_light() {
            return Ok(());
        }
        let scene = flight.scene();
        let rejected = |what, remedy| FilmError::NoLight {
            scene: scene.path.clone(),
            what,
            remedy,
        };
        let no_room = |what, remedy| FilmError::NoOverlay {
            scene: scene.path.clone(),
            what,
            remedy,
        };
        let overlay = settings.take_overlay();
        if !overlay
            && (scene.layers.is_on() || !scene.stations.is_empty() || !scene.geojson.is_empty())
        {
            return Err(no_room(
                "lines and names on the globe and ground stations",
                "switch graticule, coast_lines, borders, terminator, moon_shadow and place_names off, and leave [[station]] and [[geojson]] out",
            ));
        }
        if !overlay && TracksLayer::is_wanted(flight) {
            return Err(no_room(
                "tracks and names",
                "switch trail, ground_track, subpoint, marker and footprint off",
            ));
        }
        if scene.earth.light.is_none() {
            return Err(rejected(
                "the paper's shading",
                "write look = \"standard\" in [earth]",
            ));
        }
        if settings.alpha && scene.quality.scale < 1.0 {
            return Err(rejected(
                "space between enlarged pixels",
                "leave scale out of [quality]",
            ));
        }
        Ok(())
    }

    /// Uploads the maps to an adapter.
    ///
    /// # Errors
    /// What the settings do not allow; maps and textures that the device has no room for.
    pub fn open(
        flight: &Flight,
        gpu: GpuContext,
        options: EarthOptions,
        size: (u32, u32),
        settings: PictureSettings,
    ) -> Result<Self, PlayError> {
        Self::check(flight, &settings)?;
        let scene = flight.scene();
        if !settings.take_overlay() && !scene.captions.is_empty() {
            tracing::warn!(
                "{}: captions are left out: they have display colours, and images of --format exr and --alpha have none",
                scene.path.display()
            );
        }
        let (mut renderer, pixels_a_side) = match settings.need_light() {
            false => (OffscreenRenderer::open(gpu, options, size)?, 1),
            true => {
                let side = settings.pixels_a_side(scene.output.samples);
                let drawn = (size.0.saturating_mul(side), size.1.saturating_mul(side));
                let mut renderer = OffscreenRenderer::open_for_light(gpu, options, drawn)?;
                if settings.alpha {
                    renderer.make_space_transparent();
                }
                (renderer, side)
            }
        };
        renderer.show_dated_maps(flight)?;
        renderer.show_models(flight)?;
        // What is beyond the Earth is space.
        if !settings.alpha {
            renderer.show_sky(flight)?;
        }
        if !settings.need_light() {
            renderer.show_tracks(flight)?;
            renderer.show_captions(flight)?;
        }
        let quality = scene_quality(&scene.quality, *renderer.earth().quality());
        renderer.set_quality(&quality)?;
        let tone = scene.output.tone.open()?;
        let over = match settings.need_light() && settings.take_overlay() {
            true => OverLight::of(flight, &renderer, size, tone)?,
            false => None,
        };
        Ok(Self {
            renderer,
            settings,
            size,
            pixels_a_side,
            look: PictureLook {
                factor: 1.0,
                tone,
                bloom: scene.output.bloom,
                grade: scene.output.grade,
                frame: 0,
            },
            over,
            wait: scene.output.wait(),
        })
    }

    /// The renderer.
    pub fn renderer(&mut self) -> &mut OffscreenRenderer {
        &mut self.renderer
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size.0) / f64::from(self.size.1)
    }

    /// Draws a picture of `moment`. Where a shutter is open, `at` gives the moments of parts of the time to the next frame.
    ///
    /// # Errors
    /// Moments that are not known, a lost device.
    pub fn paint(
        &mut self,
        moment: &Moment,
        at: impl Fn(f64) -> Result<Moment, PlayError>,
    ) -> Result<Painted, PlayError> {
        if !self.settings.need_light() {
            let (stats, missing) = self.renderer.draw_complete(moment, self.wait);
            return Ok(Painted {
                picture: FilmPicture::Shown(self.renderer.read()?),
                exposure_ev: stats.exposure_ev,
                missing,
            });
        }
        let mut gathered = GatheredLight::new(self.size, self.pixels_a_side);
        let mut all_missing: Vec<TileKey> = Vec::new();
        let mut exposure_ev = moment.exposure_ev;
        let mut over = None;
        for part in self.settings.instants() {
            let moment = match self.settings.shutter {
                None => *moment,
                Some(_) => at(part)?,
            };
            let (stats, missing) = self.renderer.draw_complete(&moment, self.wait);
            gathered.add(&self.renderer.read_light()?);
            all_missing.extend(missing);
            // That of the first, which a metered one has for all.
            exposure_ev = exposure_ev.or(Some(stats.exposure_ev));
            if let Some(layer) = self.over.as_mut().filter(|_| over.is_none()) {
                over = Some(layer.draw(&moment, &stats, &self.renderer)?);
            }
        }
        let exposure_ev = exposure_ev.unwrap_or_default();
        let look = PictureLook {
            factor: exposure_factor(exposure_ev),
            frame: moment.frame,
            ..self.look
        };
        Ok(Painted {
            picture: FilmPicture::Light(LightPicture {
                over,
                ..gathered.picture(look)
            }),
            exposure_ev,
            missing: all_missing,
        })
    }
}
