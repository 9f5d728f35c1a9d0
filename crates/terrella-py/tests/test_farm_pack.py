"""Packs of many workers: the same files as the command's."""

import os
import subprocess

import pytest
import terrella
from farm_help import begin, children, is_alive, kill, wait_for
from terrella import farm

OPTIONS = {"storage": "plain", "pixels": {"day": [128, 64], "clouds": [64]}, "attribution": ["NASA"]}
RUN = f"""
import sys
from terrella import farm
print(farm.pack(sys.argv[1], sys.argv[2], clouds=sys.argv[3], workers=2, **{OPTIONS!r}))
"""


def files(folder):
    return {str(path.relative_to(folder)): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def identities(folder):
    return {str(path.relative_to(folder)): (path.stat().st_ino, path.stat().st_mtime_ns) for path in folder.rglob("*.ktx2")}


@pytest.fixture(scope="module")
def maps(root):
    return {"day": root / "textures/day.jpg", "clouds": root / "textures/clouds.jpg"}


@pytest.fixture(scope="module")
def packed(maps, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pack")
    report = farm.pack(folder / "one/earth", workers=1, **maps, **OPTIONS)
    assert report.wanted == 128 * 3 and (report.done, report.kept) == (report.wanted, 0) and report.bytes_written > 0
    return folder / "one/earth"


def test_two_workers_cut_what_one_cuts(packed, maps, tmp_path):
    report = farm.pack(tmp_path / "earth", workers=2, **maps, **OPTIONS)
    assert len(report.by_worker) == 2 and sum(report.by_worker.values()) == report.wanted
    assert files(tmp_path / "earth") == files(packed)
    with pytest.raises(terrella.Error, match="finished pack"):
        farm.pack(tmp_path / "earth", workers=2, **maps, **OPTIONS)


@pytest.mark.skipif("TERRELLA_COMMAND" not in os.environ, reason="the command terrella was not built beside the tests")
def test_packs_are_those_of_the_command(packed, maps, tmp_path):
    command = [os.environ["TERRELLA_COMMAND"], "-q", "pack"]
    subprocess.run([*command, "build", "--day", maps["day"], "--clouds", maps["clouds"], "--storage", "plain", "--pixels", "day=128,64",
                    "--pixels", "clouds=64", "--attribution", "NASA", "-o", tmp_path / "earth"], check=True)
    assert files(tmp_path / "earth") == files(packed)
    subprocess.run([*command, "verify", packed], check=True)


def test_workers_and_who_began_the_run_may_be_killed(packed, maps, tmp_path):
    out = tmp_path / "earth"
    run = begin(RUN, out, maps["day"], maps["clouds"])
    wait_for(lambda: len(identities(out)) >= 20, "twenty tiles")
    kill(children(run.pid)[0])
    wait_for(lambda: len(identities(out)) >= 60 or run.poll() is not None, "sixty tiles")
    workers = children(run.pid) if run.poll() is None else []
    run.kill()
    run.communicate()
    wait_for(lambda: not any(map(is_alive, workers)), "the workers' end", 20)
    before = identities(out)
    report = farm.pack(out, workers=2, **maps, **OPTIONS)
    after = identities(out)
    repeated = [name for name in before if after[name] != before[name]]
    # Tiles with their final name but no line in a journal yet: at most one per worker.
    assert len(repeated) <= 2 * os.cpu_count() and report.kept >= len(before) - len(repeated)
    assert files(out) == files(packed)


def test_what_is_wrong_is_named(maps, tmp_path):
    for options, words in [
        ({"storage": "zip"}, "storage"),
        ({"pixels": {"sea": [64]}}, "sea"),
        ({"pixels": {"day": [64, 128]}}, "levels must fall"),
        ({"exaggeration": 3.0}, "exaggeration"),
        ({"workers": 0}, "workers"),
        ({"memory_mb": 0.0}, "memory_mb"),
    ]:
        with pytest.raises(ValueError, match=words):
            farm.pack(tmp_path / "earth", maps["day"], **options)
    with pytest.raises(terrella.Error, match="nowhere.png"):
        farm.pack(tmp_path / "earth", tmp_path / "nowhere.png")
    assert not (tmp_path / "earth").exists() or not any((tmp_path / "earth").iterdir())
