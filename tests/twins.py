"""Slow, obvious versions of the kernels, in plain Python integers and fractions."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from itertools import combinations, pairwise

import numpy as np

from vmesh.arrays import Float64Array, Int64Array, UInt8Array, UInt16Array
from vmesh.kernels.remeshing import WeightedImage

Point = tuple[int, int]
Face = tuple[int, int, int]


def doubled_area(a: Point, b: Point, c: Point) -> int:
    """Positive where a, b, c turn from the x axis towards y."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def in_circle_determinant(a: Point, b: Point, c: Point, d: Point) -> int:
    """Positive if d is inside the circle of the positively oriented a, b, c."""
    (ax, ay), (bx, by), (cx, cy) = ((p[0] - d[0], p[1] - d[1]) for p in (a, b, c))
    return (
        (ax * ax + ay * ay) * (bx * cy - by * cx)
        + (bx * bx + by * by) * (cx * ay - cy * ax)
        + (cx * cx + cy * cy) * (ax * by - ay * bx)
    )


def is_inside(points: Sequence[Point], face: Face, d: int) -> bool:
    """Whether point d lies inside the circle of a face, ties broken as the format says.

    A point's height x**2 + y**2 on the paraboloid is lowered by an infinitesimal, which of the
    point that is last in raster order is infinitely larger than that of any other. d is inside
    if it lies below the plane of the lifted face.
    """
    a, b, c = (points[v] for v in face)
    determinant = in_circle_determinant(a, b, c, points[d])
    if determinant:
        return determinant > 0
    last = max(*face, d)
    if last == d:
        return True
    # The plane below d sinks or rises with the last corner, as d's barycentric weight says.
    at = face.index(last)
    weight = doubled_area(points[d], points[face[at - 2]], points[face[at - 1]])
    return weight < 0


def canonical_delaunay(points: Sequence[Point]) -> list[Face]:
    """Every positive triangle with no other point inside its circle: lowest first, sorted."""
    faces = []
    for i, j, k in combinations(range(len(points)), 3):
        area = doubled_area(points[i], points[j], points[k])
        if area == 0:
            continue
        face = (i, j, k) if area > 0 else (i, k, j)
        if not any(is_inside(points, face, d) for d in range(len(points)) if d not in face):
            faces.append(face)
    return sorted(faces)


def hull_doubled_area(points: Iterable[Point]) -> int:
    """Doubled area of the convex hull, by Andrew's monotone chain."""
    ordered = sorted(points)
    total = 0
    for run in (ordered, ordered[::-1]):
        chain: list[Point] = []
        for p in run:
            while len(chain) > 1 and doubled_area(chain[-2], chain[-1], p) <= 0:
                chain.pop()
            chain.append(p)
        total += sum(a[0] * b[1] - a[1] * b[0] for a, b in pairwise(chain))
    return total


