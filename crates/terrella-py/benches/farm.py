"""Measures the farm: farm.py WHAT [ROUNDS], WHAT being film, sweep, big_sweep, pack, engines or parts. Prints a line of JSON for each run.

One worker on one core against two on one core each, interleaved; `loop` is a program that draws and writes the same without a farm, on one
core. `rate` is of the time after all workers have answered once: a long run's. `cpu_s` is user and system time of all processes.
"""

import json
import os
import resource
import shutil
import sys
import tempfile
import time
from pathlib import Path

import terrella
from terrella import _native, farm
from terrella._earth import _textures
from terrella._film import encode_frames
from terrella.farm import _engine, _files

ROOT = Path(__file__).resolve().parents[3]
SCENE = ROOT / "config/iss.toml"
FILM = {"size": (640, 360), "frames": range(0, 96), "frames_a_task": 2}
LAYERS = ["lat_deg", "lon_deg", "range_m", "land", "cloud_cover"]
SWEEP = {"size": (256, 256), "layers": LAYERS, "samples_a_shard": 16, "seed": 1}


def cpu_s():
    of = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return sum(one.ru_utime + one.ru_stime for one in of)


class Pace:
    """When what was done."""

    def __init__(self):
        self.begin = time.monotonic()
        self.reported = []

    def __call__(self, done, wanted):
        self.reported.append((time.monotonic() - self.begin, done))

    def rate(self, after):
        (first_s, first), (last_s, last) = next(reported for reported in self.reported if reported[1] >= after), self.reported[-1]
        return (last - first) / (last_s - first_s)

    def first_s(self):
        return next(seconds for seconds, done in self.reported if done > 0)


def reported(what, **values):
    print(json.dumps({"what": what, **{key: round(value, 4) if isinstance(value, float) else value for key, value in values.items()}}), flush=True)


def farmed(what, workers, after, run):
    """A run on as many cores as workers."""
    cores = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, cores[:workers])
    os.environ["LP_NUM_THREADS"] = "1"
    out = Path(tempfile.mkdtemp(prefix="farm-"))
    pace, before, begin = Pace(), cpu_s(), time.monotonic()
    try:
        report = run(out / "out", workers, pace)
    finally:
        os.sched_setaffinity(0, cores)
        shutil.rmtree(out)
    wall_s = time.monotonic() - begin
    reported(what, workers=workers, done=report.done, wall_s=wall_s, first_s=pace.first_s() if pace.reported else None,
         rate=pace.rate(after) if pace.reported and after else report.done / wall_s, cpu_s=cpu_s() - before, drawing_s=report.drawing_seconds,
         processor_s=report.processor_seconds,
         bytes_moved=report.bytes_moved, bytes_written=report.bytes_written)


def film(out, workers, pace):
    return farm.film(SCENE, out, workers=workers, progress=pace, **FILM)


def film_loop():
    """The same frames without a farm: drawn, encoded and written one by one."""
    cores = sorted(os.sched_getaffinity(0))
    os.sched_setaffinity(0, cores[:1])
    os.environ["LP_NUM_THREADS"] = "1"
    with tempfile.TemporaryDirectory() as out:
        frames = _native.FilmFrames(SCENE, _textures(None), _native.Pictures(), size=FILM["size"])
        numbers = list(FILM["frames"])
        first = len(numbers) // 8
        for index in numbers:
            if index == numbers[first]:
                begin, before = time.monotonic(), cpu_s()
            contents, _, _ = frames.draw(index, f"{index}.png")
            _files.write_whole(Path(out) / f"{index}.png", contents)
        seconds = time.monotonic() - begin
    os.sched_setaffinity(0, cores)
    reported("film loop", workers=0, done=len(numbers) - first, rate=(len(numbers) - first) / seconds, cpu_s=cpu_s() - before, wall_s=seconds)


def sweep(count):
    return lambda out, workers, pace: farm.sweep(SCENE, out, count, workers=workers, progress=pace, **SWEEP)


def pack(storage):
    """The starter maps as a pack whose levels are the paper's: enlarged, which asks for as much work as larger maps but their reading."""
    def run(out, workers, pace):
        textures = ROOT / "textures"
        return farm.pack(out / "earth", textures / "day.jpg", clouds=textures / "clouds.jpg", water=textures / "water.png",
                         night_lights=textures / "night_lights.png", storage=storage, pixels={"day": [675, 256], "clouds": [256]},
                         workers=workers, progress=pace)

    return run



def parts():
    """What else a run has in it: a video of the frames, and the reading of a map for a part of a pack, each on one core."""
    cores = sorted(os.sched_getaffinity(0))
    with tempfile.TemporaryDirectory() as folder:
        out = Path(folder)
        farm.film(SCENE, out / "frames", workers=2, **FILM)
        os.sched_setaffinity(0, cores[:1])
        begin = time.monotonic()
        encode_frames(out / "film.mp4", out / "frames", "frame_00000.png", len(FILM["frames"]), 30.0)
        reported("encode", rate=len(FILM["frames"]) / (time.monotonic() - begin))
        begin = time.monotonic()
        farm.pack(out / "small", ROOT / "textures/day.jpg", storage="plain", pixels={"day": [32]}, workers=1)
        # A map of 4096 × 2048 texels; the time includes the start of the program.
        reported("pack read", wall_s=time.monotonic() - begin)
    os.sched_setaffinity(0, cores)


def engines(address):
    """How many calls a second an engine carries that do nothing."""
    engine = _engine.open_engine(2, address)
    begun = time.monotonic()
    try:
        import terrella_farm_nothing as module
    except ImportError:
        folder = tempfile.mkdtemp()
        (Path(folder) / "terrella_farm_nothing.py").write_text("def nothing(argument):\n    return argument\n")
        sys.path.insert(0, folder)
        engine.close()
        engine = _engine.open_engine(2, address)
        begun = time.monotonic()
        import terrella_farm_nothing as module
    count, given, taken = 2000, 0, 0
    while taken < count:
        while given < count and engine.room() > 0:
            engine.submit(_engine.Call(str(given), module.nothing, {"n": given}))
            given += 1
        engine.next()
        taken += 1
        if taken == 200:
            begin = time.monotonic()
    seconds = time.monotonic() - begin
    reported("engine", address=address, calls_a_second=(count - 200) / seconds, first_s=begin - begun)
    engine.close()


def main():
    what, rounds = sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else 5
    reported("machine", cores=len(os.sched_getaffinity(0)), adapter=terrella.Earth((16, 16)).adapter, python=sys.version.split()[0])
    for _ in range(rounds):
        if what == "film":
            film_loop()
            for workers in (1, 2):
                farmed("film", workers, len(FILM["frames"]) // 8, film)
        elif what == "sweep":
            for workers in (1, 2):
                farmed("sweep", workers, 32, sweep(128))
        elif what == "big_sweep":
            farmed("sweep of 2000", 2, 32, sweep(2000))
        elif what == "pack":
            for storage in ("plain", "bc"):
                for workers in (1, 2):
                    farmed(f"pack {storage}", workers, 0, pack(storage))
        elif what == "parts":
            parts()
        elif what == "engines":
            for address in (None, "local"):
                engines(address)


if __name__ == "__main__":
    main()
