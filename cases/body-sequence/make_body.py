#!/usr/bin/env python3
"""Writes body/body_0001.obj ... body_0012.obj beside this file: a round body that stretches, bends and comes back."""
import math
from pathlib import Path

FRAMES, AROUND, RINGS, RADIUS = 12, 18, 9, 0.17  # of the sequence, quads around, rings of vertices, m


def place(ring, k, phase):
    """Of a vertex of the ball at rest, how far it is carried by a phase between 0 and 1."""
    polar, angle = math.pi * ring / (RINGS + 1), 2 * math.pi * k / AROUND
    x = RADIUS * math.cos(polar) * (1 + 0.5 * phase)
    y, z = (RADIUS * math.sin(polar) * f(angle) * (1 - 0.2 * phase) for f in (math.cos, math.sin))
    return x, y, z + phase * (0.08 - 1.8 * x * x)


def faces():
    """The numbers of the vertices, from 1; the two ends are the last."""
    def at(ring, k):
        return (ring - 1) * AROUND + k % AROUND + 1
    first, last = RINGS * AROUND + 1, RINGS * AROUND + 2
    for k in range(AROUND):
        yield first, at(1, k), at(1, k + 1)
        for ring in range(1, RINGS):
            yield at(ring, k), at(ring + 1, k), at(ring + 1, k + 1), at(ring, k + 1)
        yield at(RINGS, k), last, at(RINGS, k + 1)


for frame in range(FRAMES):
    phase = math.sin(math.pi * frame / (FRAMES - 1)) ** 2
    vertices = [place(ring, k, phase) for ring in range(1, RINGS + 1) for k in range(AROUND)]
    vertices += [place(0, 0, phase), place(RINGS + 1, 0, phase)]
    with open(Path(__file__).parent / "body" / f"body_{frame + 1:04}.obj", "w") as file:
        file.writelines("v {:.5f} {:.5f} {:.5f}\n".format(*v) for v in vertices)
        file.writelines("f " + " ".join(map(str, face)) + "\n" for face in faces())
