//! The window: winit's events in, pictures out.

mod filming;
mod keyboard;
mod pointing;
mod switching;

use super::basilisk::with_camera_service;
use super::controls::{Controls, WindowTask};
use super::coverage_layer::{CoverageWork, compute_behind};
use super::error::{PlayError, WindowError};
use super::flight::Flight;
use super::keys::Action;
use super::picture_change::PictureMaker;
use super::pointer::Pointer;
use super::progress::Progress;
use super::shader_watch::ShaderWatch;
use super::simulator_time::SimulatorTime;
use super::timeline::{Coverage, PassSearch};
use super::window_renderer::{Presented, WindowRenderer};
use filming::Filming;
use glam::DVec2;
use hifitime::Unit;
use std::path::PathBuf;
use std::sync::mpsc::Receiver;
use std::time::{Duration, Instant};
use terrella::EyeView;
use terrella::frames::Epoch;
use terrella::internals::gpu::{PictureError, ShaderFiles};
use winit::application::ApplicationHandler;
use winit::dpi::PhysicalSize;
use winit::event::{ElementState, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::keyboard::ModifiersState;
use winit::window::{Fullscreen, WindowId};

/// Wait before a surface that returned no texture is tried again.
const RETRY: Duration = Duration::from_millis(100);
/// Pixels of a touchpad that magnify like one notch of a wheel.
const PIXELS_PER_NOTCH: f64 = 50.0;
/// Magnification of one notch, as a power of two.
const ZOOM_PER_NOTCH: f64 = 0.25;
/// How far ahead tiles are read for, seconds of the user's time.
const EXPECTED_S: [f64; 3] = [0.5, 1.5, 4.0];
/// How long a message stays, and for each of its characters.
const MESSAGE_TIME: Duration = Duration::from_secs(3);
const READING_TIME: Duration = Duration::from_millis(70);
/// The first message.
const WELCOME: &str = "drag turns the globe, the wheel approaches it, H lists all keys";
/// Time after which a window without activity checks whether the program must end.
const LOOK_FOR_END: Duration = Duration::from_millis(250);

/// How the window is opened.
#[derive(Clone, Debug, Default)]
pub struct WindowRequest<'r> {
    /// Part of the adapter's name; `None` takes the best.
    pub adapter: Option<&'r str>,
    /// Width and height of the inside, pixels; `None` is the scene's.
    pub size: Option<(u32, u32)>,
    /// Closes the window by itself after this many seconds.
    pub for_seconds: Option<f64>,
    /// The program that makes films, by its command `play`; `None` makes none.
    pub program: Option<PathBuf>,
}

/// Opens a window and plays the flight in it until it is closed. Call it on the main thread, once in a program.
pub fn play_in_window(
    flight: &Flight,
    request: &WindowRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), PlayError> {
    // Before the maps are loaded: a missing display is detected immediately.
    let event_loop =
        EventLoop::new().map_err(|error| WindowError::NoDisplay(no_display(&error)))?;
    with_camera_service(flight, request.adapter, || {
        run_window(event_loop, flight, request, progress)
    })
}

