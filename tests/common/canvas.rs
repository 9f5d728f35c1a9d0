//! Common code of the picture tests: one device for the process, synthetic maps, and a drawn image in one call.

use glam::DVec3;
use image::RgbaImage;
use std::sync::OnceLock;
use std::time::Duration;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    Earth, EarthOptions, EyeView, FrameRequest, FrameStats, FrameTargets, GpuContext, Quality, Sky,
};
use terrella_imagery::tile::TileKey;
use terrella_imagery::{EarthLayers, LayerImage};

/// The device that all tests of a process draw with: a software adapter if there is one, for the same pictures
/// everywhere, else the best. `TERRELLA_TEST_ADAPTER` names another.
pub fn gpu() -> &'static GpuContext {
    static GPU: OnceLock<GpuContext> = OnceLock::new();
    GPU.get_or_init(|| {
        let named = std::env::var("TERRELLA_TEST_ADAPTER").ok();
        let open = |name| pollster::block_on(GpuContext::open(name));
        let context = match named.as_deref() {
            Some(name) => open(Some(name)),
            None => open(Some("llvmpipe")).or_else(|_| open(None)),
        };
        let context = context
            .expect("picture tests need an adapter: `cargo xtask test` installs a software one");
        // A test must only make valid requests to the device.
        let handler = |error: wgpu::Error| panic!("{error}");
        context
            .device
            .on_uncaptured_error(std::sync::Arc::new(handler));
        context
    })
}

/// A map that is a function of latitude and longitude, degrees, sampled at texel centres.
pub fn map(width: u32, f: impl Fn(f64, f64) -> [u8; 3]) -> LayerImage {
    let height = width / 2;
    let mut texels = Vec::with_capacity((4 * width * height) as usize);
    for y in 0..height {
        for x in 0..width {
            let lat = 90.0 - (f64::from(y) + 0.5) * 180.0 / f64::from(height);
            let lon = -180.0 + (f64::from(x) + 0.5) * 360.0 / f64::from(width);
            texels.extend(f(lat, lon));
            texels.push(255);
        }
    }
    LayerImage::from_rgba8(width, height, texels).expect("a sound map")
}

/// A day map and nothing else.
pub fn day_only(day: LayerImage) -> EarthLayers {
    EarthLayers {
        day,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    }
}

/// Maps of one plain colour and nothing else.
pub fn plain(color: [u8; 3]) -> EarthLayers {
    day_only(map(64, |_, _| color))
}

/// Ground in waves of 2000 m, drawn by this surface.
pub fn waves(kind: terrella::SurfaceKind) -> terrella::GroundOptions {
    use terrella_ground::elevation::{Bounds, Elevation, HeightRange};
    struct Waves;
    impl Elevation for Waves {
        fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
            2000.0 * (90.0 * lat_rad).sin() * (60.0 * lon_rad).cos()
        }
        fn range_m(&self, _: &Bounds) -> HeightRange {
            HeightRange {
                low_m: -2000.0,
                high_m: 2000.0,
            }
        }
        fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
            1e-3
        }
    }
    terrella::GroundOptions {
        elevation: std::sync::Arc::new(Waves),
        surface: kind.settings(terrella::Subdivision::Auto),
        tolerance_px: 0.5,
    }
}

/// An Earth with its own targets.
pub struct Rig {
    pub earth: Earth,
    targets: FrameTargets,
    size: (u32, u32),
}

/// An Earth that makes the pipelines that its few pictures need.
fn when_needed(options: &EarthOptions) -> Earth {
    let gpu = gpu();
    let options = EarthOptions {
        pipelines: terrella::Pipelines::WhenNeeded,
        ..options.clone()
    };
    Earth::new(&gpu.device, &gpu.queue, &options).expect("sound options")
}

impl Rig {
    pub fn new(options: &EarthOptions, size: (u32, u32)) -> Self {
        let gpu = gpu();
        let earth = when_needed(options);
        Self {
            earth,
            targets: FrameTargets::new(&gpu.device, size, options.samples),
            size,
        }
    }

    /// The same with a target of light.
    pub fn of_light(options: &EarthOptions, size: (u32, u32)) -> Self {
        let gpu = gpu();
        Self::with_color(
            &EarthOptions {
                color_format: gpu.float_format(),
                ..options.clone()
            },
            size,
        )
    }

    /// The same with pipelines that are created when the options say.
    pub fn with_pipelines(options: &EarthOptions, size: (u32, u32)) -> Self {
        let gpu = gpu();
        let earth = Earth::new(&gpu.device, &gpu.queue, options).expect("sound options");
        Self {
            earth,
            ..Self::with_color(options, size)
        }
    }

    /// The same with a target of the options' own format.
    pub fn with_color(options: &EarthOptions, size: (u32, u32)) -> Self {
        let gpu = gpu();
        let (format, samples) = (options.color_format, options.samples);
        let earth = when_needed(options);
        Self {
            earth,
            targets: FrameTargets::with_color(&gpu.device, format, size, samples),
            size,
        }
    }

    /// Draws better or worse from now on, into textures that fit.
    pub fn set_quality(&mut self, quality: &Quality) {
        let gpu = gpu();
        let changed = self.earth.set_quality(&gpu.queue, quality);
        changed.expect("a sound quality");
        self.targets = FrameTargets::new(&gpu.device, self.size, quality.samples);
    }

    pub fn aspect(&self) -> f64 {
        f64::from(self.size.0) / f64::from(self.size.1)
    }

    pub fn draw(&mut self, view: &EyeView, sun_itrf: DVec3) -> (RgbaImage, FrameStats) {
        self.draw_of(view, &Sky::new(sun_itrf))
    }

