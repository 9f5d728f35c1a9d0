use super::*;
use crate::flight::{Flight, SatelliteState};
use crate::live_status::LiveStatus;
use crate::scene::Scene;
use crate::switches::Layer;
use egui::{RawInput, Rect, Shape};
use std::path::Path;
use terrella::frames::{Epoch, Geodetic};

/// The smallest window in which nothing may be cut off, points.
const SMALLEST: Vec2 = Vec2::new(640.0, 360.0);
/// A window in which the switches are unfolded at first; they stay so when it becomes smaller.
const LARGE: Vec2 = Vec2::new(1920.0, 1080.0);

/// A text with where it may be seen, and where it is.
type LaidText = (Rect, Rect, String);

fn adaptive() -> AdaptiveQuality {
    let day = terrella::LayerImage::from_rgba8(1, 1, vec![0; 4]).expect("a map");
    let layers = terrella::EarthLayers {
        day,
        clouds: None,
        normals: None,
        night_lights: None,
        water: None,
    };
    let full = terrella::Quality::of(&terrella::EarthOptions::new(layers));
    AdaptiveQuality::new(
        10.0,
        terrella::QualityLadder::recorded().levels(full, false),
    )
}

#[test]
fn a_frame_time_out_of_reach_is_reported() {
    let mut adaptive = adaptive();
    assert_eq!(quality_text(&adaptive), "full, held to 10 ms");
    for _ in 0..1000 {
        adaptive.observe(50.0);
    }
    let text = quality_text(&adaptive);
    let end = "; 10 ms is out of reach, frames cost 50.0";
    assert!(
        text.starts_with("without ") && text.ends_with(end),
        "{text}"
    );
}

#[test]
fn speeds_read_well() {
    assert_eq!(speed_text(-64.0, false), "-64 × real time");
    assert_eq!(speed_text(0.25, true), "0.25 × real time, paused");
    assert!(frame_text(Some(20.0), 3.0).contains("50 per second"));
}

/// A flight with the longest of everything that the panel shows.
struct Longest {
    flight: Flight,
    adaptive: AdaptiveQuality,
}

impl Longest {
    fn new() -> Self {
        Self::of("")
    }

    fn of(scene: &str) -> Self {
        let scene = Scene::from_toml(scene, Path::new("test.toml")).expect("a good scene");
        let mut adaptive = adaptive();
        for _ in 0..1000 {
            adaptive.observe(50.0);
        }
        Self {
            flight: Flight::open(scene).expect("opens"),
            adaptive,
        }
    }

    /// Lays out a few frames, until sizes settle, and returns the last one's text with its visible area, and the rectangles of all windows.
    fn lay_out(&self, size: Vec2, change: impl Fn(&mut Controls)) -> (Vec<LaidText>, Vec<Rect>) {
        let (texts, areas, _) = self.lay_out_and_click(size, None, change);
        (texts, areas)
    }

