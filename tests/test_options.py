"""Options by their names: a misspelt one is an error when it is checked and when it is called.

mypy reads these tests too. Each ``type: ignore`` stands where it has to object: it complains of one
that is of no use.
"""

from __future__ import annotations

import inspect
from dataclasses import fields
from pathlib import Path
from typing import get_type_hints

import numpy as np
import pytest

import vmesh
from tests.pictures import PICTURES
from vmesh.formats.registry import FORMATS, write_mesh

SETTINGS = [field.name for field in fields(vmesh.Settings)]


@pytest.fixture(scope="module")
def mesh() -> vmesh.Mesh:
    return vmesh.encode(PICTURES["disc"], vertices=20, effort=1)


def test_a_misspelt_setting_is_refused_by_its_name() -> None:
    with pytest.raises(TypeError, match="qualty"):
        vmesh.encode(PICTURES["disc"], qualty=50)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="qualty"):
        vmesh.study(PICTURES["disc"], qualty=50)  # type: ignore[call-arg]
    with pytest.raises(TypeError, match="qualty"):
        vmesh.Settings().with_goal(qualty=50)  # type: ignore[call-arg]


def test_a_setting_that_is_none_of_the_choices_is_refused() -> None:
    with pytest.raises(ValueError, match="method"):
        vmesh.encode(PICTURES["disc"], method="red-noise")  # type: ignore[arg-type]


@pytest.mark.parametrize("function", [vmesh.encode, vmesh.study])
def test_the_settings_are_keywords_with_the_same_defaults_and_types(function: object) -> None:
    assert callable(function)
    keywords, own = inspect.signature(function).parameters, inspect.signature(vmesh.Settings)
    assert [name for name in keywords if name in SETTINGS] == SETTINGS
    for name, parameter in own.parameters.items():
        assert keywords[name].kind is inspect.Parameter.KEYWORD_ONLY
        assert keywords[name].default == parameter.default
        assert get_type_hints(function)[name] == get_type_hints(vmesh.Settings)[name]


def test_every_setting_is_described_where_it_is_a_keyword() -> None:
    text = inspect.getdoc(vmesh.encode)
    assert text is not None
    assert all(f"\n{name} : " in text for name in SETTINGS)


def test_a_field_that_a_mesh_does_not_have_cannot_be_replaced(mesh: vmesh.Mesh) -> None:
    with pytest.raises(TypeError, match="verticies"):
        mesh.replaced(verticies=mesh.vertices)  # type: ignore[call-arg]
    assert mesh.replaced(vertices=mesh.vertices, tile=None) == mesh


@pytest.mark.parametrize("suffix", FORMATS)
def test_a_misspelt_option_of_a_format_is_refused_by_its_name(
    mesh: vmesh.Mesh, tmp_path: Path, suffix: str
) -> None:
    name = FORMATS[suffix].name
    with pytest.raises(TypeError, match=f"^{name} has no option 'tolerence': expected "):
        vmesh.export(mesh, tmp_path / f"a{suffix}", tolerence=2.0)  # type: ignore[call-arg]
    assert not list(tmp_path.iterdir())


def test_an_option_of_another_format_is_refused_with_those_that_there_are(
    mesh: vmesh.Mesh, tmp_path: Path
) -> None:
    known = "one of mode, backend, page_width, page_size, orientation, margin"
    with pytest.raises(TypeError, match=f"^PDF has no option 'tolerance': expected {known}$"):
        vmesh.export(mesh, tmp_path / "a.pdf", tolerance=2.0)
    known = "one of scale, width, height, transform, supersample"
    with pytest.raises(TypeError, match=f"^PNG has no option 'mode': expected {known}$"):
        vmesh.export(mesh, tmp_path / "a.png", mode="flat")
    with pytest.raises(TypeError, match=r"^OBJ has no option 'ascii': expected none$"):
        vmesh.export(mesh, tmp_path / "a.obj", ascii=True)


def test_the_options_of_a_format_are_taken(mesh: vmesh.Mesh, tmp_path: Path) -> None:
    vmesh.export(mesh, tmp_path / "a.png", scale=0.5, supersample=2)
    vmesh.export(mesh, tmp_path / "a.png", width=9, limits=vmesh.Limits())
    vmesh.export(mesh, tmp_path / "a.svg", mode="auto", tolerance=8, width="210mm")
    vmesh.export(mesh, tmp_path / "a.svgz", fit=np.asarray(PICTURES["disc"]), progress=print)
    vmesh.export(mesh, tmp_path / "a.pdf", page_width="210mm", backend="native")
    with (tmp_path / "b.svg").open("wb") as stream:
        write_mesh(mesh, stream, FORMATS[".svg"], seams="trapping", merge=10)
