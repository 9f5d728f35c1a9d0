"""Examples run."""

import os
import re
import shutil
import subprocess
import sys

import pytest


def run(root, folder, *arguments):
    return subprocess.run([sys.executable, root / "crates/terrella-py/examples" / arguments[0], *arguments[1:]],
                          cwd=folder, capture_output=True, text=True, check=True, env=os.environ).stdout


def test_the_earth(root, tmp_path):
    reported = run(root, tmp_path, "earth.py")
    found = re.fullmatch(r"brightest \d\.\d\d, (\d+)% of the ground in view is lit\n", reported)
    assert found and 60 < int(found[1]) < 95, reported
    assert (tmp_path / "earth.png").stat().st_size > 50_000


def test_a_catalogue(root, tmp_path):
    reported = run(root, tmp_path, "catalogue.py", root / "config/orbits/iss.tle")
    assert "km high" in reported and "51." in reported, reported


def test_motions(root, tmp_path):
    reported = run(root, tmp_path, "motions.py")
    assert re.fullmatch(r"\d+ km after a day, \d{3,4} steps\n", reported), reported


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_film(root, tmp_path):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    run(root, tmp_path, "film.py", root / "config/iss.toml", "iss.mp4", "3")
    assert (tmp_path / "iss.mp4").stat().st_size > 1000


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_film_on_two_workers(root, tmp_path):
    reported = run(root, tmp_path, "farm_film.py", root / "config/iss.toml", "frames", "iss.mp4", "4")
    assert "4 of 4 frames: 4 drawn" in reported and "iss.mp4: put together" in reported, reported
    assert (tmp_path / "iss.mp4").stat().st_size > 1000 and len(list((tmp_path / "frames").glob("*.png"))) == 4


def test_a_labelled_data_set(root, tmp_path):
    reported = run(root, tmp_path, "farm_sweep.py", root / "config/full_disc.toml", "swept", "70")
    assert "70 of 70 samples: 70 drawn" in reported, reported
    assert sorted(path.name for path in (tmp_path / "swept").iterdir()) == ["README.md", "manifest.json", "shard-000000.tar", "shard-000001.tar"]
    pytest.importorskip("torch", reason="torch is not installed")
    pytest.importorskip("PIL", reason="Pillow is not installed")
    read = run(root, tmp_path, "pytorch_loader.py", "swept")
    assert read.count("range_m (4, 256, 256)") == 17 and "(4, 3, 256, 256)" in read, read
