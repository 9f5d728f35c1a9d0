//! egui on the window's surface.

use super::egui_pass::{self, EguiTarget};
use super::focus;
use super::panel;
use super::theme;
use egui_wgpu::{Renderer, RendererOptions};
use std::time::Duration;
use winit::event::WindowEvent;
use winit::window::Window;

/// egui's input, renderer and output.
pub struct Overlay {
    state: egui_winit::State,
    renderer: Renderer,
    output: Option<egui::FullOutput>,
    /// Where the pointer is, points.
    pointer: Option<egui::Pos2>,
    /// The next layout puts the focus into a text field.
    expects_focus: bool,
}

/// Whether egui has consumed an event.
pub struct EventResponse {
    /// egui has consumed it.
    pub consumed: bool,
    /// The image must be drawn again.
    pub repaint: bool,
}

impl Overlay {
    /// For a window with a surface of this format.
    pub fn new(window: &Window, device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let context = egui::Context::default();
        theme::apply(&context);
        // Keys belong to the window: egui would walk its buttons with them.
        context.options_mut(|options| options.zoom_with_keyboard = false);
        let side = device.limits().max_texture_dimension_2d as usize;
        Self {
            state: egui_winit::State::new(
                context,
                egui::ViewportId::ROOT,
                window,
                Some(window.scale_factor() as f32),
                None,
                Some(side),
            ),
            renderer: Renderer::new(device, format, RendererOptions::default()),
            output: None,
            pointer: None,
            expects_focus: false,
        }
    }

    /// Offers an event to egui.
    pub fn on_event(&mut self, window: &Window, event: &WindowEvent) -> EventResponse {
        if let WindowEvent::CursorMoved { position, .. } = event {
            let scale = self.state.egui_ctx().pixels_per_point();
            let at_px = egui::pos2(position.x as f32, position.y as f32);
            self.pointer = Some(at_px / scale);
        }
        let response = self.state.on_window_event(window, event);
        EventResponse {
            consumed: response.consumed,
            repaint: response.repaint,
        }
    }

    /// Whether the pointer is over the panel or drags a part of it.
    pub fn wants_pointer(&self) -> bool {
        self.state.egui_ctx().egui_wants_pointer_input()
    }

    /// How much of the picture the panel covers on the left and the time line at the bottom, pixels.
    pub fn covered_px(&self) -> [f32; 2] {
        let context = self.state.egui_ctx();
        panel::covered(context).map(|points| points * context.pixels_per_point())
    }

    /// Whether a press or the wheel is the panel's. The pointer may have moved there since the last layout, which egui does not know yet.
    pub fn takes_press(&self) -> bool {
        let context = self.state.egui_ctx();
        let layer = self.pointer.and_then(|at| context.layer_id_at(at));
        let is_over = layer.is_some_and(|layer| layer.order != egui::Order::Background);
        is_over || self.wants_pointer()
    }

    /// Whether a line of text is being typed, to which keys belong.
    pub fn is_typing(&self) -> bool {
        focus::is_typing(self.state.egui_ctx())
    }

    /// The next layout puts the focus into a text field.
    pub fn expect_focus(&mut self) {
        self.expects_focus = true;
    }

    /// Whether events that are not laid out yet can move the focus.
    pub fn awaits_focus(&self) -> bool {
        self.expects_focus || focus::can_move_focus(&self.state.egui_input().events)
    }

    /// Lays out one frame. Returns the time until egui needs another.
    pub fn lay_out(&mut self, window: &Window, mut add: impl FnMut(&egui::Context)) -> Duration {
        self.expects_focus = false;
        let input = self.state.take_egui_input(window);
        let context = self.state.egui_ctx().clone();
        let mut output = context.run_ui(input, |ui| add(ui.ctx()));
        let platform = std::mem::take(&mut output.platform_output);
        self.state.handle_platform_output(window, platform);
        let root = output.viewport_output.get(&egui::ViewportId::ROOT);
        let delay = root.map_or(Duration::MAX, |viewport| viewport.repaint_delay);
        match &mut self.output {
            // A frame that was laid out and never drawn still brought its textures.
            Some(waiting) => waiting.append(output),
            None => self.output = Some(output),
        }
        delay
    }

    /// Draws what was laid out over a picture.
    pub fn draw(&mut self, target: EguiTarget<'_>) -> Vec<wgpu::CommandBuffer> {
        let Some(output) = self.output.take() else {
            return Vec::new();
        };
        let context = self.state.egui_ctx();
        egui_pass::draw(&mut self.renderer, context, output, target)
    }
}

impl Drop for Overlay {
    fn drop(&mut self) {
        // egui holds it for a fault if textures that came with a layout are dropped unused; at the end they are.
        if let Some(output) = &mut self.output {
            output.textures_delta.clear();
        }
    }
}
