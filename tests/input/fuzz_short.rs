//! The bodies of the fuzz targets of `fuzz/`, for a second or two each: the same mutated inputs every time.

use std::path::Path;

#[path = "../../fuzz/bodies/basilisk.rs"]
mod basilisk;
#[path = "../../fuzz/bodies/earth_orientation.rs"]
mod earth_orientation;
#[path = "../../fuzz/bodies/ephemeris.rs"]
mod ephemeris;
#[path = "../../fuzz/bodies/fetch_source.rs"]
mod fetch_source;
#[path = "../../fuzz/bodies/heights.rs"]
mod heights;
#[path = "../../fuzz/bodies/live.rs"]
mod live;
#[path = "../../fuzz/bodies/manifest.rs"]
mod manifest;
#[path = "../../fuzz/bodies/mosaic.rs"]
mod mosaic;
#[path = "../../fuzz/bodies/omm.rs"]
mod omm;
#[path = "../../fuzz/bodies/opm.rs"]
mod opm;
#[path = "../../fuzz/bodies/pack_heights.rs"]
mod pack_heights;
#[path = "../../fuzz/bodies/response.rs"]
mod response;
#[path = "../../fuzz/bodies/scene.rs"]
mod scene;
#[path = "../../fuzz/bodies/sidecar.rs"]
mod sidecar;
#[path = "../../fuzz/bodies/source.rs"]
mod source;
#[path = "../../fuzz/bodies/tile.rs"]
mod tile;
#[path = "../../fuzz/bodies/tle.rs"]
mod tle;

