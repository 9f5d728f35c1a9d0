//! An Earth that owns its device and textures and returns images in memory, for programs without wgpu.
//!
//! | file | what |
//! |---|---|
//! | `offscreen.rs` | the Earth: displayed colour, light, and ground truth |
//! | `truth.rs` | ground truth as arrays |
//! | `truth_layers.rs` | the layers of ground truth: names, units, values |
//! | `textures.rs` | render targets |
//! | `limits.rs` | size limits |
//! | `error.rs` | errors |

mod error;
mod limits;
mod shared;
mod textures;
mod truth;
mod truth_layers;

pub use error::OffscreenError;
pub use limits::check_length;
pub use limits::{MAX_PICTURE_MIB, picture_bytes};
pub use limits::{check_memory, check_size, supported_samples};
pub use limits::{check_truth_memory, new_truth_targets};
pub use textures::PictureTextures;
pub use truth::set_truth;
pub use truth::{LayerValues, TruthPicture};
pub use truth_layers::{LayerDtype, TRUTH_LAYERS, TruthLayer, TruthPixel};

use crate::gpu::{Development, FrameTargets, GpuContext, TruthTargets};
use crate::{
    DiagnosticOptions, Earth, EarthError, EarthLayers, EarthOptions, EyeView, FrameRequest,
    FrameStats, LayerSelection, MapError, MapUploader, Pipelines, Sky, TruthView, UploadedMaps,
    load_layers_to,
};
use std::path::{Path, PathBuf};
use std::time::Duration;
use terrella_imagery::tile::TileKey;

/// An Earth that renders into memory. Earths of one program share their device ([`Self::open_gpu`]) and their maps ([`Self::shared_maps`]).
///
/// It renders three kinds of images: colour, light and truth. The first request for a kind creates its [`Earth`] and textures, so a program pays
/// only for the kinds that it uses. All kinds share the maps, which the first image moves from memory to the GPU.
///
/// Each call waits for the device and returns a complete image. It renders one image at a time (`&mut self`) and can be moved to other threads.
pub struct OffscreenEarth {
    gpu: GpuContext,
    options: EarthOptions,
    size: (u32, u32),
    shown: Option<Drawn<PictureTextures>>,
    light: Option<Drawn<PictureTextures>>,
    truth: Option<Drawn<TruthTargets>>,
    /// The last field: it is dropped after what others may share.
    _release: shared::Release,
}

/// An Earth of one kind, and its render targets.
struct Drawn<T> {
    earth: Earth,
    targets: T,
}

/// Statistics of an image, and the tiles missing from it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Drawing {
    /// Statistics of the frame.
    pub stats: FrameStats,
    /// Tiles that did not arrive in time; coarser ones are drawn instead.
    pub missing: Vec<TileKey>,
}

impl OffscreenEarth {
    /// Opens the best adapter, or the best of those whose name contains `adapter`, letter case aside, for images of any kind. It blocks.
    ///
    /// While an Earth of this program uses the device, later calls with the same name return it too.
    ///
    /// # Errors
    /// No adapter, none of that name, or one that provides no device.
    pub fn open_gpu(adapter: Option<&str>) -> Result<GpuContext, OffscreenError> {
        let float = GpuContext::FLOAT_TARGET;
        shared::gpu(adapter, || {
            Ok(pollster::block_on(GpuContext::open_with(adapter, float))?)
        })
    }

    /// Maps for [`EarthOptions::layers`] and [`EarthOptions::uploaded`], which `load` reads from `files`. While an Earth of this program uses them, later
    /// calls return the same maps without reading: if the device, `variant` and the files with their lengths and times of change are the same.
    /// `variant` names all else that the maps depend on.
    ///
    /// # Errors
    /// Those of `load`.
    pub fn shared_maps<E>(
        gpu: &GpuContext,
        files: Vec<PathBuf>,
        variant: String,
        load: impl FnOnce() -> Result<(EarthLayers, UploadedMaps), E>,
    ) -> Result<(EarthLayers, UploadedMaps), E> {
        shared::maps(gpu, files, variant, load)
    }

    /// As [`Self::shared_maps`], the maps of a folder as [`load_layers`](crate::load_layers) reads them, for Earths with the default shading.
    ///
    /// # Errors
    /// Invalid maps, and maps that the device rejects.
    pub fn shared_layers(
        gpu: &GpuContext,
        folder: &Path,
        selection: LayerSelection,
    ) -> Result<(EarthLayers, UploadedMaps), MapError> {
        let files = selection.files_in(folder);
        shared::maps(gpu, files, format!("{selection:?}"), || {
            let uploader = MapUploader::new(&gpu.device, &gpu.queue, Default::default());
            let (layers, damaged) = load_layers_to(folder, selection, &uploader)?;
            match damaged.into_iter().next() {
                Some(damaged) => Err(damaged.error.into()),
                None => Ok((layers, uploader.finish()?)),
            }
        })
    }

