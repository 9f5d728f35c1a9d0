//! `prepare` and `render` allocate nothing themselves after the Earth is created.
//!
//! wgpu itself allocates when a buffer is written (a staging buffer a call) and when a pass is recorded; those calls are measured alone and
//! subtracted. This file is a separate process, so that nothing else counts.

mod common;

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use std::sync::{Mutex, MutexGuard, PoisonError};
use terrella::frames::Geodetic;
use terrella::{Earth, EarthOptions, FrameRequest, Sky};
use terrella_ground::elevation::{Bounds, Elevation, HeightRange};

struct Counting;

thread_local! {
    static COUNT: Cell<u64> = const { Cell::new(0) };
}

// SAFETY: every call is passed on unchanged to the system's allocator, which upholds the contract; the counter is a
// thread-local cell of a plain integer with a const initialiser, so that counting neither allocates nor unwinds.
#[allow(unsafe_code)]
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let _ = COUNT.try_with(|count| count.set(count.get() + 1));
        // SAFETY: as above.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        // SAFETY: as above.
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn allocations(mut work: impl FnMut()) -> u64 {
    let before = COUNT.with(Cell::get);
    work();
    COUNT.with(Cell::get) - before
}

/// Held by each test: they share a device, and submissions grow the pools that wgpu keeps for all.
fn alone() -> MutexGuard<'static, ()> {
    static ALONE: Mutex<()> = Mutex::new(());
    ALONE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Ground that is rough at every spacing.
struct Waves;
impl Elevation for Waves {
    fn height_m(&self, lat_rad: f64, lon_rad: f64, _: f64) -> f64 {
        500.0 * (300.0 * lat_rad).sin() * (200.0 * lon_rad).cos()
    }
    fn range_m(&self, _: &Bounds) -> HeightRange {
        HeightRange {
            low_m: -500.0,
            high_m: 500.0,
        }
    }
    fn finest_spacing_rad(&self, _: f64, _: f64) -> f64 {
        1e-5
    }
}

#[test]
fn prepare_allocates_nothing_of_its_own() {
    let _alone = alone();
    assert_eq!(
        allocations(|| drop(std::hint::black_box(vec![1_u8]))),
        1,
        "the counter must count"
    );
    let gpu = common::gpu();
    let mut earth = Earth::new(
        &gpu.device,
        &gpu.queue,
        &EarthOptions::new(common::plain([90, 90, 90])),
    )
    .unwrap();
    let view = |step: u32| {
        let place = Geodetic::from_degrees(
            40.0 - f64::from(step),
            3.0 * f64::from(step),
            4e5 * f64::from(step + 1),
        );
        common::tilted(place, 60.0, -30.0, 50.0, 1.6)
    };
    let sky = Sky::new(glam::DVec3::X);
    // wgpu's allocations for one frame's writes of the same sizes, measured separately.
    let write = |size: u64| {
        let label = Some("terrella test");
        let usage = wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST;
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label,
            size,
            usage,
            mapped_at_creation: false,
        });
        let bytes = vec![0_u8; size as usize];
        gpu.queue.write_buffer(&buffer, 0, &bytes);
        gpu.queue.submit([]);
        allocations(|| gpu.queue.write_buffer(&buffer, 0, &bytes))
    };
    let flush = || {
        gpu.queue.submit([]);
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .unwrap();
    };
    for step in 0..40 {
        earth.prepare(&gpu.queue, FrameRequest::new(&view(step), &sky, (640, 400)));
        flush();
    }
    // Five writes a frame: the frame, the vertices, cells that are not drawn alike, the air's frame and its ring.
    let most: u64 = [144, 60_000, 60_000, 208, 3_584]
        .into_iter()
        .map(|size| (0..8).map(|_| write(size)).max().unwrap())
        .sum();
    flush();
    let mut worst = 0;
    for step in 0..40 {
        worst = worst.max(allocations(|| {
            earth.prepare(&gpu.queue, FrameRequest::new(&view(step), &sky, (640, 400)));
        }));
        flush();
    }
    println!("{worst} allocations in prepare at most, {most} by wgpu's five writes alone");
    assert!(worst <= most, "{worst} allocations, {most} of them wgpu's");
}

