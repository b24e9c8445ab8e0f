"""A sheet that nothing holds: the sums that each integrator makes of g, to the last digits."""
from validations import cases
from validations.cases import G
from validations.checks import Check

ABOUT = "A sheet that nothing holds falls as the integrator's own sum says, and so with its order towards g t²/2."
KEYS = ["integrator", "step_s"]
END = 0.4  # s


def plan(quick):
    steps = (0.02, 0.01) if quick else (0.02, 0.01, 0.005, 0.0025)
    return cases.points(KEYS, *((integrator, step) for integrator in ("implicit_euler", "bdf2", "imex")
                                for step in steps))


def measure(laboratory, point):
    step = point["step_s"]
    case = {"cloth": {"grid": {"size": [1, 1], "vertices": [9, 9]}}, **cases.EXACT,
            "time": cases.steps_of(END, step, integrator=point["integrator"])}
    return {"depth_m": -laboratory.whole_run(case).frames[-1].positions[:, 2].mean()}


def of_scheme(row):
    """Euler's steps, implicit or IMEX, add up to g t (t + h) / 2. BDF2 begins with such a step, whose error g h^2 / 2
    its formula e' = (4 e - e_before) / 3 takes to 3/4 g h^2 (1 - 3^-n)."""
    h = row["step_s"]
    if row["integrator"] != "bdf2":
        return G * END * (END + h) / 2
    return G * END**2 / 2 + 0.75 * G * h**2 * (1 - 3.0 ** -round(END / h))


def judge(rows):
    checks = [Check(f"depth after {END} s, {row['integrator']}, steps of {1000 * row['step_s']:g} ms", "m",
                    of_scheme(row), 1e-6,
                    row["depth_m"], "the integrator's own sum (formula in the code)") for row in rows]
    for integrator, expected in (("implicit_euler", 1), ("bdf2", 2), ("imex", 1)):
        found = cases.of(rows, integrator=integrator)
        fine, coarse = (abs(row["depth_m"] - G * END**2 / 2) for row in (found[-1], found[-2]))
        checks.append(Check(f"order of the error against g t^2 / 2, {integrator}", "", expected, 0.05,
                            cases.order(fine, coarse),
                            "order of the integrator"))
    return checks


def draw(axes, rows):
    for integrator in cases.values(rows, "integrator"):
        found = cases.of(rows, integrator=integrator)
        axes.loglog([1000 * row["step_s"] for row in found], [abs(row["depth_m"] - G * END**2 / 2) for row in found],
                    "o-" if integrator != "imex" else "x--", label=integrator)
    axes.set_xlabel("time step, ms")
    axes.set_ylabel(f"|depth - g t^2 / 2| after {END} s, m")
    axes.legend()
