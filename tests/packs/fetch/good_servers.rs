//! Good servers: whole maps, regions, several protocols; requested with rate limits, and once.

use super::server::{Answer, Server};
use super::{Notes, SIDE, colour, description, files, jpeg, layer, options, place, png, tile};
use std::time::{Duration, Instant};
use terrella_pack::fetch::{FetchError, Fineness};
use terrella_pack::mosaic::{Bounds, Mosaic};
use terrella_pack::source::{RowSource, SourceLimits};

const LIMITS: SourceLimits = SourceLimits {
    buffer_bytes: 64 << 20,
};

fn good() -> Server {
    Server::new(|path, _| {
        let [level, row, column] = place(path);
        Answer::picture("image/png", png(&tile(level, row, column, colour)))
    })
}

/// All rows of a mosaic, and the reports.
fn read(mosaic: &Mosaic) -> (Vec<u8>, Vec<String>) {
    let info = mosaic.info();
    let mut rows = mosaic.rows(LIMITS);
    let mut texels = vec![0; info.row_bytes() * info.height as usize];
    for row in texels.chunks_exact_mut(info.row_bytes()) {
        rows.next_row(row).expect("a row");
    }
    (texels, rows.notes())
}

#[test]
fn a_map_is_fetched_once_and_is_what_the_server_has() {
    let (server, folder) = (good(), tempfile::tempdir().expect("a folder"));
    let layer = layer(&description(&server));
    let done = layer.fetch(&options(folder.path()), &()).expect("fetched");
    let fetched = &done.fetched[0].1;
    assert_eq!((fetched.new, fetched.kept, fetched.retries), (8, 0, 0));
    assert_eq!(server.count(), 8);
    assert!(server.most_busy() <= 3, "{} at once", server.most_busy());

    let mosaic = Mosaic::open(&done.mosaic, None, LIMITS).expect("a mosaic");
    assert_eq!(mosaic.attribution(), ["Waves by the tests"]);
    let info = mosaic.info();
    assert_eq!(
        (info.width, info.height, info.channels),
        (4 * SIDE, 2 * SIDE, 3)
    );
    let (texels, notes) = read(&mosaic);
    assert_eq!(notes, [""; 0]);
    let step = 360.0 / f64::from(info.width);
    for (n, texel) in texels.chunks_exact(3).enumerate() {
        let (x, y) = (n as u32 % info.width, n as u32 / info.width);
        let expected = colour(
            (f64::from(x) + 0.5) * step - 180.0,
            90.0 - (f64::from(y) + 0.5) * step,
        );
        assert_eq!(texel, expected, "at {x}, {y}");
    }

    let again = layer.fetch(&options(folder.path()), &()).expect("fetched");
    assert_eq!((again.fetched[0].1.new, again.fetched[0].1.kept), (0, 8));
    assert_eq!(server.count(), 8, "a kept tile was asked for");
    // A tile that was changed on disk is fetched again.
    std::fs::write(folder.path().join("local/always/2/1/2.png"), b"x").expect("written");
    let again = layer.fetch(&options(folder.path()), &()).expect("fetched");
    assert_eq!((again.fetched[0].1.new, again.fetched[0].1.kept), (1, 7));
}

#[test]
fn a_fetch_that_is_stopped_goes_on() {
    let (server, folder) = (good(), tempfile::tempdir().expect("a folder"));
    let layer = layer(&description(&server));
    let mut options = options(folder.path());
    options.fineness = Fineness::Level(3);
    let stopping = Notes {
        stop_after: Some(9),
        ..Notes::default()
    };
    let error = layer.fetch(&options, &stopping).expect_err("stopped");
    assert!(matches!(error, FetchError::Cancelled), "{error}");
    let before = server.count();
    assert!((9..32).contains(&before), "{before} requests");
    let done = layer.fetch(&options, &()).expect("fetched");
    let fetched = &done.fetched[0].1;
    assert_eq!(fetched.new + fetched.kept, 32);
    assert!(fetched.kept >= 9, "{fetched:?}");
    let hidden = files(folder.path())
        .into_iter()
        .filter(|file| file.to_string_lossy().contains("part"));
    assert_eq!(hidden.count(), 0);
}

#[test]
fn servers_are_asked_no_faster_than_is_said() {
    let (server, folder) = (good(), tempfile::tempdir().expect("a folder"));
    let mut options = options(folder.path());
    options.requests_per_s = Some(20.0);
    let begun = Instant::now();
    layer(&description(&server))
        .fetch(&options, &())
        .expect("fetched");
    // Seven steps of 50 ms.
    assert!(
        begun.elapsed() >= Duration::from_millis(345),
        "{:?}",
        begun.elapsed()
    );
    let times = server.times();
    let fifth = times[4].duration_since(times[0]);
    assert!(fifth >= Duration::from_millis(150), "{fifth:?}");
}

