"""Labelled data sets of many workers."""

import io
import json
import math
import os
import resource
import shutil
import sys
import tarfile

import numpy as np
import pytest
import terrella
from farm_help import begin, children, contents, inodes, is_alive, kill, wait_for, write_scene
from terrella import farm

COUNT, EACH = 21, 4
LAYERS = ("lat_deg", "range_m", "lit")
SCENE = """
[time]
start = "2018-06-21T08:00:00Z"
duration_s = 60
speed = 60
[camera]
mode = "geodetic"
[output]
samples = 1
"""
CHOSEN = {"count": COUNT, "seed": 7, "size": (40, 32), "layers": LAYERS, "samples_a_shard": EACH}
RUN = f"""
import sys
from terrella import farm
chosen = {CHOSEN!r}
print(farm.sweep(sys.argv[1], sys.argv[2], workers=2, **chosen))
"""


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    folder = tmp_path_factory.mktemp("sweep")
    scene = write_scene(folder, SCENE)
    report = farm.sweep(scene, folder / "one", workers=1, **CHOSEN)
    assert (report.done, report.kept, report.wanted) == (COUNT, 0, COUNT)
    return folder


def samples(folder):
    """What training code reads, by plain tar and NumPy: (number, picture's bytes, layers, JSON)."""
    read = {}
    for shard in sorted(folder.glob("shard-*.tar")):
        with tarfile.open(shard) as tar:
            for entry in tar:
                assert (entry.mtime, entry.uid, entry.mode) == (0, 0, 0o644)
                key, _, ending = entry.name.partition(".")
                read.setdefault(int(key), {})[ending] = tar.extractfile(entry).read()
    for index, files in sorted(read.items()):
        layers = {name.removesuffix(".npy"): np.load(io.BytesIO(data)) for name, data in files.items() if name.endswith(".npy")}
        yield index, files["png"], layers, json.loads(files["json"])


def test_samples_are_what_they_say(swept):
    read = list(samples(swept / "one"))
    assert [index for index, *_ in read] == list(range(COUNT))
    scene = terrella.Scene(swept / "scene.toml", size=CHOSEN["size"])
    first, last = terrella.Epoch("2018-06-21T08:00:00Z"), terrella.Epoch("2018-06-21T09:00:00Z")
    for index, png, layers, known in read:
        assert known["index"] == index and known["seed"] == 7
        camera = dict(known["camera"])
        assert np.allclose(camera.pop("eye_itrf_m"), terrella.itrf_from_geodetic([camera["lat_deg"], camera["lon_deg"], camera["height_m"]]), rtol=1e-12)
        assert 4e5 <= camera["height_m"] <= 4e6 and -90 <= camera["pitch_deg"] <= -40
        assert first <= terrella.Epoch(known["time_utc"]) <= last
        seen = terrella.Camera.geodetic(**camera)
        drawn = scene.frame(known["time_utc"], camera=seen)
        assert drawn.png() == png
        truth = scene.truth(known["time_utc"], list(LAYERS), camera=seen)
        assert list(layers) == list(LAYERS)
        for name in LAYERS:
            assert layers[name].dtype == truth[name].dtype and np.array_equal(layers[name], truth[name], equal_nan=True)
    # The images differ, and the places span the globe.
    assert len({png for _, png, *_ in read}) > COUNT - 5  # The sea by night is black.
    assert np.ptp([known["camera"]["lon_deg"] for *_, known in read]) > 180


def test_the_manifest_says_what_is_in_it(swept):
    manifest = json.loads((swept / "one/manifest.json").read_text())
    assert manifest["format"] == "terrella sweep 1" and manifest["complete"] and manifest["count"] == COUNT
    assert manifest["scene"]["text"] == SCENE and manifest["seed"] == 7
    assert [layer["name"] for layer in manifest["layers"]] == list(LAYERS) and manifest["layers"][0]["unit"]
    assert manifest["exposure_ev"] == 0.5 and all(known["exposure_ev"] == 0.5 for *_, known in samples(swept / "one"))
    assert "| `exposure_ev` | the scene's: 0.5 |" in (swept / "one/README.md").read_text()
    assert manifest["drawn"]["height_m"] == "LogUniform(least=400000.0, most=4000000.0)"
    assert [shard["samples"] for shard in manifest["shards"]] == [4, 4, 4, 4, 4, 1]
    assert sorted(os.listdir(swept / "one")) == sorted(["README.md", "manifest.json", *(shard["file"] for shard in manifest["shards"])])


