use super::*;

const USUAL: UsualStyle = UsualStyle {
    line: GeoStyle {
        color: [1, 2, 3],
        opacity: 0.5,
        width_px: 2.0,
    },
    fill_opacity: 0.0,
};

fn parse(text: &str) -> GeoJson {
    GeoJson::parse(text, USUAL, None).unwrap_or_else(|error| panic!("{error}"))
}

/// A collection of features with these members.
fn features(members: &[&str]) -> GeoJson {
    let features = members
        .iter()
        .map(|members| format!("{{\"type\":\"Feature\",{members}}}"));
    let features: Vec<_> = features.collect();
    let list = features.join(",");
    parse(&format!(
        "{{\"type\":\"FeatureCollection\",\"features\":[{list}]}}"
    ))
}

fn geometry(kind: &str, coordinates: &str) -> GeoJson {
    parse(&format!(
        "{{\"type\":\"{kind}\",\"coordinates\":{coordinates}}}"
    ))
}

/// Longitudes and latitudes of all lines, degrees.
fn lines(found: &GeoJson) -> Vec<Vec<[f64; 2]>> {
    let degrees = |place: &Geodetic| {
        [place.lon_rad, place.lat_rad].map(|angle| (angle.to_degrees() * 1e9).round() / 1e9)
    };
    let lines = found.lines.iter().flat_map(|(_, lines)| lines);
    lines
        .map(|line| line.iter().map(degrees).collect())
        .collect()
}

fn said(found: &GeoJson) -> Vec<String> {
    found.remarks.iter().map(Remark::to_string).collect()
}

/// The examples of RFC 7946, appendix A.
#[test]
fn the_geometries_of_the_standard_are_read() {
    assert_eq!(geometry("Point", "[100.0, 0.0]").points.len(), 1);
    assert_eq!(
        geometry("MultiPoint", "[[100.0, 0.0],[101.0, 1.0]]")
            .points
            .len(),
        2
    );
    let line = geometry("LineString", "[[100.0, 0.0],[101.0, 1.0]]");
    assert_eq!(lines(&line), [[[100.0, 0.0], [101.0, 1.0]]]);
    let many = geometry(
        "MultiLineString",
        "[[[100.0, 0.0],[101.0, 1.0]],[[102.0, 2.0],[103.0, 3.0]]]",
    );
    assert_eq!(lines(&many).len(), 2);
    let holes = geometry(
        "Polygon",
        "[[[100.0, 0.0],[101.0, 0.0],[101.0, 1.0],[100.0, 1.0],[100.0, 0.0]],
          [[100.8, 0.8],[100.8, 0.2],[100.2, 0.2],[100.2, 0.8],[100.8, 0.8]]]",
    );
    assert_eq!(
        lines(&holes).iter().map(Vec::len).collect::<Vec<_>>(),
        [5, 5]
    );
    assert_eq!((holes.wrong_windings, said(&holes).len()), (0, 0));
    let polygons = geometry(
        "MultiPolygon",
        "[[[[102.0, 2.0],[103.0, 2.0],[103.0, 3.0],[102.0, 3.0],[102.0, 2.0]]],
          [[[100.0, 0.0],[101.0, 0.0],[101.0, 1.0],[100.0, 1.0],[100.0, 0.0]],
           [[100.2, 0.2],[100.2, 0.8],[100.8, 0.8],[100.8, 0.2],[100.2, 0.2]]]]",
    );
    assert_eq!(lines(&polygons).len(), 3);
    let collection = parse(
        "{\"type\":\"GeometryCollection\",\"geometries\":[
          {\"type\":\"Point\",\"coordinates\":[100.0, 0.0]},
          {\"type\":\"LineString\",\"coordinates\":[[101.0, 0.0],[102.0, 1.0]]}]}",
    );
    assert_eq!((collection.points.len(), lines(&collection).len()), (1, 1));
    // With a height, with foreign members, and a feature without a place.
    let found = features(&[
        "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2,3.5],\"more\":[]},\"properties\":null,\"id\":7",
        "\"geometry\":null,\"properties\":{}",
    ]);
    assert_eq!((found.points.len(), said(&found).len()), (1, 0));
}

#[test]
fn a_feature_at_fault_is_named_and_the_rest_is_drawn() {
    let good = "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2]}";
    let bomb = format!(
        "\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":{}1{}}}",
        "[".repeat(100_000),
        "]".repeat(100_000)
    );
    let collections = format!(
        "\"geometry\":{}{{\"type\":\"Point\",\"coordinates\":[0,0]}}{}",
        "{\"type\":\"GeometryCollection\",\"geometries\":[".repeat(30),
        "]}".repeat(30)
    );
    let properties = format!(
        "\"properties\":{}1{},{good}",
        "{\"a\":".repeat(500),
        "}".repeat(500)
    );
    for (bad, expected) in [
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[NaN,2]}",
            "not a finite number",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,-Infinity]}",
            "not a finite number",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1e999,2]}",
            "number out of range",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1]}",
            "[longitude, latitude]",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[\"1\",2]}",
            "its coordinates: invalid type",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[48.2,116.4]}",
            "latitude 116.4 is out of range",
        ),
        (
            "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1000,2]}",
            "longitude 1000 is out of range",
        ),
        ("\"geometry\":{\"type\":\"Point\"}", "no coordinates"),
        (
            "\"geometry\":{\"type\":\"Circle\",\"coordinates\":[1,2]}",
            "\"Circle\", which GeoJSON has not",
        ),
        (
            "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[1,2]]}",
            "1 positions and needs 2",
        ),
        (
            "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[]}",
            "0 positions and needs 2",
        ),
        (
            "\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[[1,2],[3,4],[1,2]]]}",
            "2 corners and needs 3",
        ),
        (
            "\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[]]}",
            "0 corners and needs 3",
        ),
        (
            "\"geometry\":{\"type\":\"Polygon\",\"coordinates\":[[1,2],[3,4]]}",
            "its coordinates: invalid type",
        ),
        (
            "\"geometry\":{\"type\":\"GeometryCollection\"}",
            "no geometries",
        ),
        ("\"geometry\":[1]", "invalid"),
        (&bomb, "its coordinates: invalid type"),
        (&collections, "nested too deeply"),
        (&properties, "nested too deeply"),
    ] {
        let found = features(&[good, bad, good]);
        assert_eq!(found.points.len(), 2, "{expected}");
        let said = said(&found);
        assert_eq!(said.len(), 1, "{said:?}");
        assert!(
            said[0].starts_with("feature 1: ") && said[0].contains(expected),
            "{said:?}"
        );
        assert!(!found.remarks[0].is_drawn);
    }
    let many = vec!["\"geometry\":7"; 50];
    let found = features(&many);
    assert_eq!((found.remarks.len(), found.more_remarks), (20, 30));
}