fn run_window(
    event_loop: EventLoop<()>,
    flight: &Flight,
    request: &WindowRequest<'_>,
    progress: &dyn Progress,
) -> Result<(), PlayError> {
    std::thread::scope(|scope| {
        let proxy = event_loop.create_proxy();
        // A loop that has ended is not woken.
        let wake = move || {
            let _ = proxy.send_event(());
        };
        let (wake_for_coverage, wake_for_pictures) = (wake.clone(), wake.clone());
        let pass_search = PassSearch::start(scope, flight, wake).map_err(WindowError::NoPasses)?;
        let pictures = PictureMaker::start(scope, flight, wake_for_pictures);
        let pictures = pictures.map_err(WindowError::NoPictures)?;
        let (found, coverage_done) = std::sync::mpsc::channel();
        let coverage_work = compute_behind(scope, flight, move |failure| {
            // The window may be closed by now.
            let _ = found.send(failure);
            wake_for_coverage();
        });
        let coverage_work = coverage_work.map_err(WindowError::NoCoverage)?;
        let mut controls = Controls::new(flight);
        controls.makes_films = request.program.is_some();
        let mut app = App {
            pass_search,
            pictures,
            filming: None,
            coverage_done,
            _coverage_work: coverage_work,
            controls,
            live: SimulatorTime::of(flight),
            flight,
            request,
            progress,
            renderer: None,
            failure: None,
            closes_at: None,
            last_frame: None,
            message_ends: None,
            repaint_at: None,
            retry_at: None,
            pointer: Pointer::default(),
            modifiers: ModifiersState::empty(),
            hidden: false,
            expected: Vec::new(),
            shader_watch: ShaderWatch::new(ShaderFiles::chosen()),
        };
        event_loop
            .run_app(&mut app)
            .map_err(|error| WindowError::NoDisplay(error.to_string()))?;
        match app.failure {
            Some(failure) => Err(failure),
            None => Ok(()),
        }
    })
}

/// winit's reason without the place in its source that its message begins with: `os error at FILE:LINE: reason.`
fn no_display(error: &winit::error::EventLoopError) -> String {
    let text = error.to_string();
    let reason = match text.strip_prefix("os error at ") {
        Some(rest) => rest.split_once(": ").map_or(rest, |(_, reason)| reason),
        None => &text,
    };
    reason.trim_end_matches('.').to_owned()
}

struct App<'a> {
    flight: &'a Flight,
    /// Present if a simulator controls the time.
    live: Option<SimulatorTime<'a>>,
    pass_search: PassSearch,
    /// Makes pictures of other layers and tone curves.
    pictures: PictureMaker,
    /// The film that is being made.
    filming: Option<Filming>,
    /// The map of coverage is there, or what went wrong.
    coverage_done: Receiver<Option<PlayError>>,
    _coverage_work: Option<CoverageWork>,
    request: &'a WindowRequest<'a>,
    controls: Controls,
    progress: &'a dyn Progress,
    renderer: Option<WindowRenderer>,
    failure: Option<PlayError>,
    closes_at: Option<Instant>,
    /// When the last frame began; `None` after a time without frames.
    last_frame: Option<Instant>,
    message_ends: Option<Instant>,
    /// When egui, or a surface without a texture, needs another frame.
    repaint_at: Option<Instant>,
    /// When a surface that returned no texture is tried again.
    retry_at: Option<Instant>,
    pointer: Pointer,
    modifiers: ModifiersState,
    /// Minimised or covered.
    hidden: bool,
    /// Expected positions of the eye.
    expected: Vec<EyeView>,
    shader_watch: ShaderWatch,
}

