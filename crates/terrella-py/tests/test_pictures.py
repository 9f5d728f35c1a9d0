"""Pictures: of the Earth with a camera, and of scenes."""

import datetime
import threading
import time

import numpy as np
import pytest
import terrella

NOON = "2018-06-21T12:00:00Z"
CAMERA = terrella.Camera.geodetic(10, 0, 1.2e7)


def test_the_earth_is_seen_in_the_middle_and_space_beside_it(earth):
    color = earth.color(CAMERA, NOON)
    assert color.shape == (144, 256, 4) and color.dtype == np.uint8
    assert color.flags.c_contiguous and color.flags.owndata is not None
    assert color[72, 128, :3].sum() > 100
    assert color[2, 2, :3].max() <= 3


def test_north_is_up_and_east_is_right(earth):
    """The Sahara is bright and the Gulf of Guinea dark: the first row is north."""
    color = earth.color(terrella.Camera.geodetic(10, 5, 6e6), NOON).astype(float)
    red = color[..., 0] - color[..., 2]
    assert red[40:60, 100:156].mean() > red[85:105, 100:156].mean() + 10


def test_the_radiance_is_light_itself(earth):
    light = earth.radiance(CAMERA, NOON)
    assert light.shape == (144, 256, 3) and light.dtype == np.float32
    assert np.isfinite(light).all()
    assert 0.01 < light[72, 128].mean() < 2
    # Unlike in an 8-bit image, space has no noise.
    assert light[2, 2].max() < 1e-3


def test_depth_is_that_of_a_pinhole_camera(earth):
    depth = earth.depth_m(CAMERA, NOON)
    truth = earth.truth(CAMERA, NOON, ["range_m"])["range_m"]
    assert depth.shape == (144, 256) and depth.dtype == np.float32
    assert np.isinf(depth[2, 2]) and np.isnan(truth[2, 2])
    seen = np.isfinite(depth)
    half = np.tan(np.radians(22.5))
    y, x = np.mgrid[:144, :256]
    u, v = ((x + 0.5) / 72 - 256 / 144) * half, ((y + 0.5) / 72 - 1) * half
    np.testing.assert_allclose(depth[seen], (truth / np.sqrt(1 + u**2 + v**2))[seen], rtol=1e-5)
    # Straight down, the depth is the height.
    assert abs(depth[71:73, 127:129].mean() - 1.2e7) < 5e4


def test_truth_layers_are_what_their_list_says(earth):
    layers = earth.truth(CAMERA, NOON)
    reported = terrella.truth_layers()
    assert list(layers) == [name for name, *_ in reported]
    for name, unit, dtype, what in reported:
        assert layers[name].dtype == np.dtype(dtype) and unit and what
    assert layers["normal_itrf"].shape == (144, 256, 3)
    assert abs(layers["lat_deg"][71:73, 127:129].mean() - 10) < 0.5
    up = np.linalg.norm(layers["normal_itrf"], axis=-1)
    assert np.nanmax(np.abs(up - 1)) < 1e-5


def test_a_camera_of_matrices_sees_the_same(earth):
    place = terrella.itrf_from_geodetic([10.0, 0.0, 1.2e7])
    np.testing.assert_allclose(CAMERA.eye_itrf_m, place, atol=1e-3)
    lat = np.radians(10)
    forward = -np.array([np.cos(lat), 0, np.sin(lat)])
    up = np.array([-np.sin(lat), 0, np.cos(lat)])
    looking = terrella.Camera(place, forward, up)
    right = np.cross(forward, up)
    view_from_itrf = np.array([right, up, -forward])
    f = 1 / np.tan(np.radians(22.5))
    clip = np.array([[f * 144 / 256, 0, 0, 0], [0, f, 0, 0], [0, 0, 0, 0.1], [0, 0, -1, 0]])
    given = terrella.Camera.matrices(place, view_from_itrf, clip)
    pictures = [earth.color(camera, NOON).astype(int) for camera in (CAMERA, looking, given)]
    assert np.abs(pictures[0] - pictures[1]).mean() < 0.05
    assert np.abs(pictures[0] - pictures[2]).mean() < 0.05


