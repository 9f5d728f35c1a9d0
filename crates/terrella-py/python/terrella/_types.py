"""What arguments of several functions may be, for type checkers."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, Literal, Protocol

if TYPE_CHECKING:
    import datetime
    from collections.abc import Iterable

    import numpy as np
    from numpy.typing import ArrayLike, NDArray
    from typing_extensions import TypeAlias

    from ._native import Epoch


class AstropyTime(Protocol):
    """A Time of astropy, one or an array of them. Its scales, such as ``utc``, are dynamic: type checkers do not see them."""

    @property
    def jd1(self) -> Any: ...
    @property
    def jd2(self) -> Any: ...
    @property
    def scale(self) -> Any: ...


class SkyfieldTime(Protocol):
    """A Time of skyfield, one or an array of them."""

    @property
    def whole(self) -> Any: ...
    @property
    def tai_fraction(self) -> Any: ...


class Quantity(Protocol):
    """Numbers with a unit, as astropy and poliastro have them."""

    @property
    def unit(self) -> Any: ...
    @property
    def to_value(self) -> Any: ...


class Distance(Protocol):
    """A distance of skyfield."""

    @property
    def au(self) -> Any: ...


class Velocity(Protocol):
    """A velocity of skyfield."""

    @property
    def au_per_d(self) -> Any: ...


Time: TypeAlias = "Epoch | str | datetime.datetime | np.datetime64 | AstropyTime | SkyfieldTime"
Times: TypeAlias = "Time | Iterable[Time] | NDArray[np.datetime64]"
FrameName: TypeAlias = Literal["itrf", "teme", "gcrf", "eme2000", "pef"]
Elapsed: TypeAlias = "datetime.timedelta | np.timedelta64 | float"
Vectors: TypeAlias = "ArrayLike | Quantity | Distance | Velocity"
