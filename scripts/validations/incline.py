"""A patch of cloth on an inclined plane: it sticks up to Coulomb's angle, and slides beyond it as Coulomb says."""
import math

import numpy as np

from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = ("A patch of cloth on an inclined plane sticks up to Coulomb's angle and slides beyond it with Coulomb's "
         "acceleration.")
KEYS = ["friction", "beyond_deg", "step_s"]
END, THICKNESS = 0.3, 0.001  # s, m
STUCK = 1e-4  # m that a patch which sticks may creep
BEYOND = (-3, -1, -0.25, 0.25, 1, 5)  # degrees from Coulomb's angle


def plan(quick):
    if quick:
        return cases.points(KEYS, *((0.5, beyond, 0.005) for beyond in (-1, 1, 5)))
    return cases.points(KEYS, *((friction, beyond, 0.005) for friction in (0.2, 0.5) for beyond in BEYOND),
                        *((0.5, beyond, 0.001) for beyond in BEYOND))


def angle_of(row):
    return math.atan(row["friction"]) + math.radians(row["beyond_deg"])


def measure(laboratory, point):
    angle = angle_of(point)
    normal, down = np.array([math.sin(angle), 0, math.cos(angle)]), np.array([math.cos(angle), 0, -math.sin(angle)])
    case = {"cloth": {"grid": {"size": [0.1, 0.1], "vertices": [9, 9]},
                      "start": {"rotate": {"axis": [0, 1, 0], "angle": angle}, "translate": list(THICKNESS * normal)}},
            "obstacles": [{"plane": {"normal": list(normal)}, "friction": point["friction"]}],
            "contact": {"thickness": THICKNESS, "check": "step"}, "time": cases.steps_of(END, point["step_s"])}
    run = laboratory.whole_run(case)
    first, last = run.frames[0].positions, run.frames[-1].positions
    return {"moved_m": float((last - first).mean(axis=0) @ down),
            "acceleration_m_s2": float(run.frames[-1]["velocities"].mean(axis=0) @ down) / END,
            "intersections": run.summary["contact"]["intersections"]}


def of_coulomb(friction, angle):
    """g (sin - friction cos) beyond its angle, 0 up to it."""
    return max(0.0, G * (math.sin(angle) - friction * math.cos(angle)))


def judge(rows):
    checks = []
    for row in rows:
        side = "beyond" if row["beyond_deg"] > 0 else "below"
        name = f"friction {row['friction']:g}, {abs(row['beyond_deg']):g} degrees {side} Coulomb's angle, "
        name += f"steps of {1000 * row['step_s']:g} ms"
        if row["beyond_deg"] < 0:
            checks.append(Check(f"moved after {END} s, {name}", "m", 0, STUCK, row["moved_m"], "sticks"))
        else:
            expected = of_coulomb(row["friction"], angle_of(row))
            checks.append(Check(f"acceleration, {name}", "m/s^2", expected, 1e-3 / END + 0.01 * expected,
                                row["acceleration_m_s2"],
                                "g (sin a - friction cos a); 1 % and 1 mm/s"))
    for friction, step in dict.fromkeys((row["friction"], row["step_s"]) for row in rows):
        sliding = [row for row in cases.of(rows, friction=friction, step_s=step) if row["beyond_deg"] > 0]
        slope, offset = np.polyfit([row["beyond_deg"] for row in sliding],
                                   [row["acceleration_m_s2"] for row in sliding], 1)
        coulomb = math.degrees(math.atan(friction))
        name = f"angle at which sliding begins, friction {friction:g}, steps of {1000 * step:g} ms"
        checks.append(Check(name, "degrees", coulomb, 0.1, coulomb - offset / slope,
                            "atan(friction); where the line through the accelerations is zero"))
    return checks


def draw(axes, rows):
    for friction in cases.values(rows, "friction"):
        found = cases.of(rows, friction=friction)
        angles = np.linspace(math.degrees(angle_of(found[0])), math.degrees(angle_of(found[-1])), 200)
        axes.plot(angles, [of_coulomb(friction, math.radians(a)) for a in angles], color="0.6")
        axes.plot([math.degrees(angle_of(row)) for row in found], [row["acceleration_m_s2"] for row in found], "o",
                  label=f"friction {friction:g}")
    axes.set_xlabel("angle of the plane, degrees")
    axes.set_ylabel("acceleration, m/s^2 (grey: Coulomb)")
    axes.legend()
