// The C interface of Terrella, a realistic Earth. Generated from crates/terrella-c by cbindgen; a test compares it. Do not edit.
//
// Lengths are metres, angles degrees where a name says so, axes Earth-fixed (ITRF: x to 0 degrees east on the equator, z to the north pole).
// Pictures have their first row at the top. Texts are UTF-8.
//
// Every call returns a status; terrella_message returns the error message of the calling thread's last failure. No call ends the program, and
// no exception or panic escapes.
//
// Threads: any thread may call any function. Calls with one handle are serialised. Handles of TerrellaVulkanEarth use the caller's queue, and the
// caller must synchronise access to it. Handles do not survive a fork: the child process makes its own.


#ifndef TERRELLA_H
#define TERRELLA_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

// The Earth's rate of rotation about the z axis of ITRF, radians per second.
#define TERRELLA_EARTH_ROTATION_RAD_S 7.29211514670698e-5

// The major version of this header. A library of another major version has another soname, and before 1.0 one of another minor version.
#define TERRELLA_VERSION_MAJOR 0

// The minor version of this header.
#define TERRELLA_VERSION_MINOR 1

// The patch version of this header.
#define TERRELLA_VERSION_PATCH 0

// The result of a call. `terrella_message` returns the error message.
typedef enum {
  // Done.
  TERRELLA_OK = 0,
  // A required pointer is null.
  TERRELLA_NULL = 1,
  // An argument is out of range or invalid.
  TERRELLA_ARGUMENT = 2,
  // A freed handle, a value that was never a handle, or a handle of another type.
  TERRELLA_HANDLE = 3,
  // A scene is invalid, or does not cover the requested time.
  TERRELLA_SCENE = 4,
  // A file cannot be read or is invalid.
  TERRELLA_FILE = 5,
  // No graphics adapter, out of device memory, a missing device feature, or a lost device.
  TERRELLA_DEVICE = 6,
  // The handle was made before `fork`, and this is the child.
  TERRELLA_FORKED = 7,
  // An internal error. Do not use the handle of the call any more. Please report it.
  TERRELLA_BROKEN = 8,
} TerrellaStatus;

// An Earth with its own device. An opaque handle. Any thread may use it; calls from several threads are serialised.
typedef struct TerrellaEarth TerrellaEarth;

// A scene file with its own device. An opaque handle. Any thread may use it; calls from several threads are serialised.
typedef struct TerrellaScene TerrellaScene;

// An Earth on a program's own Vulkan device. An opaque handle. The caller orders calls: no other thread submits to the queue during a
// call.
typedef struct TerrellaVulkanEarth TerrellaVulkanEarth;

// An instant, in international atomic time (TAI) since 1900-01-01T00:00:00 TAI. Differences are elapsed time, through leap seconds too.
// `terrella_time_utc` and `terrella_time_unix` make it.
typedef struct {
  // Whole seconds.
  int64_t tai_s;
  // Nanoseconds after that, 0 to 999 999 999.
  uint32_t tai_ns;
} TerrellaTime;

// Position, attitude and projection of a camera. Fill it with `terrella_camera_geodetic` or `terrella_camera_look`, or yourself.
typedef struct {
  // The eye: Earth-fixed axes (ITRF: x to 0° E on the equator, z to the north pole), metres; at least 6 000 000 m from the centre.
  double eye_itrf_m[3];
  // Rotation from Earth-fixed axes to those of the view (x right, y up, −z forward), row by row.
  double view_from_itrf[9];
  // Projection from view to clip space as Vulkan has it (z from 0 to 1) but y upwards, row by row. Depth reversed: nearer is larger.
  double clip_from_view[16];
} TerrellaCamera;

// Options of an Earth. Fill them with `terrella_options_default`, then change what you need.
typedef struct {
  // Width of pictures, pixels.
  uint32_t width;
  // Height of pictures, pixels.
  uint32_t height;
  // Samples per pixel of displayed pictures, 1 or 4.
  uint32_t samples;
  // Folder of maps; null takes that of the environment variable TERRELLA_TEXTURES, else `textures` or `../share/terrella/textures`
  // beside the program, else that of the source tree that the library was built from.
  const char *textures;
  // Part of the name of the graphics adapter, letter case aside; null takes the best.
  const char *adapter;
  // Exposure value, EV.
  double exposure_ev;
  // Whether each image is metered, 0 or 1, instead of `exposure_ev`.
  uint8_t auto_exposure;
  // Whether the atmosphere is drawn, 0 or 1.
  uint8_t air;
  // Whether clouds are drawn, 0 or 1.
  uint8_t clouds;
  // Whether city lights are drawn, 0 or 1.
  uint8_t night_lights;
  // Whether synthetic detail below the maps' texels is drawn, 0 or 1.
  uint8_t detail;
  // Whether land and clouds reflect sunlight by direction, 0 or 1. With 0 they are Lambertian.
  uint8_t directional_reflectance;
} TerrellaOptions;

