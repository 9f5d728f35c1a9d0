"""Labelled pictures of a scene from many places, drawn by many workers into shards."""

from __future__ import annotations

import json
import os
import shutil
import time
import warnings
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

from .. import _native
from .._earth import _textures
from . import _files, _run, _worker
from ._card import CARD, attribution, card
from ._engine import Call
from ._formats import FORMATS
from ._open_engine import check_engine, open_engine
from ._report import FarmError, Report
from ._samples import ORDER, Plan
from .distributions import Constant, Dates, Drawn, LogUniform, OnSphere, Uniform, as_distribution, check_extent, reported

if TYPE_CHECKING:
    from .._types import Time

FORMAT = "terrella sweep 1"
MANIFEST = "manifest.json"
# Default layers of a sweep.
DEFAULT_LAYERS = ("lat_deg", "lon_deg", "range_m", "land", "cloud_cover")
_MOST_SAMPLES = 1_000_000_000
# The number of samples checked before a sweep, and the share of night samples that causes a warning.
_LOOKED_AT = 256
_MUCH_NIGHT = 0.4
# Most characters of a value in a message.
_MOST_SHOWN = 80


def sweep(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    count: int,
    *,
    seed: int = 0,
    size: tuple[int, int] = (256, 256),
    layers: Sequence[str] = DEFAULT_LAYERS,
    place: Drawn = OnSphere(),
    height_m: Drawn = LogUniform(4e5, 4e6),
    heading_deg: Drawn = Uniform(0.0, 360.0),
    pitch_deg: Drawn = Uniform(-90.0, -40.0),
    fov_deg: Drawn = 45.0,
    time: Drawn | Time | None = None,
    exposure_ev: Drawn | None = None,
    sun_elevation_deg: Drawn | None = None,
    draw: Callable[[Any, int], dict[str, Any]] | None = None,
    format: Literal["webdataset", "zarr"] = "webdataset",
    samples_a_shard: int = 64,
    workers: int | None = None,
    address: Any = None,
    overwrite: bool = False,
    textures: str | os.PathLike[str] | None = None,
    adapter: str | None = None,
    retries: int = 2,
    progress: bool | _run.Progress | None = None,
) -> Report:
    """Renders `count` images of a scene with truth layers into a data set in the folder `out`. Positions, times and exposures are sampled from
    distributions.

    `place` gives a latitude and a longitude, `height_m` metres above the ellipsoid, `heading_deg` degrees clockwise from north, `pitch_deg`
    degrees above the horizontal, `fov_deg` the vertical field of view, `time` a time (by default any of the scene's), `exposure_ev` exposure
    values (by default the scene's exposure, 0.5 unless it sets another; samples record null where it is automatic). `sun_elevation_deg` moves each
    time, by half a day at most, to when the Sun has this elevation, from -90 to 90, over the ground in the middle of the image. Each is a distribution of `terrella.farm`, a value, or a function of a
    `numpy.random.Generator`; `draw` is a function of a generator and the sample's number that returns several of them by name. Functions
    must be defined in a module that workers can import. `layers` are names of `terrella.truth_layers()`.

    `cloud_cover` is that of the smooth cloud map: for labels of clouds, write `[earth] detail = false` in the scene.

    Where many samples look at ground by night a warning says so, before anything is rendered.

    A sample depends only on `seed` and its number. `format` "webdataset" writes tar shards of `samples_a_shard` samples, "zarr" a Zarr
    group. `manifest.json` describes it, with the licences of the maps; `README.md` is its card. `DataSet` reads it, `coco` writes masks of it. `workers`, `address`, `overwrite`, `textures`, `adapter` and `retries` as for `film`.

    Raises `FarmError` if anything fails; complete output is kept, and the same call resumes.
    """
    scene, out = Path(scene).absolute(), Path(out).absolute()
    if not 1 <= count <= _MOST_SAMPLES:
        raise ValueError(f"count: {count} is not from 1 to {_MOST_SAMPLES}")
    if not 0 <= seed < 1 << 64:
        raise ValueError(f"seed: {seed} is not from 0 to 2**64 - 1")
    if not 1 <= samples_a_shard <= 100_000:
        raise ValueError(f"samples_a_shard: {samples_a_shard} is not from 1 to 100000")
    if format not in FORMATS:
        raise ValueError(f"format: {format!r} is none of {', '.join(FORMATS)}")
    if not (len(size) == 2 and all(1 <= side <= 65536 for side in size)):
        raise ValueError(f"size: {size} is not two numbers of pixels from 1 to 65536")
    if isinstance(layers, str):
        raise TypeError(f"layers: pass a list of names, for example [{layers!r}], not a text")
    known = {name: (name, unit, dtype, what) for name, unit, dtype, what in _native.truth_layers()}
    unknown = [name for name in layers if name not in known]
    if unknown or len(set(layers)) != len(layers):
        raise ValueError(f"layers: {', '.join(unknown) or 'one is named twice'}; there are {', '.join(known)}, each once")
    _run.checked_retries(retries)
    check_engine(workers, address)
    maps = _textures(textures)
    key = json.loads(_native.scene_key(scene, maps))
    given = {"place": place, "height_m": height_m, "heading_deg": heading_deg, "pitch_deg": pitch_deg, "fov_deg": fov_deg, "time": time,
             "exposure_ev": exposure_ev, "sun_elevation_deg": sun_elevation_deg}
    distributions = {name: as_distribution(value, name) for name, value in given.items() if value is not None}
    if "sun_elevation_deg" in distributions:
        check_extent(distributions["sun_elevation_deg"], "sun_elevation_deg", -90, 90)
    if time is None:
        distributions["time"] = _dates_of(scene, maps)
    expected = _worker.expected_inputs(scene, maps)
    exposure = _native.scene_exposure(scene, maps)
    definition = {
        "format": FORMAT,
        "program": key["program"],
        "scene": {"file": scene.name, "blake3": key["scene_blake3"], "inputs": key["inputs"], "text": scene.read_text(encoding="utf-8")},
        "maps_sha256": expected["maps"],
        "size": list(size),
        "layers": [{"name": name, "unit": known[name][1], "dtype": known[name][2], "what": known[name][3]} for name in layers],
        "seed": seed,
        "count": count,
        "samples_a_shard": samples_a_shard,
        "kind": format,
        "drawn": {name: reported(distributions[name]) for name in ORDER if name in distributions},
        "exposure_ev": "auto" if exposure is None else exposure,
        "draw": None if draw is None else reported(as_distribution(draw, "draw")),
        "attribution": attribution(maps, _files_of(key), _native.scene_attribution(scene, maps)),
    }
    plan = Plan(seed, distributions, draw)
    # Report problems of all samples before any worker starts.
    looked_at = [plan.sample(index) for index in range(min(count, _LOOKED_AT))]
    night = sum(chosen.sun_elevation_deg() < 0 for chosen in looked_at) / len(looked_at)
    if night >= _MUCH_NIGHT:
        warnings.warn(f"{night:.0%} of the samples look at ground where the Sun is below the horizon; "
                      "sun_elevation_deg=farm.Uniform(20, 80) moves their times to daylight", stacklevel=2)
    part = {"scene": str(scene), "textures": None if textures is None else str(maps), "out": str(out), "size": tuple(size),
            "layers": list(layers), "adapter": adapter, "expected": expected, "plan": plan, "kind": format,
            "scene_blake3": key["scene_blake3"], "exposure_ev": exposure}
    return _fill(out, definition, part, FORMATS[format], workers, address, overwrite, retries, progress)


