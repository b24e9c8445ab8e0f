"""Momentum, angular momentum and energy, where physics or the integrator says what becomes of them."""
import numpy as np

from validations import cases
from validations.cases import G
from validations.checks import Check, Validation

KEYS = ["audit", "method"]
SIDE, SIZE, DENSITY, STEP, RELEASE = 9, 0.5, 0.2, 0.004, 0.1
MASS = DENSITY * SIZE**2  # kg
STRAIN = 1e-6


def plan(quick):
    methods = ("fast_projection", "icd") if quick else ("fast_projection", "icd", "sap", "gauss_seidel", "none")
    return cases.points(KEYS, *(("free flight", method) for method in methods), *(("spin", method) for method in methods[:3]),
                        *(("damped fall", method) for method in methods[:3]))


def inextensibility(method, carried=True):
    tight = {"strain": STRAIN, "compliance": 1e-9, "max_iterations": 50, "solver": "mumps", "carried_tension": carried}
    return {"method": method, **({} if method == "none" else {"strain": STRAIN} if method == "gauss_seidel" else tight)}


def cloth(method, material, **damping):
    return {"grid": {"size": [SIZE, SIZE], "vertices": [SIDE, SIDE]},
            "material": {"density": DENSITY, **material, "damping": damping,
                         **({"stretch": 100} if method == "none" else {})}}


def thrown(method, material, carried):
    """One corner swings the sheet and lifts it; at RELEASE it lets it go, and nothing acts on it any more."""
    turn = {"axis": [1, 1, 0], "angle": "60 deg", "centre": [0, 0, 0.3]}
    motion = [{"time": 0}, {"time": 0.2, "rotate": turn, "translate": [0.2, 0, 0.4]}]
    return {"cloth": cloth(method, material), "pins": [{"vertices": [0], "motion": motion, "release": RELEASE}],
            "gravity": [0, 0, 0], "velocity": {"solver": "mumps"}, "inextensibility": inextensibility(method, carried),
            "time": cases.steps_of(2 * RELEASE, STEP, round(2 * RELEASE / STEP))}


def masses():
    """Of the vertices: each cell gives a quarter to its corners."""
    ends = np.ones(SIDE)
    ends[[0, -1]] = 0.5
    return (MASS / (SIDE - 1) ** 2 * np.outer(ends, ends)).ravel()[:, None]


def flight(laboratory, case):
    """Masses, positions and velocities from the first step of which the sheet is free."""
    run = laboratory.whole_run(case)
    first = round(RELEASE / STEP) + 1
    return masses(), *([field for _, field in run.frames(name)][first:] for name in ("positions", "velocities"))


def free_flight(laboratory, method):
    m, _, v = flight(laboratory, thrown(method, {"bending": 1e-4, "shear": 5}, True))
    linear = np.array([(m * now).sum(axis=0) for now in v])
    return {"linear": float(np.abs(linear - linear[0]).max() / np.linalg.norm(linear[0]))}


def spin(laboratory, method):
    """Impulses along the edges as they are at the end of the step, and no others, leave L' = L + h sum m v' x v. So no bending,
    shear and carried tension here, whose forces are those of the candidate."""
    m, x, v = flight(laboratory, thrown(method, {"bending": 0, "shear": 0}, False))
    angular = np.array([np.cross(at, m * now).sum(axis=0) for at, now in zip(x, v)])
    gained = STEP * np.array([np.cross(then, m * now).sum(axis=0) for now, then in zip(v, v[1:])])
    return {"angular": float(np.abs(np.diff(angular, axis=0) - gained).max() / np.linalg.norm(angular, axis=1).max())}


def damped_fall(laboratory, method):
    """A sheet let go while two corners that are not neighbours are held."""
    case = {"cloth": cloth(method, {"bending": 1e-4, "shear": 10}, mass=1, stiffness=0.01), "pins": [{"vertices": [0, SIDE * SIDE - 1]}],
            "inextensibility": inextensibility(method), "time": cases.steps_of(1, STEP)}
    rows = laboratory.whole_run(case).steps()
    energy = [sum(value for name, value in row.items() if name.endswith("_J")) for row in rows]
    return {"growth_J": max(after - before for before, after in zip(energy, energy[1:])), "lost_J": energy[0] - energy[-1]}


AUDITS = {"free flight": free_flight, "spin": spin, "damped fall": damped_fall}


def measure(laboratory, point):
    return {**dict.fromkeys(("linear", "angular", "growth_J", "lost_J"), float("nan")),
            **AUDITS[point["audit"]](laboratory, point["method"])}


def check(row):
    method = row["method"]
    if row["audit"] == "free flight":
        return Check(f"relative change of linear momentum in free flight, {method}", "", 0, 1e-9, row["linear"],
                     "conserved, to the tolerance of the solvers")
    if row["audit"] == "spin":
        return Check(f"relative violation of the angular identity in a step, {method}", "", 0, STRAIN, row["angular"],
                     "L' = L + h sum m v' x v; the strain asked for")
    return Check(f"largest growth of total energy in a step of a damped fall, {method}", "J", 0, 1e-6 * MASS * G * SIZE,
                 max(0.0, row["growth_J"]), "never grows; 1e-6 m g l")


def judge(rows):
    return [check(row) for row in rows]


def draw(axes, rows):
    for audit, column, label in (("free flight", "linear", "change of linear momentum"),
                                 ("spin", "angular", "violation of the angular identity")):
        found = cases.of(rows, audit=audit)
        axes.plot([row["method"] for row in found], [row[column] for row in found], "o", label=label)
    axes.axhline(STRAIN, color="black", linewidth=0.8, label="strain asked for")
    axes.set_yscale("log")
    axes.set_ylabel("relative to the whole")
    axes.legend()


VALIDATION = Validation(
    "audits",
    "A sheet thrown and let go where there is no gravity, and one that falls with damping: momentum, angular "
    "momentum, energy.",
    KEYS, plan, measure, draw, judge)