    /// An Earth with these options for images of `size`, width and height in pixels. Colour format, depth and diagnostics of the options are
    /// overridden. Nothing is uploaded before the first image.
    ///
    /// # Errors
    /// An image that is empty, larger than the device supports, or takes more than [`MAX_PICTURE_MIB`].
    pub fn new(
        gpu: GpuContext,
        mut options: EarthOptions,
        size: (u32, u32),
    ) -> Result<Self, OffscreenError> {
        options.develop_after_pass(FrameTargets::COLOR);
        options.depth = FrameTargets::REVERSED_DEPTH;
        options.diagnostics = DiagnosticOptions::default();
        options.pipelines = Pipelines::WhenNeeded;
        options.samples =
            limits::supported_samples(&gpu.adapter, options.color_format, options.samples);
        options.check(&gpu.device)?;
        limits::check_size(&gpu, size)?;
        limits::check_memory(size, &options.pass_format())?;
        Ok(Self {
            gpu,
            options,
            size,
            shown: None,
            light: None,
            truth: None,
            _release: shared::Release,
        })
    }

    /// Width and height of the next image, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Changes the size of later images. It recreates textures and keeps maps.
    ///
    /// # Errors
    /// As [`Self::new`]. The size is then unchanged.
    pub fn set_size(&mut self, size: (u32, u32)) -> Result<(), OffscreenError> {
        limits::check_size(&self.gpu, size)?;
        limits::check_memory(size, &self.options.pass_format())?;
        self.size = size;
        Ok(())
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        f64::from(self.size.0) / f64::from(self.size.1)
    }

    /// Adapter, device and queue.
    pub fn gpu(&self) -> &GpuContext {
        &self.gpu
    }

    /// Options of the Earth. Its maps have no texels after the first image.
    pub fn options(&self) -> &EarthOptions {
        &self.options
    }

    /// Draws the Earth as displayed colour into `rgba`: four bytes a pixel (red, green, blue in sRGB, and opacity, which is 255 on the ground),
    /// rows from the top, without padding. Waits for tiles of a pack, at most `wait`.
    ///
    /// # Errors
    /// A view without an image, a buffer whose length is not width × height × 4, a device that is out of memory or lost.
    pub fn draw_color(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        wait: Duration,
        rgba: &mut [u8],
    ) -> Result<Drawing, OffscreenError> {
        check_length(self.size, 4, rgba.len())?;
        self.check_view(view, sky)?;
        self.upload()?;
        let (gpu, options) = (&self.gpu, &self.options);
        let shown = FrameTargets::COLOR;
        let shown = Self::of_kind(&mut self.shown, gpu, options, shown, self.size, |_| ())?;
        let drawing = shown.draw(&self.gpu, view, sky, wait)?;
        let targets = shown.targets.picture();
        let read = targets.read_back_into(&self.gpu.device, &self.gpu.queue, rgba);
        self.gpu.checked(read)?;
        Ok(drawing)
    }

    /// Draws the Earth's light into `light`: four 32-bit floats a pixel, scene-referred and linear, before exposure and tone curve (a white sheet
    /// that faces the Sun in space is 1): red, green, blue, and a value without meaning. Each pixel is the light along the ray through its centre.
    /// If the adapter cannot blend 32-bit floats, the precision is that of 16-bit floats. The ground has no synthetic detail: measurements use data
    /// only.
    ///
    /// # Errors
    /// As [`Self::draw_color`]; the buffer has width × height × 4 numbers.
    pub fn draw_light(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        wait: Duration,
        light: &mut [f32],
    ) -> Result<Drawing, OffscreenError> {
        check_length(self.size, 4, light.len())?;
        self.check_view(view, sky)?;
        self.upload()?;
        let format = self.gpu.float_format();
        let drawn = Self::of_kind(
            &mut self.light,
            &self.gpu,
            &self.options,
            format,
            self.size,
            |options| {
                // 32-bit values, in the precision that the device can blend.
                options.color_format = format;
                options.development = Development::InPass;
                options.samples = 1;
                options.light.detail = false;
            },
        )?;
        let drawing = drawn.draw(&self.gpu, view, sky, wait)?;
        let targets = drawn.targets.picture();
        let read = targets.read_light_into(&self.gpu.device, &self.gpu.queue, light);
        self.gpu.checked(read)?;
        Ok(drawing)
    }

