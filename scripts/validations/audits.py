"""Momentum, angular momentum and energy, where physics or the integrator says what becomes of them."""
import numpy as np

from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = ("A sheet thrown and let go where there is no gravity, and one that falls with damping: momentum, angular "
         "momentum, energy.")
KEYS = ["audit", "method"]
SIDE, SIZE, DENSITY, STEP, RELEASE = 9, 0.5, 0.2, 0.004, 0.1
MASS = DENSITY * SIZE**2  # kg
STRAIN = 1e-6


WOVEN, LIMP = {"bending": 1e-4, "shear": 5}, {"bending": 0, "shear": 0}
FLIGHTS = {"flight": (WOVEN, True), "limp flight": (LIMP, True), "limp flight, no carried tension": (LIMP, False)}


def plan(quick):
    methods = ("fast_projection", "icd", "sap")[:2 if quick else 3]
    plan = [("flight", method) for method in (methods if quick else (*methods, "gauss_seidel", "none"))]
    plan += [("limp flight", method) for method in ("fast_projection", "icd") if not quick]
    plan += [("limp flight, no carried tension", method) for method in methods]
    return cases.points(KEYS, *plan, *(("damped fall", method) for method in methods))


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


def energies(steps):
    return sum(values for name, values in steps.items() if name.endswith("_J"))


def growth(energy):
    return max(0.0, *np.diff(energy))


def flight(laboratory, method, material, carried):
    """From the first step of which the sheet is free: how linear momentum changes, how energy grows in a step, and by
    how much L' = L + h sum m v' x v is violated. That holds for impulses along the edges as they are at the end of the
    step; bending, shear and the tension carried into the step have forces of the candidate."""
    run = laboratory.whole_run(thrown(method, material, carried))
    frames = run.frames[round(RELEASE / STEP) + 1:]
    x, v = ([frame[name] for frame in frames] for name in ("positions", "velocities"))
    m = masses()
    linear = np.array([(m * now).sum(axis=0) for now in v])
    angular = np.array([np.cross(at, m * now).sum(axis=0) for at, now in zip(x, v)])
    gained = STEP * np.array([np.cross(then, m * now).sum(axis=0) for now, then in zip(v, v[1:])])
    violated = np.abs(np.diff(angular, axis=0) - gained).max() / np.linalg.norm(angular, axis=1).max()
    free = run.steps["time_s"] > RELEASE + STEP / 2
    energy, whole_steps = energies(run.steps)[free], not run.steps["rejected"][free].any()
    return {"linear": float(np.abs(linear - linear[0]).max() / np.linalg.norm(linear[0])),
            "growth": growth(energy) / energy[0],
            "angular": float(violated) if whole_steps else float("nan")}  # else a frame is not a step


def damped_fall(laboratory, method):
    """A sheet let go while two corners that are not neighbours are held."""
    case = {"cloth": cloth(method, {"bending": 1e-4, "shear": 10}, mass=1, stiffness=0.01),
            "pins": [{"vertices": [0, SIDE * SIDE - 1]}],
            "inextensibility": inextensibility(method), "time": cases.steps_of(1, STEP)}
    return {"linear": float("nan"), "growth": growth(energies(laboratory.whole_run(case).steps)) / (MASS * G * SIZE),
            "angular": float("nan")}


def measure(laboratory, point):
    if point["audit"] == "damped fall":
        return damped_fall(laboratory, point["method"])
    return flight(laboratory, point["method"], *FLIGHTS[point["audit"]])


def checks_of(row):
    audit, method = row["audit"], row["method"]
    if audit != "damped fall":
        yield Check(f"relative change of linear momentum, {audit}, {method}", "", 0, 1e-9, row["linear"],
                    "conserved, to the tolerance of the solvers")
    if audit.endswith("no carried tension"):
        yield Check(f"relative violation of the angular identity in a step, {audit}, {method}", "", 0, STRAIN,
                    row["angular"],
                    "L' = L + h sum m v' x v; the strain asked for")
    yield Check(f"growth of total energy in a step, {audit}, {method}", "", 0, 1e-6, row["growth"],
                f"never grows; relative to {'m g l' if audit == 'damped fall' else 'the energy at its start'}")


def judge(rows):
    return [check for row in rows for check in checks_of(row)]


def draw(axes, rows):
    places = {method: place for place, method in enumerate(cases.values(rows, "method"))}
    for audit, color in zip(cases.values(rows, "audit"), ("C0", "C3", "C2", "C1")):
        found = cases.of(rows, audit=audit)
        for column, marker in (("linear", "o"), ("angular", "s"), ("growth", "^")):
            shown = [(places[row["method"]], max(row[column], 1e-17)) for row in found if row[column] == row[column]]
            axes.plot([x for x, _ in shown], [y for _, y in shown], marker, color=color, fillstyle="none", linestyle="",
                      label=f"{audit}: {column}" if shown else None)
    axes.set_xticks(list(places.values()), list(places))
    axes.axhline(STRAIN, color="black", linewidth=0.8, label="strain asked for")
    axes.set_yscale("log")
    axes.set_ylabel("relative change or violation (0: at 1e-17)")
    axes.legend(fontsize=6, ncols=2)
