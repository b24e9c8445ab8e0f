#!/usr/bin/env python3
"""Writes disc.obj beside this file: a disc of one metre, rings of vertices in a Delaunay triangulation, whose edges run
in all directions; warp along x (`vt` is the place in the plane)."""
from pathlib import Path

import numpy as np
from matplotlib.tri import Triangulation

RINGS, RADIUS = 24, 0.5
rings = [(0.0, 0.0)]
for ring in range(1, RINGS + 1):
    count = 6 * ring
    angle = 2 * np.pi * (np.arange(count) + 0.38 * ring) / count
    rings += zip(RADIUS * ring / RINGS * np.cos(angle), RADIUS * ring / RINGS * np.sin(angle))
points = np.round(rings, 6)
triangles = Triangulation(*points.T).triangles
corners = points[triangles]
one, two = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
area = one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0]
triangles = triangles[np.abs(area) > 1e-6]  # none along the rim without an area
with open(Path(__file__).parent / "disc.obj", "w") as file:
    file.write("# A disc of triangles; made by make_disc.py\n")
    file.writelines(f"v {x:.6f} {y:.6f} 0\n" for x, y in points)
    file.writelines(f"vt {x:.6f} {y:.6f}\n" for x, y in points)
    file.writelines("f " + " ".join(f"{v + 1}/{v + 1}" for v in t) + "\n" for t in triangles)
