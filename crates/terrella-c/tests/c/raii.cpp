// The classes of terrella.hpp apart from drawing: times, exceptions, moves, destruction.
#undef NDEBUG
#include <algorithm>
#include <cassert>
#include <cmath>
#include <terrella.hpp>

template <typename F>
static TerrellaStatus thrown(F call) {
    try {
        call();
    } catch (const terrella::Error &error) {
        assert(error.what()[0] != '\0');
        return error.status();
    }
    return TERRELLA_OK;
}

int main(int argc, char **argv) {
    assert(argc == 2);
    terrella::Time before("2016-12-31T23:59:59Z"), after("2017-01-01T00:00:00.25Z");
    // A leap second lies between them.
    assert(after - before == 2.25 && before < after && before != after);
    assert((before + 2.25) == after && (after - 2.25) == before);
    assert((before + 1).utc() == "2016-12-31T23:59:60.000Z");
    assert(std::fabs(terrella::Time::from_unix(1483228800.25) - after) < 1e-6);
    assert(thrown([] { terrella::Time("yesterday"); }) == TERRELLA_ARGUMENT);
    assert(before <= after && before <= before && !(after <= before) && after > before && !(before > before));
    assert(after >= before && after >= after && !(before >= after));
    auto moment = before;
    moment += 2.25;
    assert(moment == after && (moment -= 2.25) == before);
    assert(thrown([] { return terrella::camera_geodetic(91, 0, 1e6, 0, -90, 45, 1); }) == TERRELLA_ARGUMENT);
    assert(thrown([] { terrella::Scene("nowhere.toml"); }) == TERRELLA_SCENE);

    auto camera = terrella::camera_look({2e7, 0, 0}, {-1, 0, 0}, {0, 0, 1}, 45, 1.5);
    assert(camera.eye_itrf_m[0] == 2e7);
    // Vallado 2013, example 3-15, with the time of UT1: what is left is polar motion.
    auto itrf = terrella::gcrf_to_itrf({5102508.9579, 6123011.4007, 6378136.9282}, {-4743.220157, 790.536497, 5533.755727},
                                       terrella::Time("2004-04-06T07:51:27.946047Z"));
    const double position_m[3] = {-1033479.383, 7901295.2754, 6380356.5958}, velocity_m_s[3] = {-3225.63652, -2872.45145, 5531.924446};
    for (int axis = 0; axis < 3; ++axis) {
        assert(std::fabs(itrf.position_m[axis] - position_m[axis]) < 20);
        assert(std::fabs(itrf.velocity_m_s[axis] - velocity_m_s[axis]) < 0.03);
    }
    auto options = terrella::default_options();
    options.width = 48;
    options.height = 32;
    assert(options.detail == 1 && options.directional_reflectance == 1);
    // Each option alone changes the image.
    auto seen = [&](std::uint8_t detail, std::uint8_t directional) {
        auto changed = options;
        changed.detail = detail;
        changed.directional_reflectance = directional;
        auto over_africa = terrella::camera_geodetic(10, 20, 5e5, 0, -60, 45, 1.5);
        return terrella::Earth(changed).image(over_africa, terrella::Time("2018-06-21T08:00:00Z")).rgba;
    };
    auto both = seen(1, 1);
    assert(both == seen(1, 1) && both != seen(0, 1) && both != seen(1, 0));
    terrella::Earth earth(options);
    TerrellaEarth *handle = earth.get();
    terrella::Earth moved(std::move(earth));
    assert(moved.get() == handle && earth.get() == nullptr);
    auto depth = moved.depth_m(camera, after);
    assert(depth.size() == 48 * 32 && std::isinf(depth[0]) && depth[16 * 48 + 24] > 1.3e7f);
    assert(moved.truth<double>(camera, after, "lat_deg").values.size() == depth.size());
    // A byte count that does not match the layer.
    auto normals = moved.truth<float, 3>(camera, after, "normal_itrf");
    assert(normals.components == 3 && normals.values.size() == 3 * depth.size());
    const float *normal = &normals.values[3 * (16 * 48 + 24)];
    assert(std::fabs(std::hypot(normal[0], normal[1], normal[2]) - 1) < 1e-5 && normal[0] > 0.9f);
    auto layers = terrella::layers();
    auto is_normal = [](const terrella::LayerInfo &layer) { return layer.name == "normal_itrf"; };
    auto listed = std::find_if(layers.begin(), layers.end(), is_normal);
    assert(listed != layers.end() && listed->components == 3 && listed->number_bytes == sizeof(float) && !listed->what.empty());
    assert(thrown([&] { return moved.truth<float>(camera, after, "lat_deg"); }) == TERRELLA_ARGUMENT);
    moved.resize(24, 16);
    assert(moved.image(camera, after).rgba.size() == 24 * 16 * 4);
    terrella::check(terrella_earth_resize(moved.get(), 12, 6));
    assert(moved.width() == 12 && moved.height() == 6 && moved.aspect() == 2);
    auto image = moved.image(camera, after);
    assert(image.rgba.size() == 12 * 6 * 4);
    for (std::size_t bytes : {image.rgba.size() - 4, image.rgba.size() + 3, std::size_t(0)}) {
        auto wrong = image;
        wrong.rgba.resize(bytes);
        assert(thrown([&] { wrong.save("wrong.png"); }) == TERRELLA_ARGUMENT);
    }
    moved = terrella::Earth(options);
    // The previous object is freed.
    assert(terrella_earth_resize(handle, 8, 8) == TERRELLA_HANDLE);

    // A sensor in a scene's text. Its lens moves the limb from r to r (1 + k1 r^2), in units of the focal length.
    auto disc = [](double k1) {
        auto scene = terrella::Scene::from_text(
            "[camera]\nmode = \"geodetic\"\nlat_deg = 10\nlon_deg = 20\nheight_km = 10000\n[earth]\natmosphere = \"none\"\n"
            "[sensor]\nsize = [64, 48]\nfocal_length_mm = 0.4\npixel_pitch_um = 10\nf_number = 4\nexposure_s = 2e-5\nfull_well_e = 20000\n"
            "oversampling = 1\nbits = 10\ndistortion = [" + std::to_string(k1) + ", 0, 0, 0]\n");
        auto lat = scene.raw_truth<double>(scene.start(), "lat_deg");
        auto frame = scene.raw(scene.start());
        assert(frame.width == 64 && frame.height == 48 && lat.values.size() == frame.numbers.size());
        auto [least, most] = std::minmax_element(frame.numbers.begin(), frame.numbers.end());
        assert(*least < *most && *most < 1024);
        return double(std::count_if(lat.values.begin(), lat.values.end(), [](double value) { return std::isfinite(value); }));
    };
    double r = std::tan(std::asin(6371.0 / 16371.0)), stretch = 1 + r * r;
    assert(std::fabs(disc(1) / disc(0) / (stretch * stretch) - 1) < 0.02);
    assert(thrown([] { return terrella::Scene::from_text("[sensor]\nsize = [64, 48]\nfull_well_e = 0\n"); }) == TERRELLA_SCENE);
    assert(thrown([] { return terrella::Scene::from_text("").raw(terrella::Time("2018-06-21T12:00:00Z")); }) == TERRELLA_SCENE);
    // An orbit file in place of a scene begins at the epoch of its elements.
    terrella::Scene orbit(argv[1], 32, 18);
    assert(orbit.info().satellites == 1 && orbit.start().utc().compare(0, 16, "2018-01-20T21:33") == 0);
    assert(std::hypot(orbit.satellite(0, orbit.start()).position_m[0], orbit.satellite(0, orbit.start()).position_m[1]) < 6.9e6);
    // The ISS of January 2018 over Graz: the passes that `terrella orbit --passes` finds.
    auto with_tracks = [](const char *tracks) {
        return terrella::Scene::from_text(std::string("[time]\nstart = \"2018-01-20T12:00:00Z\"\n[camera]\nmode = \"geodetic\"\nlat_deg = 30\n"
            "lon_deg = 20\nheight_km = 20000\n[orbit]\n") + tracks, "scene.toml", 96, 54);
    };
    auto plain = with_tracks("[tracks]\ntrail = false\nground_track = false\nfootprint = false\n");
    terrella::Time from("2018-01-20T12:00:00Z"), until("2018-01-21T12:00:00Z");
    auto passes = plain.passes(0, {47.07, 15.44, 350, 10}, from, until);
    assert(passes.size() >= 3 && passes.size() <= 8);
    for (std::size_t n = 0; n < passes.size(); ++n) {
        auto &pass = passes[n];
        assert(from < pass.end && pass.begin < until && pass.begin < pass.highest && pass.highest < pass.end);
        assert(pass.rises && pass.sets && pass.elevation_deg >= 10 && pass.elevation_deg <= 90 && pass.distance_m > 3.9e5);
        assert(n == 0 || passes[n - 1].end < pass.begin);
        // The satellite's elevation, seen from the place, matches the pass.
        auto state = plain.satellite(0, pass.highest);
        double lat = 47.07 * M_PI / 180, lon = 15.44 * M_PI / 180, e2 = 6.69437999014e-3;
        double up[3] = {std::cos(lat) * std::cos(lon), std::cos(lat) * std::sin(lon), std::sin(lat)};
        double normal = 6378137 / std::sqrt(1 - e2 * up[2] * up[2]), sum = 0, square = 0;
        for (int axis = 0; axis < 3; ++axis) {
            double there = (axis < 2 ? normal + 350 : normal * (1 - e2) + 350) * up[axis];
            double to = state.position_m[axis] - there;
            sum += to * up[axis];
            square += to * to;
        }
        assert(std::fabs(std::sqrt(square) - pass.distance_m) < 1);
        assert(std::fabs(std::asin(sum / std::sqrt(square)) * 180 / M_PI - pass.elevation_deg) < 1e-4);
    }
    assert(plain.passes(0, {47.07, 15.44, 350, 10}, from, until, 2).size() == 2);
    assert(plain.passes(0, {47.07, 15.44, 350, 10}, from, until, 0).empty());
    assert(thrown([&] { return plain.passes(0, {97, 15, 0, 0}, from, until); }) == TERRELLA_ARGUMENT);
    assert(thrown([&] { return plain.passes(9, {47, 15, 0, 0}, from, until); }) != TERRELLA_OK);
    // More passes than the class reads in one call: those of a single call.
    auto many = plain.passes(0, {47.07, 15.44, 350, 0}, from, until + 13 * 86400.0);
    TerrellaPassSearch search{47.07, 15.44, 350, 0, from, until + 13 * 86400.0, -6, nullptr};
    std::vector<TerrellaPass> at_once(many.size() + 10);
    std::size_t count = 0;
    terrella::check(terrella_scene_passes(plain.get(), 0, &search, at_once.data(), at_once.size(), &count));
    assert(many.size() > 64 && count == many.size());
    for (std::size_t n = 0; n < count; ++n) assert(many[n].begin == at_once[n].begin && many[n].end == at_once[n].end);
    // When the station can be seen, and how bright: never under a Sun that is never low enough.
    std::size_t visible = 0;
    auto fortnight = until + 13 * 86400.0;
    for (const auto &pass : plain.passes(0, {47.07, 15.44, 350, 10, -6, -1.8}, from, fortnight)) {
        assert(std::fabs(pass.duration_s - (pass.end - pass.begin)) < 1e-6);
        if (pass.visible_count == 0) continue;
        visible += 1;
        assert(pass.begin <= pass.visible_begin && pass.visible_begin <= pass.brightest && pass.brightest <= pass.visible_end &&
               pass.visible_end <= pass.end);
        assert(pass.magnitude > -5 && pass.magnitude < 6);
    }
    assert(visible > 0 && visible < many.size());
    for (const auto &pass : plain.passes(0, {47.07, 15.44, 350, 10, -90}, from, fortnight)) {
        assert(pass.visible_count == 0 && std::isnan(pass.magnitude));
    }
    assert(thrown([&] { return plain.passes(0, {47, 15, 0, 0, -6, 99}, from, until); }) == TERRELLA_ARGUMENT);
    auto track = plain.track(0, from, from + 5400, 91);
    assert(track.size() == 91);
    for (std::size_t n = 0; n < track.size(); ++n) assert(track[n].position_m == plain.satellite(0, from + 60.0 * n).position_m);
    assert(plain.track(0, from, from, 1).size() == 1 && plain.track(0, from, until, 0).empty());
    // Drawn over the globe too.
    auto drawn = with_tracks("[tracks]\ntrail = true\nground_track = true\n");
    assert(drawn.image(from).rgba != plain.image(from).rgba);

    auto built = std::to_string(TERRELLA_VERSION_MAJOR) + "." + std::to_string(TERRELLA_VERSION_MINOR) + "." + std::to_string(TERRELLA_VERSION_PATCH);
    assert(terrella::version() == built);
    return 0;
}
