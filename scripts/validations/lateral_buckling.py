"""A strip clamped with its width upright, straight out: beyond a certain weight it falls over sideways."""
import math

import numpy as np

from validations import cases, strips
from validations.cases import G
from validations.checks import Check

ABOUT = ("A strip of 0.2 m, its width upright, on triangles stretched by less than 0.1 % and on quads at 1 % strain: "
         "the weight at which it falls over sideways.")
KEYS = ["mesh", "spacing_m", "rows", "gamma"]
LENGTH, DENSITY, DAMPING, END = 0.2, 0.2, 10.0, 3.0  # m, kg/m^2, 1/s, s
# 6 j, j the first zero of J_(-1/6): q L^3 / sqrt(B_side C) at which a cantilever buckles [Prandtl 1899, Michell 1899]
BEAM = 12.854
# of a strip of an isotropic plate with Poisson ratio 0: B_side = B w, C = 2 B w, q = weight per area times w
PLATE = BEAM * math.sqrt(2)
# Hinges store B/2 (p^2 + q^2 - 2/3 p q + 8/3 s^2) per area on triangles with equal sides, s the twist: B_side = 8/9 B
# w, C = 8/3 B w; and 4 s^2, with B_side = 0.8 B w, where squares are cut in turn. Quads store nothing in a twist.
HINGES = {"equilateral": BEAM * math.sqrt(64 / 27), "alternating": BEAM * math.sqrt(3.2)}
MESHES = [("equilateral", 0.005, 2), ("equilateral", 0.0025, 4), ("equilateral", 0.00125, 8),
          ("alternating", 0.005, 2), ("alternating", 0.0025, 4)]


def plan(quick):
    if quick:
        return cases.points(KEYS, ("quads", 0.005, 2, 2))
    triangles = [(*mesh, gamma) for mesh in MESHES for gamma in ((20, 23) if mesh[0] == "equilateral" else (23, 28))]
    return cases.points(KEYS, *triangles, *(("quads", 0.005, 2, gamma) for gamma in (2, 18)))


def measure(laboratory, point):
    """The rate at which a small bend to the side grows, 1/s, over the second half of the run; and what the strip does
    in its plane. On triangles it has to be all but unstretchable by its stiffness: projections lock there."""
    spacing = point["spacing_m"]
    flat, faces = getattr(strips, point["mesh"])(LENGTH + spacing / 2, spacing, point["rows"])
    upright = np.stack([flat[:, 0], 0 * flat[:, 0], flat[:, 1]], axis=1)
    bent = upright + np.outer(1e-4 * np.where(flat[:, 0] > 1.01 * spacing, flat[:, 0] - spacing / 2, 0) ** 2 / LENGTH,
                              [0, 1, 0])
    stiff, kept = {"stretch": 2e4, "shear": 1e4}, {"method": "none"}
    if point["mesh"] == "quads":
        stiff, kept = {"shear": 1e3}, {"strain": "1 %"}
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
    names = dict.fromkeys(tuple(row[key] for key in KEYS[:3]) for row in rows)
    return [(name, [row for row in rows if tuple(row[key] for key in KEYS[:3]) == name]) for name in names]


def judge(rows):
    checks = []
    for (mesh, spacing, across), found in meshes(rows):
        name = f"{mesh}, {across:g} cells across, sides of {1000 * spacing:g} mm"
        if mesh == "quads":
            for row in found:
                falls = float(row["rate_per_s"] > 0)
                quantity = f"falls over at gamma {row['gamma']:g} (1: yes), {name}"
                checks += [Check(quantity, "", 0, 0, falls, f"isotropic plate: stands up to {PLATE:.2f}"),
                           Check(quantity, "", 1, 0, falls, "quads store nothing in a twist, C = 0")]
            continue
        checks += [Check(f"gamma at the threshold, {name}", "", PLATE, 0.05 * PLATE, threshold(found),
                         "isotropic plate of Poisson ratio 0: 12.854 sqrt(2) [Prandtl, Michell]; 5 %, the width over "
                         "the length"),
                   Check(f"gamma at the threshold, {name}", "", HINGES[mesh], 0.05 * HINGES[mesh], threshold(found),
                         "12.854 sqrt(B_side C) of what the hinges of this mesh store; 5 %")]
    return checks


def draw(axes, rows):
    for (mesh, spacing, _), found in meshes(rows):
        axes.plot([row["gamma"] for row in found], [row["rate_per_s"] for row in found], "o-",
                  label=f"{mesh}, {1000 * spacing:g} mm")
    axes.axhline(0, color="0.7")
    axes.axvline(PLATE, color="black", label="threshold of an isotropic plate")
    for (mesh, gamma), style in zip(HINGES.items(), ("--", ":")):
        axes.axvline(gamma, color="black", linestyle=style, label=f"of hinges, {mesh}")
    axes.set_xlabel("gamma = weight per area x length^3 / bending stiffness")
    axes.set_ylabel("growth of a bend to the side, 1/s")
    axes.legend(fontsize=8, loc="center left", bbox_to_anchor=(0, 0.4))
