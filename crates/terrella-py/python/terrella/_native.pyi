"""The native part; the package documents it."""

from __future__ import annotations

import datetime
import os
from collections.abc import Sequence
from typing import Any, Literal, final, overload

import numpy as np
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Self

from ._types import Elapsed, FrameName, Time, Times, Vectors

__version__: str

class Error(Exception):
    """An error of the library."""

class SceneError(Error):
    """An invalid scene, or a time that it does not cover."""

class OrbitError(Error):
    """An invalid orbit file, or a time outside the validity of a satellite."""

class DeviceError(Error):
    """No graphics adapter, out of device memory, or a lost device."""

@final
class Epoch:
    def __new__(cls, time: Time) -> Self: ...
    @property
    def utc(self) -> str: ...
    def text(self, scale: Literal["UTC", "TAI", "TT", "GPS"]) -> str: ...
    def to_datetime(self) -> datetime.datetime: ...
    def to_datetime64(self) -> np.datetime64: ...
    def to_astropy(self) -> Any: ...
    def seconds_since(self, other: Time) -> float: ...
    def nanoseconds_since(self, other: Time) -> int: ...
    def __add__(self, elapsed: Elapsed, /) -> Epoch: ...
    def __radd__(self, elapsed: Elapsed, /) -> Epoch: ...
    @overload
    def __sub__(self, other: Time, /) -> float: ...
    @overload
    def __sub__(self, other: Elapsed, /) -> Epoch: ...
    def __rsub__(self, other: Time, /) -> float: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __lt__(self, other: Epoch, /) -> bool: ...
    def __le__(self, other: Epoch, /) -> bool: ...
    def __gt__(self, other: Epoch, /) -> bool: ...
    def __ge__(self, other: Epoch, /) -> bool: ...
    def __hash__(self) -> int: ...

@final
class Camera:
    def __new__(cls, eye_itrf_m: Vectors, forward: ArrayLike, up: ArrayLike, *, fov_deg: float = 45.0) -> Self: ...
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
    def matrices(eye_itrf_m: Vectors, view_from_itrf: ArrayLike, clip_from_view: ArrayLike) -> Camera: ...
    @property
    def eye_itrf_m(self) -> NDArray[np.float64]: ...
    @property
    def forward(self) -> NDArray[np.float64]: ...
    def __eq__(self, other: object, /) -> bool: ...
    def __ne__(self, other: object, /) -> bool: ...
    def __hash__(self) -> int: ...

class Earth:
    def __new__(
        cls,
        size: tuple[int, int],
        textures: str | os.PathLike[str],
        *,
        adapter: str | None = None,
        samples: int = 1,
        air: bool = True,
        clouds: bool = True,
        night_lights: bool = True,
        detail: bool = True,
        directional_reflectance: bool = True,
        exposure_ev: float | None = None,
        scene: tuple[str | os.PathLike[str], str] | None = None,
    ) -> Self: ...
    @property
    def adapter(self) -> str: ...
    @property
    def size(self) -> tuple[int, int]: ...
    def color(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.uint8]: ...
    def radiance(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.float32]: ...
    def depth_m(self, camera: Camera, time: Time, *, wait_s: float = 30.0) -> NDArray[np.float32]: ...
    def truth(
        self, camera: Camera, time: Time, layers: Sequence[str] | None = None, *, wait_s: float = 30.0
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]: ...

class Scene:
    def __new__(
        cls,
        path: str | os.PathLike[str],
        textures: str | os.PathLike[str],
        *,
        text: str | None = None,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> Self: ...
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
        self, time: Time | datetime.timedelta | None = None, layers: Sequence[str] | None = None, *, camera: Camera | None = None
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]: ...
    def raw(self, time: Time | datetime.timedelta | None = None, *, camera: Camera | None = None) -> NDArray[np.uint16]: ...
    def raw_truth(
        self, time: Time | datetime.timedelta | None = None, layers: Sequence[str] | None = None, *, camera: Camera | None = None
    ) -> dict[str, NDArray[np.float32] | NDArray[np.float64]]: ...
    def propagate(
        self, times: Times, frame: FrameName = "itrf", *, outside: Literal["raise", "nan"] = "raise"
    ) -> tuple[NDArray[np.float64], NDArray[np.float64]]: ...

