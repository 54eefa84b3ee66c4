"""Drafts, their lambdas and measures, and the search for a goal."""

from __future__ import annotations

import numpy as np
import pytest

from tests import twins
from tests.pictures import PICTURES, disc, drawn, noise
from vmesh.arrays import UInt8Array
from vmesh.codec.writer import dumps
from vmesh.encoder.draft import SampledDraft
from vmesh.encoder.effort import EFFORTS
from vmesh.encoder.image import weighted
from vmesh.encoder.mesh_builder import MeshBuilder
from vmesh.encoder.pipeline import encode
from vmesh.encoder.proposals import propose
from vmesh.encoder.rate_control import measure_psnr
from vmesh.encoder.rate_model import lambda_of, lambda_of_quality, vertices_for
from vmesh.encoder.remeshing import Remesher
from vmesh.encoder.sampling import Samples
from vmesh.encoder.settings import Settings
from vmesh.formats.raster.rendering import render
from vmesh.mesh import Metadata
from vmesh.metrics import psnr


@pytest.mark.parametrize("vertices", [4, 60])
@pytest.mark.parametrize("name", [name for name, p in PICTURES.items() if p.shape[-1] != 4])
def test_psnr_is_measured_as_the_rendered_picture_shows_it(name: str, vertices: int) -> None:
    picture = PICTURES[name]
    mesh = encode(picture, method="blue-noise", vertices=vertices)
    rendered = render(mesh).reshape(picture.shape)
    image = picture.reshape(*picture.shape[:2], -1)
    assert measure_psnr(image, mesh) == pytest.approx(psnr(rendered, picture))


def test_psnr_counts_colors_as_far_as_they_are_seen() -> None:
    picture = noise(20, 24, 4)
    mesh = encode(picture, method="blue-noise", vertices=60)
    difference = drawn(mesh) - picture.astype(np.float64)
    seen = picture[:, :, 3:] / 255 * [1, 1, 1, 0] + [0, 0, 0, 1]
    expected = 10 * np.log10(255**2 / np.square(difference * seen).mean())
    assert measure_psnr(picture, mesh) == pytest.approx(expected)
    hidden = disc(20, 24, (255, 0, 0), (20, 90, 160))
    mesh = encode(hidden, vertices=40)
    other = disc(20, 24, (0, 255, 0), (20, 90, 160))
    assert measure_psnr(hidden, mesh) == measure_psnr(other, mesh)


def test_lambda_falls_with_the_quality() -> None:
    lambdas = [lambda_of_quality(quality, 255) for quality in range(101)]
    assert lambdas == sorted(lambdas, reverse=True)
    assert len(set(lambdas)) == 101
    assert lambdas[-1] > 0


def test_a_larger_file_is_guessed_to_hold_more_vertices() -> None:
    counts = [vertices_for(size) for size in range(1, 5000, 7)]
    assert counts == sorted(counts)
    assert counts[0] == 4


@pytest.mark.parametrize("n_components", [1, 3, 4])
def test_a_sampled_draft_knows_its_error(n_components: int) -> None:
    image = noise(20, 24, n_components)
    if n_components == 4:
        image[5:, 10:, 3] = 0

    def take(n: int) -> Samples:
        return propose(weighted(image), Settings(vertices=n))[1]

    draft = SampledDraft(weighted(image), take, 60)
    vertices, triangles = draft.geometry()
    assert draft.n_vertices == len(vertices) == pytest.approx(60, rel=0.02)
    matrix = twins.barycentric_matrix(vertices.astype(np.int64) * 128, triangles, 20, 24)
    expected = 0.0
    for z in range(n_components):
        seen = np.sqrt(image[:, :, 3].ravel() / 255) if n_components == 4 and z < 3 else 1.0
        values = image[:, :, z].ravel() * seen
        weights = matrix * np.reshape(seen, (-1, 1))
        solution = np.linalg.lstsq(weights, values, rcond=None)[0]
        expected += float(np.square(weights @ solution - values).sum())
    assert draft.error == pytest.approx(expected, rel=0.1)


@pytest.mark.parametrize("n", [100, 300])
def test_lambda_is_about_what_a_bit_saves_in_a_refined_mesh(chelsea: UInt8Array, n: int) -> None:
    image = weighted(chelsea[60:156, 100:228])

    def error_and_bits(n_vertices: int) -> tuple[float, int]:
        draft.resize(n_vertices)
        return draft.error, 8 * len(dumps(MeshBuilder(image, Metadata(), None).build(draft)))

    draft = Remesher(
        image,
        propose(image, Settings(vertices=4 * n))[1].vertices(),
        EFFORTS[5],
    )
    draft.thin(n, lambda: None)
    draft.refine(n, lambda: None)
    error, bits = error_and_bits(n)
    expected = lambda_of(draft)
    less, more = error_and_bits(round(1.25 * n))
    saved = (error - less) / (more - bits)
    assert saved / 2 < expected < 2 * saved


def test_a_draft_of_fewer_vertices_has_more_error(chelsea: UInt8Array) -> None:
    image = weighted(chelsea[60:156, 100:228])
    draft = SampledDraft(image, lambda n: propose(image, Settings(vertices=n))[1], 1000)
    errors = [draft.error]
    for n in (500, 200, 50):
        draft.resize(n)
        assert draft.n_vertices == pytest.approx(n, rel=0.02)
        errors.append(draft.error)
    assert errors == sorted(errors)


def test_colors_are_as_fine_as_the_error_deserves(chelsea: UInt8Array) -> None:
    image = weighted(chelsea[60:156, 100:228])
    draft = SampledDraft(image, lambda n: propose(image, Settings(vertices=n))[1], 1000)
    steps = []
    for n in (1500, 300, 60):
        draft.resize(n)
        mesh = MeshBuilder(image, Metadata(xmp=b"x"), None).build(draft)
        mesh.check()
        assert mesh.metadata.xmp == b"x"
        steps.append(mesh.lattice.steps[0])
    assert steps[0] < steps[1] < steps[2]
    assert MeshBuilder(image, Metadata(), 9).build(draft).lattice.steps[0] == 9
