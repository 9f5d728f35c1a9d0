"""The Earth and scenes, drawn into arrays."""

import os
from pathlib import Path

from . import _native, _whole


def _textures(folder):
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

    def __init__(self, color, time):
        self.color = color
        self.time = time

    @property
    def size(self):
        """Width and height, pixels."""
        height, width, _ = self.color.shape
        return width, height

    def png(self):
        """The bytes of a PNG file."""
        return _native.png(self.color)

    def save(self, path):
        """Writes a PNG file. It is complete or not there."""
        path = Path(path)
        if path.suffix.lower() != ".png":
            raise ValueError(f"path: {path} does not end in .png, the one kind of picture that is written; "
                             "other kinds: `color` is an array that any library writes")
        unfinished = path.with_name(path.name + f".{os.getpid()}.part")
        try:
            unfinished.write_bytes(self.png())
            _whole.replace(unfinished, path)
        finally:
            unfinished.unlink(missing_ok=True)

    def _repr_png_(self):
        return self.png()

    def __array__(self, dtype=None, copy=None):
        import numpy

        if copy is False and dtype is not None and numpy.dtype(dtype) != self.color.dtype:
            raise ValueError("dtype: a picture of bytes becomes another type by a copy alone")
        color = self.color if dtype is None else self.color.astype(dtype, copy=False)
        return color.copy() if copy else color

    def __repr__(self):
        width, height = self.size
        return f"<terrella.Frame {width} × {height}, {self.time}>"


class Earth(_native.Earth):
    """The Earth on a device of its own, for a ``Camera`` at an instant.

    ``size`` is width and height in pixels; ``textures`` a folder of maps (by default that of TERRELLA_TEXTURES, else the maps that came with
    the package); ``adapter`` a part of the name of the graphics adapter (by default the best); ``samples`` 1 or 4 a pixel; ``exposure_ev``
    how bright light is shown (by default a fixed exposure).

    What draws a kind of picture (colour, light, truth) is made when the first of that kind is asked for. Any thread may call it, one picture is
    drawn at a time, and other Python threads run meanwhile. After ``fork`` a child must make its own.
    """

    def __new__(cls, size=(800, 450), textures=None, **options):
        return super().__new__(cls, size, _textures(textures), **options)

    def frame(self, camera, time, **options):
        """The Earth as it is shown, a ``Frame``."""
        return Frame(self.color(camera, time, **options), time)


class Scene(_native.Scene):
    """A scene file (TOML), drawn at any instant as the command ``terrella`` draws it.

    ``size`` is width and height in pixels (by default the scene's). Instants are a ``terrella.Epoch``, a text like
    "2018-01-15T12:00:00Z", a datetime with a time zone, a numpy.datetime64 (UTC), or a datetime.timedelta after the scene's start; without
    one the start is drawn.

    Where exposure is metered each picture is metered by itself.
    """

    def __new__(cls, path, *, textures=None, **options):
        return super().__new__(cls, path, _textures(textures), **options)

    def frame(self, time=None, *, camera=None, exposure_ev=None):
        """An instant as it is shown, a ``Frame``; by a ``Camera`` and an exposure other than the scene's where they are given."""
        return Frame(self.color(time, camera=camera, exposure_ev=exposure_ev), self.start if time is None else time)

    def frames(self, first=0, end=None):
        """The frames of the scene in their order, each drawn when it is asked for: all, or those from ``first`` on, without ``end``."""
        times = self.times()
        end = len(times) if end is None else end
        if not 0 <= first < end <= len(times):
            raise ValueError(f"first, end: there are no frames {first}..{end} of {len(times)}")
        return (self.frame(time) for time in times[first:end])