    /// As [`Self::lay_out`], with a click on the first text that reads so; also returns the resulting action.
    fn lay_out_and_click(
        &self,
        size: Vec2,
        clicked: Option<&str>,
        change: impl Fn(&mut Controls),
    ) -> (Vec<LaidText>, Vec<Rect>, Vec<Action>) {
        let mut controls = Controls::new(&self.flight);
        change(&mut controls);
        let request = controls.request(1.0);
        let now: Epoch = controls.clock.now();
        let mut moment = self.flight.view_at(now, &request).expect("a view");
        moment.satellite = moment.satellite.map(|satellite| SatelliteState {
            place: Geodetic::from_degrees(-51.123_456, -179.987_654, 420_123.4),
            error_m: Some(1234.5),
            ..satellite
        });
        let mut stats = FrameStats::default();
        stats.tiles.failures = 12;
        stats.ground.error_px = Some(0.9);
        let data = PanelData {
            satellite: Some("A SATELLITE WITH A LONG NAME (2018-001-ABC)"),
            moment: &moment,
            ellipsoid: *self.flight.ellipsoid(),
            stats,
            has_tiles: true,
            adaptive: Some(&self.adaptive),
            interval_ms: Some(123.4),
            work_ms: 100.0,
            adapter: "llvmpipe (LLVM 15.0.6, 256 bits), Vulkan, a software renderer of Mesa 22.3.6",
        };
        let context = Context::default();
        crate::theme::apply(&context);
        let mut texts = Vec::new();
        let mut actions = Vec::new();
        let sizes = [LARGE, LARGE, size, size, size, size, size];
        for (frame, size) in sizes.into_iter().enumerate() {
            let at = clicked.filter(|_| frame > 3).map(|clicked| {
                let is_wanted = |(_, _, text): &&LaidText| text == clicked;
                let found: &LaidText = texts.iter().find(is_wanted).expect("it is laid out");
                found.1.center()
            });
            let press = |pos, pressed| egui::Event::PointerButton {
                pos,
                button: egui::PointerButton::Primary,
                pressed,
                modifiers: egui::Modifiers::NONE,
            };
            let events = at.map_or_else(Vec::new, |pos| match frame {
                4 => vec![egui::Event::PointerMoved(pos)],
                5 => vec![press(pos, true)],
                _ => vec![press(pos, false)],
            });
            let input = RawInput {
                screen_rect: Some(Rect::from_min_size(egui::Pos2::ZERO, size)),
                events,
                ..RawInput::default()
            };
            let mut asked = Vec::new();
            let mut output = context.run_ui(input, |ui| {
                asked = show(ui.ctx(), &controls, &data);
            });
            actions.extend(asked);
            output.textures_delta.clear();
            let shapes = output.shapes.into_iter();
            let found = shapes.filter_map(|shape| match shape.shape {
                Shape::Text(text) => Some((
                    shape.clip_rect,
                    text.visual_bounding_rect(),
                    text.galley.text().to_owned(),
                )),
                _ => None,
            });
            texts = found.collect();
        }
        let areas = context.memory(|memory| {
            let layers: Vec<_> = memory.areas().visible_layer_ids().into_iter().collect();
            let rects = layers.iter().map(|layer| memory.area_rect(layer.id));
            rects.flatten().collect()
        });
        (texts, areas, actions)
    }

    fn assert_nothing_is_cut_off(&self, what: &str, change: impl Fn(&mut Controls)) {
        let (texts, areas) = self.lay_out(SMALLEST, change);
        let screen = Rect::from_min_size(egui::Pos2::ZERO, SMALLEST);
        assert!(!areas.is_empty(), "{what}: nothing is laid out");
        for area in areas {
            assert!(screen.contains_rect(area), "{what}: {area} leaves {screen}");
        }
        for (clip, rect, text) in texts.into_iter().filter(|(_, _, text)| !text.is_empty()) {
            // Heights are scrolled, widths are not.
            let is_whole = clip.left() - 1.0 <= rect.left() && rect.right() <= clip.right() + 1.0;
            assert!(is_whole, "{what}: {text:?} at {rect} is cut off at {clip}");
        }
    }
}

fn nothing(_: &mut Controls) {}

#[test]
fn buttons_have_tooltips_with_their_keys() {
    for action in [
        Action::Slower,
        Action::Faster,
        Action::Reverse,
        Action::NextCamera,
        Action::TimeLine,
        Action::Help,
        Action::Step(-1.0),
        Action::Step(1.0),
        Action::Loop,
        Action::RangeStart(None),
        Action::RangeEnd(None),
        Action::RangeAll,
        Action::RealTime,
        Action::SceneSpan,
        Action::NextPass,
        Action::NorthUp,
        Action::MapScale,
    ] {
        assert!(tooltip(&action).ends_with(')'), "{action:?}");
    }
    assert_eq!(tooltip(&Action::Pause), "play or pause (Space)");
}

