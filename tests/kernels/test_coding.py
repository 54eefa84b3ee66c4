from __future__ import annotations

from math import comb

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests import twins
from tests.strategies import flipped, lattices, meshes, point_sets, raster_sorted
from vmesh.arrays import Int32Array, UInt8Array
from vmesh.codec.hierarchy import Hierarchy, build_hierarchy
from vmesh.codec.mesh_coder import Decoder, Encoder, encode, find_flips
from vmesh.color_lattice import ColorLattice
from vmesh.errors import FormatError
from vmesh.kernels.coding import colors, flips, positions, range_coder, triangle_list
from vmesh.kernels.delaunay import delaunay
from vmesh.mesh import Mesh

N_CONTEXTS = 5
Bits = list[tuple[int, int]]


def written(bits: Bits) -> bytes:
    """Bytes of (context, bit) pairs."""
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(N_CONTEXTS)
    data = np.zeros(len(bits) + 8, np.uint8)
    range_coder.start(coder, data, 0)
    for context, bit in bits:
        range_coder.code_bit(coder, data, model, context, bit)
    return data[: range_coder.finish(coder, data)].tobytes()


def read(data: bytes, contexts: list[int]) -> list[int]:
    """The bits that are read by the probabilities of these contexts."""
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(N_CONTEXTS)
    given_bytes = np.frombuffer(bytearray(data), np.uint8)
    range_coder.start(coder, given_bytes, 1)
    return [range_coder.code_bit(coder, given_bytes, model, context, 0) for context in contexts]


def as_bytes(data: bytes) -> UInt8Array:
    return np.frombuffer(bytearray(data), np.uint8)


def bit_lists() -> st.SearchStrategy[Bits]:
    return st.lists(st.tuples(st.integers(0, N_CONTEXTS - 1), st.integers(0, 1)), max_size=300)


@given(bit_lists())
def test_bits_are_written_as_on_one_unbounded_integer(bits: Bits) -> None:
    assert written(bits) == twins.range_coded(bits, N_CONTEXTS)


@given(bit_lists())
def test_bits_come_back(bits: Bits) -> None:
    assert read(written(bits), [context for context, _ in bits]) == [bit for _, bit in bits]


@pytest.mark.parametrize("share", [0.0, 0.001, 0.03, 0.3, 0.5, 0.9, 0.999, 1.0])
def test_long_sequences_of_any_probability_come_back_and_carry_rightly(share: float) -> None:
    random = np.random.default_rng(4)
    contexts = random.integers(0, N_CONTEXTS, 20_000)
    ones = (random.random(20_000) < share).astype(int)
    bits = list(zip(contexts.tolist(), ones.tolist(), strict=True))
    data = written(bits)
    assert data == twins.range_coded(bits, N_CONTEXTS)
    assert read(data, contexts.tolist()) == [bit for _, bit in bits]
    entropy_in_bytes = 0.0
    if 0 < share < 1:
        entropy_in_bytes = -share * np.log2(share) - (1 - share) * np.log2(1 - share)
        entropy_in_bytes *= 20_000 / 8
    assert len(data) < 1.05 * entropy_in_bytes + 60


def test_a_run_of_bytes_to_carry_through_is_written_rightly() -> None:
    # Zeros raise the low end; after enough of them it stands just below a carry.
    for n in range(200):
        bits = [(0, 0)] * n + [(1, 1)] * 3 + [(2, 0)] * 40
        assert written(bits) == twins.range_coded(bits, N_CONTEXTS)


def test_nothing_takes_no_bytes() -> None:
    assert written([]) == b""


def test_probabilities_stay_within_their_bounds() -> None:
    for bit in (0, 1):
        coder = np.zeros(range_coder.N_FIELDS, np.int64)
        model = range_coder.even_model(1)
        data = np.zeros(4096, np.uint8)
        range_coder.start(coder, data, 0)
        for _ in range(20_000):
            range_coder.code_bit(coder, data, model, 0, bit)
        probability, seen = model[0].tolist()
        assert 64 <= probability <= 65472
        assert seen == range_coder.RATE_LIMIT


