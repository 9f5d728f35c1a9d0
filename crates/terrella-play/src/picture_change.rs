//! Pictures of other layers or another tone curve, made by a thread of their own: pipelines are compiled, maps read and lines laid out while
//! the window goes on with what it has.

use super::coverage_layer::{CoverageLegend, coverage_legend};
use super::error::PlayError;
use super::flight::{Flight, Moment};
use super::quality_control::scene_quality;
use super::scene_painter::{Patience, PictureTarget, ScenePainter};
use super::switches::{Layer, Switches};
use super::tracks::{ShownTracks, TracksLayer};
use crate::scene::Scene;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread::{Builder, Scope};
use std::time::Duration;
use terrella::internals::gpu::{GpuContext, ScaledTarget, color_texture};
use terrella::tracks::TracksOptions;
use terrella::{EarthError, EarthOptions, Quality};

/// How long a picture waits for tiles of a pack, so that the ground does not become coarse when it is shown.
const TILES_WAIT: Duration = Duration::from_secs(3);

/// What is to be drawn.
pub struct PictureOrder {
    pub switches: Switches,
    /// The scene with all that is switched on.
    pub scene: Scene,
    pub gpu: GpuContext,
    /// Format of what is shown.
    pub format: wgpu::TextureFormat,
    pub what: OrderKind,
}

/// How much of a picture is made anew.
pub enum OrderKind {
    /// Lines, polygons and names, for the pass of these options.
    Tracks(TracksOptions),
    /// All of it.
    Whole(Box<WholePicture>),
}

/// What a whole picture is made for.
pub struct WholePicture {
    /// Those of its Earth, `None` where its maps are to be read first.
    pub options: Option<EarthOptions>,
    /// Samples a pixel, which the adapter does.
    pub samples: u32,
    /// Width and height of the window and of what is drawn for it, pixels.
    pub size: (u32, u32),
    pub drawn_size: (u32, u32),
    /// What is seen now, by which pipelines are chosen.
    pub moment: Option<Moment>,
}

/// What has been made.
pub struct ReadyPicture {
    pub switches: Switches,
    pub scene: Scene,
    pub what: ReadyKind,
}

/// How much of a picture has been made.
pub enum ReadyKind {
    Tracks(Box<Option<TracksLayer>>, Option<CoverageLegend>),
    Whole(Box<ReadyWhole>),
}

/// All of a picture.
pub struct ReadyWhole {
    pub painter: ScenePainter,
    pub target: ScaledTarget,
    pub options: EarthOptions,
    /// The Earth's quality with all layers.
    pub full: Quality,
}

/// What of tracks switches show.
pub fn shown_tracks(switches: &Switches) -> ShownTracks {
    ShownTracks {
        satellites: switches.is_on(Layer::Tracks),
        stations: switches.is_on(Layer::Stations),
    }
}

impl PictureOrder {
    /// Makes it.
    ///
    /// # Errors
    /// What cannot be read, made or drawn.
    pub fn make(self, flight: &Flight) -> Result<ReadyPicture, PlayError> {
        let Self {
            switches,
            scene,
            gpu,
            format,
            what,
        } = self;
        let what = match what {
            OrderKind::Tracks(options) => {
                let tracks = TracksLayer::with_options(&scene, flight, &gpu, &options, format)?;
                let tracks = tracks
                    .map(|mut tracks| tracks.show_parts(shown_tracks(&switches)).map(|()| tracks));
                ReadyKind::Tracks(
                    Box::new(tracks.transpose()?),
                    coverage_legend(&scene, flight)?,
                )
            }
            OrderKind::Whole(whole) => {
                let made = whole.make(flight, &scene, &switches, gpu, format)?;
                ReadyKind::Whole(Box::new(made))
            }
        };
        Ok(ReadyPicture {
            switches,
            scene,
            what,
        })
    }
}

impl WholePicture {
    fn make(
        self,
        flight: &Flight,
        scene: &Scene,
        switches: &Switches,
        gpu: GpuContext,
        format: wgpu::TextureFormat,
    ) -> Result<ReadyWhole, PlayError> {
        let mut options = match self.options {
            Some(options) => options,
            None => {
                let mut options = flight.uploaded_options_of(scene, &gpu)?;
                options.develop_after_pass(format);
                options
            }
        };
        options.samples = self.samples;
        let device = gpu.device.clone();
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let made = (|| {
            let mut painter = ScenePainter::of_scene(scene, flight, gpu, &options, format)?;
            let full = scene_quality(&scene.quality, *painter.earth().quality());
            let sky = switches.is_on(Layer::Sky);
            painter.show_layers(scene, flight, sky, shown_tracks(switches))?;
            painter.choose_exposure(switches.exposure, scene.output.exposure)?;
            painter.set_quality(&Quality {
                samples: self.samples,
                ..switches.quality(full)
            })?;
            if let Some((_, error)) = painter.follow_quality().into_iter().next() {
                return Err(error);
            }
            let (size, drawn_size) = (self.size, self.drawn_size);
            let pass = options.pass_format();
            let target = ScaledTarget::of_pass(&device, &pass, format, size, drawn_size);
            let mut made = ReadyWhole {
                painter,
                target: target.map_err(EarthError::from)?,
                options,
                full,
            };
            if let Some(moment) = &self.moment {
                made.draw_once(moment, format)?;
            }
            Ok(made)
        })();
        let rejected = pollster::block_on(scope.pop());
        let made: ReadyWhole = made?;
        match rejected {
            Some(error) => Err(EarthError::Rejected(error.to_string()).into()),
            None => Ok(made),
        }
    }
}

