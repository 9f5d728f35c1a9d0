//! A satellite on a circle, an Earth with its tracks, and positions on screen.

use crate::common;
use glam::{DVec2, DVec3, DVec4};
use image::RgbaImage;
use terrella::frames::{Ellipsoid, Epoch, Geodetic, Orientation, utc_from_rfc3339};
use terrella::internals::gpu::{Attachments, DepthBuffer, color_texture, read_texture};
use terrella::tracks::{TrackMoment, TrackSpan, TrackStats, TrackStyle, Tracks, TracksOptions};
use terrella::{Earth, EarthOptions, EyeView, FrameRequest, Sky, ViewFrame};
use terrella_ground::air::Atmosphere;
use terrella_orbit::constants::EARTH_GM_M3_S2;
use terrella_orbit::{Feed, Frame, OrbitError, OrbitState};

pub const WGS84: Ellipsoid = Ellipsoid::WGS84;
pub const SIZE: (u32, u32) = (480, 360);
pub const MAGENTA: [u8; 3] = [255, 0, 255];

/// A circle about the Earth's centre in inertial axes.
pub struct Circle {
    pub radius_m: f64,
    pub inclination_rad: f64,
}

pub fn now() -> Epoch {
    utc_from_rfc3339("2018-01-15T12:00:00Z").expect("a date")
}

impl Circle {
    pub fn rate_rad_s(&self) -> f64 {
        (EARTH_GM_M3_S2 / self.radius_m.powi(3)).sqrt()
    }

    /// In the Earth-fixed axes of now, `angle` ahead of where it is now.
    pub fn as_seen_now(&self, angle_rad: f64) -> DVec3 {
        let (sin, cos) = angle_rad.sin_cos();
        let (tilt, level) = self.inclination_rad.sin_cos();
        let inertial = self.radius_m * DVec3::new(cos, sin * level, sin * tilt);
        Frame::Teme.itrf_from(now(), &Orientation::default()) * inertial
    }
}

impl Feed for Circle {
    fn name(&self) -> &str {
        "Circle"
    }

    fn validity(&self) -> (Epoch, Epoch) {
        let date = |text| utc_from_rfc3339(text).expect("a date");
        (date("2000-01-01T00:00:00Z"), date("2050-01-01T00:00:00Z"))
    }

    fn state_at(&self, epoch: Epoch) -> Result<OrbitState, OrbitError> {
        let rate = self.rate_rad_s();
        let (sin, cos) = (rate * (epoch - now()).to_seconds()).sin_cos();
        let (tilt, level) = self.inclination_rad.sin_cos();
        Ok(OrbitState {
            epoch,
            frame: Frame::Teme,
            position_m: self.radius_m * DVec3::new(cos, sin * level, sin * tilt),
            velocity_m_s: self.radius_m * rate * DVec3::new(-sin, cos * level, cos * tilt),
        })
    }
}

/// The moment of a view's frame.
fn moment(view: &EyeView) -> TrackMoment<'_> {
    TrackMoment {
        epoch: now(),
        orientation: Orientation::default(),
        turn: None,
        view,
        target: SIZE.into(),
    }
}

pub struct Rig {
    options: EarthOptions,
    earth: Earth,
    pub tracks: Tracks,
    pub sun: DVec3,
}

impl Rig {
    pub fn new(options: EarthOptions, style: TrackStyle) -> Self {
        let gpu = common::gpu();
        let earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
        Self {
            tracks: Tracks::new(&gpu.device, &TracksOptions::of(&earth), &[style]).expect("tracks"),
            earth,
            options,
            sun: DVec3::X,
        }
    }

    /// The image with tracks, the one without, and the statistics.
    pub fn draw(&mut self, view: &EyeView, feed: &dyn Feed) -> (RgbaImage, RgbaImage, TrackStats) {
        let gpu = common::gpu();
        let sky = Sky::new(self.sun);
        self.earth
            .prepare(&gpu.queue, FrameRequest::new(view, &sky, SIZE));
        let stats = self
            .tracks
            .prepare_complete(&gpu.queue, &moment(view), [feed]);
        (self.picture(true), self.picture(false), stats)
    }

