//! The native host: Terrella on its own device, without Bevy.

use crate::headless::Picture;
use bevy::render::render_resource::TextureFormat;
use bevy_terrella::EarthTrack;
use std::sync::{Arc, OnceLock};
use terrella::celestial::{Celestial, CelestialMoment, CelestialOptions};
use terrella::frames::Orientation;
use terrella::orbit::Feed;
use terrella::tracks::{Polylines, Station, TrackMoment, Tracks, TracksOptions};
use terrella::{
    Earth, EarthLayers, EarthOptions, Exposure, EyeView, FrameRequest, FrameTargets,
    LayerSelection, Sky, SurfaceLight, find_textures, load_layers, wgpu,
};

/// The starter maps, read once.
pub fn maps() -> Arc<EarthLayers> {
    static MAPS: OnceLock<Arc<EarthLayers>> = OnceLock::new();
    let load = || {
        let folder = find_textures().expect("the starter maps");
        Arc::new(load_layers(&folder, LayerSelection::default()).expect("whole maps"))
    };
    MAPS.get_or_init(load).clone()
}

/// Light without synthetic detail, which turns rounding of matrices into colour differences.
pub fn light() -> SurfaceLight {
    SurfaceLight {
        detail: false,
        ..SurfaceLight::DEFAULT
    }
}

/// Drawn objects besides the Earth.
#[derive(Default)]
pub struct Beside {
    pub celestial: Option<CelestialOptions>,
    pub tracks: Vec<EarthTrack>,
    pub stations: Vec<Station>,
    pub lines: Vec<Polylines>,
}

/// A program that draws with wgpu.
pub struct Native {
    pub device: wgpu::Device,
    pub queue: wgpu::Queue,
}

impl Native {
    /// Opens a device of the adapter that Bevy uses. Prints a message and returns `None` without an adapter, because nothing
    /// can be drawn then.
    pub fn open() -> Option<Self> {
        let instance =
            wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let adapter = pollster::block_on(instance.request_adapter(&wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        }));
        let Ok(adapter) = adapter else {
            eprintln!("SKIPPED: there is no graphics adapter; install a Vulkan driver");
            return None;
        };
        let opened = pollster::block_on(adapter.request_device(&wgpu::DeviceDescriptor {
            label: Some("terrella native host"),
            ..Default::default()
        }));
        let (device, queue) = opened.expect("a device of the adapter");
        Some(Self { device, queue })
    }

    /// An image as the program would draw it.
    pub fn draw(
        &self,
        key: (TextureFormat, u32),
        seen: (&EyeView, &Sky),
        size: (u32, u32),
        exposure: Exposure,
    ) -> Picture {
        self.draw_with(key, seen, size, exposure, &Beside::default())
    }

    /// The same with a sky and tracks.
    pub fn draw_with(
        &self,
        (format, samples): (TextureFormat, u32),
        (eye, sky): (&EyeView, &Sky),
        size: (u32, u32),
        exposure: Exposure,
        beside: &Beside,
    ) -> Picture {
        let (device, queue) = (&self.device, &self.queue);
        let mut earth = Earth::new(
            device,
            queue,
            &EarthOptions {
                color_format: format,
                samples,
                exposure,
                light: light(),
                ..EarthOptions::new(EarthLayers::clone(&maps()))
            },
        )
        .expect("an Earth");
        let targets = FrameTargets::with_color(device, format, size, samples);
        earth.prepare(queue, FrameRequest::new(eye, sky, size));
        let epoch = sky.epoch.expect("the instant of the sky");
        let orientation = Orientation::default();
        let celestial = beside.celestial.as_ref().map(|options| {
            let mut celestial =
                Celestial::new(device, queue, &earth, options).expect("a sound sky");
            let moment = CelestialMoment {
                epoch,
                orientation,
                view: eye,
                target: size.into(),
                velocity_m_s: None,
            };
            celestial.prepare(queue, &earth, &moment);
            celestial
        });
        let options = TracksOptions::of(&earth);
        let styles: Vec<_> = beside.tracks.iter().map(|track| track.style).collect();
        let mut tracks = Tracks::new(device, &options, &styles).expect("sound styles");
        tracks
            .set_stations(&beside.stations, 0)
            .expect("sound stations");
        tracks.set_lines(beside.lines.clone()).expect("sound lines");
        let moment = TrackMoment {
            epoch,
            orientation,
            turn: None,
            view: eye,
            target: size.into(),
        };
        let feeds = beside.tracks.iter().map(|track| &*track.feed as &dyn Feed);
        tracks.prepare_complete(queue, &moment, feeds);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("terrella native host"),
        });
        {
            let mut pass = targets.begin_pass(&mut encoder);
            earth.render_surface(&mut pass);
            earth.render_air(&mut pass);
            if let Some(celestial) = &celestial {
                celestial.render(&mut pass);
            }
            earth.render_clouds_overhead(&mut pass);
            tracks.render(&mut pass);
        }
        queue.submit([encoder.finish()]);
        let bytes = match format {
            TextureFormat::Rgba16Float => {
                let light = targets.read_light(device, queue).expect("a picture");
                light
                    .iter()
                    .flatten()
                    .flat_map(|l| l.to_le_bytes())
                    .collect()
            }
            _ => targets.read_back(device, queue).expect("a picture"),
        };
        Picture { size, bytes }
    }
}
