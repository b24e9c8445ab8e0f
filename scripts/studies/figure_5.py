"""A draping cloth by every method, over the strain limit and over resolution [G07 figure 5].

A fast wrong answer is no answer: next to the cost stand the strain that was asked for and the one that was had, and
how deep the cloth has fallen, because a cloth that does not fall does not stretch. XPBD has no limit: its substeps are
doubled until the strain is there. In the plots, hollow marks are runs that did not come to their end.
"""
from studies import scenes
from studies.experiment import Experiment, smallest

METHODS: dict[str, dict] = {
    "fast_projection": {}, "icd": {}, "sap": {}, "shake": {}, "shake lagged": {"shake": {"matrix": "lagged"}},
    "rattle": {}, "jacobi": {}, "gauss_seidel": {}, "xpbd": {}}
CONSTRAINED = list(METHODS)[:5]  # of the figure, which has no RATTLE
LIMITING = ["jacobi", "gauss_seidel"]
KEYS = ["method", "vertices_a_side", "strain_asked", "end_s"]
STEP = 0.005  # s at most; every method takes smaller ones where it must


def points(sides, strains, end):
    return [dict(zip(KEYS, (method, side, strain, end))) for side in sides for strain in strains for method in METHODS]


def plan_a(quick):
    return points([16], [0.1, 0.01, 0.001], 0.1) if quick else points([71], [0.1, 0.03, 0.01, 0.003, 0.001], 0.3)


def plan_b(quick):
    if quick:
        return points([16, 41], [0.01], 0.1)
    # beyond, the others take many minutes
    larger = [point for point in points([141], [0.01], 0.3) if point["method"] in ("fast_projection", "icd")]
    largest = [point for point in points([281], [0.01], 0.3) if point["method"] == "fast_projection"]
    return points([20, 40, 71, 100], [0.01], 0.3) + larger + largest


def measure(laboratory, point):
    method, side, strain = (point[key] for key in KEYS[:3])

    def run(**options):
        return laboratory.run(scenes.drape(side, point["end_s"], STEP, method=method.split()[0], strain=strain,
                                           **options))

    if method != "xpbd":
        return run(**METHODS[method]).measures()

    def try_substeps(substeps):
        found = run(xpbd={"substeps": substeps})
        return found if not found.completed or found.strain <= strain else None

    substeps, found = smallest([10 * 2**k for k in range(8)], try_substeps)
    if found is None:
        return {"status": "not reached"}
    return {**found.measures(), "substeps": substeps}


def completed(rows, method):
    return [row for row in rows if row["method"] == method and row["status"] == "completed"]


def draw_over(key, label):
    def draw(axes, rows):
        for method in METHODS:
            found = sorted((row[key], row["cpu_s_per_s"], row["status"]) for row in rows
                           if row["method"] == method and row.get("cpu_s_per_s"))
            line, = axes.loglog([x for x, _, _ in found], [y for _, y, _ in found], "o-", label=method)
            stopped = [(x, y) for x, y, status in found if status != "completed"]
            axes.plot([x for x, _ in stopped], [y for _, y in stopped], "o", color=line.get_color(),
                      markerfacecolor="white")
        axes.set_xticks(ticks := sorted({row[key] for row in rows}), [f"{value:g}" for value in ticks])
        axes.set_xticks([], minor=True)
        axes.set_xlabel(label)
        axes.set_ylabel("CPU s per simulated s")
        axes.legend(fontsize="small")
        if key == "strain_asked":
            axes.invert_xaxis()
    return draw


def shared(rows, key):
    """The values at which all methods that are judged came to their end: growth is compared over the same range."""
    done = [{row[key] for row in completed(rows, method)} for method in CONSTRAINED + LIMITING]
    return set.intersection(*done)


def growth(rows, method, key):
    """Cost at the hard end over cost at the easy one, of the range that is shared."""
    found = sorted((row[key], row["cpu_s_per_s"]) for row in completed(rows, method) if row[key] in shared(rows, key))
    if len(found) < 2:
        return None
    return found[0][1] / found[-1][1] if key == "strain_asked" else found[-1][1] / found[0][1]


def told(value):
    return "not known" if value is None else f"{value:.1f}"


def table(rows, key):
    lines = [f"growth of cost is that between {key} {min(shared(rows, key)):g} and {max(shared(rows, key)):g}"]
    for method in METHODS:
        done, asked = completed(rows, method), [row for row in rows if row["method"] == method]
        grows = told(growth(rows, method, key))
        lines.append(f"{method}: {len(done)} of {len(asked)} completed, cost grows by {grows}")
    return lines


def fastest(rows, key):
    """[(value, the method of least cost among those that have a limit)]."""
    result = []
    for value in sorted({row[key] for row in rows}):
        costs = {method: row["cpu_s_per_s"] for method in METHODS if method != "xpbd" for row in completed(rows, method)
                 if row[key] == value}
        if costs:
            result.append((value, min(costs, key=lambda method: costs[method])))
    return result


def judge(rows, key):
    """Constrained methods grow less than sweeps, and at the hard end Fast Projection is the fastest of all."""
    first = fastest(rows, key)
    lines = table(rows, key) + [f"fastest at {key} {value:g}: {method}" for value, method in first]
    clm = [g for g in (growth(rows, method, key) for method in CONSTRAINED) if g is not None]
    limiting = [g for g in (growth(rows, method, key) for method in LIMITING) if g is not None]
    hardest = first[0 if key == "strain_asked" else -1][1] if first else None
    return bool(clm and limiting) and max(clm) < max(limiting) and hardest == "fast_projection", "\n".join(lines)


CLAIM = "constrained methods scale better than strain limiting, and where it is hardest Fast Projection is the fastest"
STUDIES = [
    Experiment(
        "figure-5a", f"over the strain limit, {CLAIM}.",
        KEYS, plan_a, measure, draw_over("strain_asked", "strain asked for"), lambda rows: judge(rows, "strain_asked")),
    Experiment(
        "figure-5b", f"over resolution at 1 %, {CLAIM}.",
        KEYS, plan_b, measure, draw_over("vertices_a_side", "vertices a side"),
        lambda rows: judge(rows, "vertices_a_side"))]
