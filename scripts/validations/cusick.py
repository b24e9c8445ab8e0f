"""Cusick's drape test on the named fabrics: how much of the ring of cloth around a disc still casts a shadow."""
import math

import numpy as np

from validations import cases, fabrics, strips
from validations.cases import G
from validations.checks import Check, band, unjudged

ABOUT = ("Cusick's drape test: a specimen of 30 cm over a disc of 18 cm, the named fabrics against the published "
         "bands of what they are called after.")
KEYS = ["fabric", "spacing_m", "seed", "cells"]
COMPARED = ("wool", "denim")  # of triangles with quads
DISC, SPECIMEN = 0.09, 0.15  # radii, m [BS 5058, ISO 9073-9]
PIXEL = 0.0005  # m


def plan(quick):
    if quick:
        return cases.points(KEYS, ("wool", 0.01, 0, "quads"))
    return cases.points(KEYS, *((name, 0.005, 0, "quads") for name in fabrics.NAMES),
                        *((name, 0.005, seed, "quads") for name in COMPARED for seed in (1, 2)),
                        *((name, 0.01, 0, "quads") for name in COMPARED),
                        *((name, spacing, seed, "quads") for name in COMPARED for spacing in (0.0075, 0.006)
                          for seed in range(3)),
                        *((name, spacing, seed, "triangles") for name in COMPARED for spacing in (0.0075, 0.006, 0.005)
                          for seed in range(3)))


def round_specimen(spacing):
    """The squares of a grid whose centres lie in the specimen."""
    columns = math.ceil(2 * SPECIMEN / spacing) + 2
    places, corners = strips.grid(columns * spacing, spacing, columns)
    places = places - columns * spacing / 2
    faces = [face for face in corners if np.linalg.norm(places[list(face)].mean(axis=0)) < SPECIMEN]
    used = sorted({vertex for face in faces for vertex in face})
    number = {vertex: new for new, vertex in enumerate(used)}
    return places[used], [tuple(number[vertex] for vertex in face) for face in faces]


def in_triangles(places, faces, spacing, seed):
    """Each square cut along one of its diagonals, and vertices inside the specimen moved, both at random. Those around
    the edge of the disc stay, so that the same are held: half a cell there is two points of the coefficient."""
    chance = np.random.default_rng(3 + seed)
    places = places.copy()
    radius = np.linalg.norm(places, axis=1)
    inside = (radius < SPECIMEN - 2 * spacing) & (abs(radius - DISC) > spacing)
    places[inside] += chance.uniform(-0.25, 0.25, (inside.sum(), 2)) * spacing
    return places, [triangle for (a, b, c, d), first in zip(faces, chance.random(len(faces)) < 0.5)
                    for triangle in (((a, b, c), (a, c, d)) if first else ((a, b, d), (b, c, d)))]


def shadow(positions, faces):
    """The area under the cloth, m^2: of the pixels whose centres lie under one of its triangles."""
    size = round(2.4 * SPECIMEN / PIXEL)
    dark = np.zeros((size, size), bool)
    p = positions[:, :2] / PIXEL + size / 2
    for first, *others in faces:
        for one, two in zip(others, others[1:]):
            paint(dark, p[[first, one, two]])
    return dark.sum() * PIXEL**2


def paint(dark, corners):
    """The pixels in a triangle: on the same side of all three edges."""
    low, high = np.floor(corners.min(axis=0)).astype(int), np.ceil(corners.max(axis=0)).astype(int)
    x, y = np.meshgrid(np.arange(low[0], high[0]) + 0.5, np.arange(low[1], high[1]) + 0.5)
    sides = [(b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])
             for a, b in zip(corners, np.roll(corners, -1, axis=0))]
    dark[low[1]:high[1], low[0]:high[0]] |= np.all([side >= 0 for side in sides],
                                                   axis=0) | np.all([side <= 0 for side in sides], axis=0)


