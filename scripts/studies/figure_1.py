"""A patch hung by two corners with less and less strain permitted [G07 figure 1].

What a cloth that stretches looks like is told by stiff springs, whose stiffness is doubled until the strain that is
asked for is kept; what Fast Projection makes of the same permission stands beside it.
"""
import matplotlib.pyplot as plt

from studies import scenes
from studies.experiment import smallest

METHODS = ["springs", "fast_projection"]
ABOUT = "the less strain is permitted, the more springs cost; Fast Projection keeps every limit at nearly one cost."
KEYS = ["method", "strain_asked", "vertices_a_side", "end_s"]
STEP = {"springs": 0.0001, "fast_projection": 0.005}  # s at most; the former for the jerk when the pins begin to move


def plan(quick):
    side, strains, end = (11, [0.1, 0.02], 0.5) if quick else (41, [0.1, 0.05, 0.01, 0.001], 0.5)
    return [dict(zip(KEYS, (method, strain, side, end))) for strain in strains for method in METHODS]


def measure(laboratory, point):
    method, strain, side, end = (point[key] for key in KEYS)
    if method == "fast_projection":
        run, stiffness = laboratory.run(scenes.drape(side, end, STEP[method], method=method, strain=strain)), None
    else:
        def try_stiffness(stiffness):
            found = laboratory.run(scenes.drape(side, end, STEP[method], method="springs",
                                                springs={"stiffness": stiffness}))
            return found if not found.completed or found.strain <= strain else None

        stiffness, run = smallest([2.0**k for k in range(2, 16)], try_stiffness)
        if run is None:
            return {"status": "not reached"}
    if run.completed:
        draw_shape(laboratory.stem, side, run.frames[-1].positions, f"{method}, {100 * strain:g} %")
    return {**run.measures(), "stiffness_N": stiffness or ""}


def draw_shape(stem, side, x, title):
    name = title.replace(", ", "-").replace(" %", "").replace("_", "-").replace(".", "p")
    figure = plt.figure(figsize=(4, 4), layout="constrained")
    axes = figure.add_subplot(projection="3d", title=title)
    axes.plot_surface(*(x[:, i].reshape(side, side) for i in range(3)), color="#6b94c2", linewidth=0.2,
                      edgecolor="#26262d")
    axes.set_xlim(0, 1), axes.set_ylim(-0.5, 0.5), axes.set_zlim(-1.2, 0)
    axes.set_box_aspect((1, 1, 1.2))
    axes.view_init(15, -60)
    figure.savefig(stem.parent / f"{stem.name}-{name}.png", dpi=90)
    plt.close(figure)


def of_method(rows, method):
    return sorted((row for row in rows if row["method"] == method and row["status"] == "completed"),
                  key=lambda row: row["strain_asked"])


def draw(axes, rows):
    for method in METHODS:
        found = of_method(rows, method)
        axes.loglog([row["strain_asked"] for row in found], [row["cpu_s_per_s"] for row in found], "o-", label=method)
    axes.set_xlabel("strain asked for")
    axes.set_ylabel("CPU s per simulated s")
    axes.legend()
    axes.invert_xaxis()


def judge(rows):
    """Springs grow dear, Fast Projection does not, and keeps every limit. Depths are told, but at one moment of a fall
    they are in no order."""
    springs, fast = of_method(rows, "springs"), of_method(rows, "fast_projection")
    lines = [f"{row['method']}, {100 * row['strain_asked']:g} % asked: {100 * row['strain_had']:.3g} % had, depth "
             f"{row['depth_m']:.3f} m, "
             f"{row['cpu_s_per_s']:.3g} CPU s per s" for row in springs + fast]
    lines += [f"{row['method']}, {100 * row['strain_asked']:g} % asked: {row['status']}" for row in rows
              if row["status"] != "completed"]
    dearer = len(springs) > 1 and springs[0]["cpu_s_per_s"] > springs[-1]["cpu_s_per_s"]
    costs = [row["cpu_s_per_s"] for row in fast]
    kept = (len(fast) == sum(row["method"] == "fast_projection" for row in rows) and
            all(row["strain_had"] <= row["strain_asked"] for row in fast))
    return dearer and kept and max(costs) < 2 * min(costs), "\n".join(lines)
