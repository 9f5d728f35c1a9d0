"""Programs in Python on the pages and in docstrings are whole, and run as they are printed: those of a page one after another in one folder, each
in a process of its own."""

import ast
import builtins
import doctest
import importlib.util
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
import terrella
from conftest import ROOT

# These programs need a viewer. The tests named here run them from the page too.
RUN_ELSEWHERE = {
    "docs/basilisk.md": "tests/command/basilisk/real.rs",
    "docs/live.md": "tests/command/live.rs",
}
# Files that a package's program reads and that we may not redistribute.
KERNELS = {"nyx_space": ["de405.bsp", "constants.pca"]}
# Packages that our modules need and that are not installed with them.
NEEDED_BY = {"terrella.notebook": "jupyter_rfb"}
# Java packages, importable after Orekit's import.
NOT_PYTHON = {"java", "org"}
WRITTEN = (".png", ".mp4", ".oem", ".csv")


def blocks(text, language):
    return re.findall(rf"```{language}\n(.*?)```", text, re.DOTALL)


def printed_programs():
    """Every program, as (where it is printed, its number there, its text)."""
    pages = [path for pattern in ["*.md", "docs/**/*.md", "crates/*/*.md", "config/*.md", "fuzz/*.md"] for path in sorted(ROOT.glob(pattern))]
    for path in pages:
        for number, program in enumerate(blocks(path.read_text(encoding="utf-8"), "python"), 1):
            yield path.relative_to(ROOT).as_posix(), number, program
    for path in sorted((ROOT / "crates/terrella-py/python").rglob("*.py")):
        words = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
        if examples := doctest.DocTestParser().get_examples(words):
            yield path.relative_to(ROOT).as_posix(), 1, "".join(example.source for example in examples)


PROGRAMS = list(printed_programs())
RUN_HERE = [program for program in PROGRAMS if program[0] not in RUN_ELSEWHERE]


def named(programs):
    return pytest.mark.parametrize("page, number, program", programs, ids=[f"{page}:{number}" for page, number, _ in programs])


def imported(program):
    """The packages that a program imports."""
    names = set()
    for node in ast.walk(ast.parse(program)):
        if isinstance(node, ast.Import):
            names |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            names.add(node.module.partition(".")[0])
            if node.module in NEEDED_BY:
                names.add(NEEDED_BY[node.module])
    return names


def unbound(program):
    """Names that a program reads and nowhere binds."""
    read, bound = set(), set(dir(builtins))
    for node in ast.walk(ast.parse(program)):
        if isinstance(node, ast.Name):
            (read if isinstance(node.ctx, ast.Load) else bound).add(node.id)
        elif isinstance(node, (ast.Import, ast.ImportFrom)):
            bound |= {alias.asname or alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, (ast.FunctionDef, ast.ClassDef)):
            bound.add(node.name)
        elif isinstance(node, ast.arg):
            bound.add(node.arg)
    return read - bound


def lacking(program):
    """What the program needs and this machine does not have."""
    for name in sorted(imported(program) - NOT_PYTHON):
        if importlib.util.find_spec(name) is None:
            return f"{name} is not installed"
        if files := KERNELS.get(name):
            return f"the kernels {' and '.join(files)} are not here"
    if "_dataset(" in program and importlib.util.find_spec("xarray") is None:
        return "xarray is not installed"
    if ("Film(" in program or "video=" in program) and shutil.which("ffmpeg") is None:
        return "ffmpeg is not installed"
    return None


@pytest.fixture(scope="session")
def folder_of(tmp_path_factory):
    """The folder of a page, as the repository's looks to its programs."""
    folders = {}

    def folder(page):
        if page not in folders:
            folders[page] = tmp_path_factory.mktemp("page")
            (folders[page] / "config").symlink_to(ROOT / "config")
            if page == "docs/embedding/files.md":
                [script] = blocks((ROOT / page).read_text(encoding="utf-8"), "text")
                (folders[page] / "fly.script").write_text(script, encoding="utf-8")
        return folders[page]

    return folder


def test_programs_are_found():
    pages = {page for page, _, _ in PROGRAMS}
    assert {"docs/embedding/python.md", "docs/embedding/files.md", "docs/farm.md", "crates/terrella-py/README.md", *RUN_ELSEWHERE} <= pages
    assert sum(page.endswith(".py") for page in pages) >= 3, pages
    for page, test in RUN_ELSEWHERE.items():
        assert page in (ROOT / test).read_text(encoding="utf-8"), f"{test} does not run {page}"


def test_a_line_without_its_import_is_noticed():
    assert unbound("import sys\nscene = terrella.Scene(sys.argv[1])\nfor time in scene.times()[:frames]:\n    print(time)") == {"terrella", "frames"}
    assert unbound("from a.b import c as d\nwith d() as e:\n    print([f(e) for f in d])") == set()


@named(PROGRAMS)
def test_each_program_is_whole(page, number, program):
    assert unbound(program) == set(), f"{page}: nothing gives these names"
    assert "sys.argv" not in program, f"{page}: it waits for arguments that nobody gives"


@named(RUN_HERE)
def test_each_program_runs(page, number, program, folder_of):
    if lack := lacking(program):
        pytest.skip(f"{page}, program {number}: {lack}")
    folder = folder_of(page)
    ran = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True)
    assert ran.returncode == 0, f"{page}, program {number}:\n{program}\n{ran.stdout}{ran.stderr}"
    strings = (node.value for node in ast.walk(ast.parse(program)) if isinstance(node, ast.Constant) and isinstance(node.value, str))
    for name in (name for name in strings if name.endswith(WRITTEN)):
        assert (folder / name).stat().st_size > 1000, f"{page}, program {number}: {name}"
    if "print(" in program:
        assert ran.stdout.strip(), f"{page}, program {number} prints nothing"
    # Files from other programs that Terrella can fly, according to this page.
    for flown in [*folder.glob("*.oem"), *folder.glob("*.csv")]:
        [(first, last)] = terrella.Ephemerides(flown).validity
        assert last - first == pytest.approx(5400.0, abs=1e-3), flown.name


def test_a_text_block_is_no_program():
    assert blocks("```python\na\n```\n```text\nb\n```\n```python\nc\nd\n```", "python") == ["a\n", "c\nd\n"]
