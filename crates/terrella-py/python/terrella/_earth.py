"""The Earth and scenes, drawn into arrays."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from . import _native, _toml, _whole

if TYPE_CHECKING:
    import datetime

    import numpy as np
    from numpy.typing import DTypeLike, NDArray
    from typing_extensions import Self

    from ._native import Camera
    from ._types import Time

# The scene tables that apply to an Earth without satellites and sky.
_EARTH_TABLES = ("earth", "output")
# The keys that a sensor must have.
_SENSOR_KEYS = ("size", "focal_length_mm", "pixel_pitch_um", "f_number", "exposure_s", "full_well_e")
# Turns off the rest of a scene: an Earth has neither sky nor satellites.
_NOTHING_ELSE = {
    "camera": {"mode": "geodetic", "lat_deg": 0, "lon_deg": 0, "height_km": 10000},
    "sky": {"stars": False, "milky_way": False, "sun": False, "moon": False, "glare": False, "eclipses": False},
}


def _textures(folder: str | os.PathLike[str] | None) -> Path:
    """The folder of maps: the one given, that of TERRELLA_TEXTURES, or the one that came with this package."""
    if folder is not None:
        return Path(folder)
    variable = os.environ.get("TERRELLA_TEXTURES")
    if variable is not None:
        return Path(variable)
    return Path(__file__).parent / "textures"


class Frame:
    """A picture: ``color`` is an array of height × width × 4 bytes (red, green, blue in sRGB, opacity).

    Notebooks show it by themselves.
    """

    __slots__ = ("color", "time")

    color: NDArray[np.uint8]
    time: Time | datetime.timedelta

    def __init__(self, color: NDArray[np.uint8], time: Time | datetime.timedelta) -> None:
        self.color = color
        self.time = time

    @property
    def size(self) -> tuple[int, int]:
        """Width and height, pixels."""
        height, width, _ = self.color.shape
        return width, height

    def png(self) -> bytes:
        """The bytes of a PNG file, those that the command writes."""
        return _native.png(self.color)

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes a PNG file. It is complete or not there."""
        path = Path(path)
        if path.suffix.lower() != ".png":
            raise ValueError(f"path: {path} does not end in .png, the one kind of picture that is written; "
                             "other kinds: `color` is an array that any library writes")
        if not path.parent.is_dir():
            raise FileNotFoundError(errno.ENOENT, f"path: there is no folder {path.parent}; create it first", os.fspath(path))
        unfinished = path.with_name(path.name + f".{os.getpid()}.part")
        try:
            unfinished.write_bytes(self.png())
            _whole.replace(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)

    def _repr_png_(self) -> bytes:
        return self.png()

    def __array__(self, dtype: DTypeLike | None = None, copy: bool | None = None) -> NDArray[Any]:
        import numpy

        if copy is False and dtype is not None and numpy.dtype(dtype) != self.color.dtype:
            raise ValueError("dtype: a picture of bytes becomes another type by a copy alone")
        color: NDArray[Any] = self.color if dtype is None else self.color.astype(dtype, copy=False)
        return color.copy() if copy else color

    def __repr__(self) -> str:
        width, height = self.size
        return f"<terrella.Frame {width} × {height}, {self.time}>"