#[test]
fn nothing_is_cut_off_in_a_small_window() {
    let longest = Longest::new();
    let message = "No further: the elements of A SATELLITE WITH A LONG NAME hold until 2026-11-25T00:00:00Z, and \
                   the next set of elements is not in the file that the scene names";
    longest.assert_nothing_is_cut_off("panel and time line", nothing);
    longest.assert_nothing_is_cut_off("help", |controls| controls.help = true);
    longest.assert_nothing_is_cut_off("question", |controls| controls.asks_to_close = true);
    longest.assert_nothing_is_cut_off("message", |controls| {
        controls.message = Some(message.to_owned());
    });
    longest.assert_nothing_is_cut_off("a simulator", |controls| {
        controls.live = Some(LiveStatus {
            name: "A SATELLITE WITH A LONG NAME".into(),
            pace: "in lockstep".into(),
            rows: vec![("simulator", "nothing has come since 12.3 s ago".into()); 6],
            notice: Some(
                "nothing has come from the simulator on tcp://127.0.0.1:5005 for 10.0 s".into(),
            ),
        });
    });
}

#[test]
fn the_help_names_every_way_to_close_it() {
    let longest = Longest::new();
    let (texts, _) = longest.lay_out(SMALLEST, |controls| controls.help = true);
    assert!(
        texts
            .iter()
            .any(|(_, _, text)| text.contains("closes this help"))
    );
}

#[test]
fn all_keys_are_visible_at_once_in_a_usual_window() {
    use crate::keys::{BINDINGS, MOUSE};
    let longest = Longest::new();
    for size in [Vec2::new(1280.0, 720.0), LARGE] {
        let (texts, areas) = longest.lay_out(size, |controls| controls.help = true);
        let screen = Rect::from_min_size(egui::Pos2::ZERO, size);
        for area in areas {
            assert!(screen.contains_rect(area), "{area} leaves {screen}");
        }
        let find = |wanted: &str| {
            let found = texts.iter().find(|(_, _, text)| text == wanted);
            let (clip, rect, _) = found.unwrap_or_else(|| panic!("{wanted} is missing"));
            assert!(clip.expand(1.0).contains_rect(*rect), "{wanted}: {rect}");
            *rect
        };
        let bindings = BINDINGS.iter().map(|binding| binding.does);
        for does in bindings.chain(MOUSE.iter().map(|(_, does)| *does)) {
            find(does);
        }
        // What closes it is at the top.
        let first = find("play or pause").top();
        for closing in ["open or close this help", "close the window at once"] {
            assert!(find(closing).top() < first, "{closing}");
        }
    }
}

#[test]
fn the_help_leaves_the_panel_visible_where_there_is_room() {
    let longest = Longest::new();
    let (texts, _) = longest.lay_out(LARGE, |controls| controls.help = true);
    let find = |wanted: &str| {
        let found = texts.iter().find(|(_, _, text)| text == wanted);
        found.map(|(_, rect, _)| *rect).expect("it is laid out")
    };
    let name = "A SATELLITE WITH A LONG NAME (2018-001-ABC)";
    assert!(find("open or close this help").left() > find(name).right());
}

#[test]
fn a_wide_time_line_names_the_colours_of_its_bands() {
    let scene = "[time]\nduration_s = 21600\n[camera]\nmode = \"nadir\"\n[orbit]\n";
    let longest = Longest::of(scene);
    let words = ["night below", "Earth's shadow", "passes"];
    let shown = |width: f32, change: fn(&mut Controls, &Flight)| {
        let (texts, _) = longest.lay_out(Vec2::new(width, 720.0), |controls| {
            change(controls, &longest.flight);
        });
        words.map(|word| {
            let found = texts.iter().find(|(_, _, text)| text == word);
            found.map(|(_, rect, _)| *rect)
        })
    };
    let with_bands = |controls: &mut Controls, flight: &Flight| {
        controls.line.find_light(flight, &controls.clock);
        let begin = controls.clock.now();
        controls.line.passes = vec![terrella_orbit::Pass {
            begin,
            rises: true,
            highest: begin,
            elevation_rad: 0.7,
            end: begin,
            sets: true,
        }];
    };
    for width in [900.0, 1280.0] {
        let [night, umbra, passes] = shown(width, with_bands).map(|rect| rect.expect("a word"));
        assert!(night.right() < umbra.left() && umbra.right() < passes.left());
    }
    assert_eq!(shown(800.0, with_bands), [None; 3]);
    // Bands that are not there are not named.
    assert_eq!(shown(1280.0, |_, _| ()), [None; 3]);
}

