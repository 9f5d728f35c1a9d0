"""The engine that a caller asks for."""

from __future__ import annotations

from typing import Any

from ._engine import Engine
from ._pool import Pool
from ._report import FarmError


def check_engine(workers: int | None, address: Any) -> None:
    """Rejects workers that cannot be opened, before anything is written. Starts nothing."""
    if workers is not None and not 1 <= workers <= 1024:
        raise ValueError(f"workers: {workers} is not from 1 to 1024")
    if address is None:
        return
    if workers is not None and address != "local":
        raise ValueError("workers: a cluster has the workers that it has; leave it out, or give no address")
    try:
        from . import _dask  # noqa: F401
    except ImportError as error:
        raise FarmError(f"address: {address!r} asks for a Dask cluster, and {error}; pip install 'terrella-earth[farm]'") from None


def open_engine(workers: int | None, address: Any) -> Engine:
    """Processes of this machine; with an address a Dask cluster, "local" for one that is made on this machine and heard by nobody else."""
    check_engine(workers, address)
    if address is None:
        return Pool(workers or 2)
    from ._dask import Dask

    return Dask(address, workers or 2)
