//! Cost of further views of one Earth: a frame of one view compared with a frame of four of the same size, interleaved, and their memory. Target:
//! four views cost at most four times one.
//!
//! `cargo bench --bench views`

use std::time::Instant;
use terrella::frames::{Ellipsoid, Geodetic};
use terrella::{
    Earth, EarthOptions, EarthView, EyeView, FrameRequest, FrameTargets, GpuContext,
    LayerSelection, Sky, ViewFrame, Viewport, find_textures, load_layers,
};

const SIZE: (u32, u32) = (640, 360);
const ROUNDS: usize = 40;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let gpu = pollster::block_on(GpuContext::open(None))?;
    let layers = load_layers(&find_textures()?, LayerSelection::default())?;
    let options = EarthOptions::new(layers);
    let begin = Instant::now();
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options)?;
    let made_ms = begin.elapsed().as_secs_f64() * 1e3;
    let begin = Instant::now();
    let mut views = [earth.new_view()?, earth.new_view()?, earth.new_view()?];
    let view_ms = begin.elapsed().as_secs_f64() * 1e3 / views.len() as f64;
    let targets = [(); 4].map(|()| FrameTargets::new(&gpu.device, SIZE, 1));
    let sky = Sky::new(glam::DVec3::new(0.8, 0.55, 0.25).normalize());
    // Four eyes that see about as much: only the number of views differs.
    let eyes = [0.0, 5.0, 10.0, 15.0].map(|lon_deg| {
        let place = Geodetic::from_degrees(10.0, lon_deg, 4e5);
        let eye = Ellipsoid::WGS84.itrf_from_geodetic(place);
        EyeView::itrf(eye, -eye, glam::DVec3::Z, 1.0, 16.0 / 9.0)
    });
    let mut frame = |views: &mut [EarthView]| {
        let begin = Instant::now();
        let mut others: Vec<_> = views
            .iter_mut()
            .zip(&eyes[1..])
            .map(|(view, eye)| ViewFrame {
                view,
                eye,
                sky: &sky,
                target: Viewport::from(SIZE),
            })
            .collect();
        earth.prepare(
            &gpu.queue,
            FrameRequest::new(&eyes[0], &sky, SIZE).with_views(&mut others),
        );
        let mut encoder = gpu.device.create_command_encoder(&Default::default());
        earth.render(&mut targets[0].begin_pass(&mut encoder));
        for (view, target) in views.iter().zip(&targets[1..]) {
            earth.render_view(view, &mut target.begin_pass(&mut encoder));
        }
        gpu.queue.submit([encoder.finish()]);
        let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        waited.expect("the device answers");
        begin.elapsed().as_secs_f64() * 1e3
    };
    let mut ratios = Vec::new();
    let (mut ones, mut fours) = (Vec::new(), Vec::new());
    for round in 0..ROUNDS + 4 {
        let (one, four) = (frame(&mut []), frame(&mut views));
        if round >= 4 {
            ratios.push(four / one);
            ones.push(one);
            fours.push(four);
        }
    }
    let of = |values: &mut Vec<f64>, part: f64| {
        values.sort_by(f64::total_cmp);
        values[(part * (values.len() - 1) as f64).round() as usize]
    };
    println!("{}", gpu.adapter.get_info().name);
    println!("an Earth is made in {made_ms:.0} ms, a further view in {view_ms:.1} ms");
    println!(
        "one view {:.2} ms, four views {:.2} ms, medians of {ROUNDS} frames interleaved, {} × {}",
        of(&mut ones, 0.5),
        of(&mut fours, 0.5),
        SIZE.0,
        SIZE.1
    );
    println!(
        "four over one {:.2}, quartiles {:.2} to {:.2}",
        of(&mut ratios, 0.5),
        of(&mut ratios, 0.25),
        of(&mut ratios, 0.75)
    );
    Ok(())
}
