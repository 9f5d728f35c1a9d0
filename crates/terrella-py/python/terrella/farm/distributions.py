"""What the samples of a sweep are drawn from.

A sample depends only on the seed and its number, not on the worker that draws it nor on the samples before: each has a stream of random
numbers of its own, that of ``numpy.random.SeedSequence((seed, index))``, from which only numbers that are even between 0 and 1 are taken.
"""

from __future__ import annotations

import hashlib
import inspect
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import TYPE_CHECKING, Any, Protocol, Union

if TYPE_CHECKING:
    import numpy as np

    from .._types import Time


class Distribution(Protocol):
    """Draws one value with the random numbers of a sample."""

    def draw(self, random: np.random.Generator) -> Any: ...


@dataclass(frozen=True)
class Constant:
    """Always the same."""

    value: Any

    def draw(self, random: np.random.Generator) -> Any:
        return self.value


@dataclass(frozen=True)
class Uniform:
    """A number from ``least`` to ``most``; all have equal probability."""

    least: float
    most: float

    def __post_init__(self) -> None:
        _check_range(self.least, self.most)

    def draw(self, random: np.random.Generator) -> float:
        return self.least + (self.most - self.least) * random.random()


@dataclass(frozen=True)
class LogUniform:
    """A number from ``least`` to ``most`` whose logarithm is uniform: each decade has equal probability, as suits heights."""

    least: float
    most: float

    def __post_init__(self) -> None:
        _check_range(self.least, self.most)
        if self.least <= 0:
            raise ValueError(f"least: {self.least} is not more than 0")

    def draw(self, random: np.random.Generator) -> float:
        log = math.log(self.least) + (math.log(self.most) - math.log(self.least)) * random.random()
        return min(max(math.exp(log), self.least), self.most)


@dataclass(frozen=True)
class Normal:
    """Gaussian, with a standard deviation; numbers beyond ``least`` and ``most`` are not drawn."""

    mean: float
    deviation: float
    least: float = -math.inf
    most: float = math.inf

    def __post_init__(self) -> None:
        if not (math.isfinite(self.mean) and 0 < self.deviation < math.inf):
            raise ValueError(f"deviation: {self.mean} ± {self.deviation} is not a Gaussian")
        if not self.least < self.most or self._part(self.most) - self._part(self.least) < 1e-9:
            raise ValueError(f"least, most: hardly any number of {self.mean} ± {self.deviation} is from {self.least} to {self.most}")

    def _part(self, value: float) -> float:
        return NormalDist(self.mean, self.deviation).cdf(value)

    def draw(self, random: np.random.Generator) -> float:
        # Inverse transform sampling: one random number per value, however much is cut off.
        first, last = self._part(self.least), self._part(self.most)
        part = first + (last - first) * random.random()
        value = NormalDist(self.mean, self.deviation).inv_cdf(min(max(part, 1e-300), 1 - 2**-53))
        return min(max(value, self.least), self.most)


@dataclass(frozen=True)
class Choice:
    """One of several values, with equal probability or by ``weights``."""

    values: Sequence[Any]
    weights: Sequence[float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "values", tuple(self.values))
        if not self.values:
            raise ValueError("values: there is none")
        if self.weights is not None:
            object.__setattr__(self, "weights", tuple(float(weight) for weight in self.weights))
            if len(self.weights) != len(self.values) or min(self.weights) < 0 or not 0 < sum(self.weights) < math.inf:
                raise ValueError("weights: one for each value is needed, none below 0 and not all 0")

    def draw(self, random: np.random.Generator) -> Any:
        weights = self.weights or (1.0,) * len(self.values)
        left = random.random() * sum(weights)
        for value, weight in zip(self.values, weights):
            left -= weight
            if left < 0:
                return value
        return self.values[max(n for n, weight in enumerate(weights) if weight > 0)]


