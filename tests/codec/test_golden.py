"""Files of versions 1.0 and 1.1 that are never edited: later readers decode them to the same.

A test of these that fails says that files of users would change: the program is wrong, not the
test.
"""

from __future__ import annotations

import hashlib
import io
from pathlib import Path
from typing import Final

import pytest

import vmesh
from vmesh.codec.text import mesh_text
from vmesh.formats.raster.pam import write_pam

_FOLDER: Final = Path(__file__).parents[1] / "golden"

# SHA-256 of the file, of the canonical text of its mesh, and of its picture as PAM.
GOLDEN: Final = {
    "photograph": (
        "1af892dd27f8844ec64aa9f47bc1cfae549eac0946e724fd38cfbc20397784a6",
        "2bfed5da70585ea0e2ff9d406eec788e9b5d4891cc4eb4ad877fadf97d375780",
        "7fd2a1f826c334cb0dddeec1f946cf53ceb9a7ed3931cdbe3b1ce8c25b031589",
    ),
    "one-grey-pixel": (
        "1f9a270e1d3e814285ac32e8041b1586da1630fe4b7f46d98b8871f0b3492ed5",
        "80bb1e303590ecd7170956ac534ef64affa26de5da8510dddb1dd914b697d6ba",
        "bb74f3f7d463daf4b70ccbb4a598d29e4525763308804dcd7641aa457eddcb52",
    ),
    "rgba": (
        "e3e8fbb2a45421623f948dc5a3c45c3f0c08748c708273a0886e6158ed70c83b",
        "0364652938c08ffd9549598ef606d17ee574d6b233d4615319e91c8322fe110a",
        "ecd0966597c5405a46fd955a3479bf249fc57039e3d87518637d49cfc79e51b3",
    ),
    "listed": (
        "7f572f4f5ffebe72747438b057138e00f687834a9b703eb015b43e2dd853fd43",
        "c55f68fca61efb56326562d21cf0afe666bdc0ab109b51e58dd279e2144a0a3b",
        "336afd611339a28f030d7c84c2a9b31c438839ece7f358c1a624d73c1da5ba1a",
    ),
    "flipped": (
        "fa81cf24ce11894fb9e799327234ca98797061856b355c29a57fa8b7604b8e67",
        "b66dd0aa98023f523f43aae8f723de5e20dac09baf0adc476c5cc0d89aa3f785",
        "471e1dfac0c3af68099e66c8574ca13097635924ff67fc468ce4ac93fbcbb34a",
    ),
    "sixteen-bits": (
        "34f854a5827a4f9168f227b7b577cf98a16cca01fafe3e309516abe6daf91b3f",
        "45b8c7c7c3d77cdd24f2b60bd7666360d94b0addbd5afd7814302ac045b529c1",
        "45a6acbca4f287a710d1ffe19e6415aa4b5a4f65569ff3ddb0f4ce372583a947",
    ),
    "metadata": (
        "53f274e37ad12395f0d09d6ce63416352bbf6bf50fc383d786b1fea7f4476068",
        "1c31c1f2926342cd13bb20daebcb5730a545693a1f3f3e25bd1c1e6d05690822",
        "1a547c1fa3459a6987ccb6ed46c623467ddf3a38e1a28bcc65ef73c10ec26e0a",
    ),
    "many-ties": (
        "8fb7744461b2ed241f79babab2a23e2c5a474f0b53c455f77afbde12e2a3d11a",
        "71524feff4cd4ead6b8f93089c61ee9e7bf66925ebf911d0c67a7a9d19f4bdc7",
        "f80c047198fb0cf20e618371c6e9fb66546be3af93631a6fa864296402f74038",
    ),
    "tiles": (
        "3c726e3435a2fb6614f614140ec900200a2978560bf7df9d788275a4ceccffeb",
        "48f2bc8a10173932990aa336f960296eab6b85e6bda1002313f04b8dad6ada07",
        "435b859a64dc4dd760d6ec1b4ee7d28d0eecbdbfade6e23d49c94644ad85230c",
    ),
}


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


def test_no_golden_file_was_added_or_lost() -> None:
    assert {path.stem for path in _FOLDER.iterdir()} == GOLDEN.keys()


@pytest.mark.parametrize("name", GOLDEN)
def test_a_golden_file_decodes_to_what_it_always_did(name: str) -> None:
    data = (_FOLDER / f"{name}.vmesh").read_bytes()
    mesh = vmesh.loads(data)
    picture = io.BytesIO()
    write_pam(vmesh.render(mesh), picture, depth=mesh.depth)
    text = mesh_text(mesh).encode("ascii")
    assert (sha256(data), sha256(text), sha256(picture.getvalue())) == GOLDEN[name]
