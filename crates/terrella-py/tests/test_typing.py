"""Type checkers see what the package is: right programs pass, and each mistake is named."""

import json
import re
import subprocess
import sys
from pathlib import Path

import pytest
import terrella

TYPED = Path(__file__).parent / "typed"
PACKAGE = Path(terrella.__file__).parent.parent
MISTAKES = {number for number, line in enumerate((TYPED / "wrong.py").read_text().splitlines(), 1) if "# mistake" in line}


def lines_named(output):
    return {int(number) for number in re.findall(r"wrong\.py:(\d+)", output)}


def test_there_are_eleven_mistakes():
    assert len(MISTAKES) == 11


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    """A configuration whose cache both of mypy's programs use."""
    pytest.importorskip("mypy", reason="mypy is not installed")
    folder = tmp_path_factory.mktemp("mypy")
    config = folder / "mypy.ini"
    config.write_text(f"[mypy]\nstrict = true\nmypy_path = {PACKAGE}\nfollow_imports = silent\ncache_dir = {folder / 'cache'}\n")
    return config


def test_mypy_sees_them_all(config):
    from mypy import api

    found, errors, _ = api.run(["--config-file", str(config), str(TYPED / "right.py"), str(TYPED / "wrong.py")])
    assert not errors and "right.py" not in found, f"{found}{errors}"
    assert lines_named(found) == MISTAKES, found


def test_the_stubs_are_exact(config, tmp_path):
    allowed = tmp_path / "allowed"
    # Compiled modules have it; it lists every name.
    allowed.write_text(r"terrella\._native\.__all__")
    options = ["--ignore-disjoint-bases", "--allowlist", str(allowed), "--mypy-config-file", str(config)]
    ran = subprocess.run([sys.executable, "-m", "mypy.stubtest", "terrella._native", *options], cwd=tmp_path, capture_output=True, text=True)
    assert ran.returncode == 0, ran.stdout + ran.stderr


def test_pyright_sees_them_all(tmp_path):
    pytest.importorskip("basedpyright", reason="basedpyright is not installed")
    config = tmp_path / "pyrightconfig.json"
    config.write_text(json.dumps({"include": [str(TYPED)], "typeCheckingMode": "standard", "extraPaths": [str(PACKAGE)]}))
    ran = subprocess.run([sys.executable, "-m", "basedpyright", "--level", "error", "--pythonpath", sys.executable, "-p", str(config)], capture_output=True, text=True)
    assert "right.py" not in ran.stdout and lines_named(ran.stdout) == MISTAKES, ran.stdout + ran.stderr
