"""The native part. See the package for what these are."""

from __future__ import annotations

import datetime
import os
from collections.abc import Iterable
from typing import Any, Literal, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

Time = Union["Epoch", str, datetime.datetime, np.datetime64]
Times = Union[Time, Iterable[Time], NDArray[np.datetime64]]
FrameName = Literal["itrf", "teme", "gcrf", "eme2000", "pef"]
Elapsed = Union[datetime.timedelta, float]

__version__: str

class Error(Exception):
    """What the library rejects or cannot do."""

class SceneError(Error):
    """A scene, or an instant asked of it, is at fault."""

class OrbitError(Error):
    """A file of orbits, or an instant at which a satellite is not known."""

class DeviceError(Error):
    """No adapter, or one that has no room or was lost."""

class Epoch:
    def __init__(self, time: Time) -> None: ...
    @property
    def utc(self) -> str: ...
    def text(self, scale: Literal["UTC", "TAI", "TT", "GPS"]) -> str: ...
    def seconds_since(self, other: Time) -> float: ...
    def __add__(self, elapsed: Elapsed) -> Epoch: ...
    def __lt__(self, other: Epoch) -> bool: ...
    def __le__(self, other: Epoch) -> bool: ...
    def __gt__(self, other: Epoch) -> bool: ...
    def __ge__(self, other: Epoch) -> bool: ...
    def __hash__(self) -> int: ...

class Camera:
    def __init__(self, eye_itrf_m: ArrayLike, forward: ArrayLike, up: ArrayLike, *, fov_deg: float = 45.0) -> None: ...
    @staticmethod
    def geodetic(
        lat_deg: float,
        lon_deg: float,
        height_m: float,
        *,
        heading_deg: float = 0.0,
        pitch_deg: float = -90.0,
        fov_deg: float = 45.0,
    ) -> Camera: ...
    @staticmethod
    def matrices(eye_itrf_m: ArrayLike, view_from_itrf: ArrayLike, clip_from_view: ArrayLike) -> Camera: ...
    @property
    def eye_itrf_m(self) -> NDArray[np.float64]: ...

class Earth:
    @property
    def adapter(self) -> str: ...
    @property
    def size(self) -> tuple[int, int]: ...
    def color(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.uint8]: ...
    def radiance(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.float32]: ...
    def depth_m(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.float32]: ...
    def truth(
        self, camera: Camera, time: Time, layers: list[str] | None = None, *, wait_s: float = 30.0
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]: ...

