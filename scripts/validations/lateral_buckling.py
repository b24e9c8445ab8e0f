"""A strip clamped with its width upright, straight out: beyond a certain weight it falls over sideways."""
import math

import numpy as np

from validations import cases, strips
from validations.cases import G
from validations.checks import Check

ABOUT = ("A strip of 0.2 m, its width upright, on quads under Newton's method and on triangles stretched by less than "
         "0.2 %: the weight at which it falls over sideways.")
KEYS = ["mesh", "gamma", "spacing_m", "rows"]
LENGTH, DENSITY, DAMPING, END = 0.2, 0.2, 10.0, 3.0  # m, kg/m^2, 1/s, s
# 6 j, j the first zero of J_(-1/6): q L^3 / sqrt(B_side C) at which a cantilever buckles [Prandtl 1899, Michell 1899]
BEAM = 12.854
# of a strip of an isotropic plate with Poisson ratio 0: B_side = B w, C = 2 B w, q = weight per area times w
PLATE = BEAM * math.sqrt(2)
MESHES = [("quads", 0.005, 2), ("quads", 0.0025, 4), ("equilateral", 0.005, 2), ("equilateral", 0.0025, 4),
          ("one_way", 0.0025, 4), ("alternating", 0.005, 2), ("alternating", 0.0025, 4), ("irregular", 0.0025, 4)]
GAMMAS = (17, 20)


def plan(quick):
    meshes = [("quads", 0.0025, 4), ("equilateral", 0.005, 2)] if quick else MESHES
    return cases.points(KEYS, *((mesh, gamma, *cells) for mesh, *cells in meshes for gamma in GAMMAS))


def measure(laboratory, point):
    """The rate at which a small bend to the side grows, 1/s, over the second half of the run. On triangles the strip
    has to be all but unstretchable by its stiffness: projections lock there. Fast Projection takes compression at the
    start of the step, and so sees a strip that is too stiff at these steps (see the page). The length is that beyond
    the cells that are held: there twist begins."""
    spacing = point["spacing_m"]
    flat, faces = getattr(strips, point["mesh"])(LENGTH + spacing, spacing, point["rows"])
    upright = np.stack([flat[:, 0], 0 * flat[:, 0], flat[:, 1]], axis=1)
    bent = upright + np.outer(1e-4 * np.where(flat[:, 0] > 1.01 * spacing, flat[:, 0] - spacing / 2, 0) ** 2 / LENGTH,
                              [0, 1, 0])
    stiff, kept = {"stretch": 2e4, "shear": 1e4}, {"method": "none"}
    if point["mesh"] == "quads":
        stiff, kept = {"shear": 1e3}, {"method": "newton"}
    case = {"cloth": {"mesh": strips.write(laboratory.path("flat.obj"), upright, faces),
                      "start": {"shape": strips.write(laboratory.path("bent.obj"), bent)},
                      "material": {"density": DENSITY, "bending": DENSITY * G * LENGTH**3 / point["gamma"],
                                   "damping": {"mass": DAMPING}, **stiff}},
            "name": f"{point['mesh']} {spacing} {point['rows']}", "velocity": {"solver": "mumps"},
            "pins": [{"box": {"min": [-1, -1, -1], "max": [1.01 * spacing, 1, 1]}}],
            "inextensibility": kept,
            "time": cases.steps_of(END, 0.005, 30)}
    run = laboratory.whole_run(case)
    tip = np.flatnonzero(flat[:, 0] > flat[:, 0].max() - 1e-9)
    times, aside = np.array([(frame.time, frame.positions[tip, 1].mean()) for frame in run.frames]).T
    late = times > END / 2
    return {"rate_per_s": np.polyfit(times[late], np.log(np.abs(aside[late])), 1)[0], "aside_m": abs(aside[-1]),
            "strain_had": run.summary["strain"]["max"]}


def threshold(rows):
    """Where the stiffness -rate (rate + damping) of the slowest motion is zero, on the line through the two that were
    tried."""
    (g1, s1), (g2, s2) = ((row["gamma"], -row["rate_per_s"] * (row["rate_per_s"] + DAMPING)) for row in rows)
    return g1 + s1 * (g2 - g1) / (s1 - s2)


def meshes(rows):
    """[(mesh, spacing, rows of cells), its rows]"""
    def name_of(row):
        return row["mesh"], row["spacing_m"], row["rows"]

    return [(name, [row for row in rows if name_of(row) == name]) for name in dict.fromkeys(map(name_of, rows))]


def judge(rows):
    return [Check(f"gamma at the threshold, {mesh}, {across:g} cells across, sides of {1000 * spacing:g} mm", "", PLATE,
                  0.05 * PLATE, threshold(found),
                  "plate of Poisson ratio 0: 12.854 sqrt(2) [Prandtl, Michell]; 5 %, the width over the length")
            for (mesh, spacing, across), found in meshes(rows)]


def draw(axes, rows):
    for (mesh, spacing, _), found in meshes(rows):
        axes.plot([row["gamma"] for row in found], [row["rate_per_s"] for row in found], "o-",
                  label=f"{mesh}, {1000 * spacing:g} mm")
    axes.axhline(0, color="0.7")
    axes.axvline(PLATE, color="black", label="threshold of an isotropic plate")
    axes.set_xlabel("gamma = weight per area x length^3 / bending stiffness")
    axes.set_ylabel("growth of a bend to the side, 1/s")
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(0, 0.4))
