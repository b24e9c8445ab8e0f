"""A weightless rod of 1 m with a bead: period and amplitude of small swings, and the period of a large one."""
import cmath
import math

import numpy as np

from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = ("Period and amplitude of small swings against the roots of the integrators; a large swing against the "
         "elliptic integral.")
KEYS = ["integrator", "start_rad", "step_s"]
FREQUENCY = math.sqrt(G)  # of a small swing of 1 m, 1/s
RATE = 10  # frames/s
START = 5  # frames after which what only the first step of BDF2 brings in has died away


def plan(quick):
    steps = (0.01,) if quick else (0.02, 0.01, 0.005)
    small = [(integrator, 1e-3, step) for integrator in ("implicit_euler", "imex", "bdf2") for step in steps]
    return cases.points(KEYS, *small, ("bdf2", 1.0, 0.002))


def measure(laboratory, point):
    case = {"cloth": {"line": {"length": 1, "vertices": 2},
                      "start": {"rotate": {"axis": [0, 1, 0], "angle": math.pi / 2 - point["start_rad"]}}},
            "pins": [{"vertices": [0]}], **cases.EXACT,
            "time": cases.steps_of(6, point["step_s"], 6 * RATE, integrator=point["integrator"])}
    frames = laboratory.whole_run(case).frames
    ends = [frame.positions[1] for frame in frames]
    times, angles = np.array([frame.time for frame in frames]), np.array([math.atan2(x, -z) for x, _, z in ends])
    return small_swing(angles) if point["start_rad"] < 0.1 else {"period_s": period(times, angles)}


def small_swing(angles):
    """By the factor z from frame to frame, from least squares of a_(n+1) = 2 Re(z) a_n - |z|^2 a_(n-1)."""
    a = angles[START:]
    twice_real, square = np.linalg.lstsq(np.stack([a[1:-1], -a[:-2]], axis=1), a[2:], rcond=None)[0]
    amplitude = math.sqrt(square)
    return {"period_s": 2 * math.pi / RATE / math.acos(twice_real / 2 / amplitude), "kept_in_1_s": amplitude**RATE}


def period(times, angles):
    """Between crossings of zero in the same direction, from the cubic through the four frames around each."""
    crossings = []
    for n in np.flatnonzero((angles[:-1] > 0) & (angles[1:] <= 0)):
        near = slice(n - 1, n + 3)
        cubic = np.polyfit(times[near] - times[n], angles[near], 3)
        crossings += [times[n] + root.real for root in np.roots(cubic) if abs(root.imag) < 1e-9 and
                      0 <= root.real <= 1 / RATE]
    return float(np.mean(np.diff(crossings)))


def factor(integrator, wh):
    """What a step makes of x' = i w x: 1 / (1 - i w h), or the root near 1 of (3/2 - i w h) z^2 - 2 z + 1/2."""
    if integrator != "bdf2":
        return 1 / (1 - 1j * wh)
    a = 1.5 - 1j * wh
    return (2 + cmath.sqrt(4 - 2 * a)) / (2 * a)


def large_period(start):
    """4 sqrt(l/g) K(sin(start/2)) = 2 pi sqrt(l/g) / agm(1, cos(start/2))."""
    a, b = 1.0, math.cos(start / 2)
    while abs(a - b) > 1e-15:
        a, b = (a + b) / 2, math.sqrt(a * b)
    return 2 * math.pi / FREQUENCY / a


def judge(rows):
    checks = []
    for row in rows:
        name = f"{row['integrator']}, steps of {1000 * row['step_s']:g} ms"
        if row["start_rad"] == 1:
            checks.append(Check(f"period of a swing from 1 rad, {name}", "s", large_period(1), 1e-3 * large_period(1),
                                row["period_s"],
                                "complete elliptic integral; 0.1 %"))
            continue
        z = factor(row["integrator"], FREQUENCY * row["step_s"])
        checks += [Check(f"period of a small swing, {name}", "s", 2 * math.pi * row["step_s"] / cmath.phase(z), 1e-5,
                         row["period_s"],
                         "root of the integrator on x'' = -(g/l) x"),
                   Check(f"amplitude left of a small swing after 1 s, {name}", "", abs(z) ** (1 / row["step_s"]), 1e-5,
                         row["kept_in_1_s"],
                         "the same root")]
    return checks


def draw(axes, rows):
    for integrator in cases.values(rows, "integrator"):
        found = [row for row in cases.of(rows, integrator=integrator) if row["start_rad"] < 0.1]
        steps = np.linspace(0.0001, 0.022, 100)
        axes.plot(1000 * steps, [abs(factor(integrator, FREQUENCY * h)) ** (1 / h) for h in steps], "-", color="0.7")
        axes.plot([1000 * row["step_s"] for row in found], [row["kept_in_1_s"] for row in found],
                  "x" if integrator == "imex" else "o", label=integrator)
    axes.set_xlabel("time step, ms")
    axes.set_ylabel("amplitude left after 1 s (grey: the integrator's root)")
    axes.legend()
