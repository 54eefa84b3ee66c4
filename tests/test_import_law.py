from __future__ import annotations

import ast
import subprocess
import sys
import tomllib
from collections.abc import Iterator
from graphlib import TopologicalSorter
from pathlib import Path

import pytest

import vmesh

PACKAGE = Path(vmesh.__file__).parent
LAW = tomllib.loads((PACKAGE.parent / "pyproject.toml").read_text("utf-8"))["tool"]["importlinter"]
DOWNHILL = next(law for law in LAW["contracts"] if law["type"] == "layers")
EXCEPTIONS = {tuple(line.split(" -> ")) for line in DOWNHILL["ignore_imports"]}


def name_of(path: Path) -> str:
    """Full name of the module in a file."""
    parts = path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts).removesuffix(".__init__")


MODULES = {name_of(path): path for path in PACKAGE.rglob("*.py")}


def modules_after(statement: str) -> set[str]:
    """Modules that a fresh interpreter has loaded after a statement."""
    code = f"{statement}\nimport sys\nprint(*sys.modules)"
    result = subprocess.run(
        [sys.executable, "-c", code],
        capture_output=True,
        text=True,
        check=True,
        cwd=PACKAGE.parent,
    )
    return set(result.stdout.splitlines()[-1].split())


def test_importing_the_package_loads_nothing_heavy() -> None:
    loaded = modules_after("import vmesh")
    assert loaded.isdisjoint({"numpy", "numba", "scipy", "PIL", "cairocffi", "lxml"})


@pytest.mark.parametrize("name", ["Mesh", "Metadata", "Limits", "ColorLattice", "FormatError"])
def test_the_data_types_need_neither_numba_nor_pillow(name: str) -> None:
    assert modules_after(f"from vmesh import {name}").isdisjoint({"numba", "scipy", "PIL"})


def test_a_file_is_listed_without_numba_and_numpy() -> None:
    loaded = modules_after("import vmesh.codec.layout")
    assert loaded.isdisjoint({"numba", "numpy", "scipy", "PIL"})


@pytest.mark.parametrize("name", ["loads", "dumps", "load", "dump", "encode"])
def test_the_codec_and_the_encoder_need_no_pillow(name: str) -> None:
    assert modules_after(f"from vmesh import {name}").isdisjoint({"PIL", "cairocffi", "lxml"})


@pytest.mark.parametrize("name", vmesh.__all__)
def test_every_public_name_is_there(name: str) -> None:
    assert getattr(vmesh, name).__name__ == name
    assert name in dir(vmesh)


def test_another_name_is_not() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'missing'"):
        vmesh.missing  # noqa: B018


def nodes_of(path: Path) -> Iterator[ast.AST]:
    """All that a file does when it runs: without what is for type checkers only."""
    waiting: list[ast.AST] = [ast.parse(path.read_text("utf-8"))]
    while waiting:
        node = waiting.pop()
        yield node
        is_for_types = isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        waiting += () if is_for_types else ast.iter_child_nodes(node)


def imports_of(path: Path) -> set[str]:
    """Full names of the modules that a file imports anywhere, also those named by strings."""
    names = set()
    for node in nodes_of(path):
        match node:
            case ast.Import():
                names |= {alias.name for alias in node.names}
            case ast.ImportFrom():
                assert node.level == 0, f"{path.name} imports relatively"
                found = {f"{node.module}.{alias.name}" for alias in node.names}
                names |= {name if name in MODULES else f"{node.module}" for name in found}
            case ast.Call(func=ast.Name("import_module"), args=[ast.Constant(str(name)), *_]):
                names.add(name)
            case ast.Constant(str(name)) if "." in name and name in MODULES:  # of a table
                names.add(name)
    return names


def test_only_the_kernels_import_numba() -> None:
    for path in PACKAGE.rglob("*.py"):
        uses = any(name.split(".")[0] == "numba" for name in imports_of(path))
        assert not uses or path.parent.name == "kernels", path


def test_only_the_plots_of_a_report_import_matplotlib() -> None:
    uses = [
        path.relative_to(PACKAGE).as_posix()
        for path in PACKAGE.rglob("*.py")
        if any(name.split(".")[0] == "matplotlib" for name in imports_of(path))
    ]
    assert uses == ["report/plot.py"]


def test_matplotlib_waits_until_a_plot_is_drawn() -> None:
    assert "matplotlib" not in modules_after("import vmesh.cli.report, vmesh.report.page")


def test_an_import_by_a_constant_string_is_an_import(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text('def f():\n    import_module("numba").jit\n\nTABLE = {"x": "vmesh.errors"}\n')
    assert imports_of(path) == {"numba", "vmesh.errors"}


def test_an_import_for_type_checkers_is_none(tmp_path: Path) -> None:
    path = tmp_path / "module.py"
    path.write_text("if TYPE_CHECKING:\n    import numba\nimport numpy\n")
    assert imports_of(path) == {"numpy"}


def own_imports() -> dict[str, set[str]]:
    """The package's modules -> those of it that they import, but for the written exceptions."""
    return {
        name: {other for other in imports_of(path) if (name, other) not in EXCEPTIONS}
        & MODULES.keys()
        for name, path in MODULES.items()
    }


def test_no_module_imports_itself_by_way_of_others() -> None:
    # Raises a CycleError that tells the circle.
    assert set(TopologicalSorter(own_imports()).static_order()) == MODULES.keys()


def test_every_exception_is_an_import() -> None:
    assert all(other in imports_of(MODULES[name]) for name, other in EXCEPTIONS)


def test_imports_run_downhill_also_those_by_strings() -> None:
    layers = {
        part: number
        for number, layer in enumerate(DOWNHILL["layers"])
        for part in layer.split(" | ")
    }
    for name, others in own_imports().items():
        part = ".".join(name.split(".")[:2])
        for other in others - {"vmesh"}:  # whose names are those of all layers
            below = ".".join(other.split(".")[:2])
            is_downhill = layers[below] > layers.get(part, -1)
            assert is_downhill or below == part, f"{name} imports {other}"


def test_kernels_use_nothing_that_their_cache_does_not_notice() -> None:
    for path in (PACKAGE / "kernels").rglob("*.py"):
        own = {name for name in imports_of(path) if name.startswith("vmesh")}
        allowed = ("vmesh.arrays", "vmesh.errors", "vmesh.kernels")
        assert all(name.startswith(allowed) for name in own), path
