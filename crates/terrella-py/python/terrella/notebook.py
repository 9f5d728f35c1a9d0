"""An Earth in a notebook that turns under the mouse. Needs jupyter_rfb: ``pip install 'terrella-earth[notebook]'``.

>>> import terrella
>>> from terrella.notebook import View
>>> View(terrella.Earth((640, 360)), "2018-06-21T08:00:00Z")
"""

from __future__ import annotations

import asyncio
import math
import threading
from typing import TYPE_CHECKING, Any

try:
    from jupyter_rfb import RemoteFrameBuffer
except ImportError as error:
    raise ImportError(f"terrella.notebook needs jupyter_rfb ({error}); pip install 'terrella-earth[notebook]'") from error

from ._native import Camera

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from ._earth import Earth
    from ._types import Time


class View(RemoteFrameBuffer):  # type: ignore[misc, unused-ignore]  # jupyter_rfb has no types.
    """The Earth seen from above a place: drag to fly, turn the wheel to climb. The kernel is free while a picture is drawn."""

    LOWEST_M = 2e5
    HIGHEST_M = 1e8

    def __init__(
        self, earth: Earth, time: Time, *, lat_deg: float = 20.0, lon_deg: float = 10.0, height_m: float = 1.2e7, fov_deg: float = 45.0
    ) -> None:
        # Set before the widget starts: it may request a frame at once.
        self._earth = earth
        self._time = time
        self.place = [float(lat_deg), float(lon_deg), float(height_m)]
        self._fov_deg = fov_deg
        self._dragged: tuple[float, float] | None = None
        self._wanted = threading.Event()
        self._lock = threading.Lock()
        self._drawn: NDArray[np.uint8] | None = None
        # Draw here first, so that errors are raised here and not in a thread.
        self._draw()
        super().__init__()
        width, height = earth.size
        self.css_width, self.css_height = f"{width}px", f"{height}px"

    def camera(self) -> Camera:
        """Where the eye is now."""
        lat_deg, lon_deg, height_m = self.place
        return Camera.geodetic(lat_deg, lon_deg, height_m, fov_deg=self._fov_deg)

    def set_time(self, time: Time) -> None:
        """Shows another instant."""
        self._time = time
        self._draw()
        self.request_draw()

    def _draw(self) -> None:
        self._drawn = self._earth.color(self.camera(), self._time)[:, :, :3]

    def _draw_in_thread(self, loop: asyncio.AbstractEventLoop) -> None:
        try:
            while self._wanted.is_set():
                self._wanted.clear()
                self._draw()
                # Outside the kernel's event loop, a requested draw would never happen.
                loop.call_soon_threadsafe(self.request_draw)
        finally:
            self._lock.release()

    def _moved(self) -> None:
        self._wanted.set()
        if self._lock.acquire(blocking=False):
            loop = asyncio.get_running_loop()
            threading.Thread(target=self._draw_in_thread, args=[loop], daemon=True).start()

    def get_frame(self) -> NDArray[np.uint8] | None:
        """Called by the widget: the picture drawn last."""
        return self._drawn

    def handle_event(self, event: dict[str, Any]) -> None:
        """Called by the widget: what the mouse does."""
        kind = event["event_type"]
        if kind == "pointer_down":
            self._dragged = event["x"], event["y"]
        elif kind == "pointer_up":
            self._dragged = None
        elif kind == "pointer_move" and self._dragged is not None:
            (x, y), self._dragged = self._dragged, (event["x"], event["y"])
            # The surface at the centre of the view follows the pointer.
            pixel_m = 2 * self.place[2] * math.tan(math.radians(self._fov_deg) / 2) / self._earth.size[1]
            pixel_deg = min(math.degrees(pixel_m / 6.4e6), 0.5)
            narrowing = max(math.cos(math.radians(self.place[0])), 0.1)
            self.place[0] = min(max(self.place[0] + (event["y"] - y) * pixel_deg, -89.9), 89.9)
            self.place[1] = (self.place[1] - (event["x"] - x) * pixel_deg / narrowing + 180) % 360 - 180
            self._moved()
        elif kind == "wheel":
            height_m = self.place[2] * math.exp(event["dy"] / 500)
            self.place[2] = min(max(height_m, self.LOWEST_M), self.HIGHEST_M)
            self._moved()
