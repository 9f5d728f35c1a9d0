"""Examples run, and the page shows lines of them alone."""

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
    told = run(root, tmp_path, "earth.py")
    assert re.fullmatch(r"brightest \d\.\d\d, \d+% of the ground in view is lit\n", told), told
    assert (tmp_path / "earth.png").stat().st_size > 50_000


def test_a_catalogue(root, tmp_path):
    told = run(root, tmp_path, "catalogue.py", root / "config/orbits/iss.tle")
    assert "km high" in told and "51." in told, told


def test_motions(root, tmp_path):
    told = run(root, tmp_path, "motions.py")
    assert re.fullmatch(r"\d+ km after a day, \d{3,4} steps\n", told), told


@pytest.mark.skipif(shutil.which("ffmpeg") is None, reason="ffmpeg is not installed")
def test_a_film(root, tmp_path):
    pytest.importorskip("tqdm", reason="tqdm is not installed")
    run(root, tmp_path, "film.py", root / "config/iss.toml", "iss.mp4", "3")
    assert (tmp_path / "iss.mp4").stat().st_size > 1000


def test_the_page_shows_what_runs(root):
    """Each line of Python on the page is one of an example, of a docstring or of the widget's own words."""
    page = (root / "docs/embedding/python.md").read_text(encoding="utf-8")
    folder = root / "crates/terrella-py"
    sources = [path.read_text(encoding="utf-8") for path in [*folder.glob("examples/*.py"), *folder.glob("python/terrella/*.py")]]
    known = {line.strip().removeprefix(">>> ").removeprefix("... ").strip() for text in sources for line in text.splitlines()}
    blocks = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    assert blocks
    unknown = [line for block in blocks for line in block.splitlines() if line.strip() not in known]
    assert unknown == []
