#!/usr/bin/env python3
"""Writes layers.obj beside this file: two square cloths of quads in one mesh, the upper one turned by 45 degrees."""
from pathlib import Path

import numpy as np

SIDE, VERTICES, BELOW, ABOVE = 0.9, 46, 0.30, 0.32  # m, along a side, m, m


def sheet(angle, height):
    line = np.linspace(-SIDE / 2, SIDE / 2, VERTICES)
    x, y = np.meshgrid(line, line)
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * x - s * y, s * x + c * y, np.full_like(x, height)], -1).reshape(-1, 3)


points = np.concatenate([sheet(0.0, BELOW), sheet(np.pi / 4, ABOVE)])
row, column = np.meshgrid(np.arange(VERTICES - 1), np.arange(VERTICES - 1), indexing="ij")
first = (row * VERTICES + column).ravel() + 1
quads = np.stack([first, first + 1, first + VERTICES + 1, first + VERTICES], -1)
with open(Path(__file__).parent / "layers.obj", "w") as file:
    file.write("# Two square cloths; made by make_layers.py\n")
    file.writelines("v {:.6f} {:.6f} {:.6f}\n".format(*p) for p in points)
    for quad in np.concatenate([quads, quads + VERTICES**2]):
        file.write("f " + " ".join(map(str, quad)) + "\n")