#[test]
fn what_is_no_geojson_is_said() {
    for (text, expected) in [
        ("", "it is no JSON: EOF"),
        (
            "{\"type\":\"FeatureCollection\",\"features\":[{]}",
            "it is no JSON: ",
        ),
        ("[]", "its type is missing"),
        ("7", "no JSON: invalid type"),
        ("{}", "its type is missing"),
        ("{\"type\":\"Topology\"}", "its type is \"Topology\""),
        (
            "{\"type\":\"FeatureCollection\"}",
            "its type is \"FeatureCollection\"",
        ),
        (
            "{\"type\":\"FeatureCollection\",\"features\":{}}",
            "a list of features",
        ),
    ] {
        let error = GeoJson::parse(text, USUAL, None)
            .expect_err(text)
            .to_string();
        assert!(error.contains(expected), "{text}: {error}");
    }
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("a.geojson");
    let read = || GeoJson::read(&path, USUAL, None);
    assert!(matches!(read(), Err(GeoJsonError::Read(_))));
    std::fs::write(&path, [0xff, 0xfe, 0x7b]).expect("written");
    assert!(matches!(read(), Err(GeoJsonError::NotUtf8)));
    std::fs::write(&path, "\u{feff}{\"type\":\"Point\",\"coordinates\":[1,2]}").expect("written");
    assert_eq!(read().expect("a point").points.len(), 1);
    // 200 MB that are nowhere on the disk: nothing of them is read.
    let file = std::fs::File::create(&path).expect("made");
    file.set_len(200_000_000).expect("grown");
    assert!(matches!(read(), Err(GeoJsonError::TooLarge)));
}

#[test]
fn too_many_positions_are_left_out_before_they_are_read() {
    let zeros = "[0,0],".repeat(1_200_000);
    let huge = format!(
        "\"geometry\":{{\"type\":\"LineString\",\"coordinates\":[{}]}}",
        zeros.trim_end_matches(',')
    );
    let good = "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}";
    let found = features(&[good, &huge, good]);
    assert_eq!(lines(&found).len(), 2);
    assert!(said(&found)[0].starts_with("feature 1: the file has more than 1 000 000 positions"));
}

