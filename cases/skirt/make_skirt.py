#!/usr/bin/env python3
"""Writes skirt.obj, start.obj and hips.obj beside this file: a gathered skirt and what wears it.

The skirt is cut as a flat ring between waist and hem, of quads along threads around and threads down. It starts folded:
every thread down lies straight on a cone with waves around whose tip is the ring's centre, which stretches nothing.
`--rings 24 --spokes 208` makes 5200 vertices, `--rings 48 --spokes 416` 20 384, `--rings 186 --spokes 1608` 300 696;
the pin of the case holds the first SPOKES. The hips are an ellipsoid.
"""
import argparse
from pathlib import Path

import numpy as np

WAIST, HEM, TIP = 0.2, 0.65, 1.13  # m from the tip, m from the tip, m above the floor
OPENING, FOLDS = np.radians(50), 10  # mean angle of the cone, waves around it
CENTRE, AXES = np.array([0, 0, 0.84]), np.array([0.17, 0.14, 0.2])  # m, of the hips


def write(path, points, quads, head):
    with open(path, "w") as file:
        file.write(f"# {head}; made by make_skirt.py\n")
        file.writelines("v {:.6f} {:.6f} {:.6f}\n".format(*p) for p in points)
        file.writelines("f " + " ".join(str(v + 1) for v in q) + "\n" for q in quads)


def ring_of_quads(rings, spokes):
    """Vertex r * spokes + s is on ring r and spoke s; the rings close."""
    r, s = np.meshgrid(np.arange(rings), np.arange(spokes), indexing="ij")
    after = (s + 1) % spokes
    corners = [r * spokes + s, r * spokes + after, (r + 1) * spokes + after, (r + 1) * spokes + s]
    return np.stack(corners, -1).reshape(-1, 4)


def waved(wave, turn):
    opening = OPENING + wave * np.cos(FOLDS * turn)
    return np.stack([np.sin(opening) * np.cos(turn), np.sin(opening) * np.sin(turn), -np.cos(opening)], -1)


def evenly_spaced(wave, spokes):
    """Points on the waved curve whose neighbours are all as far apart, and how far."""
    turn = np.linspace(0, 2 * np.pi, spokes + 1)
    for _ in range(50):
        apart = np.linalg.norm(np.diff(waved(wave, turn), axis=0), axis=1)
        along = np.concatenate([[0], np.cumsum(apart)])
        turn = np.interp(np.linspace(0, along[-1], spokes + 1), along, turn)
    return waved(wave, turn[:-1]), along[-1] / spokes


def directions(spokes):
    """Of the threads down: on the unit sphere they make a waved closed curve, as long as in the flat ring."""
    low, high = 0.0, 0.3
    for _ in range(50):
        wave = 0.5 * (low + high)
        points, apart = evenly_spaced(wave, spokes)
        low, high = (wave, high) if apart < 2 * np.sin(np.pi / spokes) else (low, wave)
    return points


def hips(rings=16, spokes=32):
    down = np.pi * (np.arange(rings + 1) + 0.5)[:, None] / (rings + 1)
    angle = 2 * np.pi * np.arange(spokes)[None, :] / spokes
    ball = np.stack([np.sin(down) * np.cos(angle), np.sin(down) * np.sin(angle), np.cos(down) + 0 * angle], -1)
    points = [*(CENTRE + AXES * ball.reshape(-1, 3)), CENTRE + AXES * [0, 0, 1], CENTRE - AXES * [0, 0, 1]]
    last, top, bottom = rings * spokes, len(points) - 2, len(points) - 1
    caps = [[face for face in ([top, s, (s + 1) % spokes], [bottom, last + (s + 1) % spokes, last + s])]
            for s in range(spokes)]
    return points, [*ring_of_quads(rings, spokes), *sum(caps, [])]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--rings", type=int, default=24, help="default: %(default)s")
    parser.add_argument("--spokes", type=int, default=208, help="default: %(default)s")
    parser.add_argument("--out", type=Path, default=Path(__file__).parent, help="default: beside this file")
    options = parser.parse_args()
    radius = np.linspace(WAIST, HEM, options.rings + 1)[:, None, None]
    angle = 2 * np.pi * np.arange(options.spokes) / options.spokes
    flat = np.stack([np.cos(angle), np.sin(angle), 0 * angle], -1)
    quads = ring_of_quads(options.rings, options.spokes)
    write(options.out / "skirt.obj", (radius * flat).reshape(-1, 3), quads, "A ring of cloth")
    write(options.out / "start.obj", (radius * directions(options.spokes) + [0, 0, TIP]).reshape(-1, 3), quads,
          "The same, gathered")
    points, faces = hips()
    write(options.out / "hips.obj", points, faces, "An ellipsoid")


if __name__ == "__main__":
    main()
