"""The command `python -m terrella.farm`."""

from __future__ import annotations

import argparse
import importlib
import re
import sys
import warnings
from collections.abc import Sequence
from typing import Any

from .. import _native
from . import FarmError, distributions, film, pack, sweep
from ._sweep import DEFAULT_LAYERS

_DRAWN = """Quantities of a sweep are a number; uniform:LEAST:MOST, loguniform:LEAST:MOST, normal:MEAN:DEVIATION or normal:MEAN:DEVIATION:LEAST:MOST;
choice:A:B:C; or MODULE.FUNCTION, which is given a numpy.random.Generator."""


def _size(text: str) -> tuple[int, int]:
    found = re.fullmatch(r"(\d+)[xX](\d+)", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is no size; write it as in 1280x720")
    return int(found[1]), int(found[2])


def _frames(text: str) -> range:
    found = re.fullmatch(r"(\d+)\.\.(=?)(\d+)", text)
    if not found:
        raise argparse.ArgumentTypeError(f"{text!r} is no range; write it as FIRST..END, for example 240..480 for the frames 240 to 479")
    return range(int(found[1]), int(found[3]) + bool(found[2]))


def _function(text: str) -> Any:
    module, _, name = text.rpartition(".")
    try:
        return getattr(importlib.import_module(module), name)
    except (ImportError, AttributeError, ValueError) as error:
        raise argparse.ArgumentTypeError(f"{text!r} is no number, no distribution and no function: {error}") from None


def _drawn(text: str) -> Any:
    kind, *values = text.split(":")
    kinds = {"uniform": (distributions.Uniform, {2}), "loguniform": (distributions.LogUniform, {2}), "normal": (distributions.Normal, {2, 4})}
    try:
        if kind in kinds:
            make, lengths = kinds[kind]
            if len(values) not in lengths:
                raise ValueError(f"{kind} takes {' or '.join(map(str, sorted(lengths)))} numbers")
            return make(*map(float, values))
        if kind == "choice":
            return distributions.Choice([float(value) for value in values])
        return float(text)
    except ValueError as error:
        if kind in kinds or kind == "choice":
            raise argparse.ArgumentTypeError(f"{text!r}: {error}") from None
    return _function(text)


def _dates(text: str) -> Any:
    first, _, last = text.partition("..")
    try:
        return distributions.Dates(first, last) if last else first
    except (ValueError, _native.Error) as error:
        raise argparse.ArgumentTypeError(f"{text!r}: {error}") from None


def _box(text: str) -> Any:
    try:
        west, south, east, north = (float(value) for value in text.split(","))
        return distributions.OnSphere((south, north), (west, east))
    except ValueError as error:
        raise argparse.ArgumentTypeError(f"{text!r} is no region W,S,E,N: {error}") from None


def _levels(text: str) -> tuple[str, list[int]]:
    name, _, levels = text.partition("=")
    try:
        return name, [int(level) for level in levels.split(",")]
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text!r}: write it as in day=1350,675,256") from None


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser("python -m terrella.farm", description="Renders films, labelled data sets and imagery packs on many workers. The same command resumes an interrupted run.")
    commands = parser.add_subparsers(required=True, metavar="film|sweep|pack")
    common = argparse.ArgumentParser(add_help=False)
    group = common.add_argument_group("workers")
    group.add_argument("--workers", type=int, metavar="N", help="processes of this machine [2]")
    group.add_argument("--address", metavar="tcp://HOST:PORT", help="a Dask cluster instead; local: one of this machine")
    group.add_argument("--retries", type=int, default=2, metavar="N", help="retries of a part whose failure may be temporary [2]")
    group.add_argument("--overwrite", action="store_true", help="replace existing output")
    group.add_argument("--quiet", action="store_true", help="print no progress bar and no report")
    scene = argparse.ArgumentParser(add_help=False)
    scene.add_argument("scene", metavar="SCENE", help="the scene file")
    scene.add_argument("-o", "--out", required=True, metavar="FOLDER", help="the folder to write to")
    scene.add_argument("--size", type=_size, metavar="WxH", help="width and height in pixels")
    scene.add_argument("--adapter", metavar="NAME", help="part of the name of the graphics adapter")
    scene.add_argument("--textures", metavar="FOLDER", help="folder of maps, instead of the package's")

    of_film = commands.add_parser("film", parents=[scene, common], help="the frames of a scene's film")
    of_film.set_defaults(call=_film)
    of_film.add_argument("--video", metavar="FILE.mp4", help="encode the frames with ffmpeg")
    of_film.add_argument("--frames", type=_frames, metavar="FIRST..END", help="only these frames, END excluded")
    of_film.add_argument("--format", choices=["png", "png16", "exr", "pq", "hlg"], default="png")
    of_film.add_argument("--alpha", action="store_true", help="transparent space")
    of_film.add_argument("--supersample", type=int, metavar="N", help="render N × N samples per pixel: 1, 2 or 4")
    of_film.add_argument("--shutter", type=float, metavar="PART", help="average light over this fraction of the frame interval")
    of_film.add_argument("--subframes", type=int, default=16, metavar="N", help="with --shutter: number of subframes [16]")
    of_film.add_argument("--crf", type=int, default=18, metavar="N", help="video quality, 0 (best) to 51 [18]")

    of_sweep = commands.add_parser("sweep", parents=[scene, common], help="a labelled data set", epilog=_DRAWN)
    of_sweep.set_defaults(call=_sweep)
    of_sweep.add_argument("--count", type=int, required=True, metavar="N", help="samples")
    of_sweep.add_argument("--seed", type=int, default=0, metavar="N")
    of_sweep.add_argument("--layers", default=",".join(DEFAULT_LAYERS), metavar="A,B", help="truth layers [%(default)s]")
    of_sweep.add_argument("--region", type=_box, dest="place", metavar="W,S,E,N", help="places within these bounds, degrees")
    for name in ("height-m", "heading-deg", "pitch-deg", "fov-deg", "exposure-ev", "sun-elevation-deg"):
        of_sweep.add_argument(f"--{name}", type=_drawn, metavar="DRAWN")
    of_sweep.add_argument("--time", type=_dates, metavar="FIRST..LAST", help="range of times, UTC [the scene's]")
    of_sweep.add_argument("--draw", type=_function, metavar="MODULE.FUNCTION", help="function of a Generator and a sample number that returns quantities by name")
    of_sweep.add_argument("--format", choices=["webdataset", "zarr"], default="webdataset")
    of_sweep.add_argument("--samples-a-shard", type=int, default=64, metavar="N", help="[64]")

    of_pack = commands.add_parser("pack", parents=[common], help="an imagery pack from maps")
    of_pack.set_defaults(call=_pack)
    of_pack.add_argument("-o", "--out", required=True, metavar="FOLDER", help="the pack's folder")
    of_pack.add_argument("--day", required=True, metavar="MAP", help="surface colour by day, sRGB")
    for name in ("clouds", "normals", "elevation", "night-lights", "water"):
        of_pack.add_argument(f"--{name}", metavar="MAP")
    of_pack.add_argument("--name")
    of_pack.add_argument("--attribution", action="append", default=[], metavar="TEXT")
    of_pack.add_argument("--storage", choices=["plain", "bc", "both"], default="both")
    of_pack.add_argument("--pixels", type=_levels, action="append", default=[], metavar="LAYER=N,N")
    of_pack.add_argument("--exaggeration", type=float, metavar="TIMES")
    of_pack.add_argument("--elevation-offset-m", type=float, metavar="METRES")
    of_pack.add_argument("--memory-mb", type=float, default=512.0, metavar="MB", help="of each worker [512]")
    return parser


