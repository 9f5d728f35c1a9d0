// Every detectable misuse gives a status and a message that names the argument, never a crash.
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <terrella.h>
#include <unistd.h>

static int failures;

static void expect(const char *what, TerrellaStatus status, TerrellaStatus wanted, const char *named) {
    const char *words = status == TERRELLA_OK ? "" : terrella_message();
    if (status != wanted || !strstr(words, named)) {
        fprintf(stderr, "%s: %s \"%s\", not %s that names \"%s\"\n", what, terrella_status_name(status), words,
                terrella_status_name(wanted), named);
        failures++;
    }
}

#define EXPECT(call, wanted, named) expect(#call, (call), (wanted), (named))

static TerrellaEarth *shared;
static TerrellaCamera camera;
static TerrellaTime noon;

static void *draw_many(void *failed) {
    unsigned char *rgba = malloc(32 * 18 * 4);
    for (int i = 0; i < 5; i++)
        if (terrella_earth_draw(shared, &camera, noon, 0, TERRELLA_RGBA8, rgba, 32 * 18 * 4, NULL) != TERRELLA_OK) *(int *)failed = 1;
    free(rgba);
    return NULL;
}

int main(int argc, char **argv) {
    if (argc < 2) return 2;
    if (strcmp(terrella_message(), "") != 0) return 3;
    char version[40];
    snprintf(version, sizeof version, "%d.%d.%d", TERRELLA_VERSION_MAJOR, TERRELLA_VERSION_MINOR, TERRELLA_VERSION_PATCH);
    if (strcmp(terrella_version(), version) != 0) failures++, fprintf(stderr, "header %s, library %s\n", version, terrella_version());
    // A message outlives later ones: programs read both after two calls.
    const char *kept = terrella_message();
    for (int n = 0; n < 50; n++) terrella_options_default(NULL), terrella_time_utc("a long text that is no date", &noon);
    if (terrella_message() != kept || !strstr(kept, "text")) failures++, fprintf(stderr, "the message moved: %s\n", kept);
    EXPECT(terrella_options_default(NULL), TERRELLA_NULL, "options");
    EXPECT(terrella_time_utc(NULL, &noon), TERRELLA_NULL, "text");
    EXPECT(terrella_time_utc("2018-06-21T12:00:00Z", NULL), TERRELLA_NULL, "time");
    EXPECT(terrella_time_utc("noon", &noon), TERRELLA_ARGUMENT, "text");
    EXPECT(terrella_time_utc("\xff", &noon), TERRELLA_ARGUMENT, "UTF-8");
    EXPECT(terrella_time_unix(NAN, &noon), TERRELLA_ARGUMENT, "unix_s");
    EXPECT(terrella_time_utc("2018-06-21T12:00:00Z", &noon), TERRELLA_OK, "");
    TerrellaTime other;
    EXPECT(terrella_time_unix(1529582400, &other), TERRELLA_OK, "");
    if (other.tai_s != noon.tai_s || other.tai_ns != noon.tai_ns) failures++, fprintf(stderr, "two ways to noon differ\n");
    EXPECT(terrella_time_add(noon, INFINITY, &other), TERRELLA_ARGUMENT, "elapsed_s");
    EXPECT(terrella_time_add(noon, 1e10 - 1, &other), TERRELLA_ARGUMENT, "elapsed_s");
    EXPECT(terrella_itrf_from_gcrf(noon, NULL), TERRELLA_NULL, "matrix");
    char text[40];
    text[0] = '!';
    EXPECT(terrella_time_text(noon, text, 5), TERRELLA_ARGUMENT, "bytes");
    if (text[0] != '!') failures++, fprintf(stderr, "a short buffer was written to\n");
    EXPECT(terrella_time_text(noon, NULL, 40), TERRELLA_NULL, "text");
    EXPECT(terrella_time_text(noon, text, sizeof text), TERRELLA_OK, "");
    if (strcmp(text, "2018-06-21T12:00:00.000Z") != 0) failures++, fprintf(stderr, "%s\n", text);

    EXPECT(terrella_camera_geodetic(91, 0, 1e7, 0, -90, 45, 1, &camera), TERRELLA_ARGUMENT, "lat_deg");
    EXPECT(terrella_camera_geodetic(0, 0, 1e7, 0, -90, NAN, 1, &camera), TERRELLA_ARGUMENT, "fov_deg");
    EXPECT(terrella_camera_geodetic(0, 0, 1e7, 0, -90, 45, 0, &camera), TERRELLA_ARGUMENT, "aspect");
    EXPECT(terrella_camera_geodetic(0, 0, 1e7, 0, -90, 45, 1, NULL), TERRELLA_NULL, "camera");
    double eye[3] = {2e7, 0, 0}, nowhere[3] = {0, 0, 0}, up[3] = {0, 0, 1}, lost[3] = {NAN, 0, 0};
    EXPECT(terrella_camera_look(eye, nowhere, up, 45, 1, &camera), TERRELLA_ARGUMENT, "forward");
    double km[3] = {6778, 0, 0};
    EXPECT(terrella_camera_look(km, up, up, 45, 1, &camera), TERRELLA_ARGUMENT, "metres");
    EXPECT(terrella_camera_look(lost, up, up, 45, 1, &camera), TERRELLA_ARGUMENT, "eye_itrf_m");
    EXPECT(terrella_camera_look(eye, up, NULL, 45, 1, &camera), TERRELLA_NULL, "up");
    EXPECT(terrella_camera_geodetic(0, 0, 1e7, 0, -90, 45, 32.0 / 18, &camera), TERRELLA_OK, "");

    TerrellaOptions options;
    EXPECT(terrella_options_default(&options), TERRELLA_OK, "");
    options.width = 32;
    options.height = 18;
    TerrellaEarth *earth = NULL;
    EXPECT(terrella_earth_new(NULL, &earth), TERRELLA_NULL, "options");
    EXPECT(terrella_earth_new(&options, NULL), TERRELLA_NULL, "earth");
    TerrellaOptions wrong = options;
    wrong.samples = 3;
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_ARGUMENT, "samples");
    wrong = options;
    wrong.width = 0;
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_ARGUMENT, "size");
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_ARGUMENT, "at least 1");
    wrong = options;
    wrong.air = 7;
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_ARGUMENT, "options.air");
    wrong = options;
    wrong.exposure_ev = NAN;
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_ARGUMENT, "exposure_ev");
    wrong = options;
    wrong.textures = "/nowhere";
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_FILE, "/nowhere");
    wrong = options;
    wrong.adapter = "no such adapter";
    EXPECT(terrella_earth_new(&wrong, &earth), TERRELLA_DEVICE, "no such adapter");
    if (earth) failures++, fprintf(stderr, "a call that failed wrote a handle\n");
    EXPECT(terrella_earth_new(&options, &earth), TERRELLA_OK, "");

    size_t bytes = 32 * 18 * 4;
    unsigned char *pixels = malloc(4 * bytes);
    EXPECT(terrella_earth_draw(NULL, &camera, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_NULL, "earth");
    EXPECT(terrella_earth_draw((TerrellaEarth *)pixels, &camera, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_HANDLE, "earth");
    EXPECT(terrella_earth_draw(earth, NULL, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_NULL, "camera");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 0, TERRELLA_RGBA8, NULL, bytes, NULL), TERRELLA_NULL, "pixels");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 0, TERRELLA_RGBA8, pixels, bytes - 1, NULL), TERRELLA_ARGUMENT, "bytes");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 0, 7, pixels, bytes, NULL), TERRELLA_ARGUMENT, "format");
    EXPECT(terrella_earth_draw(earth, &camera, noon, -1, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_ARGUMENT, "wait_s");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 0, TERRELLA_RGBA32F, pixels + 1, 4 * bytes, NULL), TERRELLA_ARGUMENT, "pixels");
    TerrellaTime never = {-5, 0};
    EXPECT(terrella_earth_draw(earth, &camera, never, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_ARGUMENT, "time");
    TerrellaCamera broken = camera;
    broken.eye_itrf_m[0] = NAN;
    EXPECT(terrella_earth_draw(earth, &broken, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_ARGUMENT, "camera");
    broken = camera;
    broken.view_from_itrf[0] = 5;
    EXPECT(terrella_earth_draw(earth, &broken, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_ARGUMENT, "view_from_itrf");
    broken = camera;
    memset(broken.clip_from_view, 0, sizeof broken.clip_from_view);
    EXPECT(terrella_earth_draw(earth, &broken, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_ARGUMENT, "clip_from_view");
    EXPECT(terrella_earth_resize(earth, 0, 5), TERRELLA_ARGUMENT, "size");
    EXPECT(terrella_earth_resize(earth, 1000000, 1000000), TERRELLA_ARGUMENT, "size");
    uint32_t wide = 0, high = 0;
    EXPECT(terrella_earth_size(earth, &wide, NULL), TERRELLA_NULL, "height");
    EXPECT(terrella_earth_size(earth, NULL, &high), TERRELLA_NULL, "width");
    EXPECT(terrella_earth_size(NULL, &wide, &high), TERRELLA_NULL, "earth");
    EXPECT(terrella_earth_size(earth, &wide, &high), TERRELLA_OK, "");
    if (wide != 32 || high != 18) failures++, fprintf(stderr, "%u x %u pixels\n", wide, high);

    // All formats; both formats of linear light agree.
    TerrellaDrawn drawn;
    EXPECT(terrella_earth_draw(earth, &camera, noon, 5, TERRELLA_RGBA8, pixels, bytes, &drawn), TERRELLA_OK, "");
    if (drawn.triangles == 0 || pixels[4 * (9 * 32 + 16)] == 0) failures++, fprintf(stderr, "nothing is drawn\n");
    float *light = malloc(4 * bytes);
    uint16_t *halves = malloc(2 * bytes);
    EXPECT(terrella_earth_draw(earth, &camera, noon, 5, TERRELLA_RGBA32F, light, 4 * bytes, NULL), TERRELLA_OK, "");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 5, TERRELLA_RGBA16F, halves, 2 * bytes, NULL), TERRELLA_OK, "");
    for (size_t i = 0; i < bytes; i++) {
        int exponent = halves[i] >> 10 & 31;
        float half = exponent ? ldexpf((halves[i] & 1023) + 1024, exponent - 25) : ldexpf(halves[i] & 1023, -24);
        if (fabsf(half - light[i]) > 1e-7f + light[i] / 1024) {
            failures++;
            fprintf(stderr, "half %zu is %g, not %g\n", i, half, light[i]);
            break;
        }
    }
    free(halves);
    free(light);

    // Depth and layers.
    float *depth = malloc(bytes);
    double *lat = malloc(2 * bytes);
    EXPECT(terrella_earth_depth(earth, &camera, noon, 0, depth, 5), TERRELLA_ARGUMENT, "count");
    EXPECT(terrella_earth_depth(earth, &camera, noon, 0, NULL, 32 * 18), TERRELLA_NULL, "depth_m");
    EXPECT(terrella_earth_depth(earth, &camera, noon, 0, depth, 32 * 18), TERRELLA_OK, "");
    if (fabsf(depth[9 * 32 + 16] - 1e7f) > 1e5f || !isinf(depth[0])) failures++, fprintf(stderr, "depth %g\n", depth[9 * 32 + 16]);
    TerrellaLayerBuffer layer = {"lat_deg", lat, 2 * bytes};
    EXPECT(terrella_earth_truth(earth, &camera, noon, 0, &layer, 1, NULL), TERRELLA_OK, "");
    if (!(fabs(lat[9 * 32 + 16]) < 5)) failures++, fprintf(stderr, "latitude %g\n", lat[9 * 32 + 16]);
    EXPECT(terrella_earth_truth(earth, &camera, noon, 0, NULL, 1, NULL), TERRELLA_NULL, "layers");
    layer.name = "colour";
    EXPECT(terrella_earth_truth(earth, &camera, noon, 0, &layer, 1, NULL), TERRELLA_ARGUMENT, "layers[0].name");
    layer.name = "lat_deg";
    layer.bytes--;
    EXPECT(terrella_earth_truth(earth, &camera, noon, 0, &layer, 1, NULL), TERRELLA_ARGUMENT, "layers[0].bytes");
    free(lat);
    free(depth);
    TerrellaLayer reported;
    for (size_t n = 0; n < terrella_layer_count(); n++) EXPECT(terrella_layer(n, &reported), TERRELLA_OK, "");
    EXPECT(terrella_layer(terrella_layer_count(), &reported), TERRELLA_ARGUMENT, "index");
    EXPECT(terrella_layer(0, NULL), TERRELLA_NULL, "layer");

    // Threads share a handle.
    shared = earth;
    int failed = 0;
    pthread_t threads[3];
    for (int i = 0; i < 3; i++) pthread_create(&threads[i], NULL, draw_many, &failed);
    for (int i = 0; i < 3; i++) pthread_join(threads[i], NULL);
    if (failed) failures++, fprintf(stderr, "threads cannot share a handle\n");

    // A forked process has no device.
    pid_t child = fork();
    if (child == 0) {
        EXPECT(terrella_earth_draw(earth, &camera, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_FORKED, "earth");
        EXPECT(terrella_earth_free(earth), TERRELLA_OK, "");
        _exit(failures ? 1 : 0);
    }
    int status = 1;
    waitpid(child, &status, 0);
    if (status != 0) failures++, fprintf(stderr, "the fork ended with %d\n", status);

    // Scenes.
    TerrellaScene *scene = NULL;
    EXPECT(terrella_scene_open(NULL, 0, 0, NULL, NULL, &scene), TERRELLA_NULL, "path");
    EXPECT(terrella_scene_open(argv[1], 0, 0, NULL, NULL, NULL), TERRELLA_NULL, "scene");
    EXPECT(terrella_scene_open(argv[1], 32, 18, "/nowhere", NULL, &scene), TERRELLA_FILE, "/nowhere does not exist");
    EXPECT(terrella_scene_open("/nowhere.toml", 0, 0, NULL, NULL, &scene), TERRELLA_SCENE, "/nowhere.toml");
    EXPECT(terrella_scene_open(argv[1], 0, 18, NULL, NULL, &scene), TERRELLA_ARGUMENT, "size");
    EXPECT(terrella_scene_open(argv[1], 32, 18, NULL, NULL, &scene), TERRELLA_OK, "");
    TerrellaSceneInfo info;
    EXPECT(terrella_scene_info(scene, NULL), TERRELLA_NULL, "info");
    EXPECT(terrella_scene_info(scene, &info), TERRELLA_OK, "");
    EXPECT(terrella_scene_info((TerrellaScene *)earth, &info), TERRELLA_HANDLE, "an Earth");
    EXPECT(terrella_scene_draw(scene, info.start, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_OK, "");
    EXPECT(terrella_time_utc("2050-01-01T00:00:00Z", &other), TERRELLA_OK, "");
    EXPECT(terrella_scene_draw(scene, other, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_SCENE, "2050");
    double position[3];
    EXPECT(terrella_scene_satellite(scene, 0, info.start, position, NULL), TERRELLA_OK, "");
    EXPECT(terrella_scene_satellite(scene, info.satellites, info.start, position, NULL), TERRELLA_ARGUMENT, "index");
    EXPECT(terrella_scene_satellite(scene, 0, info.start, NULL, NULL), TERRELLA_NULL, "position_m");
    uint32_t width, height;
    uint16_t numbers[4];
    EXPECT(terrella_scene_sensor_size(scene, &width, &height), TERRELLA_SCENE, "sensor");
    EXPECT(terrella_scene_raw(scene, info.start, numbers, 4, NULL), TERRELLA_SCENE, "sensor");
    TerrellaScene *seen = NULL;
    const char *sensor = "[sensor]\nsize = [2, 2]\nfocal_length_mm = 5\npixel_pitch_um = 5\nf_number = 4\nexposure_s = 1e-3\nfull_well_e = 1e4\n";
    EXPECT(terrella_scene_parse(NULL, "a.toml", 0, 0, NULL, NULL, &seen), TERRELLA_NULL, "toml");
    EXPECT(terrella_scene_parse(sensor, NULL, 0, 0, NULL, NULL, &seen), TERRELLA_NULL, "path");
    EXPECT(terrella_scene_parse("[sensor]\nsize = 2\n", "a.toml", 0, 0, NULL, NULL, &seen), TERRELLA_SCENE, "a.toml:2");
    EXPECT(terrella_scene_parse(sensor, "a.toml", 0, 0, NULL, NULL, &seen), TERRELLA_OK, "");
    EXPECT(terrella_scene_sensor_size(seen, &width, NULL), TERRELLA_NULL, "height");
    EXPECT(terrella_scene_sensor_size(seen, &width, &height), TERRELLA_OK, "");
    EXPECT(terrella_scene_raw(seen, info.start, numbers, 3, NULL), TERRELLA_ARGUMENT, "count");
    EXPECT(terrella_scene_raw(seen, info.start, NULL, 4, NULL), TERRELLA_NULL, "numbers");
    TerrellaLayerBuffer small = {"lat_deg", numbers, sizeof numbers};
    EXPECT(terrella_scene_raw_truth(seen, info.start, &small, 1, NULL), TERRELLA_ARGUMENT, "layers[0].bytes");
    EXPECT(terrella_scene_free(seen), TERRELLA_OK, "");
    TerrellaPassSearch search = {.lat_deg = 48.1, .lon_deg = 11.6, .height_m = 520, .min_elevation_deg = 10, .from = info.start, .until = info.start};
    search.until.tai_s += 86400;
    TerrellaPass passes[8];
    size_t found = 0;
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 8, &found), TERRELLA_OK, "");
    /* A space station passes over Munich four to seven times a day. */
    if (found < 4 || found > 7) {
        fprintf(stderr, "%zu passes\n", found);
        return 1;
    }
    for (size_t n = 0; n < found; n++) {
        const TerrellaPass *pass = &passes[n];
        int64_t rising_s = pass->highest.tai_s - pass->begin.tai_s, setting_s = pass->end.tai_s - pass->highest.tai_s;
        if (rising_s < 0 || setting_s < 0 || rising_s + setting_s > 600 || !pass->rises || !pass->sets || pass->elevation_deg < 10 ||
            pass->distance_m < 400e3 || pass->distance_m > 1800e3) {
            fprintf(stderr, "pass %zu\n", n);
            return 1;
        }
    }
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 2, &found), TERRELLA_OK, "");
    if (found != 2) {
        return 1;
    }
    // One after another, they end.
    TerrellaPassSearch page = search;
    size_t paged = 0;
    for (;;) {
        EXPECT(terrella_scene_passes(scene, 0, &page, passes, 1, &found), TERRELLA_OK, "");
        if (found == 0 || paged > 20) break;
        page.from = passes[0].end;
        paged++;
    }
    if (paged < 4 || paged > 7) failures++, fprintf(stderr, "%zu passes one after another\n", paged);
    EXPECT(terrella_scene_passes(scene, 0, &search, NULL, 0, &found), TERRELLA_OK, "");
    if (found != 0) failures++, fprintf(stderr, "%zu passes without room\n", found);
    page = search;
    page.until.tai_s = page.from.tai_s - 1;
    EXPECT(terrella_scene_passes(scene, 0, &page, passes, 8, &found), TERRELLA_ARGUMENT, "search.until");
    page.from.tai_s += 366 * 86400;
    page.until.tai_s = page.from.tai_s + 86400;
    EXPECT(terrella_scene_passes(scene, 0, &page, passes, 8, &found), TERRELLA_SCENE, "outside of the data");
    EXPECT(terrella_scene_passes(scene, 9, &search, passes, 8, &found), TERRELLA_ARGUMENT, "index");
    EXPECT(terrella_scene_passes(scene, 0, &search, NULL, 8, &found), TERRELLA_NULL, "passes");
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 8, NULL), TERRELLA_NULL, "count");
    double bright = -31;
    search.standard_magnitude = &bright;
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 8, &found), TERRELLA_ARGUMENT, "search.standard_magnitude");
    search.standard_magnitude = NULL;
    search.sun_below_deg = 91;
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 8, &found), TERRELLA_ARGUMENT, "search.sun_below_deg");
    search.sun_below_deg = -6;
    search.lat_deg = 91;
    EXPECT(terrella_scene_passes(scene, 0, &search, passes, 8, &found), TERRELLA_ARGUMENT, "search.lat_deg");
    EXPECT(terrella_scene_free(scene), TERRELLA_OK, "");
    EXPECT(terrella_scene_free(scene), TERRELLA_HANDLE, "freed already");

    // Double free, and use after free.
    EXPECT(terrella_earth_free(earth), TERRELLA_OK, "");
    EXPECT(terrella_earth_free(earth), TERRELLA_HANDLE, "freed already");
    EXPECT(terrella_earth_draw(earth, &camera, noon, 0, TERRELLA_RGBA8, pixels, bytes, NULL), TERRELLA_HANDLE, "freed already");
    EXPECT(terrella_earth_free(NULL), TERRELLA_NULL, "earth");
    EXPECT(terrella_write_png(NULL, pixels, 4, 4), TERRELLA_NULL, "path");
    EXPECT(terrella_write_png("a.png", NULL, 4, 4), TERRELLA_NULL, "rgba");
    EXPECT(terrella_write_png("a.png", pixels, 0, 4), TERRELLA_ARGUMENT, "width");
    EXPECT(terrella_write_png("a.png", pixels, 4, 0), TERRELLA_ARGUMENT, "at least 1");
    EXPECT(terrella_write_png("/dev/null/a.png", pixels, 4, 4), TERRELLA_FILE, "/dev/null");

    // Vulkan calls that need no Vulkan.
    const char *name = "";
    TerrellaVulkanHost host = {0};
    TerrellaVulkanEarth *vulkan = NULL;
    EXPECT(terrella_vulkan_extension(NULL, 0, &name), TERRELLA_NULL, "host");
    EXPECT(terrella_vulkan_extension(&host, 0, &name), TERRELLA_NULL, "get_instance_proc_addr");
    EXPECT(terrella_vulkan_earth_new(&host, &options, 12345, &vulkan), TERRELLA_ARGUMENT, "vk_format");
    EXPECT(terrella_vulkan_earth_new(&host, &options, 43, &vulkan), TERRELLA_NULL, "host.device");
    EXPECT(terrella_vulkan_earth_free(NULL), TERRELLA_NULL, "earth");
    TerrellaVulkanImage image = {1, 0, 5, 9};
    EXPECT(terrella_vulkan_draw(NULL, &camera, noon, 0, &image, NULL), TERRELLA_ARGUMENT, "layout");
    image.layout = TERRELLA_LAYOUT_SHADER;
    EXPECT(terrella_vulkan_draw(NULL, &camera, noon, 0, &image, NULL), TERRELLA_NULL, "earth");
    free(pixels);
    return failures ? 1 : 0;
}
