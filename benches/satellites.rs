//! Many satellites in parallel: SGP4 on both cores, and states between samples. Target: 10 000 satellites a second.

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;
use std::path::Path;
use std::sync::Arc;
use terrella_frames::{Duration, Epoch};
use terrella_orbit::interpolated::{InterpolatedStates, Interpolation, KeplerOrbit, StateSample};
use terrella_orbit::{Feed, Frame, Sgp4Feed};

const SATELLITES: u64 = 10_000;

/// Satellites spread over low orbits, and every fifth one over orbits of half a day, which cost SGP4 the most.
fn satellites() -> Vec<Sgp4Feed> {
    let iss = Sgp4Feed::built_in_iss().expect("as released");
    let origin: Arc<Path> = Arc::from(Path::new("bench"));
    (0..SATELLITES)
        .map(|k| {
            let mut elements = iss.elements().clone();
            let x = k as f64;
            elements.catalogue_number = k;
            elements.raan_deg = x * 0.7 % 360.0;
            elements.mean_anomaly_deg = x * 1.3 % 360.0;
            elements.inclination_deg = 20.0 + x * 0.9 % 140.0;
            if k % 5 == 0 {
                elements.mean_motion_rev_day = 2.006;
                elements.eccentricity = 0.7;
            }
            Sgp4Feed::from_elements(elements, Arc::clone(&origin), 1).expect("flies")
        })
        .collect()
}

fn propagate(feeds: &[Sgp4Feed], epoch: Epoch) -> usize {
    let states = feeds.iter().map(|feed| feed.state_at(epoch));
    states.filter(|state| black_box(state).is_ok()).count()
}

fn satellites_a_second(criterion: &mut Criterion) {
    let feeds = satellites();
    let epoch = feeds[0].epoch() + Duration::from_days(3.0);
    assert_eq!(propagate(&feeds, epoch), feeds.len());
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let mut group = criterion.benchmark_group("10 000 satellites");
    group.throughput(Throughput::Elements(SATELLITES));
    group.bench_function("one core", |b| b.iter(|| propagate(&feeds, epoch)));
    group.bench_function(format!("{cores} cores"), |b| {
        b.iter(|| {
            std::thread::scope(|scope| {
                for part in feeds.chunks(feeds.len().div_ceil(cores)) {
                    scope.spawn(move || propagate(part, epoch));
                }
            });
        });
    });
    group.bench_function("from their elements", |b| b.iter(satellites));
    group.finish();
}

fn between_samples(criterion: &mut Criterion) {
    let start = Epoch::from_tai_seconds(3e9);
    let samples: Vec<_> = (0..1440)
        .map(|minute| {
            let t_s = f64::from(minute) * 60.0;
            let (position_m, velocity_m_s) = KeplerOrbit::LOW.state(t_s);
            StateSample {
                epoch: start + Duration::from_seconds(t_s),
                position_m,
                velocity_m_s: Some(velocity_m_s),
            }
        })
        .collect();
    for interpolation in [
        Interpolation::Lagrange { degree: 5 },
        Interpolation::WITH_VELOCITIES,
        Interpolation::Lagrange { degree: 27 },
    ] {
        let ephemeris = InterpolatedStates::new(Frame::Gcrf, &samples, interpolation)
            .expect("samples of a good orbit");
        let name = format!("{} {}", interpolation.name(), interpolation.degree());
        let epoch = start + Duration::from_seconds(40_012.3);
        criterion.bench_function(&name, |b| b.iter(|| ephemeris.state_at(black_box(epoch))));
    }
}

criterion_group!(benches, satellites_a_second, between_samples);
criterion_main!(benches);
