from __future__ import annotations

import os
import sys
from pathlib import Path

import pytest
from PIL import Image

from vmesh.batch.sources import PICTURE_SUFFIXES, PICTURES, find_sources


@pytest.fixture
def photos(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A tree of empty files, which is where the program runs."""
    for name in (
        *("photos/b.png", "photos/a.JPG", "photos/notes.txt", "photos/.hidden.png"),
        *("photos/sea/a.jpg", "photos/sea/deep/c.webp", "photos/.trash/d.png"),
    ):
        path = tmp_path / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.touch()
    monkeypatch.chdir(tmp_path)
    return tmp_path / "photos"


def names(*arguments: str, output: str = "out") -> list[tuple[str, str]]:
    """Path and name of each source."""
    found = find_sources(arguments, output, PICTURES).sources
    return [(source.path.as_posix(), source.name.as_posix()) for source in found]


def test_a_folder_gives_its_pictures_with_their_tree(photos: Path) -> None:
    assert names("photos") == [
        ("photos/a.JPG", "a.JPG"),
        ("photos/b.png", "b.png"),
        ("photos/sea/a.jpg", "sea/a.jpg"),
        ("photos/sea/deep/c.webp", "sea/deep/c.webp"),
    ]
    assert names("photos/sea/")[0] == ("photos/sea/a.jpg", "a.jpg")


def test_the_present_folder_and_the_one_above_are_folders_too(
    photos: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert names(".")[0] == ("photos/a.JPG", "photos/a.JPG")
    monkeypatch.chdir(photos / "sea")
    assert names("..")[0] == ("../a.JPG", "a.JPG")


def test_a_named_file_is_taken_whatever_it_is_called(photos: Path) -> None:
    assert names("photos/notes.txt", "photos/.hidden.png") == [
        ("photos/notes.txt", "notes.txt"),
        ("photos/.hidden.png", ".hidden.png"),
    ]


def test_a_pattern_keeps_the_tree_below_its_fixed_part(photos: Path) -> None:
    assert names("photos/**/*.[jw]*") == [
        ("photos/sea/a.jpg", "sea/a.jpg"),
        ("photos/sea/deep/c.webp", "sea/deep/c.webp"),
    ]
    absolute = photos / "*.png"
    assert names(str(absolute)) == [((photos / "b.png").as_posix(), "b.png")]
    assert names("*/sea/*.jpg") == [("photos/sea/a.jpg", "photos/sea/a.jpg")]


def test_a_folder_that_a_pattern_matches_keeps_its_place(photos: Path) -> None:
    assert ("photos/sea/deep/c.webp", "sea/deep/c.webp") in names("photos/*")


def test_a_file_whose_name_looks_like_a_pattern_is_a_file(photos: Path) -> None:
    (photos / "[x].png").touch()
    assert names("photos/[x].png") == [("photos/[x].png", "[x].png")]


def test_what_is_not_there_is_left_to_the_one_who_reads(photos: Path) -> None:
    assert names("none.png", "photos/*.gif") == [
        ("none.png", "none.png"),
        ("photos/*.gif", "*.gif"),
    ]


def test_a_source_that_is_named_twice_comes_once(photos: Path) -> None:
    assert len(names("photos/b.png", "photos", "photos", "photos/**")) == len(names("photos/**"))


def test_outputs_below_a_source_are_no_sources(photos: Path) -> None:
    assert names("photos", output="photos/sea") == [
        ("photos/a.JPG", "a.JPG"),
        ("photos/b.png", "b.png"),
    ]
    assert len(names("photos", output="photos")) == 4


def test_a_folder_without_pictures_is_told(photos: Path) -> None:
    for path in (photos / "sea").rglob("*.*"):
        path.unlink()
    with pytest.raises(ValueError, match="no pictures were found in photos/sea, photos/sea/deep"):
        names("photos/sea", "photos/sea/deep")


@pytest.mark.skipif(sys.platform == "win32" or os.geteuid() == 0, reason="root may read everywhere")
def test_a_folder_that_cannot_be_read_is_told(photos: Path) -> None:
    (photos / "sea").chmod(0)
    with pytest.raises(PermissionError):
        names("photos")


def test_pillow_reads_all_that_is_taken_from_folders() -> None:
    assert set(Image.registered_extensions()) >= PICTURE_SUFFIXES