def test_automatic_exposure_has_no_number(swept, tmp_path):
    scene = write_scene(tmp_path, SCENE + 'exposure_ev = "auto"\n')
    farm.sweep(scene, tmp_path / "out", workers=1, **{**CHOSEN, "count": 1})
    assert json.loads((tmp_path / "out/manifest.json").read_text())["exposure_ev"] == "auto"
    assert [known["exposure_ev"] for *_, known in samples(tmp_path / "out")] == [None]


def test_a_sample_depends_on_seed_and_number_alone(swept, tmp_path):
    report = farm.sweep(swept / "scene.toml", tmp_path / "two", workers=2, **CHOSEN)
    assert len(report.by_worker) == 2
    assert contents(tmp_path / "two", ".tar") == contents(swept / "one", ".tar")
    others = {**CHOSEN, "count": 9, "samples_a_shard": 3}
    farm.sweep(swept / "scene.toml", tmp_path / "fewer", workers=1, **others)
    fewer, one = list(samples(tmp_path / "fewer")), list(samples(swept / "one"))
    assert [(n, png, known) for n, png, _, known in fewer] == [(n, png, known) for n, png, _, known in one[:9]]
    farm.sweep(swept / "scene.toml", tmp_path / "seed", workers=1, **{**others, "seed": 8})
    assert not any(a[1] == b[1] for a, b in zip(samples(tmp_path / "seed"), one))


def test_webdataset_reads_it(swept):
    webdataset = pytest.importorskip("webdataset", reason="webdataset is not installed")
    shards = sorted(map(str, (swept / "one").glob("shard-*.tar")))
    data = webdataset.WebDataset(shards, shardshuffle=False).decode()
    read = list(data)
    assert [one["__key__"] for one in read] == [f"{n:09}" for n in range(COUNT)]
    for one, (_, png, layers, known) in zip(read, samples(swept / "one")):
        values = one["lit.npy"]
        values = np.load(io.BytesIO(values)) if isinstance(values, bytes) else values
        assert np.array_equal(values, layers["lit"], equal_nan=True)
        reported = one["json"]
        assert (json.loads(reported) if isinstance(reported, bytes) else reported) == known and one["png"] == png


def test_zarr_reads_it(swept, tmp_path):
    scene = swept / "scene.toml"
    report = farm.sweep(scene, tmp_path / "z", workers=2, format="zarr", **{**CHOSEN, "layers": ("lat_deg", "normal_itrf")})
    assert report.done == COUNT
    lines = [json.loads(line) for path in sorted((tmp_path / "z/samples").iterdir()) for line in path.read_text().splitlines()]
    known = [known for *_, known in samples(swept / "one")]
    assert [{name: value for name, value in line.items() if name != "chunks"} for line in lines] == known
    # Complete chunks, readable without a library.
    one = np.fromfile(tmp_path / "z/lat_deg/3.0.0", "<f8").reshape(32, 40)
    layers = [layers for _, _, layers, _ in samples(swept / "one")]
    assert np.array_equal(one, layers[3]["lat_deg"], equal_nan=True)
    before = inodes(tmp_path / "z/lat_deg", ".0")
    (tmp_path / "z/lat_deg/9.0.0").write_bytes(b"half")
    again = farm.sweep(scene, tmp_path / "z", workers=1, format="zarr", **{**CHOSEN, "layers": ("lat_deg", "normal_itrf")})
    assert (again.kept, again.done) == (COUNT - EACH, EACH)
    after = inodes(tmp_path / "z/lat_deg", ".0")
    assert {name for name in before if before[name] != after[name]} == {f"{n}.0.0" for n in range(8, 12)}
    zarr = pytest.importorskip("zarr", reason="zarr is not installed")
    group = zarr.open_group(str(tmp_path / "z"), mode="r")
    assert group["color"].shape == (COUNT, 32, 40, 3) and group["normal_itrf"].shape == (COUNT, 32, 40, 3)
    for n in (0, 11, COUNT - 1):
        assert np.array_equal(group["lat_deg"][n], layers[n]["lat_deg"], equal_nan=True)
    norms = np.linalg.norm(group["normal_itrf"][5], axis=-1)
    assert np.nanmax(np.abs(norms - 1)) < 1e-5


