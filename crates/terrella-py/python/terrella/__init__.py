"""A realistic Earth as NumPy arrays.

>>> import terrella
>>> scene = terrella.Scene("config/iss.toml")
>>> scene.frame().save("iss.png")

``Scene`` plays a scene file at any instant; ``Earth`` is the Earth alone, seen by a ``Camera`` of yours; ``Catalogue``,
``Ephemerides``, ``KeplerOrbit`` and ``IntegratedOrbit`` say where satellites are. Lengths are metres, angles degrees where a name says so, axes Earth-fixed (ITRF: x to 0° E
on the equator, z to the north pole). Pictures have their first row at the top.
"""

from importlib.util import find_spec

# It is loaded with the first array, and the native module cannot report that it is missing.
if find_spec("numpy") is None:
    raise ImportError("terrella needs NumPy: pip install numpy", name="numpy")

from ._datasets import states_dataset, truth_dataset
from ._earth import Earth, Frame, Scene
from ._film import Film
from ._native import (
    Camera,
    Catalogue,
    DeviceError,
    Ephemerides,
    Epoch,
    Error,
    IntegratedOrbit,
    KeplerOrbit,
    OrbitError,
    ParameterMessages,
    Satellites,
    SceneError,
    __version__,
    geodetic_from_itrf,
    itrf_from_geodetic,
    readings,
    sun_itrf_m,
    transform,
    truth_layers,
)

__all__ = [
    "Camera",
    "Catalogue",
    "DeviceError",
    "Earth",
    "Ephemerides",
    "Epoch",
    "Error",
    "Film",
    "Frame",
    "IntegratedOrbit",
    "KeplerOrbit",
    "OrbitError",
    "ParameterMessages",
    "Satellites",
    "Scene",
    "SceneError",
    "__version__",
    "geodetic_from_itrf",
    "itrf_from_geodetic",
    "readings",
    "states_dataset",
    "sun_itrf_m",
    "transform",
    "truth_dataset",
    "truth_layers",
]