#[test]
fn a_region_is_fine_and_the_rest_coarse() {
    // The fine levels are brighter.
    let server = Server::new(|path, _| {
        let [level, row, column] = place(path);
        let shade = if level == 4 {
            [200, 180, 160]
        } else {
            [100, 90, 80]
        };
        Answer::picture("image/png", png(&tile(level, row, column, |_, _| shade)))
    });
    let folder = tempfile::tempdir().expect("a folder");
    let mut options = options(folder.path());
    options.fineness = Fineness::Level(4);
    options.region = Some(Bounds::new([-22.5, 0.0, 22.5, 45.0]).expect("good"));
    options.ground_width = 2 * SIDE;
    options.feather_deg = 6.0;
    let done = layer(&description(&server))
        .fetch(&options, &())
        .expect("fetched");
    let counts: Vec<_> = done
        .fetched
        .iter()
        .map(|(_, fetched)| fetched.new)
        .collect();
    assert_eq!(counts, [2, 4]);
    let mosaic = Mosaic::open(&done.mosaic, None, LIMITS).expect("a mosaic");
    let width = mosaic.info().width;
    assert_eq!(width, 16 * SIDE);
    let (texels, notes) = read(&mosaic);
    assert_eq!(notes, [""; 0]);
    let at = |lon_deg: f64, lat_deg: f64| {
        let place = |degrees: f64| (degrees / 360.0 * f64::from(width)) as usize;
        let n = place(90.0 - lat_deg) * width as usize + place(lon_deg + 180.0);
        texels[3 * n]
    };
    assert_eq!(
        (at(0.0, 22.0), at(60.0, 22.0), at(0.0, -30.0)),
        (200, 100, 100)
    );
    // Half way through the feather, and at its ends.
    let middle = at(-19.5, 22.0);
    assert!((140..170).contains(&middle), "{middle}");
    assert!(at(-22.4, 22.0) < 115 && at(-16.6, 22.0) > 195);
}

#[test]
fn wmts_tms_and_lists_are_spoken() {
    let server = Server::new(|path, _| {
        let path = path.replace("EPSG:4326:2", "2").replace("?layer=x", "");
        if let Some(row) = path.strip_prefix("/tms/2/") {
            let numbers: Vec<u32> = row
                .trim_end_matches(".jpeg")
                .split('/')
                .map_while(|word| word.parse().ok())
                .collect();
            return Answer::picture(
                "image/jpeg",
                jpeg(&tile(2, 1 - numbers[1], numbers[0], colour)),
            );
        }
        if let Some(name) = path.strip_prefix("/files/") {
            let column = if name.starts_with("west") { 0 } else { 1 };
            return Answer::picture("image/png", png(&tile(1, 0, column, colour)));
        }
        let [level, row, column] = place(&path);
        Answer::picture("image/png", png(&tile(level, row, column, colour)))
    });
    let folder = tempfile::tempdir().expect("a folder");
    let wmts = description(&server)
        .replace(
            "{z}/{row}/{column}.png",
            "wmts/{TileMatrix}/{TileRow}/{TileCol}.png?layer=x",
        )
        .replace(
            "media",
            "level_names = [\"a\", \"b\", \"EPSG:4326:2\", \"c\", \"d\"]\nmedia",
        )
        .replace("\"local\"", "\"wmts\"");
    let tms = description(&server)
        .replace("{z}/{row}/{column}.png", "tms/{z}/{x}/{-y}.jpeg")
        .replace("image/png", "image/jpeg")
        .replace("\"local\"", "\"tms\"");
    let (head, _) = description(&server)
        .split_once("[tiles]")
        .map(|(a, b)| (a.to_string(), b.to_string()))
        .expect("there");
    let list = format!(
        "{}[files]\nmedia = \"image/png\"\nmax_file_bytes = 100000\n[[files.file]]\nurl = \"{}\"\nsave_as = \"west.png\"\n\
         bounds_deg = [-180, -90, 0, 90]\n[[files.file]]\nurl = \"{}\"\nsave_as = \"east.png\"\nbounds_deg = [0, -90, 180, 90]\n",
        head.replace("\"local\"", "\"list\""),
        server.url("/files/west.png"),
        server.url("/files/east.png"),
    );
    for (text, width) in [(wmts, 4 * SIDE), (tms, 4 * SIDE), (list, 2 * SIDE)] {
        let done = layer(&text)
            .fetch(&options(folder.path()), &())
            .expect("fetched");
        let mosaic = Mosaic::open(&done.mosaic, None, LIMITS).expect("a mosaic");
        assert_eq!(mosaic.info().width, width, "{text}");
        let (texels, _) = read(&mosaic);
        let step = 360.0 / f64::from(width);
        for (n, texel) in texels.chunks_exact(3).enumerate() {
            let (x, y) = (n as u32 % width, n as u32 / width);
            let expected = colour(
                (f64::from(x) + 0.5) * step - 180.0,
                90.0 - (f64::from(y) + 0.5) * step,
            );
            // JPEG loses a little; the maps of the list are stretched north–south, according to their bounds.
            if width == 4 * SIDE {
                assert!(
                    texel[0].abs_diff(expected[0]) < 24,
                    "at {x}, {y}: {texel:?} {expected:?}"
                );
            }
        }
    }
    assert_eq!(server.count(), 8 + 8 + 2);
}
