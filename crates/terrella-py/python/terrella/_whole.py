"""Files that are complete or not there, also after a power failure."""

from __future__ import annotations

import errno
import os
from pathlib import Path


def replace(unfinished: Path, path: Path) -> None:
    """Gives a complete file its final name. Its data are synced before, its folder after it."""
    # Windows syncs only files that are open for writing.
    with open(unfinished, "r+b") as file:
        os.fsync(file.fileno())
    os.replace(unfinished, path)
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Syncs the names in a folder, where the system can."""
    if os.name != "posix":
        return
    try:
        handle = os.open(folder, os.O_RDONLY)
    except OSError:
        # The folder may be writable but not readable.
        return
    try:
        os.fsync(handle)
    except OSError as error:
        # Some file systems cannot sync folders.
        if error.errno not in (errno.EINVAL, errno.ENOTSUP):
            raise
    finally:
        os.close(handle)
