"""Colours by ICC profiles in the viewer, against littleCMS."""

from __future__ import annotations

import io
import json
import struct
from pathlib import Path
from typing import Any, Final

import numpy as np
import pytest
from PIL import Image, ImageCms

import vmesh
from tests.web.node import ROOT, run_node
from tests.web.profiles import (
    ADOBE_RGB,
    DISPLAY_P3,
    SRGB,
    grey_profile,
    matrix_profile,
    parametric,
    profile_of,
    sampled,
)
from vmesh.arrays import UInt8Array
from vmesh.mesh import Metadata

_SCRIPT: Final = """
import { readFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
const [web, source] = process.argv.slice(2);
const load = (name) => import(pathToFileURL(`${web}/${name}`));
const { decode, render } = await load("decoder/vmesh.js");
const { iccProfile, toSrgb } = await load("viewer/profile.js");
const mesh = decode(new Uint8Array(readFileSync(source)));
const made = await toSrgb(mesh);
const profile = await iccProfile(mesh).catch(() => []);
console.log(JSON.stringify({
  isSame: made === mesh,
  profile: Buffer.from(profile ?? []).toString("hex"),
  samples: [...mesh.samples],
  made: [...made.samples].map((sample) => sample / (2 ** made.depth - 1)),
  pixel: render(made).data[0] / (2 ** made.depth - 1),
}));
"""

GAMMA: Final = sampled([round(256 * 2.2)])
TABLE: Final = sampled([round(65535 * (i / 99) ** 1.8) for i in range(100)])
BLACK: Final = sampled([0, 0])


def mesh_of(pixels: UInt8Array, profile: bytes = b"") -> vmesh.Mesh:
    found = vmesh.encode(pixels, vertices=60, effort=1)
    return found.replaced(metadata=Metadata(icc=profile))


@pytest.fixture(scope="module")
def colored() -> UInt8Array:
    return np.random.default_rng(1).integers(0, 256, (12, 12, 3), dtype=np.uint8)


def converted(data: bytes, folder: Path) -> dict[str, Any]:
    """What the viewer makes of a file."""
    (folder / "convert.mjs").write_text(_SCRIPT, "utf-8")
    (folder / "mesh.vmesh").write_bytes(data)
    printed = run_node(folder / "convert.mjs", ROOT / "vmesh" / "web", folder / "mesh.vmesh")
    found: dict[str, Any] = json.loads(printed)
    return found


def by_little_cms(samples: UInt8Array, profile: bytes) -> UInt8Array:
    """Colours of shape (n, c) in sRGB, or their greys."""
    mode = "L" if samples.shape[1] == 1 else "RGB"
    shown = ImageCms.profileToProfile(
        Image.fromarray(samples.reshape(1, -1, 3) if mode == "RGB" else samples.reshape(1, -1)),
        ImageCms.ImageCmsProfile(io.BytesIO(profile)),
        ImageCms.createProfile("sRGB"),
        renderingIntent=ImageCms.Intent.RELATIVE_COLORIMETRIC,
        outputMode="RGB",
    )
    assert shown is not None
    return np.asarray(shown).reshape(-1, 3)


@pytest.mark.parametrize(
    "profile",
    [
        matrix_profile(DISPLAY_P3),
        matrix_profile(ADOBE_RGB, sampled([563])),
        matrix_profile(DISPLAY_P3, TABLE),
        matrix_profile(SRGB, GAMMA),
        matrix_profile(SRGB, sampled([])),
        matrix_profile(ADOBE_RGB, parametric(0, 1.7)),
        matrix_profile(ADOBE_RGB, parametric(1, 1.9, 1.1, -0.1)),
        matrix_profile(ADOBE_RGB, parametric(2, 1.9, 1.1, -0.1, 0.02)),
        matrix_profile(DISPLAY_P3, parametric(4, 2.4, 0.9, 0.1, 0.1, 0.05, 0, 0.001)),
        matrix_profile(DISPLAY_P3, gTRC=GAMMA),
        matrix_profile(DISPLAY_P3[::-1]),
    ],
    ids=[
        "p3",
        "adobe",
        "table",
        "gamma",
        "linear",
        "para0",
        "para1",
        "para2",
        "para4",
        "own",
        "swap",
    ],
)
def test_colors_are_those_of_little_cms(
    colored: UInt8Array, profile: bytes, tmp_path: Path
) -> None:
    mesh = mesh_of(colored, profile)
    found = converted(vmesh.dumps(mesh), tmp_path)
    assert bytes.fromhex(found["profile"]) == profile
    samples = np.array(found["samples"], np.uint8).reshape(-1, 3)
    expected = by_little_cms(samples, profile).astype(float)
    assert np.abs(255 * np.array(found["made"]).reshape(-1, 3) - expected).max() < 1.6


