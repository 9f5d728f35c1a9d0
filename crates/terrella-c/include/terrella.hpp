// The C++ interface of Terrella, a realistic Earth: classes over terrella.h that free what they hold and throw terrella::Error. C++17, header only.
//
// Units, axes and threads are those of terrella.h. Objects can be moved and not copied; one that was moved from can only be assigned to or
// destroyed.

#ifndef TERRELLA_HPP
#define TERRELLA_HPP

#if !(__cplusplus >= 201703L || (defined(_MSVC_LANG) && _MSVC_LANG >= 201703L))
#error "terrella.hpp needs C++17: compile with -std=c++17 or later, or /std:c++17"
#endif

#include "terrella.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace terrella {

// A call that failed: its status, and the message of the library.
class Error : public std::runtime_error {
public:
    Error(TerrellaStatus status, const char *message) : std::runtime_error(message), status_(status) {}
    [[nodiscard]] TerrellaStatus status() const noexcept { return status_; }

private:
    TerrellaStatus status_;
};

// Throws unless a call succeeded; for calls of terrella.h that have no method here.
inline void check(TerrellaStatus status) {
    if (status != TERRELLA_OK) throw Error(status, terrella_message());
}

// An instant, exact to the nanosecond, leap seconds included.
class Time {
public:
    // From a text like "2018-01-15T12:00:00Z" (RFC 3339).
    explicit Time(const std::string &utc) { check(terrella_time_utc(utc.c_str(), &time_)); }
    Time(TerrellaTime time) noexcept : time_(time) {}
    // From seconds since 1970-01-01T00:00:00Z as POSIX counts them.
    [[nodiscard]] static Time from_unix(double unix_s) {
        TerrellaTime time;
        check(terrella_time_unix(unix_s, &time));
        return time;
    }
    [[nodiscard]] Time operator+(double elapsed_s) const {
        TerrellaTime later;
        check(terrella_time_add(time_, elapsed_s, &later));
        return later;
    }
    [[nodiscard]] Time operator-(double elapsed_s) const { return *this + -elapsed_s; }
    Time &operator+=(double elapsed_s) { return *this = *this + elapsed_s; }
    Time &operator-=(double elapsed_s) { return *this = *this - elapsed_s; }
    // Elapsed seconds from another instant to this.
    [[nodiscard]] double operator-(const Time &other) const noexcept {
        return double(time_.tai_s - other.time_.tai_s) + (double(time_.tai_ns) - double(other.time_.tai_ns)) * 1e-9;
    }
    [[nodiscard]] bool operator==(const Time &other) const noexcept { return time_.tai_s == other.time_.tai_s && time_.tai_ns == other.time_.tai_ns; }
    [[nodiscard]] bool operator!=(const Time &other) const noexcept { return !(*this == other); }
    [[nodiscard]] bool operator<(const Time &other) const noexcept {
        return time_.tai_s != other.time_.tai_s ? time_.tai_s < other.time_.tai_s : time_.tai_ns < other.time_.tai_ns;
    }
    [[nodiscard]] bool operator>(const Time &other) const noexcept { return other < *this; }
    [[nodiscard]] bool operator<=(const Time &other) const noexcept { return !(other < *this); }
    [[nodiscard]] bool operator>=(const Time &other) const noexcept { return !(*this < other); }
    // In UTC, like "2018-01-15T12:00:00.000Z".
    [[nodiscard]] std::string utc() const {
        char text[40];
        check(terrella_time_text(time_, text, sizeof text));
        return text;
    }
    [[nodiscard]] operator TerrellaTime() const noexcept { return time_; }

private:
    TerrellaTime time_;
};

// A camera above a place; see terrella_camera_geodetic.
[[nodiscard]] inline TerrellaCamera camera_geodetic(double lat_deg, double lon_deg, double height_m, double heading_deg, double pitch_deg,
                                                    double fov_deg, double aspect) {
    TerrellaCamera camera;
    check(terrella_camera_geodetic(lat_deg, lon_deg, height_m, heading_deg, pitch_deg, fov_deg, aspect, &camera));
    return camera;
}

// A camera at a point that looks along a direction; see terrella_camera_look.
[[nodiscard]] inline TerrellaCamera camera_look(const std::array<double, 3> &eye_itrf_m, const std::array<double, 3> &forward,
                                                const std::array<double, 3> &up, double fov_deg, double aspect) {
    TerrellaCamera camera;
    check(terrella_camera_look(eye_itrf_m.data(), forward.data(), up.data(), fov_deg, aspect, &camera));
    return camera;
}

