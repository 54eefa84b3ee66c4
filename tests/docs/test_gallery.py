"""The gallery is small, leads where it says, and its program writes it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[2]
GALLERY = (ROOT / "docs" / "gallery.md").read_text("utf-8")


def pictures_of(document: str) -> list[str]:
    return re.findall(r"!\[[^]]*\]\(([^)]*)\)", document)


def test_its_pictures_are_there_and_small() -> None:
    shown = [ROOT / "docs" / name for name in pictures_of(GALLERY)]
    assert sorted(shown) == sorted((ROOT / "docs" / "gallery").iterdir())
    assert all(path.stat().st_size <= 40_000 for path in shown)
    assert sum(path.stat().st_size for path in shown) <= 300_000


def test_every_picture_has_a_licence_and_figures() -> None:
    sections = GALLERY.split("\n## ")[1:]
    assert len(sections) == 6
    for section in sections:
        assert re.search(r"; (CC0|public\sdomain)\.", section), section
        cells = re.findall(r"^\| (\d.*) \|$", section, re.MULTILINE)[0].split(" | ")
        width, height = map(int, cells[0].split(" x "))
        n_bytes = int(cells[1].replace(",", ""))
        assert f"{8 * n_bytes / (width * height):.3f}" == cells[2]
        assert float(cells[2]) <= 0.2


def test_its_program_writes_it(tmp_path: Path) -> None:
    photos = tmp_path / "photos"
    photos.mkdir()
    for name in ("chelsea", "unknown"):
        with Image.open(ROOT / "tests" / "images" / "chelsea.png") as image:
            image.crop((100, 60, 260, 160)).save(photos / f"{name}.png")
    target = tmp_path / "gallery.md"
    command = [sys.executable, "-m", "tools.gallery", "--images", str(photos), "--effort", "1"]
    subprocess.run([*command, "--output", str(target)], cwd=ROOT, check=True, capture_output=True)
    assert pictures_of(target.read_text("utf-8")) == ["gallery/chelsea.webp"]
    with Image.open(tmp_path / "gallery" / "chelsea.webp") as image:
        assert image.size == (2 * 160 + 8, 100)
    assert "| 160 x 100 |" in target.read_text("utf-8")
