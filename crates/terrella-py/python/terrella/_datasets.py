"""Truth layers and states with names and units on their axes, for programs that use xarray."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any, Literal

from . import _native

if TYPE_CHECKING:
    from numpy.typing import NDArray

    from ._native import Satellites, Scene
    from ._types import FrameName, Times

_NAMED_AXES = ("x", "y", "z")


def truth_dataset(layers: Mapping[str, NDArray[Any]]) -> Any:
    """The arrays of ``truth`` as an ``xarray.Dataset`` with the axes ``row`` and ``column``, from the top left, and each layer's unit and meaning. Needs
    xarray."""
    xarray = _xarray()
    meanings = {name: {"units": unit, "long_name": what} for name, unit, _, what in _native.truth_layers()}
    axes = ("row", "column", "axis")
    variables = {name: (axes[: values.ndim], values, meanings.get(name, {})) for name, values in layers.items()}
    coordinates = {"axis": list(_NAMED_AXES)} if any(values.ndim == 3 for values in layers.values()) else {}
    return xarray.Dataset(variables, coordinates)


def states_dataset(
    satellites: Satellites | Scene, times: Times, frame: FrameName = "itrf", *, outside: Literal["raise", "nan"] = "raise"
) -> Any:
    """What ``propagate`` returns as an ``xarray.Dataset``: ``position`` and ``velocity`` by ``satellite``, ``time`` and ``axis``. Times are datetime64 in UTC.
    Needs xarray."""
    import numpy

    xarray = _xarray()
    epochs = [_native.Epoch(time) for time in times] if _is_row(times) else [_native.Epoch(times)]  # type: ignore[arg-type, union-attr]
    positions_m, velocities_m_s = satellites.propagate(epochs, frame, outside=outside)
    names = satellites.satellites if isinstance(satellites, _native.Scene) else satellites.names
    axes = ("satellite", "time", "axis")
    return xarray.Dataset(
        {"position": (axes, positions_m, {"units": "m"}), "velocity": (axes, velocities_m_s, {"units": "m s-1"})},
        {"satellite": names, "time": numpy.array([epoch.to_datetime64() for epoch in epochs]), "axis": list(_NAMED_AXES)},
        {"frame": frame},
    )


def _xarray() -> Any:
    try:
        import xarray
    except ImportError as error:
        raise ImportError(f"this function needs xarray ({error}); pip install xarray") from error
    return xarray


def _is_row(times: Any) -> bool:
    """Whether these are several instants."""
    try:
        iter(times)
    except TypeError:
        return False
    return not isinstance(times, str)