def test_workers_and_who_began_the_run_may_be_killed(swept, tmp_path):
    out = tmp_path / "out"
    run = begin(RUN, swept / "scene.toml", out)
    wait_for(lambda: out.is_dir() and len(contents(out, ".tar")) >= 1, "a shard")
    workers = children(run.pid)
    kill(workers[0])
    wait_for(lambda: len(contents(out, ".tar")) >= 3 or run.poll() is not None, "three shards")
    workers = children(run.pid) if run.poll() is None else []
    run.kill()
    run.communicate()
    wait_for(lambda: not any(map(is_alive, workers)), "the workers' end", 20)
    before = inodes(out, ".tar")
    assert before
    report = farm.sweep(swept / "scene.toml", out, workers=2, **CHOSEN)
    assert report.kept + report.done == COUNT and report.kept >= EACH * (len(before) - 1)
    after = inodes(out, ".tar")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".tar") == contents(swept / "one", ".tar")
    assert (out / "manifest.json").read_bytes() == (swept / "one/manifest.json").read_bytes()
    assert sorted(os.listdir(out)) == sorted(os.listdir(swept / "one"))


def test_a_disk_that_fills_keeps_what_was_done(swept, tmp_path):
    out = tmp_path / "out"
    sizes = sorted(len(one) for one in contents(swept / "one", ".tar").values())
    limit = (sizes[0] + sizes[1]) // 2
    assert sizes[0] < limit < sizes[1]
    run = begin(RUN, swept / "scene.toml", out, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)))
    _, errors = run.communicate(timeout=120)
    assert run.returncode == 1 and "make room and run the same again" in errors, errors
    assert [name for name in os.listdir(out) if name.endswith((".tar", ".part"))] == []
    report = farm.sweep(swept / "scene.toml", out, workers=2, **CHOSEN)
    assert report.done == COUNT and contents(out, ".tar") == contents(swept / "one", ".tar")


def test_other_sweeps_are_rejected(swept):
    scene, out = swept / "scene.toml", swept / "one"
    before = inodes(out, ".tar")
    other = write_scene(swept, SCENE.replace("samples = 1", "samples = 4"), "other.toml")
    # Without clouds a scene reads fewer maps, and none of them is another.
    cloudless = write_scene(swept, SCENE + "[earth]\nclouds = false\n", "cloudless.toml")
    for path, options, words in [
        (scene, {"seed": 8}, "seed was 7 and is 8"),
        (scene, {"size": (41, 32)}, "size was"),
        (scene, {"layers": ("lit",)}, "layers was"),
        (scene, {"height_m": 5e5}, "height_m was LogUniform.* and is Constant"),
        (scene, {"count": 22}, "count was 21 and is 22"),
        (other, {}, "holds another sweep: the scene has changed; choose"),
        (cloudless, {}, "holds another sweep: the scene has changed; choose"),
    ]:
        with pytest.raises(farm.FarmError, match=words) as raised:
            farm.sweep(path, out, **{**CHOSEN, **options})
        assert len(str(raised.value)) < 400, raised.value
    assert inodes(out, ".tar") == before