// Pixel format of an image: a constant that begins with `TERRELLA_RGBA`.
typedef uint32_t TerrellaFormat;

// Statistics of an image.
typedef struct {
  // Triangles.
  uint64_t triangles;
  // Tiles of a pack that did not arrive in time; coarser ones are drawn instead.
  uint64_t missing_tiles;
  // The exposure value that was used, EV.
  double exposure_ev;
} TerrellaDrawn;

// A requested truth layer and your buffer for it: row by row from the top, NaN where there is no value.
typedef struct {
  // Its name.
  const char *name;
  // Buffer for its numbers, float or double as the layer says.
  void *values;
  // Bytes of that buffer: width × height × components × number_bytes.
  size_t bytes;
} TerrellaLayerBuffer;

// Place and time interval of a search for passes.
typedef struct {
  // Geodetic latitude (WGS84), degrees, −90 to 90.
  double lat_deg;
  // Longitude east, degrees, −360 to 360.
  double lon_deg;
  // Height above the ellipsoid, metres, −12 000 to 100 000.
  double height_m;
  // Elevation mask: how high above the horizon a pass begins and ends, degrees, 0 to 89.999.
  double min_elevation_deg;
  // Passes that are in progress at this instant or begin later.
  TerrellaTime from;
  // And that begin before this one. It is not before `from`.
  TerrellaTime until;
  // The satellite can be seen while it is outside the Earth's umbra and the Sun is lower than this, degrees, −90 to 90. Civil twilight
  // ends at −6.
  double sun_below_deg;
  // Its magnitude at a distance of 1000 km with half of its disc lit, −30 to 30. If this is null, no magnitudes are estimated.
  const double *standard_magnitude;
} TerrellaPassSearch;

// A pass of a satellite. Azimuths count from north to east, degrees.
typedef struct {
  // When it rises above the mask; `from`, or the start of the satellite's data, if it is above the mask then.
  TerrellaTime begin;
  // Azimuth then.
  double begin_azimuth_deg;
  // When it is highest.
  TerrellaTime highest;
  // Azimuth then.
  double highest_azimuth_deg;
  // Elevation then, degrees.
  double elevation_deg;
  // Distance then, metres.
  double distance_m;
  // When it sets; `until`, or the end of the satellite's data, if it is above the mask then.
  TerrellaTime end;
  // Azimuth then.
  double end_azimuth_deg;
  // Whether it rises at `begin`.
  bool rises;
  // Whether it sets at `end`.
  bool sets;
  // Its length, seconds.
  double duration_s;
  // How often the satellite becomes visible in it; 0 if never. The rest applies only if this is not 0.
  uint32_t visible_count;
  // When it is first visible.
  TerrellaTime visible_begin;
  // When it is last visible.
  TerrellaTime visible_end;
  // When it is brightest; `visible_begin` without a standard magnitude.
  TerrellaTime brightest;
  // Its magnitude then; NaN without a standard magnitude.
  double magnitude;
} TerrellaPass;

// Image size, playback time and satellites of a scene.
typedef struct {
  // Width of pictures, pixels.
  uint32_t width;
  // Height of pictures, pixels.
  uint32_t height;
  // The first frame.
  TerrellaTime start;
  // Where playback ends.
  TerrellaTime end;
  // Frames of one playback.
  uint64_t frames;
  // Frames per second of playback.
  double frame_rate_hz;
  // Satellites.
  size_t satellites;
} TerrellaSceneInfo;

// Description of a truth layer. Its texts are never freed.
typedef struct {
  // Its name.
  const char *name;
  // The unit of its numbers, "1" if they have none.
  const char *unit;
  // What they mean.
  const char *what;
  // Numbers per pixel.
  uint32_t components;
  // Bytes of a number: 4 for float, 8 for double.
  uint32_t number_bytes;
} TerrellaLayer;

