"""JavaScript modules -> one script.

The modules are ours and plain: named imports from files beside them, named exports, nothing else.
For these a bundler of the JavaScript world, and Node to run it, would be a large tool for a few
lines. Each module becomes a function that gives its exports, so that names cannot clash; whatever
is written in another way is refused and not guessed at.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from importlib.resources import files
from importlib.resources.abc import Traversable
from posixpath import dirname, join, normpath
from typing import Final

WEB: Final[Traversable] = files("vmesh.web")

_IMPORT: Final = re.compile(r'^import \{ (\w+(?:, \w+)*) \} from "([./\w]+)";\n', re.MULTILINE)
_EXPORTED: Final = re.compile(r"^export (?=(?:class|const|function\*?) (\w+))", re.MULTILINE)
_PASSED_ON: Final = re.compile(r"^export \{ (\w+(?:, \w+)*) \};\n", re.MULTILINE)
_LEFT: Final = re.compile(r"^\s*(?:import|export)\b.*", re.MULTILINE)
_END_OF_SCRIPT: Final = re.compile(r"</script|<!--", re.IGNORECASE)


def bundle(entry: str) -> str:
    """One script that holds a module of `vmesh/web` and all that it imports.

    Raises
    ------
    ValueError
        If a module is written in a way that is not provided for.
    """
    order = list(_in_order(entry, set()))
    names = {path: f"module{i}" for i, path in enumerate(order)}
    parts = [_as_function(path, names) for path in order]
    script = "(() => {\n" + "\n".join(parts) + "})();\n"
    if _END_OF_SCRIPT.search(script):
        raise ValueError(f"{entry}: the script would end its element in a page")
    return script


def _in_order(path: str, seen: set[str]) -> Iterator[str]:
    """A module after all that it imports, each of them once."""
    seen.add(path)
    for _, source in _IMPORT.findall(_text(path)):
        other = _resolved(path, source)
        if other not in seen:
            yield from _in_order(other, seen)
    yield path


def _as_function(path: str, names: dict[str, str]) -> str:
    """A module as a constant: the object of its exports."""
    text = _text(path)
    exported: list[str] = _EXPORTED.findall(text)
    exported += [name for group in _PASSED_ON.findall(text) for name in group.split(", ")]
    body = _IMPORT.sub(
        lambda found: f"const {{ {found[1]} }} = {names[_resolved(path, found[2])]};\n", text
    )
    body = _PASSED_ON.sub("", _EXPORTED.sub("", body))
    if left := _LEFT.search(body):
        raise ValueError(f"{path}: expected named imports and exports, got {left[0].strip()!r}")
    returned = f"return {{ {', '.join(exported)} }};\n" if exported else ""
    return f"// {path}\nconst {names[path]} = (() => {{\n{body}{returned}}})();\n"


def _resolved(path: str, source: str) -> str:
    """Path of a module that another one imports."""
    return normpath(join(dirname(path), source))


def _text(path: str) -> str:
    return (WEB / path).read_text("utf-8")
