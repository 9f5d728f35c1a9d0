"""Imagery packs, cut by many workers."""

from __future__ import annotations

import os
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Literal

from .. import _native
from . import _run, _worker
from ._engine import Call
from ._open_engine import open_engine
from ._report import FarmError, Report


def pack(
    out: str | os.PathLike[str],
    day: str | os.PathLike[str],
    *,
    clouds: str | os.PathLike[str] | None = None,
    normals: str | os.PathLike[str] | None = None,
    elevation: str | os.PathLike[str] | None = None,
    night_lights: str | os.PathLike[str] | None = None,
    water: str | os.PathLike[str] | None = None,
    name: str | None = None,
    attribution: Sequence[str] = (),
    storage: Literal["plain", "bc", "both"] = "both",
    pixels: dict[str, Sequence[int]] | None = None,
    exaggeration: float | None = None,
    elevation_offset_m: float | None = None,
    memory_mb: float = 512.0,
    overwrite: bool = False,
    workers: int | None = None,
    address: Any = None,
    retries: int = 2,
    progress: bool | _run.Progress | None = None,
) -> Report:
    """Cuts maps into an imagery pack in the folder `out`: the same files as `terrella pack build` writes, with its options, so that
    each resumes what the other has begun.

    Workers make columns of blocks of a map each; every worker reads its maps from their beginning, with `memory_mb` megabytes at most.
    `workers`, `address`, `overwrite` and `retries` as for `film`.

    Raises `FarmError` if anything fails; complete output is kept, and the same call resumes.
    """
    out = Path(out).absolute()
    paths = {"clouds": clouds, "normals": normals, "elevation": elevation, "night_lights": night_lights, "water": water}
    options: dict[str, Any] = {key: str(Path(path).absolute()) for key, path in paths.items() if path is not None}
    options |= {"name": name, "attribution": list(attribution), "storage": storage, "pixels": [(key, list(v)) for key, v in (pixels or {}).items()],
                "exaggeration": exaggeration, "elevation_offset_m": elevation_offset_m, "memory_mb": memory_mb}
    given = (str(out), str(Path(day).absolute()))
    _run.checked_retries(retries)
    report = Report(out, "tiles")
    engine = open_engine(workers, address)
    try:
        parts, report.wanted = _native.PackBuild(*given, **options, restart=overwrite).begin(engine.workers)
        report.kept = report.wanted - sum(missing for *_, missing in parts)
        common = {"given": given, "options": options, "version": _native.__version__, "threads": None if engine.workers > 1 else os.cpu_count()}
        calls = (Call(f"{layer}, columns {first} to {end - 1}", build_part, {**common, "part": (layer, first, end)}, missing)
                 for layer, first, end, _, missing in parts)
        before = _bytes(out)

        def take(call: Call, value: dict[str, Any]) -> None:
            report.done += call.count
            report.by_worker[value["worker"]] = report.by_worker.get(value["worker"], 0) + call.count
            report.drawing_seconds += value["seconds"]
            report.processor_seconds += value["processor_seconds"]

        _run.drive(engine, calls, report, retries=retries, progress=_run.shown(progress, "tiles"), take=take)
        _run.reject_failures(report)
        begin = time.monotonic()
        _native.PackBuild(*given, **options).finish()
        report.seconds += time.monotonic() - begin
        report.bytes_written = _bytes(out) - before
    except OSError as error:
        raise FarmError(f"{error}; make room, and run the same again", report) from None
    finally:
        engine.close()
    return report


def _bytes(folder: Path) -> int:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file())


def build_part(part: dict[str, Any]) -> dict[str, Any]:
    """Makes some columns of a map: runs in a worker."""
    begin, begin_processor = time.monotonic(), time.process_time()
    if part["version"] != _native.__version__:
        raise _native.Error(f"the worker {_worker.name()} has version {_native.__version__} of terrella, and {part['version']} is wanted; "
                            "all workers must have the same")
    made = _native.PackBuild(*part["given"], **part["options"], threads=part["threads"]).make(*part["part"])
    return {"made": made, "worker": _worker.name(), "seconds": time.monotonic() - begin, "processor_seconds": time.process_time() - begin_processor}