def test_changed_maps_are_named(swept, tmp_path):
    maps, scene = tmp_path / "maps", swept / "scene.toml"
    shutil.copytree(os.environ["TERRELLA_TEXTURES"], maps)
    one = {**CHOSEN, "count": 1, "workers": 1, "textures": maps}
    farm.sweep(scene, tmp_path / "out", **one)
    # Small maps are PNG.
    clouds, day = (next(path for path in maps.iterdir() if path.stem == name) for name in ("clouds", "day"))
    clouds.unlink()
    with pytest.raises(farm.FarmError, match="holds another sweep: the scene reads other files; choose"):
        farm.sweep(scene, tmp_path / "out", **one)
    shutil.copy(day, clouds)
    with pytest.raises(farm.FarmError, match=f"holds another sweep: the maps have changed \\({clouds.name}\\); choose"):
        farm.sweep(scene, tmp_path / "out", **one)


def test_a_call_without_workers_leaves_the_folder_as_it_was(swept, tmp_path, monkeypatch):
    scene = swept / "scene.toml"
    for options, kind in [({"workers": 0}, ValueError), ({"address": "nonsense://x", "workers": None}, farm.FarmError)]:
        with pytest.raises(kind):
            farm.sweep(scene, tmp_path / "out", **{**CHOSEN, **options})
        assert not (tmp_path / "out").exists()
    # As if Dask were not installed.
    monkeypatch.setitem(sys.modules, "distributed", None)
    monkeypatch.delitem(sys.modules, "terrella.farm._dask", raising=False)
    monkeypatch.delattr("terrella.farm._dask", raising=False)
    before = contents(swept / "one", ".tar")
    for out, options in [(tmp_path / "out", {}), (swept / "one", {"overwrite": True})]:
        with pytest.raises(farm.FarmError, match=r"pip install 'terrella-earth\[farm\]'"):
            farm.sweep(scene, out, address="local", **{**CHOSEN, **options})
    with pytest.raises(farm.FarmError, match="pip install"):
        farm.film(scene, tmp_path / "out", address="local")
    assert not (tmp_path / "out").exists() and contents(swept / "one", ".tar") == before


def test_bad_arguments_are_named(swept, tmp_path):
    scene = swept / "scene.toml"
    for options, words in [
        ({"count": 0}, "count"),
        ({"seed": -1}, "seed"),
        ({"layers": ("colour",)}, "colour; there are lat_deg"),
        ({"layers": ("lit", "lit")}, "layers"),
        ({"format": "tfrecord"}, "format"),
        ({"samples_a_shard": 0}, "samples_a_shard"),
        ({"size": (0, 4)}, "size"),
        ({"fov_deg": lambda random: 30.0}, "fov_deg: workers cannot import"),
        ({"place": (91.0, 0.0)}, "lat_deg"),
    ]:
        with pytest.raises(ValueError, match=words):
            sample = {**CHOSEN, **options}
            farm.sweep(scene, tmp_path / "out", workers=1, **sample)
            # Errors that only drawing can detect are in the report.
    with pytest.raises(TypeError, match=r"layers: pass a list of names, for example \['lit'\]"):
        farm.sweep(scene, tmp_path / "out", **{**CHOSEN, "layers": "lit"})
    with pytest.raises(farm.FarmError, match="exposure_ev") as raised:
        farm.sweep(scene, tmp_path / "out", workers=1, **{**CHOSEN, "count": 1, "exposure_ev": 99.0})
    assert raised.value.report.failed[0].name == "shard 0"
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine/notes.txt").write_text("mine")
    with pytest.raises(farm.FarmError, match="notes.txt"):
        farm.sweep(scene, tmp_path / "mine", **CHOSEN)


