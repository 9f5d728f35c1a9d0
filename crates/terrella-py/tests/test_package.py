"""The package: its import, its stubs, films and the widget."""

import ast
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import terrella

FOLDER = Path(terrella.__file__).parent


def test_the_import_is_quick_and_asks_for_no_numpy():
    program = (
        "import time, sys; begin = time.perf_counter(); import terrella;"
        "print(time.perf_counter() - begin, 'numpy' in sys.modules)"
    )
    runs = [subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout.split()
            for _ in range(3)]
    assert min(float(seconds) for seconds, _ in runs) < 0.2, runs
    assert runs[0][1] == "False"


def test_a_missing_numpy_is_an_import_error():
    program = "import sys; sys.modules['numpy'] = None; import terrella"
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 1 and run.stderr.endswith("ImportError: terrella needs NumPy: pip install numpy\n"), run.stderr


def test_the_stubs_are_of_what_is_there():
    from terrella import _native

    assert (FOLDER / "py.typed").is_file()
    stubs = ast.parse((FOLDER / "_native.pyi").read_text(encoding="utf-8"))
    stubbed = {}
    for node in stubs.body:
        if isinstance(node, ast.ClassDef):
            stubbed[node.name] = {item.name for item in node.body if isinstance(item, ast.FunctionDef)}
        elif isinstance(node, ast.FunctionDef):
            stubbed[node.name] = None
        elif isinstance(node, ast.AnnAssign):
            stubbed[node.target.id] = None
    public = {name for name in vars(_native) if not name.startswith("_")} | {"__version__"}
    assert public == set(stubbed)
    for name, members in stubbed.items():
        if members is not None and not issubclass(getattr(_native, name), Exception):
            there = {member for member in vars(getattr(_native, name)) if not member.startswith("_")}
            assert there == {member for member in members if not member.startswith("_")}, name


def test_everything_public_has_words():
    for name in terrella.__all__:
        if name != "__version__":
            thing = getattr(terrella, name)
            assert (thing.__doc__ or "").strip(), name
            for member, value in vars(thing).items() if isinstance(thing, type) else []:
                if not member.startswith("_") and (callable(value) or isinstance(value, property)):
                    assert (value.__doc__ or "").strip(), f"{name}.{member}"


def test_objects_say_what_they_are(root, earth, scene):
    assert repr(earth) == f"<terrella.Earth 256 × 144, {earth.adapter}>"
    reported = repr(scene)
    assert reported.startswith(f"<terrella.Scene {root / 'config/iss.toml'}, 256 × 144, {scene.start} to ") and ", 1 satellite, " in reported, reported
    assert repr(terrella.Scene.from_dict({"camera": {"mode": "geodetic"}})).startswith("<terrella.Scene <dict>, ")
    catalogue = terrella.Catalogue(root / "config/orbits/iss.tle")
    assert repr(catalogue) == f"<terrella.Catalogue, 1 satellite: {catalogue.names[0]}>"
    for kind in (terrella.Earth, terrella.Scene):
        assert "graphics adapter" in kind.adapter.__doc__ and "pixels" in kind.size.__doc__


def test_maps_came_with_the_package(monkeypatch):
    from terrella import _earth

    monkeypatch.delenv("TERRELLA_TEXTURES")
    folder = _earth._textures(None)
    assert folder == FOLDER / "textures" and (folder / "day.jpg").is_file()
    assert terrella.Earth((32, 18)).size == (32, 18)


def test_the_package_has_all_starter_maps(root):
    not_maps = {"Cargo.toml", "lib.rs", "LICENSE-APACHE", "LICENSE-MIT"}
    maps = {path.name for path in (root / "textures").iterdir() if path.is_file()} - not_maps
    assert {"day.jpg", "lines.bin", "place_names.bin", "places.bin", "stars.bin"} <= maps
    for folder in [root / "crates/terrella-py/python/terrella/textures", FOLDER / "textures"]:
        assert {path.name for path in folder.iterdir() if path.is_file()} == maps, folder