def test_a_scene_at_any_instant(scene):
    start = scene.frame()
    later = scene.frame(datetime.timedelta(minutes=10))
    assert start.size == (256, 144) == scene.size
    assert np.array_equal(start.color, scene.frame(scene.start).color)
    assert np.array_equal(later.color, scene.frame(scene.start + datetime.timedelta(minutes=10)).color)
    assert not np.array_equal(start.color, later.color)
    assert scene.radiance().shape == (144, 256, 3)
    assert scene.depth_m().shape == (144, 256)
    assert set(scene.truth(layers=["lat_deg", "lit"])) == {"lat_deg", "lit"}
    times = scene.times()
    assert times[0] == scene.start
    assert abs(times[1].seconds_since(times[0])) > 0


def test_a_frame_is_a_png_an_array_and_a_file(scene, tmp_path):
    frame = scene.frame()
    assert frame._repr_png_()[:8] == b"\x89PNG\r\n\x1a\n"
    assert np.asarray(frame).shape == (144, 256, 4)
    assert np.asarray(frame, dtype=float).dtype == float
    frame.save(tmp_path / "iss.png")
    assert (tmp_path / "iss.png").read_bytes() == frame.png()
    assert [path.name for path in tmp_path.iterdir()] == ["iss.png"]
    with pytest.raises(ValueError, match="path"):
        frame.save(tmp_path / "iss.jpg")


def test_other_threads_run_while_a_picture_is_drawn(earth):
    """The interpreter is let go: a thread counts on while another draws."""
    counted, stop = [0], threading.Event()

    def count():
        while not stop.is_set():
            counted[0] += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=count)
    thread.start()
    begin, before = time.perf_counter(), counted[0]
    while time.perf_counter() - begin < 0.5:
        earth.truth(CAMERA, NOON)
    during = counted[0] - before
    stop.set()
    thread.join()
    # If calls held the interpreter, the thread would count to some tens only.
    assert during > 80, during