#[test]
fn rings_are_closed_and_their_winding_is_counted() {
    let open = geometry("Polygon", "[[[0,0],[10,0],[10,10]]]");
    assert_eq!(
        lines(&open),
        [[[0.0, 0.0], [10.0, 0.0], [10.0, 10.0], [0.0, 0.0]]]
    );
    assert_eq!(
        said(&open),
        ["feature 0: a ring is not closed; it is drawn closed"]
    );
    assert!(open.remarks[0].is_drawn);
    for (ring, is_wrong) in [
        ("[[0,0],[10,0],[10,10],[0,0]]", false),
        ("[[0,0],[10,10],[10,0],[0,0]]", true),
        // Around the date line, with longitudes that jump and that go on.
        ("[[170,0],[-170,0],[-170,10],[170,10],[170,0]]", false),
        ("[[170,0],[170,10],[-170,10],[-170,0],[170,0]]", true),
        ("[[170,0],[190,0],[190,10],[170,10],[170,0]]", false),
    ] {
        let found = geometry("Polygon", &format!("[{ring}]"));
        assert_eq!(found.wrong_windings, usize::from(is_wrong), "{ring}");
    }
}

#[test]
fn segments_over_half_a_turn_go_the_shorter_way_and_whole_turns_go_round() {
    let cut = geometry(
        "MultiLineString",
        "[[[170,45],[180,45]],[[-180,45],[-170,45]]]",
    );
    assert_eq!(said(&cut).len(), 0);
    let across = geometry("LineString", "[[170,45],[-170,45],[-100,45],[170,40]]");
    let said_of_it = said(&across);
    assert_eq!(said_of_it.len(), 1, "{said_of_it:?}");
    assert!(
        said_of_it[0].contains("from longitude 170 to -170") && said_of_it[0].contains("3.1.9")
    );
    let round = geometry("LineString", "[[-180,50],[180,50]]");
    assert_eq!(
        lines(&round),
        [[[-180.0, 50.0], [-60.0, 50.0], [60.0, 50.0], [180.0, 50.0]]]
    );
    assert_eq!(said(&round).len(), 0);
}

#[test]
fn edges_along_the_date_line_are_no_outline() {
    // The cut starts the ring, ends it, or is inside it.
    for ring in [
        "[[180,0],[180,10],[170,10],[170,0],[180,0]]",
        "[[180,10],[170,10],[170,0],[180,0],[180,10]]",
        "[[170,0],[180,0],[180,5],[180,10],[170,10],[170,0]]",
    ] {
        let found = geometry("Polygon", &format!("[{ring}]"));
        assert_eq!(
            lines(&found),
            [[[180.0, 10.0], [170.0, 10.0], [170.0, 0.0], [180.0, 0.0]]],
            "{ring}"
        );
    }
    let two = "[[180,0],[180,2],[170,5],[180,8],[180,9],[160,5],[180,0]]";
    let found = geometry("Polygon", &format!("[{two}]"));
    assert_eq!(lines(&found).len(), 2);
}

/// simplestyle-spec 1.1.0: a fill has an opacity of 0.6 by default.
#[test]
fn polygons_are_filled_as_they_say() {
    let area = |properties: &str| {
        let rings = "[[[0,0],[9,0],[9,9],[0,0]],[[3,1],[4,1],[4,2],[3,1]]]";
        format!(
            "\"properties\":{{{properties}}},\"geometry\":{{\"type\":\"Polygon\",\"coordinates\":{rings}}}"
        )
    };
    let members = [
        area("\"fill\":\"#0f0\""),
        area("\"stroke\":\"#ff0000\",\"fill-opacity\":0.25"),
        area("\"fill\":\"#00ff00\",\"stroke-width\":0,\"title\":\"Zone\""),
        area("\"fill\":\"#00f\",\"fill-opacity\":0"),
        area(""),
    ];
    let members: Vec<&str> = members.iter().map(String::as_str).collect();
    let fills = |found: &GeoJson| -> Vec<_> {
        let fills = found.fills.iter();
        fills
            .map(|(style, polygons)| (style.color, style.opacity, polygons.len()))
            .collect()
    };
    let found = features(&members);
    assert_eq!(
        fills(&found),
        [([0, 255, 0], 0.6, 2), ([255, 0, 0], 0.25, 1)]
    );
    let rings = &found.fills[0].1[0];
    assert_eq!(rings.iter().map(Vec::len).collect::<Vec<_>>(), [4, 4]);
    assert_eq!(found.points.len(), 1, "named by its filling alone");
    // The table's own opacity applies to features without any style.
    let usual = UsualStyle {
        fill_opacity: 0.5,
        ..USUAL
    };
    let text = r#"{"type":"Polygon","coordinates":[[[0,0],[9,0],[9,9],[0,0]]]}"#;
    let bare = GeoJson::parse(text, usual, None).expect("good");
    assert_eq!(fills(&bare), [([1, 2, 3], 0.5, 1)]);
}