/// Tracks of three satellites that fly on: curves grow at one end and end at the other, in the room that they have.
#[test]
fn tracks_allocate_nothing_of_their_own() {
    let _alone = alone();
    use std::time::{Duration, Instant};
    use terrella::frames::{Duration as Span, Ellipsoid, Orientation, utc_from_rfc3339};
    use terrella::tracks::{Footprint, TrackMoment, TrackSpan, TrackStyle, Tracks, TracksOptions};
    use terrella::tracks::{LineStyle, Polylines, Station};
    use terrella_orbit::{Feed, FieldOfView, Sgp4Feed};
    let gpu = common::gpu();
    let options = EarthOptions::new(common::plain([90, 90, 90]));
    let style = TrackStyle {
        trail: Some(TrackSpan::TRAIL),
        ground_track: Some(TrackSpan::GROUND_TRACK),
        footprint: Some(Footprint {
            field: Some(FieldOfView {
                off_nadir_rad: 0.3,
                ..FieldOfView::nadir(0.5)
            }),
            is_filled: true,
            has_edges: true,
            swath: Some(TrackSpan::GROUND_TRACK),
        }),
        subpoint: true,
        marker: true,
        ..TrackStyle::new(0)
    };
    let earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
    let mut tracks =
        Tracks::new(&gpu.device, &TracksOptions::of(&earth), &[style; 3]).expect("tracks");
    let lines = LineStyle::thin([255; 3], 0.3);
    let graticule = Polylines::graticule(lines, &Ellipsoid::WGS84, 10.0).expect("lines");
    tracks.set_lines(vec![graticule]).expect("lines");
    let station = Station {
        place: Geodetic::from_degrees(10.0, 20.0, 100.0),
        min_elevation_rad: 0.1,
        color: [255; 3],
        width_px: 2.0,
    };
    tracks.set_stations(&[station; 3], 0).expect("stations");
    let feeds = [(); 3].map(|()| Sgp4Feed::built_in_iss().expect("elements"));
    let start = utc_from_rfc3339("2018-01-19T00:30:00Z").expect("a date");
    let view = common::down(Geodetic::from_degrees(10.0, 20.0, 2e7), 50.0, 1.6);
    let flush = || {
        gpu.queue.submit([]);
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("a device");
    };
    let (mut frame, mut uploaded) = (0_u32, 0);
    let mut draw = |tracks: &mut Tracks| {
        frame += 1;
        let moment = TrackMoment {
            epoch: start + Span::from_seconds(2.0 * f64::from(frame)),
            orientation: Orientation::default(),
            turn: None,
            view: &view,
            target: (640, 400).into(),
        };
        let feeds = feeds.iter().map(|feed| feed as &dyn Feed);
        let stats = tracks.prepare(&gpu.queue, &moment, feeds);
        uploaded = stats.uploaded_bytes;
        stats
    };
    let first = draw(&mut tracks);
    assert!(!first.is_complete, "more states than one frame may ask for");
    for _ in 0..60 {
        draw(&mut tracks);
        flush();
    }
    let (mut worst, mut longest, mut whole) = (0, Duration::ZERO, Duration::ZERO);
    for _ in 0..200 {
        let begin = Instant::now();
        let mut complete = false;
        let count = allocations(|| complete = draw(&mut tracks).is_complete);
        let took = begin.elapsed();
        assert!(complete);
        (worst, longest, whole) = (worst.max(count), longest.max(took), whole + took);
        flush();
    }
    // Five writes: the frame, lines, marks, fills, polygons.
    let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("terrella test"),
        size: uploaded,
        usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    });
    let mut most = 0;
    for size in [160, uploaded - 800, 160, 144, 192] {
        let bytes = vec![0_u8; size as usize & !3];
        let write = || {
            let count = allocations(|| gpu.queue.write_buffer(&buffer, 0, &bytes));
            flush();
            count
        };
        most += (0..8).map(|_| write()).max().expect("eight");
    }
    println!(
        "{worst} allocations at most, {most} by wgpu's five writes; {uploaded} bytes; mean {:?}, longest {longest:?}",
        whole / 200
    );
    assert!(worst <= most, "{worst} allocations, {most} of them wgpu's");
}

#[test]
fn choosing_and_staging_allocate_nothing_at_all() {
    let _alone = alone();
    use terrella_ground::globe::{BlockGrid, Visibility, select_blocks};
    let grid = BlockGrid::new(terrella::frames::Ellipsoid::WGS84, 6).unwrap();
    let mut drawn = Vec::with_capacity(128);
    let count = allocations(|| {
        for step in 0..100 {
            let place = Geodetic::from_degrees(
                40.0 - f64::from(step),
                3.0 * f64::from(step),
                4e5 * f64::from(step + 1),
            );
            let (eye, clip_from_eye) = common::down(place, 50.0, 1.6).to_itrf();
            select_blocks(
                &grid,
                Visibility::Conservative,
                eye,
                &clip_from_eye,
                &mut drawn,
            );
            std::hint::black_box(&drawn);
        }
    });
    assert_eq!(count, 0);
}

