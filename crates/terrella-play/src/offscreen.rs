//! The offscreen renderer for stills, frames and video: an adapter, an Earth, and render targets.

use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::scene_painter::{Patience, PictureTarget, ScenePainter};
use image::RgbaImage;
use std::time::{Duration, Instant};
use terrella::internals::gpu::{FrameTargets, GpuContext, GpuTimer, PassPart, PictureError};
use terrella::internals::offscreen::{PictureTextures, supported_samples};
use terrella::{
    Development, Earth, EarthOptions, Exposure, EyeView, FrameStats, Grade, Pipelines, Quality,
};
use terrella_imagery::tile::TileKey;

/// An Earth with textures to draw it into.
pub struct OffscreenRenderer {
    painter: ScenePainter,
    textures: PictureTextures,
    samples: u32,
    /// Whether space is transparent.
    is_space_transparent: bool,
    /// Number of images drawn before all elevation data was loaded.
    pictures_without_heights: u64,
}

impl PictureTarget for PictureTextures {
    fn size(&self) -> (u32, u32) {
        self.size()
    }

    fn drawn_size(&self) -> (u32, u32) {
        self.drawn_size()
    }

    fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.begin_pass(encoder)
    }

    fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        self.set_frame(queue, frame);
    }

    fn finish(&self, encoder: &mut wgpu::CommandEncoder) {
        self.finish(encoder, None);
    }

    fn view(&self) -> &wgpu::TextureView {
        self.picture().picture_view()
    }
}

/// A frame and how long it took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimedFrame {
    /// Statistics of the frame.
    pub stats: FrameStats,
    /// Time of [`Earth::prepare`], and of the craft's where there is one.
    pub prepare: Duration,
    /// Time of the whole frame, the device waited for.
    pub frame: Duration,
}

impl OffscreenRenderer {
    /// Uploads the maps to an adapter.
    ///
    /// If the adapter does not support the requested samples, one sample a pixel is drawn, with a warning.
    pub fn open(
        gpu: GpuContext,
        mut options: EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        options.develop_after_pass(FrameTargets::COLOR);
        options.samples = supported_samples(&gpu.adapter, options.color_format, options.samples);
        Self::open_as(gpu, &options, FrameTargets::COLOR, size)
    }

    /// The same with layers that are shown one by one in one pass, in place of light that they add up and that is developed once: without bloom,
    /// white balance and grain. To compare with.
    ///
    /// # Errors
    /// A tone curve that is a measured response, which only that development has.
    pub fn open_in_pass(
        gpu: GpuContext,
        mut options: EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        options.development = Development::InPass;
        options.color_format = FrameTargets::COLOR;
        options.bloom.strength = 0.0;
        options.grade = Grade::NONE;
        options.samples = supported_samples(&gpu.adapter, options.color_format, options.samples);
        Self::open_as(gpu, &options, FrameTargets::COLOR, size)
    }

    /// The same for light itself ([`Self::read_light`]), with one sample a pixel: the light along the ray through its middle.
    pub fn open_for_light(
        gpu: GpuContext,
        mut options: EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        let format = gpu.float_format();
        options.color_format = format;
        options.samples = 1;
        Self::open_as(gpu, &options, format, size)
    }

    /// The same for files of light, which have no exposure: the gains of stars and of the lights of the night do not fall beside daylight, so
    /// that light is the truth times one number in all of them.
    ///
    /// # Errors
    /// As [`Self::open_for_light`].
    pub fn open_for_radiance(
        gpu: GpuContext,
        mut options: EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        options.light.night_fades_by_day = false;
        let mut renderer = Self::open_for_light(gpu, options, size)?;
        renderer.painter.keep_star_gain();
        Ok(renderer)
    }

    fn open_as(
        gpu: GpuContext,
        options: &EarthOptions,
        format: wgpu::TextureFormat,
        size: (u32, u32),
    ) -> Result<Self, PlayError> {
        let options = &EarthOptions {
            pipelines: Pipelines::WhenNeeded,
            ..options.clone()
        };
        let textures = PictureTextures::new(&gpu, &options.pass_format(), format, size, size)?;
        Ok(Self {
            painter: ScenePainter::new(gpu, options, format)?,
            textures,
            samples: options.samples,
            is_space_transparent: false,
            pictures_without_heights: 0,
        })
    }