#[test]
fn a_message_is_in_the_middle_of_a_window_with_room() {
    let longest = Longest::new();
    for text in ["saved a.png", &"a long message of many words ".repeat(8)] {
        let (texts, _) = longest.lay_out(LARGE, |controls| {
            controls.message = Some(text.to_owned());
        });
        let found = texts.iter().find(|(_, _, laid)| laid == text);
        let (_, rect, _) = found.expect("the message");
        assert!((rect.center().x - 0.5 * LARGE.x).abs() < 8.0, "{rect}");
    }
}

#[test]
fn what_is_selected_is_said_beside_the_panel() {
    let longest = Longest::new();
    let select = |controls: &mut Controls| {
        controls.read_out = Some(ReadOut {
            title: "A SATELLITE WITH A LONG NAME (2018-001-ABC)".into(),
            rows: vec![
                ("position", "51.123° S, 179.988° W".into()),
                ("altitude", "35786.0 km".into()),
                ("speed", "7.660 km/s".into()),
                ("solar time", "23:59 (apparent)".into()),
            ],
            at: Some(glam::DVec2::splat(0.6)),
            passes_over_deg: Some([-51.5, -179.75]),
        });
    };
    longest.assert_nothing_is_cut_off("selection", select);
    let (texts, areas) = longest.lay_out(SMALLEST, select);
    let is_part = |area: &Rect| area.size() != SMALLEST;
    let areas: Vec<_> = areas.into_iter().filter(is_part).collect();
    assert!(areas.len() >= 3, "{areas:?}");
    for (index, area) in areas.iter().enumerate() {
        for other in &areas[..index] {
            assert!(!area.shrink(0.5).intersects(*other), "{area} over {other}");
        }
    }
    assert!(texts.iter().any(|(_, _, text)| text == "solar time"));
}

#[test]
fn every_layer_is_switched_by_a_click_on_its_name() {
    let scene = "[[station]]\nname = \"Kiruna\"\nlat_deg = 67.9\nlon_deg = 21\n";
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("a.geojson");
    std::fs::write(&file, "{}").expect("written");
    let scene = format!(
        "{scene}[coverage]\nshow = \"gap\"\n[[geojson]]\nfile = {:?}\n",
        file.display().to_string()
    );
    let longest = Longest::of(&scene);
    for layer in Layer::ALL {
        let (_, _, actions) = longest.lay_out_and_click(LARGE, Some(layer.name()), nothing);
        assert_eq!(actions, [Action::Layer(layer)]);
    }
    // A scene without stations has no box for them.
    let (texts, _) = Longest::new().lay_out(LARGE, nothing);
    let is_there = |name: &str| texts.iter().any(|(_, _, text)| text == name);
    assert!(is_there("tracks") && !is_there("stations"));
}

#[test]
fn a_dialog_takes_the_clicks_on_what_is_below() {
    let longest = Longest::new();
    let open: [fn(&mut Controls); 2] = [
        |controls| controls.asks_to_close = true,
        |controls| controls.asks_for_film = true,
    ];
    for open in open {
        for below in ["tracks", "next pass"] {
            let (_, _, actions) = longest.lay_out_and_click(LARGE, Some(below), open);
            assert_eq!(actions, [], "{below}");
        }
    }
    let close = |controls: &mut Controls| controls.asks_to_close = true;
    let (_, _, actions) = longest.lay_out_and_click(LARGE, Some("Stay (Esc)"), close);
    assert_eq!(actions, [Action::Dismiss]);
}

#[test]
fn exposure_is_metered_by_a_click_and_then_held() {
    let longest = Longest::of("[output]\nexposure_ev = 1.5\n");
    let click = |change: fn(&mut Controls)| {
        let (_, _, actions) = longest.lay_out_and_click(LARGE, Some("automatic"), change);
        actions
    };
    use terrella::Exposure;
    assert_eq!(click(nothing), [Action::Expose(Some(Exposure::Auto))]);
    // The last metered value, which the test keeps at 0.
    let is_metered = |controls: &mut Controls| {
        controls.apply(Action::Expose(Some(Exposure::Auto)), 720.0);
    };
    assert_eq!(click(is_metered), [Action::Expose(Some(Exposure::Ev(0.0)))]);
    let reset = |change: fn(&mut Controls)| {
        let (_, _, actions) = longest.lay_out_and_click(LARGE, Some("as in the scene"), change);
        actions
    };
    assert_eq!(reset(nothing), []);
    assert_eq!(reset(is_metered), [Action::SceneLook]);
}

