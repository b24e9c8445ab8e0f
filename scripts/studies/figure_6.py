"""The same drape by ICD and by Fast Projection [G07 figure 6], and, as a scale, by Fast Projection at half the step."""
import matplotlib.pyplot as plt
import numpy as np

from studies import scenes
from studies.experiment import rms

ABOUT = "Fast Projection and ICD give similar results: no farther apart than by what halving the step changes."
KEYS = ["vertices_a_side", "end_s", "max_step_s"]


def plan(quick):
    return [dict(zip(KEYS, (13, 0.4, 0.005) if quick else (71, 1.0, 0.005)))]


def measure(laboratory, point):
    side, end, step = (point[key] for key in KEYS)

    def frames(method, step_there):
        return laboratory.whole_run(scenes.drape(side, end, step_there, method=method, strain=0.01)).frames

    fast, icd, half = frames("fast_projection", step), frames("icd", step), frames("fast_projection", step / 2)
    draw_shapes(laboratory.stem, side, {"Fast Projection": fast[-1].positions, "ICD": icd[-1].positions})
    return [distances(*frames_then) for frames_then in zip(fast, icd, half)]


def distances(fast, icd, half):
    """Of three frames of one time."""
    x, y, z = fast.positions, icd.positions, half.positions
    return {"time_s": fast.time, "rms_icd_m": rms(x, y), "max_icd_m": float(np.linalg.norm(x - y, axis=1).max()),
            "rms_half_step_m": rms(x, z)}


def draw_shapes(stem, side, shapes):
    figure = plt.figure(figsize=(8, 4), layout="constrained")
    for k, (name, x) in enumerate(shapes.items()):
        axes = figure.add_subplot(1, 2, k + 1, projection="3d", title=name)
        axes.plot_surface(*(x[:, i].reshape(side, side) for i in range(3)), color="#6b94c2", linewidth=0.2,
                          edgecolor="#26262d")
        axes.set_aspect("equal")
        axes.set_box_aspect(None, zoom=0.8)
    figure.savefig(stem.parent / (stem.name + "-shapes.png"), dpi=130)
    plt.close(figure)


def draw(axes, rows):
    times = [row["time_s"] for row in rows]
    for name, label in (("rms_icd_m", "ICD, RMS"), ("max_icd_m", "ICD, largest"),
                        ("rms_half_step_m", "half the step, RMS")):
        axes.plot(times, [1000 * row[name] for row in rows], label=label)
    axes.set_xlabel("time, s")
    axes.set_ylabel("distance from Fast Projection, mm")
    axes.legend()


def judge(rows):
    last, side = rows[-1], rows[-1]["vertices_a_side"]
    text = (f"at {last['time_s']:g} s, {side:g} x {side:g} vertices, 1 m: RMS distance of the vertices "
            f"{1000 * last['rms_icd_m']:.2f} mm, "
            f"largest {1000 * last['max_icd_m']:.2f} mm; of Fast Projection at half the step: "
            f"{1000 * last['rms_half_step_m']:.2f} mm")
    return last["rms_icd_m"] <= last["rms_half_step_m"], text
