"""The picture of equal bytes is small, stands in the README, and its program writes it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).parents[2]
PICTURE = ROOT / "docs" / "equal-bytes.webp"


def test_the_readme_shows_it() -> None:
    assert "](docs/equal-bytes.webp)" in (ROOT / "README.md").read_text("utf-8")
    assert PICTURE.stat().st_size <= 150_000


def test_its_program_writes_a_panel_for_each_format_in_no_more_bytes(tmp_path: Path) -> None:
    photograph, picture = tmp_path / "photograph.png", tmp_path / "picture.webp"
    with Image.open(ROOT / "tests" / "images" / "chelsea.png") as image:
        image.crop((100, 60, 260, 160)).save(photograph)
    command = [sys.executable, "-m", "tools.equal_bytes", "--photograph", str(photograph)]
    settings = ["--effort", "1", "--bits", "0.8", "--region", "0", "0", "90", "60"]
    done = subprocess.run(
        [*command, *settings, "--output", str(picture)],
        cwd=ROOT,
        check=True,
        capture_output=True,
        text=True,
    )
    labels = re.findall(r"^(\w+): ([\d,]+) bytes, \d+\.\d dB$", done.stdout, re.MULTILINE)
    assert [name for name, _ in labels] == ["vmesh", "WebP", "JPEG"]
    sizes = [int(n_bytes.replace(",", "")) for _, n_bytes in labels]
    assert sizes[0] == max(sizes)
    with Image.open(picture) as written:
        assert written.width == 3 * 90 + 2 * 8
        assert written.height > 60
