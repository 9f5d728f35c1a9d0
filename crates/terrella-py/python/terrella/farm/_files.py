"""Files that are whole or not there, and a journal of those that are."""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
import shutil
import socket
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any, BinaryIO

from .. import _whole
from ._report import FarmError

# The folder for a run's own files, inside its output folder.
OWN = ".terrella-farm"


def checksum(path: Path) -> str:
    """SHA-256 of a file, as hexadecimal digits."""
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while part := file.read(1 << 20):
            digest.update(part)
    return digest.hexdigest()


class Hashed:
    """A file that is written from its beginning to its end, its SHA-256 and its length."""

    def __init__(self, file: BinaryIO):
        self._file = file
        self._digest = hashlib.sha256()
        self.bytes = 0

    def write(self, part: Any) -> int:
        self._digest.update(part)
        self.bytes += len(part)
        self._file.write(part)
        return len(part)

    def tell(self) -> int:
        return self.bytes

    @property
    def sha256(self) -> str:
        return self._digest.hexdigest()


@contextlib.contextmanager
def pending(path: Path, *, prefix: str = ".terrella-", durable: bool = True) -> Iterator[tuple[Hashed, list]]:
    """A file under a temporary name beside its own, which it gets when all went well. What is put into the list is called before that.

    `durable`: it outlasts a power failure.
    """
    handle, name = tempfile.mkstemp(prefix=prefix, suffix=".part", dir=path.parent)
    before: list = []
    try:
        # mkstemp creates the file with 0600; give it the mode of an ordinary new file under the user's umask.
        os.chmod(name, 0o666 & ~_mask())
        with os.fdopen(handle, "wb") as file:
            hashed = Hashed(file)
            yield hashed, before
        for call in before:
            call()
        if durable:
            _whole.replace(name, path)
        else:
            os.replace(name, path)
    except BaseException:
        with contextlib.suppress(OSError):
            os.unlink(name)
        raise


def write_whole(path: Path, contents: bytes, *, prefix: str = ".terrella-", durable: bool = True) -> None:
    """Writes a file: it is complete or not there."""
    with pending(path, prefix=prefix, durable=durable) as (file, _):
        file.write(contents)


def _mask() -> int:
    mask = os.umask(0)
    os.umask(mask)
    return mask


class Journal:
    """Lines of what this process has finished in a folder, one file for each process.

    A line is written before the file that it speaks of gets its name: what stands under a final name is in a journal, and a line whose
    file is not there, or is another, says nothing.
    """

    def __init__(self, folder: Path):
        own = folder / OWN
        own.mkdir(exist_ok=True)
        name = f"journal-{socket.gethostname()}-{os.getpid()}-{time.time_ns()}.jsonl"
        self.path = own / name
        self._file = open(self.path, "ab", buffering=0)

    def note(self, record: dict[str, Any]) -> None:
        """Adds a line."""
        self._file.write(json.dumps(record).encode() + b"\n")

    def close(self) -> None:
        self._file.close()


def journals(folder: Path) -> Iterator[dict[str, Any]]:
    """What all processes have noted."""
    for path in sorted((folder / OWN).glob("journal-*.jsonl")):
        for line in path.read_bytes().splitlines():
            # The last line of a process that was killed may be cut off.
            with contextlib.suppress(ValueError):
                record = json.loads(line)
                if isinstance(record, dict):
                    yield record


def forget(folder: Path) -> None:
    """Takes away all that runs had of their own in a folder."""
    shutil.rmtree(folder / OWN, ignore_errors=True)


class Lock:
    """One run at a time in a folder."""

    def __init__(self, folder: Path):
        (folder / OWN).mkdir(parents=True, exist_ok=True)
        self._file = open(folder / OWN / "lock", "ab")
        try:
            if os.name == "posix":
                import fcntl

                fcntl.flock(self._file, fcntl.LOCK_EX | fcntl.LOCK_NB)
            else:
                import msvcrt

                msvcrt.locking(self._file.fileno(), msvcrt.LK_NBLCK, 1)
        except OSError:
            self._file.close()
            raise FarmError(f"{folder}: another run is writing to this folder; wait for its end, or give each run a folder of its own") from None

    def release(self) -> None:
        self._file.close()