def test_distributions_draw_what_they_say():
    random = np.random.Generator(np.random.PCG64(1))

    def many(distribution):
        return np.array([distribution.draw(random) for _ in range(4000)])

    uniform = many(farm.Uniform(-3, 5))
    assert -3 <= uniform.min() < -2.98 and 4.98 < uniform.max() <= 5 and abs(uniform.mean() - 1) < 0.15
    log = np.log10(many(farm.LogUniform(1e2, 1e6)))
    assert 2 <= log.min() and log.max() <= 6 and abs(log.mean() - 4) < 0.08
    normal = many(farm.Normal(10, 2))
    assert abs(normal.mean() - 10) < 0.15 and abs(normal.std() - 2) < 0.1
    cut = many(farm.Normal(0, 1, 1, 2))
    # The mean of a Gaussian cut to 1…2: (φ(1) − φ(2)) / (Φ(2) − Φ(1)).
    assert 1 <= cut.min() and cut.max() <= 2 and abs(cut.mean() - 1.3832) < 0.02
    places = np.array([farm.OnSphere().draw(random) for _ in range(4000)])
    # Half of a hemisphere's area lies between the equator and 30°.
    assert abs(np.mean(np.abs(places[:, 0]) < 30) - 0.5) < 0.03 and abs(np.mean(places[:, 1] > 90) - 0.25) < 0.03
    box = np.array([farm.OnSphere((40, 50), (5, 15)).draw(random) for _ in range(500)])
    assert 40 <= box[:, 0].min() and box[:, 0].max() <= 50 and 5 <= box[:, 1].min() and box[:, 1].max() <= 15
    pacific = np.array([farm.OnSphere((30, 60), (170, -160)).draw(random) for _ in range(600)])[:, 1]
    assert np.abs(pacific).max() <= 180 and set(np.sign(pacific)) == {-1, 1} and (np.abs(pacific) >= 160).all()
    assert pacific[pacific > 0].min() >= 170 and abs(np.mean(pacific > 0) - 1 / 3) < 0.07
    assert 170 <= farm.OnSphere((30, 60), (170, 190)).draw(random)[1] <= 190
    chosen = many(farm.Choice([1, 2, 3], weights=[1, 0, 3]))
    assert set(chosen) == {1, 3} and abs(np.mean(chosen == 3) - 0.75) < 0.03
    dates = farm.Dates(terrella.Epoch("2018-01-01T00:00:00Z"), np.datetime64("2018-01-02T00:00:00"))
    assert (dates.first, dates.last) == ("2018-01-01T00:00:00.000Z", "2018-01-02T00:00:00.000Z")
    for make in [lambda: farm.Uniform(2, 1), lambda: farm.LogUniform(0, 1), lambda: farm.Normal(0, 0), lambda: farm.Normal(0, 1, 99, 100),
                 lambda: farm.Choice([]), lambda: farm.Choice([1], [-1]), lambda: farm.OnSphere((0, 91)), lambda: farm.OnSphere((9, 1)),
                 lambda: farm.OnSphere((0, 9), (0, 361)), lambda: farm.OnSphere((0, 9), (190, 170)), lambda: farm.OnSphere((0, 9), (0, math.nan)),
                 lambda: farm.Dates("2018-01-02T00:00:00Z", "2018-01-01T00:00:00Z"), lambda: farm.Uniform(0, math.nan)]:
        with pytest.raises(ValueError):
            make()


def test_functions_of_modules_draw_too(swept, tmp_path, monkeypatch):
    (tmp_path / "flown.py").write_text(
        "def height_m(random):\n    return 3e5 + 1e5 * random.random()\n\n\n"
        "def sample(random, index):\n    return {'place': (10.0, 5.0 * index), 'exposure_ev': -2.0}\n")
    monkeypatch.syspath_prepend(str(tmp_path))
    import flown

    farm.sweep(swept / "scene.toml", tmp_path / "out", **{**CHOSEN, "count": 6}, workers=2, height_m=flown.height_m, draw=flown.sample)
    known = [known for *_, known in samples(tmp_path / "out")]
    assert [one["camera"]["lon_deg"] for one in known] == [0.0, 5.0, 10.0, 15.0, 20.0, 25.0]
    assert all(3e5 <= one["camera"]["height_m"] <= 4e5 and one["exposure_ev"] == -2.0 for one in known)
    # A changed function makes a different sweep.
    (tmp_path / "flown.py").write_text((tmp_path / "flown.py").read_text().replace("10.0", "11.0"))
    import importlib
    import linecache

    linecache.clearcache()
    importlib.reload(flown)
    with pytest.raises(farm.FarmError, match="draw was flown.sample"):
        farm.sweep(swept / "scene.toml", tmp_path / "out", **{**CHOSEN, "count": 6}, workers=2, height_m=flown.height_m, draw=flown.sample)
