"""Scenes and Earths of dicts and texts."""

import datetime
import os
from pathlib import Path

import numpy as np
import pytest
import terrella
from terrella import _toml

TABLES = {
    "time": {"start": terrella.Epoch("2018-06-21T12:00:00Z"), "duration_s": np.float64(10)},
    "camera": {"mode": "geodetic", "lat_deg": np.int64(10), "lon_deg": 0, "height_km": 12000},
    "output": {"size": (64, 36), "samples": 1},
    "sky": {"stars": False},
}


def test_dicts_are_written_as_toml():
    tables = {"a": {"b": True, "c": [1, 2.5], "d": 'q"\\\n\x7fü', "e": {"f g": Path("x/y")}, "left out": None}, "l": [{"n": 1}, {"n": 2}]}
    text = _toml.text(tables)
    assert text.splitlines()[0] == '["a"]' and text.count('[["l"]]') == 2
    tomllib = pytest.importorskip("tomllib", reason="Python 3.10 has no tomllib")
    read = tomllib.loads(text)
    assert read == {"a": {"b": True, "c": [1, 2.5], "d": 'q"\\\n\x7fü', "e": {"f g": "x/y"}}, "l": [{"n": 1}, {"n": 2}]}
    when = datetime.datetime(2018, 6, 21, tzinfo=datetime.timezone.utc)
    assert tomllib.loads(_toml.text({"time": {"start": when}})) == {"time": {"start": "2018-06-21T00:00:00.000Z"}}
    for wrong, where in [({"a": 1}, "a: a table"), ([], "tables"), ({"a": {"b": object()}}, r"a\.b: object"), ({"a": {1: 2}}, "a: names"),
                         ({"a": {"b": [b"c"]}}, r"a\.b\[0\]"), ({1: {}}, "1: names")]:
        with pytest.raises(TypeError, match=where):
            _toml.text(wrong)


def test_a_scene_of_a_dict_is_that_of_its_text(tmp_path):
    of_dict = terrella.Scene.from_dict(TABLES)
    of_text = terrella.Scene.from_text(_toml.text(TABLES))
    path = tmp_path / "scene.toml"
    path.write_text(_toml.text(TABLES))
    picture = terrella.Scene(path).frame()
    assert of_dict.size == (64, 36) and of_dict.start == TABLES["time"]["start"]
    assert np.array_equal(of_dict.frame().color, picture.color) and np.array_equal(of_text.frame().color, picture.color)
    with pytest.raises(terrella.SceneError, match=r"<dict>.*\[camera\] fov_deg"):
        terrella.Scene.from_dict({"camera": {"fov_deg": 200}})
    with pytest.raises(terrella.SceneError, match="<text>:2"):
        terrella.Scene.from_text("[camera]\nfov_deg = 200\n")
    with pytest.raises(terrella.SceneError, match="missing.tle"):
        terrella.Scene.from_dict({"orbit": {"file": "missing.tle"}}, folder=tmp_path)


def test_python_hears_what_is_left_out(tmp_path, caplog):
    maps = Path(os.environ["TERRELLA_TEXTURES"])
    for path in maps.iterdir():
        if not path.name.startswith("clouds"):
            (tmp_path / path.name).symlink_to(path)
    assert terrella.Scene.from_dict(TABLES, textures=tmp_path).frame().size == (64, 36)
    [record] = caplog.records
    assert (record.name, record.levelname) == ("terrella", "WARNING") and record.getMessage().endswith("is missing; clouds is left out")


def test_an_earth_of_a_dict_has_terrain():
    camera = terrella.Camera.geodetic(28, 86, 60_000, pitch_deg=-25)
    time = "2018-06-21T06:00:00Z"
    smooth = terrella.Earth.from_dict({}, (64, 36))
    rough = terrella.Earth.from_dict({"earth": {"elevation": []}, "output": {"samples": 1}}, (64, 36))
    heights = [earth.truth(camera, time, ["height_m"])["height_m"] for earth in (smooth, rough)]
    assert np.nanmax(np.abs(heights[0])) < 1 and np.nanmax(heights[1]) > 3000
    with pytest.raises(ValueError, match="no table 'orbit'"):
        terrella.Earth.from_dict({"orbit": {}})
    with pytest.raises(terrella.Error, match="nowhere"):
        terrella.Earth.from_dict({"earth": {"pack": "nowhere"}})


def test_pictures_are_written_as_the_command_writes_them():
    color = np.arange(4 * 5 * 4, dtype=np.uint8).reshape(4, 5, 4)
    png = terrella.Frame(color, "2018-06-21T06:00:00Z").png()
    # The PNG has no alpha channel: colour type 2.
    assert png[:8] == b"\x89PNG\r\n\x1a\n" and png[24:26] == b"\x08\x02"
    assert terrella.Frame(color[:, ::-1], "2018-06-21T06:00:00Z").png() != png
