"""cases/two-pins on finer and finer meshes: what a simulated second costs, and the CG iterations of a projection on
many ranks."""
import math
import tempfile

CASE = "two-pins"
RATE = 25  # frames a second


def with_side(side):
    return [f"cloth.grid.vertices=[{side}, {side}]", f"pins=[{{vertices: [0, {side - 1}]}}]"]


def sets(side, end, *more):
    return [*with_side(side), f"time.end={end}", f"time.frame_rate={1 / end}", *more]


def fitted_exponent(numbers, values):
    """Of a power law through all points, by least squares in their logarithms."""
    x, y = [math.log(n) for n in numbers], [math.log(v) for v in values]
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def growth(run, sides, end, print_row):
    """The CPU seconds of the time steps, rejected ones included, of a simulated second; on one rank."""
    print_row(["vertices", "steps (rejected)", "CG a velocity solve", "projections a step", "CG a projection",
               "CPU s a simulated second"])
    print_row(["---"] * 6)
    costs = []
    for side in sides:
        s, _ = run(CASE, 1, sets(side, end))
        costs.append(s["seconds"]["cpu"] / s["end_time"])
        print_row([f"{side}²", f"{s['steps']} ({s['rejected_steps']})", f"{s['velocity']['ksp_iterations_mean']:.0f}",
                   f"{s['projection']['iterations_mean']:.1f}", f"{s['projection']['ksp_iterations_mean']:.1f}",
                   f"{costs[-1]:.3g}"])
    if len(sides) > 1:
        print(f"\nfirst {end} s: the cost grows as n^{fitted_exponent([side * side for side in sides], costs):.2f}, n "
              f"being the vertices")


def iterations(start, go_on, sides, ranks, end, print_row):
    """Of a cloth that has fallen for `end` seconds, on one rank, the steps of the next 0.04 s on each number of
    ranks."""
    print_row(["vertices", *(f"{r} rank{'s' * (r > 1)}" for r in ranks)])
    print_row(["---"] * (1 + len(ranks)))
    for side in sides:
        with tempfile.TemporaryDirectory() as folder:
            start(CASE, f"{folder}/fallen", sets(side, end, f"time.frame_rate={RATE}", "output.fields=[position]"))
            print_row([f"{side}²", *(f"{mean_of_projections(go_on(f'{folder}/fallen', r, end + 1 / RATE), end):.1f}"
                                     for r in ranks)])


def mean_of_projections(steps, since):
    """CG iterations of one, over all steps after `since`."""
    late = steps["time_s"] > since * (1 + 1e-9)
    return steps["projection_ksp_iterations"][late].sum() / steps["projection_iterations"][late].sum()
