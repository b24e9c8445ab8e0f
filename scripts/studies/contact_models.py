"""One drop on a sphere with the contact of the papers and with contact inside the projection: what each keeps, and what
it costs."""
from studies import scenes

ABOUT = "only contact inside the projection keeps both: no strain over the limit, no intersection."
KEYS = ["model", "vertices_a_side", "end_s"]
MODELS = {"constraint": {"model": "constraint"}, "impulse, last": {"model": "impulse"},
          "impulse, first": {"model": "impulse", "impulse": {"order": "contact_first"}},
          "penalty": {"model": "penalty"}}


def plan(quick):
    return [dict(zip(KEYS, (model, 21 if quick else 51, 0.4 if quick else 0.6))) for model in MODELS]


def measure(laboratory, point):
    case = scenes.sphere(int(point["vertices_a_side"]), point["end_s"])
    case["contact"] |= MODELS[point["model"]]
    run = laboratory.run(case)
    found = run.measures()
    if "steps" in found:
        found |= {"intersections": run.summary["contact"]["intersections"], "strain_asked": 0.01,
                  "least_gap_m": min(float(frame["gaps"].min()) for frame in run.frames)}
    return found


def draw(axes, rows):
    rows = [row for row in rows if "strain_had" in row]
    for k, (label, key, factor) in enumerate((("largest strain, %", "strain_had", 100),
                                              ("intersections a step", "per_step", 1),
                                              ("CPU s per simulated s", "cpu_s_per_s", 1))):
        values = [factor * (row["intersections"] / row["steps"] if key == "per_step" else row[key]) for row in rows]
        axes.bar([n + 0.27 * (k - 1) for n in range(len(rows))], [max(v, 1e-3) for v in values], 0.25, label=label)
    axes.set_xticks(range(len(rows)), [row["model"] for row in rows])
    axes.set_yscale("log")
    axes.legend()


def judge(rows):
    text, both = [], []
    for row in rows:
        if "intersections" not in row:
            text.append(f"{row['model']}: {row['status']}")
            continue
        if row["strain_had"] <= row["strain_asked"] and row["intersections"] == 0:
            both.append(row["model"])
        text.append(f"{row['model']}: strain {100 * row['strain_had']:.3g} %, {row['intersections']:g} intersections "
                    f"in {row['steps']:g} steps, "
                    f"gap down to {1000 * row['least_gap_m']:.2f} mm, {row['cpu_s_per_s']:.3g} CPU s per s, depth "
                    f"{row['depth_m']:.3f} m")
    return both == ["constraint"], "; ".join(text)
