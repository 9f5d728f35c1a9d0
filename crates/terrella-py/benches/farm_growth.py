"""Tables of what farm.py measured, and of what follows from it for more workers: farm_growth.py writes them, `--check` compares.

The runs stand in farm_runs.jsonl beside it, as farm.py printed them. The model: work is shared without loss but for what is measured here (the
processor time that two workers lose); the engine carries so many calls a second; the disk that all share takes `DISK_BYTES_S`; each worker starts once; the
last task ends alone; a video is encoded by one ffmpeg when all frames are there. What takes longest sets the end.
"""

import csv
import io
import json
import math
import statistics
import sys
from pathlib import Path

HERE = Path(__file__).resolve().parent
RECORDED = HERE.parents[2] / "docs/recorded"
DISK_BYTES_S = 1e9
MAPS_BYTES = 7.5e6
MANY = 86_400
# Texels of a tile's row at each level, finest first, for a map of 86 400 texels round the Earth.
DAY_LEVELS = [5400, 2700, 1350, 675, 256]
JPEG_TEXELS = 86_400 * 43_200
WORKERS = [1, 2, 10, 100, 1000]


def load():
    runs = {}
    for line in (HERE / "farm_runs.jsonl").read_text(encoding="utf-8").splitlines():
        run = json.loads(line)
        runs.setdefault((run["what"], run.get("workers"), run.get("address")), []).append(run)
    return runs


def values(runs, what, workers=None, key="rate", address=None):
    return [run[key] for run in runs[(what, workers, address)]]


def spread(numbers, digits=3):
    middle, least, most = (format_number(number, digits) for number in (statistics.median(numbers), min(numbers), max(numbers)))
    return f"{middle} ({least}–{most})"


def format_number(number, digits=3):
    if number >= 10 ** (digits - 1):
        return f"{number:,.0f}".replace(",", "\u202f")
    return f"{number:.{max(0, digits - 1 - math.floor(math.log10(abs(number) or 1)))}f}"


def ratios(above, below):
    return [a / b for a, b in zip(above, below)]


def by_processor(runs, what):
    """Two over one, as the processor time of a picture has it: what others take of the cores does not count."""
    of = {n: [run["processor_s"] / run["done"] for run in runs[(what, n, None)]] for n in (1, 2)}
    return [2 * one / two for one, two in zip(of[1], of[2])]


def measured(runs):
    rows = [("what", "figure, median (least–most)", "by")]
    of = {n: values(runs, "film", n) for n in (1, 2)}
    loop = values(runs, "film loop", 0)
    rounds = f"`farm.py film`, {len(loop)} rounds"
    rows += [
        ("film, 640 × 360, frames a second: one worker; two", f"{spread(of[1])}; {spread(of[2])}", rounds),
        ("the same: two over one", spread(ratios(of[2], of[1])), rounds),
        ("the same by the workers' processor time: what two draw in a second of theirs over what one does, twice", spread(by_processor(runs, "film")), rounds),
        ("time of a frame by one worker over that of a program without a farm, on one core", spread(ratios(loop, of[1])), rounds),
        ("the same by the processor time of all processes, with all that a run begins with, ms a frame more",
         spread([1000 * (run["cpu_s"] / run["done"] - alone["cpu_s"] / alone["done"])
                 for run, alone in zip(runs[("film", 1, None)], runs[("film loop", 0, None)])]), rounds),
        ("the same: bytes that are reported and answered, and bytes that are written, a frame",
         "; ".join(format_number(statistics.median(run[key] / run["done"] for run in runs[("film", 2, None)])) for key in ("bytes_moved", "bytes_written")), rounds),
        ("the same: the first frames after the start, s: one worker; two", "; ".join(spread(values(runs, "film", n, "first_s")) for n in (1, 2)), rounds),
    ]
    of = {n: values(runs, "sweep", n) for n in (1, 2)}
    rounds = f"`farm.py sweep`, {len(of[1])} rounds"
    rows += [
        ("sweep, 256 × 256, five truth layers, samples a second: one worker; two", f"{spread(of[1])}; {spread(of[2])}", rounds),
        ("the same: two over one", spread(ratios(of[2], of[1])), rounds),
        ("the same by the workers' processor time, the making of their renderers with it", spread(by_processor(runs, "sweep")), rounds),
        ("the same: bytes that are written, a sample", format_number(statistics.median(run["bytes_written"] / run["done"] for run in runs[("sweep", 2, None)])), rounds),
    ]
    for run in runs.get(("sweep of 2000", 2, None), []):
        rows.append(("sweep of 2000 such samples, two workers: s in all; samples a second with the start; after it",
                     f"{format_number(run['wall_s'])}; {format_number(run['done'] / run['wall_s'])}; {format_number(run['rate'])}", "`farm.py big_sweep 1`"))
    of = {n: values(runs, "pack plain", n, "wall_s") for n in (1, 2)}
    rows.append(("pack of four starter maps, plain, s: one worker; two; one over two", f"{spread(of[1])}; {spread(of[2])}; {spread(ratios(of[1], of[2]))}", f"`farm.py pack`, {len(of[1])} rounds"))
    rows.append(("the same by the workers' processor time: two over one",
                 spread([2 * one / two for one, two in zip(*(values(runs, "pack plain", n, "processor_s") for n in (1, 2)))]), f"{len(of[1])} rounds"))
    of = {n: values(runs, "pack bc", n, "wall_s") for n in (1, 2)}
    rows.append(("the same maps, compressed, s: one worker; two; one over two", f"{spread(of[1])}; {spread(of[2])}; {spread(ratios(of[1], of[2]))}", f"{len(of[1])} rounds"))
    rows += [
        ("calls a second that do nothing: pool; Dask on this machine",
         f"{spread(values(runs, 'engine', key='calls_a_second'))}; {spread(values(runs, 'engine', key='calls_a_second', address='local'))}", "`farm.py engines`"),
        ("frames of 640 × 360 a second into a video, by ffmpeg on one core", spread(values(runs, "encode")), "`farm.py parts`"),
    ]
    return rows