#[test]
fn simplestyle_is_drawn_or_listed() {
    let line = "\"geometry\":{\"type\":\"LineString\",\"coordinates\":[[1,2],[3,4]]}";
    let point = "\"geometry\":{\"type\":\"Point\",\"coordinates\":[1,2]}";
    let found = features(&[
        &format!(
            "{line},\"properties\":{{\"stroke\":\"#f80\",\"stroke-width\":4,\"stroke-opacity\":0.25,\"fill\":\"#fff\"}}"
        ),
        &format!(
            "{line},\"properties\":{{\"stroke\":\"0180FF\",\"title\":\"Route\",\"fill\":\"#000\",\"marker-symbol\":\"x\"}}"
        ),
        &format!("{line},\"properties\":{{\"stroke-opacity\":0}}"),
        &format!("{line},\"properties\":{{\"stroke-width\":0}}"),
        &format!("{point},\"properties\":{{\"marker-color\":\"#00ff00\",\"title\":\"Kourou\"}}"),
        line,
        &format!("{line},\"properties\":{{\"stroke\":\"red\",\"stroke-width\":\"thick\"}}"),
    ]);
    let style = |color, opacity, width_px| GeoStyle {
        color,
        opacity,
        width_px,
    };
    let mut styles: Vec<_> = found
        .lines
        .iter()
        .map(|(style, lines)| (*style, lines.len()))
        .collect();
    styles.sort_by_key(|(style, _)| style.color);
    assert_eq!(
        styles,
        [
            (style([1, 2, 3], 0.5, 2.0), 2),
            (style([1, 128, 255], 0.5, 2.0), 1),
            (style([255, 136, 0], 0.25, 4.0), 1),
        ]
    );
    let names: Vec<_> = found
        .points
        .iter()
        .map(|point| (point.name.as_deref(), point.is_marked, point.color))
        .collect();
    assert_eq!(
        names,
        [
            (Some("Route"), false, [1, 128, 255]),
            (Some("Kourou"), true, [0, 255, 0]),
        ]
    );
    assert_eq!(found.ignored, ["marker-symbol"]);
    assert!(found.fills.is_empty(), "lines have none");
    assert_eq!(
        said(&found),
        [
            "feature 6: stroke is no colour such as \"#ffc42e\"; the usual one is taken",
            "feature 6: stroke-width is no number of 0 or more; the usual one is taken",
        ]
    );
}

#[test]
fn names_are_of_the_key_and_stand_within_rings() {
    let text = "{\"type\":\"Feature\",\"properties\":{\"ADMIN\":\"Fiji\",\"title\":\"no\",\"n\":7},\"geometry\":
        {\"type\":\"MultiPolygon\",\"coordinates\":[[[[0,0],[1,0],[1,1],[0,0]]],
        [[[176,-20],[-178,-20],[-178,-16],[176,-16],[176,-20]]]]}}";
    let named = |key| {
        GeoJson::parse(text, USUAL, Some(key))
            .expect("a feature")
            .points
    };
    let fiji = named("ADMIN");
    assert_eq!(fiji.len(), 1);
    let place = fiji[0].place;
    assert_eq!(fiji[0].name.as_deref(), Some("Fiji"));
    assert!((place.lat_rad.to_degrees() + 18.0).abs() < 1e-9);
    assert!((place.lon_rad.to_degrees() - 179.0).abs() < 1e-9);
    assert_eq!(named("n")[0].name.as_deref(), Some("7"));
    assert!(named("none").is_empty());
}

#[test]
fn words_in_strings_are_no_numbers() {
    let text = r#"{"type":"Feature","properties":{"title":"NaN \" Infinity I"},"geometry":{"type":"MultiPoint","coordinates":[[1,2]]}}"#;
    let name = parse(text).points[0].name.clone();
    assert_eq!(name.as_deref(), Some("NaN \" Infinity I"));
    assert_eq!(
        without_nan("[NaN,-Infinity,Infinity,\"NaN\",In]"),
        "[null,null,null,\"NaN\",In]"
    );
}

#[test]
fn any_bytes_are_read_without_a_panic() {
    let good = r##"{"type":"FeatureCollection","features":[{"type":"Feature","properties":{"stroke":"#fff","title":"a"},"geometry":{"type":"Polygon","coordinates":[[[1,2],[3,4],[5,6],[1,2]]]}}]}"##;
    // Each byte changed or truncated: with an own random generator, so that a failure is reproducible.
    let mut state = 1_u64;
    for cut in 0..good.len() {
        let _ = GeoJson::parse(&good[..cut], USUAL, None);
        for _ in 0..20 {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            let mut bytes = good.as_bytes().to_vec();
            bytes[cut] = b"{}[]\",:-0e9.N\\nul"[(state >> 33) as usize % 17];
            let text = String::from_utf8(bytes).expect("ASCII");
            let _ = GeoJson::parse(&text, USUAL, Some("title"));
        }
    }
}