def test_threads_share_a_renderer(earth):
    wanted = earth.color(CAMERA, NOON)
    found = [None] * 4

    def draw(n):
        found[n] = earth.color(CAMERA, NOON)

    threads = [threading.Thread(target=draw, args=(n,)) for n in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert all(np.array_equal(one, wanted) for one in found)


def test_the_same_picture_twice(earth):
    assert np.array_equal(earth.color(CAMERA, NOON), earth.color(CAMERA, NOON))


def test_a_scene_gives_raw_frames(tmp_path):
    path = tmp_path / "raw.toml"
    path.write_text(
        "[sensor]\nsize = [48, 32]\nfocal_length_mm = 0.6\npixel_pitch_um = 10\nf_number = 4\nexposure_s = 2e-5\n"
        "full_well_e = 20000\noversampling = 1\nbits = 12\nread_noise_e = 5\n"
    )
    scene = terrella.Scene(path)
    frame = scene.raw()
    assert frame.shape == (32, 48) and frame.dtype == np.uint16
    assert 0 < frame.max() < 4096 and frame.std() > 0
    np.testing.assert_array_equal(frame, scene.raw(scene.start))
    later = scene.raw(datetime.timedelta(seconds=60))
    truth = scene.raw_truth(layers=["lat_deg", "normal_itrf"])
    assert truth["lat_deg"].shape == (32, 48) and truth["normal_itrf"].shape == (32, 48, 3)
    assert np.isfinite(truth["lat_deg"]).any()
    assert (frame != later).any()
    plain = tmp_path / "plain.toml"
    plain.write_text("")
    with pytest.raises(terrella.SceneError, match="sensor"):
        terrella.Scene(plain).raw()


def test_detail_and_directional_reflectance_are_options_of_the_earth():
    """Each changes the image, and both are the keys of scenes."""
    camera = terrella.Camera.geodetic(10, 20, 4e5, pitch_deg=-50)
    morning = "2018-06-21T08:00:00Z"

    def drawn(**options):
        return terrella.Earth((128, 72), **options).color(camera, morning).astype(int)

    both = drawn()
    assert np.array_equal(both, drawn(detail=True, directional_reflectance=True))
    for name in ("detail", "directional_reflectance"):
        without = drawn(**{name: False})
        table = terrella.Earth.from_dict({"earth": {name: False}}, (128, 72)).color(camera, morning).astype(int)
        assert np.abs(without - both).mean() > 0.2, name
        assert np.abs(without - table).mean() < 0.2 * np.abs(without - both).mean(), name


SENSOR = {
    "size": [48, 32], "focal_length_mm": 0.6, "pixel_pitch_um": 10, "f_number": 4, "exposure_s": 2e-5, "full_well_e": 20000,
    "oversampling": 1, "bits": 12, "read_noise_e": 5,
}


def test_an_earth_gives_raw_frames_of_a_sensor(earth):
    sensor, noon = SENSOR, "2018-06-21T12:00:00Z"
    frame = earth.raw(CAMERA, noon, sensor)
    assert frame.shape == (32, 48) and frame.dtype == np.uint16
    assert 0 < frame.max() < 4096 and frame.std() > 0
    # The limb has the angle of a globe at this height. A pixel at r from the centre has the angle atan(r / 60).
    seen = np.isfinite(earth.raw_truth(CAMERA, noon, sensor, ["lat_deg"])["lat_deg"])
    y, x = np.mgrid[:32, :48]
    radius = np.hypot(x - 23.5, y - 15.5)
    limb = 60 * np.tan(np.arcsin(6371 / (6371 + 12000)))
    assert seen[radius < limb - 1].all() and not seen[radius > limb + 1].any()
    # The same frame as of a scene with the camera at the same place and no sky.
    scene = terrella.Scene.from_dict({
        "camera": {"mode": "geodetic", "lat_deg": 10, "lon_deg": 0, "height_km": 12000},
        "sky": {"stars": False, "sun": False, "moon": False, "eclipses": False},
        "sensor": sensor,
    })
    np.testing.assert_array_equal(frame, scene.raw(noon))
    elsewhere = terrella.Camera.geodetic(10, 90, 1.2e7)
    np.testing.assert_array_equal(scene.raw(noon, camera=elsewhere), earth.raw(elsewhere, noon, sensor))
    assert (scene.raw(noon, camera=elsewhere) != frame).any()
    # Rows are exposed one after the other by a fixed camera over the rotating Earth.
    rolling = earth.raw(CAMERA, noon, {**sensor, "shutter": "rolling", "line_time_us": 100})
    assert rolling.shape == frame.shape


def test_a_sensor_that_is_none_names_the_key(earth):
    noon = "2018-06-21T12:00:00Z"
    for key, value in [("full_well_e", 0), ("size", [0, 32]), ("bits", 99), ("pixel_pitch", 10)]:
        with pytest.raises(terrella.SceneError, match=key):
            earth.raw(CAMERA, noon, {**SENSOR, key: value})
    with pytest.raises(TypeError, match="sensor"):
        earth.raw(CAMERA, noon, 12)
    few = {key: value for key, value in SENSOR.items() if key not in ("f_number", "exposure_s")}
    with pytest.raises(terrella.SceneError, match="sensor: f_number, exposure_s are missing; a sensor needs size, focal_length_mm"):
        earth.raw(CAMERA, noon, few)
    # Each key that a sensor cannot do without, and no other.
    for key in SENSOR:
        without = {name: value for name, value in SENSOR.items() if name != key}
        if key in ("size", "focal_length_mm", "pixel_pitch_um", "f_number", "exposure_s", "full_well_e"):
            with pytest.raises(terrella.SceneError, match=f"sensor: {key} is missing"):
                earth.raw_truth(CAMERA, noon, without)
        else:
            earth.raw_truth(CAMERA, noon, without, ["lat_deg"])
