"""Data sets: daylight, licences, their card, how they are read, masks."""

import json
import pickle

import numpy as np
import pytest
import terrella
from conftest import ROOT
from farm_help import write_scene
from terrella import farm
from terrella.farm._card import attribution
from terrella.farm._card import card as card_of
from terrella.farm._samples import Chosen, Plan

COUNT = 5
LAYERS = ("land", "cloud_cover", "sun_elevation_deg", "range_m")
SCENE = '[camera]\nmode = "geodetic"\n[output]\nsamples = 1\n[sky]\nstars = false\n'
CHOSEN = {"count": COUNT, "seed": 3, "size": (24, 16), "layers": LAYERS, "samples_a_shard": 2, "workers": 1,
          "time": farm.Dates("2018-01-01T00:00:00Z", "2019-01-01T00:00:00Z"), "sun_elevation_deg": farm.Uniform(20, 70)}


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dataset")
    scene = write_scene(folder, SCENE)
    farm.sweep(scene, folder / "tar", **CHOSEN)
    farm.sweep(scene, folder / "zarr", format="zarr", **CHOSEN)
    return folder


def test_the_sun_stands_as_high_as_was_drawn(swept):
    data = farm.DataSet(swept / "zarr")
    for index in range(COUNT):
        known, elevation = data.known(index), data[index]["sun_elevation_deg"]
        assert 20 <= known["sun_elevation_deg"] <= 70
        # The truth layer at the centre of the image: the four pixels around it.
        middle = elevation[7:9, 11:13]
        if np.isfinite(middle).all():
            assert abs(middle.mean() - known["sun_elevation_deg"]) < 0.5, known


@pytest.mark.parametrize("is_morning", [True, False])
def test_times_are_moved_to_an_elevation(is_morning):
    chosen = Chosen(0, {"place": (48.0, 16.0), "height_m": 5e5, "heading_deg": 0.0, "pitch_deg": -90.0, "fov_deg": 45.0, "time": "2018-03-20T02:00:00Z"})
    assert chosen.move_time(30.0, is_morning)
    assert chosen.sun_elevation_deg() == pytest.approx(30.0, abs=1e-3)
    # Apparent noon at 16° E is at about 11:03 UTC on this date.
    assert (terrella.Epoch(chosen.values["time"]) < terrella.Epoch("2018-03-20T11:03:00Z")) == is_morning
    assert not chosen.move_time(60.0, is_morning)


def test_a_sun_that_never_stands_so_high_is_an_error(swept, tmp_path):
    with pytest.raises(ValueError, match="sun_elevation_deg: sample 0: in 100 attempts"):
        farm.sweep(swept / "scene.toml", tmp_path / "out", **{**CHOSEN, "place": (80.0, 0.0), "sun_elevation_deg": 60.0})


@pytest.mark.parametrize("wanted", [120, -90.5, float("nan"), farm.Uniform(100, 200), farm.Uniform(80, 91),
                                    farm.LogUniform(10, 100), farm.Choice([10.0, 95.0]), farm.Normal(40, 20), farm.Normal(40, 20, -90, 100), pytest.param(farm.distributions.Constant(-100), id="constant")])
def test_a_sun_beyond_the_zenith_is_an_error(swept, tmp_path, wanted):
    with pytest.raises(ValueError, match="sun_elevation_deg: .* is not from -90 to 90"):
        farm.sweep(swept / "scene.toml", tmp_path / "out", **{**CHOSEN, "sun_elevation_deg": wanted})
    assert not (tmp_path / "out").exists()


def test_a_function_that_draws_a_sun_beyond_the_zenith_is_an_error():
    given = {"place": (0.0, 0.0), "height_m": 5e5, "heading_deg": 0.0, "pitch_deg": -90.0, "fov_deg": 45.0, "time": "2018-03-20T12:00:00Z"}
    plan = Plan(1, {name: farm.distributions.Constant(value) for name, value in given.items()}, lambda random, index: {"sun_elevation_deg": 120})
    with pytest.raises(ValueError, match="sun_elevation_deg: sample 0: 120 is not from -90 to 90"):
        plan.sample(0)
    # Bounds make a Gaussian possible.
    farm.distributions.check_extent(farm.Normal(40, 20, -90, 90), "sun_elevation_deg", -90, 90)


def test_sets_with_much_night_warn(swept, tmp_path):
    night = {**CHOSEN, "sun_elevation_deg": farm.Choice([-30.0, 20.0]), "count": 1}
    with pytest.warns(UserWarning, match="% of the samples look at ground where the Sun is below the horizon"):
        farm.sweep(swept / "scene.toml", tmp_path / "out", **{**night, "sun_elevation_deg": -30.0, "place": (0.0, 0.0)})


