"""What runs in a worker."""

from __future__ import annotations

import errno
import functools
import hashlib
import json
import os
import pickle
import queue
import signal
import socket
import sys
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Any

from .. import _native
from ._files import Journal

_NO_ROOM = {errno.ENOSPC, errno.EFBIG, getattr(errno, "EDQUOT", errno.ENOSPC)}

# The renderer used last, kept for reuse.
_warm: dict[Any, Any] = {}
_warming = threading.Lock()


def warm(key: Any, make: Callable[[], Any]) -> Any:
    """The renderer of this process for such pictures. One at a time is kept: each has maps on the device."""
    with _warming:
        if key not in _warm:
            _warm.clear()
            _warm[key] = make()
        return _warm[key]


def cool() -> None:
    """Lets go of the renderer: its device may be lost."""
    with _warming:
        _warm.clear()


# This process's journals, by folder.
_journals: dict[str, Journal] = {}


def journal(folder: Path) -> Journal:
    """What this process notes of a folder. Of one that was done with meanwhile a new one is begun."""
    with _warming:
        found = _journals.get(str(folder))
        if found is None or not found.path.exists():
            found = _journals[str(folder)] = Journal(folder)
        return found


def name() -> str:
    """This worker: its machine and its process."""
    return f"{socket.gethostname()}:{os.getpid()}"


def check_inputs(argument: dict[str, Any]) -> Path:
    """The folder of maps that this worker draws with. Does not draw another scene, or with other maps or another version, than was meant."""
    from .._earth import _textures

    textures = _textures(argument["textures"])
    scene, expected_json = argument["scene"], json.dumps(argument["expected"], sort_keys=True)
    found = {**_inputs_of_run(scene, str(textures), expected_json), "scene": _file_digest(scene)}
    for what, expected in argument["expected"].items():
        if found[what] != expected:
            raise _native.SceneError(f"{argument['scene']}: on the worker {name()} the {what} is another than where the run was begun; "
                                     "all workers must have the same")
    return textures


def expected_inputs(scene: Path, textures: Path) -> dict[str, Any]:
    """The same of the process that begins a run. Maps are all files that pictures come from but those of satellites and tables."""
    files = json.loads(_native.scene_key(scene, textures))["inputs"]
    is_map = [file["key"].startswith(("earth.", "sky.")) for file in files]
    return {
        "version of terrella": _native.__version__,
        "scene": _file_digest(scene),
        "maps": _digest([file for file, map_ in zip(files, is_map) if map_]),
        "file of a satellite or table": _digest([file for file, map_ in zip(files, is_map) if not map_]),
    }


@functools.lru_cache(maxsize=4)
def _inputs_of_run(scene: str, textures: str, _expected_json: str) -> dict[str, Any]:
    """Read once for each run: files may be large, and a worker may live longer than a run."""
    return expected_inputs(Path(scene), Path(textures))


def _digest(files: list[dict[str, Any]]) -> str:
    return hashlib.sha256(json.dumps(files, sort_keys=True).encode()).hexdigest()


def _file_digest(path: Any) -> str:
    return hashlib.sha256(Path(path).read_bytes()).hexdigest()


def guarded(function: Callable[[Any], Any], argument: Any) -> dict[str, Any]:
    """Calls a function. An error comes back as words, and whether another attempt may go well."""
    try:
        return {"value": function(argument)}
    except OSError as error:
        if error.errno in _NO_ROOM:
            return {"error": _no_room(error), "full": True}
        return {"error": str(error), "again": True}
    except _native.DeviceError as error:
        cool()
        return {"error": str(error), "again": True}
    except (_native.Error, ValueError, TypeError) as error:
        return {"error": str(error)}
    except Exception as error:  # noqa: BLE001 - whatever a caller's function raises is reported, and ends no worker.
        return {"error": f"{type(error).__name__}: {error}"}


def _no_room(error: OSError) -> str:
    place = f"{error.filename}: " if error.filename else ""
    return f"{place}cannot be written: {error.strerror}; make room"


def main() -> None:
    """A worker of the pool: calls come by standard input, answers go by standard output, which nobody else writes to."""
    from . import _pool

    cores = [int(core) for core in sys.argv[1].split(",") if core]
    if cores:
        os.sched_setaffinity(0, cores)
    # An interrupt at the terminal is for the parent process.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    calls: queue.Queue[Any] = queue.Queue()

    def listen() -> None:
        while (message := _pool.receive(sys.stdin.buffer)) is not None:
            calls.put(message)
        # The parent is gone or needs no more work: do not draw on.
        os._exit(0)

    threading.Thread(target=listen, daemon=True).start()
    while True:
        try:
            function, argument = pickle.loads(calls.get())
        except Exception as error:  # noqa: BLE001 - a function that cannot be imported here.
            answer = {"error": f"the worker cannot import what it is to call: {error}; functions must stand in a module, not in the program itself"}
        else:
            answer = guarded(function, argument)
        _pool.send(answers, pickle.dumps(answer))
