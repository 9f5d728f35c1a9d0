//! The renderer of the window: surface, scene and panel.

mod switching;

use super::controls::Controls;
use super::egui_pass::EguiTarget;
use super::error::{PlayError, WindowError};
use super::flight::{Flight, Moment};
use super::frame_cost::FrameCosts;
use super::keys::Action;
use super::offscreen::rgba_image;
use super::output::{self, PendingFile};
use super::overlay::{EventResponse, Overlay};
use super::panel::{self, PanelData};
use super::picking::MARKER_PX;
use super::picture_change::{TargetView, shown_tracks};
use super::progress::Progress;
use super::quality_control::{QualityControl, scene_quality};
use super::scene_painter::{Patience, ScenePainter};
use super::surface::WindowSurface;
use super::switches::{Layer, Switches};
use crate::scene::{EDGE_SAMPLES, Scene};
use glam::DVec2;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};
use terrella::frames::{Ellipsoid, rfc3339};
use terrella::internals::gpu::{GpuContext, GpuFault, read_texture};
use terrella::{EarthError, EarthOptions, EyeView, FrameStats, Quality};
use terrella_ground::elevation::Elevation;
use wgpu::CurrentSurfaceTexture;
use winit::dpi::PhysicalSize;
use winit::event::WindowEvent;
use winit::event_loop::ActiveEventLoop;
use winit::window::Window;

pub use switching::Switching;

/// Weight of the newest frame in the times that the panel shows.
const SMOOTHING: f64 = 0.1;

/// A window and everything that draws in it.
pub struct WindowRenderer {
    overlay: Overlay,
    surface: WindowSurface,
    painter: ScenePainter,
    window: Arc<Window>,
    adapter: String,
    satellite: Option<String>,
    ellipsoid: Ellipsoid,
    has_tiles: bool,
    /// Elevation data of the drawn terrain.
    relief: Option<Arc<dyn Elevation>>,
    quality_control: Option<TimedQuality>,
    samples: SamplesByView,
    /// Options of the Earth; its maps are only on the GPU.
    options: EarthOptions,
    /// The Earth's quality with all layers.
    full: Quality,
    switches: Switches,
    last: Option<(Moment, FrameStats)>,
    interval_ms: Option<f64>,
    work_ms: f64,
}

/// Samples a pixel, with and without a craft in the picture.
#[derive(Clone, Copy)]
struct SamplesByView {
    with_craft: u32,
    without: u32,
}

/// Adaptive quality that holds a frame time, and the cost of frames.
struct TimedQuality {
    control: QualityControl,
    costs: FrameCosts,
}

/// Whether a frame reached the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Presented {
    /// It is on screen and may stay for this time.
    Until(Duration),
    /// The surface had no texture for it; draw again later.
    Skipped,
}