class Earth(_native.Earth):
    """The Earth for a ``Camera`` at an instant.

    ``size`` is width and height in pixels; ``textures`` a folder of maps (by default that of TERRELLA_TEXTURES, else the maps that came with
    the package); ``adapter`` a part of the name of the graphics adapter (by default the best); ``samples`` 1 or 4 a pixel; ``air``, ``clouds``
    and ``night_lights`` draw the atmosphere, clouds and city lights; ``detail`` adds synthetic detail below the maps' texels;
    ``directional_reflectance`` reflects sunlight by direction, and without it land and clouds are Lambertian; ``exposure_ev`` is the exposure, by default 0.5:
    light is multiplied by 2 to this power before display, so that each step of 1 doubles it. ``Earth.from_dict`` has terrain, packs, open water and all other settings.

    The first image of each kind (colour, light, truth) creates its renderer. Any thread may call it; it renders one image at a time, and other
    Python threads run meanwhile. Earths of a program share the device and, where their maps are the same, one copy of them. After ``fork`` a child
    must create its own.
    """

    def __new__(
        cls,
        size: tuple[int, int] = (800, 450),
        textures: str | os.PathLike[str] | None = None,
        *,
        adapter: str | None = None,
        samples: int = 1,
        air: bool = True,
        clouds: bool = True,
        night_lights: bool = True,
        detail: bool = True,
        directional_reflectance: bool = True,
        exposure_ev: float | None = None,
    ) -> Self:
        made = super().__new__(cls, size, _textures(textures), adapter=adapter, samples=samples, air=air, clouds=clouds,
                               night_lights=night_lights, detail=detail, directional_reflectance=directional_reflectance,
                               exposure_ev=exposure_ev)
        table = {"clouds": clouds, "night_lights": night_lights, "detail": detail, "directional_reflectance": directional_reflectance}
        made._describe({"earth": table if air else {**table, "atmosphere": "none"}}, Path(), textures)
        return made

    @classmethod
    def from_dict(
        cls,
        tables: Mapping[str, Any],
        size: tuple[int, int] = (800, 450),
        textures: str | os.PathLike[str] | None = None,
        *,
        folder: str | os.PathLike[str] = ".",
        adapter: str | None = None,
    ) -> Self:
        """An Earth that the tables ``earth`` and ``output`` of a scene describe, with packs, terrain, open water, tone and all else of them:
        ``Earth.from_dict({"earth": {"pack": "europe", "surface": "quadtree"}})``. ``folder`` is the one that paths in them are relative to."""
        for name in tables:
            if name not in _EARTH_TABLES:
                raise ValueError(f"tables: an Earth has no table {name!r}, only {' and '.join(_EARTH_TABLES)}; Scene.from_dict takes all tables")
        scene = (Path(folder) / "<dict>", _toml.text(tables))
        made = super().__new__(cls, size, _textures(textures), adapter=adapter, scene=scene)
        made._describe(tables, Path(folder), textures)
        return made

    def _describe(self, tables: Mapping[str, Any], folder: Path, textures: str | os.PathLike[str] | None) -> None:
        """Keeps what a scene of the same Earth is made of."""
        self._tables, self._folder, self._given_textures = tables, folder, textures
        self._sensor: tuple[str, Scene] | None = None

    def __repr__(self) -> str:
        width, height = self.size
        return f"<terrella.Earth {width} × {height}, {self.adapter}>"

    def _scene_of(self, sensor: Mapping[str, Any]) -> Scene:
        if isinstance(sensor, Mapping) and (missing := [key for key in _SENSOR_KEYS if key not in sensor]):
            are = "is" if len(missing) == 1 else "are"
            raise _native.SceneError(f"sensor: {', '.join(missing)} {are} missing; a sensor needs {', '.join(_SENSOR_KEYS)}")
        tables = {**self._tables, "sensor": sensor, **_NOTHING_ELSE}
        text = _toml.text(tables)
        kept = self._sensor
        if kept is None or kept[0] != text:
            scene = Scene.from_dict(tables, folder=self._folder, textures=self._given_textures, adapter=self.adapter)
            kept = self._sensor = (text, scene)
        return kept[1]

    def raw(self, camera: Camera, time: Time, sensor: Mapping[str, Any]) -> NDArray[np.uint16]:
        """The raw frame of a sensor: height × width (uint16), in digital numbers.

        ``sensor`` has the keys of a scene's ``[sensor]`` table. It needs ``size`` (width and height in pixels), ``focal_length_mm``,
        ``pixel_pitch_um``, ``f_number``, ``exposure_s`` and ``full_well_e``; the other keys have defaults. The camera says where the
        sensor is and where it looks; the field of view, exposure and resolution are the sensor's. Stars, Sun and Moon are not in the frame;
        ``Scene.raw`` draws them. The Earth keeps the renderer of the sensor that it drew last."""
        return self._scene_of(sensor).raw(time, camera=camera)

    def raw_truth(
        self, camera: Camera, time: Time, sensor: Mapping[str, Any], layers: Sequence[str] | None = None
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]:
        """Truth layers by name, all or those named, of the pixels of ``raw``: through the sensor's lens."""
        return self._scene_of(sensor).raw_truth(time, layers, camera=camera)

    def frame(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> Frame:
        """The displayed image, a ``Frame``. The call waits for tiles of a pack for at most ``wait_s`` seconds."""
        return Frame(self.color(camera, time, wait_s=wait_s), time)


class Scene(_native.Scene):
    """A scene file (TOML), drawn at any instant as the command ``terrella`` draws it. ``Scene.from_text`` and ``Scene.from_dict`` need no file.

    ``size`` is width and height in pixels (by default the scene's); ``textures`` a folder of maps (by default that of TERRELLA_TEXTURES, else the
    maps that came with the package); ``adapter`` a part of the name of the graphics adapter (by default the best). A time is a
    ``terrella.Epoch``, or anything that one can be created from, or a datetime.timedelta after the scene's start, which is the default.

    With automatic exposure, each image is metered separately.
    """

    _path: str

    def __new__(
        cls,
        path: str | os.PathLike[str],
        *,
        textures: str | os.PathLike[str] | None = None,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> Self:
        made = super().__new__(cls, path, _textures(textures), size=size, adapter=adapter)
        made._path = str(path)
        return made

    @classmethod
    def from_text(
        cls,
        text: str,
        *,
        folder: str | os.PathLike[str] = ".",
        textures: str | os.PathLike[str] | None = None,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> Self:
        """A scene of the text of such a file; ``folder`` is the one that paths in it are relative to."""
        made = super().__new__(cls, Path(folder) / "<text>", _textures(textures), text=text, size=size, adapter=adapter)
        made._path = "<text>"
        return made

    @classmethod
    def from_dict(
        cls,
        tables: Mapping[str, Any],
        *,
        folder: str | os.PathLike[str] = ".",
        textures: str | os.PathLike[str] | None = None,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> Self:
        """A scene of its tables by name, each with its keys by name: ``Scene.from_dict({"camera": {"mode": "nadir"}})``. Times may be an ``Epoch`` or
        a datetime with a time zone, paths a ``Path``. ``folder`` is the one that paths are relative to."""
        path, text = Path(folder) / "<dict>", _toml.text(tables)
        made = super().__new__(cls, path, _textures(textures), text=text, size=size, adapter=adapter)
        made._path = "<dict>"
        return made

    def __repr__(self) -> str:
        width, height = self.size
        count = len(self.satellites)
        flown = f"{count} satellite{'' if count == 1 else 's'}"
        return f"<terrella.Scene {self._path}, {width} × {height}, {self.start} to {self.end}, {flown}, {self.adapter}>"

    def frame(self, time: Time | datetime.timedelta | None = None, *, camera: Camera | None = None, exposure_ev: float | None = None) -> Frame:
        """The displayed image at a time, a ``Frame``. ``camera`` and ``exposure_ev`` replace those of the scene."""
        return Frame(self.color(time, camera=camera, exposure_ev=exposure_ev), self.start if time is None else time)

    def frames(self, first: int = 0, end: int | None = None) -> Iterator[Frame]:
        """The frames of the scene in order, each rendered on demand: all, or from ``first`` up to but not including ``end``."""
        times = self.times()
        end = len(times) if end is None else end
        if not 0 <= first < end <= len(times):
            raise ValueError(f"first, end: there are no frames {first}..{end} of {len(times)}")
        return (self.frame(time) for time in times[first:end])