// The program's Vulkan objects. They must outlive what is made with them.
typedef struct {
  // The function vkGetInstanceProcAddr, as a PFN_vkVoidFunction.
  void (*get_instance_proc_addr)(void);
  // The VkInstance.
  void *instance;
  // The VkPhysicalDevice.
  void *physical_device;
  // The VkDevice, made with all extensions that `terrella_vulkan_extension` names and with the features that the physical device has (as
  // vkGetPhysicalDeviceFeatures gives them). May be null where only extensions are asked for.
  void *device;
  // The version of Vulkan that the instance was made for, as VK_MAKE_API_VERSION; at least 1.1.
  uint32_t api_version;
  // Family of the queue, which must support graphics.
  uint32_t queue_family;
  // Index of the queue in its family.
  uint32_t queue_index;
  // Names of the device's enabled extensions.
  const char *const *device_extensions;
  // Number of these extensions.
  size_t device_extension_count;
} TerrellaVulkanHost;

// Layout of an image after drawing: a constant that begins with `TERRELLA_LAYOUT`.
typedef uint32_t TerrellaLayout;

// An image of the program to draw into.
typedef struct {
  // The VkImage: two-dimensional, one level, one layer, one sample, exclusive to the queue's family, usage
  // VK_IMAGE_USAGE_COLOR_ATTACHMENT_BIT and what `layout` needs. Its contents are discarded.
  uint64_t image;
  // Width, pixels.
  uint32_t width;
  // Height, pixels.
  uint32_t height;
  // Its layout after drawing.
  TerrellaLayout layout;
} TerrellaVulkanImage;

// The displayed image: red, green, blue in sRGB and opacity, one byte each.
#define TERRELLA_RGBA8 0

// Linear scene-referred light (a white sheet that faces the Sun in space is 1): red, green, blue and an unused number, IEEE half floats.
#define TERRELLA_RGBA16F 1

// The same as 32-bit floats.
#define TERRELLA_RGBA32F 2

// To be copied from: VK_IMAGE_LAYOUT_TRANSFER_SRC_OPTIMAL. The image has VK_IMAGE_USAGE_TRANSFER_SRC_BIT.
#define TERRELLA_LAYOUT_TRANSFER 0

// To be read by shaders: VK_IMAGE_LAYOUT_SHADER_READ_ONLY_OPTIMAL. The image has VK_IMAGE_USAGE_SAMPLED_BIT.
#define TERRELLA_LAYOUT_SHADER 1

// To be drawn over: VK_IMAGE_LAYOUT_COLOR_ATTACHMENT_OPTIMAL.
#define TERRELLA_LAYOUT_ATTACHMENT 2

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Writes the rotation from GCRF axes (those of ICRF and, to 0.02 arc seconds, J2000) to Earth-fixed axes (ITRF) at an instant: nine
// numbers, row by row. A position or direction in ITRF is this matrix times the one in GCRF.
//
// A velocity in ITRF is relative to the rotating Earth: with the matrix R, the position r in ITRF and the vector w = (0, 0,
// `TERRELLA_EARTH_ROTATION_RAD_S`), it is R v − w × r.
//
// Precession and nutation are those of IAU 2000B. UT1 is taken as UTC, and polar motion as zero: up to 420 m and 20 m at the ground. Scenes
// without measured Earth orientation use the same rotation.
//
// # Safety
// `matrix` points to writable memory for nine numbers.
TerrellaStatus terrella_itrf_from_gcrf(TerrellaTime time, double *matrix);

// A camera above a place: latitude and longitude in degrees (geodetic, WGS84), height in metres. With heading 0 and pitch −90 it looks
// straight down, north upwards; heading turns it clockwise from north, pitch raises it, 0 is level. `fov_deg` is the vertical field of
// view, `aspect` width over height.
//
// # Safety
// `camera` points to writable memory.
TerrellaStatus terrella_camera_geodetic(double lat_deg,
                                        double lon_deg,
                                        double height_m,
                                        double heading_deg,
                                        double pitch_deg,
                                        double fov_deg,
                                        double aspect,
                                        TerrellaCamera *camera);

// A camera at `eye_itrf_m` (three numbers, metres) that looks along `forward` with `up` upwards on screen (three numbers each, of any
// length). If `up` is parallel to `forward`, the roll is the library's choice, always the same one for the same `forward`. An eye less than
// 6 000 000 m from the Earth's centre is an error.
//
// # Safety
// Each points to three numbers; `camera` points to writable memory.
TerrellaStatus terrella_camera_look(const double *eye_itrf_m,
                                    const double *forward,
                                    const double *up,
                                    double fov_deg,
                                    double aspect,
                                    TerrellaCamera *camera);

