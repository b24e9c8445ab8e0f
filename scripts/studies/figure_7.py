"""A scene with all in it [as G07 figures 7 and 8, which say no figures]: a cloth falls on a sphere over a floor, folds and lies on
itself; strain and intersections of every step."""
import csv

from studies import scenes
from studies.table import Study

KEYS = ["vertices_a_side", "end_s"]


def plan(quick):
    return [dict(zip(KEYS, (21, 0.5) if quick else (71, 1.5)))]


def measure(laboratory, point):
    run = laboratory.whole_run(scenes.sphere(int(point["vertices_a_side"]), point["end_s"]))
    with open(run.folder / "steps.csv", newline="") as file:
        steps = [{key: float(value) for key, value in row.items()} for row in csv.DictReader(file)]
    return [{"time_s": row["time_s"], "strain": row["strain_max"], "contacts": row["contacts"], "projections": row["projection_iterations"],
             "rejected": row["rejected"], "depth_m": row["depth_m"], "strain_asked": run.summary["strain"]["limit"],
             "intersections": run.summary["contact"]["intersections"]} for row in steps]


def draw(axes, rows):
    times = [row["time_s"] for row in rows]
    axes.plot(times, [100 * row["strain"] for row in rows], label="largest strain, %")
    axes.plot(times, [row["projections"] for row in rows], label="projections a step", linewidth=0.7)
    axes.plot(times, [row["contacts"] / 1000 for row in rows], label="thousand contacts")
    axes.set_xlabel("time, s")
    axes.legend()


def judge(rows):
    strain, limit = max(row["strain"] for row in rows), rows[0]["strain_asked"]
    text = (f"{rows[0]['vertices_a_side']:g} vertices a side, {rows[-1]['time_s']:g} s: {len(rows)} steps, {sum(row['rejected'] for row in rows):g} rejected, "
            f"strain {100 * strain:.3f} % of {100 * limit:g} % permitted, {rows[0]['intersections']:g} intersections in any step, up to "
            f"{max(row['contacts'] for row in rows):g} contacts, {sum(row['projections'] for row in rows) / len(rows):.2f} projections a step")
    return strain <= limit and rows[0]["intersections"] == 0, text


STUDY = Study("figure-7", "strain stays within the limit, and nothing intersects, in a scene with contact of all kinds.", KEYS, plan, measure,
              draw, judge)
