"""Every benchmark runs on tiny pictures and prints well-formed tables."""

from __future__ import annotations

import csv
import subprocess
import sys
from pathlib import Path

import pytest

from benchmarks.file_format.__main__ import main as file_format
from benchmarks.paper.__main__ import main as paper
from benchmarks.rate_distortion.__main__ import main as rate_distortion
from benchmarks.speed.__main__ import main as speed
from benchmarks.vector_output.__main__ import main as vector_output
from tests.benchmarks.printed import run

ROOT = Path(__file__).parents[2]
QUICK = ("--effort", "1")


@pytest.mark.parametrize(
    "name", ["document", "file_format", "paper", "rate_distortion", "speed", "vector_output"]
)
def test_every_benchmark_says_how_it_is_run(name: str) -> None:
    command = [sys.executable, "-m", f"benchmarks.{name}", "--help"]
    printed = subprocess.run(command, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    assert printed.startswith(f"Usage: python -m benchmarks.{name} [OPTIONS]")


def test_the_paper_is_compared_in_points_quality_bits_and_speed(folder: str) -> None:
    options = ("--images", folder, *QUICK, "--each", "--vertices", "100", "--repeat", "1")
    points, quality, each, adaptive, bits, stages = run(paper, *options)
    assert [row[:2] for row in points.rows[-2:]] == [["mean", "multiclass"], ["mean", "channels"]]
    assert "mean of 2 pictures" in quality.title
    assert len(each.rows) == 2 * 2 * 2
    assert [row[1] for row in adaptive.rows[-2:]] == ["blue-noise", "adaptive, effort 1"]
    assert [row[0] for row in bits.rows] == ["chelsea", "coffee", "mean", "paper"]
    assert "72 x 48 pixels of chelsea" in stages.title


def test_the_paper_is_compared_by_means_alone_unless_each_picture_is_asked_for(folder: str) -> None:
    options = ("--images", folder, "--limit", "1", "--part", "points", "--part", "bits")
    points, bits = run(paper, *options)
    assert {row[0] for row in points.rows} == {"mean"}
    assert [row[0] for row in bits.rows] == ["mean", "paper"]


def test_the_file_format_is_measured_by_parts_beside_other_ways_and_in_tiles(folder: str) -> None:
    options = ("--images", folder, *QUICK, "--repeat", "1", "--tile", "32")
    parts, triangles, whole, speeds, tiles = run(file_format, *options)
    for row in parts.rows:
        *of_parts, of_file = map(float, row[1:-1])
        assert sum(of_parts) == pytest.approx(of_file, abs=0.05)
    assert [row[0] for row in triangles.rows] == ["flips, as the file has them", "a list"]
    assert whole.rows[0][0] == "vmesh"
    assert [row[0] for row in speeds.rows[:2]] == ["vmesh, writing", "vmesh, reading"]
    assert {row[0] for row in tiles.rows} == {"chelsea", "coffee"}


def test_speed_is_measured_of_rasters_the_library_and_processes(folder: str) -> None:
    parts = ("--part", "raster", "--part", "library", "--part", "starts", "--part", "memory")
    sizes = ("--vertices", "40", "--size", "64", "48", "--large", "96", "64")
    raster, more, library, starts, memory = run(
        speed, "--images", folder, *parts, *sizes, "--repeat", "1"
    )
    assert "40 vertices of chelsea, drawn at 64 x 48" in raster.title
    assert "chelsea enlarged 4 times" in more.title
    assert {"dumps", "loads", "render", "to PDF"} <= {row[0] for row in library.rows}
    assert "`vmesh --help`" in {row[0] for row in starts.rows}
    assert [row[0] for row in memory.rows] == ["72 x 48", "96 x 64"]


def test_vector_output_is_measured_by_mode_and_renderer_and_beside_tracings(folder: str) -> None:
    renderers = ("--renderer", "resvg", "--renderer", "mupdf")
    options = ("--images", folder, "--limit", "1", "--vertices", "40", *renderers)
    modes, documents = run(vector_output, *options)
    assert {(row[0][:3], row[1]) for row in modes.rows} == {("SVG", "resvg"), ("PDF", "mupdf")}
    assert "vmesh, 40 vertices, gradient" in {row[0] for row in documents.rows}


def test_codecs_are_compared_at_rates_and_at_the_quality_of_the_paper(
    folder: str, tmp_path: Path
) -> None:
    table = tmp_path / "rows.csv"
    options = ("--images", folder, *QUICK, "--rates", "0.5,1", "--csv", str(table))
    tables = run(rate_distortion, *options, "--part", "rates")
    rgb, *_, paper_coding = tables
    assert "PSNR (RGB), dB: mean of 2 pictures" in rgb.title
    assert rgb.header == ["codec", "0.50 bpp", "1.00 bpp"]
    assert [row[0] for row in rgb.rows[:2]] == ["vmesh", "JPEG 2000"]
    assert len(paper_coding.rows) == 2 * 2 + 2
    with table.open(newline="") as stream:
        rows = list(csv.DictReader(stream))
    assert all(int(row["n_bytes"]) <= int(row["budget"]) for row in rows if row["part"] == "rates")


def test_codecs_are_compared_in_thumbnails_enlargements_and_drawings(folder: str) -> None:
    parts = ("--part", "thumbnails", "--part", "upscaling", "--part", "pictures")
    options = ("--images", folder, "--limit", "1", "--reduce", "2", *QUICK)
    tables = run(rate_distortion, *options, *parts)
    titles = [table.title for table in tables]
    assert titles.index("Bytes of lossless files") == len(titles) - 1
    assert any(title.startswith("800 bytes") for title in titles)
    assert any("enlarged 2 times" in title for title in titles)


def test_seconds_and_memory_are_measured_by_effort_and_by_size(folder: str) -> None:
    options = ("--images", folder, *QUICK, "--part", "speed", "--largest", "0.1")
    efforts, sizes = run(rate_distortion, *options)
    assert [row[0] for row in efforts.rows] == ["1", "5", "9"]
    assert [row[0] for row in sizes.rows] == ["0.1"]
