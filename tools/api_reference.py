"""docs/api.md: the reference of the public names, made of their docstrings.

::

    python -m tools.api_reference            write it
    python -m tools.api_reference --check    status 1 if it is not what the docstrings say
"""

from __future__ import annotations

import ast
import inspect
import re
import textwrap
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import click

import vmesh
from tools.made_document import keep

TARGET: Final = Path(__file__).parents[1] / "docs" / "api.md"

CHAPTERS: Final = {
    "Pixels, meshes, files": ("encode", "Settings", "render", "load", "loads", "dump", "dumps"),
    "The mesh": ("Mesh", "Metadata", "ColorLattice"),
    "Other formats and programs": (
        "export",
        "export_album",
        "data_uri",
        "import_mesh",
        "paint_mesh",
        "register",
    ),
    "Reports": ("study", "Study"),
    "Limits and errors": (
        *("Limits", "VmeshError", "FormatError", "LimitError", "ImageError", "MeshError"),
        "PartialFileWarning",
    ),
}
HEAD: Final = """# Reference

The public names of `vmesh`, from their docstrings by `tools/api_reference.py`. The
[tutorial](tutorial.md) shows them at work.
"""

_LONGEST_LINE: Final = 88
_SECTION: Final = re.compile(r"^(\w[\w ]*)\n-{3,}\n", re.MULTILINE)
_ROLE: Final = re.compile(r":\w+:`~?([^`]*)`")


@click.command()
@click.option("--check", is_flag=True, help="Write nothing; status 1 if the file is out of date.")
def main(check: bool) -> None:
    """Write docs/api.md."""
    keep(TARGET, reference(), "python -m tools.api_reference", check=check)


def reference() -> str:
    """The whole document."""
    chapters = [
        "\n".join([f"## {title}\n", *(_entry(name) for name in names)])
        for title, names in CHAPTERS.items()
    ]
    return "\n".join([HEAD, *chapters])


def _entry(name: str) -> str:
    """A public name: how it is called, what it does, and the members of a class."""
    value = getattr(vmesh, name)
    parts = [f"### {name}\n", _call(f"vmesh.{name}", value), _markdown(value)]
    if inspect.isclass(value):
        parts += [
            f"#### {name}.{member}\n\n{_call(f'{name}.{member}', function)}\n{_markdown(function)}"
            for member, function in _members(value)
        ]
    return "\n".join(part for part in parts if part)


def _members(value: type) -> Iterator[tuple[str, Any]]:
    """Public methods and properties of a class, in the order of its source."""
    for name, member in vars(value).items():
        function = getattr(member, "__func__", member)
        if not name.startswith("_") and (inspect.isfunction(function) or _is_property(member)):
            yield name, member


def _is_property(member: object) -> bool:
    return isinstance(member, property)


def _call(name: str, value: Any) -> str:
    """Block of code that shows how a name is used; nothing for an exception."""
    if inspect.isclass(value):
        if issubclass(value, BaseException):
            return ""
        fields = ", ".join(map(_field, inspect.signature(value).parameters.values()))
        return _block(name, ast.parse(f"def f({fields}): ...").body[0], is_bound=False)
    function = value.fget if _is_property(value) else getattr(value, "__func__", value)
    definition = ast.parse(textwrap.dedent(inspect.getsource(function))).body[0]
    return _block(name, definition, is_property=_is_property(value))


def _field(parameter: inspect.Parameter) -> str:
    """A parameter without its type, which is told below, and with its default."""
    if parameter.default is inspect.Parameter.empty:
        return parameter.name
    is_made = repr(parameter.default).startswith("<")  # anew for each object
    return f"{parameter.name}={'...' if is_made else repr(parameter.default)}"


def _block(
    name: str, definition: ast.AST, *, is_bound: bool = True, is_property: bool = False
) -> str:
    """A definition as a block of code, without its `self`, in lines that are not too long."""
    assert isinstance(definition, ast.FunctionDef)
    arguments = definition.args
    if is_bound and arguments.args and arguments.args[0].arg in ("self", "cls"):
        del arguments.args[0]
    result = f" -> {ast.unparse(definition.returns)}" if definition.returns else ""
    # Spaces and quotes as ruff has them, which formats code in Markdown too.
    inner = re.sub(r"(: [^=,]*)=", r"\1 = ", ast.unparse(arguments)).replace("'", '"')
    line = f"{name}{'' if is_property else f'({inner})'}{result}"
    if len(line) > _LONGEST_LINE:
        inner = re.sub(r", (?![^\[(]*[\])])", ",\n    ", inner)
        line = f"{name}(\n    {inner},\n){result}"
    return f"```py\n{line}\n```\n"


def _markdown(value: object) -> str:
    """A docstring in the manner of numpydoc as Markdown."""
    first, *sections = _SECTION.split(inspect.getdoc(value) or "")
    parts = [_inline(first.strip()) + "\n"]
    for title, body in zip(sections[::2], sections[1::2], strict=True):
        parts.append(f"**{title}**\n\n" + "".join(_items(body)))
    return "\n".join(parts)


def _items(body: str) -> Iterator[str]:
    """Terms of a section and what is said of them, as a list."""
    for item in re.split(r"\n(?=\S)", body.strip()):
        term, _, text = item.partition("\n")
        name, separator, kind = term.partition(" : ")
        text = _inline(" ".join(textwrap.dedent(text).split()))
        kind = f" ({_inline(kind)})" if separator else ""
        yield f"- `{name}`{kind}{': ' if text else ''}{text}\n"


def _inline(text: str) -> str:
    """Marks of reStructuredText as those of Markdown, outside of code."""
    text = _ROLE.sub(r"`\1`", text).replace("``", "`")
    pieces = text.split("`")
    pieces[::2] = [re.sub(r"([*_<])", r"\\\1", piece) for piece in pieces[::2]]
    return "`".join(pieces)


if __name__ == "__main__":
    main()