@given(st.lists(st.integers(0, 2**31 - 2), max_size=60))
def test_numbers_come_back(numbers: list[int]) -> None:
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(triangle_list.NUMBER_CONTEXTS)
    data = np.zeros(4096, np.uint8)
    range_coder.start(coder, data, 0)
    for number in numbers:
        assert triangle_list.code_number(coder, data, model, 0, number) == number
    payload = data[: range_coder.finish(coder, data)].copy()
    model = range_coder.even_model(triangle_list.NUMBER_CONTEXTS)
    range_coder.start(coder, payload, 1)
    assert [triangle_list.code_number(coder, payload, model, 0, 0) for _ in numbers] == numbers


@given(st.lists(st.integers(0, 2**11 + 12), max_size=60))
def test_sizes_come_back(sizes: list[int]) -> None:
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(colors.SIZE_CONTEXTS)
    data = np.zeros(4096, np.uint8)
    range_coder.start(coder, data, 0)
    for size in sizes:
        assert colors.code_size(coder, data, model, 0, size) == size
    payload = data[: range_coder.finish(coder, data)].copy()
    model = range_coder.even_model(colors.SIZE_CONTEXTS)
    range_coder.start(coder, payload, 1)
    assert [colors.code_size(coder, payload, model, 0, 0) for _ in sizes] == sizes


def test_a_size_of_too_many_bits_is_refused() -> None:
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(colors.SIZE_CONTEXTS)
    range_coder.start(coder, as_bytes(bytes(64)), 0)
    assert colors.code_size(coder, as_bytes(bytes(64)), model, 0, 2**17 + 12) == 2**17 + 12
    assert colors.code_size(coder, as_bytes(bytes(64)), model, 0, 2**17 + 13) == -1
    model = range_coder.even_model(colors.SIZE_CONTEXTS)
    range_coder.start(coder, as_bytes(bytes(64)), 1)  # Zeros are read as ones for ever.
    assert colors.code_size(coder, as_bytes(bytes(64)), model, 0, 0) == -1


def test_probabilities_at_the_start_are_within_the_bounds_of_all() -> None:
    levels = [colors.initial_level_model(n_components) for n_components in (1, 3, 4)]
    for model in (positions.initial_split_model(), flips.initial_flip_model(), *levels):
        assert model.dtype == np.int64
        assert (model[:, 0] >= 64).all()
        assert (model[:, 0] <= 65472).all()
        assert set(model[:, 1].tolist()) <= {0, 16}
    assert len(positions.initial_split_model()) == positions.SPLIT_CONTEXTS
    assert len(flips.initial_flip_model()) == flips.FLIP_CONTEXTS
    assert [len(model) for model in levels] == [n * colors.COMPONENT_CONTEXTS for n in (1, 3, 4)]


@pytest.mark.parametrize("count", range(1, positions.N_SMALL))
def test_probabilities_at_the_start_spread_the_points_evenly_over_both_halves(count: int) -> None:
    # By those of the steps of the search, every number of points has its binomial probability.
    area = 5
    model = positions.initial_split_model().reshape(-1, 2)
    for number in range(count + 1):
        low, high, chance = 0, count, 1.0
        while low < high:
            middle = (low + high) >> 1
            context = (area * positions.N_SMALL + count) * positions.N_SMALL + middle
            more = model[context, 0] / 65536
            if number > middle:
                low, chance = middle + 1, chance * more
            else:
                high, chance = middle, chance * (1 - more)
        assert chance == pytest.approx(comb(count, number) / 2**count, rel=1e-3)


@given(point_sets())
def test_positions_come_back_in_raster_order(drawn: tuple[int, int, Int32Array]) -> None:
    columns, rows, points = drawn
    payload = encode(lambda encoder: encoder.positions(points[::-1].copy(), columns, rows))
    assert np.array_equal(Decoder(payload, 0).positions(len(points), columns, rows), points)


