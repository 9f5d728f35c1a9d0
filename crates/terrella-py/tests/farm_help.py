"""What tests of the farm have in common."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

# Different frames, with an exposure that follows the light from day into night.
SCENE = """
[time]
start = "2018-06-21T16:00:00Z"
speed = 240
frame_rate_hz = 10
duration_s = 576
[camera]
mode = "geodetic"
lat_deg = 13
lon_deg = 14
height_km = 3000
[[camera.keys]]
time_s = 0
lat_deg = 13
lon_deg = 14
height_km = 3000
[[camera.keys]]
time_s = 576
lat_deg = 20
lon_deg = 130
height_km = 3000
[output]
size = [96, 64]
samples = 1
exposure_ev = "auto"
"""
FRAMES = 24


def write_scene(folder, text=SCENE, name="scene.toml"):
    path = Path(folder) / name
    path.write_text(text, encoding="utf-8")
    return path


def contents(folder, ending):
    """Files of this ending in a folder, by their names."""
    return {path.name: path.read_bytes() for path in sorted(Path(folder).iterdir()) if path.name.endswith(ending)}


def inodes(folder, ending):
    """What tells a file from one that was written again under the same name."""
    return {path.name: (path.stat().st_ino, path.stat().st_mtime_ns) for path in Path(folder).iterdir() if path.name.endswith(ending)}


def frames_of(folder):
    return json.loads((Path(folder) / "frames.json").read_text(encoding="utf-8"))["frames"]


def begin(program, *arguments, **options):
    """Starts a program of Python that uses the farm."""
    return subprocess.Popen([sys.executable, "-c", program, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                            **options)


def children(process):
    """Ids of the processes that a process has started."""
    found = []
    for task in Path(f"/proc/{process}/task").iterdir():
        found += [int(number) for number in (task / "children").read_text().split()]
    return found


def descendants(process):
    found = children(process)
    return found + [one for child in found for one in descendants(child)]


def wait_for(condition, what, seconds=120):
    deadline = time.monotonic() + seconds
    while not (found := condition()):
        assert time.monotonic() < deadline, what
        time.sleep(0.005)
    return found


def kill(process):
    os.kill(process, signal.SIGKILL)


def is_alive(process):
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False
