// The Earth as a picture in memory, and as a PNG file.
//
//   cc still.c $(pkg-config --cflags --libs terrella) -o still && ./still earth.png
#include <stdio.h>
#include <stdlib.h>
#include <terrella.h>

static void check(TerrellaStatus status) {
    if (status != TERRELLA_OK) {
        fprintf(stderr, "%s: %s\n", terrella_status_name(status), terrella_message());
        exit(1);
    }
}

int main(int argc, char **argv) {
    TerrellaOptions options;
    check(terrella_options_default(&options));
    options.width = 640;
    options.height = 360;
    options.samples = 4;
    TerrellaEarth *earth;
    check(terrella_earth_new(&options, &earth));

    TerrellaTime time;
    check(terrella_time_utc("2018-06-21T16:00:00Z", &time));
    TerrellaCamera camera;  // 5000 km above Lake Chad, looking west, 60 degrees below level.
    check(terrella_camera_geodetic(13, 14, 5e6, 270, -60, 45, 640.0 / 360.0, &camera));

    size_t bytes = (size_t)640 * 360 * 4;
    unsigned char *rgba = malloc(bytes);
    if (!rgba) return 1;
    TerrellaDrawn drawn;
    check(terrella_earth_draw(earth, &camera, time, 30, TERRELLA_RGBA8, rgba, bytes, &drawn));
    printf("%llu triangles\n", (unsigned long long)drawn.triangles);
    check(terrella_write_png(argc > 1 ? argv[1] : "earth.png", rgba, 640, 360));

    free(rgba);
    check(terrella_earth_free(earth));
    return 0;
}
