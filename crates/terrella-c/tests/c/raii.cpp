// What the classes of terrella.hpp do beside drawing: times, exceptions, moving, freeing.
#undef NDEBUG
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
    auto built = std::to_string(TERRELLA_VERSION_MAJOR) + "." + std::to_string(TERRELLA_VERSION_MINOR) + "." + std::to_string(TERRELLA_VERSION_PATCH);
    assert(terrella::version() == built);
    return 0;
}
