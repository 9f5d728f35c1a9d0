"""docs/reference/python.md: everything that the package exports, with its signatures from the stubs and sources and its docstrings."""

import ast
import inspect
import os
from pathlib import Path

import pytest
import terrella
import terrella.farm
from conftest import ROOT

PAGE = ROOT / "docs/reference/python.md"
SOURCES = ROOT / "crates/terrella-py/python/terrella"
MODULES = [terrella, terrella.farm]
UPDATE = "TERRELLA_UPDATE_REFERENCE=1 cargo test -p terrella-py"
HEAD = f"""# Python

<!-- Made from the stubs, the sources and the docstrings in crates/terrella-py:
     {UPDATE} -->

All classes and functions of the modules `terrella` and `terrella.farm`. [embedding/python.md](../embedding/python.md) shows them at work, and
[farm.md](../farm.md) the workers. A `Time` is an `Epoch`, an ISO 8601 string, a `datetime` with a time zone, a `numpy.datetime64` (UTC) or a `Time` of astropy or skyfield; `Times`
are one or several. `Elapsed` is a `timedelta`, a `numpy.timedelta64` or seconds. `Vectors` are an array, a `Quantity` of astropy, or a `Distance` or
`Velocity` of skyfield. A `FrameName` is `"itrf"`, `"teme"`, `"gcrf"`, `"eme2000"` or `"pef"`.
"""
# Members that every exception inherits.
INHERITED = (Exception,)


def definitions():
    """The nodes of classes and functions by name, those of a subclass before those of its base."""
    found = {}
    for path in [*sorted(SOURCES.glob("*.py")), *sorted((SOURCES / "farm").glob("*.py")), SOURCES / "_native.pyi"]:
        for node in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(node, (ast.ClassDef, ast.FunctionDef)):
                found.setdefault(node.name, []).append(node)
    return found


def is_decorated(node, name):
    return any(isinstance(one, ast.Name) and one.id == name for one in node.decorator_list)


def signature(node, name):
    """As it is called: without `self`, and without the brackets of a property."""
    arguments = node.args
    first = [*arguments.posonlyargs, *arguments.args][:1]
    if first and first[0].arg in ("self", "cls"):
        (arguments.posonlyargs or arguments.args).pop(0)
    returns = f" -> {ast.unparse(node.returns)}" if node.returns and name == node.name else ""
    return name + returns if is_decorated(node, "property") else f"{name}({ast.unparse(arguments)}){returns}"


def paragraphs(words):
    """A docstring as paragraphs of Markdown; code in reST's double quotes becomes Markdown's."""
    words = inspect.cleandoc(words or "").partition(">>> ")[0].strip()
    return words.replace("``", "`")


def entry(heading, call, words):
    parts = [heading, f"```text\n{call}\n```", paragraphs(words)]
    return "\n\n".join(part for part in parts if part) + "\n"


def members(nodes):
    """Public methods, properties and fields of a class and its bases of the same name, each once."""
    seen = {}
    for node in nodes:
        for one in node.body:
            if isinstance(one, ast.FunctionDef) and not one.name.startswith("_"):
                seen.setdefault(one.name, one)
    return seen


def constructor(nodes, name):
    for node in nodes:
        fields = [one for one in node.body if isinstance(one, ast.AnnAssign)]
        for one in node.body:
            if isinstance(one, ast.FunctionDef) and one.name in ("__init__", "__new__"):
                return signature(one, name)
        if is_dataclass(node):
            given = (f"{ast.unparse(one.target)}: {ast.unparse(one.annotation)}" + (f" = {ast.unparse(one.value)}" if one.value else "") for one in fields)
            return f"{name}({', '.join(given)})"
    return f"class {name}"


def is_dataclass(node):
    return any("dataclass" in ast.unparse(one) for one in node.decorator_list)


def written():
    found, page = definitions(), [HEAD]
    for module in MODULES:
        page.append(f"## `{module.__name__}`\n")
        for name in (name for name in module.__all__ if not name.startswith("__")):
            nodes, value = found[name], getattr(module, name)
            if isinstance(nodes[0], ast.FunctionDef):
                page.append(entry(f"### `{name}`", signature(nodes[0], name), value.__doc__))
                continue
            call = f"class {name}({value.__base__.__name__})" if issubclass(value, INHERITED) else constructor(nodes, name)
            page.append(entry(f"### `{name}`", call, value.__doc__))
            for member, node in members(nodes).items():
                page.append(entry(f"#### `{name}.{member}`", signature(node, member), getattr(value, member).__doc__))
    return "\n".join(page)


def test_the_reference_page_is_that_of_the_package():
    page = written()
    if os.environ.get("TERRELLA_UPDATE_REFERENCE"):
        PAGE.parent.mkdir(exist_ok=True)
        PAGE.write_text(page, encoding="utf-8")
    committed = PAGE.read_text(encoding="utf-8") if PAGE.exists() else ""
    assert committed == page, f"docs/reference/python.md is not what the package says; run `{UPDATE}`"


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_everything_public_is_explained(module):
    """An entry without a docstring says nothing that its signature does not."""
    page = written()
    for name in (name for name in module.__all__ if not name.startswith("__")):
        section = page.partition(f"\n### `{name}`\n")[2].partition("\n#")[0]
        assert section.partition("```text\n")[2].partition("\n```")[2].strip(), f"{name} has no docstring"


def test_signatures_are_as_they_are_called():
    source = "class A:\n    @property\n    def p(self) -> int: ...\n    def m(self, a: int, *, b: str = 'c') -> None: ...\n    def __init__(self, x) -> None: ..."
    [node] = ast.parse(source).body
    assert [signature(one, one.name) for one in members([node]).values()] == ["p -> int", "m(a: int, *, b: str='c') -> None"]
    assert constructor([node], "A") == "A(x)"
    assert paragraphs("One ``two``.\n\n    >>> three") == "One `two`."