    /// Uses another quality from now on, at its scale of the image size. If the adapter does not support the requested samples, one sample a pixel
    /// is drawn, with a warning.
    ///
    /// # Errors
    /// A quality that the Earth rejects, or textures that do not fit into the device's memory.
    pub fn set_quality(&mut self, quality: &Quality) -> Result<(), PlayError> {
        let format = self.earth().format().color;
        let samples = match quality.samples == self.samples {
            true => self.samples,
            false => supported_samples(&self.gpu().adapter, format, quality.samples),
        };
        let quality = Quality {
            samples,
            ..*quality
        };
        if quality == *self.earth().quality() {
            return Ok(());
        }
        self.painter.set_quality(&quality)?;
        self.make_textures(self.size())?;
        self.samples = samples;
        match self.painter.follow_quality().into_iter().next() {
            Some((_, error)) => Err(error),
            None => Ok(()),
        }
    }

    /// Draws images of another size from now on.
    ///
    /// # Errors
    /// A size that exceeds this program's memory limit or the device's memory.
    pub fn resize(&mut self, size: (u32, u32)) -> Result<(), PlayError> {
        if size == self.size() {
            return Ok(());
        }
        self.make_textures(size)
    }

    /// Makes the textures for pictures of a size, at the quality's scale.
    fn make_textures(&mut self, size: (u32, u32)) -> Result<(), PlayError> {
        let drawn_size = self.earth().quality().drawn_size(size);
        let format = self.textures.picture().format();
        let pass = self.earth().format();
        let mut textures = PictureTextures::new(self.gpu(), &pass, format, size, drawn_size)?;
        if self.is_space_transparent {
            textures.make_space_transparent();
        }
        self.textures = textures;
        Ok(())
    }

    /// Makes space transparent from now on: alpha of light is the opacity over the background. Only at full resolution.
    pub fn make_space_transparent(&mut self) {
        self.is_space_transparent = true;
        self.textures.make_space_transparent();
    }

    /// Width and height that are drawn, pixels; [`Self::size`] where the quality's scale is 1.
    pub fn drawn_size(&self) -> (u32, u32) {
        self.textures.drawn_size()
    }

    /// Draws the maps of each picture's date from now on, where they change with it; without, those that it was opened with.
    pub fn show_dated_maps(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.painter.show_dated_maps(flight)
    }

    /// Draws the models of a flight's satellites from now on, where its scene names any.
    pub fn show_models(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.painter.show_models(flight)
    }

    /// Draws the sky from now on, if a flight's scene requests any of it.
    pub fn show_sky(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.painter.show_sky(flight)
    }

    /// The same without one part of it, by its key.
    pub fn show_sky_without(&mut self, flight: &Flight, part: &str) -> Result<(), PlayError> {
        self.painter.show_sky_without(flight, part)
    }

    /// Bytes of the WGSL that the driver got, for the Earth and all other layers.
    pub fn shader_bytes(&self) -> u64 {
        self.painter.shader_bytes()
    }

    /// Draws the tracks of a flight's satellites from now on, if its scene requests any.
    pub fn show_tracks(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.painter.show_tracks(flight)
    }

    /// Writes the captions of a flight's scene over pictures from now on, where it has any. Not for renderers of light.
    pub fn show_captions(&mut self, flight: &Flight) -> Result<(), PlayError> {
        self.painter.show_captions(flight)
    }