def test_missing_lines_and_names_are_noticed(root, tmp_path, caplog):
    tables = {"camera": {"mode": "geodetic"}, "layers": {"coast_lines": True, "place_names": True}, "output": {"size": [32, 18]}}
    assert terrella.Scene.from_dict(tables, textures=root / "textures").notices == []
    for path in (root / "textures").iterdir():
        if path.name not in ("lines.bin", "place_names.bin"):
            (tmp_path / path.name).symlink_to(path)
    scene = terrella.Scene.from_dict(tables, textures=tmp_path)
    assert [notice.partition(":")[0] for notice in scene.notices] == ["coast_lines", "place_names"]
    assert "lines.bin" in scene.notices[0] and "place_names.bin" in scene.notices[1]
    scene.frame()
    assert all(any(name in record.message for record in caplog.records) for name in ["coast_lines", "place_names"]), caplog.text


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_film(scene, tmp_path):
    path = tmp_path / "iss.mp4"
    with terrella.Film(path, scene.size, 10) as film:
        for time in scene.times()[:5]:
            film.write(scene.frame(time))
    assert [one.name for one in tmp_path.iterdir()] == ["iss.mp4"]
    probe = subprocess.run(
        [shutil.which("ffmpeg"), "-i", str(path), "-f", "framemd5", "-"], capture_output=True, text=True, check=True)
    assert sum(not line.startswith("#") for line in probe.stdout.splitlines()) == 5
    # Tags from which players know the colours.
    assert "yuv420p(tv, bt709" in probe.stderr


def test_frames_of_a_part_of_a_film(scene):
    part = list(scene.frames(1, 3))
    assert [frame.time for frame in part] == scene.times()[1:3]
    for first, end in [(2, 2), (-1, 3), (0, len(scene.times()) + 1)]:
        with pytest.raises(ValueError, match="no frames"):
            scene.frames(first, end)


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_what_films_reject(tmp_path):
    for arguments, named in [
        (("a.mp4", (15, 16), 10), "size"),
        (("a.mp4", (16, 16), 0), "frame_rate_hz"),
        (("a.avi", (16, 16), 10), "path"),
    ]:
        with pytest.raises(ValueError, match=named):
            terrella.Film(tmp_path / arguments[0], *arguments[1:])
    with pytest.raises(ValueError, match="frame"):
        with terrella.Film(tmp_path / "a.mp4", (16, 16), 10) as film:
            film.write(np.zeros((16, 16, 3), np.uint8))
    with pytest.raises(terrella.Error, match="ffmpeg failed"):
        with terrella.Film(tmp_path / "nowhere/a.mp4", (16, 16), 10) as film:
            for _ in range(1000):
                film.write(np.zeros((16, 16, 4), np.uint8))
    # Nothing unfinished is left.
    assert list(tmp_path.iterdir()) == []


def test_the_widget_turns_under_the_mouse(earth, monkeypatch):
    pytest.importorskip("jupyter_rfb", reason="jupyter_rfb is not installed")
    import asyncio

    from terrella.notebook import View

    view = View(earth, "2018-06-21T12:00:00Z")
    before = view.get_frame()
    assert before.shape == (144, 256, 3) and before.dtype == np.uint8
    lat_deg, lon_deg, height_m = view.place
    loops = []
    # Outside an event loop the widget's own method would do nothing.
    monkeypatch.setattr(view, "request_draw", lambda: loops.append(asyncio.get_running_loop()))

    async def kernel():
        view.handle_event({"event_type": "pointer_down", "x": 100, "y": 70})
        view.handle_event({"event_type": "pointer_move", "x": 140, "y": 90})
        view.handle_event({"event_type": "pointer_up", "x": 140, "y": 90})
        view.handle_event({"event_type": "wheel", "dy": -100})
        for _ in range(400):
            if loops:
                break
            await asyncio.sleep(0.05)
        return asyncio.get_running_loop()

    loop = asyncio.run(kernel())
    assert view.place[0] > lat_deg and view.place[1] < lon_deg and view.place[2] < height_m
    assert loops and all(one is loop for one in loops)
    assert not np.array_equal(view.get_frame(), before)
