//! The panel and all overlays: layout at every window size, and appearance.

use super::*;
use crate::egui_pass::{self, EguiTarget};
use crate::flight::Flight;
use crate::offscreen::rgba_image;
use crate::scene::Scene;
use crate::theme;
use egui::{RawInput, Rect};
use std::path::{Path, PathBuf};
use terrella::internals::gpu::{GpuContext, read_texture};

/// Sizes of windows in pixels, with the pixels per point.
const SIZES: [(u32, u32, f32); 6] = [
    (640, 360, 1.0),
    (1280, 720, 1.0),
    (1920, 1080, 1.0),
    (3840, 2160, 1.0),
    (1280, 720, 2.0),
    (3840, 2160, 2.0),
];
/// Number of sizes with golden images.
const PICTURES: usize = 2;
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Background of the panel, display values.
const SKY: wgpu::Color = wgpu::Color {
    r: 0.36,
    g: 0.5,
    b: 0.66,
    a: 1.0,
};

/// A window with all open that may be open at a time.
struct Window {
    context: Context,
    output: egui::FullOutput,
}

/// The panel with all open that may be open at a time, frame by frame.
struct Panel {
    flight: Flight,
    controls: Controls,
    context: Context,
    /// Points.
    size: egui::Vec2,
    /// Pixels per point.
    scale: f32,
}

impl Panel {
    fn new((width, height, scale): (u32, u32, f32)) -> Self {
        let text = "[time]\nstart = \"2018-01-15T12:00:00Z\"\nduration_s = 21600\n[camera]\nmode = \"nadir\"\n[orbit]\n";
        let scene = Scene::from_toml(text, Path::new("test.toml")).expect("a good scene");
        let flight = Flight::open(scene).expect("opens");
        let mut controls = Controls::new(&flight);
        controls.map_scale = true;
        controls.message = Some("saved terrella-2018-01-15T12-00-00.000Z.png".to_owned());
        controls.read_out = Some(ReadOut {
            title: "Place".to_owned(),
            rows: vec![
                ("position", "48.2000° N, 16.4000° E".to_owned()),
                ("altitude", "0 m".to_owned()),
                ("solar time", "13:05 (apparent)".to_owned()),
            ],
            at: None,
            passes_over_deg: Some([48.2, 16.4]),
        });
        controls.clock.seek(0.3);
        controls.line.find_light(&flight, &controls.clock);
        let context = Context::default();
        theme::apply(&context);
        Self {
            flight,
            controls,
            context,
            size: egui::vec2(width as f32, height as f32) / scale,
            scale,
        }
    }

    fn frame(&self, time_s: f64) -> egui::FullOutput {
        let request = self.controls.request(16.0 / 9.0);
        let moment = self.flight.view_at(self.controls.clock.now(), &request);
        let data = PanelData {
            satellite: Some("ISS (ZARYA)"),
            moment: &moment.expect("known"),
            ellipsoid: *self.flight.ellipsoid(),
            stats: FrameStats::default(),
            has_tiles: false,
            adaptive: None,
            interval_ms: Some(16.7),
            work_ms: 3.2,
            adapter: "test",
        };
        let mut input = RawInput {
            time: Some(time_s),
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, self.size)),
            ..RawInput::default()
        };
        let viewport = input.viewports.entry(egui::ViewportId::ROOT).or_default();
        viewport.native_pixels_per_point = Some(self.scale);
        self.context.run_ui(input, |ui| {
            show(ui.ctx(), &self.controls, &data);
        })
    }
}

/// A panel that has settled: an egui window knows its size after one layout pass, and is opaque after a fraction of a second.
fn window(size: (u32, u32, f32)) -> Window {
    let panel = Panel::new(size);
    let mut output = egui::FullOutput::default();
    for second in 0..3 {
        output.append(panel.frame(f64::from(second)));
    }
    Window {
        context: panel.context,
        output,
    }
}

