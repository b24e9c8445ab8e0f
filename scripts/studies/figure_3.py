"""What Fast Projection leaves of the balance of forces [G07 figure 3], by force_residual next to the program."""
import csv
import io
import math
import statistics
import subprocess

from studies import scenes
from taut.launch import ENVIRONMENT

STEPS = [0.02, 0.01, 0.005, 0.0025, 0.00125, 0.000625, 0.0003125]
ABOUT = "what the first iteration leaves of F vanishes with the step, and the iterations after it change it little."
KEYS = ["vertices_a_side", "end_s"]


def plan(quick):
    return [dict(zip(KEYS, (17, 0.6) if quick else (31, 1.0)))]


def measure(laboratory, point):
    side, end = (point[key] for key in KEYS)
    case = scenes.drape(side, end, 0.002, strain=1e-3, max_iterations=50)
    done = subprocess.run([laboratory.beside("force_residual"), laboratory.write(case), *map(str, STEPS)],
                          env=ENVIRONMENT, check=True, stdout=subprocess.PIPE, text=True)
    rows = list(csv.DictReader(io.StringIO(done.stdout)))
    return [{name: float(cell) for name, cell in row.items()} for row in rows]


def median(rows, step, name):
    return statistics.median(row[name] for row in rows if row["dt_s"] == step)


def steps_of(rows):
    return sorted({row["dt_s"] for row in rows})


def draw(axes, rows):
    for name in ("first", "last"):
        axes.loglog(steps_of(rows), [median(rows, step, name) for step in steps_of(rows)], "o-",
                    label=f"after the {name} iteration")
    axes.set_xlabel("time step, s")
    axes.set_ylabel("|F| / |M g|, median over steps")
    axes.legend()


def judge(rows):
    steps = steps_of(rows)
    lines = [f"h = {1000 * step:g} ms: {median(rows, step, 'iterations'):g} iterations, |F|/|Mg| "
             f"{median(rows, step, 'first'):.3g} "
             f"after the first, {median(rows, step, 'last'):.3g} after the last" for step in steps]
    order = math.log(median(rows, steps[1], "last") / median(rows, steps[0], "last")) / math.log(steps[1] / steps[0])
    kept = all(median(rows, step, "last") < 2 * median(rows, step, "first") for step in steps)
    lines.append(f"order in h between the two shortest steps: {order:.1f}")
    return order >= 1 and kept, "\n".join(lines)