#[test]
fn streaming_what_is_there_allocates_nothing_at_all() {
    let _alone = alone();
    use std::sync::Arc;
    use std::time::{Duration, Instant};
    use terrella_imagery::stream::{StreamOptions, TileRequest, TileStream};
    use terrella_imagery::tile::{
        BlockSet, LayerLayout, LevelLayout, MapLayer, Storage, Tile, TileError, TileKey, TileShape,
        TileSource,
    };
    struct Grey(Vec<LayerLayout>);
    impl TileSource for Grey {
        fn layers(&self) -> &[LayerLayout] {
            &self.0
        }
        fn read(&self, key: TileKey, _: &dyn Fn() -> bool) -> Result<Tile, TileError> {
            let layer = &self.0[key.layer.index()];
            let shape = layer.levels[usize::from(key.level)].shape;
            Ok(Tile {
                format: layer.format,
                shape,
                texels: vec![128; shape.bytes(layer.format)],
            })
        }
    }
    let layout = |layer: MapLayer| LayerLayout {
        layer,
        format: layer.tile_format(Storage::Plain),
        levels: [32, 24, 16]
            .map(|pixels| LevelLayout::of_blocks(TileShape::new(pixels).unwrap(), BlockSet::ALL))
            .to_vec(),
    };
    let source = Arc::new(Grey(MapLayer::ALL.map(layout).to_vec()));
    let mut stream = TileStream::new(source, &StreamOptions::default());
    // The most there is: every block of every map.
    let requests: Vec<_> = (0..128)
        .flat_map(|block| {
            MapLayer::ALL.map(|layer| TileRequest {
                key: TileKey {
                    layer,
                    level: block % 2,
                    block,
                    part: 0,
                },
                drawn: true,
            })
        })
        .collect();
    let start = Instant::now();
    while stream.counters().hits < 640 {
        stream.update(Instant::now(), &requests);
        for request in &requests {
            stream.draw(request.key.layer, request.key.block);
        }
        stream.upload(u64::MAX, &mut |_| {});
        stream.wait(Duration::from_millis(1));
        assert!(
            start.elapsed() < Duration::from_secs(60),
            "{:?}",
            stream.counters()
        );
    }
    let mut best = Duration::MAX;
    let count = allocations(|| {
        for _ in 0..100 {
            let start = Instant::now();
            stream.update(start, &requests);
            for request in &requests {
                std::hint::black_box(stream.draw(request.key.layer, request.key.block));
            }
            stream.upload(8 << 20, &mut |_| {});
            assert_eq!(std::hint::black_box(stream.counters()).hits, 640);
            assert_eq!(stream.missing().count(), 0);
            best = best.min(start.elapsed());
        }
    });
    println!("{best:?} for a frame of {} requests", requests.len());
    assert_eq!(count, 0);
    assert!(best < Duration::from_millis(1), "{best:?}");
}

#[test]
fn a_view_at_rest_with_all_its_tiles_allocates_nothing_of_its_own() {
    let _alone = alone();
    let gpu = common::gpu();
    let tiles = std::sync::Arc::new(common::tiles::FunctionTiles::new(&[64, 32], |lat, lon| {
        [lat as u8, lon as u8, 100]
    }));
    let mut options = EarthOptions::new(common::plain([90, 90, 90]));
    options.layers.day = tiles.whole(1);
    let mut without = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
    options.tiles = Some(terrella::TileOptions::new(tiles));
    let mut with = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
    let view = common::down(Geodetic::from_degrees(20.0, 30.0, 3e6), 50.0, 1.6);
    let sky = Sky::new(view.eye_world.normalize());
    let wait = std::time::Duration::from_secs(10);
    let (stats, missing) =
        with.prepare_complete(&gpu.queue, FrameRequest::new(&view, &sky, (640, 400)), wait);
    assert!(missing.is_empty() && stats.tiles.hits > 0);
    let worst_of = |earth: &mut Earth| {
        let mut worst = 0;
        for round in 0..40 {
            let count = allocations(|| {
                earth.prepare(&gpu.queue, FrameRequest::new(&view, &sky, (640, 400)));
            });
            // The first rounds fill wgpu's own pools.
            worst = if round < 20 { 0 } else { worst.max(count) };
            gpu.queue.submit([]);
            gpu.device
                .poll(wgpu::PollType::wait_indefinitely())
                .expect("the device answers");
        }
        worst
    };
    let (whole, tiled) = (worst_of(&mut without), worst_of(&mut with));
    println!("{tiled} allocations with tiles, {whole} without");
    assert!(
        tiled <= whole,
        "{tiled} allocations with tiles, {whole} without"
    );
}