/// What the interface takes of a frame: its layout and its triangles, without drawing.
///
/// `cargo test --release -p terrella-play --features window print_interface -- --ignored --nocapture`
#[test]
#[ignore = "measures"]
fn print_interface_times() {
    for size in SIZES {
        let panel = Panel::new(size);
        let mut times = Vec::new();
        for frame in 0..300 {
            let began = std::time::Instant::now();
            let mut output = panel.frame(f64::from(frame) / 60.0);
            let triangles = panel
                .context
                .tessellate(output.shapes, output.pixels_per_point);
            times.push(began.elapsed().as_secs_f64() * 1e3);
            // In the first frame windows find out their sizes.
            assert!(frame == 0 || !std::hint::black_box(triangles).is_empty());
            output.textures_delta.clear();
        }
        // The first frames make letters.
        times.drain(..50);
        times.sort_by(f64::total_cmp);
        let [median, high] = [times[times.len() / 2], times[times.len() * 99 / 100]];
        println!("{size:?}: {median:.3} ms median, {high:.3} ms p99");
    }
}

#[test]
fn nothing_overlaps_and_nothing_is_cut_at_any_size() {
    for size in SIZES {
        let mut window = window(size);
        window.output.textures_delta.clear();
        let screen = window.context.content_rect();
        let areas: Vec<Rect> = window.context.memory(|memory| {
            let layers = memory.areas().visible_layer_ids();
            let rects = layers.iter().map(|layer| memory.area_rect(layer.id));
            // The whole screen is below all of them.
            rects.flatten().filter(|rect| *rect != screen).collect()
        });
        // Panel, time line, selection, message, scale.
        assert_eq!(areas.len(), 5, "{size:?}: {areas:?}");
        for (index, area) in areas.iter().enumerate() {
            assert!(screen.contains_rect(*area), "{size:?}: {area}");
            for other in &areas[index + 1..] {
                let common = area.intersect(*other);
                assert!(!common.is_positive(), "{size:?}: {area} over {other}");
            }
        }
    }
}

fn golden(size: (u32, u32)) -> PathBuf {
    let name = format!("goldens/panel_{}x{}.png", size.0, size.1);
    Path::new(env!("CARGO_MANIFEST_DIR")).join(name)
}

/// Drivers round edges of shapes each their own way.
#[test]
fn the_panel_looks_as_its_pictures() {
    let gpu = pollster::block_on(GpuContext::open(None)).expect("an adapter");
    let mut renderer =
        egui_wgpu::Renderer::new(&gpu.device, FORMAT, egui_wgpu::RendererOptions::PREDICTABLE);
    for (width, height, scale) in SIZES.into_iter().take(PICTURES) {
        let Window { context, output } = window((width, height, scale));
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("terrella test panel"),
            size: wgpu::Extent3d {
                width,
                height,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        });
        let view = texture.create_view(&Default::default());
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        let sky = wgpu::Operations {
            load: wgpu::LoadOp::Clear(SKY),
            store: wgpu::StoreOp::Store,
        };
        drop(encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("terrella test sky"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: sky,
            })],
            ..Default::default()
        }));
        let target = EguiTarget {
            device: &gpu.device,
            queue: &gpu.queue,
            encoder: &mut encoder,
            view: &view,
            size: (width, height),
        };
        let commands = egui_pass::draw(&mut renderer, &context, output, target);
        gpu.queue
            .submit(commands.into_iter().chain([encoder.finish()]));
        let texels = read_texture(&gpu.device, &gpu.queue, &texture).expect("reads");
        let drawn = rgba_image(width, height, texels).expect("an image");
        let path = golden((width, height));
        if std::env::var_os("TERRELLA_UPDATE_GOLDENS").is_some() {
            drawn.save(&path).expect("writes");
            continue;
        }
        let expected = image::open(&path).expect("a golden; TERRELLA_UPDATE_GOLDENS=1 writes it");
        let expected = expected.to_rgba8();
        assert_eq!(expected.dimensions(), (width, height));
        let pairs = drawn.pixels().zip(expected.pixels());
        let different = pairs.filter(|(a, b)| (0..3).any(|k| a.0[k].abs_diff(b.0[k]) > 48));
        let part = different.count() as f64 / f64::from(width * height);
        assert!(part < 2e-3, "{part} of {} differs", path.display());
    }
}