def test_the_card_and_the_manifest_name_licences(swept):
    [day, own] = attribution(ROOT / "textures", ["day.jpg", "mine.png"], [])
    assert "public domain" in day["licence"] and day["source"].endswith("by Reto Stöckli") and "not stated" in own["licence"]
    files = ["clouds.jpg", "lines.bin", "moon.jpg", "night_lights.png", "place_names.bin", "places.bin", "seasons.png", "stars.bin", "water.png"]
    licences = [source["licence"] for source in attribution(ROOT / "textures", files, [])]
    assert not any("below" in licence or "not stated" in licence for licence in licences), licences
    manifest = json.loads((swept / "tar/manifest.json").read_text())
    assert {"day", "clouds"} <= {source["file"].partition(".")[0] for source in manifest["attribution"]}
    card = (swept / "tar/README.md").read_text()
    for words in [manifest["attribution"][0]["source"], "| `cloud_cover` |", "Uniform(least=20", 'farm.DataSet("tar")', "24 × 16", "`[earth] detail = false`", "rendered by terrella 0."]:
        assert words in card, words
    layers = [layer for layer in manifest["layers"] if layer["name"] != "cloud_cover"]
    assert "detail" not in card_of({**manifest, "name": "tar", "layers": layers})


def test_both_formats_hold_the_same_samples(swept):
    pytest.importorskip("PIL", reason="Pillow is not installed")
    tar, chunks = farm.DataSet(swept / "tar"), farm.DataSet(swept / "zarr")
    assert len(tar) == len(chunks) == COUNT and tar.layers == list(LAYERS)
    tar = pickle.loads(pickle.dumps(tar))
    for index in (4, 0, 3):
        assert tar.known(index) == chunks.known(index) and tar.known(index)["index"] == index
        one, other = tar[index], chunks[index]
        assert list(one) == list(other) == ["color", *LAYERS] and one["color"].shape == (16, 24, 3)
        for name in one:
            assert one[name].dtype == other[name].dtype and np.array_equal(one[name], other[name], equal_nan=True), name
    assert tar.known(-1) == tar.known(np.int64(COUNT - 1)) and np.array_equal(tar[-1]["color"], tar[COUNT - 1]["color"])
    assert [known["land"].shape for known in tar[1:4]] == [(16, 24)] * 3 and tar[5:] == []
    assert repr(tar) == f"<terrella.farm.DataSet {swept / 'tar'}, 5 samples of 24 × 16: color, land, cloud_cover, sun_elevation_deg, range_m>"
    for wrong in (5, -6):
        with pytest.raises(IndexError, match=f"{wrong} is not from -5 to 4"):
            tar[wrong]
    for wrong in ("0", 1.0):
        with pytest.raises(TypeError, match="index: a sample's number is needed"):
            tar[wrong]


def test_masks_are_those_of_the_layers(swept):
    path = farm.coco(swept / "zarr", ["land", "cloud", "night", "earth"])
    page = json.loads(path.read_text())
    assert [category["name"] for category in page["categories"]] == ["land", "cloud", "night", "earth"]
    assert len(page["images"]) == COUNT and page["licenses"][0]["name"]
    data = farm.DataSet(swept / "zarr")
    found = {(one["image_id"], one["category_id"]): one for one in page["annotations"]}
    for index in range(COUNT):
        land = data[index]["land"] >= 0.5
        assert ((index, 1) in found) == land.any()
        if not land.any():
            continue
        one = found[index, 1]
        # As pycocotools reads uncompressed run lengths: alternately outside and inside, in column order.
        counts = one["segmentation"]["counts"]
        pixels = np.repeat(np.arange(len(counts)) % 2, counts)
        assert np.array_equal(pixels.reshape(16, 24, order="F"), land) and one["area"] == land.sum()
        x, y, width, height = one["bbox"]
        assert land[y : y + height, x : x + width].sum() == land.sum() and land[y].any() and land[:, x].any()
    with pytest.raises(ValueError, match="'sea' is none of"):
        farm.coco(swept / "zarr", ["sea"])
    with pytest.raises(TypeError, match=r"categories: pass a list of names, for example \['land'\]"):
        farm.coco(swept / "zarr", "land")


def test_samples_of_chunks_count_from_the_end(swept):
    data = farm.DataSet(swept / "zarr")
    assert data.known(-1) == data.known(COUNT - 1) and np.array_equal(data.truth(-2)["land"], data[COUNT - 2]["land"], equal_nan=True)
    assert [sample["color"].shape for sample in data[::2]] == [(16, 24, 3)] * 3
    with pytest.raises(IndexError, match="5 is not from -5 to 4"):
        data.known(5)


def test_what_is_no_data_set(swept, tmp_path):
    (tmp_path / "manifest.json").write_text("{")
    with pytest.raises(farm.FarmError, match="no manifest"):
        farm.DataSet(tmp_path)
    (tmp_path / "manifest.json").write_text('{"complete": false}')
    with pytest.raises(farm.FarmError, match="not complete"):
        farm.DataSet(tmp_path)
