"""A chain between two points of different height against the equilibrium of its links, by each method."""
import math

import numpy as np

from validations import cases, strips
from validations.cases import G
from validations.checks import Check

ABOUT = ("A chain of 40 links and 1 m between two points 0.7 m apart and 0.2 m of different height, shape and "
         "tensions, by every method.")
KEYS = ["method"]
LINKS, LENGTH, SPAN, RISE, DENSITY = 40, 1.0, 0.7, 0.2, 0.2  # m, kg/m
STRAIN, SPRINGS = 1e-4, 200.0  # springs: N, which the weight of the chain strains by about 1 %
LIMITED = ("fast_projection", "icd", "sap", "shake", "rattle", "jacobi", "gauss_seidel")
KNOW_TENSION = ("fast_projection", "icd", "sap", "springs")


def plan(quick):
    methods = ("fast_projection", "springs") if quick else (*LIMITED, "xpbd", "springs")
    return cases.points(KEYS, *((method,) for method in methods))


def shape(pull, compliance):
    """Vertices and tensions of a chain whose first link pulls with (horizontal, vertical) on the left end: the vertical
    part loses the weight of each vertex; a link is longer by its tension times `compliance`."""
    horizontal, vertical = pull
    weight = DENSITY * LENGTH * G / LINKS
    v = vertical - weight * np.arange(LINKS)
    tension = np.hypot(horizontal, v)
    lengths = LENGTH / LINKS * (1 + compliance * tension)
    x, z = np.cumsum(lengths * horizontal / tension), np.cumsum(-lengths * v / tension)
    return np.concatenate([[[0, 0]], np.stack([x, z], axis=1)]), tension


def equilibrium(compliance=0.0):
    """(vertices, tensions), by Newton on the place of the right end."""
    unknown = np.array([0.5, 0.5]) * DENSITY * LENGTH * G
    for _ in range(100):
        miss = shape(unknown, compliance)[0][-1] - (SPAN, RISE)
        slopes = [(shape(unknown + d, compliance)[0][-1] - shape(unknown - d, compliance)[0][-1]) / 2e-6
                  for d in 1e-6 * np.eye(2)]
        change = np.linalg.solve(np.array(slopes).T, miss)
        unknown = unknown - change * min(1.0, 0.2 / float(np.linalg.norm(change)))
        if np.linalg.norm(miss) < 1e-12:
            return shape(unknown, compliance)
    raise ArithmeticError("no equilibrium found")


def vee():
    """Two straight legs, as a start. (A straight chain between two pins has no unique tension, which some methods
    need.)"""
    chord = np.array([SPAN, RISE])
    half = np.linalg.norm(chord) / 2
    down = np.array([RISE, -SPAN]) / np.linalg.norm(chord)
    corner = chord / 2 + math.sqrt((LENGTH / 2) ** 2 - half**2) * down
    s = np.linspace(0, 2, LINKS + 1)[:, None]
    legs = np.where(s <= 1, s * corner, corner + (s - 1) * (chord - corner))
    return np.stack([legs[:, 0], np.zeros(LINKS + 1), legs[:, 1]], axis=1)


def inextensibility(method):
    if method == "springs":
        return {"springs": {"stiffness": SPRINGS}}
    if method == "xpbd":
        return {"xpbd": {"substeps": 50}}
    return {"strain": STRAIN, **({"compliance": 0} if method in LIMITED[:5] else {})}


def measure(laboratory, point):
    method = point["method"]
    case = {"cloth": {"line": {"length": LENGTH, "vertices": LINKS + 1},
                      "start": {"shape": strips.write(laboratory.path("vee.obj"), vee())},
                      "material": {"density": DENSITY, "bending": 0, "damping": {"mass": 10}}},
            "pins": [{"vertices": [0, LINKS]}],
            "inextensibility": {"method": method, **inextensibility(method)}, "time": cases.steps_of(4, 0.01)}
    run = laboratory.whole_run(case)
    expected, tension = equilibrium(1 / SPRINGS if method == "springs" else 0.0)
    found = {"distance_m": float(np.abs(run.frames[-1].positions[:, [0, 2]] - expected).max()),
             "strain": run.steps["strain_max"][-1]}
    if method in KNOW_TENSION:
        found["tension_error"] = float(np.abs(run.frames[-1]["tension"] / tension - 1).max())
    return {"tension_error": math.nan, **found}


def judge(rows):
    checks = []
    for row in rows:
        method = row["method"]
        limit = row["strain"] if method == "xpbd" else STRAIN
        wanted = "twice the strain " + ("it has"
                                        if method == "xpbd" else f"asked for, {STRAIN:g},") + " times the length"
        checks.append(Check(f"largest distance of a vertex from the equilibrium, {method}", "m", 0, 2 * limit * LENGTH,
                            row["distance_m"],
                            f"equilibrium of the links{', elastic' if method == 'springs' else ''}; {wanted}"))
        if method in KNOW_TENSION:
            checks.append(Check(f"largest relative error of a tension, {method}", "", 0, 0.01, row["tension_error"],
                                "equilibrium of the links; 1 %"))
    return checks


def draw(axes, rows):
    axes.bar([row["method"] for row in rows], [1e6 * row["distance_m"] for row in rows], color="0.75")
    axes.axhline(2e6 * STRAIN * LENGTH, color="black", label="tolerance of methods that keep a limit, and of springs")
    axes.set_yscale("log")
    axes.set_ylabel("largest distance from the equilibrium, 1e-6 m")
    axes.tick_params(axis="x", labelsize=7, rotation=20)
    axes.legend()