    /// Width and height, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.textures.size()
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        let (width, height) = self.size();
        f64::from(width) / f64::from(height)
    }

    /// The adapter that draws.
    pub fn adapter_info(&self) -> wgpu::AdapterInfo {
        self.gpu().adapter.get_info()
    }

    /// The Earth.
    pub fn earth(&self) -> &Earth {
        self.painter.earth()
    }

    /// Names of the parts of the sky that are drawn, and of those that are not.
    pub fn sky_features(&self) -> [Vec<&'static str>; 2] {
        self.painter.sky_features()
    }

    /// Adapter, device and queue.
    pub fn gpu(&self) -> &GpuContext {
        self.painter.gpu()
    }

    /// Whether the exposure of images is metered.
    pub fn meters_exposure(&self) -> bool {
        self.painter.meters_exposure()
    }

    /// Samples a pixel that are really drawn.
    pub fn samples(&self) -> u32 {
        self.samples
    }

    /// Draws an instant. Does not wait for the device.
    pub fn draw(&mut self, moment: &Moment) -> FrameStats {
        let stats = self.prepare(moment);
        self.submit();
        stats
    }

    /// Draws a moment when all requested tiles have arrived, or `wait` is over. Returns the missing tiles.
    pub fn draw_complete(&mut self, moment: &Moment, wait: Duration) -> (FrameStats, Vec<TileKey>) {
        let patience = Patience::Complete(wait);
        let drawn = self.painter.prepare(moment, self.drawn_size(), patience);
        self.warn_of_missing_heights();
        self.submit();
        drawn
    }

    /// Warns that an image's terrain is coarser than its data: for the first image of a film, and increasingly seldom for later ones.
    fn warn_of_missing_heights(&mut self) {
        let missing = self.earth().missing_heights();
        let Some(first) = missing.first() else {
            return;
        };
        self.pictures_without_heights += 1;
        if self.pictures_without_heights.is_power_of_two() {
            tracing::warn!(
                "{} elevation tiles are missing, and the terrain is coarser there ({first} among them; {} images so far); give it more time \
                 (wait_s under [output]) or memory (ground_mb under [earth]), or run `terrella pack verify`",
                missing.len(),
                self.pictures_without_heights
            );
        }
    }

    /// If exposure is metered, adapts the next image's exposure over the time since the last, seconds, instead of instantly: for images of a film.
    /// Returns the exposure value, if metered.
    pub fn follow_light(
        &mut self,
        moment: &Moment,
        elapsed_s: f64,
    ) -> Result<Option<f64>, PlayError> {
        Ok(self.painter.follow_light(moment, elapsed_s)?)
    }

    /// Sets the exposure of the next images, except those with their own exposure ([`Moment::exposure_ev`]).
    ///
    /// # Errors
    /// An exposure value outside [`Exposure::RANGE_EV`].
    pub fn set_exposure(&mut self, exposure: Exposure) -> Result<(), PlayError> {
        Ok(self.painter.set_exposure(exposure)?)
    }

    /// Says where the eye will be soon, so that tiles are there when it comes.
    pub fn prefetch(&mut self, views: &[EyeView]) {
        self.painter.prefetch(views);
    }

    /// Draws the craft and the ground that were prepared last once more, into a pass of the Earth's format: for their depth.
    pub fn render_surface(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.painter.render_surface(pass);
    }

    /// Reads back what was drawn last. Waits for the device.
    pub fn read(&self) -> Result<RgbaImage, PlayError> {
        self.earth().check_pipelines()?;
        let read = self
            .textures
            .picture()
            .read_back(&self.gpu().device, &self.gpu().queue);
        let texels = self.gpu().checked(read)?;
        let (width, height) = self.textures.size();
        Ok(rgba_image(width, height, texels)?)
    }

    /// Reads the light of a renderer that was opened for it: red, green, blue and an unused value, rows from the top.
    pub fn read_light(&self) -> Result<Vec<[f32; 4]>, PlayError> {
        self.earth().check_pipelines()?;
        let read = self
            .textures
            .picture()
            .read_light(&self.gpu().device, &self.gpu().queue);
        Ok(self.gpu().checked(read)?)
    }

    /// Reads back what was drawn last to where it is wanted: four bytes a pixel. Waits for the device.
    pub fn read_into(&self, rgba: &mut [u8]) -> Result<(), PlayError> {
        self.earth().check_pipelines()?;
        let (device, queue) = (&self.gpu().device, &self.gpu().queue);
        let read = self.textures.picture().read_back_into(device, queue, rgba);
        Ok(self.gpu().checked(read)?)
    }

    /// The same as light, of a renderer that is open for it: four numbers a pixel.
    pub fn read_light_into(&self, light: &mut [f32]) -> Result<(), PlayError> {
        let (device, queue) = (&self.gpu().device, &self.gpu().queue);
        let read = self
            .textures
            .picture()
            .read_light_into(device, queue, light);
        Ok(self.gpu().checked(read)?)
    }

    /// Draws an instant twice and times the second time: the first fills caches and compiles what drivers compile late.
    pub fn measure(&mut self, moment: &Moment) -> Result<TimedFrame, PlayError> {
        self.time(moment)?;
        self.time(moment)
    }

    /// Draws an instant and times it, the device waited for.
    pub fn time(&mut self, moment: &Moment) -> Result<TimedFrame, PlayError> {
        let begin = Instant::now();
        let stats = self.prepare(moment);
        let prepare = begin.elapsed();
        self.submit();
        self.wait()?;
        Ok(TimedFrame {
            stats,
            prepare,
            frame: begin.elapsed(),
        })
    }

    /// Draws an instant in passes, "surface" (with the craft, where there is one), "air" (with tracks) and "development" (where light is
    /// developed or enlarged after them), and reads how long each took on the device, milliseconds. Clearing counts to the first, resolving
    /// samples to the air.
    ///
    /// Several passes and the writing of times cost time themselves: not for frames whose whole time is wanted.
    pub fn time_passes(
        &mut self,
        moment: &Moment,
        timer: &GpuTimer,
    ) -> Result<Vec<(&'static str, f64)>, PlayError> {
        self.prepare(moment);
        let names = match self.earth().has_air() {
            true => &["surface", "air"][..],
            false => &["surface"],
        };
        let count = names.len() as u32;
        let mut encoder = self.encoder();
        for (n, name) in (0..).zip(names) {
            let part = PassPart {
                is_first: n == 0,
                is_last: n + 1 == count,
            };
            let times = Some(timer.writes(n));
            let mut pass = self.textures.begin_part(&mut encoder, part, times);
            match *name {
                "air" => self.painter.render_air(&mut pass),
                _ => self.painter.render_surface(&mut pass),
            }
            if part.is_last {
                self.painter.render_beyond(&mut pass);
            }
        }
        let mut names = names.to_vec();
        if self.textures.has_last_pass() {
            self.textures
                .finish(&mut encoder, Some(timer.writes(count)));
            names.push("development");
        }
        let count = names.len() as u32;
        timer.resolve(&mut encoder, count);
        self.gpu().queue.submit([encoder.finish()]);
        let times = timer.read(&self.gpu().device, count)?;
        Ok(names.into_iter().zip(times).collect())
    }

    /// Prepares an instant that is not drawn, and waits until the device has what was written.
    pub fn prepare_alone(&mut self, moment: &Moment) -> Result<(), PlayError> {
        self.prepare(moment);
        self.gpu().queue.submit([]);
        self.wait()
    }

    fn prepare(&mut self, moment: &Moment) -> FrameStats {
        let size = self.drawn_size();
        self.painter.prepare(moment, size, Patience::WholeTracks).0
    }

    /// Times a pass into the same textures that draws something else in place of the Earth, the device waited for.
    pub fn time_other(
        &self,
        draw: impl FnOnce(&mut wgpu::RenderPass<'_>),
    ) -> Result<Duration, PlayError> {
        let begin = Instant::now();
        self.submit_pass(draw);
        self.wait()?;
        Ok(begin.elapsed())
    }

    fn submit(&mut self) {
        let mut encoder = self.encoder();
        self.painter.paint(&mut encoder, &self.textures);
        self.gpu().queue.submit([encoder.finish()]);
    }

    fn submit_pass(&self, draw: impl FnOnce(&mut wgpu::RenderPass<'_>)) {
        let mut encoder = self.encoder();
        let mut pass = self.textures.begin_pass(&mut encoder);
        draw(&mut pass);
        drop(pass);
        self.gpu().queue.submit([encoder.finish()]);
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        let device = &self.gpu().device;
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella picture"),
        })
    }

    fn wait(&self) -> Result<(), PlayError> {
        match self.gpu().device.poll(wgpu::PollType::wait_indefinitely()) {
            Ok(_) => Ok(()),
            Err(error) => Err(PlayError::DeviceLost(error.to_string())),
        }
    }
}

/// Texels that were read back, as encoders and comparisons take them.
pub fn rgba_image(width: u32, height: u32, texels: Vec<u8>) -> Result<RgbaImage, PictureError> {
    RgbaImage::from_raw(width, height, texels)
        .ok_or_else(|| PictureError::ReadBack("short read".into()))
}