#[test]
fn a_projected_grid_allocates_nothing() {
    let _alone = alone();
    use terrella_ground::globe::projected_grid::{
        GridOptions, GridUniforms, HeightTiles, ProjectedGrid,
    };
    use terrella_ground::globe::{GroundView, Surface};

    let mut grid = ProjectedGrid::new(&GridOptions::on_cpu());
    let mut tiles = HeightTiles::new(256);
    let mut drawn = 0;
    let count = allocations(|| {
        for step in 0..40 {
            let height_m = 4e5 * 0.87_f64.powi(step);
            let place = Geodetic::from_degrees(47.0, 0.2 * f64::from(step), height_m + 500.0);
            let tilted = common::tilted(place, 30.0, -40.0, 45.0, 16.0 / 9.0);
            let (eye_itrf_m, clip_from_eye) = tilted.to_itrf();
            let view = GroundView {
                eye_itrf_m,
                clip_from_eye,
                pixel_rad: 1e-3,
                tolerance_px: 1.0,
            };
            grid.prepare(&view, &Waves);
            grid.for_each_patch(&mut |patch| drawn += patch.vertices.len());
            if let Some(frame) = grid.aim(&view, &Waves) {
                tiles.update(&frame, &Waves, 4);
                std::hint::black_box(GridUniforms::new(&frame, &tiles));
            }
        }
    });
    assert_eq!((count, drawn), (0, 40 * 129 * 129));
}

#[test]
fn a_grid_of_the_gpu_allocates_nothing_of_its_own() {
    let _alone = alone();
    use terrella_ground::globe::projected_grid::{
        GPU_LOADS, GridOptions, GridUniforms, TILE_SAMPLES,
    };

    let gpu = common::gpu();
    let mut options = EarthOptions::new(common::plain([90, 90, 90]));
    options.atmosphere = terrella::Atmosphere::None;
    options.ground = Some(terrella::GroundOptions {
        elevation: std::sync::Arc::new(Waves),
        surface: terrella::SurfaceSettings::ProjectedGrid(GridOptions::default()),
        tolerance_px: 1.0,
    });
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
    let sky = Sky::new(glam::DVec3::X);
    let flush = || {
        gpu.queue.submit([]);
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device answers");
    };
    // wgpu's allocations for the writes of a frame that uploads as many tiles as allowed.
    let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("terrella test"),
        size: wgpu::Extent3d {
            width: TILE_SAMPLES,
            height: TILE_SAMPLES,
            depth_or_array_layers: 1,
        },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::R32Float,
        usage: wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let heights = vec![0_u8; 4 * (TILE_SAMPLES * TILE_SAMPLES) as usize];
    let write_tile = || {
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * TILE_SAMPLES),
            rows_per_image: None,
        };
        let to = texture.as_image_copy();
        gpu.queue
            .write_texture(to, &heights, layout, texture.size());
    };
    let write = |size: usize| {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella test"),
            size: size as u64,
            usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bytes = vec![0_u8; size];
        gpu.queue.write_buffer(&buffer, 0, &bytes);
        flush();
        allocations(|| gpu.queue.write_buffer(&buffer, 0, &bytes))
    };
    let sizes = [
        size_of::<terrella::internals::plan::FrameUniforms>(),
        size_of::<GridUniforms>(),
    ];
    let uniforms: u64 = sizes
        .map(|size| (0..8).map(|_| write(size)).max())
        .iter()
        .flatten()
        .sum();
    let tile = (0..8).map(|_| {
        write_tile();
        flush();
        allocations(write_tile)
    });
    let most = uniforms + u64::from(GPU_LOADS) * tile.max().unwrap_or(0);
    let (mut worst, mut loads) = (0, 0);
    for step in 0..160 {
        let height_m = 4e5 * 0.965_f64.powi(step);
        let place = Geodetic::from_degrees(47.0, 0.01 * f64::from(step), height_m + 500.0);
        let view = common::tilted(place, 30.0, -40.0, 45.0, 1.6);
        let mut stats = terrella::FrameStats::default();
        let count = allocations(|| {
            stats = earth.prepare(&gpu.queue, FrameRequest::new(&view, &sky, (640, 400)))
        });
        flush();
        let loaded = stats.ground.samples_read / u64::from(TILE_SAMPLES * TILE_SAMPLES);
        // The first rounds fill wgpu's own pools.
        if step >= 20 && loaded <= u64::from(GPU_LOADS) {
            (worst, loads) = (worst.max(count), loads + loaded);
        }
    }
    println!(
        "{worst} allocations in prepare at most, {most} by wgpu's writes alone; {loads} tiles"
    );
    assert!(loads > 50, "{loads}");
    assert!(worst <= most, "{worst} allocations, {most} of them wgpu's");
}