    /// Draws the ground truth of each pixel, which is then read layer by layer.
    ///
    /// # Errors
    /// As [`Self::draw_color`].
    pub fn draw_truth(
        &mut self,
        view: &EyeView,
        sky: &Sky,
        wait: Duration,
    ) -> Result<(TruthPicture, Drawing), OffscreenError> {
        let truth_view = TruthView::new(view, sky, self.options.figure, self.size);
        let truth_view = truth_view.ok_or(OffscreenError::NoPicture)?;
        limits::check_truth_memory(self.size)?;
        self.upload()?;
        let (gpu, size) = (&self.gpu, self.size);
        let targets = match self.truth.take() {
            Some(drawn) if drawn.targets.size() == size => drawn,
            Some(drawn) => Drawn {
                targets: limits::new_truth_targets(gpu, size)?,
                ..drawn
            },
            None => Drawn {
                earth: make_truth_earth(gpu, &self.options)?,
                targets: limits::new_truth_targets(gpu, size)?,
            },
        };
        let drawn = self.truth.insert(targets);
        let drawing = drawn.draw(gpu, view, sky, wait)?;
        let lines = 0..size.1;
        let read = drawn.targets.read(&gpu.device, &gpu.queue, lines);
        let texels = gpu.checked(read)?;
        let has_water = self.options.layers.water.is_some();
        Ok((
            TruthPicture::new(truth_view, size, texels, has_water),
            drawing,
        ))
    }

    /// Uploads the maps unless they are already on the GPU.
    fn upload(&mut self) -> Result<(), OffscreenError> {
        let uploaded = self.options.upload(&self.gpu.device, &self.gpu.queue);
        Ok(uploaded.map_err(EarthError::from)?)
    }

    fn of_kind<'d>(
        kept: &'d mut Option<Drawn<PictureTextures>>,
        gpu: &GpuContext,
        options: &EarthOptions,
        format: wgpu::TextureFormat,
        size: (u32, u32),
        choose: impl FnOnce(&mut EarthOptions),
    ) -> Result<&'d mut Drawn<PictureTextures>, OffscreenError> {
        let textures =
            |earth: &Earth| PictureTextures::new(gpu, &earth.format(), format, size, size);
        let drawn = match kept.take() {
            Some(drawn) if drawn.targets.size() == size => drawn,
            Some(drawn) => Drawn {
                targets: textures(&drawn.earth)?,
                ..drawn
            },
            None => {
                let mut options = options.clone();
                choose(&mut options);
                let earth = Earth::new(&gpu.device, &gpu.queue, &options)?;
                let targets = textures(&earth)?;
                Drawn { earth, targets }
            }
        };
        Ok(kept.insert(drawn))
    }

    fn check_view(&self, view: &EyeView, sky: &Sky) -> Result<(), OffscreenError> {
        let found = TruthView::new(view, sky, self.options.figure, self.size);
        found.map(|_| ()).ok_or(OffscreenError::NoPicture)
    }
}

/// Begins a pass, and adds the passes after it.
trait Targets {
    fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e>;
    fn end(&self, _: &mut wgpu::CommandEncoder) {}
    fn pixels(&self) -> (u32, u32);
}

impl Targets for PictureTextures {
    fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.begin_pass(encoder)
    }

    fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        self.finish(encoder, None);
    }

    fn pixels(&self) -> (u32, u32) {
        self.size()
    }
}

impl Targets for TruthTargets {
    fn begin<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.begin_pass(encoder)
    }

    fn pixels(&self) -> (u32, u32) {
        self.size()
    }
}

impl<T: Targets> Drawn<T> {
    fn draw(
        &mut self,
        gpu: &GpuContext,
        view: &EyeView,
        sky: &Sky,
        wait: Duration,
    ) -> Result<Drawing, EarthError> {
        let size = self.targets.pixels();
        let (stats, missing) =
            self.earth
                .prepare_complete(&gpu.queue, FrameRequest::new(view, sky, size), wait);
        let label = Some("terrella offscreen");
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label });
        self.earth.render(&mut self.targets.begin(&mut encoder));
        self.targets.end(&mut encoder);
        gpu.queue.submit([encoder.finish()]);
        self.earth.check_pipelines()?;
        Ok(Drawing { stats, missing })
    }
}

/// The same Earth with ground truth as output.
fn make_truth_earth(gpu: &GpuContext, options: &EarthOptions) -> Result<Earth, OffscreenError> {
    let mut options = options.clone();
    truth::set_truth(&mut options)?;
    Ok(Earth::new(&gpu.device, &gpu.queue, &options)?)
}
