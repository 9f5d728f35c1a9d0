"""Films, by the program ffmpeg."""

from __future__ import annotations

import os
import shutil
import struct
import subprocess
import tempfile
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, NoReturn

from . import _whole

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray
    from typing_extensions import Self

    from ._earth import Frame


def _checked(path: str | os.PathLike[str], size: tuple[int, int], frame_rate_hz: float, crf: int) -> str:
    """The program ffmpeg; rejects what it would not make a film of."""
    from . import _native

    width, height = size
    if width % 2 or height % 2 or width < 2 or height < 2:
        raise ValueError(f"size: H.264 needs an even width and height, not {width} × {height}")
    if not 0 < float(frame_rate_hz) <= 1000:
        raise ValueError(f"frame_rate_hz: {frame_rate_hz} is not more than 0 and at most 1000")
    if not 0 <= int(crf) <= 51:
        raise ValueError(f"crf: {crf} is not from 0 to 51")
    program = shutil.which("ffmpeg")
    if program is None:
        raise _native.Error("ffmpeg was not found on the search path; install it (on Debian and Ubuntu "
                            "`apt-get install ffmpeg`), or write frames by Frame.save")
    if Path(path).suffix.lower() != ".mp4":
        raise ValueError(f"path: {path} does not end in .mp4")
    return program


def _coding(crf: int) -> list[str]:
    """Arguments for ffmpeg: H.264 that players show in the right colours."""
    # Convert with BT.709 and say so: without the filter ffmpeg would convert with BT.601.
    return ["-vf", "scale=out_color_matrix=bt709:out_range=tv,format=yuv420p",
            "-c:v", "libx264", "-crf", str(int(crf)), "-colorspace", "bt709", "-color_primaries", "bt709",
            "-color_trc", "bt709", "-color_range", "tv", "-movflags", "+faststart"]


def encode_frames(
    path: str | os.PathLike[str], folder: str | os.PathLike[str], first: str, count: int, frame_rate_hz: float, *, crf: int = 18
) -> None:
    """An H.264 film (MP4) of numbered pictures in a folder: of ``count`` from the one named ``first`` on, ``frame_00000.png`` for example."""
    from . import _native

    with open(Path(folder) / first, "rb") as picture:
        size = struct.unpack(">II", picture.read(24)[16:])
    program = _checked(path, size, frame_rate_hz, crf)
    path = Path(path)
    number = Path(first).stem.rpartition("_")[2]
    pattern = str(Path(folder).absolute()).replace("%", "%%") + f"/frame_%0{len(number)}d.png"
    unfinished = path.with_name(f"{path.stem}.{os.getpid()}.part.mp4")
    try:
        ran = subprocess.run(
            [program, "-y", "-loglevel", "error", "-framerate", str(frame_rate_hz), "-start_number", str(int(number)), "-i", pattern,
             "-frames:v", str(count), *_coding(crf), os.fspath(unfinished)],
            stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        problem = _native.mp4_problem(unfinished, count) if ran.returncode == 0 else None
        if ran.returncode != 0 or problem:
            status = f"the video is incomplete: {problem}" if problem else ran.returncode
            raise _native.Error(f"{path}: ffmpeg failed ({status}): {ran.stderr.decode(errors='replace').strip()[-500:]}")
        _whole.replace(unfinished, path)
    finally:
        unfinished.unlink(missing_ok=True)


class Film:
    """An H.264 film (MP4) of frames that are written one by one. It is complete or not there.

    >>> with terrella.Film("iss.mp4", scene.size, scene.frame_rate_hz) as film:
    ...     for frame in tqdm(scene.frames(), total=len(scene.times())):
    ...         film.write(frame)

    ``crf`` is x264's quality, 0 to 51, 18 by default. Colours are BT.709, of limited range, and tagged so. Needs ``ffmpeg`` with libx264 on the search path.
    """

    def __init__(self, path: str | os.PathLike[str], size: tuple[int, int], frame_rate_hz: float, *, crf: int = 18) -> None:
        width, height = size
        program = _checked(path, size, frame_rate_hz, crf)
        self._path = Path(path)
        self._unfinished = self._path.with_name(f"{self._path.stem}.{os.getpid()}.part.mp4")
        self._size = (width, height)
        self._frames = 0
        self._errors = tempfile.TemporaryFile()
        self._ffmpeg: subprocess.Popen[bytes] | None = subprocess.Popen(
            [program, "-y", "-loglevel", "error", "-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}",
             "-r", str(frame_rate_hz), "-i", "-",
             *_coding(crf), os.fspath(self._unfinished)],
            stdin=subprocess.PIPE, stdout=subprocess.DEVNULL, stderr=self._errors)

    def write(self, frame: Frame | NDArray[np.uint8]) -> None:
        """Writes the next frame: a ``Frame``, or an array of height × width × 4 bytes."""
        import numpy

        color = numpy.ascontiguousarray(getattr(frame, "color", frame))
        width, height = self._size
        if color.shape != (height, width, 4) or color.dtype != numpy.uint8:
            raise ValueError(f"frame: an array of shape {(height, width, 4)} and dtype uint8 is needed, not of {color.shape} and {color.dtype}")
        if self._ffmpeg is None or self._ffmpeg.stdin is None:
            raise ValueError("frame: the film is finished")
        try:
            self._ffmpeg.stdin.write(color.data)
        except OSError:
            self._fail()
        self._frames += 1

    def close(self) -> None:
        """Finishes the film and gives the file its name."""
        from . import _native

        if self._ffmpeg is None or self._ffmpeg.stdin is None:
            return
        try:
            self._ffmpeg.stdin.close()
        except OSError:
            self._fail()
        if self._ffmpeg.wait() != 0:
            self._fail()
        if problem := _native.mp4_problem(self._unfinished, self._frames):
            self._fail(f"the video is incomplete: {problem}")
        self._ffmpeg = None
        self._errors.close()
        _whole.replace(self._unfinished, self._path)

    def _fail(self, why: str | None = None) -> NoReturn:
        from . import _native

        status = why or (self._ffmpeg and self._ffmpeg.wait())
        self._errors.seek(0)
        words = self._errors.read().decode(errors="replace").strip()[-500:]
        self._discard()
        raise _native.Error(f"{self._path}: ffmpeg failed ({status}): {words}")

    def _discard(self) -> None:
        if self._ffmpeg is not None:
            self._ffmpeg.kill()
            self._ffmpeg.wait()
            try:
                if self._ffmpeg.stdin is not None:
                    self._ffmpeg.stdin.close()
            except OSError:
                pass
            self._ffmpeg = None
        self._errors.close()
        self._unfinished.unlink(missing_ok=True)

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, value: BaseException | None, traceback: TracebackType | None) -> None:
        if kind is None:
            self.close()
        else:
            self._discard()
