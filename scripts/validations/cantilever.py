"""A strip clamped at one end: how far it hangs, over the ratio of weight to bending, for every model of bending."""
import math

import numpy as np

from validations import cases, elastica
from validations.cases import G
from validations.checks import Check, band

ABOUT = ("A strip of 0.2 m clamped at one end, at rest under its own weight and at 1 % strain: the master curve of "
         "H/W over gamma.")
KEYS = ["gamma", "bending_model", "cells", "along", "step_s"]
LENGTH, COARSE, FINE = 0.2, 21, 41  # m; vertices along the strip
LONG, SHORT = 0.014, 0.001  # s
MODELS = [("yarn", "quads"), ("isometric", "quads"), ("discrete_shells", "quads"), ("baraff_witkin", "quads"),
          ("isometric", "triangles"), ("isometric", "alternating_triangles"),
          ("discrete_shells", "alternating_triangles")]


def plan(quick):
    curve = [(gamma, "yarn", "quads", FINE, LONG)
             for gamma in ((1, 10, 100) if quick else (0.5, 1, 2, 5, 10, 20, 50, 100, 500))]
    if quick:
        return cases.points(KEYS, *curve)
    models = [(10, model, cells, COARSE, SHORT) for model, cells in MODELS]
    return cases.points(KEYS, *curve, *models, *((10, "yarn", "quads", along, LONG) for along in (6, 11, 21, 81)),
                        (10, "discrete_shells", "quads", FINE, LONG))


def measure(laboratory, point):
    bending = elastica.DENSITY * G * LENGTH**3 / point["gamma"]
    case = elastica.clamped_strip(LENGTH, point["along"], {"bending": bending, "bending_model": point["bending_model"]},
                                  point["cells"],
                                  point["step_s"])
    return elastica.hangs(laboratory, case)


def stiffness_had(row):
    """The part of the bending stiffness with which an elastica drops as far."""
    low, high = 0.1, 10.0
    for _ in range(20):
        middle = math.sqrt(low * high)
        low, high = (middle, high) if elastica.hanging(row["gamma"] / middle)[0] > row["drop_m"] / LENGTH else (low,
                                                                                                                middle)
    return low


def judge(rows):
    """On triangles also the stiffness that the strip shows. With the curvatures p along, q across and a shift d of
    every other vertex, squares cut in turn store 3/4 [(p - d)^2 + (q - d)^2 + 2 d^2] + 1/4 [p^2 + q^2 + 2 d^2] times
    B/2 per area (src/forces/folds.hpp), at the least 0.81 p^2."""
    checks = []
    for row in rows:
        name = f"gamma {row['gamma']:g}, {row['bending_model']} on {row['cells']}, {row['along']:g} vertices along, "
        name += f"steps of {1000 * row['step_s']:g} ms"
        drop, reach = elastica.hanging(row["gamma"])
        reference = "heavy elastica; 1 % of the length, the strain allowed "
        reference += f"(H/W {row['drop_m'] / row['reach_m']:.4g}, elastica {drop / reach:.4g})"
        checks += [Check(f"drop / length, {name}", "", drop, 0.01, row["drop_m"] / LENGTH, reference),
                   Check(f"reach / length, {name}", "", reach, 0.01, row["reach_m"] / LENGTH, reference)]
        if "triangles" in row["cells"]:
            least, why = {"triangles": (0.98, "a plate, to 2 %"),
                          "alternating_triangles": (0.8, "what squares cut in turn relax to, at the least"),
                          }[row["cells"]]
            checks.append(band(f"bending stiffness that it has / B, {name}", "", least, 1.02, stiffness_had(row), why))
    return checks


def draw(axes, rows):
    gammas = np.geomspace(0.3, 700, 25)
    curve = [elastica.hanging(gamma) for gamma in gammas]
    axes.loglog(gammas, [drop / reach for drop, reach in curve], "-", color="0.6", label="heavy elastica")
    for (model, cells), marker in zip(MODELS, "o+x1v^<"):
        found = cases.of(rows, bending_model=model, cells=cells)
        if found:
            axes.loglog([row["gamma"] for row in found], [row["drop_m"] / row["reach_m"] for row in found], marker,
                        fillstyle="none",
                        label=f"{model} on {cells}")
    axes.set_xlabel("gamma = weight per area x length^3 / bending stiffness")
    axes.set_ylabel("H / W = drop / reach of the tip")
    axes.legend()