impl WindowRenderer {
    /// Opens the window, the adapter that presents to it, and the Earth.
    pub fn open(
        event_loop: &ActiveEventLoop,
        size: PhysicalSize<u32>,
        flight: &Flight,
        adapter: Option<&str>,
        progress: &dyn Progress,
    ) -> Result<Self, PlayError> {
        let scene = flight.scene().path.file_stem();
        let name = scene.unwrap_or_default().to_string_lossy();
        let attributes = Window::default_attributes()
            .with_title(format!("{name} · Terrella"))
            .with_inner_size(size)
            // Shown when there is something to see.
            .with_visible(false);
        let window = event_loop
            .create_window(attributes)
            .map_err(|error| WindowError::NoDisplay(error.to_string()))?;
        let window = Arc::new(window);
        let display = Box::new(event_loop.owned_display_handle());
        let (gpu, surface) = pollster::block_on(GpuContext::open_for_window(
            adapter,
            display,
            window.clone(),
        ))?;
        progress.begin("loading maps", None);
        let mut options = flight.uploaded_options(&gpu)?;
        progress.end();
        let inner = window.inner_size();
        let inner = (inner.width, inner.height);
        let surface = WindowSurface::new(&gpu, surface, inner, &mut options)?;
        let painter = ScenePainter::of(flight, gpu, &options, surface.format())?;
        let (gpu, earth) = (painter.gpu(), painter.earth());
        let full = scene_quality(&flight.scene().quality, *earth.quality());
        let control = QualityControl::of(flight.scene(), full, earth.has_tiles())?;
        let quality_control = match control {
            Some(control) => Some(TimedQuality {
                control,
                costs: FrameCosts::new(&gpu.device).map_err(WindowError::NoThread)?,
            }),
            None => None,
        };
        let samples = SamplesByView {
            with_craft: match flight.scene().line("output", "samples") {
                Some(_) => surface.samples(),
                None => surface.supported_samples(gpu, EDGE_SAMPLES),
            },
            without: surface.samples(),
        };
        window.set_visible(true);
        let info = gpu.adapter.get_info();
        tracing::info!("window on {} ({})", info.name, info.backend);
        let mut renderer = Self {
            overlay: Overlay::new(&window, &gpu.device, surface.format()),
            surface,
            painter,
            window,
            adapter: format!("{} ({})", info.name, info.backend),
            ellipsoid: *flight.ellipsoid(),
            satellite: flight.feed().map(|feed| feed.name().to_owned()),
            has_tiles: options.tiles.is_some(),
            relief: (options.ground.as_ref()).map(|ground| Arc::clone(&ground.elevation)),
            quality_control,
            samples,
            options,
            full,
            switches: Switches::of(flight.scene()),
            last: None,
            interval_ms: None,
            work_ms: 0.0,
        };
        renderer.set_quality(&full);
        Ok(renderer)
    }

    /// Draws with the current shader files: all drawables are created again.
    ///
    /// # Errors
    /// A file that cannot be read, compiled or drawn with. Everything is then unchanged.
    pub fn reload_shaders(&mut self, flight: &Flight) -> Result<(), PlayError> {
        let scene = self.switches.scene(flight.scene())?;
        self.make_again(flight, &scene, self.options.clone())?;
        self.show(flight, &scene, self.switches)
    }

    /// Makes all that is drawn again with these options.
    fn make_again(
        &mut self,
        flight: &Flight,
        scene: &Scene,
        mut options: EarthOptions,
    ) -> Result<(), PlayError> {
        let gpu = self.painter.gpu().clone();
        options.samples = self.samples.without;
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let painter = ScenePainter::of_scene(scene, flight, gpu, &options, self.surface.format());
        let rejected = pollster::block_on(scope.pop());
        let painter = painter?;
        if let Some(error) = rejected {
            return Err(EarthError::Rejected(error.to_string()).into());
        }
        self.surface.set_pass(&painter.gpu().device, &options)?;
        self.painter = painter;
        self.full = scene_quality(&scene.quality, *self.painter.earth().quality());
        self.options = options;
        // The surface has the samples of the options; layers follow by this.
        self.set_quality(&self.full.clone());
        Ok(())
    }

    fn show(
        &mut self,
        flight: &Flight,
        scene: &Scene,
        switches: Switches,
    ) -> Result<(), PlayError> {
        let tracks = shown_tracks(&switches);
        let sky = switches.is_on(Layer::Sky);
        self.painter.show_layers(scene, flight, sky, tracks)?;
        self.painter
            .choose_exposure(switches.exposure, scene.output.exposure)?;
        let full = switches.quality(self.full);
        let samples = self.painter.earth().quality().samples;
        if let Some(timed) = &mut self.quality_control {
            let has_tiles = self.painter.earth().has_tiles();
            if let Some(control) = QualityControl::of(scene, full, has_tiles)? {
                timed.control = control;
            }
        }
        if !self.set_quality(&Quality { samples, ..full }) {
            return Err(EarthError::Rejected("the layers cannot be drawn".into()).into());
        }
        self.switches = switches;
        Ok(())
    }