    /// The same under any sky.
    pub fn draw_of(&mut self, view: &EyeView, sky: &Sky) -> (RgbaImage, FrameStats) {
        let stats = self
            .earth
            .prepare(&gpu().queue, FrameRequest::new(view, sky, self.size));
        (self.picture(), stats)
    }

    /// Draws light: of a rig that is made for it.
    pub fn draw_light(&mut self, view: &EyeView, sun_itrf: DVec3) -> Vec<[f32; 4]> {
        self.draw_light_of(view, &Sky::new(sun_itrf))
    }

    /// The same under any sky.
    pub fn draw_light_of(&mut self, view: &EyeView, sky: &Sky) -> Vec<[f32; 4]> {
        self.earth
            .prepare(&gpu().queue, FrameRequest::new(view, sky, self.size));
        self.submit();
        let light = self.targets.read_light(&gpu().device, &gpu().queue);
        light.expect("a picture")
    }

    /// The same at night, with the sky.
    pub fn draw_light_with(
        &mut self,
        behind: &mut terrella::celestial::Celestial,
        moment: &terrella::celestial::CelestialMoment<'_>,
    ) -> Vec<[f32; 4]> {
        let gpu = gpu();
        let night = Sky::new(moment.view.to_itrf().0.normalize_or(DVec3::X) * -1.0);
        self.earth.prepare(
            &gpu.queue,
            FrameRequest::new(moment.view, &night, self.size),
        );
        behind.prepare(&gpu.queue, &self.earth, moment);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut pass = self.targets.begin_pass(&mut encoder);
        self.earth.render(&mut pass);
        behind.render(&mut pass);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        let light = self.targets.read_light(&gpu.device, &gpu.queue);
        light.expect("a picture")
    }

    /// Draws once all tiles have come and the ground is as fine as it will be; returns the tiles that cannot come.
    /// The timeout is for faults: a busy machine takes many times longer than a quiet one.
    pub fn draw_complete(
        &mut self,
        view: &EyeView,
        sun_itrf: DVec3,
    ) -> (RgbaImage, FrameStats, Vec<TileKey>) {
        let (sky, wait) = (Sky::new(sun_itrf), Duration::from_secs(180));
        let (stats, missing) = self.earth.prepare_complete(
            &gpu().queue,
            FrameRequest::new(view, &sky, self.size),
            wait,
        );
        assert!(self.earth.is_settled(), "no end within {wait:?}");
        (self.picture(), stats, missing)
    }

    fn picture(&mut self) -> RgbaImage {
        self.submit();
        let gpu = gpu();
        let texels = self.targets.read_back(&gpu.device, &gpu.queue);
        let (width, height) = self.size;
        RgbaImage::from_raw(width, height, texels.expect("a picture")).expect("of that size")
    }

    fn submit(&mut self) {
        let gpu = gpu();
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.earth
            .render(&mut self.targets.begin_pass(&mut encoder));
        gpu.queue.submit([encoder.finish()]);
    }
}

/// An eye above a place that looks down, north up.
pub fn down(place: Geodetic, fov_deg: f64, aspect: f64) -> EyeView {
    tilted(place, 0.0, -90.0, fov_deg, aspect)
}

/// An eye above a place that looks towards `azimuth_deg` from north, `pitch_deg` above the horizontal.
pub fn tilted(
    place: Geodetic,
    azimuth_deg: f64,
    pitch_deg: f64,
    fov_deg: f64,
    aspect: f64,
) -> EyeView {
    let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
    let up = Ellipsoid::normal(place.lat_rad, place.lon_rad);
    let east = DVec3::new(-place.lon_rad.sin(), place.lon_rad.cos(), 0.0);
    let north = up.cross(east);
    let (azimuth, pitch) = (azimuth_deg.to_radians(), pitch_deg.to_radians());
    let flat = north * azimuth.cos() + east * azimuth.sin();
    let forward = flat * pitch.cos() + up * pitch.sin();
    let upwards = up * pitch.cos() - flat * pitch.sin();
    EyeView::itrf(eye, forward, upwards, fov_deg.to_radians(), aspect)
}

/// The exact place that a pixel's centre looks at on the ellipsoid, in f64; `None` where it misses.
pub fn looks_at(view: &EyeView, x: u32, y: u32, size: (u32, u32)) -> Option<Geodetic> {
    let direction = ray(view, x, y, size);
    let scale = Ellipsoid::WGS84.scaled_from_itrf();
    let (e, d) = (view.eye_world * scale, direction * scale);
    let (a, half_b, c) = (
        d.length_squared(),
        e.dot(d),
        (e.length() - 1.0) * (e.length() + 1.0),
    );
    // Discriminant by Lagrange's identity: no cancellation at the limb.
    let disc = a - e.cross(d).length_squared();
    if disc < 0.0 || half_b >= 0.0 {
        return None;
    }
    let t = c / (-half_b + disc.sqrt());
    Some(Ellipsoid::WGS84.geodetic_from_itrf(view.eye_world + direction * t))
}

/// Unit direction of a pixel's centre, ITRF axes.
pub fn ray(view: &EyeView, x: u32, y: u32, size: (u32, u32)) -> DVec3 {
    let ndc_x = 2.0 * (f64::from(x) + 0.5) / f64::from(size.0) - 1.0;
    let ndc_y = 1.0 - 2.0 * (f64::from(y) + 0.5) / f64::from(size.1);
    let p = view.clip_from_view;
    let in_view = DVec3::new(ndc_x / p.x_axis.x, ndc_y / p.y_axis.y, -1.0);
    (view.view_from_world.inverse() * in_view).normalize()
}