class Scene:
    @property
    def adapter(self) -> str: ...
    @property
    def size(self) -> tuple[int, int]: ...
    @property
    def start(self) -> Epoch: ...
    @property
    def end(self) -> Epoch: ...
    @property
    def frame_rate_hz(self) -> float: ...
    @property
    def notices(self) -> list[str]: ...
    @property
    def satellites(self) -> list[str]: ...
    def times(self) -> list[Epoch]: ...
    def color(
        self, time: Time | datetime.timedelta | None = None, *, camera: Camera | None = None, exposure_ev: float | None = None
    ) -> NDArray[np.uint8]: ...
    def radiance(self, time: Time | datetime.timedelta | None = None, *, camera: Camera | None = None) -> NDArray[np.float32]: ...
    def depth_m(self, time: Time | datetime.timedelta | None = None, *, camera: Camera | None = None) -> NDArray[np.float32]: ...
    def truth(
        self, time: Time | datetime.timedelta | None = None, layers: list[str] | None = None, *, camera: Camera | None = None
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]: ...
    def raw(self, time: Time | datetime.timedelta | None = None) -> NDArray[np.uint16]: ...
    def propagate(
        self, times: Times, frame: FrameName = "itrf", *, outside: Literal["raise", "nan"] = "raise"
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

class Pictures:
    def __init__(
        self,
        *,
        format: Literal["png", "png16", "exr"] = "png",
        alpha: bool = False,
        supersample: int | None = None,
        shutter: float | None = None,
        subframes: int = 16,
    ) -> None: ...

class FilmFrames:
    def __init__(
        self,
        path: str | os.PathLike[str],
        textures: str | os.PathLike[str],
        pictures: Pictures,
        *,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> None: ...
    @property
    def adapter(self) -> str: ...
    @property
    def driver(self) -> str: ...
    def draw(self, index: int, file: str) -> tuple[bytes, str, list[str]]: ...

class FilmFolder:
    def __init__(
        self,
        path: str | os.PathLike[str],
        textures: str | os.PathLike[str],
        folder: str | os.PathLike[str],
        pictures: Pictures,
        *,
        size: tuple[int, int] | None = None,
        first: int = 0,
        end: int | None = None,
        existing: Literal["reject", "resume", "overwrite"] = "reject",
    ) -> None: ...
    @property
    def frame_count(self) -> int: ...
    @property
    def wanted(self) -> tuple[int, int]: ...
    @property
    def kept(self) -> list[int]: ...
    @property
    def kept_adapter(self) -> str | None: ...
    @property
    def frame_rate_hz(self) -> float: ...
    @property
    def has_memory(self) -> bool: ...
    def name(self, index: int) -> str: ...
    def adopt(self, record: str) -> bool: ...
    def begin(self, adapter: str) -> None: ...
    def add(self, record: str) -> None: ...
    def finish(self) -> None: ...
    def close(self) -> None: ...

class PackBuild:
    def __init__(
        self,
        out: str | os.PathLike[str],
        day: str | os.PathLike[str],
        *,
        clouds: str | os.PathLike[str] | None = None,
        normals: str | os.PathLike[str] | None = None,
        elevation: str | os.PathLike[str] | None = None,
        night_lights: str | os.PathLike[str] | None = None,
        water: str | os.PathLike[str] | None = None,
        name: str | None = None,
        attribution: list[str] = ...,
        storage: Literal["plain", "bc", "both"] = "both",
        pixels: list[tuple[str, list[int]]] = ...,
        exaggeration: float | None = None,
        elevation_offset_m: float | None = None,
        memory_mb: float = 512.0,
        threads: int | None = None,
        restart: bool = False,
    ) -> None: ...
    def begin(self, workers: int) -> tuple[list[tuple[str, int, int, int, int]], int]: ...
    def make(self, map: str, first: int, end: int) -> int: ...
    def finish(self) -> None: ...

class Satellites:
    @property
    def names(self) -> list[str]: ...
    @property
    def validity(self) -> list[tuple[Epoch, Epoch]]: ...
    def __len__(self) -> int: ...
    def propagate(
        self, times: Times, frame: FrameName = "itrf", *, outside: Literal["raise", "nan"] = "raise"
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...
    def passes(
        self,
        lat_deg: float,
        lon_deg: float,
        height_m: float = 0.0,
        *,
        first: Time,
        last: Time,
        min_elevation_deg: float = 10.0,
        sun_below_deg: float = -6.0,
        standard_magnitude: float | None = None,
    ) -> list[list[dict[str, Any]]]: ...

class Catalogue(Satellites):
    def __init__(self, path: str | os.PathLike[str], *, strict: bool = False) -> None: ...
    @property
    def faults(self) -> list[str]: ...

class Ephemerides(Satellites):
    def __init__(self, path: str | os.PathLike[str], *, strict: bool = False) -> None: ...
    @property
    def faults(self) -> list[str]: ...

class ParameterMessages(Satellites):
    def __init__(
        self, path: str | os.PathLike[str], *, last: Time, first: Time | None = None, strict: bool = False
    ) -> None: ...
    @property
    def faults(self) -> list[str]: ...

class KeplerOrbit(Satellites):
    def __init__(
        self,
        time: Time,
        *,
        last: Time,
        inclination_deg: float,
        eccentricity: float = 0.0,
        semi_major_axis_m: float | None = None,
        periapsis_m: float | None = None,
        raan_deg: float = 0.0,
        argument_of_periapsis_deg: float = 0.0,
        true_anomaly_deg: float | None = None,
        mean_anomaly_deg: float | None = None,
        frame: Literal["gcrf", "teme", "eme2000"] = "gcrf",
        j2: bool = False,
        first: Time | None = None,
        name: str = "satellite",
    ) -> None: ...
    @staticmethod
    def from_state(
        time: Time,
        position_m: ArrayLike,
        velocity_m_s: ArrayLike,
        *,
        last: Time,
        frame: Literal["gcrf", "teme", "eme2000"] = "gcrf",
        j2: bool = False,
        first: Time | None = None,
        name: str = "satellite",
    ) -> KeplerOrbit: ...
    @property
    def impact(self) -> Epoch | None: ...

class IntegratedOrbit(Satellites):
    def __init__(
        self,
        time: Time,
        position_m: ArrayLike,
        velocity_m_s: ArrayLike,
        *,
        last: Time,
        first: Time | None = None,
        frame: FrameName = "gcrf",
        gravity_degree: int = 8,
        gravity_order: int | None = None,
        air: Literal["us1976", "exponential"] | None = None,
        sun: bool = False,
        moon: bool = False,
        sunlight: bool = False,
        mass_kg: float = 1000.0,
        drag_area_m2: float = 10.0,
        drag_coefficient: float = 2.2,
        sunlit_area_m2: float = 10.0,
        reflectivity: float = 1.3,
        relative_tolerance: float = 1e-10,
        name: str = "satellite",
    ) -> None: ...
    @property
    def impact(self) -> Epoch | None: ...
    @property
    def steps(self) -> int: ...

def transform(
    positions_m: ArrayLike,
    velocities_m_s: ArrayLike | None,
    times: Times,
    *,
    source: FrameName,
    target: FrameName,
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]: ...
def geodetic_from_itrf(positions_m: ArrayLike) -> NDArray[np.float64]: ...
def itrf_from_geodetic(places: ArrayLike) -> NDArray[np.float64]: ...
def sun_itrf_m(times: Times) -> NDArray[np.float64]: ...
def readings(times: Times, scale: Literal["TAI", "TT", "GPS"]) -> NDArray[np.datetime64]: ...
def truth_layers() -> list[tuple[str, str, str, str]]: ...
def scene_key(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> str: ...
def scene_dates(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> tuple[Epoch, Epoch]: ...
def mp4_problem(path: str | os.PathLike[str], frames: int) -> str | None: ...
def png(color: NDArray[np.uint8]) -> bytes: ...