def _files_of(key: dict[str, Any]) -> list[str]:
    """Names of the files of maps, lines and stars that a scene's pictures come from."""
    return [Path(file["file"]).name for file in key["inputs"] if file["key"].startswith(("earth.", "layers.", "sky."))]


def _dates_of(scene: Path, maps: Path) -> Any:
    first, last = (epoch.utc for epoch in _native.scene_dates(scene, maps))
    return Constant(first) if first == last else Dates(first, last)


def _fill(out: Path, definition: dict[str, Any], part: dict[str, Any], kind: Any, workers: int | None, address: Any, overwrite: bool, retries: int,
          progress: Any) -> Report:
    """Makes the shards that lack."""
    _check_folder(out, definition, overwrite)
    is_new = not out.exists()
    lock = _files.Lock(out)
    try:
        report = Report(out, "samples", wanted=definition["count"])
        shards = {} if overwrite else _kept(out, definition, kind)
        report.kept = sum(shard["samples"] for shard in shards.values())
        calls = list(_calls(definition, part, set(shards)))
        if not calls and not overwrite and (out / MANIFEST).exists() and json.loads((out / MANIFEST).read_text()).get("complete"):
            _files.forget(out)
            return report

        def take(call: Call, value: dict[str, Any]) -> None:
            shards[value["shard"]["shard"]] = value["shard"]
            report.done += call.count
            report.bytes_written += value["shard"]["bytes"]
            report.by_worker[value["worker"]] = report.by_worker.get(value["worker"], 0) + call.count
            report.drawing_seconds += value["seconds"]
            report.processor_seconds += value["processor_seconds"]
            report.adapters.add(f"{value['adapter']}")
            report.notes += value["notes"]

        try:
            engine = open_engine(workers, address)
        except BaseException:
            # Nothing was rendered: the folder stays as it was.
            if is_new:
                shutil.rmtree(out, ignore_errors=True)
            raise
        try:
            if overwrite:
                _remove(out, kind)
            _write_manifest(out, definition, shards, complete=False)
            kind.begin(out, definition)
            _run.drive(engine, iter(calls), report, retries=retries, progress=_run.shown(progress, "samples"), take=take)
        finally:
            engine.close()
            # Unfinished files of workers that died.
            for half in out.glob("**/.terrella-*.part"):
                half.unlink(missing_ok=True)
            if shards:
                _keep(out, definition, shards)
        _run.reject_failures(report)
        _write_manifest(out, definition, shards, complete=True)
        _files.write_whole(out / CARD, card({**definition, "name": out.name}).encode())
        _files.forget(out)
        if len(report.adapters) > 1:
            report.notes.append(f"drawn by several adapters ({', '.join(sorted(report.adapters))}): their pictures may differ a little")
        return report
    finally:
        lock.release()


