"""The same on a Dask cluster: its own address alone, through the end of workers and of the scheduler."""

import os
import subprocess
import sys

import pytest
from farm_help import FRAMES, begin, contents, descendants, inodes, kill, wait_for, write_scene
from pathlib import Path
from terrella import farm

distributed = pytest.importorskip("distributed", reason="distributed is not installed: films and sweeps on clusters are not tested here")

RUN = """
import sys
from terrella import farm
print(farm.film(sys.argv[1], sys.argv[2], workers=2, frames_a_task=1, address="local", size=(256, 160)))
"""


@pytest.fixture(scope="module")
def film(tmp_path_factory):
    folder = tmp_path_factory.mktemp("dask")
    farm.film(write_scene(folder), folder / "one", workers=1, size=(256, 160))
    return folder


def programs(process, word):
    """Descendants whose command line has this word in it."""
    found = []
    for one in descendants(process):
        try:
            if word in Path(f"/proc/{one}/cmdline").read_bytes().decode().replace("\0", " "):
                found.append(one)
        except OSError:
            pass
    return found


def listening(processes):
    """Addresses at which these processes listen, as the kernel writes them."""
    wanted = set()
    for process in processes:
        for file in Path(f"/proc/{process}/fd").iterdir():
            try:
                if (target := os.readlink(file)).startswith("socket:["):
                    wanted.add(target[8:-1])
            except OSError:
                pass
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/net/{table}").read_text().splitlines()[1:]:
            words = line.split()
            # 0A: listening.
            if words[3] == "0A" and words[9] in wanted:
                found.add(words[1].partition(":")[0])
    return found


def test_a_local_cluster_is_heard_by_nobody_else_and_outlives_a_worker(film, tmp_path):
    out = tmp_path / "out"
    run = begin(RUN, film / "scene.toml", out)
    wait_for(lambda: out.is_dir() and len(contents(out, ".png")) >= 3, "three frames")
    before = inodes(out, ".png")
    addresses = listening([run.pid, *descendants(run.pid)])
    # 127.0.0.1 in the kernel's byte order; scheduler, nannies and workers listen.
    assert addresses == {"0100007F"}, addresses
    workers = programs(run.pid, "multiprocessing.spawn") or programs(run.pid, "spawn_main")
    assert len(workers) == 2
    kill(workers[0])
    words, errors = run.communicate(timeout=120)
    assert run.returncode == 0, errors
    assert f"{FRAMES} of {FRAMES} frames" in words
    after = inodes(out, ".png")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".png") == contents(film / "one", ".png")


def test_a_scheduler_that_is_killed_takes_nothing_along(film, tmp_path):
    out = tmp_path / "out"
    run = begin(RUN, film / "scene.toml", out)
    wait_for(lambda: out.is_dir() and len(contents(out, ".png")) >= 3, "three frames")
    (scheduler,) = programs(run.pid, "dask_scheduler")
    kill(scheduler)
    _, errors = run.communicate(timeout=120)
    assert run.returncode == 1 and "does not answer any more" in errors and f"of {FRAMES} frames are done and kept" in errors, errors
    before = inodes(out, ".png")
    assert 3 <= len(before) < FRAMES
    report = farm.film(film / "scene.toml", out, workers=2, size=(256, 160))
    assert (report.kept, report.done) == (len(before), FRAMES - len(before))
    after = inodes(out, ".png")
    assert {name: after[name] for name in before} == before
    assert contents(out, ".png") == contents(film / "one", ".png")


def test_a_cluster_by_its_address(film, tmp_path):
    from terrella.farm import _dask

    cluster = _dask.LocalCluster(2)
    try:
        with cluster.connect() as client:
            address = client.scheduler.address
            report = farm.film(film / "scene.toml", tmp_path / "a", address=address, size=(256, 160), frames=range(0, 6))
            assert report.done == 6 and report.bytes_moved > 0
            # The workers and their renderers stay.
            report = farm.sweep(film / "scene.toml", tmp_path / "b", 9, address=client, size=(32, 32), layers=["lit"], samples_a_shard=3)
            assert report.done == 9 and client.status == "running"
        farm.sweep(film / "scene.toml", tmp_path / "c", 9, workers=1, size=(32, 32), layers=["lit"], samples_a_shard=3)
        assert contents(tmp_path / "b", ".tar") == contents(tmp_path / "c", ".tar")
        one, six = contents(film / "one", ".png"), contents(tmp_path / "a", ".png")
        assert len(six) == 6 and all(one[name] == data for name, data in six.items())
    finally:
        cluster.close()


def test_no_cluster_is_said(film, tmp_path):
    with pytest.raises(farm.FarmError, match="no Dask scheduler at 'nonsense"):
        farm.film(film / "scene.toml", tmp_path / "out", address="nonsense://x")


def test_the_command_says_what_it_takes():
    reported = subprocess.run([sys.executable, "-m", "terrella.farm", "film", "--help"], capture_output=True, text=True, check=True).stdout
    assert "--address" in reported and "--overwrite" in reported