// Default options of an Earth, to be changed.
[[nodiscard]] inline TerrellaOptions default_options() {
    TerrellaOptions options;
    check(terrella_options_default(&options));
    return options;
}

// A displayed image: four bytes per pixel (red, green, blue in sRGB, opacity), rows from the top.
struct Image {
    std::uint32_t width = 0;
    std::uint32_t height = 0;
    std::vector<std::uint8_t> rgba;

    // Writes a PNG file, without opacity. Throws unless `rgba` has the bytes of its width and height.
    void save(const std::string &path) const {
        if (rgba.size() / 4 != std::size_t(width) * height || rgba.size() % 4 != 0) {
            std::string words = "rgba: an image of " + std::to_string(width) + " × " + std::to_string(height) + " pixels has four bytes for each, not " +
                                std::to_string(rgba.size()) + " bytes in all";
            throw Error(TERRELLA_ARGUMENT, words.c_str());
        }
        check(terrella_write_png(path.c_str(), rgba.data(), width, height));
    }
};

// A truth layer by its name: `T` is double or float as the layer has it (see `layers`), NaN where there is no value. The numbers of a pixel
// are consecutive: component c of pixel n is values[n * components + c].
template <typename T>
struct Layer {
    std::string name;
    std::vector<T> values;
    std::size_t components;
};

// The description of a truth layer; see TerrellaLayer.
struct LayerInfo {
    std::string name, unit, what;
    // Numbers per pixel.
    std::size_t components;
    // Bytes per number: 4 for float, 8 for double.
    std::size_t number_bytes;
};

// All truth layers.
[[nodiscard]] inline std::vector<LayerInfo> layers() {
    std::vector<LayerInfo> all;
    all.reserve(terrella_layer_count());
    for (std::size_t n = 0; n < terrella_layer_count(); ++n) {
        TerrellaLayer one;
        check(terrella_layer(n, &one));
        all.push_back(LayerInfo{one.name, one.unit, one.what, one.components, one.number_bytes});
    }
    return all;
}

// The raw frame of a sensor: the numbers of its converter, rows from the top.
struct RawFrame {
    std::uint32_t width;
    std::uint32_t height;
    std::vector<std::uint16_t> numbers;
};

