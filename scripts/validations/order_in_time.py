"""A sheet held by one side, on one mesh with steps halved again and again: the order in which its end shape
converges."""
from studies.experiment import rms
from validations import cases
from validations.checks import Check

ABOUT = ("A sheet held by one side, its mesh fixed, no step rejected: distance between the shapes after 0.24 s with "
         "steps h and h/2.")
KEYS = ["forces", "integrator", "halvings"]
END, FIRST, SIDE = 0.24, 0.008, 9  # s, s
EDGES_KEPT = {"strain": 1e-6, "compliance": 0, "max_iterations": 50, "solver": "mumps"}
FORCES: dict[str, dict] = {
    "bending": {}, "bending, shear": {"shear": 5}, "bending, shear, air": {"shear": 5},
    "bending, stretch": {"stretch": 5}}
ORDERS = {"implicit_euler": 1, "bdf2": 2, "imex": 1}


def plan(quick):
    if quick:
        return cases.points(KEYS, ("bending", "implicit_euler", 3), ("bending, shear, air", "bdf2", 3),
                            ("bending, shear, air", "imex", 3))
    return cases.points(KEYS, *((forces, integrator, 5) for forces in FORCES for integrator in ORDERS))


def shape(laboratory, forces, integrator, step):
    """It starts tilted about an oblique axis, so that it swings and folds in all directions."""
    case = {"cloth": {"grid": {"size": [0.5, 0.5], "vertices": [SIDE, SIDE]},
                      "start": {"rotate": {"axis": [1, 4, 0], "angle": "30 deg"}},
                      "material": {"density": 0.2, "bending": 1e-4, "shear": 0, **FORCES[forces]}},
            "pins": [{"vertices": list(range(0, SIDE * SIDE, SIDE))}], **({"air": {}} if "air" in forces else {}),
            "velocity": {"solver": "mumps"}, "time": cases.steps_of(END, step, integrator=integrator),
            "inextensibility": {"method": "none"} if "stretch" in forces else EDGES_KEPT}
    run = laboratory.whole_run(case)
    return run.frames[-1].positions, run.summary["rejected_steps"]


def measure(laboratory, point):
    """A row a pair of steps: the distance between the shapes with h and h/2."""
    steps = [FIRST / 2**k for k in range(point["halvings"] + 1)]
    shapes = [shape(laboratory, point["forces"], point["integrator"], step) for step in steps]
    return [{"step_s": step, "rms_m": rms(coarse, fine), "rejected": rejected + also}
            for step, (coarse, rejected), (fine, also) in zip(steps, shapes, shapes[1:])]


def judge(rows):
    checks = []
    for (forces, integrator), found in series(rows):
        measured = cases.order(found[-1]["rms_m"], found[-2]["rms_m"])
        checks.append(Check(f"order in the time step, {integrator}; {forces}", "", ORDERS[integrator], 0.2, measured,
                            f"order of the integrator; {sum(row['rejected'] for row in found):g} steps rejected"))
    return checks


def series(rows):
    pairs = dict.fromkeys((row["forces"], row["integrator"]) for row in rows)
    return [(pair, cases.of(rows, forces=pair[0], integrator=pair[1])) for pair in pairs]


def draw(axes, rows):
    for (forces, integrator), found in series(rows):
        axes.loglog([1000 * row["step_s"] for row in found], [1000 * row["rms_m"] for row in found],
                    {"implicit_euler": "o-", "bdf2": "s-", "imex": "x--"}[integrator], label=f"{integrator}; {forces}")
    axes.set_xlabel("time step h, ms")
    axes.set_ylabel("RMS distance of the shapes with h and h/2, mm")
    axes.legend(fontsize=7)
