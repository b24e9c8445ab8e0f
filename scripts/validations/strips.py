"""Strips in the plane x-z, clamped at x = 0, cut into cells in three ways."""
import math

import numpy as np


def equilateral(length, spacing, rows):
    """Rows of triangles with equal sides; every other row of vertices is shifted by half a side, and filled at its
    ends."""
    columns, lines = round(length / spacing), []
    places: list[tuple[float, float]] = []
    for j in range(rows + 1):
        shifted = np.r_[0, (np.arange(columns) + 0.5) * spacing, columns * spacing]
        x = shifted if j % 2 else np.arange(columns + 1) * spacing
        lines.append(range(len(places), len(places) + len(x)))
        places += [(at, j * spacing * math.sqrt(3) / 2) for at in x]
    return np.array(places), [face for lower, upper in zip(lines, lines[1:]) for face in between(places, lower, upper)]


def between(places, lower, upper):
    """Triangles between two rows of vertices, from left to right: always the shorter next side."""
    i = k = 0
    while i < len(lower) - 1 or k < len(upper) - 1:
        along_lower = k == len(upper) - 1 or (i < len(lower) - 1 and places[lower[i + 1]][0] < places[upper[k + 1]][0])
        yield (lower[i], lower[i + 1], upper[k]) if along_lower else (lower[i], upper[k + 1], upper[k])
        i, k = (i + 1, k) if along_lower else (i, k + 1)


def grid(length, spacing, rows):
    """Vertices, and the four corners of each square."""
    columns = round(length / spacing)
    places = np.array([(i * spacing, j * spacing) for j in range(rows + 1) for i in range(columns + 1)])
    corners = [(j * (columns + 1) + i, j * (columns + 1) + i + 1, (j + 1) * (columns + 1) + i + 1,
                (j + 1) * (columns + 1) + i)
               for j in range(rows) for i in range(columns)]
    return places, corners


def quads(length, spacing, rows):
    return grid(length, spacing, rows)


def alternating(length, spacing, rows):
    """Squares cut along one diagonal and the other in turn."""
    places, corners = grid(length, spacing, rows)
    columns, faces = round(length / spacing), []
    for number, (p, q, r, s) in enumerate(corners):
        faces += [(p, q, r), (p, r, s)] if sum(divmod(number, columns)) % 2 == 0 else [(p, q, s), (q, r, s)]
    return places, faces


def write(path, vertices, faces=()):
    """As an OBJ file."""
    path.write_text("".join(f"v {x:.17g} {y:.17g} {z:.17g}\n" for x, y, z in vertices) +
                    "".join("f " + " ".join(str(i + 1) for i in face) + "\n" for face in faces))
    return str(path)


def one_way(length, spacing, rows):
    """Squares all cut along the same diagonal."""
    places, corners = grid(length, spacing, rows)
    return places, [face for p, q, r, s in corners for face in ((p, q, r), (p, r, s))]


def irregular(length, spacing, rows):
    """Equilateral triangles whose inner vertices, but those of the two columns that are held, are moved at random."""
    places, faces = equilateral(length, spacing, rows)
    inside = (places[:, 0] > 1.6 * spacing) & (places[:, 0] < length - 0.6 * spacing) & (places[:, 1] > 0) & \
        (places[:, 1] < places[:, 1].max())
    places[inside] += np.random.default_rng(1).uniform(-0.25, 0.25, (inside.sum(), 2)) * spacing
    return places, faces