impl ApplicationHandler for App<'_> {
    fn new_events(&mut self, _event_loop: &ActiveEventLoop, cause: StartCause) {
        // The loop wakes far more often than there is something to draw.
        let is_due = self.repaint_at.is_some_and(|time| time <= Instant::now());
        if matches!(cause, StartCause::ResumeTimeReached { .. }) && self.live.is_none() && is_due {
            self.redraw();
        }
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        // Desktop systems resume once; on others the renderer of the first time is kept.
        if self.renderer.is_some() {
            return;
        }
        let [width, height] = self.flight.scene().output.size;
        let (width, height) = self.request.size.unwrap_or((width, height));
        let size = PhysicalSize::new(width, height);
        let adapter = self.request.adapter;
        match WindowRenderer::open(event_loop, size, self.flight, adapter, self.progress) {
            Ok(renderer) => {
                self.renderer = Some(renderer);
                let time = self.request.for_seconds;
                let time = time.and_then(|time| Duration::try_from_secs_f64(time).ok());
                self.closes_at = time.and_then(|time| Instant::now().checked_add(time));
                self.show_message(WELCOME.to_owned());
                self.redraw();
            }
            Err(error) => self.fail(event_loop, error),
        }
    }

    /// The search has an answer, or the map of coverage or a picture is there.
    fn user_event(&mut self, _event_loop: &ActiveEventLoop, (): ()) {
        while let Some(answer) = self.pass_search.answer() {
            let coverage = self.coverage();
            let controls = &mut self.controls;
            if let Some(message) = controls.line.receive(&mut controls.clock, answer, coverage) {
                self.show_message(message);
            }
        }
        while let Ok(failure) = self.coverage_done.try_recv() {
            self.show_coverage(failure);
        }
        self.take_picture();
        self.redraw();
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _id: WindowId, event: WindowEvent) {
        if matches!(event, WindowEvent::KeyboardInput { .. }) {
            self.settle_focus(event_loop);
        }
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        let response = renderer.offer(&event);
        // The picture behind a dialog takes no pointer.
        let is_taken = response.consumed || self.controls.is_modal();
        if response.repaint && !matches!(event, WindowEvent::RedrawRequested) {
            renderer.window().request_redraw();
        }
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(size) => {
                self.hidden = size.width == 0 || size.height == 0;
                renderer.resize((size.width, size.height));
                self.redraw();
            }
            WindowEvent::Occluded(occluded) => {
                self.hidden = occluded;
                self.redraw();
            }
            WindowEvent::RedrawRequested => self.draw(event_loop),
            WindowEvent::KeyboardInput { event, .. }
                if event.state == ElementState::Pressed && !response.consumed =>
            {
                self.press_key(event_loop, &event);
            }
            WindowEvent::ModifiersChanged(modifiers) => self.modifiers = modifiers.state(),
            WindowEvent::MouseInput { state, button, .. } => {
                self.press(event_loop, state, button, is_taken);
            }
            WindowEvent::CursorMoved { position, .. } => {
                // A press that comes right after the pointer is known to be the panel's one layout later.
                if renderer.wants_pointer() || self.controls.is_modal() {
                    self.pointer.let_go();
                    self.controls.hand.let_go();
                }
                let at_px = DVec2::new(position.x, position.y);
                for gesture in self.pointer.move_to(at_px).into_iter().flatten() {
                    self.gesture(event_loop, gesture);
                }
            }
            WindowEvent::CursorLeft { .. } => self.pointer.leave(),
            WindowEvent::MouseWheel { delta, .. } if !is_taken => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, lines) => f64::from(lines),
                    MouseScrollDelta::PixelDelta(pixels) => pixels.y / PIXELS_PER_NOTCH,
                };
                self.wheel(event_loop, notches * ZOOM_PER_NOTCH);
            }
            WindowEvent::PinchGesture { delta, .. } if delta.is_finite() && !is_taken => {
                self.wheel(event_loop, (1.0 + delta.max(-0.9)).log2());
            }
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        if self.closes_at.is_some_and(|end| end <= now) {
            event_loop.exit();
            return;
        }
        if let Some(fault) = self.renderer.as_ref().and_then(WindowRenderer::fault) {
            self.fail(event_loop, PictureError::from(fault).into());
            return;
        }
        if self.message_ends.is_some_and(|end| end <= now) {
            (self.message_ends, self.controls.message) = (None, None);
            self.redraw();
        }
        self.look_for_film();
        if self.shader_watch.has_changed(now) {
            self.reload_shaders();
        }
        let is_over = self.live.as_ref().is_some_and(SimulatorTime::is_over);
        if is_over || self.progress.cancelled() {
            event_loop.exit();
            return;
        }
        let is_paused = self.controls.clock.is_paused();
        let mut poll_at = None;
        let due = match &mut self.live {
            None => !is_paused && !self.hidden && self.repaint_at.is_none(),
            Some(live) => {
                poll_at = live.pause(is_paused).map(|pause| now + pause);
                let is_due = live.is_due(self.hidden, is_paused);
                let is_past = |time: Instant| time <= now;
                (is_due || self.repaint_at.is_some_and(is_past))
                    && self.retry_at.is_none_or(is_past)
            }
        };
        if due {
            self.redraw();
        }
        let wake = [
            self.closes_at,
            self.message_ends,
            self.repaint_at,
            poll_at,
            // A request to end comes from outside of the event loop.
            Some(now + LOOK_FOR_END),
        ];
        if let Some(time) = wake.into_iter().flatten().min() {
            event_loop.set_control_flow(ControlFlow::WaitUntil(time));
        }
    }
}

