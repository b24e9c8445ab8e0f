"""One drape at rising resolution: distances at the vertices that all grids share.

The finest grid, which costs most of the study, runs for a shorter time; pairs are judged at the last time of all.
"""
from studies import scenes
from studies.experiment import rms

ABOUT = "shapes at rising resolution converge to one."
KEYS = ["vertices_a_side", "finer", "end_s", "max_step_s"]


def plan(quick):
    sides, ends, step = ([9, 17, 33], [0.2, 0.2], 0.005) if quick else ([71, 141, 281, 561], [0.5, 0.5, 0.3], 0.002)
    return [dict(zip(KEYS, (coarse, fine, end, step))) for coarse, fine, end in zip(sides, sides[1:], ends)]


def measure(laboratory, point):
    coarse, fine, end, step = (point[key] for key in KEYS)

    def shapes(side):
        run = laboratory.whole_run(scenes.drape(side, end, step, strain=0.01))
        every = (side - 1) // (coarse - 1)
        return [(frame.time, frame.positions.reshape(side, side, 3)[::every, ::every].reshape(-1, 3))
                for frame in run.frames]

    return [{"time_s": time, "rms_m": rms(x, y)} for (time, x), (_, y) in zip(shapes(coarse), shapes(fine))]


def pairs(rows):
    return sorted({(row["vertices_a_side"], row["finer"]) for row in rows})


def of_pair(rows, pair):
    return [row for row in rows if (row["vertices_a_side"], row["finer"]) == pair]


def draw(axes, rows):
    for pair in pairs(rows):
        found = of_pair(rows, pair)
        axes.plot([row["time_s"] for row in found], [1000 * row["rms_m"] for row in found], "o-",
                  label="{:g} and {:g} a side".format(*pair))
    axes.set_xlabel("time, s")
    axes.set_ylabel("RMS distance, mm")
    axes.legend()


def judge(rows):
    shared = min(max(row["time_s"] for row in of_pair(rows, pair)) for pair in pairs(rows))
    last = {pair: next(row for row in of_pair(rows, pair) if row["time_s"] == shared) for pair in pairs(rows)}
    lines = [f"{coarse:g} and {fine:g} vertices a side: {1000 * row['rms_m']:.2f} mm at {shared:g} s"
             for (coarse, fine), row in last.items()]
    distances = [row["rms_m"] for row in last.values()]
    return all(a > b for a, b in zip(distances, distances[1:])), "\n".join(lines)
