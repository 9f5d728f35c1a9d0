//! Text and images over finished pictures, in egui's fonts.

use super::egui_pass::{self, EguiTarget};
use egui::{LayerId, Painter, Pos2, RawInput, Rect, Vec2};
use egui_wgpu::{Renderer, RendererOptions};

/// egui's fonts and the pipeline that draws them.
pub struct TextOverlay {
    context: egui::Context,
    renderer: Renderer,
}

impl TextOverlay {
    /// For images of this format.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        Self {
            context: egui::Context::default(),
            // Without dithering: the same picture every time.
            renderer: Renderer::new(device, format, RendererOptions::PREDICTABLE),
        }
    }

    /// Keeps an image for [`Self::draw`].
    pub fn load(&self, name: &str, image: egui::ColorImage) -> egui::TextureHandle {
        let options = egui::TextureOptions::LINEAR;
        self.context.load_texture(name, image, options)
    }

    /// Draws over a picture; `paint` gets its rectangle, a point a pixel, and may be called again.
    pub fn draw(&mut self, target: EguiTarget<'_>, mut paint: impl FnMut(&Painter, Rect)) {
        let (width, height) = target.size;
        let screen = Rect::from_min_size(Pos2::ZERO, Vec2::new(width as f32, height as f32));
        let input = RawInput {
            screen_rect: Some(screen),
            max_texture_side: Some(target.device.limits().max_texture_dimension_2d as usize),
            ..Default::default()
        };
        let output = self.context.run_ui(input, |ui| {
            let painter = ui.ctx().layer_painter(LayerId::background());
            paint(&painter, screen);
        });
        let renderer = &mut self.renderer;
        let callbacks = egui_pass::draw(renderer, &self.context, output, target);
        // Only paint callbacks create command buffers; there are none.
        debug_assert!(callbacks.is_empty());
    }
}
