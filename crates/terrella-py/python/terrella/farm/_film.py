"""A scene's film as frames, drawn by many workers."""

from __future__ import annotations

import hashlib
import json
import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

from .. import _native
from .._earth import _textures
from .._film import encode_frames
from . import _files, _run, _worker
from ._engine import Call
from ._open_engine import check_engine, open_engine
from ._report import FarmError, Report

# Prefix of unfinished frames, the same as the command's.
_UNFINISHED = ".terrella-frame-"
# Most frames of a task. A worker that dies loses no written frame; at the end the other workers wait for at most one task.
_MOST_A_TASK = 16


def film(
    scene: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    video: str | os.PathLike[str] | None = None,
    size: tuple[int, int] | None = None,
    frames: range | None = None,
    workers: int | None = None,
    address: Any = None,
    format: Literal["png", "png16", "exr", "pq", "hlg"] = "png",
    alpha: bool = False,
    supersample: int | None = None,
    shutter: float | None = None,
    subframes: int = 16,
    peak_cd_m2: float | None = None,
    crf: int = 18,
    overwrite: bool = False,
    textures: str | os.PathLike[str] | None = None,
    adapter: str | None = None,
    frames_a_task: int | None = None,
    retries: int = 2,
    progress: bool | _run.Progress | None = None,
) -> Report:
    """Renders the frames of a scene's film into the folder `out`, as `terrella play SCENE --frames OUT --resume` does: the same files and the
    same index `frames.json`, so that each resumes what the other has begun.

    `size` is width and height in pixels (by default the scene's), `frames` the range to render (by default all; in steps of 1), `video`
    an MP4 that ffmpeg encodes from them with the quality `crf`. `workers` processes of this machine render, 2 by default; with
    `address` the workers of a Dask cluster ("tcp://host:8786", a `distributed.Client`, or "local"), which must see `scene` and `out` under
    the same paths. `overwrite` renders all frames again. `adapter` is a part of the name of the graphics adapter. `format`, `alpha`,
    `supersample`, `shutter` and `subframes` are those of the command, `peak_cd_m2` its option `--peak`.

    Raises `FarmError` if anything fails; complete output is kept, and the same call resumes.
    """
    scene, out = Path(scene).absolute(), Path(out).absolute()
    options = {"format": format, "alpha": alpha, "supersample": supersample, "shutter": shutter, "subframes": subframes, "peak_cd_m2": peak_cd_m2}
    pictures = _native.Pictures(**options)
    if frames is not None and (frames.step != 1 or len(frames) == 0 or frames.start < 0):
        raise ValueError(f"frames: {frames} is no range of frames in steps of 1")
    if frames_a_task is not None and not 1 <= frames_a_task <= 10_000:
        raise ValueError(f"frames_a_task: {frames_a_task} is not from 1 to 10000")
    _run.checked_retries(retries)
    check_engine(workers, address)
    if video is not None and (format in ("exr", "pq", "hlg") or alpha):
        raise ValueError("video: is made of opaque PNG of 8 bits; leave format and alpha out, or make it from the frames yourself")
    maps = _textures(textures)
    span = {} if frames is None else {"first": frames.start, "end": frames.stop}
    existing = "overwrite" if overwrite else "resume"
    folder = _native.FilmFolder(scene, maps, out, pictures, size=size, existing=existing, **span)
    report = Report(out, "frames")
    try:
        if overwrite:
            _files.forget(out)
        for record in _files.journals(out):
            folder.adopt(record.get("page", ""))
        first, end = folder.wanted
        kept = set(folder.kept)
        lacking = [index for index in range(first, end) if index not in kept]
        report.wanted, report.kept = end - first, len(kept)
        if folder.has_memory:
            report.notes.append("the ground of this scene is drawn by a surface whose level of detail hangs a little on the frames before (quadtree, "
                                "clipmap or projected-grid): frames may differ from those of one run; surface = \"contours\" draws the same everywhere")
        if lacking:
            begun = folder.kept_adapter or ""
            common = {
                "scene": str(scene), "textures": None if textures is None else str(maps), "out": str(out), "pictures": options,
                "size": size, "adapter": adapter, "expected": _worker.expected_inputs(scene, maps),
            }
            engine = open_engine(workers, address)
            try:
                folder.begin(begun)
                taking = _Taking(folder, report, begun)
                calls = _calls(common, folder, lacking, engine.workers, frames_a_task)
                _run.drive(engine, calls, report, retries=retries, progress=_run.shown(progress, "frames"), take=taking)
            finally:
                engine.close()
            _run.reject_failures(report)
        folder.finish()
        _files.forget(out)
        if video is not None:
            begin = time.monotonic()
            encode_frames(video, out, folder.name(first), end - first, folder.frame_rate_hz, crf=crf)
            report.video = Path(video)
            report.notes.append(f"{video}: put together in {time.monotonic() - begin:.1f} s")
    finally:
        folder.close()
    return report