impl ReadyWhole {
    /// Draws what is seen now into a texture that nobody sees: what drivers compile at the first use they compile here.
    fn draw_once(&mut self, moment: &Moment, format: wgpu::TextureFormat) -> Result<(), PlayError> {
        let gpu = self.painter.gpu().clone();
        let drawn_size = self.target.drawn_size();
        let patience = match self.painter.earth().has_tiles() {
            true => Patience::Complete(TILES_WAIT),
            false => Patience::Live,
        };
        self.painter.prepare(moment, drawn_size, patience);
        self.painter.earth().check_pipelines()?;
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
        let size = self.target.size();
        let label = "terrella next picture";
        let texture = color_texture(&gpu.device, label, size, format, 1, usage);
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some(label),
            ..Default::default()
        });
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some(label) });
        let target = TargetView {
            target: &self.target,
            view: &view,
        };
        self.painter.paint(&mut encoder, &target);
        gpu.queue.submit([encoder.finish()]);
        Ok(())
    }
}

/// A target with the view that it is shown in.
pub struct TargetView<'t> {
    pub target: &'t ScaledTarget,
    pub view: &'t wgpu::TextureView,
}

impl PictureTarget for TargetView<'_> {
    fn size(&self) -> (u32, u32) {
        self.target.size()
    }

    fn drawn_size(&self) -> (u32, u32) {
        self.target.drawn_size()
    }

    fn begin_pass<'e>(&self, encoder: &'e mut wgpu::CommandEncoder) -> wgpu::RenderPass<'e> {
        self.target.begin_pass(encoder, self.view)
    }

    fn set_frame(&self, queue: &wgpu::Queue, frame: u32) {
        self.target.set_frame(queue, frame);
    }

    fn finish(&self, encoder: &mut wgpu::CommandEncoder) {
        self.target.finish(encoder, self.view, None);
    }

    fn view(&self) -> &wgpu::TextureView {
        self.view
    }
}

/// The caller's end of the thread that makes pictures. Dropping it ends the thread after the picture that is in work.
pub struct PictureMaker {
    orders: Sender<(u64, Box<PictureOrder>)>,
    made: Receiver<(u64, Result<ReadyPicture, PlayError>)>,
    newest: Arc<AtomicU64>,
    /// What was ordered last and is not there yet.
    awaited: Option<Switches>,
}

impl PictureMaker {
    /// Starts the thread. `wake` is called on it whenever a picture is ready.
    ///
    /// # Errors
    /// No thread.
    pub fn start<'scope>(
        scope: &'scope Scope<'scope, '_>,
        flight: &'scope Flight,
        wake: impl Fn() + Send + 'scope,
    ) -> std::io::Result<Self> {
        let (orders, to_make) = channel::<(u64, Box<PictureOrder>)>();
        let (ready, made) = channel();
        let newest = Arc::new(AtomicU64::new(0));
        let known = Arc::clone(&newest);
        let work = move || {
            while let Ok((number, order)) = to_make.recv() {
                if known.load(Ordering::Relaxed) != number {
                    continue;
                }
                if ready.send((number, order.make(flight))).is_err() {
                    break;
                }
                wake();
            }
        };
        Builder::new()
            .name("terrella pictures".to_owned())
            .spawn_scoped(scope, work)?;
        Ok(Self {
            orders,
            made,
            newest,
            awaited: None,
        })
    }

    /// Orders a picture in place of one that is not there yet.
    pub fn order(&mut self, order: PictureOrder) {
        let number = self.newest.fetch_add(1, Ordering::Relaxed) + 1;
        self.awaited = Some(order.switches);
        // It fails only if the thread broke down, which has been reported then.
        let _ = self.orders.send((number, Box::new(order)));
    }

    /// Wants what was ordered no more.
    pub fn forget(&mut self) {
        if self.awaited.take().is_some() {
            self.newest.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// What was ordered and is not there yet.
    pub fn awaited(&self) -> Option<&Switches> {
        self.awaited.as_ref()
    }

    /// The picture that was ordered last, once it is there.
    pub fn ready(&mut self) -> Option<Result<ReadyPicture, PlayError>> {
        let newest = self.newest.load(Ordering::Relaxed);
        let mut made = self.made.try_iter();
        let (_, ready) = made.find(|(number, _)| *number == newest)?;
        self.awaited = None;
        Some(ready)
    }
}
