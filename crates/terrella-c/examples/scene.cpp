// A scene file in C++: a picture, and the ground below its camera.
//
//   c++ -std=c++17 scene.cpp $(pkg-config --cflags --libs terrella) -o scene && ./scene config/iss.toml iss.png
#include <cstdio>
#include <exception>
#include <terrella.hpp>

int main(int argc, char **argv) try {
    if (argc < 3) {
        std::fprintf(stderr, "give a scene file and a PNG file\n");
        return 1;
    }
    terrella::Scene scene(argv[1], 640, 360);
    scene.image(scene.start()).save(argv[2]);

    auto lat = scene.truth<double>(scene.start(), "lat_deg");
    auto lon = scene.truth<double>(scene.start(), "lon_deg");
    auto below = std::size_t(scene.info().width) * (scene.info().height - 1) + scene.info().width / 2;
    std::printf("%s: the lowest line's middle shows %.3f N %.3f E\n", scene.start().utc().c_str(), lat.values[below], lon.values[below]);
    return 0;
} catch (const std::exception &error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
}