/// Without a new page nothing is allocated; a view at rest builds none.
#[test]
fn pages_of_contours_allocate_nothing_once_they_are_built() {
    let _alone = alone();
    use terrella_ground::globe::contours::{ContourPages, PageOptions};
    use terrella_ground::globe::{GroundView, Surface};

    let view = |step: u32| {
        let place = Geodetic::from_degrees(47.0, 2e-4 * f64::from(step), 2e4);
        common::tilted(place, 90.0, -40.0, 45.0, 16.0 / 9.0)
    };
    let mut pages = ContourPages::new(PageOptions::default());
    let (mut still, mut drawn) = (0, 0);
    for step in 0..600 {
        let (eye_itrf_m, clip_from_eye) = view(step / 2).to_itrf();
        let view = GroundView {
            eye_itrf_m,
            clip_from_eye,
            pixel_rad: 1e-3,
            tolerance_px: 1.0,
        };
        let mut stats = terrella_ground::globe::SurfaceStats::default();
        let count = allocations(|| stats = pages.prepare(&view, &Waves));
        if stats.samples_read == 0 {
            assert_eq!(count, 0, "step {step}");
            still += 1;
            drawn = drawn.max(stats.patches);
        }
    }
    println!("{still} of 600 frames built nothing, {drawn} pages");
    assert!(still > 300 && drawn > 20);

    // The same on the GPU, except wgpu's allocations for three writes.
    let gpu = common::gpu();
    let mut options = EarthOptions::new(common::plain([90, 90, 90]));
    options.atmosphere = terrella::Atmosphere::None;
    options.ground = Some(terrella::GroundOptions {
        elevation: std::sync::Arc::new(Waves),
        surface: terrella::SurfaceSettings::CastContours(PageOptions::default()),
        tolerance_px: 1.0,
    });
    let mut earth = Earth::new(&gpu.device, &gpu.queue, &options).expect("an Earth");
    let sky = Sky::new(glam::DVec3::X);
    let wait = std::time::Duration::from_secs(60);
    let (stats, _) = earth.prepare_complete(
        &gpu.queue,
        FrameRequest::new(&view(0), &sky, (640, 400)),
        wait,
    );
    assert!(stats.ground.patches > 10);
    let flush = || {
        gpu.queue.submit([]);
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .expect("the device answers");
    };
    let write = |size: usize| {
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("terrella test"),
            size: size as u64,
            usage: wgpu::BufferUsages::VERTEX | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let bytes = vec![0_u8; size];
        let once = || {
            let count = allocations(|| gpu.queue.write_buffer(&buffer, 0, &bytes));
            flush();
            count
        };
        (0..8).map(|_| once()).max().expect("eight")
    };
    let pages = stats.ground.patches as usize;
    let most: u64 = [
        size_of::<terrella::internals::plan::FrameUniforms>(),
        96 * pages,
        56 * pages,
    ]
    .map(write)
    .iter()
    .sum();
    let mut worst = 0;
    for round in 0..40 {
        let count = allocations(|| {
            earth.prepare(&gpu.queue, FrameRequest::new(&view(0), &sky, (640, 400)));
        });
        flush();
        // The first rounds fill wgpu's own pools.
        worst = if round < 20 { 0 } else { worst.max(count) };
    }
    println!("{worst} allocations in prepare at most, {most} by wgpu's three writes");
    assert!(worst <= most, "{worst} allocations, {most} of them wgpu's");
}
