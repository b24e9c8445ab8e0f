"""A square held by two corners that are brought together, at rest, on finer and finer meshes."""
from studies.experiment import rms
from validations import cases
from validations.checks import Check, band, unjudged

ABOUT = ("A square of 1 m held by two corners 0.8 m apart, at rest: distance between its shapes on one mesh and the "
         "next finer one.")
KEYS = ["cells", "vertices_a_side"]
SIDES = (11, 21, 41)


def plan(quick):
    return cases.points(KEYS, *((cells, side) for cells in ("quads",) for side in (SIDES[:2] if quick else SIDES)))


def shape(laboratory, cells, side):
    """At the vertices of the coarsest mesh, settled by damping with its mass."""
    case = {"cloth": {"grid": {"size": [1, 1], "vertices": [side, side], "cells": cells},
                      "material": {"density": 0.2, "bending": 1e-3, "shear": 10, "damping": {"mass": 6}}},
            "pins": [{"vertices": [0], "motion": [{"time": 0}, {"time": 0.5, "translate": [0.1, 0, 0]}]},
                     {"vertices": [side - 1], "motion": [{"time": 0}, {"time": 0.5, "translate": [-0.1, 0, 0]}]}],
            "inextensibility": {"strain": 1e-3, "max_iterations": 50}, "time": cases.steps_of(4, 0.0025)}
    run = laboratory.whole_run(case)
    every = (side - 1) // (SIDES[0] - 1)
    return run.frames[-1].positions.reshape(side, side, 3)[::every, ::every].reshape(-1, 3), run


def measure(laboratory, point):
    """The distance to the next finer mesh."""
    side = int(point["vertices_a_side"])
    (coarse, run), (fine, _) = (shape(laboratory, point["cells"], n) for n in (side, 2 * side - 1))
    return {"to_next_m": rms(coarse, fine), "kinetic_J": run.steps["kinetic_J"][-1],
            "rejected": run.summary["rejected_steps"]}


def judge(rows):
    checks = []
    for coarse, fine in zip(rows, rows[1:]):
        sides = coarse["vertices_a_side"], fine["vertices_a_side"], 2 * fine["vertices_a_side"] - 1
        name = "{:g} to {:g} to {:g} vertices a side".format(*sides)
        checks.append(band(f"distance to the next finer mesh over that before, {name}", "", 0, 1,
                           fine["to_next_m"] / coarse["to_next_m"],
                           f"shrinks; {1000 * coarse['to_next_m']:.3g} and {1000 * fine['to_next_m']:.3g} mm"))
        order = cases.order(fine["to_next_m"], coarse["to_next_m"])
        if fine["vertices_a_side"] < SIDES[-1]:
            checks.append(unjudged(f"order in the edge length, {name}", "", order, "not judged on the coarsest meshes"))
        else:
            checks.append(Check(f"order in the edge length, {name}", "", 2, 0.5, order,
                                "second differences are of second order; the corners that hold it are points"))
    return checks


def draw(axes, rows):
    axes.loglog([1000 / (row["vertices_a_side"] - 1) for row in rows], [1000 * row["to_next_m"] for row in rows], "o-")
    axes.set_xlabel("edge length, mm")
    axes.set_ylabel("RMS distance to the next finer mesh, mm")