def measure(laboratory, point):
    """From flat, with bumps of up to 0.1 mm, until it hangs still: by Newton's method, for under Fast Projection
    equilibrium is no fixed point, and cloth comes to rest limper (wool at 31 in place of 53 %)."""
    flat, faces = round_specimen(point["spacing_m"])
    squares = len(faces)
    if point["cells"] == "triangles":
        flat, faces = in_triangles(flat, faces, point["spacing_m"], point["seed"])
    flat = np.c_[flat, np.zeros(len(flat))]
    radius = np.linalg.norm(flat, axis=1)
    bumps = 1e-4 * np.random.default_rng(point["seed"]).uniform(-1, 1, len(flat)) * (radius > DISC + point["spacing_m"])
    case = {"name": f"{point['cells']} {point['spacing_m']} {point['seed']}",
            "cloth": {"mesh": strips.write(laboratory.path("flat.obj"), flat, faces), "fabric": point["fabric"],
                      "start": {"shape": strips.write(laboratory.path("bumps.obj"), flat + np.outer(bumps, [0, 0, 1]))},
                      "material": {"damping": {"mass": 2}}},
            "pins": [{"vertices": np.flatnonzero(radius <= DISC).tolist()}],
            "inextensibility": {"method": "newton"}, "time": cases.steps_of(6, 0.01)}
    run = laboratory.whole_run(case)
    x = run.frames[-1].positions
    whole, disc = squares * point["spacing_m"] ** 2, math.pi * DISC**2
    edge = x[radius > SPECIMEN - point["spacing_m"]]
    around = np.argsort(np.arctan2(edge[:, 1], edge[:, 0]))
    bending, density = fabrics.bending_and_density(laboratory, point["fabric"])
    own, published = fabrics.drapes(laboratory.program)[point["fabric"]]
    low, high = published or (math.nan, math.nan)
    return {"told_percent": own, "low_percent": low, "high_percent": high,
            "drape_percent": 100 * (shadow(x, faces) - disc) / (whole - disc),
            "nodes": nodes(np.linalg.norm(edge[around, :2], axis=1)),
            "bending_length_mm": 1000 * (bending / (density * G)) ** (1 / 3), "kinetic_J": run.steps["kinetic_J"][-1]}


def nodes(radii):
    """Folds around the shadow: maxima of its radius, after its staircase is smoothed away."""
    waves = np.fft.rfft(radii)
    waves[16:] = 0
    smooth = np.fft.irfft(waves, len(radii))
    return int(((smooth > np.roll(smooth, 1)) & (smooth >= np.roll(smooth, -1)) & (smooth > smooth.mean())).sum())


def judge(rows):
    checks = []
    for row in cases.of(rows, cells="quads"):
        name = f"drape coefficient, {row['fabric']}, sides of {1000 * row['spacing_m']:g} mm, start {row['seed']:g}"
        seen = f"; {row['nodes']:g} folds; bending length {row['bending_length_mm']:.3g} mm"
        if math.isnan(row["low_percent"]):
            checks.append(unjudged(name, "%", row["drape_percent"], "no published band found" + seen))
        else:
            reference = f"published band of real {row['fabric']}, see `taut fabrics`" + seen
            checks.append(band(name, "%", row["low_percent"], row["high_percent"], row["drape_percent"], reference))
        if row["spacing_m"] == 0.005:
            checks.append(Check(name, "%", row["told_percent"], 3, row["drape_percent"], "as `taut fabrics` says"))
    return checks + compare(cases.of(rows, cells="triangles"), rows)


def compare(triangles, rows):
    """Of triangles with quads of the same material and sides. Which folds cloth finds differs from start to start, of
    triangles from mesh to mesh, and with it the coefficient by up to 2 points: means are compared."""
    checks = []
    for fabric, spacing in dict.fromkeys((row["fabric"], row["spacing_m"]) for row in triangles):
        mean = {cells: np.mean([row["drape_percent"] for row in
                                cases.of(rows, fabric=fabric, spacing_m=spacing, cells=cells)])
                for cells in ("quads", "triangles")}
        name = f"drape coefficient, {fabric}, irregular triangles with sides of {1000 * spacing:g} mm, mean of starts"
        checks.append(Check(name, "%", float(mean["quads"]), 3, float(mean["triangles"]), "quads of the same sides"))
    return checks


def draw(axes, rows):
    shown = [row for row in rows if (row["spacing_m"], row["seed"], row["cells"]) == (0.005, 0, "quads")] or rows
    for place, row in enumerate(shown):
        if not math.isnan(row["low_percent"]):
            low, high = row["low_percent"], row["high_percent"]
            axes.bar(place, high - low, bottom=low, color="0.85", label="published band" if row is shown[0] else None)
        axes.plot(place, row["drape_percent"], "ko")
    axes.set_xticks(range(len(shown)), [row["fabric"] for row in shown], fontsize=8, rotation=45)
    axes.set_ylim(0, 100)
    axes.set_ylabel("drape coefficient, %")
    axes.legend()
