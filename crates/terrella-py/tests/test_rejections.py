"""What is wrong is said by an exception that names the argument."""

import datetime
import importlib
import multiprocessing
import os
import sys

import numpy as np
import pytest
import terrella

NOON = "2018-06-21T12:00:00Z"
CAMERA = terrella.Camera.geodetic(10, 0, 1.2e7)
EYE = [2e7, 0.0, 0.0]
FORWARD, UP = [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("eye", "forward", "up", "kind", "named"),
    [
        ([np.nan, 0, 0], FORWARD, UP, ValueError, "eye_itrf_m"),
        ([1.0, 2.0], FORWARD, UP, ValueError, r"eye_itrf_m: an array of shape \(3,\)"),
        (np.zeros((3, 1)), FORWARD, UP, ValueError, "eye_itrf_m"),
        (["a", "b", "c"], FORWARD, UP, TypeError, "eye_itrf_m"),
        (np.zeros(3, complex), FORWARD, UP, TypeError, "eye_itrf_m"),
        (np.array([True, False, True]), FORWARD, UP, TypeError, "eye_itrf_m"),
        (None, FORWARD, UP, TypeError, "eye_itrf_m"),
        (EYE, [0.0, 0.0, 0.0], UP, ValueError, "forward: no direction"),
        (EYE, FORWARD, [np.inf, 0, 0], ValueError, "up"),
        (5.0, FORWARD, UP, ValueError, "eye_itrf_m"),
        ([[1], [2, 3]], FORWARD, UP, TypeError, "eye_itrf_m"),
    ],
)
def test_cameras(eye, forward, up, kind, named):
    with pytest.raises(kind, match=named):
        terrella.Camera(eye, forward, up)


@pytest.mark.parametrize("fov", [0.0, -1.0, 180.0, float("nan")])
def test_fields_of_view(fov):
    with pytest.raises(ValueError, match="fov_deg"):
        terrella.Camera(EYE, FORWARD, UP, fov_deg=fov)


@pytest.mark.parametrize(
    ("arguments", "named"),
    [((91, 0, 1e6), "lat_deg"), ((0, float("nan"), 1e6), "lon_deg"), ((0, 0, float("inf")), "height_m")],
)
def test_places(arguments, named):
    with pytest.raises(ValueError, match=named):
        terrella.Camera.geodetic(*arguments)


def test_matrices():
    good = np.eye(3), np.array([[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 0, 0.1], [0, 0, -1, 0]], float)
    terrella.Camera.matrices(EYE, *good)
    for rotation, clip, named in [
        (2 * np.eye(3), good[1], "view_from_itrf"),
        (-np.eye(3), good[1], "view_from_itrf"),
        (np.eye(4), good[1], "view_from_itrf"),
        (good[0], np.zeros((4, 4)), "clip_from_view"),
        (good[0], np.full((4, 4), np.nan), "clip_from_view"),
    ]:
        with pytest.raises(ValueError, match=named):
            terrella.Camera.matrices(EYE, rotation, clip)


@pytest.mark.parametrize(
    ("time", "kind"),
    [
        ("yesterday", ValueError),
        ("2018-06-21T12:00:00", ValueError),
        ("1899-12-31T23:59:59Z", ValueError),
        ("2100-01-01T00:00:00Z", ValueError),
        (datetime.datetime(2018, 6, 21), ValueError),
        (np.datetime64("NaT"), ValueError),
        (np.datetime64("3000-01-01"), ValueError),
        (np.datetime64("200000-01-01"), ValueError),
        (1.5e9, TypeError),
        (None, TypeError),
        (b"2018-06-21T12:00:00Z", TypeError),
    ],
)
def test_instants(earth, time, kind):
    with pytest.raises(kind, match="time"):
        earth.color(CAMERA, time)


def test_a_time_that_is_none_is_named(earth):
    with pytest.raises(ValueError, match="NaT is not a time"):
        earth.color(CAMERA, np.datetime64("NaT"))