def _remove(out: Path, kind: Any) -> None:
    """Removes an earlier sweep."""
    kind.remove(out)
    (out / MANIFEST).unlink(missing_ok=True)
    for old in (out / _files.OWN).glob("journal-*.jsonl"):
        old.unlink()


def _keep(out: Path, definition: dict[str, Any], shards: dict[int, dict[str, Any]]) -> None:
    """What is done comes into the manifest, if there is room; else the journals have it."""
    try:
        _write_manifest(out, definition, shards, complete=False)
    except OSError:
        pass


def _check_folder(out: Path, definition: dict[str, Any], overwrite: bool) -> None:
    """Rejects a folder that holds something else. Writes nothing."""
    if not out.exists():
        return
    manifest = out / MANIFEST
    if manifest.exists():
        try:
            found = json.loads(manifest.read_text(encoding="utf-8"))
        except ValueError as error:
            found = {"problem": str(error)}
        if overwrite:
            return
        if found.get("format") != FORMAT:
            raise FarmError(f"{manifest}: is no manifest of a sweep ({found.get('problem', found.get('format'))}); choose another folder, or "
                            "give overwrite=True to draw all again")
        differences = [name for name in definition if definition[name] != found.get(name)]
        if differences:
            if "scene" in differences:
                # These follow from the scene and its files.
                differences = [name for name in differences if name not in ("maps_sha256", "attribution", "exposure_ev")]
            words = "; ".join(_difference(name, found.get(name), definition[name]) for name in differences)
            raise FarmError(f"{out}: holds another sweep: {words}; choose another folder, or give overwrite=True to draw all again")
        return
    other = [path.name for path in out.iterdir() if not path.name.startswith(".terrella")]
    if other:
        raise FarmError(f"{out}: holds {sorted(other)[0]} and no {MANIFEST}: it is no sweep; choose another folder")


def _difference(name: str, found: Any, wanted: Any) -> str:
    if name == "scene":
        return _scene_difference(found or {}, wanted)
    if name in ("maps_sha256", "attribution"):
        return f"{name} has changed"
    if name == "layers":
        found, wanted = ([layer["name"] for layer in layers or []] for layers in (found, wanted))
    if name == "drawn":
        names = [one for one in {**(found or {}), **wanted} if (found or {}).get(one) != wanted.get(one)]
        return "; ".join(f"{one} was {_short((found or {}).get(one))} and is {_short(wanted.get(one))}" for one in names)
    return f"{name} was {_short(found)} and is {_short(wanted)}"


def _scene_difference(found: dict[str, Any], wanted: dict[str, Any]) -> str:
    """Which of a scene and its files have changed."""
    known = {(file["key"], file["file"]): file["blake3"] for file in found.get("inputs", [])}
    changed = [file for file in wanted["inputs"] if known.get((file["key"], file["file"]), file["blake3"]) != file["blake3"]]
    parts = []
    if any(found.get(name) != wanted[name] for name in ("file", "blake3")):
        parts.append("the scene has changed")
    is_map = [file["key"].startswith(("earth.", "layers.", "sky.")) for file in changed]
    for what, wanted_kind in [("maps", True), ("other files of the scene", False)]:
        if names := [Path(file["file"]).name for file, kind in zip(changed, is_map) if kind == wanted_kind]:
            parts.append(f"the {what} have changed ({_short(', '.join(names))})")
    return "; ".join(parts) or "the scene reads other files"