    pub fn window(&self) -> &Window {
        &self.window
    }

    /// The device error, if the device has stopped permanently.
    pub fn fault(&self) -> Option<GpuFault> {
        self.painter.gpu().check().err()
    }

    /// Width and height of the picture, pixels.
    pub fn size(&self) -> (u32, u32) {
        self.surface.size()
    }

    /// Width over height.
    pub fn aspect(&self) -> f64 {
        let (width, height) = self.size();
        f64::from(width) / f64::from(height)
    }

    /// Whether the Earth is drawn with the tiles of a pack.
    pub fn has_tiles(&self) -> bool {
        self.has_tiles
    }

    /// Elevation data of the drawn terrain; `None` is the smooth ellipsoid.
    pub fn relief(&self) -> Option<&Arc<dyn Elevation>> {
        self.relief.as_ref()
    }

    /// Whether the last picture still waits for tiles, or for tracks to be whole.
    pub fn is_loading(&self) -> bool {
        self.painter.is_loading()
            || self.last.is_some_and(|(_, stats)| {
                let tiles = stats.tiles;
                tiles.queued + tiles.loading + tiles.waiting_upload > 0
            })
    }

    /// Says where the eye will be soon.
    pub fn prefetch(&mut self, views: &[EyeView]) {
        self.painter.prefetch(views);
    }

    /// The places in the scene of the satellites whose dots a click on a pixel of the window can mean.
    pub fn markers_near(&self, at_px: DVec2) -> Vec<usize> {
        let (shown, drawn) = (self.surface.size(), self.surface.drawn_size());
        let smaller = |drawn: u32, shown: u32| f64::from(drawn) / f64::from(shown.max(1));
        let scale = DVec2::new(smaller(drawn.0, shown.0), smaller(drawn.1, shown.1));
        let at_px = (at_px * scale).as_vec2().to_array();
        // A pixel more for rounding; the click is compared with exact places then.
        let within_px = (MARKER_PX + 1.0) * scale.max_element();
        self.painter.markers_near(at_px, within_px as f32).collect()
    }

    /// The moment that was drawn last.
    pub fn last_moment(&self) -> Option<Moment> {
        self.last.map(|(moment, _)| moment)
    }

    /// Follows the window to another size.
    pub fn resize(&mut self, size: (u32, u32)) {
        self.surface.resize(&self.painter.gpu().device, size);
    }