/// Name, seeds, body, and how many inputs are tried.
pub type Target = (&'static str, fn() -> Vec<Vec<u8>>, fn(&[u8]), u32);

pub const TARGETS: &[Target] = &[
    ("manifest", manifest::seeds, manifest::run, 10_000),
    ("tile", tile::seeds, tile::run, 100_000),
    (
        "pack_heights",
        pack_heights::seeds,
        pack_heights::run,
        30_000,
    ),
    ("scene", scene::seeds, scene::run, 100_000),
    ("tle", tle::seeds, tle::run, 200_000),
    ("omm", omm::seeds, omm::run, 30_000),
    ("opm", opm::seeds, opm::run, 30_000),
    ("ephemeris", ephemeris::seeds, ephemeris::run, 30_000),
    ("response", response::seeds, response::run, 30_000),
    ("live", live::seeds, live::run, 200_000),
    ("basilisk", basilisk::seeds, basilisk::run, 30_000),
    (
        "earth_orientation",
        earth_orientation::seeds,
        earth_orientation::run,
        30_000,
    ),
    ("source", source::seeds, source::run, 30_000),
    ("mosaic", mosaic::seeds, mosaic::run, 100_000),
    (
        "fetch_source",
        fetch_source::seeds,
        fetch_source::run,
        30_000,
    ),
    ("heights", heights::seeds, heights::run, 30_000),
    ("sidecar", sidecar::seeds, sidecar::run, 30_000),
];

/// Marsaglia's xorshift: the same numbers on every machine.
pub struct Random(pub u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number below `end`; 0 for 0.
    pub fn below(&mut self, end: usize) -> usize {
        (self.next() % end.max(1) as u64) as usize
    }
}

/// Changes an input in one of the ways in which fuzzers do; `other` gives pieces to put in.
fn mutate(input: &mut Vec<u8>, other: &[u8], random: &mut Random) {
    const WORDS: [&[u8]; 12] = [
        b"\0",
        b"\xff\xff\xff\xff",
        b"\xff\xff\xff\x7f",
        b"-1",
        b"nan",
        b"1e999",
        b"\"",
        b"[[",
        b"\n",
        b"9999999999",
        b"../",
        "\u{202e}é".as_bytes(),
    ];
    let at = random.below(input.len());
    let len = 1 + random.below(24);
    match random.below(7) {
        0 if !input.is_empty() => input[at] ^= 1 << random.below(8),
        1 if !input.is_empty() => input[at] = random.next() as u8,
        2 => input.truncate(at),
        3 => drop(input.drain(at..(at + len).min(input.len()))),
        4 => {
            let word = WORDS[random.below(WORDS.len())];
            input.splice(at..at, word.iter().copied());
        }
        5 => {
            let word = WORDS[random.below(WORDS.len())];
            let end = (at + word.len()).min(input.len());
            input.splice(at..end, word.iter().copied());
        }
        _ => {
            let from = random.below(other.len());
            let piece = &other[from..(from + len * 4).min(other.len())];
            input.splice(at..at, piece.iter().copied());
        }
    }
}

fn run(target: &str) {
    let (_, seeds, body, inputs) = *TARGETS.iter().find(|t| t.0 == target).expect("a target");
    let seeds = seeds();
    for seed in &seeds {
        body(seed);
    }
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    for _ in 0..inputs {
        body(&mutated(&seeds, &mut random));
    }
}

/// One of the inputs, changed in some ways.
pub fn mutated(seeds: &[Vec<u8>], random: &mut Random) -> Vec<u8> {
    let mut input = seeds[random.below(seeds.len())].clone();
    for _ in 0..=random.below(4) {
        let other = &seeds[random.below(seeds.len())];
        mutate(&mut input, other, random);
    }
    input
}

#[test]
fn manifests() {
    run("manifest");
}

#[test]
fn tiles() {
    run("tile");
}

#[test]
fn heights_of_packs() {
    run("pack_heights");
}

#[test]
fn scenes() {
    run("scene");
}

#[test]
fn maps() {
    run("source");
}

#[test]
fn mosaics_and_world_files() {
    run("mosaic");
}

#[test]
fn sources_of_maps() {
    run("fetch_source");
}

#[test]
fn files_of_heights() {
    run("heights");
}

#[test]
fn sidecars_of_heights() {
    run("sidecar");
}

#[test]
fn elements() {
    run("tle");
}

#[test]
fn elements_in_every_form() {
    run("omm");
}

#[test]
fn states_with_manoeuvres() {
    run("opm");
}

#[test]
fn ephemerides() {
    run("ephemeris");
}

#[test]
fn packets_of_simulators() {
    run("live");
}

#[test]
fn messages_of_simulations() {
    run("basilisk");
}

#[test]
fn tables_of_the_earths_orientation() {
    run("earth_orientation");
}

/// The seeds are good inputs: a fuzzer that starts from rejected ones would look at little.
#[test]
fn seeds_are_good() {
    use terrella_imagery::pack::Manifest;
    let text = |seed: &Vec<u8>| String::from_utf8(seed.clone()).expect("text");
    let path = Path::new("seed");
    let good = |seed: &&Vec<u8>| Manifest::from_toml(&text(seed), path).is_ok();
    assert_eq!(manifest::seeds().iter().filter(good).count(), 3);
    assert!(
        pack_heights::seeds()
            .iter()
            .all(|seed| pack_heights::is_good(seed))
    );
    {
        use terrella_pack::source::{SourceLimits, read_source};
        let limits = SourceLimits {
            buffer_bytes: 256 << 10,
        };
        let good =
            |seed: &Vec<u8>| read_source(std::io::Cursor::new(seed.clone()), path, limits).is_ok();
        assert!(source::seeds().iter().all(good));
    }
    {
        use terrella_pack::mosaic::{Description, world_place};
        let seeds = mosaic::seeds();
        for seed in &seeds[..3] {
            Description::from_toml(&text(seed), path).expect("a good mosaic");
        }
        world_place(&text(&seeds[3]), None).expect("a good world file");
        terrella_ground::elevation::vrt::Vrt::read(&text(&seeds[4]), path).expect("a good .vrt");
    }
    for seed in fetch_source::seeds() {
        terrella_pack::fetch::MapSource::from_toml(&text(&seed), path).expect("a good source");
    }
    {
        use terrella_ground::elevation::{GridLimits, read};
        let sidecars = sidecar::seeds().into_iter().map(|seed| text(&seed));
        let sidecars: Vec<_> = sidecars
            .map(|text| read::Sidecar::from_toml(&text, path).expect("a good sidecar"))
            .collect();
        for seed in heights::seeds() {
            let sidecar = seed.starts_with(b"\x89PNG").then_some(&sidecars[0]);
            let seed = std::io::Cursor::new(seed);
            read::read_heights(seed, sidecar, path, &GridLimits::default()).expect("good heights");
        }
    }
    for seed in scene::seeds() {
        terrella_play::scene::Scene::from_toml(&text(&seed), path).expect("a good scene");
    }
    let good =
        |seed: &&Vec<u8>| terrella_orbit::TleFeed::from_text(&text(seed), path, None).is_ok();
    let elements = tle::seeds();
    assert!(
        elements.iter().filter(good).count() > 20,
        "of {}",
        elements.len()
    );
    for seed in omm::seeds() {
        terrella_orbit::Catalogue::from_text(&text(&seed), path, true).expect("good elements");
    }
    for seed in ephemeris::seeds() {
        terrella_orbit::Ephemerides::from_text(&text(&seed), path, true).expect("good states");
    }
    for seed in opm::seeds() {
        terrella_orbit::ParameterMessages::from_text(&text(&seed), path, true)
            .expect("a good message");
    }
    for seed in live::seeds() {
        let mut splitter = terrella_orbit::live::Splitter::default();
        splitter.push(&seed);
        while let Some(received) = splitter.finish() {
            let packet = received.packet;
            packet.expect("a good packet");
        }
    }
    {
        use terrella_orbit::basilisk::{Message, Recording};
        let [first, second, file, _] = <[Vec<u8>; 4]>::try_from(basilisk::seeds()).expect("four");
        for message in [first, second] {
            let message = Message::read(&message).expect("a good message");
            assert_eq!((message.craft.len(), message.cameras.len()), (2, 1));
        }
        let start = terrella::Epoch::default();
        let recording = Recording::read(std::io::Cursor::new(file), path, start, None);
        assert_eq!(recording.expect("a good file").messages(), 3);
    }
    for seed in earth_orientation::seeds() {
        terrella::frames::EarthOrientation::from_finals2000a(&text(&seed), path)
            .expect("a good table");
    }
}

/// Writes them where `cargo fuzz` looks for its corpus.
#[test]
#[ignore = "writes to fuzz/corpus"]
fn write_the_corpus() {
    for (target, seeds, _, _) in TARGETS {
        let folder = Path::new(crate::REPOSITORY)
            .join("fuzz/corpus")
            .join(target);
        std::fs::create_dir_all(&folder).expect("made");
        for (number, seed) in seeds().iter().enumerate() {
            std::fs::write(folder.join(format!("seed-{number}")), seed).expect("written");
        }
    }
}
