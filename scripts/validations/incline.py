"""A patch of cloth on an inclined plane: it sticks up to Coulomb's angle, and slides beyond it as Coulomb says."""
import math

import numpy as np

from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = ("A patch of cloth on an inclined plane sticks up to Coulomb's angle, for seconds, and slides beyond it with "
         "Coulomb's acceleration.")
KEYS = ["plane", "friction", "beyond_deg", "step_s", "end_s"]
SHORT, LONG, THICKNESS = 0.3, 6.0, 0.001  # s, s, m
STUCK, STILL = 1e-4, 1e-5  # m that a patch which sticks may move in SHORT, and creep in the second half of LONG
BEYOND = (-3, -1, -0.25, 0.25, 1, 5)  # degrees from Coulomb's angle
# How a plane is inclined: towards x with the mesh along it, askew to both, or tilted within TILTED s from level on,
# with the cloth on it.
PLANES = {"straight": (0.0, 0.0), "askew": (0.65, 0.3), "tilted": (0.65, 0.3)}  # rad: towards where; the mesh in it
TILTED = 1.5


def plan(quick):
    if quick:
        return cases.points(KEYS, *(("straight", 0.5, beyond, 0.005, SHORT) for beyond in (-1, 1, 5)),
                            ("tilted", 0.5, -1, 0.005, LONG))
    short = [("straight", friction, beyond, 0.005, SHORT) for friction in (0.2, 0.5) for beyond in BEYOND]
    short += [("straight", 0.5, beyond, 0.001, SHORT) for beyond in BEYOND]
    short += [("askew", 0.5, beyond, 0.005, SHORT) for beyond in (1, 5)]
    long = [(plane, 0.5, beyond, step, LONG) for plane in PLANES for beyond in (-1, -0.25)
            for step in (0.01, 0.005, 0.0025)]
    return cases.points(KEYS, *short, *long, *(("tilted", 0.5, 3, step, 2 * TILTED) for step in (0.005, 0.0025)))


def angle_of(row):
    return math.atan(row["friction"]) + math.radians(row["beyond_deg"])