    /// Offers an event to the panel.
    pub fn offer(&mut self, event: &WindowEvent) -> EventResponse {
        // Before egui sees the key that ends it.
        let is_typing = self.overlay.is_typing();
        let response = self.overlay.on_event(&self.window, event);
        if matches!(event, WindowEvent::KeyboardInput { .. }) {
            return EventResponse {
                consumed: is_typing,
                ..response
            };
        }
        let is_pointer = matches!(
            event,
            WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. }
        );
        EventResponse {
            consumed: response.consumed || (is_pointer && self.overlay.takes_press()),
            ..response
        }
    }

    /// Lays out the panel if events that it has not had yet can move the focus. Answers what the user did.
    pub fn settle_focus(&mut self, controls: &Controls) -> Option<Vec<Action>> {
        let (moment, stats) = self.last.filter(|_| self.overlay.awaits_focus())?;
        let (_, actions) = self.lay_out_panel(&moment, controls, stats);
        Some(actions)
    }

    /// The next layout puts the focus into a text field.
    pub fn expect_focus(&mut self) {
        self.overlay.expect_focus();
    }

    /// Whether the pointer was over the panel, or dragging a part of it, in the last layout.
    pub fn wants_pointer(&self) -> bool {
        self.overlay.wants_pointer()
    }

    /// Draws an instant and the panel over it. `interval` is the time since the frame before, where there was one.
    pub fn draw(
        &mut self,
        moment: &Moment,
        controls: &Controls,
        interval: Option<Duration>,
    ) -> (Presented, Vec<Action>) {
        if let Some(interval) = interval {
            let milliseconds = interval.as_secs_f64() * 1e3;
            self.interval_ms = Some(smooth(self.interval_ms, milliseconds));
        }
        let frame = match self.surface.acquire() {
            CurrentSurfaceTexture::Success(frame) | CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            CurrentSurfaceTexture::Outdated => {
                self.surface.configure(&self.painter.gpu().device);
                return (Presented::Skipped, Vec::new());
            }
            CurrentSurfaceTexture::Lost => {
                self.replace_surface();
                return (Presented::Skipped, Vec::new());
            }
            CurrentSurfaceTexture::Timeout
            | CurrentSurfaceTexture::Occluded
            | CurrentSurfaceTexture::Validation => return (Presented::Skipped, Vec::new()),
        };
        let begin = Instant::now();
        match self.quality_control {
            Some(_) => self.govern(),
            None => self.follow_craft(moment),
        }
        self.follow_light(moment, interval);
        let view = self.surface.view_of(&frame.texture);
        let mut encoder = self.encoder();
        let stats = self.draw_scene(moment, &mut encoder, &view, false);
        let (delay, actions) = self.lay_out_panel(moment, controls, stats);
        let panel = self.overlay.draw(EguiTarget {
            device: &self.painter.gpu().device,
            queue: &self.painter.gpu().queue,
            encoder: &mut encoder,
            view: &view,
            size: self.surface.size(),
        });
        let submission = self
            .painter
            .gpu()
            .queue
            .submit(panel.into_iter().chain([encoder.finish()]));
        if let Some(quality_control) = &self.quality_control {
            quality_control.costs.time(begin, submission);
        }
        self.window.pre_present_notify();
        self.painter.gpu().queue.present(frame);
        let work = begin.elapsed().as_secs_f64() * 1e3;
        self.work_ms = smooth((self.work_ms > 0.0).then_some(self.work_ms), work);
        self.last = Some((*moment, stats));
        (Presented::Until(delay), actions)
    }

    /// Writes the last picture, without the panel, into a folder. Answers the file.
    pub fn screenshot(&mut self, folder: PathBuf) -> Result<PathBuf, PlayError> {
        let Some((moment, _)) = self.last else {
            return Err(PlayError::DeviceLost("nothing has been drawn yet".into()));
        };
        let path = free_name(folder, &rfc3339(moment.epoch));
        let file = PendingFile::create(&path, "images", "png")?;
        // Some surfaces cannot be read: the same is drawn once more into a texture that can.
        let texture = self.surface.capture_texture(&self.painter.gpu().device);
        let view = self.surface.view_of(&texture);
        let mut encoder = self.encoder();
        self.draw_scene(&moment, &mut encoder, &view, true);
        self.painter.gpu().queue.submit([encoder.finish()]);
        let texels = read_texture(
            &self.painter.gpu().device,
            &self.painter.gpu().queue,
            &texture,
        )?;
        file.write_png(&rgba_image(texture.width(), texture.height(), texels)?)?;
        tracing::info!("saved {}", path.display());
        Ok(path)
    }

    /// Smooths edges where there is a craft to be seen.
    fn follow_craft(&mut self, moment: &Moment) {
        let samples = match moment.craft.is_some() || self.painter.has_models() {
            true => self.samples.with_craft,
            false => self.samples.without,
        };
        let quality = *self.painter.earth().quality();
        if quality.samples != samples {
            self.set_quality(&Quality { samples, ..quality });
        }
    }

    /// Adapts the exposure to the view over the time since the last frame.
    fn follow_light(&mut self, moment: &Moment, interval: Option<Duration>) {
        let elapsed_s = interval.unwrap_or_default().as_secs_f64();
        // Metered values are in the range.
        if let Err(error) = self.painter.follow_light(moment, elapsed_s) {
            tracing::warn!("the exposure is unchanged: {error}");
        }
    }

    fn set_quality(&mut self, quality: &Quality) -> bool {
        let changed = self.painter.set_quality(quality);
        if let Err(error) = &changed {
            tracing::warn!("the quality is unchanged: {error}");
        }
        let quality = self.painter.earth().quality();
        self.surface
            .set_quality(&self.painter.gpu().device, quality);
        for (what, error) in self.painter.follow_quality() {
            tracing::warn!("{what} no longer drawn: {error}");
        }
        changed.is_ok()
    }

    /// Reduces or restores quality according to the costs of the last frames.
    fn govern(&mut self) {
        let Some(TimedQuality { control, costs }) = &mut self.quality_control else {
            return;
        };
        let Some(quality) = control.observe(costs.completed_ms()) else {
            return;
        };
        if !self.set_quality(&quality) {
            self.quality_control = None;
        }
    }

    fn encoder(&self) -> wgpu::CommandEncoder {
        let device = &self.painter.gpu().device;
        device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella window"),
        })
    }

    fn draw_scene(
        &mut self,
        moment: &Moment,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        is_screenshot: bool,
    ) -> FrameStats {
        let covered_px = match is_screenshot {
            true => [0.0; 2],
            false => self.overlay.covered_px(),
        };
        self.painter.leave_to_panel(covered_px);
        let drawn_size = self.surface.drawn_size();
        let (stats, _) = self.painter.prepare(moment, drawn_size, Patience::Live);
        let surface = &self.surface;
        let target = surface.target();
        self.painter.paint(encoder, &TargetView { target, view });
        stats
    }

    fn lay_out_panel(
        &mut self,
        moment: &Moment,
        controls: &Controls,
        stats: FrameStats,
    ) -> (Duration, Vec<Action>) {
        let data = PanelData {
            satellite: self.satellite.as_deref(),
            moment,
            ellipsoid: self.ellipsoid,
            stats,
            has_tiles: self.has_tiles,
            adaptive: self
                .quality_control
                .as_ref()
                .map(|quality_control| quality_control.control.adaptive()),
            interval_ms: self.interval_ms,
            work_ms: self.work_ms,
            adapter: &self.adapter,
        };
        let mut actions = Vec::new();
        let delay = self.overlay.lay_out(&self.window, |context| {
            // egui may lay out more than once; a click counts once.
            actions = panel::show(context, controls, &data);
        });
        (delay, actions)
    }

    fn replace_surface(&mut self) {
        match self
            .painter
            .gpu()
            .instance
            .create_surface(self.window.clone())
        {
            Ok(surface) => self.surface.replace(&self.painter.gpu().device, surface),
            Err(error) => tracing::warn!("the window's surface was lost: {error}"),
        }
    }
}

fn smooth(before: Option<f64>, newest: f64) -> f64 {
    before.map_or(newest, |before| before + SMOOTHING * (newest - before))
}

/// `terrella-<time of the picture>.png`, with a number where that is taken.
fn free_name(folder: PathBuf, epoch: &str) -> PathBuf {
    // Colons are not allowed in file names on all systems.
    let stem = format!("terrella-{}", epoch.replace(':', "-"));
    output::free_name(&folder.join(stem), "png")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn screenshots_of_one_instant_get_numbers() {
        let folder = tempfile::tempdir().expect("a folder");
        let name = || free_name(folder.path().into(), "2018-01-15T12:00:00.000Z");
        assert!(name().ends_with("terrella-2018-01-15T12-00-00.000Z.png"));
        std::fs::write(name(), b"").expect("writes");
        assert!(name().ends_with("terrella-2018-01-15T12-00-00.000Z-2.png"));
    }

    #[test]
    fn times_are_smoothed() {
        assert_eq!(smooth(None, 10.0), 10.0);
        assert!((smooth(Some(10.0), 20.0) - 11.0).abs() < 1e-12);
    }
}