// A handle that is freed with its owner.
template <typename H, TerrellaStatus (*free_handle)(H *)>
class Handle {
public:
    Handle() noexcept = default;
    explicit Handle(H *handle) noexcept : handle_(handle) {}
    Handle(Handle &&other) noexcept : handle_(std::exchange(other.handle_, nullptr)) {}
    Handle &operator=(Handle &&other) noexcept {
        std::swap(handle_, other.handle_);
        return *this;
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;
    ~Handle() {
        if (handle_) free_handle(handle_);
    }
    // For calls of terrella.h. It stays the owner's.
    [[nodiscard]] H *get() const noexcept { return handle_; }

private:
    H *handle_ = nullptr;
};

// An Earth on a device of its own.
class Earth {
public:
    explicit Earth(const TerrellaOptions &options = default_options()) {
        TerrellaEarth *earth = nullptr;
        check(terrella_earth_new(&options, &earth));
        handle_ = Handle<TerrellaEarth, terrella_earth_free>(earth);
    }
    // The size is the library's own, also after `terrella_earth_resize`. These calls wait while another thread draws with this Earth.
    [[nodiscard]] std::uint32_t width() const { return size().first; }
    [[nodiscard]] std::uint32_t height() const { return size().second; }
    [[nodiscard]] double aspect() const {
        auto [width, height] = size();
        return double(width) / double(height);
    }
    // Width and height of the images, pixels.
    [[nodiscard]] std::pair<std::uint32_t, std::uint32_t> size() const {
        std::uint32_t width, height;
        check(terrella_earth_size(get(), &width, &height));
        return {width, height};
    }
    void resize(std::uint32_t width, std::uint32_t height) { check(terrella_earth_resize(get(), width, height)); }
    // The Earth as it is displayed. Waits for tiles of a pack, at most `wait_s` seconds.
    [[nodiscard]] Image image(const TerrellaCamera &camera, const Time &time, double wait_s = 30, TerrellaDrawn *drawn = nullptr) const {
        auto [width, height] = size();
        Image image{width, height, std::vector<std::uint8_t>(std::size_t(width) * height * 4)};
        check(terrella_earth_draw(get(), &camera, time, wait_s, TERRELLA_RGBA8, image.rgba.data(), image.rgba.size(), drawn));
        return image;
    }
    // Linear light: red, green, blue and an unused fourth number.
    [[nodiscard]] std::vector<float> radiance(const TerrellaCamera &camera, const Time &time, double wait_s = 30) const {
        std::vector<float> light(pixels() * 4);
        check(terrella_earth_draw(get(), &camera, time, wait_s, TERRELLA_RGBA32F, light.data(), light.size() * sizeof(float), nullptr));
        return light;
    }
    // Distance of the ground along the camera's axis, metres; infinite where none is seen.
    [[nodiscard]] std::vector<float> depth_m(const TerrellaCamera &camera, const Time &time, double wait_s = 30) const {
        std::vector<float> depth(pixels());
        check(terrella_earth_depth(get(), &camera, time, wait_s, depth.data(), depth.size()));
        return depth;
    }
    // A truth layer. Give the number of components of a vector: truth<float, 3>(camera, time, "normal_itrf").
    template <typename T, std::size_t components = 1>
    [[nodiscard]] Layer<T> truth(const TerrellaCamera &camera, const Time &time, const std::string &name, double wait_s = 30) const {
        Layer<T> layer{name, std::vector<T>(pixels() * components), components};
        TerrellaLayerBuffer buffer{layer.name.c_str(), layer.values.data(), layer.values.size() * sizeof(T)};
        check(terrella_earth_truth(get(), &camera, time, wait_s, &buffer, 1, nullptr));
        return layer;
    }
    [[nodiscard]] TerrellaEarth *get() const noexcept { return handle_.get(); }

private:
    std::size_t pixels() const {
        auto [width, height] = size();
        return std::size_t(width) * height;
    }

