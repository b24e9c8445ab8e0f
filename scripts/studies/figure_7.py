"""A scene with all in it [as G07 figures 7 and 8, which say no figures]: a cloth falls on a sphere over a floor, folds
and lies on itself; strain and intersections of every step."""
from studies import scenes

ABOUT = "strain stays within the limit, and nothing intersects, in a scene with contact of all kinds."
KEYS = ["vertices_a_side", "end_s"]


def plan(quick):
    return [dict(zip(KEYS, (21, 0.5) if quick else (71, 1.5)))]


def measure(laboratory, point):
    run = laboratory.whole_run(scenes.sphere(int(point["vertices_a_side"]), point["end_s"]))
    columns = {"time_s": "time_s", "strain": "strain_max", "contacts": "contacts",
               "projections": "projection_iterations",
               "rejected": "rejected", "depth_m": "depth_m"}
    asked, intersections = run.summary["strain"]["limit"], run.summary["contact"]["intersections"]
    return [{**dict(zip(columns, row)), "strain_asked": asked, "intersections": intersections}
            for row in zip(*(run.steps[name] for name in columns.values()))]


def draw(axes, rows):
    times = [row["time_s"] for row in rows]
    axes.plot(times, [100 * row["strain"] for row in rows], label="largest strain, %")
    axes.plot(times, [row["projections"] for row in rows], label="projections a step", linewidth=0.7)
    axes.plot(times, [row["contacts"] / 1000 for row in rows], label="thousand contacts")
    axes.set_xlabel("time, s")
    axes.legend()


def judge(rows):
    strain, limit = max(row["strain"] for row in rows), rows[0]["strain_asked"]
    text = (f"{rows[0]['vertices_a_side']:g} vertices a side, {rows[-1]['time_s']:g} s: {len(rows)} steps, "
            f"{sum(row['rejected'] for row in rows):g} rejected, "
            f"strain {100 * strain:.3f} % of {100 * limit:g} % permitted, {rows[0]['intersections']:g} intersections "
            f"in any step, up to {max(row['contacts'] for row in rows):g} contacts, "
            f"{sum(row['projections'] for row in rows) / len(rows):.2f} projections a step")
    return strain <= limit and rows[0]["intersections"] == 0, text
