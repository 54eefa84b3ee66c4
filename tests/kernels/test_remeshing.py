"""Edits of a mesh against twins that judge each of them by the error of the whole mesh."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import twins
from tests.pictures import PICTURES, noise, ramp, step_edge
from tests.strategies import meshes, pictures
from tests.surfaces import (
    check_surface,
    evenly,
    measure_all,
    open_surface,
    scattered,
    triangles_of,
    unevenly,
)
from vmesh.arrays import Float64Array, Int32Array, UInt8Array
from vmesh.kernels.delaunay import delaunay
from vmesh.kernels.remeshing import (
    LEAST_GAIN,
    MAX_STEPS,
    N_TRIES,
    REACH,
    RIDGE,
    Surface,
    WeightedImage,
    Workspace,
    flip_edges,
    insert,
    make_workspace,
    propose_insertions,
    relocate,
    thin,
    weigh,
)
from vmesh.mesh import Mesh


def room_for(image: WeightedImage) -> Workspace:
    return make_workspace(image.samples.shape[0], image.samples.shape[2])


def remove(surface: Surface, image: WeightedImage, n_remove: int, max_cost: float) -> int:
    """Remove the vertices that cost least, without chance; how many went."""
    work = room_for(image)
    n_points = len(surface.points)
    costs = np.zeros(n_points)
    weigh(surface, image, work, 0, n_points, costs)
    return thin(surface, image, work, costs, np.ones(n_points), n_remove, max_cost)


def random_colors(n: int, n_components: int, seed: int = 0) -> Float64Array:
    return np.random.default_rng(seed).uniform(0, 255, (n, n_components))


def total_error(surface: Surface, image: WeightedImage) -> float:
    """The error of a surface by its twin."""
    triangles = triangles_of(surface).tolist()
    return sum(twins.triangle_errors(surface.points, triangles, surface.colors, image))


def check_errors(surface: Surface, image: WeightedImage) -> None:
    """Check that each triangle in use knows its error."""
    expected = twins.triangle_errors(
        surface.points, triangles_of(surface).tolist(), surface.colors, image
    )
    assert surface.errors[surface.origin[::3] >= 0] == pytest.approx(expected, abs=1e-6)


def surface_on(image: WeightedImage, n: int, seed: int, n_spare: int = 0) -> Surface:
    """Scattered vertices with random colours."""
    height, width, n_components = image.samples.shape
    vertices = scattered(width, height, n, seed)
    colors = random_colors(len(vertices), n_components, seed)
    return open_surface(image, vertices, colors, n_spare)


# --- Errors ---------------------------------------------------------------------------------------


@given(meshes(), st.sampled_from([1, 3, 4]), st.integers(0, 99))
def test_errors_are_those_of_looking_at_every_pixel(
    mesh: Mesh, n_components: int, seed: int
) -> None:
    image = unevenly(noise(mesh.height, mesh.width, n_components, seed))
    vertices = mesh.canonical().vertices << 1 >> mesh.subdivision
    far = (vertices == mesh.vertices.max(axis=0) << 1 >> mesh.subdivision) | (vertices == 0)
    vertices = np.where(far, vertices, vertices | 1)
    vertices = np.unique(vertices[:, ::-1], axis=0)[:, ::-1].astype(np.int32)
    surface = open_surface(image, vertices, random_colors(len(vertices), n_components, seed))
    check_errors(surface, image)


@pytest.mark.parametrize("shape", [(1, 1, 3), (1, 60, 3), (60, 1, 1), (3, 200, 4), (50, 40, 3)])
def test_the_triangles_share_the_error_of_the_picture(shape: tuple[int, int, int]) -> None:
    image = unevenly(noise(*shape))
    corners = np.array([[0, 0], [2, 0], [0, 2], [2, 2]], dtype=np.int32)
    vertices = corners * np.array([shape[1], shape[0]], dtype=np.int32)
    surface = open_surface(image, vertices, np.zeros((4, shape[2])))
    assert measure_all(surface, image) == twins.squares(image)


def test_a_vertex_on_an_edge_of_pixels_shares_them_out_exactly_once() -> None:
    image = unevenly(noise(9, 16, 3))
    # Triangles whose sides run through pixel centres: level, upright and at 45 degrees.
    sites = [(0, 0), (32, 0), (9, 9), (23, 9), (9, 13), (0, 18), (32, 18)]
    vertices = np.array(sites, dtype=np.int32)
    surface = open_surface(image, vertices, np.zeros((7, 3)))
    assert surface.errors.sum() == twins.squares(image)
    check_errors(surface, image)


# --- Removing -------------------------------------------------------------------------------------


def errors_without_each(
    vertices: Int32Array, colors: Float64Array, image: WeightedImage
) -> dict[int, float]:
    """Error of the Delaunay triangles of all vertices but one, by that one."""
    far = vertices.max(axis=0)
    errors = {}
    for v in range(len(vertices)):
        if all(vertices[v, i] in (0, far[i]) for i in range(2)):
            continue
        rest = np.delete(vertices, v, axis=0)
        faces = delaunay(rest).tolist()
        left = np.delete(colors, v, axis=0)
        errors[v] = sum(twins.triangle_errors(rest.astype(np.int64), faces, left, image))
    return errors


@pytest.mark.parametrize("seed", range(6))
def test_the_vertex_that_costs_least_goes_first(seed: int) -> None:
    image = unevenly(noise(23, 29, 3, seed=seed))
    surface = surface_on(image, 12, seed)
    for _ in range(14):
        used = np.flatnonzero(surface.leaving >= 0)
        vertices = surface.points[used].astype(np.int32)
        errors = errors_without_each(vertices, surface.colors[used], image)
        assert remove(surface, image, 1, np.inf) == 1
        gone = used[surface.leaving[used] < 0]
        assert total_error(surface, image) == pytest.approx(min(errors.values()))
        assert errors[int(np.flatnonzero(used == gone[0])[0])] == min(errors.values())
        check_surface(surface, 29, 23)
    check_errors(surface, image)


@pytest.mark.parametrize("seed", range(4))
def test_costs_are_computed_anew_when_they_come_up_as_the_least(seed: int) -> None:
    image = unevenly(noise(23, 29, 3, seed=seed))
    surface = surface_on(image, 16, seed)
    vertices, colors = surface.points.astype(np.int32), surface.colors.copy()

    def cost(v: int, left: list[int]) -> float:
        """What the removal of a vertex adds to the error of the Delaunay triangles."""
        if vertices[v].tolist() in [[0, 0], [58, 0], [0, 46], [58, 46]]:
            return np.inf
        errors = []
        for rest in (left, [u for u in left if u != v]):
            faces = delaunay(np.ascontiguousarray(vertices[rest])).tolist()
            points = surface.points[rest]
            errors.append(sum(twins.triangle_errors(points, faces, colors[rest], image)))
        return errors[1] - errors[0]

    def around(v: int, left: list[int]) -> set[int]:
        faces = delaunay(np.ascontiguousarray(vertices[left])).tolist()
        return {left[u] for face in faces if left.index(v) in face for u in face} - {v}

    expected = twins.thinned(len(vertices), 14, cost, around)
    assert remove(surface, image, 14, np.inf) == 14
    assert np.flatnonzero(surface.leaving >= 0).tolist() == expected
    check_surface(surface, 29, 23)
    check_errors(surface, image)


def test_vertices_that_cost_more_than_allowed_stay() -> None:
    image = unevenly(noise(23, 29, 3))
    surface = surface_on(image, 12, 1)
    # As thinning removes them until each of those left costs more.
    while remove(surface, image, 1000, 2000.0):
        pass
    used = np.flatnonzero(surface.leaving >= 0)
    assert 4 < len(used) < 20
    before = total_error(surface, image)
    vertices = surface.points[used].astype(np.int32)
    errors = errors_without_each(vertices, surface.colors[used], image)
    least = min(errors.values()) - before
    assert least > 2000.0
    assert remove(surface, image, 1000, 0.99 * least) == 0
    assert remove(surface, image, 1, 1.01 * least) == 1


@pytest.mark.parametrize("name", PICTURES)
def test_only_the_corners_are_left_in_the_end(name: str) -> None:
    picture = PICTURES[name].reshape(*PICTURES[name].shape[:2], -1)
    height, width, n_components = picture.shape
    # Every pixel's centre is a vertex, which puts all of them on circles with others.
    centres = [(2 * x + 1, 2 * y + 1) for y in range(height) for x in range(width)]
    sites = [(0, 0), (2 * width, 0), *centres, (0, 2 * height), (2 * width, 2 * height)]
    vertices = np.array(sites, dtype=np.int32)
    image = unevenly(picture)
    surface = open_surface(image, vertices, random_colors(len(sites), n_components))
    while remove(surface, image, len(sites) // 3 + 1, np.inf):
        check_surface(surface, width, height)
        check_errors(surface, image)
    left = surface.points[surface.leaving >= 0].tolist()
    assert left == [[0, 0], [2 * width, 0], [0, 2 * height], [2 * width, 2 * height]]


# --- Inserting ------------------------------------------------------------------------------------


def proposals(surface: Surface, image: WeightedImage) -> tuple[Float64Array, np.ndarray]:
    n_triangles = len(surface.errors)
    gains, places = np.full(n_triangles, np.nan), np.zeros((n_triangles, 2), dtype=np.int64)
    propose_insertions(surface, image, room_for(image), 0, len(gains), gains, places)
    return gains, places


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_an_insertion_gains_what_was_proposed(n_components: int, seed: int) -> None:
    image = unevenly(noise(30, 40, n_components, seed))
    surface = surface_on(image, 10, seed, n_spare=1)
    gains, places = proposals(surface, image)
    best = int(np.argmax(gains))
    before, gain = surface.errors.sum(), gains[best]
    assert insert(surface, image, room_for(image), np.array([best]), gains, places, 1) == 1
    check_surface(surface, 40, 30)
    check_errors(surface, image)
    v = len(surface.points) - 1
    assert surface.points[v].tolist() == places[best].tolist()
    # The ridge that holds a colour where no pixel tells is in the gain, but not in the error.
    held = RIDGE * np.square(surface.colors[v]).sum()
    assert before - surface.errors.sum() == pytest.approx(gain + held)


@pytest.mark.parametrize("seed", range(3))
def test_the_gain_is_that_of_the_best_color_at_a_place_as_good_as_the_middle(seed: int) -> None:
    image = unevenly(noise(20, 24, 3, seed))
    surface = surface_on(image, 6, seed)
    gains, places = proposals(surface, image)
    for t, face in enumerate(triangles_of(surface).tolist()):

        def gain_at(x: int, y: int, t: int = t, face: list[int] = face) -> float:
            points = np.vstack([surface.points, [[x, y]]])
            colors = np.vstack([surface.colors, np.zeros((1, 3))])
            v = len(points) - 1
            star = [[face[i], face[(i + 1) % 3], v] for i in range(3)]
            error = twins.star_error(points, star, colors, image, v, (x, y), RIDGE)
            return float(surface.errors[t]) - error

        # The centre of the pixel in the middle.
        middle = gain_at(*(2 * (corners // 2) + 1 for corners in surface.points[face].sum(0) // 3))
        if middle > 0:
            x, y = places[t].tolist()
            assert (x % 2, y % 2) == (1, 1)
            assert gains[t] == pytest.approx(gain_at(x, y))
            assert gains[t] >= middle * (1 - 1e-6)
        else:
            assert gains[t] >= middle


def test_no_two_insertions_share_a_side() -> None:
    image = unevenly(noise(30, 40, 3))
    surface = surface_on(image, 20, 2, n_spare=50)
    before = triangles_of(surface).copy()
    gains, places = proposals(surface, image)
    order = np.argsort(-gains, kind="stable")
    order = order[gains[order] > 0]
    inserted = insert(surface, image, room_for(image), order, gains, places, 50)
    check_surface(surface, 40, 30)
    check_errors(surface, image)
    split = {
        t for t, face in enumerate(before) if not np.array_equal(face, triangles_of(surface)[t])
    }
    assert inserted == len(split) == np.count_nonzero(surface.leaving >= 0) - 28
    edges = twins.directed_edges(before)
    for (u, v), e in edges.items():
        if e // 3 in split and (v, u) in edges:
            assert edges[v, u] // 3 not in split
    # What changed is proposed anew, and a second call may split the neighbours.
    propose_insertions(surface, image, room_for(image), 0, len(gains), gains, places)
    np.testing.assert_array_equal(gains, proposals(surface, image)[0])
    useful = np.argsort(-gains, kind="stable")[:3]
    assert insert(surface, image, room_for(image), useful, gains, places, 50) > 0
    check_surface(surface, 40, 30)


@pytest.mark.parametrize("n_spare", [0, 1, 2, 5])
def test_insertions_end_where_the_room_does(n_spare: int) -> None:
    image = unevenly(noise(30, 40, 3))
    surface = surface_on(image, 20, 2, n_spare)
    gains, places = proposals(surface, image)
    order = np.argsort(-gains, kind="stable")
    order = order[gains[order] > 0]
    assert insert(surface, image, room_for(image), order, gains, places, 100) == n_spare
    check_surface(surface, 40, 30)
    assert insert(surface, image, room_for(image), order, gains, places, 100) == 0


def test_no_more_are_inserted_than_were_asked_for() -> None:
    image = unevenly(noise(30, 40, 3))
    surface = surface_on(image, 20, 2, n_spare=10)
    gains, places = proposals(surface, image)
    order = np.argsort(-gains, kind="stable")
    assert insert(surface, image, room_for(image), order, gains, places, 3) == 3
    assert np.count_nonzero(surface.leaving >= 0) == 31


def test_there_is_nothing_to_gain_where_there_is_no_error() -> None:
    image = evenly(np.full((12, 10, 3), 70, dtype=np.uint8))
    vertices = scattered(10, 12, 4, 0)
    surface = open_surface(image, vertices, np.full((len(vertices), 3), 70.0))
    gains, _ = proposals(surface, image)
    assert (gains <= 0).all()


# --- Moving ---------------------------------------------------------------------------------------


def walk(surface: Surface, image: WeightedImage, v: int) -> tuple[float, list[tuple[int, int]]]:
    """The places that a vertex moves to one after the other, and the error in the last."""
    far = (2 * image.samples.shape[1], 2 * image.samples.shape[0])
    faces = triangles_of(surface).tolist()
    points, colors = surface.points.copy(), surface.colors.copy()
    start = (int(points[v, 0]), int(points[v, 1]))

    def is_allowed(place: tuple[int, int]) -> bool:
        """Whether a place is inside the canvas, or on the side on which the vertex was."""
        return place != tuple(points[v]) and all(
            p == q if q in (0, limit) else 0 < p < limit
            for p, q, limit in zip(place, start, far, strict=True)
        )

    def error_at(place: tuple[int, int]) -> float:
        return twins.star_error(points, faces, colors, image, v, place, RIDGE)

    steps = [(2 * x, 2 * y) for x, y in product(range(-REACH, REACH + 1), repeat=2)]
    place, least = start, error_at(start)
    path: list[tuple[int, int]] = []
    while len(path) < MAX_STEPS:
        colors[v] = twins.best_color(points, faces, colors, image, v, RIDGE)
        changes = twins.predicted_changes(points, faces, colors, image, v, steps)
        places = [(place[0] + x, place[1] + y) for x, y in sorted(steps, key=changes.__getitem__)]
        tried = [p for p in places if is_allowed(p)][:N_TRIES]
        better = [p for p in tried if error_at(p) < least - LEAST_GAIN]
        if not better:
            break
        place, least = better[0], error_at(better[0])
        points[v] = place
        path.append(place)
    return least, path


@pytest.mark.parametrize("seed", range(4))
def test_a_vertex_walks_to_better_places_by_the_largest_predicted_decrease(seed: int) -> None:
    image = unevenly(noise(20, 24, 3, seed))
    work = room_for(image)
    for v in range(16):
        surface = surface_on(image, 8, seed)
        corner = all(p in (0, limit) for p, limit in zip(surface.points[v], (48, 40), strict=True))
        least, path = (0.0, []) if corner else walk(surface, image, v)
        before = surface.points[v].tolist()
        surface.dirty[:v] = False
        # Those after it would be woken up by its move.
        surface.leaving[v + 1 :] = -1
        moved = relocate(surface, image, work, np.arange(len(surface.points)))
        check_errors(surface, image)
        assert moved == bool(path)
        assert surface.points[v].tolist() == [*map(list, path), before][len(path) - 1]
        if not corner:
            star = [t for t, face in enumerate(triangles_of(surface)) if v in face]
            held = RIDGE * np.square(surface.colors[v]).sum()
            assert surface.errors[star].sum() + held == pytest.approx(least)


@pytest.mark.parametrize("n_components", [1, 3, 4])
@pytest.mark.parametrize("seed", range(3))
def test_moving_never_raises_the_error(n_components: int, seed: int) -> None:
    image = unevenly(noise(40, 50, n_components, seed))
    surface = surface_on(image, 24, seed)
    work = room_for(image)
    before = surface.errors.sum()
    for _ in range(6):
        moved = relocate(surface, image, work, np.arange(len(surface.points)))
        after = surface.errors.sum()
        assert after <= before
        before = after
        check_surface(surface, 50, 40)
        check_errors(surface, image)
        assert measure_all(surface, image) == pytest.approx(after)
    assert moved < 10


def test_vertices_come_to_rest_when_nothing_around_them_changes() -> None:
    image = evenly(step_edge(40, 50))
    surface = surface_on(image, 24, 5)
    work = room_for(image)
    for _ in range(100):
        if not relocate(surface, image, work, np.arange(len(surface.points))):
            break
    assert not surface.dirty[surface.leaving >= 0].all()
    points = surface.points.copy()
    assert relocate(surface, image, work, np.arange(len(surface.points))) == 0
    assert np.array_equal(surface.points, points)


def test_border_vertices_stay_on_their_side_and_corners_where_they_are() -> None:
    image = unevenly(noise(30, 40, 3))
    surface = surface_on(image, 20, 3)
    before = surface.points.copy()
    for _ in range(5):
        relocate(surface, image, room_for(image), np.arange(len(surface.points)))
    far = np.array([80, 60])
    on_border = (before == 0) | (before == far)
    assert np.array_equal(surface.points[on_border], before[on_border])
    assert (((surface.points == 0) | (surface.points == far)) == on_border).all()
    assert (surface.points[~on_border] % 2 == 1).all()


# --- Flipping -------------------------------------------------------------------------------------


def flip_gains(surface: Surface, image: WeightedImage) -> list[float]:
    """What the flip of each edge of a convex quadrilateral would gain."""
    faces = [tuple(face) for face in triangles_of(surface).tolist()]
    edges = twins.directed_edges(faces)
    gains = []
    for (b, c), e in edges.items():
        if (c, b) not in edges or b > c:
            continue
        t, u = e // 3, edges[c, b] // 3
        (a,) = set(faces[t]) - {b, c}
        (d,) = set(faces[u]) - {b, c}
        flipped = [(a, d, c), (d, a, b)]
        corners = [[tuple(surface.points[v].tolist()) for v in face] for face in flipped]
        if min(twins.doubled_area(*face) for face in corners) <= 0:
            continue
        own = surface.colors, image
        before = sum(twins.triangle_errors(surface.points, [faces[t], faces[u]], *own))
        gains.append(before - sum(twins.triangle_errors(surface.points, flipped, *own)))
    return gains


@pytest.mark.parametrize("seed", range(5))
def test_flips_lower_the_error_until_none_is_left_that_would(seed: int) -> None:
    image = unevenly(noise(30, 40, 3, seed))
    surface = surface_on(image, 16, seed)
    work = room_for(image)
    assert max(flip_gains(surface, image)) > 0
    before = surface.errors.sum()
    for _ in range(50):
        flipped = flip_edges(surface, image, work, 0.0)
        check_surface(surface, 40, 30)
        check_errors(surface, image)
        if not flipped:
            break
        assert surface.errors.sum() < before
        before = surface.errors.sum()
    assert flipped == 0
    assert max(flip_gains(surface, image)) <= 1e-2


@pytest.mark.parametrize("seed", range(5))
def test_an_edge_that_is_not_delaunay_has_to_gain_its_charge(seed: int) -> None:
    image = unevenly(noise(30, 40, 3, seed))
    free, charged, dear = (surface_on(image, 16, seed) for _ in range(3))
    work = room_for(image)
    implied = {tuple(face) for face in triangles_of(dear).tolist()}
    charge = 0.5 * max(flip_gains(dear, image))
    counts = []
    for surface, cost in ((free, 0.0), (charged, charge), (dear, 1e12)):
        n_flipped = 0
        for _ in range(50):
            before = surface.errors.sum()
            flipped = flip_edges(surface, image, work, cost)
            n_flipped += flipped
            if not flipped:
                break
            assert before - surface.errors.sum() > (cost if surface is charged else 0.0) - 1e-6
        counts.append(n_flipped)
    assert counts[0] > counts[1] > counts[2] == 0
    assert {tuple(face) for face in triangles_of(dear).tolist()} == implied


def test_a_high_charge_leads_back_to_the_delaunay_triangles() -> None:
    image = unevenly(noise(30, 40, 3))
    surface = surface_on(image, 16, 1)
    implied = {frozenset(face) for face in triangles_of(surface).tolist()}
    work = room_for(image)
    while flip_edges(surface, image, work, 0.0):
        pass
    assert {frozenset(face) for face in triangles_of(surface).tolist()} != implied
    while flip_edges(surface, image, work, 1e12):
        check_surface(surface, 40, 30)
    assert {frozenset(face) for face in triangles_of(surface).tolist()} == implied


# --- All together ---------------------------------------------------------------------------------


@given(pictures(), st.integers(0, 2**32 - 1))
def test_a_surface_stays_sound_whatever_is_done_to_it(picture: UInt8Array, seed: int) -> None:
    image = unevenly(picture, seed)
    height, width, n_components = picture.shape
    random = np.random.default_rng(seed)
    chosen = random.random((height, width)) < 0.5
    centres = [(2 * x + 1, 2 * y + 1) for y, x in np.argwhere(chosen).tolist()]
    sites = [(0, 0), (2 * width, 0), *centres, (0, 2 * height), (2 * width, 2 * height)]
    vertices = np.array(sites, dtype=np.int32)
    colors = random_colors(len(sites), n_components, seed)
    surface = open_surface(image, vertices, colors, n_spare=6)
    work = room_for(image)
    for edit in random.integers(4, size=8):
        if edit == 0:
            remove(surface, image, int(random.integers(1, 6)), np.inf)
        elif edit == 1:
            gains, places = proposals(surface, image)
            order = np.argsort(-gains, kind="stable")
            insert(surface, image, work, order[gains[order] > 0], gains, places, 4)
        elif edit == 2:
            relocate(surface, image, work, np.arange(len(surface.points)))
        else:
            flip_edges(surface, image, work, float(random.choice([0.0, 1e3])))
        check_surface(surface, width, height)
    check_errors(surface, image)


def test_a_ramp_is_held_by_its_corners_alone() -> None:
    image = evenly(ramp(20, 30))
    surface = surface_on(image, 15, 0)
    x, y = surface.points.T / 2 - 0.5
    surface.colors[:] = np.stack([255 * x / 29, 255 * y / 19, 255 - 255 * x / 29], axis=1)
    measure_all(surface, image)
    before = surface.errors.sum()
    assert remove(surface, image, 100, np.inf) == 19
    # Rounding to whole levels is all that is left.
    assert surface.errors.sum() < 1.2 * before < 0.2 * image.samples.size