    Handle<TerrellaEarth, terrella_earth_free> handle_;
};

// Device extensions that the host must enable; see terrella_vulkan_extension. The names are never freed.
[[nodiscard]] inline std::vector<const char *> vulkan_extensions(const TerrellaVulkanHost &host) {
    std::vector<const char *> names;
    const char *name = nullptr;
    for (std::size_t index = 0; check(terrella_vulkan_extension(&host, index, &name)), name; ++index) names.push_back(name);
    return names;
}

// An Earth on a program's own Vulkan device, for images of one VkFormat; see terrella_vulkan_earth_new. Destroy it before the device.
class VulkanEarth {
public:
    VulkanEarth(const TerrellaVulkanHost &host, std::uint32_t vk_format, const TerrellaOptions &options = default_options()) {
        TerrellaVulkanEarth *earth = nullptr;
        check(terrella_vulkan_earth_new(&host, &options, vk_format, &earth));
        handle_ = Handle<TerrellaVulkanEarth, terrella_vulkan_earth_free>(earth);
    }
    // Submits to the host's queue and does not wait for it; see terrella_vulkan_draw. Waits for tiles of a pack, at most `wait_s` seconds.
    void draw(const TerrellaCamera &camera, const Time &time, const TerrellaVulkanImage &image, double wait_s = 30,
              TerrellaDrawn *drawn = nullptr) {
        check(terrella_vulkan_draw(get(), &camera, time, wait_s, &image, drawn));
    }
    [[nodiscard]] TerrellaVulkanEarth *get() const noexcept { return handle_.get(); }

private:
    Handle<TerrellaVulkanEarth, terrella_vulkan_earth_free> handle_;
};

// Position and velocity of a satellite: Earth-fixed axes (ITRF), metres and metres per second. The velocity is relative to the rotating Earth.
struct State {
    std::array<double, 3> position_m;
    std::array<double, 3> velocity_m_s;
};

// The rotation from GCRF to ITRF axes at an instant, row by row; see terrella_itrf_from_gcrf.
[[nodiscard]] inline std::array<double, 9> itrf_from_gcrf(const Time &time) {
    std::array<double, 9> matrix;
    check(terrella_itrf_from_gcrf(time, matrix.data()));
    return matrix;
}

// A position or direction in GCRF axes, as it is in ITRF axes at an instant.
[[nodiscard]] inline std::array<double, 3> gcrf_to_itrf(const std::array<double, 3> &gcrf, const Time &time) {
    auto matrix = itrf_from_gcrf(time);
    std::array<double, 3> itrf;
    for (std::size_t row = 0; row < 3; ++row)
        itrf[row] = matrix[3 * row] * gcrf[0] + matrix[3 * row + 1] * gcrf[1] + matrix[3 * row + 2] * gcrf[2];
    return itrf;
}

// A state in ITRF axes from position and velocity in GCRF axes, whose velocity is relative to the stars.
[[nodiscard]] inline State gcrf_to_itrf(const std::array<double, 3> &position_m, const std::array<double, 3> &velocity_m_s, const Time &time) {
    State itrf{gcrf_to_itrf(position_m, time), gcrf_to_itrf(velocity_m_s, time)};
    itrf.velocity_m_s[0] += TERRELLA_EARTH_ROTATION_RAD_S * itrf.position_m[1];
    itrf.velocity_m_s[1] -= TERRELLA_EARTH_ROTATION_RAD_S * itrf.position_m[0];
    return itrf;
}

// Where passes are looked for: a place (degrees, metres) and an elevation mask (degrees). And when a satellite can be seen from there: the Sun
// is lower than `sun_below_deg`; with a standard magnitude its brightness is estimated.
struct Place {
    double lat_deg;
    double lon_deg;
    double height_m = 0;
    double min_elevation_deg = 0;
    double sun_below_deg = -6;
    std::optional<double> standard_magnitude = std::nullopt;
};

// A pass of a satellite over a place; see TerrellaPass.
struct Pass {
    Time begin, highest, end;
    double begin_azimuth_deg, highest_azimuth_deg, end_azimuth_deg;
    double elevation_deg;
    double distance_m;
    // Whether it rises at `begin`, and sets at `end`; else it is in progress there.
    bool rises, sets;
    double duration_s;
    // How often it becomes visible; if ever, when first and last, when it is brightest, and its magnitude then (NaN without a standard magnitude).
    std::uint32_t visible_count;
    Time visible_begin, visible_end, brightest;
    double magnitude;
};

// A scene file with a device of its own.
class Scene {
public:
    // `path` names a scene or an orbit file. Width and height 0 take the scene's; empty texts take the default maps and the best adapter.
    explicit Scene(const std::string &path, std::uint32_t width = 0, std::uint32_t height = 0, const std::string &textures = "",
                   const std::string &adapter = "") {
        TerrellaScene *scene = nullptr;
        check(terrella_scene_open(path.c_str(), width, height, textures.empty() ? nullptr : textures.c_str(),
                                  adapter.empty() ? nullptr : adapter.c_str(), &scene));
        own(scene);
    }
    // A scene of its text. Messages name `path`, and paths in the text are relative to its folder.
    [[nodiscard]] static Scene from_text(const std::string &toml, const std::string &path = "scene.toml", std::uint32_t width = 0,
                                         std::uint32_t height = 0, const std::string &textures = "", const std::string &adapter = "") {
        TerrellaScene *scene = nullptr;
        check(terrella_scene_parse(toml.c_str(), path.c_str(), width, height, textures.empty() ? nullptr : textures.c_str(),
                                   adapter.empty() ? nullptr : adapter.c_str(), &scene));
        return Scene(scene);
    }
    [[nodiscard]] const TerrellaSceneInfo &info() const noexcept { return info_; }
    [[nodiscard]] Time start() const noexcept { return info_.start; }
    [[nodiscard]] Time end() const noexcept { return info_.end; }
    // The scene at an instant as the command displays it.
    [[nodiscard]] Image image(const Time &time, TerrellaDrawn *drawn = nullptr) const {
        Image image{info_.width, info_.height, std::vector<std::uint8_t>(pixels() * 4)};
        check(terrella_scene_draw(get(), time, TERRELLA_RGBA8, image.rgba.data(), image.rgba.size(), drawn));
        return image;
    }
    // Distance of the ground along the camera's axis, metres; infinite where none is seen.
    [[nodiscard]] std::vector<float> depth_m(const Time &time) const {
        std::vector<float> depth(pixels());
        check(terrella_scene_depth(get(), time, depth.data(), depth.size()));
        return depth;
    }
    // A truth layer. Give the number of components of a vector: truth<float, 3>(time, "normal_itrf").
    template <typename T, std::size_t components = 1>
    [[nodiscard]] Layer<T> truth(const Time &time, const std::string &name) const {
        Layer<T> layer{name, std::vector<T>(pixels() * components), components};
        TerrellaLayerBuffer buffer{layer.name.c_str(), layer.values.data(), layer.values.size() * sizeof(T)};
        check(terrella_scene_truth(get(), time, &buffer, 1, nullptr));
        return layer;
    }
    // The raw frame of the scene's sensor.
    [[nodiscard]] RawFrame raw(const Time &time) const {
        RawFrame frame{0, 0, {}};
        check(terrella_scene_sensor_size(get(), &frame.width, &frame.height));
        frame.numbers.resize(std::size_t(frame.width) * frame.height);
        check(terrella_scene_raw(get(), time, frame.numbers.data(), frame.numbers.size(), nullptr));
        return frame;
    }
    // A truth layer for the pixels of the raw frame.
    template <typename T, std::size_t components = 1>
    [[nodiscard]] Layer<T> raw_truth(const Time &time, const std::string &name) const {
        std::uint32_t width, height;
        check(terrella_scene_sensor_size(get(), &width, &height));
        Layer<T> layer{name, std::vector<T>(std::size_t(width) * height * components), components};
        TerrellaLayerBuffer buffer{layer.name.c_str(), layer.values.data(), layer.values.size() * sizeof(T)};
        check(terrella_scene_raw_truth(get(), time, &buffer, 1, nullptr));
        return layer;
    }
    // The state of the satellite at this place in the scene, from 0.
    [[nodiscard]] State satellite(std::size_t index, const Time &time) const {
        State state;
        check(terrella_scene_satellite(get(), index, time, state.position_m.data(), state.velocity_m_s.data()));
        return state;
    }
    // The states of a satellite at `count` instants from `first` to `last`, both included: its orbit in space.
    [[nodiscard]] std::vector<State> track(std::size_t index, const Time &first, const Time &last, std::size_t count) const {
        std::vector<State> states;
        states.reserve(count);
        double elapsed_s = last - first;
        for (std::size_t n = 0; n < count; ++n)
            states.push_back(satellite(index, count > 1 ? first + elapsed_s * double(n) / double(count - 1) : first));
        return states;
    }
    // The passes of a satellite over a place that are in progress at `from` or begin between it and `until`, in their order: the first `most`.
    [[nodiscard]] std::vector<Pass> passes(std::size_t index, const Place &place, const Time &from, const Time &until,
                                           std::size_t most = 1000) const {
        std::vector<Pass> passes;
        std::array<TerrellaPass, 64> page;
        TerrellaPassSearch search{place.lat_deg, place.lon_deg, place.height_m, place.min_elevation_deg, from, until, place.sun_below_deg,
                                  place.standard_magnitude ? &*place.standard_magnitude : nullptr};
        while (passes.size() < most) {
            std::size_t left = most - passes.size(), capacity = left < page.size() ? left : page.size(), count = 0;
            check(terrella_scene_passes(get(), index, &search, page.data(), capacity, &count));
            for (std::size_t n = 0; n < count; ++n) {
                const TerrellaPass &one = page[n];
                passes.push_back(Pass{one.begin, one.highest, one.end, one.begin_azimuth_deg, one.highest_azimuth_deg, one.end_azimuth_deg,
                                      one.elevation_deg, one.distance_m, one.rises, one.sets, one.duration_s, one.visible_count,
                                      one.visible_begin, one.visible_end, one.brightest, one.magnitude});
            }
            if (count < capacity) break;
            search.from = page[count - 1].end;
        }
        return passes;
    }
    [[nodiscard]] TerrellaScene *get() const noexcept { return handle_.get(); }

private:
    explicit Scene(TerrellaScene *scene) { own(scene); }
    void own(TerrellaScene *scene) {
        handle_ = Handle<TerrellaScene, terrella_scene_free>(scene);
        check(terrella_scene_info(get(), &info_));
    }
    std::size_t pixels() const noexcept { return std::size_t(info_.width) * info_.height; }

    Handle<TerrellaScene, terrella_scene_free> handle_;
    TerrellaSceneInfo info_{};
};

// The version of the library that is loaded, as in "0.1.0".
[[nodiscard]] inline std::string version() { return terrella_version(); }

}  // namespace terrella

#endif  // TERRELLA_HPP
