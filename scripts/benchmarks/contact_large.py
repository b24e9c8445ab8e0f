"""Large scenes in contact: what a frame costs and what takes the time, beside plain XPBD measured in the same run and
what is printed of ppf-contact-solver on a GPU."""
import tempfile
from dataclasses import dataclass, field
from pathlib import Path

from benchmarks import baseline

SHEET = "material: {density: 0.2, bending: 3.0e-5, shear: 10, damping: {mass: 0.2}}"
UNIT_SIDE = 71  # of the cloth that plain XPBD takes
COLUMNS = ["scene", "vertices", "ranks", "s a frame", "CPU s a frame", "printed", "steps (rejected)", "contacts",
           "projections a step", "products a step", "search", "programs", "strain", "intersections"]


@dataclass
class Scene:
    side: int  # vertices along it
    text: str  # of the case; {side} and, of the last vertex of the first row, {last} stand for numbers
    sets: list = field(default_factory=list)
    printed: str = "–"  # s a frame, of ppf-contact-solver on an NVIDIA L4


def sheets(strain):
    cloths = "".join(f"  - {{name: sheet{k}, grid: {{size: [2, 2], vertices: [{{side}}, {{side}}]}}, {SHEET},\n"
                     f"     start: {{translate: [-1, -1, {0.51 + 0.01 * k}]}}}}\n" for k in range(5))
    return (f"cloths:\n{cloths}obstacles: [{{sphere: {{centre: [0, 0, 0], radius: 0.5}}}}]\n"
            f"contact: {{friction: 0.2}}\ninextensibility: {{strain: {strain} %}}\n"
            "time: {end: 1.6667, frame_rate: 60, max_step: 8.34 ms}\n")


def hanging():
    return (f"cloth: {{grid: {{size: [2, 2], vertices: [{{side}}, {{side}}]}}, {SHEET}}}\n"
            "pins: [{vertices: [0, {last}]}]\ngravity: [{time: 0, value: [0, 0, -9.81]}, {time: 1, value: "
            "[0, 0, -9.81]},\n  {time: 1.02, value: [0, 0, 9.81]}]\ncontact: {}\ninextensibility: {strain: 1 %}\n"
            "time: {end: 1.6667, frame_rate: 60, max_step: 8.34 ms}\n")


def scenes(case):
    """`case` is where the text of a named case stands."""
    def shipped(name, *sets):
        return ["cloth.grid.vertices=[{side}, {side}]", *sets], case(name)

    sphere, sphere_text = shipped("sphere-large")
    pile, pile_text = shipped("pile")
    return {"hang": Scene(128, hanging(), printed="2.6"),
            "drape 5 %": Scene(128, sheets(5), printed="1.6"),
            "drape 1 %": Scene(128, sheets(1)),
            "sphere-large": Scene(500, sphere_text, sphere),
            "pile": Scene(141, pile_text, pile)}


def cells(name, ranks, scene, s, cpu):
    frames, seconds, contact = s["frames"] - 1, s["seconds"], s["contact"]
    steps, projected = s["steps"] + s["rejected_steps"], s["projection"]
    wall = seconds["total"] - seconds["setup"]
    return [name, s["vertices"], ranks, f"{wall / frames:.3g}", f"{cpu / frames:.3g}", scene.printed,
            f"{steps - s['rejected_steps']} ({s['rejected_steps']})", contact["pairs_max"],
            f"{projected['iterations_mean']:.1f}",
            f"{projected['iterations_mean'] * projected['ksp_iterations_mean']:.0f}",
            f"{100 * seconds['contact'] / wall:.0f} %", f"{100 * seconds['projection'] / wall:.0f} %",
            f"{100 * s['strain']['max']:.2f} %", contact["intersections"]]


def report(xpbd, run, case, side, end, ranks, sets, print_row):
    """`run(case, ranks, sets)` is one run's summary and CPU seconds. `side` replaces that of all scenes, `end` (s)
    their end."""
    unit = baseline.plain_xpbd(xpbd, UNIT_SIDE, 4 * UNIT_SIDE, 0.2)["cpu_s_per_s"] / 60
    print(f"Plain XPBD, two-pins, {UNIT_SIDE}² vertices, 1 %: {unit:.3g} CPU s a frame of 1/60 s. Printed: "
          "ppf-contact-solver on an NVIDIA L4.\n")
    print_row(COLUMNS)
    print_row(["---"] * len(COLUMNS))
    for name, scene in scenes(case).items():
        n = side or scene.side
        places = {"side": n, "last": n - 1}
        with tempfile.TemporaryDirectory() as folder:
            file = Path(folder) / "case.yaml"
            file.write_text(scene.text.replace("{side}", str(n)).replace("{last}", str(n - 1)))
            given = [s.format(**places) for s in scene.sets] + ([f"time.end={end}"] if end else []) + sets
            for number in ranks:
                print_row(cells(name, number, scene, *run(file, number, given)))