// Opens a graphics adapter and creates an Earth. Free it with `terrella_earth_free`. On failure `*earth` is unchanged.
//
// # Safety
// `options` points to options whose texts end with zero bytes; `earth` points to writable memory.
TerrellaStatus terrella_earth_new(const TerrellaOptions *options, TerrellaEarth **earth);

// Frees an Earth. A null or freed handle is an error. Any thread may call it, also while another one draws with this Earth: that call is
// completed, and every later one is `TERRELLA_HANDLE`.
TerrellaStatus terrella_earth_free(TerrellaEarth *earth);

// Changes the size of the images. On failure the size stays.
TerrellaStatus terrella_earth_resize(TerrellaEarth *earth, uint32_t width, uint32_t height);

// Returns the size of the images, pixels. It waits while another thread draws with this Earth.
//
// # Safety
// Both point to writable memory.
TerrellaStatus terrella_earth_size(TerrellaEarth *earth, uint32_t *width, uint32_t *height);

// Draws a picture and writes it to `pixels`, rows from the top without padding: `bytes` is width × height × 4, 8 or 16 by its format. Any
// other number is `TERRELLA_ARGUMENT`, and nothing is drawn or written. Waits for the device, and for tiles at most `wait_s` seconds. 0 draws
// the tiles that have arrived, for real time. `drawn` may be null.
//
// # Safety
// `camera` points to a camera; `pixels` points to `bytes` bytes, which nobody else uses during the call; `drawn` is null or points to
// writable memory.
TerrellaStatus terrella_earth_draw(TerrellaEarth *earth,
                                   const TerrellaCamera *camera,
                                   TerrellaTime time,
                                   double wait_s,
                                   TerrellaFormat format,
                                   void *pixels,
                                   size_t bytes,
                                   TerrellaDrawn *drawn);

// Writes the distance of the ground along the camera's axis, metres, to `depth_m`: `count` is width × height, and any other number is
// `TERRELLA_ARGUMENT`. Infinite where no ground is visible.
//
// # Safety
// `camera` points to a camera; `depth_m` points to `count` floats, which nobody else uses during the call.
TerrellaStatus terrella_earth_depth(TerrellaEarth *earth,
                                    const TerrellaCamera *camera,
                                    TerrellaTime time,
                                    double wait_s,
                                    float *depth_m,
                                    size_t count);

// Writes truth layers, each to its own buffer. The view is rendered once for all of them. A buffer of another size than the layer is
// `TERRELLA_ARGUMENT`, and nothing is written. With a `count` of 0, `layers` may be null. `drawn` may be null.
//
// # Safety
// `camera` points to a camera; `layers` points to `count` values. Their texts end with zero bytes. Their buffers have the bytes that they
// name, do not overlap, and nobody else uses them during the call. `drawn` is null or points to writable memory.
TerrellaStatus terrella_earth_truth(TerrellaEarth *earth,
                                    const TerrellaCamera *camera,
                                    TerrellaTime time,
                                    double wait_s,
                                    const TerrellaLayerBuffer *layers,
                                    size_t count,
                                    TerrellaDrawn *drawn);

// The error message of this thread's last failed call, in UTF-8; empty if there was none. The pointer is valid until the thread ends. The
// thread's next failed call overwrites the text. A message of more than 2047 bytes is truncated. Use the pointer in this thread only.
const char *terrella_message(void);

// The name of a status, for logs: "TERRELLA_OK" and so on; "no status" for any other number. The text never changes and is valid as long
// as the library is loaded.
const char *terrella_status_name(uint32_t status);

// Fills options with the defaults: 800 × 450 pixels, one sample each, the starter maps, the best adapter.
//
// # Safety
// `options` points to writable memory.
TerrellaStatus terrella_options_default(TerrellaOptions *options);

// The passes of a satellite of a scene over a place, in their order, at most `capacity` of them. `count` receives the number written. If
// it is `capacity` there may be more: search again from the end of the last one. `index` counts from 0 in the scene's order.
//
// With a capacity of 0, nothing is searched, `count` receives 0, and `passes` may be null. An interval that ends before it begins is
// `TERRELLA_ARGUMENT`. One that lies outside of the satellite's data is `TERRELLA_SCENE`. One that lies partly outside is searched as far
// as the data reach.
//
// # Safety
// `passes` points to writable memory for `capacity` passes, and `count` to that for one number.
TerrellaStatus terrella_scene_passes(TerrellaScene *scene,
                                     size_t index,
                                     const TerrellaPassSearch *search,
                                     TerrellaPass *passes,
                                     size_t capacity,
                                     size_t *count);