def diffuse(
    salience: UInt16Array,
    scale: int,
    floor: int,
    weights: Int64Array,
    strengths: Int64Array,
    seed: int,
) -> UInt8Array:
    """Multi-class error diffusion with one array of errors for the whole picture."""
    n_classes, height, width = salience.shape
    one = 255 * 256
    classes = np.zeros((height, width), dtype=np.uint8)
    errors: dict[tuple[int, int, int], int] = {}
    random = (seed * 2654435761 + 1013904223) % 2**32 or 1
    for y in range(height):
        step = -1 if y % 2 else 1
        for x in range(width)[::step]:
            wanted = [
                min(one, int(salience[i, y, x]) * scale // 2**16 + floor) for i in range(n_classes)
            ]
            if sum(wanted) > one:
                wanted = [value * one // sum(wanted) for value in wanted]
                level = 255
            else:
                level = (sum(wanted) + 128) // 256
            corrected = [wanted[i] + errors.get((i, y, x), 0) for i in range(n_classes)]
            random ^= random << 13 & 0xFFFFFFFF
            random ^= random >> 17
            random ^= random << 5 & 0xFFFFFFFF
            strength = int(strengths[level])
            threshold = 128 * 256 + random % 128 * strength // 256 if strength else 127 * 256
            if sum(corrected) > threshold:
                chosen = corrected.index(max(corrected))
                classes[y, x] = chosen + 1
                corrected[chosen] -= one
            right, behind, _ = (int(share) for share in weights[level])
            for i, error in enumerate(corrected):
                ahead, back = error * right // 2**16, error * behind // 2**16
                shares = {(y, x + step): ahead, (y + 1, x - step): back}
                shares[y + 1, x] = error - ahead - back
                for (row, column), share in shares.items():
                    errors[i, row, column] = errors.get((i, row, column), 0) + share
    return classes


def pixel_weights(corners: Sequence[Point], x: int, y: int) -> tuple[int, int, int] | None:
    """Doubled areas of the parts of a positive triangle around a pixel's centre.

    None if the pixel does not belong to it: its centre is outside, or on an edge that is neither
    a left nor a level top edge. Coordinates are in 1/256 pixel.
    """
    centre = (256 * x + 128, 256 * y + 128)
    parts = []
    for i in range(3):
        start, end = corners[(i + 1) % 3], corners[(i + 2) % 3]
        part = doubled_area(start, end, centre)
        upward = end[1] < start[1]
        rightward = end[1] == start[1] and end[0] > start[0]
        if part < 0 or (part == 0 and not (upward or rightward)):
            return None
        parts.append(part)
    return parts[0], parts[1], parts[2]


def fill(
    vertices: Int64Array, triangles: Iterable[Sequence[int]], colors: UInt8Array, raster: UInt8Array
) -> None:
    """Draw triangles with exact interpolation; those without positive area are left out."""
    for face in triangles:
        corners = [(int(vertices[v, 0]), int(vertices[v, 1])) for v in face]
        det = doubled_area(corners[0], corners[1], corners[2])
        if det <= 0:
            continue
        for y, x in np.ndindex(raster.shape[:2]):
            parts = pixel_weights(corners, x, y)
            if parts is None:
                continue
            for z in range(raster.shape[2]):
                total = sum(w * int(colors[v, z]) for w, v in zip(parts, face, strict=True))
                raster[y, x, z] = (2 * total + det) // (2 * det)


def barycentric_matrix(
    vertices: Int64Array, triangles: Iterable[Sequence[int]], height: int, width: int
) -> Float64Array:
    """Weights of the vertices at every pixel's centre, shape (h w, n)."""
    matrix = np.zeros((height * width, len(vertices)))
    for face in triangles:
        corners = [(int(vertices[v, 0]), int(vertices[v, 1])) for v in face]
        det = doubled_area(corners[0], corners[1], corners[2])
        for y, x in np.ndindex(height, width):
            parts = pixel_weights(corners, x, y)
            if parts is not None:
                matrix[y * width + x, list(face)] = np.array(parts) / det
    return matrix


def range_coded(bits: Iterable[tuple[int, int]], n_contexts: int) -> bytes:
    """Bytes of (context, bit) pairs: the adaptive range coder on one unbounded integer.

    The carry needs no care here: `low` is the whole number written so far.
    """
    model = [[1 << 15, 0] for _ in range(n_contexts)]
    low, span, n_bytes = 0, 2**32, 4
    for context, bit in bits:
        probability, seen = model[context]
        split = (span >> 12) * (probability >> 4)
        if bit:
            span = split
        else:
            low, span = low + split, span - split
        moved = probability + (65536 * bit - probability) // (seen + 2)
        model[context] = [min(max(moved, 64), 65472), min(seen + 1, 250)]
        while span < 2**24:
            low, span, n_bytes = low << 8, span << 8, n_bytes + 1
    # Of the numbers in the final range, the one that ends in the most zero bits.
    for zeros in range(32, -1, -1):
        value = -(-low >> zeros) << zeros
        if value < low + span:
            break
    return value.to_bytes(n_bytes, "big").rstrip(b"\0")


def directed_edges(triangles: Iterable[Sequence[int]]) -> dict[tuple[int, int], int]:
    """Where each directed edge stands among the half-edges: 3 t + i leaves corner i of t."""
    edges = {}
    for t, face in enumerate(triangles):
        for i in range(3):
            edges[int(face[i]), int(face[(i + 1) % 3])] = 3 * t + i
    return edges


def squares(image: WeightedImage) -> float:
    """The error of a mesh that is black all over."""
    counted = image.weights[:, :, None] * np.square(image.samples, dtype=np.float64)
    return float(counted.sum())


def triangle_errors(
    points: Int64Array,
    triangles: Iterable[Sequence[int]],
    colors: Float64Array,
    image: WeightedImage,
) -> list[float]:
    """Squared error of each triangle over the pixels it holds, by looking at every pixel.

    `points` are in half pixels; a centre on an edge belongs to the triangle right of or below it.
    """
    samples, weights = image
    height, width = weights.shape
    x, y = 2 * np.arange(width)[None, :] + 1, 2 * np.arange(height)[:, None] + 1
    errors = []
    for face in triangles:
        corners = [(int(points[v, 0]), int(points[v, 1])) for v in face]
        det = doubled_area(corners[0], corners[1], corners[2])
        inside = np.ones((height, width), dtype=bool)
        value = np.zeros(samples.shape)
        for i in range(3):
            (ax, ay), (bx, by) = corners[(i + 1) % 3], corners[(i + 2) % 3]
            part = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
            counts = by < ay or (by == ay and bx > ax)
            inside &= (part > 0) | ((part == 0) & counts)
            value += (part / det)[:, :, None] * colors[face[i]]
        squares = weights[:, :, None] * (value - samples) ** 2
        errors.append(float(squares[inside].sum()))
    return errors


def star_error(
    points: Int64Array,
    triangles: Iterable[Sequence[int]],
    colors: Float64Array,
    image: WeightedImage,
    v: int,
    place: Point,
    ridge: float,
) -> float:
    """Least error of the triangles around a vertex if it stood at a place, over all its colours.

    A ridge holds the colour where next to no pixel tells. Infinite if a triangle were turned over.
    """
    star = [face for face in triangles if v in face]
    moved = points.copy()
    moved[v] = place
    for face in star:
        corners = [(int(moved[u, 0]), int(moved[u, 1])) for u in face]
        if doubled_area(corners[0], corners[1], corners[2]) <= 0:
            return float("inf")
    return sum(
        constant - slope * slope / (4 * (bend + ridge))
        for constant, slope, bend in color_parabolas(moved, star, colors, image, v)
    )


def best_color(
    points: Int64Array,
    triangles: Iterable[Sequence[int]],
    colors: Float64Array,
    image: WeightedImage,
    v: int,
    ridge: float,
) -> Float64Array:
    """Colour of a vertex that leaves the least error; as :func:`star_error`."""
    star = [face for face in triangles if v in face]
    parabolas = color_parabolas(points, star, colors, image, v)
    return np.array([-slope / (2 * (bend + ridge)) for _, slope, bend in parabolas])


def color_parabolas(
    points: Int64Array,
    star: Sequence[Sequence[int]],
    colors: Float64Array,
    image: WeightedImage,
    v: int,
) -> list[tuple[float, float, float]]:
    """The error as a parabola in each component of a vertex's colour, from three of its points."""
    parabolas = []
    for z in range(image.samples.shape[2]):
        component = image._replace(samples=image.samples[:, :, z : z + 1])
        values = []
        for color in (0.0, 1.0, 2.0):
            tried = colors[:, z : z + 1].copy()
            tried[v] = color
            values.append(sum(triangle_errors(points, star, tried, component)))
        bend = (values[2] - 2 * values[1] + values[0]) / 2
        parabolas.append((values[0], values[1] - values[0] - bend, bend))
    return parabolas


def predicted_changes(
    points: Int64Array,
    triangles: Iterable[Sequence[int]],
    colors: Float64Array,
    image: WeightedImage,
    v: int,
    steps: Iterable[Point],
) -> dict[Point, float]:
    """What each step of a vertex would change the error by, were every pixel linear in it.

    A step d changes a pixel of weight w, in a triangle of gradient g, by w (k - g d), where k is
    the change of the vertex's colour, which is the best for each step.
    """
    height, width = image.weights.shape
    # Component, residual, weight, and weight times gradient, by the root of what the pixel counts.
    rows = []
    for face in triangles:
        if v not in face:
            continue
        first = list(face).index(v)
        own = [face[(first + i) % 3] for i in range(3)]
        corners = [(int(points[u, 0]), int(points[u, 1])) for u in own]
        sides = np.array([corners[1], corners[2]], dtype=float) - corners[0]
        gradients = np.linalg.solve(sides, colors[own[1:]] - colors[own[0]])
        fine = [(128 * x, 128 * y) for x, y in corners]
        for y, x in np.ndindex(height, width):
            parts = pixel_weights(fine, x, y)
            if parts is None:
                continue
            weights = np.array(parts) / sum(parts)
            root = np.sqrt(image.weights[y, x])
            for z in range(image.samples.shape[2]):
                residual = float(image.samples[y, x, z]) - weights @ colors[own, z]
                weight = root * weights[0]
                rows.append((z, root * residual, weight, *(weight * gradients[:, z])))
    table = np.array(rows)
    changes = {}
    for step in steps:
        total = 0.0
        for z in range(image.samples.shape[2]):
            _, residual, weight, slope_x, slope_y = table[table[:, 0] == z].T
            moved = residual + slope_x * step[0] + slope_y * step[1]
            change = (weight @ moved) / (weight @ weight)
            total += float(((moved - weight * change) ** 2).sum() - (residual**2).sum())
        changes[step] = total
    return changes


def independent_set(
    triangles: Iterable[Sequence[int]], kept: Sequence[bool], max_triangles: int
) -> dict[int, set[int]]:
    """Vertices taken in order unless a neighbour was, with their neighbours."""
    around: list[set[int]] = [set() for _ in kept]
    counts = [0] * len(kept)
    for face in triangles:
        for v in face:
            around[v] |= set(face) - {v}
            counts[v] += 1
    taken: dict[int, set[int]] = {}
    for v, neighbours in enumerate(around):
        if not kept[v] and counts[v] <= max_triangles and not neighbours & set(taken):
            taken[v] = neighbours
    return taken


def hierarchy(points: Sequence[Point], max_triangles: int) -> list[tuple[int, set[int]]]:
    """Vertices in the order in which their colours are coded, each with its parents."""
    far = (max(p[0] for p in points), max(p[1] for p in points))
    left = list(range(len(points)))
    levels: list[list[tuple[int, set[int]]]] = []
    while True:
        faces = canonical_delaunay([points[v] for v in left])
        corners = [all(c in (0, f) for c, f in zip(points[v], far, strict=True)) for v in left]
        taken = independent_set(faces, corners, max_triangles)
        if not taken:
            break
        levels.append([(left[v], {left[u] for u in around}) for v, around in taken.items()])
        left = [v for i, v in enumerate(left) if i not in taken]
    last = [(v, {left[i - 1]} if i else set()) for i, v in enumerate(left)]
    return [entry for level in [last, *levels[::-1]] for entry in level]


def thinned(
    n: int,
    n_remove: int,
    cost: Callable[[int, list[int]], float],
    around: Callable[[int, list[int]], set[int]],
) -> list[int]:
    """What is left of n vertices when the one that costs least goes, again and again.

    The cost of a neighbour of what has gone is computed anew when it comes up as the least.
    """
    left = list(range(n))
    costs = {v: cost(v, left) for v in left}
    outdated: set[int] = set()
    while n - len(left) < n_remove:
        v = min(costs, key=lambda v: costs[v])
        if v in outdated:
            outdated.remove(v)
            costs[v] = cost(v, left)
        else:
            outdated |= around(v, left)
            left.remove(v)
            del costs[v]
    return left