impl<'a> App<'a> {
    fn redraw(&self) {
        if let (Some(renderer), false) = (&self.renderer, self.hidden) {
            renderer.window().request_redraw();
        }
    }

    fn fail(&mut self, event_loop: &ActiveEventLoop, error: PlayError) {
        self.failure = Some(error);
        event_loop.exit();
    }

    fn show_message(&mut self, message: String) {
        // As long as it takes to read.
        let time = MESSAGE_TIME + READING_TIME * message.chars().count() as u32;
        self.message_ends = Some(Instant::now() + time);
        self.controls.message = Some(message);
    }

    /// Draws with shaders that have changed on disk, and reports it, or why not.
    fn reload_shaders(&mut self) {
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        let message = match renderer.reload_shaders(self.flight) {
            Ok(()) => {
                tracing::info!("drawn with the new shaders");
                "drawn with the new shaders".to_owned()
            }
            Err(error) => {
                tracing::warn!("the shaders stay as they were: {error}");
                format!("the shaders stay as they were: {error}")
            }
        };
        self.show_message(message);
        self.redraw();
    }

    fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) {
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        let height_px = f64::from(renderer.size().1);
        if !self.controls.accepts(action) {
            return;
        }
        if let Some(denial) = self.live.as_ref().and_then(|live| live.denial(action)) {
            self.show_message(denial);
            self.redraw();
            return;
        }
        let window = renderer.window();
        if action == Action::Dismiss
            && !self.controls.is_something_open()
            && window.fullscreen().is_some()
        {
            window.set_fullscreen(None);
            return;
        }
        let before = self.controls.switches;
        match self.controls.apply(action, height_px) {
            None if self.controls.switches == before => {}
            None => self.switch(before),
            Some(WindowTask::Quit) => event_loop.exit(),
            Some(WindowTask::NorthUp) => self.turn_north_up(),
            Some(WindowTask::Follow(index)) => self.follow_now(index),
            Some(WindowTask::GoTo(epoch)) => {
                let coverage = self.coverage();
                let controls = &mut self.controls;
                if let Some(message) = controls.line.go_to(&mut controls.clock, epoch, coverage) {
                    self.show_message(message);
                }
            }
            Some(WindowTask::RealTime) => {
                let coverage = self.coverage();
                let controls = &mut self.controls;
                let message = match Epoch::now() {
                    Ok(now) => controls
                        .line
                        .begin_real_time(&mut controls.clock, now, coverage),
                    Err(error) => format!("the real clock cannot be read: {error}"),
                };
                self.show_message(message);
            }
            Some(WindowTask::NextPass) => {
                match self
                    .controls
                    .line
                    .next_pass_query(&self.controls.clock, self.coverage())
                {
                    Ok(query) => self.pass_search.ask(query),
                    Err(message) => self.show_message(message),
                }
            }
            Some(WindowTask::MakeFilm) => self.make_film(),
            Some(WindowTask::FullScreen) => {
                let window = renderer.window();
                let next = match window.fullscreen() {
                    Some(_) => None,
                    None => Some(Fullscreen::Borderless(None)),
                };
                window.set_fullscreen(next);
            }
            Some(WindowTask::Screenshot) => match renderer.screenshot(PathBuf::new()) {
                Ok(path) => self.show_message(format!("saved {}", path.display())),
                Err(error) => self.show_message(error.to_string()),
            },
        }
        self.redraw();
    }

    /// The satellite that cameras fly with, and when it is known.
    fn coverage(&self) -> Option<Coverage<'a>> {
        self.flight.feed().map(Coverage::of)
    }

    /// Lets time pass, or sets the clock by the real one.
    fn advance(&mut self, wall: Duration) {
        if self.live.is_some() {
            // Time comes from the simulator.
            return;
        }
        let coverage = self.coverage();
        let controls = &mut self.controls;
        let now = controls.line.is_real_time().then(Epoch::now);
        let message = match now {
            Some(Ok(now)) => controls.line.follow(&mut controls.clock, now, coverage),
            _ => {
                controls.advance(wall.as_secs_f64());
                None
            }
        };
        if let Some(message) = message {
            self.show_message(message);
        }
        let controls = &mut self.controls;
        let queries = [
            controls.line.passes_query(&controls.clock),
            controls.line.light_query(&controls.clock),
        ];
        for query in queries.into_iter().flatten() {
            self.pass_search.ask(query);
        }
    }

    fn draw(&mut self, event_loop: &ActiveEventLoop) {
        let now = Instant::now();
        let interval = self.last_frame.map(|last| now - last);
        self.advance(interval.unwrap_or_default());
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        let aspect = renderer.aspect();
        let request = self.controls.request(aspect);
        let is_paused = self.controls.clock.is_paused();
        let moment = match &mut self.live {
            Some(live) => Ok(live.moment(&request, is_paused)),
            None => self.flight.view_at(self.controls.clock.now(), &request),
        };
        self.controls.live = self.live.as_ref().map(|live| live.status(is_paused));
        let mut moment = match (moment, renderer.last_moment()) {
            (Ok(moment), _) => moment,
            // The satellite cannot be followed any further: the last picture stays, with the reason.
            (Err(error), Some(last)) => {
                self.controls.clock.set_paused(true);
                self.controls.message = Some(error.to_string());
                last
            }
            (Err(error), None) => {
                self.fail(event_loop, error);
                return;
            }
        };
        self.place_eye(&mut moment, aspect);
        let Some(renderer) = &mut self.renderer else {
            return;
        };
        // Only consecutive frames give a frame rate.
        let stands = self
            .live
            .as_ref()
            .is_some_and(|live| live.pause(is_paused).is_some());
        let moving = !is_paused && !stands;
        self.last_frame = moving.then_some(now);
        self.expected.clear();
        // An eye that the user has moved goes nowhere by itself.
        if moving && renderer.has_tiles() && self.controls.hand.eye().is_none() {
            let speed = match &self.live {
                Some(live) => live.rate(),
                None => Some(self.controls.clock.speed()),
            };
            let speeds = speed
                .into_iter()
                .flat_map(|speed| EXPECTED_S.map(|s| s * speed));
            self.expected.extend(speeds.filter_map(|seconds| {
                let epoch = moment.epoch + Unit::Second * seconds;
                Some(self.flight.view_at(epoch, &request).ok()?.view)
            }));
        }
        renderer.prefetch(&self.expected);
        let (presented, actions) = renderer.draw(&moment, &self.controls, interval);
        if let (Some(live), Presented::Until(_)) = (&mut self.live, presented) {
            live.drawn();
        }
        self.repaint_at = match presented {
            Presented::Until(_) if renderer.is_loading() => Some(now),
            Presented::Until(delay) => now.checked_add(delay).filter(|_| !moving),
            Presented::Skipped => Some(now + RETRY),
        };
        self.retry_at = self.repaint_at.filter(|_| presented == Presented::Skipped);
        for action in actions {
            self.act(event_loop, action);
        }
    }
}
