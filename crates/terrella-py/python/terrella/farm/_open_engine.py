"""The engine that a caller asks for."""

from __future__ import annotations

from typing import Any

from ._engine import Engine
from ._pool import Pool
from ._report import FarmError


def open_engine(workers: int | None, address: Any) -> Engine:
    """Processes of this machine; with an address a Dask cluster, "local" for one that is made on this machine and heard by nobody else."""
    if workers is not None and not 1 <= workers <= 1024:
        raise ValueError(f"workers: {workers} is not from 1 to 1024")
    if address is None:
        return Pool(workers or 2)
    if workers is not None and address != "local":
        raise ValueError("workers: a cluster has the workers that it has; leave it out, or give no address")
    try:
        from ._dask import Dask
    except ImportError as error:
        raise FarmError(f"address: {address!r} asks for a Dask cluster, and {error}; pip install 'terrella-earth[farm]'") from None
    return Dask(address, workers or 2)
