"""Cloth hung by its upper side from stretchable threads: each edge is longer by the weight below it over its
stiffness."""
from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = ("Elongation of a line and of a strip of 1 m under their own weight, stretchable by about 5 %, for "
         "everything in Taut that stretches.")
KEYS = ["model", "cells"]
LENGTH, WIDTH, DENSITY, STIFFNESS = 1.0, 0.1, 0.2, 20.0  # m, m; kg/m^2, or kg/m of a line; N/m, or N of a line
ALONG = 11  # vertices
QUICK = [("springs", "line"), ("stretch", "line"), ("stretch", "quads")]
ALL = [*QUICK, ("springs", "quads"), ("stretch", "triangles"), ("stretch", "alternating_triangles"),
       ("xpbd, 20 substeps,", "line"), ("xpbd, 200 substeps,", "line")]


def plan(quick):
    return cases.points(KEYS, *(QUICK if quick else ALL))


def cloth(cells):
    """Hanging down by one end; a strip is one cell wide, so that its two threads share the weight."""
    turned = {"rotate": {"axis": [0, 1, 0], "angle": "90 deg"}}
    if cells == "line":
        return {"line": {"length": LENGTH, "vertices": ALONG}, "start": turned}
    return {"grid": {"size": [LENGTH, WIDTH], "vertices": [ALONG, 2], "cells": cells}, "start": turned}


def stretching(model, cells):
    """(keys of the material, the block inextensibility)."""
    if model == "stretch":
        return {"stretch": STIFFNESS}, {"method": "none"}
    if model != "springs":
        return {}, {"method": "xpbd", "compliance": 1 / STIFFNESS, "xpbd": {"substeps": int(model.split()[1])}}
    thread = STIFFNESS if cells == "line" else STIFFNESS * WIDTH / 2  # N
    return {}, {"method": "springs", "springs": {"stiffness": thread}}


def measure(laboratory, point):
    material, inextensibility = stretching(point["model"], point["cells"])
    case = {"cloth": {**cloth(point["cells"]), "material": {"density": DENSITY, "damping": {"mass": 8}, **material}},
            "pins": [{"box": {"min": [-1, -1, -1e-6], "max": [1, 2, 1e-6]}}],
            "velocity": {"solver": "mumps"}, "inextensibility": inextensibility, "time": cases.steps_of(6, 0.01)}
    run = laboratory.whole_run(case)
    lower = run.frames[-1].positions[:, 2].reshape(-1, ALONG)[:, -1]
    return {"elongation_m": -lower.mean() - LENGTH, "kinetic_J": run.steps["kinetic_J"][-1]}


EXPECTED = DENSITY * G * LENGTH**2 / (2 * STIFFNESS)  # also of lumped masses on equal edges


def judge(rows):
    return [Check(f"elongation under its own weight, {row['model']} on {row['cells']}", "m", EXPECTED, 1e-3 * EXPECTED,
                  row["elongation_m"], "w L^2 / (2 k)") for row in rows]


def draw(axes, rows):
    names = [f"{row['model'].rstrip(',')} on {row['cells']}" for row in rows]
    axes.barh(names, [100 * abs(row["elongation_m"] / EXPECTED - 1) for row in rows], color="0.75")
    axes.axvline(0.1, color="black", label="tolerance")
    axes.set_xscale("log")
    axes.set_xlabel("error of the elongation, %")
    axes.legend(loc="lower right")