def limits(runs, workers):
    """What takes how long, seconds, by the kind of work."""
    def middle(*of, **where):
        return statistics.median(values(runs, *of, **where))

    def texels(levels):
        return 128 * sum(level**2 for level in levels)

    calls_s = middle("engine", key="calls_a_second", address="local" if workers > 2 else None)
    start_s = middle("film", 1, "first_s")
    load_s = workers * MAPS_BYTES / DISK_BYTES_S
    made = {}
    for what, task in (("film", 16), ("sweep", 64)):
        efficiency = 1.0 if workers == 1 else min(1.0, statistics.median(by_processor(runs, what)) / 2)
        rate = middle(what, 1)
        written = statistics.median(one["bytes_written"] / one["done"] for one in runs[(what, 2, None)])
        task = max(1, min(task, MANY // (8 * workers))) if what == "film" else task
        made[what] = {
            "drawing": MANY / (rate * workers * efficiency),
            "the scheduler": MANY / task / calls_s,
            "the shared disk": MANY * written / DISK_BYTES_S,
            "start": start_s + load_s,
            "the last task": task / rate,
        }
    made["film with video"] = {**made["film"], "one ffmpeg": MANY / middle("encode")}
    # The day map alone, compressed for GPUs: the cost per texel, and the cost of reading the map once.
    small = texels([675, 256]) + 3 * texels([256])
    cost_s = middle("pack bc", 1, "wall_s") / small
    read_s = middle("pack read", key="wall_s") / (4096 * 2048) * JPEG_TEXELS
    parts = min(16, 1 << max(0, math.ceil(math.log2(workers))))
    made["pack"] = {
        "encoding": cost_s * texels(DAY_LEVELS) / min(workers, 16),
        "reading the map in each part": read_s * math.ceil(parts / workers),
        "the shared disk": texels(DAY_LEVELS) * 4 / 3 / DISK_BYTES_S,
    }
    return made


NAMES = {
    "film": "film of 86 400 frames, 640 × 360",
    "film with video": "the same with a video of it",
    "sweep": "sweep of 86 400 samples, 256 × 256, five layers",
    "pack": "day map of 86 400 × 43 200 texels, compressed tiles",
}


def growth(runs):
    rows = [("what", *(f"{n} worker{'s' * (n > 1)}" for n in WORKERS), "what sets the end at 1000")]
    every = {n: limits(runs, n) for n in WORKERS}
    for kind, name in NAMES.items():
        cells = []
        for n in WORKERS:
            terms = every[n][kind]
            once = sum(terms.get(one, 0) for one in ("start", "the last task", "one ffmpeg", "reading the map in each part"))
            flowing = {key: value for key, value in terms.items() if key not in ("start", "the last task", "one ffmpeg", "reading the map in each part")}
            longest = max(terms, key=terms.get)
            cells.append((duration(max(flowing.values()) + once), longest))
        rows.append((name, *(f"{text} ({longest})" for text, longest in cells), explained(every[1000][kind])))
    return rows


def explained(terms):
    first, second = sorted(terms, key=terms.get, reverse=True)[:2]
    return f"{first}, {duration(terms[first])}; then {second}, {duration(terms[second])}"


def duration(seconds):
    if seconds >= 5400:
        return f"{seconds / 3600:.1f} h"
    return f"{seconds / 60:.1f} min" if seconds >= 90 else f"{seconds:.1f} s"


def text(rows, head):
    file = io.StringIO()
    csv.writer(file, lineterminator="\n").writerows(rows)
    return head + file.getvalue()


def files():
    runs = load()
    machine = json.loads((HERE / "farm_machine.json").read_text(encoding="utf-8"))
    made = {}
    for name, rows, method in [
        ("farm.csv", measured(runs), "one worker on one core, two on one core each, interleaved"),
        ("farm_growth.csv", growth(runs), "computed from the runs of farm.csv"),
    ]:
        command = "python crates/terrella-py/benches/" + ("farm.py WHAT" if name == "farm.csv" else "farm_growth.py")
        head = "".join(f"# {key}: {value}\n" for key, value in {"method": method, "command": command, **machine}.items())
        made[RECORDED / name] = text(rows, head)
    return made


def main():
    for path, contents in files().items():
        if "--check" in sys.argv:
            if path.read_text(encoding="utf-8") != contents:
                sys.exit(f"{path} is not what farm_growth.py makes of farm_runs.jsonl; run it")
        else:
            path.write_text(contents, encoding="utf-8")


if __name__ == "__main__":
    main()