@final
class Pictures:
    def __new__(
        cls,
        *,
        format: Literal["png", "png16", "exr", "pq", "hlg"] = "png",
        alpha: bool = False,
        supersample: int | None = None,
        shutter: float | None = None,
        subframes: int = 16,
        peak_cd_m2: float | None = None,
    ) -> Self: ...

@final
class FilmFrames:
    def __new__(
        cls,
        path: str | os.PathLike[str],
        textures: str | os.PathLike[str],
        pictures: Pictures,
        *,
        size: tuple[int, int] | None = None,
        adapter: str | None = None,
    ) -> Self: ...
    @property
    def adapter(self) -> str: ...
    @property
    def driver(self) -> str: ...
    def draw(self, index: int, file: str) -> tuple[bytes, str, list[str]]: ...

@final
class FilmFolder:
    def __new__(
        cls,
        path: str | os.PathLike[str],
        textures: str | os.PathLike[str],
        folder: str | os.PathLike[str],
        pictures: Pictures,
        *,
        size: tuple[int, int] | None = None,
        first: int = 0,
        end: int | None = None,
        existing: Literal["reject", "resume", "overwrite"] = "reject",
    ) -> Self: ...
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

@final
class PackBuild:
    def __new__(
        cls,
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
    ) -> Self: ...
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

@final
class Catalogue(Satellites):
    def __new__(cls, path: str | os.PathLike[str], *, strict: bool = False) -> Self: ...
    @staticmethod
    def from_text(text: str, *, strict: bool = False) -> Catalogue: ...
    @property
    def faults(self) -> list[str]: ...

@final
class Ephemerides(Satellites):
    def __new__(cls, path: str | os.PathLike[str], *, strict: bool = False) -> Self: ...
    @staticmethod
    def from_text(text: str, *, strict: bool = False) -> Ephemerides: ...
    @staticmethod
    def from_states(
        times: Times,
        positions_m: Vectors,
        velocities_m_s: Vectors | None = None,
        *,
        frame: FrameName = "gcrf",
        name: str = "satellite",
    ) -> Ephemerides: ...
    @property
    def faults(self) -> list[str]: ...

@final
class ParameterMessages(Satellites):
    def __new__(
        cls, path: str | os.PathLike[str], *, last: Time, first: Time | None = None, strict: bool = False
    ) -> Self: ...
    @property
    def faults(self) -> list[str]: ...

@final
class KeplerOrbit(Satellites):
    def __new__(
        cls,
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
    ) -> Self: ...
    @staticmethod
    def from_state(
        time: Time,
        position_m: Vectors,
        velocity_m_s: Vectors,
        *,
        last: Time,
        frame: Literal["gcrf", "teme", "eme2000"] = "gcrf",
        j2: bool = False,
        first: Time | None = None,
        name: str = "satellite",
    ) -> KeplerOrbit: ...
    @property
    def impact(self) -> Epoch | None: ...

@final
class IntegratedOrbit(Satellites):
    def __new__(
        cls,
        time: Time,
        position_m: Vectors,
        velocity_m_s: Vectors,
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
    ) -> Self: ...
    @property
    def impact(self) -> Epoch | None: ...
    @property
    def steps(self) -> int: ...

def transform(
    positions_m: Vectors,
    velocities_m_s: Vectors | None,
    times: Times,
    *,
    source: FrameName,
    target: FrameName,
) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]: ...
def geodetic_from_itrf(positions_m: Vectors) -> NDArray[np.float64]: ...
def itrf_from_geodetic(places: ArrayLike) -> NDArray[np.float64]: ...
def sun_itrf_m(times: Times) -> NDArray[np.float64]: ...
def readings(times: Times, scale: Literal["TAI", "TT", "GPS"]) -> NDArray[np.datetime64]: ...
def truth_layers() -> list[tuple[str, str, str, str]]: ...
def scene_key(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> str: ...
def scene_attribution(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> list[str]: ...
def scene_dates(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> tuple[Epoch, Epoch]: ...
def scene_exposure(path: str | os.PathLike[str], textures: str | os.PathLike[str]) -> float | None: ...
def mp4_problem(path: str | os.PathLike[str], frames: int) -> str | None: ...
def png(color: NDArray[np.uint8]) -> bytes: ...