    /// The picture of a further view with its tracks, prepared together with the first, whose eye this is.
    pub fn draw_further(
        &mut self,
        first: &EyeView,
        eye: &EyeView,
        feed: &dyn Feed,
    ) -> (RgbaImage, TrackStats) {
        let gpu = common::gpu();
        let sky = Sky::new(self.sun);
        let mut view = self.earth.new_view().expect("a view");
        let mut tracks = self.tracks.new_view(&view);
        let frame = ViewFrame {
            view: &mut view,
            eye,
            sky: &sky,
            target: SIZE.into(),
        };
        self.earth.prepare(
            &gpu.queue,
            FrameRequest::new(first, &sky, SIZE).with_views(&mut [frame]),
        );
        let stats = tracks.prepare_complete(&gpu.queue, &moment(eye), [feed]);
        let drawn = self.drawn(|pass| {
            self.earth.render_view(&view, pass);
            tracks.render(pass);
        });
        (drawn, stats)
    }

    fn picture(&self, with_tracks: bool) -> RgbaImage {
        self.drawn(|pass| {
            self.earth.render(pass);
            if with_tracks {
                self.tracks.render(pass);
            }
        })
    }

    fn drawn(&self, draw: impl FnOnce(&mut wgpu::RenderPass<'_>)) -> RgbaImage {
        let gpu = common::gpu();
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
        let format = self.options.color_format;
        let texture = color_texture(&gpu.device, "terrella test", SIZE, format, 1, usage);
        let view = texture.create_view(&Default::default());
        let attachments = Attachments::new(&gpu.device, SIZE, format, self.options.samples);
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        // A pass without depth, or with depths the other way round, is begun here.
        let mut pass = match self.options.depth {
            DepthBuffer::ReversedZ(_) => attachments.begin_pass(&mut encoder, &view),
            depth => plain_pass(&mut encoder, &view, depth),
        };
        draw(&mut pass);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        let texels = read_texture(&gpu.device, &gpu.queue, &texture).expect("a picture");
        RgbaImage::from_raw(texture.width(), texture.height(), texels).expect("of that size")
    }
}

pub fn plain_pass<'e>(
    encoder: &'e mut wgpu::CommandEncoder,
    view: &wgpu::TextureView,
    depth: DepthBuffer,
) -> wgpu::RenderPass<'e> {
    let depth_view = match depth {
        DepthBuffer::StandardZ(format) => {
            let usage = wgpu::TextureUsages::RENDER_ATTACHMENT;
            let device = &common::gpu().device;
            let texture = color_texture(device, "terrella test", SIZE, format, 1, usage);
            Some(texture.create_view(&Default::default()))
        }
        _ => None,
    };
    encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
        label: Some("terrella test"),
        color_attachments: &[Some(wgpu::RenderPassColorAttachment {
            view,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                store: wgpu::StoreOp::Store,
            },
        })],
        depth_stencil_attachment: depth_view.as_ref().map(|view| {
            wgpu::RenderPassDepthStencilAttachment {
                view,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: None,
            }
        }),
        ..Default::default()
    })
}

pub fn options(atmosphere: Atmosphere) -> EarthOptions {
    EarthOptions {
        atmosphere,
        ..EarthOptions::new(common::plain([70, 90, 60]))
    }
}

/// Only the elements that `change` turns on, in a colour that no Earth has.
pub fn style(change: impl FnOnce(&mut TrackStyle)) -> TrackStyle {
    let mut style = TrackStyle {
        color: MAGENTA,
        width_px: 5.0,
        ..TrackStyle::new(0)
    };
    change(&mut style);
    style
}

/// A trail that hardly fades over its last revolution: it goes back for fifteen.
pub fn whole(radius_m: f64) -> Option<TrackSpan> {
    let rate = (EARTH_GM_M3_S2 / radius_m.powi(3)).sqrt();
    Some(TrackSpan::Seconds {
        before_s: 15.0 * std::f64::consts::TAU / rate,
        after_s: 0.0,
    })
}