#[test]
fn performance_is_said_under_details_alone() {
    let longest = Longest::new();
    let (texts, _) = longest.lay_out(Vec2::new(1920.0, 1080.0), nothing);
    let is_shown = |word: &str| texts.iter().any(|(_, _, text)| text == word);
    for word in [
        "altitude",
        "sub-satellite point",
        "field of view",
        "inertial speed",
        "Details",
    ] {
        assert!(is_shown(word), "{word}");
    }
    for word in ["frame", "blocks", "adapter", "quality"] {
        assert!(!is_shown(word), "{word}");
    }
    let names = |rows: Vec<(&'static str, String)>| rows.into_iter().map(|(name, _)| name);
    let epoch = longest.flight.scene().time.start;
    let moment = longest.flight.at(epoch, 1.5).expect("a moment");
    let data = PanelData {
        satellite: None,
        moment: &moment,
        ellipsoid: *longest.flight.ellipsoid(),
        stats: FrameStats::default(),
        has_tiles: true,
        adaptive: Some(&longest.adaptive),
        interval_ms: None,
        work_ms: 1.0,
        adapter: "an adapter",
    };
    let said: Vec<_> = names(detail_rows(&data)).collect();
    assert_eq!(said.first(), Some(&"frame"));
    assert!(
        said.contains(&"tiles") && said.contains(&"quality"),
        "{said:?}"
    );
    assert_eq!(said.last(), Some(&"adapter"));
}

/// `cargo test --release -p terrella-play --features window print_panel -- --ignored --nocapture`
#[test]
#[ignore = "measures"]
fn print_panel_times() {
    let many = "[[orbit]]\nsource = \"kepler\"\nwalker = \"53:15000/100/1\"\naltitude_km = 550\nmarker = true\n";
    let satellites = many.to_owned() + &many.replace("550", "1150");
    for (what, scene) in [("one satellite", ""), ("30000 satellites", &*satellites)] {
        let longest = Longest::of(scene);
        let mut controls = Controls::new(&longest.flight);
        controls.panel = true;
        let moment = {
            let request = controls.request(1.0);
            longest.flight.view_at(controls.clock.now(), &request)
        };
        let moment = moment.expect("a view");
        let data = PanelData {
            satellite: Some("ISS (ZARYA)"),
            moment: &moment,
            ellipsoid: *longest.flight.ellipsoid(),
            stats: FrameStats::default(),
            has_tiles: false,
            adaptive: None,
            interval_ms: Some(16.6),
            work_ms: 4.0,
            adapter: "adapter",
        };
        for size in [SMALLEST, LARGE] {
            let context = Context::default();
            crate::theme::apply(&context);
            let mut times: Vec<f64> = Vec::new();
            for frame in 0..220 {
                // The clock goes on, and the pointer moves over the panel.
                controls.clock.advance(1.0 / 60.0);
                let pos = egui::Pos2::new(30.0 + (frame % 40) as f32, 60.0 + (frame % 90) as f32);
                let input = RawInput {
                    screen_rect: Some(Rect::from_min_size(egui::Pos2::ZERO, size)),
                    events: vec![egui::Event::PointerMoved(pos)],
                    ..RawInput::default()
                };
                let began = std::time::Instant::now();
                let mut output = context.run_ui(input, |ui| {
                    show(ui.ctx(), &controls, &data);
                });
                let shapes = std::mem::take(&mut output.shapes);
                let triangles = context.tessellate(shapes, output.pixels_per_point);
                let took = began.elapsed().as_secs_f64() * 1e3;
                assert!(!triangles.is_empty());
                output.textures_delta.clear();
                if frame >= 20 {
                    times.push(took);
                }
            }
            times.sort_by(f64::total_cmp);
            let at = |part: f64| times[(part * (times.len() - 1) as f64) as usize];
            println!(
                "{what}, {size}: {:.2} ms median, {:.2} ms at most of 95 %",
                at(0.5),
                at(0.95)
            );
        }
    }
}