@dataclass(frozen=True)
class OnSphere:
    """A latitude and a longitude, degrees: places of the globe, or of a part of it, with equal probability per area. A range of longitudes that
    crosses the date line may be written as (170, -170) or (170, 190)."""

    lat_deg: tuple[float, float] = (-90.0, 90.0)
    lon_deg: tuple[float, float] = (-180.0, 180.0)

    def __post_init__(self) -> None:
        _check_range(*self.lat_deg)
        west, east = self.lon_deg
        if not -90 <= self.lat_deg[0] <= self.lat_deg[1] <= 90:
            raise ValueError(f"lat_deg: {self.lat_deg} is not a range of latitudes from -90 to 90")
        if not (-360 <= west <= 360 and -360 <= east <= 360):
            raise ValueError(f"lon_deg: {self.lon_deg} is not a range of longitudes from -360 to 360")
        if west > east and not (west <= 180 and east >= -180):
            raise ValueError(f"lon_deg: {self.lon_deg} is neither west to east nor across the date line, as (170, -170) is")

    def draw(self, random: np.random.Generator) -> tuple[float, float]:
        south, north = (math.sin(math.radians(lat_deg)) for lat_deg in self.lat_deg)
        sine = south + (north - south) * random.random()
        west, east = self.lon_deg
        crosses = west > east
        lon_deg = west + (east + 360.0 * crosses - west) * random.random()
        return math.degrees(math.asin(min(max(sine, -1.0), 1.0))), lon_deg - 360.0 * (crosses and lon_deg > 180)


@dataclass(frozen=True)
class Dates:
    """A time from ``first`` to ``last``; all have equal probability. Both are a ``Time``, for example "2018-06-21T08:00:00Z", and kept as UTC text."""

    first: Time
    last: Time

    def __post_init__(self) -> None:
        from .. import _native

        for name in ("first", "last"):
            object.__setattr__(self, name, _native.Epoch(getattr(self, name)).utc)
        if _native.Epoch(self.last) < _native.Epoch(self.first):
            raise ValueError(f"last: {self.last} is before {self.first}")

    def draw(self, random: np.random.Generator) -> Any:
        from .. import _native

        first = _native.Epoch(self.first)
        return first + random.random() * _native.Epoch(self.last).seconds_since(first)


Drawn = Union[Distribution, Callable[["np.random.Generator"], Any], float, int, str, tuple[Any, ...]]


def _check_range(least: float, most: float) -> None:
    if not (math.isfinite(least) and math.isfinite(most) and least <= most):
        raise ValueError(f"least, most: {least} to {most} is not a range of numbers")


def as_distribution(value: Drawn, name: str) -> Any:
    """A distribution as it is, a function that workers can import, or a value that is always the same."""
    if hasattr(value, "draw") or not callable(value):
        return value if hasattr(value, "draw") else Constant(value)
    if getattr(value, "__module__", None) in (None, "__main__") or "<" in getattr(value, "__qualname__", "<"):
        raise ValueError(f"{name}: workers cannot import {value!r}; put the function into a module of its own, beside the program")
    return value


def check_extent(distribution: Any, name: str, least: float, most: float) -> None:
    """Rejects a distribution that can draw a number outside a range. The numbers of functions are checked when they are drawn."""
    ends: Sequence[Any] = ()
    if isinstance(distribution, Constant):
        ends = (distribution.value,)
    elif isinstance(distribution, (Uniform, LogUniform)):
        ends = (distribution.least, distribution.most)
    elif isinstance(distribution, Normal):
        # Six deviations from the mean lies one number of a thousand million.
        far = 6 * distribution.deviation
        ends = (max(distribution.least, distribution.mean - far), min(distribution.most, distribution.mean + far))
    elif isinstance(distribution, Choice):
        ends = distribution.values
    if not all(least <= float(end) <= most for end in ends):
        words = distribution.value if isinstance(distribution, Constant) else distribution
        raise ValueError(f"{name}: {words} is not from {least} to {most}")


def drawn(distribution: Any, random: np.random.Generator) -> Any:
    """A value of a distribution or of a function."""
    return distribution.draw(random) if hasattr(distribution, "draw") else distribution(random)


def reported(distribution: Any) -> str:
    """What a distribution is, as text that is another for another: of a function its name and the checksum of its source."""
    if hasattr(distribution, "draw"):
        return repr(distribution)
    try:
        source = hashlib.sha256(inspect.getsource(distribution).encode()).hexdigest()[:16]
    except (OSError, TypeError):
        source = "without source"
    return f"{distribution.__module__}.{distribution.__qualname__} ({source})"