def turn(axis, angle):
    """The matrix that turns about an axis of length 1."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def rotation(matrix):
    """The same in a case."""
    angle = math.acos(min(1.0, (np.trace(matrix) - 1) / 2))
    axis = [matrix[2, 1] - matrix[1, 2], matrix[0, 2] - matrix[2, 0], matrix[1, 0] - matrix[0, 1]]
    return {"axis": [float(x) for x in axis] if angle else [0, 0, 1], "angle": angle}


def measure(laboratory, point):
    angle, (towards, askew) = angle_of(point), PLANES[point["plane"]]
    level = [-math.sin(towards), math.cos(towards), 0]
    incline, in_plane = turn(level, angle), turn([0, 0, 1], towards + askew)
    is_tilted = point["plane"] == "tilted"
    placed = in_plane if is_tilted else incline @ in_plane
    normal = np.array([0, 0, 1]) if is_tilted else incline[:, 2]
    down = incline @ [math.cos(towards), math.sin(towards), 0]
    keyframes = [{"time": 0}, {"time": TILTED, "rotate": {"axis": level, "angle": angle}}]
    obstacle = {"plane": {"reach": 1}, "motion": keyframes} if is_tilted else {"plane": {"normal": normal.tolist()}}
    start = THICKNESS * normal - placed @ [0.05, 0.05, 0]
    case = {"cloth": {"grid": {"size": [0.1, 0.1], "vertices": [9, 9]},
                      "start": {"rotate": rotation(placed), "translate": start.tolist()}},
            "obstacles": [{**obstacle, "friction": point["friction"]}],
            "contact": {"thickness": THICKNESS, "check": "step"},
            "time": cases.steps_of(point["end_s"], point["step_s"], 120 if point["end_s"] == LONG else 20)}
    run = laboratory.whole_run(case)
    at = [float(frame.positions.mean(axis=0) @ down) for frame in run.frames]
    speed = [float(frame["velocities"].mean(axis=0) @ down) for frame in run.frames]
    since = [frame.time >= 1.2 * TILTED for frame in run.frames].index(True) if is_tilted else 0
    seconds = run.frames[-1].time - run.frames[since].time
    creep, tremble = trend([frame.time for frame in run.frames], at)
    return {"moved_m": at[-1], "creep_m": creep, "tremble_m": tremble,
            "acceleration_m_s2": (speed[-1] - speed[since]) / seconds,
            "intersections": run.summary["contact"]["intersections"]}


def trend(times, at):
    """How far the line through the places of the second half of a run goes, and how far they are from it, root mean
    square: cloth that stays where it is may tremble there within the strain allowed."""
    late = np.array(times) >= times[-1] / 2
    t, x = np.array(times)[late], np.array(at)[late]
    line = np.polyfit(t, x, 1)
    return line[0] * (t[-1] - t[0]), float(np.sqrt(np.mean((x - np.polyval(line, t)) ** 2)))


def of_coulomb(friction, angle):
    """g (sin - friction cos) beyond its angle, 0 up to it."""
    return max(0.0, G * (math.sin(angle) - friction * math.cos(angle)))


def judge(rows):
    checks = []
    for row in rows:
        side = "beyond" if row["beyond_deg"] > 0 else "below"
        name = f"{row['plane']}, friction {row['friction']:g}, {abs(row['beyond_deg']):g} degrees {side} Coulomb's "
        name += f"angle, steps of {1000 * row['step_s']:g} ms"
        if row["beyond_deg"] > 0:
            expected = of_coulomb(row["friction"], angle_of(row))
            checks.append(Check(f"acceleration, {name}", "m/s^2", expected, 1e-3 / SHORT + 0.01 * expected,
                                row["acceleration_m_s2"],
                                "g (sin a - friction cos a); 1 % and 1 mm/s"))
        elif row["end_s"] == SHORT:
            checks.append(Check(f"moved after {SHORT:g} s, {name}", "m", 0, STUCK, row["moved_m"], "sticks"))
        else:
            checks += [Check(f"moved after {LONG:g} s, {name}", "m", 0, G * row["step_s"]**2, row["moved_m"],
                             "sticks; what falls moves so far in a step"),
                       Check(f"creep in the second half of it, {name}", "m", 0, STILL, row["creep_m"],
                             f"sticks; trembles by {1e6 * row['tremble_m']:.2g} um about that, root mean square")]
    short = cases.of(rows, plane="straight", end_s=SHORT)
    for friction, step in dict.fromkeys((row["friction"], row["step_s"]) for row in short):
        sliding = [row for row in cases.of(short, friction=friction, step_s=step) if row["beyond_deg"] > 0]
        slope, offset = np.polyfit([row["beyond_deg"] for row in sliding],
                                   [row["acceleration_m_s2"] for row in sliding], 1)
        coulomb = math.degrees(math.atan(friction))
        name = f"angle at which sliding begins, friction {friction:g}, steps of {1000 * step:g} ms"
        checks.append(Check(name, "degrees", coulomb, 0.1, coulomb - offset / slope,
                            "atan(friction); where the line through the accelerations is zero"))
    return checks


def draw(axes, rows):
    short = cases.of(rows, plane="straight", end_s=SHORT)
    for friction in cases.values(short, "friction"):
        found = cases.of(short, friction=friction)
        angles = np.linspace(math.degrees(angle_of(found[0])), math.degrees(angle_of(found[-1])), 200)
        axes.plot(angles, [of_coulomb(friction, math.radians(a)) for a in angles], color="0.6")
        axes.plot([math.degrees(angle_of(row)) for row in found], [row["acceleration_m_s2"] for row in found], "o",
                  label=f"friction {friction:g}")
    axes.set_xlabel("angle of the plane, degrees")
    axes.set_ylabel("acceleration, m/s^2 (grey: Coulomb)")
    axes.legend()
