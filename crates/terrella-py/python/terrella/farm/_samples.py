"""What the samples of a sweep are, by their numbers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .. import _native
from .distributions import drawn

# The order in which a sample's random numbers are taken: part of what a seed means.
ORDER = ("place", "height_m", "heading_deg", "pitch_deg", "fov_deg", "time", "exposure_ev")


@dataclass
class Chosen:
    """What a sample is to show."""

    index: int
    values: dict[str, Any]

    def camera(self) -> Any:
        lat_deg, lon_deg = self.values["place"]
        aimed = {name: float(self.values[name]) for name in ("heading_deg", "pitch_deg", "fov_deg")}
        return _native.Camera.geodetic(float(lat_deg), float(lon_deg), float(self.values["height_m"]), **aimed)

    def told(self) -> dict:
        """The same as numbers and text."""
        values, time = self.values, self.values["time"]
        lat_deg, lon_deg = values["place"]
        camera = {"lat_deg": float(lat_deg), "lon_deg": float(lon_deg)}
        camera |= {name: float(values[name]) for name in ("height_m", "heading_deg", "pitch_deg", "fov_deg")}
        camera["eye_itrf_m"] = [float(value) for value in self.camera().eye_itrf_m]
        sun = _native.sun_itrf_m([time])[0]
        exposure_ev = values.get("exposure_ev")
        return {"index": self.index, "time_utc": time, "camera": camera,
                "exposure_ev": None if exposure_ev is None else float(exposure_ev), "sun_itrf_m": [float(value) for value in sun]}


@dataclass
class Plan:
    """Says of each number what its sample shows."""

    seed: int
    distributions: dict[str, Any]
    draw: Callable[[Any, int], dict] | None = None

    def sample(self, index: int) -> Chosen:
        import numpy as np

        random = np.random.Generator(np.random.PCG64(np.random.SeedSequence((self.seed, index))))
        values = {name: drawn(self.distributions[name], random) for name in ORDER if name in self.distributions}
        if self.draw is not None:
            given = self.draw(random, index)
            unknown = [name for name in given if name not in ORDER]
            if unknown:
                raise ValueError(f"draw: gives {', '.join(unknown)}; there are {', '.join(ORDER)}")
            values |= given
        # What is reported is what is drawn, to the last digit.
        values["time"] = _native.Epoch(values["time"]).utc
        return Chosen(index, values)
