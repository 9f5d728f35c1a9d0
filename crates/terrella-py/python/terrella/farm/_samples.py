"""What the samples of a sweep are, by their numbers."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from .. import _native
from .distributions import drawn

# The order in which a sample draws its random numbers. A seed's meaning depends on it.
ORDER = ("place", "height_m", "heading_deg", "pitch_deg", "fov_deg", "time", "exposure_ev", "sun_elevation_deg")
# Most attempts to draw a sample whose place can have the Sun at the drawn elevation.
_ATTEMPTS = 100
_DAY_S = 86_400.0


@dataclass
class Chosen:
    """What a sample is to show."""

    index: int
    values: dict[str, Any]

    def camera(self) -> Any:
        lat_deg, lon_deg = self.values["place"]
        aimed = {name: float(self.values[name]) for name in ("heading_deg", "pitch_deg", "fov_deg")}
        return _native.Camera.geodetic(float(lat_deg), float(lon_deg), float(self.values["height_m"]), **aimed)

    def sun_elevation_deg(self) -> float:
        """How high the Sun stands over the ground in the middle of the image, or over the place where that is sky."""
        lat_rad, lon_rad = self._aim()
        sun = _native.sun_itrf_m([self.values["time"]])[0]
        lat_sun, lon_sun = math.atan2(sun[2], math.hypot(sun[0], sun[1])), math.atan2(sun[1], sun[0])
        return math.degrees(math.asin(_sine_of_elevation(lat_rad, lat_sun, lon_rad - lon_sun)))

    def move_time(self, sun_elevation_deg: float, is_morning: bool) -> bool:
        """Moves the time, by half a day at most, to when the Sun stands so high in the middle of the image; False where it never does."""
        begun = _native.Epoch(self.values["time"])
        lat_rad, lon_rad = self._aim()
        sine, moved_s = math.sin(math.radians(sun_elevation_deg)), 0.0
        # The Sun's declination changes by up to 0.4° a day: three steps leave less than a thousandth of a degree.
        for _ in range(3):
            sun = _native.sun_itrf_m([begun + moved_s])[0]
            lat_sun, lon_sun = math.atan2(sun[2], math.hypot(sun[0], sun[1])), math.atan2(sun[1], sun[0])
            cosine = (sine - math.sin(lat_rad) * math.sin(lat_sun)) / max(math.cos(lat_rad) * math.cos(lat_sun), 1e-9)
            if not -1.0 <= cosine <= 1.0:
                return False
            wanted = math.acos(cosine) * (-1.0 if is_morning else 1.0)
            turn = math.remainder(wanted - (lon_rad - lon_sun), 2 * math.pi) / (2 * math.pi)
            moved_s += turn * _DAY_S
        self.values["time"] = (begun + moved_s).utc
        return True

    def _aim(self) -> tuple[float, float]:
        """Latitude and longitude (geodetic, radians) of the ground that the camera's axis meets, or of the place under the camera."""
        import numpy as np

        camera = self.camera()
        # Scale the ellipsoid to a unit sphere.
        scale = 1 / _native.itrf_from_geodetic([[0, 0, 0], [0, 90, 0], [90, 0, 0]]).diagonal()
        eye, ahead = camera.eye_itrf_m * scale, camera.forward * scale
        a, b, c = ahead @ ahead, eye @ ahead, eye @ eye - 1
        if b < 0 and b * b >= a * c:
            ground = (eye - ahead * ((b + math.sqrt(b * b - a * c)) / a)) / scale
            lat_deg, lon_deg, _ = _native.geodetic_from_itrf(ground)
        else:
            lat_deg, lon_deg = self.values["place"]
        return math.radians(float(lat_deg)), math.radians(float(lon_deg))

    def reported(self) -> dict[str, Any]:
        """The same as numbers and text."""
        values, time = self.values, self.values["time"]
        lat_deg, lon_deg = values["place"]
        camera: dict[str, Any] = {"lat_deg": float(lat_deg), "lon_deg": float(lon_deg)}
        camera |= {name: float(values[name]) for name in ("height_m", "heading_deg", "pitch_deg", "fov_deg")}
        camera["eye_itrf_m"] = [float(value) for value in self.camera().eye_itrf_m]
        sun = _native.sun_itrf_m([time])[0]
        exposure_ev = values.get("exposure_ev")
        return {"index": self.index, "time_utc": time, "camera": camera,
                "exposure_ev": None if exposure_ev is None else float(exposure_ev), "sun_itrf_m": [float(value) for value in sun],
                "sun_elevation_deg": self.sun_elevation_deg()}


def _sine_of_elevation(lat_rad: float, lat_sun: float, hour_angle_rad: float) -> float:
    sine = math.sin(lat_rad) * math.sin(lat_sun) + math.cos(lat_rad) * math.cos(lat_sun) * math.cos(hour_angle_rad)
    return min(max(sine, -1.0), 1.0)


@dataclass
class Plan:
    """Says of each number what its sample shows."""

    seed: int
    distributions: dict[str, Any]
    draw: Callable[[Any, int], dict[str, Any]] | None = None

    def sample(self, index: int) -> Chosen:
        import numpy as np

        random = np.random.Generator(np.random.PCG64(np.random.SeedSequence((self.seed, index))))
        for _ in range(_ATTEMPTS):
            chosen = self._drawn(index, random)
            wanted = chosen.values.get("sun_elevation_deg")
            if wanted is not None and not -90 <= float(wanted) <= 90:
                raise ValueError(f"sun_elevation_deg: sample {index}: {wanted} is not from -90 to 90")
            if wanted is None or chosen.move_time(float(wanted), random.random() < 0.5):
                return chosen
        raise ValueError(f"sun_elevation_deg: sample {index}: in {_ATTEMPTS} attempts the Sun never reached the elevation at a place that was drawn; "
                         f"the last was {float(wanted):.1f}°")

    def _drawn(self, index: int, random: Any) -> Chosen:
        values = {name: drawn(self.distributions[name], random) for name in ORDER if name in self.distributions}
        if self.draw is not None:
            given = self.draw(random, index)
            unknown = [name for name in given if name not in ORDER]
            if unknown:
                raise ValueError(f"draw: gives {', '.join(unknown)}; there are {', '.join(ORDER)}")
            values |= given
        # The reported time equals the drawn time to the last digit.
        values["time"] = _native.Epoch(values["time"]).utc
        return Chosen(index, values)