def _film(scene: str, out: str, options: dict[str, Any]) -> Any:
    return film(scene, out, **options)


def _sweep(scene: str, out: str, options: dict[str, Any]) -> Any:
    options["layers"] = [name for name in options["layers"].split(",") if name]
    count = options.pop("count")
    return sweep(scene, out, count, **{name: value for name, value in options.items() if value is not None})


def _pack(scene: None, out: str, options: dict[str, Any]) -> Any:
    options["pixels"] = dict(options["pixels"])
    return pack(out, options.pop("day"), **options)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the command; 0 where all went well, 1 where something is left undone, 2 where it was not asked for rightly."""
    options = vars(_parser().parse_args(arguments))
    call, quiet = options.pop("call"), options.pop("quiet")
    options["progress"] = False if quiet else None
    # Prints warnings without the source line.
    warnings.showwarning = lambda message, *_: print(f"warning: {message}", file=sys.stderr)
    try:
        report = call(options.pop("scene", None), options.pop("out"), options)
    except KeyboardInterrupt:
        print("stopped; complete output is kept, and the same command resumes", file=sys.stderr)
        return 130
    except FarmError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except (ValueError, TypeError, _native.SceneError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    except (_native.Error, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    if not quiet:
        print(report)
    return 0


if __name__ == "__main__":
    sys.exit(main())
