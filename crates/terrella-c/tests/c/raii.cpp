// What the classes of terrella.hpp do beside drawing: times, exceptions, moving, freeing.
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

int main() {
    terrella::Time before("2016-12-31T23:59:59Z"), after("2017-01-01T00:00:00.25Z");
    // A leap second lies between them.
    assert(after - before == 2.25 && before < after && before != after);
    assert((before + 2.25) == after && (after - 2.25) == before);
    assert((before + 1).utc() == "2016-12-31T23:59:60.000Z");
    assert(std::fabs(terrella::Time::from_unix(1483228800.25) - after) < 1e-6);
    assert(thrown([] { terrella::Time("yesterday"); }) == TERRELLA_ARGUMENT);
    assert(thrown([] { terrella::camera_geodetic(91, 0, 1e6, 0, -90, 45, 1); }) == TERRELLA_ARGUMENT);
    assert(thrown([] { terrella::Scene("nowhere.toml"); }) == TERRELLA_SCENE);

    auto camera = terrella::camera_look({2e7, 0, 0}, {-1, 0, 0}, {0, 0, 1}, 45, 1.5);
    assert(camera.eye_itrf_m[0] == 2e7);
    auto options = terrella::default_options();
    options.width = 48;
    options.height = 32;
    terrella::Earth earth(options);
    TerrellaEarth *handle = earth.get();
    terrella::Earth moved(std::move(earth));
    assert(moved.get() == handle && earth.get() == nullptr);
    auto depth = moved.depth_m(camera, after);
    assert(depth.size() == 48 * 32 && std::isinf(depth[0]) && depth[16 * 48 + 24] > 1.3e7f);
    assert(moved.truth<double>(camera, after, "lat_deg").values.size() == depth.size());
    // As many bytes as the layer does not have.
    assert(thrown([&] { moved.truth<float>(camera, after, "lat_deg"); }) == TERRELLA_ARGUMENT);
    moved.resize(24, 16);
    assert(moved.image(camera, after).rgba.size() == 24 * 16 * 4);
    moved = terrella::Earth(options);
    // What it held before is free.
    assert(terrella_earth_resize(handle, 8, 8) == TERRELLA_HANDLE);

    // A sensor of a scene's text: its lens moves the limb from r to r (1 + k1 r^2), both over the focal length.
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
    assert(thrown([] { terrella::Scene::from_text("[sensor]\nsize = [64, 48]\nfull_well_e = 0\n"); }) == TERRELLA_SCENE);
    assert(thrown([] { terrella::Scene::from_text("").raw(terrella::Time("2018-06-21T12:00:00Z")); }) == TERRELLA_SCENE);
    auto built = std::to_string(TERRELLA_VERSION_MAJOR) + "." + std::to_string(TERRELLA_VERSION_MINOR) + "." + std::to_string(TERRELLA_VERSION_PATCH);
    assert(terrella::version() == built);
    return 0;
}