def test_a_full_lattice_takes_no_bytes() -> None:
    y, x = np.mgrid[:13, :9]
    points = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
    payload = encode(lambda encoder: encoder.positions(points, 9, 13))
    assert payload == b""
    assert np.array_equal(Decoder(payload, 0).positions(117, 9, 13), points)


def test_positions_of_the_largest_lattice_come_back() -> None:
    side = (1 << 19) + 1
    points = np.array([(0, 0), (side - 1, 0), (0, side - 1), (side - 1, side - 1)], dtype=np.int32)
    payload = encode(lambda encoder: encoder.positions(points, side, side))
    assert np.array_equal(Decoder(payload, 0).positions(4, side, side), points)


@given(st.binary(max_size=60), st.integers(1, 50), st.integers(1, 50), st.integers(1, 40))
def test_any_bytes_are_distinct_positions_on_the_lattice_or_refused(
    payload: bytes, columns: int, rows: int, n: int
) -> None:
    n = min(n, columns * rows)
    try:
        points = Decoder(payload, 7).positions(n, columns, rows)
    except FormatError as error:
        assert error.code == "positions"
        return
    assert (points >= 0).all()
    assert (points < [columns, rows]).all()
    assert len(np.unique(points, axis=0)) == n


@given(meshes())
def test_triangles_come_back(mesh: Mesh) -> None:
    payload = encode(lambda encoder: encoder.triangles(mesh.triangles, mesh.n_vertices))
    result = Decoder(payload, 0).triangles(mesh.n_triangles, mesh.n_vertices)
    assert np.array_equal(result, mesh.triangles)


@given(st.binary(max_size=60), st.integers(1, 30), st.integers(1, 20))
def test_any_bytes_are_triangles_of_known_vertices_or_refused(
    payload: bytes, m: int, n_vertices: int
) -> None:
    try:
        triangles = Decoder(payload, 7).triangles(m, n_vertices)
    except FormatError as error:
        assert error.code == "triangles"
        assert 7 <= error.offset <= 7 + len(payload)
        return
    assert (triangles >= 0).all()
    assert (triangles < n_vertices).all()


def hierarchy_of(mesh: Mesh) -> Hierarchy:
    return build_hierarchy(mesh.vertices, delaunay(mesh.vertices))


@given(meshes())
def test_levels_come_back(mesh: Mesh) -> None:
    hierarchy = hierarchy_of(mesh)
    payload = encode(lambda encoder: encoder.levels(mesh.levels, hierarchy, mesh.lattice))
    assert np.array_equal(Decoder(payload, 0).levels(hierarchy, mesh.lattice), mesh.levels)


@given(meshes(), st.sampled_from([0, 1]))
def test_extreme_levels_come_back(mesh: Mesh, parity: int) -> None:
    hierarchy = hierarchy_of(mesh)
    bounds = np.stack(mesh.lattice.level_bounds())
    levels = bounds[(np.arange(mesh.n_vertices) + parity) % 2]
    payload = encode(lambda encoder: encoder.levels(levels, hierarchy, mesh.lattice))
    assert np.array_equal(Decoder(payload, 0).levels(hierarchy, mesh.lattice), levels)


@given(meshes(), lattices(), st.binary(max_size=80))
def test_any_bytes_are_levels_within_bounds_or_refused(
    mesh: Mesh, lattice: ColorLattice, payload: bytes
) -> None:
    try:
        levels = Decoder(payload, 7).levels(hierarchy_of(mesh), lattice)
    except FormatError as error:
        assert error.code == "colors"
        return
    lowest, highest = lattice.level_bounds()
    assert (levels >= lowest).all()
    assert (levels <= highest).all()


def test_smooth_colors_take_fewer_bytes_than_rough_ones() -> None:
    y, x = np.mgrid[:30, :30]
    vertices = np.stack([x.ravel(), y.ravel()], axis=1).astype(np.int32)
    hierarchy = build_hierarchy(vertices, delaunay(vertices))
    lattice = ColorLattice((1,))
    noise = np.random.default_rng(3).integers(0, 256, 900)
    sizes = []
    for levels in (3 * x.ravel() + 5 * y.ravel(), (x * y).ravel() % 40, noise):
        column = levels.astype(np.int32)[:, np.newaxis]

        def write(encoder: Encoder, own: Int32Array = column) -> None:
            encoder.levels(own, hierarchy, lattice)

        sizes.append(len(encode(write)))
    assert sizes == sorted(sizes)
    assert sizes[0] < 300 < 900 < sizes[2]