// Writes a picture of `TERRELLA_RGBA8` to a PNG file, without its opacity. The file is complete or does not exist; an existing file is
// replaced.
//
// # Safety
// `path` ends with a zero byte; `rgba` points to width × height × 4 bytes.
TerrellaStatus terrella_write_png(const char *path, const uint8_t *rgba, uint32_t width, uint32_t height);

// Reads a scene file and the files that it names, and opens a graphics adapter. In place of a scene `path` may name an orbit file of one
// satellite, as for the command: the scene is then the default one with this satellite. `width` and `height` are the image size; with both
// 0 it is the scene's. `textures` is the folder of default maps, null as in `TerrellaOptions`. `adapter` is a part of the adapter's name,
// null takes the best. Free the scene with `terrella_scene_free`. On failure `*scene` is unchanged.
//
// # Safety
// Texts end with zero bytes; `scene` points to writable memory.
TerrellaStatus terrella_scene_open(const char *path,
                                   uint32_t width,
                                   uint32_t height,
                                   const char *textures,
                                   const char *adapter,
                                   TerrellaScene **scene);

// As `terrella_scene_open`, but from the text of a scene. Messages name `path`, and paths in the text are relative to its folder; the file
// itself is not read.
//
// # Safety
// As `terrella_scene_open`.
TerrellaStatus terrella_scene_parse(const char *toml,
                                    const char *path,
                                    uint32_t width,
                                    uint32_t height,
                                    const char *textures,
                                    const char *adapter,
                                    TerrellaScene **scene);

// Frees a scene. A null or freed handle is an error. Any thread may call it, as `terrella_earth_free`.
TerrellaStatus terrella_scene_free(TerrellaScene *scene);

// Image size, playback time and satellites of a scene.
//
// # Safety
// `info` points to writable memory.
TerrellaStatus terrella_scene_info(TerrellaScene *scene, TerrellaSceneInfo *info);

// Position and velocity of a satellite of a scene at an instant: Earth-fixed axes (ITRF), metres and metres per second, three numbers
// each. The velocity is relative to the rotating Earth. `index` counts from 0 in the scene's order; `velocity_m_s` may be null.
//
// # Safety
// Each points to writable memory for three numbers.
TerrellaStatus terrella_scene_satellite(TerrellaScene *scene, size_t index, TerrellaTime time, double *position_m, double *velocity_m_s);

// Draws an instant of a scene as the command `terrella` draws it, and writes it to `pixels` as `terrella_earth_draw` does. Waits for tiles
// as long as the scene says. `drawn` may be null.
//
// # Safety
// As `terrella_earth_draw`.
TerrellaStatus terrella_scene_draw(TerrellaScene *scene,
                                   TerrellaTime time,
                                   TerrellaFormat format,
                                   void *pixels,
                                   size_t bytes,
                                   TerrellaDrawn *drawn);

// As `terrella_earth_depth`, with the scene's camera: of the ground, without a spacecraft before it.
//
// # Safety
// As `terrella_earth_depth`.
TerrellaStatus terrella_scene_depth(TerrellaScene *scene, TerrellaTime time, float *depth_m, size_t count);

// As `terrella_earth_truth`, with the scene's camera: of the ground, without a spacecraft before it.
//
// # Safety
// As `terrella_earth_truth`.
TerrellaStatus terrella_scene_truth(TerrellaScene *scene,
                                    TerrellaTime time,
                                    const TerrellaLayerBuffer *layers,
                                    size_t count,
                                    TerrellaDrawn *drawn);

// Width and height of the sensor of a scene, pixels: those of its raw frames and their truth. A scene without a `[sensor]` table is
// `TERRELLA_SCENE`.
//
// # Safety
// Both point to writable memory.
TerrellaStatus terrella_scene_sensor_size(TerrellaScene *scene, uint32_t *width, uint32_t *height);

// Draws the raw frame of the sensor of a scene at an instant, by the scene's camera, and writes its numbers to `numbers`, rows from the
// top: those of the converter, from 0 to 2^bits − 1, as `terrella frame --raw` writes them. `count` is width × height of the sensor, and any
// other number is `TERRELLA_ARGUMENT`. Of `drawn`, which may be null, only `missing_tiles` is set.
//
// # Safety
// `numbers` points to `count` values, which nobody else uses during the call; `drawn` is null or points to writable memory.
TerrellaStatus terrella_scene_raw(TerrellaScene *scene,
                                  TerrellaTime time,
                                  uint16_t *numbers,
                                  size_t count,
                                  TerrellaDrawn *drawn);

