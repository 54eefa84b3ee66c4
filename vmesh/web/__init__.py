"""The second decoder and the viewer, in JavaScript: modules, and the scripts built of them."""

from importlib.resources import files
from importlib.resources.abc import Traversable
from typing import Final

WEB: Final[Traversable] = files(__name__)


def built_script(name: str) -> str:
    """A script of `dist`, which pages run as it is."""
    return (WEB / "dist" / f"{name}.js").read_text("utf-8")