def _short(value: Any) -> str:
    words = str(value)
    return words if len(words) <= _MOST_SHOWN else words[:_MOST_SHOWN] + "…"


def _kept(out: Path, definition: dict[str, Any], kind: Any) -> dict[int, dict[str, Any]]:
    """The shards of earlier runs that are whole, by their numbers."""
    known: dict[int, dict[str, Any]] = {}
    manifest = out / MANIFEST
    noted = list(_files.journals(out))
    if manifest.exists():
        noted += json.loads(manifest.read_text(encoding="utf-8")).get("shards", [])
    for shard in noted:
        number = shard.get("shard")
        if isinstance(number, int) and number not in known and _is_of(shard, definition, kind) and kind.is_whole(out, shard):
            known[number] = shard
    return known


def _is_of(shard: dict[str, Any], definition: dict[str, Any], kind: Any) -> bool:
    first = shard["shard"] * definition["samples_a_shard"]
    return (shard.get("first"), shard.get("file")) == (first, kind.name(shard["shard"])) and first < definition["count"]


def _calls(definition: dict[str, Any], part: dict[str, Any], kept: set[int]) -> Iterator[Call]:
    count, each = definition["count"], definition["samples_a_shard"]
    for number, first in enumerate(range(0, count, each)):
        if number not in kept:
            samples = min(each, count - first)
            yield Call(f"shard {number}", draw_part, {**part, "shard": number, "first": first, "samples": samples}, samples)


def _write_manifest(out: Path, definition: dict[str, Any], shards: dict[int, dict[str, Any]], *, complete: bool) -> None:
    ordered = [shards[number] for number in sorted(shards)]
    text = json.dumps({**definition, "complete": complete, "shards": ordered}, indent=1, ensure_ascii=False)
    _files.write_whole(out / MANIFEST, text.encode() + b"\n")


def draw_part(part: dict[str, Any]) -> dict[str, Any]:
    """Draws a shard and writes it: runs in a worker."""
    begin = time.monotonic()
    out = Path(part["out"])
    textures = _worker.check_inputs(part)
    kind = FORMATS[part["kind"]]
    journal = _worker.journal(out)
    begin_processor = time.process_time()
    # A worker that died in this run may have written the shard.
    if (shard := _written(out, part, kind)) is None:
        key = ("sweep", part["scene"], str(textures), part["size"], part["adapter"], json.dumps(part["expected"]))
        scene = _worker.warm(key, lambda: _scene(part, textures))
        begin_processor = time.process_time()
        numbers = range(part["first"], part["first"] + part["samples"])
        adapter = scene.adapter
        shard = kind.write(out, part, adapter, (_sample(scene, part, index) for index in numbers), journal.note)
    else:
        adapter = shard["adapter"]
    return {"shard": shard, "worker": _worker.name(), "adapter": adapter, "seconds": time.monotonic() - begin,
            "processor_seconds": time.process_time() - begin_processor, "notes": []}


def _written(out: Path, part: dict[str, Any], kind: Any) -> dict[str, Any] | None:
    if not kind.path(out, part["shard"]).exists():
        return None
    noted = (shard for shard in _files.journals(out) if shard.get("shard") == part["shard"])
    return next((shard for shard in noted if kind.is_whole(out, shard)), None)


def _scene(part: dict[str, Any], textures: Path) -> Any:
    return _native.Scene(part["scene"], textures, size=part["size"], adapter=part["adapter"])


def _sample(scene: Any, part: dict[str, Any], index: int) -> tuple[int, dict[str, Any], Any, dict[str, Any]]:
    """A sample: its number, what is known of it, its picture, its layers."""
    chosen = part["plan"].sample(index)
    camera, time = chosen.camera(), chosen.values["time"]
    color = scene.color(time, camera=camera, exposure_ev=chosen.values.get("exposure_ev"))
    truth = scene.truth(time, part["layers"], camera=camera) if part["layers"] else {}
    reported = chosen.reported()
    if reported["exposure_ev"] is None:
        reported["exposure_ev"] = part["exposure_ev"]
    known = {**reported, "seed": part["plan"].seed, "scene_blake3": part["scene_blake3"]}
    return index, known, color, truth