@pytest.mark.parametrize("connection", ["XYZ ", "Lab "])
@pytest.mark.parametrize("curve", [GAMMA, TABLE, sampled([])], ids=["gamma", "table", "linear"])
def test_greys_are_those_of_little_cms(
    colored: UInt8Array, curve: bytes, connection: str, tmp_path: Path
) -> None:
    profile = grey_profile(curve, connection)
    found = converted(vmesh.dumps(mesh_of(colored[..., 0], profile)), tmp_path)
    samples = np.array(found["samples"], np.uint8).reshape(-1, 1)
    expected = by_little_cms(samples, profile)[:, 0].astype(float)
    assert np.abs(255 * np.array(found["made"]) - expected).max() < 1.6


def test_alpha_stays_as_it_is_and_16_bits_are_kept(colored: UInt8Array, tmp_path: Path) -> None:
    deep = (colored // 2 + 64).astype(np.uint16) * 257  # no color outside sRGB
    with_alpha = np.concatenate([deep, deep[..., :1]], axis=2)
    found = converted(vmesh.dumps(mesh_of(with_alpha, matrix_profile(DISPLAY_P3))), tmp_path)
    samples = np.array(found["samples"]).reshape(-1, 4) / 65535
    made = np.array(found["made"]).reshape(-1, 4)
    assert np.abs(made[:, 3] - samples[:, 3]).max() < 2 / 65535
    rounded = np.round(samples[:, :3] * 255).astype(np.uint8)
    expected = by_little_cms(rounded, matrix_profile(DISPLAY_P3)).astype(float)
    assert np.abs(255 * made[:, :3] - expected).max() < 2.5


@pytest.mark.parametrize(
    "profile",
    [
        b"",
        matrix_profile(SRGB),
        ImageCms.ImageCmsProfile(ImageCms.createProfile("sRGB")).tobytes(),
    ],
    ids=["none", "srgb", "little-cms"],
)
def test_a_picture_in_srgb_is_the_very_same(
    colored: UInt8Array, profile: bytes, tmp_path: Path
) -> None:
    assert converted(vmesh.dumps(mesh_of(colored, profile)), tmp_path)["isSame"]


def _cut(profile: bytes) -> bytes:
    return profile[:-20]


def _tags(profile: bytes, count: int) -> bytes:
    return profile[:128] + struct.pack(">I", count) + profile[132:]


_P3: Final = matrix_profile(DISPLAY_P3)


@pytest.mark.parametrize(
    "profile",
    [
        b"\0",
        bytes(200),
        _cut(_P3),
        _P3[:140],
        _tags(_P3, 0),
        _tags(_P3, 3),
        matrix_profile(DISPLAY_P3, b"none" + bytes(40)),
        matrix_profile(DISPLAY_P3, parametric(9, 1.0)),
        matrix_profile(DISPLAY_P3, b"curv" + bytes(4) + struct.pack(">IHH", 2**31, 0, 9)),
        matrix_profile(DISPLAY_P3, rTRC=b"curv"),
        profile_of("RGB ", "Lab ", {"A2B0": b"mft2" + bytes(60)}),
        profile_of("CMYK", "Lab ", {"A2B0": b"mft2" + bytes(60)}),
        grey_profile(GAMMA),
    ],
)
def test_profiles_that_cannot_be_read_are_taken_as_srgb(
    colored: UInt8Array, profile: bytes, tmp_path: Path
) -> None:
    assert converted(vmesh.dumps(mesh_of(colored, profile)), tmp_path)["isSame"]


def test_a_profile_of_no_end_is_not_inflated(tmp_path: Path) -> None:
    module = ROOT / "vmesh" / "web" / "viewer" / "profile.js"
    (tmp_path / "bomb.mjs").write_text(
        f"""import {{ deflateSync }} from "node:zlib";
        import {{ iccProfile }} from "{module.as_uri()}";
        const content = new Uint8Array(deflateSync(Buffer.alloc(2 ** 26)));
        for (const damaged of [content, content.subarray(0, 99), content.subarray(9)]) {{
          const chunks = [{{ tag: "i", content: damaged }}];
          const said = await iccProfile({{ chunks }}).then(() => "read", () => "refused");
          console.log(said);
        }}"""
    )
    assert run_node(tmp_path / "bomb.mjs").split() == ["refused"] * 3
