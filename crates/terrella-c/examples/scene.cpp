// A scene file in C++: a picture, and the ground below its camera.
//
//   c++ -std=c++17 scene.cpp $(pkg-config --cflags --libs terrella) -o scene && ./scene config/iss.toml iss.png
#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <terrella.h>
#include <vector>

static void check(TerrellaStatus status) {
    if (status != TERRELLA_OK) throw std::runtime_error(terrella_message());
}

struct Free {
    void operator()(TerrellaScene *scene) const { terrella_scene_free(scene); }
};

int main(int argc, char **argv) try {
    if (argc < 3) throw std::runtime_error("give a scene file and a PNG file");
    TerrellaScene *opened = nullptr;
    check(terrella_scene_open(argv[1], 640, 360, nullptr, nullptr, &opened));
    std::unique_ptr<TerrellaScene, Free> scene(opened);
    TerrellaSceneInfo info;
    check(terrella_scene_info(scene.get(), &info));

    std::vector<unsigned char> rgba(std::size_t(info.width) * info.height * 4);
    check(terrella_scene_draw(scene.get(), info.start, TERRELLA_RGBA8, rgba.data(), rgba.size(), nullptr));
    check(terrella_write_png(argv[2], rgba.data(), info.width, info.height));

    std::vector<double> lat(rgba.size() / 4), lon(lat.size());
    TerrellaLayerBuffer layers[] = {{"lat_deg", lat.data(), lat.size() * sizeof(double)},
                                    {"lon_deg", lon.data(), lon.size() * sizeof(double)}};
    check(terrella_scene_truth(scene.get(), info.start, layers, 2, nullptr));
    std::size_t below = std::size_t(info.width) * (info.height - 1) + info.width / 2;
    char utc[40];
    check(terrella_time_text(info.start, utc, sizeof utc));
    std::printf("%s: the lowest line's middle shows %.3f N %.3f E\n", utc, lat[below], lon[below]);
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