def test_an_instant_of_a_row_is_named(root):
    catalogue = terrella.Catalogue(root / "config/orbits/iss.tle")
    with pytest.raises(ValueError, match=r"times\[1\]"):
        catalogue.propagate([NOON, "no date"])


@pytest.mark.parametrize("size", [(0, 10), (10, -1), (10**9, 10), (2**70, 1)])
def test_sizes(size):
    with pytest.raises((ValueError, OverflowError)):
        terrella.Earth(size)


def test_what_earths_reject(earth):
    with pytest.raises(ValueError, match="wait_s"):
        earth.color(CAMERA, NOON, wait_s=float("nan"))
    with pytest.raises(ValueError, match="layers.*no_such"):
        earth.truth(CAMERA, NOON, ["no_such"])
    for wrong in ("lat_deg", 7, [7]):
        with pytest.raises(TypeError, match=r'layers: pass a list of names, for example \["lat_deg"\]'):
            earth.truth(CAMERA, NOON, wrong)
    with pytest.raises(TypeError, match="Camera"):
        earth.color("a camera", NOON)
    with pytest.raises(ValueError, match="samples"):
        terrella.Earth((16, 16), samples=3)
    with pytest.raises(ValueError, match="exposure_ev"):
        terrella.Earth((16, 16), exposure_ev=float("nan"))
    with pytest.raises(terrella.Error, match="nowhere"):
        terrella.Earth((16, 16), textures="/nowhere")
    with pytest.raises(terrella.DeviceError, match="no such adapter"):
        terrella.Earth((16, 16), adapter="no such adapter")


def test_what_scenes_reject(scene, root, tmp_path):
    with pytest.raises(terrella.OrbitError, match="2030"):
        scene.frame("2030-01-01T00:00:00Z")
    with pytest.raises(terrella.SceneError, match="nowhere.toml"):
        terrella.Scene(tmp_path / "nowhere.toml")
    bad = tmp_path / "bad.toml"
    bad.write_text("[camera]\nfov_deg = 200\n")
    with pytest.raises(terrella.SceneError, match="bad.toml:2"):
        terrella.Scene(bad)
    with pytest.raises(terrella.Error, match="simulator"):
        terrella.Scene(root / "config/live.toml")


def test_a_picture_in_a_folder_that_is_missing_names_the_folder(tmp_path):
    frame = terrella.Frame(np.zeros((4, 4, 4), np.uint8), NOON)
    with pytest.raises(FileNotFoundError, match="path: there is no folder .*nowhere; create it first") as raised:
        frame.save(tmp_path / "nowhere/x.png")
    assert ".part" not in str(raised.value) and raised.value.filename == str(tmp_path / "nowhere/x.png")


def test_packages_that_are_missing_are_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "xarray", None)
    monkeypatch.setitem(sys.modules, "jupyter_rfb", None)
    monkeypatch.delitem(sys.modules, "terrella.notebook", raising=False)
    with pytest.raises(ImportError, match="pip install xarray"):
        terrella.truth_dataset({})
    with pytest.raises(ImportError, match=r"pip install 'terrella-earth\[notebook\]'"):
        importlib.import_module("terrella.notebook")


def test_pictures_that_are_none():
    for wrong in [np.zeros((4, 4, 3), np.uint8), np.zeros((4, 4)), "picture"]:
        with pytest.raises((TypeError, ValueError), match="color"):
            terrella.Frame(wrong, NOON).png()


def _draw_in_child(earth, answers):
    try:
        earth.color(CAMERA, NOON)
        answers.put("drawn")
    except RuntimeError as error:
        answers.put(str(error))


@pytest.mark.skipif(not hasattr(os, "fork"), reason="no fork here")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_renderer_after_fork_is_an_error_and_no_hang(earth):
    context = multiprocessing.get_context("fork")
    answers = context.Queue()
    child = context.Process(target=_draw_in_child, args=(earth, answers))
    child.start()
    words = answers.get(timeout=20)
    child.join(20)
    assert "fork" in words and "spawn" in words
    assert child.exitcode == 0
