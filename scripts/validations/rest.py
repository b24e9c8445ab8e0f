"""Cloth that hangs by two corners, or fell on obstacles, by Newton's method on the whole step, until it is still."""
import yaml

from taut import launch
from validations import cases
from validations.cases import G
from validations.checks import Check, band

ABOUT = ("Squares of cloth hung by two corners come to rest at steps of 10 ms, and hang as deep whatever the step. "
         "Fast Projection keeps the small one at 0.2 m/s for ever. Cloth that fell on obstacles rests too.")
KEYS = ["scene", "size_m", "vertices_a_side", "mass_damping", "step_s"]
DENSITY, END, LATE = 0.2, 20.0, 15.0  # kg/m^2, s, s
# Folders in cases: metres from the highest point of the cloth at the start to the lowest ground, kg.
FALLEN = {"sphere": (0.62, 0.2), "table": (0.42, 0.2), "layers": (0.42, 0.81 * (0.15 + 0.324)), "pile": (1.54, 0.2)}
FALLEN_END, FALLEN_LATE = 10.5, 10.0  # s


def plan(quick):
    small = ("hung", 0.3, 11, 0.5, 0.01)
    square = [("hung", 1.0, 41, 0.5, step) for step in (0.01, 0.005, 0.0025)]
    fallen = [(scene, 0.9 if scene == "layers" else 1.0, 21, 0.5, 0.01) for scene in FALLEN]
    if quick:
        return cases.points(KEYS, small, fallen[0])
    return cases.points(KEYS, small, *square, ("hung", 1.0, 71, 0.5, 0.01), *fallen)


def fall(laboratory, point):
    """A case of the folder, coarser, at longer steps and with this damping."""
    side, damping = int(point["vertices_a_side"]), point["mass_damping"]
    case = yaml.safe_load((launch.ROOT / "cases" / point["scene"] / "case.yaml").read_text())
    for cloth in case.get("cloths", [case.get("cloth")]):
        cloth["grid"]["vertices"] = [side, side]
        cloth["material"]["damping"] = {"mass": damping}
    case["inextensibility"] = {"method": "newton"}
    case["time"] = cases.steps_of(FALLEN_END, point["step_s"], 21)
    return laboratory.whole_run(case)


def measure(laboratory, point):
    if point["scene"] in FALLEN:
        run = fall(laboratory, point)
        late = run.steps["time_s"] >= FALLEN_LATE
        drift = abs(run.frames[-1].positions - run.frames[-2].positions).max()
        return {"late_J": float(max(run.steps["kinetic_J"][late])), "end_J": float(run.steps["kinetic_J"][-1]),
                "depth_m": float(run.steps["depth_m"][-1]), "drift_m": float(drift),
                "rejected": run.summary["rejected_steps"]}
    size, side = point["size_m"], int(point["vertices_a_side"])
    inward = 0.05 * size
    case = {"cloth": {"grid": {"size": [size, size], "vertices": [side, side]},
                      "material": {"density": DENSITY, "bending": 1e-5, "shear": 10,
                                   "damping": {"mass": point["mass_damping"]}}},
            "pins": [{"vertices": [0], "motion": [{"time": 0}, {"time": 0.3, "translate": [inward, 0, 0]}]},
                     {"vertices": [side - 1], "motion": [{"time": 0}, {"time": 0.3, "translate": [-inward, 0, 0]}]}],
            "inextensibility": {"method": "newton"}, "time": cases.steps_of(END, point["step_s"], int(END))}
    run = laboratory.whole_run(case)
    steps, last, before = run.steps, run.frames[-1], run.frames[-2]
    late = steps["time_s"] >= LATE
    return {"late_J": float(max(steps["kinetic_J"][late][:10])), "end_J": float(steps["kinetic_J"][-1]),
            "depth_m": float(steps["depth_m"][-1]),
            "drift_m": float(abs(last.positions - before.positions).max()), "rejected": run.summary["rejected_steps"]}


def judge(rows):
    checks = []
    for row in cases.of(rows, scene="hung"):
        name = "{:g} vertices a side, {:g} m, steps of {:g} ms".format(row["vertices_a_side"], row["size_m"],
                                                                       1000 * row["step_s"])
        energy = DENSITY * row["size_m"]**2 * G * row["depth_m"]
        checks += [band(f"kinetic energy at {LATE:g} s over weight times height, {name}", "", 0, 1e-6,
                        row["late_J"] / energy, "it rests"),
                   band(f"the same at {END:g} s over that at {LATE:g} s, {name}", "", 0, 1,
                        row["end_J"] / row["late_J"], "and ever more"),
                   band(f"farthest a vertex moves in the last second, {name}", "mm", 0, 0.1, 1000 * row["drift_m"],
                        "it does not drift")]
    for row in rows:
        if row["scene"] in FALLEN:
            height, mass = FALLEN[row["scene"]]
            checks.append(band(f"kinetic energy from {FALLEN_LATE:g} s on over weight times height, {row['scene']}", "",
                               0, 1e-5, row["late_J"] / (mass * G * height), "it rests, without a burst"))
    squares = cases.of(rows, scene="hung", vertices_a_side=41)
    checks += [Check(f"depth, 41 vertices a side, steps of {1000 * row['step_s']:g} ms", "m", squares[-1]["depth_m"],
                     0.01 * squares[-1]["depth_m"], row["depth_m"], "at steps of 2.5 ms; 1 %") for row in squares[:-1]]
    return checks


def draw(axes, rows):
    for row in cases.of(rows, scene="hung"):
        axes.semilogy([LATE, END], [row["late_J"], row["end_J"]], "o-",
                      label="{:g}², {:g} ms".format(row["vertices_a_side"], 1000 * row["step_s"]))
    axes.set_xlabel("time, s")
    axes.set_ylabel("kinetic energy, J")
    axes.legend()
