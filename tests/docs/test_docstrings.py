"""The summary of every docstring names its noun, so that it can be read by itself."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import pytest

ROOT: Final = Path(__file__).parents[2]
FOLDERS: Final = ("vmesh", "tools", "benchmarks")

# Words that point at something else, or ask: a summary that opens with one of them says what it is
# about only to those who read what stands around it.
_OPENINGS: Final = (
    *("that", "this", "these", "those", "such", "it", "its", "they", "their", "them", "he", "she"),
    *("what", "whatever", "which", "whichever", "who", "whoever", "whose"),
    *("whether", "if", "how", "about how", "why", "when", "whenever", "where", "wherever", "as"),
    *("everything", "something", "anything", "nothing", "most", "others", "another"),
    *("both", "either", "neither"),
    *("all that", "the same", "the one", "the ones", "the other", "the others", "one that", "ones"),
    *("of", "in", "between"),
)
_LEANING: Final = re.compile(rf"(?:{'|'.join(_OPENINGS)})\b", re.IGNORECASE)


def summaries(root: Path) -> Iterator[tuple[str, str]]:
    """Place, as file:line, and summary of each docstring below some folders."""
    for path in sorted(path for folder in FOLDERS for path in (root / folder).rglob("*.py")):
        for node in ast.walk(ast.parse(path.read_text("utf-8"))):
            if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
                docstring = ast.get_docstring(node)
                if docstring:
                    summary = " ".join(docstring.split("\n\n")[0].split())
                    yield f"{path.relative_to(root).as_posix()}:{node.body[0].lineno}", summary


def leaning_summaries(root: Path) -> list[str]:
    """Place and summary of the docstrings that cannot be read by themselves."""
    return [f"{place}: {text}" for place, text in summaries(root) if _LEANING.match(text)]


def test_every_summary_can_be_read_by_itself() -> None:
    found = leaning_summaries(ROOT)
    assert not found, "a summary opens with its noun (or a verb), not so:\n" + "\n".join(found)


@pytest.mark.parametrize(
    "summary", ["Those of some regions.", "Whether files hold pixels.", "Of it."]
)
def test_a_summary_that_leans_on_its_context_is_found(tmp_path: Path, summary: str) -> None:
    (tmp_path / "vmesh").mkdir()
    (tmp_path / "vmesh" / "regions.py").write_text(f'def take() -> None:\n    """{summary}"""\n')
    assert leaning_summaries(tmp_path) == [f"vmesh/regions.py:2: {summary}"]


@pytest.mark.parametrize(
    "summary", ["Moments of some regions.", "True if files hold pixels.", "Theses."]
)
def test_a_summary_that_names_its_noun_passes(tmp_path: Path, summary: str) -> None:
    (tmp_path / "vmesh").mkdir()
    (tmp_path / "vmesh" / "regions.py").write_text(f'def take() -> None:\n    """{summary}"""\n')
    assert leaning_summaries(tmp_path) == []