// As `terrella_scene_truth` for the pixels of `terrella_scene_raw`: through the sensor's lens, each row at its own instant. Layers have
// the sensor's size. Of `drawn`, which may be null, only `missing_tiles` is set.
//
// # Safety
// As `terrella_scene_truth`.
TerrellaStatus terrella_scene_raw_truth(TerrellaScene *scene,
                                        TerrellaTime time,
                                        const TerrellaLayerBuffer *layers,
                                        size_t count,
                                        TerrellaDrawn *drawn);

// An instant from a text like "2018-01-15T12:00:00Z" or "2018-01-15T13:30:00.25+01:30" (RFC 3339); leap seconds are read.
//
// # Safety
// `text` ends with a zero byte; `time` points to writable memory.
TerrellaStatus terrella_time_utc(const char *text, TerrellaTime *time);

// An instant from seconds since 1970-01-01T00:00:00Z as POSIX counts them, without leap seconds.
//
// # Safety
// `time` points to writable memory.
TerrellaStatus terrella_time_unix(double unix_s, TerrellaTime *time);

// The instant `elapsed_s` seconds after `time`; before it if negative.
//
// # Safety
// `later` points to writable memory, which may be that of `time`.
TerrellaStatus terrella_time_add(TerrellaTime time, double elapsed_s, TerrellaTime *later);

// Writes an instant as a text in UTC, like "2018-01-15T12:00:00.000Z", with a zero byte at its end: 40 bytes are enough. A buffer that
// is too short is `TERRELLA_ARGUMENT`, and nothing is written.
//
// # Safety
// `text` points to writable memory of `bytes` bytes.
TerrellaStatus terrella_time_text(TerrellaTime time, char *text, size_t bytes);

// The number of truth layers.
size_t terrella_layer_count(void);

// The description of the truth layer with this index, from 0.
//
// # Safety
// `layer` points to writable memory.
TerrellaStatus terrella_layer(size_t index, TerrellaLayer *layer);

// The version of the loaded library, like "0.1.0". Never null; do not free it.
const char *terrella_version(void);

// Returns a device extension that the host must enable, by its index from 0; null after the last one. Call it before vkCreateDevice. Names
// are never freed.
//
// # Safety
// `host` points to Vulkan objects as its fields say; `device` and `device_extensions` are not read. `name` points to writable memory.
TerrellaStatus terrella_vulkan_extension(const TerrellaVulkanHost *host, size_t index, const char **name);

// Creates an Earth on the host's device, for images of a format: VK_FORMAT_R8G8B8A8_UNORM (37) or _SRGB (43), VK_FORMAT_B8G8R8A8_UNORM
// (44) or _SRGB (50) for display, VK_FORMAT_R16G16B16A16_SFLOAT (97) for linear light. `width`, `height` and `adapter` of the options are not
// used. On failure `*earth` is unchanged.
//
// # Safety
// `host` points to Vulkan objects as its fields say, which outlive the Earth; texts end with zero bytes; `earth` points to writable
// memory. Nobody submits to the queue during the call.
TerrellaStatus terrella_vulkan_earth_new(const TerrellaVulkanHost *host,
                                         const TerrellaOptions *options,
                                         uint32_t vk_format,
                                         TerrellaVulkanEarth **earth);

// Frees an Earth on Vulkan, after the device has finished drawing. Call it before you destroy the device. No other
// thread may use this Earth then: a call in progress would keep its objects after this one returns.
TerrellaStatus terrella_vulkan_earth_free(TerrellaVulkanEarth *earth);

// Draws into an image of the host: submits to its queue and does not wait. Later submissions to that queue see the picture. Keep the image
// until the queue has finished. The first row is at the top, as in Vulkan. Waits for tiles, at most `wait_s` seconds. `drawn`
// may be null.
//
// # Safety
// `camera` points to a camera, `image` to a description that is true of an image of the host's device; nobody else submits to the queue or
// uses the image during the call; `drawn` is null or points to writable memory.
TerrellaStatus terrella_vulkan_draw(TerrellaVulkanEarth *earth,
                                    const TerrellaCamera *camera,
                                    TerrellaTime time,
                                    double wait_s,
                                    const TerrellaVulkanImage *image,
                                    TerrellaDrawn *drawn);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TERRELLA_H */
