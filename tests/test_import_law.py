from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import vmesh

PACKAGE = Path(vmesh.__file__).parent


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


def imports_of(path: Path) -> set[str]:
    """Full names of the modules that a file imports anywhere."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text("utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{path.name} imports relatively"
            names |= {f"{node.module}", *(f"{node.module}.{alias.name}" for alias in node.names)}
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


@pytest.mark.parametrize("pattern", ["mesh/*.py", "color_lattice.py", "limits.py", "errors.py"])
def test_the_ground_floor_imports_no_floor_above(pattern: str) -> None:
    above = ("vmesh.kernels", "vmesh.codec", "vmesh.encoder", "vmesh.formats", "vmesh.cli")
    for path in PACKAGE.glob(pattern):
        assert not any(module.startswith(above) for module in imports_of(path)), path


def test_kernels_call_kernels_of_their_own_file_only() -> None:
    for path in (PACKAGE / "kernels").glob("*.py"):
        own = {name for name in imports_of(path) if name.startswith("vmesh")}
        assert all(
            name.startswith(("vmesh.arrays", "vmesh.errors", "vmesh.kernels.jit")) for name in own
        ), path