def _calls(common: dict[str, Any], folder: Any, lacking: list[int], workers: int, most: int | None) -> Iterator[Call]:
    # Tasks are small enough that the last ones end at about the same time.
    most = most or max(1, min(_MOST_A_TASK, len(lacking) // (8 * workers)))
    for n in range(0, len(lacking), most):
        part = lacking[n:n + most]
        names = [(index, folder.name(index)) for index in part]
        label = f"frame {part[0]}" if len(part) == 1 else f"frames {part[0]} to {part[-1]}"
        yield Call(label, draw_part, {**common, "frames": names}, len(part))


class _Taking:
    """Brings what workers have drawn onto the page."""

    def __init__(self, folder: Any, report: Report, begun: str):
        self._folder, self._report, self._begun = folder, report, begun
        self._lacks: list[str] = []

    def __call__(self, call: Call, value: dict[str, Any]) -> None:
        report = self._report
        drawn_by = f"{value['adapter']} ({value['driver']})"
        if not report.adapters:
            self._begin(value["adapter"])
        elif drawn_by not in report.adapters:
            report.notes.append(f"{value['worker']} draws with {drawn_by}, others with {', '.join(sorted(report.adapters))}: "
                                "pictures of other adapters may differ a little")
        report.adapters.add(drawn_by)
        for record, lacks in value["frames"]:
            try:
                self._folder.add(record)
            except _native.Error as error:
                raise FarmError(str(error), None) from None
            report.done += 1
            report.bytes_written += json.loads(record)["bytes"]
            if lacks:
                number = json.loads(record)["index"]
                report.notes.append(f"frame {number} lacks tiles and is coarser there: {', '.join(lacks)}")
        report.by_worker[value["worker"]] = report.by_worker.get(value["worker"], 0) + len(value["frames"])
        report.drawing_seconds += value["seconds"]
        report.processor_seconds += value["processor_seconds"]

    def _begin(self, adapter: str) -> None:
        if self._begun not in ("", adapter):
            self._report.notes.append(f"the frames that are kept were drawn by {self._begun}, the others by {adapter}: they may differ a little; "
                                      "overwrite=True draws all again")
        if self._begun != adapter:
            self._folder.begin(adapter)


def draw_part(part: dict[str, Any]) -> dict[str, Any]:
    """Draws some frames and writes them: runs in a worker."""
    begin = time.monotonic()
    out = Path(part["out"])
    textures = _worker.check_inputs(part)
    options = part["pictures"]
    key = ("film", part["scene"], str(textures), part["size"], part["adapter"], tuple(sorted(options.items())), json.dumps(part["expected"]))
    frames = _worker.warm(key, lambda: _native.FilmFrames(
        part["scene"], textures, _native.Pictures(**options), size=part["size"], adapter=part["adapter"]))
    begin_processor = time.process_time()
    journal = _worker.journal(out)
    done = []
    for index, name in part["frames"]:
        path = out / name
        record = _written(path) if path.exists() else None
        if record is None:
            contents, record, lacks = frames.draw(index, name)
            with _files.pending(path, prefix=_UNFINISHED) as (file, before):
                file.write(contents)
                line = {"file": name, "sha256": file.sha256, "page": record}
                before.append(lambda line=line: journal.note(line))
        else:
            lacks = []
        done.append((record, lacks))
    return {"frames": done, "worker": _worker.name(), "adapter": frames.adapter, "driver": frames.driver, "seconds": time.monotonic() - begin,
            "processor_seconds": time.process_time() - begin_processor}


def _written(path: Path) -> str | None:
    """What is known of a frame that a worker wrote before it was lost in the same run."""
    digest = hashlib.sha256(path.read_bytes()).hexdigest()
    for record in _files.journals(path.parent):
        if record.get("file") == path.name and record.get("sha256") == digest:
            return record["page"]
    return None