def flips_in_bytes(mesh: Mesh) -> bytes:
    """The flips from the Delaunay triangles to those of a mesh."""
    flips = find_flips(mesh)
    assert flips is not None
    return encode(lambda encoder: encoder.flips(flips, delaunay(mesh.vertices), mesh))


@given(meshes())
def test_flips_come_back(mesh: Mesh) -> None:
    decoder = Decoder(flips_in_bytes(mesh), 0)
    triangles = decoder.flips(mesh.vertices, delaunay(mesh.vertices), mesh.levels)
    assert np.array_equal(triangles, mesh.triangles)


def test_flips_on_the_largest_lattice_come_back() -> None:
    # Cotangents of the thinnest triangles of the largest canvas do not overflow.
    far = 1 << 19
    random = np.random.default_rng(9)
    thin = [(int(x), int(y)) for x, y in random.integers(0, [far + 1, 4], (60, 2))]
    sites = {*thin, *((y, far - x) for x, y in thin), (0, 0), (far, 0), (0, far), (far, far)}
    vertices = raster_sorted(np.array(sorted(sites), dtype=np.int32))
    triangles = flipped(vertices, delaunay(vertices), 60, random)
    levels = random.integers(0, 256, (len(vertices), 1), dtype=np.int32)
    mesh = Mesh(1 << 15, 1 << 15, vertices, triangles, levels, ColorLattice((1,)), 4)
    mesh.check()
    decoder = Decoder(flips_in_bytes(mesh), 0)
    result = decoder.flips(mesh.vertices, delaunay(mesh.vertices), mesh.levels)
    assert np.array_equal(result, mesh.triangles)


@given(meshes(), st.binary(max_size=120))
def test_any_bytes_are_flips_to_a_valid_mesh_or_refused(mesh: Mesh, payload: bytes) -> None:
    decoder = Decoder(payload, 7)
    try:
        triangles = decoder.flips(mesh.vertices, delaunay(mesh.vertices), mesh.levels)
    except FormatError as error:
        assert error.code == "triangles"
        assert 7 <= error.offset <= 7 + len(payload)
        return
    mesh.replaced(triangles=triangles).check()


@given(meshes())
def test_flips_without_end_are_refused(mesh: Mesh) -> None:
    # Zeros are read as ones for ever: whatever can be flipped is flipped, again and again.
    decoder = Decoder(bytes(4000), 0)
    try:
        triangles = decoder.flips(mesh.vertices, delaunay(mesh.vertices), mesh.levels)
    except FormatError as error:
        assert "out of range" in str(error)
        return
    mesh.replaced(triangles=triangles).check()


def test_a_payload_longer_than_the_first_buffer_is_written_whole() -> None:
    random = np.random.default_rng(6)
    sites = random.choice(1 << 20, 200_000, replace=False)
    points = np.stack([sites % 1024, sites // 1024], axis=1).astype(np.int32)
    payload = encode(lambda encoder: encoder.positions(points, 1024, 1024))
    assert len(payload) > 1 << 16
    expected = points[np.argsort(sites)]
    assert np.array_equal(Decoder(payload, 0).positions(200_000, 1024, 1024), expected)


def test_the_writer_never_writes_beyond_its_room() -> None:
    coder = np.zeros(range_coder.N_FIELDS, np.int64)
    model = range_coder.even_model(1)
    data = np.zeros(6, np.uint8)
    range_coder.start(coder, data[:4], 0)
    for i in range(400):
        range_coder.code_bit(coder, data[:4], model, 0, i % 2)
    assert range_coder.finish(coder, data[:4]) <= 4
    assert coder[range_coder.POSITION] > 4
    assert as_bytes(data[4:].tobytes()).tolist() == [0, 0]
