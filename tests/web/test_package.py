"""The package for npm, packed, installed and used as others would."""

from __future__ import annotations

import json
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import Final

import numpy as np
import pytest

import vmesh
from tests.pictures import PICTURES, share_apart
from tests.web.node import PACKAGES, ROOT, need_package, run_node, run_npm
from tests.web.windows import BROWSERS, Site, Window, pixels_of, window_of

_WEB: Final = ROOT / "vmesh" / "web"
_TOOLS: Final = ("package.json", "tsconfig.json", "tsconfig.declarations.json")

_MAIN: Final = """
import { DEFAULT_LIMITS, VmeshError, decode, render, type Mesh } from "vmesh-web";
import { iccProfile, toSrgb } from "vmesh-web/profile";
import "vmesh-web/element";
import type { VmeshImage } from "vmesh-web/element";

async function show(source: string): Promise<string> {
  const response = await fetch(source);
  try {
    const mesh: Mesh = await toSrgb(decode(new Uint8Array(await response.arrayBuffer())));
    const profile: Uint8Array | null = await iccProfile(mesh);
    const { data, components } = render(mesh, { pixels: DEFAULT_LIMITS.pixels });
    return `${mesh.width} ${mesh.height} ${components} ${data.length} ${profile}`;
  } catch (error) {
    return error instanceof VmeshError ? error.code : String(error);
  }
}

const image: VmeshImage | null = document.querySelector("vmesh-image");
if (image) image.addEventListener("load", async () => { document.title = await show(image.src); });
"""

_WRONG: Final = """
import { decode } from "vmesh-web";
decode("photo.vmesh");
decode(new Uint8Array(9)).pixels;
"""

_SERVER: Final = """
import { readFileSync } from "node:fs";
import { decode, render } from "vmesh-web";
import { toSrgb } from "vmesh-web/profile";
import "vmesh-web/element";
import "vmesh-web/dist/vmesh-image.js";
import * as built from "vmesh-web/dist/vmesh.js";
const bytes = readFileSync(process.argv[2]);
const meshes = [decode(bytes), await toSrgb(decode(bytes)), built.decode(bytes)];
console.log(JSON.stringify(meshes.map((mesh) => [...render(mesh).data])));
"""


@pytest.fixture(scope="module")
def tarball(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The package as `npm pack` makes it, from a copy of what it takes."""
    need_package("typescript")
    copy = tmp_path_factory.mktemp("source")
    shutil.copytree(_WEB, copy / "vmesh" / "web", ignore=shutil.ignore_patterns("types"))
    (copy / "tests" / "web").mkdir(parents=True)
    for name in _TOOLS:
        shutil.copy(ROOT / "tests" / "web" / name, copy / "tests" / "web")
    (copy / "tests" / "web" / "node_modules").symlink_to(PACKAGES)
    run_npm("pack", folder=copy / "vmesh" / "web")
    (made,) = (copy / "vmesh" / "web").glob("*.tgz")
    return made


@pytest.fixture(scope="module")
def project(tarball: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A project that has installed the package."""
    folder = tmp_path_factory.mktemp("project")
    (folder / "package.json").write_text('{ "name": "project", "private": true, "type": "module" }')
    run_npm("install", tarball, folder=folder)
    return folder


@pytest.fixture(scope="module")
def mesh() -> vmesh.Mesh:
    return vmesh.encode(PICTURES["ramp"], vertices=9)


def test_the_package_holds_what_its_exports_and_types_name(project: Path) -> None:
    folder = project / "node_modules" / "vmesh-web"
    package = json.loads((folder / "package.json").read_text("utf-8"))
    targets = [
        path
        for entry in package["exports"].values()
        for path in (entry.values() if isinstance(entry, dict) else [entry])
    ]
    assert all((folder / path).is_file() for path in [*targets, *package["sideEffects"]])
    assert (folder / "LICENSE").read_text() == (ROOT / "LICENSE").read_text()
    assert (folder / "README.md").is_file()
    assert not list(folder.rglob("*.py")) + list(folder.rglob("*.html"))
    assert package["version"] == vmesh.__version__
    assert "dependencies" not in package


def test_node_decodes_with_the_package(project: Path, mesh: vmesh.Mesh) -> None:
    vmesh.dump(mesh, project / "photo.vmesh")
    (project / "server.mjs").write_text(_SERVER)
    printed = json.loads(run_node("server.mjs", "photo.vmesh", folder=project))
    assert printed == [np.asarray(vmesh.render(mesh)).ravel().tolist()] * 3


@pytest.mark.parametrize("resolution", ["bundler", "nodenext"])
def test_typescript_checks_a_program_by_the_declarations(project: Path, resolution: str) -> None:
    module = "esnext" if resolution == "bundler" else "nodenext"
    options = ["--noEmit", "--strict", "--target", "es2022", "--lib", "es2022,dom"]
    options += ["--module", module, "--moduleResolution", resolution]
    compiler = need_package("typescript") / "bin" / "tsc"
    (project / "main.ts").write_text(_MAIN)
    run_node(compiler, *options, "main.ts", folder=project)
    (project / "wrong.ts").write_text(_WRONG)
    with pytest.raises(AssertionError) as failed:
        run_node(compiler, *options, "wrong.ts", folder=project)
    assert "wrong.ts(3,8)" in str(failed.value)
    assert "wrong.ts(4,27)" in str(failed.value)


@pytest.fixture(scope="module", params=BROWSERS)
def window(request: pytest.FixtureRequest) -> Iterator[Window]:
    with window_of(request.param) as opened:
        yield opened


@pytest.fixture(scope="module")
def built(project: Path) -> Path:
    """A page built by Vite."""
    vite = need_package("vite") / "bin" / "vite.js"
    (project / "index.html").write_text(
        '<!doctype html><meta charset="utf-8"><title>Waiting</title>'
        '<vmesh-image src="photo.vmesh" alt="A ramp" width="32" height="24"></vmesh-image>'
        '<script type="module" src="/main.ts"></script>'
    )
    (project / "main.ts").write_text(_MAIN)
    run_node(vite, "build", folder=project)
    return project / "dist"


def test_a_page_built_with_vite_shows_a_picture(
    built: Path, window: Window, mesh: vmesh.Mesh
) -> None:
    site = Site(window)
    try:
        site.files |= {path.name: path.read_bytes() for path in built.rglob("*.*")}
        site.files["photo.vmesh"] = vmesh.dumps(mesh)
        site.policy = "default-src 'self'"
        window.open(f"{site.address}index.html")
        for _ in range(600):
            if (title := window.evaluate("document.title")) != "Waiting":
                break
        assert title == f"{mesh.width} {mesh.height} 3 {3 * mesh.width * mesh.height} null"
        assert share_apart(pixels_of(window), vmesh.render(mesh)) < 0.01
    finally:
        site.close()


def test_the_decoder_alone_leaves_the_element_out(project: Path) -> None:
    (project / "decoder.js").write_text('export { decode } from "vmesh-web";\n')
    esbuild = need_package("esbuild") / "bin" / "esbuild"
    options = ("--bundle", "--minify", "--format=esm", "--target=es2022")
    made = run_node(esbuild, "decoder.js", *options, folder=project)
    assert "HTMLElement" not in made
    assert len(made) < (_WEB / "dist" / "vmesh.js").stat().st_size