pub fn aspect() -> f64 {
    f64::from(SIZE.0) / f64::from(SIZE.1)
}

/// Position of a place on screen, pixels, if it is in front of the eye.
pub fn any_pixel(view: &EyeView, place: DVec3) -> Option<(f64, f64)> {
    let (eye, clip_from_eye) = view.to_itrf();
    let clip: DVec4 = clip_from_eye * (place - eye).extend(1.0);
    let (x, y) = (
        (0.5 + 0.5 * clip.x / clip.w) * f64::from(SIZE.0),
        (0.5 - 0.5 * clip.y / clip.w) * f64::from(SIZE.1),
    );
    (clip.w > 0.0).then_some((x, y))
}

/// The same if it is in the picture and not at its edge.
pub fn pixel(view: &EyeView, place: DVec3) -> Option<(f64, f64)> {
    let inside = |at: f64, size: u32| (3.0..f64::from(size) - 3.0).contains(&at);
    any_pixel(view, place).filter(|(x, y)| inside(*x, SIZE.0) && inside(*y, SIZE.1))
}

/// Approximate distance of a place from the limb, pixels.
pub fn limb_px(view: &EyeView, place: DVec3) -> f64 {
    let eye = view.eye_world;
    let pixel_rad = 2.0 / (view.clip_from_view.y_axis.y * f64::from(SIZE.1));
    let limb_m = (eye.length_squared() - 6.37e6_f64.powi(2)).max(0.0).sqrt();
    (q_of(eye, place) - 1.0).abs() * 6.37e6 / limb_m.max(1.0) / pixel_rad
}

/// Distance of a point from a segment.
pub fn from_segment(at: (f64, f64), (a, b): ((f64, f64), (f64, f64))) -> f64 {
    let (at, a, b) = (DVec2::from(at), DVec2::from(a), DVec2::from(b));
    let along = (b - a).length_squared();
    let t = if along > 0.0 {
        (at - a).dot(b - a) / along
    } else {
        0.0
    };
    at.distance(a + t.clamp(0.0, 1.0) * (b - a))
}

pub fn differs(a: &RgbaImage, b: &RgbaImage, x: u32, y: u32) -> u8 {
    let (a, b) = (a.get_pixel(x, y), b.get_pixel(x, y));
    (0..3)
        .map(|k| a[k].abs_diff(b[k]))
        .max()
        .unwrap_or_default()
}

/// Distance of a ray to a place from the Earth's centre line, scaled space.
pub fn q_of(eye: DVec3, place: DVec3) -> f64 {
    let scale = WGS84.scaled_from_itrf();
    (scale * eye)
        .cross((scale * (place - eye)).normalize())
        .length()
}

/// Views of a low circle: from outside and inside of it, from low and high, and from the line itself.
pub fn views(circle: &Circle) -> Vec<EyeView> {
    let tilted = |lat, lon, height, azimuth, pitch, fov| {
        let place = Geodetic::from_degrees(lat, lon, height);
        common::tilted(place, azimuth, pitch, fov, aspect())
    };
    let on_it = circle.as_seen_now(0.0);
    let ahead = circle.as_seen_now(-0.1) - on_it;
    vec![
        tilted(20.0, 0.0, 4e7, 0.0, -90.0, 25.0),
        tilted(-35.0, 100.0, 9e6, 30.0, -80.0, 60.0),
        tilted(10.0, -60.0, 4e5, 90.0, -15.0, 70.0),
        tilted(89.0, 0.0, 2e7, 0.0, -88.0, 50.0),
        tilted(0.0, 45.0, 3e3, 10.0, 20.0, 90.0),
        EyeView::itrf(on_it, ahead, on_it, 1.2, aspect()),
        EyeView::itrf(on_it * 1.01, ahead - on_it, on_it, 2.0, aspect()),
    ]
}
